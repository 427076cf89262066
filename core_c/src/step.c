/* Steps with the input held: input → load once, then the method. The one stepping loop of the project. */
#include "heading.h"
#include "load.h"

uint64_t laconic_run(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                     const laconic_input *held, uint64_t steps, laconic_status *status) {
    laconic_load load;
    laconic_loads loads = {&load, &load, &load, true};
    laconic_status last = LACONIC_OK;
    uint64_t left;
    if (zero_if_finite(world_force_place(held)) != R(0)) {
        *status = LACONIC_OVERFLOW;
        return 0;
    }
    load_of(&load, model, held);
    loads.steady = !load.turns;
    for (left = steps; left > 0; left--) {
        if (!heading_has_room(&state->heading)) {
            last = LACONIC_OVERFLOW;
            break;
        }
        last = integrator->chosen->step(model, integrator, state, &loads);
        if (last != LACONIC_OK) break;
    }
    *status = last;
    return steps - left;
}

laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held) {
    laconic_status status;
    laconic_run(model, integrator, state, held, 1, &status);
    return status;
}
