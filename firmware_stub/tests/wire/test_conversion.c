/* Numbers of 64 bits in single precision on small boards: the same bits as the compiler's own conversion. */
#include "conversion.h"

#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static void check(uint64_t whole) {
    const float expected = (float)whole;
    uint32_t bits;
    memcpy(&bits, &expected, sizeof bits);
    TEST_ASSERT_EQUAL_HEX32(bits, port_single_bits(whole));
}

static void numbers_at_every_place_and_between_two_floats_round_as_the_compiler_does(void) {
    static const uint64_t parts[] = {0, 1, 2, 3, 0x7F, 0x80, 0x81, 0xFF, 0x100, 0x180, 0x17F, 0x181};
    check(0);
    check(UINT64_MAX);
    for (int place = 0; place < 64; place++) {
        for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
            check((uint64_t)1 << place | parts[k]);
            check(((uint64_t)1 << place) - parts[k]);
            check(((uint64_t)0x1000001 << place) + (place > 8 ? parts[k] << (place - 8) : parts[k]));
        }
    }
}

static void random_numbers_of_every_length_round_as_the_compiler_does(void) {
    uint64_t state = 0x9E3779B97F4A7C15U;
    for (int k = 0; k < 100000; k++) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        check(state >> (k % 64));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_at_every_place_and_between_two_floats_round_as_the_compiler_does);
    RUN_TEST(random_numbers_of_every_length_round_as_the_compiler_does);
    return UNITY_END();
}
