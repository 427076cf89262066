/* Exact-flow splitting, extrapolated to fourth order: exact for free motion, best while damping is slow. */
#include "exact_flow.h"
#include "integrator.h"

RARE increment flow_4_varying(const laconic_model *model, const laconic_integrator *integrator,
                              const laconic_state *state, const laconic_loads *loads) {
    return extrapolated_varying(exact_flow_step, model, integrator, state, loads);
}

static laconic_status flow_4_step(const laconic_model *model, const laconic_integrator *integrator,
                                  laconic_state *state, const laconic_loads *loads) {
    const vector zeta = zeta_of(state);
    const increment by = steady_over(loads) ? extrapolated(exact_flow_step, model, integrator, zeta, loads)
                                            : flow_4_varying(model, integrator, state, loads);
    return advance_if_passive(state, model, integrator->step_s, loads, zeta, by);
}

static laconic_status flow_4_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    (void)why;
    laconic_decay_levels(integrator, model, 3);
    return LACONIC_OK;
}

const laconic_method laconic_exact_flow_4 = {"exact-flow-4", 4, PREPARE(flow_4_prepare), flow_4_step};
