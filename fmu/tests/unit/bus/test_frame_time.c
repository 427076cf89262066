/* Tests of frame_time.c: bits of frames by ISO 11898-1, without stuff bits in the classic part, counted by hand. */
#include "frame_time.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define WITHIN(expected, found) TEST_ASSERT_DOUBLE_WITHIN(1e-15, expected, found)

static void classic_frames_have_47_or_67_bits_and_their_data(void) {
    laconic_frame frame = {.length = 8};
    WITHIN((47 + 64) / 5e5, frame_time_s(&frame, 500000, 1));
    frame.extended = true;
    WITHIN((67 + 64) / 5e5, frame_time_s(&frame, 500000, 1));
    frame.remote = true; /* no data, whatever its length */
    WITHIN(67 / 5e5, frame_time_s(&frame, 500000, 1));
    frame.extended = false;
    frame.length = 0;
    WITHIN(47 / 1e6, frame_time_s(&frame, 1000000, 1));
}

static void frames_of_can_fd_have_a_fast_part_where_they_switch(void) {
    laconic_frame frame = {.length = 16, .fd = true};
    WITHIN((17 + 13 + 5 + 128 + 27) / 5e5, frame_time_s(&frame, 500000, 2000000));
    frame.bit_rate_switch = true;
    WITHIN((17 + 13) / 5e5 + (5 + 128 + 27) / 2e6, frame_time_s(&frame, 500000, 2000000));
    frame.length = 20; /* the longer CRC */
    WITHIN((17 + 13) / 5e5 + (5 + 160 + 32) / 2e6, frame_time_s(&frame, 500000, 2000000));
    frame.extended = true;
    WITHIN((17 + 19 + 13) / 5e5 + (5 + 160 + 32) / 2e6, frame_time_s(&frame, 500000, 2000000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(classic_frames_have_47_or_67_bits_and_their_data);
    RUN_TEST(frames_of_can_fd_have_a_fast_part_where_they_switch);
    return UNITY_END();
}
