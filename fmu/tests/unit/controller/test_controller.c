/* Tests of controller/model.c, the second FMU model behind the glue: its law in steps, as states, and its derivatives,
 * beside the formula u = K_p e + K_i I, limited, with the integral stopped while it would drive u beyond. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* Start values of the description. */
#define KP 0.5
#define KI 2.0
#define LIMIT 24.0

static const double wanted[4] = {10, -20, 100, -100}, measured[4] = {4, 3, -2, 5};

static void apply(void) {
    for (uint32_t k = 1; k <= 4; k++) {
        set("setpoint_rad_per_s", k, wanted[k - 1]);
        set("wheel_speed_rad_per_s", k, measured[k - 1]);
    }
}

static double limited(double volts) { return volts > LIMIT ? LIMIT : volts < -LIMIT ? -LIMIT : volts; }

static void a_step_integrates_the_error_of_wheels_that_are_not_limited(void) {
    double integral[4] = {0};
    initialise();
    apply();
    for (int n = 0; n < 30; n++) {
        for (uint32_t k = 0; k < 4; k++) {
            const double error = wanted[k] - measured[k], volts = KP * error + KI * integral[k];
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, limited(volts), get("voltage_V", k + 1));
            const bool held = (volts > LIMIT && error > 0) || (volts < -LIMIT && error < 0);
            TEST_ASSERT_TRUE(get("der(angle_error_rad)", k + 1) == (held ? 0 : error));
            if (!held) integral[k] += 0.1 * error;
        }
        OK(step(0.1 * n, 0.1));
        for (uint32_t k = 0; k < 4; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-12, integral[k], get("angle_error_rad", k + 1));
    }
    TEST_ASSERT_TRUE(get("voltage_V", 3) == LIMIT && get("voltage_V", 4) == -LIMIT && get("voltage_V", 1) == LIMIT);
    TEST_ASSERT_TRUE(get("voltage_V", 2) == -LIMIT);
    for (uint32_t k = 1; k <= 4; k++) set("setpoint_rad_per_s", k, measured[k - 1]);
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 1) == 0);
    set("wheel_speed_rad_per_s", 1, measured[0] + 1); /* limited above, and the error drives it back */
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 1) == -1);
    set("wheel_speed_rad_per_s", 2, measured[1] - 1);
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 2) == 1);
}

static void a_gain_below_zero_and_a_limit_that_is_none_are_refused(void) {
    ASSERT_REFUSED(try_set("voltage_limit_V", 0, -1), "outside its range: at least 0");
    set("voltage_limit_V", 0, 0);
    ASSERT_REFUSED(initialise_refused(), "voltage_limit_V: 0 must be above 0");
    set("voltage_limit_V", 0, 5);
    instance()->model.proportional_Vs_per_rad = -1;
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "proportional_gain_Vs_per_rad: -1 must not be negative");
    instance()->model.proportional_Vs_per_rad = 0;
    instance()->model.integral_V_per_rad = -2;
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "integral_gain_V_per_rad: -2 must not be negative");
    instance()->model.integral_V_per_rad = 0;
    OK(fmi2ExitInitializationMode(c));
}

static void gains_are_tuned_in_a_run_and_the_integral_stays(void) {
    initialise();
    apply();
    OK(step(0, 0.1));
    const double integral = get("angle_error_rad", 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.6, integral);
    set("proportional_gain_Vs_per_rad", 0, 1.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.5 * 6 + KI * integral, get("voltage_V", 1));
    TEST_ASSERT_TRUE(get("angle_error_rad", 1) == integral);
    set("voltage_limit_V", 0, 0);
    ASSERT_REFUSED(step(0.1, 0.1), "voltage_limit_V: 0 must be above 0");
    set("voltage_limit_V", 0, 1);
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 1);
    OK(step(0.1, 0.1));
    TEST_ASSERT_TRUE(get("angle_error_rad", 1) == integral); /* held at the limit */
}

/* What is read again without any change is not computed again, though another group is. */
static void what_is_fresh_is_computed_once(void) {
    initialise();
    apply();
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 3);
    instance()->model.voltage_V[0] = 4;
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 1) == 6);
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 4);
    fmu_model_refresh(instance(), FMU_GROUPS_ALL);
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 4);
    set("setpoint_rad_per_s", 1, 12);
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 4 && get("der(angle_error_rad)", 1) == 8);
}

/* Outputs may be read in initialization, and parameters set behind it; and states behind outputs. */
static void outputs_follow_what_is_set_behind_them(void) {
    make(fmi2ModelExchange);
    const double integral[4] = {1, 2, 3, 4};
    OK(fmi2EnterInitializationMode(c));
    set("setpoint_rad_per_s", 1, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * KP, get("voltage_V", 1));
    set("proportional_gain_Vs_per_rad", 0, 3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * 3, get("voltage_V", 1));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2EnterContinuousTimeMode(c));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * 3, get("voltage_V", 1));
    OK(fmi2SetContinuousStates(c, integral, 4));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * 3 + KI, get("voltage_V", 1));
}

/* At the limit itself the voltage still follows. */
static void at_the_limit_derivatives_are_those_of_the_law(void) {
    const double one = 1;
    double found = 7;
    initialise();
    for (uint32_t k = 1; k <= 2; k++) {
        const fmi2ValueReference voltage = ref("voltage_V", k), setpoint = ref("setpoint_rad_per_s", k);
        set("setpoint_rad_per_s", k, k == 1 ? LIMIT / KP : -LIMIT / KP);
        TEST_ASSERT_TRUE(get("voltage_V", k) == (k == 1 ? LIMIT : -LIMIT));
        OK(fmi2GetDirectionalDerivative(c, &voltage, 1, &setpoint, 1, &one, &found));
        TEST_ASSERT_TRUE(found == KP);
    }
}

/* There the integral is not held either: its rate and the rate's derivative are the error's, from both sides. */
static void at_the_limit_itself_and_without_an_error_the_integral_follows(void) {
    const double one = 1;
    double found = 7;
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (uint32_t k = 1; k <= 4; k++) {
        const double sign = k % 2 == 1 ? 1 : -1;
        const fmi2ValueReference rate = ref("der(angle_error_rad)", k), setpoint = ref("setpoint_rad_per_s", k);
        set("setpoint_rad_per_s", k, k <= 2 ? sign * LIMIT / KP : 0);
        set("angle_error_rad", k, k <= 2 ? 0 : sign * LIMIT); /* of the last two the voltage is beyond the limit */
        TEST_ASSERT_TRUE(get("voltage_V", k) == sign * LIMIT);
        TEST_ASSERT_TRUE(get("der(angle_error_rad)", k) == (k <= 2 ? sign * LIMIT / KP : 0));
        OK(fmi2GetDirectionalDerivative(c, &rate, 1, &setpoint, 1, &one, &found));
        TEST_ASSERT_TRUE(found == 1);
    }
}

/* The arrays of the model are full then. */
static void a_controller_of_sixteen_wheels_is_sixteen_controllers(void) {
    double state[FMU_MODEL_LARGEST_ARRAY], found[FMU_MODEL_LARGEST_ARRAY];
    instance()->initial.wheel_count = FMU_MODEL_LARGEST_ARRAY;
    OK(fmi2Reset(c));
    initialise();
    for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++) {
        set("setpoint_rad_per_s", k, k);
        set("wheel_speed_rad_per_s", k, 0.25 * k);
    }
    for (int n = 0; n < 2; n++) {
        for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++) {
            const double integral = 0.1 * n * 0.75 * k;
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, integral, get("angle_error_rad", k));
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, KP * 0.75 * k + KI * integral, get("voltage_V", k));
        }
        for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++)
            TEST_ASSERT_TRUE(get("der(angle_error_rad)", k) == 0.75 * k);
        for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, (KP + KI * 0.1 * n) * 0.75 * k, get("voltage_V", k));
        if (n == 0) OK(step(0, 0.1));
    }
    TEST_ASSERT_EQUAL_UINT32(FMU_MODEL_LARGEST_ARRAY, fmu_model_state_count(&instance()->model));
    for (int k = 0; k < FMU_MODEL_LARGEST_ARRAY; k++) state[k] = -k;
    fmu_model_set_states(instance(), state);
    fmu_model_get_states(instance(), found);
    TEST_ASSERT_EQUAL_MEMORY(state, found, sizeof state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, KP * 0.75, get("voltage_V", 1));
    TEST_ASSERT_TRUE(get("wheel_speed_rad_per_s", 1) == 0.25 && get("setpoint_rad_per_s", 1) == 1);
}

static void a_run_that_starts_anew_has_no_integral(void) {
    initialise();
    apply();
    OK(step(0, 0.1));
    TEST_ASSERT_TRUE(get("angle_error_rad", 1) != 0);
    OK(fmi2Reset(c));
    initialise();
    TEST_ASSERT_TRUE(get("angle_error_rad", 1) == 0 && get("voltage_V", 1) == 0);
}

static void inputs_are_held_over_a_step_and_have_no_slopes(void) {
    const fmi2ValueReference setpoint = ref("setpoint_rad_per_s", 1);
    const fmi2Integer first = 1;
    const double slope = 1;
    initialise();
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &setpoint, 1, &first, &slope), "the inputs are held over a step");
}

/* Where an importer looks in between, steps are taken one by one; a step of several is not the controller's. */
static void a_callback_sees_the_step_s_end(void) {
    set("proportional_gain_Vs_per_rad", 0, 0);
    initialise();
    apply();
    OK(step(0, 0.05));
    OK(step(0.05, 0.2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.25 * 6, get("angle_error_rad", 1));
}

static void integrals_are_continuous_states_of_model_exchange(void) {
    double state[4] = {1, -2, 3, 4}, found[4], rate[4], nominal[4];
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    apply();
    OK(fmi2SetContinuousStates(c, state, 4));
    OK(fmi2GetContinuousStates(c, found, 4));
    TEST_ASSERT_EQUAL_MEMORY(state, found, sizeof state);
    OK(fmi2GetDerivatives(c, rate, 4));
    for (uint32_t k = 0; k < 4; k++) {
        const double error = wanted[k] - measured[k], volts = KP * error + KI * state[k];
        const bool held = (volts > LIMIT && error > 0) || (volts < -LIMIT && error < 0);
        TEST_ASSERT_TRUE(rate[k] == (held ? 0 : error));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, limited(volts), get("voltage_V", k + 1));
    }
    OK(fmi2GetNominalsOfContinuousStates(c, nominal, 4));
    for (int k = 0; k < 4; k++) TEST_ASSERT_TRUE(nominal[k] == 1);
    set("angle_error_rad", 2, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, KP * -23 + KI * 0.5, get("voltage_V", 2));
    log_clear();
    OK(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(0, lines);
    ASSERT_REFUSED(fmi2SetContinuousStates(c, state, 5), "there are 4 continuous states, not 5");
}

static void derivatives_are_those_of_the_law_and_0_where_it_is_limited(void) {
    fmi2ValueReference of[2], by[3];
    const double seeds[3] = {2, 3, 5};
    double found[2];
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    apply();
    for (uint32_t k = 1; k <= 4; k++) {
        by[0] = ref("setpoint_rad_per_s", k);
        by[1] = ref("wheel_speed_rad_per_s", k);
        by[2] = ref("angle_error_rad", k);
        of[0] = ref("voltage_V", k);
        of[1] = ref("der(angle_error_rad)", k);
        OK(fmi2GetDirectionalDerivative(c, of, 2, by, 3, seeds, found));
        const bool is_limited = k > 2;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, is_limited ? 0 : KP * -1 + KI * 5, found[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, is_limited ? 0 : -1, found[1]);
    }
    set("angle_error_rad", 2, -20); /* limited below, and the error drives it back */
    set("setpoint_rad_per_s", 2, measured[1] + 4);
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 2) == 4 && get("voltage_V", 2) == -LIMIT);
    set("angle_error_rad", 1, 100); /* limited above, and the error drives it back */
    set("setpoint_rad_per_s", 1, 0);
    by[0] = ref("setpoint_rad_per_s", 1);
    of[0] = ref("voltage_V", 1);
    of[1] = ref("der(angle_error_rad)", 1);
    OK(fmi2GetDirectionalDerivative(c, of, 2, by, 1, seeds, found));
    TEST_ASSERT_TRUE(found[0] == 0 && found[1] == 2);
}

static void outputs_change_in_time_with_the_integral(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    double rate = 7;
    initialise();
    apply();
    OK(step(0, 0.1));
    OK(fmi2GetRealOutputDerivatives(c, &voltage, 1, &first, &rate));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, KI * 6, rate);
    const fmi2ValueReference second = ref("voltage_V", 2);
    OK(fmi2GetRealOutputDerivatives(c, &second, 1, &first, &rate));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, KI * -23, rate);
    instance()->model.start_needed = true; /* a new start has no integral */
    for (uint32_t k = 1; k <= 4; k++) TEST_ASSERT_TRUE(get("angle_error_rad", k) == 0);
}

static void a_state_is_kept_in_bytes(void) {
    static fmi2Byte bytes[4096];
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    initialise();
    apply();
    OK(step(0, 0.1));
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    TEST_ASSERT_TRUE(size < sizeof bytes);
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(step(0.1, 0.1));
    const double volts = get("voltage_V", 1);
    set("setpoint_rad_per_s", 1, 0);
    set("wheel_speed_rad_per_s", 1, 1);
    set("proportional_gain_Vs_per_rad", 0, 9);
    set("integral_gain_V_per_rad", 0, 8);
    set("voltage_limit_V", 0, 7);
    OK(step(0.2, 0.3));
    fmi2FreeInstance(c);
    c = make_2(fmi2CoSimulation, fmu_token_2);
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &kept));
    OK(fmi2SetFMUstate(c, kept));
    OK(step(0.1, 0.1));
    TEST_ASSERT_TRUE(get("voltage_V", 1) == volts && get("time", 0) == 0.2);
    instance()->model.wheel_count = 17;
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &kept), "no possible state");
    OK(fmi2FreeFMUstate(c, &kept));
}

/* ------------------------------------------------------------------------------------------- by FMI 3 -- */

static int seen;
static void between(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested, fmi3Boolean get_allowed,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    (void)e, (void)time, (void)set_requested, (void)get_allowed, (void)finished, (void)can_return, (void)early_time;
    seen++;
    *early = false;
}

/* Six wheels by configuration, and motion that is saved before a step that the importer watches. */
static void the_number_of_wheels_is_configured(void) {
    const fmi3ValueReference count = ref("wheel_count", 0), setpoint = ref("setpoint_rad_per_s", 0),
                             integral = ref("angle_error_rad", 0);
    const fmi3UInt64 six = 6;
    const double wished[6] = {1, 2, 3, 4, 5, 6};
    double found[6];
    fmi3Instance i =
        fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, false, NULL, 0, NULL, log_3, between);
    OK(fmi3EnterConfigurationMode(i));
    OK(fmi3SetUInt64(i, &count, 1, &six, 1));
    OK(fmi3ExitConfigurationMode(i));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3SetFloat64(i, &setpoint, 1, wished, 6));
    OK(fmi3DoStep(i, 0, 0.5, true, NULL, NULL, NULL, NULL));
    OK(fmi3GetFloat64(i, &integral, 1, found, 6));
    for (int k = 0; k < 6; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.5 * wished[k], found[k]);
    TEST_ASSERT_EQUAL_INT(1, seen);
    fmi3FreeInstance(i);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_step_integrates_the_error_of_wheels_that_are_not_limited);
    RUN_TEST(a_gain_below_zero_and_a_limit_that_is_none_are_refused);
    RUN_TEST(gains_are_tuned_in_a_run_and_the_integral_stays);
    RUN_TEST(what_is_fresh_is_computed_once);
    RUN_TEST(outputs_follow_what_is_set_behind_them);
    RUN_TEST(at_the_limit_derivatives_are_those_of_the_law);
    RUN_TEST(at_the_limit_itself_and_without_an_error_the_integral_follows);
    RUN_TEST(a_controller_of_sixteen_wheels_is_sixteen_controllers);
    RUN_TEST(a_run_that_starts_anew_has_no_integral);
    RUN_TEST(inputs_are_held_over_a_step_and_have_no_slopes);
    RUN_TEST(a_callback_sees_the_step_s_end);
    RUN_TEST(integrals_are_continuous_states_of_model_exchange);
    RUN_TEST(derivatives_are_those_of_the_law_and_0_where_it_is_limited);
    RUN_TEST(outputs_change_in_time_with_the_integral);
    RUN_TEST(a_state_is_kept_in_bytes);
    RUN_TEST(the_number_of_wheels_is_configured);
    return UNITY_END();
}
