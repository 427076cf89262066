/* Codes behind payloads, and how old they are. */
#include "laconic_secure/secoc.h"

#define NUMBER_BYTES 2U
#define FRESHNESS_BYTES 8U

const char *laconic_secoc_text(laconic_secoc_status status) {
    static const char *const texts[] = {"accepted", "wrong key or changed message", "replayed message", "old freshness",
                                        "freshness used up"};
    return (unsigned)status < LACONIC_SECOC_STATUSES ? texts[status] : "unknown";
}

static bool has_code(size_t length, size_t code_bytes) {
    return length <= LACONIC_SECOC_LONGEST && code_bytes <= LACONIC_AES_BYTES;
}

static void code_of(const laconic_cmac_key *key, uint16_t number, uint64_t freshness, const uint8_t *payload,
                    size_t length, uint8_t mac[LACONIC_AES_BYTES]) {
    uint8_t message[NUMBER_BYTES + LACONIC_SECOC_LONGEST + FRESHNESS_BYTES];
    uint8_t *to = message;
    *to++ = (uint8_t)(number >> 8);
    *to++ = (uint8_t)number;
    for (size_t i = 0; i < length; i++) *to++ = payload[i];
    for (unsigned i = 0; i < FRESHNESS_BYTES; i++) *to++ = (uint8_t)(freshness >> (8U * (FRESHNESS_BYTES - 1U - i)));
    laconic_cmac(key, message, NUMBER_BYTES + length + FRESHNESS_BYTES, mac);
}

bool laconic_secoc_seal(const laconic_cmac_key *key, uint16_t number, uint64_t freshness, const uint8_t *payload,
                        size_t length, uint8_t *trailer, size_t code_bytes) {
    uint8_t mac[LACONIC_AES_BYTES];
    if (!has_code(length, code_bytes)) return false;
    code_of(key, number, freshness, payload, length, mac);
    trailer[0] = (uint8_t)freshness;
    for (size_t i = 0; i < code_bytes; i++) trailer[1 + i] = mac[i];
    return true;
}

/* The least value above `last` with these lower bits. */
static uint64_t completed(uint64_t last, uint8_t lower) { return last + 1U + (uint8_t)(lower - (uint8_t)(last + 1U)); }

laconic_secoc_status laconic_secoc_open(const laconic_cmac_key *key, uint16_t number, uint64_t *last,
                                        const uint8_t *payload, size_t length, const uint8_t *trailer,
                                        size_t code_bytes) {
    uint8_t mac[LACONIC_AES_BYTES];
    const uint64_t newer = completed(*last, trailer[0]), older = newer - 256U;
    if (!has_code(length, code_bytes)) return LACONIC_SECOC_WRONG_CODE;
    code_of(key, number, newer, payload, length, mac);
    if (newer > *last && laconic_same_bytes(mac, trailer + 1, code_bytes)) {
        *last = newer;
        return LACONIC_SECOC_OK;
    }
    if (newer < 256U) return LACONIC_SECOC_WRONG_CODE; /* no older one has these bits */
    code_of(key, number, older, payload, length, mac);
    if (!laconic_same_bytes(mac, trailer + 1, code_bytes)) return LACONIC_SECOC_WRONG_CODE;
    return older == *last ? LACONIC_SECOC_REPLAYED : LACONIC_SECOC_OLD;
}
