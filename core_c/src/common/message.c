/* The texts of a refusal: the name of its status, and one line with field, item, fault and remedy. */
#include "common.h"
#include "laconic/articulated.h"

/* Numbers have six digits, as printf's %.6g; two that differ have as many more as show it, up to what this precision
 * holds. */
#define FEWEST_DIGITS 6
#if defined LACONIC_SINGLE
typedef int32_t decimal;
#define MOST_DIGITS 9
#else
typedef int64_t decimal;
#define MOST_DIGITS 17
#endif

typedef struct writer {
    char *text;
    size_t size, length;
} writer;

static void put(writer *w, char c) {
    if (w->length + 1 < w->size) w->text[w->length] = c;
    w->length++;
}

static void put_text(writer *w, const char *text) {
    for (; *text != '\0'; text++) put(w, *text);
}

static void put_count(writer *w, decimal number) {
    decimal divisor = 1;
    while (number / divisor >= 10) divisor *= 10;
    for (; divisor > 0; divisor /= 10) put(w, (char)('0' + number / divisor % 10));
}

/* Scales a finite x > 0 to 1 <= x < 10; returns the exponent of 10 that is taken out. */
static int32_t scale_to_digits(real *x) {
    int32_t exponent = 0;
    while (*x >= R(10)) {
        *x *= R(0.1);
        exponent++;
    }
    while (*x < R(1)) {
        *x *= R(10);
        exponent--;
    }
    return exponent;
}

/* Writes the `count` digits of a number without trailing zeros; the point stands behind digit `point`. */
static void put_digits(writer *w, decimal digits, int32_t count, int32_t point) {
    decimal divisor = 1;
    for (int32_t k = 1; k < count; k++) divisor *= 10;
    for (int32_t k = 0; divisor > 0; k++, divisor /= 10) {
        if (k >= point && digits == 0) return;
        if (k == point) put(w, '.');
        put(w, (char)('0' + digits / divisor));
        digits %= divisor;
    }
}

static void put_number(writer *w, real x, int32_t count) {
    decimal power = 1; /* 10^(count - 1) */
    if (x != x) {
        put_text(w, "NaN");
        return;
    }
    if (x < R(0)) put(w, '-');
    x = magnitude(x);
    if (!is_finite(x) || x == R(0)) {
        put_text(w, x == R(0) ? "0" : "infinity");
        return;
    }
    int32_t exponent = scale_to_digits(&x);
    for (int32_t k = 1; k < count; k++) power *= 10;
    decimal digits = (decimal)(x * (real)power + R(0.5));
    if (digits >= 10 * power) {
        digits = power;
        exponent++;
    }
    if (exponent >= -4 && exponent < 0) {
        put_text(w, "0.");
        for (int32_t k = exponent + 1; k < 0; k++) put(w, '0');
        while (digits % 10 == 0) digits /= 10;
        put_count(w, digits);
    } else if (exponent >= 0 && exponent < count) {
        put_digits(w, digits, count, exponent + 1);
    } else {
        put_digits(w, digits, count, 1);
        put_text(w, exponent < 0 ? "e-" : "e+");
        put_count(w, exponent < 0 ? -exponent : exponent);
    }
}

#define NAME(IDENTIFIER, name, explanation) name,
#define EXPLANATION(IDENTIFIER, name, explanation) explanation,

const char *laconic_status_name(laconic_status status) {
    static const char *const names[] = {LACONIC_STATUSES(NAME)};
    return (unsigned)status < LACONIC_STATUS_COUNT ? names[status] : "unknown status";
}

static const char *explanation(laconic_status status) {
    static const char *const texts[] = {LACONIC_STATUSES(EXPLANATION)};
    return (unsigned)status < LACONIC_STATUS_COUNT ? texts[status] : "unknown status";
}

/* Closes the text; returns the length that the whole text has. */
static size_t end_text(const writer *w) {
    if (w->size > 0) w->text[w->length < w->size ? w->length : w->size - 1] = '\0';
    return w->length;
}

#define METHOD_NAME(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) LACONIC_METHOD_WITH_##NEEDS(name, )

static const char *const plain_methods[] = {LACONIC_METHODS(METHOD_NAME)};
static const char *const methods_with_hinges[] = {LACONIC_ARTICULATED_METHOD_NAMES};

/* All in the order of the numbers, "or" before the last. */
static void put_names(writer *w, const char *const names[], size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (i > 0) put_text(w, i + 1 < count ? ", " : " or ");
        put_text(w, names[i]);
    }
}

static void put_method_names(writer *w, bool with_hinges) {
    if (with_hinges)
        put_names(w, methods_with_hinges, sizeof methods_with_hinges / sizeof methods_with_hinges[0]);
    else
        put_names(w, plain_methods, sizeof plain_methods / sizeof plain_methods[0]);
}

static bool look_alike(real a, real b, int32_t count) {
    char one[32], other[32];
    writer first = {NULL, 0, 0}, second = {NULL, 0, 0};
    first.text = one;
    second.text = other;
    first.size = second.size = sizeof one;
    put_number(&first, a, count);
    put_number(&second, b, count);
    if (first.length != second.length) return false;
    for (size_t k = 0; k < first.length; k++)
        if (one[k] != other[k]) return false;
    return true;
}

static void put_explanation(writer *w, const laconic_refusal *why) {
    const char *c;
    int32_t count = FEWEST_DIGITS;
    while (count < MOST_DIGITS && why->value != why->limit && look_alike(why->value, why->limit, count)) count++;
    for (c = explanation(why->status); *c != '\0'; c++) {
        if (*c == '#')
            put_number(w, why->value, count);
        else if (*c == '@')
            put_number(w, why->limit, count);
        else if (*c == '$')
            put_method_names(w, why->limit > R(0));
        else
            put(w, *c);
    }
}

/* The item's number replaces # in "[#]" of a path; without an item "[#]" is left out. */
static void put_path(writer *w, const char *path, int32_t item) {
    for (; *path != '\0'; path++) {
        if (*path != '[') {
            put(w, *path);
            continue;
        }
        if (item > 0) {
            put(w, '[');
            put_count(w, item);
            put(w, ']');
        }
        path += 2;
    }
}

size_t laconic_explanation(const laconic_refusal *why, char *text, size_t size) {
    writer w = {NULL, 0, 0};
    w.text = text;
    w.size = size;
    put_explanation(&w, why);
    return end_text(&w);
}

size_t laconic_message(const laconic_refusal *why, char *text, size_t size) {
    writer w = {NULL, 0, 0};
    w.text = text;
    w.size = size;
    put_path(&w, laconic_field_path(why->field), why->item);
    if (w.length > 0) put_text(&w, ": ");
    put_explanation(&w, why);
    return end_text(&w);
}
