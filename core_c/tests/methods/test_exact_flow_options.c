/* Tests of exact_flow.c as a core has it that was compiled without damping or without any input: here both options are
 * variables, so that one program tries all. */
#include "step_internals.h"

#include "methods.h"

static bool with_damping, with_forcing;

#undef LACONIC_WITH_DAMPING
#define LACONIC_WITH_DAMPING with_damping
#undef LACONIC_WITH_FORCING
#define LACONIC_WITH_FORCING with_forcing
#define laconic_exact_flow lean_flow
#define laconic_exact_flow_4 lean_flow_4
extern const laconic_method lean_flow, lean_flow_4;
#include "exact_flow.c"
#undef laconic_exact_flow
#undef laconic_exact_flow_4

/* Whatever a core leaves out, where nothing of it acts it steps as the whole one does. */
static void assert_steps_of_the_whole_core(const laconic_method *lean, const laconic_method *whole, laconic_vehicle v,
                                           const laconic_input *input) {
    const laconic_model m = model_of(v);
    const laconic_integrator in = integrator_of(whole, &m, 0.05);
    laconic_integrator other = in;
    laconic_state state = moving(&m, 1, -2, 3), same = state;
    other.chosen = lean;
    for (int k = 0; k < 20; k++) {
        ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, input));
        ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &other, &same, input));
    }
    TEST_ASSERT_EQUAL_MEMORY(&state, &same, sizeof state);
}

static void assert_both_orders(bool damping_is_there, bool forcing_is_there, laconic_vehicle v,
                               const laconic_input *input) {
    with_damping = damping_is_there;
    with_forcing = forcing_is_there;
    assert_steps_of_the_whole_core(&lean_flow, &laconic_exact_flow, v, input);
    assert_steps_of_the_whole_core(&lean_flow_4, &laconic_exact_flow_4, v, input);
}

static void without_both_it_takes_the_steps_of_free_motion(void) {
    const laconic_input none_acts = no_input();
    assert_both_orders(false, false, three_wheels(), &none_acts);
}

static void without_inputs_it_still_damps(void) {
    const laconic_input none_acts = no_input();
    assert_both_orders(true, false, with_motors(three_wheels()), &none_acts);
}

static void without_damping_it_is_still_driven(void) {
    laconic_input input = no_input();
    input.body_force_N[0] = 3;
    assert_both_orders(false, true, three_wheels(), &input);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(without_both_it_takes_the_steps_of_free_motion);
    RUN_TEST(without_inputs_it_still_damps);
    RUN_TEST(without_damping_it_is_still_driven);
    return UNITY_END();
}
