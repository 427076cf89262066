/* Clocks of bus terminals: when the bytes to send are sent. */
#include "network_port.h"

void network_ports_make_due(network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++) ports[k].is_due = ports[k].tx.size > 0;
}

bool network_ports_are_due(const network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++)
        if (ports[k].is_due) return true;
    return false;
}

void network_port_activate(network_port *port) {
    port->is_due = false;
    port->tx_clock = true;
    port->offered = port->tx.size;
}

/* Whatever the importer did with them: they belong to this activation of their clock only. */
void network_ports_settle(network_port *ports, size_t count) {
    for (size_t k = 0; k < count; k++) {
        network_port *port = &ports[k];
        if (port->tx_clock) ls_bus_drop(&port->tx, port->offered);
        port->offered = 0;
        port->tx_clock = port->rx_clock = false;
        port->rx.size = 0;
    }
}
