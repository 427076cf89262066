/* The self-test: does arithmetic, with the options of this file and the modes of this thread, give the core's bits? The
 * numbers of each check are wrong only under its own fault or one that is checked before it. Each check adds up its
 * wrong results instead of branching, since a sound build would never take the branches and no test would cover
 * them. */
#include "common.h"

/* Rounded to its type, and unknown when this is compiled. */
static real opaque(real x) {
    volatile real stored = x;
    return stored;
}

/* -ffinite-math-only lets compilers take every test for NaN and infinity as passed. */
static bool nan_passes_for_a_number(void) {
    const real zero = opaque(R(0)), nan = opaque(zero / zero), infinite = opaque(R(1) / zero);
    return (nan == nan) + (nan > zero) + is_finite(nan) + is_finite(infinite) + (zero_if_finite(nan) == zero) > 0;
}

/* To nearest, ties to even; the other modes fail here on one side of 0 or the other. */
static bool rounds_another_way(void) {
    const real one = opaque(R(1)), next = R(1) + LACONIC_EPSILON, after = R(1) + R(2) * LACONIC_EPSILON;
    const real half = opaque(R(0.5) * LACONIC_EPSILON), more = opaque(R(0.75) * LACONIC_EPSILON);
    return (opaque(one + more) != next) + (opaque(-one - more) != -next) + (opaque(one + half) != one) +
               (opaque(opaque(next) + half) != after) >
           0;
}

/* -fassociative-math: (1 + enormous) − enormous is 0, even where more digits are kept than the type has. */
static bool sums_in_another_order(void) {
    const real one = opaque(R(1)), enormous = opaque(R(1e36)), sum = one + enormous;
    return sum - enormous != R(0);
}

/* x87, or float computed as double: a product that overflows stays finite and can be halved. */
static bool keeps_more_than_the_type(void) {
    return is_finite(opaque(LACONIC_REAL_MAX) * opaque(R(2)) * opaque(R(0.5)));
}

/* Two numbers side by side: gcc 12's SLP vectoriser fuses such in spite of -ffp-contract=off. */
typedef struct couple {
    real first, second;
} couple;

RARE void multiply(couple *out, const couple *a, const couple *b) { /* as complex numbers */
    const couple x = *a, y = *b;
    out->first = x.first * y.first - x.second * y.second;
    out->second = x.second * y.first + x.first * y.second;
}

/* (1 + ε)(1 − ε) rounds to 1; fused with the subtraction it does not, and −ε² is left. Each product is used
 * once: compilers do not fuse a product that is also needed by itself. */
static bool fuses_multiply_and_add(void) {
    const real one = opaque(R(1)), more = R(1) + LACONIC_EPSILON, less = R(1) - LACONIC_EPSILON;
    const couple a = {opaque(more), opaque(less)}, b = {a.second, a.first};
    const real left = opaque(more) * opaque(less) - one, right = one - opaque(more) * opaque(less);
    couple product;
    multiply(&product, &a, &b);
    return (left != R(0)) + (right != R(0)) + (product.first != R(0)) > 0;
}

/* -freciprocal-math, for which clang has no macro: 107 · (1/107) is 1 neither in double nor in single. */
static bool divides_by_reciprocals(void) {
    const real number = R(107), divisor = opaque(number);
    const real once = opaque(number) / divisor, twice = opaque(R(2) * number) / divisor;
    return (once != R(1)) + (twice != R(2)) + (opaque(number) / R(107) != R(1)) > 0;
}

/* Half of the smallest normal number is subnormal: flushed to 0 as a result or as an operand, it cannot be doubled
 * back. */
static bool flushes_small_numbers(void) {
    const real half = opaque(opaque(LACONIC_REAL_MIN) * opaque(R(0.5)));
    return opaque(half * opaque(R(2))) != LACONIC_REAL_MIN;
}

/* libgcc's assembly for Arm without double precision: 1 − 2⁻³³(1 + ε) loses a bit too much (docs/c.md). */
static bool subtracts_wrongly(void) {
    const real one = opaque(R(1)), tiny = R(1.16415321826934814453125e-10);
    return one - opaque(tiny * (R(1) + LACONIC_EPSILON)) != R(1) - tiny;
}

laconic_arithmetic laconic_self_test(void) {
    static bool (*const wrong[LACONIC_ARITHMETIC_COUNT - 1])(void) = {
        /* in the order of laconic_arithmetic */
        nan_passes_for_a_number, rounds_another_way,     sums_in_another_order, keeps_more_than_the_type,
        fuses_multiply_and_add,  divides_by_reciprocals, flushes_small_numbers, subtracts_wrongly};
    for (int k = 0; k < LACONIC_ARITHMETIC_COUNT - 1; k++)
        if (wrong[k]()) return (laconic_arithmetic)(k + 1);
    return LACONIC_ARITHMETIC_SOUND;
}

#define TEXT_OF_ARITHMETIC(IDENTIFIER, text) text,

const char *laconic_arithmetic_text(laconic_arithmetic found) {
    static const char *const texts[] = {LACONIC_ARITHMETICS(TEXT_OF_ARITHMETIC)};
    return (unsigned)found < LACONIC_ARITHMETIC_COUNT ? texts[found] : "unknown";
}
