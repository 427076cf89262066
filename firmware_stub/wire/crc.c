/* The three checksums of the wire: CRC-8 and CRC-16 of the frames, CRC-32 of a loaded vehicle. */
#include "laconic_node/crc.h"

/* Each look-up takes four bits: two look-ups a byte, and 112 bytes of tables for all three. */

static const uint8_t table8[16] = {0x00, 0x2F, 0x5E, 0x71, 0xBC, 0x93, 0xE2, 0xCD,
                                   0x57, 0x78, 0x09, 0x26, 0xEB, 0xC4, 0xB5, 0x9A};

uint8_t laconic_crc8(uint8_t crc, const uint8_t *bytes, size_t count) {
    for (size_t k = 0; k < count; k++) {
        crc = (uint8_t)(crc ^ bytes[k]);
        crc = (uint8_t)((crc << 4) ^ table8[crc >> 4]);
        crc = (uint8_t)((crc << 4) ^ table8[crc >> 4]);
    }
    return crc;
}

static const uint16_t table16[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5, 0x60C6, 0x70E7,
                                     0x8108, 0x9129, 0xA14A, 0xB16B, 0xC18C, 0xD1AD, 0xE1CE, 0xF1EF};

uint16_t laconic_crc16(uint16_t crc, const uint8_t *bytes, size_t count) {
    for (size_t k = 0; k < count; k++) {
        crc = (uint16_t)(crc ^ (bytes[k] << 8));
        crc = (uint16_t)((crc << 4) ^ table16[crc >> 12]);
        crc = (uint16_t)((crc << 4) ^ table16[crc >> 12]);
    }
    return crc;
}

static const uint32_t table32[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
                                     0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                     0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};

uint32_t laconic_crc32(uint32_t crc, const uint8_t *bytes, size_t count) {
    for (size_t k = 0; k < count; k++) {
        crc ^= bytes[k];
        crc = (crc >> 4) ^ table32[crc & 15U];
        crc = (crc >> 4) ^ table32[crc & 15U];
    }
    return crc;
}
