/* Protection of frames after AUTOSAR E2E: profile 2/22 for classic frames, profile 5 for CAN FD.
 *
 * Profile 22   byte 0 CRC-8H2F, byte 1 lower half: counter 0 … 15 (the upper half is payload). The CRC runs over
 *              bytes 1 … and then one byte of the DataID list, chosen by the counter.
 * Profile 5    bytes 0–1 CRC-16 (low byte first), byte 2 counter 0 … 255. The CRC runs over bytes 2 … and then
 *              the DataID, low byte first.
 *
 * The run time of a check depends only on the length, not on the content of the frame. */
#ifndef LACONIC_NODE_E2E_H
#define LACONIC_NODE_E2E_H

#include <stdbool.h>
#include <stdint.h>

#define LACONIC_E2E_P22_HEADER 2
#define LACONIC_E2E_P22_COUNTER_MASK 15U
#define LACONIC_E2E_P05_HEADER 3
#define LACONIC_E2E_P05_COUNTER_MASK 255U

/* What the CRC begins and ends with: its start value, and the DataID that follows the payload. */
typedef struct laconic_e2e_ends {
    uint16_t start, data_id; /* profile 22: below 256 */
} laconic_e2e_ends;

/* Start values of the profiles; keyed frames have others (protection.h). */
#define LACONIC_E2E_P22_START 0xFFU
#define LACONIC_E2E_P05_START 0xFFFFU

void laconic_e2e_p22_protect(uint8_t *data, uint8_t length, laconic_e2e_ends ends, uint8_t counter);
bool laconic_e2e_p22_crc_is_right(const uint8_t *data, uint8_t length, laconic_e2e_ends ends);

void laconic_e2e_p05_protect(uint8_t *data, uint8_t length, laconic_e2e_ends ends, uint8_t counter);
bool laconic_e2e_p05_crc_is_right(const uint8_t *data, uint8_t length, laconic_e2e_ends ends);

typedef enum laconic_e2e_status {
    LACONIC_E2E_OK = 0,
    LACONIC_E2E_OK_SOME_LOST,   /* right, and fewer than max_delta frames are missing before it   */
    LACONIC_E2E_REPEATED,       /* right, with the counter of the last accepted frame             */
    LACONIC_E2E_WRONG_SEQUENCE, /* right, with a counter ahead by more than max_delta             */
    LACONIC_E2E_ERROR,          /* CRC wrong                                                      */
    LACONIC_E2E_NO_NEW_DATA
} laconic_e2e_status;

/* The rig's receiver of one kind of plain frame. All zero: nothing received yet, the first right frame is OK.
 * A refused frame never changes `counter`. When LACONIC_E2E_RESYNC refused frames in a row have a right CRC and
 * consecutive counters, the last of them is OK and its counter the new reference. */
#define LACONIC_E2E_RESYNC 3

typedef struct laconic_e2e_receiver {
    bool known;          /* counter holds that of an accepted frame              */
    uint8_t counter;     /* of the last accepted frame                           */
    uint8_t stray;       /* of the last frame with LACONIC_E2E_WRONG_SEQUENCE    */
    uint8_t stray_count; /* how many of these were consecutive; 0: none          */
    uint8_t lost;        /* frames missing before the last accepted one          */
} laconic_e2e_receiver;

/* To be called for each frame received. `mask`: LACONIC_E2E_Pxx_COUNTER_MASK. */
laconic_e2e_status laconic_e2e_check(laconic_e2e_receiver *receiver, bool crc_is_right, uint8_t counter, uint8_t mask,
                                     uint8_t max_delta);

static inline bool laconic_e2e_accepts(laconic_e2e_status status) {
    return status == LACONIC_E2E_OK || status == LACONIC_E2E_OK_SOME_LOST;
}

#endif
