/* Exponential Kahan, linearised (exponential_kahan.c): M Δ = ζ'(ζ), M = D⁻¹ − Q(ζ). As Q is linear in ζ,
 *     M dΔ = (∂ζ'/∂ζ at ζ + ½ Δ) dζ + db. */
#include "base_change.h"

/* M⁻¹ by its rows: with the cofactors c, M⁻¹ v = (v_x c₀ + v_y c₁ + v_z c₂)/det. */
static linear_map inverse_of(const linear_map *m) {
    const vector c0 = cross(m->y, m->z), c1 = cross(m->z, m->x), c2 = cross(m->x, m->y);
    const real scale = R(1) / dot(m->x, c0);
    const linear_map inverse = {scaled(scale, vector_of(c0.x, c1.x, c2.x)), scaled(scale, vector_of(c0.y, c1.y, c2.y)),
                                scaled(scale, vector_of(c0.z, c1.z, c2.z))};
    return inverse;
}

static inline vector row_times(vector row, const linear_map *b) {
    return plus(plus(scaled(row.x, b->x), scaled(row.y, b->y)), scaled(row.z, b->z));
}

static linear_map product_of(const linear_map *a, const linear_map *b) {
    const linear_map out = {row_times(a->x, b), row_times(a->y, b), row_times(a->z, b)};
    return out;
}

static linear_map implicit_map(const linear_map *gyroscopic, vector inverse_gain) {
    const linear_map m = {plus(scaled(R(-0.5), gyroscopic->x), vector_of(inverse_gain.x, R(0), R(0))),
                          plus(scaled(R(-0.5), gyroscopic->y), vector_of(R(0), inverse_gain.y, R(0))),
                          plus(scaled(R(-0.5), gyroscopic->z), vector_of(R(0), R(0), inverse_gain.z))};
    return m;
}

static inline vector beyond_half(const laconic_decay *d) {
    return minus(vec(d->mean), vector_of(R(0.5), R(0.5), R(0.5)));
}

static inline vector gyroscopic_rate(const laconic_model *m, vector zeta) {
    return scaled(dot(vec(m->nu_of_zeta[2]), zeta), cross(zeta, vec(m->gyro)));
}

/* follow() of exponential_kahan.c: the gyroscopic term varies over the step. */
static void trace_follow(base_trace *t, const laconic_model *m, const laconic_decay *d) {
    const vector end = plus(t->zeta, t->of.kahan.first);
    t->of.kahan.gyroscopic = minus(gyroscopic_rate(m, end), gyroscopic_rate(m, t->zeta));
    t->of.kahan.added = mapped(&t->by_b, times(beyond_half(d), t->of.kahan.gyroscopic));
    t->of.kahan.at_end = gyroscopic_map(m, end);
    t->of.kahan.at_added = gyroscopic_map(m, t->of.kahan.added);
    t->delta = plus(t->of.kahan.first, t->of.kahan.added);
    t->change = plus(t->change, t->of.kahan.gyroscopic);
    t->varies = true;
}

static increment trace_kahan(base_trace *t, const step_point *at, int level, vector zeta, const parabola *b) {
    const laconic_model *m = at->model;
    const laconic_decay *d = &at->integrator->decay[level];
    t->level = level;
    t->zeta = zeta;
    t->change = t->of.kahan.given = b->change;
    t->varies = b->varies;
    t->of.kahan.at_start = gyroscopic_map(m, zeta);
    const linear_map implicit = implicit_map(&t->of.kahan.at_start, vec(d->inverse_gain));
    t->by_b = inverse_of(&implicit);
    t->of.kahan.first = t->delta = mapped(&t->by_b, zeta_rate(m, zeta, equivalent_constant(b, d)));
    const linear_map rate = rate_map(m, added(zeta, R(0.5), t->delta));
    t->by_zeta = product_of(&t->by_b, &rate);
    if (at->integrator->stiff) trace_follow(t, m, d);
    const parabola followed = {b->start, t->change, none, t->varies};
    return increment_of(d, zeta, t->delta, &followed);
}

/* What a change of the model adds to M v. */
static vector implicit_change(const base_trace *t, const laconic_model *m, const base_model_change *by, vector v) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), dg = by->dynamics->yaw, dw = by->dynamics->gyro;
    const vector turned = plus(plus(scaled(dot(dg, t->zeta), cross(v, w)), scaled(dot(g, t->zeta), cross(v, dw))),
                               plus(scaled(dot(dg, v), cross(t->zeta, w)), scaled(dot(g, v), cross(t->zeta, dw))));
    return added(mapped(&by->decay[t->level].inverse_gain, v), R(-0.5), turned);
}

/* What a change of the model adds to the right-hand side for the increment before follow(). */
static vector first_by_model(const base_trace *t, const step_point *at, const base_model_change *model) {
    const vector implicit = implicit_change(t, at->model, model, t->of.kahan.first);
    const vector rate = minus(dynamics_rate_change(at->model, model->dynamics, t->zeta), implicit);
    return plus(rate, mapped(&model->decay[t->level].mean, t->of.kahan.given));
}

/* The change of the increment before follow(). */
INLINE lanes first_change(const base_trace *t, const step_point *at, const laconic_decay *d, lanes zeta,
                          const b_change *b, const base_model_change *model) {
    lanes rate = b->varies ? lanes_plus(b->start, lanes_times(vec(d->mean), b->change)) : b->start;
    if (model != NULL) rate = lanes_plus(rate, lanes_of(first_by_model(t, at, model)));
    return lanes_plus(lanes_mapped(&t->by_zeta, zeta), lanes_mapped(&t->by_b, rate));
}

/* What a change of the model adds to the change of (g·ζ)(ζ × w) over the base step. */
static vector gyroscopic_by_model(const base_trace *t, const laconic_model *m, const base_model_change *model) {
    return minus(gyroscopic_change(m, model->dynamics, plus(t->zeta, t->of.kahan.first)),
                 gyroscopic_change(m, model->dynamics, t->zeta));
}

/* And to the right-hand side of what follow() adds. */
static vector follow_by_model(const base_trace *t, const laconic_model *m, const base_model_change *model) {
    return minus(mapped(&model->decay[t->level].mean, t->of.kahan.gyroscopic),
                 implicit_change(t, m, model, t->of.kahan.added));
}

/* The changes of what follow() adds: to the increment, returned, and to the change of b. */
INLINE lanes follow_change(b_change *b, const base_trace *t, const laconic_model *m, const laconic_decay *d, lanes zeta,
                           lanes delta, const base_model_change *model) {
    lanes change = lanes_minus(lanes_mapped(&t->of.kahan.at_end, lanes_plus(zeta, delta)),
                               lanes_mapped(&t->of.kahan.at_start, zeta));
    if (model != NULL) change = lanes_plus(change, lanes_of(gyroscopic_by_model(t, m, model)));
    b->change = b->varies ? lanes_plus(b->change, change) : change;
    b->varies = true;
    lanes sum = lanes_added(lanes_times(beyond_half(d), change), R(0.5), lanes_mapped(&t->of.kahan.at_added, zeta));
    if (model != NULL) sum = lanes_plus(sum, lanes_of(follow_by_model(t, m, model)));
    return lanes_mapped(&t->by_b, sum);
}

INLINE increment_change change_kahan(const base_trace *t, const step_point *at, lanes zeta, const b_change *b,
                                     const base_model_change *model) {
    const laconic_decay *d = &at->integrator->decay[t->level];
    b_change followed = *b;
    lanes delta = first_change(t, at, d, zeta, b, model);
    if (at->integrator->stiff) delta = lanes_plus(delta, follow_change(&followed, t, at->model, d, zeta, delta, model));
    return increment_change_of(t, d, zeta, delta, &followed, model != NULL ? &model->decay[t->level] : NULL);
}

void laconic_kahan_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                             int32_t count) {
    base_responses(trace_kahan, change_kahan, false, 1, step, out, at, in, count);
}

void laconic_kahan_4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                               int32_t count) {
    base_responses(trace_kahan, change_kahan, true, 2, step, out, at, in, count);
}
