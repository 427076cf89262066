/* Tests of exponential_kahan.c: order, steady motions, stiff vehicles, refusals. */
#include "kahan.h"

/* ------------------------------------------------------------------------------ second order -- */

static void is_of_second_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exponential_kahan, &v, start_with(2, 1, 4), &input, 2.0, EITHER(100, 40), 2);
}

static void is_of_second_order_without_a_world_force(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_order(&laconic_exponential_kahan, &v, start_with(2, 1, 4), &input, 1.0, EITHER(100, 40), 2);
}

static void damping_and_forcing_alone_are_exact(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_input input = no_input();
    errors e;
    input.voltage_V[0] = REAL(1);
    input.voltage_V[1] = REAL(-1); /* straight along η, without yaw */
    e = errors_of(&laconic_exponential_kahan, &v, start_with(0, 1, 0), &input, 1.0, 1);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-13, 4e-6));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-13, 4e-6));
}

static void a_steady_motion_stays_at_any_step(void) {
    assert_steady_motion_stays(&laconic_exponential_kahan, 0.1);
    assert_steady_motion_stays(&laconic_exponential_kahan, 3.0);
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_exponential_kahan, EITHER(1e-13, 1e-5));
}

static void energy_and_k_nearly_stay(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exponential_kahan, &v, 0.02, 3000);
    TEST_ASSERT_TRUE(d.energy < 1e-3);
    TEST_ASSERT_TRUE(d.yaw_integral < 1e-3);
}

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_exponential_kahan, three_wheels(), every_input(), 0.1, 500);
}

static void a_step_without_a_solution_is_refused(void) {
    assert_singular_step_refused(&laconic_exponential_kahan, 0.5);
}

static void numbers_beyond_the_range_are_refused(void) { assert_too_large_force_refused(&laconic_exponential_kahan); }

/* ------------------------------------------------------------------ damping fast beside the step -- */

/* h·r is 0.63 and 0.31: from 0.3 on the gyroscopic term is followed over the step. */
static void assert_follows(const laconic_method *method, double order, errors most) {
    const laconic_start start = start_with(2, 1, 4);
    laconic_vehicle v = with_motors(three_wheels());
    laconic_input input = every_input();
    v.motor_damping_Nms = REAL(0.2);
    v.motor_gain_Nm_per_V = REAL(0.6);
    input.body_force_N[0] = 40;
    input.world_force_N[0] = input.world_force_N[1] = 0;
    const errors found = errors_of(method, &v, start, &input, 1.0, 10);
    TEST_ASSERT_TRUE_MESSAGE(found.nu < most.nu, "nu");
    TEST_ASSERT_TRUE_MESSAGE(found.pose < most.pose, "pose");
    TEST_ASSERT_TRUE_MESSAGE(found.wheels < most.wheels, "wheels");
    if (IN_DOUBLE || order < 3) assert_order(method, &v, start, &input, 1.0, 10, order);
}

static void fast_damping_leaves_order_and_accuracy(void) {
    const errors of_second = {0.0135, 3.3e-3, 0.0205}, of_fourth = {1.08e-4, 4.6e-5, 1.72e-4};
    assert_follows(&laconic_exponential_kahan, 2, of_second);
    assert_follows(&laconic_exponential_kahan_4, 4, of_fourth);
}

/* ------------------------------------------------------------------------------ fourth order -- */

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exponential_kahan_4, &v, start_with(2, 1, 4), &input, 2.0, EITHER(40, 8), 4);
}

static void is_of_fourth_order_without_a_world_force(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_order(&laconic_exponential_kahan_4, &v, start_with(2, 1, 4), &input, 1.0, EITHER(40, 3), 4);
}

static void a_steady_motion_stays_at_any_step_in_the_extrapolated(void) {
    assert_steady_motion_stays(&laconic_exponential_kahan_4, 0.1);
    assert_steady_motion_stays(&laconic_exponential_kahan_4, 3.0);
}

static void a_stiff_vehicle_reaches_its_steady_motion_in_the_extrapolated(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_exponential_kahan_4, EITHER(1e-13, 1e-5));
}

static void energy_and_k_nearly_stay_in_the_extrapolated(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exponential_kahan_4, &v, 0.02, 3000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-6, 2e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-6, 2e-5));
}

static void a_step_that_gains_energy_is_refused_in_the_extrapolated(void) {
    start_that_gains_energy(&laconic_exponential_kahan_4, three_wheels(), no_input(), 0.1, 500);
}

static void a_whole_or_half_step_without_a_solution_is_refused(void) {
    assert_singular_step_refused(&laconic_exponential_kahan_4, 0.5);
    assert_singular_step_refused(&laconic_exponential_kahan_4, 0.25);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_second_order_under_everything_that_can_act);
    RUN_TEST(is_of_second_order_without_a_world_force);
    RUN_TEST(damping_and_forcing_alone_are_exact);
    RUN_TEST(a_steady_motion_stays_at_any_step);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(energy_and_k_nearly_stay);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    RUN_TEST(a_step_without_a_solution_is_refused);
    RUN_TEST(numbers_beyond_the_range_are_refused);
    RUN_TEST(fast_damping_leaves_order_and_accuracy);
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(is_of_fourth_order_without_a_world_force);
    RUN_TEST(a_steady_motion_stays_at_any_step_in_the_extrapolated);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion_in_the_extrapolated);
    RUN_TEST(energy_and_k_nearly_stay_in_the_extrapolated);
    RUN_TEST(a_step_that_gains_energy_is_refused_in_the_extrapolated);
    RUN_TEST(a_whole_or_half_step_without_a_solution_is_refused);
    return UNITY_END();
}
