/* Tests of message.c: the texts of refusals, with their numbers. */
#include "check.h"

#include <stdio.h>

static char text[400];

static const char *message(laconic_status status, laconic_field field, int32_t item, double value, double limit) {
    const laconic_refusal why = {status, field, item, REAL(value), REAL(limit)};
    const size_t length = laconic_message(&why, text, sizeof text);
    TEST_ASSERT_EQUAL_UINT(strlen(text), length);
    return text;
}

static void a_refusal_names_field_item_value_and_remedy(void) {
    TEST_ASSERT_EQUAL_STRING("vehicle.mass_kg: -2 is not positive; give a value above 0",
                             message(LACONIC_NOT_POSITIVE, LACONIC_FIELD_MASS, 0, -2, 0));
    TEST_ASSERT_EQUAL_STRING_LEN("vehicle.wheel[12].roller_rad: with 0.5 rad the roller axis lies along the axle",
                                 message(LACONIC_ROLLER_ALONG_AXLE, LACONIC_FIELD_ROLLER, 12, 0.5, 0), 77);
    TEST_ASSERT_EQUAL_STRING(
        "run.step_s: 0.25 s is unstable with this method because the motors damp too fast; use at most 0.125 s, "
        "or auto",
        message(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, 0.25, 0.125));
}

static void a_field_without_the_item_it_could_have_is_named_as_a_whole(void) {
    TEST_ASSERT_EQUAL_STRING("initial.nu_rad_per_s: a result leaves the range of " LACONIC_REAL_NAME
                             " precision; check inputs and units",
                             message(LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, 0, 0));
    TEST_ASSERT_EQUAL_STRING_LEN("voltage_V[2]: NaN",
                                 message(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 2, (double)NAN, 0), 17);
    TEST_ASSERT_EQUAL_STRING_LEN("body_moment_Nm: NaN",
                                 message(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0, (double)NAN, 0), 19);
}

static void an_explanation_is_the_message_without_its_field(void) {
    const laconic_refusal why = {LACONIC_NEGATIVE, LACONIC_FIELD_MOTOR_DAMPING, 0, REAL(-1), 0};
    TEST_ASSERT_EQUAL_UINT(42, laconic_explanation(&why, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("-1 is negative; give 0 or a value above it", text);
}

static void without_a_field_only_the_explanation_is_given(void) {
    TEST_ASSERT_EQUAL_STRING("ok", message(LACONIC_OK, LACONIC_FIELD_NONE, 0, 0, 0));
}

static void every_status_has_a_text_and_so_has_an_unknown_number(void) {
    for (int status = 1; status < LACONIC_STATUS_COUNT; status++)
        TEST_ASSERT_TRUE(strlen(message((laconic_status)status, LACONIC_FIELD_NONE, 0, 1, 2)) > 10);
    TEST_ASSERT_EQUAL_STRING("unknown status", message((laconic_status)1000, LACONIC_FIELD_NONE, 0, 0, 0));
}

static void every_status_has_a_text_of_its_own(void) {
    for (int a = 0; a < LACONIC_STATUS_COUNT; a++) {
        TEST_ASSERT_NOT_EQUAL(0, strlen(laconic_status_name((laconic_status)a)));
        for (int b = 0; b < a; b++)
            TEST_ASSERT_TRUE(strcmp(laconic_status_name((laconic_status)a), laconic_status_name((laconic_status)b)) !=
                             0);
    }
    TEST_ASSERT_EQUAL_STRING("ok", laconic_status_name(LACONIC_OK));
    TEST_ASSERT_EQUAL_STRING("wheel not set", laconic_status_name(LACONIC_WHEEL_NOT_SET));
    TEST_ASSERT_EQUAL_STRING("overflow", laconic_status_name(LACONIC_OVERFLOW));
    TEST_ASSERT_EQUAL_STRING("unknown status", laconic_status_name(LACONIC_STATUS_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown status", laconic_status_name((laconic_status)1000));
}

/* The number as a message writes it. */
static const char *shown(double value) {
    const char *end = strstr(message(LACONIC_NOT_POSITIVE, LACONIC_FIELD_NONE, 0, value, 0), " is not positive");
    TEST_ASSERT_NOT_NULL(end);
    text[end - text] = '\0';
    return text;
}

static void numbers_are_written_as_printf_writes_them(void) {
    const double values[] = {1,      -1,     0.1,     123456,   999999, 1e6,   1.5e6,  0.0001, 0.000123456, 0.00001,
                             2.5e-5, -3e-7,  3.14159, 100,      1e10,   1e30,  -1e-30, 0.5,    42.25,       999999.7,
                             12.5,   0.0625, 1234.5,  0.999999, 0.0099, 65536, 7e-12,  -8,     31.4159};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        char expected[40];
        double read = 0;
        snprintf(expected, sizeof expected, "%.6g", values[i]);
        TEST_ASSERT_EQUAL_INT(1, sscanf(shown(values[i]), "%lf", &read));
        ASSERT_NEAR(EITHER(1.1e-6, 2e-6) * fabs(values[i]), values[i], read);
        TEST_ASSERT_TRUE_MESSAGE(strlen(text) <= strlen(expected), text);
    }
}

static void a_number_that_rounds_up_to_the_next_power_stays_right(void) {
    TEST_ASSERT_EQUAL_STRING("1e+6", shown(999999.9));
    TEST_ASSERT_EQUAL_STRING("10", shown(9.9999999));
    TEST_ASSERT_EQUAL_STRING("9.99999", shown(9.99999));
}

static void two_numbers_that_differ_are_shown_by_digits_that_differ(void) {
    TEST_ASSERT_EQUAL_STRING("0.1250001 is above 0.125; give 0.125 or less",
                             message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, 0.1250001, 0.125));
    TEST_ASSERT_EQUAL_STRING("1000001 is above 1000000; give 1000000 or less",
                             message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, 1000001, 1000000));
    TEST_ASSERT_EQUAL_STRING("-2000000 makes a fixed or locked wheel slide; the nearest value that the wheels allow is "
                             "-2000002",
                             message(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_NONE, 0, -2000000, -2000002));
    TEST_ASSERT_EQUAL_STRING("0.0001234564 is above 0.0001234561; give 0.0001234561 or less",
                             message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, 0.0001234564, 0.0001234561));
    TEST_ASSERT_EQUAL_STRING_LEN(EITHER("1.0000002e+10 is above 1e+10", "1.0000004e+10 is above 1e+10"),
                                 message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, 1.0000002e10, 1e10), 28);
}

static void numbers_that_are_equal_have_six_digits(void) {
    TEST_ASSERT_EQUAL_STRING("3.33333 is above 3.33333; give 3.33333 or less",
                             message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, 10.0 / 3, 10.0 / 3));
    TEST_ASSERT_EQUAL_STRING("NaN is above NaN; give NaN or less",
                             message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, (double)NAN, (double)NAN));
}

#if !defined LACONIC_SINGLE
/* From some units in the last place on, which scaling rounds. */
static void close_numbers_in_double_are_told_apart(void) {
    const double values[] = {1, 0.1, 12.5, 0.00033, 123456.7, 1e12, 3e-7, 9.5};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        double above = 0, limit = 0;
        (void)message(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, values[i] * (1 + 4 * DBL_EPSILON), values[i]);
        TEST_ASSERT_EQUAL_INT(2, sscanf(text, "%lf is above %lf", &above, &limit));
        TEST_ASSERT_TRUE_MESSAGE(above > limit, text);
    }
}
#endif

/* Just below the middle of two: a power of 10 taken out and put back would round it up. */
static void a_number_is_scaled_no_farther_than_it_must_be(void) {
    TEST_ASSERT_EQUAL_STRING("92.5649", shown(EITHER(92.564949999999996, 92.5649)));
}

static void zero_infinity_and_nan_are_written_out(void) {
    TEST_ASSERT_EQUAL_STRING("0", shown(0.0));
    TEST_ASSERT_EQUAL_STRING("infinity", shown(HUGE_VAL));
    TEST_ASSERT_EQUAL_STRING("-infinity", shown(-HUGE_VAL));
    TEST_ASSERT_EQUAL_STRING("NaN", shown((double)NAN));
}

static void the_ends_of_the_range_are_shown(void) {
    double read;
    TEST_ASSERT_EQUAL_INT(1, sscanf(shown((double)LACONIC_REAL_MAX), "%lf", &read));
    ASSERT_NEAR(1e-4, 1.0, read / (double)LACONIC_REAL_MAX);
    TEST_ASSERT_EQUAL_INT(1, sscanf(shown((double)LACONIC_REAL_MIN), "%lf", &read));
    ASSERT_NEAR(1e-4, 1.0, read / (double)LACONIC_REAL_MIN);
}

static void a_short_buffer_gets_what_fits_and_the_whole_length_is_returned(void) {
    const laconic_refusal why = {LACONIC_NEGATIVE, LACONIC_FIELD_MOTOR_DAMPING, 0, REAL(-1), 0};
    const size_t length = laconic_message(&why, text, sizeof text);
    char little[8] = "#######";
    TEST_ASSERT_EQUAL_UINT(length, laconic_message(&why, little, sizeof little));
    TEST_ASSERT_EQUAL_STRING("vehicle", little);
    TEST_ASSERT_EQUAL_UINT(length, laconic_message(&why, NULL, 0));
    TEST_ASSERT_EQUAL_UINT(42, laconic_explanation(&why, little, sizeof little));
    TEST_ASSERT_EQUAL_STRING("-1 is n", little);
    TEST_ASSERT_EQUAL_UINT(42, laconic_explanation(&why, NULL, 0));
}

/* Whatever its size: cut or whole, it ends within, and what stands behind it stays. */
static void nothing_behind_the_buffer_is_written(void) {
    const laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_MASS, 0, 0, 0};
    const char whole[] = "vehicle.mass_kg: ok";
    for (size_t size = 0; size <= sizeof whole + 2; size++) {
        char expected[sizeof whole + 6], found[sizeof whole + 6];
        memset(expected, '#', sizeof expected);
        memset(found, '#', sizeof found);
        snprintf(expected, size, "%s", whole);
        TEST_ASSERT_EQUAL_UINT(sizeof whole - 1, laconic_message(&why, found, size));
        for (size_t k = 0; k < sizeof found; k++)
            if (k <= strlen(whole) || k >= size) TEST_ASSERT_EQUAL_INT(expected[k], found[k]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_refusal_names_field_item_value_and_remedy);
    RUN_TEST(a_field_without_the_item_it_could_have_is_named_as_a_whole);
    RUN_TEST(an_explanation_is_the_message_without_its_field);
    RUN_TEST(without_a_field_only_the_explanation_is_given);
    RUN_TEST(every_status_has_a_text_of_its_own);
    RUN_TEST(every_status_has_a_text_and_so_has_an_unknown_number);
    RUN_TEST(numbers_are_written_as_printf_writes_them);
    RUN_TEST(a_number_that_rounds_up_to_the_next_power_stays_right);
    RUN_TEST(a_number_is_scaled_no_farther_than_it_must_be);
    RUN_TEST(two_numbers_that_differ_are_shown_by_digits_that_differ);
    RUN_TEST(numbers_that_are_equal_have_six_digits);
#if !defined LACONIC_SINGLE
    RUN_TEST(close_numbers_in_double_are_told_apart);
#endif
    RUN_TEST(zero_infinity_and_nan_are_written_out);
    RUN_TEST(the_ends_of_the_range_are_shown);
    RUN_TEST(a_short_buffer_gets_what_fits_and_the_whole_length_is_returned);
    RUN_TEST(nothing_behind_the_buffer_is_written);
    return UNITY_END();
}
