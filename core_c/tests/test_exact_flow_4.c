#include "stiff.h"

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exact_flow_4, &v, start_with(2, 1, 4), &input, 2.0, EITHER(40, 8), 4);
}

static void is_of_fourth_order_when_nothing_turns_with_the_world(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_order(&laconic_exact_flow_4, &v, start_with(2, 1, 4), &input, 1.0, EITHER(40, 3), 4);
}

static void free_motion_is_exact(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_input input = no_input();
    const errors e = errors_of(&laconic_exact_flow_4, &v, start_with(1, 2, 3), &input, 4.0, 40);
    TEST_ASSERT_TRUE(e.nu < EITHER(2e-12, 2e-5));
}

static void energy_and_k_stay_to_rounding(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exact_flow_4, &v, 0.05, 10000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-13, 2e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-13, 2e-5));
}

static void a_step_that_makes_energy_out_of_nothing_is_refused(void) {
    start_that_gains_energy(&laconic_exact_flow_4, bare_body(), every_input(), 1.0, 10);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(is_of_fourth_order_when_nothing_turns_with_the_world);
    RUN_TEST(free_motion_is_exact);
    RUN_TEST(energy_and_k_stay_to_rounding);
    RUN_TEST(a_step_that_makes_energy_out_of_nothing_is_refused);
    return UNITY_END();
}
