/* A mecanum vehicle and a plan of its drives, for tests of drives on wheels. */
#ifndef DRIVE_SCENE_H
#define DRIVE_SCENE_H

#include "laconic_drives/drives.h"

#include <string.h>

#define REAL(number) ((laconic_real)(number))
#define SCENE_STEP_S REAL(0.001)

/* 20 kg on four mecanum wheels of 5 cm, without a motor of its own; `friction`: of the ground, 0: ideal. */
static inline laconic_vehicle scene_vehicle(laconic_real friction) {
    static const laconic_real sign[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    laconic_vehicle vehicle = {.mass_kg = 20, .yaw_inertia_kgm2 = 1, .wheel_radius_m = REAL(0.05)};
    vehicle.wheel_inertia_kgm2 = REAL(0.01);
    vehicle.com_z_m = REAL(0.1);
    vehicle.ground.friction_coefficient = friction;
    vehicle.wheel_count = 4;
    for (int i = 0; i < 4; i++) {
        vehicle.wheel[i].kind = LACONIC_WHEEL_ROLLER;
        vehicle.wheel[i].x_m = REAL(0.2) * sign[i][0];
        vehicle.wheel[i].y_m = REAL(0.15) * sign[i][1];
        vehicle.wheel[i].axle_rad = REAL(-1.57079632679489661923);
        vehicle.wheel[i].roller_rad = REAL(0.78539816339744830962) * sign[i][2];
    }
    return vehicle;
}

/* Drives 1 to 4 on wheels 1 to 4; 1 A makes 0.3 N m at the wheel. */
static inline laconic_drive_plan scene_plan(int32_t protocol) {
    const laconic_drive_settings settings = {.encoder_counts = 8192,
                                             .gear_ratio = 20,
                                             .torque_constant_Nm_per_A = REAL(0.015),
                                             .current_limit_A = 20,
                                             .position_gain_per_s = 5,
                                             .speed_gain_As = REAL(0.05),
                                             .speed_integral_gain_A = REAL(0.3)};
    laconic_drive_plan plan;
    laconic_drive_plan_begin(&plan);
    plan.protocol = protocol;
    for (int i = 0; i < 4; i++) {
        plan.drive[i] = settings;
        plan.drive[i].node_id = i + 1;
    }
    return plan;
}

/* The plant of that vehicle at rest. */
static inline void scene_plant(laconic_plant *plant, const laconic_vehicle *vehicle) {
    laconic_start start;
    memset(&start, 0, sizeof start);
    laconic_plant_start(plant, vehicle, &laconic_auto, SCENE_STEP_S, &start, NULL);
}

#endif
