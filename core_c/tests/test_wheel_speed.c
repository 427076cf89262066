#include "vehicles.h"

static void wheels_turn_as_xi_says(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const double expected[3] = {-0.4 + SIGMA * 1.9, 0.4 + SIGMA * 1.9, -0.7 + RHO * 1.9};
    laconic_real speed[3];
    laconic_wheel_speeds(&m, &state, speed);
    ASSERT_NEAR_ALL(4 * ROUNDING, expected, speed, 3);
}

static void a_wheel_with_its_axle_to_the_right_turns_forward_when_the_vehicle_does(void) {
    const laconic_model m = model_of(caster());
    const laconic_state state = moving(&m, 2, 0, 0);
    laconic_real speed[1];
    laconic_wheel_speeds(&m, &state, speed);
    ASSERT_NEAR(ROUNDING, 2, speed[0]);
}

static void a_locked_wheel_stands(void) {
    laconic_vehicle v = three_wheels();
    laconic_model m;
    laconic_state state;
    laconic_real speed[3];
    v.wheel[2].locked = true;
    m = model_of(v);
    state = moving(&m, RHO * 3, 1, 3);
    laconic_wheel_speeds(&m, &state, speed);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)speed[2]);
    ASSERT_NEAR(4 * ROUNDING, 1 + SIGMA * 3, speed[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(wheels_turn_as_xi_says);
    RUN_TEST(a_wheel_with_its_axle_to_the_right_turns_forward_when_the_vehicle_does);
    RUN_TEST(a_locked_wheel_stands);
    return UNITY_END();
}
