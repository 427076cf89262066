/* A vehicle whose damping is fast beside the step: h·r is in the hundreds. */
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
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(1);
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

/* A caster moves straight on: the forcing supplies the energy, so nothing but the range of numbers can refuse it. */
static inline void assert_too_large_force_refused(const laconic_method *method) {
    laconic_input input = no_input();
    input.body_force_N[0] = REAL(EITHER(1e100, 1e15));
    assert_step_refused(method, caster(), start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

static inline void assert_too_fast_yaw_refused(const laconic_method *method) {
    assert_step_refused(method, three_wheels(), start_with(1, 1, 500), no_input(), 0.1,
                        LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT);
}

/* Searches random starts for one whose step of `step` is refused since it would gain energy. Such states are rare, and
 * which they are is not promised; that they are refused and the state then stays as it was, is. */
static inline laconic_start start_that_gains_energy(const laconic_method *method, laconic_vehicle v,
                                                    laconic_input input, double step, double speed) {
    const laconic_model m = model_of(v);
    const laconic_integrator in = integrator_of(method, &m, step);
    laconic_start start = start_with(0, 0, 0);
    uint32_t seed = 1;
    for (int tries = 0; tries < 100000; tries++) {
        laconic_state state, before;
        for (int k = 0; k < 3; k++) {
            seed = seed * 1664525U + 1013904223U;
            start.nu_rad_per_s[k] = REAL(speed * ((double)(seed >> 8) / 8388608.0 - 1.0));
        }
        state = before = state_of(&m, start);
        if (laconic_step(&m, &in, &state, &input) == LACONIC_STEP_GAINS_ENERGY) {
            TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
            return start;
        }
    }
    TEST_FAIL_MESSAGE("no start was refused");
    return start;
}

#endif
