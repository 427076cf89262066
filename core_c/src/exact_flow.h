#ifndef LACONIC_EXACT_FLOW_H
#define LACONIC_EXACT_FLOW_H

#include "elementary.h"
#include "polynomials.h"

/* Half-angle of the turn about w as a ratio: tan(ψ/2) = |w| numerator/denominator. */
typedef struct half_angle {
    real numerator, denominator;
} half_angle;

half_angle laconic_large_half_angle(real z, real along, real across);

/* Free motion turns ζ about w by the angle ψ with ψ' = |w| g·ζ. As a Riccati equation for u = tan(ψ/2) it has
 * the solution u(h) = |w| along T/(1 − across T), T = tan √z/√z, with along = ½h g·ζ, across = ½h g·(ζ×w),
 * z = (½h)²[(g·ζ)(2(g·w)(w·ζ) − |w|² g·ζ) − (g·(ζ×w))²], either sign. */
static inline half_angle half_angle_after(const laconic_model *m, real half_step, const real zeta[3],
                                          const real turned[3]) {
    const real *g = m->nu_of_zeta[2], *w = m->gyro;
    const real yaw = dot(g, zeta);
    const real along = half_step * yaw, across = half_step * dot(g, turned);
    const real rest = half_step * (R(2) * dot(g, w) * dot(w, zeta) - dot(w, w) * yaw);
    const real z = along * rest - across * across;
    if (magnitude(z) <= TANGENT_SMALL) {
        const real tangent = poly_tangent(z);
        const half_angle a = {along * tangent, R(1) - across * tangent};
        return a;
    }
    return laconic_large_half_angle(z, along, across);
}

/* ζ⁺ − ζ = 2 τ/(1 + |w|²τ²) (ζ×w + τ (ζ×w)×w), τ = numerator/denominator: |ζ| stays to rounding. */
static inline void free_flow(real delta[3], const laconic_model *m, real half_step, const real zeta[3]) {
    const real *w = m->gyro;
    real turned[3], twice[3], factor;
    half_angle a;
    int k;
    cross(turned, zeta, w);
    cross(twice, turned, w);
    a = half_angle_after(m, half_step, zeta, turned);
    factor = R(2) * a.numerator / (a.denominator * a.denominator + dot(w, w) * a.numerator * a.numerator);
    for (k = 0; k < 3; k++) delta[k] = factor * (a.denominator * turned[k] + a.numerator * twice[k]);
}

/* Damping and drive alone, exact for b linear over the half step. */
static inline void drive_flow(real zeta[3], real delta[3], const laconic_model *m, const laconic_decay *d,
                              const real b[3], const real *change) {
    int k;
    for (k = 0; k < 3; k++) {
        real step = d->gain[k] * (b[k] - m->decay_per_s[k] * zeta[k]);
        if (change != NULL) step += d->ramp[k] * R(0.5) * change[k];
        delta[k] += step;
        zeta[k] += step;
    }
}

/* Drive for h/2, free motion for h, drive for h/2. */
static inline laconic_status exact_flow_step(const laconic_model *m, const laconic_integrator *integrator, int level,
                                             const real zeta[3], const real b[3], const real *change,
                                             laconic_increment *out) {
    const real half_step = integrator->step_s * (level == 0 ? R(0.5) : R(0.25));
    const laconic_decay *whole = &integrator->decay[level], *half = &integrator->decay[level + 1];
    real z[3] = {zeta[0], zeta[1], zeta[2]}, middle[3] = {b[0], b[1], b[2]}, turn[3];
    int k;
    out->delta[0] = out->delta[1] = out->delta[2] = R(0);
    drive_flow(z, out->delta, m, half, b, change);
    free_flow(turn, m, half_step, z);
    for (k = 0; k < 3; k++) {
        z[k] += turn[k];
        out->delta[k] += turn[k];
        if (change != NULL) middle[k] += R(0.5) * change[k];
    }
    drive_flow(z, out->delta, m, half, middle, change);
    for (k = 0; k < 3; k++) {
        out->mean[k] = zeta[k] + whole->mean[k] * out->delta[k];
        out->slope[k] = whole->slope[k] * out->delta[k];
        if (change != NULL) {
            out->mean[k] += whole->mean_ramp[k] * change[k];
            out->slope[k] += whole->slope_ramp[k] * change[k];
        }
    }
    return LACONIC_OK;
}

#endif
