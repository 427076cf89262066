/* What the registers show of a drive. */
#include "../octets.h"
#include "moteus.h"

/* What limits the torque, where nothing is wrong. */
static uint8_t limit_of(const moteus_axis *axis, const laconic_wheel_drive *drive) {
    if (axis->fault != 0) return axis->fault;
    if (drive->limits & LACONIC_DRIVE_AT_SUPPLY) return MOTEUS_LIMIT_VOLTAGE;
    if (drive->limits & LACONIC_DRIVE_AT_CURRENT) return MOTEUS_LIMIT_CURRENT;
    return 0;
}

void moteus_update_status(const laconic_drives *drives, int32_t i) {
    moteus_axis *axis = (moteus_axis *)drives->axes + i;
    const laconic_wheel_drive *drive = &drives->drive[i];
    const laconic_drive_settings *settings = &drive->settings;
    const drive_place place = place_difference(moteus_seen(drive), axis->zero);
    const laconic_real none = real_not_a_number(), velocity = moteus_velocity(drive);
    moteus_status *status = &axis->status;
    status->mode = axis->mode;
    status->encoder_position = place_turns(place, settings->encoder_counts);
    status->encoder_velocity = drive->speed_rad_per_s / (2 * MOTEUS_PI);
    status->encoder_validity = 3; /* encoder 0: place and speed */
    status->position = status->encoder_position / settings->gear_ratio;
    status->velocity = velocity;
    status->torque = moteus_torque_constant(drive) * drive->current_A;
    status->q_current_A = drive->current_A;
    status->power_W = (settings->torque_constant_Nm_per_A * drive->speed_rad_per_s +
                       settings->winding_resistance_ohm * drive->current_A) *
                      drive->current_A;
    status->trajectory_complete = axis->trajectory_complete;
    status->home_state = axis->home_state;
    status->voltage_V = settings->supply_V;
    status->temperature_C = 25; /* drives have no thermal model */
    status->fault = limit_of(axis, drive);
    status->torque_error = status->torque - status->command_torque;
    const drive_place control = place_difference(axis->control, axis->zero);
    status->control_position =
        axis->has_control ? place_turns(control, settings->encoder_counts) / settings->gear_ratio : none;
    status->control_velocity = axis->has_control ? axis->control_velocity : none;
}
