/* Normal deviates as a function of seed, stream and index, by integer arithmetic and the core's own functions: the same
 * bits on every platform, and no state. */
#include "heading.h"

/* The generator is SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014): a count in
 * steps of an odd number, each value scrambled so that every bit depends on every bit of it. Since its state is a
 * count, any place of the sequence is reached at once. */
#define GOLDEN UINT64_C(0x9E3779B97F4A7C15) /* 2^64 over the golden ratio */

static uint64_t scrambled(uint64_t z) {
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

#ifdef LACONIC_SINGLE
#define FRACTION_BITS 24
#define FRACTION_UNIT R(5.9604644775390625e-8) /* 2^-24 */
#else
#define FRACTION_BITS 53
#define FRACTION_UNIT R(1.1102230246251565404e-16) /* 2^-53 */
#endif
#define SQUARE_ROOT_OF_HALF R(0.70710678118654752440)
#define LN2 R(0.69314718055994530942)

/* −ln of the share of 2^64 that the integer is, with 0 taken as 1: 0 … 44.4. The share is m 2^-n; with √½ <= m < √2
 * and s = (m − 1)/(m + 1), ln m = 2 artanh s, whose 11 terms leave less than 1e-18 of it. */
static real minus_log_of_share(uint64_t bits) {
    int32_t halvings = 0;
    bits |= 1U;
    for (; bits >> 63 == 0; bits <<= 1) halvings++;
    real m = (real)(int64_t)(bits >> (64 - FRACTION_BITS)) * FRACTION_UNIT; /* exact */
    if (m < SQUARE_ROOT_OF_HALF) {
        m *= R(2);
        halvings++;
    }
    const real s = (m - R(1)) / (m + R(1)), square = s * s;
    real sum = R(0);
    for (int32_t k = 21; k >= 1; k -= 2) sum = sum * square + R(1) / (real)k;
    return (real)halvings * LN2 - R(2) * s * sum;
}

/* Box and Muller: the radius of a normal pair is √(−2 ln u), its direction any with equal right. */
void laconic_normal_pair(laconic_real pair[2], uint64_t seed, uint32_t stream, uint64_t index) {
    const uint64_t start = scrambled(scrambled(seed + GOLDEN) + stream) + 2U * index * GOLDEN;
    const uint64_t first = scrambled(start + GOLDEN), second = scrambled(start + 2U * GOLDEN);
    const real radius = laconic_root(R(2) * minus_log_of_share(first));
    const direction way = direction_of_binary_angle((laconic_binary_angle)(second >> (64 - BINARY_ANGLE_BITS)));
    pair[0] = radius * way.cosine;
    pair[1] = radius * way.sine;
}
