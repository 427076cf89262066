/* Tests of what clocks and steps of a bus do beside their usual way: lists of clocks, ends of steps. */
#include "model_interface.h"
#include "network_bench.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

static void begin(void) { OK(begin_from(0)); }

static void clocks_of_one_list_are_set_each(void) {
    const fmi3ValueReference clocks[2] = {of_terminal("Node1", "Rx_Clock"), of_terminal("Node2", "Rx_Clock")};
    const bool on[2] = {true, true}, second[2] = {false, true};
    begin();
    OK(fmi3SetClock(c, clocks, 2, on));
    TEST_ASSERT_TRUE(instance()->model.port[0].rx_clock && instance()->model.port[1].rx_clock);
    OK(fmi3SetClock(c, clocks, 2, second));
    TEST_ASSERT_TRUE(!instance()->model.port[0].rx_clock && instance()->model.port[1].rx_clock);
}

static void no_step_ends_early(void) {
    fmu_step_end end = {.early = true};
    begin();
    OK(fmi3EnterStepMode(c));
    OK((int)fmu_do_step(instance(), 0, 0.25, &end));
    TEST_ASSERT_TRUE(!end.early && end.time_s == 0.25);
    end.early = true;
    TEST_ASSERT_EQUAL_INT(FMU_ERROR, fmu_do_step(instance(), 0.25, -1, &end));
    TEST_ASSERT_TRUE(!end.early && end.time_s == 0.25);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(clocks_of_one_list_are_set_each);
    RUN_TEST(no_step_ends_early);
    return UNITY_END();
}
