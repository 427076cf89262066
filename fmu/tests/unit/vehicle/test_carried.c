/* Tests of what is carried on: by a change of the vehicle in a run, by states that are set one by one, and by a
 * communication step that is taken back. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* ------------------------------------------------------------------------------------------- changes -- */

static void drive(void) {
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 2.0 * k - 3);
}

/* A payload that moves the centre of mass, where nothing was read before: the body goes on from where it was. */
static void the_body_keeps_place_and_velocity_in_a_change(void) {
    static const char *const kept[] = {"origin_x_m", "origin_y_m", "heading_rad", "yaw_rate_rad_per_s"};
    double before[4];
    for (int read = 1; read >= 0; read--) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.01);
        set("start_x_m", 0, 2);
        set("start_heading_rad", 0, 0.5);
        initialise();
        drive();
        OK(step(0, 0.5));
        for (int k = 0; k < 4 && read; k++) before[k] = get(kept[k], 0);
        set("payload_mass_kg", 0, 3);
        set("payload_x_m", 0, 0.2);
        for (int k = 0; k < 4; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-14, before[k], get(kept[k], 0));
        TEST_ASSERT_TRUE(fabs(before[0] - 2) > 0.01 && fabs(before[3]) > 0.01);
    }
}

static void with_limits(void) {
    set("supply_V", 0, 9);
    set("winding_resistance_ohm", 0, 1.5);
}

/* In Model Exchange the states are then those of the new centre of mass, and rates those of a vehicle that was so from
 * the start; also with a drive that has limits. */
static void model_exchange_goes_on_as_the_changed_vehicle(void) {
    double state[10], rate[2][10];
    for (int limited = 0; limited < 2; limited++) {
        for (int changed = 1; changed >= 0; changed--) {
            fmi2EventInfo info;
            make(fmi2ModelExchange);
            if (limited) with_limits();
            if (!changed) set("payload_mass_kg", 0, 3);
            if (!changed) set("payload_x_m", 0, 0.2);
            initialise();
            OK(fmi2EnterContinuousTimeMode(c));
            drive();
            if (changed) {
                for (int k = 0; k < 10; k++) state[k] = 0.3 * k - 0.7;
                OK(fmi2SetContinuousStates(c, state, 10));
                const double x = get("origin_x_m", 0), y = get("origin_y_m", 0), yaw = get("yaw_rate_rad_per_s", 0);
                OK(fmi2EnterEventMode(c));
                set("payload_mass_kg", 0, 3);
                set("payload_x_m", 0, 0.2);
                OK(fmi2NewDiscreteStates(c, &info));
                TEST_ASSERT_TRUE(info.valuesOfContinuousStatesChanged);
                OK(fmi2GetContinuousStates(c, state, 10));
                TEST_ASSERT_TRUE(fabs(state[3] - 0.2) > 0.01); /* of the centre of mass */
                TEST_ASSERT_DOUBLE_WITHIN(1e-14, x, get("origin_x_m", 0));
                TEST_ASSERT_DOUBLE_WITHIN(1e-14, y, get("origin_y_m", 0));
                TEST_ASSERT_DOUBLE_WITHIN(1e-14, yaw, get("yaw_rate_rad_per_s", 0));
            } else {
                OK(fmi2SetContinuousStates(c, state, 10));
            }
            OK(fmi2GetDerivatives(c, rate[changed], 10));
        }
        for (int k = 0; k < 10; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-12, rate[0][k], rate[1][k]);
        TEST_ASSERT_TRUE(fabs(rate[0][0]) > 1e-3);
    }
}

/* --------------------------------------------------------------------------------------- single states -- */

/* None is rounded by the way through the plant's state, also where others were set before and since. */
static void states_that_are_set_one_by_one_are_there_to_the_last_bit(void) {
    static const struct {
        const char *name;
        uint32_t element;
    } states[] = {{"nu_rad_per_s", 1},
                  {"nu_rad_per_s", 2},
                  {"nu_rad_per_s", 3},
                  {"x_m", 0},
                  {"y_m", 0},
                  {"heading_rad", 0},
                  {"wheel_angle_rad", 1},
                  {"wheel_angle_rad", 2},
                  {"wheel_angle_rad", 3},
                  {"wheel_angle_rad", 4}};
    double found[10], rate[2][10];
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int n = 0; n < 40; n++) {
        double wanted[10];
        for (int k = 0; k < 10; k++) {
            wanted[k] = sin(n + 0.7 * k) * (1 + k) / 3;
            set(states[k].name, states[k].element, wanted[k]);
            TEST_ASSERT_TRUE(get(states[k].name, states[k].element) == wanted[k]);
        }
        OK(fmi2GetContinuousStates(c, found, 10));
        TEST_ASSERT_EQUAL_MEMORY(wanted, found, sizeof wanted);
        const double energy = get("energy_J", 0);
        OK(fmi2GetDerivatives(c, rate[0], 10));
        OK(fmi2SetContinuousStates(c, wanted, 10));
        OK(fmi2GetDerivatives(c, rate[1], 10));
        TEST_ASSERT_EQUAL_MEMORY(rate[1], rate[0], sizeof rate[0]);
        TEST_ASSERT_TRUE(get("energy_J", 0) == energy && energy > 0);
    }
}

/* ---------------------------------------------------------------------------------- steps that are taken back -- */

static fmi3Instance third;
static bool reads, strong;

static double third_get(const char *name, uint32_t element) {
    const fmi3ValueReference reference = ref(name, element);
    double value = NOT_A_NUMBER;
    OK(fmi3GetFloat64(third, &reference, 1, &value, 1));
    return value;
}

static void third_set(const char *name, uint32_t element, double value) {
    const fmi3ValueReference reference = ref(name, element);
    OK(fmi3SetFloat64(third, &reference, 1, &value, 1));
}

/* What comes between internal steps: perhaps somebody reads, perhaps with a force by which no
 * other step is possible. */
static void between(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested, fmi3Boolean get_allowed,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    (void)e, (void)time, (void)set_requested, (void)get_allowed, (void)finished, (void)can_return, (void)early_time;
    if (reads) (void)third_get("x_m", 0);
    if (strong) third_set("body_force_N", 1, 1.7e308);
    if (strong) third_set("body_force_N", 2, 1.7e308);
    *early = false;
}

static fmi3Status third_step(double at_s, double step_s) {
    return fmi3DoStep(third, at_s, step_s, true, NULL, NULL, NULL, NULL);
}

static void begin_third(bool sensors) {
    const fmi3ValueReference imu = ref("has_imu", 0), counts = ref("encoder_counts_per_turn", 1);
    const int32_t per_turn = 4096;
    third =
        fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, false, NULL, 0, NULL, log_3, between);
    third_set("step_s", 0, 0.05);
    third_set("friction_coefficient", 0, 0);
    if (sensors) OK(fmi3SetBoolean(third, &imu, 1, &sensors, 1));
    if (sensors) OK(fmi3SetInt32(third, &counts, 1, &per_turn, 1));
    OK(fmi3EnterInitializationMode(third, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(third));
    third_set("voltage_V", 1, 5);
}

#define SEEN 4

static void see(double found[SEEN]) {
    found[0] = third_get("x_m", 0);
    found[1] = third_get("wheel_angle_rad", 1);
    found[2] = third_get("encoder_count", 1);
    found[3] = third_get("imu_acceleration_m_per_s2", 1);
}

/* Where the vehicle is after a step, and after another; between the two, perhaps, one that is refused. */
static void run_third(double found[2][SEEN], bool sensors, bool refused) {
    begin_third(sensors);
    OK(third_step(0, 0.2));
    strong = refused;
    if (refused) ASSERT_DISCARDED(third_step(0.2, 0.2), "is refused");
    strong = false;
    see(found[0]);
    OK(third_step(0.2, 0.2));
    see(found[1]);
    fmi3FreeInstance(third);
}

/* Motion, input, sensors and outputs are those of before, whether or not somebody had read on the way; and so it goes
 * on. */
static void a_step_with_updates_that_is_refused_is_taken_back(void) {
    double usual[2][SEEN], found[2][SEEN];
    for (int sensors = 0; sensors < 2; sensors++) {
        reads = false;
        run_third(usual, sensors == 1, false);
        TEST_ASSERT_TRUE(usual[0][0] != 0 && usual[1][0] != usual[0][0] && (usual[0][2] != 0) == sensors);
        for (int read = 0; read < 2; read++) {
            reads = read == 1;
            run_third(found, sensors == 1, true);
            TEST_ASSERT_EQUAL_MEMORY(usual, found, sizeof usual);
        }
    }
}

/* An importer that has added up its times ends with it. */
static void a_remainder_of_time_moves_nothing(void) {
    set("friction_coefficient", 0, 0);
    initialise();
    set("voltage_V", 1, 5);
    OK(step(0, 0.1));
    const double x = get("x_m", 0);
    OK(step(0.1, 1e-9));
    TEST_ASSERT_TRUE(get("x_m", 0) == x && x != 0);
    TEST_ASSERT_EQUAL_UINT64(1, instance()->model.plant.steps);
}

/* In a single internal step, too. */
static void a_slope_moves_its_input_in_one_internal_step(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 2);
    const fmi2Integer first = 1;
    const double slope = 30;
    set("friction_coefficient", 0, 0);
    set("step_s", 0, 0.1);
    initialise();
    for (int n = 0; n < 3; n++) {
        OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
        OK(step(0.1 * n, 0.1));
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, 3.0 * (n + 1), get("voltage_V", 2));
        TEST_ASSERT_EQUAL_UINT64(n + 1, instance()->model.plant.steps);
    }
    OK(step(0.3, 0.1));
    TEST_ASSERT_EQUAL_UINT64(4, instance()->model.plant.steps);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_body_keeps_place_and_velocity_in_a_change);
    RUN_TEST(model_exchange_goes_on_as_the_changed_vehicle);
    RUN_TEST(states_that_are_set_one_by_one_are_there_to_the_last_bit);
    RUN_TEST(a_step_with_updates_that_is_refused_is_taken_back);
    RUN_TEST(a_remainder_of_time_moves_nothing);
    RUN_TEST(a_slope_moves_its_input_in_one_internal_step);
    return UNITY_END();
}
