/* Numbers out of the bytes of an input; where they end, 0. */
#ifndef LACONIC_FMU_FUZZ_BYTES_H
#define LACONIC_FMU_FUZZ_BYTES_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct source {
    const uint8_t *bytes;
    size_t size, at;
} source;

/* A byte. */
static inline unsigned next(source *s) { return s->at < s->size ? s->bytes[s->at++] : 0; }

static inline uint32_t next_word(source *s) {
    uint32_t word = next(s);
    word |= next(s) << 8;
    word |= next(s) << 16;
    return word | next(s) << 24;
}

/* Usual and extreme numbers, sometimes any. */
static inline double next_number(source *s) {
    static const double odd[] = {0.0,   -0.0,   1.0,     -1.0,    1e-3,     0.01,   0.1,  2.0, 5.0,  1e9, -1e9,
                                 1e300, -1e300, DBL_MIN, DBL_MAX, -DBL_MAX, 1e-300, 3.14, 0.5, 1e17, 1e19};
    const unsigned choice = next(s);
    double value;
    if (choice < 128) return odd[choice % (sizeof odd / sizeof odd[0])];
    if (choice < 140) return NAN;
    if (choice < 150) return choice % 2 ? INFINITY : -INFINITY;
    if (choice < 230) return (double)(int32_t)next_word(s) * 1e-9;
    uint64_t bits = (uint64_t)next_word(s) << 32 | next_word(s);
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
