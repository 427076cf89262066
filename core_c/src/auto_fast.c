/* What auto takes while damping is fast beside the step; see auto.c. */
#include "internal.h"

static laconic_status fast_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_loads *loads) {
    const laconic_status status = laconic_exponential_kahan_4.step(model, integrator, state, loads);
    if (status == LACONIC_OK) return status;
    return laconic_exact_flow.step(model, integrator, state, loads);
}

const laconic_method laconic_auto_fast = {"exponential-kahan-4", 4, NULL, fast_step};
