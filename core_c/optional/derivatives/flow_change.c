/* The splitting with the exact free motion, linearised (exact_flow.c). The free motion is a rotation of ζ by an angle
 * that depends on ζ: its derivative is the rotation, plus what the change of the angle adds. */
#include "base_change.h"

/* tan √z/√z = s/c and c² times its derivative by z; s and c have a common factor. */
typedef struct tangent_of_root {
    real s, c, slope;
} tangent_of_root;

/* Of the series z/3 + 2z²/15 + … of tan √z/√z, |z| <= 1/64: error 3e-16. */
static real small_slope(real z) {
    return R(1) / R(3) +
           z * (R(4) / R(15) +
                z * (R(17) / R(105) +
                     z * (R(248) / R(2835) +
                          z * (R(1382) / R(31185) + z * (R(43688) / R(2027025) + z * (R(929569) / R(91216125)))))));
}

static tangent_of_root tangent_at(real z) {
    tangent_of_root t = {R(0), R(1), R(0)};
    if (magnitude(z) <= TANGENT_SMALL) {
        t.s = poly_tangent(z);
        t.slope = small_slope(z);
        return t;
    }
    const real root = laconic_root(magnitude(z));
    if (z > R(0)) {
        const direction d = laconic_direction_of_angle(root);
        t.s = d.sine / root;
        t.c = d.cosine;
    } else { /* sinh and cosh, both times 2e^−√|z| */
        const real decayed = laconic_decaying_exponential(R(2) * root);
        t.s = (R(1) - decayed) / root;
        t.c = R(1) + decayed;
    }
    t.slope = (t.c * t.c + z * t.s * t.s - t.s * t.c) / (R(2) * z);
    return t;
}

/* The map of dζ ↦ a dζ × w + b (dζ × w) × w + turn (by·dζ). */
static linear_map rotation_map(const laconic_model *m, real a, real b, vector turn, vector by) {
    const vector w = vec(m->gyro), s = scaled(a, w), u = scaled(b, w);
    const real off = b * m->gyro_square;
    const linear_map map = {
        {u.x * w.x - off + turn.x * by.x, u.x * w.y + s.z + turn.x * by.y, u.x * w.z - s.y + turn.x * by.z},
        {u.y * w.x - s.z + turn.y * by.x, u.y * w.y - off + turn.y * by.y, u.y * w.z + s.x + turn.y * by.z},
        {u.z * w.x + s.y + turn.z * by.x, u.z * w.y - s.x + turn.z * by.y, u.z * w.z - off + turn.z * by.z}};
    return map;
}

/* The free motion from `before`, with tan(ψ/2) = |w| n/d; κ is half the change of ψ/|w|. */
static vector trace_free_motion(base_trace *t, const laconic_model *m, real half_step) {
    const vector z = t->of.flow.before;
    const real along = half_step * dot(vec(m->nu_of_zeta[2]), z), across = half_step * dot(vec(m->spin_gain), z);
    const real curve = half_step * dot(vec(m->spin_curve), z);
    const tangent_of_root tan = tangent_at(along * curve - across * across);
    const real n = along * tan.s, d = tan.c - across * tan.s, wn = m->gyro_square * (n * n);
    const real scale = R(1) / (d * d + wn), bend = scale * along * tan.slope;
    t->of.flow.zeta_cross_w = cross(z, vec(m->gyro));
    t->of.flow.twice_cross_w = cross(t->of.flow.zeta_cross_w, vec(m->gyro));
    t->of.flow.ahead = R(2) * scale * n * d;
    t->of.flow.aside = R(2) * scale * n * n;
    t->of.flow.shrink = scale * n * n;
    t->of.flow.turn = plus(scaled(R(2) * scale * (d * d - wn), t->of.flow.zeta_cross_w),
                           scaled(R(4) * scale * n * d, t->of.flow.twice_cross_w));
    t->of.flow.by_along = half_step * (scale * tan.s * d + bend * curve);
    t->of.flow.by_across = half_step * (scale * along * tan.s * tan.s - R(2) * bend * across);
    t->of.flow.by_curve = half_step * bend * along;
    const vector by =
        plus(scaled(t->of.flow.by_along, vec(m->nu_of_zeta[2])),
             plus(scaled(t->of.flow.by_across, vec(m->spin_gain)), scaled(t->of.flow.by_curve, vec(m->spin_curve))));
    t->by_zeta = rotation_map(m, t->of.flow.ahead, t->of.flow.aside, t->of.flow.turn, by);
    return plus(scaled(t->of.flow.ahead, t->of.flow.zeta_cross_w), scaled(t->of.flow.aside, t->of.flow.twice_cross_w));
}

/* What a change of the model adds to the change of the free motion. */
static vector free_motion_by_model(const base_trace *t, const laconic_model *m, const dynamics_change *by) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), dg = by->yaw, dw = by->gyro, z = t->of.flow.before;
    const real square_change = R(2) * dot(w, dw);
    const vector gain = plus(cross(dw, g), cross(w, dg));
    const vector curve = plus(minus(scaled(R(2) * (dot(dg, w) + dot(g, dw)), w), scaled(square_change, g)),
                              minus(scaled(R(2) * dot(g, w), dw), scaled(m->gyro_square, dg)));
    const real turn =
        t->of.flow.by_along * dot(dg, z) + t->of.flow.by_across * dot(gain, z) + t->of.flow.by_curve * dot(curve, z);
    const vector once = cross(z, dw), twice = plus(cross(once, w), cross(t->of.flow.zeta_cross_w, dw));
    const real less = -square_change * t->of.flow.shrink;
    const vector straight = plus(scaled(t->of.flow.ahead, added(once, less, t->of.flow.zeta_cross_w)),
                                 scaled(t->of.flow.aside, added(twice, less, t->of.flow.twice_cross_w)));
    return added(straight, turn, t->of.flow.turn);
}

/* The increment of damping and forcing alone, from ζ under the constant b. */
INLINE vector linear_part(const laconic_model *m, const laconic_decay *half, vector zeta, vector b) {
    return times(vec(half->gain), minus(b, damping(m, zeta)));
}

static increment trace_flow(base_trace *t, const step_point *at, int level, vector zeta, const parabola *b) {
    const laconic_model *m = at->model;
    const laconic_decay *half = &at->integrator->decay[level + 1];
    t->level = level;
    t->zeta = zeta;
    t->of.flow.first = t->of.flow.second = b->start;
    t->change = b->change;
    t->varies = b->varies;
    if (b->varies) {
        t->of.flow.first = added(b->start, R(0.5), times(vec(half->mean), b->change));
        t->of.flow.second = added(t->of.flow.first, R(0.5), b->change);
    }
    const vector up = linear_part(m, half, zeta, t->of.flow.first);
    t->of.flow.before = plus(zeta, up);
    const vector rotation = trace_free_motion(t, m, at->integrator->step_s * (level == 0 ? R(0.5) : R(0.25)));
    t->of.flow.middle = plus(t->of.flow.before, rotation);
    t->delta = plus(plus(up, rotation), linear_part(m, half, t->of.flow.middle, t->of.flow.second));
    return increment_of(&at->integrator->decay[level], zeta, t->delta, b);
}

INLINE lanes linear_change(const laconic_model *m, const laconic_decay *half, lanes zeta, lanes b) {
    if (!LACONIC_WITH_DAMPING) return lanes_times(vec(half->gain), b);
    return lanes_times(vec(half->gain), lanes_minus(b, lanes_times(vec(m->decay_per_s), zeta)));
}

/* What a change of the model adds to it. */
static vector linear_by_model(const laconic_model *m, const laconic_decay *half, const base_model_change *by,
                              const decay_change *factors, vector zeta, vector b) {
    const vector damped = times(vec(half->gain), mapped(&by->dynamics->damping, zeta));
    return minus(mapped(&factors->gain, minus(b, damping(m, zeta))), damped);
}

INLINE increment_change change_flow(const base_trace *t, const step_point *at, lanes zeta, const b_change *b,
                                    const base_model_change *model) {
    const laconic_model *m = at->model;
    const laconic_decay *half = &at->integrator->decay[t->level + 1];
    const decay_change *factors = model != NULL ? &model->decay[t->level + 1] : NULL;
    lanes first = b->start, second = b->start;
    if (b->varies) {
        first = lanes_added(first, R(0.5), lanes_times(vec(half->mean), b->change));
        if (model != NULL) first = lanes_added(first, R(0.5), lanes_of(mapped(&factors->mean, t->change)));
        second = lanes_added(first, R(0.5), b->change);
    }
    lanes up = linear_change(m, half, zeta, first);
    if (model != NULL)
        up = lanes_plus(up, lanes_of(linear_by_model(m, half, model, factors, t->zeta, t->of.flow.first)));
    const lanes before = lanes_plus(zeta, up);
    lanes rotation = lanes_mapped(&t->by_zeta, before);
    if (model != NULL) rotation = lanes_plus(rotation, lanes_of(free_motion_by_model(t, m, model->dynamics)));
    lanes down = linear_change(m, half, lanes_plus(before, rotation), second);
    if (model != NULL)
        down =
            lanes_plus(down, lanes_of(linear_by_model(m, half, model, factors, t->of.flow.middle, t->of.flow.second)));
    return increment_change_of(t, &at->integrator->decay[t->level], zeta, lanes_plus(lanes_plus(up, rotation), down), b,
                               model != NULL ? &model->decay[t->level] : NULL);
}

void laconic_flow_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                            int32_t count) {
    base_responses(trace_flow, change_flow, false, 2, step, out, at, in, count);
}

void laconic_flow_4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                              int32_t count) {
    base_responses(trace_flow, change_flow, true, 3, step, out, at, in, count);
}
