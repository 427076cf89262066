/* The vehicle as the glue sees it: parameters and inputs as the importer set them, the core's plant, and outputs that
 * are computed when they are asked for. Plain data; only the integrator points to its (constant) method. */
#ifndef LACONIC_FMU_VEHICLE_MODEL_H
#define LACONIC_FMU_VEHICLE_MODEL_H

#include "laconic/laconic.h"

#define FMU_MODEL_LARGEST_ARRAY LACONIC_MAX_WHEELS
#define FMU_MODEL_TAKES_SLOPES true

/* Elements of the arrays whose size wheel_count says; it is never set beyond FMU_MODEL_LARGEST_ARRAY. */
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.wheel_count)

/* What must be fresh before a variable is read: bits in fmu_variable.group and fmu_model.stale. */
#define FMU_GROUP_STATE 1U  /* Model Exchange: the core's state follows the continuous states */
#define FMU_GROUP_MOTION 2U /* ν, x, y, heading */
#define FMU_GROUP_ANGLES 8U
#define FMU_GROUP_VELOCITY 16U
#define FMU_GROUP_SPEEDS 32U
#define FMU_GROUP_TORQUES 64U
#define FMU_GROUP_GROUND 128U
#define FMU_GROUP_ENERGY 256U
#define FMU_GROUP_RATES 512U
#define FMU_GROUP_POSE 1024U /* what else the pose says: origin, wrapped heading */
#define FMU_GROUPS_ALL 2043U
#define FMU_GROUPS_OF_INPUT (FMU_GROUP_TORQUES | FMU_GROUP_GROUND | FMU_GROUP_RATES)
#define FMU_GROUPS_OF_CONTINUOUS_STATES (FMU_GROUP_MOTION | FMU_GROUP_ANGLES)

typedef struct fmu_model {
    bool start_needed;   /* parameters were set since the last start          */
    bool change_needed;  /* tunable ones were set since                       */
    bool states_changed; /* by an event, and the importer was not told yet   */
    bool continuous;     /* Model Exchange                                */
    bool stand_in;       /* no step is known yet: the integrator is prepared for another method */
    double time_s;
    uint32_t stale;

    laconic_vehicle vehicle;
    laconic_start start;
    int32_t method;
    double step_s;
    laconic_input input;
    bool sloped;         /* some input's slope is not 0 */
    laconic_input slope; /* du/dt during the next step  */

    laconic_plant plant;
    laconic_contact contact;
    laconic_grip_event pending_slip, pending_lift; /* where fmu_instance.warnings_pending says so */
    double slip_s, lift_s;                         /* their times                      */

    double nu[3]; /* the continuous states; in Model Exchange the core's state follows them */
    double x_m, y_m, heading_rad;
    double wheel_angle_rad[LACONIC_MAX_WHEELS];

    laconic_pose pose;
    double velocity_m_per_s[2], yaw_rate_rad_per_s;
    double wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    double wheel_torque_Nm[LACONIC_MAX_WHEELS];
    double energy_J;
    laconic_reactions ground;
    laconic_rates rates;
} fmu_model;

/* What steps change. */
typedef struct fmu_model_motion {
    laconic_state state;
    uint64_t steps;
    laconic_input input;
} fmu_model_motion;

/* A direction in the space of states, inputs and outputs. */
typedef struct fmu_tangent {
    double nu[3], x_m, y_m, heading_rad, wheel_angle_rad[LACONIC_MAX_WHEELS];
    laconic_input input;
    laconic_rates rates;
    laconic_pose pose;
    double velocity_m_per_s[2], yaw_rate_rad_per_s;
    double wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    double wheel_torque_Nm[LACONIC_MAX_WHEELS];
    double energy_J;
    laconic_reactions ground;
} fmu_tangent;

#endif
