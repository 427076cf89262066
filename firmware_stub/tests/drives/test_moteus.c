/* Tests of firmware_stub/drives/moteus: frames of the register protocol, modes, the position controller, limits. */
#include "moteus_bench.h"

void setUp(void) { bench_begin(&laconic_moteus, NODE, GEAR); }
void tearDown(void) {}

static void a_query_is_answered_in_the_types_that_it_asks_for(void) {
    ANSWERS("\x14\x04\x00\x13\x0D", "\x24\x04\x00\x00\x00\x00\x00\x00\x00\x00\x00\x23\x0D\x30\x19\x00");
    TEST_ASSERT_EQUAL_HEX32(0x100, frame.id);
    TEST_ASSERT_FALSE(frame.extended);
    ANSWERS("\x19\x00", "\x29\x00\x00\x00\x00\x00"); /* mode as int32 */
}

static void integers_that_mean_not_set_and_numbers_beyond_the_range(void) {
    ANSWERS("\x01\x00\x0A\x01\x20\x80\x11\x20", "\x21\x20\x80");                 /* NaN */
    ANSWERS("\x01\x00\x0A\x0D\x20\x00\x00\x20\x41\x11\x20", "\x21\x20\x7F");     /* 10 turns: at most 1.27 */
    ANSWERS("\x01\x00\x0A\x0D\x20\x00\x00\x20\xC1\x15\x20", "\x25\x20\x01\x80"); /* -10 turns: -3.2767 */
    ANSWERS("\x01\x00\x0A\x05\x21\xA0\x0F\x1D\x21", "\x2D\x21\x00\x00\x80\x3F"); /* 4000 of 0.00025 turns/s */
}

static void registers_that_are_unknown_or_not_writeable_are_errors(void) {
    ANSWERS("\x11\x7F", "\x31\x7F\x01");
    ANSWERS("\x11\x10", "\x31\x10\x01"); /* PWM of a phase */
    ANSWERS("\x01\x01\x05", "\x30\x01\x02");
    ANSWERS("\x01\x7F\x05", "\x30\x7F\x01");
    ANSWERS("\x01\x70\x05", "\x30\x70\x02");
    ANSWERS("\x12\x07\x11\x00", "\x31\x08\x01"); /* the range is void, the rest of the frame is left */
    ANSWERS("\x11\x80\x02", "\x31\x80\x02\x01"); /* model number is an int32 */
    ANSWERS("\x19\x82\x02", "\x29\x82\x02\x05\x00\x00\x00");
    ANSWERS("\x09\x2A\x01\x00\x00\x00\x09\x2A\x00\x00\x00\x80\x11\x00", "\x30\x2A\x01\x21\x00\x00");
}

static void modes_that_are_not_modelled_are_refused_as_unknown(void) {
    static const uint8_t modes[] = {5, 6, 7, 8, 14, 16, 127};
    for (size_t k = 0; k < sizeof modes; k++) {
        const uint8_t request[] = {0x01, 0x00, modes[k]}, refusal[] = {0x30, 0x00, 0x01};
        bench_send(TO_NODE, request, 3);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(refusal, reply(), 3);
    }
    near(STOPPED, read_float(0x00), 0.1);
}

static void only_a_frame_that_asks_is_answered(void) {
    bench_send(NODE, "\x11\x00", 2);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
    bench_send(ASK | 5, "\x11\x00", 2); /* another node */
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
    bench_send(0x10000 | TO_NODE, "\x11\x00", 2); /* another prefix */
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
    bench_send(ASK | 0x1200 | NODE, "\x11\x00", 2);
    TEST_ASSERT_TRUE(bench_receive(REPLY | 0x12, &frame)); /* to the node that asked */
}

static void every_drive_answers_the_broadcast_and_a_uuid_selects_one(void) {
    bench_send(ASK | 0x7F, "\x18\x04\xD0\x02", 4);
    TEST_ASSERT_TRUE(bench_receive(REPLY, &frame));
    uint8_t uuid[16], select[] = {0x08, 0x04, 0xD4, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x11, 0x00};
    memcpy(uuid, frame.data + 4, 16);
    TEST_ASSERT_TRUE(bench_receive(REPLY + 0x100, &frame));
    TEST_ASSERT_TRUE(memcmp(uuid, frame.data + 4, 16) != 0);
    memcpy(select + 4, uuid, 16);
    bench_send(ASK | 0x7F, select, sizeof select);
    TEST_ASSERT_TRUE(drives.protocol->next_frame(&drives, &frame));
    TEST_ASSERT_EQUAL_HEX32(REPLY, frame.id);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
}

static void replies_are_as_fast_as_the_query_and_padded(void) {
    laconic_frame query = {.id = TO_NODE, .length = 12, .fd = true, .bit_rate_switch = true, .extended = true};
    memcpy(query.data, "\x1F\x01\x50\x50\x50\x50\x50\x50\x50\x50\x50\x50", 12);
    drives.protocol->on_frame(&drives, &query, now_us);
    reply();
    TEST_ASSERT_EQUAL_UINT8(16, frame.length); /* 14 bytes */
    TEST_ASSERT_EQUAL_HEX8(0x50, frame.data[15]);
    TEST_ASSERT_TRUE(frame.fd && frame.bit_rate_switch);
}

static void a_reply_with_no_room_left_ends_there(void) {
    uint8_t request[24];
    for (size_t k = 0; k < 12; k++) {
        request[2 * k] = 0x1F;
        request[2 * k + 1] = 0x01;
    }
    bench_send(TO_NODE, request, sizeof request);
    reply();
    TEST_ASSERT_EQUAL_UINT8(64, frame.length); /* four of 14 bytes, padded */
    TEST_ASSERT_EQUAL_HEX8(0x50, frame.data[56]);
}

static void a_second_query_before_the_reply_is_taken_gets_none(void) {
    bench_send(TO_NODE, "\x11\x0D", 2);
    bench_send(TO_NODE, "\x11\x00", 2);
    TEST_ASSERT_EQUAL_HEX8(0x0D, reply()[1]);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
}

static void the_diagnostic_stream_is_mute(void) {
    ANSWERS("\x42\x01\x30", "\x41\x01\x00");
    ANSWERS("\x40\x01\x03tel\x11\x00", "\x41\x01\x00\x21\x00\x00");
    bench_send(TO_NODE, "\x44\x01\x00\x30\x11\x00", 6); /* with flow control: unknown */
    reply();
    TEST_ASSERT_EQUAL_UINT8(0, frame.length);
}

static void position_mode_goes_there_within_its_acceleration_and_says_when_it_is_done(void) {
    put_mode(POSITION);
    put_float(0x20, 1);
    put_float(0x28, (laconic_real)0.5);
    put_float(0x29, 2);
    put_float(0x27, none);
    send();
    laconic_real fastest = 0;
    int32_t steps = 0;
    bench_steps(1);
    for (; read_float(0x0B) == 0 && steps < 20000; steps++) {
        const laconic_real asked = read_float(0x39);
        if (asked > fastest) fastest = asked;
        bench_steps(1);
    }
    near(0.5, fastest, 1e-3);
    near(0.25 + 0.25 + (1 - 0.125) / 0.5, (laconic_real)steps / 1000, 0.05);
    bench_steps(2000);
    near(1, read_float(0x01), 0.01);
    near(POSITION, read_float(0x00), 0.1);
}

static void the_law_is_kp_times_turns_and_kd_times_turns_per_second(void) {
    const laconic_drive_settings *has = &drives.drive[0].settings;
    const laconic_real kd = has->speed_gain_As * has->torque_constant_Nm_per_A * GEAR * GEAR * (laconic_real)6.2831853;
    put_mode(POSITION);
    put_float(0x20, (laconic_real)0.001);
    put_float(0x23, (laconic_real)0.5);
    put_float(0x28, -1);
    put_float(0x29, -1);
    put_float(0x22, (laconic_real)0.125);
    send();
    bench_step();
    near((laconic_real)0.001 * kd * has->position_gain_per_s / 2 + (laconic_real)0.125, drives.drive[0].torque_Nm,
         1e-4);
}

static void velocity_is_kept_and_the_maximum_torque_too(void) {
    hold(none, (laconic_real)0.5, 3000);
    near(0.5, read_float(0x02), 0.01);
    put_mode(POSITION);
    put_float(0x20, none);
    put_float(0x21, -5);
    put_float(0x25, (laconic_real)0.02);
    send();
    bench_steps(50);
    near(-0.02, drives.drive[0].torque_Nm, 1e-5);
    near(102, read_float(0x0F), 0.1);
}

static void silence_ends_position_mode_after_100_ms_and_only_stop_leaves_the_timeout(void) {
    hold(none, 1, 1000);
    bench_steps(70); /* the last command was 20 ms earlier */
    near(POSITION, read_float(0x00), 0.1);
    bench_steps(30);
    near(TIMEOUT, read_float(0x00), 0.1);
    bench_steps(2000);
    near(0, read_float(0x02), 0.01); /* damped to rest */
    TEST_ASSERT_TRUE(drives.drive[0].unheard);
    hold(none, 1, 20);
    near(TIMEOUT, read_float(0x00), 0.1);
    put_mode(STOPPED);
    send();
    hold(none, 1, 20);
    near(POSITION, read_float(0x00), 0.1);
    TEST_ASSERT_TRUE(drives.drive[0].unheard); /* a verdict at the end still tells of it */
}

static void the_timeout_is_that_of_the_command_of_the_scene_or_none(void) {
    drives.watchdog_s = (laconic_real)0.03;
    hold(none, 1, 1);
    bench_steps(40);
    near(TIMEOUT, read_float(0x00), 0.1);
    put_mode(STOPPED);
    send();
    put_mode(POSITION);
    put_float(0x27, (laconic_real)0.3);
    send();
    bench_steps(250);
    near(POSITION, read_float(0x00), 0.1);
    bench_steps(100);
    near(TIMEOUT, read_float(0x00), 0.1);
}

static void stay_within_pushes_back_from_its_bounds_alone(void) {
    put_mode(STAY_WITHIN);
    put_float(0x40, -1);
    put_float(0x41, 1);
    put_float(0x46, none);
    send();
    bench_step();
    near(0, drives.drive[0].torque_Nm, 1e-9);
    put_mode(STAY_WITHIN);
    put_float(0x40, (laconic_real)0.5);
    put_float(0x41, none);
    put_float(0x46, none);
    send();
    bench_steps(3000);
    near(0.5, read_float(0x01), 0.02);
}

static void current_zero_velocity_brake_and_stop(void) {
    put_mode(CURRENT);
    put_float(0x1C, 2);
    send();
    bench_step();
    near(2, drives.drive[0].current_A, 1e-5);
    bench_steps(500);
    put_mode(BRAKE);
    send();
    bench_step();
    TEST_ASSERT_TRUE(drives.drive[0].current_A < 0);
    put_mode(ZERO_VELOCITY);
    send();
    bench_steps(3000); /* no timeout */
    near(0, read_float(0x02), 0.01);
    near(ZERO_VELOCITY, read_float(0x00), 0.1);
    put_mode(STOPPED);
    send();
    bench_step();
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_OFF, drives.drive[0].target.mode);
}

static void a_stop_position_with_limits_is_fault_45_and_works_without(void) {
    put_mode(POSITION);
    put_float(0x26, 1);
    send();
    near(FAULT, read_float(0x00), 0.1);
    near(45, read_float(0x0F), 0.1);
    put_mode(STOPPED);
    send();
    put_mode(POSITION);
    put_float(0x20, none);
    put_float(0x21, (laconic_real)-0.5); /* the sign is chosen towards the stop position */
    put_float(0x26, (laconic_real)0.25);
    put_float(0x27, none);
    put_float(0x29, -1);
    send();
    bench_steps(4000);
    near(0.25, read_float(0x01), 0.01);
}

static void faults_of_the_drive_are_faults_until_stopped(void) {
    static const uint8_t rows[][2] = {{LACONIC_DRIVE_FAULT_ENCODER, 35},     {LACONIC_DRIVE_FAULT_STALL, 33},
                                      {LACONIC_DRIVE_FAULT_TEMPERATURE, 38}, {LACONIC_DRIVE_FAULT_SUPPLY, 40},
                                      {LACONIC_DRIVE_FAULT_OVERSPEED, 50},   {LACONIC_DRIVE_FAULT_FOLLOWING, 49}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        hold(none, 0, 5);
        near(POSITION, read_float(0x00), 0.1);
        laconic_drive_fail(&drives.drive[0], rows[k][0]);
        hold(none, 0, 5);
        near(FAULT, read_float(0x00), 0.1);
        near(rows[k][1], read_float(0x0F), 0.1);
        put_mode(STOPPED);
        send();
        near(0, read_float(0x0F), 0.1);
    }
}

static void the_output_gets_the_number_that_it_is_told(void) {
    hold(none, (laconic_real)0.5, 1500);
    const laconic_real before = read_float(0x01);
    bench_send(TO_NODE, "\x0D\xB1\x02\x00\x00\x80\x42", 7); /* exactly 64 turns */
    bench_drop_frames();
    near(64, read_float(0x01), 1e-4);
    near(2, read_float(0x0C), 0.1);
    bench_send(TO_NODE, "\x0D\xB0\x02\x00\x00\x80\x3F", 7); /* nearest to 1 turn: whole turns of the shaft */
    bench_drop_frames();
    TEST_ASSERT_TRUE(read_float(0x01) > (laconic_real)0.874 && read_float(0x01) < (laconic_real)1.126);
    near(64 - read_float(0x01), (laconic_real)(int32_t)((64 - read_float(0x01)) * GEAR + (laconic_real)0.5) / GEAR,
         1e-3);
    TEST_ASSERT_TRUE(before > 0);
}

static void a_reversed_gear_turns_the_other_way(void) {
    bench_begin(&laconic_moteus, NODE, -GEAR);
    hold(none, (laconic_real)0.5, 2000);
    near(0.5, read_float(0x02), 0.01);
    near((laconic_real)(0.5 * 6.2831853), bench_speed[0], 0.1);
    TEST_ASSERT_TRUE(drives.drive[0].encoder.count < 0);
}

static void malformed_frames_do_what_can_be_read_of_them(void) {
    static const char *const frames[] = {"\x01",           "\x0D\x20\x00", "\x1C", "\x1C\xFF\xFF\xFF\xFF\xFF",
                                         "\x40\x01\x09xx", "\x60"};
    for (size_t k = 0; k < sizeof frames / sizeof frames[0]; k++) {
        bench_send(TO_NODE, frames[k], (uint8_t)strlen(frames[k]));
        reply();
        TEST_ASSERT_EQUAL_UINT8(0, frame.length);
    }
    bench_send(TO_NODE, "\x01\x00\x0A\x0D", 4);
    bench_drop_frames();
    near(POSITION, read_float(0x00), 0.1);
}

static void the_millisecond_counter_counts(void) {
    bench_steps(300);
    ANSWERS("\x15\x70", "\x25\x70\x2C\x01");
    ANSWERS("\x11\x70", "\x21\x70\x2C");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_query_is_answered_in_the_types_that_it_asks_for);
    RUN_TEST(integers_that_mean_not_set_and_numbers_beyond_the_range);
    RUN_TEST(registers_that_are_unknown_or_not_writeable_are_errors);
    RUN_TEST(modes_that_are_not_modelled_are_refused_as_unknown);
    RUN_TEST(only_a_frame_that_asks_is_answered);
    RUN_TEST(every_drive_answers_the_broadcast_and_a_uuid_selects_one);
    RUN_TEST(replies_are_as_fast_as_the_query_and_padded);
    RUN_TEST(a_reply_with_no_room_left_ends_there);
    RUN_TEST(a_second_query_before_the_reply_is_taken_gets_none);
    RUN_TEST(the_diagnostic_stream_is_mute);
    RUN_TEST(position_mode_goes_there_within_its_acceleration_and_says_when_it_is_done);
    RUN_TEST(the_law_is_kp_times_turns_and_kd_times_turns_per_second);
    RUN_TEST(velocity_is_kept_and_the_maximum_torque_too);
    RUN_TEST(silence_ends_position_mode_after_100_ms_and_only_stop_leaves_the_timeout);
    RUN_TEST(the_timeout_is_that_of_the_command_of_the_scene_or_none);
    RUN_TEST(stay_within_pushes_back_from_its_bounds_alone);
    RUN_TEST(current_zero_velocity_brake_and_stop);
    RUN_TEST(a_stop_position_with_limits_is_fault_45_and_works_without);
    RUN_TEST(faults_of_the_drive_are_faults_until_stopped);
    RUN_TEST(the_output_gets_the_number_that_it_is_told);
    RUN_TEST(a_reversed_gear_turns_the_other_way);
    RUN_TEST(malformed_frames_do_what_can_be_read_of_them);
    RUN_TEST(the_millisecond_counter_counts);
    return UNITY_END();
}
