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

/* Steps of a long run. Builds without sanitizers check the numbers of all steps. Under clang's sanitizers a step takes
 * eighty times as long, and all steps touch the same memory, so that a tenth of them is taken there. */
#ifdef __has_feature /* clang */
#if __has_feature(address_sanitizer)
#define LONG_RUN(steps) ((steps) / 10)
#endif
#endif
#ifndef LONG_RUN
#define LONG_RUN(steps) (steps)
#endif

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

/* What laconic.h states of a refusal's numbers: the value is one that the status speaks of, and there is a limit where
 * one is acceptable, else 0. */
static inline void assert_tells_what_was_wrong(const laconic_refusal *why) {
    const double value = (double)why->value, limit = (double)why->limit;
    bool has_limit = false, fits = true;
    switch (why->status) {
    case LACONIC_NOT_FINITE: fits = !isfinite(value); break;
    case LACONIC_NOT_POSITIVE: fits = value <= 0; break;
    case LACONIC_NEGATIVE: fits = value < 0; break;
    case LACONIC_ZERO: fits = fabs(value) < (double)LACONIC_REAL_MIN; break;
    case LACONIC_FRICTION_TWICE:
    case LACONIC_FRICTION_MISSING: fits = value > 0; break;
    case LACONIC_ILL_CONDITIONED: fits = value > 1; break;
    case LACONIC_NOTHING_MOVES: fits = value >= 0 && value <= 1.0001; break; /* a part of a way */
    case LACONIC_ROLLER_ALONG_AXLE:
    case LACONIC_WHEEL_KIND_UNKNOWN:
    case LACONIC_MOTOR_CIRCUIT_UNKNOWN: fits = isfinite(value); break;
    case LACONIC_WHEEL_NOT_SET:
    case LACONIC_METHOD_UNKNOWN:
    case LACONIC_METHOD_WITHOUT_FRICTION: fits = value == 0; break;
    case LACONIC_STRAIGHT_ONLY: fits = value >= 0; break; /* a distance */
    case LACONIC_ABOVE_LIMIT: fits = has_limit = value > limit && limit >= 0; break;
    case LACONIC_TOO_MANY_WHEELS:
    case LACONIC_TOO_MANY_SUPPORTS: fits = has_limit = (value < 0 || value > limit) && limit > 0; break;
    default: has_limit = true; break;
    }
    TEST_ASSERT_TRUE_MESSAGE(fits && (has_limit || limit == 0), "its value or limit is none of its status");
}

#define ASSERT_REFUSED(expected_status, expected_field, expected_item, actual, why) \
    do { \
        memset(&(why), 0, sizeof(why)); /* that of an earlier call tells nothing */ \
        const laconic_status refused_with = (actual); \
        ASSERT_STATUS(expected_status, refused_with); \
        ASSERT_STATUS(expected_status, (why).status); \
        TEST_ASSERT_EQUAL_STRING(laconic_field_name(expected_field), laconic_field_name((why).field)); \
        TEST_ASSERT_EQUAL_INT(expected_item, (why).item); \
        assert_tells_what_was_wrong(&(why)); \
    } while (0)

void setUp(void) {}

void tearDown(void) {}

#endif
