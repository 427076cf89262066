/* Tests of slcan.c: lines become frames and replies, frames become lines. */
#include "laconic_node/slcan.h"
#include "unity.h"

#include <string.h>

static laconic_slcan slcan;
static laconic_frame frame;

void setUp(void) {
    memset(&frame, 0, sizeof frame);
    laconic_slcan_init(&slcan, 0);
}
void tearDown(void) {}

static laconic_slcan_event feed(const char *text) {
    laconic_slcan_event event = LACONIC_SLCAN_NOTHING;
    for (; *text != 0; text++) event = laconic_slcan_feed(&slcan, *text, &frame);
    return event;
}

static void answers(const char *line, const char *expected) {
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_REPLY, feed(line));
    TEST_ASSERT_EQUAL_STRING(expected, slcan.reply);
}

static void commands_are_answered(void) {
    answers("S6\r", "\r");
    answers("O\r", "\r");
    answers("O\r", "\a");
    answers("S6\r", "\a");
    answers("V\r", "V1010\r");
    answers("N\r", "NLACO\r");
    answers("F\r", "F00\r");
    answers("Q\r", "\a");
    answers("C\r", "\r");
    answers("Z1\r", "\r");
    answers("S9\r", "\a");
    answers("L\r", "\r");
    answers("t20001\r", "\a");
}

static void frames_of_every_kind_are_read(void) {
    feed("O\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t7FF3a1B2c3\r"));
    TEST_ASSERT_EQUAL_HEX32(0x7FF, frame.id);
    TEST_ASSERT_EQUAL_UINT8(3, frame.length);
    TEST_ASSERT_EQUAL_HEX8(0xB2, frame.data[1]);
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("T1FFFFFFF0\r"));
    TEST_ASSERT_TRUE(frame.extended);
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("\nr2008\r"));
    TEST_ASSERT_TRUE(frame.remote);
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("b2019000102030405060708090A0B\r"));
    TEST_ASSERT_TRUE(frame.fd && frame.bit_rate_switch);
    TEST_ASSERT_EQUAL_UINT8(12, frame.length);
}

static void lines_that_are_no_frames_are_refused(void) {
    const char *const wrong[] = {"t\r",        "t20\r",     "t8001AA\r", "t2009\r",      "t2001\r",   "t2001A\r",
                                 "t2001AAB\r", "t2001GG\r", "tXYZ0\r",   "T200000000\r", "d2009AA\r", "r20080011\r"};
    feed("O\r");
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) answers(wrong[k], "\a");
    TEST_ASSERT_EQUAL_UINT8(0, frame.length);
}

static void a_line_too_long_is_dropped_to_its_end(void) {
    feed("O\r");
    for (int k = 0; k < 1000; k++) feed("1");
    answers("\r", "\a");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t2000\r"));
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_NOTHING, feed("\r"));
}

static void at_the_wrong_bit_rate_nothing_comes_or_goes(void) {
    char line[LACONIC_SLCAN_LINE];
    laconic_slcan_init(&slcan, '6');
    feed("S5\rO\r");
    answers("t2000\r", "\a");
    TEST_ASSERT_EQUAL_size_t(0, laconic_slcan_write(&slcan, &frame, line));
    feed("C\rS6\rO\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t2000\r"));
}

static void what_is_written_reads_back_the_same(void) {
    char line[LACONIC_SLCAN_LINE + 1] = {0};
    feed("O\r");
    feed("D123456789AABBCCDDEEFF001122334455\r");
    const laconic_frame before = frame;
    line[laconic_slcan_write(&slcan, &frame, line)] = 0;
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_REPLY, feed("X\r"));
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed(line));
    TEST_ASSERT_EQUAL_MEMORY(before.data, frame.data, before.length);
    TEST_ASSERT_EQUAL_HEX32(before.id, frame.id);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(commands_are_answered);
    RUN_TEST(frames_of_every_kind_are_read);
    RUN_TEST(lines_that_are_no_frames_are_refused);
    RUN_TEST(a_line_too_long_is_dropped_to_its_end);
    RUN_TEST(at_the_wrong_bit_rate_nothing_comes_or_goes);
    RUN_TEST(what_is_written_reads_back_the_same);
    return UNITY_END();
}
