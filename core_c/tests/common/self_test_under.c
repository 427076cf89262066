/* Runs the self-test under a mode of the processor (nearest, up, down, zero, ftz, daz) and prints what it finds.
 * host_tests compiles it with options that break the arithmetic. */
#include <fenv.h>
#include <stdio.h>
#include <string.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "laconic/laconic.h"

static int set_mode(const char *mode) {
    if (strcmp(mode, "nearest") == 0) return 0;
    if (strcmp(mode, "up") == 0) return fesetround(FE_UPWARD);
    if (strcmp(mode, "down") == 0) return fesetround(FE_DOWNWARD);
    if (strcmp(mode, "zero") == 0) return fesetround(FE_TOWARDZERO);
#if defined(__SSE__)
    if (strcmp(mode, "ftz") == 0) return _mm_setcsr(_mm_getcsr() | 0x8000U), 0;
    if (strcmp(mode, "daz") == 0) return _mm_setcsr(_mm_getcsr() | 0x0040U), 0;
#endif
    return 1;
}

int main(int argc, char **argv) {
    laconic_arithmetic found;
    if (argc != 2 || set_mode(argv[1]) != 0) return 77;
    found = laconic_self_test();
    printf("%d %s\n", (int)found, laconic_arithmetic_text(found));
    return 0;
}
