/* The texts of a refusal: the name of its status, and one line with field, item, fault and remedy. */
#include "common.h"

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

static void put_count(writer *w, int32_t number) {
    int32_t divisor = 1;
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
static void put_digits(writer *w, int32_t digits, int32_t count, int32_t point) {
    int32_t divisor = 1;
    for (int32_t k = 1; k < count; k++) divisor *= 10;
    for (int32_t k = 0; divisor > 0; k++, divisor /= 10) {
        if (k >= point && digits == 0) return;
        if (k == point) put(w, '.');
        put(w, (char)('0' + digits / divisor));
        digits %= divisor;
    }
}

/* Six digits, as printf's %.6g. */
static void put_number(writer *w, real x) {
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
    int32_t digits = (int32_t)(x * R(100000) + R(0.5));
    if (digits >= 1000000) {
        digits = 100000;
        exponent++;
    }
    if (exponent >= -4 && exponent < 0) {
        put_text(w, "0.");
        for (int32_t k = exponent + 1; k < 0; k++) put(w, '0');
        while (digits % 10 == 0) digits /= 10;
        put_count(w, digits);
    } else if (exponent >= 0 && exponent < 6) {
        put_digits(w, digits, 6, exponent + 1);
    } else {
        put_digits(w, digits, 6, 1);
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

/* As laconic_articulated_method_name() has them: that part is linked only where it is called. */
#define METHODS_WITH_HINGES "auto, rk4, circle or moebius-4"

/* All in the order of the numbers, "or" before the last. */
static void put_method_names(writer *w) {
    static const char *const names[] = {LACONIC_METHODS(METHOD_NAME)};
    const size_t last = sizeof names / sizeof names[0] - 1;
    for (size_t i = 0; i < last; i++) {
        put_text(w, names[i]);
        put_text(w, i + 1 < last ? ", " : " or ");
    }
    put_text(w, names[last]);
}

static void put_explanation(writer *w, const laconic_refusal *why) {
    const char *c;
    for (c = explanation(why->status); *c != '\0'; c++) {
        if (*c == '#')
            put_number(w, why->value);
        else if (*c == '@')
            put_number(w, why->limit);
        else if (*c == '$' && why->limit > R(0))
            put_text(w, METHODS_WITH_HINGES);
        else if (*c == '$')
            put_method_names(w);
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
