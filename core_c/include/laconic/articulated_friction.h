/* Articulated vehicles on ground with friction: steered wheels that scrub, swerve modules that disagree, casters that
 * flip, trailers that jackknife. "Tree" names such a vehicle here: bodies on hinges, as in articulated.h, whose wheels
 * may slip.
 *
 *     vehicle  --prepare-->  model  --step-->  state  -->  outputs
 *      (SI)                (constants)   ^
 *                                 input, held over a step
 *
 * Memory, threads, errors, bits, frames  as in articulated.h. The position of a state is that of S_0, the centre of
 * mass of body 0 with its payload; velocities of S_0 are in the axes of body 0.
 *
 * Model    unknowns are z = (velocity of S_0, yaw rate, ψ'_1 … ψ'_H) and the wheels' speeds s. A step minimises
 *
 *     ½(z − z*)ᵀM(z − z*) + Σ ½ J (s − s*)² + h Φ(z, s),    Φ = Σ μN √(slip_u² + k² slip_w²) + motors, axles, hinges
 *
 *          at the angles ψ^ = ψ + ½ h ψ'. M is the mass matrix of the tree there. z* is the projection of all bodies'
 *          velocities, unchanged in the world, onto the hinges at their new places. Springs and stops act at the ψ^ of
 *          the next step, so the energy of motion and springs never grows by itself.
 * Hinges   each has viscous damping, dry friction, a spring, two stops, and one of: nothing, a servo (torque), a motor
 *          (voltage) or a prescribed rate. A hinge cannot be coordinated: give its servo the angle.
 * Loads    by statics at each step, with the wheels where they are and the ground's forces of the step before. A hinge
 *          carries pitch and roll (a caster's fork, a swerve module), or as a hitch only a force (a trailer). A hitch's
 *          horizontal force counts as acting at the height of the trailer's centre of mass.
 * Memory   a step needs some 28 kB of stack in double with the default bounds of real.h.
 * Order    1: halving the step halves the error. Rolling casters need h v/trail < 2.
 * Cost     of a step of 1 ms over that of a rigid vehicle with as many wheels: test_articulated_cost.py. */
#ifndef LACONIC_ARTICULATED_FRICTION_H
#define LACONIC_ARTICULATED_FRICTION_H

#include "laconic/articulated.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------------------- vehicle -- */

/* A body and its hinge on ground with friction, in addition to laconic_body. All zero: a pivot that carries pitch,
 * without dry friction, stops and control. */
typedef struct laconic_tree_hinge {
    laconic_real com_z_m;         /* height of the body's centre of mass; for normal loads only                */
    bool hitch;                   /* the hinge carries no pitch and roll: a trailer                            */
    laconic_real dry_friction_Nm; /* least torque that turns the hinge                                         */
    laconic_real stop_low_rad, stop_high_rad; /* the angle stays between them; both 0: no stops                */

    /* A servo on a free hinge: torque = gain (angle − ψ) + damping (rate − ψ'), cut to the limit. */
    laconic_real servo_gain_Nm_per_rad, servo_damping_Nms;
    laconic_real servo_limit_Nm; /* 0: none */

    /* A motor hinge: torque = gain_Nm_per_V · voltage − damping_Nms · ψ' of laconic_body. Supply as of the wheels. */
    laconic_real viscous_friction_Nms;   /* the part of damping_Nms that is not back-EMF                       */
    laconic_real winding_resistance_ohm; /* R_a; 0: the electrical side is not known                           */
    laconic_real current_limit_A;        /* 0: none; needs the resistance                                      */
    laconic_real loop_V_per_rad, loop_Vs_per_rad; /* a loop adds them times (angle − ψ), (rate − ψ') to the voltage;
                                                     the first 0: a speed loop                                 */
    laconic_real control_period_s; /* at which servo or loop looks at ψ and ψ', holding its torque or voltage between;
                                      0: a servo acts continuously, a loop looks at each step                  */
} laconic_tree_hinge;

/* A wheel, in addition to laconic_wheel. All zero: load by statics, no scrub. */
typedef struct laconic_tree_wheel {
    laconic_real load_N;         /* a measured normal load, which stays; of all wheels or of none              */
    laconic_real scrub_radius_m; /* a: a standing wheel resists turning about the vertical with μN a           */
    laconic_real scrub_fade_m;   /* ρ_s: a rolling one with μN a · min(1, ρ_s/radius of its path); 0: as standing.
                                    A rim slower than 1 µm/s counts as standing */
    laconic_real creep; /* of a tyre: slip over rolled way at which its force reaches μN; below it force and slip
                                    are in proportion, so that its cornering stiffness is μN/creep; 0: none     */
} laconic_tree_wheel;

/* Start from all zero. `hinged.base.ground.friction_coefficient` must be above 0; `hinged.base.drive` holds for the
 * wheels' motors, its supply for motors of hinges also. Hinge b is item b − 1. */
typedef struct laconic_tree_vehicle {
    laconic_articulated_vehicle hinged;
    laconic_tree_hinge hinge[LACONIC_MAX_BODIES];
    laconic_tree_wheel wheel[LACONIC_MAX_WHEELS];
} laconic_tree_vehicle;

/* Rows as in vehicle.h and articulated.h. */
/* clang-format off */
#define LACONIC_TREE_HINGE_FIELDS(X, of) \
    X(of, 121, BODY_COM_Z,            com_z_m,                body_com_z_m,                REAL, NOT_NEGATIVE, NEVER) \
    X(of, 122, HINGE_HITCH,           hitch,                  hinge_hitch,                 FLAG, UNCHECKED,    NEVER) \
    X(of, 123, HINGE_DRY_FRICTION,    dry_friction_Nm,        hinge_dry_friction_Nm,       REAL, NOT_NEGATIVE, NEVER) \
    X(of, 124, HINGE_STOP_LOW,        stop_low_rad,           hinge_stop_low_rad,          REAL, ANGLE,        NEVER) \
    X(of, 125, HINGE_STOP_HIGH,       stop_high_rad,          hinge_stop_high_rad,         REAL, ANGLE,        NEVER) \
    X(of, 126, SERVO_GAIN,            servo_gain_Nm_per_rad,  servo_gain_Nm_per_rad,       REAL, NOT_NEGATIVE, NEVER) \
    X(of, 127, SERVO_DAMPING,         servo_damping_Nms,      servo_damping_Nms,           REAL, NOT_NEGATIVE, NEVER) \
    X(of, 128, SERVO_LIMIT,           servo_limit_Nm,         servo_limit_Nm,              REAL, NOT_NEGATIVE, NEVER) \
    X(of, 129, HINGE_VISCOUS_FRICTION,viscous_friction_Nms,   hinge_viscous_friction_Nms,  REAL, NOT_NEGATIVE, NEVER) \
    X(of, 130, HINGE_RESISTANCE,      winding_resistance_ohm, hinge_winding_resistance_ohm, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 131, HINGE_CURRENT_LIMIT,   current_limit_A,        hinge_current_limit_A,       REAL, NOT_NEGATIVE, NEVER) \
    X(of, 132, LOOP_ANGLE_GAIN,       loop_V_per_rad,         loop_V_per_rad,              REAL, FINITE,       NEVER) \
    X(of, 133, LOOP_RATE_GAIN,        loop_Vs_per_rad,        loop_Vs_per_rad,             REAL, FINITE,       NEVER) \
    X(of, 134, CONTROL_PERIOD,        control_period_s,       control_period_s,            REAL, NOT_NEGATIVE, NEVER)

#define LACONIC_TREE_WHEEL_FIELDS(X, of) \
    X(of, 135, WHEEL_LOAD,            load_N,                 given_load_N,                REAL, NOT_NEGATIVE, NEVER) \
    X(of, 136, SCRUB_RADIUS,          scrub_radius_m,         scrub_radius_m,              REAL, NOT_NEGATIVE, NEVER) \
    X(of, 137, SCRUB_FADE,            scrub_fade_m,           scrub_fade_m,                REAL, NOT_NEGATIVE, NEVER) \
    X(of, 139,CREEP, creep, wheel_creep, REAL,NOT_NEGATIVE, NEVER)

/* The array of laconic_tree_input that laconic_articulated_input has not; the step checks it. */
#define LACONIC_TREE_INPUT_FIELDS(X, of) \
    X(of, 138, HINGE_ANGLE,           hinge_angle_rad,        steering_angle_rad,          REAL, FINITE,       NEVER)

#define LACONIC_TREE_FIELDS(X) \
    LACONIC_TREE_HINGE_FIELDS(X, TREE_HINGE) LACONIC_TREE_WHEEL_FIELDS(X, TREE_WHEEL) \
    LACONIC_TREE_INPUT_FIELDS(X, TREE_INPUT)
/* clang-format on */

#define LACONIC_TREE_FIELD_NUMBER(of, number, IDENTIFIER, ...) LACONIC_FIELD_OF_##IDENTIFIER = number,

/* Numbers of a refusal's field that laconic_articulated_field does not have. The item: number of the body or wheel. */
typedef enum laconic_tree_field {
    LACONIC_TREE_FIELDS(LACONIC_TREE_FIELD_NUMBER) LACONIC_TREE_FIELD_COUNT = 140
} laconic_tree_field;

/* ---------------------------------------------------------------------------------- model -- */

#define LACONIC_TREE_SPEEDS (3 + LACONIC_MAX_BODIES)                    /* of z             */
#define LACONIC_TREE_AXES (LACONIC_MAX_WHEELS + LACONIC_MAX_BODIES)     /* with a motor     */
#define LACONIC_TREE_POINTS (LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS) /* with normal loads */

/* Prepared constants of one body; of body 0 the hinge is at S_0. */
typedef struct laconic_tree_body {
    int32_t parent, group;            /* group: the lowest body to which hinges fix it against pitch            */
    int32_t depth;                    /* number of hinges from body 0                                           */
    int32_t path[LACONIC_MAX_BODIES]; /* these hinges from 0, the body's own last                               */
    laconic_hinge_kind hinge;
    laconic_real hinge_x_m, hinge_y_m; /* from the parent's hinge, parent's axes                                 */
    laconic_real com_x_m, com_y_m;     /* from the hinge, own axes                                               */
    laconic_real mass_kg, yaw_inertia_kgm2;
    laconic_real com_z_m;      /* of a group's lowest body: of the whole group                           */
    laconic_real padding_kgm2; /* of a prescribed hinge without inertia: keeps M regular, nothing else   */
    laconic_real damping_Nms;  /* viscous, without back-EMF                                              */
    laconic_real stiffness_Nm, rest_rad, dry_friction_Nm, stop_low_rad, stop_high_rad;
    laconic_real servo_gain_Nm_per_rad, servo_damping_Nms, servo_limit_Nm;
    laconic_real loop_V_per_rad, loop_Vs_per_rad, control_period_s;
    bool hitch, stops, servo, sampled; /* sampled: servo or loop holds what it set                               */
} laconic_tree_body;

/* Prepared constants of one wheel. */
typedef struct laconic_tree_rim {
    int32_t body;
    bool locked;
    laconic_real x_m, y_m;             /* from the body's hinge, its axes                                    */
    laconic_real pull[2];              /* u, axes of the body                                                */
    laconic_real rim[2];               /* R sin γ, k R cos γ                                                 */
    laconic_real arm_across_m;         /* R cos γ                                                            */
    laconic_real rolling[2], rim_size; /* rim[] as direction and length                                      */
    laconic_real radius_m, drag, inertia_kgm2, friction_coefficient, dry_Nm, load_N, scrub_radius_m, scrub_fade_m,
        creep;
} laconic_tree_rim;

/* A motor on a wheel's axle, or behind them on a hinge. */
typedef struct laconic_tree_motor {
    int32_t circuit; /* laconic_motor_circuit                                              */
    bool acts;       /* there is a motor, or viscous friction                              */
    laconic_real gain_Nm_per_V, back_emf_Nms, viscous_Nms, torque_limit_Nm; /* LACONIC_REAL_MAX: no limit    */
    laconic_real ampere_per_Nm; /* 0 where R_a is not known                                           */
} laconic_tree_motor;

/* Prepared constants; read them, do not write them. */
typedef struct laconic_tree_model {
    int32_t body_count, wheel_count, point_count;
    laconic_tree_body body[LACONIC_MAX_BODIES + 1];
    laconic_tree_rim wheel[LACONIC_MAX_WHEELS];
    laconic_tree_motor motor[LACONIC_TREE_AXES]; /* of wheel i, then of hinge b at wheel_count + b − 1       */
    laconic_real support_m[LACONIC_MAX_SUPPORTS][2];
    bool star; /* every hinge is on body 0                                  */
    bool loads_given, sloped, controlled;
    laconic_real gravity_m_per_s2; /* across the ground                                         */
    laconic_real pull_m_per_s2[2]; /* of the slope, world axes                                  */
    laconic_real supply_V, supply_resistance_ohm;
    laconic_real mass_kg, com_x_m, com_y_m; /* all bodies; S_0 in the body frame                         */
} laconic_tree_model;

/* Checks the vehicle and fills the model. Refuses as laconic_vehicle_check does, the numbers of bodies as
 * laconic_articulated_prepare does, and
 *   NOT_POSITIVE         no ground.friction_coefficient; a fade without scrub; a limit without winding resistance; the
 *                        load of one wheel where others have one
 *   COORDINATED_SLIPS    a coordinated hinge
 *   NO_EFFECT_ON_HINGE   a servo on a motor or prescribed hinge, a loop on one without motor, stops of a prescribed one
 *   ABOVE_LIMIT          stop_low_rad above stop_high_rad
 *   MASSLESS_HINGE       the body has no inertia about its hinge, which is not prescribed
 *   OVERFLOW             a constant leaves the range */
laconic_status laconic_tree_prepare(laconic_tree_model *model, const laconic_tree_vehicle *vehicle,
                                    laconic_refusal *why);

/* ---------------------------------------------------------------------------------- input -- */

/* Forces and commands over a step. All zero: motors with 0 V, servos that hold ψ = 0, prescribed hinges held. */
typedef struct laconic_tree_input {
    laconic_articulated_input hinged; /* voltages, torques and forces as there; hinge_rate: of prescribed hinges, and
                                         the target rate of servos and loops. Accelerations and twist: not read  */
    laconic_real hinge_angle_rad[LACONIC_MAX_BODIES]; /* target of servos and loops                              */
} laconic_tree_input;

/* ---------------------------------------------------------------------------------- state -- */

/* All that a motion consists of, and what its last step found. Copy it to save the motion. */
typedef struct laconic_tree_state {
    laconic_sum x_m, y_m;
    laconic_heading heading;
    laconic_heading hinge[LACONIC_MAX_BODIES];
    laconic_real z[LACONIC_TREE_SPEEDS];
    laconic_vector body[LACONIC_MAX_BODIES + 1]; /* velocity of each centre of mass and yaw rate, axes of body 0 at the
                                                    last step's ψ^ */
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_sum wheel_angle_rad[LACONIC_MAX_WHEELS];

    /* Forces of the last step by their laws, of the robot on ground and hinges: the next step's first guess. */
    laconic_real grip_N[LACONIC_MAX_WHEELS][2]; /* along u, and along w over k                                */
    laconic_real scrub_Nm[LACONIC_MAX_WHEELS];
    laconic_real dry_Nm[LACONIC_MAX_BODIES], stop_Nm[LACONIC_MAX_BODIES][2]; /* against the body; high, low    */
    laconic_real drive_Nm[LACONIC_MAX_BODIES];        /* of a servo or motor with limit, or of a prescribed rate */
    laconic_real normal_N[LACONIC_TREE_POINTS];       /* below 0: the point has lifted and carried nothing       */
    laconic_real control_command[LACONIC_MAX_BODIES]; /* sampled torque of a servo, voltage of a loop            */
    int32_t control_wait[LACONIC_MAX_BODIES];         /* steps until it looks again                              */

    laconic_real motor_torque_Nm[LACONIC_TREE_AXES], current_A[LACONIC_TREE_AXES];
    int32_t limit[LACONIC_TREE_AXES]; /* laconic_drive_limit */
    laconic_real supply_current_A, supply_voltage_V;
    int32_t passes;               /* of the solver in the last step                                         */
    laconic_real spring_energy_J; /* at ψ^ of the next step                                                 */
    laconic_sum supply_energy_J;  /* drawn from the supply, since the start                                 */
    laconic_sum outer_work_J;     /* of outer forces, torques and the slope                                 */
    laconic_sum servo_work_J;     /* of servos and prescribed rates                                         */
    laconic_sum slip_loss_J, scrub_loss_J, axle_loss_J, hinge_loss_J, stop_loss_J, motor_loss_J, supply_loss_J;
    laconic_sum numerical_loss_J; /* dissipation of the first-order step */
} laconic_tree_state;

typedef struct laconic_tree_start {
    laconic_articulated_start hinged;                       /* every hinge rate is read */
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS]; /* all 0: as the wheels roll at this velocity */
    bool wheels_stand;                                      /* true: 0 is 0                               */
} laconic_tree_start;

/* Refuses NOT_FINITE, OVERFLOW; ABOVE_LIMIT, BELOW_LIMIT where an angle lies beyond its stop. */
laconic_status laconic_tree_state_set(laconic_tree_state *state, const laconic_tree_model *model,
                                      const laconic_tree_start *start, laconic_refusal *why);

/* ---------------------------------------------------------------------------------- steps -- */

/* One step under the held input. Nothing corresponds to laconic_step_sampled(). At first order an input from the middle
 * of the step is as accurate. A step that its solver refuses is taken in 2, 4 or 8 parts first. Refuses, with the state
 * as it was:
 *   NOT_FINITE, NOT_POSITIVE  a number of the input, or the step
 *   STEP_DOES_NOT_FIT         a control_period_s is not a whole number of steps
 *   STEP_UNSOLVED             no contact forces found
 *   OVERFLOW                  a result leaves the range */
laconic_status laconic_tree_step(const laconic_tree_model *model, laconic_real step_s, laconic_tree_state *state,
                                 const laconic_tree_input *held, laconic_refusal *why);

/* -------------------------------------------------------------------------------- outputs -- */

/* Motion as in articulated.h, then what ground and hinges did in the last step. The books close:
 *     energy + spring energy now − at the start = supply energy + outer and servo work − all losses. */
typedef struct laconic_tree_outputs {
    laconic_articulated_motion motion;
    laconic_real slip_along_m_per_s[LACONIC_MAX_WHEELS],
        slip_across_m_per_s[LACONIC_MAX_WHEELS]; /* along u, along w  */
    int32_t contact_state[LACONIC_MAX_WHEELS];   /* 0 sticks or rolls, 1 slips, 2 has lifted                  */
    laconic_real along_N[LACONIC_MAX_WHEELS],
        lateral_N[LACONIC_MAX_WHEELS];          /* of the ground on the wheel: along u, against w (to the right), as in
                                          laconic_reactions. Slip takes −along slip_along + lateral slip_across */
    laconic_real scrub_Nm[LACONIC_MAX_WHEELS];  /* the same, about the vertical                              */
    laconic_real normal_N[LACONIC_TREE_POINTS]; /* wheels, then supports                                     */
    laconic_real wheel_torque_Nm[LACONIC_MAX_WHEELS];    /* of the motor on the axle                             */
    laconic_real hinge_torque_Nm[LACONIC_MAX_BODIES];    /* of servo, motor or prescribed rate on the body       */
    laconic_real friction_torque_Nm[LACONIC_MAX_BODIES]; /* dry friction of the hinge                         */
    laconic_real stop_torque_Nm[LACONIC_MAX_BODIES];
    laconic_real motor_current_A[LACONIC_TREE_AXES]; /* wheels, then hinges                                  */
    int32_t drive_limit[LACONIC_TREE_AXES];          /* laconic_drive_limit                                  */
    laconic_real supply_current_A, supply_voltage_V;
    laconic_real spring_energy_J, supply_energy_J, outer_work_J, servo_work_J;
    laconic_real slip_loss_J, scrub_loss_J, axle_loss_J, hinge_loss_J, stop_loss_J, motor_loss_J, supply_loss_J;
    laconic_real numerical_loss_J;
} laconic_tree_outputs;

/* The motion alone. */
void laconic_tree_motion_of(laconic_articulated_motion *motion, const laconic_tree_model *model,
                            const laconic_tree_state *state);

void laconic_tree_outputs_of(laconic_tree_outputs *outputs, const laconic_tree_model *model,
                             const laconic_tree_state *state);

#ifdef __cplusplus
}
#endif

#ifndef LACONIC_IN_CORE /* build.h */
#define laconic_tree_prepare(...) (laconic_check_bodies(), laconic_tree_prepare(__VA_ARGS__))
#define laconic_tree_state_set(...) (laconic_check_bodies(), laconic_tree_state_set(__VA_ARGS__))
#endif

#endif
#endif
