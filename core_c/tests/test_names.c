#include "check.h"

static void every_field_but_none_has_a_name_of_its_own(void) {
    int a, b;
    TEST_ASSERT_EQUAL_STRING("", laconic_field_name(LACONIC_FIELD_NONE));
    for (a = 1; a < LACONIC_FIELD_COUNT; a++) {
        TEST_ASSERT_NOT_EQUAL(0, strlen(laconic_field_name((laconic_field)a)));
        for (b = 1; b < a; b++)
            TEST_ASSERT_TRUE(strcmp(laconic_field_name((laconic_field)a), laconic_field_name((laconic_field)b)) != 0);
    }
}

static void fields_are_called_as_fmus_call_them(void) {
    TEST_ASSERT_EQUAL_STRING("mass_kg", laconic_field_name(LACONIC_FIELD_MASS));
    TEST_ASSERT_EQUAL_STRING("payload_yaw_inertia_kgm2", laconic_field_name(LACONIC_FIELD_PAYLOAD_YAW_INERTIA));
    TEST_ASSERT_EQUAL_STRING("roller_rad", laconic_field_name(LACONIC_FIELD_ROLLER));
    TEST_ASSERT_EQUAL_STRING("support_y_m", laconic_field_name(LACONIC_FIELD_SUPPORT_Y));
    TEST_ASSERT_EQUAL_STRING("start_heading_rad", laconic_field_name(LACONIC_FIELD_START_HEADING));
    TEST_ASSERT_EQUAL_STRING("step_s", laconic_field_name(LACONIC_FIELD_STEP));
    TEST_ASSERT_EQUAL_STRING("world_force_point_m", laconic_field_name(LACONIC_FIELD_WORLD_FORCE_POINT));
    TEST_ASSERT_EQUAL_STRING("resistance_ohm", laconic_field_name(LACONIC_FIELD_RESISTANCE));
    TEST_ASSERT_EQUAL_STRING("rotor_inertia_kgm2", laconic_field_name(LACONIC_FIELD_ROTOR_INERTIA));
}

static void every_status_has_words_of_its_own(void) {
    int a, b;
    for (a = 0; a < LACONIC_STATUS_COUNT; a++) {
        TEST_ASSERT_NOT_EQUAL(0, strlen(laconic_status_name((laconic_status)a)));
        for (b = 0; b < a; b++)
            TEST_ASSERT_TRUE(strcmp(laconic_status_name((laconic_status)a), laconic_status_name((laconic_status)b)) !=
                             0);
    }
    TEST_ASSERT_EQUAL_STRING("ok", laconic_status_name(LACONIC_OK));
    TEST_ASSERT_EQUAL_STRING("wheel not set", laconic_status_name(LACONIC_WHEEL_NOT_SET));
    TEST_ASSERT_EQUAL_STRING("overflow", laconic_status_name(LACONIC_OVERFLOW));
}

static void numbers_that_are_none_are_survived(void) {
    TEST_ASSERT_EQUAL_STRING("", laconic_field_name(LACONIC_FIELD_COUNT));
    TEST_ASSERT_EQUAL_STRING("", laconic_field_name((laconic_field)1000));
    TEST_ASSERT_EQUAL_STRING("unknown status", laconic_status_name(LACONIC_STATUS_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown status", laconic_status_name((laconic_status)1000));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_field_but_none_has_a_name_of_its_own);
    RUN_TEST(fields_are_called_as_fmus_call_them);
    RUN_TEST(every_status_has_words_of_its_own);
    RUN_TEST(numbers_that_are_none_are_survived);
    return UNITY_END();
}
