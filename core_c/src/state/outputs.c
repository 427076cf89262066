/* The outputs of a state: velocities, position and pose, wheels, energy; their derivatives along a variation; and all
 * of them together. */
#include "step_internals.h"

/* ----------------------------------------------------------------------------- velocities -- */

static void velocity_of(const laconic_model *model, vector zeta, real velocity_m_per_s[2], real *yaw_rate_rad_per_s) {
    velocity_m_per_s[0] = dot(vec(model->velocity_of_zeta[0]), zeta);
    velocity_m_per_s[1] = dot(vec(model->velocity_of_zeta[1]), zeta);
    *yaw_rate_rad_per_s = dot(vec(model->yaw_rate_of_zeta), zeta);
}

void laconic_nu(const laconic_model *model, const laconic_state *state, laconic_real nu_rad_per_s[3]) {
    const vector zeta = zeta_of(state);
    for (int k = 0; k < 3; k++) nu_rad_per_s[k] = dot(vec(model->nu_of_zeta[k]), zeta);
}

laconic_real laconic_body_velocity(const laconic_model *model, const laconic_state *state,
                                   laconic_real velocity_m_per_s[2]) {
    real yaw_rate;
    velocity_of(model, zeta_of(state), velocity_m_per_s, &yaw_rate);
    return yaw_rate;
}

/* ----------------------------------------------------------------------- position and pose -- */

void laconic_position(const laconic_state *state, laconic_real *x_m, laconic_real *y_m, laconic_real *heading_rad) {
    *x_m = state->x_m.value;
    *y_m = state->y_m.value;
    *heading_rad = heading_unwrapped(&state->heading);
}

laconic_real laconic_angle_wrapped(laconic_real angle_rad) {
    const laconic_heading heading = {0, laconic_binary_angle_of(angle_rad), R(0)};
    return heading_wrapped(&heading);
}

/* The body's origin Q is at (x, y) − Rot(θ) s, with s the vector from Q to S in body axes. */
void laconic_pose_of(laconic_pose *pose, const laconic_model *model, const laconic_state *state) {
    const direction heading = laconic_direction_of_binary_angle(state->heading.fraction);
    const real sx = model->com_x_m, sy = model->com_y_m;
    pose->x_m = state->x_m.value;
    pose->y_m = state->y_m.value;
    pose->origin_x_m = pose->x_m - (heading.cosine * sx - heading.sine * sy);
    pose->origin_y_m = pose->y_m - (heading.sine * sx + heading.cosine * sy);
    pose->heading_rad = heading_unwrapped(&state->heading);
    pose->heading_wrapped_rad = heading_wrapped(&state->heading);
}

/* --------------------------------------------------------------------------------- wheels -- */

/* χ' = Ξ ν */
static void speeds_of(const laconic_model *model, vector zeta, real *speed_rad_per_s) {
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++) speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), zeta);
}

void laconic_wheel_speeds(const laconic_model *model, const laconic_state *state, laconic_real *speed_rad_per_s) {
    speeds_of(model, zeta_of(state), speed_rad_per_s);
}

/* χ' = wheel_of_zeta · ζ, hence χ = wheel_of_zeta · ∫ζ dt: a step needs no operation for each wheel. */
void laconic_wheel_angles(const laconic_model *model, const laconic_state *state, laconic_real *angle_rad) {
    const vector travel = {state->travel[0].value, state->travel[1].value, state->travel[2].value};
    const vector rest = {state->travel[0].rest, state->travel[1].rest, state->travel[2].rest};
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++) {
        const vector row = vec(model->wheel_of_zeta[i]);
        angle_rad[i] = state->wheel_angle_set_rad[i] + (dot(row, travel) + dot(row, rest));
    }
}

void laconic_wheel_angles_set(const laconic_model *model, laconic_state *state, const laconic_real *angle_rad) {
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++) state->wheel_angle_set_rad[i] = angle_rad[i];
    for (int32_t i = 0; i < 3; i++) state->travel[i] = sum_of(R(0));
}

/* M_i = c1_i U_i − c2_i χ_i' + T_i */
static void torques_of(const laconic_model *model, const real *speed_rad_per_s, const laconic_input *input,
                       real *torque_Nm) {
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++)
        torque_Nm[i] = model->motor_gain_Nm_per_V[own(i)] * input->voltage_V[i] -
                       model->motor_damping_Nms[own(i)] * speed_rad_per_s[i] + input->axle_torque_Nm[i];
}

void laconic_wheel_torques(const laconic_model *model, const laconic_state *state, const laconic_input *input,
                           laconic_real *torque_Nm) {
    laconic_wheel_speeds(model, state, torque_Nm);
    torques_of(model, torque_Nm, input, torque_Nm);
}

/* ------------------------------------------------------ the two integrals of the free motion -- */

/* M R² ζ·ζ = M R² νᵀAν = 2T; of two different motions, the bilinear form. */
static real energy_of(const laconic_model *model, vector zeta, vector other) {
    return dot(zeta, other) * (model->mass_kg * model->wheel_radius_m * model->wheel_radius_m);
}

laconic_real laconic_energy_J(const laconic_model *model, const laconic_state *state) {
    const vector zeta = zeta_of(state);
    return R(0.5) * energy_of(model, zeta, zeta);
}

/* A G is the transpose of G⁺; where one rotation made the axes, A G = V diag(√(1 + λ²x)) = G diag(1 + λ²x), as
 * G = V diag(1/√(1 + λ²x)). */
laconic_real laconic_yaw_integral(const laconic_model *model, const laconic_state *state) {
    real sum = R(0);
    for (int k = 0; k < 3; k++) {
        const real row = rotated_twice(model) ? inverse_row(model, k)[2] : model->nu_of_zeta[2][k] * model->inertia[k];
        sum += row * state->zeta[k].value;
    }
    return sum;
}

/* ------------------------------------------------------------------------ all, and changes -- */

void laconic_outputs_of(laconic_outputs *outputs, const laconic_plant *plant, const laconic_input *input) {
    const laconic_model *model = &plant->model;
    const laconic_state *state = &plant->state;
    laconic_nu(model, state, outputs->nu_rad_per_s);
    outputs->yaw_rate_rad_per_s = laconic_body_velocity(model, state, outputs->velocity_body_m_per_s);
    outputs->energy_J = laconic_energy_J(model, state);
    laconic_pose_of(&outputs->pose, model, state);
    laconic_wheel_speeds(model, state, outputs->wheel_speed_rad_per_s);
    laconic_wheel_angles(model, state, outputs->wheel_angle_rad);
    laconic_wheel_torques(model, state, input, outputs->wheel_torque_Nm);
#if LACONIC_WITH_FRICTION
    if (plant->friction.acts) laconic_friction_outputs_of(outputs, plant, input);
#endif
    outputs->input = *input;
}

void laconic_plant_reactions(laconic_reactions *reactions, const laconic_plant *plant, const laconic_contact *contact,
                             const laconic_input *input) {
#if LACONIC_WITH_FRICTION
    if (plant->friction.acts) {
        laconic_friction_reactions_of(reactions, plant, input);
        return;
    }
#endif
    laconic_reactions_of(reactions, contact, &plant->model, &plant->state, input);
}

/* All but origin and energy are linear in ζ and the input: the derivative is the same function of the variation. */
void laconic_motion_tangent(laconic_motion_change *change, const laconic_model *model, const laconic_motion *at,
                            const laconic_variation *by) {
    const direction heading = laconic_direction_of_angle(at->heading_rad);
    const vector zeta = zeta_of_nu(model, at->nu_rad_per_s), d_zeta = zeta_of_nu(model, by->nu_rad_per_s);
    const real sx = model->com_x_m, sy = model->com_y_m, yaw = by->heading_rad;
    change->origin_x_m = by->x_m + yaw * (heading.sine * sx + heading.cosine * sy);
    change->origin_y_m = by->y_m - yaw * (heading.cosine * sx - heading.sine * sy);
    velocity_of(model, d_zeta, change->velocity_m_per_s, &change->yaw_rate_rad_per_s);
    change->energy_J = energy_of(model, zeta, d_zeta);
    speeds_of(model, d_zeta, change->wheel_speed_rad_per_s);
    torques_of(model, change->wheel_speed_rad_per_s, &by->input, change->wheel_torque_Nm);
}
