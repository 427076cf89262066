/* Tests of firmware_stub/drives/odrive: CANSimple of firmware 0.6.10, its states, modes and errors. */
#include "odrive_bench.h"

void setUp(void) { bench_begin(&laconic_odrive, NODE, 1); }
void tearDown(void) {}

static void heartbeats_come_every_100_ms_and_estimates_every_10_ms(void) {
    int32_t heartbeats = 0, estimates = 0, others = 0;
    for (int32_t k = 0; k < 1000; k++) {
        bench_step();
        while (drives.protocol->next_frame(&drives, &frame)) {
            heartbeats += frame.id == id(HEARTBEAT);
            estimates += frame.id == id(ESTIMATES);
            others += (frame.id >> 5) != NODE && (frame.id >> 5) != NODE + 1;
        }
    }
    TEST_ASSERT_EQUAL_INT32(10, heartbeats);
    TEST_ASSERT_EQUAL_INT32(100, estimates);
    TEST_ASSERT_EQUAL_INT32(0, others);
}

static void messages_that_a_drive_sends_answer_a_remote_or_an_empty_frame(void) {
    static const uint8_t sent[] = {0x00, 0x01, 0x03, 0x06, 0x09, 0x14, 0x15, 0x17, 0x1C, 0x1D};
    for (size_t k = 0; k < sizeof sent; k++) {
        ask(sent[k]);
        bench_send(id(sent[k]), NULL, 0);
        TEST_ASSERT_TRUE(bench_receive(id(sent[k]), &frame));
    }
    for (uint32_t command = 0; command < 32; command++) {
        const laconic_frame request = {.id = id(command), .remote = true};
        bool sends = false;
        for (size_t k = 0; k < sizeof sent; k++) sends = sends || sent[k] == command;
        drives.protocol->on_frame(&drives, &request, now_us);
        TEST_ASSERT_EQUAL(sends, drives.protocol->next_frame(&drives, &frame));
    }
}

static void version_is_protocol_2_of_firmware_0_6_10(void) {
    static const uint8_t version[8] = {2, 0, 0, 0, 0, 6, 10, 0};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(version, ask(0x00), 8);
}

static void the_lowest_identifier_goes_first(void) {
    for (uint32_t node = NODE + 1; node >= NODE; node--) {
        const laconic_frame low = {.id = node << 5 | 0x03, .remote = true},
                            high = {.id = node << 5 | 0x1D, .remote = true};
        drives.protocol->on_frame(&drives, &high, now_us);
        drives.protocol->on_frame(&drives, &low, now_us);
    }
    static const uint32_t order[] = {NODE << 5 | 0x03, NODE << 5 | 0x1D, (NODE + 1) << 5 | 0x03,
                                     (NODE + 1) << 5 | 0x1D};
    for (int32_t k = 0; k < 4; k++) {
        TEST_ASSERT_TRUE(drives.protocol->next_frame(&drives, &frame));
        TEST_ASSERT_EQUAL_HEX32(order[k], frame.id);
    }
}

static void velocity_control_reaches_the_speed_and_idle_coasts(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(INPUT_VEL, 2, 0);
    bench_steps(2000);
    near(2, speed(), 0.01);
    send_words(SET_STATE, IDLE, 0);
    is_in(IDLE, CANCELLED);
    bench_steps(100);
    near(2, speed(), 0.01);
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_OFF, drives.drive[0].target.mode);
}

static void position_control_starts_where_the_shaft_is_and_goes_where_it_is_told(void) {
    const float far = 1000.25F;
    bench_send(id(SET_POSITION), &far, 4);
    near(1000.25, position(), 1e-3);
    close_loop(POSITION, PASSTHROUGH);
    bench_steps(200);
    near(1000.25, position(), 1e-3);
    const struct {
        float turns;
        int16_t speed, torque;
    } input = {1001.5F, 0, 0};
    bench_send(id(INPUT_POS), &input, 8);
    bench_steps(3000);
    near(1001.5, position(), 0.01);
}

static void torque_control_gives_that_torque(void) {
    close_loop(TORQUE, PASSTHROUGH);
    send_floats(INPUT_TORQUE, 0.1F, 0);
    bench_step();
    near(0.1, drives.drive[0].torque_Nm, 1e-6);
    near(2, bench_float(ask(0x14) + 4), 1e-5); /* A */
    near(0.1, bench_float(ask(0x1C)), 1e-6);
}

static void a_speed_ramp_takes_a_second_for_1_turn_per_s(void) {
    close_loop(VELOCITY, VEL_RAMP);
    send_floats(INPUT_VEL, 3, 0);
    bench_steps(500);
    near(0.5, drives.drive[0].target.speed_rad_per_s / (laconic_real)6.2831853, 0.01);
    bench_steps(3000);
    near(3, speed(), 0.01);
}

static void a_torque_ramp_takes_a_second_for_a_hundredth_of_a_newton_metre(void) {
    close_loop(TORQUE, TORQUE_RAMP);
    send_floats(INPUT_TORQUE, 0.02F, 0);
    bench_steps(1000);
    near(0.01, drives.drive[0].torque_Nm, 1e-4);
}

static void a_position_filter_creeps_to_the_place_without_overshoot(void) {
    close_loop(POSITION, POS_FILTER);
    const struct {
        float turns;
        int16_t speed, torque;
    } input = {1, 0, 0};
    bench_send(id(INPUT_POS), &input, 8);
    for (int32_t k = 0; k < 8000; k++) {
        bench_steps(1);
        TEST_ASSERT_TRUE(position() < (laconic_real)1.01);
    }
    near(1, position(), 0.01);
}

static void a_trapezoidal_trajectory_keeps_its_limits_and_says_when_it_is_done(void) {
    laconic_real fastest = 0;
    int32_t steps = 0;
    close_loop(POSITION, TRAP_TRAJ);
    send_floats(0x12, 2, 1);
    const float limit = 1.5F;
    bench_send(id(0x11), &limit, 4);
    const struct {
        float turns;
        int16_t speed, torque;
    } input = {-6, 0, 0};
    bench_send(id(INPUT_POS), &input, 8);
    TEST_ASSERT_EQUAL_UINT8(0, ask(HEARTBEAT)[6]);
    for (; ask(HEARTBEAT)[6] == 0 && steps < 20000; steps++) {
        const laconic_real asked = drives.drive[0].target.speed_rad_per_s / (laconic_real)6.2831853;
        if (asked < fastest) fastest = asked;
        bench_steps(1);
    }
    near(-1.5, fastest, 1e-3);
    /* 1.5²/(2·2) + 1.5²/(2·1) turns on the ramps, which take 0.75 s and 1.5 s; the rest at 1.5 turns/s */
    near(0.75 + 1.5 + (6 - 0.5625 - 1.125) / 1.5, (laconic_real)steps / 1000, 0.05);
    bench_steps(500);
    near(-6, position(), 0.01);
}

static void limits_hold_the_speed_and_the_current(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(LIMITS, 1, 3);
    send_floats(INPUT_VEL, 5, 0);
    bench_step();
    near(0.15, drives.drive[0].torque_Nm, 1e-6);
    bench_steps(3000);
    near(1, speed(), 0.01);
    send_floats(LIMITS, 2, 1000); /* more than the drive has */
    near(20, drives.drive[0].settings.current_limit_A, 1e-6);
}

static void gains_are_torques_at_the_shaft(void) {
    const float gain = 30;
    send_floats(SET_VEL_GAINS, 0.5F, 1);
    bench_send(id(SET_POS_GAIN), &gain, 4);
    near(0.5 / 6.2831853 / 0.05, drives.drive[0].settings.speed_gain_As, 1e-5);
    near(1 / 6.2831853 / 0.05, drives.drive[0].settings.speed_integral_gain_A, 1e-5);
    near(30, drives.drive[0].settings.position_gain_per_s, 1e-5);
}

static void numbers_that_are_none_change_nothing(void) {
    const laconic_drive_settings before = drives.drive[0].settings;
    const float none = (float)(1e300 * 1e10 * 0);
    static const uint8_t takes_floats[] = {INPUT_POS, INPUT_VEL, INPUT_TORQUE, LIMITS,       0x11,
                                           0x12,      0x13,      SET_POSITION, SET_POS_GAIN, SET_VEL_GAINS};
    close_loop(VELOCITY, PASSTHROUGH);
    for (size_t k = 0; k < sizeof takes_floats; k++) send_floats(takes_floats[k], none, none);
    send_floats(LIMITS, -1, 1);
    send_floats(SET_VEL_GAINS, -1, 1);
    bench_steps(10);
    TEST_ASSERT_EQUAL_MEMORY(&before, &drives.drive[0].settings, sizeof before);
    TEST_ASSERT_TRUE(drives.drive[0].torque_Nm == 0);
    is_in(CLOSED_LOOP, BUSY);
}

static void calibration_of_a_calibrated_drive_ends_in_idle(void) {
    static const uint8_t procedures[] = {3, 4, 6, 7, 10, 12, 13};
    for (size_t k = 0; k < sizeof procedures; k++) {
        send_words(SET_STATE, procedures[k], 0);
        is_in(procedures[k], BUSY);
        bench_steps(200);
        is_in(IDLE, SUCCESS);
    }
    send_words(SET_STATE, 2, 0); /* startup sequence: nothing is configured */
    is_in(IDLE, SUCCESS);
}

static void states_that_it_has_not_are_invalid(void) {
    static const uint32_t states[] = {5, 9, 14, 15, 99, 0x80000000U};
    for (size_t k = 0; k < sizeof states / sizeof states[0]; k++) {
        close_loop(VELOCITY, PASSTHROUGH);
        send_words(SET_STATE, states[k], 0);
        is_in(IDLE, INVALID_STATE);
    }
    send_words(SET_STATE, 11, 0);
    is_in(IDLE, HOMING_WITHOUT_ENDSTOP);
    send_words(SET_STATE, 0, 0);
    is_in(IDLE, HOMING_WITHOUT_ENDSTOP); /* undefined is no request */
}

static void modes_that_are_not_modelled_disarm_with_bad_config(void) {
    static const uint8_t modes[][2] = {{0, 1}, {4, 1}, {2, 4}, {2, 7}, {2, 8}, {3, 9}};
    for (size_t k = 0; k < sizeof modes / sizeof modes[0]; k++) {
        close_loop(VELOCITY, PASSTHROUGH);
        send_words(SET_MODE, modes[k][0], modes[k][1]);
        is_in(IDLE, DISARMED);
        TEST_ASSERT_EQUAL_HEX32(0x10, ask_word(GET_ERROR, 4));
        bench_send(id(CLEAR_ERRORS), "\0", 1);
    }
}

static void errors_must_be_cleared_before_it_arms_again(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    bench_send(id(ESTOP), NULL, 0);
    is_in(IDLE, DISARMED);
    TEST_ASSERT_EQUAL_HEX32(0x2000000, ask_word(GET_ERROR, 0));
    TEST_ASSERT_EQUAL_HEX32(0x2000000, ask_word(GET_ERROR, 4));
    TEST_ASSERT_EQUAL_HEX32(0x2000000, ask_word(HEARTBEAT, 0));
    send_words(SET_STATE, CLOSED_LOOP, 0);
    is_in(IDLE, DISARMED);
    bench_send(id(CLEAR_ERRORS), "\0", 1);
    TEST_ASSERT_EQUAL_HEX32(0, ask_word(HEARTBEAT, 0));
    close_loop(VELOCITY, PASSTHROUGH);
}

static void a_silent_controller_disarms_the_drive_with_a_watchdog(void) {
    drives.watchdog_s = (laconic_real)0.05;
    close_loop(VELOCITY, PASSTHROUGH);
    for (int32_t k = 0; k < 20; k++) {
        send_floats(INPUT_VEL, 1, 0);
        bench_steps(40);
    }
    is_in(CLOSED_LOOP, BUSY);
    bench_steps(60);
    is_in(IDLE, DISARMED);
    TEST_ASSERT_EQUAL_HEX32(0x1000000, ask_word(GET_ERROR, 4));
}

static void faults_of_the_drive_are_errors_of_the_axis(void) {
    static const uint32_t rows[][2] = {
        {LACONIC_DRIVE_FAULT_ENCODER, 0x8},        {LACONIC_DRIVE_FAULT_STALL, 0x4000000},
        {LACONIC_DRIVE_FAULT_TEMPERATURE, 0x4000}, {LACONIC_DRIVE_FAULT_OVERSPEED, 0x8000},
        {LACONIC_DRIVE_FAULT_SUPPLY, 0x200},       {LACONIC_DRIVE_FAULT_FOLLOWING, 0x10000},
        {LACONIC_DRIVE_FAULT_WATCHDOG, 0x1000000}, {LACONIC_DRIVE_FAULT_TARGET, 0x10}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        close_loop(VELOCITY, PASSTHROUGH);
        laconic_drive_fail(&drives.drive[0], rows[k][0]);
        is_in(IDLE, DISARMED);
        TEST_ASSERT_EQUAL_HEX32(rows[k][1], ask_word(GET_ERROR, 4));
        bench_send(id(CLEAR_ERRORS), "\0", 1);
    }
}

static void a_shaft_that_is_dragged_beyond_its_limit_disarms(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(LIMITS, 1, 20);
    bench_speed[0] = (laconic_real)(6.2831853 * 1.3);
    bench_steps(1);
    bench_speed[0] = (laconic_real)(6.2831853 * 1.3);
    bench_steps(1);
    is_in(IDLE, DISARMED);
    TEST_ASSERT_EQUAL_HEX32(0x8000, ask_word(GET_ERROR, 4));
}

static void a_node_id_is_given_by_serial_number(void) {
    uint8_t data[8];
    memcpy(data, ask(ADDRESS), 8);
    TEST_ASSERT_EQUAL_UINT8(NODE, data[0]);
    const laconic_frame scan = {.id = 0x3F << 5 | ADDRESS, .remote = true};
    drives.protocol->on_frame(&drives, &scan, now_us);
    TEST_ASSERT_TRUE(bench_receive((NODE + 1) << 5 | ADDRESS, &frame)); /* every drive answers */
    data[0] = 0x3F;
    bench_send(0x3F << 5 | ADDRESS, data, 7); /* no node id */
    data[0] = 20;
    bench_send(0x3F << 5 | ADDRESS, data, 7);
    bench_drop_frames();
    const laconic_frame request = {.id = 20 << 5 | HEARTBEAT, .remote = true};
    drives.protocol->on_frame(&drives, &request, now_us);
    TEST_ASSERT_TRUE(bench_receive(20 << 5 | HEARTBEAT, &frame));
}

static void a_reboot_brings_back_what_was_saved(void) {
    const float gain = 7;
    const laconic_real before = drives.drive[0].settings.position_gain_per_s;
    close_loop(VELOCITY, PASSTHROUGH);
    bench_send(id(SET_POS_GAIN), &gain, 4);
    bench_send(id(REBOOT), "\0", 1);
    is_in(IDLE, SUCCESS);
    near(before, drives.drive[0].settings.position_gain_per_s, 1e-6);
    bench_send(id(SET_POS_GAIN), &gain, 4);
    bench_send(id(REBOOT), "\1", 1); /* saves first */
    bench_send(id(REBOOT), "\0", 1);
    near(7, drives.drive[0].settings.position_gain_per_s, 1e-6);
}

/* Also where it stands somewhere else: its encoder is an incremental one. */
static void after_a_reboot_the_place_is_0(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(INPUT_VEL, 3, 0);
    bench_steps(2000);
    TEST_ASSERT_TRUE(position() > 4);
    bench_send(id(REBOOT), "\0", 1);
    near(0, position(), 0.0002); /* less than a count */
}

static void endpoints_and_firmware_loading_are_left_unanswered(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    bench_drop_frames();
    bench_send(id(0x04), "\0\1\0\0", 4);
    bench_send(id(ENTER_DFU), NULL, 0);
    bench_send(id(REBOOT), "\3", 1);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
    is_in(CLOSED_LOOP, BUSY);
}

static void frames_of_other_kinds_and_short_ones_are_passed_over(void) {
    const uint32_t closed = CLOSED_LOOP;
    laconic_frame other = {.id = id(SET_STATE), .length = 8, .extended = true};
    memcpy(other.data, &closed, 4);
    drives.protocol->on_frame(&drives, &other, now_us);
    other.extended = false;
    other.fd = true;
    drives.protocol->on_frame(&drives, &other, now_us);
    bench_send(id(SET_STATE), &closed, 3);
    is_in(IDLE, SUCCESS);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(heartbeats_come_every_100_ms_and_estimates_every_10_ms);
    RUN_TEST(messages_that_a_drive_sends_answer_a_remote_or_an_empty_frame);
    RUN_TEST(version_is_protocol_2_of_firmware_0_6_10);
    RUN_TEST(the_lowest_identifier_goes_first);
    RUN_TEST(velocity_control_reaches_the_speed_and_idle_coasts);
    RUN_TEST(position_control_starts_where_the_shaft_is_and_goes_where_it_is_told);
    RUN_TEST(torque_control_gives_that_torque);
    RUN_TEST(a_speed_ramp_takes_a_second_for_1_turn_per_s);
    RUN_TEST(a_torque_ramp_takes_a_second_for_a_hundredth_of_a_newton_metre);
    RUN_TEST(a_position_filter_creeps_to_the_place_without_overshoot);
    RUN_TEST(a_trapezoidal_trajectory_keeps_its_limits_and_says_when_it_is_done);
    RUN_TEST(limits_hold_the_speed_and_the_current);
    RUN_TEST(gains_are_torques_at_the_shaft);
    RUN_TEST(numbers_that_are_none_change_nothing);
    RUN_TEST(calibration_of_a_calibrated_drive_ends_in_idle);
    RUN_TEST(states_that_it_has_not_are_invalid);
    RUN_TEST(modes_that_are_not_modelled_disarm_with_bad_config);
    RUN_TEST(errors_must_be_cleared_before_it_arms_again);
    RUN_TEST(a_silent_controller_disarms_the_drive_with_a_watchdog);
    RUN_TEST(faults_of_the_drive_are_errors_of_the_axis);
    RUN_TEST(a_shaft_that_is_dragged_beyond_its_limit_disarms);
    RUN_TEST(a_node_id_is_given_by_serial_number);
    RUN_TEST(a_reboot_brings_back_what_was_saved);
    RUN_TEST(after_a_reboot_the_place_is_0);
    RUN_TEST(endpoints_and_firmware_loading_are_left_unanswered);
    RUN_TEST(frames_of_other_kinds_and_short_ones_are_passed_over);
    return UNITY_END();
}
