/* Clocks of bus terminals: when the bytes to send are sent. */
#include "network_port.h"

void network_ports_make_due(network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++) {
        ports[k].due = ports[k].tx.size;
        ports[k].is_due = ports[k].due > 0;
        ports[k].is_ready = ports[k].again = false;
    }
}

bool network_ports_are_due(const network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++)
        if (ports[k].is_due) return true;
    return false;
}

bool network_ports_need_update(const network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++)
        if (ports[k].again) return true;
    return false;
}

void network_port_activate(network_port *port) {
    port->again = port->is_ready; /* a triggered clock: answers to what comes now wait for the next step */
    port->offered = port->is_ready ? port->due : port->tx.size;
    port->is_due = port->is_ready = false;
    port->tx_clock = true;
}

/* What a clock has sent goes, whatever the importer did with it. What no importer asked for stays. */
static void settle(network_port *port) {
    const bool comes = port->is_due && !port->is_ready;
    if (port->tx_clock) ls_bus_drop(&port->tx, port->offered);
    port->again = comes || (port->tx_clock && port->again);
    port->is_due = port->is_ready = comes;
    port->offered = 0;
    port->tx_clock = port->rx_clock = false;
    port->rx.size = 0;
}

void network_ports_settle(network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++) settle(&ports[k]);
}
