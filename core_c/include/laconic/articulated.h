/* Articulated vehicles that roll without slip: steered wheels, swivel casters, trailers, loaders.
 *
 * A vehicle is a tree of rigid bodies in the plane. Body 0 is the carriage; body b hangs on its parent, a body with a
 * lower number, by a vertical hinge. A caster is a body with a fixed wheel behind its hinge; a steered wheel is a body
 * with a fixed wheel under its hinge; a trailer is a body with an axle behind its hinge.
 *
 *     vehicle  --prepare-->  model  --step-->  state  -->  outputs
 *      (SI)                (constants)   ^
 *                                 input at start and end
 *
 * Memory, threads, bits  as in laconic.h: the caller owns every struct, all are plain data, no heap, no globals.
 * Errors   a function that can refuse returns a laconic_status and then changes nothing. `why` (it may be NULL) gets
 *          field, item and value; laconic_message() makes one line of text of them.
 * Frames   body 0: the body frame of laconic.h. A body b ≥ 1: its own frame, with its origin at its hinge. ψ_b is the
 *          angle from the parent's ξ to the body's ξ. The position (x, y) of a state is that of S_0, the centre of mass
 *          of body 0 (with its payload).
 *
 * Symbols  X_b = (V, ω)  twist of a body: velocity of its origin (body 0: of S_0) in its own axes, absolute yaw rate
 *          I_b, D_b      its inertia and its wheels' damping, 3×3, constant in its own frame: a body with wheels is one
 *                        carriage of equation (4.7)
 *          n, ℓ          axle of a body's fixed wheels and its lever about the hinge: n·V + ℓ ω = 0
 *          following     a free hinge whose own wheels fix the body's yaw rate, ω = −n·V/ℓ: casters, trailers
 *          own           a free or motor hinge without such wheels: ω is a velocity of its own
 *          η             velocities of the model: ζ of the carriage alone (laconic.h), then the ω of own hinges. So
 *                        X_b = B_b(ψ) η + β_b(t), with β from prescribed rates
 *          E₀            1 on ζ, 0 on own ω. The equations of motion are
 *     (E₀ + Σ B_bᵀ I_b B_b) η' = right side of (4.7) + Σ B_bᵀ (a(X_b) + F_b − D_b X_b − I_b γ_b) + hinge torques + Cᵀκ
 *          γ_b           X_b' at η' = 0;   C: rows of wheels that no following hinge takes up (a wheel under a steered
 *                        hinge, a second axle)
 *
 * Limits   ideal ground (no ground.friction_coefficient), motors without limits; hinges without stops or dry
 *          friction. */
#ifndef LACONIC_ARTICULATED_H
#define LACONIC_ARTICULATED_H

#include "laconic/laconic.h"

/* The names of the methods, in the order of laconic_articulated_method. */
#define LACONIC_ARTICULATED_METHOD_NAMES "auto", "rk4", "circle", "moebius-4"

#if LACONIC_MAX_BODIES > 0

#ifdef __cplusplus
extern "C" {
#endif

/* -------------------------------------------------------------------------------- vehicle -- */

typedef enum laconic_hinge_kind {
    LACONIC_HINGE_UNSET = 0,      /* refused, so that a forgotten hinge is noticed                             */
    LACONIC_HINGE_FREE = 1,       /* torque T − damping ψ' − stiffness (ψ − rest)                              */
    LACONIC_HINGE_MOTOR = 2,      /* the same plus gain · voltage                                              */
    LACONIC_HINGE_PRESCRIBED = 3, /* ψ' is an input, whatever torque that takes                                */
    LACONIC_HINGE_COORDINATED = 4 /* points along the velocity that the twist of the input has at the hinge: its
                                     wheels roll along the body's ξ                                            */
} laconic_hinge_kind;

/* One body on a hinge. Start from all zero and set what applies. Mass and inertia include the body's wheels. */
typedef struct laconic_body {
    int32_t parent; /* 0: the carriage; lower than the body's own number                                 */
    laconic_hinge_kind hinge;
    laconic_real hinge_x_m, hinge_y_m; /* in the parent's frame                                              */
    laconic_real mass_kg;              /* 0 or above                                                         */
    laconic_real com_x_m, com_y_m;     /* centre of mass in the body's frame                                 */
    laconic_real yaw_inertia_kgm2;     /* about the vertical through the body's centre of mass, 0 or above   */
    laconic_real damping_Nms;          /* of a free or motor hinge: torque per ψ'                            */
    laconic_real stiffness_Nm;         /* of a free or motor hinge: torque per radian                        */
    laconic_real rest_rad;             /* ψ at which the spring is relaxed                                   */
    laconic_real gain_Nm_per_V;        /* of a motor hinge                                                   */
} laconic_body;

/* A vehicle with hinges. `base` describes body 0 alone, and the wheels of all bodies: x_m and y_m of a wheel are in the
 * frame of its body. */
typedef struct laconic_articulated_vehicle {
    laconic_vehicle base;
    int32_t wheel_body[LACONIC_MAX_WHEELS]; /* number of the wheel's body; 0: the carriage */
    int32_t body_count;                     /* H: bodies without the carriage               */
    laconic_body body[LACONIC_MAX_BODIES];  /* body b is body[b − 1]                       */
} laconic_articulated_vehicle;

/* Rows as in vehicle.h: X(of, number, IDENTIFIER, member, name, KIND, RULE, NEED). laconic_field_name() and
 * laconic_field_path() know them, and nodes with hinges take them. */
/* clang-format off */
#define LACONIC_BODY_FIELDS(X, of) \
    X(of,  97, BODY_PARENT,      parent,           body_parent,           INTEGER, UNCHECKED,    NEVER) \
    X(of,  98, BODY_HINGE,       hinge,            body_hinge,            INTEGER, UNCHECKED,    ALWAYS) \
    X(of,  99, BODY_HINGE_X,     hinge_x_m,        body_hinge_x_m,        REAL,    FINITE,       ALWAYS) \
    X(of, 100, BODY_HINGE_Y,     hinge_y_m,        body_hinge_y_m,        REAL,    FINITE,       ALWAYS) \
    X(of, 101, BODY_MASS,        mass_kg,          body_mass_kg,          REAL,    NOT_NEGATIVE, ALWAYS) \
    X(of, 102, BODY_COM_X,       com_x_m,          body_com_x_m,          REAL,    FINITE,       NEVER) \
    X(of, 103, BODY_COM_Y,       com_y_m,          body_com_y_m,          REAL,    FINITE,       NEVER) \
    X(of, 104, BODY_YAW_INERTIA, yaw_inertia_kgm2, body_yaw_inertia_kgm2, REAL,    NOT_NEGATIVE, ALWAYS) \
    X(of, 105, HINGE_DAMPING,    damping_Nms,      hinge_damping_Nms,     REAL,    NOT_NEGATIVE, NEVER) \
    X(of, 106, HINGE_STIFFNESS,  stiffness_Nm,     hinge_stiffness_Nm,    REAL,    NOT_NEGATIVE, NEVER) \
    X(of, 107, HINGE_REST,       rest_rad,         hinge_rest_rad,        REAL,    ANGLE,        NEVER) \
    X(of, 108, HINGE_GAIN,       gain_Nm_per_V,    hinge_gain_Nm_per_V,   REAL,    FINITE,       NEVER)

/* Which body a wheel belongs to; how many bodies there are. */
#define LACONIC_WHEEL_BODY_FIELD(X, of) X(of, 109, WHEEL_BODY, body, wheel_body, INTEGER, UNCHECKED, NEVER)
#define LACONIC_BODY_COUNT_FIELD(X, of) X(of, 110, BODY_COUNT, body, body_count, INTEGER, UNCHECKED, NEVER)

/* Arrays of laconic_articulated_input and _start; their functions check them. */
#define LACONIC_HINGE_INPUT_FIELDS(X, of) \
    X(of, 111, HINGE_VOLTAGE,      hinge_voltage_V,               hinge_voltage_V,      REAL, FINITE, NEVER) \
    X(of, 112, HINGE_TORQUE,       hinge_torque_Nm,               hinge_torque_Nm,      REAL, FINITE, NEVER) \
    X(of, 113, HINGE_RATE,         hinge_rate_rad_per_s, steering_rate_rad_per_s, REAL, FINITE, NEVER) \
    X(of, 114, HINGE_ACCELERATION, hinge_acceleration_rad_per_s2, steering_acceleration_rad_per_s2, REAL, FINITE, \
      NEVER) \
    X(of, 115, TWIST,              twist,                         steering_twist,       REAL, FINITE, NEVER) \
    X(of, 116, TWIST_RATE,         twist_rate,                    steering_twist_rate,  REAL, FINITE, NEVER)
#define LACONIC_HINGE_START_FIELDS(X, of) \
    X(of, 117, START_VELOCITY,     velocity_m_per_s,     start_velocity_m_per_s,     REAL, FINITE, NEVER) \
    X(of, 118, START_YAW_RATE,     yaw_rate_rad_per_s,   start_yaw_rate_rad_per_s,   REAL, FINITE, NEVER) \
    X(of, 119, START_HINGE_ANGLE,  hinge_angle_rad,      start_hinge_rad,            REAL, FINITE, NEVER) \
    X(of, 120, START_HINGE_RATE,   hinge_rate_rad_per_s, start_hinge_rate_rad_per_s, REAL, FINITE, NEVER)

#define LACONIC_ARTICULATED_FIELDS(X) \
    LACONIC_BODY_FIELDS(X, BODY) LACONIC_WHEEL_BODY_FIELD(X, WHEEL) LACONIC_BODY_COUNT_FIELD(X, COUNT) \
    LACONIC_HINGE_INPUT_FIELDS(X, HINGE) LACONIC_HINGE_START_FIELDS(X, HINGE_START)
/* clang-format on */

#define LACONIC_ARTICULATED_FIELD_NUMBER(of, number, IDENTIFIER, ...) LACONIC_FIELD_OF_##IDENTIFIER = number,

/* Numbers of a refusal's field in addition to those of laconic_field; converted to it they keep their values. The
 * item is the number of the body; of WHEEL_BODY that of the wheel, of TWIST that of the component. */
typedef enum laconic_articulated_field {
    LACONIC_ARTICULATED_FIELDS(LACONIC_ARTICULATED_FIELD_NUMBER) LACONIC_ARTICULATED_FIELD_COUNT = 121
} laconic_articulated_field;

/* ---------------------------------------------------------------------------------- model -- */

#define LACONIC_MAX_VELOCITIES (3 + LACONIC_MAX_BODIES) /* of η */
#define LACONIC_MAX_LEFT_ROWS (3 * LACONIC_MAX_BODIES)  /* of C */

/* A symmetric 3×3 matrix on twists. */
typedef struct laconic_form {
    laconic_real xx, xy, yy, xw, yw, ww;
} laconic_form;

typedef enum laconic_hinge_motion {
    LACONIC_MOTION_FOLLOWING,
    LACONIC_MOTION_OWN,
    LACONIC_MOTION_PRESCRIBED,
    LACONIC_MOTION_COORDINATED
} laconic_hinge_motion;

/* Prepared constants of one body on a hinge. */
typedef struct laconic_link {
    int32_t parent;
    laconic_hinge_motion motion;
    int32_t column;                               /* of its ω in η, where that is its own; else −1                   */
    int32_t first_row, row_end;                   /* rows left over of this body: first_row … row_end − 1             */
    uint32_t own_below, rows_below;               /* bit k: own hinge k, row k belongs to this body or hangs on it    */
    laconic_vector hinge;                         /* from the parent's origin (parent 0: from S_0); z is 0            */
    laconic_vector first_moment;                  /* m s_ξ, m s_η, m                                                  */
    laconic_form inertia, drag;                   /* I_b, D_b                                                         */
    bool drags;                                   /* D_b is not 0                                                     */
    bool is_leaf;                                 /* no other body hangs on it                                        */
    bool is_plain_follower;                       /* a following leaf without rows left over                          */
    laconic_form followed_inertia, followed_drag; /* of a following hinge: on V alone, ω put in          */
    laconic_vector axle_per_lever;                /* of a following hinge: n/ℓ; z is 0                                */
    laconic_real damping_Nms, stiffness_Nm, rest_rad, gain_Nm_per_V;
} laconic_link;

/* One row left over: n·V + ℓ ω = 0. */
typedef struct laconic_left_row {
    int32_t body, wheel; /* the first wheel that asks for it, from 0 */
    laconic_vector axle; /* n_ξ, n_η, ℓ in the body's frame          */
} laconic_left_row;

/* A wheel in the frame of its body. */
typedef struct laconic_articulated_wheel {
    int32_t body;
    laconic_vector roll;            /* χ' = roll · X_b                                        */
    laconic_vector pull;            /* (u, lever): the reaction along u is a wrench along it  */
    laconic_vector axle;            /* (n, lever), of a fixed wheel; else 0                   */
    laconic_real inverse_arm_per_m; /* 1/(R sin γ)                                            */
    laconic_real inertia_kgm2, gain_Nm_per_V, damping_Nms;
    bool locked;
} laconic_articulated_wheel;

/* Prepared constants; read them, do not write them. */
typedef struct laconic_articulated_model {
    int32_t body_count, wheel_count;
    int32_t carriage_dof;        /* m: ζ of the carriage; 1 where the twist coordinates hinges                   */
    int32_t own_count;           /* own hinges                                                                  */
    int32_t dof;                 /* m + own_count, before the rows left over                                    */
    int32_t row_count;           /* rows left over                                                              */
    int32_t last_inner;          /* the last body on which another hangs                                        */
    bool coordinated;            /* some hinge is coordinated: the carriage moves along the twist alone          */
    laconic_vector column[3];    /* X_0 = Σ column_k ζ_k, columns have unit energy                          */
    laconic_form pair[6];        /* column_iᵀ A column_j = pair · A, for (0,0) (1,0) (1,1) (2,0) (2,1) (2,2) */
    laconic_real decay_per_s[3]; /* r_k of the carriage alone                                               */
    int32_t column_count;        /* of the carriage alone                                                   */
    laconic_vector held[2];      /* rows with row·X_0 = 0 on all motions that its own wheels allow          */
    int32_t held_count;
    laconic_real mass_kg;       /* of body 0 with payload                                                  */
    laconic_form inertia, drag; /* of body 0, about S_0                                                    */
    laconic_real com_x_m, com_y_m;
    laconic_link link[LACONIC_MAX_BODIES];
    laconic_left_row row[LACONIC_MAX_LEFT_ROWS];
    laconic_articulated_wheel wheel[LACONIC_MAX_WHEELS];
    laconic_real length_m;            /* size of the vehicle, for comparisons of lengths                         */
    laconic_real fastest_decay_per_s; /* of motors and hinges, the largest of several postures               */
    laconic_real fastest_swing_per_s; /* of springs, likewise                                               */
    laconic_real friction_coefficient;
    laconic_vector slope_acceleration; /* downhill, world axes; 0 on level ground */
} laconic_articulated_model;

/* Checks the vehicle and fills the model. About 5,000 flops a body. Refuses as laconic_prepare does for the carriage
 * (naming the wheel as the vehicle counts it), as laconic_vehicle_check does for wheels, and with
 *   TOO_MANY_BODIES        body_count below 0 or above LACONIC_MAX_BODIES
 *   HINGE_NOT_SET, HINGE_KIND_UNKNOWN, BODY_UNKNOWN (wheel_body, parent: not a lower number), NOT_FINITE, NEGATIVE,
 *   OVERFLOW               numbers of a body or wheel
 *   COORDINATED_ON_BODY    a coordinated hinge whose parent is not the carriage
 *   COORDINATED_WHEEL      a fixed wheel of a coordinated body does not roll along ξ with its axle line through the
 *                          hinge
 *   COORDINATED_TOO_FEW    the carriage's own wheels and coordinated ones together leave more than one motion
 *   MASSLESS_HINGE         an own hinge turns without inertia
 *   STEERED_TOO_OFTEN      fixed wheels under free or motor hinges hold the carriage at nearly every angle: three
 *                          motor-driven modules, or two behind which the carriage has an axle
 *   NOTHING_MOVES          wheels of one body hold it
 *   FRICTION_WITH_HINGES   the vehicle has ground friction or limits of a drive */
laconic_status laconic_articulated_prepare(laconic_articulated_model *model, const laconic_articulated_vehicle *vehicle,
                                           laconic_refusal *why);

/* ---------------------------------------------------------------------------------- input -- */

/* Everything that acts or is commanded at one moment. All zero: only damping acts, and prescribed hinges are held. */
typedef struct laconic_articulated_input {
    laconic_input base; /* voltages and torques of all wheels; forces on body 0, points from S_0                 */
    laconic_real hinge_voltage_V[LACONIC_MAX_BODIES];               /* motor hinges; hinge b is item b − 1        */
    laconic_real hinge_torque_Nm[LACONIC_MAX_BODIES];               /* free and motor hinges: on b, against parent */
    laconic_real hinge_rate_rad_per_s[LACONIC_MAX_BODIES];          /* prescribed hinges: r                       */
    laconic_real hinge_acceleration_rad_per_s2[LACONIC_MAX_BODIES]; /* prescribed hinges: r'                      */
    laconic_real twist[3];                                          /* T: velocity of the body frame's origin and yaw
                                                                       rate, up to a common positive factor       */
    laconic_real twist_rate[3];                                     /* T'                                         */
} laconic_articulated_input;

/* Sets r' and T' of both inputs so that rates and twist vary linearly over a step of that size. */
void laconic_articulated_ramp(laconic_articulated_input *start, laconic_articulated_input *end, laconic_real step_s);

/* OK iff every number of the model's wheels and hinges is finite. */
laconic_status laconic_articulated_input_check(const laconic_articulated_model *model,
                                               const laconic_articulated_input *input, laconic_refusal *why);

/* ---------------------------------------------------------------------------------- state -- */

/* All that a motion consists of. Copy it to save the motion, copy it back to restore it. */
typedef struct laconic_articulated_state {
    laconic_sum eta[LACONIC_MAX_VELOCITIES];
    laconic_sum x_m, y_m;
    laconic_heading heading;
    laconic_heading hinge[LACONIC_MAX_BODIES];     /* ψ, wraps exactly as the heading does                  */
    laconic_sum travel[LACONIC_MAX_BODIES + 1][3]; /* ∫X_b dt since the wheel angles were last set           */
    laconic_real wheel_angle_set_rad[LACONIC_MAX_WHEELS];
    laconic_real hinge_rate_rad_per_s[LACONIC_MAX_BODIES]; /* r at this moment, 0 of other hinges             */
    laconic_vector twist, twist_rate;                      /* T and T' at this moment, of S_0                  */
} laconic_articulated_state;

typedef struct laconic_articulated_start {
    laconic_real velocity_m_per_s[2]; /* of S_0, body axes                                             */
    laconic_real yaw_rate_rad_per_s;
    laconic_real x_m, y_m, heading_rad;
    laconic_real hinge_angle_rad[LACONIC_MAX_BODIES];      /* coordinated hinges: only its whole turns are read */
    laconic_real hinge_rate_rad_per_s[LACONIC_MAX_BODIES]; /* prescribed and coordinated hinges: not read        */
} laconic_articulated_start;

/* Sets the state: the motion that wheels, prescribed rates and twist of `input` allow and that is nearest in kinetic
 * energy to the given one. `change_m_per_s` (it may be NULL) gets the size of what was changed, as √(2 · energy of the
 * difference / mass of all bodies): about 0 iff the given motion was allowed. Wheel angles become 0. Refuses
 * NOT_FINITE, OVERFLOW, and as laconic_articulated_step does for the posture. */
laconic_status laconic_articulated_state_set(laconic_articulated_state *state, laconic_real *change_m_per_s,
                                             const laconic_articulated_model *model,
                                             const laconic_articulated_start *start,
                                             const laconic_articulated_input *input, laconic_refusal *why);

/* Rates and twist of `input` from now on: the momenta along the motions that are then allowed stay as they are. A step
 * does the same at its start wherever its input commands another rate, T or T' than the state has. Costs about half a
 * step of rk4. Refuses TWIST_JUMPS where T would turn a coordinated hinge at once, and as laconic_articulated_step. */
laconic_status laconic_articulated_jump(const laconic_articulated_model *model, laconic_articulated_state *state,
                                        const laconic_articulated_input *input, laconic_refusal *why);

/* ------------------------------------------------------------------------ methods and steps -- */

typedef enum laconic_articulated_method {
    LACONIC_ARTICULATED_AUTO = 0,     /* divides a step where motion is fast, and judges parts by their energy  */
    LACONIC_ARTICULATED_RK4 = 1,      /* order 4; h v/a < 2.78 (a: trail of a caster) and h·r < 2.78            */
    LACONIC_ARTICULATED_CIRCLE = 2,   /* order 4; following angles by exact maps of the circle; h·r < 2.78      */
    LACONIC_ARTICULATED_MOEBIUS_4 = 3 /* order 4; any damping. Order 3 with rows left over, and 2, but stable, where
                                         a spring swings faster than the step (h·rate above 1)                  */
} laconic_articulated_method;

#define LACONIC_ARTICULATED_METHOD_COUNT 4

/* One of LACONIC_ARTICULATED_METHOD_NAMES; "" for an unknown number. */
const char *laconic_articulated_method_name(int32_t method);

/* The method of that name; −1: there is none. */
int32_t laconic_articulated_method_by_name(const char *name);

/* Factors of an exponential step, per velocity, with a = h r and φ at −a. */
typedef struct laconic_articulated_factors {
    laconic_real
        correction[LACONIC_MAX_VELOCITIES];     /* h (r/(1 − e^−a) − 1/h − r/2): makes a midpoint step exponential */
    laconic_real mean[LACONIC_MAX_VELOCITIES];  /* κ = φ2/φ1                                                    */
    laconic_real slope[LACONIC_MAX_VELOCITIES]; /* 12 (φ2/2 − φ3)/φ1                                            */
} laconic_articulated_factors;

/* One method prepared for one step size. */
typedef struct laconic_articulated_integrator {
    laconic_articulated_method method;
    laconic_real step_s, rate_per_step;     /* h, 1/h                                     */
    int32_t parts;                          /* of auto: how many the fastest decay asks for */
    laconic_articulated_factors factors[2]; /* of moebius-4: for h and h/2                  */
} laconic_articulated_integrator;

/* Refuses METHOD_UNKNOWN, NOT_FINITE, NOT_POSITIVE, OVERFLOW (the step) and for rk4 and circle
 * STEP_BEYOND_DAMPING_LIMIT. */
laconic_status laconic_articulated_integrator_prepare(laconic_articulated_integrator *integrator, int32_t method,
                                                      const laconic_articulated_model *model, laconic_real step_s,
                                                      laconic_refusal *why);

/* One step of h from the input at its start to the input at its end (the same pointer twice: the input is held). Over
 * the step voltages, torques and forces vary linearly; rates and T are the cubics through both values with both
 * derivatives. Refuses, with the state as it was:
 *   NOT_FINITE                    a number of an input
 *   TWIST_ZERO                    T is 0 or a hinge lies in its turning centre, so the wheel there has no direction
 *   TWIST_JUMPS                   T turns a coordinated hinge by more than a quarter turn within the step, or at once
 *   TWIST_AGAINST_WHEELS          T makes a fixed wheel of the carriage slide
 *   WHEELS_DISAGREE               wheels ask for different turning centres, so nothing moves: item and value are two
 *                                 of these wheels
 *   MASSLESS_HINGE                at these angles an own hinge turns without inertia
 *   STEP_BEYOND_TRAIL_LIMIT       rk4: the wheels of a body turn it too fast for the step (limit: the largest step);
 *                                 auto: not even by 4096 parts that judge themselves. The item is the body
 *   STEP_BEYOND_GYROSCOPIC_LIMIT  rk4, circle: the yaw rate is too large for the step
 *   STEP_SINGULAR                 moebius-4: in this state the step has no solution
 *   OVERFLOW                      a result leaves the range */
laconic_status laconic_articulated_step(const laconic_articulated_model *model,
                                        const laconic_articulated_integrator *integrator,
                                        laconic_articulated_state *state, const laconic_articulated_input *start,
                                        const laconic_articulated_input *end, laconic_refusal *why);

/* -------------------------------------------------------------------------------- outputs -- */

/* Outputs that follow from the state alone. Arrays have one number for each of the model's bodies or wheels. */
typedef struct laconic_articulated_motion {
    laconic_real velocity_m_per_s[2], yaw_rate_rad_per_s; /* of S_0, body axes                          */
    laconic_real x_m, y_m, heading_rad;                   /* of S_0; heading unwrapped                  */
    laconic_real hinge_angle_rad[LACONIC_MAX_BODIES];     /* ψ, unwrapped                               */
    laconic_real hinge_rate_rad_per_s[LACONIC_MAX_BODIES];
    laconic_real body_x_m[LACONIC_MAX_BODIES], body_y_m[LACONIC_MAX_BODIES]; /* of its hinge, world axes */
    laconic_real body_heading_rad[LACONIC_MAX_BODIES];                       /* in (−π, π]               */
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_real wheel_angle_rad[LACONIC_MAX_WHEELS];
    laconic_real energy_J; /* kinetic, of all bodies and wheels */
} laconic_articulated_motion;

void laconic_articulated_motion_of(laconic_articulated_motion *motion, const laconic_articulated_model *model,
                                   const laconic_articulated_state *state);

/* Wheel angles from now on. */
void laconic_articulated_wheel_angles_set(const laconic_articulated_model *model, laconic_articulated_state *state,
                                          const laconic_real *angle_rad);

/* Accelerations at one moment: X_b' of each body (body 0 first), η'. For outer integrators and tests. Refuses as
 * laconic_articulated_step does for the posture. */
typedef struct laconic_articulated_rates {
    laconic_vector twist[LACONIC_MAX_BODIES + 1];      /* X_b */
    laconic_vector twist_rate[LACONIC_MAX_BODIES + 1]; /* X_b' */
    laconic_real eta_rate[LACONIC_MAX_VELOCITIES];
} laconic_articulated_rates;

laconic_status laconic_articulated_rates_of(laconic_articulated_rates *rates, const laconic_articulated_model *model,
                                            const laconic_articulated_state *state,
                                            const laconic_articulated_input *input, laconic_refusal *why);

/* Forces that ground and hinges must deliver, from leaf to root. */
typedef struct laconic_articulated_reactions {
    laconic_real wheel_torque_Nm[LACONIC_MAX_WHEELS];  /* of motor and input on the axle                            */
    laconic_real along_N[LACONIC_MAX_WHEELS];          /* along the roller's axis; fixed: rolling direction         */
    laconic_real lateral_N[LACONIC_MAX_WHEELS];        /* fixed wheels: along the axle. Wheels of one axle line share
                                                          their force equally: only the sum is determined           */
    laconic_real brake_Nm[LACONIC_MAX_WHEELS];         /* locked wheels                                             */
    laconic_real hinge_torque_Nm[LACONIC_MAX_BODIES];  /* on the body, the opposite on its parent                   */
    laconic_real hinge_force_N[LACONIC_MAX_BODIES][2]; /* of the parent on the body, in the body's axes             */
    laconic_real balance;                              /* what is left at body 0 over the largest force there: rounding
                                                          iff everything above is right                             */
    laconic_real largest_N; /* size of the largest reaction of a wheel: with it the caller judges slip, or:          */
    laconic_real no_slip_margin_N; /* least of μ N_i − |reaction_i| for the given loads N                            */
} laconic_articulated_reactions;

/* `normal_N`: a load for each wheel, for the margin alone; NULL: the margin is 0. */
laconic_status laconic_articulated_reactions_of(laconic_articulated_reactions *reactions,
                                                const laconic_articulated_model *model,
                                                const laconic_articulated_state *state,
                                                const laconic_articulated_input *input, const laconic_real *normal_N,
                                                laconic_refusal *why);

/* A program with another number of bodies than the library, or with other definitions of build.h, does not link. */
#define LACONIC_BUILT_BODIES LACONIC_JOINED(laconic_built_with_LACONIC_MAX_BODIES_, LACONIC_MAX_BODIES)
void LACONIC_BUILT_BODIES(void);

#ifdef __cplusplus
}
#endif

#ifndef LACONIC_IN_CORE /* build.h */
static inline void laconic_check_bodies(void) {
    laconic_check_build();
    LACONIC_BUILT_BODIES();
}

#define laconic_articulated_prepare(...) (laconic_check_bodies(), laconic_articulated_prepare(__VA_ARGS__))
#define laconic_articulated_integrator_prepare(...) \
    (laconic_check_bodies(), laconic_articulated_integrator_prepare(__VA_ARGS__))
#define laconic_articulated_state_set(...) (laconic_check_bodies(), laconic_articulated_state_set(__VA_ARGS__))
#endif

#endif
#endif
