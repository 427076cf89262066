#include "vehicles.h"

static void torque_is_gain_times_voltage_less_damping_plus_what_is_applied(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const laconic_input input = every_input();
    laconic_real speed[3], torque[3];
    int i;
    laconic_wheel_speeds(&m, &state, speed);
    laconic_wheel_torques(&m, &state, &input, torque);
    for (i = 0; i < 3; i++)
        ASSERT_NEAR(2 * ROUNDING, GAIN * (1.5 - 0.7 * i) - DAMPING * (double)speed[i] + 0.02 * i - 0.03, torque[i]);
}

static void without_motors_only_the_applied_torque_is_left(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const laconic_input input = every_input();
    laconic_real torque[3];
    laconic_wheel_torques(&m, &state, &input, torque);
    ASSERT_NEAR(ROUNDING, 0.01, torque[2]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(torque_is_gain_times_voltage_less_damping_plus_what_is_applied);
    RUN_TEST(without_motors_only_the_applied_torque_is_left);
    return UNITY_END();
}
