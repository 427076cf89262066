/* Tests of taylor_8.c: order, drift, stability limit, refusals. */
#include "stiff.h"

static laconic_refusal why;

static void is_of_eighth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_taylor_8, &v, start_with(2, 1, 4), &input, 2.0, EITHER(32, 5), 8);
}

static void large_steps_meet_the_reference(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    const errors e = errors_of(&laconic_taylor_8, &v, start_with(2, 1, 4), &input, 1.0, EITHER(40, 20));
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-10, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-10, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-10, 1e-5));
}

static void energy_and_k_drift_only_by_the_truncation_error(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_taylor_8, &v, 0.05, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-11, 1e-5));
}

static void a_steady_motion_stays(void) { assert_steady_motion_stays(&laconic_taylor_8, 0.1); }

/* A spinning puck moves straight on, though its axes rotate by 2 rad in each step; the error is of the order of
 * 2⁸/8!. */
static void a_spinning_puck_flies_straight(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_input input = no_input();
    const double spin = 2.0 / 0.1 * (double)m.yaw_scale, speed = RADIUS * 1.0;
    laconic_state state = moving(&m, 1, 0, spin);
    laconic_pose pose;
    take_steps(&laconic_taylor_8, &m, &state, &input, 0.1, 20);
    laconic_pose_of(&pose, &m, &state);
    ASSERT_NEAR(2e-2 * speed * 2.0, speed * 2.0, pose.x_m);
    ASSERT_NEAR(2e-2 * speed * 2.0, 0.0, pose.y_m);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 40.0, pose.heading_rad);
}

static double fastest_decay(const laconic_model *m) {
    return larger((double)m->decay_per_s[0], larger((double)m->decay_per_s[1], (double)m->decay_per_s[2]));
}

static void a_step_beyond_the_damping_limit_is_refused_with_the_largest_stable_one(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const double limit = 4.313 / fastest_decay(&m);
    laconic_integrator in;
    memset(&in, 0, sizeof in);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_integrator_prepare(&in, &laconic_taylor_8, &m, REAL(limit * 1.001), &why), why);
    ASSERT_NEAR(limit * 4 * ROUNDING, limit, why.limit);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_taylor_8, &m, REAL(limit * 0.999), &why));
}

static void just_below_the_damping_limit_motion_dies_out(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 1, 1, 0);
    const double before = (double)laconic_energy_J(&m, &state);
    take_steps(&laconic_taylor_8, &m, &state, &input, 4.2 / fastest_decay(&m), 100);
    TEST_ASSERT_TRUE((double)laconic_energy_J(&m, &state) < 1e-3 * before);
}

static void a_yaw_too_fast_for_the_step_is_refused(void) { assert_too_fast_yaw_refused(&laconic_taylor_8); }

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_taylor_8, bare_body(), every_input(), 1.0, 5);
}

static void numbers_beyond_the_range_are_refused(void) { assert_too_large_force_refused(&laconic_taylor_8); }

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_eighth_order_under_everything_that_can_act);
    RUN_TEST(large_steps_meet_the_reference);
    RUN_TEST(energy_and_k_drift_only_by_the_truncation_error);
    RUN_TEST(a_steady_motion_stays);
    RUN_TEST(a_spinning_puck_flies_straight);
    RUN_TEST(a_step_beyond_the_damping_limit_is_refused_with_the_largest_stable_one);
    RUN_TEST(just_below_the_damping_limit_motion_dies_out);
    RUN_TEST(a_yaw_too_fast_for_the_step_is_refused);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    RUN_TEST(numbers_beyond_the_range_are_refused);
    return UNITY_END();
}
