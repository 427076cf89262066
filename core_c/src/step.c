/* One step: input → load → the method. */
#include "load.h"

laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held) {
    laconic_load load;
    const laconic_loads loads = {&load, &load, &load};
    load_of(&load, model, held);
    return integrator->chosen->step(model, integrator, state, &loads);
}
