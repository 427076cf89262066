#include "methods.h"

static void angles_start_at_zero_and_can_be_set(void) {
    const laconic_model m = model_of(three_wheels());
    laconic_state state = moving(&m, 1, 2, 3);
    const laconic_real wanted[3] = {REAL(0.5), REAL(-40), REAL(1000)};
    laconic_real angle[3];
    laconic_wheel_angles(&m, &state, angle);
    TEST_ASSERT_EACH_EQUAL_DOUBLE(0.0, ((double[3]){(double)angle[0], (double)angle[1], (double)angle[2]}), 3);
    laconic_wheel_angles_set(&m, &state, wanted);
    laconic_wheel_angles(&m, &state, angle);
    ASSERT_NEAR_ALL(0, wanted, angle, 3);
}

/* Straight ahead at ν = (2, 0, 0) a caster's wheel turns by 2 rad a second. */
static void angles_grow_with_the_wheels_speed_from_what_they_were_set_to(void) {
    const laconic_model m = model_of(caster());
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 2, 0, 0);
    const laconic_real wanted[1] = {REAL(10)};
    laconic_real angle[1];
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.125, 8);
    laconic_wheel_angles_set(&m, &state, wanted);
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.125, 16);
    laconic_wheel_angles(&m, &state, angle);
    ASSERT_NEAR(EITHER(1e-14, 4e-6), 14.0, angle[0]);
}

static void the_angle_of_a_locked_wheel_stays(void) {
    laconic_vehicle v = three_wheels();
    const laconic_input input = no_input();
    const laconic_real wanted[3] = {0, 0, REAL(7)};
    laconic_real angle[3];
    laconic_model m;
    laconic_state state;
    v.wheel[2].locked = true;
    m = model_of(v);
    state = moving(&m, RHO, 1, 1);
    laconic_wheel_angles_set(&m, &state, wanted);
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.1, 50);
    laconic_wheel_angles(&m, &state, angle);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, (double)angle[2]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(angles_start_at_zero_and_can_be_set);
    RUN_TEST(angles_grow_with_the_wheels_speed_from_what_they_were_set_to);
    RUN_TEST(the_angle_of_a_locked_wheel_stays);
    return UNITY_END();
}
