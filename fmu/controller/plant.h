/* A PI controller for wheel speeds, one loop per wheel: the second FMU of the same glue.
 *
 *     u = K_p e + K_i I, limited to ±limit;   I' = e, or 0 while u is limited and e would drive it further */
#ifndef LACONIC_FMU_CONTROLLER_PLANT_H
#define LACONIC_FMU_CONTROLLER_PLANT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMU_PLANT_LARGEST_ARRAY 16
#define FMU_PLANT_TAKES_SLOPES false
#define FMU_PLANT_ARRAY_SIZE(plant) ((uint32_t)(plant)->wheel_count)
#define FMU_GROUP_STATE_READ 1U /* nothing to compute; read only once initialization has begun */
#define FMU_GROUP_VOLTAGE 2U
#define FMU_GROUP_RATES 4U
#define FMU_GROUPS_ALL 6U

typedef struct fmu_plant {
    bool start_needed, change_needed, states_changed;
    double time_s;
    uint32_t stale;
    int32_t wheel_count;
    double proportional_Vs_per_rad, integral_V_per_rad, limit_V;
    double setpoint_rad_per_s[FMU_PLANT_LARGEST_ARRAY];
    double speed_rad_per_s[FMU_PLANT_LARGEST_ARRAY];
    double error_rad[FMU_PLANT_LARGEST_ARRAY];            /* I, the state */
    double error_rate_rad_per_s[FMU_PLANT_LARGEST_ARRAY]; /* I'           */
    double voltage_V[FMU_PLANT_LARGEST_ARRAY];
    double step_s;
} fmu_plant;

typedef struct fmu_plant_motion {
    double error_rad[FMU_PLANT_LARGEST_ARRAY];
} fmu_plant_motion;

typedef struct fmu_tangent {
    double setpoint_rad_per_s[FMU_PLANT_LARGEST_ARRAY];
    double speed_rad_per_s[FMU_PLANT_LARGEST_ARRAY];
    double error_rad[FMU_PLANT_LARGEST_ARRAY];
    double error_rate_rad_per_s[FMU_PLANT_LARGEST_ARRAY];
    double voltage_V[FMU_PLANT_LARGEST_ARRAY];
} fmu_tangent;

#endif
