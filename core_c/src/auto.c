/* auto: a method of fourth order where one takes the step, else exact-flow, which takes every step. The rule in full:
 *
 *   h·r_max < 0.3    exact-flow-4          damping is slow beside the step: the error of the splitting is least, and
 *                                          free motion keeps its energy
 *                    taylor-8              instead, in steps over which b varies, while h·|w||g·ζ| < 0.5: there
 *                                          nothing is conserved, and taylor-8 is cheaper and more exact
 *   otherwise        exponential-kahan-4   keeps the steady state that fast damping leads to
 *   and where the chosen one refuses a step (it would gain energy or has no solution: h·|ν3| is large), that
 *   step is taken by exact-flow, which every step suits.
 *
 * The choice by damping is made once, when the integrator is prepared, and can be read in `chosen`; the rest depends
 * only on state and input. So the same run makes the same choices everywhere. */
#include "step_internals.h"

#define SERIES_ROTATION R(0.5) /* rad: of the terms aⁿ/n! the first that taylor-8 leaves out is then 5e-9 */

static laconic_status auto_slow_step(const laconic_model *model, const laconic_integrator *integrator,
                                     laconic_state *state, const laconic_forcing_samples *samples) {
    laconic_status status = LACONIC_STEP_SINGULAR; /* none has taken the step yet */
    if (!constant_over(samples)) status = laconic_taylor_8.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exact_flow_4.step(model, integrator, state, samples);
    if (status != LACONIC_OK) status = laconic_exact_flow.step(model, integrator, state, samples);
    return status;
}

const laconic_method laconic_auto_slow = {"exact-flow-4", 4, NULL, auto_slow_step};

static laconic_status auto_fast_step(const laconic_model *model, const laconic_integrator *integrator,
                                     laconic_state *state, const laconic_forcing_samples *samples) {
    const laconic_status status = laconic_exponential_kahan_4.step(model, integrator, state, samples);
    if (status == LACONIC_OK) return status;
    return laconic_exact_flow.step(model, integrator, state, samples);
}

const laconic_method laconic_auto_fast = {"exponential-kahan-4", 4, NULL, auto_fast_step};

static laconic_status auto_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    integrator->chosen = integrator->stiff ? &laconic_auto_fast : &laconic_auto_slow;
    laconic_decay_levels(integrator, model, 3);
    return laconic_explicit_limits(integrator, model, LACONIC_REAL_MAX, SERIES_ROTATION, why);
}

/* No step function: `chosen` is always one of the two above. */
const laconic_method laconic_auto = {"auto", 4, PREPARE(auto_prepare), NULL};
