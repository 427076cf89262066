/* The base step of exponential-kahan and exponential-kahan-4. */
#ifndef LACONIC_EXPONENTIAL_KAHAN_H
#define LACONIC_EXPONENTIAL_KAHAN_H

#include "symmetric.h"

typedef struct matrix {
    vector row0, row1, row2;
} matrix;

/* Cramer's rule: M⁻¹ rhs = (rhs_x c₀ + rhs_y c₁ + rhs_z c₂)/det. */
typedef struct solver {
    vector c0, c1, c2;
    real inverse_determinant;
} solver;

/* False where M is singular to rounding. */
static inline bool factorise(solver *s, const matrix *m) {
    real determinant;
    s->c0 = cross(m->row1, m->row2);
    s->c1 = cross(m->row2, m->row0);
    s->c2 = cross(m->row0, m->row1);
    determinant = dot(m->row0, s->c0);
    s->inverse_determinant = R(1) / determinant;
    return determinant * determinant > R(256) * LACONIC_EPSILON * LACONIC_EPSILON * (R(1) + square(s->c0));
}

static inline vector solve(const solver *s, vector rhs) {
    return scaled(s->inverse_determinant,
                  plus(scaled(rhs.x, s->c0), plus(scaled(rhs.y, s->c1), scaled(rhs.z, s->c2))));
}

/* E − D Q with D = hφ1, Q Δ = q(ζ,Δ) = ½[(g·ζ) Δ×w + (g·Δ) ζ×w]. */
static inline matrix implicit_matrix(vector gain, vector g, vector w, real yaw, vector turned) {
    const vector s = scaled(R(0.5) * yaw, gain), l = scaled(R(0.5), times(gain, turned));
    const matrix m = {
        {R(1) - l.x * g.x, -(l.x * g.y + s.x * w.z), s.x * w.y - l.x * g.z},
        {s.y * w.z - l.y * g.x, R(1) - l.y * g.y, -(l.y * g.z + s.y * w.x)},
        {-(l.z * g.x + s.z * w.y), s.z * w.x - l.z * g.y, R(1) - l.z * g.z},
    };
    return m;
}

/* Where damping is fast beside the step, ζ follows b at once, and q with it: q(ζ,ζ⁺) is its mean, but what ζ
 * is at the step's end hangs on q there. So q, too, goes linearly from q(ζ,ζ) to q(ζ⁺,ζ⁺): it adds
 * (φ2 − φ1/2)·(their difference) to the increment, and joins the change of b for mean and slope. Without it
 * a stiff vehicle lags by h/r times the change of q; with it by (h/r)². */
static inline vector follow(drive *b, const laconic_model *m, const laconic_decay *d, const solver *s, vector zeta,
                            vector delta) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), end = plus(zeta, delta);
    const vector change = minus(scaled(dot(g, end), cross(end, w)), scaled(dot(g, zeta), cross(zeta, w)));
    const vector none = {R(0), R(0), R(0)}, tilt = minus(vec(d->ramp), scaled(R(0.5), vec(d->gain)));
    if (!b->varies) b->change = b->curve = none;
    b->change = plus(b->change, change);
    b->varies = true;
    return plus(delta, solve(s, times(tilt, change)));
}

/* ζ⁺ = e^{hL}ζ + hφ1(hL)[q(ζ,ζ⁺) + b] and what a varying b adds, written for the increment Δ = ζ⁺ − ζ:
 * (E − D Q)Δ = D ζ'(ζ) + … */
static inline laconic_status kahan_step(const laconic_model *m, const laconic_integrator *integrator, int level,
                                        vector zeta, const drive *b, increment *out) {
    const laconic_decay *d = &integrator->decay[level];
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), gain = vec(d->gain);
    const real yaw = dot(g, zeta);
    const vector turned = cross(zeta, w);
    const vector rate = plus(scaled(yaw, turned), minus(b->start, times(vec(m->decay_per_s), zeta)));
    const matrix implicit = implicit_matrix(gain, g, w, yaw, turned);
    vector rhs = times(gain, rate), delta;
    solver s;
    if (!factorise(&s, &implicit)) return LACONIC_STEP_SINGULAR;
    if (b->varies) rhs = plus(rhs, response(d->ramp, d->bend, b));
    delta = solve(&s, rhs);
    if (integrator->stiff) {
        drive followed = *b;
        delta = follow(&followed, m, d, &s, zeta, delta);
        fill(out, d, zeta, delta, &followed);
    } else {
        fill(out, d, zeta, delta, b);
    }
    return LACONIC_OK;
}

#endif
