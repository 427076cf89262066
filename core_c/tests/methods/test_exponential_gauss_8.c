/* Tests of exponential_gauss_8.c: order, steady motions, stiff vehicles, panels, drift, refusals. */
#include "stiff.h"

/* In single precision 8 steps already err by little more than rounding, and half as many are beyond the gyroscopic
 * limit. */
static void assert_eighth_order_under(laconic_input input) {
    const laconic_vehicle v = with_motors(three_wheels());
    if (EITHER(true, false)) {
        assert_order(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 2.0, 16, 8);
    } else {
        const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 2.0, 8);
        TEST_ASSERT_TRUE(e.nu < 1e-4 && e.pose < 1e-5 && e.wheels < 1e-5);
    }
}

static void is_of_eighth_order_under_everything_that_can_act(void) { assert_eighth_order_under(every_input()); }

static void is_of_eighth_order_without_a_world_force(void) {
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_eighth_order_under(input);
}

static void large_steps_meet_the_reference(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 1.0, 25);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-11, 1e-5));
}

/* h·r of 0.3 is one panel, of 30 many of them and the rest. */
static void damping_and_forcing_alone_are_exact_in_one_panel_and_in_many(void) {
    laconic_vehicle v = with_motors(three_wheels());
    laconic_input input = no_input();
    input.voltage_V[0] = REAL(1);
    input.voltage_V[1] = REAL(-1); /* straight along η, without yaw */
    for (int k = 0; k < 3; k++) {
        const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(0, 1, 0), &input, 1.0, 1);
        TEST_ASSERT_TRUE(e.nu < EITHER(1e-13, 4e-6));
        TEST_ASSERT_TRUE(e.wheels < EITHER(1e-13, 4e-6));
        v.motor_damping_Nms *= REAL(10);
    }
}

static void a_steady_motion_stays_at_any_step(void) {
    assert_steady_motion_stays(&laconic_exponential_gauss_8, 0.1);
    assert_steady_motion_stays(&laconic_exponential_gauss_8, 0.4);
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_exponential_gauss_8, EITHER(1e-13, 1e-5));
}

/* On the way to its steady motion such a vehicle yaws and slides at once; against 1,000 small steps. */
static void what_dies_out_within_a_step_is_integrated(void) {
    laconic_vehicle v = stiff();
    laconic_input input = no_input();
    errors e;
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(i - 1);
    e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, -3, 4), &input, 0.02, 1);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-11, 1e-5));
}

static void damping_beyond_the_panels_is_taken(void) {
    const laconic_model m = model_of(stiff());
    laconic_state state = moving(&m, 1, 1, 0);
    const laconic_input input = no_input();
    take_steps(&laconic_exponential_gauss_8, &m, &state, &input, 1e5, 3);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0, laconic_energy_J(&m, &state));
}

static void energy_and_k_drift_only_by_the_truncation_error(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exponential_gauss_8, &v, 0.05, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-12, 1e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-12, 1e-5));
}

/* From rest, by a b that grows from 0 along one of ζ's axes alone: what else moves, the gyroscopic term has made. */
static void end_of_one_axis(double zeta[3], const laconic_model *m, const laconic_method *method, int axis, int steps) {
    const laconic_integrator in = integrator_of(method, m, 0.25 / steps);
    laconic_state state = moving(m, 0, 0, 0);
    for (int i = 0; i < steps; i++) {
        laconic_forcing at[3];
        memset(at, 0, sizeof at);
        for (int k = 0; k < 3; k++) at[k].constant[axis] = REAL(6 * (i + 0.5 * k) / steps);
        const laconic_forcing_samples samples = {&at[0], &at[1], &at[2], false};
        ASSERT_STATUS(LACONIC_OK, method->step(m, &in, &state, &samples));
    }
    for (int k = 0; k < 3; k++) zeta[k] = (double)state.zeta[k].value;
}

static void a_forcing_along_one_axis_turns_the_motion(void) {
    laconic_vehicle v = with_own_wheels(with_motors(three_wheels()));
    v.com_x_m = REAL(0.03);
    const laconic_model m = model_of(v);
    for (int axis = 0; axis < 3; axis++) {
        double whole[3], fine[3];
        end_of_one_axis(whole, &m, &laconic_exponential_gauss_8, axis, 1);
        end_of_one_axis(fine, &m, &laconic_taylor_8, axis, 32);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(fabs(fine[k]) > 1e-4);
            ASSERT_NEAR(EITHER(1e-8, 1e-5), fine[k], whole[k]);
        }
    }
}

static void a_yaw_too_fast_for_the_step_is_refused(void) { assert_too_fast_yaw_refused(&laconic_exponential_gauss_8); }

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_exponential_gauss_8, three_wheels(), every_input(), 1.0, 500);
}

static void numbers_beyond_the_range_are_refused(void) { assert_too_large_force_refused(&laconic_exponential_gauss_8); }

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_eighth_order_under_everything_that_can_act);
    RUN_TEST(is_of_eighth_order_without_a_world_force);
    RUN_TEST(large_steps_meet_the_reference);
    RUN_TEST(damping_and_forcing_alone_are_exact_in_one_panel_and_in_many);
    RUN_TEST(a_steady_motion_stays_at_any_step);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(what_dies_out_within_a_step_is_integrated);
    RUN_TEST(damping_beyond_the_panels_is_taken);
    RUN_TEST(energy_and_k_drift_only_by_the_truncation_error);
    RUN_TEST(a_forcing_along_one_axis_turns_the_motion);
    RUN_TEST(a_yaw_too_fast_for_the_step_is_refused);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    RUN_TEST(numbers_beyond_the_range_are_refused);
    return UNITY_END();
}
