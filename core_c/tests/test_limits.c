#include "methods.h"

static laconic_refusal why;

static void an_explicit_method_is_limited_by_damping(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const laconic_state rest = moving(&m, 0, 0, 0);
    const double fastest = larger((double)m.decay_per_s[0], larger((double)m.decay_per_s[1], (double)m.decay_per_s[2]));
    const double limit = (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest);
    ASSERT_NEAR(limit * 4 * ROUNDING, 2.785 / fastest, limit);
}

/* The limit is the border: a little less is taken, a little more refused. */
static void an_explicit_method_is_limited_by_fast_turning(laconic_vehicle v) {
    const laconic_model m = model_of(v);
    laconic_state state = moving(&m, 1, 1, 400);
    const double limit = (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &state);
    const laconic_input input = no_input();
    laconic_integrator in = integrator_of(&laconic_rk4, &m, limit * 1.001);
    TEST_ASSERT_TRUE(limit > 0);
    ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, laconic_step(&m, &in, &state, &input));
    in = integrator_of(&laconic_rk4, &m, limit * 0.999);
    ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
}

static void fast_turning_limits_free_and_damped_vehicles(void) {
    an_explicit_method_is_limited_by_fast_turning(three_wheels());
    an_explicit_method_is_limited_by_fast_turning(with_motors(three_wheels()));
}

static void the_implicit_methods_bear_any_step(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_state state = moving(&m, 10, 10, 400);
    int32_t i;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(&laconic_auto, &m, &state));
    for (i = 2; i <= 5; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(laconic_method_by_number(i), &m, &state));
}

static void a_vehicle_without_damping_at_rest_bears_any_step(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state rest = moving(&m, 0, 0, 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest));
}

static void damping_near_the_end_of_the_range_still_has_a_limit(void) {
    laconic_vehicle v = three_wheels();
    laconic_model m;
    laconic_state rest;
    double limit;
    v.motor_damping_Nms = REAL(EITHER(1e150, 1e15));
    m = model_of(v);
    rest = moving(&m, 0, 0, 0);
    limit = (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest);
    TEST_ASSERT_TRUE(limit > 0 && limit < 1e-10);
}

static void whole_numbers_of_steps_are_counted(void) {
    uint64_t steps = 0;
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(0.1, 0.001, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(100, steps);
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(1e6, 1e-3, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(1000000000, steps);
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(0.01, 0.01, &steps, NULL));
    TEST_ASSERT_EQUAL_UINT64(1, steps);
}

static void an_interval_of_no_whole_number_of_steps_is_refused_with_one_that_fits(void) {
    uint64_t steps = 77;
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(0.1, 0.03, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 0.1 / 3, why.limit);
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(0.001, 1.0, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 0.001, why.limit);
    TEST_ASSERT_EQUAL_UINT64(77, steps);
}

/* 1000 s of 1 ms steps and half a step more: far within a tolerance relative to the time, but half a step is lost. */
static void the_tolerance_is_of_the_step_not_of_the_time(void) {
    uint64_t steps = 0;
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(1000.0005, 1e-3, &steps, &why));
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(1000.0 + 2e-9, 1e-3, &steps, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(1000.0 + 5e-10, 1e-3, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(1000000, steps);
}

static void intervals_and_steps_that_are_none_are_refused(void) {
    const double bad[] = {0, -1, (double)NAN, HUGE_VAL, -HUGE_VAL};
    uint64_t steps = 0;
    size_t i;
    for (i = 0; i < 5; i++) {
        ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(bad[i], 0.01, &steps, &why));
        TEST_ASSERT_NOT_EQUAL(LACONIC_OK, laconic_steps_in(1.0, bad[i], &steps, &why));
        TEST_ASSERT_EQUAL_STRING("step_s", laconic_field_name(why.field));
    }
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_steps_in(1.0, (double)NAN, &steps, &why));
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_steps_in(1.0, 0.0, &steps, &why));
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(1e9, 1e-9, &steps, &why));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_explicit_method_is_limited_by_damping);
    RUN_TEST(fast_turning_limits_free_and_damped_vehicles);
    RUN_TEST(the_implicit_methods_bear_any_step);
    RUN_TEST(a_vehicle_without_damping_at_rest_bears_any_step);
    RUN_TEST(damping_near_the_end_of_the_range_still_has_a_limit);
    RUN_TEST(whole_numbers_of_steps_are_counted);
    RUN_TEST(an_interval_of_no_whole_number_of_steps_is_refused_with_one_that_fits);
    RUN_TEST(the_tolerance_is_of_the_step_not_of_the_time);
    RUN_TEST(intervals_and_steps_that_are_none_are_refused);
    return UNITY_END();
}
