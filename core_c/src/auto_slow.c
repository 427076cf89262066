/* What auto takes while damping is slow beside the step; see auto.c. */
#include "internal.h"

static laconic_status slow_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_loads *loads) {
    const laconic_status status = laconic_exact_flow_4.step(model, integrator, state, loads);
    if (status == LACONIC_OK) return status;
    return laconic_exact_flow.step(model, integrator, state, loads);
}

const laconic_method laconic_auto_slow = {"exact-flow-4", 4, NULL, slow_step};
