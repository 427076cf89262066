/* Tests of model_exchange.c and partial_derivatives.c: continuous states, their rates, and derivatives of both. */
#include "fmi_bench.h"

#define STATES (3 + 3 + 4) /* ν, pose, wheel angles */

static fmi2Component c;

void setUp(void) {
    log_clear();
    c = make_2(fmi2ModelExchange, fmu_token_2);
    TEST_ASSERT_NOT_NULL(c);
}
void tearDown(void) { fmi2FreeInstance(c); }

static void begin(bool has_stop, double stop_s) {
    fmi2EventInfo info;
    OK(fmi2SetupExperiment(c, fmi2False, 0, 0, has_stop, stop_s));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2NewDiscreteStates(c, &info));
    TEST_ASSERT_FALSE(info.newDiscreteStatesNeeded || info.terminateSimulation || info.nextEventTimeDefined);
    OK(fmi2EnterContinuousTimeMode(c));
}

static const double here[STATES] = {0.5, -0.3, 0.2, 1, 2, 0.7, 0, 0, 0, 0};

static void an_event_has_no_next_one(void) {
    fmi2EventInfo info;
    memset(&info, 0x7F, sizeof info);
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2NewDiscreteStates(c, &info));
    TEST_ASSERT_TRUE(!info.newDiscreteStatesNeeded && !info.terminateSimulation && !info.nextEventTimeDefined);
    TEST_ASSERT_TRUE(!info.nominalsOfContinuousStatesChanged && !info.valuesOfContinuousStatesChanged);
    TEST_ASSERT_TRUE(info.nextEventTime == 0);
}

/* As many as there are, and no further. */
static void states_are_read_into_their_places_alone(void) {
    double found[STATES + 1];
    begin(false, 0);
    found[STATES] = 77;
    OK(fmi2GetContinuousStates(c, found, STATES));
    TEST_ASSERT_TRUE(found[STATES] == 77);
    OK(fmi2GetDerivatives(c, found, STATES));
    TEST_ASSERT_TRUE(found[STATES] == 77);
    OK(fmi2GetNominalsOfContinuousStates(c, found, STATES));
    TEST_ASSERT_TRUE(found[STATES] == 77);
}

static void states_are_set_and_come_back(void) {
    double found[STATES], nominal[STATES];
    begin(false, 0);
    OK(fmi2SetContinuousStates(c, here, STATES));
    OK(fmi2GetContinuousStates(c, found, STATES));
    for (int k = 0; k < STATES; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-14, here[k], found[k]);
    OK(fmi2GetNominalsOfContinuousStates(c, nominal, STATES));
    for (int k = 0; k < STATES; k++) TEST_ASSERT_TRUE(nominal[k] > 0);
    ASSERT_REFUSED(fmi2GetContinuousStates(c, found, STATES - 1), "there are 10 continuous states, not 9");
    ASSERT_REFUSED(fmi2SetContinuousStates(c, NULL, STATES), "the list of values is missing (NULL)");
    found[3] = NOT_A_NUMBER;
    log_clear();
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2SetContinuousStates(c, found, STATES));
    ASSERT_LOGGED("logStatusDiscard: continuous state 4 of 10 cannot be nan");
    found[3] = 2e18;
    TEST_ASSERT_EQUAL_INT(fmi2Discard, fmi2SetContinuousStates(c, found, STATES));
}

/* The pose moves with ν, the wheels turn as fast as they are told to. */
static void rates_are_those_of_the_motion(void) {
    const fmi2ValueReference speed[4] = {ref("wheel_speed_rad_per_s", 1), ref("wheel_speed_rad_per_s", 2),
                                         ref("wheel_speed_rad_per_s", 3), ref("wheel_speed_rad_per_s", 4)};
    const fmi2ValueReference velocity[3] = {ref("velocity_body_m_per_s", 1), ref("velocity_body_m_per_s", 2),
                                            ref("yaw_rate_rad_per_s", 0)};
    double rate[STATES], turning[4], moving[3];
    begin(false, 0);
    OK(fmi2SetContinuousStates(c, here, STATES));
    OK(fmi2GetDerivatives(c, rate, STATES));
    OK(fmi2GetReal(c, speed, 4, turning));
    OK(fmi2GetReal(c, velocity, 3, moving));
    for (int k = 0; k < 4; k++) TEST_ASSERT_TRUE(rate[6 + k] == turning[k] && turning[k] != 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, moving[0] * cos(0.7) - moving[1] * sin(0.7), rate[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, moving[0] * sin(0.7) + moving[1] * cos(0.7), rate[4]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, moving[2], rate[5]);
}

static void single_states_may_be_set(void) {
    const fmi2ValueReference x = ref("x_m", 0);
    double found[STATES], at = 7;
    begin(false, 0);
    OK(fmi2SetContinuousStates(c, here, STATES));
    OK(fmi2SetReal(c, &x, 1, &at));
    OK(fmi2GetContinuousStates(c, found, STATES));
    TEST_ASSERT_TRUE(found[3] == 7 && found[4] == 2);
    at = 2e18;
    ASSERT_REFUSED(fmi2SetReal(c, &x, 1, &at), "x_m: 2e+18 is outside its range");
}

static void time_lies_within_the_run(void) {
    fmi2Boolean event, terminate;
    begin(true, 10);
    OK(fmi2SetTime(c, 5));
    ASSERT_REFUSED(fmi2SetTime(c, -1), "is before the start time 0 s");
    ASSERT_REFUSED(fmi2SetTime(c, 10.1), "is beyond the stop time 10 s");
    ASSERT_REFUSED(fmi2SetTime(c, 10 + 0.5e-6), "SetTime: 10.0000005 s is beyond the stop time 10 s");
    ASSERT_REFUSED(fmi2SetTime(c, NOT_A_NUMBER), "nan is not a time");
    event = terminate = fmi2True;
    OK(fmi2CompletedIntegratorStep(c, fmi2True, &event, &terminate));
    TEST_ASSERT_FALSE(event || terminate);
    OK(fmi2SetTime(c, 10.1)); /* a solver on its way looks a little further */
    ASSERT_REFUSED(fmi2CompletedIntegratorStep(c, fmi2True, &event, &terminate),
                   "CompletedIntegratorStep: 10.1 s is beyond the stop time 10 s");
    OK(fmi2SetTime(c, 10 + 0.5e-6));
    ASSERT_REFUSED(fmi2CompletedIntegratorStep(c, fmi2True, &event, &terminate), "is beyond the stop time 10 s");
    ASSERT_REFUSED(fmi2SetTime(c, 10.3), "is beyond the stop time 10 s");
    OK(fmi2SetTime(c, 10));
    OK(fmi2CompletedIntegratorStep(c, fmi2True, &event, &terminate));
}

static void there_are_no_event_indicators(void) {
    double none;
    begin(false, 0);
    OK(fmi2GetEventIndicators(c, NULL, 0));
    TEST_ASSERT_EQUAL_INT(fmi2Error, fmi2GetEventIndicators(c, &none, 1));
    OK(fmi2EnterEventMode(c));
    ASSERT_REFUSED(fmi2SetContinuousStates(c, here, STATES), "is not allowed in event mode");
}

/* Rates along a direction of states and inputs, by the difference of two evaluations. */
static void directional_derivatives_are_those_of_differences(void) {
    fmi2ValueReference known[7], unknown[3];
    double seed[7], found[3], low[STATES], high[STATES], moved[STATES];
    const double by = 1e-6;
    for (uint32_t k = 0; k < 3; k++) {
        known[k] = ref("nu_rad_per_s", k + 1);
        unknown[k] = ref("der(nu_rad_per_s)", k + 1);
    }
    for (uint32_t k = 0; k < 4; k++) known[3 + k] = ref("voltage_V", k + 1);
    for (int k = 0; k < 7; k++) seed[k] = 0.3 * k - 0.8;
    begin(false, 0);
    OK(fmi2SetContinuousStates(c, here, STATES));
    OK(fmi2GetDirectionalDerivative(c, unknown, 3, known, 7, seed, found));
    for (int side = -1; side <= 1; side += 2) {
        memcpy(moved, here, sizeof moved);
        double volts[4];
        for (int k = 0; k < 3; k++) moved[k] += side * by * seed[k];
        for (int k = 0; k < 4; k++) volts[k] = side * by * seed[3 + k];
        OK(fmi2SetContinuousStates(c, moved, STATES));
        OK(fmi2SetReal(c, known + 3, 4, volts));
        OK(fmi2GetDerivatives(c, side < 0 ? low : high, STATES));
    }
    for (int k = 0; k < 3; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-8, (high[k] - low[k]) / (2 * by), found[k]);
}

static void adjoint_derivatives_are_the_transposed_ones(void) {
    const fmi3ValueReference known[2] = {ref("voltage_V", 0), ref("nu_rad_per_s", 0)},
                             unknown = ref("der(nu_rad_per_s)", 0);
    double along[7], rate[3], back[7], weight[3] = {0.4, -1, 2}, left = 0, right = 0;
    fmi3Instance i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    size_t count = 0;
    TEST_ASSERT_NOT_NULL(i);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3GetNumberOfContinuousStates(i, &count));
    TEST_ASSERT_EQUAL_size_t(STATES, count);
    OK(fmi3GetNumberOfEventIndicators(i, &count));
    TEST_ASSERT_EQUAL_size_t(0, count);
    for (int k = 0; k < 7; k++) along[k] = 0.2 * k - 0.5;
    OK(fmi3GetDirectionalDerivative(i, &unknown, 1, known, 2, along, 7, rate, 3));
    OK(fmi3GetAdjointDerivative(i, &unknown, 1, known, 2, weight, 3, back, 7));
    for (int k = 0; k < 3; k++) left += weight[k] * rate[k];
    for (int k = 0; k < 7; k++) right += along[k] * back[k];
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, left, right);
    TEST_ASSERT_TRUE(fabs(left) > 1e-3);
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &unknown, 1, known, 2, along, 6, rate, 3),
                   "6 values for knowns that have 7");
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &unknown, 1, known, 2, along, 7, rate, 2),
                   "2 values for unknowns that have 3");
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, NULL, 1, known, 2, along, 7, rate, 3), "is missing (NULL)");
    const fmi3ValueReference mass = ref("mass_kg", 0), none = 0x7FFFFFFF;
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &unknown, 1, &mass, 1, along, 1, rate, 3),
                   "mass_kg is neither an input");
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &mass, 1, known, 2, along, 7, rate, 1),
                   "mass_kg is neither an output");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &none, 1, known, 2, weight, 1, back, 7),
                   "no variable with the value reference");
    fmi3FreeInstance(i);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_event_has_no_next_one);
    RUN_TEST(states_are_read_into_their_places_alone);
    RUN_TEST(states_are_set_and_come_back);
    RUN_TEST(rates_are_those_of_the_motion);
    RUN_TEST(single_states_may_be_set);
    RUN_TEST(time_lies_within_the_run);
    RUN_TEST(there_are_no_event_indicators);
    RUN_TEST(directional_derivatives_are_those_of_differences);
    RUN_TEST(adjoint_derivatives_are_the_transposed_ones);
    return UNITY_END();
}
