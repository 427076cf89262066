/* A vehicle with hinges as an FMU model: parameters and inputs as the importer set them, the core's articulated
 * vehicle, and outputs that are computed when they are read. Plain data. */
#ifndef LACONIC_FMU_ARTICULATED_MODEL_H
#define LACONIC_FMU_ARTICULATED_MODEL_H

#include "laconic/articulated.h"

#if LACONIC_MAX_BODIES < 1
#error "LACONIC_MAX_BODIES is 0: this FMU needs the core with bodies on hinges"
#endif

#define FMU_MODEL_SLIPS 0 /* slipping/model.h is the other */
#define FMU_MODEL_LARGEST_ARRAY LACONIC_MAX_WHEELS
#define FMU_MODEL_OTHER_LARGEST_ARRAY LACONIC_MAX_BODIES
#define FMU_MODEL_MOST_STATES (6 + 2 * LACONIC_MAX_BODIES + LACONIC_MAX_WHEELS)
#define FMU_MODEL_PORTS 0 /* bus terminals */
#define FMU_MODEL_TAKES_SLOPES true
#define FMU_MODEL_SLICE_STEPS 256U /* between two looks at whether the importer cancels: well below a second */
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)

/* Arrays have one element for each wheel, or one for each body on a hinge. */
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.base.wheel_count)
#define FMU_MODEL_OTHER_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.body_count)

/* Groups of variables that are computed together before one is read: bits in fmu_variable.group and fmu_model.stale. */
#define FMU_GROUP_STATE 1U  /* Model Exchange: the core's state, computed from the continuous states */
#define FMU_GROUP_PLACE 2U  /* the continuous states */
#define FMU_GROUP_MOTION 4U /* what else follows from the state alone */
#define FMU_GROUP_GROUND 8U
#define FMU_GROUP_RATES 16U
#define FMU_GROUPS_ALL 31U
#define FMU_GROUPS_OF_STATE (FMU_GROUPS_ALL & ~FMU_GROUP_STATE) /* stale when the core's state changed */
#define FMU_GROUPS_OF_INPUT (FMU_GROUP_GROUND | FMU_GROUP_RATES)

/* The continuous states, or their derivatives. */
typedef struct fmu_moving {
    double x_m, y_m, heading_rad;
    double hinge_rad[LACONIC_MAX_BODIES];
    double wheel_angle_rad[LACONIC_MAX_WHEELS];
    double zeta[3];                 /* η of the carriage                                    */
    double own[LACONIC_MAX_BODIES]; /* η of each own hinge; 0 of the others                 */
} fmu_moving;

typedef laconic_articulated_input fmu_hinged_input;

typedef struct fmu_model {
    bool start_needed;   /* parameters were set since the last start          */
    bool change_needed;  /* tunable parameters were set since, or commands in event mode */
    bool states_changed; /* by an event that no event iteration has reported yet */
    bool continuous;     /* Model Exchange                                */
    bool jump_needed;    /* Model Exchange: commands were set in event mode */
    double time_s;
    uint32_t stale;

    laconic_articulated_vehicle vehicle;
    bool hinge_is_ball[LACONIC_MAX_BODIES];
    laconic_articulated_start start;
    int32_t method;
    double step_s;
    laconic_articulated_input input;
    laconic_articulated_input slope; /* du/dt during the next step; FMI 2 */

    laconic_articulated_vehicle in_use; /* what `prepared` was prepared from */
    laconic_articulated_model prepared;
    laconic_articulated_integrator integrator;
    laconic_articulated_state state;
    laconic_articulated_input commanded; /* Model Exchange: the input by which `state` was last computed */

    fmu_moving at, rate; /* in Model Exchange the core's state follows `at` */
    laconic_articulated_motion motion;
    double heading_wrapped_rad, origin_m[2];
    laconic_articulated_reactions ground;
    double hinge_force_along_N[LACONIC_MAX_BODIES], hinge_force_across_N[LACONIC_MAX_BODIES];
    double wheel_load_N[LACONIC_MAX_WHEELS], support_load_N[LACONIC_MAX_SUPPORTS];
} fmu_model;

/* What steps change. */
typedef struct fmu_model_motion {
    laconic_articulated_state state;
    laconic_articulated_input input, slope;
} fmu_model_motion;

/* Such a vehicle has no partial derivatives; the offsets of its inputs name them for slopes. */
typedef struct fmu_tangent {
    laconic_articulated_input input;
} fmu_tangent;

#endif
