/* The checksum of saved states for fuzz targets, which the linker puts in its place (--wrap): the same values, eight
 * bytes at a time and without sanitizers. By the product's half bytes it would take two thirds of a target's time. */
#include <stdlib.h>

#include "stream.h"

uint32_t __real_fmu_checksum(const uint8_t *bytes, size_t size);
uint32_t __wrap_fmu_checksum(const uint8_t *bytes, size_t size);

enum { SLICES = 8 };

static uint32_t table[SLICES][256];

static void make_table(void) {
    uint8_t known[256];
    for (uint32_t n = 0; n < 256; n++) {
        uint32_t remainder = n;
        for (int bit = 0; bit < 8; bit++) remainder = (remainder >> 1) ^ (remainder & 1U ? 0xEDB88320U : 0U);
        table[0][n] = remainder;
        known[n] = (uint8_t)(37U * n + 1U);
    }
    for (uint32_t n = 0; n < 256; n++)
        for (int k = 1; k < SLICES; k++) table[k][n] = (table[k - 1][n] >> 8) ^ table[0][table[k - 1][n] & 255U];
    for (size_t size = 0; size < sizeof known; size += 5)
        if (__wrap_fmu_checksum(known, size) != __real_fmu_checksum(known, size)) abort();
}

__attribute__((no_sanitize("address", "undefined"))) static uint32_t after(uint32_t remainder, const uint8_t *bytes,
                                                                           size_t size) {
    for (; size >= SLICES; bytes += SLICES, size -= SLICES)
        remainder = table[7][bytes[0] ^ (remainder & 255U)] ^ table[6][bytes[1] ^ (remainder >> 8 & 255U)] ^
                    table[5][bytes[2] ^ (remainder >> 16 & 255U)] ^ table[4][bytes[3] ^ (remainder >> 24)] ^
                    table[3][bytes[4]] ^ table[2][bytes[5]] ^ table[1][bytes[6]] ^ table[0][bytes[7]];
    for (size_t k = 0; k < size; k++) remainder = (remainder >> 8) ^ table[0][(remainder ^ bytes[k]) & 255U];
    return remainder;
}

uint32_t __wrap_fmu_checksum(const uint8_t *bytes, size_t size) {
    static bool is_made;
    if (!is_made) {
        is_made = true;
        make_table();
    }
    return ~after(0xFFFFFFFFU, bytes, size);
}
