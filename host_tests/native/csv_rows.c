/* Rows of numbers as CSV text: of each number the shortest digits that read back as the same number, of several such
 * the nearest, written as Python's repr writes them.
 *
 * After R. Giulietti, "The Schubfach way to render doubles" (2020). A double is c·2^q; every decimal within half a unit
 * of c reads back as it. Scaled by 10^-k, with k such that this interval is from 1 to 10 wide, the shortest decimals in
 * it are whole numbers near the scaled c, so comparing three of them decides. Products with powers of ten are taken to
 * 64 bits and a sticky bit for what is lost ("rounded to odd"), which keeps every comparison exact. */
#include "csv_rows.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_POWER (-292) /* the first of `powers`: 10^-292 */
#define HIDDEN_BIT (UINT64_C(1) << 52)
#define FRACTION_BITS (HIDDEN_BIT - 1)

typedef struct decimal { /* digits · 10^exponent */
    uint64_t digits;
    int exponent;
} decimal;

/* The upper 64 bits of a 128-bit product; *low: the others. */
static uint64_t product(uint64_t a, uint64_t b, uint64_t *low) {
    const uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    const uint64_t middle = a1 * b0 + (a0 * b0 >> 32), other = a0 * b1 + (uint32_t)middle;
    *low = a * b;
    return a1 * b1 + (middle >> 32) + (other >> 32);
}

/* g·c / 2^128 with its last bit set where anything was lost; g in two halves, the upper first. */
static uint64_t scaled(const uint64_t g[2], uint64_t c) {
    uint64_t lowest, low;
    const uint64_t carry = product(g[1], c, &lowest), high = product(g[0], c, &low);
    const uint64_t sum = low + carry;
    return (high + (sum < low)) | (sum > 1);
}

static int floor_shift(int32_t value, int bits) {
    return value >= 0 ? value >> bits : -((-value + (1 << bits) - 1) >> bits);
}

/* Of a positive normal double. */
static decimal shortest(uint64_t fraction, int exponent_bits, const uint64_t *powers) {
    const uint64_t c = HIDDEN_BIT | fraction;
    const int q = exponent_bits - 1075;
    const bool closer_below = fraction == 0 && exponent_bits > 1; /* the next smaller double is half as far */
    const int k = floor_shift(q * 1262611 - (closer_below ? 524031 : 0), 22); /* ⌊log10 of the interval's width⌋ */
    const int shift = q + floor_shift(-k * 1741647, 19) + 1;                  /* ⌊log2 10^-k⌋ */
    const uint64_t *g = powers + 2 * (-k - LEAST_POWER);
    const uint64_t odd = c & 1; /* the borders belong to an even c */
    const uint64_t lower = scaled(g, (4 * c - 2 + closer_below) << shift) + odd;
    const uint64_t value = scaled(g, 4 * c << shift);
    const uint64_t upper = scaled(g, (4 * c + 2) << shift) - odd;
    const uint64_t whole = value / 4, tens = whole / 10, middle = 4 * whole + 2;
    bool below_fits = lower <= 40 * tens, above_fits = 40 * tens + 40 <= upper;
    decimal found = {tens + above_fits, k + 1};
    if (below_fits != above_fits) return found; /* a digit less, and only one such */
    below_fits = lower <= 4 * whole;
    above_fits = 4 * whole + 4 <= upper;
    found.exponent = k;
    found.digits = whole;
    if (below_fits != above_fits)
        found.digits += above_fits;
    else
        found.digits += value > middle || (value == middle && (whole & 1) != 0);
    return found;
}

/* A subnormal double has few digits: tried from one on. */
static decimal shortest_of_small(double value) {
    decimal found = {0, 0};
    char text[40];
    int digits;
    for (digits = 0; digits < 17; digits++) {
        snprintf(text, sizeof text, "%.*e", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    for (digits = 0; text[digits] != 'e'; digits++)
        if (text[digits] != '.') found.digits = 10 * found.digits + (uint64_t)(text[digits] - '0');
    found.exponent = atoi(text + digits + 1) - (digits > 1 ? digits - 2 : 0);
    return found;
}

static int digits_of(char digit[20], uint64_t number) {
    char reversed[20];
    int count = 0, k;
    do reversed[count++] = (char)('0' + number % 10);
    while ((number /= 10) != 0);
    for (k = 0; k < count; k++) digit[k] = reversed[count - 1 - k];
    return count;
}

static char *repeat(char *to, char what, int count) {
    while (count-- > 0) *to++ = what;
    return to;
}

static char *copy(char *to, const char *from, int count) {
    memcpy(to, from, (size_t)count);
    return to + count;
}

/* `point`: how many digits stand before the decimal point. */
static char *write_plain(char *to, const char *digit, int count, int point) {
    if (point <= 0) return copy(repeat(copy(to, "0.", 2), '0', -point), digit, count);
    if (point >= count) return copy(repeat(copy(to, digit, count), '0', point - count), ".0", 2);
    return copy(copy(copy(to, digit, point), ".", 1), digit + point, count - point);
}

static char *write_exponent(char *to, const char *digit, int count, int exponent) {
    char size[20];
    int length;
    *to++ = digit[0];
    if (count > 1) to = copy(copy(to, ".", 1), digit + 1, count - 1);
    *to++ = 'e';
    *to++ = exponent < 0 ? '-' : '+';
    length = digits_of(size, (uint64_t)abs(exponent));
    return copy(repeat(to, '0', 2 - length), size, length);
}

static char *write_number(char *to, double number, const uint64_t *powers) {
    uint64_t bits;
    int exponent_bits, count, point;
    char digit[20];
    decimal found;
    memcpy(&bits, &number, sizeof bits);
    exponent_bits = (int)(bits >> 52 & 2047);
    if (exponent_bits == 2047 && (bits & FRACTION_BITS) != 0) return copy(to, "nan", 3);
    if (bits >> 63 != 0) *to++ = '-';
    if (exponent_bits == 2047) return copy(to, "inf", 3);
    if (bits << 1 == 0) return copy(to, "0.0", 3);
    found = exponent_bits != 0 ? shortest(bits & FRACTION_BITS, exponent_bits, powers)
                               : shortest_of_small(bits >> 63 != 0 ? -number : number);
    while (found.digits % 10 == 0) {
        found.digits /= 10;
        found.exponent++;
    }
    count = digits_of(digit, found.digits);
    point = count + found.exponent;
    if (point > -4 && point <= 16) return write_plain(to, digit, count, point);
    return write_exponent(to, digit, count, point - 1);
}

size_t laconic_csv_rows(char *text, const double *numbers, size_t rows, size_t columns, const uint64_t *powers) {
    char *to = text;
    size_t row, column;
    for (row = 0; row < rows; row++)
        for (column = 0; column < columns; column++) {
            to = write_number(to, *numbers++, powers);
            *to++ = column + 1 < columns ? ',' : '\n';
        }
    return (size_t)(to - text);
}
