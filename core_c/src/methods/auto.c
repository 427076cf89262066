/* auto: a method of eighth order where one takes the step, else one of fourth, else exact-flow. The rule in full:
 *
 *   exponential-gauss-8   every step that it takes: of eighth order whatever the damping, keeps steady motions and, in
 *                         free motion, the energy
 *   and where it refuses a step, which yaws far (h·|w||g·ζ| above 2) or whose rounds do not converge:
 *   h·r_max < 0.3    exact-flow-4          damping is slow beside the step: the error of the splitting is least
 *   otherwise        exponential-kahan-4   keeps the steady state that fast damping leads to
 *   and where that refuses it, too, exact-flow, which every step suits.
 *
 * The choice by damping is made once, when the integrator is prepared; the rest depends only on state and input. So
 * the same run makes the same choices everywhere. Others would cost less: below h·r = 0.03 taylor-8 is as exact, but
 * changes the energy of free motion; those of fourth order err at a step of 1 ms by up to 1e-9 there, and by 1e-4 where
 * damping is fast. Who can do with that names the method (docs/integrators.md has the figures). */
#include "step_internals.h"

#if LACONIC_WITH_EXPONENTIAL_GAUSS

static laconic_status auto_slow_step(const laconic_model *model, const laconic_integrator *integrator,
                                     laconic_state *state, const laconic_forcing_samples *samples) {
    laconic_status status = laconic_exponential_gauss_8.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exact_flow_4.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exact_flow.step(model, integrator, state, samples);
    return status;
}

const laconic_method laconic_auto_slow = {"exponential-gauss-8", 8, NULL, auto_slow_step};

static laconic_status auto_fast_step(const laconic_model *model, const laconic_integrator *integrator,
                                     laconic_state *state, const laconic_forcing_samples *samples) {
    laconic_status status = laconic_exponential_gauss_8.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exponential_kahan_4.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exact_flow.step(model, integrator, state, samples);
    return status;
}

const laconic_method laconic_auto_fast = {"exponential-gauss-8", 8, NULL, auto_fast_step};

static laconic_status auto_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    integrator->chosen = integrator->stiff ? &laconic_auto_fast : &laconic_auto_slow;
    laconic_decay_levels(integrator, model, 3);
    return laconic_exponential_gauss_8.prepare(integrator, model, why);
}

/* No step function: `chosen` is always one of the two above. */
const laconic_method laconic_auto = {"auto", 8, PREPARE(auto_prepare), NULL};

#endif
