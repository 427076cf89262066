/* What auto takes while damping is slow beside the step; see auto.c. */
#include "load.h"

static laconic_status slow_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_loads *loads) {
    laconic_status status = LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    if (!steady_over(loads)) status = laconic_taylor_8.step(model, integrator, state, loads);
    if (status != LACONIC_OK) status = laconic_exact_flow_4.step(model, integrator, state, loads);
    if (status != LACONIC_OK) status = laconic_exact_flow.step(model, integrator, state, loads);
    return status;
}

const laconic_method laconic_auto_slow = {"exact-flow-4", 4, NULL, slow_step};
