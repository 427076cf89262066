/* Tests of state.c and emergency.c: the CiA 402 state machine over all its transitions, faults and what they say. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

static void a_drive_is_switch_on_disabled_after_power_up(void) {
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    TEST_ASSERT_EQUAL_HEX16(0x0010, statusword() & 0x0010); /* voltage enabled */
}

static void bring_to(uint16_t wanted) {
    power_up();
    set(0x605A, 0, 6); /* a quick stop that stays */
    set(0x605C, 0, 0);
    set(0x6060, 0, 9);
    if (wanted == SWITCH_ON_DISABLED) return;
    control(6);
    if (wanted == READY) return;
    control(7);
    if (wanted == SWITCHED_ON) return;
    control(15);
    if (wanted == ENABLED) return;
    control(2);
}

/* Commands: disable voltage, quick stop, shutdown, switch on (disable operation), enable operation. */
static void every_command_leads_from_every_state_where_cia_402_says(void) {
    static const uint16_t commands[5] = {0, 2, 6, 7, 15};
    static const uint16_t ends[5][6] = {
        {SWITCH_ON_DISABLED, SWITCH_ON_DISABLED, SWITCH_ON_DISABLED, READY, SWITCH_ON_DISABLED, SWITCH_ON_DISABLED},
        {READY, SWITCH_ON_DISABLED, SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED},
        {SWITCHED_ON, SWITCH_ON_DISABLED, SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED},
        {ENABLED, SWITCH_ON_DISABLED, QUICK_STOP, READY, SWITCHED_ON, ENABLED},
        {QUICK_STOP, SWITCH_ON_DISABLED, QUICK_STOP, QUICK_STOP, QUICK_STOP, ENABLED},
    };
    for (int from = 0; from < 5; from++) {
        for (int k = 0; k < 5; k++) {
            bring_to(ends[from][0]);
            TEST_ASSERT_EQUAL_HEX16(ends[from][0], state());
            control(commands[k]);
            TEST_ASSERT_EQUAL_HEX16(ends[from][1 + k], state());
        }
    }
}

static void only_operation_enabled_gives_torque(void) {
    static const uint16_t states[4] = {SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED};
    for (int k = 0; k < 4; k++) {
        bring_to(states[k]);
        set(0x60FF, 0, 4 * COUNTS);
        step(5);
        TEST_ASSERT_EQUAL(states[k] == ENABLED, on.drives.drive[0].torque_Nm > 0);
        TEST_ASSERT_TRUE(on.drives.drive[1].torque_Nm == 0);
    }
}

/* A stop by option code: in which state the drive is while it slows down, where it ends, how many steps it takes. */
static int steps_of_stop(uint16_t index, int option, uint16_t word, uint16_t during, uint16_t after) {
    power_up();
    set(index, 0, option);
    set(0x6084, 0, 100000);
    set(0x6085, 0, 400000);
    set(0x60FF, 0, 20000);
    enable(9);
    step(600);
    TEST_ASSERT_INT_WITHIN(50, 20000, get(0x606C, 0));
    control(word);
    int steps = 0;
    while (state() == during && state() != after && steps < 500) {
        step(1);
        steps++;
    }
    TEST_ASSERT_EQUAL_HEX16(after, state());
    return steps;
}

/* 20,000 counts/s along 100,000 or 400,000 counts/s² take 200 or 50 steps, and the wheel follows a little later. */
static void option_codes_say_how_the_drive_stops(void) {
    TEST_ASSERT_EQUAL(0, steps_of_stop(0x605A, 0, 2, QUICK_STOP, SWITCH_ON_DISABLED));
    TEST_ASSERT_INT_WITHIN(8, 207, steps_of_stop(0x605A, 1, 2, QUICK_STOP, SWITCH_ON_DISABLED));
    TEST_ASSERT_INT_WITHIN(8, 63, steps_of_stop(0x605A, 2, 2, QUICK_STOP, SWITCH_ON_DISABLED));
    TEST_ASSERT_EQUAL(0, steps_of_stop(0x605B, 0, 6, ENABLED, READY));
    TEST_ASSERT_INT_WITHIN(8, 207, steps_of_stop(0x605B, 1, 6, ENABLED, READY));
    TEST_ASSERT_EQUAL(0, steps_of_stop(0x605C, 0, 7, ENABLED, SWITCHED_ON));
    TEST_ASSERT_INT_WITHIN(8, 207, steps_of_stop(0x605C, 1, 7, ENABLED, SWITCHED_ON));
}

static void quick_stops_that_stay_hold_the_wheel_and_let_the_drive_be_enabled_again(void) {
    steps_of_stop(0x605A, 5, 2, ENABLED, QUICK_STOP);
    step(400);
    TEST_ASSERT_EQUAL_HEX16(QUICK_STOP, state());
    TEST_ASSERT_INT_WITHIN(20, 0, get(0x606C, 0));
    TEST_ASSERT_BITS_HIGH(1024, statusword());
    control(15);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    step(600);
    TEST_ASSERT_INT_WITHIN(50, 20000, get(0x606C, 0));
}

static void a_command_that_comes_with_its_mode_again_and_again_does_not_slow_down_a_stop(void) {
    static const uint8_t quick_stop[3] = {2, 0, 9};
    set(0x60FF, 0, 20000);
    set(0x6085, 0, 400000);
    enable(9);
    start_nodes();
    step(600);
    for (int k = 0; k < 80; k++) {
        deliver(0x200 + ID, quick_stop, 3);
        step(1);
    }
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
    TEST_ASSERT_INT_WITHIN(5, 0, get(0x606C, 0));
}

static void a_quick_stop_that_does_not_stay_cannot_be_taken_back(void) {
    set(0x605A, 0, 2);
    set(0x60FF, 0, 20000);
    enable(9);
    step(300);
    control(2);
    control(15);
    TEST_ASSERT_EQUAL_HEX16(QUICK_STOP, state());
}

static void enabling_again_ends_a_ramp_to_another_state(void) {
    steps_of_stop(0x605C, 1, 15, QUICK_STOP, ENABLED);
    control(7);
    step(50);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    control(15);
    step(400);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    TEST_ASSERT_INT_WITHIN(50, 20000, get(0x606C, 0));
}

static void halt_slows_down_and_going_on_needs_no_new_command(void) {
    enable(3);
    set(0x60FF, 0, 20000);
    step(600);
    control(15 | 256);
    step(500);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    TEST_ASSERT_INT_WITHIN(20, 0, get(0x606C, 0));
    TEST_ASSERT_BITS_HIGH(1024, statusword());
    control(15);
    step(600);
    TEST_ASSERT_INT_WITHIN(50, 20000, get(0x606C, 0));
}

/* --- faults ------------------------------------------------------------------------------------------------------ */

static void check_emergency(uint16_t code, uint8_t register_) {
    const laconic_frame *frame = last(0x80 + ID);
    TEST_ASSERT_NOT_NULL(frame);
    TEST_ASSERT_EQUAL(8, frame->length);
    TEST_ASSERT_EQUAL_HEX16(code, canopen_get(frame->data, 2));
    TEST_ASSERT_EQUAL_HEX8(register_, frame->data[2]);
}

static void each_fault_of_a_drive_has_its_code_in_emcy_603f_and_1003(void) {
    static const struct {
        uint32_t fault;
        uint16_t code;
        uint8_t register_;
    } faults[] = {{LACONIC_DRIVE_FAULT_ENCODER, 0x7305, 33},    {LACONIC_DRIVE_FAULT_STALL, 0x7121, 33},
                  {LACONIC_DRIVE_FAULT_TEMPERATURE, 0x4310, 9}, {LACONIC_DRIVE_FAULT_OVERSPEED, 0x8400, 33},
                  {LACONIC_DRIVE_FAULT_SUPPLY, 0x3220, 5},      {LACONIC_DRIVE_FAULT_WATCHDOG, 0x8100, 17},
                  {LACONIC_DRIVE_FAULT_FOLLOWING, 0x8611, 33},  {LACONIC_DRIVE_FAULT_TARGET, 0x6320, 33}};
    for (size_t k = 0; k < sizeof faults / sizeof faults[0]; k++) {
        power_up();
        enable(9);
        forget();
        laconic_drive_fail(&on.drives.drive[0], faults[k].fault);
        step(1);
        check_emergency(faults[k].code, faults[k].register_);
        TEST_ASSERT_EQUAL(0, count_of(0x80 + OTHER_ID));
        TEST_ASSERT_EQUAL_HEX16(FAULT, state());
        TEST_ASSERT_EQUAL_HEX16(faults[k].code, get(0x603F, 0) & 0xFFFF);
        TEST_ASSERT_EQUAL(1, get(0x1003, 0));
        TEST_ASSERT_EQUAL_HEX32(faults[k].code, get(0x1003, 1));
        control(0);
        control(128);
        check_emergency(0, 0);
        TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
        TEST_ASSERT_EQUAL(0, get(0x603F, 0));
    }
}

static void a_fault_is_reset_by_a_rising_edge_alone_and_by_no_other_command(void) {
    enable(9);
    control(15 | 128); /* the bit is high already when the fault comes */
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    step(1);
    static const uint16_t words[7] = {128, 128, 0, 2, 6, 7, 15};
    for (int k = 0; k < 7; k++) {
        control(words[k]);
        TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    }
    control(128);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
}

static void a_fault_whose_cause_remains_is_not_reset(void) {
    enable(9);
    laconic_drive_break(&on.drives.drive[0], LACONIC_DRIVE_FAULT_ENCODER);
    step(1);
    control(0);
    control(128);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
    laconic_drive_mend(&on.drives.drive[0], LACONIC_DRIVE_FAULT_ENCODER);
    control(0);
    control(128);
    TEST_ASSERT_EQUAL_HEX16(SWITCH_ON_DISABLED, state());
}

static void the_history_keeps_the_four_newest_errors_and_is_cleared_by_zero(void) {
    static const uint32_t faults[5] = {1, 2, 4, 8, 16};
    for (int k = 0; k < 5; k++) {
        laconic_drive_fail(&on.drives.drive[0], faults[k]);
        step(1);
        control(0);
        control(128);
    }
    TEST_ASSERT_EQUAL(4, get(0x1003, 0));
    TEST_ASSERT_EQUAL_HEX32(0x3220, get(0x1003, 1));
    TEST_ASSERT_EQUAL_HEX32(0x7121, get(0x1003, 4));
    set(0x1003, 0, 0);
    TEST_ASSERT_EQUAL(0, get(0x1003, 0));
    TEST_ASSERT_EQUAL_HEX32(CANOPEN_VALUE, write_as(0x1003, 0, 1, 1));
}

static void a_node_with_emcy_switched_off_sends_none(void) {
    set(0x1014, 0, (int64_t)(0x80000080U + ID));
    forget();
    laconic_drive_fail(&on.drives.drive[0], LACONIC_DRIVE_FAULT_STALL);
    step(3);
    TEST_ASSERT_EQUAL(0, count_of(0x80 + ID));
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_drive_is_switch_on_disabled_after_power_up);
    RUN_TEST(every_command_leads_from_every_state_where_cia_402_says);
    RUN_TEST(only_operation_enabled_gives_torque);
    RUN_TEST(option_codes_say_how_the_drive_stops);
    RUN_TEST(quick_stops_that_stay_hold_the_wheel_and_let_the_drive_be_enabled_again);
    RUN_TEST(a_command_that_comes_with_its_mode_again_and_again_does_not_slow_down_a_stop);
    RUN_TEST(a_quick_stop_that_does_not_stay_cannot_be_taken_back);
    RUN_TEST(enabling_again_ends_a_ramp_to_another_state);
    RUN_TEST(halt_slows_down_and_going_on_needs_no_new_command);
    RUN_TEST(each_fault_of_a_drive_has_its_code_in_emcy_603f_and_1003);
    RUN_TEST(a_fault_is_reset_by_a_rising_edge_alone_and_by_no_other_command);
    RUN_TEST(a_fault_whose_cause_remains_is_not_reset);
    RUN_TEST(the_history_keeps_the_four_newest_errors_and_is_cleared_by_zero);
    RUN_TEST(a_node_with_emcy_switched_off_sends_none);
    return UNITY_END();
}
