/* Exponential Kahan: second order, one 3×3 solve, exact for damping and drive alone, keeps every steady state. */
#include "exponential_kahan.h"

#include "integrator.h"

static laconic_status kahan_1_step(const laconic_model *model, const laconic_integrator *integrator,
                                   laconic_state *state, const laconic_loads *loads) {
    const stretch all = whole_of(loads);
    origin from = start_of(state);
    increment by;
    drive b;
    const laconic_status status =
        driven_step(kahan_step, model, integrator, 0, &from, &all, &b, &by);
    if (status != LACONIC_OK) return status;
    return advance_if_passive(state, model, integrator->step_s, zeta_of(state), &b, by);
}

static laconic_status kahan_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 1);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan = {"exponential-kahan", 2, PREPARE(kahan_prepare), kahan_1_step};
