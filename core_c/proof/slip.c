/* Where wheels of a vehicle with friction start, for Frama-C's analyser: friction as laconic_friction_of() leaves
 * it. */
#include "anything.h"

void prove_slip_set(void) {
    static laconic_friction friction;
    static laconic_slip slip;
    countable_vehicle();
    any_model(&model);
    model.wheel_count = vehicle.wheel_count;
    ANYTHING(start);
    if (laconic_friction_of(&friction, &model, &vehicle, NULL) != LACONIC_OK) return;
    (void)laconic_slip_set(&slip, &friction, &vehicle, &start, any_refusal());
}
