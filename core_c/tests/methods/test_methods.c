/* Tests of methods.c: numbers and names of the methods. */
#include "check.h"

static void every_number_has_its_method_and_every_name_leads_back(void) {
    const char *const names[LACONIC_METHOD_COUNT] = {
        "auto",       "rk4",          "exponential-kahan", "exponential-kahan-4",
        "exact-flow", "exact-flow-4", "taylor-8",          "exponential-gauss-8"};
    const int32_t orders[LACONIC_METHOD_COUNT] = {8, 4, 2, 4, 2, 4, 8, 8};
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        TEST_ASSERT_NOT_NULL(method);
        TEST_ASSERT_EQUAL_STRING(names[i], method->name);
        TEST_ASSERT_EQUAL_INT(orders[i], method->order);
        TEST_ASSERT_EQUAL_PTR(method, laconic_method_by_name(names[i]));
    }
}

static void what_is_no_method_is_null(void) {
    TEST_ASSERT_NULL(laconic_method_by_number(-1));
    TEST_ASSERT_NULL(laconic_method_by_number(INT32_MIN));
    TEST_ASSERT_NULL(laconic_method_by_number(LACONIC_METHOD_COUNT));
    TEST_ASSERT_NULL(laconic_method_by_number(INT32_MAX));
    TEST_ASSERT_NULL(laconic_method_by_name(""));
    TEST_ASSERT_NULL(laconic_method_by_name("rk"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk45"));
    TEST_ASSERT_NULL(laconic_method_by_name("RK4"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk3"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk5"));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_number_has_its_method_and_every_name_leads_back);
    RUN_TEST(what_is_no_method_is_null);
    return UNITY_END();
}
