/* Tests of robomaster.c: commands and feedback of C620 and C610, bit by bit. */
#include "drive_scene.h"
#include "unity.h"

static laconic_drives drives;
static laconic_plant plant;
static laconic_input held;
static uint64_t axes[16 * LACONIC_MAX_WHEELS];
static uint32_t now_us;

static void begin(const laconic_drive_protocol *protocol, laconic_real watchdog_s) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    laconic_drive_plan plan = scene_plan(0);
    plan.watchdog_s = watchdog_s;
    plan.drive[3].node_id = 6;
    scene_plant(&plant, &vehicle);
    memset(&held, 0, sizeof held);
    now_us = 0xFFFFF000U; /* the time wraps after four steps */
    laconic_drives_start(&drives, &plan, protocol, axes, &plant, now_us);
}

void setUp(void) { begin(&laconic_robomaster, 0); }
void tearDown(void) {}

static void step(int count) {
    for (int k = 0; k < count; k++) {
        now_us += 1000;
        laconic_drives_step(&drives, &plant, &held, now_us, NULL);
    }
}

static void command(uint32_t id, int place, int raw) {
    laconic_frame frame = {.id = id, .length = 8};
    frame.data[2 * place] = (uint8_t)((unsigned)raw >> 8 & 255U);
    frame.data[2 * place + 1] = (uint8_t)((unsigned)raw & 255U);
    laconic_drives_on_frame(&drives, &frame, now_us);
}

static void a_command_is_a_current_in_its_place_high_byte_first(void) {
    command(0x200, 1, 8192);
    TEST_ASSERT_TRUE(drives.drive[1].target.current_A == 10 && drives.drive[0].target.current_A == 0);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_CURRENT, drives.drive[0].target.mode);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, drives.drive[3].target.mode); /* number 6: the other frame */
    command(0x200, 2, -16384);
    TEST_ASSERT_TRUE(drives.drive[2].target.current_A == -20 && drives.drive[1].target.current_A == 0);
    command(0x1FF, 1, 4096);
    TEST_ASSERT_TRUE(drives.drive[3].target.current_A == 5);
}

static void each_number_has_its_place_in_one_of_two_frames(void) {
    for (int number = 1; number <= 8; number++) {
        setUp();
        drives.drive[0].settings.node_id = number;
        for (int place = 0; place < 4; place++) command(number <= 4 ? 0x1FF : 0x200, place, 4096);
        TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, drives.drive[0].target.mode);
        command(number <= 4 ? 0x200 : 0x1FF, (number - 1) % 4, 1024 * number);
        TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_CURRENT, drives.drive[0].target.mode);
        TEST_ASSERT_TRUE(drives.drive[0].target.current_A == REAL(1.25) * (laconic_real)number);
    }
}

static void a_command_beyond_full_scale_is_full_scale(void) {
    command(0x200, 0, 32767);
    TEST_ASSERT_TRUE(drives.drive[0].target.current_A == 20);
    command(0x200, 0, -32768);
    TEST_ASSERT_TRUE(drives.drive[0].target.current_A == -20);
}

static void a_c610_has_half_the_current_and_no_temperature(void) {
    laconic_frame frame;
    begin(&laconic_robomaster_c610, 0);
    command(0x200, 0, 10000);
    TEST_ASSERT_TRUE(drives.drive[0].target.current_A > REAL(9.9999) &&
                     drives.drive[0].target.current_A < REAL(10.0001));
    step(1);
    TEST_ASSERT_TRUE(laconic_drives_next_frame(&drives, &frame));
    TEST_ASSERT_EQUAL_INT(10000, frame.data[4] << 8 | frame.data[5]);
    TEST_ASSERT_EQUAL_UINT8(0, frame.data[6]);
}

static void frames_that_are_no_commands_are_passed_over(void) {
    laconic_frame frame = {.id = 0x200, .length = 8, .data = {0x40}};
    frame.extended = true;
    laconic_drives_on_frame(&drives, &frame, now_us);
    frame.extended = false;
    frame.remote = true;
    laconic_drives_on_frame(&drives, &frame, now_us);
    frame.remote = false;
    frame.fd = true;
    laconic_drives_on_frame(&drives, &frame, now_us);
    frame.fd = false;
    frame.length = 7;
    laconic_drives_on_frame(&drives, &frame, now_us);
    frame.length = 8;
    frame.id = 0x201;
    laconic_drives_on_frame(&drives, &frame, now_us);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, drives.drive[0].target.mode);
}

static int word_of(const laconic_frame *frame, int at) { return (int16_t)(frame->data[at] << 8 | frame->data[at + 1]); }

static void feedback_comes_every_millisecond_with_angle_speed_and_current(void) {
    laconic_frame frame;
    for (int k = 0; k < 500; k++) {
        command(0x200, 0, -1639); /* −2 A */
        step(1);
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_TRUE(laconic_drives_next_frame(&drives, &frame));
            TEST_ASSERT_EQUAL_HEX32(i < 3 ? 0x201U + (uint32_t)i : 0x206U, frame.id);
            TEST_ASSERT_TRUE(frame.length == 8 && !frame.extended && !frame.remote && !frame.fd);
            TEST_ASSERT_EQUAL_INT((int)drives.drive[i].encoder.count & 8191, word_of(&frame, 0));
            const laconic_real rpm = drives.drive[i].speed_rad_per_s * REAL(60 / 6.28318530717958647693);
            TEST_ASSERT_TRUE((laconic_real)word_of(&frame, 2) - rpm < REAL(0.51) &&
                             (laconic_real)word_of(&frame, 2) - rpm > REAL(-0.51));
            TEST_ASSERT_EQUAL_INT(i == 0 ? -1639 : 0, word_of(&frame, 4));
            TEST_ASSERT_TRUE(frame.data[6] == 25 && frame.data[7] == 0);
        }
        TEST_ASSERT_FALSE(laconic_drives_next_frame(&drives, &frame));
    }
    TEST_ASSERT_TRUE(drives.drive[0].encoder.count < -1000);
}

static void a_speed_or_current_beyond_16_bits_is_their_end(void) {
    laconic_frame frame;
    for (int side = -1; side <= 1; side += 2) {
        step(1);
        drives.drive[0].speed_rad_per_s = REAL(side * 1e4); /* 95,493 rpm */
        drives.drive[0].current_A = REAL(side * 50);        /* 40,960 of 16,384 for 20 A */
        TEST_ASSERT_TRUE(laconic_drives_next_frame(&drives, &frame));
        TEST_ASSERT_EQUAL_HEX32(0x201, frame.id);
        for (int at = 2; at < 6; at += 2) {
            TEST_ASSERT_EQUAL_HEX8(side < 0 ? 0x80 : 0x7F, frame.data[at]);
            TEST_ASSERT_EQUAL_HEX8(side < 0 ? 0x00 : 0xFF, frame.data[at + 1]);
        }
        while (laconic_drives_next_frame(&drives, &frame)) continue;
    }
}

static void an_encoder_of_other_counts_is_told_in_8192_parts_of_a_turn(void) {
    laconic_frame frame;
    drives.drive[0].settings.encoder_counts = 1024;
    drives.drive[0].encoder.count = 1024 * 5 + 512;
    step(1);
    laconic_drives_next_frame(&drives, &frame);
    TEST_ASSERT_EQUAL_INT(4096, word_of(&frame, 0));
}

static int frames_of(int steps, uint32_t each_us) {
    laconic_frame frame;
    int frames = 0;
    for (int k = 0; k < steps; k++) {
        now_us += each_us;
        laconic_drives_step(&drives, &plant, &held, now_us, NULL);
        while (laconic_drives_next_frame(&drives, &frame)) frames++;
    }
    return frames;
}

static void shorter_steps_send_feedback_every_millisecond_also_late(void) {
    drives.step_s = REAL(0.0005);
    TEST_ASSERT_EQUAL_INT(40, frames_of(20, 500));
    drives.step_s = REAL(0.0003);
    TEST_ASSERT_INT_WITHIN(4, 40, frames_of(33, 300));
    now_us += 10000; /* the port was away; its steps come at once */
    TEST_ASSERT_INT_WITHIN(4, 40, frames_of(33, 0));
}

static void longer_steps_send_their_feedback_alone(void) {
    drives.step_s = REAL(0.005);
    TEST_ASSERT_EQUAL_INT(40, frames_of(10, 5000));
}

static void without_a_watchdog_the_last_command_stays(void) {
    command(0x200, 0, 800);
    step(5000);
    TEST_ASSERT_TRUE(drives.drive[0].current_A > 0 && drives.drive[0].faults == 0);
}

static void the_watchdog_switches_off_until_the_next_command(void) {
    begin(&laconic_robomaster, REAL(0.1));
    command(0x200, 0, 800);
    step(100);
    TEST_ASSERT_TRUE(drives.drive[0].current_A > 0);
    step(1);
    TEST_ASSERT_TRUE(drives.drive[0].current_A == 0);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_WATCHDOG, drives.drive[0].faults);
    command(0x200, 0, 800);
    step(1);
    TEST_ASSERT_TRUE(drives.drive[0].current_A > 0 && drives.drive[0].faults == 0);
    TEST_ASSERT_TRUE(drives.drive[0].unheard); /* a verdict at the end still tells of it */
}

static void the_watchdog_of_a_group_runs_from_its_first_command_on(void) {
    begin(&laconic_robomaster, REAL(0.1));
    step(500);
    command(0x200, 0, 800);
    step(50);
    TEST_ASSERT_TRUE(drives.drive[0].current_A > 0 && !drives.drive[0].unheard);
    step(100);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_WATCHDOG, drives.drive[0].faults);
    TEST_ASSERT_FALSE(drives.drive[3].unheard); /* no command for number 6 has ever come */
}

static void a_fault_by_order_stays_whatever_is_commanded(void) {
    laconic_drive_break(&drives.drive[0], LACONIC_DRIVE_FAULT_TEMPERATURE);
    command(0x200, 0, 800);
    step(1);
    TEST_ASSERT_TRUE(drives.drive[0].current_A == 0);
    laconic_drive_mend(&drives.drive[0], LACONIC_DRIVE_FAULT_TEMPERATURE);
    command(0x200, 0, 800);
    step(1);
    TEST_ASSERT_TRUE(drives.drive[0].current_A > 0);
}

static void a_vehicle_without_drives_is_silent(void) {
    laconic_frame frame;
    drives.count = 0;
    drives.axes = NULL;
    laconic_robomaster.start(&drives, now_us);
    command(0x200, 0, 800);
    step(3);
    TEST_ASSERT_FALSE(laconic_drives_next_frame(&drives, &frame));
}

static void a_speed_that_rounds_beyond_16_bits_is_their_end(void) {
    laconic_frame frame;
    step(1);
    drives.drive[0].speed_rad_per_s = REAL(32767.75) / REAL(9.54929658551372014613);
    TEST_ASSERT_TRUE(laconic_drives_next_frame(&drives, &frame));
    TEST_ASSERT_EQUAL_HEX8(0x7F, frame.data[2]);
    TEST_ASSERT_EQUAL_HEX8(0xFF, frame.data[3]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_command_is_a_current_in_its_place_high_byte_first);
    RUN_TEST(each_number_has_its_place_in_one_of_two_frames);
    RUN_TEST(a_command_beyond_full_scale_is_full_scale);
    RUN_TEST(a_c610_has_half_the_current_and_no_temperature);
    RUN_TEST(frames_that_are_no_commands_are_passed_over);
    RUN_TEST(feedback_comes_every_millisecond_with_angle_speed_and_current);
    RUN_TEST(a_speed_or_current_beyond_16_bits_is_their_end);
    RUN_TEST(an_encoder_of_other_counts_is_told_in_8192_parts_of_a_turn);
    RUN_TEST(shorter_steps_send_feedback_every_millisecond_also_late);
    RUN_TEST(longer_steps_send_their_feedback_alone);
    RUN_TEST(without_a_watchdog_the_last_command_stays);
    RUN_TEST(the_watchdog_switches_off_until_the_next_command);
    RUN_TEST(the_watchdog_of_a_group_runs_from_its_first_command_on);
    RUN_TEST(a_fault_by_order_stays_whatever_is_commanded);
    RUN_TEST(a_vehicle_without_drives_is_silent);
    RUN_TEST(a_speed_that_rounds_beyond_16_bits_is_their_end);
    return UNITY_END();
}
