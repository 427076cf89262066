/* Controller::update of 0.5.6: the input mode shapes the setpoints, the control mode says which of them act. */
#include "../octets.h"
#include "odrive.h"

/* Defaults of 0.5.6 (Controller::Config_t) for which CANSimple has no message. */
static const laconic_real speed_ramp = 1;                   /* vel_ramp_rate [turn/s²]         */
static const laconic_real torque_ramp = (laconic_real)0.01; /* torque_ramp_rate [N·m/s]        */
static const laconic_real filter_bandwidth_per_s = 2;       /* input_filter_bandwidth          */

drive_place odrive_place(const odrive_axis *axis, const laconic_wheel_drive *drive) {
    const drive_place place = {drive->encoder.count, 0};
    return place_difference(place, axis->zero);
}

static laconic_real counts_of(const laconic_wheel_drive *drive, laconic_real turns) {
    return turns * (laconic_real)drive->settings.encoder_counts;
}

static void ramp_speed(odrive_axis *axis, laconic_real step_s) {
    const laconic_real change = real_within(axis->input_speed - axis->speed, -speed_ramp * step_s, speed_ramp * step_s);
    axis->speed += change;
    axis->torque = change / step_s * axis->inertia;
}

static void ramp_torque(odrive_axis *axis, laconic_real step_s) {
    axis->torque += real_within(axis->input_torque - axis->torque, -torque_ramp * step_s, torque_ramp * step_s);
}

/* A critically damped filter of second order. */
static void filter_place(odrive_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    const laconic_real most = (laconic_real)0.25 / step_s;
    const laconic_real ki = 2 * (filter_bandwidth_per_s < most ? filter_bandwidth_per_s : most);
    const laconic_real kp = ki * ki / 4;
    const laconic_real off = place_counts(place_difference(axis->input_place, axis->place)) / counts_of(drive, 1);
    const laconic_real acceleration = kp * off + ki * (axis->input_speed - axis->speed);
    axis->torque = acceleration * axis->inertia;
    axis->speed += step_s * acceleration;
    axis->place = place_moved(axis->place, counts_of(drive, step_s * axis->speed));
}

static void travel(odrive_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    if (!axis->travelling) return;
    drive_motion motion = {.place = axis->place, .target = axis->input_place};
    motion.speed = counts_of(drive, axis->speed);
    motion.speed_limit = counts_of(drive, axis->travel_speed);
    motion.acceleration = counts_of(drive, axis->travel_acceleration);
    motion.deceleration = counts_of(drive, axis->travel_deceleration);
    axis->travelling = !motion_step(&motion, step_s);
    const laconic_real speed = motion.speed / counts_of(drive, 1);
    axis->torque = axis->travelling ? (speed - axis->speed) / step_s * axis->inertia : 0;
    axis->speed = speed;
    axis->place = motion.place;
}

static void shape(odrive_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    switch (axis->input_mode) {
    case ODRIVE_PASSTHROUGH:
        axis->place = axis->input_place;
        axis->speed = axis->input_speed;
        axis->torque = axis->input_torque;
        break;
    case ODRIVE_VEL_RAMP: ramp_speed(axis, step_s); break;
    case ODRIVE_TORQUE_RAMP: ramp_torque(axis, step_s); break;
    case ODRIVE_POS_FILTER: filter_place(axis, drive, step_s); break;
    case ODRIVE_TRAP_TRAJ: travel(axis, drive, step_s); break;
    default: break; /* inactive: the setpoints stay */
    }
    axis->speed = real_within(axis->speed, -axis->speed_limit, axis->speed_limit);
}

/* Torque control keeps the limit of the speed with the gain of the speed loop (limitVel of 0.5.6). */
static laconic_real held_below_limit(const odrive_axis *axis, const laconic_wheel_drive *drive,
                                     laconic_real current_A) {
    const laconic_real gain = drive->settings.speed_gain_As, limit = axis->speed_limit * (2 * ODRIVE_PI);
    if (!is_finite(limit) || gain == 0) return current_A;
    const laconic_real speed = drive->speed_rad_per_s;
    return real_within(current_A, (-limit - speed) * gain, (limit - speed) * gain);
}

void odrive_follow(odrive_axis *axis, laconic_wheel_drive *drive, laconic_real step_s) {
    static const laconic_drive_mode modes[] = {
        [ODRIVE_TORQUE] = LACONIC_DRIVE_CURRENT,
        [ODRIVE_VELOCITY] = LACONIC_DRIVE_SPEED,
        [ODRIVE_POSITION] = LACONIC_DRIVE_POSITION,
    };
    shape(axis, drive, step_s);
    const drive_place place = place_sum(axis->place, axis->zero);
    drive->target.mode = modes[axis->control_mode];
    drive->target.position_count = place.count;
    drive->target.position_rest = place.rest;
    drive->target.speed_rad_per_s = axis->speed * (2 * ODRIVE_PI);
    drive->target.current_A = axis->torque / drive->settings.torque_constant_Nm_per_A;
    if (axis->control_mode == ODRIVE_TORQUE)
        drive->target.current_A = held_below_limit(axis, drive, drive->target.current_A);
}
