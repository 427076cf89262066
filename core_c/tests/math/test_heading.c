/* Tests of heading.h, and of the compensated sums of common.h. */
#include "heading.h"

#include "check.h"

#define WHOLE_TURN 6.28318530717958647693

static void the_wrapped_heading_lies_in_minus_pi_to_pi(void) {
    laconic_heading heading = {0, 0, 0};
    double angle = 0;
    for (int i = 0; i < 2000; i++) {
        const laconic_real step = REAL(i % 3 == 0 ? -0.7 : 0.9);
        heading_advance(&heading, step);
        angle += (double)step;
        const double wrapped = (double)heading_wrapped(&heading);
        TEST_ASSERT_TRUE(wrapped > -PI - 1e-6 && wrapped <= PI + 1e-6);
        ASSERT_NEAR(EITHER(1e-9, 1e-3), cos(angle), cos(wrapped));
        ASSERT_NEAR(EITHER(1e-9, 1e-3), sin(angle), sin(wrapped));
        ASSERT_NEAR(EITHER(1e-9, 1e-3), angle, heading_unwrapped(&heading));
    }
}

static void half_a_turn_is_pi_and_never_minus_pi(void) {
    laconic_heading heading = {0, (laconic_binary_angle)1 << (sizeof(laconic_binary_angle) * 8 - 1), 0};
    ASSERT_NEAR(ROUNDING, PI, heading_wrapped(&heading));
    ASSERT_NEAR(ROUNDING, PI, heading_unwrapped(&heading));
    heading.turns = -1;
    ASSERT_NEAR(ROUNDING, -PI, heading_unwrapped(&heading));
}

static void resolution_does_not_fall_with_the_number_of_turns(void) {
    laconic_heading near = {0, 0, 0}, far = {1000000000, 0, 0};
    for (int i = 0; i < 1000; i++) {
        heading_advance(&near, REAL(0.01));
        heading_advance(&far, REAL(0.01));
    }
    TEST_ASSERT_TRUE(near.fraction == far.fraction);
    TEST_ASSERT_TRUE(near.turns + 1000000000 == far.turns);
}

static void many_turns_in_one_step_are_counted(void) {
    laconic_heading heading = {0, 0, 0};
    heading_advance(&heading, REAL(1000 * WHOLE_TURN));
    heading_advance(&heading, REAL(0.25 * WHOLE_TURN));
    ASSERT_NEAR(EITHER(1e-11, 1e-3), 1000.25, (double)heading_unwrapped(&heading) / WHOLE_TURN);
    heading_advance(&heading, REAL(-2000.5 * WHOLE_TURN));
    ASSERT_NEAR(EITHER(1e-11, 2e-3), -1000.25, (double)heading_unwrapped(&heading) / WHOLE_TURN);
}

static void the_heading_half_way_is_returned(void) {
    laconic_heading heading = {0, 0, 0};
    direction d = laconic_direction_of_binary_angle(heading_advance(&heading, REAL(1.0)));
    ASSERT_NEAR(ROUNDING, cos(0.5), d.cosine);
    ASSERT_NEAR(ROUNDING, sin(0.5), d.sine);
    d = laconic_direction_of_binary_angle(heading_advance(&heading, REAL(WHOLE_TURN + 1.0)));
    ASSERT_NEAR(EITHER(1e-14, 5e-6), cos(1.5 + PI), d.cosine);
    ASSERT_NEAR(EITHER(1e-14, 5e-6), sin(1.5 + PI), d.sine);
}

static void a_compensated_sum_loses_nothing(void) {
    laconic_sum sum = sum_of(REAL(1));
    laconic_real plain = REAL(1);
    const double addend = EITHER(1e-17, 1e-9);
    for (int i = 0; i < 1000000; i++) {
        sum_add(&sum, REAL(addend));
        plain += REAL(addend);
    }
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)plain);
    ASSERT_NEAR(2 * (double)LACONIC_EPSILON, 1.0 + 1e6 * addend, (double)sum.value + (double)sum.rest);
}

/* Half of what a heading can show at a time: every second one is seen, and none is lost. */
static void angles_below_the_resolution_are_kept_until_they_count(void) {
    laconic_heading heading = {0, 0, 0};
    for (int i = 0; i < 1000; i++) {
        TEST_ASSERT_TRUE(heading.fraction <= (laconic_binary_angle)i);
        TEST_ASSERT_TRUE(heading.fraction + 3 >= (laconic_binary_angle)i);
        heading_advance(&heading, BINARY_ANGLE_UNIT_RAD);
    }
}

/* 2⁶² turns either way: as many are left for a step as it may add. */
static void a_step_begins_within_the_turns_that_leave_room_for_it(void) {
    const int64_t most = (int64_t)1 << 62;
    const laconic_heading inside[2] = {{most - 1, 0, 0}, {-most, 0, 0}}, outside[2] = {{most, 0, 0}, {-most - 1, 0, 0}};
    laconic_model m;
    laconic_integrator in;
    laconic_input input;
    memset(&m, 0, sizeof m);
    memset(&input, 0, sizeof input);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_exact_flow, &m, REAL(1), NULL));
    for (int k = 0; k < 2; k++) {
        laconic_state state;
        memset(&state, 0, sizeof state);
        state.heading = inside[k];
        TEST_ASSERT_TRUE(heading_has_room(&state.heading));
        ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
        state.heading = outside[k];
        TEST_ASSERT_FALSE(heading_has_room(&state.heading));
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &input));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_wrapped_heading_lies_in_minus_pi_to_pi);
    RUN_TEST(half_a_turn_is_pi_and_never_minus_pi);
    RUN_TEST(resolution_does_not_fall_with_the_number_of_turns);
    RUN_TEST(many_turns_in_one_step_are_counted);
    RUN_TEST(the_heading_half_way_is_returned);
    RUN_TEST(a_compensated_sum_loses_nothing);
    RUN_TEST(angles_below_the_resolution_are_kept_until_they_count);
    RUN_TEST(a_step_begins_within_the_turns_that_leave_room_for_it);
    return UNITY_END();
}
