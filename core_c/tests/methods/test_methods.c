/* Tests of methods.c: numbers and names of the methods, and that each row of methods.h states what its source does. */
#include "check.h"

typedef struct row {
    int32_t number;
    const char *identifier, *name;
    int32_t order;
    const laconic_method *method;
} row;

#define ROW(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) \
    {number, #identifier, name, order, &laconic_##identifier},
static const row rows[] = {LACONIC_METHODS(ROW)};
#define ROWS ((int32_t)(sizeof rows / sizeof rows[0]))

static void every_number_has_its_method_and_every_name_leads_back(void) {
    TEST_ASSERT_EQUAL_INT32(LACONIC_METHOD_COUNT, ROWS);
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_INT32(i, rows[i].number);
        TEST_ASSERT_EQUAL_PTR(rows[i].method, laconic_method_by_number(i));
        TEST_ASSERT_EQUAL_PTR(rows[i].method, laconic_method_by_name(rows[i].name));
    }
}

static void a_row_has_the_name_and_the_order_of_its_source(void) {
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_STRING(rows[i].name, rows[i].method->name);
        TEST_ASSERT_EQUAL_INT32(rows[i].order, rows[i].method->order);
    }
}

static void a_name_is_the_identifier_with_hyphens(void) {
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_size_t(strlen(rows[i].identifier), strlen(rows[i].name));
        for (size_t k = 0; k < strlen(rows[i].name); k++)
            TEST_ASSERT_EQUAL_CHAR(rows[i].identifier[k] == '_' ? '-' : rows[i].identifier[k], rows[i].name[k]);
    }
}

static void no_two_methods_have_one_name(void) {
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t k = 0; k < i; k++) TEST_ASSERT_TRUE(strcmp(rows[i].name, rows[k].name) != 0);
}

/* Names in the order of the numbers, with "or" before the last. */
static void the_message_for_an_unknown_method_names_all(void) {
    const laconic_refusal why = {LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, 0, 0};
    char text[400], expected[400] = "run.method: there is no such method; use ";
    for (int32_t i = 0; i < ROWS; i++) {
        if (i > 0) strcat(expected, i < ROWS - 1 ? ", " : " or ");
        strcat(expected, rows[i].name);
    }
    TEST_ASSERT_EQUAL_size_t(strlen(expected), laconic_message(&why, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
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
    RUN_TEST(a_row_has_the_name_and_the_order_of_its_source);
    RUN_TEST(a_name_is_the_identifier_with_hyphens);
    RUN_TEST(no_two_methods_have_one_name);
    RUN_TEST(the_message_for_an_unknown_method_names_all);
    RUN_TEST(what_is_no_method_is_null);
    return UNITY_END();
}
