/* Tests of can_controller.c: with and without bus notifications, what is sent again, error counters and bus-off. */
#include "can_controller.h"
#include "unity.h"

#include <string.h>

static can_controller can;
static ls_bus_buffer tx;

void setUp(void) {
    memset(&can, 0, sizeof can);
    memset(&tx, 0, sizeof tx);
    can.bit_rate_bit_per_s = 500000;
}
void tearDown(void) {}

static void start(bool notified) {
    can.notified = notified;
    can_controller_start(&can, &tx);
    tx.size = 0;
}

static const laconic_frame frame = {.id = 0x77, .length = 1, .data = {5}};

/* The next operation that the controller has sent, taken off; its code, 0: none. */
static ls_bus_operation told;
static uint32_t next(void) {
    size_t at = 0;
    static ls_bus_buffer seen;
    seen = tx;
    if (ls_bus_read(seen.bytes, seen.size, &at, &told) == LS_BUS_END) return 0;
    ls_bus_drop(&tx, at);
    return told.code;
}

static bool hear(uint32_t code, uint32_t id, uint64_t now_us) {
    const ls_bus_operation operation = {.code = code, .id = id};
    return can_controller_hear(&can, &tx, LS_BUS_RIGHT, &operation, now_us);
}

static void hear_error(uint32_t id, bool is_sender, uint8_t flag, uint64_t now_us) {
    const ls_bus_operation operation = {.code = LS_BUS_BUS_ERROR, .id = id, .flag = flag, .is_sender = is_sender};
    TEST_ASSERT_FALSE(can_controller_hear(&can, &tx, LS_BUS_RIGHT, &operation, now_us));
}

static bool hear_frame(bool fd) {
    const ls_bus_operation operation = {.code = fd ? LS_BUS_CAN_FD_TRANSMIT : LS_BUS_CAN_TRANSMIT, .frame = {.fd = fd}};
    return can_controller_hear(&can, &tx, LS_BUS_RIGHT, &operation, 0);
}

static void it_begins_with_its_bit_rates_and_what_the_bus_does_with_lost_frames(void) {
    can_controller_start(&can, &tx);
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_TRUE(told.parameter == LS_BUS_CAN_BAUDRATE && told.value == 500000);
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_TRUE(told.parameter == LS_BUS_ARBITRATION_LOST_BEHAVIOR && told.value == LS_BUS_BUFFER_AND_RETRANSMIT);
    TEST_ASSERT_EQUAL(0, next());
    for (int k = 0; k < 4; k++) {
        can.fd_bit_rate_bit_per_s = 2000000;
        can.notified = k & 1;
        can.discards = k & 2;
        can_controller_start(&can, &tx);
        TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
        TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
        TEST_ASSERT_TRUE(told.parameter == LS_BUS_CAN_FD_BAUDRATE && told.value == 2000000);
        TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
        TEST_ASSERT_EQUAL(k == 3 ? LS_BUS_DISCARD_AND_NOTIFY : LS_BUS_BUFFER_AND_RETRANSMIT, (int)told.value);
    }
}

static void without_notifications_every_frame_is_sent(void) {
    start(false);
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_TRUE(can_controller_is_free(&can, &tx));
        can_controller_send(&can, &tx, &frame);
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
        TEST_ASSERT_TRUE(told.frame.id == 0x77 && told.frame.data[0] == 5);
    }
    TEST_ASSERT_EQUAL_INT32(3, can.sent);
    hear_error(0x77, true, 1, 0); /* the standard: then notifications are passed over */
    TEST_ASSERT_TRUE(can.transmit_errors == 0 && hear_frame(false) && can.heard == 1);
    can.receive_errors = 5;
    TEST_ASSERT_TRUE(hear_frame(false) && can.receive_errors == 5);
}

static void with_notifications_one_frame_is_on_its_way(void) {
    start(true);
    can_controller_send(&can, &tx, &frame);
    TEST_ASSERT_FALSE(can_controller_is_free(&can, &tx));
    TEST_ASSERT_FALSE(hear(LS_BUS_CONFIRM, 0x78, 0)); /* another one's */
    TEST_ASSERT_FALSE(can_controller_is_free(&can, &tx));
    TEST_ASSERT_FALSE(hear(LS_BUS_CONFIRM, 0x77, 0));
    TEST_ASSERT_TRUE(can_controller_is_free(&can, &tx));
    can.transmit_errors = 2;
    hear(LS_BUS_CONFIRM, 0x77, 0); /* nothing is on its way */
    TEST_ASSERT_EQUAL_INT32(2, can.transmit_errors);
    can_controller_send(&can, &tx, &frame);
    hear(LS_BUS_CONFIRM, 0x77, 0);
    TEST_ASSERT_EQUAL_INT32(1, can.transmit_errors);
    for (int n = 0; n < 2; n++) { /* not below 0 */
        can_controller_send(&can, &tx, &frame);
        hear(LS_BUS_CONFIRM, 0x77, 0);
        TEST_ASSERT_EQUAL_INT32(0, can.transmit_errors);
    }
    TEST_ASSERT_EQUAL_INT32(4, can.sent);
}

static void a_frame_that_lost_arbitration_is_sent_again_or_dropped(void) {
    start(true);
    can_controller_send(&can, &tx, &frame);
    next();
    hear(LS_BUS_ARBITRATION_LOST, 0x78, 0);
    TEST_ASSERT_EQUAL(0, next());
    hear(LS_BUS_ARBITRATION_LOST, 0x77, 0);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    TEST_ASSERT_TRUE(told.frame.id == 0x77 && !can_controller_is_free(&can, &tx));
    TEST_ASSERT_TRUE(can.sent == 1 && can.lost == 0 && !can.again);
    can.drops_lost = true;
    hear(LS_BUS_ARBITRATION_LOST, 0x77, 0);
    TEST_ASSERT_TRUE(can_controller_is_free(&can, &tx) && can.lost == 1);
    TEST_ASSERT_EQUAL(0, next());
    hear(LS_BUS_ARBITRATION_LOST, 0x77, 0);
    TEST_ASSERT_EQUAL_INT32(1, can.lost);
}

/* What must be sent again waits for room, and no answer to it counts until then. */
static void a_frame_waits_for_room_to_be_sent_again(void) {
    start(true);
    can_controller_send(&can, &tx, &frame);
    tx.size = LS_BUS_BUFFER_BYTES - 16;
    hear(LS_BUS_ARBITRATION_LOST, 0x77, 0);
    TEST_ASSERT_TRUE(can.again);
    hear(LS_BUS_CONFIRM, 0x77, 0);
    TEST_ASSERT_TRUE(can.waits);
    tx.size = 0;
    can_controller_tick(&can, &tx, 0);
    TEST_ASSERT_TRUE(!can.again && next() == LS_BUS_CAN_TRANSMIT);
    hear(LS_BUS_CONFIRM, 0x77, 0);
    TEST_ASSERT_FALSE(can.waits);
    can_controller_tick(&can, &tx, 0);
    TEST_ASSERT_EQUAL(0, next());
}

static void a_frame_leaves_room_for_a_status(void) {
    start(false);
    tx.size = LS_BUS_BUFFER_BYTES - LS_BUS_LARGEST_OPERATION - 64;
    TEST_ASSERT_TRUE(can_controller_is_free(&can, &tx));
    tx.size++;
    TEST_ASSERT_FALSE(can_controller_is_free(&can, &tx));
    tx.size = LS_BUS_BUFFER_BYTES - 16;
    can_controller_send(&can, &tx, &frame); /* without room it is not sent */
    TEST_ASSERT_EQUAL_INT32(0, can.sent);
}

/* 8 for each error: passive above 127, off above 255; 1 less for each confirmed frame. */
static void a_sender_s_errors_make_it_passive_and_then_take_it_off_the_bus(void) {
    start(true);
    can_controller_send(&can, &tx, &frame);
    next();
    for (int k = 1; k <= 31; k++) {
        hear_error(0x77, true, 2, 1000);
        TEST_ASSERT_EQUAL_INT32(8 * k, can.transmit_errors);
        TEST_ASSERT_EQUAL_INT32(k < 16 ? LS_BUS_ERROR_ACTIVE : LS_BUS_ERROR_PASSIVE, can.status);
        if (k == 16) TEST_ASSERT_TRUE(next() == LS_BUS_STATUS && told.status == LS_BUS_ERROR_PASSIVE);
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next()); /* again */
        TEST_ASSERT_EQUAL(0, next());
    }
    hear_error(0x77, true, 2, 1000);
    TEST_ASSERT_TRUE(can.status == LS_BUS_BUS_OFF && next() == LS_BUS_STATUS && told.status == LS_BUS_BUS_OFF);
    TEST_ASSERT_EQUAL(0, next());
    TEST_ASSERT_TRUE(can.off_until_us == 1000 + 128 * 11 * 2); /* µs at 500 kbit/s */
    TEST_ASSERT_FALSE(hear_frame(false));
    hear_error(0x77, true, 2, 2000);
    TEST_ASSERT_TRUE(can.off_until_us == 1000 + 128 * 11 * 2 && can.status == LS_BUS_BUS_OFF);
    can.waits = false;
    TEST_ASSERT_FALSE(can_controller_is_free(&can, &tx));
    can.waits = true;
    can_controller_tick(&can, &tx, can.off_until_us - 1);
    TEST_ASSERT_EQUAL(LS_BUS_BUS_OFF, can.status);
    can_controller_tick(&can, &tx, can.off_until_us);
    TEST_ASSERT_TRUE(can.status == LS_BUS_ERROR_ACTIVE && can.transmit_errors == 0 && can.receive_errors == 0);
    TEST_ASSERT_TRUE(next() == LS_BUS_STATUS && told.status == LS_BUS_ERROR_ACTIVE);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
}

/* The counter may be odd: confirmed frames take 1 off. */
static void the_limits_of_the_counters_are_127_and_255(void) {
    start(true);
    can.transmit_errors = 119;
    hear_error(1, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 127 && can.status == LS_BUS_ERROR_ACTIVE);
    can.transmit_errors = 120;
    hear_error(1, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 128 && can.status == LS_BUS_ERROR_PASSIVE);
    can.transmit_errors = 247;
    hear_error(1, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 255 && can.status == LS_BUS_ERROR_PASSIVE);
    can.transmit_errors = 248;
    hear_error(1, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 256 && can.status == LS_BUS_BUS_OFF);
}

/* However long ago it became passive. */
static void the_wait_off_the_bus_begins_when_it_goes_off(void) {
    start(true);
    for (uint64_t k = 1; k <= 31; k++) hear_error(1, true, 2, 1000 * k);
    TEST_ASSERT_EQUAL(LS_BUS_ERROR_PASSIVE, can.status);
    hear_error(1, true, 2, 50000);
    TEST_ASSERT_EQUAL(LS_BUS_BUS_OFF, can.status);
    TEST_ASSERT_TRUE(can.off_until_us == 50000 + 128 * 11 * 2);
}

static void an_error_of_another_frame_sends_nothing_again(void) {
    start(true);
    hear_error(0x77, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 8 && !can.again);
    can_controller_send(&can, &tx, &frame);
    hear_error(0x78, true, 2, 0);
    TEST_ASSERT_TRUE(can.transmit_errors == 16 && !can.again);
}

/* 8 for the first to notice, 1 for the others; 1 less for each frame, and from passive back to 119. */
static void a_receiver_s_errors_make_it_passive(void) {
    start(true);
    hear_error(1, false, LS_BUS_SECONDARY_ERROR_FLAG, 0);
    TEST_ASSERT_EQUAL_INT32(1, can.receive_errors);
    hear_error(1, false, LS_BUS_PRIMARY_ERROR_FLAG, 0);
    TEST_ASSERT_EQUAL_INT32(9, can.receive_errors);
    TEST_ASSERT_TRUE(hear_frame(false));
    TEST_ASSERT_EQUAL_INT32(8, can.receive_errors);
    can.receive_errors = 0;
    TEST_ASSERT_TRUE(hear_frame(false) && can.receive_errors == 0);
    can.receive_errors = 126;
    hear_error(1, false, LS_BUS_SECONDARY_ERROR_FLAG, 0);
    TEST_ASSERT_TRUE(can.receive_errors == 127 && can.status == LS_BUS_ERROR_ACTIVE);
    hear_error(1, false, LS_BUS_PRIMARY_ERROR_FLAG, 0);
    TEST_ASSERT_TRUE(can.receive_errors == 135 && can.status == LS_BUS_ERROR_PASSIVE);
    TEST_ASSERT_TRUE(next() == LS_BUS_STATUS && told.status == LS_BUS_ERROR_PASSIVE);
    hear_error(1, false, LS_BUS_PRIMARY_ERROR_FLAG, 0);
    TEST_ASSERT_EQUAL_INT32(135, can.receive_errors); /* passive: it counts no higher */
    TEST_ASSERT_TRUE(hear_frame(false) && can.receive_errors == 119);
    TEST_ASSERT_TRUE(next() == LS_BUS_STATUS && told.status == LS_BUS_ERROR_ACTIVE);
    can.receive_errors = 127;
    TEST_ASSERT_TRUE(hear_frame(false) && can.receive_errors == 126);
}

static void a_passive_sender_of_can_fd_says_so_in_its_frames(void) {
    const laconic_frame fd = {.id = 1, .fd = true};
    start(true);
    can.status = LS_BUS_ERROR_PASSIVE;
    can_controller_send(&can, &tx, &fd);
    TEST_ASSERT_EQUAL_HEX8(1, tx.bytes[14]);
}

static void frames_of_can_fd_are_heard_by_who_has_it(void) {
    start(false);
    TEST_ASSERT_FALSE(hear_frame(true));
    TEST_ASSERT_EQUAL_INT32(0, can.heard);
    can.fd_bit_rate_bit_per_s = 1000000;
    TEST_ASSERT_TRUE(hear_frame(true));
    TEST_ASSERT_EQUAL_INT32(1, can.heard);
}

static void wrong_operations_are_answered_but_for_wrong_answers(void) {
    const uint8_t bytes[2] = {7, 8};
    ls_bus_operation wrong = {.code = 0x99, .bytes = bytes, .size = 2};
    start(true);
    TEST_ASSERT_FALSE(can_controller_hear(&can, &tx, LS_BUS_WRONG, &wrong, 0));
    TEST_ASSERT_TRUE(can.wrong == 1 && next() == LS_BUS_FORMAT_ERROR && told.size == 12);
    wrong.code = LS_BUS_FORMAT_ERROR;
    TEST_ASSERT_FALSE(can_controller_hear(&can, &tx, LS_BUS_WRONG, &wrong, 0));
    TEST_ASSERT_TRUE(can.wrong == 2 && next() == 0);
    can.wrong = INT32_MAX;
    can_controller_hear(&can, &tx, LS_BUS_WRONG, &wrong, 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, can.wrong); /* or more */
    TEST_ASSERT_FALSE(hear(LS_BUS_WAKEUP, 0, 0));
    TEST_ASSERT_FALSE(hear(LS_BUS_STATUS, 0, 0));
    TEST_ASSERT_EQUAL(0, next());
}

/* As slow as it may be. */
static void one_bit_per_second_is_can_fd(void) {
    can.fd_bit_rate_bit_per_s = 1;
    can_controller_start(&can, &tx);
    TEST_ASSERT_TRUE(next() == LS_BUS_CONFIGURATION && next() == LS_BUS_CONFIGURATION);
    TEST_ASSERT_TRUE(told.parameter == LS_BUS_CAN_FD_BAUDRATE && told.value == 1);
    TEST_ASSERT_TRUE(hear_frame(true));
}

static void a_start_forgets_what_was(void) {
    const can_controller used = {.bit_rate_bit_per_s = 500000,
                                 .waits = true,
                                 .again = true,
                                 .transmit_errors = 1,
                                 .receive_errors = 2,
                                 .status = LS_BUS_BUS_OFF,
                                 .sent = 3,
                                 .heard = 4,
                                 .lost = 5,
                                 .wrong = 6};
    can = used;
    start(true);
    TEST_ASSERT_TRUE(!can.waits && !can.again && can.transmit_errors == 0 && can.receive_errors == 0);
    TEST_ASSERT_TRUE(can.sent == 0 && can.heard == 0 && can.lost == 0 && can.wrong == 0);
    TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, can.status);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(it_begins_with_its_bit_rates_and_what_the_bus_does_with_lost_frames);
    RUN_TEST(without_notifications_every_frame_is_sent);
    RUN_TEST(with_notifications_one_frame_is_on_its_way);
    RUN_TEST(a_frame_that_lost_arbitration_is_sent_again_or_dropped);
    RUN_TEST(a_frame_waits_for_room_to_be_sent_again);
    RUN_TEST(a_frame_leaves_room_for_a_status);
    RUN_TEST(a_sender_s_errors_make_it_passive_and_then_take_it_off_the_bus);
    RUN_TEST(the_limits_of_the_counters_are_127_and_255);
    RUN_TEST(the_wait_off_the_bus_begins_when_it_goes_off);
    RUN_TEST(an_error_of_another_frame_sends_nothing_again);
    RUN_TEST(a_receiver_s_errors_make_it_passive);
    RUN_TEST(a_passive_sender_of_can_fd_says_so_in_its_frames);
    RUN_TEST(frames_of_can_fd_are_heard_by_who_has_it);
    RUN_TEST(wrong_operations_are_answered_but_for_wrong_answers);
    RUN_TEST(one_bit_per_second_is_can_fd);
    RUN_TEST(a_start_forgets_what_was);
    return UNITY_END();
}
