#ifndef LACONIC_EXPONENTIAL_KAHAN_H
#define LACONIC_EXPONENTIAL_KAHAN_H

#include "internal.h"

/* The base step of exponential-kahan and exponential-kahan-4. */
static inline laconic_status kahan_step(const laconic_model *m, const laconic_integrator *integrator, int level,
                                        const real zeta[3], const real b[3], const real *change,
                                        laconic_increment *out);

/* Solves M x = rhs, M given by rows, by Cramer's rule. False where M is singular to rounding. */
static inline bool solve3(real x[3], const real row0[3], const real row1[3], const real row2[3], const real rhs[3]) {
    real c12[3], c20[3], c01[3], determinant, inverse;
    int k;
    cross(c12, row1, row2);
    cross(c20, row2, row0);
    cross(c01, row0, row1);
    determinant = dot(row0, c12);
    if (!(magnitude(determinant) > R(16) * LACONIC_EPSILON * (R(1) + size(c12)))) return false;
    inverse = R(1) / determinant;
    for (k = 0; k < 3; k++) x[k] = inverse * (rhs[0] * c12[k] + rhs[1] * c20[k] + rhs[2] * c01[k]);
    return true;
}

/* ζ⁺ = e^{hL}ζ + hφ1(hL)[q(ζ,ζ⁺) + b] + hφ2(hL)·change, with q(ζ,ζ⁺) = ½[(g·ζ) ζ⁺×w + (g·ζ⁺) ζ×w], written
 * for the increment Δ = ζ⁺ − ζ: (E − D Q)Δ = D ζ'(ζ) + hφ2·change, D = hφ1, QΔ = q(ζ,Δ). */
static inline laconic_status kahan_step(const laconic_model *m, const laconic_integrator *integrator, int level,
                                        const real zeta[3], const real b[3], const real *change,
                                        laconic_increment *out) {
    const laconic_decay *d = &integrator->decay[level];
    const real *g = m->nu_of_zeta[2], *w = m->gyro;
    const real yaw = dot(g, zeta), half = R(0.5) * yaw;
    real turned[3], rhs[3], scale[3], lean[3], row[3][3];
    int k;
    cross(turned, zeta, w);
    for (k = 0; k < 3; k++) {
        rhs[k] = d->gain[k] * (yaw * turned[k] + (b[k] - m->decay_per_s[k] * zeta[k]));
        if (change != NULL) rhs[k] += d->ramp[k] * change[k];
        scale[k] = half * d->gain[k];
        lean[k] = R(0.5) * d->gain[k] * turned[k];
    }
    for (k = 0; k < 3; k++) {
        row[k][0] = -lean[k] * g[0];
        row[k][1] = -lean[k] * g[1];
        row[k][2] = -lean[k] * g[2];
        row[k][k] += R(1);
    }
    /* − scale (Δ × w) */
    row[0][1] -= scale[0] * w[2];
    row[0][2] += scale[0] * w[1];
    row[1][2] -= scale[1] * w[0];
    row[1][0] += scale[1] * w[2];
    row[2][0] -= scale[2] * w[1];
    row[2][1] += scale[2] * w[0];
    if (!solve3(out->delta, row[0], row[1], row[2], rhs)) return LACONIC_STEP_SINGULAR;
    for (k = 0; k < 3; k++) {
        out->mean[k] = zeta[k] + d->mean[k] * out->delta[k];
        out->slope[k] = d->slope[k] * out->delta[k];
        if (change != NULL) {
            out->mean[k] += d->mean_ramp[k] * change[k];
            out->slope[k] += d->slope_ramp[k] * change[k];
        }
    }
    return LACONIC_OK;
}

#endif
