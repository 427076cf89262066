/* Tests of fmi3.c: types, configuration, events, intermediate updates, dependencies. */
#include "fmi_bench.h"

static fmi3Instance c;

void setUp(void) {
    log_clear();
    c = make_3(false);
    TEST_ASSERT_NOT_NULL(c);
}
void tearDown(void) { fmi3FreeInstance(c); }

static void set(const char *name, uint32_t element, double value) {
    const fmi3ValueReference reference = ref(name, element);
    OK(fmi3SetFloat64(c, &reference, 1, &value, 1));
}

static double get(const char *name, uint32_t element) {
    const fmi3ValueReference reference = ref(name, element);
    double value = NOT_A_NUMBER;
    OK(fmi3GetFloat64(c, &reference, 1, &value, 1));
    return value;
}

static void begin(void) {
    OK(fmi3EnterInitializationMode(c, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(c));
}

static fmi3Status step(double at_s, double step_s, fmi3Float64 *end_s) {
    fmi3Boolean event, terminate, early;
    return fmi3DoStep(c, at_s, step_s, true, &event, &terminate, &early, end_s);
}

static void an_array_is_read_and_set_as_a_whole(void) {
    const fmi3ValueReference voltage = ref("voltage_V", 0), speed = ref("wheel_speed_rad_per_s", 0);
    const double volts[4] = {1, 2, 3, 4};
    double found[4] = {0}, end_s;
    begin();
    OK(fmi3SetFloat64(c, &voltage, 1, volts, 4));
    OK(fmi3GetFloat64(c, &voltage, 1, found, 4));
    TEST_ASSERT_EQUAL_MEMORY(volts, found, sizeof volts);
    TEST_ASSERT_TRUE(get("voltage_V", 3) == 3);
    ASSERT_REFUSED(fmi3SetFloat64(c, &voltage, 1, volts, 3), "voltage_V has 4 values, but only 3 were left");
    ASSERT_REFUSED(fmi3GetFloat64(c, &voltage, 1, found, 5), "values");
    OK(step(0, 0.5, &end_s));
    TEST_ASSERT_TRUE(end_s == 0.5);
    OK(fmi3GetFloat64(c, &speed, 1, found, 4));
    TEST_ASSERT_TRUE(found[0] > 0 && found[0] == get("wheel_speed_rad_per_s", 1));
    const fmi3ValueReference fifth = ref("voltage_V", 5);
    ASSERT_REFUSED(fmi3GetFloat64(c, &fifth, 1, found, 1), "no variable with the value reference");
}

static void the_number_of_wheels_is_configured(void) {
    const fmi3ValueReference wheels = ref("wheel_count", 0), voltage = ref("voltage_V", 0), kind = ref("wheel_kind", 3);
    fmi3UInt64 count = 2;
    fmi3Int64 roller = 1;
    double volts[6] = {0};
    ASSERT_REFUSED(fmi3SetUInt64(c, &wheels, 1, &count, 1), "it is set in configuration mode");
    OK(fmi3EnterConfigurationMode(c));
    count = 17;
    ASSERT_REFUSED(fmi3SetUInt64(c, &wheels, 1, &count, 1), "wheel_count: 17 is outside its range: 1 to 16");
    count = 6;
    OK(fmi3SetUInt64(c, &wheels, 1, &count, 1));
    ASSERT_REFUSED(fmi3EnterInitializationMode(c, false, 0, 0, false, 0), "is not allowed in configuration mode");
    OK(fmi3ExitConfigurationMode(c));
    count = 0;
    OK(fmi3GetUInt64(c, &wheels, 1, &count, 1));
    TEST_ASSERT_EQUAL_UINT64(6, count);
    OK(fmi3GetFloat64(c, &voltage, 1, volts, 6));
    OK(fmi3SetInt64(c, &kind, 1, &roller, 1));
    OK(fmi3GetInt64(c, &kind, 1, &roller, 1));
    OK(fmi3EnterInitializationMode(c, false, 0, 0, false, 0));
    ASSERT_REFUSED(fmi3ExitInitializationMode(c), "wheel"); /* the new ones were not set */
}

static void every_type_has_its_functions_and_the_fmu_has_no_others(void) {
    const fmi3ValueReference locked = ref("wheel_locked", 1), supports = ref("support_count", 0),
                             mass = ref("mass_kg", 0);
    fmi3Boolean flag = true;
    fmi3Int32 whole = 2;
    fmi3Float32 single;
    fmi3Int8 small;
    fmi3Int16 short_one;
    fmi3UInt8 byte;
    fmi3UInt16 word;
    fmi3UInt32 unsigned_one;
    fmi3String text;
    OK(fmi3SetBoolean(c, &locked, 1, &flag, 1));
    flag = false;
    OK(fmi3GetBoolean(c, &locked, 1, &flag, 1));
    TEST_ASSERT_TRUE(flag);
    OK(fmi3SetInt32(c, &supports, 1, &whole, 1));
    whole = 0;
    OK(fmi3GetInt32(c, &supports, 1, &whole, 1));
    TEST_ASSERT_EQUAL_INT(2, whole);
    ASSERT_REFUSED(fmi3GetInt32(c, &supports, 1, NULL, 0), "support_count has 1 values, but only 0 were left");
    ASSERT_REFUSED(fmi3GetInt32(c, &mass, 1, &whole, 1), "mass_kg is a Float64 (Real), not an Int32");
    ASSERT_REFUSED(fmi3GetFloat32(c, &mass, 1, &single, 1), "Float32");
    ASSERT_REFUSED(fmi3GetInt8(c, &mass, 1, &small, 1), "Int8");
    ASSERT_REFUSED(fmi3GetInt16(c, &mass, 1, &short_one, 1), "Int16");
    ASSERT_REFUSED(fmi3GetUInt8(c, &mass, 1, &byte, 1), "UInt8");
    ASSERT_REFUSED(fmi3GetUInt16(c, &mass, 1, &word, 1), "UInt16");
    ASSERT_REFUSED(fmi3GetUInt32(c, &mass, 1, &unsigned_one, 1), "UInt32");
    ASSERT_REFUSED(fmi3GetString(c, &mass, 1, &text, 1), "String");
    OK(fmi3GetFloat32(c, NULL, 0, NULL, 0));
}

static int calls;
static bool is_early;
static double seen_s;

static void between(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested, fmi3Boolean get_allowed,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    const fmi3ValueReference voltage = ref("voltage_V", 1), x = ref("x_m", 0), mass = ref("mass_kg", 0);
    double volt = 3, value;
    (void)e;
    calls++;
    seen_s = time;
    TEST_ASSERT_TRUE(get_allowed && can_return && finished && set_requested == (calls != 5));
    OK(fmi3GetFloat64(c, &x, 1, &value, 1));
    OK(fmi3SetFloat64(c, &voltage, 1, &volt, 1));
    TEST_ASSERT_EQUAL_INT(3, (int)fmi3SetFloat64(c, &mass, 1, &volt, 1));
    *early = is_early && calls == 2;
    *early_time = time;
}

static void an_importer_may_look_between_internal_steps_and_return(void) {
    const fmi3ValueReference wanted[1] = {ref("x_m", 0)};
    for (int early = 0; early < 2; early++) {
        fmi3Boolean event, terminate, returned;
        double end_s;
        fmi3FreeInstance(c);
        c = fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, false, false, true, wanted, 1, NULL, log_3,
                                        between);
        TEST_ASSERT_NOT_NULL(c);
        set("step_s", 0, 0.01);
        begin();
        calls = 0;
        is_early = early == 1;
        OK(fmi3DoStep(c, 0, 0.05, true, &event, &terminate, &returned, &end_s));
        TEST_ASSERT_EQUAL_INT(early ? 2 : 5, calls);
        TEST_ASSERT_TRUE(returned == (early == 1) && end_s == (early ? 0.02 : 0.05) && seen_s == end_s);
        TEST_ASSERT_TRUE(get("voltage_V", 1) == 3);
    }
}

static void variables_without_intermediate_values_cannot_be_required(void) {
    const fmi3ValueReference mass[2] = {ref("mass_kg", 0), ref("x_m", 0)}, none[1] = {0x7FFFFFFF},
                             second[2] = {ref("x_m", 0), ref("mass_kg", 0)};
    TEST_ASSERT_NULL(fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, second, 2, NULL,
                                                 log_3, between));
    ASSERT_LOGGED("mass_kg is required as intermediate variable, but it has no intermediate updates");
    log_clear();
    TEST_ASSERT_NULL(
        fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, mass, 1, NULL, log_3, between));
    ASSERT_LOGGED("mass_kg is required as intermediate variable, but it has no intermediate updates");
    TEST_ASSERT_NULL(
        fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, none, 1, NULL, log_3, between));
    ASSERT_LOGGED("no variable has the value reference");
    TEST_ASSERT_NULL(
        fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, NULL, 2, NULL, log_3, between));
    ASSERT_LOGGED("the list of 2 required intermediate variables is missing");
    TEST_ASSERT_NULL(
        fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, NULL, 1, NULL, log_3, between));
    ASSERT_LOGGED("the list of 1 required intermediate variables is missing");
}

static void in_event_mode_motors_are_tuned_and_the_change_is_told(void) {
    fmi3Boolean need, terminate, nominals, values, next;
    double next_s, end_s;
    fmi3FreeInstance(c);
    c = make_3(true);
    begin(); /* and is in event mode */
    OK(fmi3EnterStepMode(c));
    set("voltage_V", 1, 4);
    OK(step(0, 0.1, &end_s));
    const fmi3ValueReference gain = ref("motor_gain_Nm_per_V", 0);
    double stronger = 0.4;
    ASSERT_REFUSED(fmi3SetFloat64(c, &gain, 1, &stronger, 1), "in event mode where that is used");
    OK(fmi3EnterEventMode(c));
    OK(fmi3UpdateDiscreteStates(c, &need, &terminate, &nominals, &values, &next, &next_s));
    TEST_ASSERT_FALSE(need || terminate || nominals || values || next);
    OK(fmi3SetFloat64(c, &gain, 1, &stronger, 1));
    OK(fmi3UpdateDiscreteStates(c, &need, &terminate, &nominals, &values, &next, &next_s));
    TEST_ASSERT_TRUE(values && !need);
    OK(fmi3UpdateDiscreteStates(c, NULL, NULL, NULL, &values, NULL, NULL));
    TEST_ASSERT_FALSE(values);
    ASSERT_REFUSED(step(0.1, 0.1, &end_s), "DoStep is not allowed in event mode");
    OK(fmi3EnterStepMode(c));
    OK(step(0.1, 0.1, &end_s));
    OK(fmi3Terminate(c));
    OK(fmi3Reset(c));
    TEST_ASSERT_TRUE(get("motor_gain_Nm_per_V", 0) == 0.2);
}

/* Every answer is written, whatever stood there. */
static void without_an_event_a_run_goes_on(void) {
    fmi3Boolean need = true, terminate = true, nominals = true, values = true, next = true, event = true, early = true;
    double next_s = 7, end_s = 7;
    fmi3FreeInstance(c);
    c = make_3(true);
    begin();
    OK(fmi3UpdateDiscreteStates(c, &need, &terminate, &nominals, &values, &next, &next_s));
    TEST_ASSERT_FALSE(need || terminate || nominals || values || next);
    TEST_ASSERT_TRUE(next_s == 0);
    OK(fmi3EnterStepMode(c));
    terminate = true;
    OK(fmi3DoStep(c, 0, 0.1, true, &event, &terminate, &early, &end_s));
    TEST_ASSERT_FALSE(event || terminate || early);
    TEST_ASSERT_TRUE(end_s == 0.1);
}

static int told_to;
static void log_to(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text) {
    (void)category, (void)text;
    TEST_ASSERT_EQUAL_PTR(&told_to, e);
    TEST_ASSERT_EQUAL_INT(fmi3Error, status);
    told_to++;
}

static void the_log_goes_to_the_importer_s_environment(void) {
    fmi3FreeInstance(c);
    c = fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, false, NULL, 0, &told_to, log_to,
                                    NULL);
    told_to = 0;
    TEST_ASSERT_EQUAL_INT(fmi3Error, fmi3Terminate(c));
    fmi3Instance exchange = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, &told_to, log_to);
    TEST_ASSERT_EQUAL_INT(fmi3Error, fmi3Terminate(exchange));
    fmi3FreeInstance(exchange);
    TEST_ASSERT_EQUAL_INT(2, told_to);
}

static void in_event_mode_the_number_of_wheels_stays(void) {
    const fmi3ValueReference wheels = ref("wheel_count", 0);
    const fmi3UInt64 two = 2;
    fmi3FreeInstance(c);
    c = make_3(true);
    begin();
    ASSERT_REFUSED(fmi3SetUInt64(c, &wheels, 1, &two, 1), "wheel_count cannot be set in event mode");
}

static void the_time_is_not_set_as_a_variable(void) {
    const fmi3ValueReference time = ref("time", 0);
    const double later_s = 3;
    fmi3FreeInstance(c);
    c = make_3(true);
    ASSERT_REFUSED(fmi3SetFloat64(c, &time, 1, &later_s, 1), "time cannot be set in instantiated: it is the time");
    begin();
    ASSERT_REFUSED(fmi3SetFloat64(c, &time, 1, &later_s, 1), "time cannot be set in event mode: it is the time");
    OK(fmi3EnterStepMode(c));
    ASSERT_REFUSED(fmi3SetFloat64(c, &time, 1, &later_s, 1), "time cannot be set in step mode: it is the time");
    TEST_ASSERT_TRUE(get("time", 0) == 0);
}

static void an_output_depends_on_what_the_description_says(void) {
    size_t count = 0;
    const fmi3ValueReference x = ref("x_m", 0), none = 0x7FFFFFFF;
    TEST_ASSERT_TRUE(fmi3GetNumberOfVariableDependencies(c, x, &count) != fmi3Fatal);
    TEST_ASSERT_TRUE(fmi3GetNumberOfVariableDependencies(c, none, &count) != fmi3OK);
    TEST_ASSERT_EQUAL_STRING("3.0", fmi3GetVersion());
    TEST_ASSERT_NULL(
        fmi3InstantiateScheduledExecution("a", fmu_token_3, NULL, false, true, NULL, log_3, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_STRING("logStatusError: this FMU offers no Scheduled Execution", logged);
    told_to = 0;
    TEST_ASSERT_NULL(
        fmi3InstantiateScheduledExecution("a", fmu_token_3, NULL, false, true, &told_to, log_to, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(1, told_to);
}

static void a_run_that_cannot_be_leaves_the_instance_where_it_was(void) {
    ASSERT_REFUSED(fmi3EnterInitializationMode(c, false, 0, 2, true, 1),
                   "the stop time 1 s is before the start time 2 s");
    begin();
}

static void without_a_logger_nothing_is_told(void) {
    fmi3FreeInstance(c);
    c = fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, false, NULL, 0, NULL, NULL, NULL);
    TEST_ASSERT_NOT_NULL(c);
    TEST_ASSERT_EQUAL_INT(fmi3Error, fmi3EnterStepMode(c));
    TEST_ASSERT_NULL(
        fmi3InstantiateScheduledExecution("a", fmu_token_3, NULL, false, true, NULL, NULL, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(0, lines);
}

static void what_an_importer_does_not_ask_for_is_not_told(void) {
    fmi3Boolean event = true, terminate = true;
    fmi3Instance exchange = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    OK(fmi3EnterInitializationMode(exchange, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(exchange));
    OK(fmi3UpdateDiscreteStates(exchange, NULL, NULL, NULL, NULL, NULL, NULL));
    OK(fmi3EnterContinuousTimeMode(exchange));
    OK(fmi3CompletedIntegratorStep(exchange, true, NULL, &terminate));
    OK(fmi3CompletedIntegratorStep(exchange, true, &event, NULL));
    TEST_ASSERT_FALSE(event || terminate);
    fmi3FreeInstance(exchange);
}

static void a_run_ends_where_it_was_said_to(void) {
    double end_s;
    OK(fmi3EnterInitializationMode(c, true, 1e-4, 1, true, 2));
    OK(fmi3ExitInitializationMode(c));
    OK(step(1, 1, &end_s));
    TEST_ASSERT_TRUE(end_s == 2);
    ASSERT_REFUSED(step(2, 0.1, &end_s), "goes beyond the stop time 2 s");
    TEST_ASSERT_TRUE(end_s == 2);
}

static void logging_adds_and_removes_categories(void) {
    const fmi3String events[1] = {"logEvents"};
    double end_s;
    OK(fmi3SetDebugLogging(c, false, 0, NULL));
    OK(fmi3SetDebugLogging(c, true, 1, events));
    begin();
    for (int k = 0; k < 2; k++) {
        set("motor_gain_Nm_per_V", 0, 0.1 + 0.1 * k);
        log_clear();
        OK(step(0.1 * k, 0.1, &end_s));
        TEST_ASSERT_EQUAL_INT(k == 0, lines);
        OK(fmi3SetDebugLogging(c, false, 1, events));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_array_is_read_and_set_as_a_whole);
    RUN_TEST(the_number_of_wheels_is_configured);
    RUN_TEST(every_type_has_its_functions_and_the_fmu_has_no_others);
    RUN_TEST(an_importer_may_look_between_internal_steps_and_return);
    RUN_TEST(variables_without_intermediate_values_cannot_be_required);
    RUN_TEST(in_event_mode_motors_are_tuned_and_the_change_is_told);
    RUN_TEST(without_an_event_a_run_goes_on);
    RUN_TEST(the_log_goes_to_the_importer_s_environment);
    RUN_TEST(in_event_mode_the_number_of_wheels_stays);
    RUN_TEST(the_time_is_not_set_as_a_variable);
    RUN_TEST(an_output_depends_on_what_the_description_says);
    RUN_TEST(a_run_that_cannot_be_leaves_the_instance_where_it_was);
    RUN_TEST(without_a_logger_nothing_is_told);
    RUN_TEST(what_an_importer_does_not_ask_for_is_not_told);
    RUN_TEST(a_run_ends_where_it_was_said_to);
    RUN_TEST(logging_adds_and_removes_categories);
    return UNITY_END();
}
