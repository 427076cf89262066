/* Tests of rk4.c: order, drift, stability limit, refusals. */
#include "stiff.h"

static laconic_refusal why;

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_rk4, &v, start_with(2, 1, 4), &input, 2.0, EITHER(20, 5), 4);
}

static void small_steps_meet_the_reference(void) {
    const laconic_vehicle v = with_motors(mecanum());
    const laconic_input input = every_input();
    const errors e = errors_of(&laconic_rk4, &v, start_with(2, 1, 4), &input, 1.0, 1000);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-10, 1e-4));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-10, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-10, 1e-4));
}

static void energy_and_k_drift_only_by_the_truncation_error(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_rk4, &v, 0.01, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-9, 1e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-9, 1e-5));
}

static void a_steady_motion_stays(void) { assert_steady_motion_stays(&laconic_rk4, 0.1); }

static double fastest_decay(const laconic_model *m) {
    return larger((double)m->decay_per_s[0], larger((double)m->decay_per_s[1], (double)m->decay_per_s[2]));
}

static void a_step_beyond_the_damping_limit_is_refused_with_the_largest_stable_one(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const double limit = 2.785 / fastest_decay(&m);
    laconic_integrator in;
    memset(&in, 0, sizeof in);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_integrator_prepare(&in, &laconic_rk4, &m, REAL(limit * 1.001), &why), why);
    ASSERT_NEAR(limit * 4 * ROUNDING, limit, why.limit);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&in, &laconic_rk4, &m, REAL(limit * 0.999), &why));
}

static void just_below_the_damping_limit_motion_dies_out(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 1, 1, 0);
    const double before = (double)laconic_energy_J(&m, &state);
    take_steps(&laconic_rk4, &m, &state, &input, 2.7 / fastest_decay(&m), 100);
    TEST_ASSERT_TRUE((double)laconic_energy_J(&m, &state) < 1e-3 * before);
}

static void a_yaw_too_fast_for_the_step_is_refused(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(&laconic_rk4, &m, 0.1);
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 1, 1, 500), before = state;
    ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, laconic_step(&m, &in, &state, &input));
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
}

static void a_vehicle_without_gyroscopic_term_has_no_gyroscopic_limit(void) {
    const laconic_model m = model_of(caster());
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 1, 0, 1000);
    take_steps(&laconic_rk4, &m, &state, &input, 1.0, 3);
}

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_rk4, bare_body(), every_input(), 1.0, 5);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(small_steps_meet_the_reference);
    RUN_TEST(energy_and_k_drift_only_by_the_truncation_error);
    RUN_TEST(a_steady_motion_stays);
    RUN_TEST(a_step_beyond_the_damping_limit_is_refused_with_the_largest_stable_one);
    RUN_TEST(just_below_the_damping_limit_motion_dies_out);
    RUN_TEST(a_yaw_too_fast_for_the_step_is_refused);
    RUN_TEST(a_vehicle_without_gyroscopic_term_has_no_gyroscopic_limit);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    return UNITY_END();
}
