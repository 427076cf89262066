/* Who may command: messages with a code that only the holders of a key can make, laid out as AUTOSAR SecOC lays them.
 *
 *     payload | freshness, its lower bits | code, its upper bits
 *
 * The code is the CMAC of AES-128 over the message's number (16 bits), the payload and the whole freshness (64 bits),
 * each with its most significant byte first. The freshness of each message of one number is above that of the one
 * before; a receiver completes the bits that are not sent with the nearest value above the last accepted one.
 *
 *     CLASSIC   8 and 24 bits, SecOC's profile 1: of a frame of CAN, 4 of 8 bytes stay
 *     FD        8 and 56 bits: of a frame of CAN FD, 56 of 64 bytes stay
 *     APART     8 and 48 bits in a frame of their own (gate.h), where a frame has no room
 *
 * Whoever forges a code without the key is right once in 2²⁴, 2⁵⁶ or 2⁴⁸ messages. Payloads are not encrypted. */
#ifndef LACONIC_SECURE_SECOC_H
#define LACONIC_SECURE_SECOC_H

#include "laconic_secure/cmac.h"

#define LACONIC_SECOC_LONGEST 64 /* bytes of a payload */

/* Bytes of the code; that of the freshness is one. */
#define LACONIC_SECOC_CLASSIC 3U
#define LACONIC_SECOC_FD 7U
#define LACONIC_SECOC_APART 6U

typedef enum laconic_secoc_status {
    LACONIC_SECOC_OK = 0,
    LACONIC_SECOC_WRONG_CODE, /* another key, a changed payload, or more than 255 messages missing */
    LACONIC_SECOC_REPLAYED,   /* right, with the freshness of the last accepted message             */
    LACONIC_SECOC_OLD,        /* right, with the freshness of one of the 255 before it              */
    LACONIC_SECOC_SPENT,      /* right, beyond the last freshness of a nonce (gate.h)               */
    LACONIC_SECOC_STATUSES
} laconic_secoc_status;

/* "accepted", "wrong key or changed message" … */
const char *laconic_secoc_text(laconic_secoc_status status);

/* Writes one byte of freshness and `code_bytes` (at most 16) of the code. Returns false, and writes nothing, iff there
 * are to be more, or the payload's `length` is above LACONIC_SECOC_LONGEST. */
bool laconic_secoc_seal(const laconic_cmac_key *key, uint16_t number, uint64_t freshness, const uint8_t *payload,
                        size_t length, uint8_t *trailer, size_t code_bytes);

/* OK iff the trailer belongs to the payload and is fresh; then, and only then, *last becomes its freshness. No trailer
 * belongs to what laconic_secoc_seal() refuses. */
laconic_secoc_status laconic_secoc_open(const laconic_cmac_key *key, uint16_t number, uint64_t *last,
                                        const uint8_t *payload, size_t length, const uint8_t *trailer,
                                        size_t code_bytes);

#endif
