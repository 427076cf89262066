/* The vehicle as an FMU model: parameters and inputs as the importer set them, the core's plant, and outputs that are
 * computed when they are read. Plain data; its only pointer is that of the integrator to its (constant) method. */
#ifndef LACONIC_FMU_VEHICLE_MODEL_H
#define LACONIC_FMU_VEHICLE_MODEL_H

#include "laconic/laconic.h"

#define FMU_MODEL_LARGEST_ARRAY LACONIC_MAX_WHEELS
#define FMU_MODEL_MOST_STATES (6 + 2 * LACONIC_MAX_WHEELS)
#define FMU_MODEL_PORTS 0 /* bus terminals */
#define FMU_MODEL_TAKES_SLOPES true

/* 1 in an FMU whose derivatives in Co-Simulation are those of the last step (kept_step.c): sources/ has that number. */
#ifndef FMU_MODEL_KEEPS_STEPS
#define FMU_MODEL_KEEPS_STEPS 0
#endif
#if FMU_MODEL_KEEPS_STEPS
#include "laconic/derivatives.h"
#endif

/* 1 in an FMU that estimates its error (estimate_part.c): sources/ has that number. */
#ifndef FMU_MODEL_ESTIMATES
#define FMU_MODEL_ESTIMATES 0
#endif
#if FMU_MODEL_ESTIMATES
#include "laconic/estimate.h"
#define FMU_ESTIMATED_MEMBERS \
    laconic_errors estimated; \
    double estimated_unknown;
#else
#define FMU_ESTIMATED_MEMBERS
#endif

/* Number of elements of the arrays that have one for each wheel, at most FMU_MODEL_LARGEST_ARRAY. */
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.wheel_count)

/* Whether wheel speeds are continuous states: the FMU was made for ground with friction. */
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((model)->wheels_have_states)

/* Groups of variables that are computed together before one is read: bits in fmu_variable.group and fmu_model.stale. */
#define FMU_GROUP_STATE 1U  /* Model Exchange: the plant's state, computed from the continuous states */
#define FMU_GROUP_MOTION 2U /* ν, x, y, heading */
#define FMU_GROUP_ANGLES 8U
#define FMU_GROUP_VELOCITY 16U
#define FMU_GROUP_SPEEDS 32U
#define FMU_GROUP_TORQUES 64U
#define FMU_GROUP_GROUND 128U
#define FMU_GROUP_ENERGY 256U
#define FMU_GROUP_RATES 512U
#define FMU_GROUP_POSE 1024U     /* the rest of the pose: origin, wrapped heading */
#define FMU_GROUP_FRICTION 2048U /* what only vehicles with friction or limits of a drive show */
#define FMU_GROUP_ACCELERATION 4096U
#define FMU_GROUP_SENSORS 8192U /* what IMU and encoders show: samples of internal steps, which no input changes */
#define FMU_GROUP_ESTIMATE 16384U
#define FMU_GROUPS_ALL 32763U
#define FMU_GROUPS_OF_INPUT \
    (FMU_GROUP_TORQUES | FMU_GROUP_GROUND | FMU_GROUP_RATES | FMU_GROUP_FRICTION | FMU_GROUP_ACCELERATION)
#define FMU_GROUPS_OF_CONTINUOUS_STATES(model) \
    (FMU_GROUP_MOTION | FMU_GROUP_ANGLES | ((model)->wheels_have_states ? FMU_GROUP_SPEEDS : 0U))

/* The continuous states and the outputs: values as members of fmu_model, derivatives as members of fmu_tangent. */
#define FMU_MOVING_MEMBERS \
    FMU_ESTIMATED_MEMBERS \
    double nu[3], x_m, y_m, heading_rad; \
    double wheel_angle_rad[LACONIC_MAX_WHEELS]; \
    laconic_pose pose; \
    double velocity_m_per_s[2], yaw_rate_rad_per_s; \
    double wheel_speed_rad_per_s[LACONIC_MAX_WHEELS]; \
    double wheel_torque_Nm[LACONIC_MAX_WHEELS]; \
    double energy_J; \
    laconic_reactions ground; \
    double support_load_N[LACONIC_MAX_SUPPORTS]; \
    laconic_rates rates; \
    laconic_sensor_outputs sensed

/* laconic_friction_outputs with the same length of arrays in every build. */
typedef struct fmu_friction_outputs {
    double slip_along_m_per_s[LACONIC_MAX_WHEELS], slip_across_m_per_s[LACONIC_MAX_WHEELS];
    double contact_state[LACONIC_MAX_WHEELS], drive_limit[LACONIC_MAX_WHEELS], motor_current_A[LACONIC_MAX_WHEELS];
    double supply_current_A, supply_voltage_V, supply_energy_J, outer_work_J;
    double slip_loss_J, axle_loss_J, motor_loss_J, supply_loss_J, numerical_loss_J;
} fmu_friction_outputs;

/* Which derivatives the last communication step has. */
typedef enum fmu_step_kept {
    FMU_STEP_NONE,    /* there was none yet: those at the communication point */
    FMU_STEP_KEPT,    /* its own */
    FMU_STEP_SLOPED,  /* none, for the reason that kept_step.c logs, and so for the rest */
    FMU_STEP_TOUCHED, /* inputs were set within it   */
    FMU_STEP_CHANGED, /* the vehicle changed after it */
    FMU_STEP_KINDS
} fmu_step_kept;

/* What a communication step began with. */
typedef struct fmu_last_step {
    int32_t kept; /* fmu_step_kept */
    laconic_state state;
    laconic_input input;
    double step_s;  /* of an internal step                                   */
    uint64_t steps; /* internal ones: those of the plant at its start, then those that it took */
} fmu_last_step;

typedef struct fmu_model {
    bool start_needed;       /* parameters were set since the last start          */
    bool change_needed;      /* tunable parameters were set since */
    bool states_changed;     /* by an event that no event iteration has reported yet */
    bool continuous;         /* Model Exchange                                */
    bool stand_in;           /* the step is not known yet: the integrator is prepared for a method that takes any */
    bool wheels_have_states; /* by the start values of the FMU */
    bool idle_wheels;        /* some wheel has no motor       */
    bool watched;            /* `sensors` must see each internal step; else it is not set */
    double time_s;
    uint32_t stale;

    laconic_vehicle vehicle;
    laconic_start start;
    bool has_imu;
    laconic_sensor_settings sensor_settings;
    int32_t method;
    double step_s;
    laconic_input input;
    bool sloped;         /* the importer has set slopes */
    laconic_input slope; /* du/dt during the next step  */

    laconic_plant plant;
    laconic_sensors sensors;
    laconic_contact contact;
    laconic_model rolling; /* of a drive with limits on ideal ground: the vehicle without its motors */
    laconic_grip_event pending_slip, pending_lift; /* valid where fmu_instance.warnings_pending has their bit */
    double slip_s, lift_s;                         /* their times                      */

    FMU_MOVING_MEMBERS; /* in Model Exchange the plant's state follows the continuous states */
    double wheel_rate_rad_per_s2[LACONIC_MAX_WHEELS];
    fmu_friction_outputs friction;
#if FMU_MODEL_KEEPS_STEPS
    fmu_last_step last, next; /* `next` becomes `last` where it is not refused */
    bool has_jacobian;        /* of `last`                  */
    laconic_step_jacobian jacobian;
#endif
#if FMU_MODEL_ESTIMATES
    bool estimate_error;
    bool estimate_begun; /* the step is known, and `estimate` set */
    int32_t estimate_window_steps;
    laconic_estimate estimate;
#endif
} fmu_model;

/* What steps change. */
typedef struct fmu_model_motion {
    laconic_state state;
    laconic_slip slip;       /* of a vehicle with friction */
    laconic_sensors sensors; /* where they watch     */
    uint64_t steps;
    laconic_input input;
#if FMU_MODEL_ESTIMATES
    laconic_estimate estimate;
#endif
} fmu_model_motion;

/* Derivatives of states, inputs and outputs along one direction. */
typedef struct fmu_tangent {
    laconic_input input;
    FMU_MOVING_MEMBERS;
} fmu_tangent;

/* The loads of supports, or their derivatives, which follow those of wheels in `ground`; 0 for supports that are not
 * there. The description has them as an array of their own. */
void fmu_model_part_loads(double support_load_N[LACONIC_MAX_SUPPORTS], const laconic_reactions *ground,
                          const laconic_vehicle *vehicle);

#endif
