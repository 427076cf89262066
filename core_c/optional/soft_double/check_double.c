/* Does double precision round here as IEEE 754 prescribes? Compile this file alone, with the options of your program,
 * and run it where the program runs:
 *
 *     check_double() returns how many operations are wrong, and calls tell() with a line for each wrong result that is
 *     known beforehand, for each operation whose random results have another hash than they should, and a last one.
 *     main() calls it with puts(). -DCHECK_DOUBLE_MAIN=0 leaves main() and <stdio.h> out.
 *
 * The answers were computed in hardware, and each host that runs the tests of Laconic computes them again. It takes
 * some 50 million instructions without double precision in hardware, half a kilobyte of stack and no heap. */
#include <stdbool.h>
#include <stdint.h>

#ifndef CHECK_DOUBLE_MAIN
#define CHECK_DOUBLE_MAIN 1
#endif

int check_double(void (*tell)(const char *line));

#define ROUNDS 20000 /* random pairs of operands; the hashes of `operations` belong to it */
#define NOT_A_NUMBER ((uint64_t)0x7FF8 << 48)
#define FRACTION (((uint64_t)1 << 52) - 1)

typedef union word {
    uint64_t bits;
    double number;
} word;

static double number(uint64_t bits) {
    word taken;
    taken.bits = bits;
    return taken.number;
}

/* Of a NaN nothing is prescribed but that it is none. */
static uint64_t bits(double number) {
    word given;
    given.number = number;
    return (given.bits << 1) > ((uint64_t)0x7FF << 53) ? NOT_A_NUMBER : given.bits;
}

static float single(uint64_t lower) {
    union {
        uint32_t bits;
        float number;
    } taken;
    taken.bits = (uint32_t)lower;
    return taken.number;
}

/* The same number in magnitude below 2^places, so that its conversion to an integer is defined. */
static double within(uint64_t a, uint64_t places) {
    const uint64_t exponent = (a >> 52 & 0x7FF) % (places + 2) + 1021;
    return number((a & ~((uint64_t)0x7FF << 52)) | exponent << 52);
}

static uint64_t add(uint64_t a, uint64_t b) { return bits(number(a) + number(b)); }
static uint64_t subtract(uint64_t a, uint64_t b) { return bits(number(a) - number(b)); }
static uint64_t multiply(uint64_t a, uint64_t b) { return bits(number(a) * number(b)); }
static uint64_t divide(uint64_t a, uint64_t b) { return bits(number(a) / number(b)); }

static uint64_t compare(uint64_t a, uint64_t b) {
    const double x = number(a), y = number(b);
    return (uint64_t)((x < y) | (x <= y) << 1 | (x > y) << 2 | (x >= y) << 3 | (x == y) << 4 | (x != y) << 5);
}

static uint64_t to_single(uint64_t a, uint64_t b) {
    union {
        uint32_t bits;
        float number;
    } given;
    (void)b;
    given.number = (float)number(a);
    return (given.bits << 1) > 0xFF000000U ? 0x7FC00000U : given.bits;
}

static uint64_t of_single(uint64_t a, uint64_t b) { return (void)b, bits((double)single(a >> 20)); }
static uint64_t to_int32(uint64_t a, uint64_t b) { return (void)b, (uint64_t)(int64_t)(int32_t)within(a, 31); }
static uint64_t to_uint32(uint64_t a, uint64_t b) { return (void)b, (uint32_t)within(a << 1 >> 1, 32); }
static uint64_t to_int64(uint64_t a, uint64_t b) { return (void)b, (uint64_t)(int64_t)within(a, 63); }
static uint64_t to_uint64(uint64_t a, uint64_t b) { return (void)b, (uint64_t)within(a << 1 >> 1, 64); }
static uint64_t of_int32(uint64_t a, uint64_t b) { return (void)b, bits((double)(int32_t)(uint32_t)(a >> 20)); }
static uint64_t of_uint32(uint64_t a, uint64_t b) { return (void)b, bits((double)(uint32_t)(a >> 20)); }
static uint64_t of_int64(uint64_t a, uint64_t b) { return bits((double)((int64_t)a >> (b & 31))); }
static uint64_t of_uint64(uint64_t a, uint64_t b) { return bits((double)(a >> (b & 31))); }

typedef struct operation {
    const char *name;
    uint64_t (*result)(uint64_t a, uint64_t b);
    uint64_t hash; /* of the results of ROUNDS random pairs */
} operation;

enum { ADD, SUBTRACT, MULTIPLY, DIVIDE, COMPARE, TO_SINGLE };

static const operation operations[] = {
    {"a + b", add, 0xf4784b81feece72f},
    {"a - b", subtract, 0x872ebf894fbb75d2},
    {"a * b", multiply, 0x7d9e00c7fa452df0},
    {"a / b", divide, 0x6c2a3f0e381d3369},
    {"comparison", compare, 0x016d3b81bc667879},
    {"to float", to_single, 0x522ca51f3ff8734b},
    {"from float", of_single, 0x34ba0e49851500c2},
    {"to int32_t", to_int32, 0x8a7f4753b88f27df},
    {"to uint32_t", to_uint32, 0x11888c0385fcadaa},
    {"to int64_t", to_int64, 0xb4400481dd9c3d73},
    {"to uint64_t", to_uint64, 0x5701755ee597ebcd},
    {"from int32_t", of_int32, 0x4d5dab59035363ab},
    {"from uint32_t", of_uint32, 0x3a91eab34ef0d9a6},
    {"from int64_t", of_int64, 0x0d7c7f71a76d407f},
    {"from uint64_t", of_uint64, 0xb8c725d1442314da},
};
enum { OPERATIONS = sizeof operations / sizeof operations[0] };

/* Hard cases. The first four are those that libgcc's assembly for Arm rounds wrongly. */
static const struct known {
    int operation;
    uint64_t a, b, result;
} known[] = {
    {SUBTRACT, 0x3ff0000000000000, 0x3de0000000000001,
     0x3feffffffff00000}, /* 1 - 2^-33 (1 + 2^-52): smallest example */
    {SUBTRACT, 0x3ff0000000000000, 0x3de31628704d6200, 0x3fefffffffece9d8}, /* found in a heading */
    {SUBTRACT, 0x3ff0000000080000, 0x3de0000000000001, 0x3ff0000000000000}, /* a need not be a power of two */
    {ADD, 0xbff0000000000000, 0x3de00000ffffffff, 0xbfefffffffefffff},      /* the other sign, other bits */
    {SUBTRACT, 0x3ff0000000000000, 0x3c90000000000000, 0x3ff0000000000000}, /* 1 - 2^-54: a tie below 1 */
    {SUBTRACT, 0x3ff0000000000000, 0x3c90000000000001, 0x3fefffffffffffff},
    {ADD, 0x3ff0000000000000, 0x3ca0000000000000, 0x3ff0000000000000}, /* 1 + 2^-53: ties to even */
    {ADD, 0x3ff0000000000001, 0x3ca0000000000000, 0x3ff0000000000002},
    {ADD, 0x3ff0000000000000, 0x3ca0000000000001, 0x3ff0000000000001},
    {ADD, 0x3fffffffffffffff, 0x3ca0000000000000, 0x4000000000000000}, /* the rounding carries into the exponent */
    {ADD, 0x7fefffffffffffff, 0x7c90000000000000, 0x7ff0000000000000}, /* and into infinity */
    {ADD, 0x7fefffffffffffff, 0x7c8fffffffffffff, 0x7fefffffffffffff},
    {SUBTRACT, 0x0010000000000000, 0x0000000000000001, 0x000fffffffffffff}, /* subnormal numbers */
    {ADD, 0x000fffffffffffff, 0x0000000000000001, 0x0010000000000000},
    {ADD, 0x8000000000000000, 0x8000000000000000, 0x8000000000000000}, /* -0 - 0 */
    {SUBTRACT, 0x3ff0000000000000, 0x3ff0000000000000, 0x0000000000000000},
    {SUBTRACT, 0x7ff0000000000000, 0x7ff0000000000000, NOT_A_NUMBER},
    {MULTIPLY, 0x3ff0000000000001, 0x3fefffffffffffff, 0x3ff0000000000000},
    {MULTIPLY, 0x0010000000000001, 0x3fe0000000000000, 0x0008000000000000}, /* a tie among subnormal numbers */
    {MULTIPLY, 0x001fffffffffffff, 0x3fe0000000000000, 0x0010000000000000}, /* that rounds to a normal one */
    {MULTIPLY, 0x0000000000000001, 0x3fe0000000000000, 0x0000000000000000},
    {DIVIDE, 0x3ff0000000000000, 0x4008000000000000, 0x3fd5555555555555},
    {DIVIDE, 0x0000000000000003, 0x4000000000000000, 0x0000000000000002},
    {DIVIDE, 0x3ff0000000000000, 0x8000000000000000, 0xfff0000000000000},
    {COMPARE, 0x8000000000000000, 0x0000000000000000, 0x1a},
    {COMPARE, NOT_A_NUMBER, NOT_A_NUMBER, 0x20},
    {TO_SINGLE, 0x3ff0000010000000, 0, 0x3f800000}, /* ties to even */
    {TO_SINGLE, 0x3ff0000030000000, 0, 0x3f800002},
    {TO_SINGLE, 0x36a0000000000001, 0, 0x00000001}, /* the smallest subnormal number */
    {TO_SINGLE, 0x47efffffefffffff, 0, 0x7f7fffff},
    {TO_SINGLE, 0x47efffffF0000000, 0, 0x7f800000},
};
enum { KNOWN = sizeof known / sizeof known[0] };

static char *text_of(char *end, const char *text) {
    while (*text != 0) *end++ = *text++;
    *end = 0;
    return end;
}

static char *hex_of(char *end, uint64_t value) {
    for (int shift = 60; shift >= 0; shift -= 4) *end++ = "0123456789abcdef"[value >> shift & 15];
    *end = 0;
    return end;
}

static void tell_result(void (*tell)(const char *), const struct known *one, uint64_t found) {
    char line[128];
    char *end = text_of(line, operations[one->operation].name);
    end = hex_of(text_of(end, " with a = "), one->a);
    end = hex_of(text_of(end, ", b = "), one->b);
    end = hex_of(text_of(end, " gives "), found);
    hex_of(text_of(end, ", not "), one->result);
    tell(line);
}

static void tell_hash(void (*tell)(const char *), const operation *one, uint64_t found) {
    char line[128];
    char *end = text_of(text_of(line, one->name), ": random results have the hash ");
    hex_of(text_of(hex_of(end, found), ", not "), one->hash);
    tell(line);
}

static uint64_t next(uint64_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state * 0x2545F4914F6CDD1DU;
}

/* Random bits, and those that rounding is sensitive to: few ones, long rows of ones, the lower or the upper half. */
static uint64_t fraction(uint64_t *state) {
    const uint64_t chosen = next(state) >> 58, random = next(state) & FRACTION;
    switch (chosen & 7) {
    case 0: return random >> 20 & (((uint64_t)1 << (chosen >> 3) * 7) - 1);
    case 1: return FRACTION ^ (random & 0xFF);
    case 2: return (uint64_t)1 << random % 52;
    case 3: return FRACTION >> random % 52;
    case 4: return random & ((uint64_t)0xFFFFF << 32);
    case 5: return random & 0xFFFFFFFF;
    default: return random;
    }
}

/* Exponents up to 70 apart; one pair of eight near the ends of the range, or anywhere. */
static void draw(uint64_t *state, uint64_t *a, uint64_t *b) {
    const uint64_t chosen = next(state) >> 40;
    const uint64_t exponent = (chosen & 7) != 0 ? 1023 : (chosen & 8) != 0 ? chosen >> 4 & 0x7FF : chosen >> 4 & 31;
    const uint64_t apart = (chosen >> 16) % 71, other = exponent > apart ? exponent - apart : apart;
    *a = fraction(state) | exponent << 52 | (next(state) & (uint64_t)1 << 63);
    *b = fraction(state) | other << 52 | (next(state) & (uint64_t)1 << 63);
}

static uint64_t hash_of(const operation *one) {
    uint64_t state = 88172645463325252U, hash = 1469598103934665603U, a, b;
    for (int k = 0; k < ROUNDS; k++) {
        draw(&state, &a, &b);
        hash = (hash ^ one->result(a, b)) * 1099511628211U;
        hash ^= hash >> 29;
        hash = (hash ^ one->result(b, a)) * 1099511628211U;
    }
    return hash;
}

int check_double(void (*tell)(const char *line)) {
    int wrong = 0;
    for (int o = 0; o < OPERATIONS; o++) {
        bool is_wrong = false;
        for (int k = 0; k < KNOWN; k++) {
            if (known[k].operation != o) continue;
            const uint64_t found = operations[o].result(known[k].a, known[k].b);
            if (found == known[k].result) continue;
            is_wrong = true;
            tell_result(tell, &known[k], found);
        }
        const uint64_t hash = hash_of(&operations[o]);
        if (hash != operations[o].hash) {
            is_wrong = true;
            tell_hash(tell, &operations[o], hash);
        }
        wrong += is_wrong;
    }
    tell(wrong == 0 ? "double: sound" : "double: WRONG");
    return wrong;
}

#if CHECK_DOUBLE_MAIN
#include <stdio.h>

static void print(const char *line) { puts(line); }

int main(void) { return check_double(print) == 0 ? 0 : 1; }
#endif
