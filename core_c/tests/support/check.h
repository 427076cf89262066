/* Comparisons for both scalar types, by Unity. */
#ifndef LACONIC_TEST_CHECK_H
#define LACONIC_TEST_CHECK_H

#include <math.h>
#include <string.h>

#include "laconic/laconic.h"
#include "unity.h"

#ifdef LACONIC_SINGLE
#define IN_DOUBLE 0
#define EITHER(in_double, in_single) (in_single)
#else
#define IN_DOUBLE 1
#define EITHER(in_double, in_single) (in_double)
#endif

#define REAL(x) ((laconic_real)(x))
#define PI 3.14159265358979323846
#define NOT_A_NUMBER ((laconic_real)NAN)
#define INFINITE ((laconic_real)INFINITY)

/* A few units in the last place of numbers around 1. */
#define ROUNDING EITHER(1e-15, 5e-7)

#define ASSERT_NEAR(tolerance, expected, actual) \
    UNITY_TEST_ASSERT_DOUBLE_WITHIN((double)(tolerance), (double)(expected), (double)(actual), __LINE__, NULL)
#define ASSERT_NEAR_ALL(tolerance, expected, actual, count) \
    do { \
        int near_index; \
        for (near_index = 0; near_index < (count); near_index++) \
            ASSERT_NEAR(tolerance, (expected)[near_index], (actual)[near_index]); \
    } while (0)
#define ASSERT_STATUS(expected, actual) \
    TEST_ASSERT_EQUAL_STRING(laconic_status_name(expected), laconic_status_name(actual))
#define ASSERT_REFUSED(expected_status, expected_field, expected_item, actual, why) \
    do { \
        const laconic_status refused_with = (actual); \
        ASSERT_STATUS(expected_status, refused_with); \
        ASSERT_STATUS(expected_status, (why).status); \
        TEST_ASSERT_EQUAL_STRING(laconic_field_name(expected_field), laconic_field_name((why).field)); \
        TEST_ASSERT_EQUAL_INT(expected_item, (why).item); \
    } while (0)

void setUp(void) {}

void tearDown(void) {}

#endif
