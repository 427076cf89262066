/* Tests of wheels as the parts of the vehicle see them: as many as there are, within limits, with sensors. */
#include "fmi2_bench.h"
#include "friction_part.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* As many as a vehicle may have, each with an angle and a speed. */
static void sixteen_wheels_have_38_states(void) {
    double state[38], rate[38];
    with_wheel_states();
    laconic_vehicle *v = &instance()->model.vehicle;
    for (int k = 4; k < LACONIC_MAX_WHEELS; k++) {
        v->wheel[k] = v->wheel[k % 4];
        v->wheel[k].y_m *= 1 + 0.1 * k;
    }
    v->wheel_count = LACONIC_MAX_WHEELS;
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int k = 0; k < 38; k++) state[k] = 0.1 * k;
    OK(fmi2SetContinuousStates(c, state, 38));
    OK(fmi2GetDerivatives(c, rate, 38));
    for (int k = 22; k < 38; k++) TEST_ASSERT_TRUE(rate[k] != 0);
    for (int k = 0; k < 16; k++) TEST_ASSERT_TRUE(rate[6 + k] == state[22 + k]);
}

/* A supply that is never short: all is as without limits, with voltages of its wheels and motion in each coordinate. */
static void a_drive_within_its_limits_is_one_without(void) {
    double state[10], rate[2][10], shown[2][4][5];
    for (int limited = 0; limited < 2; limited++) {
        make(fmi2ModelExchange);
        if (limited) set("supply_V", 0, 1000);
        if (limited) set("winding_resistance_ohm", 0, 1.5);
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 3 - 1.3 * k);
        for (int k = 0; k < 10; k++) state[k] = 0.3 * k - 0.7;
        OK(fmi2SetContinuousStates(c, state, 10));
        for (uint32_t k = 0; k < 4; k++) {
            double *to = shown[limited][k];
            to[0] = get("energy_J", 0);
            to[1] = get("wheel_speed_rad_per_s", k + 1);
            to[2] = get("wheel_torque_Nm", k + 1);
            to[3] = get("wheel_reaction_N", k + 1);
            to[4] = get("wheel_angle_rad", k + 1);
        }
        OK(fmi2GetDerivatives(c, rate[limited], 10));
        OK(fmi2SetContinuousStates(c, state, 10)); /* the torque first */
        TEST_ASSERT_TRUE(get("wheel_torque_Nm", 1) == shown[limited][0][2]);
    }
    for (int k = 0; k < 10; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, rate[0][k], rate[1][k]);
    for (int k = 0; k < 4; k++)
        for (int n = 0; n < 5; n++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, shown[0][k][n], shown[1][k][n]);
    TEST_ASSERT_TRUE(rate[0][0] != 0 && rate[0][1] != 0 && shown[0][0][3] != 0);
}

/* At rest the body's acceleration is R ν', also where it is read before any rate; after each change of an input. */
static void the_acceleration_on_ground_with_friction_is_that_of_the_rates(void) {
    with_wheel_states();
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int n = 1; n <= 3; n++) {
        set("body_force_N", 1, 4 * n);
        set("body_force_N", 2, -3 * n);
        for (uint32_t k = 1; k <= 2; k++) {
            const double felt = get("acceleration_body_m_per_s2", k);
            TEST_ASSERT_TRUE(fabs(felt) > 0.01);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, get("wheel_radius_m", 0) * get("der(nu_rad_per_s)", k), felt);
        }
    }
}

static void a_single_wheel_slips_too(void) {
    laconic_vehicle v = instance()->model.vehicle;
    v.ground.friction_coefficient = 0.3;
    for (v.wheel_count = 0; v.wheel_count < 3; v.wheel_count++)
        TEST_ASSERT_TRUE(fmu_vehicle_slips(&v) == (v.wheel_count > 0));
    v.ground.friction_coefficient = 0;
    TEST_ASSERT_FALSE(fmu_vehicle_slips(&v));
}

/* A wheel that is not there has no encoder, whatever its settings say. */
static void wheels_that_are_not_there_have_no_sensors(void) {
    make(fmi2ModelExchange);
    instance()->model.sensor_settings.encoder[4].counts_per_turn = 4096;
    initialise();
    make(fmi2CoSimulation);
    set_flag("has_imu", 0);
    instance()->model.sensor_settings.encoder[4].counts_per_turn = 4096;
    instance()->model.sensor_settings.encoder[15].gear_ratio = 3;
    initialise();
    for (int i = 4; i < LACONIC_MAX_WHEELS; i++) {
        const laconic_encoder_settings unset = instance()->model.sensors.settings.encoder[i];
        TEST_ASSERT_TRUE(unset.counts_per_turn == 0 && unset.gear_ratio == 0);
    }
}

static void sensors_watch_steps_with_slopes(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    const double slope = 20;
    for (int watched = 0; watched < 2; watched++) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.05);
        set("friction_coefficient", 0, 0);
        if (watched) set_integer("encoder_counts_per_turn", 1, 4096);
        initialise();
        OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
        OK(fmi2DoStep(c, 0, 1, fmi2True));
        const double turned = get("wheel_angle_rad", 1), count = get("encoder_count", 1);
        TEST_ASSERT_TRUE(turned > 0.1);
        if (watched) TEST_ASSERT_DOUBLE_WITHIN(1.5, turned * 4096 / (2 * 3.14159265358979), count);
        if (!watched) TEST_ASSERT_TRUE(count == 0);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sixteen_wheels_have_38_states);
    RUN_TEST(a_drive_within_its_limits_is_one_without);
    RUN_TEST(the_acceleration_on_ground_with_friction_is_that_of_the_rates);
    RUN_TEST(a_single_wheel_slips_too);
    RUN_TEST(wheels_that_are_not_there_have_no_sensors);
    RUN_TEST(sensors_watch_steps_with_slopes);
    return UNITY_END();
}
