#include "check.h"

static void every_field_but_none_has_a_path_of_its_own(void) {
    int a, b;
    TEST_ASSERT_EQUAL_STRING("", laconic_field_path(LACONIC_FIELD_NONE));
    for (a = 1; a < LACONIC_FIELD_COUNT; a++) {
        TEST_ASSERT_NOT_EQUAL(0, strlen(laconic_field_path((laconic_field)a)));
        for (b = 1; b < a; b++)
            TEST_ASSERT_TRUE(strcmp(laconic_field_path((laconic_field)a), laconic_field_path((laconic_field)b)) != 0);
    }
}

/* Both end in the same key, so that neither list has slipped by a line. */
static void a_path_ends_in_the_key_that_the_name_ends_in(void) {
    int field;
    for (field = 1; field < LACONIC_FIELD_COUNT; field++) {
        const char *name = laconic_field_name((laconic_field)field), *path = laconic_field_path((laconic_field)field);
        const char *dot = strrchr(path, '.'), *key = dot != NULL ? dot + 1 : path;
        const size_t length = strcspn(key, "[");
        if (field == LACONIC_FIELD_WHEEL_COUNT || field == LACONIC_FIELD_SUPPORT_COUNT) continue; /* tables */
        TEST_ASSERT_TRUE_MESSAGE(strlen(name) >= length, path);
        TEST_ASSERT_EQUAL_STRING_LEN(name + strlen(name) - length, key, length);
    }
}

static void fields_are_found_where_scenes_have_them(void) {
    TEST_ASSERT_EQUAL_STRING("vehicle.payload.x_m", laconic_field_path(LACONIC_FIELD_PAYLOAD_X));
    TEST_ASSERT_EQUAL_STRING("vehicle.wheel", laconic_field_path(LACONIC_FIELD_WHEEL_COUNT));
    TEST_ASSERT_EQUAL_STRING("vehicle.wheel[#].roller_rad", laconic_field_path(LACONIC_FIELD_ROLLER));
    TEST_ASSERT_EQUAL_STRING("vehicle.support", laconic_field_path(LACONIC_FIELD_SUPPORT_COUNT));
    TEST_ASSERT_EQUAL_STRING("initial.heading_rad", laconic_field_path(LACONIC_FIELD_START_HEADING));
    TEST_ASSERT_EQUAL_STRING("run.step_s", laconic_field_path(LACONIC_FIELD_STEP));
    TEST_ASSERT_EQUAL_STRING("vehicle.motor.rotor_inertia_kgm2", laconic_field_path(LACONIC_FIELD_ROTOR_INERTIA));
}

static void numbers_that_are_none_are_survived(void) {
    TEST_ASSERT_EQUAL_STRING("", laconic_field_path(LACONIC_FIELD_COUNT));
    TEST_ASSERT_EQUAL_STRING("", laconic_field_path((laconic_field)1000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_field_but_none_has_a_path_of_its_own);
    RUN_TEST(a_path_ends_in_the_key_that_the_name_ends_in);
    RUN_TEST(fields_are_found_where_scenes_have_them);
    RUN_TEST(numbers_that_are_none_are_survived);
    return UNITY_END();
}
