/* soft_double.c beside this processor's addition: `soft_double SEED PAIRS` prints the first pair that differs and
 * ends with 1, else the number of pairs. Half of the pairs are any bits, the others those that rounding is sensitive
 * to: exponents 0 to 70 apart, fractions of few ones, of long rows of ones, or near a power of two. */
#include "soft_double.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIGN ((uint64_t)1 << 63)
#define FRACTION (((uint64_t)1 << 52) - 1)

static uint64_t state;

static uint64_t next(void) { /* splitmix64 */
    uint64_t z = state += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
}

static uint64_t added(uint64_t a, uint64_t b) {
    double x, y, sum;
    uint64_t bits;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    sum = x + y;
    memcpy(&bits, &sum, sizeof bits);
    return bits;
}

static uint64_t fraction(uint64_t chosen) {
    const uint64_t random = next() & FRACTION, place = chosen >> 3 & 63;
    switch (chosen & 7) {
    case 0: return random >> (place < 52 ? place : 0);
    case 1: return FRACTION ^ (random >> (place < 52 ? place : 0));
    case 2: return (random << place) & FRACTION;
    case 3: return ((uint64_t)1 << place) - (chosen >> 9 & 1);
    case 4: return random & random >> 7 & random << 9;
    default: return random;
    }
}

static void draw(uint64_t *a, uint64_t *b) {
    const uint64_t chosen = next(), apart = (chosen >> 8) % 71, lower = chosen >> 20 & 0x7FF;
    *a = next();
    *b = next();
    if ((chosen & 1) != 0) return;
    const uint64_t upper = lower + apart < 0x7FF ? lower + apart : 0x7FE;
    *a = (*a & SIGN) | upper << 52 | (fraction(chosen >> 32) & FRACTION);
    *b = (*b & SIGN) | lower << 52 | (fraction(chosen >> 48) & FRACTION);
}

static int is_same(uint64_t expected, uint64_t found) {
    const uint64_t infinite = (uint64_t)0x7FF << 52;
    return expected == found || (expected << 1 > infinite << 1 && found << 1 > infinite << 1);
}

static int differs(uint64_t a, uint64_t b) {
    const uint64_t expected = added(a, b), found = laconic_soft_add(a, b);
    if (is_same(expected, found)) return 0;
    printf("%016" PRIx64 " + %016" PRIx64 " is %016" PRIx64 ", not %016" PRIx64 "\n", a, b, expected, found);
    return 1;
}

int main(int argc, char **argv) {
    uint64_t a, b;
    if (argc != 3) return 2;
    state = strtoull(argv[1], NULL, 10) * 0xD1342543DE82EF95U;
    const uint64_t pairs = strtoull(argv[2], NULL, 10);
    for (uint64_t k = 0; k < pairs; k += 2) {
        draw(&a, &b);
        if (differs(a, b) || differs(b, a ^ SIGN)) return 1;
    }
    printf("%" PRIu64 "\n", pairs);
    return 0;
}
