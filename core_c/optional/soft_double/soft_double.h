/* Arithmetic in double precision by integers, rounded to nearest, ties to even; soft_double.c tells where it is needed.
 * Numbers go in and out as the 64 or 32 bits that IEEE 754 gives them. Subnormal numbers, both zeros and infinities are
 * as the standard has them. A NaN comes out quiet. */
#ifndef LACONIC_SOFT_DOUBLE_H
#define LACONIC_SOFT_DOUBLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

uint64_t laconic_soft_add(uint64_t a, uint64_t b);           /* a + b */
uint64_t laconic_soft_subtract(uint64_t a, uint64_t b);      /* a − b */
uint64_t laconic_soft_subtract_from(uint64_t a, uint64_t b); /* b − a */
uint64_t laconic_soft_of_single(uint32_t single);            /* exact */
uint64_t laconic_soft_of_int32(int32_t whole);               /* exact */
uint64_t laconic_soft_of_uint32(uint32_t whole);             /* exact */
uint64_t laconic_soft_of_int64(int64_t whole);               /* rounded beyond 2⁵³ */
uint64_t laconic_soft_of_uint64(uint64_t whole);             /* rounded beyond 2⁵³ */

#ifdef __cplusplus
}
#endif

#endif
