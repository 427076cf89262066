#include "vehicles.h"

static laconic_refusal why;

static void they_are_what_the_single_functions_give(void) {
    laconic_plant plant;
    laconic_outputs out;
    laconic_pose pose;
    laconic_real nu[3], velocity[2], wheels[LACONIC_MAX_WHEELS];
    const laconic_vehicle v = with_motors(mecanum());
    const laconic_input input = every_input();
    const laconic_start start = start_with(1, 2, 3);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 17, &why));
    laconic_outputs_of(&out, &plant, &input);
    laconic_nu(&plant.model, &plant.state, nu);
    TEST_ASSERT_EQUAL_MEMORY(nu, out.nu_rad_per_s, sizeof nu);
    laconic_pose_of(&pose, &plant.model, &plant.state);
    TEST_ASSERT_EQUAL_MEMORY(&pose, &out.pose, sizeof pose);
    TEST_ASSERT_TRUE(out.yaw_rate_rad_per_s == laconic_body_velocity(&plant.model, &plant.state, velocity));
    TEST_ASSERT_EQUAL_MEMORY(velocity, out.velocity_body_m_per_s, sizeof velocity);
    TEST_ASSERT_TRUE(out.energy_J == laconic_energy_J(&plant.model, &plant.state));
    laconic_wheel_speeds(&plant.model, &plant.state, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_speed_rad_per_s, 4 * sizeof wheels[0]);
    laconic_wheel_angles(&plant.model, &plant.state, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_angle_rad, 4 * sizeof wheels[0]);
    laconic_wheel_torques(&plant.model, &plant.state, &input, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_torque_Nm, 4 * sizeof wheels[0]);
    TEST_ASSERT_EQUAL_MEMORY(&input, &out.input, sizeof input);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(they_are_what_the_single_functions_give);
    return UNITY_END();
}
