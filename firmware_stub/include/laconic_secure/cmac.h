/* AES-128 (FIPS 197) forwards, and its CMAC (RFC 4493, NIST SP 800-38B), in constant time: neither a branch nor an
 * address depends on key or message. There are no tables: eight words hold bit k of all sixteen bytes of a block, and
 * the inverse in GF(2⁸) is arithmetic. */
#ifndef LACONIC_SECURE_CMAC_H
#define LACONIC_SECURE_CMAC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LACONIC_AES_BYTES 16
#define LACONIC_AES_ROUNDS 10

/* Bit i of bit[k] is bit k of byte i. */
typedef struct laconic_aes_planes {
    uint16_t bit[8];
} laconic_aes_planes;

typedef struct laconic_aes_key {
    laconic_aes_planes round[LACONIC_AES_ROUNDS + 1];
} laconic_aes_key;

void laconic_aes_key_of(laconic_aes_key *key, const uint8_t bytes[LACONIC_AES_BYTES]);

/* One block in place. */
void laconic_aes_encrypt(const laconic_aes_key *key, uint8_t block[LACONIC_AES_BYTES]);

/* The key with what its last block is changed by: whole or padded. */
typedef struct laconic_cmac_key {
    laconic_aes_key aes;
    uint8_t whole[LACONIC_AES_BYTES], padded[LACONIC_AES_BYTES];
} laconic_cmac_key;

void laconic_cmac_key_of(laconic_cmac_key *key, const uint8_t bytes[LACONIC_AES_BYTES]);

/* The code of a message of any length; the most significant byte first. */
void laconic_cmac(const laconic_cmac_key *key, const uint8_t *message, size_t length, uint8_t mac[LACONIC_AES_BYTES]);

/* True iff the bytes are the same; takes as long where the first differs as where none does. */
bool laconic_same_bytes(const uint8_t *a, const uint8_t *b, size_t length);

#endif
