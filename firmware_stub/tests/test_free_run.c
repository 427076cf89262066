/* Tests of node_run.c in free run: periods, lateness and the watchdog. */
#include "bench.h"
#include "unity.h"

void setUp(void) {
    bench_begin();
    bench_load(4);
}
void tearDown(void) {}

static void pass(uint32_t microseconds) {
    for (uint32_t k = 0; k < microseconds; k += 100) {
        now_us += 100;
        laconic_node_on_tick(&node, now_us);
    }
}

static uint8_t start(uint16_t rate, uint16_t watchdog) {
    return bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, rate, watchdog);
}

static void every_period_takes_its_steps_though_the_time_wraps(void) {
    TEST_ASSERT_EQUAL_UINT8(0, start(0, 0));
    pass(10000);
    TEST_ASSERT_EQUAL_UINT64(10, node.plant.steps);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, start(100, 0));
    pass(20000);
    TEST_ASSERT_EQUAL_UINT64(30, node.plant.steps);
}

static void rates_that_are_no_whole_steps_are_refused(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start(300, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start(1001, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start(1, 0)); /* a thousand steps at once */
}

static void steps_that_come_late_are_taken_late_and_counted(void) {
    start(1000, 0);
    now_us += 5500;
    for (int k = 0; k < 10; k++) laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(5, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT32(4500, node.free_run.worst_lateness_us);
    TEST_ASSERT_EQUAL_UINT16(4, node.counters.late_periods);
}

static void the_watchdog_needs_all_voltages_and_latches(void) {
    start(1000, 10);
    for (int k = 0; k < 4; k++) {
        bench_voltage(0, 500, 0);
        bench_voltage(1, 500, 0);
        pass(8000);
    }
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
    bench_voltage(0, 500, 0);
    pass(8000); /* group 1 is missing */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_TIMEOUT, node.state);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
    const uint64_t steps = node.plant.steps;
    bench_voltage(0, 500, 0);
    bench_voltage(1, 500, 0);
    pass(2000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_TIMEOUT, node.state);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.plant.steps == steps + 2);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, start(1000, 10));
}

static void a_frame_stamped_after_the_tick_that_follows_it_feeds_the_watchdog(void) {
    start(1000, 10);
    now_us += 500;
    bench_voltage(0, 500, 0);
    bench_voltage(1, 500, 0);
    laconic_node_on_tick(&node, now_us - 1U);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
}

static void a_sync_is_refused_in_free_run(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    start(1000, 0);
    bench_voltage(0, 500, 1);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.counters.refused == 1);
    bench_sync(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, data[3]);
}

static void the_heartbeat_beats_in_every_state(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    for (int k = 0; k < 5; k++) {
        pass(100000);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HEARTBEAT, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, data[1] >> 4);
    }
    TEST_ASSERT_EQUAL_UINT32(100000, laconic_node_idle_us(&node, now_us));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_period_takes_its_steps_though_the_time_wraps);
    RUN_TEST(rates_that_are_no_whole_steps_are_refused);
    RUN_TEST(steps_that_come_late_are_taken_late_and_counted);
    RUN_TEST(the_watchdog_needs_all_voltages_and_latches);
    RUN_TEST(a_frame_stamped_after_the_tick_that_follows_it_feeds_the_watchdog);
    RUN_TEST(a_sync_is_refused_in_free_run);
    RUN_TEST(the_heartbeat_beats_in_every_state);
    return UNITY_END();
}
