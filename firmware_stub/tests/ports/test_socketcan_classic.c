/* Tests of ports/host/socketcan.c in a build without CAN FD, whose frames have room for eight bytes. */
#include "socketcan.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static void a_frame_of_can_fd_is_passed_over_and_writes_nothing(void) {
    struct {
        laconic_frame frame;
        uint8_t behind[64];
    } to;
    struct canfd_frame raw = {.can_id = 0x123, .len = 64};
    memset(raw.data, 0xEE, sizeof raw.data);
    memset(&to, 0xA5, sizeof to);
    TEST_ASSERT_FALSE(socketcan_take(&to.frame, &raw, CANFD_MTU));
    raw.len = 8;
    TEST_ASSERT_FALSE(socketcan_take(&to.frame, &raw, CANFD_MTU));
    TEST_ASSERT_TRUE(socketcan_take(&to.frame, &raw, CAN_MTU));
    TEST_ASSERT_EACH_EQUAL_HEX8(0xEE, to.frame.data, 8);
    TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, to.behind, sizeof to.behind);
}

static void a_frame_that_is_too_long_is_not_sent(void) {
    struct canfd_frame raw;
    for (unsigned length = 0; length < 256; length++) {
        const laconic_frame frame = {.id = 0x123, .length = (uint8_t)length, .fd = (length & 1U) != 0};
        TEST_ASSERT_EQUAL(length <= 8, socketcan_put(&raw, &frame) > 0);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_frame_of_can_fd_is_passed_over_and_writes_nothing);
    RUN_TEST(a_frame_that_is_too_long_is_not_sent);
    return UNITY_END();
}
