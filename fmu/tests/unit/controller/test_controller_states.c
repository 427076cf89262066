/* Tests of controller/model.c: what a saved state holds, what is computed when, and where its arrays end. */
#include "bytes_bench.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* Start values of the description. */
#define KP 0.5
#define KI 2.0
#define LIMIT 24.0

/* ------------------------------------------------------------------------------------------ saved states -- */

static void every_member_comes_back_in_another_instance(void) {
    for (int flag = 0; flag < 3; flag++) {
        fmu_model *model = &instance()->model;
        FILL(model->time_s);
        FILL(model->proportional_Vs_per_rad);
        FILL(model->integral_V_per_rad);
        FILL(model->limit_V);
        FILL(model->setpoint_rad_per_s);
        FILL(model->speed_rad_per_s);
        FILL(model->error_rad);
        FILL(model->step_s);
        model->wheel_count = 16 - flag;
        model->start_needed = flag == 0;
        model->change_needed = flag == 1;
        model->states_changed = flag == 2;
        model->stale = 0;
        const fmu_model before = *model;
        into_another(fmi2CoSimulation);
        const fmu_model *after = &instance()->model;
        COMES_BACK(start_needed);
        COMES_BACK(change_needed);
        COMES_BACK(states_changed);
        COMES_BACK(time_s);
        COMES_BACK(wheel_count);
        COMES_BACK(proportional_Vs_per_rad);
        COMES_BACK(integral_V_per_rad);
        COMES_BACK(limit_V);
        COMES_BACK(setpoint_rad_per_s);
        COMES_BACK(speed_rad_per_s);
        COMES_BACK(error_rad);
        COMES_BACK(step_s);
        TEST_ASSERT_EQUAL_UINT32(FMU_GROUPS_ALL, after->stale);
    }
}

/* Three flags, time, wheels, two gains, limit and step; three numbers of each of sixteen wheels. */
static void a_state_has_each_number_once(void) {
    fmu_stream counter = {0};
    TEST_ASSERT_TRUE(fmu_model_serialize(&counter, &instance()->model));
    TEST_ASSERT_EQUAL_size_t(8 * (9 + 3 * 16), counter.at);
}

/* start.bin may say that the number of wheels is a constant, 0. */
static void a_controller_without_wheels_is_a_possible_state(void) {
    instance()->model.wheel_count = 0;
    into_another(fmi2CoSimulation);
    TEST_ASSERT_EQUAL_INT32(0, instance()->model.wheel_count);
}

/* ------------------------------------------------------------------------------- what is computed when -- */

static void inputs_are_read_before_initialization_and_outputs_are_not(void) {
    fmi3Instance i = make_3(false);
    const fmi3ValueReference inputs[2] = {ref("setpoint_rad_per_s", 2), ref("wheel_speed_rad_per_s", 2)};
    const char *const outputs[3] = {"angle_error_rad", "voltage_V", "der(angle_error_rad)"};
    double values[2] = {7, 8};
    TEST_ASSERT_NOT_NULL(i);
    OK(fmi3SetFloat64(i, inputs, 2, values, 2));
    values[0] = values[1] = 0;
    OK(fmi3GetFloat64(i, &inputs[0], 1, &values[0], 1));
    OK(fmi3GetFloat64(i, &inputs[1], 1, &values[1], 1));
    TEST_ASSERT_TRUE(values[0] == 7 && values[1] == 8);
    for (size_t k = 0; k < 3; k++) {
        const fmi3ValueReference output = ref(outputs[k], 1);
        ASSERT_REFUSED(fmi3GetFloat64(i, &output, 1, values, 1), "it has no value before initialization");
    }
    fmi3FreeInstance(i);
}

/* Marks in the place of outputs stay where they are not asked for. */
static void only_what_is_asked_for_is_computed(void) {
    fmu_model *model = &instance()->model;
    initialise();
    set("setpoint_rad_per_s", 1, 6);
    model->voltage_V[0] = model->error_rate_rad_per_s[0] = 77;
    TEST_ASSERT_TRUE(get("angle_error_rad", 1) == 0);
    TEST_ASSERT_TRUE(model->voltage_V[0] == 77 && model->error_rate_rad_per_s[0] == 77);
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 6 * KP);
    TEST_ASSERT_TRUE(model->error_rate_rad_per_s[0] == 77);
    TEST_ASSERT_TRUE(get("der(angle_error_rad)", 1) == 6);
}

static void a_tuned_gain_is_taken_up_once(void) {
    fmu_model *model = &instance()->model;
    initialise();
    set("setpoint_rad_per_s", 1, 6);
    set("proportional_gain_Vs_per_rad", 0, 1);
    TEST_ASSERT_TRUE(model->change_needed && get("voltage_V", 1) == 6 && !model->change_needed);
    model->voltage_V[0] = 5; /* a mark: nothing is computed anew */
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 5);
}

/* Nothing has been read since the input was set. */
static void outputs_change_in_time_by_inputs_that_were_set_last(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    double rate = 0;
    initialise();
    set("setpoint_rad_per_s", 1, 6);
    OK(step(0, 0.1));
    set("setpoint_rad_per_s", 1, 3);
    OK(fmi2GetRealOutputDerivatives(c, &voltage, 1, &first, &rate));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, KI * 3, rate);
}

/* The glue asks each model; this one has no internal step of its own. */
static void a_communication_step_is_one_internal_step(void) {
    uint64_t steps = 7;
    TEST_ASSERT_TRUE(fmu_model_own_step(&instance()->model) == 0);
    OK(fmu_model_count_steps(instance(), 0.3, 0.1, &steps));
    TEST_ASSERT_EQUAL_UINT64(1, steps);
}

/* ----------------------------------------------------------------------------------------------- the law -- */

/* Beyond its limit the integral is held whatever the size of the error. */
static void a_small_error_holds_the_integral_too(void) {
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (uint32_t k = 1; k <= 2; k++) {
        const double sign = k == 1 ? 1 : -1;
        set("angle_error_rad", k, sign * LIMIT);
        set("setpoint_rad_per_s", k, sign * 0.25);
        TEST_ASSERT_TRUE(get("voltage_V", k) == sign * LIMIT && get("der(angle_error_rad)", k) == 0);
        set("setpoint_rad_per_s", k, sign * -0.25); /* the error drives it back */
        TEST_ASSERT_TRUE(get("der(angle_error_rad)", k) == sign * -0.25);
    }
}

/* -------------------------------------------------------------------------------------- where arrays end -- */

/* Who asks has place for just as many. */
static void no_more_states_are_written_than_there_are(void) {
    double rates[5] = {9, 9, 9, 9, 9}, nominals[5] = {9, 9, 9, 9, 9}, states[5] = {9, 9, 9, 9, 9};
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    fmu_model_get_rates(instance(), rates);
    OK(fmi2GetNominalsOfContinuousStates(c, nominals, 4));
    OK(fmi2GetContinuousStates(c, states, 4));
    TEST_ASSERT_TRUE(rates[3] == 0 && nominals[3] == 1 && states[3] == 0);
    TEST_ASSERT_TRUE(rates[4] == 9 && nominals[4] == 9 && states[4] == 9);
    states[4] = 5;
    OK(fmi2SetContinuousStates(c, states, 4));
    TEST_ASSERT_TRUE(instance()->model.error_rad[4] == 0);
}

/* The arrays of the model and of its derivatives are full then. */
static void sixteen_wheels_have_derivatives_each(void) {
    const double seeds[2] = {1, 3};
    const fmi2Integer first = 1;
    double found = 0;
    instance()->initial.wheel_count = FMU_MODEL_LARGEST_ARRAY;
    OK(fmi2Reset(c));
    initialise();
    for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++) set("setpoint_rad_per_s", k, k);
    OK(step(0, 0.25));
    for (uint32_t k = 1; k <= FMU_MODEL_LARGEST_ARRAY; k++) {
        const fmi2ValueReference voltage = ref("voltage_V", k), rate = ref("der(angle_error_rad)", k);
        const fmi2ValueReference by[2] = {ref("setpoint_rad_per_s", k), ref("wheel_speed_rad_per_s", k)};
        OK(fmi2GetDirectionalDerivative(c, &voltage, 1, by, 2, seeds, &found));
        TEST_ASSERT_TRUE(found == -2 * KP);
        OK(fmi2GetDirectionalDerivative(c, &rate, 1, by, 2, seeds, &found));
        TEST_ASSERT_TRUE(found == -2);
        OK(fmi2GetRealOutputDerivatives(c, &voltage, 1, &first, &found));
        TEST_ASSERT_TRUE(found == KI * k);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_member_comes_back_in_another_instance);
    RUN_TEST(a_state_has_each_number_once);
    RUN_TEST(a_controller_without_wheels_is_a_possible_state);
    RUN_TEST(inputs_are_read_before_initialization_and_outputs_are_not);
    RUN_TEST(only_what_is_asked_for_is_computed);
    RUN_TEST(a_tuned_gain_is_taken_up_once);
    RUN_TEST(outputs_change_in_time_by_inputs_that_were_set_last);
    RUN_TEST(a_communication_step_is_one_internal_step);
    RUN_TEST(a_small_error_holds_the_integral_too);
    RUN_TEST(no_more_states_are_written_than_there_are);
    RUN_TEST(sixteen_wheels_have_derivatives_each);
    return UNITY_END();
}
