/* Laconic: the dynamics of wheeled robots.
 *
 * One kernel for carriages with any number of omni, mecanum or fixed wheels anywhere, differential
 * drives and caster wheels, after A. A. Zobova, "Application of laconic forms of the equations of
 * motion in the dynamics of nonholonomic mobile robots", Rus. J. Nonlin. Dyn. 7(4), 2011. Equation
 * numbers are that paper's.
 *
 *     vehicle  --prepare-->  model  --step-->  state  -->  outputs
 *      (SI)                (constants)   ^
 *                                      input
 *
 * Memory   the caller owns every struct; no heap, no globals, and no pointer to the caller's memory is kept.
 *          Vehicle, model, state and plant are plain data: copy them to save and restore. (laconic_integrator points
 *          to its method, which is constant; laconic_schedule and laconic_recorder point to arrays of the caller.)
 * Threads  functions touch only their arguments; different structs may be used at the same time.
 * Errors   a function that can refuse returns a laconic_status and changes nothing when it does.
 *          Where `why` is given (it may be NULL), it gets the field, the item and the value at fault;
 *          laconic_message() makes one line of text of them.
 * Bits     the same on every platform with IEEE arithmetic (-std=c99 -ffp-contract=off, and for gcc
 *          -fno-tree-slp-vectorize): the core brings its own sine, exponential and square root.
 *
 * Frames   body axes (ξ, η), η to the left of ξ. Centre of mass, wheels and supports are given in the body frame, whose
 *          origin may be anywhere. World axes (X, Y); the heading θ is the angle from X to ξ. The position (x, y) of a
 *          state is that of S.
 *
 * Symbols  docs/glossary.md has all of them. Those that the comments use:
 *          S             centre of mass of the robot with its wheels and payload
 *          M, R, J       mass of all of it; radius of a wheel; inertia of a wheel about its axle. A wheel i may have
 *                        its own R_i, J_i; R is then the vehicle's, in which ν is measured
 *          Λ, λ          I_S = Λ² M R² and J = λ² M R²: the yaw inertia about S, and J, without a unit
 *          ν             pseudo-velocities [rad/s]: v_S = R (ν1 e_ξ + ν2 e_η), yaw rate θ' = ν3/Λ
 *          χ             own rotation of a wheel; positive χ' drives the hub along (−sin β, cos β), with β the axle's
 *                        direction. So a wheel that rolls along +ξ has β = −π/2, left and right alike.
 *          Ξ             wheel matrix (4.3, 4.4): χ' = Ξν; the row of a wheel has the factor R/R_i
 *          A             inertia matrix E + Σ J_i/(M R²) Ξ_iᵀΞ_i (4.6), E + λ²ΞᵀΞ for equal wheels: the kinetic energy
 *                        is ½ M R² νᵀAν
 *          K             (Aν)₃, which free motion without constraints conserves, like the energy
 *          ζ, G, g       the velocity in principal coordinates, ν = Gζ; g is the third row of G, so ν3 = g·ζ
 *          w, r, b       of ζ' = (g·ζ)(ζ × w) − diag(r)ζ + b: axis of the gyroscopic term, damping rates, forcing
 *          κ             multipliers of the constraints [rad/s²]: M R κ is a force, M R² κ the torque of a brake
 *          c1, c2        a motor gives its wheel the torque c1 U − c2 χ' at the voltage U; a wheel may have its own
 *
 * Limits   what the model does not do, and what to do instead:
 *          slip             without a ground.friction_coefficient wheels and rollers roll without slip, and
 *                           no_slip_margin_N is below 0 where the ground cannot hold a wheel; from there on the run is
 *                           not true. With one, contacts stick and slip (friction.h).
 *          suspension       the body is rigid and its height constant; normal loads are least-norm statics, without
 *                           springs. On more than three points they are those of an evenly soft ground.
 *          hills            the ground is one plane, level or with the slope of vehicle.ground.
 *          motors           a DC motor without inductance; vehicle.drive adds supply and limits, and
 *                           ground.axle_friction_Nm dry friction. Any other torque is given as axle_torque_Nm, with
 *                           c1 = c2 = 0 where it replaces the motor's.
 *          swivel casters   a support: it carries a normal load; its inertia and its swivelling are left out. A single
 *                           fixed wheel does not swivel. articulated.h has casters that swivel.
 *          steered wheels   a fixed wheel keeps its axle; a constant steering angle is its axle_rad. articulated.h has
 *                           wheels that steer while the vehicle moves, one by one or coordinated.
 *          trailers         articulated.h has trailers, centre hinges and other bodies on hinges.
 *          skid steering    on ideal ground fixed wheels on more than one axle line cannot yaw: give the ground its
 *                           friction, or one axle line in the middle with the others as supports. */
#ifndef LACONIC_H
#define LACONIC_H

#include "laconic/friction.h" /* laconic_friction, laconic_slip */
#include "laconic/internals.h"
#include "laconic/methods.h" /* LACONIC_METHODS, LACONIC_METHOD_COUNT */
#include "laconic/real.h"
#include "laconic/sensors.h" /* laconic_sensors: IMU and encoders */
#include "laconic/status.h"  /* laconic_status, laconic_arithmetic */
#include "laconic/vehicle.h" /* laconic_vehicle, _motor, _input, _start; laconic_field */

#ifdef __cplusplus
extern "C" {
#endif

#define LACONIC_VERSION "0.1.0"
#define LACONIC_GRAVITY_M_PER_S2 9.80665

/* ------------------------------------------------------------------------------- refusals -- */

/* Why a call was refused. */
typedef struct laconic_refusal {
    laconic_status status;
    laconic_field field;
    int32_t item;       /* wheel, support or component, from 1; 0: the field has no items */
    laconic_real value; /* the value that was refused                                     */
    laconic_real limit; /* the nearest acceptable one, where there is one; else 0         */
} laconic_refusal;

/* Writes one line of text for a refusal. It names the field as in a scene file, with its table and the number of the
 * wheel, and the remedy: "vehicle.wheel[2].x_m: infinity is not a finite number; give a number". Angles in rad.
 * Writes at most `size` characters with the closing 0 and returns the length the whole text has (as snprintf does). */
size_t laconic_message(const laconic_refusal *why, char *text, size_t size);

/* The same without the field, for callers that name the field themselves. */
size_t laconic_explanation(const laconic_refusal *why, char *text, size_t size);

/* "mass_kg", "wheel_x_m" … ; "" for an unknown number. */
const char *laconic_field_name(laconic_field field);

/* The key of a scene: "vehicle.mass_kg", "vehicle.wheel[#].x_m" … , # for the item; of an input the name of its
 * signal; "" for an unknown number. */
const char *laconic_field_path(laconic_field field);

/* Further facts of vehicle.h about a field. `items`: how many items it has, 0 where it is a single number. */
typedef struct laconic_field_traits {
    laconic_field_kind kind;
    laconic_field_rule rule;
    laconic_field_need need;
    int32_t items;
} laconic_field_traits;

/* For hosts and tools that make their own lists of fields; NULL for an unknown number. */
const laconic_field_traits *laconic_field_traits_of(laconic_field field);

/* "not finite", "wheel not set" … : a few words; "unknown status" for an unknown number. */
const char *laconic_status_name(laconic_status status);

/* ----------------------------------------------------------------------------- arithmetic -- */

/* Optional, for the start of a program: does arithmetic give the bits and the refusals that this header promises?
 * Options that compilers reveal by macros are errors when compiling (common.h); this call finds the others and returns
 * the first of LACONIC_ARITHMETICS that is wrong. It tests the options of its own file and the modes of the calling
 * thread: compile it with the core's options and call it in the thread that steps. Less than 1 KB in single on a
 * Cortex-M4. */
laconic_arithmetic laconic_self_test(void);

/* "sound", or the fault and its remedy in one line. */
const char *laconic_arithmetic_text(laconic_arithmetic found);

/* -------------------------------------------------------------------------------- vehicle -- */

/* OK iff every number of the vehicle is usable; else the first that is not. O(N). Only the two counts have to be
 * checked for accesses to memory to be defined (docs/assurance.md). The check ensures in addition that results are
 * finite. */
laconic_status laconic_vehicle_check(const laconic_vehicle *vehicle, laconic_refusal *why);

/* c1 = n k_t/R_a, c2 = n² (k_t k_e/R_a + d) set in the vehicle; a wheel's own c1 and c2 stay. n² J_rotor is added to
 * the J of all driven wheels, including own ones. own_inertia_kgm2 excludes the rotor before the call and includes
 * it afterwards. So call it once, with the wheels set. Refuses NEGATIVE (wheel_inertia, own_inertia) where J is
 * below 0, ZERO (gear_ratio), OVERFLOW (gear_ratio) where one of these leaves the range, NEGATIVE (back_emf) where
 * damping is below 0. */
laconic_status laconic_motor_fit(laconic_vehicle *vehicle, const laconic_motor *motor, laconic_refusal *why);

/* ---------------------------------------------------------------------------------- model -- */

/* Prepared constants; read them, do not write them. In the coordinates ζ equation (4.7) is shortest:
 *     ν = G ζ with GᵀAG = E; every ζ satisfies the constraints,
 *     ζ' = (g·ζ)(ζ × w) − diag(r) ζ + b,      |ζ|² = νᵀAν,      g: third row of G.
 * With fewer than three degrees of freedom the columns of G beyond `dof` are zero. */
typedef struct laconic_model {
    int32_t wheel_count;
    int32_t dof;                                          /* m = 1 … 3                                 */
    laconic_real nu_of_zeta[3][3];                        /* G                                         */
    laconic_real gyro[3];                                 /* w = G₀ × G₁ / Λ                           */
    laconic_real gyro_square;                             /* |w|²                                      */
    laconic_real spin_gain[3];                            /* w × g: (spin_gain · ζ)(g·ζ) = rate of g·ζ in free motion */
    laconic_real spin_curve[3];                           /* 2(g·w)w − |w|²g                           */
    laconic_real decay_per_s[3];                          /* r_k ≥ 0, damping rates                    */
    laconic_real inertia[3];                              /* principal values of A; 1 + λ² x_k for equal wheels */
    laconic_real velocity_of_zeta[2][3];                  /* R G₀, R G₁: v_S in body axes              */
    laconic_real yaw_rate_of_zeta[3];                     /* g/Λ                                       */
    laconic_real wheel_of_zeta[LACONIC_MAX_WHEELS][3];    /* Ξ G: χ' = Ξ ν                           */
    laconic_real torque_scale;                            /* 1/(M R²)                                  */
    laconic_real voltage_scale[LACONIC_OWN_WHEELS];       /* c1_i/(M R²)                               */
    laconic_real motor_gain_Nm_per_V[LACONIC_OWN_WHEELS]; /* c1_i                                   */
    laconic_real motor_damping_Nms[LACONIC_OWN_WHEELS];   /* c2_i                                   */
    laconic_real wheel_inertia_kgm2[LACONIC_OWN_WHEELS];  /* J_i                                    */
#if LACONIC_WITH_OWN_WHEELS
    bool rotated_twice;            /* c2_i : J_i differ, so A and the damping have different axes       */
    laconic_real zeta_of_nu[3][3]; /* then G⁺ = (GᵀG)⁻¹Gᵀ: ζ = G⁺ν; else 0                              */
#endif
    laconic_real mass_kg, wheel_radius_m; /* M with payload, R                         */
    laconic_real yaw_scale;               /* Λ                                         */
    laconic_real com_x_m, com_y_m;        /* S in the body frame, with payload         */
#if LACONIC_WITH_SLOPE
    bool sloped;
    laconic_real slope_force_N[2]; /* M g sin α, downhill at S, world axes                    */
#endif
} laconic_model;

/* Checks the vehicle and fills the model: rows of Ξ (4.3–4.4), constraints of fixed and locked wheels, principal
 * axes of A (4.6), damping rates. About 2,000 flops plus 60 for each wheel; steps then need no sine of a given angle
 * and no division by a given number. Refuses as laconic_vehicle_check does. Refuses NOTHING_MOVES (item: the wheel
 * that takes the last motion; value: the share of its way that it would slide in that motion, 0 to 1). Refuses
 * STRAIGHT_ONLY if fixed wheels on parallel axle lines, as of skid steering, hold the heading (item: the wheel whose
 * line is farthest off the first one's; value: the distance in m). Refuses ILL_CONDITIONED (value: the condition
 * number of A, refused from 2·10²⁷ on, in single from 7·10⁹). Refuses OVERFLOW if a constant or the inverse of a
 * scale is beyond 10¹⁵⁴ (single: 10¹⁹), where the product of two would leave the range. Every number of a prepared
 * model is finite. If the vehicle has friction (laconic_vehicle_has_friction), the model is that of the body alone:
 * without constraints, G = E, rows of wheels 0. */
laconic_status laconic_prepare(laconic_model *model, const laconic_vehicle *vehicle, laconic_refusal *why);

/* Condition number of A on the motions that the constraints leave: largest over smallest inertia. Measured as energy
 * is, √(ν'ᵀAν'), an acceleration has a relative rounding error up to about ε √cond: half of cond's digits are lost.
 * The components of ν' keep nearly all digits. Only if a wrench acts along the largest inertia alone, all of cond's
 * digits may be lost. */
laconic_real laconic_condition_number(const laconic_model *model);

/* The matrices of the paper, to read; steps do not need them. */
typedef struct laconic_matrices {
    laconic_real wheel_rows[LACONIC_MAX_WHEELS][3];          /* Ξ (4.3–4.4)                            */
    laconic_real inertia[3][3];                              /* A = E + Σ J_i/(M R²) Ξ_iᵀ Ξ_i (4.6)    */
    laconic_real inverse_inertia[3][3];                      /* A⁻¹; with constraints G Gᵀ             */
    int32_t constraint_count;                                /* rows below, with the dependent ones    */
    laconic_real constraint_rows[2 * LACONIC_MAX_WHEELS][3]; /* c with cᵀν = 0: for each wheel
                                                          (P_i's motion along the axle)/R if
                                                          fixed, then row i of Ξ if locked */
    laconic_real lambda_yaw;                                 /* Λ                                      */
    laconic_real lambda_wheel;                               /* λ                                      */
} laconic_matrices;

/* Refuses as laconic_prepare does, and OVERFLOW for these numbers. */
laconic_status laconic_matrices_of(laconic_matrices *matrices, const laconic_vehicle *vehicle, laconic_refusal *why);

/* ---------------------------------------------------------------------------------- input -- */

/* OK iff every number is finite, those of the first wheel_count wheels and those without a wheel. The code is also
 * proved to be defined for every number, checked or not. */
laconic_status laconic_input_check(const laconic_model *model, const laconic_input *input, laconic_refusal *why);

/* The forcing b that an input makes, as a function of the heading: constant + cos θ · cosine + sin θ · sine. */
typedef struct laconic_forcing {
    laconic_real constant[3];
    laconic_real cosine[3], sine[3]; /* set only where `rotates` is true                           */
    bool rotates;                    /* a force fixed in the world acts                           */
} laconic_forcing;

void laconic_forcing_of(laconic_forcing *forcing, const laconic_model *model, const laconic_input *input);

/* ---------------------------------------------------------------------------------- state -- */

/* θ = 2π (turns + (fraction + 2 rest)·2⁻⁶⁴), 2⁻³² in single: wraps exactly, with the same resolution after any
 * number of turns. */
typedef struct laconic_heading {
    laconic_turns turns; /* int64_t */
    laconic_binary_angle fraction;
    laconic_real rest; /* in units of 2⁻⁶³ turn, 2⁻³¹ in single */
} laconic_heading;

/* All that a motion consists of. Copy it to save the motion, copy it back to restore it. */
typedef struct laconic_state {
    laconic_sum zeta[3];
    laconic_sum x_m, y_m;
    laconic_heading heading;
    laconic_sum travel[3]; /* ∫ζ dt since the wheel angles were last set; they are linear in it            */
    laconic_real wheel_angle_set_rad[LACONIC_MAX_WHEELS]; /* the angles then                                */
} laconic_state;

/* Sets the state; wheel angles become 0. Refuses START_AGAINST_CONSTRAINTS iff ν differs from the nearest allowed
 * motion by more than LACONIC_RANK_TOLERANCE of its size. (Item: the component that differs most, limit: its value
 * in that motion.) */
laconic_status laconic_state_set(laconic_state *state, const laconic_model *model, const laconic_start *start,
                                 laconic_refusal *why);

/* The same for the numbers of an outer integrator (Model Exchange): a ν that has drifted off the constraints is
 * projected onto the allowed motions instead of refused. Wheel angles become 0. */
laconic_status laconic_state_project(laconic_state *state, const laconic_model *model, const laconic_start *motion,
                                     laconic_refusal *why);

/* χ of the model's N wheels [rad], wheel_angle_set_rad + wheel_of_zeta · travel; setting them makes travel 0. */
void laconic_wheel_angles(const laconic_model *model, const laconic_state *state, laconic_real *angle_rad);
void laconic_wheel_angles_set(const laconic_model *model, laconic_state *state, const laconic_real *angle_rad);

/* Carries a motion over to a changed vehicle (payload, motor): velocity and pose of the body's origin,
 * yaw rate and wheel angles stay; ν and (x, y) are recomputed. The wheels must be the same. Refuses OVERFLOW
 * where the motion leaves the range in coordinates of the other model. */
laconic_status laconic_state_carry(laconic_state *state, const laconic_model *from, const laconic_model *to);

/* ------------------------------------------------------------------------ methods and steps -- */

/* One method prepared for one step size. */
typedef struct laconic_integrator {
    const struct laconic_method *method; /* the prepared method                                   */
    const struct laconic_method *chosen; /* takes the steps; another than `method` only for auto  */
    laconic_real step_s;                 /* h                                                     */
    laconic_decay decay[3];              /* for h, h/2, h/4, as far as the method needs them      */
    laconic_real gyro_limit;             /* largest |g·ζ| that an explicit method takes; not read by others */
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    int32_t stretches;                       /* of a step while something decays; 0: it is one panel */
    bool has_rest;                           /* after them, which is one more panel */
    bool halved;                             /* panels half as long, for the half steps of an error estimate */
    laconic_real first_share, rest_share;    /* of the step: the first panel, and the rest */
    laconic_real collocation[3][30];         /* weights of each axis; with stretches the φ of the first panel's */
    laconic_real collocation_of_rest[3][30]; /* and those of the rest */
#endif
    bool stiff; /* damping is fast for the step: h·r_max >= 0.3       */
} laconic_integrator;

typedef struct laconic_method {
    const char *name;
    int32_t order;
    laconic_status (*prepare)(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why);
    laconic_status (*step)(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                           const struct laconic_forcing_samples *samples);
} laconic_method;

#define LACONIC_METHOD_DECLARATION(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) \
    LACONIC_METHOD_WITH_##NEEDS(extern const laconic_method laconic_##identifier;)

/* laconic_rk4 and the others of methods.h. laconic_auto chooses for each step: auto.c has the rule. */
LACONIC_METHODS(LACONIC_METHOD_DECLARATION)

/* All methods, for adapters that choose by the number or the name in methods.h. NULL if there is none. Links every
 * method. */
const laconic_method *laconic_method_by_number(int32_t number);
const laconic_method *laconic_method_by_name(const char *name);

/* Prepares a method for a step. Refuses METHOD_UNKNOWN (NULL), NOT_FINITE and NOT_POSITIVE. Refuses OVERFLOW if the
 * step is beyond 10⁹ s or the inverse of a quarter of it leaves the range. For explicit methods refuses
 * STEP_BEYOND_DAMPING_LIMIT (limit: the largest stable step). */
laconic_status laconic_integrator_prepare(laconic_integrator *integrator, const laconic_method *method,
                                          const laconic_model *model, laconic_real step_s, laconic_refusal *why);

/* One step of h with the input held. Refuses STEP_BEYOND_GYROSCOPIC_LIMIT, STEP_GAINS_ENERGY, STEP_SINGULAR,
 * OVERFLOW (also where the heading has counted 2⁶² turns); the state is then as it was. An input with a number that
 * is not finite is refused with any of these, even if it is the point of a world force of 0. laconic_step_refusal
 * finds the number. */
laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held);

/* `steps` steps with the input held: its forcing is computed once. Returns the number of steps taken; where that is
 * less, `status` is that of the refused step, else OK. */
uint64_t laconic_run(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                     const laconic_input *held, uint64_t steps, laconic_status *status);

/* One step with the input sampled at its start, middle and end. Over the step torques and body wrench are the
 * parabola through the three. A force fixed in the world rotates against the body; its b varies linearly between its
 * values at the samples (in second-order methods at start and end). An explicit method of fourth order takes each
 * stage's sample; those of eighth order also take a world force along the parabola. Refuses as laconic_step does. */
laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end);

/* Makes the refusal for the status of a refused step (value: the step, limit: a smaller one to try, if any). If an
 * input is at fault, NOT_FINITE has its field. `inputs`: the held one (input_count 1), or start, middle and end in a
 * row (3). */
void laconic_step_refusal(laconic_refusal *why, laconic_status status, const laconic_model *model,
                          const laconic_integrator *integrator, const laconic_state *state, const laconic_input *inputs,
                          int32_t input_count);

/* The largest step at which a method is stable for this vehicle and state, by damping and gyroscopic limit; 0: any. */
laconic_real laconic_largest_stable_step_s(const laconic_method *method, const laconic_model *model,
                                           const laconic_state *state);

/* Whole number of steps in an interval: n = round(interval/step), at least 1. Refuses STEP_DOES_NOT_FIT where
 * |n·step − interval| exceeds 1e-6 of the *step* (value: step, limit: interval/n), where the interval is not
 * positive and finite, or n not below 9·10¹⁵; NOT_FINITE and NOT_POSITIVE for the step. */
laconic_status laconic_steps_in(double interval_s, double step_s, uint64_t *steps, laconic_refusal *why);

/* -------------------------------------------------------------------------------- outputs -- */

void laconic_nu(const laconic_model *model, const laconic_state *state, laconic_real nu_rad_per_s[3]);

typedef struct laconic_pose {
    laconic_real x_m, y_m;               /* centre of mass S                                      */
    laconic_real origin_x_m, origin_y_m; /* origin of the body frame                              */
    laconic_real heading_rad;            /* unwrapped                                             */
    laconic_real heading_wrapped_rad;    /* in (−π, π]                                            */
} laconic_pose;

void laconic_pose_of(laconic_pose *pose, const laconic_model *model, const laconic_state *state);

/* The pose's x_m, y_m and heading_rad alone, without a sine: for callers that need them at every step. */
void laconic_position(const laconic_state *state, laconic_real *x_m, laconic_real *y_m, laconic_real *heading_rad);

/* An angle in (−π, π], as heading_wrapped_rad is, to the resolution of the given one. */
laconic_real laconic_angle_wrapped(laconic_real angle_rad);

/* v_S in body axes [m/s]; returns the yaw rate [rad/s]. */
laconic_real laconic_body_velocity(const laconic_model *model, const laconic_state *state,
                                   laconic_real velocity_m_per_s[2]);

/* χ' of the model's N wheels [rad/s]. */
void laconic_wheel_speeds(const laconic_model *model, const laconic_state *state, laconic_real *speed_rad_per_s);

/* Torque on each axle, the motor's and the input's without the brake's [N·m]. */
void laconic_wheel_torques(const laconic_model *model, const laconic_state *state, const laconic_input *input,
                           laconic_real *torque_Nm);

/* Kinetic energy T = ½ M R² νᵀAν [J]; constant in free motion without damping. */
laconic_real laconic_energy_J(const laconic_model *model, const laconic_state *state);

/* K = (Aν)₃, the second integral of the free motion (no constraints, no damping) [rad/s]. */
laconic_real laconic_yaw_integral(const laconic_model *model, const laconic_state *state);

/* Right-hand side of (4.7) with forcing and damping, and of the kinematics: for Model Exchange and for tests. ν is
 * first projected onto the motions that the constraints allow. */
typedef struct laconic_rates {
    laconic_real nu_rad_per_s2[3];
    laconic_real x_m_per_s, y_m_per_s, yaw_rate_rad_per_s;
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
} laconic_rates;

void laconic_derivative(laconic_rates *rates, const laconic_model *model, const laconic_real nu_rad_per_s[3],
                        laconic_real heading_rad, const laconic_input *input);

/* --------------------------------------------------------- ground reactions and normal loads -- */

/* Constants of reactions and normal loads, in addition to the model's. */
typedef struct laconic_contact {
    int32_t constraint_count;
    int32_t lateral_row[LACONIC_MAX_WHEELS];            /* row of a fixed wheel's constraint, −1: none      */
    int32_t brake_row[LACONIC_MAX_WHEELS];              /* row of a locked wheel's constraint, −1: none     */
    laconic_real multiplier[2 * LACONIC_MAX_WHEELS][3]; /* κ = multiplier · (Aν' − …): least norm,
                                                 so wheels that share a constraint share its force */
    laconic_real wheel_rows[LACONIC_MAX_WHEELS][3];     /* Ξ                                       */
    laconic_real inverse_arm_per_m[LACONIC_MAX_WHEELS]; /* 1/(R_i sin γ_i)                         */
    laconic_real pull[LACONIC_MAX_WHEELS][2];           /* unit vector along which along_N acts, body axes   */
    laconic_real axle[LACONIC_MAX_WHEELS][2];           /* unit vector of the axle, body axes                */
    laconic_real inertia[3][3];                         /* A                                                 */
    int32_t point_count;                                /* wheels, then supports                             */
    laconic_real point_m[LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS][2];               /* from S, body axes       */
    laconic_real normal_load_of_wrench[LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS][3]; /* least-norm statics */
    laconic_real com_z_m, friction_coefficient;
    laconic_real gravity_m_per_s2; /* g cos α: across the ground                                        */
} laconic_contact;

/* Refuses as laconic_prepare does, and OVERFLOW for these constants (supports, com_z_m). */
laconic_status laconic_contact_prepare(laconic_contact *contact, const laconic_vehicle *vehicle, laconic_refusal *why);

typedef struct laconic_reactions {
    laconic_real along_N[LACONIC_MAX_WHEELS];   /* along the roller's axis; fixed: rolling direction */
    laconic_real lateral_N[LACONIC_MAX_WHEELS]; /* fixed wheels: along the axle; others 0         */
    laconic_real brake_Nm[LACONIC_MAX_WHEELS];  /* locked wheels: torque of the brake; others 0   */
    laconic_real normal_N[LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS]; /* below 0: the point would lift */
    laconic_real no_slip_margin_N; /* least of μ N_i − |reaction_i|; below 0: the wheel would slip;
                                                   NaN or −∞ where a force leaves the scalar's range */
} laconic_reactions;

void laconic_reactions_of(laconic_reactions *reactions, const laconic_contact *contact, const laconic_model *model,
                          const laconic_state *state, const laconic_input *input);

/* ------------------------------------------------------------------------- linearisation -- */

/* A motion at one moment, as outer integrators know it. No rate depends on the position. */
typedef struct laconic_motion {
    laconic_real nu_rad_per_s[3];
    laconic_real heading_rad;
} laconic_motion;

/* A direction in which states and inputs are varied. */
typedef struct laconic_variation {
    laconic_real nu_rad_per_s[3];
    laconic_real x_m, y_m, heading_rad;
    laconic_input input;
} laconic_variation;

/* Derivatives of the outputs along a variation. */
typedef struct laconic_motion_change {
    laconic_real origin_x_m, origin_y_m;
    laconic_real velocity_m_per_s[2], yaw_rate_rad_per_s;
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_real wheel_torque_Nm[LACONIC_MAX_WHEELS];
    laconic_real energy_J;
} laconic_motion_change;

/* Directional derivatives, analytic: (4.7) is quadratic in ν, linear in the voltages and torques, and bilinear in a
 * world force and its point. The margin has no derivative where the least margin passes from one wheel to another
 * (that of the first such wheel is given). It has none where a wheel's reaction is 0 (the reaction counts as
 * constant). `now`: the reactions of the motion. O(N). */
void laconic_derivative_tangent(laconic_rates *change, const laconic_model *model, const laconic_motion *at,
                                const laconic_input *input, const laconic_variation *by);
void laconic_motion_tangent(laconic_motion_change *change, const laconic_model *model, const laconic_motion *at,
                            const laconic_variation *by);
void laconic_reactions_tangent(laconic_reactions *change, const laconic_contact *contact, const laconic_model *model,
                               const laconic_motion *at, const laconic_input *input, const laconic_reactions *now,
                               const laconic_variation *by);

/* ---------------------------------------------------------------------------------- plant -- */

/* Vehicle, model, integrator and state together: FMU, firmware node and host step this struct. */
typedef struct laconic_plant {
    laconic_vehicle vehicle;
    laconic_model model;
    laconic_integrator integrator;
    laconic_state state;
#if LACONIC_WITH_FRICTION
    laconic_friction friction; /* where the vehicle has friction; else `acts` is false and the rest is not set */
    laconic_slip slip;
#endif
    uint64_t steps; /* taken since the start: time is steps · step_s */
} laconic_plant;

/* Constants of a vehicle with friction; `model`: that of laconic_prepare(). Refuses OVERFLOW where a constant leaves
 * the range, and for a drive on ideal ground as laconic_prepare does for a vehicle without friction. */
laconic_status laconic_friction_of(laconic_friction *friction, const laconic_model *model,
                                   const laconic_vehicle *vehicle, laconic_refusal *why);

/* Wheels at their start: with its wheel_speed_rad_per_s, or as they roll at its ν. Refuses NOT_FINITE and OVERFLOW
 * (start_wheel_speed), and on ideal ground as laconic_prepare_ideal and laconic_state_set. */
laconic_status laconic_slip_set(laconic_slip *slip, const laconic_friction *friction, const laconic_vehicle *vehicle,
                                const laconic_start *start, laconic_refusal *why);

/* One step with the input held. Refuses STEP_UNSOLVED (also in eight parts), and OVERFLOW as laconic_step does; state
 * and slip are then as they were. */
laconic_status laconic_friction_step(const laconic_friction *friction, const laconic_model *model, laconic_real step_s,
                                     laconic_state *state, laconic_slip *slip, const laconic_input *held);

/* Kinetic energy of body and wheels. */
laconic_real laconic_friction_energy_J(const laconic_friction *friction, const laconic_state *state,
                                       const laconic_slip *slip);

/* Width of the smooth law below: friction has 71 % of its size at this slip. Robots move at 0.1 m/s and more;
 * creeping at 1 mm/s is small compared with that. Slip decays at the rate μ g/ε ~ 5,000 1/s, which stiff integrators
 * handle without effort. */
#define LACONIC_SMOOTH_SLIP_M_PER_S 1e-3

/* Right-hand side for Model Exchange, by a smooth law: forces along slip/√(slip² + ε²). It has no rest: on a slope a
 * vehicle creeps by some ε. Normal loads are statics at this moment; a drive on ideal ground has no such law. */
void laconic_friction_derivative(laconic_rates *rates, laconic_real wheel_rate_rad_per_s2[],
                                 const laconic_friction *friction, const laconic_model *model,
                                 const laconic_real nu_rad_per_s[3], laconic_real heading_rad,
                                 const laconic_real wheel_speed_rad_per_s[], const laconic_input *input);

/* Writes the results of that law at one moment, as the friction step would: forces, loads, currents and the supply,
 * from ν and the slip's own wheel speeds. Energies stay as they are. */
void laconic_slip_smooth(laconic_slip *slip, const laconic_friction *friction, const laconic_state *state,
                         const laconic_input *input);

/* vehicle → model, method and step → integrator, start → state. A refusal changes nothing. */
laconic_status laconic_plant_start(laconic_plant *plant, const laconic_vehicle *vehicle, const laconic_method *method,
                                   laconic_real step_s, const laconic_start *start, laconic_refusal *why);

/* `steps` steps with the input held. When step k is refused, plant->steps has grown by k − 1. */
laconic_status laconic_plant_run(laconic_plant *plant, const laconic_input *held, uint64_t steps, laconic_refusal *why);

/* One step with the input sampled at its start, middle and end (three in a row): laconic_step_sampled; with friction
 * the input in the middle is held. */
laconic_status laconic_plant_run_sampled(laconic_plant *plant, const laconic_input samples[3], laconic_refusal *why);

/* Back to a start with the same vehicle, method and step; plant->steps is 0 again. A refusal changes nothing. */
laconic_status laconic_plant_restart(laconic_plant *plant, const laconic_start *start, laconic_refusal *why);

/* Speed and angle of each wheel, and the kinetic energy of body and wheels, with friction or without. */
void laconic_plant_wheel_speeds(const laconic_plant *plant, laconic_real *speed_rad_per_s);
void laconic_plant_wheel_angles(const laconic_plant *plant, laconic_real *angle_rad);
laconic_real laconic_plant_energy_J(const laconic_plant *plant);

/* Sets another step size; plant->steps continues to count. */
laconic_status laconic_plant_set_step(laconic_plant *plant, laconic_real step_s, laconic_refusal *why);

/* Another payload, motor, motor_circuit, mass … while the vehicle moves (laconic_state_carry). The wheels must stay as
 * they are; body velocity, wheel speeds and angles stay. Refuses what laconic_plant_start refuses of a vehicle,
 * OVERFLOW, and more wheels (ABOVE_LIMIT, wheel_count); a refusal changes nothing. */
laconic_status laconic_plant_change(laconic_plant *plant, const laconic_vehicle *vehicle, laconic_refusal *why);

/* -------------------------------------------------------------------------------- recording -- */

/* All outputs of a plant at one moment; every member is a number of the scalar type. */
typedef struct laconic_outputs {
    laconic_real nu_rad_per_s[3];
    laconic_real velocity_body_m_per_s[2], yaw_rate_rad_per_s;
    laconic_real energy_J;
    laconic_pose pose;
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS];
    laconic_real wheel_angle_rad[LACONIC_MAX_WHEELS];
    laconic_real wheel_torque_Nm[LACONIC_MAX_WHEELS];
    laconic_reactions reactions;       /* set only where a contact is given                            */
    laconic_friction_outputs friction; /* set only where the vehicle has friction                */
    laconic_input input;               /* what acts from this moment on                                */
    laconic_sensor_outputs sensors;    /* set only where the recorder has sensors                      */
} laconic_outputs;

/* Fills the outputs but reactions and sensors. Items beyond the model's wheels stay as they were. One sine and cosine,
 * O(N). */
void laconic_outputs_of(laconic_outputs *outputs, const laconic_plant *plant, const laconic_input *input);

/* Writes laconic_reactions_of; for a vehicle with friction the forces of the last step. Then lateral_N is the force
 * along u turned by −90°, the axle of a fixed wheel, and brake_Nm the torque that holds a locked one. */
void laconic_plant_reactions(laconic_reactions *reactions, const laconic_plant *plant, const laconic_contact *contact,
                             const laconic_input *input);

/* One instant at which a wheel needed more than the friction available, or a point would have lifted. */
typedef struct laconic_grip_event {
    uint64_t steps;        /* taken before it: its time is steps · step_s                         */
    int32_t point;         /* from 1: the wheels, then the supports; 0: no such instant           */
    laconic_real needed_N; /* size of the reaction                                                */
    laconic_real normal_N; /* normal load N; the friction available is μ N, none where N is below 0 */
    laconic_real margin_N; /* μ normal − needed                                                   */
} laconic_grip_event;

/* Whether the no-slip model was true. Start from all zero. */
typedef struct laconic_grip {
    uint64_t instants, slipping, lifting;        /* instants watched; those with a slip, with a lifted point   */
    laconic_grip_event first_slip, worst_slip;   /* worst: least margin                              */
    laconic_grip_event first_lift, worst_lift;   /* worst: least normal load                         */
    bool wheel_slips[LACONIC_MAX_WHEELS];        /* at some instant                                  */
    laconic_sum slip_loss_J[LACONIC_MAX_WHEELS]; /* on ground with friction: of each wheel, by what the ends of the
                                                    recorded steps show; their sum is that of the plant's book
                                                    if each step's end is recorded once, and no step was divided */
} laconic_grip;

/* Enters one instant. Slip is judged only where the contact has a friction coefficient. A margin or normal load below 0
 * by less than the rank tolerance times the weight is rounding and counts as neither slip nor lift. On ground
 * with friction a recorder notes the wheels that slipped in the step before, and the energy that this took. */
void laconic_grip_watch(laconic_grip *grip, const laconic_contact *contact, const laconic_model *model,
                        const laconic_reactions *reactions, uint64_t steps);

/* Inputs over many steps, of the few signals that a run uses; all other inputs are zero. Held: stretch k holds its
 * values before step until_step[k]. Sampled (until_step NULL): step k has values at its start, middle and end. */
typedef struct laconic_schedule {
    int32_t signal_count;
    const uint32_t *signal;     /* offset of each in laconic_input, in bytes                        */
    const laconic_real *value;  /* signal_count for each stretch; 3·signal_count for each step      */
    const uint64_t *until_step; /* ascending, counted from first_step; NULL: sampled                */
    uint64_t count;             /* of stretches; of steps where sampled                             */
    uint64_t first_step;        /* plant->steps at which the first begins                           */
} laconic_schedule;

/* The inputs of the step that begins after `step` steps of the plant: one that is held until `until_step`, or the three
 * samples of that step alone. Returns how many; 0 where the schedule has ended. */
int32_t laconic_schedule_at(laconic_input inputs[3], uint64_t *until_step, const laconic_schedule *schedule,
                            uint64_t step);

/* The record of a run: rows of chosen outputs, and whether the no-slip model was true. */
typedef struct laconic_recorder {
    const laconic_contact *contact; /* of this plant; NULL: no reactions, which cost as much as some steps */
    laconic_grip *grip;             /* watched at the start of every step; not where it or contact is NULL */
    uint64_t every;                 /* a row at the start of each step whose number it divides; 0: none   */
    int32_t column_count;
    const uint32_t *column; /* offset of each in laconic_outputs, in bytes                  */
    laconic_real *row;      /* space for row_room rows of column_count numbers               */
    uint64_t row_count, row_room;
    laconic_sensors *sensors; /* of this plant, which see every step; NULL: none            */
} laconic_recorder;

/* Takes steps along the schedule until `until_step` of the plant, the schedule's end, or the first row without
 * space. plant->steps is then the number of steps taken, and the next call continues there. A row and the watch take
 * state and input at a step's start. `recorder` may be NULL. Gives the bits of laconic_plant_run and
 * laconic_step_sampled, and refuses as they do. */
laconic_status laconic_plant_follow(laconic_plant *plant, const laconic_schedule *schedule, uint64_t until_step,
                                    laconic_recorder *recorder, laconic_refusal *why);

/* Records one row, and watches the grip, of this moment: for the end of a run. There must be space for the row. */
void laconic_record_row(laconic_recorder *recorder, const laconic_plant *plant, const laconic_input *input);

#ifdef __cplusplus
}
#endif

#include "laconic/build.h" /* a program with other definitions than the library's does not link */

#endif
