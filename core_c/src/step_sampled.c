#include "load.h"

/* Methods of second order turn a world force from the start's to the end's and never look at the middle one. */
static bool middle_is_finite(const laconic_load *middle) {
    if (!LACONIC_WITH_WORLD_FORCE || !middle->turns) return true;
    return zero_if_finite(middle->cosine[0] + middle->cosine[1] + middle->cosine[2] + middle->sine[0] +
                          middle->sine[1] + middle->sine[2]) == R(0);
}

laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end) {
    laconic_load load[3];
    const laconic_loads loads = {&load[0], &load[1], &load[2], false};
    load_of(&load[0], model, start);
    load_of(&load[1], model, middle);
    load_of(&load[2], model, end);
    if (!middle_is_finite(&load[1])) return LACONIC_OVERFLOW;
    return integrator->chosen->step(model, integrator, state, &loads);
}
