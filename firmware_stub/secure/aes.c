/* AES-128 on bit planes: ShiftRows and MixColumns are rotations of planes, SubBytes is arithmetic in GF(2⁸) on sixteen
 * bytes at once. */
#include "laconic_secure/cmac.h"

typedef laconic_aes_planes planes;

/* Byte i stands in row i modulo 4 of column i/4, so a column is four neighbouring bits of a plane. */
#define ROW_0 0x1111U

static planes planes_of(const uint8_t bytes[LACONIC_AES_BYTES]) {
    uint32_t a = 0, b = 0, c = 0, d = 0; /* two planes each, the upper one in the upper half */
    for (unsigned i = 0; i < LACONIC_AES_BYTES; i++) {
        const uint32_t byte = bytes[i];
        a |= ((byte & 1U) | (byte & 2U) << 15) << i;
        b |= ((byte >> 2 & 1U) | (byte & 8U) << 13) << i;
        c |= ((byte >> 4 & 1U) | (byte & 32U) << 11) << i;
        d |= ((byte >> 6 & 1U) | (byte & 128U) << 9) << i;
    }
    const planes p = {{(uint16_t)a, (uint16_t)(a >> 16), (uint16_t)b, (uint16_t)(b >> 16), (uint16_t)c,
                       (uint16_t)(c >> 16), (uint16_t)d, (uint16_t)(d >> 16)}};
    return p;
}

static void bytes_of(uint8_t bytes[LACONIC_AES_BYTES], const planes *p) {
    const uint16_t *bit = p->bit;
    for (unsigned i = 0; i < LACONIC_AES_BYTES; i++) {
        const unsigned low =
            (bit[0] >> i & 1U) | (bit[1] >> i & 1U) << 1 | (bit[2] >> i & 1U) << 2 | (bit[3] >> i & 1U) << 3;
        const unsigned high =
            (bit[4] >> i & 1U) | (bit[5] >> i & 1U) << 1 | (bit[6] >> i & 1U) << 2 | (bit[7] >> i & 1U) << 3;
        bytes[i] = (uint8_t)(low | high << 4);
    }
}

static void add(planes *p, const planes *other) {
    for (unsigned k = 0; k < 8; k++) p->bit[k] ^= other->bit[k];
}

/* GF(2⁸) as pairs over GF(2⁴): high·z + low with z² = z + N, in which an inverse takes five small products instead of
 * four large ones. GF(2⁴) is modulo y⁴ + y + 1, N = y³ + y². The maps between
 * both send x to a root of AES's polynomial there. Of the eight roots and all N, this pair's maps have the fewest
 * ones. */
typedef struct nibbles {
    uint32_t a, b, c, d; /* of 1, y, y², y³ */
} nibbles;

static inline nibbles plus(nibbles p, nibbles q) {
    const nibbles sum = {p.a ^ q.a, p.b ^ q.b, p.c ^ q.c, p.d ^ q.d};
    return sum;
}

/* y⁴ = y + 1, y⁵ = y² + y, y⁶ = y³ + y². */
static inline nibbles times(nibbles p, nibbles q) {
    const uint32_t y4 = (p.b & q.d) ^ (p.c & q.c) ^ (p.d & q.b), y5 = (p.c & q.d) ^ (p.d & q.c), y6 = p.d & q.d;
    const nibbles product = {(p.a & q.a) ^ y4, (p.a & q.b) ^ (p.b & q.a) ^ y4 ^ y5,
                             (p.a & q.c) ^ (p.b & q.b) ^ (p.c & q.a) ^ y5 ^ y6,
                             (p.a & q.d) ^ (p.b & q.c) ^ (p.c & q.b) ^ (p.d & q.a) ^ y6};
    return product;
}

static inline nibbles squared(nibbles p) {
    const nibbles square = {p.a ^ p.c, p.c, p.b ^ p.d, p.d};
    return square;
}

/* N p². */
static inline nibbles squared_by_n(nibbles p) {
    const nibbles product = {p.b ^ p.c ^ p.d, p.c ^ p.d, p.a ^ p.b ^ p.c ^ p.d, p.a ^ p.d};
    return product;
}

/* p¹⁴ = p²·p⁴·p⁸, which is 1/p, and 0 for 0. */
static inline nibbles inverse(nibbles p) {
    const nibbles p2 = squared(p), p4 = squared(p2);
    return times(times(p2, p4), squared(p4));
}

/* The inverse, then the affine map of FIPS 197, 5.1.1. */
static void substitute(planes *p) {
    const uint32_t x0 = p->bit[0], x1 = p->bit[1], x2 = p->bit[2], x3 = p->bit[3];
    const uint32_t x4 = p->bit[4], x5 = p->bit[5], x6 = p->bit[6], x7 = p->bit[7];
    const uint32_t x17 = x1 ^ x7, x57 = x5 ^ x7, x167 = x17 ^ x6;
    const nibbles low = {x0 ^ x2, x2 ^ x5 ^ x167, x3, x3 ^ x167}, high = {x1 ^ x57, x2 ^ x3, x4 ^ x167, x57};
    const nibbles norm = plus(squared_by_n(high), times(low, plus(high, low)));
    const nibbles inverted = inverse(norm), h = times(high, inverted), l = times(plus(high, low), inverted);
    const uint32_t ab = l.a ^ l.b, cd = l.c ^ l.d, gh = h.c ^ h.d;
    p->bit[0] = (uint16_t)~(ab ^ cd ^ h.a ^ gh);
    p->bit[1] = (uint16_t)~ab;
    p->bit[2] = (uint16_t)(l.a ^ cd);
    p->bit[3] = (uint16_t)(ab ^ cd ^ h.a ^ h.b);
    p->bit[4] = (uint16_t)(l.a ^ l.d ^ h.a ^ gh);
    p->bit[5] = (uint16_t)~(l.b ^ l.c ^ h.a ^ gh);
    p->bit[6] = (uint16_t)~(h.a ^ h.b ^ h.c);
    p->bit[7] = (uint16_t)(l.b ^ cd ^ h.a ^ h.b ^ gh);
}

/* Row r moves r columns to the left. */
static void shift_rows(planes *p) {
    for (unsigned k = 0; k < 8; k++) {
        const uint32_t twice = p->bit[k] * 0x10001U; /* so that a turn is a shift */
        p->bit[k] = (uint16_t)((twice & ROW_0) | (twice >> 4 & ROW_0 << 1) | (twice >> 8 & ROW_0 << 2) |
                               (twice >> 12 & ROW_0 << 3));
    }
}

/* Each byte's neighbour below it in its column, and the one two below. */
static unsigned below(unsigned plane) { return (plane >> 1 & 0x7777U) | (plane << 3 & 0x8888U); }
static unsigned two_below(unsigned plane) { return (plane >> 2 & 0x3333U) | (plane << 2 & 0xCCCCU); }

/* 2a + 3b + c + d = 2(a + b) + b + (c + d), with b, c, d below a. */
static void mix_columns(planes *p) {
    unsigned pair[8];
    for (unsigned k = 0; k < 8; k++) pair[k] = p->bit[k] ^ below(p->bit[k]);
    for (unsigned k = 0; k < 8; k++) {
        const unsigned doubled = (k > 0 ? pair[k - 1] : 0U) ^ (k == 0 || k == 1 || k == 3 || k == 4 ? pair[7] : 0U);
        p->bit[k] = (uint16_t)(doubled ^ below(p->bit[k]) ^ two_below(pair[k]));
    }
}

/* Each round key's first word is the one before it, turned, substituted and with a constant (FIPS 197, 5.2). */
void laconic_aes_key_of(laconic_aes_key *key, const uint8_t bytes[LACONIC_AES_BYTES]) {
    uint8_t now[LACONIC_AES_BYTES], s[LACONIC_AES_BYTES];
    unsigned constant = 1;
    for (unsigned i = 0; i < LACONIC_AES_BYTES; i++) now[i] = bytes[i];
    key->round[0] = planes_of(now);
    for (unsigned round = 1; round <= LACONIC_AES_ROUNDS; round++) {
        planes substituted = key->round[round - 1];
        substitute(&substituted);
        bytes_of(s, &substituted);
        for (unsigned i = 0; i < 4; i++) now[i] = (uint8_t)(now[i] ^ s[12 + (i + 1) % 4] ^ (i == 0 ? constant : 0U));
        for (unsigned i = 4; i < LACONIC_AES_BYTES; i++) now[i] ^= now[i - 4];
        key->round[round] = planes_of(now);
        constant = (constant << 1 ^ (0x11BU & (0U - (constant >> 7)))) & 0xFFU;
    }
}

void laconic_aes_encrypt(const laconic_aes_key *key, uint8_t block[LACONIC_AES_BYTES]) {
    planes p = planes_of(block);
    add(&p, &key->round[0]);
    for (unsigned round = 1; round < LACONIC_AES_ROUNDS; round++) {
        substitute(&p);
        shift_rows(&p);
        mix_columns(&p);
        add(&p, &key->round[round]);
    }
    substitute(&p);
    shift_rows(&p);
    add(&p, &key->round[LACONIC_AES_ROUNDS]);
    bytes_of(block, &p);
}
