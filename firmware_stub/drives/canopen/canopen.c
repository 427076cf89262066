/* CANopen drives after CiA 301 and CiA 402, one node for each drive: frames to nodes, network management, heartbeats,
 * and the order in which frames are sent. */
#include "canopen.h"
#include "objects.h"

#include <string.h>

enum { NMT_START = 1, NMT_STOP = 2, NMT_PRE_OPERATIONAL = 128, NMT_RESET_NODE = 129, NMT_RESET_COMMUNICATION = 130 };

static canopen_node node_at(laconic_drives *drives, int i, uint32_t now_us) {
    const canopen_node on = {(canopen_axis *)drives->axes + i, &drives->drive[i], drives->step_s, now_us,
                             drives->watchdog_s};
    return on;
}

/* --- resets ------------------------------------------------------------------------------------------------------ */

#define NOTHING(...)
#define RESET_MEMBER(index, sub, last, type, access, member, initial, name) \
    if ((initial) != 0) axis->member = initial;

/* The communication's objects as after power-up; boot-up, then pre-operational. */
static void reset_communication(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    axis->consumer = axis->producer_ms = axis->behaviour = 0;
    axis->sdo_step = 0;
    axis->trouble = 0;
    CANOPEN_DEVICE_OBJECTS(NOTHING, RESET_MEMBER, NOTHING, NOTHING)
    if (axis->state < CANOPEN_FAULT_REACTION) axis->error_register = 0;
    axis->sync_id = 0x80;
    axis->emergency_id = (uint16_t)(0x80 + canopen_id(on));
    canopen_start_pdos(on);
    axis->due = (uint8_t)((axis->due & CANOPEN_DUE_EMERGENCY) | CANOPEN_DUE_BOOT);
    axis->nmt = CANOPEN_PRE_OPERATIONAL;
}

/* The usual windows suit an encoder of thousands of counts. Of a coarse one, such as the steps of a commutation, they
 * would be the drive's whole range: each is then a part of a turn, and at least a count. */
static void fit_windows(canopen_axis *axis, uint32_t encoder_counts) {
    const uint16_t part = (uint16_t)(encoder_counts / 64 + 1);
    if (encoder_counts >= 4096) return;
    axis->speed_window = (uint16_t)(4 * part);
    axis->speed_threshold = part;
    axis->position_window = part;
}

static void reset_node(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const laconic_real rated_A = axis->rated_A;
    memset(axis, 0, sizeof *axis);
    CANOPEN_DRIVE_OBJECTS(NOTHING, RESET_MEMBER, NOTHING, NOTHING)
    axis->rated_A = rated_A;
    axis->ending = CANOPEN_NO_ENDING;
    fit_windows(axis, (uint32_t)on->drive->settings.encoder_counts);
    on->drive->settings.current_limit_A = rated_A;
    on->drive->target.mode = LACONIC_DRIVE_OFF;
    laconic_drive_clear(on->drive);
    reset_communication(on);
}

static void start(laconic_drives *drives, uint32_t now_us) {
    for (int i = 0; i < drives->count; i++) {
        const canopen_node on = node_at(drives, i, now_us);
        on.axis->rated_A = on.drive->settings.current_limit_A;
        reset_node(&on);
    }
}

/* --- network management ------------------------------------------------------------------------------------------ */

void canopen_set_nmt(const canopen_node *on, uint8_t nmt) {
    canopen_axis *axis = on->axis;
    const uint8_t before = axis->nmt;
    axis->nmt = nmt;
    if (nmt == CANOPEN_STOPPED) axis->due &= CANOPEN_DUE_BOOT | CANOPEN_DUE_EMERGENCY | CANOPEN_DUE_HEARTBEAT;
    if (nmt == CANOPEN_PRE_OPERATIONAL) axis->due &= (uint8_t)~(15U * CANOPEN_DUE_TPDO);
    if (nmt == CANOPEN_OPERATIONAL && before != nmt) canopen_pdos_begin(on);
}

static void command(const canopen_node *on, uint8_t code) {
    const bool is_moving = on->axis->state == CANOPEN_ENABLED || on->axis->state == CANOPEN_QUICK_STOP;
    switch (code) {
    case NMT_START: canopen_set_nmt(on, CANOPEN_OPERATIONAL); break;
    case NMT_STOP:
        if (is_moving) canopen_connection_option(on, 0x8100);
        canopen_set_nmt(on, CANOPEN_STOPPED);
        break;
    case NMT_PRE_OPERATIONAL: canopen_set_nmt(on, CANOPEN_PRE_OPERATIONAL); break;
    case NMT_RESET_NODE: reset_node(on); break;
    case NMT_RESET_COMMUNICATION:
        if (is_moving) canopen_connection_option(on, 0x8100);
        reset_communication(on);
        break;
    default: break;
    }
}

/* --- heartbeats -------------------------------------------------------------------------------------------------- */

static bool take_heartbeat(const canopen_node *on, uint32_t id) {
    canopen_axis *axis = on->axis;
    const uint32_t watched = axis->consumer >> 16 & 127U;
    if (watched == 0 || id != 0x700U + watched) return false;
    axis->consumer_us = on->now_us;
    if ((axis->consumer & 0xFFFFU) != 0) axis->trouble |= CANOPEN_LISTENS;
    axis->trouble &= (uint8_t)~CANOPEN_TROUBLE_SILENCE;
    canopen_all_clear(axis);
    return true;
}

static void check_heartbeats(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const uint32_t producer_us = 1000U * axis->producer_ms;
    if (producer_us != 0 && on->now_us - axis->producer_us >= producer_us) {
        axis->producer_us += producer_us;
        if (on->now_us - axis->producer_us >= producer_us) axis->producer_us = on->now_us; /* none is made up for */
        axis->due |= CANOPEN_DUE_HEARTBEAT;
    }
    if ((axis->trouble & CANOPEN_LISTENS) == 0) return;
    if (on->now_us - axis->consumer_us <= 1000U * (axis->consumer & 0xFFFFU)) return;
    axis->trouble = (uint8_t)((axis->trouble & ~CANOPEN_LISTENS) | CANOPEN_TROUBLE_SILENCE);
    canopen_connection_lost(on, 0x8130);
}

/* --- the protocol's functions ------------------------------------------------------------------------------------ */

static bool take_frame(const canopen_node *on, const laconic_frame *frame) {
    canopen_axis *axis = on->axis;
    const bool operational = axis->nmt == CANOPEN_OPERATIONAL;
    bool is_taken = !frame->remote && take_heartbeat(on, frame->id);
    if (axis->nmt == CANOPEN_STOPPED) return is_taken;
    if (!frame->remote && frame->id == 0x600U + canopen_id(on) && frame->length == 8) {
        canopen_sdo(on, frame->data);
        return true;
    }
    if (!operational) return is_taken;
    if (!frame->remote && frame->id == axis->sync_id) {
        canopen_sync(on);
        is_taken = true;
    }
    return canopen_take_pdo(on, frame) || is_taken;
}

static void on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us) {
    const bool is_command = frame->id == 0 && !frame->remote && frame->length == 2;
    if (frame->extended || frame->fd) return;
    for (int i = 0; i < drives->count; i++) {
        const canopen_node on = node_at(drives, i, now_us);
        if (laconic_drive_is_off_bus(on.drive)) continue;
        const bool for_it = is_command && (frame->data[1] == 0 || frame->data[1] == canopen_id(&on));
        if (for_it) command(&on, frame->data[0]);
        if (frame->id == 0 || !take_frame(&on, frame)) continue;
        if (on.axis->nmt == CANOPEN_OPERATIONAL) canopen_find_due_pdos(&on);
    }
}

static void on_step(laconic_drives *drives, uint32_t now_us) {
    for (int i = 0; i < drives->count; i++) {
        const canopen_node on = node_at(drives, i, now_us);
        canopen_watch_drive(&on);
        check_heartbeats(&on);
        if (on.axis->nmt == CANOPEN_OPERATIONAL) canopen_check_deadlines(&on);
        canopen_move(&on);
        if (on.axis->nmt == CANOPEN_OPERATIONAL) canopen_find_due_pdos(&on);
        if (laconic_drive_is_mute(on.drive)) on.axis->due &= (uint8_t)~CANOPEN_DUE_HEARTBEAT;
        if (laconic_drive_is_off_bus(on.drive)) on.axis->due = 0;
    }
}

static void send(const canopen_node *on, uint8_t what, laconic_frame *frame) {
    canopen_axis *axis = on->axis;
    frame->id = 0x700U + canopen_id(on);
    frame->length = 1;
    frame->data[0] = what == CANOPEN_DUE_BOOT ? CANOPEN_BOOT : axis->nmt;
    if (what == CANOPEN_DUE_EMERGENCY) {
        canopen_send_emergency(on, frame);
    } else if (what == CANOPEN_DUE_SDO) {
        frame->id = 0x580U + canopen_id(on);
        frame->length = 8;
        memcpy(frame->data, axis->sdo_answer, 8);
    } else if (what >= CANOPEN_DUE_TPDO && what < CANOPEN_DUE_SDO) {
        int k = 0;
        while ((CANOPEN_DUE_TPDO << k) != what) k++;
        canopen_send_pdo(on, k, frame);
    }
}

/* An error waits until a stopped node may speak again. */
static uint8_t sendable(const canopen_axis *axis) {
    return axis->nmt == CANOPEN_STOPPED ? axis->due & (uint8_t)~CANOPEN_DUE_EMERGENCY : axis->due;
}

/* The most urgent kind of frame first, of the first node that has one: near what identifiers decide on a bus. */
static bool next_frame(laconic_drives *drives, laconic_frame *frame) {
    for (uint32_t what = CANOPEN_DUE_BOOT; what <= CANOPEN_DUE_HEARTBEAT; what <<= 1) {
        for (int i = 0; i < drives->count; i++) {
            const canopen_node on = node_at(drives, i, 0);
            if ((sendable(on.axis) & what) == 0) continue;
            on.axis->due &= (uint8_t)~what;
            memset(frame, 0, sizeof *frame);
            send(&on, (uint8_t)what, frame);
            return true;
        }
    }
    return false;
}

const laconic_drive_protocol laconic_canopen = {
    .name = "canopen",
    .axis_bytes = sizeof(canopen_axis),
    .first_id = 1,
    .last_id = 127,
    .start = start,
    .on_frame = on_frame,
    .on_step = on_step,
    .next_frame = next_frame,
};
