/* Drives without a node, for Python: a map of a DBC's signals asks of them what else a protocol would. */
#ifndef LACONIC_NODE_LIBRARY_DRIVES_H
#define LACONIC_NODE_LIBRARY_DRIVES_H

#include <stdbool.h>
#include <stdint.h>

struct laconic_wheel_drive;

/* The members of laconic_drive_settings, whatever the scalar type of the library. */
typedef struct laconic_library_drive_settings {
    int32_t node_id, encoder_counts;
    double gear_ratio, torque_constant_Nm_per_A, back_emf_Vs_per_rad, current_limit_A, speed_limit_rad_per_s, supply_V;
    double winding_resistance_ohm, current_bandwidth_rad_per_s, position_gain_per_s, speed_gain_As;
    double speed_integral_gain_A, stall_time_s;
} laconic_library_drive_settings;

/* Bytes of a drive, in memory that the caller provides, aligned to 8 bytes. */
uint32_t laconic_library_wheel_drive_size(void);
/* The functions of laconic_drives/drive.h again, with doubles. */
void laconic_library_wheel_drive_start(struct laconic_wheel_drive *drive,
                                       const laconic_library_drive_settings *settings);
void laconic_library_wheel_drive_aim(struct laconic_wheel_drive *drive, int32_t mode, int64_t count, double rest,
                                     double speed_rad_per_s, double current_A);
double laconic_library_wheel_drive_act(struct laconic_wheel_drive *drive, double step_s);
void laconic_library_wheel_drive_measure(struct laconic_wheel_drive *drive, double turned_rad, double speed_rad_per_s);
void laconic_library_wheel_drive_clear(struct laconic_wheel_drive *drive);
void laconic_library_wheel_drive_break(struct laconic_wheel_drive *drive, uint32_t faults);
void laconic_library_wheel_drive_mend(struct laconic_wheel_drive *drive, uint32_t faults);
/* A brake holds the wheel from now on, or lets it go. */
void laconic_library_wheel_drive_hold(struct laconic_wheel_drive *drive, bool is_held);
/* As laconic_drive_brake(); `plant`: a laconic_plant of the library of the core with the same scalar type, which has
 * laconic_library_plant_size() bytes there, too. */
double laconic_library_wheel_drive_brake(const struct laconic_wheel_drive *drive, const void *plant, int32_t wheel,
                                         double speed_rad_per_s, double share);
uint32_t laconic_library_plant_size(void);

/* What a drive measured at the end of the last step. */
typedef struct laconic_library_measured {
    int32_t mode; /* laconic_drive_mode of the target */
    uint32_t faults;
    int64_t count;
    double speed_rad_per_s, current_A, torque_Nm;
} laconic_library_measured;

void laconic_library_wheel_drive_measured(const struct laconic_wheel_drive *drive, laconic_library_measured *measured);

#endif
