/* Tests of what stands beside the vehicle's plain motion: ground with friction and limits of a drive in both kinds of
 * FMU, sensors, and the warnings of a run. The core's plant, stepped beside the FMU, says what is right. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

static void ground_with_friction(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    set("ground_roller_drag", 0, 0.2);
    set("ground_axle_friction_Nm", 0, 0.01);
    set("supply_V", 0, 12);
    set("supply_resistance_ohm", 0, 0.1);
    set("winding_resistance_ohm", 0, 1.5);
}

static const double volts[4] = {14, -3, 6, 9};

static void apply(laconic_input *held) {
    memset(held, 0, sizeof *held);
    for (uint32_t k = 1; k <= 4; k++) {
        set("voltage_V", k, volts[k - 1]);
        held->voltage_V[k - 1] = volts[k - 1];
    }
}

/* The same vehicle by the core alone. */
static laconic_plant twin_of(double step_s) {
    laconic_plant twin;
    const fmu_model *model = &instance()->model;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&twin, &model->vehicle, laconic_method_by_number(model->method),
                                                      step_s, &model->start, NULL));
    return twin;
}

/* -------------------------------------------------------------------------------------- friction -- */

static void outputs_with_friction_are_those_of_the_core(void) {
    laconic_input held;
    laconic_outputs now;
    ground_with_friction();
    initialise();
    laconic_plant twin = twin_of(0.01);
    apply(&held);
    set("body_force_N", 1, held.body_force_N[0] = 2);
    for (int k = 0; k < 40; k++) OK(fmi2DoStep(c, k * 0.01, 0.01, fmi2True));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_run(&twin, &held, 40, NULL));
    laconic_outputs_of(&now, &twin, &held);
    laconic_plant_reactions(&now.reactions, &twin, NULL, &held);
    bool any_slips = false, any_limit = false;
    for (uint32_t k = 0; k < 4; k++) {
        TEST_ASSERT_TRUE(get("wheel_speed_rad_per_s", k + 1) == now.wheel_speed_rad_per_s[k]);
        TEST_ASSERT_TRUE(get("wheel_angle_rad", k + 1) == now.wheel_angle_rad[k]);
        TEST_ASSERT_TRUE(get("wheel_torque_Nm", k + 1) == now.wheel_torque_Nm[k]);
        TEST_ASSERT_TRUE(get("wheel_reaction_N", k + 1) == now.reactions.along_N[k]);
        TEST_ASSERT_TRUE(get("slip_along_m_per_s", k + 1) == now.friction.slip_along_m_per_s[k]);
        TEST_ASSERT_TRUE(get("slip_across_m_per_s", k + 1) == now.friction.slip_across_m_per_s[k]);
        TEST_ASSERT_TRUE(get("contact_state", k + 1) == now.friction.contact_state[k]);
        TEST_ASSERT_TRUE(get("drive_limit", k + 1) == now.friction.drive_limit[k]);
        TEST_ASSERT_TRUE(get("motor_current_A", k + 1) == now.friction.motor_current_A[k]);
        any_slips = any_slips || now.friction.contact_state[k] > 0;
        any_limit = any_limit || now.friction.drive_limit[k] > 0;
    }
    TEST_ASSERT_TRUE(any_slips && any_limit);
    TEST_ASSERT_TRUE(get("energy_J", 0) == now.energy_J && now.energy_J > 0);
    TEST_ASSERT_TRUE(get("supply_current_A", 0) == now.friction.supply_current_A);
    TEST_ASSERT_TRUE(get("supply_voltage_V", 0) == now.friction.supply_voltage_V);
    TEST_ASSERT_TRUE(get("supply_energy_J", 0) == now.friction.supply_energy_J);
    TEST_ASSERT_TRUE(get("outer_work_J", 0) == now.friction.outer_work_J && now.friction.outer_work_J != 0);
    TEST_ASSERT_TRUE(get("slip_loss_J", 0) == now.friction.slip_loss_J && now.friction.slip_loss_J > 0);
    TEST_ASSERT_TRUE(get("axle_loss_J", 0) == now.friction.axle_loss_J);
    TEST_ASSERT_TRUE(get("motor_loss_J", 0) == now.friction.motor_loss_J);
    TEST_ASSERT_TRUE(get("supply_loss_J", 0) == now.friction.supply_loss_J && now.friction.supply_loss_J > 0);
    TEST_ASSERT_TRUE(get("numerical_loss_J", 0) == now.friction.numerical_loss_J);
}

/* Each output by itself, so that no other one has made it fresh. */
static void an_output_with_friction_is_fresh_whichever_is_read_first(void) {
    laconic_input held;
    laconic_outputs now;
    ground_with_friction();
    initialise();
    laconic_plant twin = twin_of(0.01);
    apply(&held);
    for (int n = 0; n < 6; n++) {
        OK(fmi2DoStep(c, n * 0.01, 0.01, fmi2True));
        TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_run(&twin, &held, 1, NULL));
        laconic_outputs_of(&now, &twin, &held);
        laconic_plant_reactions(&now.reactions, &twin, NULL, &held);
        if (n == 0) TEST_ASSERT_TRUE(get("wheel_torque_Nm", 1) == now.wheel_torque_Nm[0]);
        if (n == 1) TEST_ASSERT_TRUE(get("wheel_speed_rad_per_s", 1) == now.wheel_speed_rad_per_s[0]);
        if (n == 2) TEST_ASSERT_TRUE(get("wheel_angle_rad", 1) == now.wheel_angle_rad[0]);
        if (n == 3) TEST_ASSERT_TRUE(get("energy_J", 0) == now.energy_J);
        if (n == 4) TEST_ASSERT_TRUE(get("wheel_reaction_N", 1) == now.reactions.along_N[0]);
        if (n == 5) TEST_ASSERT_TRUE(get("slip_loss_J", 0) == now.friction.slip_loss_J);
    }
}

static void a_state_with_friction_is_taken_up_again(void) {
    static fmi2Byte bytes[65536];
    laconic_input held;
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    ground_with_friction();
    set_flag("has_imu", 0);
    set_integer("encoder_counts_per_turn", 1, 4096);
    initialise();
    apply(&held);
    OK(fmi2DoStep(c, 0, 0.1, fmi2True));
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    TEST_ASSERT_TRUE(size < sizeof bytes);
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(fmi2FreeFMUstate(c, &kept));
    OK(fmi2DoStep(c, 0.1, 0.1, fmi2True));
    const double x = get("x_m", 0), loss = get("slip_loss_J", 0), felt = get("imu_acceleration_m_per_s2", 1);
    const double count = get("encoder_count", 1);
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &kept));
    OK(fmi2SetFMUstate(c, kept));
    OK(fmi2FreeFMUstate(c, &kept));
    OK(fmi2DoStep(c, 0.1, 0.1, fmi2True));
    TEST_ASSERT_TRUE(get("x_m", 0) == x && get("slip_loss_J", 0) == loss);
    TEST_ASSERT_TRUE(get("imu_acceleration_m_per_s2", 1) == felt && get("encoder_count", 1) == count);
    TEST_ASSERT_TRUE(count != 0);
}

/* What a scene with [ground] makes of the FMU: wheel speeds are states. */
static void with_drag_and_wheel_states(void) {
    make(fmi2ModelExchange);
    ground_with_friction();
    fmu_model_made(&instance()->model);
}

static void model_exchange_takes_friction_where_it_has_states_for_it(void) {
    make(fmi2ModelExchange);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    ASSERT_REFUSED(initialise_refused(), "has no states for wheels that slip");
    with_drag_and_wheel_states();
    set("ground_friction_coefficient", 0, 0);
    set("ground_roller_drag", 0, 0);
    set("ground_axle_friction_Nm", 0, 0);
    ASSERT_REFUSED(initialise_refused(), "has states for wheels that slip; give a value above 0");
}

#define SLIP_STATES (6 + 2 * 4)

static void rates_of_wheels_that_slip_are_those_of_the_smooth_law(void) {
    double state[SLIP_STATES], rate[SLIP_STATES], back[SLIP_STATES], wheel_rate[LACONIC_MAX_WHEELS];
    laconic_input held;
    laconic_rates rates;
    with_drag_and_wheel_states();
    set_flag("wheel_locked", 4);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    apply(&held);
    for (int k = 0; k < 4; k++) instance()->model.plant.slip.wheel_angle_rad[k].rest = 1; /* of steps before */
    for (int k = 0; k < SLIP_STATES; k++) state[k] = k < 6 ? 0.2 * k - 0.3 : 0.7 * k - 6;
    OK(fmi2SetContinuousStates(c, state, SLIP_STATES));
    OK(fmi2GetContinuousStates(c, back, SLIP_STATES));
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, state[11], back[11]);
    OK(fmi2GetDerivatives(c, rate, SLIP_STATES));
    const laconic_plant twin = twin_of(1);
    double speed[4] = {state[10], state[11], state[12], 0}; /* the last is braked */
    laconic_friction_derivative(&rates, wheel_rate, &twin.friction, &twin.model, state, state[5], speed, &held);
    for (int k = 0; k < 3; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, rates.nu_rad_per_s2[k], rate[k]);
    for (int k = 0; k < 4; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, wheel_rate[k], rate[10 + k]);
    TEST_ASSERT_TRUE(get("supply_current_A", 0) != 0);
    for (int k = 0; k < 4; k++) { /* what the plant got: a brake holds its wheel */
        TEST_ASSERT_TRUE(instance()->model.plant.slip.wheel_speed_rad_per_s[k] == speed[k]);
        TEST_ASSERT_TRUE(instance()->model.plant.slip.wheel_angle_rad[k].value == state[6 + k]);
        TEST_ASSERT_TRUE(instance()->model.plant.slip.wheel_angle_rad[k].rest == 0);
    }
    TEST_ASSERT_TRUE(isfinite(get("acceleration_body_m_per_s2", 1)));
    TEST_ASSERT_TRUE(get("wheel_reaction_N", 1) != 0);
}

/* A contact slips above the width of the law; under so high a centre of mass that the vehicle would tilt, some lift. */
static void contacts_by_the_smooth_law_slip_or_lift(void) {
    double state[SLIP_STATES];
    for (int k = 0; k < SLIP_STATES; k++) state[k] = k < 6 ? 0.2 * k - 0.3 : 0.7 * k - 6;
    for (int high = 0; high < 2; high++) {
        int of_state[3] = {0};
        with_drag_and_wheel_states();
        set("com_z_m", 0, high ? 5 : 0.01);
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        OK(fmi2SetContinuousStates(c, state, SLIP_STATES));
        for (uint32_t k = 1; k <= 4; k++) of_state[(int)get("contact_state", k)]++;
        TEST_ASSERT_EQUAL_INT(high ? 1 : 0, of_state[2] > 0);
        TEST_ASSERT_TRUE(high || of_state[1] > 0);
    }
}

/* A drive with limits on ideal ground: wheels roll, and their torques are those of the limited motors. */
static void a_limited_drive_on_ideal_ground_rolls(void) {
    double state[10], rate[10], free_rate[10];
    laconic_input held;
    for (int limited = 1; limited >= 0; limited--) {
        make(fmi2ModelExchange);
        if (limited) set("supply_V", 0, 6);
        if (limited) set("winding_resistance_ohm", 0, 1.5);
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        apply(&held);
        for (int k = 0; k < 10; k++) state[k] = 0;
        OK(fmi2SetContinuousStates(c, state, 10));
        OK(fmi2GetDerivatives(c, limited ? rate : free_rate, 10));
        if (!limited) continue;
        TEST_ASSERT_TRUE(get("drive_limit", 1) == (double)LACONIC_LIMIT_VOLTAGE && get("drive_limit", 2) == 0);
        TEST_ASSERT_TRUE(get("wheel_reaction_N", 1) != 0 && get("motor_current_A", 1) > 0);
        OK(fmi2GetContinuousStates(c, state, 10));
    }
    double less = 0, more = 0;
    for (int k = 0; k < 3; k++) {
        less += rate[k] * rate[k];
        more += free_rate[k] * free_rate[k];
    }
    TEST_ASSERT_TRUE(less > 0 && less < more);
}

/* --------------------------------------------------------------------------------------- sensors -- */

static void sensors_show_what_the_core_s_show(void) {
    laconic_input held;
    laconic_sensors sensors;
    laconic_sensor_outputs now;
    set("step_s", 0, 0.01);
    set_flag("has_imu", 0);
    set("imu_x_m", 0, 0.1);
    set("imu_yaw_rate_bias_rad_per_s", 0, 0.02);
    set_integer("encoder_counts_per_turn", 2, 4096);
    set_integer("encoder_wrap", 0, 1000);
    initialise();
    laconic_plant twin = twin_of(0.01);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&sensors, &instance()->model.sensor_settings, &twin, NULL));
    apply(&held);
    OK(fmi2DoStep(c, 0, 0.2, fmi2True));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_run(&sensors, &twin, &held, 20, NULL));
    laconic_sensors_read(&now, &sensors, &twin, &held);
    for (uint32_t k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(get("acceleration_body_m_per_s2", k + 1) == now.acceleration_body_m_per_s2[k]);
        TEST_ASSERT_TRUE(get("imu_acceleration_m_per_s2", k + 1) == now.imu_acceleration_m_per_s2[k]);
    }
    TEST_ASSERT_TRUE(get("imu_yaw_rate_rad_per_s", 0) == now.imu_yaw_rate_rad_per_s);
    for (uint32_t k = 0; k < 4; k++) TEST_ASSERT_TRUE(get("encoder_count", k + 1) == now.encoder_count[k]);
    TEST_ASSERT_TRUE(get("encoder_count", 2) != 0 && get("encoder_count", 1) == 0);
}

static void sensors_that_cannot_be_are_refused(void) {
    set_integer("encoder_wrap", 0, 1);
    ASSERT_REFUSED(initialise_refused(), "encoder_wrap: a counter of 1 value shows nothing");
    make(fmi2ModelExchange);
    set_flag("has_imu", 0);
    ASSERT_REFUSED(initialise_refused(), "sensors sample at internal steps, which Model Exchange does not have");
    make(fmi2CoSimulation);
    set_flag("has_imu", 0);
    set("imu_x_m", 0, 1e300);
    ASSERT_REFUSED(initialise_refused(), "this vehicle cannot start: ");
}

/* An encoder that leaves its range ends the step, which is taken back. */
static void a_step_that_a_sensor_cannot_follow_is_taken_back(void) {
    laconic_input held;
    set("step_s", 0, 0.01);
    set_integer("encoder_counts_per_turn", 1, 2000000000);
    set("encoder_gear_ratio", 1, 1e9);
    initialise();
    apply(&held);
    log_clear();
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2DoStep(c, 0, 0.05, fmi2True));
    ASSERT_LOGGED("is refused: ");
    TEST_ASSERT_TRUE(get("x_m", 0) == 0 && get("wheel_angle_rad", 1) == 0);
}

/* -------------------------------------------------------------------------------------- warnings -- */

/* Also what friction has added: losses, and the wheels' own speeds. Of a sudden the encoder turns too fast. */
static void with_friction_too_all_is_taken_back(void) {
    laconic_input held;
    ground_with_friction();
    set_integer("encoder_counts_per_turn", 1, 4096);
    initialise();
    apply(&held);
    OK(fmi2DoStep(c, 0, 0.1, fmi2True));
    const int64_t count = instance()->model.sensors.encoder[0].count;
    instance()->model.sensors.settings.encoder[0].gear_ratio = 1e12;
    const laconic_slip before = instance()->model.plant.slip;
    for (int several = 0; several < 2; several++) {
        TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2DoStep(c, 0.1, several ? 0.03 : 0.01, fmi2True));
        TEST_ASSERT_EQUAL_MEMORY(&before, &instance()->model.plant.slip, sizeof before);
        TEST_ASSERT_EQUAL_UINT64(10, instance()->model.plant.steps);
        TEST_ASSERT_TRUE(get("slip_loss_J", 0) == before.slip_loss_J.value && before.slip_loss_J.value > 0);
        TEST_ASSERT_TRUE(instance()->model.sensors.encoder[0].count == count);
    }
}

static void a_wheel_without_grip_is_told_once(void) {
    laconic_input held;
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0.02);
    set("com_z_m", 0, 0.1);
    initialise();
    apply(&held);
    log_clear();
    OK(fmi2DoStep(c, 0, 0.05, fmi2True));
    ASSERT_LOGGED("N of grip and has");
    log_clear();
    OK(fmi2DoStep(c, 0.05, 0.05, fmi2True));
    TEST_ASSERT_EQUAL_INT(0, lines);
}

static void a_wheel_that_lifts_is_told_in_either_kind(void) {
    double state[10] = {0};
    for (int kind = 0; kind < 2; kind++) {
        make(kind == 0 ? fmi2CoSimulation : fmi2ModelExchange);
        if (kind == 0) set("step_s", 0, 0.01);
        set("com_z_m", 0, 0.5);
        set("friction_coefficient", 0, 100);
        initialise();
        log_clear();
        if (kind == 0) {
            set("body_force_N", 1, 2000);
            OK(fmi2DoStep(c, 0, 0.02, fmi2True));
        } else {
            OK(fmi2EnterContinuousTimeMode(c));
            set("body_force_N", 1, 2000);
            OK(fmi2SetContinuousStates(c, state, 10));
            OK(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL));
        }
        ASSERT_LOGGED("lifts: its normal load would be");
        ASSERT_LOGGED("the model keeps all wheels on the ground");
    }
}

static void with_friction_a_wheel_that_lifts_carries_nothing(void) {
    ground_with_friction();
    set("com_z_m", 0, 5);
    for (uint32_t k = 1; k <= 4; k++) set_flag("wheel_locked", k);
    initialise();
    log_clear();
    set("body_force_N", 1, 2000);
    for (int k = 0; k < 10; k++) OK(fmi2DoStep(c, 0.01 * k, 0.01, fmi2True));
    ASSERT_LOGGED("it carries nothing, the others share its load");
}

static void forces_beyond_the_range_are_told(void) {
    set("step_s", 0, 0.01);
    set("com_z_m", 0, 0.5);
    set("friction_coefficient", 0, 0.5);
    initialise();
    log_clear();
    set("body_force_N", 1, 1e308);
    set("body_force_N", 2, 1e308);
    const fmi2Status status = fmi2DoStep(c, 0, 0.01, fmi2True);
    TEST_ASSERT_TRUE(status == fmi2Discard || strstr(logged, "leave the range of double precision") != NULL);
}

static void slopes_of_inputs_are_watched_as_the_inputs_are(void) {
    laconic_input held;
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    const double slope = 20;
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0.02);
    set("com_z_m", 0, 0.1);
    set_flag("has_imu", 0);
    initialise();
    apply(&held);
    OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
    log_clear();
    OK(fmi2DoStep(c, 0, 0.05, fmi2True));
    ASSERT_LOGGED("N of grip and has");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, volts[0] + 0.05 * slope, get("voltage_V", 1));
}

static void a_voltage_for_a_wheel_without_a_motor_is_told_once(void) {
    set("step_s", 0, 0.01);
    set_flag("wheel_undriven", 2);
    initialise();
    log_clear();
    instance()->model.input.voltage_V[4] = 5; /* of a wheel that is not there */
    set("voltage_V", 1, 5);
    TEST_ASSERT_EQUAL_INT(0, lines);
    set("voltage_V", 2, 5);
    ASSERT_LOGGED("voltage_V[2]: 5 V has no effect: wheel 2 has no motor");
    log_clear();
    set("voltage_V", 2, 6);
    TEST_ASSERT_EQUAL_INT(0, lines);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(outputs_with_friction_are_those_of_the_core);
    RUN_TEST(an_output_with_friction_is_fresh_whichever_is_read_first);
    RUN_TEST(a_state_with_friction_is_taken_up_again);
    RUN_TEST(model_exchange_takes_friction_where_it_has_states_for_it);
    RUN_TEST(rates_of_wheels_that_slip_are_those_of_the_smooth_law);
    RUN_TEST(contacts_by_the_smooth_law_slip_or_lift);
    RUN_TEST(a_limited_drive_on_ideal_ground_rolls);
    RUN_TEST(sensors_show_what_the_core_s_show);
    RUN_TEST(sensors_that_cannot_be_are_refused);
    RUN_TEST(a_step_that_a_sensor_cannot_follow_is_taken_back);
    RUN_TEST(with_friction_too_all_is_taken_back);
    RUN_TEST(a_wheel_without_grip_is_told_once);
    RUN_TEST(a_wheel_that_lifts_is_told_in_either_kind);
    RUN_TEST(with_friction_a_wheel_that_lifts_carries_nothing);
    RUN_TEST(forces_beyond_the_range_are_told);
    RUN_TEST(slopes_of_inputs_are_watched_as_the_inputs_are);
    RUN_TEST(a_voltage_for_a_wheel_without_a_motor_is_told_once);
    return UNITY_END();
}
