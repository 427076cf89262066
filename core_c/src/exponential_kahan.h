/* The base step of exponential-kahan and exponential-kahan-4. */
#ifndef LACONIC_EXPONENTIAL_KAHAN_H
#define LACONIC_EXPONENTIAL_KAHAN_H

#include "symmetric.h"

typedef struct matrix {
    vector row0, row1, row2;
} matrix;

/* Solves M x = rhs by Cramer's rule. False where M is singular to rounding. */
static inline bool solve(vector *x, const matrix *m, vector rhs) {
    const vector c0 = cross(m->row1, m->row2), c1 = cross(m->row2, m->row0), c2 = cross(m->row0, m->row1);
    const real determinant = dot(m->row0, c0);
    if (!(determinant * determinant > R(256) * LACONIC_EPSILON * LACONIC_EPSILON * (R(1) + square(c0)))) return false;
    *x = scaled(R(1) / determinant, plus(scaled(rhs.x, c0), plus(scaled(rhs.y, c1), scaled(rhs.z, c2))));
    return true;
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

/* ζ⁺ = e^{hL}ζ + hφ1(hL)[q(ζ,ζ⁺) + b] + hφ2(hL)·change, written for the increment Δ = ζ⁺ − ζ:
 * (E − D Q)Δ = D ζ'(ζ) + hφ2·change. */
static inline laconic_status kahan_step(const laconic_model *m, const laconic_integrator *integrator, int level,
                                        vector zeta, const drive *b, increment *out) {
    const laconic_decay *d = &integrator->decay[level];
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro), gain = vec(d->gain);
    const real yaw = dot(g, zeta);
    const vector turned = cross(zeta, w);
    const vector rate = plus(scaled(yaw, turned), minus(b->start, times(vec(m->decay_per_s), zeta)));
    const matrix implicit = implicit_matrix(gain, g, w, yaw, turned);
    vector rhs = times(gain, rate), delta;
    if (LACONIC_WITH_SAMPLED_INPUT && b->varies) rhs = plus(rhs, times(vec(d->ramp), b->change));
    if (!solve(&delta, &implicit, rhs)) return LACONIC_STEP_SINGULAR;
    fill(out, d, zeta, delta, b);
    return LACONIC_OK;
}

#endif
