#include "methods.h"

static laconic_refusal why;

static laconic_status explain(const laconic_method *method, laconic_status status, const laconic_input *input) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(method, &m, 0.1);
    const laconic_state state = moving(&m, 1, 1, 500);
    laconic_step_refusal(&why, status, &m, &in, &state, input, 1);
    return why.status;
}

static void an_input_that_is_not_finite_is_found(void) {
    laconic_input input = no_input();
    input.axle_torque_Nm[1] = INFINITE;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_AXLE_TORQUE, 2, explain(&laconic_rk4, LACONIC_NOT_FINITE, &input),
                   why);
}

static void every_sample_of_a_step_is_looked_at(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    int32_t i, k;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (k = 0; k < 3; k++) {
            const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.1);
            laconic_input at[3] = {every_input(), every_input(), every_input()};
            laconic_state state = moving(&m, 1, 2, 3), before = state;
            laconic_status status;
            at[k].voltage_V[2 - k] = NOT_A_NUMBER;
            status = laconic_step_sampled(&m, &in, &state, &at[0], &at[1], &at[2]);
            TEST_ASSERT_NOT_EQUAL(LACONIC_OK, status);
            TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
            laconic_step_refusal(&why, status, &m, &in, &state, at, 3);
            ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 3 - k, why.status, why);
        }
}

static void turning_too_fast_comes_with_the_largest_step(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 1, 1, 500);
    const laconic_input input = no_input();
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   explain(&laconic_rk4, LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, &input), why);
    TEST_ASSERT_EQUAL_DOUBLE((double)laconic_largest_stable_step_s(&laconic_rk4, &m, &state), (double)why.limit);
    ASSERT_NEAR(ROUNDING, 0.1, why.value);
}

static void other_failures_come_with_half_the_step(void) {
    const laconic_input input = no_input();
    ASSERT_REFUSED(LACONIC_STEP_GAINS_ENERGY, LACONIC_FIELD_STEP, 0,
                   explain(&laconic_exponential_kahan, LACONIC_STEP_GAINS_ENERGY, &input), why);
    ASSERT_NEAR(ROUNDING, 0.05, why.limit);
    ASSERT_REFUSED(LACONIC_STEP_SINGULAR, LACONIC_FIELD_STEP, 0,
                   explain(&laconic_exponential_kahan, LACONIC_STEP_SINGULAR, &input), why);
    ASSERT_NEAR(ROUNDING, 0.05, why.limit);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, explain(&laconic_exact_flow, LACONIC_OVERFLOW, &input),
                   why);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)why.limit);
}

static void nobody_need_ask_why(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.1);
    const laconic_state state = moving(&m, 1, 1, 500);
    const laconic_input input = no_input();
    laconic_step_refusal(NULL, LACONIC_OVERFLOW, &m, &in, &state, &input, 1);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_input_that_is_not_finite_is_found);
    RUN_TEST(every_sample_of_a_step_is_looked_at);
    RUN_TEST(turning_too_fast_comes_with_the_largest_step);
    RUN_TEST(other_failures_come_with_half_the_step);
    RUN_TEST(nobody_need_ask_why);
    return UNITY_END();
}
