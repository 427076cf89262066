/* Start value and DataID of the CRC of plain and keyed frames. */
#include "laconic_node/protection.h"

#include "laconic_node/e2e.h"
#include "laconic_node/frame.h"
#include "laconic_wire.h"

/* Offsets of identifiers are below RUN and the counts of a START are added to it, so both never mix the same number. */
#define RUN 32U
#define CLASSIC_BYTES 8 /* of every classic frame of the contract */

/* A bijection of 32 bits; flipping a bit of x flips about half of the bits of the result (odd factors, chosen by
 * trial for the least bias). */
static uint32_t stir(uint32_t x) {
    x ^= x >> 16;
    x *= 0xA5C6E92DU;
    x ^= x >> 15;
    x *= 0x816223D3U;
    return x ^ (x >> 16);
}

uint32_t laconic_mix(uint32_t a, uint32_t b) { return stir(stir(a ^ 0x6C61636FU) ^ b); }

uint32_t laconic_run_key(uint32_t key, uint32_t start_count) { return laconic_mix(key, start_count + RUN); }

static bool is_fd(uint8_t offset) { return LACONIC_NODE_CAN_FD && laconic_wire[offset].fd; }

static const uint8_t *list_of(uint8_t offset) { return laconic_wire_data_ids[laconic_wire[offset].list]; }

uint8_t laconic_counter_of(uint8_t offset, const uint8_t *data) {
    return is_fd(offset) ? data[2] : (uint8_t)(data[1] & LACONIC_E2E_P22_COUNTER_MASK);
}

static laconic_e2e_ends plain(uint8_t offset, uint8_t counter) {
    laconic_e2e_ends ends = {LACONIC_E2E_P05_START, 0};
    if (is_fd(offset)) {
        ends.data_id = laconic_wire_data_id(offset);
    } else {
        ends.start = LACONIC_E2E_P22_START;
        ends.data_id = list_of(offset)[counter & LACONIC_E2E_P22_COUNTER_MASK];
    }
    return ends;
}

static laconic_e2e_ends keyed(uint8_t offset, uint32_t key, uint32_t count) {
    const uint32_t hash = laconic_mix(laconic_mix(key, offset), count);
    laconic_e2e_ends ends = {(uint16_t)hash, 0};
    if (is_fd(offset)) {
        ends.data_id = (uint16_t)(laconic_wire_data_id(offset) + (hash >> 16));
    } else {
        ends.start &= 255U;
        ends.data_id = list_of(offset)[hash >> 8 & 15U];
    }
    return ends;
}

static void protect(uint8_t offset, uint8_t *data, uint8_t counter, laconic_e2e_ends ends) {
    if (is_fd(offset)) {
        laconic_e2e_p05_protect(data, laconic_wire[offset].length, ends, counter);
    } else {
        laconic_e2e_p22_protect(data, CLASSIC_BYTES, ends, counter);
    }
}

static bool is_right(uint8_t offset, const uint8_t *data, laconic_e2e_ends ends) {
    return is_fd(offset) ? laconic_e2e_p05_crc_is_right(data, laconic_wire[offset].length, ends)
                         : laconic_e2e_p22_crc_is_right(data, CLASSIC_BYTES, ends);
}

void laconic_protect_plain(uint8_t offset, uint8_t *data, uint8_t counter) {
    protect(offset, data, counter, plain(offset, counter));
}

void laconic_protect_keyed(uint8_t offset, uint8_t *data, uint32_t key, uint32_t count) {
    protect(offset, data, (uint8_t)count, keyed(offset, key, count));
}

bool laconic_plain_is_right(uint8_t offset, const uint8_t *data) {
    return is_right(offset, data, plain(offset, laconic_counter_of(offset, data)));
}

bool laconic_keyed_is_right(uint8_t offset, const uint8_t *data, uint32_t key, uint32_t count) {
    return is_right(offset, data, keyed(offset, key, count));
}
