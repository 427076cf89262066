#include "kahan.h"

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exponential_kahan_4, &v, start_with(2, 1, 4), &input, 2.0, EITHER(40, 8), 4);
}

static void is_of_fourth_order_when_nothing_turns_with_the_world(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_order(&laconic_exponential_kahan_4, &v, start_with(2, 1, 4), &input, 1.0, EITHER(40, 3), 4);
}

static void a_steady_motion_stays_at_any_step(void) {
    assert_steady_motion_stays(&laconic_exponential_kahan_4, 0.1);
    assert_steady_motion_stays(&laconic_exponential_kahan_4, 3.0);
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_exponential_kahan_4, EITHER(1e-13, 1e-5));
}

static void energy_and_k_nearly_stay(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exponential_kahan_4, &v, 0.02, 3000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-6, 2e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-6, 2e-5));
}

static void a_step_that_makes_energy_out_of_nothing_is_refused(void) {
    start_that_gains_energy(&laconic_exponential_kahan_4, three_wheels(), no_input(), 0.1, 500);
}

static void a_whole_or_half_step_without_a_solution_is_refused(void) {
    assert_singular_step_refused(&laconic_exponential_kahan_4, 0.5);
    assert_singular_step_refused(&laconic_exponential_kahan_4, 0.25);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(is_of_fourth_order_when_nothing_turns_with_the_world);
    RUN_TEST(a_steady_motion_stays_at_any_step);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(energy_and_k_nearly_stay);
    RUN_TEST(a_step_that_makes_energy_out_of_nothing_is_refused);
    RUN_TEST(a_whole_or_half_step_without_a_solution_is_refused);
    return UNITY_END();
}
