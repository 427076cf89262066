/* What a CAN controller does between a node and its bus, in terms of bus operations: it says at which bit rate it
 * works, sends frames, repeats them where the bus says that they did not get through, counts errors and goes bus-off.
 *
 * Without bus notifications (the standard's default) every frame counts as sent. With them one frame at a time is on
 * its way: the next one follows when the bus has confirmed it. A frame that lost arbitration or met a bus error is sent
 * again, unless `drops_lost` lets go of those that lost arbitration.
 *
 * Error counters after ISO 11898-1, as far as operations tell: a sender's counter rises by 8 with each error and falls
 * by 1 with each confirmed frame, a receiver's rises by 1 (8 where it was the first to notice) and falls by 1 with each
 * frame heard; above 127 the node is error-passive, above 255 bus-off. It returns after 128 times 11 bits. */
#ifndef LACONIC_FMU_NETWORK_CAN_CONTROLLER_H
#define LACONIC_FMU_NETWORK_CAN_CONTROLLER_H

#include "ls_bus.h"

typedef struct can_controller {
    /* settings, by the model's parameters */
    bool notified; /* BusNotifications */
    bool discards; /* the bus shall discard what loses arbitration, and say so */
    bool drops_lost;
    int32_t bit_rate_bit_per_s, fd_bit_rate_bit_per_s; /* FD 0: no CAN FD */
    /* state */
    bool waits; /* `on_its_way` has been sent and not confirmed */
    bool again; /* ... and must be sent once more               */
    laconic_frame on_its_way;
    int32_t transmit_errors, receive_errors;
    int32_t status; /* enum ls_bus_status */
    uint64_t off_until_us;
    int32_t sent, heard, lost, wrong; /* frames sent and heard, frames let go, wrong operations; INT32_MAX: or more */
} can_controller;

/* As after power-up: no frame on its way, error-active. Puts the configuration of the bus into `tx`. */
void can_controller_start(can_controller *controller, ls_bus_buffer *tx);

/* Whether a frame can be sent now. */
bool can_controller_is_free(const can_controller *controller, const ls_bus_buffer *tx);
/* Sends a frame; the controller must be free. */
void can_controller_send(can_controller *controller, ls_bus_buffer *tx, const laconic_frame *frame);

/* Takes an operation; true: a frame has come, operation->frame. Wrong operations are answered. */
bool can_controller_hear(can_controller *controller, ls_bus_buffer *tx, ls_bus_reading reading,
                         const ls_bus_operation *operation, uint64_t now_us);

/* Time has passed: a node that was bus-off returns, and a frame that must be sent again is. */
void can_controller_tick(can_controller *controller, ls_bus_buffer *tx, uint64_t now_us);

#endif
