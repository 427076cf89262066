/* Values in the payloads of drives: little-endian, real numbers as IEEE 754 binary32. */
#ifndef LACONIC_DRIVES_OCTETS_H
#define LACONIC_DRIVES_OCTETS_H

#include "laconic/laconic.h"

#include <string.h>

static inline uint32_t octets_u16(const uint8_t *from) { return (uint32_t)from[0] | (uint32_t)from[1] << 8; }

static inline uint32_t octets_u32(const uint8_t *from) { return octets_u16(from) | octets_u16(from + 2) << 16; }

static inline void octets_put_u16(uint8_t *to, uint32_t value) {
    to[0] = (uint8_t)value;
    to[1] = (uint8_t)(value >> 8);
}

static inline void octets_put_u32(uint8_t *to, uint32_t value) {
    octets_put_u16(to, value);
    octets_put_u16(to + 2, value >> 16);
}

static inline laconic_real octets_real(const uint8_t *from) {
    const uint32_t bits = octets_u32(from);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (laconic_real)value;
}

/* Values beyond the range of binary32 become its largest. */
static inline void octets_put_real(uint8_t *to, laconic_real value) {
    const laconic_real most = (laconic_real)FLT_MAX;
    const float narrow = (float)(value > most ? most : value < -most ? -most : value);
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    octets_put_u32(to, bits);
}

/* False for NaN and the infinities. */
static inline bool is_finite(laconic_real value) { return value - value == 0; }

static inline laconic_real real_not_a_number(void) {
    static const uint8_t quiet[4] = {0, 0, 0xC0, 0x7F};
    return octets_real(quiet);
}

static inline laconic_real real_within(laconic_real value, laconic_real least, laconic_real most) {
    return value < least ? least : value > most ? most : value;
}

static inline laconic_real real_magnitude(laconic_real value) { return value < 0 ? -value : value; }

#endif
