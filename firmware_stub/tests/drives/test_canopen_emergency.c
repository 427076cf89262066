/* Tests of emergency.c and of what follows an error: which EMCY frames are sent when, and what becomes of the drive. */
#include "canopen_bench.h"

enum { EMCY = 0x80 + ID, RPDO1 = 0x200 + ID, RPDO2 = 0x300 + ID, MASTER = 1 };

#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})

void setUp(void) { power_up(); }
void tearDown(void) {}

/* Nothing that is due gets onto the bus until it is free again. */
static void busy_bus(void) { on.count = KEPT; }
static void free_bus(void) {
    forget();
    collect();
}

/* The codes of the EMCY frames that were sent are these, and there are no more. */
static void told(const uint16_t *codes, int count) {
    int found = 0;
    for (int k = 0; k < on.count; k++) {
        if (on.sent[k].id != EMCY) continue;
        TEST_ASSERT_LESS_THAN(count, found);
        TEST_ASSERT_EQUAL_HEX16(codes[found++], canopen_get(on.sent[k].data, 2));
    }
    TEST_ASSERT_EQUAL(count, found);
}
#define TOLD(...) told((const uint16_t[]){__VA_ARGS__}, (int)(sizeof((const uint16_t[]){__VA_ARGS__}) / 2))

static void heartbeat(void) { deliver(0x700 + MASTER, BYTES(5), 1); }

/* --- which frames ------------------------------------------------------------------------------------------------ */

static void a_busy_bus_gets_the_four_newest_errors_oldest_first_then_their_reset(void) {
    static const uint32_t faults[5] = {LACONIC_DRIVE_FAULT_ENCODER, LACONIC_DRIVE_FAULT_STALL,
                                       LACONIC_DRIVE_FAULT_TEMPERATURE, LACONIC_DRIVE_FAULT_OVERSPEED,
                                       LACONIC_DRIVE_FAULT_SUPPLY};
    start_nodes();
    busy_bus();
    for (int k = 0; k < 5; k++) {
        laconic_drive_fail(&on.drives.drive[0], faults[k]);
        step(1);
        deliver(RPDO1, BYTES(128, 0), 3);
        deliver(RPDO1, BYTES(0, 0), 3);
        TEST_ASSERT_EQUAL(CANOPEN_DISABLED, on.axes[0].state);
    }
    free_bus();
    TOLD(0x7121, 0x4310, 0x8400, 0x3220, 0);
    TEST_ASSERT_EQUAL_HEX8(0, last(EMCY)->data[2]);
}

static void an_error_that_ended_before_it_was_told_is_told_and_reset(void) {
    start_nodes();
    busy_bus();
    deliver(RPDO1, BYTES(0), 1);
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    free_bus();
    TOLD(0x8210, 0);
    forget();
    step(10);
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
}

static void no_reset_is_told_while_another_error_remains(void) {
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x6007, 0, 0);
    set(0x1029, 1, 1);
    start_nodes();
    heartbeat();
    deliver(RPDO1, BYTES(0), 1);
    step(60);
    forget();
    heartbeat(); /* the controller is back, and its frame too short as before */
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001, 0));
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    TOLD(0);
    TEST_ASSERT_EQUAL_HEX8(0, get(0x1001, 0));
}

static void a_heartbeat_does_not_end_a_fault(void) {
    set(0x1016, 1, MASTER << 16 | 50);
    start_nodes();
    heartbeat();
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    step(1);
    forget();
    heartbeat();
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
    TEST_ASSERT_EQUAL_HEX8(0x21, get(0x1001, 0));
}

static void a_missed_deadline_ends_with_the_next_frame_of_that_pdo(void) {
    set(0x1400, 5, 50);
    set(0x6007, 0, 0);
    set(0x1029, 1, 1);
    start_nodes();
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    forget();
    step(151);
    TOLD(0x8250); /* once */
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001, 0));
    forget();
    deliver(RPDO2, BYTES(0, 0, 0, 0), 4); /* another */
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
    deliver(RPDO1, BYTES(0, 0, 0), 3);
    TOLD(0);
    TEST_ASSERT_EQUAL_HEX8(0, get(0x1001, 0));
}

/* --- NMT --------------------------------------------------------------------------------------------------------- */

static void a_stopped_node_tells_its_errors_when_it_may_speak_again(void) {
    start_nodes();
    nmt(2, ID);
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    forget();
    step(5);
    TEST_ASSERT_EQUAL(0, on.count);
    nmt(128, ID);
    TOLD(0x7121);
}

static void a_node_that_is_stopped_while_it_drives_tells_it_afterwards(void) {
    enable(9);
    start_nodes();
    forget();
    nmt(2, ID);
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
    nmt(1, ID);
    TOLD(0x8100);
}

static void a_node_that_is_reset_while_it_drives_tells_it_after_its_boot_up(void) {
    enable(9);
    start_nodes();
    forget();
    nmt(130, ID);
    TEST_ASSERT_EQUAL_HEX32(0x700 + ID, on.sent[0].id);
    TEST_ASSERT_EQUAL_HEX32(EMCY, on.sent[1].id);
    TOLD(0x8100);
    TEST_ASSERT_EQUAL_HEX16(0x8100, get(0x603F, 0) & 0xFFFF);
    forget();
    nmt(130, ID); /* it does not drive any more */
    TEST_ASSERT_EQUAL(1, on.count);
    TEST_ASSERT_EQUAL_HEX32(0x700 + ID, on.sent[0].id);
}

static void a_quick_stop_counts_as_driving(void) {
    set(0x605A, 0, 5);
    enable(9);
    start_nodes();
    control(2);
    TEST_ASSERT_EQUAL_HEX16(QUICK_STOP, state());
    nmt(2, ID);
    nmt(128, ID);
    TOLD(0x8100);
}

static void silence_leaves_a_node_that_is_not_operational_as_it_is(void) {
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x6007, 0, 0);
    heartbeat();
    forget();
    step(60);
    TOLD(0x8130);
    TEST_ASSERT_EQUAL(CANOPEN_PRE_OPERATIONAL, on.axes[0].nmt);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
}

static void a_watch_without_a_time_never_fires(void) {
    set(0x1016, 1, MASTER << 16);
    heartbeat();
    forget();
    step(2000);
    TEST_ASSERT_EQUAL(0, count_of(EMCY));
}

/* --- the drive --------------------------------------------------------------------------------------------------- */

/* Operation enabled in `mode` with the controller's heartbeat, which then ceases. */
static void fall_silent(int option) {
    power_up();
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x1029, 1, 1);
    set(0x6007, 0, option);
    set(0x60FF, 0, 20000);
    start_nodes();
    enable(9);
    heartbeat();
    step(51);
}

static void fault_reaction_0_lets_the_wheel_coast_at_once(void) {
    power_up();
    set(0x605E, 0, 0);
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x60FF, 0, 20000);
    start_nodes();
    enable(9);
    heartbeat();
    step(51);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    TEST_ASSERT_TRUE(on.drives.drive[0].target.mode == LACONIC_DRIVE_OFF);
}

static void a_drive_that_fails_while_it_brakes_is_off_at_once(void) {
    fall_silent(1);
    TEST_ASSERT_EQUAL_HEX16(REACTION, state());
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_ENCODER);
    step(1);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    TEST_ASSERT_TRUE(on.drives.drive[0].torque_Nm == 0);
    TEST_ASSERT_EQUAL_HEX16(0x8130, get(0x603F, 0) & 0xFFFF); /* what came first */
}

static void silence_does_not_take_a_drive_out_of_its_fault(void) {
    for (int option = 0; option <= 3; option++) {
        power_up();
        set(0x1016, 1, MASTER << 16 | 50);
        set(0x1029, 1, 1);
        set(0x6007, 0, option);
        start_nodes();
        heartbeat();
        laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
        step(60);
        TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    }
}

static void silence_of_option_3_stops_no_drive_that_is_not_enabled(void) {
    set(0x1016, 1, MASTER << 16 | 50);
    set(0x1029, 1, 1);
    set(0x6007, 0, 3);
    start_nodes();
    control(6);
    control(7);
    heartbeat();
    step(60);
    TEST_ASSERT_EQUAL_HEX16(SWITCHED_ON, state());
}

/* Neither ends the silence of heartbeats nor begins nor ends the watch over them. */
static void process_data_are_no_heartbeats(void) {
    static const uint8_t lengths[4] = {3, 4, 4, 2};
    for (uint32_t k = 0; k < 4; k++) {
        power_up();
        set(0x1016, 1, MASTER << 16 | 50);
        set(0x6007, 0, 0);
        set(0x1029, 1, 1);
        start_nodes();
        heartbeat();
        step(45);
        forget();
        deliver(RPDO1 + 0x100 * k, BYTES(0), lengths[k]);
        step(6);
        TOLD(0x8130);
        TEST_ASSERT_TRUE(on.drives.drive[0].unheard);
        forget();
        deliver(RPDO1 + 0x100 * k, BYTES(0), lengths[k]);
        step(200);
        TEST_ASSERT_EQUAL(0, count_of(EMCY));
        TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001, 0));
    }
}

static void a_drive_that_nmt_stops_has_lost_its_controller(void) {
    enable(9);
    start_nodes();
    nmt(2, ID);
    step(100);
    TEST_ASSERT_EQUAL(CANOPEN_FAULT, on.axes[0].state);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_WATCHDOG, on.drives.drive[0].faults);
}

static void resetting_the_communication_ends_its_errors_but_no_fault(void) {
    start_nodes();
    deliver(RPDO1, BYTES(0), 1);
    TEST_ASSERT_EQUAL_HEX8(0x11, get(0x1001, 0));
    nmt(130, ID);
    TEST_ASSERT_EQUAL_HEX8(0, get(0x1001, 0));
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    step(1);
    nmt(130, ID);
    TEST_ASSERT_EQUAL_HEX8(0x21, get(0x1001, 0));
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_busy_bus_gets_the_four_newest_errors_oldest_first_then_their_reset);
    RUN_TEST(an_error_that_ended_before_it_was_told_is_told_and_reset);
    RUN_TEST(no_reset_is_told_while_another_error_remains);
    RUN_TEST(a_heartbeat_does_not_end_a_fault);
    RUN_TEST(a_missed_deadline_ends_with_the_next_frame_of_that_pdo);
    RUN_TEST(a_stopped_node_tells_its_errors_when_it_may_speak_again);
    RUN_TEST(a_node_that_is_stopped_while_it_drives_tells_it_afterwards);
    RUN_TEST(a_node_that_is_reset_while_it_drives_tells_it_after_its_boot_up);
    RUN_TEST(a_quick_stop_counts_as_driving);
    RUN_TEST(silence_leaves_a_node_that_is_not_operational_as_it_is);
    RUN_TEST(a_watch_without_a_time_never_fires);
    RUN_TEST(fault_reaction_0_lets_the_wheel_coast_at_once);
    RUN_TEST(a_drive_that_fails_while_it_brakes_is_off_at_once);
    RUN_TEST(silence_does_not_take_a_drive_out_of_its_fault);
    RUN_TEST(silence_of_option_3_stops_no_drive_that_is_not_enabled);
    RUN_TEST(process_data_are_no_heartbeats);
    RUN_TEST(a_drive_that_nmt_stops_has_lost_its_controller);
    RUN_TEST(resetting_the_communication_ends_its_errors_but_no_fault);
    return UNITY_END();
}
