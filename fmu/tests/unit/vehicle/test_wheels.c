/* Tests of wheels as the parts of the vehicle see them: as many as there are, within limits, with sensors. */
#include "fmi2_bench.h"
#include "model_interface.h"
#include "parts.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* As many as a vehicle may have. */
static void with_sixteen_wheels(void) {
    laconic_vehicle *v = &instance()->model.vehicle;
    for (int k = 4; k < LACONIC_MAX_WHEELS; k++) {
        v->wheel[k] = v->wheel[k % 4];
        v->wheel[k].y_m *= 1 + 0.1 * k;
    }
    v->wheel_count = LACONIC_MAX_WHEELS;
}

/* Each with an angle and a speed. */
static void sixteen_wheels_have_38_states(void) {
    double state[38], rate[38], found[38];
    with_wheel_states();
    with_sixteen_wheels();
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int k = 0; k < 38; k++) state[k] = 0.1 * k;
    OK(fmi2SetContinuousStates(c, state, 38));
    OK(fmi2GetContinuousStates(c, found, 38));
    TEST_ASSERT_EQUAL_MEMORY(state, found, sizeof state);
    OK(fmi2GetDerivatives(c, rate, 38));
    for (int k = 22; k < 38; k++) TEST_ASSERT_TRUE(rate[k] != 0);
    for (int k = 0; k < 16; k++) TEST_ASSERT_TRUE(rate[6 + k] == state[22 + k]);
    TEST_ASSERT_TRUE(get("contact_state", 16) == 1 && get("drive_limit", 1) == 0 && get("drive_limit", 16) == 0);
}

/* Nothing of the last wheel gets into what stands behind it: supports and a limit of the first. */
static void sixteen_wheels_with_limits_are_sixteen_without(void) {
    double state[22], rate[2][22];
    for (int limited = 0; limited < 2; limited++) {
        make(fmi2ModelExchange);
        with_sixteen_wheels();
        if (limited) set("supply_V", 0, 1000);
        if (limited) set("winding_resistance_ohm", 0, 1.5);
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        for (uint32_t k = 1; k <= 16; k++) set("voltage_V", k, 3 - 0.3 * k);
        for (int k = 0; k < 22; k++) state[k] = 0.1 * k - 0.2;
        OK(fmi2SetContinuousStates(c, state, 22));
        OK(fmi2GetDerivatives(c, rate[limited], 22));
        TEST_ASSERT_TRUE(get("wheel_torque_Nm", 16) != 0 && get("wheel_reaction_N", 16) != 0);
    }
    for (int k = 0; k < 22; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, rate[0][k], rate[1][k]);
    TEST_ASSERT_TRUE(rate[0][21] != 0);
}

/* Slopes of each, and how outputs of each change in time. */
static void the_last_of_sixteen_wheels_follows_a_slope(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 16), torque = ref("wheel_torque_Nm", 16),
                             angle = ref("wheel_angle_rad", 16);
    const fmi2Integer first = 1;
    const double slope = 20;
    double rate = 0;
    with_sixteen_wheels();
    set("step_s", 0, 0.05);
    set("friction_coefficient", 0, 0);
    set_flag("has_imu", 0);
    initialise();
    TEST_ASSERT_FALSE(instance()->model.idle_wheels);
    set("voltage_V", 16, 2);
    OK(step(0, 0.05));
    OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
    OK(fmi2GetRealOutputDerivatives(c, &torque, 1, &first, &rate));
    TEST_ASSERT_TRUE(rate != 0);
    OK(fmi2GetRealOutputDerivatives(c, &angle, 1, &first, &rate));
    TEST_ASSERT_TRUE(rate == get("wheel_speed_rad_per_s", 16) && rate != 0);
    OK(step(0.05, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4, get("voltage_V", 16));
    TEST_ASSERT_TRUE(get("imu_acceleration_m_per_s2", 1) != 0 && get("encoder_count", 16) == 0);
}

/* Of wheels that follow from ν: of a vehicle with rollers, one with fixed wheels behind, and one with a brake, too. */
static void with_wheels(int kind) {
    if (kind == 0) return;
    for (uint32_t k = 3; k <= 4; k++) set_integer("wheel_kind", k, LACONIC_WHEEL_FIXED);
    set("own_motor_gain_Nm_per_V", 3, 0.35);
    set("own_motor_damping_Nms", 4, 0.21);
    if (kind == 2) set_flag("wheel_locked", 2);
}

static const struct {
    const char *name;
    uint32_t count;
} shown[] = {{"energy_J", 1},         {"velocity_body_m_per_s", 2}, {"yaw_rate_rad_per_s", 1},
             {"wheel_angle_rad", 4},  {"wheel_speed_rad_per_s", 4}, {"wheel_torque_Nm", 4},
             {"wheel_reaction_N", 4}, {"wheel_lateral_N", 4},       {"acceleration_body_m_per_s2", 2},
             {"no_slip_margin_N", 1}, {"wheel_load_N", 4}};
#define SHOWN 31

static void read_shown(double values[SHOWN]) {
    size_t used = 0;
    for (size_t n = 0; n < sizeof shown / sizeof shown[0]; n++)
        for (uint32_t k = 1; k <= shown[n].count; k++) values[used++] = get(shown[n].name, shown[n].count == 1 ? 0 : k);
    TEST_ASSERT_EQUAL_size_t(SHOWN, used);
}

/* A supply that is never short: all is as without limits, with voltages of its wheels and motion in each coordinate,
 * also where wheels do not allow it. Nothing else tells a shorted motor from one that gets 0 V. */
static void a_drive_within_its_limits_is_one_without(void) {
    double state[10], rate[2][10], values[2][SHOWN];
    for (int kind = 0; kind < 6; kind++) {
        for (int limited = 0; limited < 2; limited++) {
            make(fmi2ModelExchange);
            with_wheels(kind / 2);
            if (limited) set("supply_V", 0, 1000);
            if (limited) set("winding_resistance_ohm", 0, 1.5);
            if (limited && kind % 2) set_integer("motor_circuit", 1, LACONIC_MOTOR_SHORTED);
            initialise();
            OK(fmi2EnterContinuousTimeMode(c));
            for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, kind % 2 && k == 1 ? 0 : 3 - 1.3 * k);
            for (int k = 0; k < 10; k++) state[k] = 0.3 * k - 0.7;
            OK(fmi2SetContinuousStates(c, state, 10));
            read_shown(values[limited]);
            OK(fmi2GetDerivatives(c, rate[limited], 10));
            OK(fmi2SetContinuousStates(c, state, 10)); /* the torque first */
            TEST_ASSERT_TRUE(get("wheel_torque_Nm", 1) == values[limited][12]);
        }
        for (int k = 0; k < 10; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, rate[0][k], rate[1][k]);
        for (int k = 0; k < SHOWN; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, values[0][k], values[1][k]);
        TEST_ASSERT_TRUE(rate[0][0] != 0 && values[0][18] != 0);
    }
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

/* Counts have no place beside their own. */
static void sixteen_encoders_leave_rates_as_they_are(void) {
    with_sixteen_wheels();
    set("step_s", 0, 0.05);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    for (uint32_t k = 1; k <= 16; k++) set_integer("encoder_counts_per_turn", k, 4096);
    initialise();
    for (uint32_t k = 1; k <= 16; k++) set("voltage_V", k, 6);
    OK(fmi2DoStep(c, 0, 0.5, fmi2True));
    const double rate = get("der(wheel_speed_rad_per_s)", 1);
    TEST_ASSERT_TRUE(rate != 0 && get("encoder_count", 1) != 0 && get("encoder_count", 16) != 0);
    TEST_ASSERT_TRUE(get("der(wheel_speed_rad_per_s)", 1) == rate);
}

/* One count a turn, which is little, and an encoder all the same. */
static void an_encoder_counts_turns(void) {
    set("step_s", 0, 0.05);
    set("friction_coefficient", 0, 0);
    set_integer("encoder_counts_per_turn", 2, 1);
    initialise();
    set("voltage_V", 2, 12);
    for (int n = 0; n < 100; n++) OK(fmi2DoStep(c, n, 1, fmi2True));
    const double turns = get("wheel_angle_rad", 2) / (2 * 3.14159265358979);
    TEST_ASSERT_TRUE(turns > 2);
    TEST_ASSERT_DOUBLE_WITHIN(1, turns, get("encoder_count", 2));
}

/* Also in an instance that has shown other numbers before: with encoders alone, and without sensors. */
static void without_an_imu_its_outputs_are_zero(void) {
    for (int encoders = 0; encoders < 2; encoders++) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.05);
        if (encoders) set_integer("encoder_counts_per_turn", 1, 4096);
        initialise();
        OK(fmi2DoStep(c, 0, 0.1, fmi2True));
        laconic_sensor_outputs *shown_before = &instance()->model.sensed;
        shown_before->imu_acceleration_m_per_s2[0] = shown_before->imu_acceleration_m_per_s2[1] = 3;
        shown_before->imu_yaw_rate_rad_per_s = 3;
        for (uint32_t k = 1; k <= 2; k++) TEST_ASSERT_TRUE(get("imu_acceleration_m_per_s2", k) == 0);
        TEST_ASSERT_TRUE(get("imu_yaw_rate_rad_per_s", 0) == 0);
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
    RUN_TEST(sixteen_wheels_with_limits_are_sixteen_without);
    RUN_TEST(the_last_of_sixteen_wheels_follows_a_slope);
    RUN_TEST(a_drive_within_its_limits_is_one_without);
    RUN_TEST(the_acceleration_on_ground_with_friction_is_that_of_the_rates);
    RUN_TEST(a_single_wheel_slips_too);
    RUN_TEST(wheels_that_are_not_there_have_no_sensors);
    RUN_TEST(sixteen_encoders_leave_rates_as_they_are);
    RUN_TEST(an_encoder_counts_turns);
    RUN_TEST(without_an_imu_its_outputs_are_zero);
    RUN_TEST(sensors_watch_steps_with_slopes);
    return UNITY_END();
}
