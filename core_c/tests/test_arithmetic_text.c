#include "check.h"

static void every_finding_has_words_of_its_own(void) {
    int a, b;
    for (a = 0; a < LACONIC_ARITHMETIC_COUNT; a++) {
        const char *text = laconic_arithmetic_text((laconic_arithmetic)a);
        TEST_ASSERT_TRUE(strlen(text) >= 5);
        for (b = 0; b < a; b++) TEST_ASSERT_TRUE(strcmp(text, laconic_arithmetic_text((laconic_arithmetic)b)) != 0);
    }
    TEST_ASSERT_EQUAL_STRING("sound", laconic_arithmetic_text(LACONIC_ARITHMETIC_SOUND));
}

static void every_fault_comes_with_its_remedy(void) {
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_FUSED), "-ffp-contract=off"));
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_WITHOUT_NAN), "-ffinite-math-only"));
    TEST_ASSERT_NOT_NULL(strstr(laconic_arithmetic_text(LACONIC_ARITHMETIC_FLUSHED), "flush-to-zero"));
}

static void a_number_that_is_none_is_survived(void) {
    TEST_ASSERT_EQUAL_STRING("unknown", laconic_arithmetic_text(LACONIC_ARITHMETIC_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown", laconic_arithmetic_text((laconic_arithmetic)1000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_finding_has_words_of_its_own);
    RUN_TEST(every_fault_comes_with_its_remedy);
    RUN_TEST(a_number_that_is_none_is_survived);
    return UNITY_END();
}
