/* Addition and subtraction in double precision for Arm processors that have none, such as Cortex-M3, M4 and M33:
 * libgcc's round some differences wrongly (docs/c.md). Link this file into firmware that computes in double;
 * no source changes, since compilers call these functions by the names of the processor's run-time ABI. Elsewhere it
 * holds the functions of soft_double.h alone.
 *
 * A significand is a whole number of 53 bits and a rest of 32 bits below the point. The last bit of the rest tells
 * whether anything was lost below it. */
#include "soft_double.h"

#include <stdbool.h>

#define RARE __attribute__((noinline, cold))

#define FIRST_BIT ((uint64_t)1 << 52) /* of a significand; the format leaves it out */
#define QUIET ((uint64_t)1 << 51)
#define INFINITE_BITS ((uint64_t)0x7FF << 52)
#define SIGN ((uint32_t)1 << 31) /* of the upper half */
#define HALF ((uint32_t)1 << 31) /* of the last bit, as a rest */
enum { NO_NUMBER = 0x7FF, BIAS = 1023 };

typedef struct significand {
    uint64_t whole;
    uint32_t rest;
} significand;

static uint32_t high(uint64_t bits) { return (uint32_t)(bits >> 32); }
static uint32_t low(uint64_t bits) { return (uint32_t)bits; }
static uint64_t joined(uint32_t upper, uint32_t lower) { return (uint64_t)upper << 32 | lower; }

/* The field of the exponent is 0 for zeros and subnormal numbers, which have the scale of 1 without the first bit. */
static uint32_t exponent_of(uint64_t bits) { return high(bits) >> 20 & NO_NUMBER; }
static bool is_nan(uint64_t bits) { return bits << 1 > INFINITE_BITS << 1; }

RARE static uint64_t sum_beyond_numbers(uint64_t a, uint64_t b) {
    if (is_nan(a)) return a | QUIET;
    if (is_nan(b)) return b | QUIET;
    if (exponent_of(a) != NO_NUMBER) return b;
    return (a ^ b) >> 63 != 0 && exponent_of(b) == NO_NUMBER ? INFINITE_BITS | QUIET : a; /* ∞ − ∞ */
}

/* The first bit of `whole`, where it is there, raises the exponent by one. */
static uint64_t packed(uint32_t sign, uint32_t exponent, uint64_t whole) {
    return joined(sign | (exponent - 1) << 20, 0) + whole;
}

/* A carry runs into the exponent, up to infinity. */
static uint64_t rounded(uint32_t sign, uint32_t exponent, uint64_t whole, uint32_t rest) {
    if (rest >= HALF) whole += rest > HALF ? 1 : whole & 1;
    return packed(sign, exponent, whole);
}

/* A whole number other than 0, whose last bit has the scale of `exponent`. Its first bit comes to its place, unless
 * that is below the exponent 1. */
static uint64_t normalised(uint32_t sign, uint32_t exponent, uint64_t whole) {
    uint32_t places = (uint32_t)__builtin_clzll(whole) - 11;
    if (places >= exponent) places = exponent - 1;
    return packed(sign, exponent - places, whole << places);
}

/* Shifted to the right by 1 to 54 places. */
static significand shifted(uint64_t whole, uint32_t places) {
    const uint32_t upper = high(whole), lower = low(whole), over = places - 32, back = 0 - over;
    significand found = {upper, lower}; /* by 32 */
    if (places < 32) {
        found.whole = joined(upper >> places, lower >> places | upper << back);
        found.rest = lower << back;
    } else if (places > 32) {
        found.whole = upper >> over;
        found.rest = lower >> over | upper << (32 - over) | (lower << (32 - over) != 0);
    }
    return found;
}

static uint64_t sum(uint32_t sign, uint32_t exponent, uint64_t x, significand y) {
    x += y.whole;
    if (x >= FIRST_BIT << 1) {
        y.rest = y.rest >> 1 | (y.rest & 1) | low(x) << 31;
        x >>= 1;
        if (++exponent == NO_NUMBER) return joined(sign, 0) | INFINITE_BITS;
    }
    return rounded(sign, exponent, x, y.rest);
}

/* x is as large as y, or has its exponent: then y has no rest. Where the first two bits vanish, y was shifted by one
 * place at most, so one bit of the rest is all that there is. */
static uint64_t difference(uint32_t sign, uint32_t exponent, uint64_t x, significand y) {
    uint32_t rest = 0 - y.rest;
    x -= y.whole + (y.rest != 0);
    if (x >> 63 != 0) {
        x = 0 - x;
        sign ^= SIGN;
    }
    if (x < FIRST_BIT && exponent > 1) {
        x = x << 1 | rest >> 31;
        rest <<= 1;
        exponent--;
    }
    if (x >= FIRST_BIT) return rounded(sign, exponent, x, rest);
    return x == 0 ? 0 : normalised(sign, exponent, x);
}

/* In one piece: with the numbers ordered in a function of its own, each call would pass 24 bytes. */
uint64_t laconic_soft_add(uint64_t a, uint64_t b) {
    uint32_t exponent = exponent_of(a), other = exponent_of(b);
    if (exponent < other) {
        const uint64_t smaller = a;
        a = b;
        b = smaller;
        exponent = other;
        other = exponent_of(b);
    }
    if (exponent == NO_NUMBER) return sum_beyond_numbers(a, b);
    significand y = {(b & (FIRST_BIT - 1)) | FIRST_BIT, 0};
    uint64_t x = (a & (FIRST_BIT - 1)) | FIRST_BIT;
    uint32_t places = exponent - other;
    if (other == 0) {
        y.whole ^= FIRST_BIT;
        if (exponent == 0) {
            x ^= FIRST_BIT;
            exponent = 1;
        } else if (y.whole == 0) {
            return a;
        } else {
            places--;
        }
    }
    if (places > 54) return a; /* b is less than a quarter of its last bit */
    if (places != 0) y = shifted(y.whole, places);
    if (((high(a) ^ high(b)) & SIGN) != 0) return difference(high(a) & SIGN, exponent, x, y);
    return sum(high(a) & SIGN, exponent, x, y);
}

uint64_t laconic_soft_subtract(uint64_t a, uint64_t b) { return laconic_soft_add(a, b ^ joined(SIGN, 0)); }

uint64_t laconic_soft_subtract_from(uint64_t a, uint64_t b) { return laconic_soft_add(b, a ^ joined(SIGN, 0)); }

/* ±whole·2^power, with at most 53 bits from the first to the last one; the smallest is normal. */
static uint64_t exact(uint32_t sign, uint32_t whole, uint32_t power) {
    if (whole == 0) return joined(sign, 0);
    return normalised(sign, BIAS + 52 + power, whole);
}

uint64_t laconic_soft_of_single(uint32_t single) {
    const uint32_t sign = single & SIGN, magnitude = single ^ sign, exponent = magnitude >> 23;
    const uint64_t bits = joined(sign, 0) | (uint64_t)magnitude << 29;
    if (exponent == 0) return exact(sign, magnitude, 0U - 149U);
    if (exponent != 0xFF) return bits + joined((BIAS - 127) << 20, 0);
    return bits | INFINITE_BITS | (magnitude << 9 != 0 ? QUIET : 0);
}

uint64_t laconic_soft_of_uint32(uint32_t whole) { return exact(0, whole, 0); }

uint64_t laconic_soft_of_int32(int32_t whole) {
    return whole < 0 ? exact(SIGN, 0 - (uint32_t)whole, 0) : exact(0, (uint32_t)whole, 0);
}

static uint64_t of_magnitude(uint32_t sign, uint64_t whole) {
    if (whole == 0) return 0;
    const uint32_t places = (uint32_t)__builtin_clzll(whole);
    whole <<= places;
    return rounded(sign, BIAS + 63 - places, whole >> 11, low(whole) << 21);
}

uint64_t laconic_soft_of_uint64(uint64_t whole) { return of_magnitude(0, whole); }

uint64_t laconic_soft_of_int64(int64_t whole) {
    return whole < 0 ? of_magnitude(SIGN, 0 - (uint64_t)whole) : of_magnitude(0, (uint64_t)whole);
}

/* All names of libgcc's object with the addition: with one of them missing, a program that uses it would link libgcc's
 * object besides, and each function twice. */
#if defined(__GNUC__) && defined(__ARM_EABI__) && (!defined(__thumb__) || defined(__thumb2__))
#if !defined(__ARM_FP) || (__ARM_FP & 8) == 0
#define LACONIC_SOFT_DOUBLE_REPLACES
#define ALSO(name, function) extern __typeof__(function) name __attribute__((used, alias(#function)))
ALSO(__aeabi_dadd, laconic_soft_add);
ALSO(__adddf3, laconic_soft_add);
ALSO(__aeabi_dsub, laconic_soft_subtract);
ALSO(__subdf3, laconic_soft_subtract);
ALSO(__aeabi_drsub, laconic_soft_subtract_from);
ALSO(__aeabi_f2d, laconic_soft_of_single);
ALSO(__extendsfdf2, laconic_soft_of_single);
ALSO(__aeabi_i2d, laconic_soft_of_int32);
ALSO(__floatsidf, laconic_soft_of_int32);
ALSO(__aeabi_ui2d, laconic_soft_of_uint32);
ALSO(__floatunsidf, laconic_soft_of_uint32);
ALSO(__aeabi_l2d, laconic_soft_of_int64);
ALSO(__floatdidf, laconic_soft_of_int64);
ALSO(__aeabi_ul2d, laconic_soft_of_uint64);
ALSO(__floatundidf, laconic_soft_of_uint64);
#endif
#endif
