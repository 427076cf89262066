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
    for (; *text != 0; text++) {
        event = laconic_slcan_feed(&slcan, *text, &frame);
        if (*text != '\r') TEST_ASSERT_EQUAL(LACONIC_SLCAN_NOTHING, event); /* a line ends nowhere else */
    }
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
    const char *const wrong[] = {"t\r",       "t20\r",       "t8001AA\r", "t2009\r", "t2001\r",
                                 "t2001A\r",  "t2001AAB\r",  "t2001GG\r", "tXYZ0\r", "T200000000\r",
                                 "d2009AA\r", "r20080011\r", "t200G\r",   "tXYZG\r"};
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
    feed("C\r");
    TEST_ASSERT_EQUAL_size_t(0, laconic_slcan_write(&slcan, &frame, line));
    feed("L\r");
    answers("t2000\r", "\a");
    feed("C\rS6\rO\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t2000\r"));
}

static void a_remote_frame_without_bytes_is_written_without_bytes(void) {
    char line[LACONIC_SLCAN_LINE + 1] = {0};
    frame.id = 0x123;
    frame.remote = true;
    feed("O\r");
    TEST_ASSERT_EQUAL_size_t(6, laconic_slcan_write(&slcan, &frame, line));
    TEST_ASSERT_EQUAL_STRING("r1230\r", line);
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

static const char digits[] = "0123456789ABCDEF";

/* Each DLC with the length that CAN FD gives it, and so many bytes. */
static void every_length_of_can_fd_is_read_and_written(void) {
    static const uint8_t lengths[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    feed("O\r");
    for (size_t dlc = 0; dlc < 16; dlc++) {
        char line[LACONIC_SLCAN_LINE + 1] = "d123", back[LACONIC_SLCAN_LINE + 1] = {0};
        size_t end = 4;
        line[end++] = digits[dlc];
        for (size_t k = 0; k < 2U * lengths[dlc]; k++) line[end++] = digits[(7U * k + dlc) % 16U];
        line[end] = '\r';
        TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed(line));
        TEST_ASSERT_EQUAL_UINT8(lengths[dlc], frame.length);
        TEST_ASSERT_TRUE(frame.fd && !frame.bit_rate_switch && !frame.extended && !frame.remote);
        TEST_ASSERT_EQUAL_size_t(end + 1, laconic_slcan_write(&slcan, &frame, back));
        TEST_ASSERT_EQUAL_STRING(line, back);
    }
}

static void lines_of_every_kind_are_written_as_they_were_read(void) {
    static const char *const lines[] = {"t7FF3A1B2C3\r", "T1FFFFFFF10F\r",   "r2008\r", "R000002008\r",
                                        "b20119A\r",     "B1ABCDEF028899\r", "d0000\r", "t00080123456789ABCDEF\r"};
    feed("O\r");
    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        char back[LACONIC_SLCAN_LINE + 1] = {0};
        TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed(lines[k]));
        TEST_ASSERT_TRUE(frame.bit_rate_switch == (lines[k][0] == 'b' || lines[k][0] == 'B'));
        back[laconic_slcan_write(&slcan, &frame, back)] = 0;
        TEST_ASSERT_EQUAL_STRING(lines[k], back);
    }
}

static void every_digit_is_one_and_its_neighbours_are_none(void) {
    feed("O\r");
    static const char none[] = {'0' - 1, '9' + 1, 'A' - 1, 'F' + 1, 'a' - 1, 'f' + 1};
    for (size_t k = 0; k < sizeof none; k++) {
        char line[] = "t2001 0\r";
        line[5] = none[k];
        answers(line, "\a");
    }
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t20080123456789abcdef\r"));
    TEST_ASSERT_EQUAL_HEX8(0x01, frame.data[0]);
    TEST_ASSERT_EQUAL_HEX8(0x89, frame.data[4]);
    TEST_ASSERT_EQUAL_HEX8(0xAB, frame.data[5]);
    TEST_ASSERT_EQUAL_HEX8(0xEF, frame.data[7]);
}

static void the_largest_identifiers_are_taken_and_the_next_are_none(void) {
    feed("O\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("T1FFFFFFF0\r"));
    TEST_ASSERT_EQUAL_HEX32(0x1FFFFFFFU, frame.id);
    answers("T200000000\r", "\a");
    answers("t8000\r", "\a");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("r2000\r"));
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t20081122334455667788\r"));
    answers("t2009112233445566778899\r", "\a");
    answers("t\r", "\a");
    answers("t200\r", "\a");
}

static void a_rate_is_one_digit_from_0_to_8(void) {
    answers("S0\r", "\r");
    answers("S8\r", "\r");
    answers("S/\r", "\a");
    answers("S\r", "\a");
    answers("S66\r", "\a");
    feed("O\r");
    answers("S6\r", "\a");
    answers("s031C\r", "\a");
    answers("Y5\r", "\a");
    answers("Z1\r", "\a");
    answers("v\r", "V1010\r");
    feed("C\r");
    answers("s031C\r", "\r");
    answers("Y5\r", "\r");
}

static void who_only_listens_sends_no_frames_and_hears_them(void) {
    char line[LACONIC_SLCAN_LINE + 1] = {0};
    answers("L\r", "\r");
    answers("t2000\r", "\a");
    frame.id = 0x200;
    TEST_ASSERT_EQUAL_size_t(6, laconic_slcan_write(&slcan, &frame, line));
    TEST_ASSERT_EQUAL_STRING("t2000\r", line);
    answers("C\r", "\r");
    TEST_ASSERT_EQUAL_size_t(0, laconic_slcan_write(&slcan, &frame, line));
    answers("t2000\r", "\a");
}

static void who_closes_and_opens_for_all_sends_frames_again(void) {
    answers("L\r", "\r");
    answers("C\r", "\r");
    answers("O\r", "\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t1230\r"));
    TEST_ASSERT_EQUAL_HEX32(0x123, frame.id);
}

static void a_channel_begins_closed_and_without_a_reply(void) {
    memset(&slcan, 0x55, sizeof slcan);
    laconic_slcan_init(&slcan, '6');
    TEST_ASSERT_TRUE(slcan.reply[0] == 0 && !slcan.open && !slcan.listen_only && !slcan.rate_is_wrong);
    answers("S6\r", "\r");
    answers("O\r", "\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t2000\r"));
}

/* The longest line is that of a frame of CAN FD with 64 bytes and 29 bits of identifier. */
static void the_longest_line_has_room_and_one_letter_more_has_none(void) {
    char line[2 + 8 + 1 + 128 + 2] = "D12345678F";
    size_t end = 10;
    feed("O\r");
    while (end < 10U + 128U) line[end++] = 'E';
    line[end] = '\r';
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed(line));
    TEST_ASSERT_EQUAL_HEX8(0xEE, frame.data[63]);
    line[end] = 'E';
    line[end + 1] = '\r';
    answers(line, "\a");
}

static void a_command_too_long_for_a_line_is_none(void) {
    feed("O");
    for (int k = 0; k < LACONIC_SLCAN_LINE; k++) feed("1");
    answers("\r", "\a");
    TEST_ASSERT_FALSE(slcan.open);
}

/* Nor does what is too much go anywhere else. */
static void a_line_too_long_changes_nothing_behind_it(void) {
    feed("O\rV\r");
    const laconic_slcan before = slcan;
    for (int k = 0; k < LACONIC_SLCAN_LINE + 20; k++) feed("1");
    TEST_ASSERT_EQUAL_UINT16(LACONIC_SLCAN_LINE, slcan.length);
    TEST_ASSERT_EQUAL_STRING(before.reply, slcan.reply);
    TEST_ASSERT_TRUE(slcan.open && !slcan.listen_only && !slcan.rate_is_wrong && slcan.required_rate == 0);
}

static void a_classic_frame_has_eight_bytes_at_most_whatever_its_line_holds(void) {
    feed("O\r");
    answers("t2009112233445566778899AABBCC\r", "\a");
    answers("t8009112233445566778899AABBCC\r", "\a"); /* and its identifier is too large */
}

static void any_rate_is_right_where_none_is_required(void) {
    for (char rate = '0'; rate <= '8'; rate++) {
        const char line[] = {'S', rate, '\r', 0};
        answers(line, "\r");
        TEST_ASSERT_FALSE(slcan.rate_is_wrong);
    }
    laconic_slcan_init(&slcan, '6');
    answers("S5\r", "\r");
    TEST_ASSERT_TRUE(slcan.rate_is_wrong);
    answers("S6\r", "\r");
    TEST_ASSERT_FALSE(slcan.rate_is_wrong);
}

/* Letters beside those of frames begin no frame. */
static void only_the_letters_of_frames_begin_one(void) {
    feed("O\r");
    answers("a2000\r", "\a");
    answers("c2000\r", "\a");
    answers("12000\r", "\a");
}

static void a_rate_is_not_that_of_the_line_before(void) {
    answers("S6\r", "\r");
    answers("S\r", "\a");
}

static void a_higher_rate_is_as_wrong_as_a_lower_one(void) {
    laconic_slcan_init(&slcan, '6');
    answers("S7\r", "\r");
    TEST_ASSERT_TRUE(slcan.rate_is_wrong);
}

static void a_closed_channel_takes_no_frames(void) {
    answers("t2000\r", "\a");
    feed("O\rC\r");
    answers("t2000\r", "\a");
}

/* Terminals send CR LF; a tab is a letter that no line has. */
static void a_line_ends_with_cr_alone(void) {
    feed("O\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed("t20\n00\r"));
    answers("t20\t00\r", "\a");
}

static void a_line_is_written_whatever_stood_there(void) {
    static const char expected[] = "t12331AB2C3\r";
    char text[LACONIC_SLCAN_LINE];
    memset(text, 0x5A, sizeof text);
    feed("O\r");
    TEST_ASSERT_EQUAL(LACONIC_SLCAN_FRAME, feed(expected));
    TEST_ASSERT_EQUAL_size_t(sizeof expected - 1, laconic_slcan_write(&slcan, &frame, text));
    TEST_ASSERT_EQUAL_MEMORY(expected, text, sizeof expected - 1);
}

/* Neither kind of CAN has frames of other lengths; above 64 bytes a line would leave its room. */
static void only_lengths_that_a_frame_can_have_are_written(void) {
    static const char lengths_of_fd[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    char text[LACONIC_SLCAN_LINE];
    feed("O\r");
    for (unsigned length = 0; length < 256; length++) {
        const bool of_fd = length <= 64 && memchr(lengths_of_fd, (char)length, sizeof lengths_of_fd) != NULL;
        laconic_frame it = {.id = 0x123, .length = (uint8_t)length};
        TEST_ASSERT_EQUAL(length <= 8, laconic_slcan_write(&slcan, &it, text) > 0);
        it.fd = true;
        TEST_ASSERT_EQUAL(of_fd, laconic_slcan_write(&slcan, &it, text) > 0);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(commands_are_answered);
    RUN_TEST(frames_of_every_kind_are_read);
    RUN_TEST(lines_that_are_no_frames_are_refused);
    RUN_TEST(a_line_too_long_is_dropped_to_its_end);
    RUN_TEST(at_the_wrong_bit_rate_nothing_comes_or_goes);
    RUN_TEST(what_is_written_reads_back_the_same);
    RUN_TEST(every_length_of_can_fd_is_read_and_written);
    RUN_TEST(lines_of_every_kind_are_written_as_they_were_read);
    RUN_TEST(every_digit_is_one_and_its_neighbours_are_none);
    RUN_TEST(the_largest_identifiers_are_taken_and_the_next_are_none);
    RUN_TEST(a_rate_is_one_digit_from_0_to_8);
    RUN_TEST(who_only_listens_sends_no_frames_and_hears_them);
    RUN_TEST(who_closes_and_opens_for_all_sends_frames_again);
    RUN_TEST(a_channel_begins_closed_and_without_a_reply);
    RUN_TEST(the_longest_line_has_room_and_one_letter_more_has_none);
    RUN_TEST(a_command_too_long_for_a_line_is_none);
    RUN_TEST(a_line_too_long_changes_nothing_behind_it);
    RUN_TEST(a_classic_frame_has_eight_bytes_at_most_whatever_its_line_holds);
    RUN_TEST(any_rate_is_right_where_none_is_required);
    RUN_TEST(only_the_letters_of_frames_begin_one);
    RUN_TEST(a_rate_is_not_that_of_the_line_before);
    RUN_TEST(a_higher_rate_is_as_wrong_as_a_lower_one);
    RUN_TEST(a_closed_channel_takes_no_frames);
    RUN_TEST(a_line_ends_with_cr_alone);
    RUN_TEST(a_remote_frame_without_bytes_is_written_without_bytes);
    RUN_TEST(a_line_is_written_whatever_stood_there);
    RUN_TEST(only_lengths_that_a_frame_can_have_are_written);
    return UNITY_END();
}
