/* Jacobian, tangent and adjoint of a step. A step's only nonlinearity is in ζ, three numbers, and the heading: the
 * methods' files answer directions of ζ, forcing and dynamics, and all else is chained to that linearly here. */
#include "step_chain.h"

/* -------------------------------------------------------------------- the step that is taken -- */

/* NULL: the derivation is of other methods. */
static const laconic_derived_method *derived(const laconic_derivation *derivation, const laconic_method *chosen) {
    /* cannot be reached: every list ends with NULL */
    for (int i = 0; i < LACONIC_DERIVED_METHODS && derivation->method[i] != NULL; i++)
        if (derivation->method[i]->chosen == chosen) return derivation->method[i];
    return NULL;
}

/* Takes the step on a copy of the state. */
static laconic_status find_responder(taken_step *s, const laconic_derivation *derivation, const laconic_model *model,
                                     const laconic_integrator *integrator, const laconic_state *state,
                                     const laconic_forcing *forcing) {
    const laconic_forcing_samples samples = {forcing, forcing, forcing, !forcing->rotates};
    const laconic_derived_method *of = derived(derivation, integrator->chosen);
    laconic_state after = *state;
    laconic_status status = LACONIC_METHOD_UNKNOWN;
    if (of == NULL) return status;
    for (int i = 0; i < 3 && status != LACONIC_OK && of->tried[i].method != NULL; i++) {
        s->responds = of->tried[i].responds;
        status = of->tried[i].method->step(model, integrator, &after, &samples);
    }
    s->end = zeta_of(&after);
    return status;
}

laconic_status laconic_take_step(taken_step *s, const laconic_derivation *derivation, const laconic_model *model,
                                 const laconic_integrator *integrator, const laconic_state *state,
                                 const laconic_input *held, bool with_world_force) {
    laconic_forcing forcing;
    if (zero_if_finite(world_force_point(held)) != R(0) || !heading_has_room(&state->heading)) return LACONIC_OVERFLOW;
    forcing_of(&forcing, model, held);
    const laconic_status status = find_responder(s, derivation, model, integrator, state, &forcing);
    if (status != LACONIC_OK) return status;
    s->at.model = model;
    s->at.integrator = integrator;
    s->at.zeta = zeta_of(state);
    s->at.constant = vec(forcing.constant);
    s->at.cosine = s->at.sine = none;
    s->at.heading = laconic_direction_of_binary_angle(state->heading.fraction);
    s->at.rotates = forcing.rotates || with_world_force;
    if (forcing.rotates) {
        const world_part b = {vec(forcing.cosine), vec(forcing.sine)}, seen = turned(b, s->at.heading);
        s->at.cosine = seen.cosine;
        s->at.sine = seen.sine;
    }
    return LACONIC_OK;
}

void laconic_respond(taken_step *s, const laconic_state *state, step_response out[], const step_direction in[],
                     int32_t count) {
    s->responds(&s->result, out, &s->at, in, count);
    laconic_cut_responses(s, out, in, count);
    const pose_change *moved = &s->result.moved;
    s->middle = laconic_direction_of_binary_angle(
        (laconic_binary_angle)(state->heading.fraction + laconic_binary_angle_of(R(0.5) * moved->yaw_change_rad)));
    s->x_m = s->middle.cosine * moved->along_m - s->middle.sine * moved->across_m;
    s->y_m = s->middle.sine * moved->along_m + s->middle.cosine * moved->across_m;
}

/* Along the directions of the first `count` lanes: best a constant for the compiler. */
INLINE void finish(laconic_state_change *const after[], int count, const taken_step *s, const step_direction *in,
                   const step_response *by, real heading_rad) {
    const laconic_model *m = s->at.model;
    const lanes zeta = lanes_plus(in->zeta, by->delta);
    const lane turn = heading_rad + R(0.5) * by->yaw_change_rad, heading = heading_rad + by->yaw_change_rad;
    const lane x = s->middle.cosine * by->along_m - s->middle.sine * by->across_m - turn * s->y_m;
    const lane y = s->middle.sine * by->along_m + s->middle.cosine * by->across_m + turn * s->x_m;
    for (int i = 0; i < 3; i++) {
        const lane nu = lanes_dot(vec(m->nu_of_zeta[i]), zeta);
        for (int k = 0; k < count; k++) after[k]->nu_rad_per_s[i] = lane_number(nu, k);
    }
    for (int k = 0; k < count; k++) {
        after[k]->x_m = lane_number(x, k);
        after[k]->y_m = lane_number(y, k);
        after[k]->heading_rad = lane_number(heading, k);
    }
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++) {
        const lane angle = lanes_dot(vec(m->wheel_of_zeta[i]), by->path);
        for (int k = 0; k < count; k++) after[k]->wheel_angle_rad[i] = lane_number(angle, k);
    }
}

void laconic_finish_step(laconic_state_change after[], int count, const taken_step *s, const step_direction *in,
                         const step_response *by, real heading_rad) {
    laconic_state_change *each[LANES];
    for (int k = 0; k < count; k++) each[k] = &after[k];
    finish(each, count, s, in, by, heading_rad);
}

/* -------------------------------------------------------------------- forcing along directions -- */

world_part laconic_world_b(const laconic_model *m, real fx, real fy, const real r[2]) {
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const vector along = added(vec(m->velocity_of_zeta[0]), -r[1], yaw);
    const vector across = added(vec(m->velocity_of_zeta[1]), r[0], yaw);
    const world_part b = {plus(scaled(fx, along), scaled(fy, across)), minus(scaled(fy, along), scaled(fx, across))};
    return b;
}

/* Of the same force where its point alone moves. */
static world_part moved_point_b(const laconic_model *m, real fx, real fy, const real dr[2]) {
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const world_part b = {scaled(fy * dr[0] - fx * dr[1], yaw), scaled(-(fy * dr[1]) - fx * dr[0], yaw)};
    return b;
}

/* Changes of b with the model's constants. */
static vector constant_by_model(const laconic_model *m, const laconic_model_change *by, const laconic_input *in) {
    vector b = none;
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++) {
        const real torque = m->voltage_scale[own(i)] * in->voltage_V[i] + m->torque_scale * in->axle_torque_Nm[i];
        const real change = by->voltage_scale[i] * in->voltage_V[i] + by->torque_scale * in->axle_torque_Nm[i];
        b = plus(b, plus(scaled(change, vec(m->wheel_of_zeta[i])), scaled(torque, vec(by->wheel_of_zeta[i]))));
    }
    const real *f = in->body_force_N;
    b = added(b, by->torque_scale / m->torque_scale, b_of_wrench(m, wrench_with(f[0], f[1], in->body_moment_Nm)));
    b = added(b, m->torque_scale * f[0], vec(by->velocity_of_zeta[0]));
    b = added(b, m->torque_scale * f[1], vec(by->velocity_of_zeta[1]));
    return added(b, m->torque_scale * in->body_moment_Nm, vec(by->yaw_rate_of_zeta));
}

/* A force's b with the rows of a change of the model in place of the model's. */
static world_part world_b_of_rows(const laconic_model_change *by, real fx, real fy, const real r[2]) {
    const vector yaw = vec(by->yaw_rate_of_zeta);
    const vector along = added(vec(by->velocity_of_zeta[0]), -r[1], yaw);
    const vector across = added(vec(by->velocity_of_zeta[1]), r[0], yaw);
    const world_part b = {plus(scaled(fx, along), scaled(fy, across)), minus(scaled(fy, along), scaled(fx, across))};
    return b;
}

static const real at_s[2] = {R(0), R(0)};

static world_part world_by_model(const laconic_model *m, const laconic_model_change *by, const laconic_input *in) {
    const real *f = in->world_force_N, *r = in->world_force_point_m, *pull = slope_force(m);
    const real *more = by->slope_force_N, t = m->torque_scale, dt = by->torque_scale;
    const world_part force =
        both(laconic_world_b(m, dt * f[0], dt * f[1], r), world_b_of_rows(by, t * f[0], t * f[1], r));
    const world_part slope = both(laconic_world_b(m, dt * pull[0] + t * more[0], dt * pull[1] + t * more[1], at_s),
                                  world_b_of_rows(by, t * pull[0], t * pull[1], at_s));
    return both(force, slope);
}

world_part laconic_world_b_by_input(const laconic_model *m, const laconic_input *by, const laconic_input *in) {
    const real t = m->torque_scale, *f = in->world_force_N, *df = by->world_force_N;
    return both(laconic_world_b(m, t * df[0], t * df[1], in->world_force_point_m),
                moved_point_b(m, t * f[0], t * f[1], by->world_force_point_m));
}

static void dynamics_of(dynamics_change *out, const laconic_model_change *by) {
    out->yaw = vec(by->nu_of_zeta[2]);
    out->gyro = vec(by->gyro);
    out->yaw_rate = vec(by->yaw_rate_of_zeta);
    out->along = vec(by->velocity_of_zeta[0]);
    out->across = vec(by->velocity_of_zeta[1]);
    out->damping.x = vec(by->damping_per_s[0]);
    out->damping.y = vec(by->damping_per_s[1]);
    out->damping.z = vec(by->damping_per_s[2]);
}

/* ---------------------------------------------------------------------------------- tangent -- */

static bool varies_world_force(const laconic_input *by) {
    return by != NULL && acts(by->world_force_N[0], by->world_force_N[1], R(0));
}

static bool varies_slope(const laconic_model_change *by) {
    return by != NULL && acts(by->slope_force_N[0], by->slope_force_N[1], R(0));
}

static void add_forcing(step_direction *d, const taken_step *s, real heading_rad, const laconic_input *held,
                        const laconic_input *input, const laconic_model_change *by) {
    const laconic_model *m = s->at.model;
    world_part world = {none, none};
    vector constant = none;
    if (input != NULL) {
        const real *f = input->body_force_N;
        constant = plus(b_of_torques(m, input), b_of_wrench(m, wrench_with(f[0], f[1], input->body_moment_Nm)));
        world = laconic_world_b_by_input(m, input, held);
    }
    if (by != NULL) {
        constant = plus(constant, constant_by_model(m, by, held));
        world = both(world, world_by_model(m, by, held));
    }
    world = turned(world, s->at.heading);
    d->constant = lanes_of(constant);
    d->cosine = lanes_of(added(world.cosine, heading_rad, s->at.sine));
    d->sine = lanes_of(added(world.sine, -heading_rad, s->at.cosine));
}

/* What follows from the model's rows alone. */
static void add_rows(laconic_state_change *after, const taken_step *s, const laconic_model_change *by) {
    const vector end = plus(s->at.zeta, s->result.delta);
    const vector nu = plus(vec(after->nu_rad_per_s), mapped_rows(by->nu_of_zeta, end));
    store(after->nu_rad_per_s, nu);
    for (int32_t i = 0; i < LACONIC_WHEELS(s->at.model); i++)
        after->wheel_angle_rad[i] += dot(vec(by->wheel_of_zeta[i]), s->result.path);
}

laconic_status laconic_step_tangent_by(laconic_state_change *after, const laconic_derivation *derivation,
                                       const laconic_model *model, const laconic_integrator *integrator,
                                       const laconic_state *state, const laconic_input *held,
                                       const laconic_state_change *before, const laconic_input *input,
                                       const laconic_model_change *by_model) {
    taken_step s;
    step_direction d;
    step_response out;
    dynamics_change dynamics;
    const laconic_status status = laconic_take_step(&s, derivation, model, integrator, state, held,
                                                    varies_world_force(input) || varies_slope(by_model));
    if (status != LACONIC_OK) return status;
    vector zeta = zeta_of_nu(model, before->nu_rad_per_s);
    d.model = NULL;
    if (by_model != NULL) {
        zeta = plus(zeta, mapped_rows(by_model->zeta_of_nu, nu_before(&s)));
        dynamics_of(&dynamics, by_model);
        d.model = &dynamics;
    }
    d.zeta = lanes_of(zeta);
    add_forcing(&d, &s, before->heading_rad, held, input, by_model);
    laconic_respond(&s, state, &out, &d, 1);
    laconic_finish_step(after, 1, &s, &d, &out, before->heading_rad);
    if (by_model != NULL) add_rows(after, &s, by_model);
    after->x_m += before->x_m;
    after->y_m += before->y_m;
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++) after->wheel_angle_rad[i] += before->wheel_angle_rad[i];
    return LACONIC_OK;
}

/* --------------------------------------------------------------------------------- jacobian -- */

#define GROUPS(columns) (((columns) + LANES - 1) / LANES)

/* Column i of G⁺. */
static inline vector zeta_of_unit_nu(const laconic_model *m, int i) {
    if (rotated_twice(m)) return vector_of(inverse_row(m, 0)[i], inverse_row(m, 1)[i], inverse_row(m, 2)[i]);
    return times(vec(m->inertia), vec(m->nu_of_zeta[i]));
}

void laconic_jacobian_directions(core_columns *c, const laconic_model *m) {
    for (int i = 0; i < 3; i++) c->zeta[i] = zeta_of_unit_nu(m, i);
    for (int k = 0; k < 2; k++) c->constant[k] = scaled(m->torque_scale, vec(m->velocity_of_zeta[k]));
    c->constant[2] = scaled(m->torque_scale, vec(m->yaw_rate_of_zeta));
}

/* The rotating parts vary along unit vectors: they follow one another in a step_direction. */
static void set_directions(step_direction in[], const core_columns *c, int columns) {
    const step_direction still = {no_lanes(), no_lanes(), no_lanes(), no_lanes(), NULL};
    for (int n = 0; n < GROUPS(columns); n++) in[n] = still;
    for (int k = 0; k < 3; k++) {
        set_lane_vector(&in[k / LANES].zeta, k % LANES, c->zeta[k]);
        set_lane_vector(&in[(3 + k) / LANES].constant, (3 + k) % LANES, c->constant[k]);
    }
    for (int k = CORE_COLUMNS / 2; k < columns; k++) set_lane((lane *)(void *)&in[k / LANES] + k, k % LANES, R(1));
}

/* Columns that fill a group in part are followed by others that fill the rest: what is not wanted is overwritten or
 * not read. */
void laconic_core_columns(const core_columns *c, taken_step *s, const laconic_state *state) {
    const int columns = s->at.rotates ? CORE_COLUMNS : CORE_COLUMNS / 2, groups = GROUPS(columns);
    step_direction in[GROUPS(CORE_COLUMNS)];
    step_response out[GROUPS(CORE_COLUMNS)];
    set_directions(in, c, columns);
    laconic_respond(s, state, out, in, groups);
    for (int n = 0; n < groups; n++) finish(&c->column[n * LANES], LANES, s, &in[n], &out[n], R(0));
}

/* A change of the state seen as one row of 6 + N numbers: it holds nothing else. */
#define HEAD 6
static inline const real *row_of(const laconic_state_change *change) { return (const real *)(const void *)change; }

/* Σ weight_k column_k. The head has a loop of its own, of a length that compilers know. */
static void weighed(laconic_state_change *restrict out, three_columns column, vector weight, int32_t wheels) {
    const real *restrict a = row_of(column[0]), *restrict b = row_of(column[1]), *restrict c = row_of(column[2]);
    real *restrict to = (real *)(void *)out;
    const real x = weight.x, y = weight.y, z = weight.z;
    for (int32_t i = 0; i < HEAD; i++) to[i] = x * a[i] + y * b[i] + z * c[i];
    for (int32_t i = HEAD; i < HEAD + wheels; i++) to[i] = x * a[i] + y * b[i] + z * c[i];
}

static void set_zero(laconic_state_change *out, int32_t wheels) {
    real *to = (real *)(void *)out;
    for (int32_t i = 0; i < HEAD + wheels; i++) to[i] = R(0);
}

static void set_scaled(laconic_state_change *restrict out, real factor, const laconic_state_change *restrict column,
                       int32_t wheels) {
    const real *from = row_of(column);
    real *to = (real *)(void *)out;
    for (int32_t i = 0; i < HEAD; i++) to[i] = factor * from[i];
    for (int32_t i = HEAD; i < HEAD + wheels; i++) to[i] = factor * from[i];
}

static void add_change(laconic_state_change *out, const laconic_state_change *more, int32_t wheels) {
    const real *from = row_of(more);
    real *to = (real *)(void *)out;
    for (int32_t i = 0; i < HEAD + wheels; i++) to[i] += from[i];
}

static void by_world_part(laconic_state_change *out, const core_columns *c, world_part b, int32_t wheels) {
    laconic_state_change sine;
    weighed(out, by_cosine(c), b.cosine, wheels);
    weighed(&sine, by_sine(c), b.sine, wheels);
    add_change(out, &sine, wheels);
}

/* A further yaw at the start turns the displacement, and a force fixed in the world against the body. */
void laconic_heading_column(laconic_state_change *out, const taken_step *s, const core_columns *c) {
    const int32_t wheels = LACONIC_WHEELS(s->at.model);
    const world_part seen = {s->at.sine, scaled(R(-1), s->at.cosine)};
    if (s->at.rotates) {
        by_world_part(out, c, seen, wheels);
    } else {
        set_zero(out, wheels);
    }
    out->x_m -= s->y_m;
    out->y_m += s->x_m;
    out->heading_rad += R(1);
}

void laconic_world_columns(laconic_step_jacobian *j, const taken_step *s, const core_columns *c,
                           const laconic_input *held) {
    const laconic_model *m = s->at.model;
    j->has_world_force = s->at.rotates;
    if (!s->at.rotates) return;
    for (int k = 0; k < 2; k++) {
        laconic_input by = ALL_ZERO;
        by.world_force_N[k] = R(1);
        by_world_part(&j->by_world_force[k], c, turned(laconic_world_b_by_input(m, &by, held), s->at.heading),
                      LACONIC_WHEELS(m));
        by.world_force_N[k] = R(0);
        by.world_force_point_m[k] = R(1);
        by_world_part(&j->by_world_force_point[k], c, turned(laconic_world_b_by_input(m, &by, held), s->at.heading),
                      LACONIC_WHEELS(m));
    }
}

/* The forcing of an axle torque is that of a force and a moment on the body: with w = ΞG, Ξ = wG⁺. */
void laconic_torque_columns(laconic_step_jacobian *j, const taken_step *s, const core_columns *c) {
    const laconic_model *m = s->at.model;
    const int32_t wheels = LACONIC_WHEELS(m);
    const real per_radius = R(1) / m->wheel_radius_m;
    for (int32_t i = 0; i < wheels; i++) {
        const vector w = vec(m->wheel_of_zeta[i]);
        const vector body = vector_of(per_radius * dot(w, c->zeta[0]), per_radius * dot(w, c->zeta[1]),
                                      m->yaw_scale * dot(w, c->zeta[2]));
        weighed(&j->by_axle_torque[i], by_constant(c), body, wheels);
        set_scaled(&j->by_voltage[i], m->motor_gain_Nm_per_V[own(i)], &j->by_axle_torque[i], wheels);
    }
}

/* The first six columns are the Jacobian's own. */
static void place_columns(core_columns *c, laconic_step_jacobian *j, laconic_state_change rotating[CORE_COLUMNS / 2]) {
    for (int k = 0; k < 3; k++) c->column[k] = &j->by_nu[k];
    for (int k = 0; k < 2; k++) c->column[3 + k] = &j->by_body_force[k];
    c->column[5] = &j->by_body_moment;
    for (int k = CORE_COLUMNS / 2; k < CORE_COLUMNS; k++) c->column[k] = &rotating[k - CORE_COLUMNS / 2];
}

laconic_status laconic_step_jacobian_by(laconic_step_jacobian *jacobian, const laconic_derivation *derivation,
                                        const laconic_model *model, const laconic_integrator *integrator,
                                        const laconic_state *state, const laconic_input *held, bool with_world_force) {
    taken_step s;
    core_columns c;
    laconic_state_change rotating[CORE_COLUMNS / 2];
    const laconic_status status = laconic_take_step(&s, derivation, model, integrator, state, held, with_world_force);
    if (status != LACONIC_OK) return status;
    place_columns(&c, jacobian, rotating);
    laconic_jacobian_directions(&c, model);
    laconic_core_columns(&c, &s, state);
    laconic_heading_column(&jacobian->by_heading, &s, &c);
    laconic_torque_columns(jacobian, &s, &c);
    laconic_world_columns(jacobian, &s, &c, held);
    return LACONIC_OK;
}

/* ------------------------------------------------------------- by whichever method takes the step -- */

laconic_status laconic_step_jacobian_of(laconic_step_jacobian *jacobian, const laconic_model *model,
                                        const laconic_integrator *integrator, const laconic_state *state,
                                        const laconic_input *held, bool with_world_force) {
    return laconic_step_jacobian_by(jacobian, &laconic_derivation_of_all, model, integrator, state, held,
                                    with_world_force);
}

laconic_status laconic_step_tangent(laconic_state_change *after, const laconic_model *model,
                                    const laconic_integrator *integrator, const laconic_state *state,
                                    const laconic_input *held, const laconic_state_change *before,
                                    const laconic_input *input, const laconic_model_change *by_model) {
    return laconic_step_tangent_by(after, &laconic_derivation_of_all, model, integrator, state, held, before, input,
                                   by_model);
}
