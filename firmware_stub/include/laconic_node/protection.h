/* Protection against recorded and delayed frames: the CRC of the rig's frames depends on a key and on a count, of
 * which a frame contains only the lower bits. It protects against stale traffic (queues, gateways, loggers), not
 * against an attacker: the algorithm is public, and the key follows from numbers that the bus transmits unencrypted.
 *
 *     nonce      drawn by the node, sent in CHALLENGE                          keys OPEN
 *     session    drawn by the rig, sent in OPEN; key = mix(session, nonce)     keys CONTROL, PARAMETER, COMMIT, SELECT
 *     run key    mix(key, count of the START + 32)                             keys the frames that move the vehicle
 *
 * hash = mix(mix(key, offset of the identifier), count) chooses where the CRC starts and which DataID it ends with:
 *
 *     classic    CRC start: bits 0 to 7; DataID: entry number bits 8 to 11 of the list
 *     CAN FD     CRC start: bits 0 to 15; DataID: that of the frame plus bits 16 to 31, modulo 2^16
 *
 * Frames of the node and HELLO are plain AUTOSAR profile 22 and 5, so that any monitor can check them. */
#ifndef LACONIC_NODE_PROTECTION_H
#define LACONIC_NODE_PROTECTION_H

#include <stdbool.h>
#include <stdint.h>

/* Every bit of the result depends on every bit of a and b. For a fixed a, different b give different results, and for a
 * fixed b different a do. mix(0, 0) = 0x42F6FD56. */
uint32_t laconic_mix(uint32_t a, uint32_t b);

/* Key of a run, from the key of the session and the count of the START that began the run. */
uint32_t laconic_run_key(uint32_t key, uint32_t start_count);

/* Write counter and CRC into `data`, which has the length of the frame. `offset` is that of the identifier and must
 * be one of laconic.dbc. The counter is the lower bits of `count` (4 classic, 8 FD). */
void laconic_protect_plain(uint8_t offset, uint8_t *data, uint8_t counter);
void laconic_protect_keyed(uint8_t offset, uint8_t *data, uint32_t key, uint32_t count);

bool laconic_plain_is_right(uint8_t offset, const uint8_t *data);
bool laconic_keyed_is_right(uint8_t offset, const uint8_t *data, uint32_t key, uint32_t count);

/* The counter in a frame. */
uint8_t laconic_counter_of(uint8_t offset, const uint8_t *data);

#endif
