#include "methods.h"

/* What each method says itself differs; laconic_step_refusal finds the number. */
static void refuses(const laconic_method *method, const laconic_input *input, laconic_field field, int item) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(method, &m, 0.1);
    laconic_state state = moving(&m, 1, 2, 3), before = state;
    laconic_refusal why;
    const laconic_status status = laconic_step(&m, &in, &state, input);
    TEST_ASSERT_NOT_EQUAL(LACONIC_OK, status);
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    laconic_step_refusal(&why, status, &m, &in, &state, input, 1);
    ASSERT_REFUSED(LACONIC_NOT_FINITE, field, item, why.status, why);
}

static void an_input_that_is_not_finite_leaves_the_state_as_it_was_whatever_the_method(void) {
    int32_t i;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++) {
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
        input.world_force_N[0] = input.world_force_N[1] = 0; /* a force of none at no point */
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE_POINT, 2);
        input = no_input();
        input.world_force_point_m[0] = NOT_A_NUMBER;
        refuses(method, &input, LACONIC_FIELD_WORLD_FORCE_POINT, 1);
    }
}

/* The voltage beyond the last wheel is nobody's. */
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
    size_t i;
    for (i = 0; i < sizeof steps / sizeof steps[0]; i++) {
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

/* Free puck: S goes straight in the world, whatever the heading does. */
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

/* Two fixed wheels with S between them: nothing turns ζ, so every method takes every step. */
static laconic_model spinning_drive(void) {
    laconic_vehicle v = differential_drive();
    v.com_y_m = 0;
    return model_of(v);
}

/* A step adds fewer than 2⁶² turns: it may begin within 2⁶² turns, and the count never overflows. */
static void a_heading_of_more_turns_than_can_be_counted_is_refused_whatever_the_method(void) {
    const laconic_model m = spinning_drive();
    const laconic_input input = no_input();
    const int64_t end = (int64_t)1 << 62, last[2] = {end - 1, 1 - end}, beyond[2] = {end + 1, -end - 1};
    int32_t i, k;
    for (i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (k = 0; k < 2; k++) {
            const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 1);
            laconic_state state = moving(&m, 0, 0, k == 0 ? 1e8 : -1e8), before;
            state.heading.turns = last[k];
            ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
            state.heading.turns = beyond[k];
            before = state;
            ASSERT_STATUS(LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &input));
            ASSERT_STATUS(LACONIC_OVERFLOW, laconic_step_sampled(&m, &in, &state, &input, &input, &input));
            TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
        }
}

static void the_fastest_turning_there_is_ends_in_a_refusal_never_in_a_jump(void) {
    const laconic_input input = no_input();
    laconic_vehicle v = bare_body();
    laconic_model m;
    laconic_integrator in;
    laconic_state state;
    int64_t turns = 0;
    laconic_status status = LACONIC_OK;
    int k;
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = REAL(1);
    m = model_of(v);
    in = integrator_of(&laconic_auto, &m, 1);
    state = moving(&m, 0, 0, EITHER(1.8e19, 5e8));
    for (k = 0; k < 10 && status == LACONIC_OK; k++) {
        status = laconic_step(&m, &in, &state, &input);
        TEST_ASSERT_TRUE(state.heading.turns >= turns);
        turns = state.heading.turns;
    }
    TEST_ASSERT_TRUE(k > 1); /* in single, the count lasts for 10¹⁰ steps */
    ASSERT_STATUS(EITHER(LACONIC_OVERFLOW, LACONIC_OK), status);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_input_that_is_not_finite_leaves_the_state_as_it_was_whatever_the_method);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_not_read);
    RUN_TEST(a_circle_is_exact_at_any_step);
    RUN_TEST(a_free_puck_goes_straight);
    RUN_TEST(a_heading_of_more_turns_than_can_be_counted_is_refused_whatever_the_method);
    RUN_TEST(the_fastest_turning_there_is_ends_in_a_refusal_never_in_a_jump);
    return UNITY_END();
}
