/* One step: input → load → the method's increment of ζ → the next state. */
#include "advance.h"

static laconic_status take(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                           laconic_loads loads) {
    laconic_increment increment;
    const laconic_status status = integrator->chosen->increment(model, integrator, state, loads, &increment);
    if (status != LACONIC_OK) return status;
    return laconic_advance(state, model, integrator->step_s, &increment);
}

laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held) {
    laconic_load load;
    laconic_load_of(&load, model, held);
    return take(model, integrator, state, (laconic_loads){&load, &load, &load});
}

laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end) {
    laconic_load load[3];
    laconic_load_of(&load[0], model, start);
    laconic_load_of(&load[1], model, middle);
    laconic_load_of(&load[2], model, end);
    return take(model, integrator, state, (laconic_loads){&load[0], &load[1], &load[2]});
}
