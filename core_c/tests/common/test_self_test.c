/* Tests of self_test.c: sound arithmetic passes, and each fault is found and named. */
#include "check.h"

#include <fenv.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

/* ---------------------------------------------------------------------------------- the test -- */

static void arithmetic_as_this_build_has_it_is_sound(void) {
    TEST_ASSERT_EQUAL_STRING("sound", laconic_arithmetic_text(laconic_self_test()));
}

static void every_other_rounding_mode_is_found(void) {
    const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    for (int i = 0; i < 3; i++) {
        laconic_arithmetic found;
        TEST_ASSERT_EQUAL_INT(0, fesetround(modes[i]));
        found = laconic_self_test();
        fesetround(FE_TONEAREST);
        TEST_ASSERT_EQUAL_INT(LACONIC_ARITHMETIC_ROUNDED_OTHERWISE, found);
    }
    TEST_ASSERT_EQUAL_INT(LACONIC_ARITHMETIC_SOUND, laconic_self_test());
}

static void subnormal_numbers_that_are_flushed_to_zero_are_found(void) {
#if defined(__SSE__)
    const unsigned modes[] = {0x8000U, 0x0040U, 0x8040U}; /* flush to zero, denormals are zero, both */
    const unsigned before = _mm_getcsr();
    for (int i = 0; i < 3; i++) {
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

/* --------------------------------------------------------------------------------- its texts -- */

static void every_finding_has_a_text_of_its_own(void) {
    for (int a = 0; a < LACONIC_ARITHMETIC_COUNT; a++) {
        const char *text = laconic_arithmetic_text((laconic_arithmetic)a);
        TEST_ASSERT_TRUE(strlen(text) >= 5);
        for (int b = 0; b < a; b++) TEST_ASSERT_TRUE(strcmp(text, laconic_arithmetic_text((laconic_arithmetic)b)) != 0);
    }
    TEST_ASSERT_EQUAL_STRING("sound", laconic_arithmetic_text(LACONIC_ARITHMETIC_SOUND));
}

static void every_fault_comes_with_its_remedy(void) {
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_FUSED), "-ffp-contract=off"));
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_WITHOUT_NAN), "-ffinite-math-only"));
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_FLUSHED), "flush-to-zero"));
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_SUBTRACTED_WRONGLY), "soft_double.c"));
}

static void an_unknown_number_has_a_text(void) {
    TEST_ASSERT_EQUAL_STRING("unknown", laconic_arithmetic_text(LACONIC_ARITHMETIC_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown", laconic_arithmetic_text((laconic_arithmetic)1000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(arithmetic_as_this_build_has_it_is_sound);
    RUN_TEST(every_other_rounding_mode_is_found);
    RUN_TEST(subnormal_numbers_that_are_flushed_to_zero_are_found);
    RUN_TEST(every_finding_has_a_text_of_its_own);
    RUN_TEST(every_fault_comes_with_its_remedy);
    RUN_TEST(an_unknown_number_has_a_text);
    return UNITY_END();
}
