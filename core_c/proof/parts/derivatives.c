/* Calls of functions of derivatives.h, for Frama-C's analyser: those that take no step. */
#include "laconic/derivatives.h"

#include "anything.h"

static laconic_step_jacobian jacobian;
static laconic_model_change by_model;

void prove_jacobian_matrices(void) {
    static laconic_real by_state[(6 + LACONIC_MAX_WHEELS) * (6 + LACONIC_MAX_WHEELS)];
    static laconic_real by_input[(6 + LACONIC_MAX_WHEELS) * LACONIC_INPUT_NUMBERS(LACONIC_MAX_WHEELS)];
    any_model(&model);
    ANYTHING(jacobian);
    jacobian.has_world_force = ANY_BOOL();
    laconic_jacobian_by_state(by_state, &jacobian, &model);
    laconic_jacobian_by_input(by_input, &jacobian, &model);
}

/* The change of a vehicle is one, too, of which only the numbers are read. */
void prove_model_tangent(void) {
    static laconic_vehicle by;
    countable_vehicle();
    any_model(&model);
    model.wheel_count = vehicle.wheel_count;
    ANYTHING(by);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        by.wheel[i].locked = ANY_BOOL();
        by.wheel[i].undriven = ANY_BOOL();
    }
    (void)laconic_model_tangent(&by_model, &model, &vehicle, &by);
}
