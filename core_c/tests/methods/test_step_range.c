/* Tests of step.c at the end of the range: turns, speeds, points and forces, for every method. */
#include "stiff.h"

/* Two fixed wheels with S between them: there is no gyroscopic term, so every method takes every step. */
static laconic_model spinning_drive(void) {
    laconic_vehicle v = differential_drive();
    v.com_y_m = 0;
    return model_of(v);
}

/* A step begins only within 2⁶² turns and adds less than 2⁶², so the count never overflows. */
static void a_heading_of_more_turns_than_can_be_counted_is_refused_whatever_the_method(void) {
    const laconic_model m = spinning_drive();
    const laconic_input input = no_input();
    const int64_t end = (int64_t)1 << 62, last[2] = {end - 1, 1 - end}, beyond[2] = {end + 1, -end - 1};
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (int32_t k = 0; k < 2; k++) {
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

static void the_fastest_yaw_ends_in_a_refusal_never_in_a_jump(void) {
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

static void ask_sampled(laconic_status wanted, const laconic_input samples[3]) {
    const laconic_model m = model_of(bare_body());
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 0.01);
        laconic_state state = moving(&m, 0.1, 0.2, 0.3);
        const laconic_state before = state;
        const laconic_status status = laconic_step_sampled(&m, &in, &state, &samples[0], &samples[1], &samples[2]);
        ASSERT_STATUS(wanted, status);
        if (wanted != LACONIC_OK) TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

/* The points of a world force that is 0 move nothing, whatever they are, as long as they are numbers. */
static void points_and_forces_that_leave_the_range_together_are_refused_whatever_the_method(void) {
    const laconic_real far_m = REAL(0.75) * LACONIC_REAL_MAX;
    const laconic_model m = model_of(bare_body());
    const laconic_integrator in = integrator_of(&laconic_auto, &m, 0.01);
    laconic_state state = moving(&m, 0.1, 0.2, 0.3);
    laconic_input held = no_input();
    held.world_force_point_m[0] = held.world_force_point_m[1] = far_m;
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &held));
    for (int k = 0; k < 3; k++) {
        laconic_input samples[3] = {no_input(), no_input(), no_input()};
        samples[k].world_force_point_m[0] = far_m;
        ask_sampled(LACONIC_OK, samples);
        samples[(k + 1) % 3].world_force_point_m[1] = far_m;
        ask_sampled(LACONIC_OVERFLOW, samples);
        samples[(k + 1) % 3] = no_input();
        samples[1].world_force_N[0] = far_m;
        ask_sampled(LACONIC_OVERFLOW, samples);
    }
}

/* A step so short that its path is small, by so large a force that the speed leaves the range. */
static void a_speed_beyond_the_range_is_refused_whatever_the_method(void) {
    const double fastest = EITHER(1e77, 1e9), step_s = EITHER(1e-66, 1e-5);
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_model m = model_of(bare_body());
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, step_s);
        laconic_input input = no_input();
        laconic_state state = moving(&m, 0.4 * fastest, 0, 0);
        input.body_force_N[0] = REAL(0.1 * fastest * MASS * RADIUS / step_s);
        ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
        const laconic_state before = state;
        input.body_force_N[0] *= 9;
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &input));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

/* The squares of the speeds before and after a step are summed: without any force a speed of three quarters is one. */
static void a_step_that_begins_near_the_end_of_the_range_is_refused_whatever_the_method(void) {
    const double fastest = EITHER(1e77, 1e9), step_s = EITHER(1e-66, 1e-5), share[2] = {0.7, 0.75};
    const laconic_input input = no_input();
    const laconic_model m = model_of(bare_body());
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++)
        for (int k = 0; k < 2; k++) {
            const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, step_s);
            laconic_state state = moving(&m, share[k] * fastest, 0, 0);
            ASSERT_STATUS(k == 0 ? LACONIC_OK : LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &input));
        }
}

/* Where no force acts a point may be as far as it likes, beside a strong force at another moment of the step. */
static void a_far_point_without_a_force_is_no_moment_of_another_sample(void) {
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_model m = model_of(bare_body());
        const laconic_integrator in = integrator_of(laconic_method_by_number(i), &m, 1e-5);
        laconic_state state = moving(&m, 0, 0, 0);
        laconic_input samples[3] = {no_input(), no_input(), no_input()};
        for (int k = 0; k < 3; k++) samples[k].world_force_N[0] = REAL(k == 2 ? 0 : 1e10);
        samples[2].world_force_point_m[0] = REAL(EITHER(1e300, 1e30));
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &state, &samples[0], &samples[1], &samples[2]));
        TEST_ASSERT_TRUE(state.zeta[0].value > 0 && state.zeta[2].value == 0);
    }
}

/* ---------------------------------------------------------------------------------- refusals -- */

/* Another step is told where a smaller one may do, and nowhere else. */
static void only_of_some_refusals_a_smaller_step_is_told(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.1);
    const laconic_state state = moving(&m, 1, 1, 500);
    const laconic_input input = no_input();
    laconic_refusal why;
    for (int status = 1; status < LACONIC_STATUS_COUNT; status++) {
        laconic_step_refusal(&why, (laconic_status)status, &m, &in, &state, &input, 1);
        const bool smaller = status == LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT || status == LACONIC_STEP_GAINS_ENERGY ||
                             status == LACONIC_STEP_SINGULAR || status == LACONIC_STEP_UNSOLVED;
        TEST_ASSERT_TRUE((int)why.status == status && (why.limit > 0) == smaller && (double)why.limit < 0.1);
    }
}

/* In the order of the fields. */
static void of_several_numbers_that_are_not_finite_the_first_is_named(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_input input = no_input();
    laconic_refusal why;
    input.world_force_point_m[0] = input.world_force_N[0] = input.body_moment_Nm = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0, laconic_input_check(&m, &input, &why), why);
    input.body_force_N[1] = input.axle_torque_Nm[2] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_AXLE_TORQUE, 3, laconic_input_check(&m, &input, &why), why);
    input.voltage_V[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 2, laconic_input_check(&m, &input, &why), why);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_heading_of_more_turns_than_can_be_counted_is_refused_whatever_the_method);
    RUN_TEST(the_fastest_yaw_ends_in_a_refusal_never_in_a_jump);
    RUN_TEST(a_speed_beyond_the_range_is_refused_whatever_the_method);
    RUN_TEST(a_step_that_begins_near_the_end_of_the_range_is_refused_whatever_the_method);
    RUN_TEST(points_and_forces_that_leave_the_range_together_are_refused_whatever_the_method);
    RUN_TEST(a_far_point_without_a_force_is_no_moment_of_another_sample);
    RUN_TEST(only_of_some_refusals_a_smaller_step_is_told);
    RUN_TEST(of_several_numbers_that_are_not_finite_the_first_is_named);
    return UNITY_END();
}
