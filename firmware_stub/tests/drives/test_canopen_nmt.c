/* Tests of canopen.c: network management, heartbeats, the order of frames, and a controller that goes silent. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

enum { HEARTBEAT = 0x700 + ID, MASTER = 1 };

#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})

static void each_node_boots_up_and_is_pre_operational(void) {
    TEST_ASSERT_EQUAL(2, on.count);
    TEST_ASSERT_EQUAL_HEX32(HEARTBEAT, on.sent[0].id);
    TEST_ASSERT_EQUAL_HEX32(0x700 + OTHER_ID, on.sent[1].id);
    TEST_ASSERT_EQUAL(1, on.sent[0].length);
    TEST_ASSERT_EQUAL_HEX8(0, on.sent[0].data[0]);
    TEST_ASSERT_EQUAL(CANOPEN_PRE_OPERATIONAL, on.axes[0].nmt);
}

static void commands_move_one_node_or_all(void) {
    static const struct {
        uint8_t command, state;
    } commands[] = {{1, 5},    {2, 4}, {1, 5},     {128, 127}, {2, 4},    {128, 127},
                    {99, 127}, {1, 5}, {129, 127}, {1, 5},     {130, 127}};
    for (size_t k = 0; k < sizeof commands / sizeof commands[0]; k++) {
        nmt(commands[k].command, ID);
        TEST_ASSERT_EQUAL(commands[k].state, on.axes[0].nmt);
        TEST_ASSERT_EQUAL(127, on.axes[1].nmt);
    }
    start_nodes();
    TEST_ASSERT_EQUAL(5, on.axes[1].nmt);
    deliver(0, BYTES(2, 0, 0), 3); /* too long for a command */
    TEST_ASSERT_EQUAL(5, on.axes[1].nmt);
}

static void a_stopped_node_answers_nothing_but_its_heartbeat(void) {
    set(0x1017, 0, 10);
    nmt(2, ID);
    forget();
    TEST_ASSERT_NULL(request(BYTES(0x40, 0, 0x10, 0)));
    step(25);
    TEST_ASSERT_EQUAL(2, count_of(HEARTBEAT));
    TEST_ASSERT_EQUAL(2, on.count);
    TEST_ASSERT_EQUAL_HEX8(4, on.sent[0].data[0]);
}

static void heartbeats_come_every_1017_milliseconds_with_the_state(void) {
    set(0x1017, 0, 20);
    forget();
    step(100);
    TEST_ASSERT_EQUAL(5, on.count);
    TEST_ASSERT_EQUAL_HEX8(127, on.sent[4].data[0]);
    start_nodes();
    forget();
    step(20);
    TEST_ASSERT_EQUAL_HEX8(5, last(HEARTBEAT)->data[0]);
    on.now_us += 1000000; /* a board that was busy makes up for none */
    forget();
    step(20);
    TEST_ASSERT_EQUAL(1, count_of(HEARTBEAT));
    set(0x1017, 0, 0);
    forget();
    step(60);
    TEST_ASSERT_EQUAL(0, count_of(HEARTBEAT));
}

static void node_guarding_is_not_answered(void) {
    laconic_frame ask = {.id = HEARTBEAT, .length = 1, .remote = true};
    forget();
    laconic_canopen.on_frame(&on.drives, &ask, 0);
    collect();
    TEST_ASSERT_EQUAL(0, on.count);
}

static void resetting_the_communication_keeps_the_drives_objects_and_resetting_the_node_does_not(void) {
    set(0x1017, 0, 500);
    set(0x6083, 0, 77);
    set(0x1801, 2, 9);
    forget();
    nmt(130, ID);
    TEST_ASSERT_EQUAL_HEX8(0, last(HEARTBEAT)->data[0]);
    TEST_ASSERT_EQUAL(0, get(0x1017, 0));
    TEST_ASSERT_EQUAL(1, get(0x1801, 2));
    TEST_ASSERT_EQUAL(77, get(0x6083, 0));
    set(0x6072, 0, 10);
    nmt(129, ID);
    TEST_ASSERT_EQUAL(100000, get(0x6083, 0));
    TEST_ASSERT_EQUAL(1000, get(0x6072, 0));
    TEST_ASSERT_TRUE(on.drives.drive[0].settings.current_limit_A == 10);
}

static void urgent_frames_are_sent_first(void) {
    set(0x1017, 0, 10);
    start_nodes();
    forget();
    laconic_frame frame = {.id = 0x600 + ID, .length = 8, .data = {0x40, 0, 0x10, 0}};
    on.now_us += 10000;
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    laconic_canopen.on_step(&on.drives, on.now_us);
    collect();
    TEST_ASSERT_EQUAL(4, on.count);
    static const uint32_t order[4] = {0x80 + ID, 0x180 + ID, 0x580 + ID, HEARTBEAT};
    for (int k = 0; k < 4; k++) TEST_ASSERT_EQUAL_HEX32(order[k], on.sent[k].id);
}

/* --- a controller that goes silent ------------------------------------------------------------------------------- */

static void drive_under_watch(int option, int behaviour) {
    power_up();
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x1029, 1, behaviour);
    set(0x6007, 0, option);
    set(0x60FF, 0, 20000);
    start_nodes();
    step(100); /* the watch begins with the first heartbeat */
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    enable(3);
    for (int k = 0; k < 20; k++) {
        deliver(0x700 + MASTER, BYTES(5), 1);
        step(40);
    }
    TEST_ASSERT_INT_WITHIN(50, 20000, get(0x606C, 0));
    forget();
    step(9);
    TEST_ASSERT_EQUAL(0, count_of(0x80 + ID));
    step(2);
}

static void silence_is_a_fault_by_default_and_the_drive_brakes(void) {
    drive_under_watch(1, 0);
    TEST_ASSERT_EQUAL(1, count_of(0x80 + ID));
    TEST_ASSERT_EQUAL_HEX16(0x8130, canopen_get(last(0x80 + ID)->data, 2));
    TEST_ASSERT_EQUAL(CANOPEN_PRE_OPERATIONAL, on.axes[0].nmt);
    TEST_ASSERT_EQUAL_HEX16(REACTION, state());
    step(300);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    TEST_ASSERT_INT_WITHIN(300, 0, get(0x606C, 0));
    TEST_ASSERT_EQUAL_HEX16(0x8130, get(0x603F, 0) & 0xFFFF);
}

static void option_codes_say_what_silence_does(void) {
    drive_under_watch(0, 1);
    TEST_ASSERT_EQUAL_HEX16(0x8130, canopen_get(last(0x80 + ID)->data, 2));
    step(100);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    TEST_ASSERT_EQUAL(CANOPEN_OPERATIONAL, on.axes[0].nmt);
    deliver(0x700 + MASTER, BYTES(5), 1);
    TEST_ASSERT_EQUAL_HEX16(0, canopen_get(last(0x80 + ID)->data, 2)); /* it is back */
    drive_under_watch(2, 1);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    drive_under_watch(3, 1);
    TEST_ASSERT_EQUAL_HEX16(QUICK_STOP, state());
    drive_under_watch(1, 2);
    TEST_ASSERT_EQUAL(CANOPEN_STOPPED, on.axes[0].nmt);
}

static void stopping_a_node_that_drives_is_a_lost_connection(void) {
    set(0x60FF, 0, 20000);
    start_nodes();
    enable(9);
    step(100);
    nmt(2, ID);
    step(400);
    nmt(128, ID);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    power_up();
    nmt(2, ID); /* nothing moved */
    nmt(128, ID);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
}

static void a_start_of_a_node_that_runs_begins_nothing_anew(void) {
    set(0x1801, 2, 2); /* at every second SYNC */
    start_nodes();
    sync();
    nmt(1, ID);
    forget();
    sync();
    TEST_ASSERT_EQUAL(1, count_of(0x280 + ID));
}

static void a_start_counts_syncs_from_the_beginning(void) {
    set(0x1801, 2, 2); /* at every second SYNC */
    start_nodes();
    sync();
    nmt(128, ID);
    nmt(1, ID);
    forget();
    sync();
    TEST_ASSERT_EQUAL(0, count_of(0x280 + ID));
    sync();
    TEST_ASSERT_EQUAL(1, count_of(0x280 + ID));
}

static void frames_that_only_look_like_commands_move_no_node(void) {
    laconic_frame frame = {.id = 0, .length = 2, .data = {1, 0}, .remote = true};
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    frame.remote = false;
    frame.fd = true;
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    frame.fd = false;
    frame.extended = true;
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    TEST_ASSERT_EQUAL(CANOPEN_PRE_OPERATIONAL, on.axes[0].nmt);
    frame.extended = false;
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    TEST_ASSERT_EQUAL(CANOPEN_OPERATIONAL, on.axes[0].nmt);
}

static void the_windows_of_a_coarse_encoder_are_parts_of_its_turn(void) {
    static const int rows[3][3] = {{30, 1, 4}, {640, 11, 44}, {4095, 64, 256}};
    for (int k = 0; k < 3; k++) {
        on.drives.drive[0].settings.encoder_counts = rows[k][0];
        nmt(129, ID);
        TEST_ASSERT_EQUAL(rows[k][1], get(0x6067, 0));
        TEST_ASSERT_EQUAL(rows[k][2], get(0x606D, 0));
        TEST_ASSERT_EQUAL(rows[k][1], get(0x606F, 0));
    }
    on.drives.drive[0].settings.encoder_counts = 4096;
    nmt(129, ID);
    TEST_ASSERT_EQUAL(100, get(0x6067, 0));
    TEST_ASSERT_EQUAL(500, get(0x606D, 0));
    TEST_ASSERT_EQUAL(5, get(0x606F, 0));
}

static void heartbeats_are_exact_to_the_microsecond(void) {
    set(0x1017, 0, 20);
    set(0x1016, 1, MASTER << 16 | 50);
    deliver(0x700 + MASTER, BYTES(5), 1);
    forget();
    for (uint32_t k = 1; k <= 2; k++) {
        laconic_canopen.on_step(&on.drives, 20000 * k - 1);
        collect();
        TEST_ASSERT_EQUAL(k - 1, count_of(HEARTBEAT));
        laconic_canopen.on_step(&on.drives, 20000 * k);
        collect();
        TEST_ASSERT_EQUAL(k, count_of(HEARTBEAT));
    }
    laconic_canopen.on_step(&on.drives, 50000);
    TEST_ASSERT_EQUAL(0, on.drives.drive[0].faults);
    laconic_canopen.on_step(&on.drives, 50001);
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_FAULT_WATCHDOG, on.drives.drive[0].faults);
}

/* Tests of pdo.c: event timers, inhibit times and deadlines. */

enum { RPDO1 = 0x200 + ID, RPDO2 = 0x300 + ID, TPDO1 = 0x180 + ID, TPDO2 = 0x280 + ID, TPDO3 = 0x380 + ID };

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
    RUN_TEST(each_node_boots_up_and_is_pre_operational);
    RUN_TEST(commands_move_one_node_or_all);
    RUN_TEST(a_stopped_node_answers_nothing_but_its_heartbeat);
    RUN_TEST(heartbeats_come_every_1017_milliseconds_with_the_state);
    RUN_TEST(node_guarding_is_not_answered);
    RUN_TEST(resetting_the_communication_keeps_the_drives_objects_and_resetting_the_node_does_not);
    RUN_TEST(urgent_frames_are_sent_first);
    RUN_TEST(silence_is_a_fault_by_default_and_the_drive_brakes);
    RUN_TEST(option_codes_say_what_silence_does);
    RUN_TEST(stopping_a_node_that_drives_is_a_lost_connection);
    RUN_TEST(a_start_of_a_node_that_runs_begins_nothing_anew);
    RUN_TEST(a_start_counts_syncs_from_the_beginning);
    RUN_TEST(frames_that_only_look_like_commands_move_no_node);
    RUN_TEST(the_windows_of_a_coarse_encoder_are_parts_of_its_turn);
    RUN_TEST(heartbeats_are_exact_to_the_microsecond);
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
