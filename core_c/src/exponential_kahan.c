/* Exponential Kahan: second order, one 3×3 solve, exact for damping and drive alone, keeps every steady state. */
#include "exponential_kahan.h"

#include "integrator.h"

RARE increment kahan_varying(const laconic_model *model, const laconic_integrator *integrator,
                             const laconic_state *state, const laconic_loads *loads) {
    return single_varying(kahan_step, model, integrator, state, loads);
}

static laconic_status kahan_1_step(const laconic_model *model, const laconic_integrator *integrator,
                                   laconic_state *state, const laconic_loads *loads) {
    const vector zeta = zeta_of(state);
    const increment by = steady_over(loads) ? single(kahan_step, model, integrator, zeta, loads)
                                            : kahan_varying(model, integrator, state, loads);
    return advance_if_passive(state, model, integrator->step_s, loads, zeta, by);
}

static laconic_status kahan_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 1);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan = {"exponential-kahan", 2, PREPARE(kahan_prepare), kahan_1_step};
