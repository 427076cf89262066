/* Derivatives of a step: how the state after laconic_step() changes with the state before it, the held input and the
 * constants of the model. For filters, predictive control, identification and optimisation.
 *
 *     jacobian   all columns at once           laconic_step_jacobian_of
 *     tangent    one direction, forwards       laconic_step_tangent
 *     adjoint    one covector, backwards       laconic_step_adjoint
 *
 * Optional: a program that calls nothing of it carries nothing of it. Not for vehicles with friction, whose step
 * (laconic_friction_step) is not smooth.
 *
 * What      derivatives of the method's own formulas, not of the exact motion: a filter gets the Jacobian of the
 *           method that it steps with. Exact but for rounding, about 1e-13 of the largest number of the same kind in
 *           double. They include the cut of a gain of energy that no input supplies. Where the rounds of a method of
 *           eighth order with any damping converge late, derivatives take longer.
 * State     here (ν, x, y, θ, χ): 6 + N numbers, in SI units and radians. ν before a step is projected onto the
 *           motions that the constraints allow, as laconic_state_project() does, so a direction that a constraint
 *           forbids has no effect on the velocity, and ν after a step obeys all constraints.
 * Branches  those of the step itself: where auto takes another method in this state, the derivatives are of that one.
 *           A step that is refused has no derivative: its status is returned, and nothing is written.
 * Memory    the caller owns every struct; no heap, at most 24 KB of stack (single: 12 KB; explicit methods of fourth
 *           order a third). No state is changed.
 * Links     every method, since auto may take most of them. A program for which flash counts calls the forms with _by,
 *           which link one method: laconic_derivation. */
#ifndef LACONIC_DERIVATIVES_H
#define LACONIC_DERIVATIVES_H

#include "laconic/laconic.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------- directions and covectors -- */

/* A change of the state, or a gradient by it. Wheels beyond the model's are neither read nor written. */
typedef struct laconic_state_change {
    laconic_real nu_rad_per_s[3];
    laconic_real x_m, y_m; /* of the centre of mass S */
    laconic_real heading_rad;
    laconic_real wheel_angle_rad[LACONIC_MAX_WHEELS];
} laconic_state_change;

/* A change of the constants of a model that a step depends on (laconic_model has their meaning), or a gradient by them.
 * Principal axes jump where two damping rates are equal, as in every symmetrical robot, though the motion does not. So
 * the axes here do not follow the damping: GᵀAG = E stays, and the damping becomes a full symmetric matrix, whose
 * change is damping_per_s. */
typedef struct laconic_model_change {
    laconic_real nu_of_zeta[3][3];                     /* of G                                            */
    laconic_real zeta_of_nu[3][3];                     /* of G⁺ = (GᵀG)⁻¹Gᵀ, with the constraints          */
    laconic_real gyro[3];                              /* of w                                            */
    laconic_real damping_per_s[3][3];                  /* of diag(r): symmetric                           */
    laconic_real velocity_of_zeta[2][3];               /* of R G₀, R G₁                                   */
    laconic_real yaw_rate_of_zeta[3];                  /* of g/Λ                                          */
    laconic_real wheel_of_zeta[LACONIC_MAX_WHEELS][3]; /* of ΞG                                           */
    laconic_real torque_scale;                         /* of 1/(M R²)                                     */
    laconic_real voltage_scale[LACONIC_MAX_WHEELS];    /* of c1_i/(M R²), for each wheel                  */
    laconic_real slope_force_N[2];                     /* of the slope's pull                             */
} laconic_model_change;

/* How a model changes with its vehicle: `by` has a change in each member that is a number of type laconic_real, and
 * 0 in members that do not change. Exact, also where damping rates coincide. An own value of a wheel (own_radius_m
 * …) that is 0 means the vehicle's and follows it; its own change is not read. Does not act, as on every step:
 * com_z_m, supports, friction coefficients, drive. If wheels share a constraint (two on one axle line), a change
 * that separates them has no derivative. The constraint then follows the least-squares fit of both. `model`: that of
 * `vehicle`. Refuses METHOD_WITHOUT_FRICTION. O(N). */
laconic_status laconic_model_tangent(laconic_model_change *change, const laconic_model *model,
                                     const laconic_vehicle *vehicle, const laconic_vehicle *by);

/* ---------------------------------------------------------------------------------- methods -- */

/* Which methods' steps are differentiated. A function that takes one (…_by) links the methods that it names and no
 * other, as laconic_integrator_prepare() does with its method, and refuses METHOD_UNKNOWN for an integrator of
 * another. The derivation of auto has all that auto may choose; by laconic_integrator.stiff a robot needs that of
 * auto_fast or auto_slow alone. The members are the core's own. */
#define LACONIC_DERIVED_METHODS 12
typedef struct laconic_derived_method laconic_derived_method;
typedef struct laconic_derivation {
    const laconic_derived_method *method[LACONIC_DERIVED_METHODS]; /* NULL after the last */
} laconic_derivation;

extern const laconic_derivation laconic_derivation_of_rk4, laconic_derivation_of_taylor_8,
    laconic_derivation_of_exponential_gauss_8, laconic_derivation_of_exponential_kahan,
    laconic_derivation_of_exponential_kahan_4, laconic_derivation_of_exact_flow, laconic_derivation_of_exact_flow_4,
    laconic_derivation_of_auto, laconic_derivation_of_auto_slow, laconic_derivation_of_auto_fast,
    laconic_derivation_of_all;

/* --------------------------------------------------------------------------------- jacobian -- */

/* Columns: the change of the state after the step for each number before it. Those of x, y and the wheel angles are not
 * kept: no rate depends on them, so each changes itself alone, by 1. */
typedef struct laconic_step_jacobian {
    laconic_state_change by_nu[3], by_heading;
    laconic_state_change by_voltage[LACONIC_MAX_WHEELS], by_axle_torque[LACONIC_MAX_WHEELS];
    laconic_state_change by_body_force[2], by_body_moment;
    bool has_world_force; /* whether the next two are set */
    laconic_state_change by_world_force[2], by_world_force_point[2];
} laconic_step_jacobian;

/* All columns. Those of the world force are set where one acts, or a slope, or `with_world_force` asks for them; they
 * cost as much as all others. */
laconic_status laconic_step_jacobian_of(laconic_step_jacobian *jacobian, const laconic_model *model,
                                        const laconic_integrator *integrator, const laconic_state *state,
                                        const laconic_input *held, bool with_world_force);
laconic_status laconic_step_jacobian_by(laconic_step_jacobian *jacobian, const laconic_derivation *derivation,
                                        const laconic_model *model, const laconic_integrator *integrator,
                                        const laconic_state *state, const laconic_input *held, bool with_world_force);

/* The numbers of laconic_input that a model has: N voltages, N axle torques, body force (2), body moment, world force
 * (2), its point (2). */
#define LACONIC_INPUT_NUMBERS(wheel_count) (2 * (wheel_count) + 7)

/* Matrices of a Jacobian, row by row: (6 + N) × (6 + N) by the state, (6 + N) × (2N + 7) by the input, in the orders of
 * laconic_state_change and laconic_input. Columns of a world force that are not set are 0. */
void laconic_jacobian_by_state(laconic_real *matrix, const laconic_step_jacobian *jacobian, const laconic_model *model);
void laconic_jacobian_by_input(laconic_real *matrix, const laconic_step_jacobian *jacobian, const laconic_model *model);

/* ------------------------------------------------------------------------ tangent and adjoint -- */

/* The change of the state after the step along a direction. `input` and `model` may be NULL: they stay.  */
laconic_status laconic_step_tangent(laconic_state_change *after, const laconic_model *model,
                                    const laconic_integrator *integrator, const laconic_state *state,
                                    const laconic_input *held, const laconic_state_change *before,
                                    const laconic_input *input, const laconic_model_change *by_model);
laconic_status laconic_step_tangent_by(laconic_state_change *after, const laconic_derivation *derivation,
                                       const laconic_model *model, const laconic_integrator *integrator,
                                       const laconic_state *state, const laconic_input *held,
                                       const laconic_state_change *before, const laconic_input *input,
                                       const laconic_model_change *by_model);

/* The gradients by state, input and model before the step of the number whose gradient by the state after it is
 * `after`: the transpose of laconic_step_tangent(). `input` and `by_model` may be NULL: not wanted. Over many steps
 * call it backwards with the states that the run passed. Costs as much as the Jacobian, and with `by_model` some
 * three times that. */
laconic_status laconic_step_adjoint(laconic_state_change *before, laconic_input *input, laconic_model_change *by_model,
                                    const laconic_model *model, const laconic_integrator *integrator,
                                    const laconic_state *state, const laconic_input *held,
                                    const laconic_state_change *after);
laconic_status laconic_step_adjoint_by(laconic_state_change *before, laconic_input *input,
                                       laconic_model_change *by_model, const laconic_derivation *derivation,
                                       const laconic_model *model, const laconic_integrator *integrator,
                                       const laconic_state *state, const laconic_input *held,
                                       const laconic_state_change *after);

#ifdef __cplusplus
}
#endif
#endif
