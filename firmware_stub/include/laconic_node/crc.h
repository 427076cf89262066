/* The three checksums of the wire contract. Their run time depends only on the length. */
#ifndef LACONIC_NODE_CRC_H
#define LACONIC_NODE_CRC_H

#include <stddef.h>
#include <stdint.h>

/* Each takes the value so far and returns the new one; begin with _START, end with ^ _END. */

#define LACONIC_CRC8_START 0xFFU /* CRC-8H2F: polynomial 0x2F */
#define LACONIC_CRC8_END 0xFFU
uint8_t laconic_crc8(uint8_t crc, const uint8_t *bytes, size_t count);

#define LACONIC_CRC16_START 0xFFFFU /* CRC-16/CCITT-FALSE: polynomial 0x1021 */
#define LACONIC_CRC16_END 0U
uint16_t laconic_crc16(uint16_t crc, const uint8_t *bytes, size_t count);

#define LACONIC_CRC32_START 0xFFFFFFFFU /* CRC-32 of Ethernet: polynomial 0x04C11DB7, reflected */
#define LACONIC_CRC32_END 0xFFFFFFFFU
uint32_t laconic_crc32(uint32_t crc, const uint8_t *bytes, size_t count);

#endif
