/* What all unit tests of FMUs share: references by name, the last line of the log, and refusals. */
#ifndef SHARED_BENCH_H
#define SHARED_BENCH_H

#include "fmi3Functions.h"
#include "instance.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define NOT_A_NUMBER ((double)NAN)

static char logged[1024]; /* the last line, behind its category; "" since log_clear() */
static int lines;

static inline void log_clear(void) {
    logged[0] = 0;
    lines = 0;
}

static inline void log_line(const char *category, const char *text) {
    snprintf(logged, sizeof logged, "%s: %s", category, text);
    lines++;
}

static void log_3(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text) {
    (void)e;
    (void)status;
    log_line(category, text);
}

#define ASSERT_LOGGED(part) TEST_ASSERT_TRUE_MESSAGE(strstr(logged, part) != NULL, logged)
#define ASSERT_REFUSED(call, part) \
    do { \
        log_clear(); \
        TEST_ASSERT_EQUAL_INT(3, (int)(call)); \
        ASSERT_LOGGED(part); \
    } while (0)
#define OK(call) TEST_ASSERT_EQUAL_INT_MESSAGE(0, (int)(call), logged)

/* The reference of a variable; of one element, from 1, where `element` is not 0. */
static inline uint32_t ref(const char *name, uint32_t element) {
    for (uint32_t row = 0; row < fmu_variable_count; row++)
        if (strcmp(fmu_name_of(&fmu_variables[row]), name) == 0)
            return element == 0 ? row : row << FMU_ELEMENT_SHIFT | element;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline fmi3Instance make_3(bool event_mode) {
    return fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, event_mode, false, NULL, 0, NULL, log_3,
                                       NULL);
}

#endif
