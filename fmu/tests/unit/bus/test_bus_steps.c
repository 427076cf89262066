/* Tests of what clocks and steps of a bus do beside their usual way: lists of clocks and bytes, intervals, ends
 * of steps. */
#include "model_interface.h"
#include "network_bench.h"

#include <float.h>

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

/* Of a list that cannot be set whole nothing is set. */
static void a_wrong_clock_behind_a_right_one_is_refused(void) {
    const fmi3ValueReference none[2] = {of_terminal("Node1", "Rx_Clock"), ref("bit_rate_bit_per_s", 0)};
    const fmi3ValueReference last = fmu_variable_count;
    const bool on[2] = {true, true};
    bool active[2];
    begin();
    ASSERT_REFUSED(fmi3SetClock(c, none, 2, on), "there is no Clock with the value reference");
    TEST_ASSERT_FALSE(instance()->model.port[0].rx_clock);
    ASSERT_REFUSED(fmi3GetClock(c, none, 2, active), "there is no Clock with the value reference");
    ASSERT_REFUSED(fmi3GetClock(c, &last, 1, active), "there is no Clock with the value reference");
}

/* A frame has passed: both nodes hear of it. */
static void clocks_of_one_list_are_read_each(void) {
    const fmi3ValueReference clocks[2] = {of_terminal("Node1", "Tx_Clock"), of_terminal("Node2", "Tx_Clock")};
    const laconic_frame frame = {.id = 1};
    bool active[2] = {false, false};
    begin();
    ls_bus_put_frame(&out, &frame, false);
    give("Node1", &out);
    update();
    step(0, 1e-3);
    update();
    OK(fmi3GetClock(c, clocks, 2, active));
    TEST_ASSERT_TRUE(active[0] && active[1]);
}

/* Which of both it is an importer may choose anew: what it has set itself needs no further iteration. */
static void a_clock_that_was_triggered_may_be_set(void) {
    const fmi3ValueReference clock = of_terminal("Node2", "Tx_Clock");
    const laconic_frame frame = {.id = 1};
    bool active = false;
    begin();
    ls_bus_put_frame(&out, &frame, false);
    give("Node1", &out);
    update();
    step(0, 1e-3);
    take("Node1");
    OK(fmi3GetClock(c, &clock, 1, &active));
    TEST_ASSERT_TRUE(active && update()); /* the iteration behind it */
    active = true;
    OK(fmi3SetClock(c, &clock, 1, &active));
    TEST_ASSERT_FALSE(update());
}

static bool needs_event(double at_s, double step_s) {
    bool needed = false;
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, at_s, step_s, true, &needed, NULL, NULL, NULL));
    OK(fmi3EnterEventMode(c));
    return needed;
}

/* Of either terminal alone; frames that wait for the bus are nothing to be sent. */
static void a_step_needs_an_event_where_a_terminal_sends(void) {
    static const char *const nodes[2] = {"Node1", "Node2"};
    const laconic_frame frame = {.id = 1};
    for (int k = 0; k < 2; k++) {
        make();
        begin();
        TEST_ASSERT_FALSE(needs_event(0, 0));
        memset(out.bytes, 0x99, 8); /* a wrong operation, whose answer is due */
        out.size = 8;
        give(nodes[k], &out);
        update();
        TEST_ASSERT_TRUE(needs_event(0, 0));
    }
    make();
    begin();
    out.size = 0;
    ls_bus_put_frame(&out, &frame, false);
    ls_bus_put_frame(&out, &frame, false);
    give("Node1", &out);
    update();
    TEST_ASSERT_FALSE(needs_event(0, 1e-6));
    TEST_ASSERT_EQUAL_size_t(16, instance()->model.node[0].queue.size);
}

static void bytes_of_one_list_are_set_each_or_none(void) {
    const fmi3ValueReference data[2] = {of_terminal("Node1", "Rx_Data"), of_terminal("Node2", "Rx_Data")};
    const fmi3ValueReference wrong[2] = {data[0], of_terminal("Node2", "Tx_Data")};
    const uint8_t one[2] = {1, 2}, other[3] = {3, 4, 5};
    const fmi3Binary values[2] = {one, other}, swapped[2] = {other, one};
    const size_t sizes[2] = {2, 3}, swapped_sizes[2] = {3, 2};
    begin();
    OK(fmi3SetBinary(c, data, 2, sizes, values, 2));
    ASSERT_REFUSED(fmi3SetBinary(c, wrong, 2, swapped_sizes, swapped, 2), "Node2.Tx_Data cannot be set");
    const network_port *port = instance()->model.port;
    TEST_ASSERT_TRUE(port[0].rx.size == 2 && memcmp(port[0].rx.bytes, one, 2) == 0);
    TEST_ASSERT_TRUE(port[1].rx.size == 3 && memcmp(port[1].rx.bytes, other, 3) == 0);
}

/* 55 bits take 55.497 and 55.503 microseconds. */
static void an_interval_is_rounded_to_the_nearest_microsecond(void) {
    static const int32_t rates[2] = {991044, 990937};
    const laconic_frame frame = {.id = 1, .length = 1};
    for (size_t k = 0; k < 2; k++) {
        uint64_t counter = 0, resolution = 0;
        fmi3IntervalQualifier qualifier;
        make();
        const fmi3ValueReference clock = of_terminal("Node2", "Tx_Clock");
        set_integer("bit_rate_bit_per_s", rates[k]);
        begin();
        out.size = 0;
        ls_bus_put_frame(&out, &frame, false);
        give("Node1", &out);
        update();
        OK(fmi3GetIntervalFraction(c, &clock, 1, &counter, &resolution, &qualifier));
        TEST_ASSERT_TRUE(counter == 55 + k && resolution == 1000000);
    }
}

/* Importers add up their times; a billionth of a second is all that this may be wrong by. */
static void a_step_begins_where_the_last_one_has_ended(void) {
    begin();
    OK(try_step(0, 0.25));
    ASSERT_REFUSED(try_step(0.25 + 3e-9, 0.25), "but the model is at 0.25 s");
    ASSERT_REFUSED(try_step(0.25 - 3e-9, 0.25), "but the model is at 0.25 s");
    OK(try_step(0.25 + 0.9e-9, 0.25));
    make();
    begin();
    double most_s = 0; /* by so much, and no less: it grows with the time itself */
    for (int k = 0; k < 9; k++) most_s = 1e-9 + 1e6 * DBL_EPSILON * most_s;
    TEST_ASSERT_TRUE(most_s == 1e-9 + 1e6 * DBL_EPSILON * most_s);
    OK(try_step(most_s, 0));
}

static void a_step_ends_by_the_stop_time_wherever_it_begins(void) {
    OK(fmi3EnterInitializationMode(c, false, 0, 0, true, 2));
    OK(fmi3ExitInitializationMode(c));
    OK(try_step(0, 1));
    ASSERT_REFUSED(try_step(1, 1.1), "the step from 1 s to 2.1 s goes beyond the stop time 2 s");
    OK(try_step(1, 1));
}

/* As a model that has not started yet: a step starts it, or is refused with the start. */
static void a_step_starts_what_has_not_started(void) {
    begin();
    instance()->model.start_needed = true;
    OK(try_step(0, 0.25));
    TEST_ASSERT_FALSE(instance()->model.start_needed);
    instance()->model.start_needed = true;
    instance()->clock.start_s = 5e9;
    ASSERT_REFUSED(try_step(0.25, 0.25), "the start time 5000000000 s cannot be taken");
    TEST_ASSERT_TRUE(instance()->model.time_s == 0.25);
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
    RUN_TEST(a_wrong_clock_behind_a_right_one_is_refused);
    RUN_TEST(clocks_of_one_list_are_read_each);
    RUN_TEST(a_clock_that_was_triggered_may_be_set);
    RUN_TEST(a_step_needs_an_event_where_a_terminal_sends);
    RUN_TEST(bytes_of_one_list_are_set_each_or_none);
    RUN_TEST(an_interval_is_rounded_to_the_nearest_microsecond);
    RUN_TEST(a_step_begins_where_the_last_one_has_ended);
    RUN_TEST(a_step_ends_by_the_stop_time_wherever_it_begins);
    RUN_TEST(a_step_starts_what_has_not_started);
    RUN_TEST(no_step_ends_early);
    return UNITY_END();
}
