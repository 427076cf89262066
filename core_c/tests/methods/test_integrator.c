/* Tests of integrator.c: which steps a method takes, and what is prepared for them. */
#include "step_internals.h"

#include "methods.h"

/* ------------------------------------------------------------------------------- preparation -- */

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

static void steps_that_are_not_positive_and_finite_are_refused(void) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        refuses(method, 0, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP);
        refuses(method, -0.01, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP);
        refuses(method, (double)NAN, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP);
        refuses(method, HUGE_VAL, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP);
    }
}

static void a_step_of_decades_is_refused_with_the_longest_there_is(void) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
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

static void a_null_method_is_refused(void) { refuses(NULL, 0.01, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD); }

static void a_good_step_is_kept_with_its_method(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.125);
    TEST_ASSERT_EQUAL_DOUBLE(0.125, (double)in.step_s);
    TEST_ASSERT_EQUAL_PTR(&laconic_rk4, in.method);
    TEST_ASSERT_EQUAL_PTR(&laconic_rk4, in.chosen);
}

/* Below h·r = 0.3 auto goes on with a splitting where it must, from there on with an exponential method. */
static void damping_is_fast_from_its_border_on(void) {
    const laconic_real border = REAL(0.3), below = border * (1 - LACONIC_EPSILON);
    laconic_model m;
    laconic_integrator in;
    memset(&m, 0, sizeof m);
    m.decay_per_s[1] = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_auto, &m, border, &why));
    TEST_ASSERT_TRUE(in.stiff);
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_fast, in.chosen);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_auto, &m, below, &why));
    TEST_ASSERT_FALSE(in.stiff);
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_slow, in.chosen);
}

static void the_fastest_decay_is_the_largest_of_all_axes(void) {
    laconic_model m;
    memset(&m, 0, sizeof m);
    for (int k = 0; k < 3; k++) {
        m.decay_per_s[k] = REAL(k + 1);
        TEST_ASSERT_EQUAL_DOUBLE(k + 1, (double)laconic_fastest_decay(&m));
    }
    m.decay_per_s[0] = REAL(9);
    TEST_ASSERT_EQUAL_DOUBLE(9, (double)laconic_fastest_decay(&m));
    m.decay_per_s[1] = REAL(9) * (REAL(1) + REAL(4) * LACONIC_EPSILON); /* by its last digits */
    TEST_ASSERT_EQUAL_DOUBLE((double)m.decay_per_s[1], (double)laconic_fastest_decay(&m));
}

/* -------------------------------------------------------------- factors of exponential steps -- */

/* One axis alone, ζ' = −rζ + b + change·s + curve·s(s − 1), s = t/h: increment, mean and first moment by the exact
 * solution (variation of constants, Simpson's rule twice). */
typedef struct axis {
    double rate, step, zeta, start, change, curve;
} axis;

static double driven(const axis *a, double t) {
    const double s = t / a->step;
    return a->start + a->change * s + a->curve * s * (s - 1);
}

/* ζ at the next node from the one before: within a node's width b is a parabola and Simpson's rule is exact for it. */
static double next(const axis *a, double zeta, double t, double dt) {
    const double decay = exp(-a->rate * dt), half = exp(-a->rate * dt / 2);
    return decay * zeta + dt / 6 * (decay * driven(a, t) + 4 * half * driven(a, t + dt / 2) + driven(a, t + dt));
}

static void factors_are_those_of_the_damped_axis(void) {
    const double rates[3] = {0.0, 0.7, 40.0};
    const int n = 20000;
    laconic_model m;
    laconic_decay d;
    memset(&m, 0, sizeof m);
    for (int k = 0; k < 3; k++) m.decay_per_s[k] = REAL(rates[k]);
    laconic_decay_of(&d, &m, REAL(0.8));
    for (int k = 0; k < 3; k++) {
        const axis a = {rates[k], 0.8, 1.3, -0.4, 2.1, -1.7};
        double zeta = a.zeta, mean = 0, moment = 0;
        for (int i = 0; i <= n; i++) {
            const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * n);
            mean += weight * zeta;
            moment += weight * ((double)i / n - 0.5) * zeta;
            if (i < n) zeta = next(&a, zeta, a.step * i / n, a.step / n);
        }
        const double delta = (double)d.gain[k] *
                             (a.start - a.rate * a.zeta + (double)d.mean[k] * a.change + (double)d.bend[k] * a.curve);
        ASSERT_NEAR(EITHER(1e-11, 1e-5), zeta - a.zeta, delta);
        ASSERT_NEAR(EITHER(1e-11, 1e-5), mean,
                    a.zeta + (double)d.mean[k] * delta + (double)d.mean_ramp[k] * a.change +
                        (double)d.mean_bend[k] * a.curve);
        ASSERT_NEAR(EITHER(1e-10, 1e-4), 12 * moment,
                    (double)d.slope[k] * delta + (double)d.slope_ramp[k] * a.change +
                        (double)d.slope_bend[k] * a.curve);
        ASSERT_NEAR(4 * ROUNDING, 1, (double)d.gain[k] * (double)d.inverse_gain[k]);
    }
}

static void levels_are_halved_steps(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_integrator in;
    laconic_decay half;
    memset(&in, 0, sizeof in);
    in.step_s = REAL(0.5);
    laconic_decay_levels(&in, &m, 3);
    laconic_decay_of(&half, &m, REAL(0.125));
    TEST_ASSERT_EQUAL_MEMORY(&half, &in.decay[2], sizeof half);
}

static void without_damping_zeta_changes_linearly_and_with_fast_damping_it_jumps(void) {
    laconic_model m;
    laconic_decay d;
    memset(&m, 0, sizeof m);
    m.decay_per_s[1] = REAL(1e12);
    laconic_decay_of(&d, &m, REAL(1));
    ASSERT_NEAR(ROUNDING, 0.5, d.mean[0]);
    ASSERT_NEAR(EITHER(1e-14, 4e-6), 1, d.slope[0]);
    ASSERT_NEAR(1e-6, 1, d.mean[1]);
    ASSERT_NEAR(1e-6, 0, d.slope[1]);
}

/* ------------------------------------------------------------------------------------ limits -- */

static void an_explicit_method_is_limited_by_damping(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const laconic_state rest = moving(&m, 0, 0, 0);
    const double fastest = larger((double)m.decay_per_s[0], larger((double)m.decay_per_s[1], (double)m.decay_per_s[2]));
    const double limit = (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest);
    ASSERT_NEAR(limit * 4 * ROUNDING, 2.785 / fastest, limit);
}

/* A step a little below the limit is taken, one a little above is refused. */
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

/* A step of the limit itself is taken; as short as this every yaw is slow enough, up to the end of the range. */
static void at_its_limits_a_step_is_taken(void) {
    laconic_model m;
    laconic_integrator in;
    memset(&m, 0, sizeof m);
    memset(&in, 0, sizeof in);
    m.decay_per_s[2] = m.gyro[0] = REAL(1);
    in.step_s = REAL(2.5);
    ASSERT_STATUS(LACONIC_OK, laconic_explicit_limits(&in, &m, REAL(2.5), REAL(5), &why));
    TEST_ASSERT_EQUAL_DOUBLE(2, (double)in.gyro_limit);
    in.step_s = 4 / LACONIC_REAL_MAX;
    ASSERT_STATUS(LACONIC_OK, laconic_explicit_limits(&in, &m, REAL(2.5), REAL(4), &why));
    TEST_ASSERT_TRUE(in.gyro_limit == LACONIC_REAL_MAX);
}

static void a_yaw_of_the_limit_itself_is_not_beyond_it(void) {
    const laconic_input input = no_input();
    const laconic_method *const explicit_ones[3] = {&laconic_rk4, &laconic_taylor_8, &laconic_exponential_gauss_8};
    laconic_model m;
    laconic_state state;
    memset(&m, 0, sizeof m);
    m.nu_of_zeta[2][2] = REAL(1);
    for (int k = 0; k < 3; k++) {
        laconic_integrator in = integrator_of(explicit_ones[k], &m, 0.5);
        in.gyro_limit = REAL(2);
        memset(&state, 0, sizeof state);
        state.zeta[2].value = REAL(2);
        ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
        state.zeta[2].value = REAL(2) * (1 + LACONIC_EPSILON);
        ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, laconic_step(&m, &in, &state, &input));
    }
}

static void a_fast_yaw_limits_the_step_with_and_without_damping(void) {
    an_explicit_method_is_limited_by_fast_turning(three_wheels());
    an_explicit_method_is_limited_by_fast_turning(with_motors(three_wheels()));
}

static void the_implicit_methods_take_any_step(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_state state = moving(&m, 10, 10, 400);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(&laconic_auto, &m, &state));
    for (int32_t i = 2; i <= 5; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(laconic_method_by_number(i), &m, &state));
}

static void without_damping_and_at_rest_any_step_is_stable(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state rest = moving(&m, 0, 0, 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest));
}

static void damping_near_the_end_of_the_range_still_has_a_limit(void) {
    laconic_vehicle v = three_wheels();
    laconic_model m;
    laconic_state rest;
    v.motor_damping_Nms = REAL(EITHER(1e150, 1e15));
    m = model_of(v);
    rest = moving(&m, 0, 0, 0);
    const double limit = (double)laconic_largest_stable_step_s(&laconic_rk4, &m, &rest);
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

static void intervals_and_steps_up_to_the_end_of_the_range_are_counted(void) {
    uint64_t steps = 77;
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(DBL_MAX, DBL_MAX, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(1, steps);
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(9e15 - 2, 1, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(8999999999999998, steps);
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(9e15 - 1, 1, &steps, &why)); /* half a step more would be even */
    TEST_ASSERT_EQUAL_UINT64(8999999999999999, steps);
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(4503599627370497, 1, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(4503599627370497, steps);
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(9e15, 1, &steps, &why));
}

static void an_interval_of_no_whole_number_of_steps_is_refused_with_one_that_fits(void) {
    uint64_t steps = 77;
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(0.1, 0.03, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 0.1 / 3, why.limit);
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(0.001, 1.0, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 0.001, why.limit);
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(2.5, 1.0, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 2.5 / 3, why.limit); /* the shorter of both that are as near */
    ASSERT_REFUSED(LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, laconic_steps_in(0.25, 1.0, &steps, &why), why);
    ASSERT_NEAR(ROUNDING, 0.25, why.limit);
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

static void the_tolerance_is_a_millionth_of_the_step_to_both_sides(void) {
    uint64_t steps = 0;
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(3 + 0.999e-6, 1, &steps, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_steps_in(3 - 0.999e-6, 1, &steps, &why));
    TEST_ASSERT_EQUAL_UINT64(3, steps);
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(3 + 1.001e-6, 1, &steps, &why));
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(3 - 1.001e-6, 1, &steps, &why));
}

static void intervals_and_steps_that_are_not_positive_and_finite_are_refused(void) {
    const double bad[] = {0, -1, (double)NAN, HUGE_VAL, -HUGE_VAL};
    uint64_t steps = 0;
    for (size_t i = 0; i < 5; i++) {
        ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(bad[i], 0.01, &steps, &why));
        TEST_ASSERT_NOT_EQUAL(LACONIC_OK, laconic_steps_in(1.0, bad[i], &steps, &why));
        TEST_ASSERT_EQUAL_STRING("step_s", laconic_field_name(why.field));
    }
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT,
                  laconic_steps_in(HUGE_VAL, HUGE_VAL, &steps, &why)); /* first the interval */
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_steps_in(1.0, (double)NAN, &steps, &why));
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_steps_in(1.0, 0.0, &steps, &why));
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_steps_in(1e9, 1e-9, &steps, &why));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(steps_that_are_not_positive_and_finite_are_refused);
    RUN_TEST(a_step_of_decades_is_refused_with_the_longest_there_is);
    RUN_TEST(a_step_whose_parts_have_no_inverse_is_refused_with_the_shortest_there_is);
    RUN_TEST(a_null_method_is_refused);
    RUN_TEST(a_good_step_is_kept_with_its_method);
    RUN_TEST(damping_is_fast_from_its_border_on);
    RUN_TEST(at_its_limits_a_step_is_taken);
    RUN_TEST(a_yaw_of_the_limit_itself_is_not_beyond_it);
    RUN_TEST(intervals_and_steps_up_to_the_end_of_the_range_are_counted);
    RUN_TEST(the_fastest_decay_is_the_largest_of_all_axes);
    RUN_TEST(factors_are_those_of_the_damped_axis);
    RUN_TEST(levels_are_halved_steps);
    RUN_TEST(without_damping_zeta_changes_linearly_and_with_fast_damping_it_jumps);
    RUN_TEST(an_explicit_method_is_limited_by_damping);
    RUN_TEST(a_fast_yaw_limits_the_step_with_and_without_damping);
    RUN_TEST(the_implicit_methods_take_any_step);
    RUN_TEST(without_damping_and_at_rest_any_step_is_stable);
    RUN_TEST(damping_near_the_end_of_the_range_still_has_a_limit);
    RUN_TEST(whole_numbers_of_steps_are_counted);
    RUN_TEST(an_interval_of_no_whole_number_of_steps_is_refused_with_one_that_fits);
    RUN_TEST(the_tolerance_is_of_the_step_not_of_the_time);
    RUN_TEST(the_tolerance_is_a_millionth_of_the_step_to_both_sides);
    RUN_TEST(intervals_and_steps_that_are_not_positive_and_finite_are_refused);
    return UNITY_END();
}
