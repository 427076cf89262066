/* Clocks that run wrong: the node's 1 % fast or slow beside the rig's, set back and forth in the midst of a session,
 * and every count started shortly before it wraps. The motion must be the core's for the inputs that were there. */
#include "campaigns.h"

#include <stdio.h>
#include <string.h>

typedef struct observer {
    laconic_plant twin; /* stepped as the node is, by the core alone                     */
    bool loaded;
    uint32_t other_bits;  /* events after which the node's motion was not the twin's       */
    uint32_t periods;     /* of the free run                                               */
    uint32_t timeouts;    /* events in TIMEOUT                                             */
    int events, shift_at; /* events; the one after which the clock is set                 */
    uint32_t shift_us;
    uint64_t steps;
    laconic_input held; /* before the event */
} observer;

static void observe(bench *on, void *with) {
    observer *it = with;
    laconic_refusal why;
    const laconic_node *node = &on->node;
    it->events++;
    if (it->events == it->shift_at) on->shift_us += it->shift_us;
    if (node->state == LACONIC_WIRE_STATE_TIMEOUT) it->timeouts++;
    if (!it->loaded && node->plant.integrator.step_s > 0) {
        memcpy(&it->twin, &node->plant, sizeof it->twin);
        it->loaded = true;
    }
    if (node->state == LACONIC_WIRE_STATE_TIMEOUT) it->held = node->input[0]; /* the watchdog comes before the step */
    if (node->plant.steps != it->steps) {
        if (node->state == LACONIC_WIRE_STATE_FREE_RUN) it->periods += (uint32_t)(node->plant.steps - it->steps) / 10U;
        if (laconic_plant_run(&it->twin, &it->held, node->plant.steps - it->steps, &why) != LACONIC_OK)
            it->other_bits++;
    }
    if (it->loaded && memcmp(&it->twin.state, &node->plant.state, sizeof it->twin.state) != 0) it->other_bits++;
    it->steps = node->plant.steps;
    it->held = node->input[0];
}

static int bad;

/* 1: a figure that must be 0. */
static void tell(const char *name, long long value, bool must_be_0) {
    printf("%s|%lld\n", name, value);
    if (must_be_0 && value != 0) bad++;
}

static bool session(bench *on, observer *it, uint32_t start_us, int32_t ppm) {
    bench_power_up(on, 3, start_us, LACONIC_INTEGRITY_ALL);
    on->clock_ppm = ppm;
    return rig_session(on, NULL, observe, it);
}

/* ----------------------------------------------------------------------------------- fast or slow -- */

static void skewed(const char *name, int32_t ppm) {
    static bench on;
    static observer it;
    char text[80];
    memset(&it, 0, sizeof it);
    const bool whole = session(&on, &it, 0xFFFF0000U, ppm);
    const laconic_node_counters *c = &on.node.counters;
    snprintf(text, sizeof text, "%s, refused", name);
    tell(text, !whole + c->crc_errors + c->sequence_errors + c->refused + c->lost, true);
    snprintf(text, sizeof text, "%s, timeouts", name);
    tell(text, it.timeouts, true);
    snprintf(text, sizeof text, "%s, other bits", name);
    tell(text, it.other_bits, true);
    snprintf(text, sizeof text, "%s, periods of %d", name, FREE_TICKS);
    tell(text, it.periods, false);
    const int wanted = FREE_TICKS + (int)((int64_t)FREE_TICKS * ppm / 1000000);
    snprintf(text, sizeof text, "%s, periods beside the node's own time", name);
    tell(text, (int)it.periods < wanted - 1 || (int)it.periods > wanted + 1, true);
}

/* ------------------------------------------------------------------------------------ set anew -- */

/* The clock is set at every third event, by so much; a session's end may differ, but its motion is the core's, and a
 * new session begins at once. */
static void set_anew(const char *name, uint32_t by_us, int most_events) {
    static bench on;
    static observer it;
    char text[80];
    long long other = 0, not_back = 0, fewest = FREE_TICKS, most = 0;
    for (int at = 1; at < most_events; at += 3) {
        memset(&it, 0, sizeof it);
        it.shift_at = at;
        it.shift_us = by_us;
        (void)session(&on, &it, 0x80000000U, 0);
        other += it.other_bits;
        if (it.periods < fewest) fewest = it.periods;
        if (it.periods > most) most = it.periods;
        on.time_us += TICK_US;
        if (!rig_open(&on) || rig_command(&on, LACONIC_WIRE_COMMAND_RESET) != 0 ||
            rig_command(&on, LACONIC_WIRE_COMMAND_START_FREE_RUN) != 0)
            not_back++;
    }
    snprintf(text, sizeof text, "%s, other bits", name);
    tell(text, other, true);
    snprintf(text, sizeof text, "%s, not back", name);
    tell(text, not_back, true);
    snprintf(text, sizeof text, "%s, fewest periods", name);
    tell(text, fewest, false);
    snprintf(text, sizeof text, "%s, most periods", name);
    tell(text, most, most > FREE_TICKS + 1 && by_us > 0x80000000U);
}

/* ---------------------------------------------------------------------------------------- wraps -- */

static void compare(const char *name, bool whole, const bench *on, const bench *plain) {
    static int wrong;
    wrong = !whole || !same_motion(&on->node, &plain->node) || on->integrity.broken != 0;
    if (wrong) tell(name, 1, true);
}

/* The microseconds wrap at every 10 ms of the session. */
static void wrap_of_time(const bench *plain) {
    static bench on;
    int starts = 0;
    for (uint32_t before_us = 0; before_us < plain->time_us; before_us += 10000U, starts++) {
        bench_power_up(&on, 3, 0U - before_us, LACONIC_INTEGRITY_ALL);
        const bool whole = rig_session(&on, NULL, NULL, NULL);
        compare("wrap of the microseconds, wrong", whole, &on, plain);
    }
    tell("wrap of the microseconds, starts", starts, false);
}

/* Counts of the session's frames and of the node's, shortly before they wrap, after each command that clears them. */
static void near_wrap(bench *on, void *with) {
    laconic_node_session *s = &on->node.session;
    uint32_t *cleared = with;
    for (int k = 0; k < LACONIC_WIRE_RIG_OFFSETS; k++) {
        if (s->count[k] == 0 && s->open) s->count[k] = 0U - 5U;
    }
    for (int k = 0; k < LACONIC_WIRE_NODE_OFFSETS; k++)
        if (on->node.sent[k] == 0) on->node.sent[k] = 250;
    if (*cleared == 0 && on->node.state == LACONIC_WIRE_STATE_READY) {
        on->node.plant.steps = 0U - (uint64_t)50;
        *cleared = 1;
    }
}

static void wrap_of_counts(bench *plain) {
    static bench on;
    uint32_t cleared = 0;
    bench_power_up(&on, 3, 0, 0); /* what is set here without a call is no fault */
    const bool whole = rig_session(&on, NULL, near_wrap, &cleared);
    on.node.plant.steps += 50;
    compare("wrap of frame counts and steps, wrong", whole, &on, plain);
    tell("wrap of frame counts and steps, sessions", 1, false);
}

int campaign_clocks(void) {
    static bench plain;
    bench_power_up(&plain, 3, 1, LACONIC_INTEGRITY_ALL);
    if (!rig_session(&plain, NULL, NULL, NULL)) return 1;
    skewed("right", 0);
    skewed("1 % fast", 10000);
    skewed("1 % slow", -10000);
    set_anew("back by 1 ms", 0U - 1000U, 900);
    set_anew("back by 50 ms", 0U - 50000U, 900);
    set_anew("back by 10 s", 0U - 10000000U, 900);
    set_anew("forth by 1 ms", 1000U, 900);
    set_anew("forth by 50 ms", 50000U, 900);
    set_anew("forth by 10 s", 10000000U, 900);
    wrap_of_time(&plain);
    wrap_of_counts(&plain);
    return bad > 0;
}
