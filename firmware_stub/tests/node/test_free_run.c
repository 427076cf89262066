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

static void a_step_that_the_core_refuses_ends_in_fault_with_the_inputs_cleared(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    start(1000, 0);
    pass(3000);
    node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
    pass(1000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(0, data[1] >> 4); /* no frame has asked for it */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_SYNC, data[2]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_BODY_MOMENT, data[4]);
    TEST_ASSERT_TRUE(node.input[0].body_moment_Nm == 0);
    pass(5000);
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps); /* and no further step */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, start(1000, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, start(1000, 0));
}

/* 300 periods of 3,333 1/3 µs are a second: rests of a microsecond are not lost. */
static void periods_that_are_no_whole_microseconds_keep_their_rate(void) {
    const laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)(1.0 / 300),
                                                      &node.start, NULL));
    TEST_ASSERT_EQUAL_UINT8(0, start(0, 0));
    TEST_ASSERT_EQUAL_UINT32(300, node.free_run.rate_Hz);
    const uint32_t begun_us = now_us;
    for (uint32_t k = 1; k <= 3000; k++) {
        now_us = node.free_run.next_us;
        TEST_ASSERT_UINT32_WITHIN(1, k * 10000U / 3U, now_us - begun_us);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(k, node.plant.steps);
    }
    TEST_ASSERT_EQUAL_UINT32(10000000, now_us - begun_us);
    TEST_ASSERT_TRUE(node.free_run.worst_lateness_us == 0 && node.counters.late_periods == 0);
}

static void a_period_is_late_from_one_period_on(void) {
    start(1000, 0);
    now_us += 1000 + 999;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.late_periods);
    now_us += 1 + 1000;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.late_periods);
    TEST_ASSERT_EQUAL_UINT32(1000, node.free_run.worst_lateness_us);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    start(1000, 0);
    TEST_ASSERT_EQUAL_UINT32(0, node.free_run.worst_lateness_us);
}

static void the_watchdog_waits_its_time_to_the_microsecond(void) {
    start(1000, 10);
    const uint32_t fed_us = now_us;
    for (uint32_t k = 1; k <= 9; k++) laconic_node_on_tick(&node, fed_us + 1000U * k);
    laconic_node_on_tick(&node, fed_us + 10000U);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
    laconic_node_on_tick(&node, fed_us + 10001U);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_TIMEOUT, node.state);
}

/* With 1 V in a group that comes twice nothing is fed; the groups of a run before do not count. */
static void groups_of_voltages_begin_anew_with_each_run(void) {
    start(1000, 10);
    bench_voltage(0, 500, 0);
    TEST_ASSERT_EQUAL_UINT8(1, node.groups_seen);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    start(1000, 10);
    TEST_ASSERT_EQUAL_UINT8(0, node.groups_seen);
    const uint32_t fed_us = node.free_run.fed_us;
    now_us += 500;
    bench_voltage(1, 500, 0);
    bench_voltage(1, 500, 0);
    TEST_ASSERT_EQUAL_UINT32(fed_us, node.free_run.fed_us);
    bench_voltage(0, 500, 0);
    TEST_ASSERT_EQUAL_UINT32(now_us, node.free_run.fed_us);
    TEST_ASSERT_EQUAL_UINT8(0, node.groups_seen);
}

static void whoever_waits_wakes_for_the_next_period_or_heartbeat(void) {
    TEST_ASSERT_EQUAL_UINT32(100000 - (now_us - node.heartbeat_us), laconic_node_idle_us(&node, now_us));
    TEST_ASSERT_EQUAL_UINT32(1, laconic_node_idle_us(&node, node.heartbeat_us + 99999U));
    TEST_ASSERT_EQUAL_UINT32(0, laconic_node_idle_us(&node, node.heartbeat_us + 100001U));
    start(100, 0);
    TEST_ASSERT_EQUAL_UINT32(10000, laconic_node_idle_us(&node, now_us));
    TEST_ASSERT_EQUAL_UINT32(4000, laconic_node_idle_us(&node, now_us + 6000U));
    TEST_ASSERT_EQUAL_UINT32(1, laconic_node_idle_us(&node, now_us + 9999U));
    TEST_ASSERT_EQUAL_UINT32(0, laconic_node_idle_us(&node, now_us + 10001U));
    node.free_run.next_us += 1000000U;
    TEST_ASSERT_EQUAL_UINT32(1, laconic_node_idle_us(&node, node.heartbeat_us + 99999U));
    TEST_ASSERT_EQUAL_UINT32(0, laconic_node_idle_us(&node, node.heartbeat_us + 100001U));
}

static void voltages_of_every_group_feed_the_watchdog_however_many_wheels_there_are(void) {
    static const int32_t wheels[] = {0, 1, 2, 3, 4, 6, 7};
    for (size_t k = 0; k < sizeof wheels / sizeof wheels[0]; k++) {
        bench_begin();
        bench_load(wheels[k]);
        start(1000, 10);
        const uint8_t groups = wheels[k] > 3 ? (uint8_t)((wheels[k] + 2) / 3) : 1;
        for (uint8_t group = 0; group < groups; group++) {
            now_us += 10;
            TEST_ASSERT_TRUE(node.free_run.fed_us != now_us);
            bench_voltage(group, 500, 0);
        }
        TEST_ASSERT_EQUAL_UINT32(now_us, node.free_run.fed_us);
    }
}

static void a_period_of_a_second_is_a_million_microseconds(void) {
    const laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, 1, &node.start, NULL);
    TEST_ASSERT_EQUAL_UINT8(0, start(1, 0));
    const uint32_t begun_us = now_us;
    laconic_node_on_tick(&node, begun_us + 2000000U);
    TEST_ASSERT_TRUE(node.plant.steps == 1 && node.counters.late_periods == 1);
    TEST_ASSERT_EQUAL_UINT32(begun_us + 2000000U, node.free_run.next_us);
}

static void without_a_watchdog_a_run_goes_on_for_ever(void) {
    TEST_ASSERT_EQUAL_UINT8(0, start(1000, 0));
    pass(50000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
}

/* 7 periods a second: the k-th begins at k · 1,000,000/7 µs, rounded down, and no microsecond is lost. */
static void periods_that_are_no_whole_microseconds_begin_when_they_should(void) {
    const laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    TEST_ASSERT_EQUAL(LACONIC_OK,
                      laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, 1 / (laconic_real)7, &node.start, NULL));
    TEST_ASSERT_EQUAL_UINT8(0, start(7, 0));
    const uint32_t began_us = now_us;
    for (uint64_t k = 1; k <= 21; k++) {
        now_us = began_us + (uint32_t)(k * 1000000U / 7U) - 1U;
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(k - 1, node.plant.steps);
        laconic_node_on_tick(&node, ++now_us);
        TEST_ASSERT_EQUAL_UINT64(k, node.plant.steps);
    }
}

/* 1666 2/3 µs: the second rest of two thirds goes beyond a microsecond. */
static void periods_of_two_thirds_of_a_microsecond_keep_their_rate(void) {
    const laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)(1.0 / 600),
                                                      &node.start, NULL));
    TEST_ASSERT_EQUAL_UINT8(0, start(0, 0));
    const uint32_t begun_us = now_us;
    for (uint32_t k = 1; k <= 600; k++) {
        now_us = node.free_run.next_us;
        TEST_ASSERT_UINT32_WITHIN(1, k * 10000U / 6U, now_us - begun_us);
        laconic_node_on_tick(&node, now_us);
    }
    TEST_ASSERT_EQUAL_UINT32(1000000, now_us - begun_us);
}

static void long_periods_are_late_from_one_of_theirs_on(void) {
    start(100, 0);
    now_us += 10000 + 9999;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.late_periods);
    now_us += 10001;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.late_periods);
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
    RUN_TEST(a_step_that_the_core_refuses_ends_in_fault_with_the_inputs_cleared);
    RUN_TEST(periods_that_are_no_whole_microseconds_keep_their_rate);
    RUN_TEST(a_period_is_late_from_one_period_on);
    RUN_TEST(the_watchdog_waits_its_time_to_the_microsecond);
    RUN_TEST(groups_of_voltages_begin_anew_with_each_run);
    RUN_TEST(whoever_waits_wakes_for_the_next_period_or_heartbeat);
    RUN_TEST(voltages_of_every_group_feed_the_watchdog_however_many_wheels_there_are);
    RUN_TEST(a_period_of_a_second_is_a_million_microseconds);
    RUN_TEST(without_a_watchdog_a_run_goes_on_for_ever);
    RUN_TEST(periods_that_are_no_whole_microseconds_begin_when_they_should);
    RUN_TEST(periods_of_two_thirds_of_a_microsecond_keep_their_rate);
    RUN_TEST(long_periods_are_late_from_one_of_theirs_on);
    return UNITY_END();
}
