/* The bus: queues of the nodes, arbitration, and the frame that is on the wire. */
#include <string.h>

#include "frame_time.h"
#include "model_interface.h"

#define INSTANT 1e-12 /* s: times that differ by less are one */
#define SOON_S 1e-6   /* until operations that are ready are sent */

static void count(int32_t *counter) { *counter += *counter < INT32_MAX; }

void fmu_model_made(fmu_model *model) { model->notifies = true; }

bool fmu_model_take_private(fmu_instance *instance, uint32_t reference, uint64_t bits) {
    (void)instance;
    (void)reference;
    (void)bits;
    return false;
}

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    if (!network_may_start(instance)) return FMU_ERROR;
    memset(self->port, 0, sizeof self->port);
    memset(self->node, 0, sizeof self->node);
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++) self->node[k].status = LS_BUS_ERROR_ACTIVE;
    self->is_busy = self->rates_differ = false;
    self->busy_s = 0.0;
    self->carried = self->contended = self->failed = self->dropped = 0;
    self->start_needed = self->change_needed = false;
    return FMU_OK;
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    (void)instance; /* counters are always up to date */
    (void)groups;
}

/* -------------------------------------------------------------------------------------- what comes -- */

static void configure(bus_node *node, const ls_bus_operation *operation) {
    switch (operation->parameter) {
    case LS_BUS_CAN_BAUDRATE: node->bit_rate_bit_per_s = operation->value; break;
    case LS_BUS_CAN_FD_BAUDRATE: node->fd_bit_rate_bit_per_s = operation->value; break;
    case LS_BUS_ARBITRATION_LOST_BEHAVIOR: node->discards = operation->value == LS_BUS_DISCARD_AND_NOTIFY; break;
    default: break; /* CAN XL */
    }
}

static void take(fmu_instance *instance, unsigned from, ls_bus_reading reading, const ls_bus_operation *operation) {
    fmu_model *self = &instance->model;
    bus_node *node = &self->node[from];
    if (reading == LS_BUS_WRONG) {
        if (operation->code != LS_BUS_FORMAT_ERROR)
            ls_bus_put_format_error(&self->port[from].tx, operation->bytes, operation->size);
        return;
    }
    switch (operation->code) {
    case LS_BUS_CAN_TRANSMIT:
    case LS_BUS_CAN_FD_TRANSMIT:
        if (node->status == LS_BUS_BUS_OFF) return;
        if (ls_bus_put_frame(&node->queue, &operation->frame, operation->error_passive)) return;
        if (self->dropped == 0)
            fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING, "Node%u sends more than the bus can carry: frames are lost",
                    from + 1);
        count(&self->dropped);
        return;
    case LS_BUS_CONFIGURATION: configure(node, operation); return;
    case LS_BUS_STATUS: node->status = operation->status; return;
    default: return; /* notifications of others are not for a bus */
    }
}

void fmu_model_receive(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++) {
        network_port *port = &self->port[k];
        ls_bus_operation operation;
        ls_bus_reading reading;
        size_t at = 0;
        if (!port->rx_clock) continue;
        while ((reading = ls_bus_read(port->rx.bytes, port->rx.size, &at, &operation)) != LS_BUS_END)
            take(instance, k, reading, &operation);
    }
}

/* ------------------------------------------------------------------------------------- arbitration -- */

static bool first_of(const bus_node *node, ls_bus_operation *operation) {
    size_t at = 0;
    return ls_bus_read(node->queue.bytes, node->queue.size, &at, operation) == LS_BUS_RIGHT;
}

/* The bits with which a frame competes, the first one highest: a lower number wins. A standard frame wins over an
 * extended one with the same 11 bits, and a data frame over a remote one. */
static uint64_t rank_of(const laconic_frame *frame) {
    const uint32_t base = frame->extended ? frame->id >> 18 : frame->id;
    const uint32_t rest = frame->extended ? frame->id & 0x3FFFFU : 0;
    const uint64_t first = frame->extended || frame->remote; /* SRR, RTR */
    return (uint64_t)base << 21 | first << 20 | (uint64_t)frame->extended << 19 | (uint64_t)rest << 1 |
           (frame->extended && frame->remote);
}

/* The node that sends next: error-active before error-passive, whose next frame has to wait (the suspend transmission
 * time), then by rank. FMU_MODEL_PORTS: none. */
static unsigned winner(const fmu_model *self, ls_bus_operation *operation) {
    unsigned best = FMU_MODEL_PORTS;
    uint64_t best_rank = 0;
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++) {
        ls_bus_operation each;
        if (!first_of(&self->node[k], &each)) continue;
        const uint64_t passive = self->node[k].status == LS_BUS_ERROR_PASSIVE;
        const uint64_t rank = passive << 63 | rank_of(&each.frame);
        if (best < FMU_MODEL_PORTS && rank >= best_rank) continue;
        best = k;
        best_rank = rank;
        *operation = each;
    }
    return best;
}

static uint32_t largest(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* Bits per second; 0: the nodes do not agree, and nothing is carried. */
static uint32_t bit_rate(const fmu_model *self) {
    const uint32_t first = self->node[0].bit_rate_bit_per_s, second = self->node[1].bit_rate_bit_per_s;
    if (first != 0 && second != 0 && first != second) return 0;
    return first + second == 0 ? (uint32_t)self->bit_rate_bit_per_s : largest(first, second);
}

static double time_of(const fmu_model *self, const laconic_frame *frame) {
    const uint32_t fd = largest(self->node[0].fd_bit_rate_bit_per_s, self->node[1].fd_bit_rate_bit_per_s);
    return frame_time_s(frame, bit_rate(self), fd > 0 ? fd : bit_rate(self));
}

static void lose(fmu_model *self, unsigned loser) {
    ls_bus_operation operation;
    bus_node *node = &self->node[loser];
    if (!first_of(node, &operation)) return;
    count(&self->contended);
    if (!node->discards) return;
    ls_bus_put_id(&self->port[loser].tx, LS_BUS_ARBITRATION_LOST, operation.id);
    ls_bus_drop(&node->queue, operation.size);
}

static void begin_frame(fmu_instance *instance, double at_s) {
    fmu_model *self = &instance->model;
    ls_bus_operation operation;
    if (self->is_busy) return;
    const unsigned best = winner(self, &operation);
    if (best == FMU_MODEL_PORTS) return;
    if (bit_rate(self) == 0) {
        if (!self->rates_differ)
            fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
                    "Node1 works at %u bit/s, Node2 at %u: the bus carries nothing",
                    (unsigned)self->node[0].bit_rate_bit_per_s, (unsigned)self->node[1].bit_rate_bit_per_s);
        self->rates_differ = true;
        return;
    }
    const double lasts_s = time_of(self, &operation.frame);
    self->is_busy = true;
    self->sender = best;
    self->frame = operation.frame;
    self->error_passive = operation.error_passive;
    self->free_s = at_s + lasts_s;
    self->busy_s += lasts_s;
    ls_bus_drop(&self->node[best].queue, operation.size);
    lose(self, 1 - best);
}

/* ------------------------------------------------------------------------------------ what is sent -- */

/* The receiver finds the error, by the CRC. */
static void fail_frame(fmu_model *self) {
    count(&self->failed);
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++) {
        const bool is_sender = k == self->sender;
        ls_bus_put_error(&self->port[k].tx, self->frame.id, LS_BUS_CRC_ERROR,
                         is_sender ? LS_BUS_SECONDARY_ERROR_FLAG : LS_BUS_PRIMARY_ERROR_FLAG, is_sender);
    }
}

static void deliver_frame(fmu_model *self) {
    const unsigned receiver = 1 - self->sender;
    const bool is_off = self->node[receiver].status == LS_BUS_BUS_OFF;
    count(&self->carried);
    if (is_off) return; /* nobody acknowledges it */
    ls_bus_put_id(&self->port[self->sender].tx, LS_BUS_CONFIRM, self->frame.id);
    if (!ls_bus_put_frame(&self->port[receiver].tx, &self->frame, self->error_passive)) count(&self->dropped);
}

static void end_frame(fmu_model *self) {
    const int32_t number = self->carried < INT32_MAX - self->failed ? self->carried + self->failed + 1 : 1;
    self->is_busy = false;
    if (self->error_every > 0 && number % self->error_every == 0)
        fail_frame(self);
    else
        deliver_frame(self);
}

void fmu_model_advance(fmu_instance *instance, double end_s) {
    fmu_model *self = &instance->model;
    begin_frame(instance, self->time_s);
    while (self->is_busy && self->free_s <= end_s + INSTANT) {
        end_frame(self);
        begin_frame(instance, self->free_s);
    }
}

double fmu_model_countdown(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    ls_bus_operation operation;
    double left_s = 0.0;
    for (unsigned k = 0; k < FMU_MODEL_PORTS; k++)
        if (self->port[k].tx.size > self->port[k].offered) return SOON_S;
    if (self->is_busy)
        left_s = self->free_s - self->time_s;
    else if (bit_rate(self) > 0 && winner(self, &operation) < FMU_MODEL_PORTS)
        left_s = time_of(self, &operation.frame);
    else
        return 0.0;
    return left_s > SOON_S ? left_s : SOON_S;
}
