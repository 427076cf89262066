#include "heading.h"
#include "load.h"

/* What some methods never look at: a world force in the middle, which those of second order turn from the start's to
 * the end's; and where a force of 0 acts. */
static inline bool world_forces_are_finite(const laconic_input *start, const laconic_input *middle,
                                           const laconic_input *end) {
    const real force = LACONIC_WITH_WORLD_FORCE ? middle->world_force_N[0] + middle->world_force_N[1] : R(0);
    const real places = world_force_place(start) + world_force_place(middle) + world_force_place(end);
    return zero_if_finite(force + places) == R(0);
}

laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end) {
    laconic_load load[3];
    const laconic_loads loads = {&load[0], &load[1], &load[2], false};
    if (!world_forces_are_finite(start, middle, end) || !heading_has_room(&state->heading)) return LACONIC_OVERFLOW;
    load_of(&load[0], model, start);
    load_of(&load[1], model, middle);
    load_of(&load[2], model, end);
    return integrator->chosen->step(model, integrator, state, &loads);
}
