/* What the tests of integrity.c share: sessions in whose memory bits change. */
#ifndef INTEGRITY_BENCH_H
#define INTEGRITY_BENCH_H

#include "rig.h"

#include "unity.h"

#include <string.h>

static bench on;

/* Which bit changes before which event of the session; events count from 1. */
typedef struct fault {
    size_t byte;
    uint8_t bits;
    int before, events;
    uint32_t at_us, noticed_us;
    uint8_t noticed; /* first */
} fault;

static inline void change(bench *at, void *with) {
    fault *it = with;
    it->events++;
    if (it->events == it->before) {
        ((uint8_t *)&at->node)[it->byte] ^= it->bits;
        it->at_us = at->time_us;
    }
    if (it->noticed != 0 || at->integrity.broken == 0) return;
    it->noticed = at->integrity.broken;
    it->noticed_us = at->time_us;
}

enum { IN_LOADING = 20, IN_FREE_RUN = 150 };

/* A session in which these bits change. */
static inline fault session_with(size_t byte, uint8_t bits, int before, uint8_t checks) {
    fault it = {.byte = byte, .bits = bits, .before = before};
    bench_power_up(&on, 7, 0xFFFFF000U, checks);
    (void)rig_session(&on, NULL, change, &it);
    return it;
}

#define BYTE(member) offsetof(laconic_node, member)

static inline void in_free_run_with(uint8_t checks) {
    bench_power_up(&on, 7, 0, checks);
    (void)rig_session(&on, NULL, NULL, NULL);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_START_FREE_RUN));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FREE_RUN, on.node.state);
}

static inline void in_free_run(void) { in_free_run_with(LACONIC_INTEGRITY_RANGE); }

#endif
