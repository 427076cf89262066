/* Tests of stream.c: numbers to bytes and back, and what is too short or out of range. */
#include "stream.h"
#include "unity.h"

#include <string.h>

static uint8_t bytes[64];

void setUp(void) { memset(bytes, 0, sizeof bytes); }
void tearDown(void) {}

static void numbers_are_little_endian_and_come_back(void) {
    fmu_stream to = {.to = bytes, .size = sizeof bytes}, from = {.from = bytes, .size = sizeof bytes}, counts = {0};
    uint64_t whole = 0x0102030405060708U;
    int32_t small = -5;
    bool flag = true;
    double real = -1.5;
    fmu_stream *const both[2] = {&to, &counts};
    memset(bytes, 0x55, sizeof bytes);
    for (int k = 0; k < 2; k++) {
        fmu_stream_u64(both[k], &whole);
        fmu_stream_i32(both[k], &small, -10, 10);
        fmu_stream_bool(both[k], &flag);
        fmu_stream_reals(both[k], &real, 1);
        TEST_ASSERT_EQUAL_size_t(32, both[k]->at);
        TEST_ASSERT_FALSE(both[k]->failed);
    }
    for (int k = 0; k < 8; k++) TEST_ASSERT_EQUAL_HEX8(8 - k, bytes[k]);
    TEST_ASSERT_EQUAL_HEX8(0x55, bytes[32]); /* what is behind them stays */
    TEST_ASSERT_EQUAL_HEX8(0xFB, bytes[8]);
    TEST_ASSERT_EQUAL_HEX8(0xFF, bytes[15]);
    whole = 0, small = 0, flag = false, real = 0;
    fmu_stream_u64(&from, &whole);
    fmu_stream_i32(&from, &small, -5, 10);
    fmu_stream_bool(&from, &flag);
    fmu_stream_reals(&from, &real, 1);
    TEST_ASSERT_TRUE(whole == 0x0102030405060708U && small == -5 && flag && real == -1.5 && !from.failed);
}

static void bytes_that_are_too_few_fail_and_are_not_touched(void) {
    fmu_stream to = {.to = bytes, .size = 7}, from = {.from = bytes, .size = 7};
    uint64_t value = 99;
    fmu_stream_u64(&to, &value);
    fmu_stream_u64(&from, &value);
    TEST_ASSERT_TRUE(to.failed && from.failed && value == 99 && to.at == 0);
    for (int k = 0; k < 8; k++) TEST_ASSERT_EQUAL_HEX8(0, bytes[k]);
    fmu_stream end = {.from = bytes, .size = 15, .at = 8};
    fmu_stream_u64(&end, &value);
    TEST_ASSERT_TRUE(end.failed && value == 99 && end.at == 8);
    fmu_stream exact = {.from = bytes, .size = 8};
    fmu_stream_u64(&exact, &value);
    TEST_ASSERT_TRUE(!exact.failed && value == 0);
}

static void a_number_out_of_its_range_fails_and_keeps_the_one_before(void) {
    const int32_t given[4] = {-4, 4, -3, 3};
    for (int k = 0; k < 4; k++) {
        fmu_stream to = {.to = bytes, .size = 8}, from = {.from = bytes, .size = 8};
        int32_t value = given[k];
        fmu_stream_i32(&to, &value, -100, 100);
        value = 0;
        fmu_stream_i32(&from, &value, -3, 3);
        TEST_ASSERT_EQUAL(k < 2, from.failed);
        TEST_ASSERT_EQUAL_INT32(k < 2 ? 0 : given[k], value);
    }
}

static void a_flag_is_0_or_1(void) {
    for (uint8_t number = 0; number < 4; number++) {
        fmu_stream from = {.from = bytes, .size = 8};
        bool flag = number != 1;
        bytes[0] = number;
        fmu_stream_bool(&from, &flag);
        TEST_ASSERT_EQUAL(number > 1, from.failed);
        TEST_ASSERT_EQUAL(number != 0, flag);
    }
}

static void the_checksum_is_the_usual_crc_32(void) {
    for (unsigned byte = 0; byte < 256; byte++) { /* bit by bit */
        const uint8_t one = (uint8_t)byte;
        uint32_t remainder = 0xFFFFFFFFU ^ byte;
        for (int k = 0; k < 8; k++) remainder = (remainder >> 1) ^ (remainder & 1U ? 0xEDB88320U : 0U);
        TEST_ASSERT_EQUAL_HEX32(~remainder, fmu_checksum(&one, 1));
    }
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, fmu_checksum((const uint8_t *)"123456789", 9));
    TEST_ASSERT_EQUAL_HEX32(0, fmu_checksum(bytes, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_are_little_endian_and_come_back);
    RUN_TEST(bytes_that_are_too_few_fail_and_are_not_touched);
    RUN_TEST(a_number_out_of_its_range_fails_and_keeps_the_one_before);
    RUN_TEST(a_flag_is_0_or_1);
    RUN_TEST(the_checksum_is_the_usual_crc_32);
    return UNITY_END();
}
