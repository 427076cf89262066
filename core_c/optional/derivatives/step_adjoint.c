/* The adjoint of a step: gradients by what was before it, from the gradient by the state after it. Every number by
 * state and input is the product of that covector with a column of the Jacobian: so it is the Jacobian's transpose to
 * the rounding of that sum, also where terms of which the column consists cancel. */
#include "step_chain.h"

/* The product of a covector and a change of the state. */
static real paired(const laconic_state_change *a, const laconic_state_change *b, int32_t wheels) {
    real sum = dot(vec(a->nu_rad_per_s), vec(b->nu_rad_per_s)) + a->x_m * b->x_m + a->y_m * b->y_m +
               a->heading_rad * b->heading_rad;
    for (int32_t i = 0; i < wheels; i++) sum += a->wheel_angle_rad[i] * b->wheel_angle_rad[i];
    return sum;
}

static vector paired_columns(three_columns column, const laconic_state_change *after, int32_t wheels) {
    return vector_of(paired(column[0], after, wheels), paired(column[1], after, wheels),
                     paired(column[2], after, wheels));
}

static void state_gradient(laconic_state_change *before, const core_columns *c, const laconic_state_change *by_heading,
                           const laconic_state_change *after, int32_t wheels) {
    const real heading = paired(by_heading, after, wheels);
    store(before->nu_rad_per_s, paired_columns(by_zeta(c), after, wheels));
    before->heading_rad = heading;
    before->x_m = after->x_m;
    before->y_m = after->y_m;
    for (int32_t i = 0; i < wheels; i++) before->wheel_angle_rad[i] = after->wheel_angle_rad[i];
}

/* The Jacobian is not kept longer than this, so that the rest of the adjoint needs no stack beside it. */
RARE void input_gradient(laconic_input *input, const taken_step *s, const core_columns *c, const laconic_input *held,
                         const laconic_state_change *after) {
    const int32_t wheels = LACONIC_WHEELS(s->at.model);
    laconic_step_jacobian j;
    laconic_torque_columns(&j, s, c);
    laconic_world_columns(&j, s, c, held);
    for (int32_t i = 0; i < wheels; i++) {
        input->voltage_V[i] = paired(&j.by_voltage[i], after, wheels);
        input->axle_torque_Nm[i] = paired(&j.by_axle_torque[i], after, wheels);
    }
    for (int k = 0; k < 2; k++) {
        input->body_force_N[k] = paired(by_constant(c)[k], after, wheels);
        input->world_force_N[k] = paired(&j.by_world_force[k], after, wheels);
        input->world_force_point_m[k] = paired(&j.by_world_force_point[k], after, wheels);
    }
    input->body_moment_Nm = paired(by_constant(c)[2], after, wheels);
}

/* ----------------------------------------------------------------------- constants of the model -- */

/* Gradients by ζ and by the parts of b; those of the rotating part in world axes. */
typedef struct core_gradient {
    vector zeta, constant;
    world_part world;
} core_gradient;

static core_gradient gradient_of(const core_columns *c, const taken_step *s, const laconic_state_change *after) {
    const int32_t wheels = LACONIC_WHEELS(s->at.model);
    const direction back = {s->at.heading.cosine, -s->at.heading.sine};
    const world_part seen = {paired_columns(by_cosine(c), after, wheels), paired_columns(by_sine(c), after, wheels)};
    const core_gradient g = {paired_columns(by_zeta(c), after, wheels), paired_columns(by_constant(c), after, wheels),
                             turned(seen, back)};
    return g;
}

static real paired_world(const core_gradient *g, world_part b) {
    return dot(g->world.cosine, b.cosine) + dot(g->world.sine, b.sine);
}

/* The gradient by one number of a dynamics_change at a time: that number is 1, all others are 0. */
static real dynamics_gradient(taken_step *s, const laconic_state *state, const laconic_state_change *after,
                              const dynamics_change *by) {
    const step_direction in = {no_lanes(), no_lanes(), no_lanes(), no_lanes(), by};
    step_response out;
    laconic_state_change column;
    laconic_respond(s, state, &out, &in, 1);
    laconic_finish_step(&column, 1, s, &in, &out, R(0));
    return paired(&column, after, LACONIC_WHEELS(s->at.model));
}

static void vector_gradient(real gradient[3], taken_step *s, const laconic_state *state,
                            const laconic_state_change *after, dynamics_change *by, vector *varied) {
    for (int k = 0; k < 3; k++) {
        *varied = vector_of(R(k == 0), R(k == 1), R(k == 2));
        gradient[k] = dynamics_gradient(s, state, after, by);
    }
    *varied = none;
}

static void dynamics_gradients(laconic_model_change *out, taken_step *s, const laconic_state *state,
                               const laconic_state_change *after) {
    dynamics_change by = {none, none, none, none, none, {none, none, none}};
    vector_gradient(out->nu_of_zeta[2], s, state, after, &by, &by.yaw);
    vector_gradient(out->gyro, s, state, after, &by, &by.gyro);
    vector_gradient(out->yaw_rate_of_zeta, s, state, after, &by, &by.yaw_rate);
    vector_gradient(out->velocity_of_zeta[0], s, state, after, &by, &by.along);
    vector_gradient(out->velocity_of_zeta[1], s, state, after, &by, &by.across);
    vector_gradient(out->damping_per_s[0], s, state, after, &by, &by.damping.x);
    vector_gradient(out->damping_per_s[1], s, state, after, &by, &by.damping.y);
    vector_gradient(out->damping_per_s[2], s, state, after, &by, &by.damping.z);
}

static void add_scaled(real out[3], real factor, vector v) { store(out, added(vec(out), factor, v)); }

/* Through the rows alone: ν = Gζ at the end, ζ = G⁺ν at the start, wheel angles. */
static void add_row_gradients(laconic_model_change *out, const taken_step *s, const core_gradient *g,
                              const laconic_state_change *after) {
    const vector end = plus(s->at.zeta, s->result.delta), nu = nu_before(s);
    const real zeta[3] = {g->zeta.x, g->zeta.y, g->zeta.z};
    for (int i = 0; i < 3; i++) {
        add_scaled(out->nu_of_zeta[i], after->nu_rad_per_s[i], end);
        store(out->zeta_of_nu[i], scaled(zeta[i], nu));
    }
    for (int32_t i = 0; i < LACONIC_WHEELS(s->at.model); i++)
        store(out->wheel_of_zeta[i], scaled(after->wheel_angle_rad[i], s->result.path));
}

/* Through the constant part of b. */
static void add_forcing_gradients(laconic_model_change *out, const taken_step *s, const core_gradient *g,
                                  const laconic_input *held) {
    const laconic_model *m = s->at.model;
    const vector b = g->constant;
    const real *f = held->body_force_N, moment = held->body_moment_Nm, t = m->torque_scale;
    out->torque_scale = dot(b, b_of_wrench(m, wrench_with(f[0], f[1], moment))) / t;
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++) {
        const real volt = held->voltage_V[i], axle = held->axle_torque_Nm[i];
        const real wheel = dot(b, vec(m->wheel_of_zeta[i]));
        add_scaled(out->wheel_of_zeta[i], m->voltage_scale[own(i)] * volt + t * axle, b);
        out->voltage_scale[i] = volt * wheel;
        out->torque_scale += axle * wheel;
    }
    add_scaled(out->velocity_of_zeta[0], t * f[0], b);
    add_scaled(out->velocity_of_zeta[1], t * f[1], b);
    add_scaled(out->yaw_rate_of_zeta, t * moment, b);
}

/* Through b of a force F (already times torque_scale) at r, whose `along` row is V0 − r_η y, `across` V1 + r_ξ y. */
static void add_world_rows(laconic_model_change *out, const core_gradient *g, real fx, real fy, const real r[2]) {
    const vector along = minus(scaled(fx, g->world.cosine), scaled(-fy, g->world.sine));
    const vector across = minus(scaled(fy, g->world.cosine), scaled(fx, g->world.sine));
    add_scaled(out->velocity_of_zeta[0], R(1), along);
    add_scaled(out->velocity_of_zeta[1], R(1), across);
    add_scaled(out->yaw_rate_of_zeta, -r[1], along);
    add_scaled(out->yaw_rate_of_zeta, r[0], across);
}

static void add_world_gradients(laconic_model_change *out, const taken_step *s, const core_gradient *g,
                                const laconic_input *held) {
    static const real at_s[2] = {R(0), R(0)};
    const laconic_model *m = s->at.model;
    const real *f = held->world_force_N, *r = held->world_force_point_m, *pull = slope_force(m), t = m->torque_scale;
    out->torque_scale += paired_world(g, laconic_world_b(m, f[0], f[1], r));
    out->torque_scale += paired_world(g, laconic_world_b(m, pull[0], pull[1], at_s));
    out->slope_force_N[0] = paired_world(g, laconic_world_b(m, t, R(0), at_s));
    out->slope_force_N[1] = paired_world(g, laconic_world_b(m, R(0), t, at_s));
    add_world_rows(out, g, t * f[0], t * f[1], r);
    add_world_rows(out, g, t * pull[0], t * pull[1], at_s);
}

static void model_gradient(laconic_model_change *out, taken_step *s, const laconic_state *state, const core_columns *c,
                           const laconic_state_change *after, const laconic_input *held) {
    const core_gradient g = gradient_of(c, s, after);
    laconic_model_change fresh = ALL_ZERO;
    dynamics_gradients(&fresh, s, state, after);
    add_row_gradients(&fresh, s, &g, after);
    add_forcing_gradients(&fresh, s, &g, held);
    add_world_gradients(&fresh, s, &g, held);
    *out = fresh;
}

static void set_units(vector axis[3]) {
    for (int k = 0; k < 3; k++) axis[k] = vector_of(R(k == 0), R(k == 1), R(k == 2));
}

laconic_status laconic_step_adjoint_by(laconic_state_change *before, laconic_input *input,
                                       laconic_model_change *by_model, const laconic_derivation *derivation,
                                       const laconic_model *model, const laconic_integrator *integrator,
                                       const laconic_state *state, const laconic_input *held,
                                       const laconic_state_change *after) {
    const bool with_world_force = input != NULL || by_model != NULL;
    taken_step s;
    core_columns c;
    laconic_state_change column[CORE_COLUMNS], by_heading;
    const laconic_status status = laconic_take_step(&s, derivation, model, integrator, state, held, with_world_force);
    if (status != LACONIC_OK) return status;
    for (int k = 0; k < CORE_COLUMNS; k++) c.column[k] = &column[k];
    if (by_model != NULL) {
        set_units(c.zeta);
        set_units(c.constant);
        laconic_core_columns(&c, &s, state);
        model_gradient(by_model, &s, state, &c, after, held);
    }
    laconic_jacobian_directions(&c, model);
    laconic_core_columns(&c, &s, state);
    laconic_heading_column(&by_heading, &s, &c);
    if (input != NULL) input_gradient(input, &s, &c, held, after);
    state_gradient(before, &c, &by_heading, after, LACONIC_WHEELS(model));
    return LACONIC_OK;
}

laconic_status laconic_step_adjoint(laconic_state_change *before, laconic_input *input, laconic_model_change *by_model,
                                    const laconic_model *model, const laconic_integrator *integrator,
                                    const laconic_state *state, const laconic_input *held,
                                    const laconic_state_change *after) {
    return laconic_step_adjoint_by(before, input, by_model, &laconic_derivation_of_all, model, integrator, state, held,
                                   after);
}
