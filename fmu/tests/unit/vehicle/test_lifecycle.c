/* Tests of lifecycle.c: which call each version and kind allows in which mode, as the standards state it. */
#include "lifecycle.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

/* Modes by a letter each: Instantiated, Configuration, iNitialization, Event, conTinuous, Step, interMediate,
 * terminated (X). Columns: FMI 2 Model Exchange and Co-Simulation, FMI 3 Model Exchange and Co-Simulation. */
static const char letters[FMU_MODE_COUNT + 1] = "ICNETSMX";
static const struct {
    fmu_call call;
    const char *modes[4];
} standard[] = {
    {FMU_CALL_SET_DEBUG_LOGGING, {"INETX", "INSX", "ICNETX", "ICNESX"}},
    {FMU_CALL_SETUP_EXPERIMENT, {"I", "I", "", ""}},
    {FMU_CALL_ENTER_CONFIGURATION, {"", "", "I", "I"}},
    {FMU_CALL_EXIT_CONFIGURATION, {"", "", "C", "C"}},
    {FMU_CALL_ENTER_INITIALIZATION, {"I", "I", "I", "I"}},
    {FMU_CALL_EXIT_INITIALIZATION, {"N", "N", "N", "N"}},
    {FMU_CALL_ENTER_EVENT, {"ET", "", "T", "S"}},
    {FMU_CALL_UPDATE_DISCRETE_STATES, {"E", "", "E", "E"}},
    {FMU_CALL_ENTER_CONTINUOUS_TIME, {"E", "", "E", ""}},
    {FMU_CALL_ENTER_STEP, {"", "", "", "E"}},
    {FMU_CALL_TERMINATE, {"ET", "S", "ET", "ES"}},
    {FMU_CALL_RESET, {"INETX", "INSX", "ICNETX", "ICNESX"}},
    {FMU_CALL_GET, {"NETX", "NSX", "ICNETX", "ICNESMX"}},
    {FMU_CALL_SET_CONTINUOUS, {"INET", "INS", "INET", "INESM"}},
    {FMU_CALL_SET_DISCRETE, {"INE", "INS", "ICNE", "ICNES"}},
    {FMU_CALL_STATE_OF_FMU, {"INETX", "INSX", "ICNETX", "ICNESX"}},
    {FMU_CALL_PARTIAL_DERIVATIVE, {"NETX", "NSX", "NETX", "NESX"}},
    {FMU_CALL_DEPENDENCIES, {"", "", "ICNETX", "ICNESX"}},
    {FMU_CALL_SET_TIME, {"ET", "", "T", ""}},
    {FMU_CALL_SET_STATES, {"T", "", "T", ""}},
    {FMU_CALL_GET_STATES, {"NETX", "", "NETX", ""}},
    {FMU_CALL_GET_RATES, {"NETX", "", "NETX", ""}},
    {FMU_CALL_GET_NOMINALS, {"INETX", "", "NETX", ""}},
    {FMU_CALL_COUNT_STATES, {"", "", "INETX", ""}},
    {FMU_CALL_COMPLETED_STEP, {"T", "", "T", ""}},
    {FMU_CALL_DO_STEP, {"", "S", "", "S"}},
    {FMU_CALL_CANCEL_STEP, {"", "", "", ""}},
    {FMU_CALL_STEP_STATUS, {"", "SX", "", ""}},
    {FMU_CALL_INPUT_DERIVATIVES, {"", "INS", "", ""}},
    {FMU_CALL_OUTPUT_DERIVATIVES, {"", "SX", "", "SMX"}},
};

static void each_call_is_allowed_in_the_modes_of_the_standards(void) {
    TEST_ASSERT_EQUAL_size_t(FMU_CALL_COUNT, sizeof standard / sizeof standard[0]);
    for (size_t n = 0; n < sizeof standard / sizeof standard[0]; n++) {
        const fmu_rule *rule = &fmu_rules[standard[n].call];
        const unsigned allowed[4] = {rule->exchange_2, rule->simulation_2, rule->exchange_3, rule->simulation_3};
        for (int kind = 0; kind < 4; kind++) {
            unsigned expected = 0;
            for (const char *mode = standard[n].modes[kind]; *mode != 0; mode++)
                expected |= 1U << (strchr(letters, *mode) - letters);
            TEST_ASSERT_EQUAL_HEX_MESSAGE(expected, allowed[kind], rule->what);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(each_call_is_allowed_in_the_modes_of_the_standards);
    return UNITY_END();
}
