#include "check.h"

#include <fenv.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

static void arithmetic_as_this_build_has_it_is_sound(void) {
    TEST_ASSERT_EQUAL_STRING("sound", laconic_arithmetic_text(laconic_self_test()));
}

static void every_other_rounding_mode_is_found(void) {
    const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    int i;
    for (i = 0; i < 3; i++) {
        laconic_arithmetic found;
        TEST_ASSERT_EQUAL_INT(0, fesetround(modes[i]));
        found = laconic_self_test();
        fesetround(FE_TONEAREST);
        TEST_ASSERT_EQUAL_INT(LACONIC_ARITHMETIC_ROUNDED_OTHERWISE, found);
    }
    TEST_ASSERT_EQUAL_INT(LACONIC_ARITHMETIC_SOUND, laconic_self_test());
}

static void subnormal_numbers_that_count_as_none_are_found(void) {
#if defined(__SSE__)
    const unsigned modes[] = {0x8000U, 0x0040U, 0x8040U}; /* flush to zero, denormals are zero, both */
    const unsigned before = _mm_getcsr();
    int i;
    for (i = 0; i < 3; i++) {
        laconic_arithmetic found;
        _mm_setcsr(before | modes[i]);
        found = laconic_self_test();
        _mm_setcsr(before);
        TEST_ASSERT_EQUAL_INT(LACONIC_ARITHMETIC_FLUSHED, found);
    }
#else
    TEST_IGNORE_MESSAGE("no way known here to flush subnormal numbers");
#endif
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(arithmetic_as_this_build_has_it_is_sound);
    RUN_TEST(every_other_rounding_mode_is_found);
    RUN_TEST(subnormal_numbers_that_count_as_none_are_found);
    return UNITY_END();
}
