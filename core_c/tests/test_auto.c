/* Tests of auto.c: which method is chosen when, and what happens to steps that it refuses. */
#include "stiff.h"

/* -------------------------------------------------------------------------------- the choice -- */

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

/* ------------------------------------------------------------------------------ slow damping -- */

/* A step that laconic_exact_flow_4 refuses, since it would gain energy: exact-flow takes it, to the bit. */
static void a_step_that_cannot_be_taken_is_taken_by_exact_flow(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_integrator in = integrator_of(&laconic_auto, &m, 1.0);
    const laconic_input input = every_input();
    const laconic_start start = start_that_gains_energy(&laconic_exact_flow_4, bare_body(), input, 1.0, 10);
    laconic_state a = state_of(&m, start), b = a;
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_slow, in.chosen);
    ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &a, &input));
    take_steps(&laconic_exact_flow, &m, &b, &input, 1.0, 1);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

static void what_exact_flow_cannot_take_is_refused(void) {
    laconic_input input = no_input();
    laconic_vehicle v = bare_body();
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_auto, v, start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

/* b of a force fixed in the world varies as the vehicle yaws. */
static void forcing_that_varies_is_stepped_by_taylor_8(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    laconic_state a = moving(&m, 1, 2, 3), b = a;
    take_steps(&laconic_auto, &m, &a, &input, 0.01, 100);
    take_steps(&laconic_taylor_8, &m, &b, &input, 0.01, 100);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

static void but_not_while_the_vehicle_yaws_fast(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    laconic_state a = moving(&m, 1, 2, 300), b = a;
    take_steps(&laconic_auto, &m, &a, &input, 0.01, 10);
    take_steps(&laconic_exact_flow_4, &m, &b, &input, 0.01, 10);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

/* ------------------------------------------------------------------------------ fast damping -- */

/* A step that laconic_exponential_kahan_4 refuses, since it would gain energy: exact-flow takes it, to the bit. */
static void a_step_that_cannot_be_taken_is_taken_by_exact_flow_while_damping_is_fast(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_integrator in = integrator_of(&laconic_auto, &m, 1.0);
    const laconic_input input = no_input();
    const laconic_start start =
        start_that_gains_energy(&laconic_exponential_kahan_4, with_motors(three_wheels()), input, 1.0, 1e4);
    laconic_state a = state_of(&m, start), b = a;
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_fast, in.chosen);
    ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &a, &input));
    take_steps(&laconic_exact_flow, &m, &b, &input, 1.0, 1);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

static void what_exact_flow_cannot_take_is_refused_while_damping_is_fast(void) {
    laconic_input input = no_input();
    laconic_vehicle v = with_motors(three_wheels());
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_auto, v, start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(slow_damping_gets_exact_flow_and_fast_damping_kahan);
    RUN_TEST(takes_the_very_steps_of_the_method_it_chose);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(a_step_that_cannot_be_taken_is_taken_by_exact_flow);
    RUN_TEST(forcing_that_varies_is_stepped_by_taylor_8);
    RUN_TEST(but_not_while_the_vehicle_yaws_fast);
    RUN_TEST(what_exact_flow_cannot_take_is_refused);
    RUN_TEST(a_step_that_cannot_be_taken_is_taken_by_exact_flow_while_damping_is_fast);
    RUN_TEST(what_exact_flow_cannot_take_is_refused_while_damping_is_fast);
    return UNITY_END();
}
