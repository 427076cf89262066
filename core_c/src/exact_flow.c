/* Exact-flow splitting: second order, keeps energy and K of the free motion to rounding, takes every step. */
#include "exact_flow.h"

#include "integrator.h"

/* Beyond the polynomial. Numerator and denominator may share any factor: only their ratio counts. */
half_angle laconic_large_half_angle(real z, real along, real across) {
    const real root = laconic_root(magnitude(z));
    half_angle a;
    if (z > R(0)) {
        const direction d = laconic_direction_of_angle(root);
        const real sinc = d.sine / root;
        a.numerator = along * sinc;
        a.denominator = d.cosine - across * sinc;
    } else {
        const real fading = laconic_decaying_exponential(R(2) * root); /* tanh x = (1 − e^{−2x})/(1 + e^{−2x}) */
        const real tangent = (R(1) - fading) / ((R(1) + fading) * root);
        a.numerator = along * tangent;
        a.denominator = R(1) - across * tangent;
    }
    return a;
}

static laconic_status flow_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_loads *loads) {
    increment by;
    (void)single_step(exact_flow_step, model, integrator, state, loads, &by); /* finds every step possible */
    return advance(state, model, integrator->step_s, zeta_of(state), by);
}

static laconic_status flow_prepare(laconic_integrator *integrator, const laconic_model *model,
                                         laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 2);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow = {"exact-flow", 2, PREPARE(flow_prepare), flow_step};
