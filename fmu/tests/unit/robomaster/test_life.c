/* Tests of the glue around a model with a single bus terminal: what an instance needs, and what it does not offer. */
#include "model_interface.h"
#include "network_bench.h"
#include "short_memory.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

static void its_clocks_need_event_mode(void) {
    const int before = short_memory_blocks;
    TEST_ASSERT_NULL(make_3(false));
    ASSERT_LOGGED("the clocks of a bus need event mode; import the FMU with it");
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
}

static void it_is_for_co_simulation_alone(void) {
    const int before = short_memory_blocks;
    TEST_ASSERT_NULL(fmi3InstantiateModelExchange("a", fmu_token_3, NULL, false, true, NULL, log_3));
    ASSERT_LOGGED("this FMU offers no Model Exchange; use Co-Simulation");
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
}

static void it_has_no_structural_parameters(void) {
    ASSERT_REFUSED(fmi3EnterConfigurationMode(c), "this FMU has no structural parameters");
    TEST_ASSERT_EQUAL(FMU_INSTANTIATED, instance()->mode);
}

/* The command of a period is due behind it, that of the next one not yet. */
static void a_step_tells_whether_its_terminal_has_an_event(void) {
    bool event = false, terminate = true, early = true;
    double end_s = 7;
    OK(begin_from(0));
    take("CAN"); /* its bit rate */
    const double period_s = instance()->model.period_s;
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, 0, period_s, true, &event, &terminate, &early, &end_s));
    TEST_ASSERT_TRUE(event && !terminate && !early && end_s == period_s);
    OK(fmi3EnterEventMode(c));
    take("CAN");
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, period_s, 0.5 * period_s, true, &event, NULL, NULL, NULL));
    TEST_ASSERT_FALSE(event);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(its_clocks_need_event_mode);
    RUN_TEST(it_is_for_co_simulation_alone);
    RUN_TEST(it_has_no_structural_parameters);
    RUN_TEST(a_step_tells_whether_its_terminal_has_an_event);
    return UNITY_END();
}
