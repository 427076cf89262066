/* Tests of step.c: held and sampled inputs, for every method, and why a step is refused. */
#include "stiff.h"

/* -------------------------------------------------------------------------------------- held -- */

/* The methods refuse with different statuses; laconic_step_refusal finds the number. */
static void refuses(const laconic_method *method, const laconic_input *input, laconic_field field, int item) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(method, &m, 0.1);
    laconic_state state = moving(&m, 1, 2, 3), before = state;
    laconic_refusal why;
    const laconic_status status = laconic_step(&m, &in, &state, input);
    TEST_ASSERT_NOT_EQUAL(LACONIC_OK, status);
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    ASSERT_REFUSED(LACONIC_NOT_FINITE, field, item,
                   (laconic_step_refusal(&why, status, &m, &in, &state, input, 1), why.status), why);
}

static void an_input_that_is_not_finite_leaves_the_state_as_it_was_whatever_the_method(void) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        laconic_input input = every_input();
        input.voltage_V[2] = NOT_A_NUMBER;
        refuses(method, &input, LACONIC_FIELD_VOLTAGE, 3);
        input = every_input();
        input.axle_torque_Nm[0] = INFINITE;
        refuses(method, &input, LACONIC_FIELD_AXLE_TORQUE, 1);
        input = every_input();
        input.body_force_N[1] = -INFINITE;
        refuses(method, &input, LACONIC_FIELD_BODY_FORCE, 2);
        input = every_input();
        input.body_moment_Nm = NOT_A_NUMBER;
        refuses(method, &input, LACONIC_FIELD_BODY_MOMENT, 0);
        input = every_input();
        input.world_force_N[0] = NOT_A_NUMBER;
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE, 1);
        input = every_input();
        input.world_force_point_m[1] = INFINITE;
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE_POINT, 2);
        input.world_force_N[0] = input.world_force_N[1] = 0; /* a force of 0 at a point that is not finite */
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE_POINT, 2);
        input = no_input();
        input.world_force_point_m[0] = NOT_A_NUMBER;
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE_POINT, 1);
    }
}

/* Also in the middle of a sampled step, which methods of second order do not use: numbers that are finite, their sum is
 * not. */
static void a_world_force_beyond_the_range_is_refused_at_every_sample(void) {
    const laconic_model m = model_of(three_wheels());
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (int sample = 0; sample < 3; sample++)
            for (int sign = -1; sign <= 1; sign += 2) {
                const laconic_integrator integrator = integrator_of(laconic_method_by_number(i), &m, 0.01);
                laconic_input input[3] = {no_input(), no_input(), no_input()};
                laconic_state state = moving(&m, 1, 2, 3);
                const laconic_state before = state;
                input[sample].world_force_N[0] = input[sample].world_force_N[1] = REAL(sign) * LACONIC_REAL_MAX;
                TEST_ASSERT_NOT_EQUAL(LACONIC_OK,
                                      laconic_step_sampled(&m, &integrator, &state, &input[0], &input[1], &input[2]));
                TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
            }
}

/* The voltage beyond the last wheel belongs to no wheel. */
static void what_lies_beyond_the_last_wheel_is_not_read(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_state state = moving(&m, 1, 2, 3);
    laconic_input input = every_input();
    input.voltage_V[3] = NOT_A_NUMBER;
    take_steps(&laconic_rk4, &m, &state, &input, 0.1, 3);
}

/* With constant ν1, ν3 a caster's path is a circle of radius R Λ ν1/ν3: exact at any step, few or many turns. */
static void a_circle_is_exact_at_any_step(void) {
    const laconic_model m = model_of(caster());
    const laconic_input input = no_input();
    const double radius = RADIUS * BIG_LAMBDA * 2.0 / 6.0;
    const double steps[] = {0.01, 0.3, 0.9, 1.7, 3.3};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        const double angle = 6.0 / BIG_LAMBDA * steps[i] * 25;
        laconic_state state = moving(&m, 2, 0, 6);
        laconic_pose pose;
        take_steps(&laconic_exact_flow, &m, &state, &input, steps[i], 25);
        laconic_pose_of(&pose, &m, &state);
        ASSERT_NEAR(EITHER(1e-13, 2e-5), radius * sin(angle), pose.x_m);
        ASSERT_NEAR(EITHER(1e-13, 2e-5), radius * (1 - cos(angle)), pose.y_m);
        ASSERT_NEAR(EITHER(1e-12, 4e-5), angle, pose.heading_rad);
    }
}

/* Free puck: S moves straight in the world at any yaw rate. */
static void a_free_puck_goes_straight(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_input input = no_input();
    laconic_start start = start_with(2, -1, 5);
    laconic_state state;
    laconic_pose pose;
    start.heading_rad = REAL(0.4);
    state = state_of(&m, start);
    take_steps(&laconic_exact_flow_4, &m, &state, &input, 0.01, 1000);
    laconic_pose_of(&pose, &m, &state);
    ASSERT_NEAR(EITHER(1e-9, 1e-4), 10 * RADIUS * (2 * cos(0.4) + sin(0.4)), pose.x_m);
    ASSERT_NEAR(EITHER(1e-9, 1e-4), 10 * RADIUS * (2 * sin(0.4) - cos(0.4)), pose.y_m);
}

/* ----------------------------------------------------------------------------------- sampled -- */

static void an_input_that_does_not_vary_gives_the_motion_of_a_held_one(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.02);
        laconic_state held = moving(&m, 1, 2, 3), sampled = held;
        laconic_real a[3], b[3];
        for (int k = 0; k < 50; k++) {
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
    for (int i = 0; i < steps; i++) {
        const laconic_input start = voltage_at(i * h), middle = voltage_at((i + 0.5) * h),
                            end = voltage_at((i + 1) * h);
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &state, &start, &middle, &end));
    }
    laconic_nu(&m, &state, nu);
    return fabs((double)nu[1] - exact);
}

/* Up to the fourth order, as far as three samples determine the input over a step. */
static void a_sampled_sine_keeps_every_methods_order(void) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        const int steps = method->order >= 4 ? EITHER(20, 6) : EITHER(50, 20), order = method->order < 4 ? 2 : 4;
        const double coarse = error_under_a_sine(method, steps), fine = error_under_a_sine(method, 2 * steps);
        TEST_ASSERT_TRUE_MESSAGE(log2(coarse / fine) > order - 0.4, method->name);
    }
}

/* A world force that grows linearly from 0 over the step adds half the velocity that the constant force adds. */
static void a_world_force_may_begin_or_end_within_a_step(void) {
    const laconic_model m = model_of(bare_body());
    laconic_input none = no_input(), half = no_input(), full = no_input();
    half.world_force_N[0] = REAL(1);
    full.world_force_N[0] = REAL(2);
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
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

/* The weights of the samples are Simpson's in methods of fourth order; those of second order use the ends only. */
static void a_world_force_at_one_sample_alone_counts_by_its_weight(void) {
    const laconic_model m = model_of(bare_body());
    laconic_input none = no_input(), push = no_input();
    const double whole = 0.5 * 2.0 / (MASS * RADIUS);
    push.world_force_N[0] = REAL(2);
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
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
    for (int k = 0; k < 3; k++) {
        laconic_input at[3] = {good, good, good};
        laconic_state state = moving(m, 1, 2, 3), before = state;
        at[k] = bad;
        TEST_ASSERT_NOT_EQUAL(LACONIC_OK, laconic_step_sampled(m, &in, &state, &at[0], &at[1], &at[2]));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

static void a_number_that_is_not_finite_at_any_sample_is_refused(void) {
    const laconic_model slow = model_of(with_motors(three_wheels())), fast = model_of(stiff());
    const laconic_real numbers[] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    const laconic_input rest = no_input(), all = every_input();
    for (int32_t number = 0; number < LACONIC_METHOD_COUNT; number++)
        for (int which = 0; which < PLACES; which++)
            for (int i = 0; i < 3; i++) {
                const laconic_method *method = laconic_method_by_number(number);
                refuses_at_each_sample(method, &slow, rest, with_number(rest, which, numbers[i]));
                refuses_at_each_sample(method, &slow, all, with_number(all, which, numbers[i]));
                if (method == &laconic_auto) /* auto then takes the step by another method */
                    refuses_at_each_sample(method, &fast, all, with_number(all, which, numbers[i]));
            }
}

/* ------------------------------------------------------------------------------------ inputs -- */

static laconic_model model;
static laconic_refusal why;

static void a_finite_input_is_accepted(void) {
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_input_check(&model, &input, &why));
}

static void what_lies_beyond_the_last_wheel_is_not_read_input(void) {
    laconic_input input = every_input();
    input.voltage_V[3] = input.axle_torque_Nm[3] = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_input_check(&model, &input, &why));
}

static void every_number_that_is_not_finite_is_named(void) {
    laconic_input good = every_input(), in;
#define REFUSES(member, bad, field, item) \
    in = good; \
    in.member = bad; \
    ASSERT_REFUSED(LACONIC_NOT_FINITE, field, item, laconic_input_check(&model, &in, &why), why)
    REFUSES(voltage_V[2], NOT_A_NUMBER, LACONIC_FIELD_VOLTAGE, 3);
    REFUSES(axle_torque_Nm[0], INFINITE, LACONIC_FIELD_AXLE_TORQUE, 1);
    REFUSES(body_force_N[1], -INFINITE, LACONIC_FIELD_BODY_FORCE, 2);
    REFUSES(body_moment_Nm, NOT_A_NUMBER, LACONIC_FIELD_BODY_MOMENT, 0);
    REFUSES(world_force_N[0], INFINITE, LACONIC_FIELD_WORLD_FORCE, 1);
    REFUSES(world_force_point_m[1], NOT_A_NUMBER, LACONIC_FIELD_WORLD_FORCE_POINT, 2);
#undef REFUSES
}

/* ---------------------------------------------------------------------------------- refusals -- */

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

static void every_sample_of_a_step_is_checked(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (int32_t k = 0; k < 3; k++) {
            const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.1);
            laconic_input at[3] = {every_input(), every_input(), every_input()};
            laconic_state state = moving(&m, 1, 2, 3), before = state;
            at[k].voltage_V[2 - k] = NOT_A_NUMBER;
            const laconic_status status = laconic_step_sampled(&m, &in, &state, &at[0], &at[1], &at[2]);
            TEST_ASSERT_NOT_EQUAL(LACONIC_OK, status);
            TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
            ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 3 - k,
                           (laconic_step_refusal(&why, status, &m, &in, &state, at, 3), why.status), why);
        }
}

static void a_refusal_at_the_gyroscopic_limit_gives_the_largest_step(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 1, 1, 500);
    const laconic_input input = no_input();
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   explain(&laconic_rk4, LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, &input), why);
    TEST_ASSERT_EQUAL_DOUBLE((double)laconic_largest_stable_step_s(&laconic_rk4, &m, &state), (double)why.limit);
    ASSERT_NEAR(ROUNDING, 0.1, why.value);
}

static void other_refusals_give_half_the_step(void) {
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

static void an_input_behind_the_last_is_not_read(void) {
    laconic_input inputs[2] = {no_input(), no_input()};
    inputs[1].body_moment_Nm = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, explain(&laconic_exact_flow, LACONIC_OVERFLOW, inputs),
                   why);
}

static void the_refusal_may_be_null(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.1);
    const laconic_state state = moving(&m, 1, 1, 500);
    const laconic_input input = no_input();
    laconic_step_refusal(NULL, LACONIC_OVERFLOW, &m, &in, &state, &input, 1);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_input_that_is_not_finite_leaves_the_state_as_it_was_whatever_the_method);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_not_read);
    RUN_TEST(a_circle_is_exact_at_any_step);
    RUN_TEST(a_free_puck_goes_straight);
    RUN_TEST(an_input_that_does_not_vary_gives_the_motion_of_a_held_one);
    RUN_TEST(a_sampled_sine_keeps_every_methods_order);
    RUN_TEST(a_world_force_beyond_the_range_is_refused_at_every_sample);
    RUN_TEST(a_world_force_may_begin_or_end_within_a_step);
    RUN_TEST(a_world_force_at_one_sample_alone_counts_by_its_weight);
    RUN_TEST(a_number_that_is_not_finite_at_any_sample_is_refused);
    model = model_of(three_wheels());
    RUN_TEST(a_finite_input_is_accepted);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_not_read_input);
    RUN_TEST(every_number_that_is_not_finite_is_named);
    RUN_TEST(an_input_that_is_not_finite_is_found);
    RUN_TEST(every_sample_of_a_step_is_checked);
    RUN_TEST(a_refusal_at_the_gyroscopic_limit_gives_the_largest_step);
    RUN_TEST(other_refusals_give_half_the_step);
    RUN_TEST(an_input_behind_the_last_is_not_read);
    RUN_TEST(the_refusal_may_be_null);
    return UNITY_END();
}
