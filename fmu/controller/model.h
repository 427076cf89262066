/* A PI controller for wheel speeds, one loop per wheel: the second FMU model behind the same glue.
 *
 *     u = K_p e + K_i I, limited to ±limit;   I' = e, or 0 while u is limited and e would drive it further beyond */
#ifndef LACONIC_FMU_CONTROLLER_MODEL_H
#define LACONIC_FMU_CONTROLLER_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FMU_MODEL_LARGEST_ARRAY 16
#define FMU_MODEL_MOST_STATES FMU_MODEL_LARGEST_ARRAY
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)
#define FMU_MODEL_PORTS 0 /* bus terminals */
#define FMU_MODEL_TAKES_SLOPES false
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->wheel_count)
#define FMU_GROUP_STATE_READ 1U /* nothing to compute, but not readable before initialization */
#define FMU_GROUP_VOLTAGE 2U
#define FMU_GROUP_RATES 4U
#define FMU_GROUPS_ALL 6U

typedef struct fmu_model {
    bool start_needed, change_needed, states_changed;
    double time_s;
    uint32_t stale;
    int32_t wheel_count;
    double proportional_Vs_per_rad, integral_V_per_rad, limit_V;
    double setpoint_rad_per_s[FMU_MODEL_LARGEST_ARRAY];
    double speed_rad_per_s[FMU_MODEL_LARGEST_ARRAY];
    double error_rad[FMU_MODEL_LARGEST_ARRAY];            /* I, the state */
    double error_rate_rad_per_s[FMU_MODEL_LARGEST_ARRAY]; /* I'           */
    double voltage_V[FMU_MODEL_LARGEST_ARRAY];
    double step_s;
} fmu_model;

typedef struct fmu_model_motion {
    double none;
} fmu_model_motion;

typedef struct fmu_tangent {
    double setpoint_rad_per_s[FMU_MODEL_LARGEST_ARRAY];
    double speed_rad_per_s[FMU_MODEL_LARGEST_ARRAY];
    double error_rad[FMU_MODEL_LARGEST_ARRAY];
    double error_rate_rad_per_s[FMU_MODEL_LARGEST_ARRAY];
    double voltage_V[FMU_MODEL_LARGEST_ARRAY];
} fmu_tangent;

#endif
