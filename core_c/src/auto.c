/* auto: fourth order where it can be had, a step that cannot fail where not. The rule, in full:
 *
 *   h·r_max < 0.3    exact-flow-4          damping is slow beside the step: the splitting's error is least
 *   otherwise        exponential-kahan-4   keeps the steady state that fast damping leads to
 *   and where the chosen one refuses a step (it would gain energy or has no solution: h·|ν3| is large), that
 *   step is taken by exact-flow, which every step suits.
 *
 * The choice is made once, when the integrator is prepared, and can be read in `chosen`; whether exact-flow steps
 * in depends only on state and input. So the same run makes the same choices everywhere. */
#include "integrator.h"

static laconic_status auto_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    integrator->chosen = integrator->stiff ? &laconic_auto_fast : &laconic_auto_slow;
    laconic_decay_levels(integrator, model, 3);
    return LACONIC_OK;
}

/* Its own step is never taken: `chosen` is always one of the two. */
const laconic_method laconic_auto = {"auto", 4, PREPARE(auto_prepare), NULL};
