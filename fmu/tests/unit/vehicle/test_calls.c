/* Tests that every function of both versions refuses an instance that is none, and a call that its mode does not allow,
 * and says so; and that functions for what the FMU lacks succeed with an empty list alone. */
#include "fmi_bench.h"

static fmi2Component c;
static fmi3Instance i;

/* What the calls below may read and write. */
static double real[8], at_s;
static uint64_t unsigned_8[1];
static uint32_t unsigned_4[1];
static uint16_t unsigned_2[1];
static uint8_t unsigned_1[1];
static int64_t signed_8[1];
static int32_t signed_4[1];
static int16_t signed_2[1];
static int8_t signed_1[1];
static float single[1];
static bool flag[1], told[4];
static fmi2Boolean flag_2[1];
static fmi2String text[1];
static fmi3Binary binary[1];
static fmi3IntervalQualifier qualifier[1];
static size_t size;
static fmi2Status status_2;
static fmi2EventInfo info;
static fmi2FMUstate state_2;
static fmi3FMUState state_3;
static const uint32_t none[1] = {0x7FFFFFFF};

void setUp(void) {
    log_clear();
    c = NULL;
    i = NULL;
}
void tearDown(void) {
    fmi2FreeInstance(c);
    fmi3FreeInstance(i);
}

/* Calls of FMI 2 by kind of FMU; X is what is made of each. */
#define OF_BOTH_2(X) \
    X(fmi2SetDebugLogging(c, fmi2True, 0, NULL)) \
    X(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0)) \
    X(fmi2EnterInitializationMode(c)) \
    X(fmi2ExitInitializationMode(c)) \
    X(fmi2Terminate(c)) \
    X(fmi2Reset(c)) \
    X(fmi2GetReal(c, none, 0, real)) \
    X(fmi2SetReal(c, none, 0, real)) \
    X(fmi2GetInteger(c, none, 0, signed_4)) \
    X(fmi2SetInteger(c, none, 0, signed_4)) \
    X(fmi2GetBoolean(c, none, 0, flag_2)) \
    X(fmi2SetBoolean(c, none, 0, flag_2)) \
    X(fmi2GetString(c, none, 0, text)) \
    X(fmi2SetString(c, none, 0, text)) \
    X(fmi2GetFMUstate(c, &state_2)) \
    X(fmi2SetFMUstate(c, state_2)) \
    X(fmi2FreeFMUstate(c, &state_2)) \
    X(fmi2SerializedFMUstateSize(c, state_2, &size)) \
    X(fmi2SerializeFMUstate(c, state_2, (fmi2Byte *)real, sizeof real)) \
    X(fmi2DeSerializeFMUstate(c, (const fmi2Byte *)real, sizeof real, &state_2)) \
    X(fmi2GetDirectionalDerivative(c, none, 0, none, 0, real, real))
#define OF_SIMULATION_2(X) \
    X(fmi2SetRealInputDerivatives(c, none, 0, signed_4, real)) \
    X(fmi2GetRealOutputDerivatives(c, none, 0, signed_4, real)) \
    X(fmi2DoStep(c, 0, 0.01, fmi2True)) \
    X(fmi2CancelStep(c)) \
    X(fmi2GetStatus(c, fmi2DoStepStatus, &status_2)) \
    X(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, real)) \
    X(fmi2GetRealStatus(c, fmi2PendingStatus, real)) \
    X(fmi2GetIntegerStatus(c, fmi2PendingStatus, signed_4)) \
    X(fmi2GetBooleanStatus(c, fmi2Terminated, flag_2)) \
    X(fmi2GetBooleanStatus(c, fmi2Terminated, NULL)) \
    X(fmi2GetStringStatus(c, fmi2PendingStatus, text))
#define OF_EXCHANGE_2(X) \
    X(fmi2EnterEventMode(c)) \
    X(fmi2NewDiscreteStates(c, &info)) \
    X(fmi2EnterContinuousTimeMode(c)) \
    X(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL)) \
    X(fmi2SetTime(c, 0)) \
    X(fmi2SetContinuousStates(c, real, 0)) \
    X(fmi2GetDerivatives(c, real, 0)) \
    X(fmi2GetEventIndicators(c, real, 0)) \
    X(fmi2GetContinuousStates(c, real, 0)) \
    X(fmi2GetNominalsOfContinuousStates(c, real, 0))

/* The same of FMI 3. */
#define TYPE_3(X, Name, values) \
    X(fmi3Get##Name(i, none, 0, values, 0)) \
    X(fmi3Set##Name(i, none, 0, values, 0))
#define LACKING_3(X, asked, given) \
    X(fmi3GetFloat32(i, none, asked, single, given)) \
    X(fmi3SetFloat32(i, none, asked, single, given)) \
    X(fmi3GetInt8(i, none, asked, signed_1, given)) \
    X(fmi3SetInt8(i, none, asked, signed_1, given)) \
    X(fmi3GetUInt8(i, none, asked, unsigned_1, given)) \
    X(fmi3SetUInt8(i, none, asked, unsigned_1, given)) \
    X(fmi3GetInt16(i, none, asked, signed_2, given)) \
    X(fmi3SetInt16(i, none, asked, signed_2, given)) \
    X(fmi3GetUInt16(i, none, asked, unsigned_2, given)) \
    X(fmi3SetUInt16(i, none, asked, unsigned_2, given)) \
    X(fmi3GetUInt32(i, none, asked, unsigned_4, given)) \
    X(fmi3SetUInt32(i, none, asked, unsigned_4, given)) \
    X(fmi3GetString(i, none, asked, text, given)) \
    X(fmi3SetString(i, none, asked, text, given)) \
    X(fmi3GetBinary(i, none, asked, &size, binary, given)) \
    X(fmi3SetBinary(i, none, asked, &size, binary, given)) \
    X(fmi3GetClock(i, none, asked, flag)) \
    X(fmi3SetClock(i, none, asked, flag)) \
    X(fmi3GetShiftDecimal(i, none, asked, real)) \
    X(fmi3SetShiftDecimal(i, none, asked, real)) \
    X(fmi3GetIntervalDecimal(i, none, asked, real, qualifier)) \
    X(fmi3SetIntervalDecimal(i, none, asked, real)) \
    X(fmi3GetShiftFraction(i, none, asked, unsigned_8, unsigned_8)) \
    X(fmi3SetShiftFraction(i, none, asked, unsigned_8, unsigned_8)) \
    X(fmi3GetIntervalFraction(i, none, asked, unsigned_8, unsigned_8, qualifier)) \
    X(fmi3SetIntervalFraction(i, none, asked, unsigned_8, unsigned_8))
#define LACKING_AND_EMPTY(X) LACKING_3(X, 0, 0)
#define OF_BOTH_3(X) \
    X(fmi3SetDebugLogging(i, true, 0, NULL)) \
    X(fmi3EnterConfigurationMode(i)) \
    X(fmi3ExitConfigurationMode(i)) \
    X(fmi3EnterInitializationMode(i, false, 0, 0, false, 0)) \
    X(fmi3ExitInitializationMode(i)) \
    X(fmi3EnterEventMode(i)) \
    X(fmi3Terminate(i)) \
    X(fmi3Reset(i)) \
    TYPE_3(X, Float64, real) \
    TYPE_3(X, Int32, signed_4) \
    TYPE_3(X, Int64, signed_8) \
    TYPE_3(X, UInt64, unsigned_8) \
    TYPE_3(X, Boolean, flag) \
    X(fmi3EvaluateDiscreteStates(i)) \
    X(fmi3ActivateModelPartition(i, 0, 0)) \
    X(fmi3GetNumberOfVariableDependencies(i, 0, &size)) \
    X(fmi3GetVariableDependencies(i, 0, &size, unsigned_4, &size, NULL, 1)) \
    X(fmi3GetFMUState(i, &state_3)) \
    X(fmi3SetFMUState(i, state_3)) \
    X(fmi3FreeFMUState(i, &state_3)) \
    X(fmi3SerializedFMUStateSize(i, state_3, &size)) \
    X(fmi3SerializeFMUState(i, state_3, (fmi3Byte *)real, sizeof real)) \
    X(fmi3DeserializeFMUState(i, (const fmi3Byte *)real, sizeof real, &state_3)) \
    X(fmi3GetDirectionalDerivative(i, none, 0, none, 0, real, 0, real, 0)) \
    X(fmi3GetAdjointDerivative(i, none, 0, none, 0, real, 0, real, 0)) \
    X(fmi3UpdateDiscreteStates(i, told, told, told, told, told, &at_s))
#define OF_EXCHANGE_3(X) \
    X(fmi3EnterContinuousTimeMode(i)) \
    X(fmi3CompletedIntegratorStep(i, true, NULL, NULL)) \
    X(fmi3SetTime(i, 0)) \
    X(fmi3SetContinuousStates(i, real, 0)) \
    X(fmi3GetContinuousStateDerivatives(i, real, 0)) \
    X(fmi3GetEventIndicators(i, real, 0)) \
    X(fmi3GetContinuousStates(i, real, 0)) \
    X(fmi3GetNominalsOfContinuousStates(i, real, 0)) \
    X(fmi3GetNumberOfEventIndicators(i, &size)) \
    X(fmi3GetNumberOfContinuousStates(i, &size))
#define OF_SIMULATION_3(X) \
    X(fmi3GetOutputDerivatives(i, none, 0, signed_4, real, 0)) \
    X(fmi3EnterStepMode(i)) \
    X(fmi3DoStep(i, 0, 0.01, true, told, told, told, &at_s))

#define IS_ERROR(call) TEST_ASSERT_EQUAL_INT_MESSAGE(3, (int)(call), #call);
#define IS_OK(call) TEST_ASSERT_EQUAL_INT_MESSAGE(0, (int)(call), #call);
#define IS_NOT_ALLOWED(call) \
    log_clear(); \
    TEST_ASSERT_EQUAL_INT_MESSAGE(3, (int)(call), #call); \
    ASSERT_LOGGED("is not allowed in");
#define IS_LACKING(call) \
    log_clear(); \
    TEST_ASSERT_EQUAL_INT_MESSAGE(3, (int)(call), #call); \
    TEST_ASSERT_EQUAL_INT(1, lines);

static void an_instance_that_is_none_is_refused_by_every_function(void) {
    OF_BOTH_2(IS_ERROR)
    OF_SIMULATION_2(IS_ERROR)
    OF_EXCHANGE_2(IS_ERROR)
    OF_BOTH_3(IS_ERROR)
    OF_EXCHANGE_3(IS_ERROR)
    OF_SIMULATION_3(IS_ERROR)
    LACKING_AND_EMPTY(IS_ERROR)
}

static void each_kind_refuses_the_functions_of_the_other(void) {
    c = make_2(fmi2ModelExchange, fmu_token_2);
    OF_SIMULATION_2(IS_NOT_ALLOWED)
    fmi2FreeInstance(c);
    c = make_2(fmi2CoSimulation, fmu_token_2);
    OF_EXCHANGE_2(IS_NOT_ALLOWED)
    i = make_3(false);
    OF_EXCHANGE_3(IS_NOT_ALLOWED)
    fmi3FreeInstance(i);
    i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    OF_SIMULATION_3(IS_NOT_ALLOWED)
}

/* Before it is initialised an FMU has no values to read; when it has ended, none to be set. */
static void calls_come_in_their_order(void) {
    c = make_2(fmi2CoSimulation, fmu_token_2);
    IS_NOT_ALLOWED(fmi2GetReal(c, none, 0, real))
    IS_NOT_ALLOWED(fmi2GetInteger(c, none, 0, signed_4))
    IS_NOT_ALLOWED(fmi2GetBoolean(c, none, 0, flag_2))
    IS_NOT_ALLOWED(fmi2GetString(c, none, 0, text))
    IS_NOT_ALLOWED(fmi2GetDirectionalDerivative(c, none, 0, none, 0, real, real))
    IS_NOT_ALLOWED(fmi2ExitInitializationMode(c))
    IS_NOT_ALLOWED(fmi2Terminate(c))
    IS_NOT_ALLOWED(fmi2DoStep(c, 0, 0.01, fmi2True))
    OK(fmi2EnterInitializationMode(c));
    IS_NOT_ALLOWED(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0))
    IS_NOT_ALLOWED(fmi2EnterInitializationMode(c))
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2Terminate(c));
    IS_NOT_ALLOWED(fmi2SetReal(c, none, 0, real))
    IS_NOT_ALLOWED(fmi2SetInteger(c, none, 0, signed_4))
    IS_NOT_ALLOWED(fmi2SetBoolean(c, none, 0, flag_2))
    IS_NOT_ALLOWED(fmi2SetString(c, none, 0, text))
    IS_NOT_ALLOWED(fmi2SetRealInputDerivatives(c, none, 0, signed_4, real))
    i = make_3(false);
    IS_NOT_ALLOWED(fmi3ExitConfigurationMode(i))
    IS_NOT_ALLOWED(fmi3ExitInitializationMode(i))
    IS_NOT_ALLOWED(fmi3EnterEventMode(i))
    IS_NOT_ALLOWED(fmi3Terminate(i))
    IS_NOT_ALLOWED(fmi3EvaluateDiscreteStates(i))
    IS_NOT_ALLOWED(fmi3UpdateDiscreteStates(i, told, told, told, told, told, &at_s))
    IS_NOT_ALLOWED(fmi3GetDirectionalDerivative(i, none, 0, none, 0, real, 0, real, 0))
    IS_NOT_ALLOWED(fmi3GetAdjointDerivative(i, none, 0, none, 0, real, 0, real, 0))
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    IS_NOT_ALLOWED(fmi3EnterConfigurationMode(i))
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3EnterEventMode(i), "the instance was made without event mode");
    OK(fmi3Terminate(i));
    IS_NOT_ALLOWED(fmi3SetFloat64(i, none, 0, real, 0))
    IS_NOT_ALLOWED(fmi3SetInt32(i, none, 0, signed_4, 0))
    IS_NOT_ALLOWED(fmi3SetInt64(i, none, 0, signed_8, 0))
    IS_NOT_ALLOWED(fmi3SetUInt64(i, none, 0, unsigned_8, 0))
    IS_NOT_ALLOWED(fmi3SetBoolean(i, none, 0, flag, 0))
}

#define LACKING_AND_ASKED(X) LACKING_3(X, 1, 0)
#define LACKING_AND_GIVEN(X) LACKING_3(X, 1, 1)

static void what_the_fmu_lacks_is_an_empty_list(void) {
    i = make_3(false);
    LACKING_AND_EMPTY(IS_OK)
    LACKING_AND_ASKED(IS_LACKING)
    LACKING_AND_GIVEN(IS_LACKING)
    ASSERT_REFUSED(fmi3ActivateModelPartition(i, 0, 0), "no Scheduled Execution");
    ASSERT_REFUSED(fmi3GetNumberOfVariableDependencies(i, 0, &size), "see ModelStructure");
    ASSERT_REFUSED(fmi3GetVariableDependencies(i, 0, &size, unsigned_4, &size, NULL, 1), "see ModelStructure");
    c = make_2(fmi2CoSimulation, fmu_token_2);
    OK(fmi2EnterInitializationMode(c));
    IS_OK(fmi2GetString(c, none, 0, text))
    IS_OK(fmi2SetString(c, none, 0, text))
    IS_LACKING(fmi2GetString(c, none, 1, text))
    IS_LACKING(fmi2SetString(c, none, 1, text))
}

/* In a call of the importer from within a step most functions would change what the step works on. */
static int visits;
static void within_a_step(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested,
                          fmi3Boolean get_allowed, fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early,
                          fmi3Float64 *early_time) {
    (void)e, (void)time, (void)set_requested, (void)get_allowed, (void)finished, (void)can_return;
    visits++;
    IS_NOT_ALLOWED(fmi3SetDebugLogging(i, true, 0, NULL))
    IS_NOT_ALLOWED(fmi3EnterInitializationMode(i, false, 0, 0, false, 0))
    IS_NOT_ALLOWED(fmi3Reset(i))
    IS_NOT_ALLOWED(fmi3SetInt32(i, none, 0, signed_4, 0))
    IS_NOT_ALLOWED(fmi3GetFMUState(i, &state_3))
    IS_NOT_ALLOWED(fmi3SetFMUState(i, state_3))
    IS_NOT_ALLOWED(fmi3FreeFMUState(i, &state_3))
    IS_NOT_ALLOWED(fmi3SerializedFMUStateSize(i, state_3, &size))
    IS_NOT_ALLOWED(fmi3SerializeFMUState(i, state_3, (fmi3Byte *)real, sizeof real))
    IS_NOT_ALLOWED(fmi3DeserializeFMUState(i, (const fmi3Byte *)real, sizeof real, &state_3))
    IS_NOT_ALLOWED(fmi3GetNumberOfVariableDependencies(i, 0, &size))
    IS_NOT_ALLOWED(fmi3GetVariableDependencies(i, 0, &size, unsigned_4, &size, NULL, 1))
    IS_NOT_ALLOWED(fmi3SetBinary(i, none, 0, &size, binary, 0))
    IS_NOT_ALLOWED(fmi3GetClock(i, none, 0, flag))
    IS_NOT_ALLOWED(fmi3SetIntervalFraction(i, none, 0, unsigned_8, unsigned_8))
    IS_NOT_ALLOWED(fmi3DoStep(i, 0, 0.01, true, told, told, told, &at_s))
    IS_OK(fmi3GetFloat64(i, none, 0, real, 0))
    *early = false;
    *early_time = time;
}

static void from_within_a_step_values_alone_are_read_and_set(void) {
    i = fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, true, NULL, 0, NULL, log_3,
                                    within_a_step);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3DoStep(i, 0, 0.02, true, NULL, NULL, NULL, NULL));
    TEST_ASSERT_TRUE(visits > 0);
}

/* A whole run of each kind by FMI 3, with states kept as bytes. */
static void a_run_by_fmi_3_is_kept_and_taken_up_again(void) {
    static fmi3Byte bytes[65536];
    const fmi3ValueReference voltage = ref("voltage_V", 0), x = ref("x_m", 0);
    const double volts[4] = {3, 2, 1, 4};
    double there, again;
    i = make_3(true);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3EvaluateDiscreteStates(i));
    OK(fmi3EnterStepMode(i));
    OK(fmi3SetFloat64(i, &voltage, 1, volts, 4));
    OK(fmi3DoStep(i, 0, 0.1, true, told, told, told, &at_s));
    OK(fmi3GetFMUState(i, &state_3));
    OK(fmi3SerializedFMUStateSize(i, state_3, &size));
    TEST_ASSERT_TRUE(size < sizeof bytes);
    OK(fmi3SerializeFMUState(i, state_3, bytes, size));
    OK(fmi3FreeFMUState(i, &state_3));
    OK(fmi3DoStep(i, 0.1, 0.1, true, told, told, told, &at_s));
    OK(fmi3GetFloat64(i, &x, 1, &there, 1));
    OK(fmi3DeserializeFMUState(i, bytes, size, &state_3));
    OK(fmi3SetFMUState(i, state_3));
    OK(fmi3FreeFMUState(i, &state_3));
    OK(fmi3DoStep(i, 0.1, 0.1, true, told, told, told, &at_s));
    OK(fmi3GetFloat64(i, &x, 1, &again, 1));
    TEST_ASSERT_TRUE(there == again && there != 0);
    const fmi3Int32 first = 1, second = 2;
    double rate;
    OK(fmi3GetOutputDerivatives(i, &x, 1, &first, &rate, 1));
    TEST_ASSERT_TRUE(isfinite(rate) && rate != 0);
    ASSERT_REFUSED(fmi3GetOutputDerivatives(i, &x, 1, &second, &rate, 1), "order");
}

static void states_by_fmi_3_are_those_of_fmi_2(void) {
    double found[10], rate[10], nominal[10], other[10];
    size_t count = 0;
    i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, true, 2));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3GetNumberOfContinuousStates(i, &count));
    TEST_ASSERT_EQUAL_size_t(10, count);
    ASSERT_REFUSED(fmi3GetNumberOfContinuousStates(i, NULL), "is missing (NULL)");
    ASSERT_REFUSED(fmi3GetNumberOfEventIndicators(i, NULL), "is missing (NULL)");
    OK(fmi3EnterContinuousTimeMode(i));
    OK(fmi3SetTime(i, 0.5));
    for (int k = 0; k < 10; k++) other[k] = k < 3 ? 0.3 * k - 0.2 : 0.1 * k;
    OK(fmi3SetContinuousStates(i, other, 10));
    OK(fmi3GetContinuousStates(i, found, 10));
    for (int k = 0; k < 10; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-14, other[k], found[k]);
    OK(fmi3GetContinuousStateDerivatives(i, rate, 10));
    OK(fmi3GetNominalsOfContinuousStates(i, nominal, 10));
    OK(fmi3GetEventIndicators(i, NULL, 0));
    told[0] = told[1] = true;
    OK(fmi3CompletedIntegratorStep(i, true, &told[0], &told[1]));
    TEST_ASSERT_FALSE(told[0] || told[1]);
    OK(fmi3EnterEventMode(i));
    c = make_2(fmi2ModelExchange, fmu_token_2);
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2EnterContinuousTimeMode(c));
    OK(fmi2SetContinuousStates(c, found, 10));
    OK(fmi2GetDerivatives(c, other, 10));
    TEST_ASSERT_EQUAL_MEMORY(rate, other, sizeof rate);
    flag_2[0] = fmi2True;
    OK(fmi2CompletedIntegratorStep(c, fmi2True, flag_2, flag_2));
    TEST_ASSERT_EQUAL_INT(fmi2False, flag_2[0]);
    OK(fmi2EnterEventMode(c));
    ASSERT_REFUSED(fmi2NewDiscreteStates(c, NULL), "event information is missing (NULL)");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_instance_that_is_none_is_refused_by_every_function);
    RUN_TEST(each_kind_refuses_the_functions_of_the_other);
    RUN_TEST(calls_come_in_their_order);
    RUN_TEST(what_the_fmu_lacks_is_an_empty_list);
    RUN_TEST(from_within_a_step_values_alone_are_read_and_set);
    RUN_TEST(a_run_by_fmi_3_is_kept_and_taken_up_again);
    RUN_TEST(states_by_fmi_3_are_those_of_fmi_2);
    return UNITY_END();
}
