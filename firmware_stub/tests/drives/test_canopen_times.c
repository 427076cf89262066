/* Tests of pdo.c: event timers, inhibit times and deadlines. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

enum { RPDO1 = 0x200 + ID, RPDO2 = 0x300 + ID, TPDO1 = 0x180 + ID, TPDO2 = 0x280 + ID, TPDO3 = 0x380 + ID };

#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})

static void data_by_event_are_sent_when_they_change_and_when_the_timer_ends(void) {
    start_nodes();
    forget();
    step(1);
    TEST_ASSERT_EQUAL(0, count_of(TPDO1));
    deliver(RPDO1, BYTES(6, 0, 0), 3);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    deliver(RPDO1, BYTES(6, 0, 0), 3);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    step(99);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    step(1);
    TEST_ASSERT_EQUAL(2, count_of(TPDO1));
    step(200);
    TEST_ASSERT_EQUAL(4, count_of(TPDO1));
}

static void the_inhibit_time_holds_back_events_but_not_their_last_value(void) {
    set(0x1800, 1, (int64_t)(0xC0000180U + ID));
    set(0x1800, 3, 100); /* 10 ms */
    set(0x1800, 5, 0);
    set(0x1800, 1, 0x40000180 + ID);
    start_nodes();
    step(20);
    forget();
    control(6);
    forget();
    deliver(RPDO1, BYTES(7, 0, 9), 3);
    deliver(RPDO1, BYTES(15, 0, 9), 3);
    TEST_ASSERT_EQUAL(0, count_of(TPDO1));
    step(10);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    TEST_ASSERT_EQUAL_HEX16(0x27, last(TPDO1)->data[0] & 0x6F);
}

static void a_watchdog_beyond_16_bits_is_the_longest_deadline(void) {
    on.drives.watchdog_s = 100;
    nmt(129, ID);
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, get(0x1401, 5) & 0xFFFF);
}

static void a_received_pdo_that_is_switched_off_is_not_missed(void) {
    set(0x1400, 5, 50);
    start_nodes();
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    set(0x1400, 1, (int64_t)(0x80000200U + ID));
    step(200);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    TEST_ASSERT_EQUAL_HEX8(0, get(0x1001, 0));
}

static void the_inhibit_time_is_read_as_it_was_written(void) {
    set(0x1802, 3, 250);
    TEST_ASSERT_EQUAL(250, get(0x1802, 3));
    TEST_ASSERT_EQUAL(0, get(0x1800, 3));
}

static void a_received_pdo_that_stops_coming_counts_as_a_lost_controller(void) {
    set(0x1400, 5, 50);
    start_nodes();
    step(200); /* none came yet: nothing to miss */
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    for (int k = 0; k < 10; k++) {
        deliver(RPDO1, BYTES(k == 0 ? 6 : k == 1 ? 7 : 15, 0, 9), 3);
        step(40);
    }
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    step(11);
    TEST_ASSERT_EQUAL_HEX16(0x8250, get(0x603F, 0) & 0xFFFF);
    TEST_ASSERT_EQUAL(CANOPEN_PRE_OPERATIONAL, on.axes[0].nmt);
}

static void a_scenes_watchdog_is_the_deadline_of_the_targets(void) {
    on.drives.watchdog_s = (laconic_real)0.08;
    nmt(129, ID);
    TEST_ASSERT_EQUAL(0, get(0x1400, 5));
    TEST_ASSERT_EQUAL(80, get(0x1401, 5));
    TEST_ASSERT_EQUAL(80, get(0x1403, 5));
    start_nodes();
    enable(9);
    deliver(RPDO2, BYTES(0, 0x10), 4);
    step(80);
    TEST_ASSERT_EQUAL(0, on.drives.drive[0].faults);
    step(60);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_FAULT_WATCHDOG, on.drives.drive[0].faults);
    control(0);
    control(128);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
}

static void pass_to(uint32_t now_us) {
    on.now_us = now_us;
    laconic_canopen.on_step(&on.drives, now_us);
    collect();
}

static void the_event_timer_and_the_inhibit_time_are_exact(void) {
    set(0x1800, 5, 7);
    start_nodes();
    forget();
    pass_to(6999);
    TEST_ASSERT_EQUAL(0, count_of(TPDO1));
    pass_to(7000);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
    power_up();
    set(0x1800, 1, (int64_t)(0x80000180U + ID));
    set(0x1800, 3, 13);
    set(0x1800, 1, 0x180 + ID);
    start_nodes();
    control(6);
    forget();
    pass_to(1299);
    TEST_ASSERT_EQUAL(0, count_of(TPDO1));
    pass_to(1300);
    TEST_ASSERT_EQUAL(1, count_of(TPDO1));
}

static void a_deadline_is_exact(void) {
    set(0x1400, 5, 50);
    start_nodes();
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    pass_to(50000);
    TEST_ASSERT_EQUAL_HEX8(0, get(0x1001, 0));
    pass_to(50001);
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001, 0));
}

static void a_pdo_that_is_switched_on_begins_its_timer_anew(void) {
    set(0x1802, 2, 254);
    set(0x1802, 5, 20); /* torque and current, both 0 */
    start_nodes();
    pass_to(1000000);
    set(0x1802, 1, 0x380 + ID);
    pass_to(1019999);
    TEST_ASSERT_EQUAL(0, count_of(TPDO3));
    pass_to(1020000);
    TEST_ASSERT_EQUAL(1, count_of(TPDO3));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(data_by_event_are_sent_when_they_change_and_when_the_timer_ends);
    RUN_TEST(the_inhibit_time_holds_back_events_but_not_their_last_value);
    RUN_TEST(a_watchdog_beyond_16_bits_is_the_longest_deadline);
    RUN_TEST(a_received_pdo_that_is_switched_off_is_not_missed);
    RUN_TEST(the_inhibit_time_is_read_as_it_was_written);
    RUN_TEST(a_received_pdo_that_stops_coming_counts_as_a_lost_controller);
    RUN_TEST(a_scenes_watchdog_is_the_deadline_of_the_targets);
    RUN_TEST(the_event_timer_and_the_inhibit_time_are_exact);
    RUN_TEST(a_deadline_is_exact);
    RUN_TEST(a_pdo_that_is_switched_on_begins_its_timer_anew);
    return UNITY_END();
}
