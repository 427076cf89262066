/* Exact-flow splitting, extrapolated to fourth order: exact for free motion, best while damping is slow. */
#include "exact_flow.h"
#include "integrator.h"
#include "symmetric.h"

static laconic_status exact_flow_4_increment(const laconic_model *model, const laconic_integrator *integrator,
                                             const laconic_state *state, laconic_loads loads,
                                             laconic_increment *out) {
    return extrapolated_step(exact_flow_step, model, integrator, state, loads, out);
}

static laconic_status exact_flow_4_prepare(laconic_integrator *integrator, const laconic_model *model,
                                           laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 3);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow_4 = {"exact-flow-4", 4, exact_flow_4_prepare, exact_flow_4_increment};
