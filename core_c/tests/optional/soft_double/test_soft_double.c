/* The adder of soft_double.c on a host, whose processor adds in double by itself: the same bits on every hard case. */
#include "soft_double.h"

#include <string.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define SIGN ((uint64_t)1 << 63)
#define ONES (((uint64_t)1 << 52) - 1)

/* The last bits of a fraction, those around the middle of the format and around its 33rd bit decide on rounding. */
static const uint64_t fractions[] = {0,
                                     1,
                                     2,
                                     3,
                                     0xFF,
                                     0x100,
                                     (uint64_t)1 << 20,
                                     (uint64_t)1 << 31,
                                     (uint64_t)1 << 32,
                                     (uint64_t)3 << 31,
                                     0x7FFFFFFF,
                                     0x80000001,
                                     ((uint64_t)1 << 32) - 1,
                                     (uint64_t)1 << 51,
                                     ((uint64_t)1 << 51) - 1,
                                     ONES - 1,
                                     ONES,
                                     ((uint64_t)1 << 51) + 1,
                                     ONES ^ 0xFFFFFFFF,
                                     (uint64_t)0x31628704D6200};
enum { FRACTIONS = sizeof fractions / sizeof fractions[0] };

static double number_of(uint64_t bits) {
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* Every NaN is one to these tests: its other bits differ between processors. */
static uint64_t bits_of(double number) {
    uint64_t bits;
    if (number != number) return (uint64_t)0x7FF8 << 48;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static void check(uint64_t a, uint64_t b) {
    TEST_ASSERT_EQUAL_HEX64(bits_of(number_of(a) + number_of(b)), bits_of(number_of(laconic_soft_add(a, b))));
    TEST_ASSERT_EQUAL_HEX64(bits_of(number_of(a) - number_of(b)), bits_of(number_of(laconic_soft_subtract(a, b))));
    TEST_ASSERT_EQUAL_HEX64(bits_of(number_of(b) - number_of(a)), bits_of(number_of(laconic_soft_subtract_from(a, b))));
}

static void check_fractions(uint64_t exponent, uint64_t other) {
    for (int i = 0; i < FRACTIONS; i++) {
        for (int k = 0; k < FRACTIONS; k++) {
            const uint64_t a = exponent << 52 | fractions[i], b = other << 52 | fractions[k];
            check(a, b);
            check(b, a | SIGN);
        }
    }
}

static void exponents_apart_by_0_to_70_round_as_the_processor_does(void) {
    for (uint64_t apart = 0; apart <= 70; apart++) {
        check_fractions(1023, 1023 - apart);
        check_fractions(apart + 2, 2);
        check_fractions(2046, 2046 - apart);
    }
}

static void zeros_subnormal_numbers_and_what_is_no_number_are_the_processors(void) {
    static const uint64_t exponents[] = {0, 1, 2, 3, 52, 53, 54, 55, 1023, 2045, 2046, 2047};
    for (size_t i = 0; i < sizeof exponents / sizeof exponents[0]; i++)
        for (size_t k = 0; k < sizeof exponents / sizeof exponents[0]; k++) check_fractions(exponents[i], exponents[k]);
}

static void the_differences_that_libgcc_rounds_wrongly_are_right(void) {
    const uint64_t one = (uint64_t)1023 << 52;
    TEST_ASSERT_EQUAL_HEX64(0x3feffffffff00000, laconic_soft_subtract(one, 0x3de0000000000001));
    TEST_ASSERT_EQUAL_HEX64(0x3fefffffffece9d8, laconic_soft_subtract(one, 0x3de31628704d6200));
    TEST_ASSERT_EQUAL_HEX64(0xbfefffffffece9d8, laconic_soft_subtract(0x3de31628704d6200, one));
}

/* Sums that come close to a power of two from either side, and differences that keep a few bits. */
static void random_numbers_of_every_kind_round_as_the_processor_does(void) {
    uint64_t state = 0x9E3779B97F4A7C15U;
    for (int k = 0; k < 300000; k++) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        const uint64_t a = (uint64_t)(1023 + k % 3) << 52 | ((state >> 12) & (k % 4 == 0 ? 0xFFFFF : ONES));
        const uint64_t b = (1023 - (state >> 5) % 64) << 52 | ((state * 0x9E3779B97F4A7C15U) >> 12);
        check(a, b);
        check(a, b | SIGN);
        check(state, state * 0xD1342543DE82EF95U);
        check(a | SIGN, a + (state >> 60));
    }
}

static void what_is_no_number_comes_out_quiet(void) {
    const uint64_t signalling = 0x7FF0000000000001, infinite = 0x7FF0000000000000;
    TEST_ASSERT_EQUAL_HEX64(0x7FF8000000000001, laconic_soft_add(signalling, 0));
    TEST_ASSERT_EQUAL_HEX64(0x7FF8000000000001, laconic_soft_add(1, signalling));
    TEST_ASSERT_EQUAL_HEX64(0x7FF8000000000001, laconic_soft_add(infinite, signalling));
    TEST_ASSERT_EQUAL_HEX64(0x7FF8000000000000, laconic_soft_subtract(infinite, infinite));
    TEST_ASSERT_EQUAL_HEX64(0x7FF8200000000000, laconic_soft_of_single(0x7F810000));
}

static void check_single(uint32_t bits) {
    float single;
    memcpy(&single, &bits, sizeof single);
    TEST_ASSERT_EQUAL_HEX64(bits_of((double)single), bits_of(number_of(laconic_soft_of_single(bits))));
}

static void numbers_in_single_precision_of_every_exponent_keep_their_value(void) {
    for (uint32_t upper = 0; upper < 512; upper++) {
        for (uint32_t place = 0; place < 23; place++) {
            check_single(upper << 23);
            check_single(upper << 23 | 1U << place);
            check_single(upper << 23 | (0x7FFFFFU >> place));
        }
    }
}

static void check_whole(uint64_t whole) {
    const uint32_t half = (uint32_t)(whole >> 32);
    TEST_ASSERT_EQUAL_HEX64(bits_of((double)whole), laconic_soft_of_uint64(whole));
    TEST_ASSERT_EQUAL_HEX64(bits_of((double)(int64_t)whole), laconic_soft_of_int64((int64_t)whole));
    TEST_ASSERT_EQUAL_HEX64(bits_of(half), laconic_soft_of_uint32(half));
    TEST_ASSERT_EQUAL_HEX64(bits_of((int32_t)half), laconic_soft_of_int32((int32_t)half));
}

static void whole_numbers_at_every_place_and_between_two_doubles_round_as_the_compiler_does(void) {
    static const uint64_t parts[] = {0, 1, 2, 3, 0x3FF, 0x400, 0x401, 0x7FF, 0x800, 0xBFF, 0xC00, 0xC01};
    for (int place = 0; place < 64; place++) {
        for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
            check_whole((uint64_t)1 << place | parts[k]);
            check_whole(((uint64_t)1 << place) - parts[k]);
            check_whole(0 - ((uint64_t)1 << place) - parts[k]);
            check_whole(((((uint64_t)1 << 53) + 1) << (place % 11)) + parts[k]);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(exponents_apart_by_0_to_70_round_as_the_processor_does);
    RUN_TEST(zeros_subnormal_numbers_and_what_is_no_number_are_the_processors);
    RUN_TEST(the_differences_that_libgcc_rounds_wrongly_are_right);
    RUN_TEST(random_numbers_of_every_kind_round_as_the_processor_does);
    RUN_TEST(what_is_no_number_comes_out_quiet);
    RUN_TEST(numbers_in_single_precision_of_every_exponent_keep_their_value);
    RUN_TEST(whole_numbers_at_every_place_and_between_two_doubles_round_as_the_compiler_does);
    return UNITY_END();
}
