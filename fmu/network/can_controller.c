/* Frames and bus notifications. */
#include "can_controller.h"

#define PASSIVE_ABOVE 127
#define OFF_ABOVE 255
#define ROOM_FOR_STATUS 64U /* frames leave it, so that a change of status can always be told */
#define RECOVERY_BITS (128U * 11U)
#define PASSIVE_RECEIVER 119 /* where the counter of a receiver goes that hears a frame while it is passive */

static void count(int32_t *counter) { *counter += *counter < INT32_MAX; }

void can_controller_start(can_controller *controller, ls_bus_buffer *tx) {
    controller->waits = controller->again = false;
    controller->transmit_errors = controller->receive_errors = 0;
    controller->status = LS_BUS_ERROR_ACTIVE;
    controller->sent = controller->heard = controller->lost = controller->wrong = 0;
    ls_bus_put_configuration(tx, LS_BUS_CAN_BAUDRATE, (uint32_t)controller->bit_rate_bit_per_s);
    if (controller->fd_bit_rate_bit_per_s > 0)
        ls_bus_put_configuration(tx, LS_BUS_CAN_FD_BAUDRATE, (uint32_t)controller->fd_bit_rate_bit_per_s);
    ls_bus_put_configuration(tx, LS_BUS_ARBITRATION_LOST_BEHAVIOR,
                             controller->notified && controller->discards ? LS_BUS_DISCARD_AND_NOTIFY
                                                                          : LS_BUS_BUFFER_AND_RETRANSMIT);
}

bool can_controller_is_free(const can_controller *controller, const ls_bus_buffer *tx) {
    return !controller->waits && controller->status != LS_BUS_BUS_OFF &&
           ls_bus_has_room(tx, LS_BUS_LARGEST_OPERATION + ROOM_FOR_STATUS);
}

static bool put_frame(const can_controller *controller, ls_bus_buffer *tx, const laconic_frame *frame) {
    return ls_bus_put_frame(tx, frame, controller->status == LS_BUS_ERROR_PASSIVE);
}

void can_controller_send(can_controller *controller, ls_bus_buffer *tx, const laconic_frame *frame) {
    if (!put_frame(controller, tx, frame)) return;
    count(&controller->sent);
    controller->waits = controller->notified;
    controller->on_its_way = *frame;
}

/* The status that the counters mean; a change is told to the bus. */
static void judge(can_controller *controller, ls_bus_buffer *tx, uint64_t now_us) {
    const int32_t worst = controller->transmit_errors > controller->receive_errors ? controller->transmit_errors
                                                                                   : controller->receive_errors;
    const int32_t before = controller->status;
    if (before == LS_BUS_BUS_OFF) return;
    controller->status = controller->transmit_errors > OFF_ABOVE ? LS_BUS_BUS_OFF
                         : worst > PASSIVE_ABOVE                 ? LS_BUS_ERROR_PASSIVE
                                                                 : LS_BUS_ERROR_ACTIVE;
    if (controller->status == before) return;
    ls_bus_put_status(tx, (enum ls_bus_status)controller->status);
    if (controller->status == LS_BUS_BUS_OFF)
        controller->off_until_us = now_us + RECOVERY_BITS * 1000000U / (uint32_t)controller->bit_rate_bit_per_s;
}

static bool is_on_its_way(const can_controller *controller, uint32_t id) {
    return controller->waits && !controller->again && controller->on_its_way.id == id;
}

static void confirm(can_controller *controller, uint32_t id) {
    if (!is_on_its_way(controller, id)) return;
    controller->waits = false;
    controller->transmit_errors -= controller->transmit_errors > 0;
}

static void lose(can_controller *controller, uint32_t id) {
    if (!is_on_its_way(controller, id)) return;
    if (controller->drops_lost) {
        controller->waits = false;
        count(&controller->lost);
    } else {
        controller->again = true;
    }
}

static void fail(can_controller *controller, const ls_bus_operation *error) {
    if (error->is_sender) {
        controller->transmit_errors += 8;
        if (is_on_its_way(controller, error->id)) controller->again = true;
    } else if (controller->receive_errors <= PASSIVE_ABOVE) {
        controller->receive_errors += error->flag == LS_BUS_PRIMARY_ERROR_FLAG ? 8 : 1;
    }
}

static void notice(can_controller *controller, ls_bus_buffer *tx, const ls_bus_operation *operation, uint64_t now_us) {
    if (!controller->notified) return; /* the standard: then they are passed over */
    if (operation->code == LS_BUS_CONFIRM) confirm(controller, operation->id);
    if (operation->code == LS_BUS_ARBITRATION_LOST) lose(controller, operation->id);
    if (operation->code == LS_BUS_BUS_ERROR) fail(controller, operation);
    judge(controller, tx, now_us);
    can_controller_tick(controller, tx, now_us);
}

static void hear_frame(can_controller *controller, ls_bus_buffer *tx, uint64_t now_us) {
    count(&controller->heard);
    if (!controller->notified) return;
    controller->receive_errors = controller->receive_errors > PASSIVE_ABOVE ? PASSIVE_RECEIVER
                                 : controller->receive_errors > 0           ? controller->receive_errors - 1
                                                                            : 0;
    judge(controller, tx, now_us);
}

bool can_controller_hear(can_controller *controller, ls_bus_buffer *tx, ls_bus_reading reading,
                         const ls_bus_operation *operation, uint64_t now_us) {
    if (reading == LS_BUS_WRONG) {
        count(&controller->wrong);
        /* an answer to a wrong answer would never end */
        if (operation->code != LS_BUS_FORMAT_ERROR) ls_bus_put_format_error(tx, operation->bytes, operation->size);
        return false;
    }
    switch (operation->code) {
    case LS_BUS_CAN_TRANSMIT:
    case LS_BUS_CAN_FD_TRANSMIT:
        if (controller->status == LS_BUS_BUS_OFF) return false;
        if (operation->frame.fd && controller->fd_bit_rate_bit_per_s == 0) return false; /* it could not read it */
        hear_frame(controller, tx, now_us);
        return true;
    case LS_BUS_CONFIRM:
    case LS_BUS_ARBITRATION_LOST:
    case LS_BUS_BUS_ERROR: notice(controller, tx, operation, now_us); return false;
    default: return false; /* configuration, status, wake-up, CAN XL: not for a node of this kind */
    }
}

void can_controller_tick(can_controller *controller, ls_bus_buffer *tx, uint64_t now_us) {
    if (controller->status == LS_BUS_BUS_OFF) {
        if (now_us < controller->off_until_us) return;
        controller->transmit_errors = controller->receive_errors = 0;
        controller->status = LS_BUS_ERROR_ACTIVE;
        ls_bus_put_status(tx, LS_BUS_ERROR_ACTIVE);
    }
    if (!controller->again || !put_frame(controller, tx, &controller->on_its_way)) return;
    controller->again = false;
}
