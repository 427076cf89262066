/* Tests of crc.c against the published check values. */
#include "laconic_node/crc.h"
#include "unity.h"

#include <stdbool.h>

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

/* Bit by bit, as the polynomials define it, highest bit first. */
static uint32_t divided(uint32_t crc, uint8_t byte, uint32_t polynomial, int bits) {
    crc ^= (uint32_t)byte << (bits - 8);
    for (int k = 0; k < 8; k++) {
        const bool carry = (crc >> (bits - 1) & 1U) != 0;
        crc = crc << 1 ^ (carry ? polynomial : 0U);
    }
    return bits == 8 ? crc & 0xFFU : crc & 0xFFFFU;
}

/* CRC-32 has its lowest bit first. */
static uint32_t divided32(uint32_t crc, uint8_t byte) {
    crc ^= byte;
    for (int k = 0; k < 8; k++) crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    return crc;
}

static void every_byte_gives_the_remainder_of_the_polynomials(void) {
    for (uint32_t k = 0; k < 256; k++) {
        const uint8_t byte = (uint8_t)k;
        TEST_ASSERT_EQUAL_HEX8(divided(0x5A, byte, 0x2F, 8), laconic_crc8(0x5A, &byte, 1));
        TEST_ASSERT_EQUAL_HEX16(divided(0x5AC3, byte, 0x1021, 16), laconic_crc16(0x5AC3, &byte, 1));
        TEST_ASSERT_EQUAL_HEX32(divided32(0x5AC3961EU, byte), laconic_crc32(0x5AC3961EU, &byte, 1));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(published_values_of_crc8h2f);
    RUN_TEST(check_values_of_crc16_and_crc32);
    RUN_TEST(a_checksum_may_be_taken_in_parts);
    RUN_TEST(every_byte_gives_the_remainder_of_the_polynomials);
    return UNITY_END();
}
