/* Exact-flow splitting: second order, keeps energy and K of the free motion to rounding, takes every step. */
#include "exact_flow.h"

#include "integrator.h"

#define LARGEST_DOUBLINGS 520 /* quarter every finite number: an infinite one ends as NaN, and the step is refused */

/* Beyond the polynomial: quarter z until it holds, then double the angle as often. With s = sin √z/√z and
 * c = cos √z up to a common factor (only their ratio counts), s(4z) = s c, c(4z) = c² − z s²; divided by
 * c² + |z| s² they stay of the order of 1 for either sign of z. */
half_angle laconic_large_half_angle(real z, real along, real across) {
    half_angle a;
    real s, c = R(1);
    int doublings = 0;
    for (; magnitude(z) > TANGENT_SMALL && doublings < LARGEST_DOUBLINGS; z *= R(0.25)) doublings++;
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

/* |ζ + δ|² − |ζ|² = δ·(2ζ + δ) should be 0: take the excess off along ζ + δ. */
vector laconic_cleared_turn(vector zeta, vector delta) {
    const vector end = plus(zeta, delta);
    const real excess = dot(delta, plus(zeta, end)), length = square(end);
    if (!(length > R(0))) return delta;
    return minus(delta, scaled(R(0.5) * excess / length, end));
}

RARE increment flow_varying(const laconic_model *model, const laconic_integrator *integrator,
                            const laconic_state *state, const laconic_loads *loads) {
    return single_varying(exact_flow_step, model, integrator, state, loads);
}

static laconic_status flow_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_loads *loads) {
    const vector zeta = zeta_of(state);
    const increment by = steady_over(loads) ? single(exact_flow_step, model, integrator, zeta, loads)
                                            : flow_varying(model, integrator, state, loads);
    return advance(state, model, integrator->step_s, zeta, by);
}

static laconic_status flow_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 2);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow = {"exact-flow", 2, PREPARE(flow_prepare), flow_step};
