/* Drives without a node, for Python. */
#include "library_drives.h"

#include "laconic_drives/drives.h"

uint32_t laconic_library_wheel_drive_size(void) { return (uint32_t)sizeof(laconic_wheel_drive); }

void laconic_library_wheel_drive_start(laconic_wheel_drive *drive, const laconic_library_drive_settings *settings) {
    const laconic_drive_settings numbers = {
        .node_id = settings->node_id,
        .encoder_counts = settings->encoder_counts,
        .gear_ratio = (laconic_real)settings->gear_ratio,
        .torque_constant_Nm_per_A = (laconic_real)settings->torque_constant_Nm_per_A,
        .back_emf_Vs_per_rad = (laconic_real)settings->back_emf_Vs_per_rad,
        .current_limit_A = (laconic_real)settings->current_limit_A,
        .speed_limit_rad_per_s = (laconic_real)settings->speed_limit_rad_per_s,
        .supply_V = (laconic_real)settings->supply_V,
        .winding_resistance_ohm = (laconic_real)settings->winding_resistance_ohm,
        .current_bandwidth_rad_per_s = (laconic_real)settings->current_bandwidth_rad_per_s,
        .position_gain_per_s = (laconic_real)settings->position_gain_per_s,
        .speed_gain_As = (laconic_real)settings->speed_gain_As,
        .speed_integral_gain_A = (laconic_real)settings->speed_integral_gain_A,
        .stall_time_s = (laconic_real)settings->stall_time_s,
    };
    laconic_drive_start(drive, &numbers);
}

void laconic_library_wheel_drive_aim(laconic_wheel_drive *drive, int32_t mode, int64_t count, double rest,
                                     double speed_rad_per_s, double current_A) {
    const laconic_drive_target target = {.mode = (laconic_drive_mode)mode,
                                         .position_count = count,
                                         .position_rest = (laconic_real)rest,
                                         .speed_rad_per_s = (laconic_real)speed_rad_per_s,
                                         .current_A = (laconic_real)current_A};
    drive->target = target;
}

double laconic_library_wheel_drive_act(laconic_wheel_drive *drive, double step_s) {
    return (double)laconic_drive_act(drive, (laconic_real)step_s);
}

void laconic_library_wheel_drive_measure(laconic_wheel_drive *drive, double turned_rad, double speed_rad_per_s) {
    laconic_drive_measure(drive, (laconic_real)turned_rad, (laconic_real)speed_rad_per_s);
}

void laconic_library_wheel_drive_clear(laconic_wheel_drive *drive) { laconic_drive_clear(drive); }

void laconic_library_wheel_drive_break(laconic_wheel_drive *drive, uint32_t faults) {
    laconic_drive_break(drive, faults);
}

void laconic_library_wheel_drive_mend(laconic_wheel_drive *drive, uint32_t faults) {
    laconic_drive_mend(drive, faults);
}

void laconic_library_wheel_drive_hold(laconic_wheel_drive *drive, bool is_held) {
    drive->brake_Nm = is_held ? (laconic_real)LACONIC_DRIVE_HOLDS_NM : 0;
}

double laconic_library_wheel_drive_brake(const laconic_wheel_drive *drive, const void *plant, int32_t wheel,
                                         double speed_rad_per_s, double share) {
    return (double)laconic_drive_brake(drive, plant, wheel, (laconic_real)speed_rad_per_s, (laconic_real)share);
}

uint32_t laconic_library_plant_size(void) { return (uint32_t)sizeof(laconic_plant); }

void laconic_library_wheel_drive_measured(const laconic_wheel_drive *drive, laconic_library_measured *measured) {
    const laconic_library_measured numbers = {(int32_t)drive->target.mode, drive->faults,
                                              drive->encoder.count,        (double)drive->speed_rad_per_s,
                                              (double)drive->current_A,    (double)drive->torque_Nm};
    *measured = numbers;
}
