/* Tests of fmi2.c and of what is behind it in Co-Simulation: life, variables, steps, refusals. */
#include "fmi_bench.h"

static fmi2Component c;

void setUp(void) {
    log_clear();
    c = make_2(fmi2CoSimulation, fmu_token_2);
    TEST_ASSERT_NOT_NULL(c);
}
void tearDown(void) { fmi2FreeInstance(c); }

static void set(const char *name, uint32_t element, double value) {
    const fmi2ValueReference reference = ref(name, element);
    OK(fmi2SetReal(c, &reference, 1, &value));
}

static double get(const char *name, uint32_t element) {
    const fmi2ValueReference reference = ref(name, element);
    double value = NOT_A_NUMBER;
    OK(fmi2GetReal(c, &reference, 1, &value));
    return value;
}

static void begin(double start_s, bool has_stop, double stop_s) {
    OK(fmi2SetupExperiment(c, fmi2False, 0, start_s, has_stop, stop_s));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
}

static void nothing_is_made_without_name_token_kind_or_callbacks(void) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL}, silent = {0};
    TEST_ASSERT_NULL(fmi2Instantiate("", fmi2CoSimulation, fmu_token_2, NULL, &callbacks, 0, 0));
    ASSERT_LOGGED("an empty text");
    TEST_ASSERT_NULL(fmi2Instantiate(NULL, fmi2CoSimulation, fmu_token_2, NULL, &callbacks, 0, 0));
    ASSERT_LOGGED("no name (NULL)");
    TEST_ASSERT_NULL(fmi2Instantiate("a", fmi2CoSimulation, NULL, NULL, &callbacks, 0, 0));
    ASSERT_LOGGED("the token is missing");
    TEST_ASSERT_NULL(fmi2Instantiate("a", (fmi2Type)7, fmu_token_2, NULL, &callbacks, 0, 0));
    ASSERT_LOGGED("no such fmuType");
    TEST_ASSERT_NULL(make_2(fmi2CoSimulation, "{another}"));
    ASSERT_LOGGED("no resources folder was given");
    TEST_ASSERT_NULL(fmi2Instantiate("a", fmi2CoSimulation, "{another}", "file:///nowhere%20at/all", &callbacks, 0, 0));
    ASSERT_LOGGED("/nowhere at/all/start.bin holds no start values");
    TEST_ASSERT_NULL(fmi2Instantiate("a", fmi2CoSimulation, fmu_token_2, NULL, NULL, 0, 0));
    TEST_ASSERT_NULL(fmi2Instantiate("", fmi2CoSimulation, fmu_token_2, NULL, &silent, 0, 0));
    TEST_ASSERT_NULL(fmi2Instantiate("a", (fmi2Type)7, fmu_token_2, NULL, &silent, 0, 0));
    TEST_ASSERT_NULL(make_2(fmi2CoSimulation, "{100%}"));
    ASSERT_LOGGED("the token {100%%} is not this binary's"); /* loggers format as printf does */
    fmi2FreeInstance(NULL);
    TEST_ASSERT_EQUAL_STRING("2.0", fmi2GetVersion());
    TEST_ASSERT_EQUAL_STRING("default", fmi2GetTypesPlatform());
}

static int told_to;
static void log_to(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String text,
                   ...) {
    TEST_ASSERT_EQUAL_PTR(&told_to, e);
    TEST_ASSERT_EQUAL_STRING("one", name);
    TEST_ASSERT_EQUAL_INT(fmi2Error, status);
    log_line(category, text);
    told_to++;
}

static void the_log_goes_to_the_importer_s_environment_in_lines_of_511_letters(void) {
    const fmi2CallbackFunctions callbacks = {log_to, calloc, free, NULL, &told_to};
    static char token[700];
    memset(token, 'x', sizeof token - 1);
    TEST_ASSERT_NULL(fmi2Instantiate("one", fmi2CoSimulation, token, NULL, &callbacks, 0, 0));
    TEST_ASSERT_EQUAL_size_t(strlen("logStatusError: ") + 511, strlen(logged));
    fmi2FreeInstance(c);
    c = fmi2Instantiate("one", fmi2CoSimulation, fmu_token_2, NULL, &callbacks, 0, 0);
    told_to = 0;
    TEST_ASSERT_EQUAL_INT(fmi2Error, fmi2Terminate(c));
    TEST_ASSERT_EQUAL_INT(1, told_to);
    TEST_ASSERT_NULL(fmi2Instantiate("one", (fmi2Type)7, fmu_token_2, NULL, &callbacks, 0, 0));
    TEST_ASSERT_EQUAL_INT(2, told_to);
    ASSERT_LOGGED("logStatusError: Instantiate: there is no such fmuType");
}

/* NaN has no sign: without it the line, which was cut, is a letter shorter. */
static void a_line_that_was_cut_is_told_to_its_end(void) {
    static char token[700];
    memset(token, 'x', sizeof token - 1);
    memcpy(token, "{ -nan", 6);
    TEST_ASSERT_NULL(make_2(fmi2CoSimulation, token));
    ASSERT_LOGGED("the token { nanxxx");
    TEST_ASSERT_EQUAL_size_t(strlen("logStatusError: ") + 510, strlen(logged));
}

/* As long as a line may be, each doubled; the next line is as short as it is. */
static void all_percent_signs_of_a_line_are_doubled(void) {
    static char token[700];
    memset(token, '%', sizeof token - 1);
    TEST_ASSERT_NULL(make_2(fmi2CoSimulation, token));
    TEST_ASSERT_EQUAL_size_t(sizeof logged - 1, strlen(logged)); /* which is what this test's log takes of it */
    TEST_ASSERT_EQUAL_size_t(strlen(logged) - strlen("logStatusError: the token "), strspn(strchr(logged, '%'), "%"));
    ASSERT_REFUSED(fmi2Terminate(c), "");
    TEST_ASSERT_EQUAL_STRING("logStatusError: Terminate is not allowed in instantiated", logged);
}

/* Which the instance keeps: the importer's memory may end with the name, and with the call. */
static void the_log_has_the_name_of_the_instance(void) {
    const fmi2CallbackFunctions callbacks = {log_to, calloc, free, NULL, &told_to};
    char *const name = malloc(sizeof "one");
    TEST_ASSERT_NOT_NULL(name);
    memcpy(name, "one", sizeof "one");
    fmi2FreeInstance(c);
    c = fmi2Instantiate(name, fmi2CoSimulation, fmu_token_2, NULL, &callbacks, 0, 0);
    memset(name, 'x', sizeof "one" - 1);
    free(name);
    told_to = 0;
    TEST_ASSERT_EQUAL_INT(fmi2Error, fmi2Terminate(c));
    TEST_ASSERT_EQUAL_INT(1, told_to);
}

/* The vehicle of the description's start values, by the core alone. */
static void a_step_has_the_bits_of_the_core(void) {
    laconic_plant plant;
    laconic_input held;
    laconic_pose pose;
    memset(&held, 0, sizeof held);
    begin(0, false, 0);
    const fmu_instance *instance = c;
    laconic_start start;
    memset(&start, 0, sizeof start);
    TEST_ASSERT_EQUAL(LACONIC_OK,
                      laconic_plant_start(&plant, &instance->model.vehicle, &laconic_auto, 0.01, &start, NULL));
    for (uint32_t k = 1; k <= 4; k++) {
        set("voltage_V", k, 1.5 * k - 2);
        held.voltage_V[k - 1] = 1.5 * k - 2;
    }
    for (int k = 0; k < 50; k++) OK(fmi2DoStep(c, k * 0.01, 0.01, fmi2True));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_run(&plant, &held, 50, NULL));
    laconic_pose_of(&pose, &plant.model, &plant.state);
    TEST_ASSERT_TRUE(get("x_m", 0) == pose.x_m && get("y_m", 0) == pose.y_m);
    TEST_ASSERT_TRUE(get("heading_rad", 0) == pose.heading_rad && pose.heading_rad != 0);
    TEST_ASSERT_TRUE(get("time", 0) == 0.5);
    TEST_ASSERT_TRUE(get("energy_J", 0) == laconic_plant_energy_J(&plant));
}

static void every_type_has_its_functions_and_refuses_the_others(void) {
    const fmi2ValueReference method = ref("method", 0), locked = ref("wheel_locked", 2), mass = ref("mass_kg", 0),
                             supports = ref("support_count", 0), wheels = ref("wheel_count", 0), none = 0x7FFFFFFF;
    fmi2Integer whole = 4;
    fmi2Boolean flag = fmi2True;
    fmi2Real real = 3;
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2SetInteger(c, &method, 1, &whole));
    whole = 0;
    OK(fmi2GetInteger(c, &method, 1, &whole));
    TEST_ASSERT_EQUAL_INT(4, whole);
    OK(fmi2GetInteger(c, &wheels, 1, &whole));
    TEST_ASSERT_EQUAL_INT(4, whole);
    OK(fmi2GetInteger(c, &supports, 1, &whole));
    TEST_ASSERT_EQUAL_INT(0, whole);
    OK(fmi2SetBoolean(c, &locked, 1, &flag));
    flag = fmi2False;
    OK(fmi2GetBoolean(c, &locked, 1, &flag));
    TEST_ASSERT_EQUAL_INT(fmi2True, flag);
    ASSERT_REFUSED(fmi2GetReal(c, &method, 1, &real), "method is an Enumeration, not a Float64");
    ASSERT_REFUSED(fmi2GetInteger(c, &mass, 1, &whole), "mass_kg is a Float64 (Real), not an Int32");
    ASSERT_REFUSED(fmi2GetBoolean(c, &mass, 1, &flag), "not a Boolean");
    ASSERT_REFUSED(fmi2GetReal(c, &none, 1, &real), "no variable with the value reference");
    whole = 8;
    ASSERT_REFUSED(fmi2SetInteger(c, &method, 1, &whole), "method: 8 is outside its range: 0 to 7");
    real = -1;
    ASSERT_REFUSED(fmi2SetReal(c, &mass, 1, &real), "mass_kg: -1 is outside its range: at least 0");
    real = NOT_A_NUMBER;
    ASSERT_REFUSED(fmi2SetReal(c, &mass, 1, &real), "mass_kg: nan is not a finite number");
    ASSERT_REFUSED(fmi2SetReal(c, NULL, 1, &real), "is missing (NULL)");
    ASSERT_REFUSED(fmi2GetReal(c, &mass, 1, NULL), "is missing (NULL)");
    ASSERT_REFUSED(fmi2GetString(c, &mass, 1, NULL), "no variables of the kind");
    ASSERT_REFUSED(fmi2SetString(c, &mass, 1, NULL), "no variables of the kind");
    OK(fmi2GetString(c, NULL, 0, NULL));
    OK(fmi2SetString(c, NULL, 0, NULL));
}

static void each_access_is_set_in_its_modes_and_the_refusal_says_when(void) {
    const fmi2ValueReference time = ref("time", 0), x = ref("x_m", 0), energy = ref("energy_J", 0),
                             mass = ref("mass_kg", 0), gain = ref("motor_gain_Nm_per_V", 0);
    const fmi2ValueReference wheels = ref("wheel_count", 0);
    fmi2Integer four = 4;
    fmi2Real one = 1;
    ASSERT_REFUSED(fmi2GetReal(c, &energy, 1, &one), "not allowed in instantiated");
    begin(0, false, 0);
    ASSERT_REFUSED(fmi2SetReal(c, &time, 1, &one), "it is the time");
    ASSERT_REFUSED(fmi2SetReal(c, &x, 1, &one), "it is a state; only Model Exchange sets it");
    ASSERT_REFUSED(fmi2SetReal(c, &energy, 1, &one), "it is computed by the model");
    ASSERT_REFUSED(fmi2SetReal(c, &mass, 1, &one), "it is fixed once initialization has ended");
    ASSERT_REFUSED(fmi2SetInteger(c, &wheels, 1, &four), "it is set in configuration mode");
    OK(fmi2SetReal(c, &gain, 1, &one));
    TEST_ASSERT_TRUE(get("motor_gain_Nm_per_V", 0) == 1);
    OK(fmi2DoStep(c, 0, 0.01, fmi2True));
    OK(fmi2Terminate(c));
    ASSERT_REFUSED(fmi2SetReal(c, &gain, 1, &one), "not allowed in terminated");
    ASSERT_REFUSED(fmi2DoStep(c, 0.01, 0.01, fmi2True), "DoStep is not allowed in terminated");
}

static void a_tuned_motor_moves_on_from_where_it_was(void) {
    begin(0, false, 0);
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 2);
    OK(fmi2DoStep(c, 0, 0.1, fmi2True));
    const double x = get("x_m", 0), speed = get("velocity_body_m_per_s", 1);
    set("motor_gain_Nm_per_V", 0, 0);
    set("motor_damping_Nms", 0, 0);
    TEST_ASSERT_TRUE(get("x_m", 0) == x && fabs(get("velocity_body_m_per_s", 1) - speed) < 1e-12 && speed > 0.01);
    OK(fmi2DoStep(c, 0.1, 0.1, fmi2True));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, x + 0.1 * speed, get("x_m", 0)); /* nothing acts any more */
}

static void steps_that_cannot_be_taken_are_refused_with_their_reason(void) {
    begin(2, true, 3);
    ASSERT_REFUSED(fmi2DoStep(c, 2, 0, fmi2True), "it must be more than 0");
    ASSERT_REFUSED(fmi2DoStep(c, 2, -0.1, fmi2True), "it must be more than 0");
    ASSERT_REFUSED(fmi2DoStep(c, 2, NOT_A_NUMBER, fmi2True), "it is not finite");
    ASSERT_REFUSED(fmi2DoStep(c, NOT_A_NUMBER, 0.1, fmi2True), "that is not finite");
    ASSERT_REFUSED(fmi2DoStep(c, 2.1, 0.1, fmi2True), "but the model is at 2 s");
    ASSERT_REFUSED(fmi2DoStep(c, 2, 1.1, fmi2True), "goes beyond the stop time 3 s");
    OK(fmi2DoStep(c, 2, 1, fmi2True));
    TEST_ASSERT_TRUE(get("time", 0) == 3);
    ASSERT_REFUSED(fmi2DoStep(c, 3, 0.1, fmi2True), "goes beyond the stop time");
    OK(fmi2DoStep(c, 3, 1e-9, fmi2True)); /* the remainder of an importer that adds up its times */
    TEST_ASSERT_TRUE(get("time", 0) == 3);
}

static void a_communication_step_is_whole_internal_steps(void) {
    set("step_s", 0, 0.004);
    begin(0, false, 0);
    OK(fmi2DoStep(c, 0, 0.02, fmi2True));
    TEST_ASSERT_EQUAL_UINT64(5, ((const fmu_instance *)c)->clock.ticks);
    ASSERT_REFUSED(fmi2DoStep(c, 0.02, 0.01, fmi2True), "0.004");
    OK(fmi2DoStep(c, 0.02, 0.008, fmi2True));
    TEST_ASSERT_EQUAL_UINT64(7, ((const fmu_instance *)c)->clock.ticks);
    OK(fmi2DoStep(c, 0.0284, 0.008, fmi2True)); /* half a step off is rounding */
    ASSERT_REFUSED(fmi2DoStep(c, 0.0385, 0.008, fmi2True), "but the model is at");
    TEST_ASSERT_TRUE(get("time", 0) == 9 * 0.004);
}

static void steps_of_many_lengths_keep_the_time(void) {
    begin(0, false, 0);
    double at = 0;
    for (int k = 1; k <= 300; k++) {
        const double step_s = 0.001 * (1 + k % 7);
        OK(fmi2DoStep(c, at, step_s, fmi2True));
        at += step_s;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, at, get("time", 0));
    }
}

static void a_run_that_cannot_begin_says_why(void) {
    ASSERT_REFUSED(fmi2SetupExperiment(c, fmi2False, 0, NOT_A_NUMBER, fmi2False, 0),
                   "the start time nan is not finite");
    ASSERT_REFUSED(fmi2SetupExperiment(c, fmi2False, 0, 2, fmi2True, 1), "is before the start time");
    ASSERT_REFUSED(fmi2SetupExperiment(c, fmi2False, 0, 2, fmi2True, NOT_A_NUMBER), "the stop time nan is not finite");
    OK(fmi2SetupExperiment(c, fmi2False, 0, 2, fmi2True, 2)); /* a run of initial values alone */
    set("mass_kg", 0, 0);
    OK(fmi2EnterInitializationMode(c));
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "mass_kg");
    set("mass_kg", 0, 2);
    OK(fmi2ExitInitializationMode(c));
}

static void reset_brings_the_start_values_back(void) {
    set("mass_kg", 0, 5);
    begin(1, false, 0);
    OK(fmi2DoStep(c, 1, 0.1, fmi2True));
    OK(fmi2Reset(c));
    begin(0, false, 0);
    TEST_ASSERT_TRUE(get("mass_kg", 0) == 24 && get("time", 0) == 0 && get("x_m", 0) == 0);
}

static void the_log_has_the_categories_that_were_chosen(void) {
    const fmi2String errors[1] = {"logStatusError"}, wrong[1] = {"logNothing"}, null[1] = {NULL}, all[1] = {"logAll"};
    OK(fmi2SetDebugLogging(c, fmi2True, 1, all));
    begin(0, false, 0);
    set("motor_gain_Nm_per_V", 0, 0.1);
    log_clear();
    OK(fmi2DoStep(c, 0, 0.1, fmi2True));
    ASSERT_LOGGED("logEvents: the vehicle changed: mass 24 kg");
    const fmi2String warnings[1] = {"logStatusWarning"}, discards[1] = {"logStatusDiscard"};
    OK(fmi2SetDebugLogging(c, fmi2True, 1, warnings));
    TEST_ASSERT_EQUAL_UINT(1, ((const fmu_instance *)c)->log_categories);
    log_clear();
    set("motor_gain_Nm_per_V", 0, 0.12);
    (void)get("x_m", 0);
    TEST_ASSERT_EQUAL_INT(0, lines); /* an event, of another category */
    OK(fmi2SetDebugLogging(c, fmi2True, 1, discards));
    TEST_ASSERT_EQUAL_UINT(2, ((const fmu_instance *)c)->log_categories);
    log_clear();
    set("motor_gain_Nm_per_V", 0, 0.15);
    (void)get("x_m", 0);
    TEST_ASSERT_EQUAL_INT(0, lines); /* an event, of another category */
    OK(fmi2SetDebugLogging(c, fmi2True, 1, errors));
    set("motor_gain_Nm_per_V", 0, 0.2);
    log_clear();
    OK(fmi2DoStep(c, 0.1, 0.1, fmi2True));
    TEST_ASSERT_EQUAL_INT(0, lines);
    log_clear();
    TEST_ASSERT_EQUAL_INT(fmi2Warning, fmi2SetDebugLogging(c, fmi2True, 1, wrong));
    ASSERT_LOGGED("logStatusWarning: SetDebugLogging: there is no category 'logNothing', which is left out; use "
                  "logStatusWarning, logStatusDiscard, logStatusError, logEvents or, for all of them, logAll");
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_INT(fmi2Warning, fmi2SetDebugLogging(c, fmi2True, 1, null));
    ASSERT_LOGGED("there is no category '(null)'");
    ASSERT_REFUSED(fmi2SetDebugLogging(c, fmi2True, 2, NULL), "2 categories and no list of them");
    ASSERT_REFUSED(fmi2SetDebugLogging(c, fmi2True, 1, NULL), "1 categories and no list of them");
    const fmi2String two[2] = {"logStatusError", "logEvents"}, bad[2] = {"logEvents", "logNothing"};
    OK(fmi2SetDebugLogging(c, fmi2True, 2, two));
    set("motor_gain_Nm_per_V", 0, 0.1);
    log_clear();
    (void)get("x_m", 0);
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_INT(fmi2Warning, fmi2SetDebugLogging(c, fmi2True, 2, bad));
    ASSERT_LOGGED("there is no category 'logNothing'");
    TEST_ASSERT_EQUAL_UINT(FMU_LOG_EVENTS, ((const fmu_instance *)c)->log_categories); /* the other one is chosen */
    OK(fmi2SetDebugLogging(c, fmi2False, 0, NULL));
    TEST_ASSERT_EQUAL_UINT(0, ((const fmu_instance *)c)->log_categories);
    ASSERT_REFUSED(fmi2DoStep(c, 0.2, 0, fmi2True), "more than 0"); /* errors are always told */
}

static void what_has_no_use_is_refused_and_statuses_are_told(void) {
    fmi2Status status;
    fmi2Real time;
    fmi2Integer whole;
    fmi2Boolean flag;
    fmi2String text;
    begin(0, false, 0);
    OK(fmi2DoStep(c, 0, 0.25, fmi2True));
    ASSERT_REFUSED(fmi2CancelStep(c), "CancelStep is not allowed in step mode: no step is running");
    OK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time));
    TEST_ASSERT_TRUE(time == 0.25);
    TEST_ASSERT_TRUE(fmi2GetStatus(c, fmi2DoStepStatus, &status) != fmi2OK);
    TEST_ASSERT_TRUE(fmi2GetIntegerStatus(c, fmi2DoStepStatus, &whole) != fmi2OK);
    TEST_ASSERT_TRUE(fmi2GetStringStatus(c, fmi2PendingStatus, &text) != fmi2OK);
    flag = fmi2True;
    OK(fmi2GetBooleanStatus(c, fmi2Terminated, &flag));
    TEST_ASSERT_EQUAL_INT(fmi2False, flag);
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2GetBooleanStatus(c, fmi2DoStepStatus, &flag)); /* none is ever pending */
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2GetBooleanStatus(c, fmi2Terminated, NULL));
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2GetRealStatus(c, fmi2LastSuccessfulTime, NULL));
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2GetRealStatus(c, fmi2DoStepStatus, &time));
    ASSERT_REFUSED(fmi2EnterEventMode(c), "EnterEventMode is not allowed");
    ASSERT_REFUSED(fmi2SetTime(c, 1), "SetTime is not allowed");
}

static void outputs_have_derivatives_and_inputs_may_have_slopes(void) {
    const fmi2ValueReference x = ref("x_m", 0), voltage = ref("voltage_V", 1), mass = ref("mass_kg", 0);
    const fmi2Integer first = 1, second = 2;
    fmi2Real value = 0, slope = 3;
    begin(0, false, 0);
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 2);
    OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &voltage, 1, &second, &slope), "order");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &mass, 1, &first, &slope), "mass_kg");
    for (int k = 0; k < 10; k++) OK(fmi2DoStep(c, k * 0.1, 0.1, fmi2True));
    OK(fmi2GetRealOutputDerivatives(c, &x, 1, &first, &value));
    const double heading = get("heading_rad", 0), along = get("velocity_body_m_per_s", 1),
                 across = get("velocity_body_m_per_s", 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, along * cos(heading) - across * sin(heading), value);
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, &mass, 1, &first, &value), "mass_kg");
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, &x, 1, &second, &value), "order");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(nothing_is_made_without_name_token_kind_or_callbacks);
    RUN_TEST(the_log_goes_to_the_importer_s_environment_in_lines_of_511_letters);
    RUN_TEST(a_line_that_was_cut_is_told_to_its_end);
    RUN_TEST(all_percent_signs_of_a_line_are_doubled);
    RUN_TEST(the_log_has_the_name_of_the_instance);
    RUN_TEST(a_step_has_the_bits_of_the_core);
    RUN_TEST(every_type_has_its_functions_and_refuses_the_others);
    RUN_TEST(each_access_is_set_in_its_modes_and_the_refusal_says_when);
    RUN_TEST(a_tuned_motor_moves_on_from_where_it_was);
    RUN_TEST(steps_that_cannot_be_taken_are_refused_with_their_reason);
    RUN_TEST(a_communication_step_is_whole_internal_steps);
    RUN_TEST(steps_of_many_lengths_keep_the_time);
    RUN_TEST(a_run_that_cannot_begin_says_why);
    RUN_TEST(reset_brings_the_start_values_back);
    RUN_TEST(the_log_has_the_categories_that_were_chosen);
    RUN_TEST(what_has_no_use_is_refused_and_statuses_are_told);
    RUN_TEST(outputs_have_derivatives_and_inputs_may_have_slopes);
    return UNITY_END();
}
