/* A vehicle with strong motors on slow steps: h·r is in the hundreds. */
#ifndef LACONIC_TEST_STIFF_H
#define LACONIC_TEST_STIFF_H

#include "methods.h"

static inline laconic_vehicle stiff(void) {
    laconic_vehicle v = mecanum();
    v.motor_gain_Nm_per_V = REAL(20);
    v.motor_damping_Nms = REAL(20);
    return v;
}

/* Forward at 1 V on every wheel: χ' = c1 U/c2 = 1 rad/s, so ν = (1, 0, 0), reached within one step. */
static inline void assert_stiff_vehicle_reaches_its_steady_motion(const laconic_method *method, double tolerance) {
    const laconic_model m = model_of(stiff());
    laconic_state state = moving(&m, 0, 0, 0);
    laconic_input input = no_input();
    laconic_real nu[3];
    int i;
    for (i = 0; i < 4; i++) input.voltage_V[i] = REAL(1);
    take_steps(method, &m, &state, &input, 0.1, 20);
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR(tolerance, 1, nu[0]);
    ASSERT_NEAR(tolerance, 0, nu[1]);
    ASSERT_NEAR(tolerance, 0, nu[2]);
}

/* From `start` in one step of `step`: refused with `status`, and nothing has changed. */
static inline void assert_step_refused(const laconic_method *method, laconic_vehicle v, laconic_start start,
                                       laconic_input input, double step, laconic_status status) {
    const laconic_model m = model_of(v);
    const laconic_integrator in = integrator_of(method, &m, step);
    laconic_state state = state_of(&m, start), before = state;
    ASSERT_STATUS(status, laconic_step(&m, &in, &state, &input));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
}

#endif
