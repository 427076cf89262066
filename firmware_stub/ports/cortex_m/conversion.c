/* The two functions that compilers call to make a number in single precision of one of 64 bits, for small code: the
 * library's take 700 bytes, since they link its addition in software. Needs a processor with single precision. */
#include "conversion.h"

#include <string.h>

/* The highest 32 bits carry all that rounding looks at once their last bit tells whether any lower bit is set: single
 * precision has 24. The power of two that is left is added to the exponent, where it is exact. */
uint32_t port_single_bits(uint64_t whole) {
    const bool is_wide = whole >> 32 != 0;
    uint32_t bits;
    if (whole == 0) return 0;
    if (!is_wide) whole <<= 32;
    const uint32_t places = (uint32_t)__builtin_clz((uint32_t)(whole >> 32));
    whole <<= places;
    const float mantissa = (float)((uint32_t)(whole >> 32) | ((uint32_t)whole != 0 ? 1U : 0U));
    memcpy(&bits, &mantissa, sizeof bits);
    return bits + ((is_wide ? 32U : 0U) << 23) - (places << 23);
}

#ifdef __arm__
/* By the processor's run-time ABI both give their result as an integer register holds it. */
uint32_t __aeabi_ul2f(uint64_t whole);
uint32_t __aeabi_l2f(int64_t whole);

__attribute__((used)) uint32_t __aeabi_ul2f(uint64_t whole) { return port_single_bits(whole); }

__attribute__((used)) uint32_t __aeabi_l2f(int64_t whole) {
    const bool is_negative = whole < 0;
    return port_single_bits(is_negative ? 0U - (uint64_t)whole : (uint64_t)whole) | (is_negative ? 1U << 31 : 0U);
}
#endif
