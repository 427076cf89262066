/* A step whose gain of energy was cut (laconic_energy_kept in step_internals.c), linearised. The method's own end e of
 * ζ is shortened across w:
 *     e' = e − c a,  a = e − w (w·e)/|w|²,  c = 1 − √(1 − S/|a|²),  S = |e|² − |ζ|² − 2 h b·(mean of ζ),
 * with b at the step's start. */
#include "step_chain.h"

typedef struct cut_trace {
    vector end, across, along; /* e, a, w/|w|² */
    real across_square, share; /* |a|², S/|a|² */
    vector b;
} cut_trace;

static real surplus_of(const step_point *at, vector end, vector b, vector path) {
    return square(end) - square(at->zeta) - R(2) * dot(b, path);
}

/* Whether the step ended shorter than its method had it by itself. */
static bool was_cut(cut_trace *t, const taken_step *s) {
    const direction ahead = {R(1), R(0)};
    t->end = plus(s->at.zeta, s->result.delta);
    t->b = forcing_seen(&s->at, ahead);
    const real surplus = surplus_of(&s->at, t->end, t->b, s->result.path);
    if (!(surplus > R(0.5) * ENERGY_ROUNDING * square(s->at.zeta))) return false;
    if (!(surplus_of(&s->at, s->end, t->b, s->result.path) < R(0.5) * surplus)) return false;
    const vector w = vec(s->at.model->gyro);
    t->along = s->at.model->gyro_square > R(0) ? scaled(R(1) / s->at.model->gyro_square, w) : none;
    t->across = minus(t->end, scaled(dot(w, t->end), t->along));
    t->across_square = square(t->across);
    t->share = surplus / t->across_square;
    return t->share < R(1);
}

/* Of a, by a change of e, and by one of w. */
static lanes across_change(const cut_trace *t, const laconic_model *m, lanes end, const dynamics_change *by) {
    const vector w = vec(m->gyro);
    lanes out = lanes_minus(end, lanes_along(lanes_dot(w, end), t->along));
    if (by == NULL || !(m->gyro_square > R(0))) return out;
    const vector dw = by->gyro;
    const real turned = dot(dw, t->end) - R(2) * dot(w, t->end) * dot(t->along, dw);
    const vector more = plus(scaled(dot(w, t->end) / m->gyro_square, dw), scaled(turned, t->along));
    return lanes_minus(out, lanes_of(more));
}

static void change_by_cut(step_response *out, const cut_trace *t, const taken_step *s, const step_direction *in) {
    const direction ahead = {R(1), R(0)};
    const real root = laconic_root(R(1) - t->share);
    const lanes end = lanes_plus(in->zeta, out->delta), across = across_change(t, s->at.model, end, in->model);
    const lane work = lanes_dot(s->result.path, forcing_change(in, ahead)) + lanes_dot(t->b, out->path);
    const lane surplus = R(2) * (lanes_dot(t->end, end) - lanes_dot(s->at.zeta, in->zeta) - work);
    const lane square_change = R(2) * lanes_dot(t->across, across);
    const lane share = (surplus - t->share * square_change) / t->across_square;
    out->delta = lanes_minus(out->delta, lanes_along(share / (R(2) * root), t->across));
    out->delta = lanes_added(out->delta, root - R(1), across);
}

void laconic_cut_responses(taken_step *s, step_response out[], const step_direction in[], int32_t count) {
    cut_trace t;
    if (!was_cut(&t, s)) return;
    for (int32_t k = 0; k < count; k++) change_by_cut(&out[k], &t, s, &in[k]);
    s->result.delta = minus(s->result.delta, scaled(t.share / (R(1) + laconic_root(R(1) - t.share)), t.across));
}
