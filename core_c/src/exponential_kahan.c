/* Exponential Kahan: second order, one 3×3 solve, exact for damping and drive alone, keeps every steady state. */
#include "exponential_kahan.h"

#include "integrator.h"
#include "symmetric.h"

static laconic_status kahan_increment(const laconic_model *model, const laconic_integrator *integrator,
                                      const laconic_state *state, laconic_loads loads, laconic_increment *out) {
    drive d;
    real zeta[3];
    const laconic_status status = single_step(kahan_step, model, integrator, state, loads, &d, out);
    if (status != LACONIC_OK) return status;
    take_zeta(zeta, state);
    return passive(zeta, integrator->step_s, d.b, d.varies ? d.change : NULL, out) ? LACONIC_OK
                                                                                   : LACONIC_STEP_GAINS_ENERGY;
}

static laconic_status kahan_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 1);
    return LACONIC_OK;
}

const laconic_method laconic_exponential_kahan = {"exponential-kahan", 2, kahan_prepare, kahan_increment};
