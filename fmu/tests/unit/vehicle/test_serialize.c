/* Tests of vehicle/serialize.c: bytes of states that could not be, and states of Model Exchange with what follows. */
#include "saved_bench.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

#define FILL_REAL(number) FILL(number)
#define FILL_INTEGER(number) (number) = (int32_t)(filled += 1)
#define FILL_ABSENCE(flag) (flag) = true
#define FILL_FLAG(flag) (flag) = true
#define FILL_WHEEL_KIND(kind) (kind) = LACONIC_WHEEL_FIXED
#define FILL_FIELD(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) FILL_##KIND((of).member);
#define FILL_OWN(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) FILL_##KIND((of).own_##member);

/* The importer's vehicle, which is not prepared before the next start. */
static void fill_vehicle(laconic_vehicle *v) {
    LACONIC_VEHICLE_FIELDS(FILL_FIELD, *v)
    LACONIC_PAYLOAD_FIELDS(FILL_FIELD, v->payload)
    LACONIC_GROUND_FIELDS(FILL_FIELD, v->ground)
    LACONIC_DRIVE_FIELDS(FILL_FIELD, v->drive)
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_FIELDS(FILL_FIELD, v->wheel[i])
        LACONIC_OWN_WHEEL_FIELDS(FILL_OWN, v->wheel[i])
    }
    v->support_count = 3;
    for (int32_t i = 0; i < LACONIC_MAX_SUPPORTS; i++) {
        LACONIC_SUPPORT_FIELDS(FILL_FIELD, v->support[i])
    }
}

static void fill_settings(laconic_sensor_settings *settings) {
    LACONIC_IMU_FIELDS(FILL_FIELD, settings->imu)
    settings->encoder_wrap = 77;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_ENCODER_FIELDS(FILL_FIELD, settings->encoder[i])
    }
}

/* Compares of bytes see gaps between members, too, which a start may leave as the stack had them. */
static void clear_gaps(laconic_encoder_settings settings[LACONIC_MAX_WHEELS]) {
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        const laconic_encoder_settings kept = settings[i];
        memset(&settings[i], 0, sizeof settings[i]);
        settings[i].counts_per_turn = kept.counts_per_turn;
        settings[i].gear_ratio = kept.gear_ratio;
    }
}

static void fill_sensors(laconic_sensors *sensors) {
    clear_gaps(sensors->settings.encoder);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        sensors->encoder[i].count = -5000000000 - i;
        FILL(sensors->encoder[i].rest);
    }
    FILL(sensors->acceleration_m_per_s2);
    sensors->newest = 0x123456789ABCDEFU;
    FILL(sensors->sample);
}

static void fill_clock(fmu_clock *clock) {
    FILL(clock->start_s);
    FILL(clock->stop_s);
    clock->stop_defined = true;
    FILL(clock->anchor_s);
    FILL(clock->anchor_rest_s);
    FILL(clock->step_s);
    FILL(clock->communication_s);
    FILL(clock->completed_s);
    clock->ticks = 0xABCDEF0123456789U;
    clock->communication_ticks = 0x1122334455667788U;
}

/* Ground with friction, sensors and a drive with limits: everything is there. */
static void every_member_comes_back_in_another_instance(void) {
    fmu_model *model = &instance()->model;
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    set_flag("has_imu", 0);
    set_integer("encoder_counts_per_turn", 1, 4096);
    initialise();
    OK(step(0, 0.1));
    fill_vehicle(&model->vehicle);
    fill_settings(&model->sensor_settings);
    FILL(model->start);
    FILL(model->input);
    FILL(model->slope);
    FILL(model->time_s);
    FILL(model->step_s);
    model->method = 5;
    model->sloped = model->change_needed = model->states_changed = true;
    fill_state(&model->plant.state);
    fill_slip(&model->plant.slip);
    model->plant.steps = 0x1020304050607080U;
    fill_sensors(&model->sensors);
    fill_clock(&instance()->clock);
    TEST_ASSERT_EQUAL_size_t(9320 + VEHICLE_BYTES, write()); /* another size is another STATE_VERSION */
    const fmu_clock clock = instance()->clock;
    const fmu_model before = *model;
    into_another(fmi2CoSimulation);
    const fmu_model *after = &instance()->model;
    TEST_ASSERT_EQUAL_MEMORY(&clock, &instance()->clock, sizeof clock);
    COMES_BACK(vehicle);
    COMES_BACK(sensor_settings);
    COMES_BACK(start);
    COMES_BACK(input);
    COMES_BACK(slope);
    COMES_BACK(time_s);
    COMES_BACK(step_s);
    COMES_BACK(method);
    COMES_BACK(start_needed);
    COMES_BACK(change_needed);
    COMES_BACK(states_changed);
    COMES_BACK(continuous);
    COMES_BACK(stand_in);
    COMES_BACK(wheels_have_states);
    COMES_BACK(idle_wheels);
    COMES_BACK(watched);
    COMES_BACK(has_imu);
    COMES_BACK(sloped);
    COMES_BACK(plant);
    COMES_BACK(sensors);
    COMES_BACK(contact);
}

/* Until a step is known the integrator is prepared for another method, and keeps its own. */
static void a_state_before_the_first_step_keeps_its_method(void) {
    set_integer("method", 0, 1);
    set_flag("wheel_undriven", 2);
    initialise();
    const fmu_model before = instance()->model;
    into_another(fmi2CoSimulation);
    const fmu_model *after = &instance()->model;
    COMES_BACK(plant.model);
    COMES_BACK(plant.integrator);
    COMES_BACK(plant.state);
    COMES_BACK(stand_in);
    COMES_BACK(idle_wheels);
    TEST_ASSERT_TRUE(before.stand_in && before.idle_wheels && after->stale == (FMU_GROUPS_ALL & ~FMU_GROUP_STATE));
    ASSERT_DISCARDED(step(0, 100), "is unstable with this method");
}

/* Members as no run leaves them, in bytes with a right checksum. */
static void what_cannot_be_prepared_again_is_no_state(void) {
    fmu_model *model = &instance()->model;
    set("step_s", 0, 0.01);
    set_integer("encoder_counts_per_turn", 1, 4096);
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    OK(read(write()));
    const fmu_model good = *model;
#define WRONG(member, value) \
    do { \
        model->member = (value); \
        ASSERT_REFUSED(read(write()), "are no possible state"); \
        *model = good; \
    } while (0)
    WRONG(plant.vehicle.mass_kg, 0);
    WRONG(plant.vehicle.wheel[1].roller_rad, 0);
    WRONG(plant.vehicle.drive.winding_resistance_ohm, -1);
    WRONG(plant.vehicle.com_z_m, -1);
    model->plant.vehicle.com_z_m = 1e154; /* each in its range, but not both */
    WRONG(plant.vehicle.friction_coefficient, 1e154);
    model->plant.vehicle.drive.supply_V = 1e154;
    WRONG(plant.vehicle.drive.supply_resistance_ohm, 1e154);
    WRONG(plant.integrator.step_s, NOT_A_NUMBER);
    WRONG(vehicle.wheel_count, 3);
    WRONG(sensors.settings.encoder_wrap, -1);
    WRONG(plant.slip.limit[0], 77);
    WRONG(plant.state.heading.rest, 1.005);
    WRONG(plant.state.heading.rest, -1.005);
    WRONG(plant.state.heading.rest, NOT_A_NUMBER);
    for (int side = -1; side <= 1; side += 2) {
        model->plant.state.heading.rest = side;
        OK(read(write()));
        TEST_ASSERT_TRUE(model->plant.state.heading.rest == side);
    }
    *model = good;
    OK(read(write()));
}

/* The method is a number in the bytes, which differ by it alone. */
static void a_method_that_is_none_is_no_state(void) {
    static fmi2Byte others[sizeof bytes];
    fmu_model *model = &instance()->model;
    size_t at = 0, differ = 0;
    model->plant.integrator.method = laconic_method_by_number(1);
    const size_t size = write();
    memcpy(others, bytes, size);
    model->plant.integrator.method = laconic_method_by_number(2);
    TEST_ASSERT_EQUAL_size_t(size, write());
    for (size_t k = 0; k < size - 8; k++)
        if (bytes[k] != others[k]) differ++, at = k;
    TEST_ASSERT_TRUE(differ == 1 && bytes[at] == 2);
    for (int number = LACONIC_METHOD_COUNT - 1; number <= LACONIC_METHOD_COUNT; number++) {
        bytes[at] = (fmi2Byte)number;
        const uint32_t checksum = fmu_checksum((const uint8_t *)bytes, size - 8);
        for (size_t k = 0; k < 4; k++) bytes[size - 8 + k] = (fmi2Byte)(checksum >> (8 * k));
        if (number < LACONIC_METHOD_COUNT)
            OK(read(size));
        else
            ASSERT_REFUSED(read(size), "are no possible state");
    }
}

/* Before the model is started, what is in the plant does not count. */
static void a_state_from_before_the_start_is_no_plant(void) {
    instance()->model.plant.vehicle.mass_kg = 0;
    OK(read(write()));
    OK(fmi2EnterInitializationMode(c));
    set("mass_kg", 0, 3);
    OK(fmi2ExitInitializationMode(c));
}

/* Parameters were set after the model had started: it starts anew, and what was read is written as it was. */
static void a_state_that_must_be_started_anew_comes_back(void) {
    static fmi2Byte first[sizeof bytes];
    set_integer("method", 0, 1);
    set("step_s", 0, 0.01);
    OK(fmi2EnterInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 0);
    set("start_x_m", 0, 3);
    const size_t size = write();
    memcpy(first, bytes, size);
    make(fmi2CoSimulation);
    OK(read(size));
    TEST_ASSERT_TRUE(instance()->model.start_needed);
    TEST_ASSERT_EQUAL_size_t(size, write());
    TEST_ASSERT_EQUAL_MEMORY(first, bytes, size);
    OK(fmi2ExitInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 3);
}

/* The plant that reads may have friction, and the one that was written none. */
static void a_state_from_before_the_ground_got_friction_has_none(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    initialise();
    set("voltage_V", 1, 6);
    OK(step(0, 0.1));
    const size_t size = write();
    OK(step(0.1, 0.1));
    const double x = get("x_m", 0);
    OK(read(size));
    set("ground_friction_coefficient", 0, 0.01);
    OK(step(0.1, 0.1));
    TEST_ASSERT_TRUE(instance()->model.plant.friction.acts && get("x_m", 0) != x);
    OK(read(size));
    TEST_ASSERT_FALSE(instance()->model.plant.friction.acts);
    OK(step(0.1, 0.1));
    TEST_ASSERT_TRUE(get("x_m", 0) == x);
}

/* As they are after the start and after a change, which nobody has read. */
static void states_of_model_exchange_are_kept_though_nobody_has_read_them(void) {
    double state[10];
    for (int changed = 0; changed < 2; changed++) {
        fmi2EventInfo info;
        make(fmi2ModelExchange);
        set("start_nu_rad_per_s", 1, 2);
        set("start_x_m", 0, 3);
        set("start_heading_rad", 0, 0.5);
        initialise();
        if (changed) set("payload_mass_kg", 0, 4);
        if (changed) set("payload_x_m", 0, 0.3);
        OK(fmi2NewDiscreteStates(c, &info));
        into_another(fmi2ModelExchange);
        OK(fmi2GetContinuousStates(c, state, 10));
        TEST_ASSERT_TRUE(fabs(state[0] - 2) < 1e-13 && fabs(state[5] - 0.5) < 1e-15);
        TEST_ASSERT_TRUE(changed ? state[3] > 3.03 && state[4] > 0.02 : state[3] == 3 && state[4] == 0);
    }
}

/* States that were set and are not followed yet, and such that are: neither is rounded by the way through the plant. */
static void states_of_model_exchange_come_back_to_the_last_bit(void) {
    double state[10], again[10];
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int n = 0; n < 60; n++) {
        for (int k = 0; k < 10; k++) state[k] = again[k] = sin(n + 0.7 * k) * (1 + k) / 3;
        OK(fmi2SetContinuousStates(c, state, 10));
        if (n % 2) (void)get("energy_J", 0);
        const size_t size = write();
        for (int k = 0; k < 10; k++) again[k] = -1;
        OK(fmi2SetContinuousStates(c, again, 10));
        OK(read(size));
        OK(fmi2GetContinuousStates(c, again, 10));
        TEST_ASSERT_EQUAL_MEMORY(state, again, sizeof state);
    }
}

static void states_of_model_exchange_are_taken_up_with_what_follows_from_them(void) {
    double state[14], rate[14], again[14];
    for (int friction = 0; friction < 2; friction++) {
        const size_t count = friction ? 14 : 10;
        make(fmi2ModelExchange);
        if (friction) with_wheel_states();
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        for (size_t k = 0; k < count; k++) state[k] = 0.2 * (double)k - 0.7;
        for (int read_first = 0; read_first < 2; read_first++) {
            OK(fmi2SetContinuousStates(c, state, count));
            if (read_first) (void)get("energy_J", 0); /* then the plant's state follows already */
            const size_t size = write();
            OK(fmi2GetDerivatives(c, rate, count));
            const double energy = get("energy_J", 0);
            for (size_t k = 0; k < count; k++) again[k] = -1;
            OK(fmi2SetContinuousStates(c, again, count));
            OK(read(size));
            OK(fmi2GetDerivatives(c, again, count));
            for (size_t k = 0; k < count; k++) TEST_ASSERT_TRUE(rate[k] == again[k]);
            TEST_ASSERT_TRUE(get("energy_J", 0) == energy && energy > 0);
            OK(fmi2GetContinuousStates(c, again, count));
            for (size_t k = 3; k < count; k++) TEST_ASSERT_TRUE(again[k] == state[k]);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_member_comes_back_in_another_instance);
    RUN_TEST(a_state_before_the_first_step_keeps_its_method);
    RUN_TEST(what_cannot_be_prepared_again_is_no_state);
    RUN_TEST(a_method_that_is_none_is_no_state);
    RUN_TEST(a_state_from_before_the_start_is_no_plant);
    RUN_TEST(a_state_that_must_be_started_anew_comes_back);
    RUN_TEST(a_state_from_before_the_ground_got_friction_has_none);
    RUN_TEST(states_of_model_exchange_are_kept_though_nobody_has_read_them);
    RUN_TEST(states_of_model_exchange_come_back_to_the_last_bit);
    RUN_TEST(states_of_model_exchange_are_taken_up_with_what_follows_from_them);
    return UNITY_END();
}
