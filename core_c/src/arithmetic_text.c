/* What the self-test found, in words; apart from it, so that firmware without messages goes without the text. */
#include "internal.h"

const char *laconic_arithmetic_text(laconic_arithmetic found) {
    static const char *const texts[LACONIC_ARITHMETIC_COUNT] = {
        "sound",
        "NaN and infinity pass for numbers; compile without -ffinite-math-only",
        "results are not rounded to nearest; set the rounding mode to nearest, ties to even",
        "sums are taken in another order; compile without -fassociative-math and -funsafe-math-optimizations",
        "intermediate results keep more digits than their type; compile for SSE2, not x87",
        "multiply and add are fused; compile with -ffp-contract=off, and with gcc -fno-tree-slp-vectorize",
        "divisions are done by reciprocals; compile without -freciprocal-math and -funsafe-math-optimizations",
        "subnormal numbers are flushed to zero; clear the flush-to-zero and denormals-are-zero modes",
    };
    return (unsigned)found < LACONIC_ARITHMETIC_COUNT ? texts[found] : "unknown";
}
