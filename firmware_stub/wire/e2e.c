/* AUTOSAR end-to-end profiles 22 (classic frames) and 5 (CAN FD): CRC and counter of one frame. */
#include "laconic_node/e2e.h"

#include "laconic_node/crc.h"

static uint8_t p22_crc(const uint8_t *data, uint8_t length, laconic_e2e_ends ends) {
    const uint8_t id = (uint8_t)ends.data_id;
    uint8_t crc = laconic_crc8((uint8_t)ends.start, data + 1, (size_t)length - 1U);
    crc = laconic_crc8(crc, &id, 1);
    return (uint8_t)(crc ^ LACONIC_CRC8_END);
}

void laconic_e2e_p22_protect(uint8_t *data, uint8_t length, laconic_e2e_ends ends, uint8_t counter) {
    data[1] = (uint8_t)((data[1] & 0xF0U) | (counter & LACONIC_E2E_P22_COUNTER_MASK));
    data[0] = p22_crc(data, length, ends);
}

bool laconic_e2e_p22_crc_is_right(const uint8_t *data, uint8_t length, laconic_e2e_ends ends) {
    return length >= LACONIC_E2E_P22_HEADER && data[0] == p22_crc(data, length, ends);
}

static uint16_t p05_crc(const uint8_t *data, uint8_t length, laconic_e2e_ends ends) {
    const uint8_t id[2] = {(uint8_t)(ends.data_id & 255U), (uint8_t)(ends.data_id >> 8)};
    uint16_t crc = laconic_crc16(ends.start, data + 2, (size_t)length - 2U);
    crc = laconic_crc16(crc, id, 2);
    return (uint16_t)(crc ^ LACONIC_CRC16_END);
}

void laconic_e2e_p05_protect(uint8_t *data, uint8_t length, laconic_e2e_ends ends, uint8_t counter) {
    data[2] = counter;
    const uint16_t crc = p05_crc(data, length, ends);
    data[0] = (uint8_t)(crc & 255U);
    data[1] = (uint8_t)(crc >> 8);
}

bool laconic_e2e_p05_crc_is_right(const uint8_t *data, uint8_t length, laconic_e2e_ends ends) {
    return length >= LACONIC_E2E_P05_HEADER && (data[0] | (data[1] << 8)) == p05_crc(data, length, ends);
}

static laconic_e2e_status accept(laconic_e2e_receiver *receiver, uint8_t counter, uint8_t lost_count) {
    receiver->known = true;
    receiver->counter = counter;
    receiver->stray_count = 0;
    receiver->lost = lost_count;
    return lost_count == 0 ? LACONIC_E2E_OK : LACONIC_E2E_OK_SOME_LOST;
}

/* The counter of a refused frame is kept apart from the reference, so that old frames cannot change the reference. */
static laconic_e2e_status stray(laconic_e2e_receiver *receiver, uint8_t counter, uint8_t mask) {
    const bool follows = counter == ((receiver->stray + 1U) & mask);
    receiver->stray_count = (uint8_t)(follows ? receiver->stray_count + 1U : 1U);
    receiver->stray = counter;
    if (receiver->stray_count >= LACONIC_E2E_RESYNC) return accept(receiver, counter, 0);
    return LACONIC_E2E_WRONG_SEQUENCE;
}

/* A refused frame leaves the reference; an accepted one becomes it. */
laconic_e2e_status laconic_e2e_check(laconic_e2e_receiver *receiver, bool crc_is_right, uint8_t counter, uint8_t mask,
                                     uint8_t max_delta) {
    if (!crc_is_right) return LACONIC_E2E_ERROR;
    if (!receiver->known) return accept(receiver, counter, 0);
    const uint8_t delta = (uint8_t)((counter - receiver->counter) & mask);
    if (delta == 0) return LACONIC_E2E_REPEATED;
    if (delta <= max_delta) return accept(receiver, counter, (uint8_t)(delta - 1U));
    return stray(receiver, counter, mask);
}
