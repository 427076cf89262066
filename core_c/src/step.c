/* Steps with the input held: input → load once, then the method. The one stepping loop of the project. */
#include "load.h"

uint64_t laconic_run(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                     const laconic_input *held, uint64_t steps, laconic_status *status) {
    laconic_load load;
    const laconic_loads loads = {&load, &load, &load};
    uint64_t taken;
    load_of(&load, model, held);
    *status = LACONIC_OK;
    for (taken = 0; taken < steps; taken++) {
        *status = integrator->chosen->step(model, integrator, state, &loads);
        if (*status != LACONIC_OK) break;
    }
    return taken;
}

laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held) {
    laconic_status status;
    laconic_run(model, integrator, state, held, 1, &status);
    return status;
}
