/* Exponential Kahan, extrapolated to fourth order: the one that is good everywhere. */
#include "exponential_kahan.h"
#include "integrator.h"

RARE increment kahan_4_varying(const laconic_model *model, const laconic_integrator *integrator,
                               const laconic_state *state, const laconic_loads *loads) {
    return extrapolated_varying(kahan_step, model, integrator, state, loads);
}

static laconic_status kahan_4_step(const laconic_model *model, const laconic_integrator *integrator,
                                   laconic_state *state, const laconic_loads *loads) {
    const vector zeta = zeta_of(state);
    const increment by = steady_over(loads) ? extrapolated(kahan_step, model, integrator, zeta, loads)
                                            : kahan_4_varying(model, integrator, state, loads);
    return advance_if_passive(state, model, integrator->step_s, loads, zeta, by);
}

static laconic_status kahan_4_prepare(laconic_integrator *integrator, const laconic_model *model,
                                      laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 2);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan_4 = {"exponential-kahan-4", 4, PREPARE(kahan_4_prepare), kahan_4_step};
