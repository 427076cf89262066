/* Tests of ls_bus.c: each operation byte by byte as FMI-LS-BUS 1.0 lays it out, read back, and everything wrong. */
#include "ls_bus.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

static ls_bus_buffer buffer;
static ls_bus_operation operation;

void setUp(void) { memset(&buffer, 0, sizeof buffer); }
void tearDown(void) {}

static ls_bus_reading read_at(size_t *at) { return ls_bus_read(buffer.bytes, buffer.size, at, &operation); }

static ls_bus_reading read_first(void) {
    size_t at = 0;
    return read_at(&at);
}

static void takes(const uint8_t *bytes, size_t size) {
    memcpy(buffer.bytes, bytes, size);
    buffer.size = size;
}

#define BYTES(...) \
    do { \
        const uint8_t expected[] = {__VA_ARGS__}; \
        TEST_ASSERT_EQUAL_size_t(sizeof expected, buffer.size); \
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, buffer.bytes, sizeof expected); \
    } while (0)
#define TAKES(...) \
    do { \
        const uint8_t given[] = {__VA_ARGS__}; \
        takes(given, sizeof given); \
    } while (0)
#define WRONG(...) \
    TAKES(__VA_ARGS__); \
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_first())
#define RIGHT(...) \
    TAKES(__VA_ARGS__); \
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_first())

static void numbers_are_those_of_the_standard(void) {
    static const int ours[] = {
        LS_BUS_FORMAT_ERROR,     LS_BUS_CAN_TRANSMIT, LS_BUS_CAN_FD_TRANSMIT, LS_BUS_CAN_XL_TRANSMIT, LS_BUS_CONFIRM,
        LS_BUS_ARBITRATION_LOST, LS_BUS_BUS_ERROR,    LS_BUS_CONFIGURATION,   LS_BUS_STATUS,          LS_BUS_WAKEUP};
    static const int codes[] = {0x01, 0x10, 0x11, 0x12, 0x20, 0x30, 0x31, 0x40, 0x41, 0x42};
    TEST_ASSERT_EQUAL_INT_ARRAY(codes, ours, sizeof codes / sizeof codes[0]);
    TEST_ASSERT_TRUE(LS_BUS_CAN_BAUDRATE == 1 && LS_BUS_CAN_FD_BAUDRATE == 2 && LS_BUS_CAN_XL_BAUDRATE == 3);
    TEST_ASSERT_TRUE(LS_BUS_ARBITRATION_LOST_BEHAVIOR == 4);
    TEST_ASSERT_TRUE(LS_BUS_BUFFER_AND_RETRANSMIT == 1 && LS_BUS_DISCARD_AND_NOTIFY == 2);
    TEST_ASSERT_TRUE(LS_BUS_ERROR_ACTIVE == 1 && LS_BUS_ERROR_PASSIVE == 2 && LS_BUS_BUS_OFF == 3);
    TEST_ASSERT_TRUE(LS_BUS_CRC_ERROR == 4 && LS_BUS_LAST_ERROR == 6);
    TEST_ASSERT_TRUE(LS_BUS_PRIMARY_ERROR_FLAG == 1 && LS_BUS_SECONDARY_ERROR_FLAG == 2);
}

/* 32,768 bytes are what the descriptions declare as maxSize. */
static void the_largest_operation_is_a_whole_frame_of_can_fd(void) {
    const laconic_frame frame = {.id = 1, .length = 64, .fd = true};
    TEST_ASSERT_TRUE(ls_bus_put_frame(&buffer, &frame, false));
    TEST_ASSERT_EQUAL_size_t(LS_BUS_LARGEST_OPERATION, buffer.size);
    TEST_ASSERT_TRUE(LS_BUS_BUFFER_BYTES == 32768 && sizeof buffer.bytes == 32768);
}

static void a_classic_frame_has_its_bytes(void) {
    const laconic_frame plain = {.id = 0x123, .length = 2, .data = {0xAB, 0xCD}};
    TEST_ASSERT_TRUE(ls_bus_put_frame(&buffer, &plain, true));
    BYTES(0x10, 0, 0, 0, 18, 0, 0, 0, 0x23, 0x01, 0, 0, 0, 0, 2, 0, 0xAB, 0xCD);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_first());
    TEST_ASSERT_EQUAL_MEMORY(&plain, &operation.frame, sizeof plain);
    TEST_ASSERT_TRUE(operation.id == 0x123 && operation.size == 18 && operation.bytes == buffer.bytes);
    TEST_ASSERT_FALSE(operation.error_passive); /* a classic frame does not say it */
    const laconic_frame remote = {.id = 0x1ABCDEF0, .extended = true, .remote = true};
    setUp();
    TEST_ASSERT_TRUE(ls_bus_put_frame(&buffer, &remote, false));
    BYTES(0x10, 0, 0, 0, 16, 0, 0, 0, 0xF0, 0xDE, 0xBC, 0x1A, 1, 1, 0, 0);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_first());
    TEST_ASSERT_EQUAL_MEMORY(&remote, &operation.frame, sizeof remote);
}

static void a_frame_of_can_fd_has_its_bytes(void) {
    const laconic_frame frame = {.id = 1, .length = 1, .fd = true, .bit_rate_switch = true, .data = {7}};
    TEST_ASSERT_TRUE(ls_bus_put_frame(&buffer, &frame, true));
    BYTES(0x11, 0, 0, 0, 18, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 0, 7);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_first());
    TEST_ASSERT_EQUAL_MEMORY(&frame, &operation.frame, sizeof frame);
    TEST_ASSERT_TRUE(operation.error_passive);
    setUp();
    TEST_ASSERT_TRUE(ls_bus_put_frame(&buffer, &frame, false));
    TEST_ASSERT_EQUAL_HEX8(0, buffer.bytes[14]);
    TEST_ASSERT_TRUE(read_first() == LS_BUS_RIGHT && !operation.error_passive);
}

/* Nobody here reads what such a frame carries, but its length, of two bytes, must be right. */
static void a_frame_of_can_xl_is_as_long_as_it_says(void) {
    uint8_t bytes[22 + 260] = {0x12, 0, 0, 0, 26, 1};
    for (unsigned length = 259; length <= 261; length++) {
        bytes[20] = (uint8_t)(length & 255U);
        bytes[21] = (uint8_t)(length >> 8);
        takes(bytes, sizeof bytes);
        TEST_ASSERT_EQUAL(length == 260 ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
    }
}

static void the_other_operations_have_their_bytes(void) {
    TEST_ASSERT_TRUE(ls_bus_put_id(&buffer, LS_BUS_CONFIRM, 0x01020304));
    TEST_ASSERT_TRUE(ls_bus_put_error(&buffer, 0x15000005, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true));
    TEST_ASSERT_TRUE(ls_bus_put_configuration(&buffer, LS_BUS_CAN_BAUDRATE, 500000));
    TEST_ASSERT_TRUE(ls_bus_put_configuration(&buffer, LS_BUS_ARBITRATION_LOST_BEHAVIOR, LS_BUS_DISCARD_AND_NOTIFY));
    TEST_ASSERT_TRUE(ls_bus_put_status(&buffer, LS_BUS_BUS_OFF));
    TEST_ASSERT_TRUE(ls_bus_put_format_error(&buffer, (const uint8_t *)"abc", 3));
    BYTES(0x20, 0, 0, 0, 12, 0, 0, 0, 4, 3, 2, 1,             /* confirm */
          0x31, 0, 0, 0, 15, 0, 0, 0, 5, 0, 0, 0x15, 4, 2, 1, /* bus error */
          0x40, 0, 0, 0, 13, 0, 0, 0, 1, 0x20, 0xA1, 7, 0,    /* bit rate */
          0x40, 0, 0, 0, 10, 0, 0, 0, 4, 2,                   /* behaviour */
          0x41, 0, 0, 0, 9, 0, 0, 0, 3,                       /* status */
          0x01, 0, 0, 0, 13, 0, 0, 0, 3, 0, 'a', 'b', 'c');
    size_t at = 0;
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == LS_BUS_CONFIRM && operation.id == 0x01020304 && at == 12);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.id == 0x15000005 && operation.error == 4 && operation.flag == 2 && operation.is_sender);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.parameter == LS_BUS_CAN_BAUDRATE && operation.value == 500000);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.parameter == 4 && operation.value == 2);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_EQUAL(LS_BUS_BUS_OFF, operation.status);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == LS_BUS_FORMAT_ERROR && operation.size == 13 && at == buffer.size);
    TEST_ASSERT_EQUAL(LS_BUS_END, read_at(&at));
}

static void an_operation_without_room_is_not_begun(void) {
    const laconic_frame frame = {.id = 1, .length = 8};
    const uint8_t some[4] = {0};
    const struct {
        size_t size;
        bool done;
    } rooms[] = {{24, 0}, {12, 0}, {15, 0}, {13, 0}, {9, 0}, {14, 0}};
    for (size_t k = 0; k < 6; k++)
        for (size_t less = 0; less < 2; less++) {
            buffer.size = LS_BUS_BUFFER_BYTES - rooms[k].size + less;
            const size_t before = buffer.size;
            const bool done = k == 0   ? ls_bus_put_frame(&buffer, &frame, false)
                              : k == 1 ? ls_bus_put_id(&buffer, LS_BUS_CONFIRM, 1)
                              : k == 2 ? ls_bus_put_error(&buffer, 1, LS_BUS_CRC_ERROR, LS_BUS_PRIMARY_ERROR_FLAG, 1)
                              : k == 3 ? ls_bus_put_configuration(&buffer, LS_BUS_CAN_FD_BAUDRATE, 1)
                              : k == 4 ? ls_bus_put_status(&buffer, LS_BUS_ERROR_PASSIVE)
                                       : ls_bus_put_format_error(&buffer, some, 4);
            TEST_ASSERT_EQUAL(less == 0, done);
            TEST_ASSERT_EQUAL_size_t(done ? LS_BUS_BUFFER_BYTES : before, buffer.size);
        }
    TEST_ASSERT_TRUE(ls_bus_has_room(&buffer, LS_BUS_BUFFER_BYTES - buffer.size));
    TEST_ASSERT_FALSE(ls_bus_has_room(&buffer, LS_BUS_BUFFER_BYTES - buffer.size + 1));
}

/* Whatever the memory held before: each operation is whole, and ends where it says. */
static void nothing_behind_an_operation_is_written(void) {
    const laconic_frame classic = {.id = 1}, fd = {.id = 1, .fd = true};
    for (int k = 0; k < 8; k++) {
        setUp();
        memset(buffer.bytes, 0xEE, sizeof buffer.bytes);
        const bool done = k == 0   ? ls_bus_put_frame(&buffer, &classic, false)
                          : k == 1 ? ls_bus_put_frame(&buffer, &fd, false)
                          : k == 2 ? ls_bus_put_id(&buffer, LS_BUS_CONFIRM, 1)
                          : k == 3 ? ls_bus_put_error(&buffer, 1, LS_BUS_CRC_ERROR, LS_BUS_PRIMARY_ERROR_FLAG, true)
                          : k == 4 ? ls_bus_put_configuration(&buffer, LS_BUS_CAN_BAUDRATE, 1)
                          : k == 5 ? ls_bus_put_configuration(&buffer, LS_BUS_ARBITRATION_LOST_BEHAVIOR, 1)
                          : k == 6 ? ls_bus_put_status(&buffer, LS_BUS_BUS_OFF)
                                   : ls_bus_put_format_error(&buffer, buffer.bytes, 0);
        TEST_ASSERT_TRUE(done && read_first() == LS_BUS_RIGHT && operation.size == buffer.size);
        for (size_t i = buffer.size; i < 100; i++) TEST_ASSERT_EQUAL_HEX8(0xEE, buffer.bytes[i]);
    }
}

static void what_is_sent_goes_from_the_front(void) {
    TAKES(1, 2, 3, 4, 5);
    ls_bus_drop(&buffer, 2);
    BYTES(3, 4, 5);
    ls_bus_drop(&buffer, 4);
    TEST_ASSERT_EQUAL_size_t(0, buffer.size);
}

/* The length is 16 bits, so of a longer operation the first bytes are told. */
static void a_format_error_tells_at_most_65535_bytes(void) {
    static uint8_t many[70000];
    TEST_ASSERT_FALSE(ls_bus_put_format_error(&buffer, many, sizeof many)); /* no buffer holds as many */
    TEST_ASSERT_EQUAL_size_t(0, buffer.size);
}

static void an_operation_whose_length_cannot_be_trusted_is_all_that_is_left(void) {
    size_t at = 0;
    TAKES(0x42, 0, 0);
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == 0 && operation.size == 3 && at == 3);
    at = 0;
    TAKES(0x42, 0, 0, 0);
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == 0x42 && operation.size == 4 && at == 4);
    at = 0;
    TAKES(0x42, 0, 0, 0, 8, 0, 0);
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == 0x42 && operation.size == 7 && at == 7);
    at = 0;
    TAKES(0x42, 0, 0, 0, 7, 0, 0, 0, 9);
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.size == 9 && at == 9);
    at = 0;
    TAKES(0x42, 0, 0, 0, 10, 0, 0, 0, 9);
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.size == 9 && at == 9);
    at = 0;
    TAKES(0x42, 0, 0, 0, 9, 0, 0, 0, 9, 0x42, 0, 0, 0, 8, 0, 0, 0); /* a wrong wake-up, and a right one */
    TEST_ASSERT_EQUAL(LS_BUS_WRONG, read_at(&at));
    TEST_ASSERT_TRUE(operation.size == 9 && at == 9);
    TEST_ASSERT_EQUAL(LS_BUS_RIGHT, read_at(&at));
    TEST_ASSERT_TRUE(operation.code == LS_BUS_WAKEUP && operation.size == 8);
    WRONG(0x43, 0, 0, 0, 8, 0, 0, 0);
    WRONG(0x42, 1, 0, 0, 8, 0, 0, 0);
    WRONG(0x42, 0, 0, 1, 8, 0, 0, 0); /* all four bytes of code and length count */
    WRONG(0x42, 0, 0, 0, 8, 0, 0, 1);
}

#define CLASSIC(id0, id1, id2, id3, ide, rtr, length, ...) \
    0x10, 0, 0, 0, sizeof((uint8_t[]){__VA_ARGS__}) + 16, 0, 0, 0, id0, id1, id2, id3, ide, rtr, length, 0, __VA_ARGS__

static void arguments_of_frames_are_checked(void) {
    RIGHT(CLASSIC(0xFF, 7, 0, 0, 0, 0, 1, 9));
    WRONG(CLASSIC(0, 8, 0, 0, 0, 0, 1, 9)); /* more than 11 bits */
    RIGHT(CLASSIC(0xFF, 0xFF, 0xFF, 0x1F, 1, 0, 1, 9));
    WRONG(CLASSIC(0, 0, 0, 0x20, 1, 0, 1, 9)); /* more than 29 */
    WRONG(CLASSIC(1, 0, 0, 0, 2, 0, 1, 9));
    WRONG(CLASSIC(1, 0, 0, 0, 0, 2, 1, 9));
    RIGHT(CLASSIC(1, 0, 0, 0, 0, 0, 8, 1, 2, 3, 4, 5, 6, 7, 8));
    WRONG(CLASSIC(1, 0, 0, 0, 0, 0, 9, 1, 2, 3, 4, 5, 6, 7, 8, 9));
    WRONG(CLASSIC(1, 0, 0, 0, 0, 0, 2, 9)); /* the length is another */
    WRONG(0x10, 0, 0, 0, 17, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 9);
    WRONG(0x10, 0, 0, 0, 15, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0);
    RIGHT(0x10, 0, 0, 0, 16, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0);
    WRONG(0x11, 0, 0, 0, 16, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0);
    RIGHT(0x11, 0, 0, 0, 17, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0);
    TEST_ASSERT_TRUE(operation.frame.fd && operation.frame.extended && !operation.frame.bit_rate_switch);
    WRONG(0x11, 0, 0, 0, 17, 0, 0, 0, 1, 0, 0, 0, 0, 0, 2, 0, 0); /* ESI */
    WRONG(0x11, 0, 0, 0, 17, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0);
}

static void frames_of_can_fd_have_the_lengths_of_can_fd(void) {
    static const uint8_t lengths[] = {0, 1, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    size_t next = 0;
    for (unsigned length = 0; length < 80; length++) {
        uint8_t bytes[17 + 80] = {0x11, 0, 0, 0, (uint8_t)(17 + length), 0, 0, 0, 1};
        bytes[15] = (uint8_t)length;
        takes(bytes, 17 + length);
        const bool is_one = length < 8 || length == lengths[next];
        TEST_ASSERT_EQUAL(is_one ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
        if (length == lengths[next] && next + 1 < sizeof lengths) next++;
    }
    TEST_ASSERT_EQUAL_size_t(sizeof lengths - 1, next);
}

static void arguments_of_notifications_are_checked(void) {
    WRONG(0x20, 0, 0, 0, 11, 0, 0, 0, 1, 2, 3);
    WRONG(0x20, 0, 0, 0, 13, 0, 0, 0, 1, 2, 3, 4, 5);
    RIGHT(0x30, 0, 0, 0, 12, 0, 0, 0, 1, 2, 3, 4);
    TEST_ASSERT_EQUAL_HEX32(0x04030201, operation.id);
    for (uint8_t error = 0; error < 9; error++)
        for (uint8_t flag = 0; flag < 4; flag++)
            for (uint8_t sender = 0; sender < 3; sender++) {
                TAKES(0x31, 0, 0, 0, 15, 0, 0, 0, 1, 0, 0, 0, error, flag, sender);
                const bool right = error >= 1 && error <= 6 && flag >= 1 && flag <= 2 && sender <= 1;
                TEST_ASSERT_EQUAL(right ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
                if (right) TEST_ASSERT_EQUAL(sender, operation.is_sender);
            }
    WRONG(0x31, 0, 0, 0, 14, 0, 0, 0, 1, 0, 0, 0, 1, 1);
    WRONG(0x31, 0, 0, 0, 16, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0);
}

static void arguments_of_settings_are_checked(void) {
    for (uint8_t parameter = 0; parameter < 6; parameter++) {
        TAKES(0x40, 0, 0, 0, 13, 0, 0, 0, parameter, 1, 0, 0, 0);
        TEST_ASSERT_EQUAL(parameter >= 1 && parameter <= 3 ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
        TAKES(0x40, 0, 0, 0, 10, 0, 0, 0, 4, parameter);
        TEST_ASSERT_EQUAL(parameter == 1 || parameter == 2 ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
        TAKES(0x41, 0, 0, 0, 9, 0, 0, 0, parameter);
        TEST_ASSERT_EQUAL(parameter >= 1 && parameter <= 3 ? LS_BUS_RIGHT : LS_BUS_WRONG, read_first());
    }
    WRONG(0x40, 0, 0, 0, 9, 0, 0, 0, 4);
    WRONG(0x40, 0, 0, 0, 12, 0, 0, 0, 1, 1, 0, 0);
    WRONG(0x41, 0, 0, 0, 8, 0, 0, 0);
    WRONG(0x41, 0, 0, 0, 10, 0, 0, 0, 1, 1);
}

static void lengths_within_format_errors_and_can_xl_fit(void) {
    RIGHT(0x01, 0, 0, 0, 12, 0, 0, 0, 2, 0, 1, 1);
    WRONG(0x01, 0, 0, 0, 12, 0, 0, 0, 1, 0, 1, 1);
    static uint8_t many[300];
    TEST_ASSERT_TRUE(ls_bus_put_format_error((setUp(), &buffer), many, sizeof many));
    TEST_ASSERT_TRUE(read_first() == LS_BUS_RIGHT && operation.size == 310);
    WRONG(0x01, 0, 0, 0, 9, 0, 0, 0, 0);
    RIGHT(0x01, 0, 0, 0, 10, 0, 0, 0, 0, 0);
    RIGHT(0x12, 0, 0, 0, 23, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 9);
    WRONG(0x12, 0, 0, 0, 23, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 9);
    RIGHT(0x12, 0, 0, 0, 22, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    WRONG(0x12, 0, 0, 0, 21, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
}

/* In memory of just their size, so that sanitizers see every byte behind it. */
static void operations_are_read_no_further_than_they_reach(void) {
    static const uint8_t codes[] = {0x01, 0x10, 0x11, 0x12, 0x20, 0x30, 0x31, 0x40, 0x41, 0x42};
    for (size_t size = 1; size <= 40; size++)
        for (size_t k = 0; k < sizeof codes; k++) {
            uint8_t *bytes = calloc(1, size);
            size_t at = 0;
            if (size > 0) bytes[0] = codes[k];
            if (size > 4) bytes[4] = (uint8_t)size;
            const ls_bus_reading reading = ls_bus_read(bytes, size, &at, &operation);
            TEST_ASSERT_TRUE(reading != LS_BUS_END && at == size && operation.size == size);
            free(bytes);
        }
}

static void a_full_buffer_loses_what_is_dropped(void) {
    buffer.size = LS_BUS_BUFFER_BYTES;
    for (size_t k = 0; k < LS_BUS_BUFFER_BYTES; k++) buffer.bytes[k] = (uint8_t)(k % 251);
    ls_bus_buffer *copy = malloc(sizeof *copy);
    *copy = buffer;
    ls_bus_drop(copy, 16);
    TEST_ASSERT_EQUAL_size_t(LS_BUS_BUFFER_BYTES - 16, copy->size);
    TEST_ASSERT_EQUAL_MEMORY(buffer.bytes + 16, copy->bytes, copy->size);
    free(copy);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_are_those_of_the_standard);
    RUN_TEST(the_largest_operation_is_a_whole_frame_of_can_fd);
    RUN_TEST(a_classic_frame_has_its_bytes);
    RUN_TEST(a_frame_of_can_fd_has_its_bytes);
    RUN_TEST(a_frame_of_can_xl_is_as_long_as_it_says);
    RUN_TEST(the_other_operations_have_their_bytes);
    RUN_TEST(an_operation_without_room_is_not_begun);
    RUN_TEST(nothing_behind_an_operation_is_written);
    RUN_TEST(what_is_sent_goes_from_the_front);
    RUN_TEST(a_format_error_tells_at_most_65535_bytes);
    RUN_TEST(an_operation_whose_length_cannot_be_trusted_is_all_that_is_left);
    RUN_TEST(arguments_of_frames_are_checked);
    RUN_TEST(frames_of_can_fd_have_the_lengths_of_can_fd);
    RUN_TEST(arguments_of_notifications_are_checked);
    RUN_TEST(arguments_of_settings_are_checked);
    RUN_TEST(lengths_within_format_errors_and_can_xl_fit);
    RUN_TEST(operations_are_read_no_further_than_they_reach);
    RUN_TEST(a_full_buffer_loses_what_is_dropped);
    return UNITY_END();
}
