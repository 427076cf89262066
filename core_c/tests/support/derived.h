/* The methods whose steps are differentiated: tests of derivatives go through them by number. */
#ifndef LACONIC_TEST_DERIVED_H
#define LACONIC_TEST_DERIVED_H

#include "laconic/derivatives.h"
#include "methods.h"

/* A method that has no derivation yet is in no list of those that derivations.c has. */
static inline bool is_derived(const laconic_method *method) {
    const laconic_model model = model_of(with_motors(three_wheels()));
    const laconic_integrator integrator = integrator_of(method, &model, 0.01);
    const laconic_state state = moving(&model, 0, 0, 0);
    const laconic_input input = no_input();
    laconic_step_jacobian jacobian;
    return laconic_step_jacobian_of(&jacobian, &model, &integrator, &state, &input, false) != LACONIC_METHOD_UNKNOWN;
}

/* The next from this number on; LACONIC_METHOD_COUNT: there is none. */
static inline int32_t derived_from(int32_t number) {
    while (number < LACONIC_METHOD_COUNT && !is_derived(laconic_method_by_number(number))) number++;
    return number;
}

#define FOR_EACH_DERIVED(number) \
    for (int32_t number = derived_from(0); number < LACONIC_METHOD_COUNT; number = derived_from(number + 1))

#endif
