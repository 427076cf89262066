/* The position controller: torque = kp (control position − position) + kd (control velocity − velocity)
 * + feedforward, where the control position follows the command within the limits of speed and acceleration. */
#include "../octets.h"
#include "moteus.h"

static const laconic_real timeout_max_torque_Nm = 5;                  /* servo.timeout_max_torque_Nm              */
static const laconic_real zero_capture_velocity = (laconic_real)0.05; /* servo.velocity_zero_capture_threshold */

typedef struct gains {
    laconic_real kp, kd; /* N·m for 1 turn, for 1 turn/s */
    laconic_real maximum_torque, feedforward_torque;
} gains;

/* The scene's gains are of a cascade: speed for a place's error, current for a speed's. */
static gains gains_of(const laconic_wheel_drive *drive, laconic_real kp_scale, laconic_real kd_scale) {
    const laconic_drive_settings *settings = &drive->settings;
    gains of = {0};
    of.kd = settings->speed_gain_As * moteus_torque_constant(drive) * settings->gear_ratio * (2 * MOTEUS_PI);
    of.kp = settings->position_gain_per_s * of.kd * kp_scale;
    of.kd *= kd_scale;
    of.maximum_torque = LACONIC_REAL_MAX;
    return of;
}

/* Begins where the wheel is. */
static void capture(moteus_axis *axis, const laconic_wheel_drive *drive) {
    if (axis->has_control) return;
    const laconic_real velocity = moteus_velocity(drive);
    axis->has_control = true;
    axis->control = moteus_seen(drive);
    axis->control_velocity = real_magnitude(velocity) < zero_capture_velocity ? 0 : velocity;
}

static void move_on(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real before, laconic_real step_s) {
    const laconic_real mean = (before + axis->control_velocity) / 2;
    axis->control = place_moved(axis->control, mean * step_s * moteus_counts(drive));
}

/* No place to go to: the speed alone follows, at once or by the acceleration. */
static void follow_velocity(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    const moteus_command *command = &axis->acting;
    const laconic_real most = command->acceleration_limit * step_s, before = axis->control_velocity;
    laconic_real change = command->velocity - before;
    axis->trajectory_complete = !(real_magnitude(change) > most);
    if (!axis->trajectory_complete) change = change < 0 ? -most : most;
    axis->control_velocity = axis->trajectory_complete ? command->velocity : before + change;
    move_on(axis, drive, most == most ? before : axis->control_velocity, step_s);
}

/* A motion without limit of its acceleration: at the limit of the speed until the step that reaches the target. */
static bool glide(drive_motion *motion, laconic_real step_s) {
    const laconic_real distance = place_counts(place_difference(motion->target, motion->place));
    const laconic_real most = motion->speed_limit * step_s;
    const bool arrives = real_magnitude(distance) <= most;
    motion->speed = distance < 0 ? -motion->speed_limit : motion->speed_limit;
    motion->target = place_moved(motion->target, motion->target_speed * step_s);
    motion->place = arrives ? motion->target : place_moved(motion->place, distance < 0 ? -most : most);
    return arrives;
}

static void follow_place(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    const moteus_command *command = &axis->acting;
    const laconic_real counts = moteus_counts(drive), size = real_magnitude(counts);
    drive_motion motion = {.place = axis->control, .target = axis->target};
    motion.speed = axis->control_velocity * counts;
    motion.target_speed = command->velocity * counts;
    motion.speed_limit = command->velocity_limit * size;
    motion.acceleration = motion.deceleration = command->acceleration_limit * size;
    const bool gradual = is_finite(command->acceleration_limit);
    axis->trajectory_complete = gradual ? motion_step(&motion, step_s) : glide(&motion, step_s);
    axis->control = motion.place;
    axis->target = motion.target;
    axis->control_velocity = axis->trajectory_complete ? command->velocity : motion.speed / counts;
    if (axis->trajectory_complete) axis->has_target = false;
}

/* Deprecated, and refused together with limits: past the stop position the control stands there. */
static void stop_there(moteus_axis *axis, const laconic_wheel_drive *drive) {
    moteus_command *command = &axis->acting;
    if (!is_finite(command->stop_position)) return;
    const drive_place shaft =
        place_at(command->stop_position * drive->settings.gear_ratio, drive->settings.encoder_counts);
    const drive_place stop = place_sum(shaft, axis->zero);
    const laconic_real past = place_counts(place_difference(axis->control, stop)) * drive->settings.gear_ratio;
    if (!(past * axis->control_velocity > 0)) return;
    axis->control = stop;
    axis->control_velocity = command->velocity = 0;
    axis->has_target = false;
    axis->trajectory_complete = true;
}

static void follow(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real step_s) {
    capture(axis, drive);
    if (axis->has_target && moteus_is_limited(&axis->acting)) {
        follow_place(axis, drive, step_s);
    } else {
        if (axis->has_target) axis->control = axis->target;
        axis->has_target = false;
        follow_velocity(axis, drive, step_s);
    }
    stop_there(axis, drive);
}

static void give_current(laconic_wheel_drive *drive, laconic_real current_A) {
    memset(&drive->target, 0, sizeof drive->target);
    drive->target.mode = LACONIC_DRIVE_CURRENT;
    drive->target.current_A = is_finite(current_A) ? current_A : 0;
}

static void give_torque(moteus_axis *axis, laconic_wheel_drive *drive, const gains *by) {
    const laconic_real off = place_counts(place_difference(moteus_seen(drive), axis->control)) / moteus_counts(drive);
    const laconic_real slip = moteus_velocity(drive) - axis->control_velocity;
    moteus_status *status = &axis->status;
    status->position_error = off;
    status->velocity_error = slip;
    status->torque_of_kp = by->kp * off;
    status->torque_of_kd = by->kd * slip;
    const laconic_real sum = by->feedforward_torque - by->kp * off - by->kd * slip;
    laconic_real torque = sum;
    if (by->maximum_torque == by->maximum_torque) torque = real_within(sum, -by->maximum_torque, by->maximum_torque);
    axis->fault = torque != sum ? MOTEUS_LIMIT_TORQUE : 0;
    status->command_torque = torque;
    give_current(drive, torque / moteus_torque_constant(drive));
}

static void hold_position(moteus_axis *axis, laconic_wheel_drive *drive, laconic_real step_s) {
    const moteus_command *command = &axis->acting;
    gains by = gains_of(drive, command->kp_scale, command->kd_scale);
    by.maximum_torque = command->maximum_torque;
    by.feedforward_torque = command->feedforward_torque;
    follow(axis, drive, step_s);
    give_torque(axis, drive, &by);
}

/* Damping alone. Also the timeout mode: servo.timeout_mode is 12. */
static void stop_turning(moteus_axis *axis, laconic_wheel_drive *drive) {
    gains by = gains_of(drive, 0, axis->acting.kd_scale);
    by.maximum_torque = timeout_max_torque_Nm;
    axis->has_control = true;
    axis->control = moteus_seen(drive);
    axis->control_velocity = 0;
    axis->trajectory_complete = true;
    give_torque(axis, drive, &by);
}

/* Between the bounds the feedforward alone; outside, the position controller on the bound. */
static void stay_within(moteus_axis *axis, laconic_wheel_drive *drive) {
    const moteus_command *command = &axis->acting;
    const drive_place place = place_difference(moteus_seen(drive), axis->zero);
    const laconic_real at = place_turns(place, drive->settings.encoder_counts) / drive->settings.gear_ratio;
    const bool below = at<command->lower_bound, above = at> command->upper_bound, outside = below || above;
    gains by = gains_of(drive, outside ? command->kp_scale : 0, outside ? command->kd_scale : 0);
    by.maximum_torque = command->maximum_torque;
    by.feedforward_torque = command->feedforward_torque;
    moteus_forget_control(axis);
    axis->control = moteus_seen(drive);
    if (outside) {
        const laconic_real bound = below ? command->lower_bound : command->upper_bound;
        const drive_place shaft = place_at(bound * drive->settings.gear_ratio, drive->settings.encoder_counts);
        axis->control = place_sum(shaft, axis->zero);
        axis->has_control = true;
    }
    give_torque(axis, drive, &by);
}

/* Phases shorted: the back-EMF drives its current through the winding. */
static void brake(laconic_wheel_drive *drive) {
    const laconic_drive_settings *settings = &drive->settings;
    const laconic_real back_emf_V = settings->torque_constant_Nm_per_A * drive->speed_rad_per_s;
    give_current(drive, settings->winding_resistance_ohm > 0 ? -back_emf_V / settings->winding_resistance_ohm : 0);
}

static uint8_t fault_of(uint32_t faults) {
    static const struct {
        uint32_t fault;
        uint8_t code;
    } rows[] = {
        {LACONIC_DRIVE_FAULT_ENCODER, MOTEUS_ENCODER_FAULT},
        {LACONIC_DRIVE_FAULT_TEMPERATURE, MOTEUS_OVER_TEMPERATURE},
        {LACONIC_DRIVE_FAULT_SUPPLY, MOTEUS_UNDER_VOLTAGE},
        {LACONIC_DRIVE_FAULT_OVERSPEED, MOTEUS_VELOCITY_CONTROL_ERROR},
        {LACONIC_DRIVE_FAULT_FOLLOWING, MOTEUS_POSITION_CONTROL_ERROR},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
        if (faults & rows[k].fault) return rows[k].code;
    return MOTEUS_DRIVER_FAULT;
}

/* Silence is noticed in the modes that move the wheel to places. */
static void supervise(moteus_axis *axis, laconic_wheel_drive *drive, laconic_real step_s) {
    if (drive->faults && axis->mode != MOTEUS_FAULT) {
        axis->mode = MOTEUS_FAULT;
        axis->fault = fault_of(drive->faults);
    }
    if (axis->timeout_left_s > 0)
        axis->timeout_left_s = real_within(axis->timeout_left_s - step_s, 0, LACONIC_REAL_MAX);
    if ((axis->mode == MOTEUS_POSITION || axis->mode == MOTEUS_STAY_WITHIN) && axis->timeout_left_s <= 0) {
        axis->mode = MOTEUS_TIMEOUT;
        drive->unheard = true;
        moteus_forget_control(axis);
    }
}

void moteus_control(moteus_axis *axis, laconic_wheel_drive *drive, laconic_real step_s) {
    supervise(axis, drive, step_s);
    axis->status.command_torque = 0;
    switch (axis->mode) {
    case MOTEUS_CURRENT: give_current(drive, axis->acting.q_current_A); break;
    case MOTEUS_POSITION: hold_position(axis, drive, step_s); break;
    case MOTEUS_TIMEOUT:
    case MOTEUS_ZERO_VELOCITY: stop_turning(axis, drive); break;
    case MOTEUS_STAY_WITHIN: stay_within(axis, drive); break;
    case MOTEUS_BRAKE: brake(drive); break;
    default:
        memset(&drive->target, 0, sizeof drive->target); /* off */
        moteus_forget_control(axis);
        break;
    }
}
