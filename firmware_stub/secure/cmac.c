/* CMAC of AES-128. */
#include "laconic_secure/cmac.h"

/* Times x in GF(2¹²⁸) modulo x¹²⁸ + x⁷ + x² + x + 1, the most significant byte first. */
static void doubled(uint8_t to[LACONIC_AES_BYTES], const uint8_t from[LACONIC_AES_BYTES]) {
    const unsigned carry = 0U - ((unsigned)from[0] >> 7);
    for (size_t i = 0; i < LACONIC_AES_BYTES; i++) {
        const unsigned next = i + 1 < LACONIC_AES_BYTES ? (unsigned)from[i + 1] >> 7 : carry & 0x87U;
        to[i] = (uint8_t)((unsigned)from[i] << 1 ^ next);
    }
}

void laconic_cmac_key_of(laconic_cmac_key *key, const uint8_t bytes[LACONIC_AES_BYTES]) {
    uint8_t zero[LACONIC_AES_BYTES] = {0};
    laconic_aes_key_of(&key->aes, bytes);
    laconic_aes_encrypt(&key->aes, zero);
    doubled(key->whole, zero);
    doubled(key->padded, key->whole);
}

static void absorb(uint8_t mac[LACONIC_AES_BYTES], const uint8_t *bytes, size_t count) {
    for (size_t i = 0; i < count; i++) mac[i] ^= bytes[i];
}

void laconic_cmac(const laconic_cmac_key *key, const uint8_t *message, size_t length, uint8_t mac[LACONIC_AES_BYTES]) {
    for (size_t i = 0; i < LACONIC_AES_BYTES; i++) mac[i] = 0;
    for (; length > LACONIC_AES_BYTES; length -= LACONIC_AES_BYTES) {
        absorb(mac, message, LACONIC_AES_BYTES);
        laconic_aes_encrypt(&key->aes, mac);
        message += LACONIC_AES_BYTES;
    }
    absorb(mac, message, length);
    if (length < LACONIC_AES_BYTES) mac[length] ^= 0x80U;
    absorb(mac, length < LACONIC_AES_BYTES ? key->padded : key->whole, LACONIC_AES_BYTES);
    laconic_aes_encrypt(&key->aes, mac);
}

bool laconic_same_bytes(const uint8_t *a, const uint8_t *b, size_t length) {
    unsigned differs = 0;
    for (size_t i = 0; i < length; i++) differs |= (unsigned)a[i] ^ b[i];
    return differs == 0;
}
