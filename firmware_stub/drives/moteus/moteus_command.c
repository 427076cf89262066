/* From the command that was written to the one that acts: defaults, limits, and which modes may follow which. */
#include "../octets.h"
#include "moteus.h"

/* servo.default_timeout_s, servo.default_accel_limit, servo.max_velocity as the firmware sets them. */
static const laconic_real default_timeout_s = (laconic_real)0.1;
static const laconic_real default_acceleration_limit = 50;
static const laconic_real max_velocity = 500;

/* What a register holds that the frame does not write (registers.md, "if unspecified"). */
moteus_command moteus_blank(void) {
    moteus_command blank;
    memset(&blank, 0, sizeof blank);
    const laconic_real none = real_not_a_number();
    blank.kp_scale = blank.kd_scale = blank.integral_limit_scale = 1;
    blank.maximum_torque = blank.stop_position = blank.velocity_limit = blank.acceleration_limit = none;
    blank.fixed_voltage = blank.fixed_current = none;
    return blank;
}

void moteus_set_mode(moteus_axis *axis, laconic_real mode) {
    axis->given = moteus_blank();
    axis->given.mode = mode;
    axis->commanded = true;
}

void moteus_forget_control(moteus_axis *axis) {
    axis->has_control = false;
    axis->control_velocity = 0;
}

/* Larger values are taken as this one: no wheel has them. NaN stays. */
static laconic_real bounded(laconic_real value) { return real_within(value, -1000000, 1000000); }

static void bound_all(moteus_command *command) {
    laconic_real *const values[] = {
        &command->velocity,       &command->feedforward_torque, &command->kp_scale,           &command->kd_scale,
        &command->maximum_torque, &command->velocity_limit,     &command->acceleration_limit, &command->q_current_A,
        &command->position,       &command->stop_position,      &command->lower_bound,        &command->upper_bound,
    };
    for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) *values[k] = bounded(*values[k]);
}

/* A limit that is not set is the default; a negative one is none. */
static laconic_real limit(laconic_real value, laconic_real by_default) {
    return value != value ? by_default : value < 0 ? real_not_a_number() : value;
}

/* Any limit makes one of the speed. */
static void complete_limits(moteus_command *command, const laconic_wheel_drive *drive) {
    const laconic_real gear = real_magnitude(drive->settings.gear_ratio);
    laconic_real fastest = drive->settings.speed_limit_rad_per_s / (2 * MOTEUS_PI * gear);
    if (!(fastest > 0)) fastest = max_velocity;
    command->velocity_limit = limit(command->velocity_limit, real_not_a_number());
    command->acceleration_limit = limit(command->acceleration_limit, default_acceleration_limit);
    const bool has_limits = is_finite(command->velocity_limit) || is_finite(command->acceleration_limit);
    if (has_limits && !(command->velocity_limit <= fastest)) command->velocity_limit = fastest;
    if (command->velocity != command->velocity) command->velocity = 0;
    if (has_limits)
        command->velocity = real_within(command->velocity, -command->velocity_limit, command->velocity_limit);
}

static drive_place place_of(const moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real turns) {
    return place_sum(place_at(turns * drive->settings.gear_ratio, drive->settings.encoder_counts), axis->zero);
}

/* A speed without position goes towards the stop position. */
static void turn_to_stop(const moteus_axis *axis, moteus_command *command, const laconic_wheel_drive *drive) {
    if (axis->has_target || !is_finite(command->stop_position)) return;
    const drive_place stop = place_of(axis, drive, command->stop_position);
    const laconic_real way = place_counts(place_difference(stop, moteus_seen(drive))) * drive->settings.gear_ratio;
    const laconic_real speed = real_magnitude(command->velocity);
    command->velocity = way > 0 ? speed : -speed;
}

static void complete(moteus_axis *axis, const laconic_drives *drives, const laconic_wheel_drive *drive) {
    moteus_command *command = &axis->acting;
    bound_all(command);
    if (command->timeout_s == 0) command->timeout_s = drives->watchdog_s > 0 ? drives->watchdog_s : default_timeout_s;
    complete_limits(command, drive);
    axis->has_target = command->position == command->position;
    if (axis->has_target) axis->target = place_of(axis, drive, command->position);
    turn_to_stop(axis, command, drive);
    axis->timeout_left_s = command->timeout_s;
}

static void enter(moteus_axis *axis, uint8_t mode) {
    if (mode != axis->mode) moteus_forget_control(axis);
    axis->mode = mode;
    axis->fault = 0;
}

/* BldcServo::Command and ISR_MaybeChangeMode: faults and the timeout are left by "stopped" alone; 1 to 4 are no modes
 * to command. Enabling and calibrating take no time here. */
void moteus_command_drive(const laconic_drives *drives, moteus_axis *axis, laconic_wheel_drive *drive) {
    const uint8_t mode = (uint8_t)axis->given.mode;
    if (mode >= MOTEUS_FAULT && mode <= 4) return;
    if (mode == MOTEUS_STOPPED) {
        laconic_drive_clear(drive);
        enter(axis, MOTEUS_STOPPED);
    }
    axis->acting = axis->given;
    complete(axis, drives, drive);
    if (mode == MOTEUS_STOPPED || axis->mode == MOTEUS_FAULT || axis->mode == MOTEUS_TIMEOUT) return;
    enter(axis, mode);
    if (is_finite(axis->acting.stop_position) && moteus_is_limited(&axis->acting)) {
        axis->mode = MOTEUS_FAULT;
        axis->fault = MOTEUS_STOP_POSITION_DEPRECATED;
    }
}

/* "Nearest" keeps the place within the turn of the shaft, which its encoder knows. The wheel stays where it is. */
void moteus_set_output(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real position, bool exact) {
    const int32_t counts = drive->settings.encoder_counts;
    const drive_place seen = moteus_seen(drive);
    if (!is_finite(position)) return;
    drive_place place = place_at(bounded(position) * drive->settings.gear_ratio, counts);
    if (!exact) {
        const drive_place off = place_difference(place, place_difference(seen, axis->zero));
        const laconic_real turns = place_turns(off, counts);
        const drive_place whole =
            place_at((laconic_real)(int32_t)bounded(turns + (turns < 0 ? -1 : 1) / (laconic_real)2), counts);
        place = place_sum(place_difference(seen, axis->zero), whole);
    }
    axis->zero = place_difference(seen, place);
    axis->home_state = 2; /* referenced to the output */
}
