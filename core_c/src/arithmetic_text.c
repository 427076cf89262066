/* What the self-test found, in words; apart from it, so that firmware without messages goes without the text. */
#include "internal.h"

#define TEXT(IDENTIFIER, text) text,

const char *laconic_arithmetic_text(laconic_arithmetic found) {
    static const char *const texts[] = {LACONIC_ARITHMETICS(TEXT)};
    return (unsigned)found < LACONIC_ARITHMETIC_COUNT ? texts[found] : "unknown";
}
