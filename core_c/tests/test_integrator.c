#include "integrator.h"

#include "methods.h"

static laconic_refusal why;

static void refuses(const laconic_method *method, double step, laconic_status status, laconic_field field) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_integrator in, before;
    memset(&in, 6, sizeof in);
    before = in;
    ASSERT_REFUSED(status, field, 0, laconic_integrator_prepare(&in, method, &m, REAL(step), &why), why);
    ASSERT_STATUS(status, laconic_integrator_prepare(&in, method, &m, REAL(step), NULL));
    if (status == LACONIC_OVERFLOW) TEST_ASSERT_EQUAL_DOUBLE(1e9, (double)why.limit);
    TEST_ASSERT_EQUAL_MEMORY(&before, &in, sizeof in);
}

static void steps_that_are_none_are_refused(void) {
    int32_t i;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        refuses(method, 0, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP);
        refuses(method, -0.01, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP);
        refuses(method, (double)NAN, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP);
        refuses(method, HUGE_VAL, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP);
    }
}

static void a_step_of_decades_is_refused_with_the_longest_there_is(void) {
    int32_t i;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        refuses(laconic_method_by_number(i), 2e9, LACONIC_OVERFLOW, LACONIC_FIELD_STEP);
    }
}

static void a_step_whose_parts_have_no_inverse_is_refused_with_the_shortest_there_is(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_integrator in;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0,
                   laconic_integrator_prepare(&in, &laconic_auto, &m, LACONIC_REAL_MIN, &why), why);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_auto, &m, why.limit, &why));
    TEST_ASSERT_TRUE(isfinite((double)in.decay[2].inverse_gain[0]));
}

static void no_method_is_refused(void) { refuses(NULL, 0.01, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD); }

static void a_good_step_is_kept_with_its_method(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.125);
    TEST_ASSERT_EQUAL_DOUBLE(0.125, (double)in.step_s);
    TEST_ASSERT_EQUAL_PTR(&laconic_rk4, in.method);
    TEST_ASSERT_EQUAL_PTR(&laconic_rk4, in.chosen);
}

static void the_fastest_decay_is_the_largest_of_all_axes(void) {
    laconic_model m;
    int k;
    memset(&m, 0, sizeof m);
    for (k = 0; k < 3; k++) {
        m.decay_per_s[k] = REAL(k + 1);
        TEST_ASSERT_EQUAL_DOUBLE(k + 1, (double)laconic_fastest_decay(&m));
    }
    m.decay_per_s[0] = REAL(9);
    TEST_ASSERT_EQUAL_DOUBLE(9, (double)laconic_fastest_decay(&m));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(steps_that_are_none_are_refused);
    RUN_TEST(a_step_of_decades_is_refused_with_the_longest_there_is);
    RUN_TEST(a_step_whose_parts_have_no_inverse_is_refused_with_the_shortest_there_is);
    RUN_TEST(no_method_is_refused);
    RUN_TEST(a_good_step_is_kept_with_its_method);
    RUN_TEST(the_fastest_decay_is_the_largest_of_all_axes);
    return UNITY_END();
}
