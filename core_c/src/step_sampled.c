#include "load.h"

laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end) {
    laconic_load load[3];
    const laconic_loads loads = {&load[0], &load[1], &load[2], false};
    load_of(&load[0], model, start);
    load_of(&load[1], model, middle);
    load_of(&load[2], model, end);
    return integrator->chosen->step(model, integrator, state, &loads);
}
