/* Tests of octets.h: values in the payloads of drives. */
#include "octets.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint32_t bits_of(laconic_real value) {
    uint8_t octets[4];
    octets_put_real(octets, value);
    return octets_u32(octets);
}

static void integers_have_their_lowest_octet_first(void) {
    const uint8_t expected[4] = {0x78, 0x56, 0x34, 0x12};
    uint8_t octets[4];
    octets_put_u32(octets, 0x12345678U);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, octets, 4);
    TEST_ASSERT_EQUAL_HEX32(0x12345678U, octets_u32(octets));
    TEST_ASSERT_EQUAL_HEX32(0x3456U, octets_u16(octets + 1));
}

static void real_numbers_are_binary32(void) {
    TEST_ASSERT_EQUAL_HEX32(0x3F800000U, bits_of(1));
    TEST_ASSERT_EQUAL_HEX32(0xC0200000U, bits_of((laconic_real)-2.5));
    const uint8_t half[4] = {0, 0, 0, 0x3F};
    TEST_ASSERT_TRUE(octets_real(half) == (laconic_real)0.5);
}

static void numbers_beyond_binary32_become_its_largest(void) {
    const laconic_real beyond = LACONIC_REAL_MAX * 2;
    TEST_ASSERT_EQUAL_HEX32(0x7F7FFFFFU, bits_of(beyond));
    TEST_ASSERT_EQUAL_HEX32(0xFF7FFFFFU, bits_of(-beyond));
}

static void what_is_no_number_stays_none(void) {
    const laconic_real none = real_not_a_number(), beyond = LACONIC_REAL_MAX * 2;
    TEST_ASSERT_EQUAL_HEX32(0x7FC00000U, bits_of(none) & 0x7FFFFFFFU);
    TEST_ASSERT_FALSE(is_finite(none));
    TEST_ASSERT_FALSE(is_finite(beyond) || is_finite(-beyond));
    TEST_ASSERT_TRUE(is_finite(LACONIC_REAL_MAX) && is_finite(0));
}

static void a_value_is_kept_within_its_bounds(void) {
    TEST_ASSERT_TRUE(real_within(5, -1, 2) == 2);
    TEST_ASSERT_TRUE(real_within(-5, -1, 2) == -1);
    TEST_ASSERT_TRUE(real_within((laconic_real)0.5, -1, 2) == (laconic_real)0.5);
    TEST_ASSERT_TRUE(real_magnitude(-3) == 3 && real_magnitude(3) == 3);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(integers_have_their_lowest_octet_first);
    RUN_TEST(real_numbers_are_binary32);
    RUN_TEST(numbers_beyond_binary32_become_its_largest);
    RUN_TEST(what_is_no_number_stays_none);
    RUN_TEST(a_value_is_kept_within_its_bounds);
    return UNITY_END();
}
