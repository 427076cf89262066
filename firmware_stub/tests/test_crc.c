/* Tests of crc.c against the published check values. */
#include "laconic_node/crc.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

static uint8_t crc8_of(const uint8_t *bytes, size_t count) {
    return (uint8_t)(laconic_crc8(LACONIC_CRC8_START, bytes, count) ^ LACONIC_CRC8_END);
}

static void published_values_of_crc8h2f(void) {
    const uint8_t zeros[4] = {0, 0, 0, 0};
    const uint8_t three[3] = {0xF2, 0x01, 0x83};
    const uint8_t four[4] = {0x0F, 0xAA, 0x00, 0x55};
    TEST_ASSERT_EQUAL_HEX8(0x12, crc8_of(zeros, 4));
    TEST_ASSERT_EQUAL_HEX8(0xC2, crc8_of(three, 3));
    TEST_ASSERT_EQUAL_HEX8(0xC6, crc8_of(four, 4));
    TEST_ASSERT_EQUAL_HEX8(0xDF, crc8_of(digits, 9));
}

static void check_values_of_crc16_and_crc32(void) {
    TEST_ASSERT_EQUAL_HEX16(0x29B1, laconic_crc16(LACONIC_CRC16_START, digits, 9) ^ LACONIC_CRC16_END);
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, laconic_crc32(LACONIC_CRC32_START, digits, 9) ^ LACONIC_CRC32_END);
}

static void a_checksum_may_be_taken_in_parts(void) {
    const uint32_t whole = laconic_crc32(LACONIC_CRC32_START, digits, 9);
    TEST_ASSERT_EQUAL_HEX32(whole, laconic_crc32(laconic_crc32(LACONIC_CRC32_START, digits, 4), digits + 4, 5));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(published_values_of_crc8h2f);
    RUN_TEST(check_values_of_crc16_and_crc32);
    RUN_TEST(a_checksum_may_be_taken_in_parts);
    return UNITY_END();
}
