/* auto: fourth order where it can be had, a step that cannot fail where not. The rule, in full:
 *
 *   h·r_max < 0.3    exact-flow-4          damping is slow beside the step: the splitting's error is least
 *   otherwise        exponential-kahan-4   keeps the steady state that fast damping leads to
 *   and where the chosen one refuses a step (it would gain energy: h·|ν3| is large), that step is taken
 *   by exact-flow, which every step suits.
 *
 * The choice is made once, when the integrator is prepared, and can be read in `chosen`; exact-flow steps in
 * depend only on state and input. So the same run makes the same choices everywhere. */
#include "integrator.h"

#define SLOW_DAMPING R(0.3)

static laconic_status with_fallback(const laconic_method *method, const laconic_model *model,
                                    const laconic_integrator *integrator, const laconic_state *state,
                                    laconic_loads loads, laconic_increment *out) {
    const laconic_status status = method->increment(model, integrator, state, loads, out);
    if (status == LACONIC_OK) return status;
    return laconic_exact_flow.increment(model, integrator, state, loads, out);
}

static laconic_status slow_increment(const laconic_model *model, const laconic_integrator *integrator,
                                     const laconic_state *state, laconic_loads loads, laconic_increment *out) {
    return with_fallback(&laconic_exact_flow_4, model, integrator, state, loads, out);
}

static laconic_status fast_increment(const laconic_model *model, const laconic_integrator *integrator,
                                     const laconic_state *state, laconic_loads loads, laconic_increment *out) {
    return with_fallback(&laconic_exponential_kahan_4, model, integrator, state, loads, out);
}

static laconic_status auto_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why);

static const laconic_method slow = {"exact-flow-4", 4, auto_prepare, slow_increment};
static const laconic_method fast = {"exponential-kahan-4", 4, auto_prepare, fast_increment};

static laconic_status auto_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    const real damping = integrator->step_s * laconic_fastest_decay(model);
    (void)why;
    integrator->chosen = damping < SLOW_DAMPING ? &slow : &fast;
    laconic_decay_levels(integrator, model, 3);
    return LACONIC_OK;
}

const laconic_method laconic_auto = {"auto", 4, auto_prepare, slow_increment};
