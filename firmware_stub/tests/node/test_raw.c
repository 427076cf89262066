/* Tests of raw_frames.c: numbers cross the bus bit for bit, and a stream out of order is refused. */
#include "drive_scene.h"
#include "laconic_node/raw_frames.h"
#include "unity.h"

#include <string.h>

static laconic_raw_input raw;
static laconic_input input[3];

void setUp(void) {
    memset(&raw, 0, sizeof raw);
    memset(input, 0, sizeof input);
}
void tearDown(void) {}

/* Sends numbers 1, 2, 3 … in segments of six bytes; returns how many. */
static uint16_t send(int count, int32_t wheels) {
    laconic_real numbers[64];
    uint8_t bytes[sizeof numbers + 6] = {0};
    uint16_t segments = 0;
    for (int k = 0; k < count; k++) numbers[k] = (laconic_real)(k + 1);
    memcpy(bytes, numbers, (size_t)count * sizeof numbers[0]);
    for (size_t at = 0; at < (size_t)count * sizeof numbers[0]; at += 6, segments++)
        TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, wheels, segments & 15U, 15, bytes + at, 6));
    return segments;
}

static void every_input_has_its_position_in_the_stream(void) {
    raw.take = LACONIC_RAW_VOLTAGE | LACONIC_RAW_AXLE_TORQUE | LACONIC_RAW_BODY_WRENCH | LACONIC_RAW_WORLD_FORCE;
    const uint16_t frames = send(2 + 2 + 3 + 4, 2);
    TEST_ASSERT_TRUE(raw.complete && laconic_raw_is_whole(&raw, frames));
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, (uint16_t)(frames + 1U)));
    TEST_ASSERT_TRUE(input[0].voltage_V[1] == 2 && input[0].axle_torque_Nm[1] == 4);
    TEST_ASSERT_TRUE(input[0].body_force_N[1] == 6 && input[0].body_moment_Nm == 7);
    TEST_ASSERT_TRUE(input[0].world_force_N[1] == 9 && input[0].world_force_point_m[1] == 11);
    TEST_ASSERT_TRUE(input[1].voltage_V[0] == 0);
}

static void sampled_inputs_fill_start_middle_and_end(void) {
    raw.take = LACONIC_RAW_VOLTAGE | LACONIC_RAW_SAMPLED;
    send(6, 2);
    TEST_ASSERT_TRUE(raw.complete);
    TEST_ASSERT_TRUE(input[0].voltage_V[1] == 2 && input[1].voltage_V[0] == 3 && input[2].voltage_V[1] == 6);
}

static void torques_alone_and_sampled_torques_with_voltages_are_as_many_as_they_are(void) {
    raw.take = LACONIC_RAW_AXLE_TORQUE;
    send(2, 2);
    TEST_ASSERT_TRUE(raw.complete && input[0].axle_torque_Nm[1] == 2);
    laconic_raw_restart(&raw);
    raw.take = LACONIC_RAW_VOLTAGE | LACONIC_RAW_AXLE_TORQUE | LACONIC_RAW_SAMPLED;
    send(12, 2);
    TEST_ASSERT_TRUE(raw.complete && input[1].voltage_V[0] == 5 && input[2].axle_torque_Nm[1] == 12);
}

static void a_missing_segment_breaks_the_stream_until_it_begins_anew(void) {
    const uint8_t bytes[6] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 4, 0, 15, bytes, 6));
    TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 4, 2, 15, bytes, 6));
    TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 4, 1, 15, bytes, 6));
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, 1));
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 4, 0, 15, bytes, 6));
}

static void one_segment_too_many_is_refused(void) {
    const uint8_t bytes[6] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    const uint16_t frames = send(1, 1);
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 1, (uint8_t)frames, 15, bytes, 6));
        TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, frames));
    }
}

static void nothing_chosen_takes_nothing_nor_do_voltages_without_wheels(void) {
    const uint8_t bytes[6] = {0};
    TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 2, 0, 15, bytes, 6));
    laconic_raw_restart(&raw);
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 0, 0, 15, bytes, 6));
    laconic_raw_restart(&raw);
    TEST_ASSERT_TRUE(laconic_raw_is_whole(&raw, 0));
}

static void a_stream_that_begins_anew_counts_its_frames_anew(void) {
    const uint8_t bytes[6] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 4, 0, 15, bytes, 6));
    TEST_ASSERT_EQUAL_UINT16(1, raw.frames);
    laconic_raw_restart(&raw);
    TEST_ASSERT_TRUE(raw.frames == 0 && raw.segment == 0 && raw.filled == 0 && raw.position == 0);
}

static void world_forces_fill_four_numbers_each(void) {
    raw.take = LACONIC_RAW_WORLD_FORCE;
    send(4, 2);
    TEST_ASSERT_TRUE(raw.complete);
    TEST_ASSERT_TRUE(input[0].world_force_N[0] == 1 && input[0].world_force_N[1] == 2);
    TEST_ASSERT_TRUE(input[0].world_force_point_m[0] == 3 && input[0].world_force_point_m[1] == 4);
}

static void bytes_are_given_in_parts_and_the_last_ends_in_zeros(void) {
    laconic_raw_output out;
    uint8_t bytes[10];
    memset(&out, 0xEE, sizeof out);
    out.size = 16;
    out.position = 0;
    out.segment = 0;
    for (uint8_t k = 0; k < 16; k++) ((uint8_t *)out.number)[k] = k;
    TEST_ASSERT_TRUE(laconic_raw_give(&out, bytes, 10));
    TEST_ASSERT_TRUE(bytes[0] == 0 && bytes[9] == 9 && out.position == 10 && out.segment == 1);
    TEST_ASSERT_FALSE(laconic_raw_give(&out, bytes, 10));
    TEST_ASSERT_TRUE(bytes[0] == 10 && bytes[5] == 15 && bytes[6] == 0 && bytes[9] == 0 && out.position == 16);
}

static void a_restart_forgets_that_all_had_come(void) {
    raw.take = LACONIC_RAW_VOLTAGE;
    send(16, 16);
    TEST_ASSERT_TRUE(raw.complete && input[0].voltage_V[15] == 16);
    laconic_raw_restart(&raw);
    TEST_ASSERT_FALSE(raw.complete || raw.broken);
}

/* Frames that bring no whole number, and those that end with one of several, are no whole inputs either. */
static void a_stream_that_ends_early_is_not_whole(void) {
    const uint8_t bytes[2 * sizeof(laconic_real)] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 0, 15, bytes, sizeof(laconic_real) / 2));
    TEST_ASSERT_TRUE(raw.position == 0 && raw.filled == sizeof(laconic_real) / 2);
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, 1));
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 1, 15, bytes, sizeof(laconic_real) / 2));
    TEST_ASSERT_TRUE(raw.position == 1 && raw.filled == 0);
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, 2));
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 2, 15, bytes, sizeof(laconic_real)));
    TEST_ASSERT_TRUE(laconic_raw_is_whole(&raw, 3));
}

static void a_wrench_alone_fills_two_forces_and_a_moment(void) {
    raw.take = LACONIC_RAW_BODY_WRENCH;
    send(3, 2);
    TEST_ASSERT_TRUE(raw.complete);
    TEST_ASSERT_TRUE(input[0].body_force_N[0] == 1 && input[0].body_force_N[1] == 2 && input[0].body_moment_Nm == 3);
}

static void a_wrench_follows_as_many_voltages_as_it_has_numbers(void) {
    raw.take = LACONIC_RAW_VOLTAGE | LACONIC_RAW_BODY_WRENCH;
    send(6, 3);
    TEST_ASSERT_TRUE(raw.complete && input[0].voltage_V[2] == 3 && input[0].body_moment_Nm == 6);
}

static void a_segment_that_comes_again_breaks_the_stream(void) {
    const uint8_t bytes[6] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 4, 0, 15, bytes, 6));
    TEST_ASSERT_FALSE(laconic_raw_take(&raw, input, 4, 0, 15, bytes, 6));
    TEST_ASSERT_TRUE(raw.broken);
}

static void more_frames_than_the_rig_has_sent_are_not_whole(void) {
    raw.take = LACONIC_RAW_VOLTAGE;
    const uint16_t frames = send(4, 4);
    TEST_ASSERT_TRUE(laconic_raw_is_whole(&raw, frames));
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, (uint16_t)(frames - 1U)));
}

static void reading_moves_nothing_and_each_torque_is_its_wheels(void) {
    static laconic_plant plant, before;
    static laconic_raw_output out;
    const laconic_vehicle vehicle = scene_vehicle(0);
    const laconic_start start = {{1, 2, 3}, 0, 0, 0, {0}};
    const laconic_input held = {.axle_torque_Nm = {5, 6, 7, 8}};
    laconic_real nu[3];
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_rk4, SCENE_STEP_S, &start, NULL));
    memcpy(&before, &plant, sizeof plant);
    laconic_nu(&before.model, &before.state, nu);
    out.send = LACONIC_RAW_NU | LACONIC_RAW_HELD_TORQUE;
    laconic_raw_collect(&out, &plant, &held, NULL);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
    TEST_ASSERT_EQUAL_UINT16(7 * sizeof(laconic_real), out.size);
    TEST_ASSERT_EQUAL_MEMORY(nu, out.number, sizeof nu);
    TEST_ASSERT_EQUAL_MEMORY(held.axle_torque_Nm, out.number + 3, 4 * sizeof(laconic_real));
}

/* No byte behind the numbers is read, which the sanitizers watch. */
static void the_last_bytes_of_the_most_numbers_are_given_alone(void) {
    static laconic_raw_output out;
    uint8_t bytes[60];
    memset(&out, 0xEE, sizeof out);
    memset(bytes, 0x5A, sizeof bytes);
    out.size = sizeof out.number;
    out.position = sizeof out.number - 4;
    TEST_ASSERT_FALSE(laconic_raw_give(&out, bytes, sizeof bytes));
    TEST_ASSERT_TRUE(bytes[3] == 0xEE && bytes[4] == 0 && bytes[59] == 0 && out.position == sizeof out.number);
}

/* A frame without bytes has come all the same; and bytes have, though the segments are back at the first. */
static void whether_numbers_have_come_is_told_by_their_bytes(void) {
    const uint8_t bytes[sizeof(laconic_real)] = {0};
    raw.take = LACONIC_RAW_VOLTAGE;
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 0, 15, bytes, 0));
    TEST_ASSERT_TRUE(laconic_raw_is_whole(&raw, 1));
    laconic_raw_restart(&raw);
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 0, 1, bytes, 1));
    TEST_ASSERT_TRUE(laconic_raw_take(&raw, input, 2, 1, 1, bytes, 1));
    TEST_ASSERT_TRUE(raw.segment == 0 && raw.position == 0);
    TEST_ASSERT_FALSE(laconic_raw_is_whole(&raw, 2));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_input_has_its_position_in_the_stream);
    RUN_TEST(sampled_inputs_fill_start_middle_and_end);
    RUN_TEST(torques_alone_and_sampled_torques_with_voltages_are_as_many_as_they_are);
    RUN_TEST(a_missing_segment_breaks_the_stream_until_it_begins_anew);
    RUN_TEST(one_segment_too_many_is_refused);
    RUN_TEST(nothing_chosen_takes_nothing_nor_do_voltages_without_wheels);
    RUN_TEST(a_stream_that_begins_anew_counts_its_frames_anew);
    RUN_TEST(world_forces_fill_four_numbers_each);
    RUN_TEST(bytes_are_given_in_parts_and_the_last_ends_in_zeros);
    RUN_TEST(a_restart_forgets_that_all_had_come);
    RUN_TEST(a_stream_that_ends_early_is_not_whole);
    RUN_TEST(a_wrench_alone_fills_two_forces_and_a_moment);
    RUN_TEST(a_wrench_follows_as_many_voltages_as_it_has_numbers);
    RUN_TEST(a_segment_that_comes_again_breaks_the_stream);
    RUN_TEST(more_frames_than_the_rig_has_sent_are_not_whole);
    RUN_TEST(reading_moves_nothing_and_each_torque_is_its_wheels);
    RUN_TEST(the_last_bytes_of_the_most_numbers_are_given_alone);
    RUN_TEST(whether_numbers_have_come_is_told_by_their_bytes);
    return UNITY_END();
}
