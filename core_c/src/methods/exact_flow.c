/* Exact-flow splitting: ζ of the free motion is exact, so energy and K stay to rounding; heading, position and wheel
 * angles are of the method's order. Second order, which takes every step, and extrapolated to fourth order, which is
 * most accurate while damping is slow. */
#include "step_internals.h"

/* ζ rotates about w by the angle ψ over a step: tan(ψ/2) = |w| numerator/denominator. */
typedef struct half_angle {
    real numerator, denominator;
} half_angle;

/* A number below 2¹⁰²⁴ is below 2⁻⁶ after 515 quarterings; an infinite one never is: it becomes NaN,
 * and the step is refused. */
#define LARGEST_DOUBLINGS 520

/* For z beyond the range of the polynomial: quarters z until it is within, then doubles the angle as often. With s =
 * sin √z/√z and c = cos √z up to a common factor (only their ratio counts), s(4z) = s c, c(4z) = c² − z s²; divided by
 * c² + |z| s² they stay of the order of 1 for either sign of z. */
RARE_AND_OPAQUE half_angle large_half_angle(real z, real along, real across) {
    half_angle a;
    real s, c = R(1);
    int doublings = 0;
    while (ALL(magnitude(z) > TANGENT_SMALL) && doublings < LARGEST_DOUBLINGS) {
        z *= R(0.25);
        doublings++;
    }
    s = poly_tangent(z);
    for (; doublings > 0; doublings--) {
        const real zss = z * s * s, norm = R(1) / (c * c + magnitude(zss));
        s = norm * (s * c);
        c = norm * (c * c - zss);
        z *= R(4);
    }
    a.numerator = along * s;
    a.denominator = c - across * s;
    return a;
}

/* δ, corrected along ζ + δ so that the rotation keeps the length: |ζ + δ|² − |ζ|² = δ·(2ζ + δ) must be 0. ζ is given by
 * its components: as a struct it would be written to memory for this call in every step, also where none is made. */
RARE_AND_OPAQUE vector length_kept(real zeta_x, real zeta_y, real zeta_z, vector delta) {
    const vector zeta = {zeta_x, zeta_y, zeta_z}, end = plus(zeta, delta);
    const real excess = dot(delta, plus(zeta, end)), end_square = square(end);
    if (!ALL(end_square > R(0))) return delta;
    return minus(delta, scaled(R(0.5) * excess / end_square, end));
}

/* Free motion rotates ζ about w by the angle ψ with ψ' = |w| g·ζ. The Riccati equation for u = tan(ψ/2) has the
 * solution u(h) = |w| along T/(1 − across T), T = tan √z/√z, with along = ½h g·ζ, across = ½h g·(ζ×w),
 * z = (½h)²[(g·ζ)(2(g·w)(w·ζ) − |w|² g·ζ) − (g·(ζ×w))²] of either sign. */
INLINE half_angle half_angle_after(const laconic_model *m, real half_step, vector zeta) {
    const real along = half_step * dot(vec(m->nu_of_zeta[2]), zeta);
    const real across = half_step * dot(vec(m->spin_gain), zeta);
    const real curve = half_step * dot(vec(m->spin_curve), zeta);
    real z = along * curve - across * across;
    if (LIKELY(magnitude(z) <= TANGENT_SMALL, &z)) {
        const real tangent = poly_tangent(z);
        const half_angle a = {along * tangent, R(1) - across * tangent};
        return a;
    }
    return large_half_angle(z, along, across);
}

/* ζ⁺ − ζ = 2 τ/(1 + |w|²τ²) (ζ×w + τ (ζ×w)×w), τ = numerator/denominator: |ζ| is kept to rounding. */
INLINE vector free_flow(const laconic_model *m, real half_step, vector zeta) {
    const vector w = vec(m->gyro), zeta_cross_w = cross(zeta, w);
    const half_angle a = half_angle_after(m, half_step, zeta);
    const real aside = m->gyro_square * (a.numerator * a.numerator), ahead = a.denominator * a.denominator;
    const real factor = R(2) * a.numerator / (ahead + aside);
    vector delta =
        scaled(factor, plus(scaled(a.denominator, zeta_cross_w), scaled(a.numerator, cross(zeta_cross_w, w))));
    /* tan²(ψ/2) is 1/16 at ψ = 0.49: up to there |δ| is at most half of |ζ|, and rounding δ costs less than rounding
     * ζ⁺. */
    return UNLIKELY(aside > R(0.0625) * ahead, &delta.x) ? length_kept(zeta.x, zeta.y, zeta.z, delta) : delta;
}

/* The exact increment under damping and forcing, without the gyroscopic term. */
INLINE vector linear_flow(const laconic_model *m, const laconic_decay *d, vector zeta, const parabola *b) {
    return times(vec(d->gain), minus(equivalent_constant(b, d), damping(m, zeta)));
}

/* The two halves of a parabola, each with s from 0 to 1: s(s − 1) over half the range is a quarter of s(s − 1) and a
 * ramp. */
static inline void split(parabola *early, parabola *late, const parabola *b) {
    const vector quarter = scaled(R(0.25), b->curve), even = scaled(R(0.5), b->change);
    early->start = b->start;
    early->change = minus(even, quarter);
    late->start = plus(b->start, early->change);
    late->change = plus(even, quarter);
    early->curve = late->curve = quarter;
    early->varies = late->varies = true;
}

/* Strang splitting: damping and forcing for h/2, free motion for h, damping and forcing for h/2. */
INLINE increment flow_base(const laconic_model *m, const laconic_integrator *integrator, int level, vector zeta,
                           const parabola *b) {
    const real half_step = integrator->step_s * (level == 0 ? R(0.5) : R(0.25));
    const laconic_decay *half = &integrator->decay[level + 1];
    const parabola *first = b, *second = b;
    parabola early, late;
    if (!(LACONIC_WITH_DAMPING || LACONIC_WITH_FORCING))
        return increment_of(&integrator->decay[level], zeta, free_flow(m, half_step, zeta), b);
    if (b->varies) {
        split(&early, &late, b);
        first = &early;
        second = &late;
    }
    const vector up = linear_flow(m, half, zeta, first);
    const vector before = plus(zeta, up);
    const vector rotation = free_flow(m, half_step, before);
    const vector down = linear_flow(m, half, plus(before, rotation), second);
    return increment_of(&integrator->decay[level], zeta, plus(plus(up, rotation), down), b);
}

/* ------------------------------------------------------------------------- second order -- */

RARE increment flow_varying(const laconic_model *model, const laconic_integrator *integrator,
                            const laconic_state *state, const laconic_forcing_samples *samples) {
    return base_alone_varying(flow_base, model, integrator, state, samples);
}

static laconic_status exact_flow_step(const laconic_model *model, const laconic_integrator *integrator,
                                      laconic_state *state, const laconic_forcing_samples *samples) {
    const vector zeta = zeta_of(state);
    const increment by = constant_over(samples) ? base_alone(flow_base, model, integrator, zeta, samples)
                                                : flow_varying(model, integrator, state, samples);
    return advance_levelled(state, model, integrator->step_s, samples, zeta, by);
}

static laconic_status exact_flow_prepare(laconic_integrator *integrator, const laconic_model *model,
                                         laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 2);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow = {"exact-flow", 2, PREPARE(exact_flow_prepare), exact_flow_step};

/* ------------------------------------------------------------------------- fourth order -- */

RARE increment flow_4_varying(const laconic_model *model, const laconic_integrator *integrator,
                              const laconic_state *state, const laconic_forcing_samples *samples) {
    return extrapolated_varying(flow_base, model, integrator, state, samples);
}

static laconic_status exact_flow_4_step(const laconic_model *model, const laconic_integrator *integrator,
                                        laconic_state *state, const laconic_forcing_samples *samples) {
    const vector zeta = zeta_of(state);
    const increment by = constant_over(samples) ? extrapolated(flow_base, model, integrator, zeta, samples)
                                                : flow_4_varying(model, integrator, state, samples);
    return advance_with_energy(state, model, integrator->step_s, samples, zeta, by);
}

static laconic_status exact_flow_4_prepare(laconic_integrator *integrator, const laconic_model *model,
                                           laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 3);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow_4 = {"exact-flow-4", 4, PREPARE(exact_flow_4_prepare), exact_flow_4_step};
