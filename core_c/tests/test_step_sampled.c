#include "stiff.h"

static void an_input_that_does_not_vary_gives_the_motion_of_a_held_one(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    int32_t i;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.02);
        laconic_state held = moving(&m, 1, 2, 3), sampled = held;
        laconic_real a[3], b[3];
        int k;
        for (k = 0; k < 50; k++) {
            ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &held, &input));
            ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &sampled, &input, &input, &input));
        }
        laconic_nu(&m, &held, a);
        laconic_nu(&m, &sampled, b);
        ASSERT_NEAR_ALL(EITHER(1e-13, 2e-5), a, b, 3);
    }
}

static laconic_input voltage_at(double t) {
    laconic_input input = no_input();
    input.voltage_V[0] = REAL(sin(3 * t));
    input.voltage_V[1] = REAL(-sin(3 * t)); /* straight along η: ν2' = −r ν2 + 2 c1 sin(3t)/(MR² A2) */
    return input;
}

static double error_under_a_sine(const laconic_method *method, int steps) {
    const double square = SMALL_LAMBDA * SMALL_LAMBDA, a2 = 1 + 2 * square, r = 2 * DAMPING / UNIT_INERTIA / a2;
    const double drive = 2 * GAIN / UNIT_INERTIA / a2, t = 2.0, h = t / steps;
    const double exact = drive * (r * sin(3 * t) - 3 * cos(3 * t) + 3 * exp(-r * t)) / (r * r + 9);
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(method, &m, h);
    laconic_state state = moving(&m, 0, 0, 0);
    laconic_real nu[3];
    int i;
    for (i = 0; i < steps; i++) {
        const laconic_input start = voltage_at(i * h), middle = voltage_at((i + 0.5) * h),
                            end = voltage_at((i + 1) * h);
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &state, &start, &middle, &end));
    }
    laconic_nu(&m, &state, nu);
    return fabs((double)nu[1] - exact);
}

/* Up to the fourth, which is as far as three samples tell of a step. */
static void a_sampled_sine_keeps_every_methods_order(void) {
    int32_t i;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        const int steps = method->order >= 4 ? EITHER(20, 6) : EITHER(50, 20), order = method->order < 4 ? 2 : 4;
        const double coarse = error_under_a_sine(method, steps), fine = error_under_a_sine(method, 2 * steps);
        TEST_ASSERT_TRUE_MESSAGE(log2(coarse / fine) > order - 0.4, method->name);
    }
}

/* A world force that grows from nothing in the step pushes half as far as one that is there all the time. */
static void a_world_force_may_begin_or_end_within_a_step(void) {
    const laconic_model m = model_of(bare_body());
    laconic_input none = no_input(), half = no_input(), full = no_input();
    int32_t i;
    half.world_force_N[0] = REAL(1);
    full.world_force_N[0] = REAL(2);
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.5);
        laconic_state growing = moving(&m, 0, 0, 0), fading = growing;
        laconic_real nu[3];
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &growing, &none, &half, &full));
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &fading, &full, &half, &none));
        laconic_nu(&m, &growing, nu);
        ASSERT_NEAR(EITHER(1e-14, 1e-6), 1.0 * 0.5 / (MASS * RADIUS), nu[0]);
        laconic_nu(&m, &fading, nu);
        ASSERT_NEAR(EITHER(1e-14, 1e-6), 1.0 * 0.5 / (MASS * RADIUS), nu[0]);
    }
}

/* Simpson's rule over three samples: what fourth order sees of a push; second order sees the ends. */
static void a_world_force_at_one_sample_alone_counts_by_its_weight(void) {
    const laconic_model m = model_of(bare_body());
    laconic_input none = no_input(), push = no_input();
    const double whole = 0.5 * 2.0 / (MASS * RADIUS);
    int32_t i;
    push.world_force_N[0] = REAL(2);
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        const laconic_integrator in = integrator_of(method, &m, 0.5);
        laconic_state early = moving(&m, 3000, 0, 0), late = early, between = early;
        laconic_real nu[3];
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &early, &push, &none, &none));
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &late, &none, &none, &push));
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &between, &none, &push, &none));
        laconic_nu(&m, &early, nu);
        ASSERT_NEAR(EITHER(1e-10, 1e-3), 3000 + whole * (method->order >= 4 ? 1.0 / 6 : 0.5), nu[0]);
        laconic_nu(&m, &late, nu);
        ASSERT_NEAR(EITHER(1e-10, 1e-3), 3000 + whole * (method->order >= 4 ? 1.0 / 6 : 0.5), nu[0]);
        laconic_nu(&m, &between, nu);
        ASSERT_NEAR(EITHER(1e-10, 1e-3), 3000 + whole * (method->order >= 4 ? 4.0 / 6 : 0.0), nu[0]);
    }
}

static laconic_input with_number(laconic_input input, int which, laconic_real number) {
    laconic_real *const places[] = {&input.voltage_V[1],           &input.axle_torque_Nm[2],
                                    &input.body_force_N[0],        &input.body_moment_Nm,
                                    &input.world_force_N[0],       &input.world_force_N[1],
                                    &input.world_force_point_m[0], &input.world_force_point_m[1]};
    *places[which] = number;
    return input;
}

#define PLACES 8

static void refuses_at_each_sample(const laconic_method *method, const laconic_model *m, laconic_input good,
                                   laconic_input bad) {
    const laconic_integrator in = integrator_of(method, m, 0.02);
    int k;
    for (k = 0; k < 3; k++) {
        laconic_input at[3] = {good, good, good};
        laconic_state state = moving(m, 1, 2, 3), before = state;
        at[k] = bad;
        TEST_ASSERT_NOT_EQUAL(LACONIC_OK, laconic_step_sampled(m, &in, &state, &at[0], &at[1], &at[2]));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

static void a_number_that_is_none_at_any_sample_is_refused(void) {
    const laconic_model slow = model_of(with_motors(three_wheels())), fast = model_of(stiff());
    const laconic_real numbers[] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    const laconic_input rest = no_input(), all = every_input();
    int which, i;
    int32_t number;
    for (number = 0; number < LACONIC_METHOD_COUNT; number++)
        for (which = 0; which < PLACES; which++)
            for (i = 0; i < 3; i++) {
                const laconic_method *method = laconic_method_by_number(number);
                refuses_at_each_sample(method, &slow, rest, with_number(rest, which, numbers[i]));
                refuses_at_each_sample(method, &slow, all, with_number(all, which, numbers[i]));
                if (method == &laconic_auto) /* which then chooses another */
                    refuses_at_each_sample(method, &fast, all, with_number(all, which, numbers[i]));
            }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_input_that_does_not_vary_gives_the_motion_of_a_held_one);
    RUN_TEST(a_sampled_sine_keeps_every_methods_order);
    RUN_TEST(a_world_force_may_begin_or_end_within_a_step);
    RUN_TEST(a_world_force_at_one_sample_alone_counts_by_its_weight);
    RUN_TEST(a_number_that_is_none_at_any_sample_is_refused);
    return UNITY_END();
}
