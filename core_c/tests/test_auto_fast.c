#include "stiff.h"

/* A step that laconic_exponential_kahan_4 refuses, since it would gain energy: exact-flow takes it, to the bit. */
static void a_step_that_cannot_be_taken_is_taken_by_exact_flow(void) {
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

static void what_exact_flow_cannot_take_is_refused(void) {
    laconic_input input = no_input();
    laconic_vehicle v = with_motors(three_wheels());
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_auto, v, start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_step_that_cannot_be_taken_is_taken_by_exact_flow);
    RUN_TEST(what_exact_flow_cannot_take_is_refused);
    return UNITY_END();
}
