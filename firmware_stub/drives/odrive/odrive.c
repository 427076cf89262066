/* The protocol as the node sees it: which axis a frame is for, cyclic messages, and whose message is next. */
#include "odrive.h"

#include <string.h>

/* Defaults of axis.config.can: heartbeat_msg_rate_ms 100, encoder_msg_rate_ms 10, all others 0, which is never. */
enum { HEARTBEAT_US = 100000, ENCODER_US = 10000 };

/* Defaults of 0.5.6: Controller::Config_t, TrapezoidalTrajectory::Config_t. */
static void set_defaults(odrive_axis *axis) {
    axis->state = ODRIVE_IDLE;
    axis->control_mode = ODRIVE_POSITION;
    axis->input_mode = ODRIVE_PASSTHROUGH;
    axis->travel_speed = 2;
    axis->travel_acceleration = (laconic_real)0.5;
    axis->travel_deceleration = (laconic_real)0.5;
}

void odrive_restart(laconic_drives *drives, int32_t i, uint32_t now_us) {
    odrive_axis *axis = odrive_axis_of(drives, i);
    laconic_wheel_drive *drive = &drives->drive[i];
    const laconic_drive_settings saved = axis->saved;
    const laconic_real most_current_A = axis->most_current_A;
    memset(axis, 0, sizeof *axis);
    laconic_drive_off(drive);
    axis->saved = drive->settings = saved;
    axis->most_current_A = most_current_A;
    set_defaults(axis);
    axis->node_id = (uint8_t)saved.node_id;
    axis->zero.count = drive->encoder.count; /* an incremental encoder starts at 0 */
    axis->speed_limit = saved.speed_limit_rad_per_s / (2 * ODRIVE_PI);
    if (saved.speed_limit_rad_per_s == 0) axis->speed_limit = LACONIC_REAL_MAX;
    axis->heartbeat_us = axis->encoder_us = now_us;
}

static void start(laconic_drives *drives, uint32_t now_us) {
    for (int32_t i = 0; i < drives->count; i++) {
        odrive_axis *axis = odrive_axis_of(drives, i);
        axis->saved = drives->drive[i].settings;
        axis->most_current_A = axis->saved.current_limit_A;
        odrive_restart(drives, i, now_us);
    }
}

static void on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us) {
    if (frame->extended || frame->fd) return;
    const uint32_t node_id = frame->id >> ODRIVE_COMMAND_BITS;
    for (int32_t i = 0; i < drives->count; i++)
        if ((node_id == odrive_axis_of(drives, i)->node_id || node_id == ODRIVE_EVERY_NODE) &&
            !laconic_drive_is_off_bus(&drives->drive[i]))
            odrive_take(drives, i, frame, now_us);
}

static void announce(odrive_axis *axis, odrive_command command, uint32_t *last_us, uint32_t period_us,
                     uint32_t now_us) {
    if (now_us - *last_us < period_us) return;
    *last_us += period_us;
    if (now_us - *last_us >= period_us) *last_us = now_us; /* messages that could not be sent are not made up for */
    axis->pending |= 1U << command;
}

static void on_step(laconic_drives *drives, uint32_t now_us) {
    for (int32_t i = 0; i < drives->count; i++) {
        odrive_axis *axis = odrive_axis_of(drives, i);
        odrive_supervise(drives, i, now_us);
        if (axis->state == ODRIVE_CLOSED_LOOP_CONTROL) odrive_follow(axis, &drives->drive[i], drives->step_s);
        announce(axis, ODRIVE_HEARTBEAT, &axis->heartbeat_us, HEARTBEAT_US, now_us);
        announce(axis, ODRIVE_GET_ENCODER_ESTIMATES, &axis->encoder_us, ENCODER_US, now_us);
        if (laconic_drive_is_mute(&drives->drive[i])) axis->pending &= ~(1U << ODRIVE_HEARTBEAT);
        if (laconic_drive_is_off_bus(&drives->drive[i])) axis->pending = 0;
    }
}

/* On a bus the lowest identifier goes first. */
static bool next_frame(laconic_drives *drives, laconic_frame *frame) {
    int32_t first = -1;
    uint32_t lowest = UINT32_MAX;
    for (int32_t i = 0; i < drives->count; i++) {
        const odrive_axis *axis = odrive_axis_of(drives, i);
        uint32_t command = 0;
        while (command < ODRIVE_COMMANDS && !(axis->pending >> command & 1U)) command++;
        const uint32_t id = (uint32_t)axis->node_id << ODRIVE_COMMAND_BITS | command;
        if (command == ODRIVE_COMMANDS || id >= lowest) continue;
        first = i;
        lowest = id;
    }
    if (first < 0) return false;
    odrive_axis *axis = odrive_axis_of(drives, first);
    const odrive_command command = (odrive_command)(lowest & (ODRIVE_COMMANDS - 1));
    axis->pending &= ~(1U << command);
    odrive_message(drives, first, command, frame);
    return true;
}

const laconic_drive_protocol laconic_odrive = {
    .name = "odrive",
    .axis_bytes = sizeof(odrive_axis),
    .first_id = 0,
    .last_id = ODRIVE_EVERY_NODE - 1,
    .start = start,
    .on_frame = on_frame,
    .on_step = on_step,
    .next_frame = next_frame,
};
