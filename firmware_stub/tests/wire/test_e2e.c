/* Tests of e2e.c: CRC and counter of profiles 22 and 5. */
#include "laconic_node/e2e.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const uint8_t ids[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

static laconic_e2e_ends of(uint8_t counter) {
    const laconic_e2e_ends ends = {LACONIC_E2E_P22_START, ids[counter & 15U]};
    return ends;
}

static const laconic_e2e_ends fd = {LACONIC_E2E_P05_START, 0x1234};

static void profile_2_gives_the_published_headers(void) {
    const uint8_t expected[4][2] = {{0x1B, 0x01}, {0x98, 0x02}, {0x31, 0x03}, {0x0D, 0x04}};
    for (uint8_t counter = 1; counter <= 4; counter++) {
        uint8_t data[8] = {0};
        laconic_e2e_p22_protect(data, 8, of(counter), counter);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected[counter - 1], data, 2);
    }
}

static void a_frame_too_short_for_its_header_is_never_right(void) {
    uint8_t data[3] = {0};
    for (uint32_t crc = 0; crc <= 0xFFFFU; crc++) {
        data[0] = (uint8_t)(crc & 255U);
        data[1] = (uint8_t)(crc >> 8);
        TEST_ASSERT_FALSE(laconic_e2e_p22_crc_is_right(data, 1, of(0)));
        TEST_ASSERT_FALSE(laconic_e2e_p05_crc_is_right(data, 2, fd));
    }
}

static void profile_5_finds_each_flipped_bit(void) {
    uint8_t data[64];
    memset(data, 0xA5, sizeof data);
    laconic_e2e_p05_protect(data, 64, fd, 9);
    TEST_ASSERT_TRUE(laconic_e2e_p05_crc_is_right(data, 64, fd));
    for (int bit = 0; bit < 512; bit++) {
        data[bit / 8] = (uint8_t)(data[bit / 8] ^ 1U << bit % 8);
        TEST_ASSERT_FALSE(laconic_e2e_p05_crc_is_right(data, 64, fd));
        data[bit / 8] = (uint8_t)(data[bit / 8] ^ 1U << bit % 8);
    }
}

static void the_status_machine_never_moves_for_a_refused_frame(void) {
    laconic_e2e_receiver receiver = {0};
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, 9, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_REPEATED, laconic_e2e_check(&receiver, true, 9, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_ERROR, laconic_e2e_check(&receiver, false, 10, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 3, 15, 1));
    TEST_ASSERT_EQUAL_UINT8(9, receiver.counter);
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, 10, 15, 1));
}

static void lost_frames_are_counted_up_to_max_delta(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 14, 15, 3);
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK_SOME_LOST, laconic_e2e_check(&receiver, true, 1, 15, 3));
    TEST_ASSERT_EQUAL_UINT8(2, receiver.lost);
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 5, 15, 3));
}

static void three_frames_in_a_row_make_a_new_reference(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 9, 15, 1);
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 1, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 2, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, 3, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 9, 15, 1));
}

/* Counters of four bits and of eight, each over its end. */
static void three_frames_in_a_row_follow_each_other_over_the_counters_end(void) {
    static const uint8_t masks[] = {15, 255};
    for (size_t k = 0; k < sizeof masks; k++) {
        const uint8_t mask = masks[k];
        for (uint8_t first = (uint8_t)(mask - 2U); first != 1; first = (uint8_t)((first + 1U) & mask)) {
            laconic_e2e_receiver receiver = {.known = true, .counter = 9};
            const uint8_t second = (uint8_t)((first + 1U) & mask), third = (uint8_t)((first + 2U) & mask);
            TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, first, mask, 1));
            TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, second, mask, 1));
            TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, third, mask, 1));
            TEST_ASSERT_EQUAL_UINT8(third, receiver.counter);
        }
    }
}

/* The headers come from PyPI's autosar-e2e, an implementation of others. */
static void profile_5_gives_the_headers_of_another_implementation(void) {
    uint8_t zeros[8] = {0}, rising[16];
    const laconic_e2e_ends other = {LACONIC_E2E_P05_START, 0xBEEF};
    for (uint8_t k = 0; k < 16; k++) rising[k] = k;
    laconic_e2e_p05_protect(zeros, 8, fd, 0);
    TEST_ASSERT_TRUE(zeros[0] == 0x1C && zeros[1] == 0xCA && zeros[2] == 0);
    laconic_e2e_p05_protect(rising, 16, other, 9);
    TEST_ASSERT_TRUE(rising[0] == 0xC9 && rising[1] == 0x1F && rising[2] == 9);
}

static void the_shortest_frames_are_their_headers(void) {
    uint8_t classic[2] = {0}, long_one[3] = {0};
    laconic_e2e_p22_protect(classic, 2, of(3), 3);
    TEST_ASSERT_TRUE(laconic_e2e_p22_crc_is_right(classic, 2, of(3)));
    laconic_e2e_p05_protect(long_one, 3, fd, 200);
    TEST_ASSERT_TRUE(long_one[2] == 200 && laconic_e2e_p05_crc_is_right(long_one, 3, fd));
}

static void the_counter_leaves_the_bits_beside_it(void) {
    uint8_t data[8] = {0, 0xA7};
    laconic_e2e_p22_protect(data, 8, of(5), 0x35);
    TEST_ASSERT_EQUAL_HEX8(0xA5, data[1]);
}

static void a_stray_frame_is_forgotten_when_the_next_one_is_right(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 9, 15, 1);
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 1, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 2, 15, 1));
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, 10, 15, 1));
    TEST_ASSERT_EQUAL_UINT8(0, receiver.stray_count);
    TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, 3, 15, 1));
    TEST_ASSERT_EQUAL_UINT8(1, receiver.stray_count);
}

/* Before any stray frame the number 0 is none: a frame with count 1 does not follow it. */
static void the_first_stray_frame_follows_none(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 9, 15, 1);
    laconic_e2e_check(&receiver, true, 1, 15, 1);
    TEST_ASSERT_EQUAL_UINT8(1, receiver.stray_count);
}

static void stray_frames_that_do_not_follow_each_other_make_no_reference(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 9, 15, 1);
    for (uint8_t k = 0; k < 8; k++)
        TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, k % 2 ? 1 : 5, 15, 1));
    static const uint8_t down[] = {7, 6, 5, 4}, up[] = {1, 3, 5, 7};
    for (int k = 0; k < 4; k++)
        TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, down[k], 15, 1));
    for (int k = 0; k < 4; k++)
        TEST_ASSERT_EQUAL(LACONIC_E2E_WRONG_SEQUENCE, laconic_e2e_check(&receiver, true, up[k], 15, 1));
    TEST_ASSERT_EQUAL_UINT8(9, receiver.counter);
}

static void a_counter_takes_the_place_of_what_stood_there(void) {
    uint8_t data[8] = {0, 0xFF};
    laconic_e2e_p22_protect(data, 8, of(2), 2);
    TEST_ASSERT_EQUAL_HEX8(0xF2, data[1]);
}

static void frames_in_order_are_right_and_each_is_the_next_reference(void) {
    laconic_e2e_receiver receiver = {0};
    for (uint8_t k = 0; k < 20; k++) {
        TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, k & 15U, 15, 3));
        TEST_ASSERT_TRUE(receiver.lost == 0 && receiver.counter == (k & 15U));
    }
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK_SOME_LOST, laconic_e2e_check(&receiver, true, 5, 15, 3));
    TEST_ASSERT_TRUE(receiver.lost == 1 && receiver.counter == 5);
}

static void each_gap_is_told_by_itself(void) {
    laconic_e2e_receiver receiver = {0};
    laconic_e2e_check(&receiver, true, 1, 15, 3);
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK_SOME_LOST, laconic_e2e_check(&receiver, true, 4, 15, 3));
    TEST_ASSERT_EQUAL_UINT8(2, receiver.lost);
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK_SOME_LOST, laconic_e2e_check(&receiver, true, 6, 15, 3));
    TEST_ASSERT_EQUAL_UINT8(1, receiver.lost);
    TEST_ASSERT_EQUAL(LACONIC_E2E_OK, laconic_e2e_check(&receiver, true, 7, 15, 3));
    TEST_ASSERT_EQUAL_UINT8(0, receiver.lost);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(profile_2_gives_the_published_headers);
    RUN_TEST(a_frame_too_short_for_its_header_is_never_right);
    RUN_TEST(profile_5_finds_each_flipped_bit);
    RUN_TEST(the_status_machine_never_moves_for_a_refused_frame);
    RUN_TEST(lost_frames_are_counted_up_to_max_delta);
    RUN_TEST(three_frames_in_a_row_make_a_new_reference);
    RUN_TEST(three_frames_in_a_row_follow_each_other_over_the_counters_end);
    RUN_TEST(profile_5_gives_the_headers_of_another_implementation);
    RUN_TEST(the_shortest_frames_are_their_headers);
    RUN_TEST(the_counter_leaves_the_bits_beside_it);
    RUN_TEST(a_stray_frame_is_forgotten_when_the_next_one_is_right);
    RUN_TEST(the_first_stray_frame_follows_none);
    RUN_TEST(stray_frames_that_do_not_follow_each_other_make_no_reference);
    RUN_TEST(a_counter_takes_the_place_of_what_stood_there);
    RUN_TEST(frames_in_order_are_right_and_each_is_the_next_reference);
    RUN_TEST(each_gap_is_told_by_itself);
    return UNITY_END();
}
