/* Tests of articulated_step.c, _state.c, _drive.c, _twist.c and _solve.c: inputs, starts, refusals of steps. */
#include "hinged_vehicles.h"

#define OF(IDENTIFIER) ((laconic_field)LACONIC_FIELD_OF_##IDENTIFIER)

static laconic_refusal why;

static void a_start_is_projected_and_says_by_how_much(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.5, 0.3, 0);
    laconic_articulated_state s;
    laconic_real change = -1;
    memset(&s, 0, sizeof s);
    ASSERT_TAKEN(laconic_articulated_state_set(&s, &change, &m, &start, &in, &refusal));
    TEST_ASSERT_TRUE((double)change > 0.1 && (double)change < 0.4);
    const laconic_articulated_motion now = motion_of(&m, &s);
    ASSERT_NEAR(ROUNDING * 4, 0, now.yaw_rate_rad_per_s); /* straight wheels */
    start.velocity_m_per_s[1] = 0;
    ASSERT_TAKEN(laconic_articulated_state_set(&s, &change, &m, &start, &in, &refusal));
    ASSERT_NEAR(ROUNDING * 10, 0, change);
}

static void starts_are_checked(void) {
    const laconic_articulated_model m = hinged_model(with_two_casters());
    const laconic_articulated_input in = nothing();
    laconic_articulated_state s, before;
    memset(&s, 0, sizeof s);
    before = s;
    laconic_articulated_start start = start_at(0, 0, 0);
    start.hinge_angle_rad[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, OF(START_HINGE_ANGLE), 2,
                   laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why), why);
    start = start_at(0, (double)INFINITE, 0);
    ASSERT_REFUSED(LACONIC_NOT_FINITE, OF(START_VELOCITY), 2,
                   laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why), why);
    start = start_at(EITHER(1e100, 1e30), 0, 0);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    start = start_at(EITHER(1e18, 3e9), 0, 0); /* an angle could count it, and in single precision η could not */
    TEST_ASSERT_EQUAL(IN_DOUBLE, laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why) == LACONIC_OK);
}

/* A jump to such a rate would throw the carriage out of every range. */
static void a_rate_that_jumps_beyond_the_range_is_refused(void) {
    laconic_articulated_vehicle v = free_carriage();
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, -0.25, 0.03, 10, 0.4, -0.3, 0.02);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    laconic_articulated_input in = nothing();
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const laconic_articulated_state before = s;
    in.hinge_rate_rad_per_s[0] = REAL(EITHER(1e90, 1e15));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_jump(&m, &s, &in, &why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

/* As after more turns than a heading counts. */
static void a_hinge_that_has_turned_too_often_is_refused(void) {
    const laconic_articulated_model m = hinged_model(with_two_casters());
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    const laconic_articulated_input in = nothing();
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    s.hinge[1].turns = INT64_MAX;
    const laconic_articulated_state before = s;
    for (int method = 0; method < LACONIC_ARTICULATED_METHOD_COUNT; method++) {
        const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.01);
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_step(&m, &i, &s, &in, &in, &why));
        TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    }
    s.hinge[1].turns = 0;
    s.heading.turns = INT64_MAX;
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.01);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_step(&m, &i, &s, &in, &in, &why));
}

static void every_number_of_an_input_is_named_where_it_is_not_finite(void) {
    laconic_articulated_vehicle v = with_two_casters();
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 0, 0, 1, 0.1, 0, 0);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    laconic_articulated_input good = nothing(), bad;
    laconic_articulated_state s = hinged_state(&m, &start, &good);
    const laconic_articulated_state before = s;
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_AUTO, 0.01);
    static const laconic_real values[] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    for (int k = 0; k < 3; k++) {
        bad = good;
        bad.base.voltage_V[1] = values[k];
        ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 2,
                       laconic_articulated_step(&m, &i, &s, &bad, &bad, &why), why);
        bad = good;
        bad.hinge_torque_Nm[0] = values[k];
        ASSERT_REFUSED(LACONIC_NOT_FINITE, OF(HINGE_TORQUE), 1, laconic_articulated_step(&m, &i, &s, &good, &bad, &why),
                       why);
        bad = good;
        bad.hinge_rate_rad_per_s[2] = values[k];
        ASSERT_REFUSED(LACONIC_NOT_FINITE, OF(HINGE_RATE), 3, laconic_articulated_step(&m, &i, &s, &good, &bad, &why),
                       why);
        bad = good;
        bad.hinge_acceleration_rad_per_s2[2] = values[k];
        ASSERT_REFUSED(LACONIC_NOT_FINITE, OF(HINGE_ACCELERATION), 3,
                       laconic_articulated_step(&m, &i, &s, &bad, &bad, &why), why);
        bad = good;
        bad.base.world_force_point_m[0] = values[k];
        ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_WORLD_FORCE_POINT, 1,
                       laconic_articulated_step(&m, &i, &s, &bad, &bad, &why), why);
        ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_WORLD_FORCE_POINT, 1,
                       laconic_articulated_jump(&m, &s, &bad, &why), why);
        TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    }
}

static void huge_inputs_are_refused_and_leave_the_state(void) {
    const laconic_articulated_model m = hinged_model(with_two_casters());
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    laconic_articulated_input in = nothing();
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const laconic_articulated_state before = s;
    in.base.voltage_V[0] = REAL(EITHER(1e150, 1e30));
    for (int method = 0; method < LACONIC_ARTICULATED_METHOD_COUNT; method++) {
        const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.01);
        laconic_status status = LACONIC_OK;
        for (int k = 0; k < 3 && status == LACONIC_OK; k++) {
            status = laconic_articulated_step(&m, &i, &s, &in, &in, &why);
        }
        TEST_ASSERT_TRUE(status != LACONIC_OK);
        s = before;
    }
}

/* --------------------------------------------------------------------- wheels that disagree -- */

static void a_swerve_that_nobody_coordinates_names_two_wheels(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_PRESCRIBED, 4));
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.3, 0, 0);
    laconic_articulated_state s;
    char text[400];
    memset(&s, 0, sizeof s);
    ASSERT_TAKEN(laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why)); /* all straight: it drives */
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.01, 10, &in);
    start.hinge_angle_rad[2] = REAL(EITHER(1e-6, 1e-2)); /* one module off leaves no motion */
    ASSERT_STATUS(LACONIC_WHEELS_DISAGREE, laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why));
    TEST_ASSERT_TRUE(why.item >= 1 && why.item <= 4 && (int)why.value >= 1 && (int)why.value <= 4);
    TEST_ASSERT_TRUE((int)why.value != why.item);
    laconic_message(&why, text, sizeof text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "coordinated"), text);
}

static void parallel_ackermann_wheels_disagree(void) {
    laconic_articulated_vehicle v = carriage(900, 1100, 1.2, 0);
    hang_wheel(&v, 0, 0, 0.7, 0.8);
    hang_wheel(&v, 0, 0, -0.7, 0.8);
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 2.5, 0.7, 8, 0.3, 0, 0);
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 2.5, -0.7, 8, 0.3, 0, 0);
    hang_wheel(&v, 1, 0, 0, 0.8);
    hang_wheel(&v, 2, 0, 0, 0.8);
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(3, 0, 0);
    laconic_articulated_state s;
    memset(&s, 0, sizeof s);
    start.hinge_angle_rad[0] = start.hinge_angle_rad[1] = REAL(0.2);
    ASSERT_REFUSED(LACONIC_WHEELS_DISAGREE, LACONIC_FIELD_AXLE, 4,
                   laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why), why);
    ASSERT_NEAR(0, 3, why.value);
    start.hinge_angle_rad[0] = start.hinge_angle_rad[1] = 0;
    ASSERT_TAKEN(laconic_articulated_state_set(&s, NULL, &m, &start, &in, &refusal));
    in.hinge_rate_rad_per_s[0] = in.hinge_rate_rad_per_s[1] = REAL(0.5); /* straight now, parallel in a moment */
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_AUTO, 0.01);
    const laconic_articulated_state before = s;
    ASSERT_STATUS(LACONIC_WHEELS_DISAGREE, laconic_articulated_step(&m, &i, &s, &in, &in, &why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

/* ------------------------------------------------------------------------------------ twists -- */

static laconic_articulated_input twist_of(double x, double y, double turn) {
    laconic_articulated_input in = nothing();
    in.twist[0] = REAL(x);
    in.twist[1] = REAL(y);
    in.twist[2] = REAL(turn);
    return in;
}

static void a_twist_without_direction_is_refused(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_COORDINATED, 4));
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    laconic_articulated_state s;
    laconic_articulated_input in = twist_of(0, 0, 0);
    memset(&s, 0, sizeof s);
    ASSERT_STATUS(LACONIC_TWIST_ZERO, laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why));
    in = twist_of(0.25, -0.3, 1); /* turns about the first module's hinge (0.3, 0.25) */
    ASSERT_REFUSED(LACONIC_TWIST_ZERO, OF(BODY_HINGE), 1,
                   laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why), why);
    in = twist_of(1e-3, 2e-3, 5);
    ASSERT_TAKEN(laconic_articulated_state_set(&s, NULL, &m, &start, &in, &refusal));
}

/* From 1.25 down to 0.25 in the middle of the step and up again: there the first module's hinge would stand still. */
static void a_twist_that_vanishes_within_a_step_is_refused_by_every_method(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_COORDINATED, 4));
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    for (int of_hinge = 0; of_hinge < 2; of_hinge++) {
        laconic_articulated_input a = of_hinge ? twist_of(1.25, -0.3, 1) : twist_of(1, 0, 0), b;
        a.twist_rate[0] = -8;
        b = a;
        b.twist_rate[0] = 8;
        laconic_articulated_state s = hinged_state(&m, &start, &a);
        const laconic_articulated_state before = s;
        for (int method = 0; method < LACONIC_ARTICULATED_METHOD_COUNT; method++) {
            const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.5);
            ASSERT_STATUS(LACONIC_TWIST_ZERO, laconic_articulated_step(&m, &i, &s, &a, &b, &why));
            TEST_ASSERT_EQUAL(of_hinge ? OF(BODY_HINGE) : OF(TWIST), why.field);
            TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
        }
    }
}

static void a_twist_that_jumps_is_refused(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_COORDINATED, 4));
    const laconic_articulated_start start = start_at(0.3, 0, 0);
    const laconic_articulated_input ahead = twist_of(1, 0, 0);
    laconic_articulated_input back = twist_of(-1, 0, 0), aside = twist_of(1, 0.01, 0), longer = twist_of(5, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &ahead);
    const laconic_articulated_state before = s;
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.01);
    ASSERT_STATUS(LACONIC_TWIST_JUMPS, laconic_articulated_step(&m, &i, &s, &back, &back, &why));
    ASSERT_STATUS(LACONIC_TWIST_JUMPS, laconic_articulated_step(&m, &i, &s, &ahead, &back, &why));
    ASSERT_STATUS(LACONIC_TWIST_JUMPS, laconic_articulated_jump(&m, &s, &aside, &why));
    ASSERT_NEAR(EITHER(1e-3, 1e-2), 0.01, fabs((double)why.value));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    ASSERT_TAKEN(laconic_articulated_jump(&m, &s, &longer, &refusal)); /* the same directions */
    ASSERT_NEAR(ROUNDING * 10, motion_of(&m, &before).velocity_m_per_s[0], motion_of(&m, &s).velocity_m_per_s[0]);
}

static void a_twist_that_makes_the_rear_axle_slide_is_refused(void) {
    const laconic_articulated_model m = hinged_model(car_with_trailer());
    const laconic_articulated_start start = start_at(3, 0, 0);
    laconic_articulated_input in = twist_of(1, 0.1, 0.2);
    laconic_articulated_state s;
    memset(&s, 0, sizeof s);
    ASSERT_STATUS(LACONIC_TWIST_AGAINST_WHEELS, laconic_articulated_state_set(&s, NULL, &m, &start, &in, &why));
    in = twist_of(1, 0, 0.2);
    s = hinged_state(&m, &start, &in);
    laconic_articulated_input end = in;
    end.twist_rate[1] = REAL(0.3);
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.01);
    ASSERT_STATUS(LACONIC_TWIST_AGAINST_WHEELS, laconic_articulated_step(&m, &i, &s, &in, &end, &why));
}

/* The centre of mass is on the axle line, so that its velocity and the axle's lever are 0 but for rounding. */
static void coordinated_wheels_turn_a_car_on_the_middle_of_its_axle(void) {
    laconic_articulated_vehicle car = car_with_trailer();
    car.base.com_x_m = car.base.com_y_m = 0;
    const laconic_articulated_model m = hinged_model(car);
    laconic_articulated_start start = start_at(0, 0, 0);
    start.yaw_rate_rad_per_s = REAL(0.5);
    for (int side = -1; side <= 1; side += 2) {
        const laconic_articulated_input in = twist_of(1e-14, 0, side);
        laconic_articulated_state s = hinged_state(&m, &start, &in);
        const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.01);
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
        const laconic_articulated_motion now = motion_of(&m, &s);
        TEST_ASSERT_TRUE(now.yaw_rate_rad_per_s > REAL(0.1));
        ASSERT_NEAR(EITHER(1e-12, 1e-6), 0, fabs((double)now.x_m) + fabs((double)now.y_m));
    }
}

/* A ramp of values alone: each step jumps to its own T' and goes on. */
static void ramps_need_values_alone(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_COORDINATED, 4));
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    const laconic_articulated_input first = twist_of(1, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &first);
    const double h = 0.01;
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_AUTO, h);
    for (int k = 0; k < 100; k++) {
        laconic_articulated_input a = twist_of(1, sin(k * h), 0.5 * k * h),
                                  b = twist_of(1, sin((k + 1) * h), 0.5 * (k + 1) * h);
        laconic_articulated_ramp(&a, &b, REAL(h));
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &a, &b, &refusal));
    }
    const laconic_articulated_motion now = motion_of(&m, &s);
    /* module 1 at (0.3, 0.25): w = (1 − 0.25·0.5, sin 1 + 0.3·0.5) */
    ASSERT_NEAR(EITHER(1e-12, 1e-5), atan2(sin(1) + 0.15, 1 - 0.125), now.hinge_angle_rad[0]);
}

static void coordinated_angles_count_turns(void) {
    const laconic_articulated_model m = hinged_model(swerve(LACONIC_HINGE_COORDINATED, 4));
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    laconic_articulated_input a = twist_of(1, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &a);
    const double h = 0.05;
    const laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_AUTO, h);
    for (int k = 1; k <= 400; k++) {
        laconic_articulated_input b = twist_of(cos(k * h), sin(k * h), 0);
        b.twist_rate[0] = REAL(-sin(k * h));
        b.twist_rate[1] = REAL(cos(k * h));
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &a, &b, &refusal));
        a = b;
    }
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 20, motion_of(&m, &s).hinge_angle_rad[2]);
}

/* ------------------------------------------------------------------------------------- state -- */

static void a_copied_state_repeats_the_motion(void) {
    const laconic_articulated_model m = hinged_model(with_two_casters());
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.3, 0, 0.1);
    laconic_articulated_state s = hinged_state(&m, &start, &in), copy;
    in.base.voltage_V[0] = 4;
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.01, 20, &in);
    copy = s;
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.01, 20, &in);
    run_held(&m, &copy, LACONIC_ARTICULATED_AUTO, 0.01, 20, &in);
    TEST_ASSERT_EQUAL_MEMORY(&s, &copy, sizeof s);
}

/* The same input twice and a held one are the same forces, whatever way they come. */
static void an_input_that_does_not_vary_may_be_given_twice(void) {
    for (int method = 0; method < LACONIC_ARTICULATED_METHOD_COUNT; method++) {
        const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_MOTOR));
        laconic_articulated_input in = nothing();
        in.base.voltage_V[2] = 6;
        in.hinge_voltage_V[0] = 1;
        const laconic_articulated_input same = in;
        const laconic_articulated_start start = start_at(0.3, 0, 0);
        laconic_articulated_state s = hinged_state(&m, &start, &in), t = s;
        const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.01);
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &t, &in, &same, &refusal));
        TEST_ASSERT_EQUAL_MEMORY(&s, &t, sizeof s);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_start_is_projected_and_says_by_how_much);
    RUN_TEST(starts_are_checked);
    RUN_TEST(a_rate_that_jumps_beyond_the_range_is_refused);
    RUN_TEST(a_hinge_that_has_turned_too_often_is_refused);
    RUN_TEST(every_number_of_an_input_is_named_where_it_is_not_finite);
    RUN_TEST(huge_inputs_are_refused_and_leave_the_state);
    RUN_TEST(a_swerve_that_nobody_coordinates_names_two_wheels);
    RUN_TEST(parallel_ackermann_wheels_disagree);
    RUN_TEST(a_twist_without_direction_is_refused);
    RUN_TEST(a_twist_that_vanishes_within_a_step_is_refused_by_every_method);
    RUN_TEST(a_twist_that_jumps_is_refused);
    RUN_TEST(a_twist_that_makes_the_rear_axle_slide_is_refused);
    RUN_TEST(coordinated_wheels_turn_a_car_on_the_middle_of_its_axle);
    RUN_TEST(ramps_need_values_alone);
    RUN_TEST(coordinated_angles_count_turns);
    RUN_TEST(a_copied_state_repeats_the_motion);
    RUN_TEST(an_input_that_does_not_vary_may_be_given_twice);
    return UNITY_END();
}
