#include "stiff.h"

static double fastest_decay(const laconic_model *m) {
    return larger((double)m->decay_per_s[0], larger((double)m->decay_per_s[1], (double)m->decay_per_s[2]));
}

static void slow_damping_gets_exact_flow_and_fast_damping_kahan(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const double border = 0.3 / fastest_decay(&m);
    laconic_integrator in = integrator_of(&laconic_auto, &m, border * 0.999);
    TEST_ASSERT_EQUAL_PTR(&laconic_auto, in.method);
    TEST_ASSERT_EQUAL_STRING("exact-flow-4", in.chosen->name);
    in = integrator_of(&laconic_auto, &m, border * 1.001);
    TEST_ASSERT_EQUAL_STRING("exponential-kahan-4", in.chosen->name);
}

static void takes_the_very_steps_of_the_method_it_chose(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_input input = every_input();
    laconic_state a = moving(&m, 1, 2, 3), b = a;
    input.world_force_N[0] = input.world_force_N[1] = 0;
    take_steps(&laconic_auto, &m, &a, &input, 0.01, 100);
    take_steps(&laconic_exact_flow_4, &m, &b, &input, 0.01, 100);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
    a = b = moving(&m, 1, 2, 3);
    take_steps(&laconic_auto, &m, &a, &input, 0.4, 5);
    take_steps(&laconic_exponential_kahan_4, &m, &b, &input, 0.4, 5);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_auto, EITHER(1e-13, 1e-5));
}

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_auto, &v, start_with(2, 1, 4), &input, 2.0, EITHER(40, 8), 4);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(slow_damping_gets_exact_flow_and_fast_damping_kahan);
    RUN_TEST(takes_the_very_steps_of_the_method_it_chose);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    return UNITY_END();
}
