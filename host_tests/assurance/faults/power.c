/* Power is lost between any two frames of a session: of the node, which begins anew and hears the rest of the frames
 * as if nothing had happened; or of the rig, after which nothing comes any more. Nothing may move that has not been
 * asked to, and a new rig must reach the end of a session of its own with the same motion as ever. */
#include "campaigns.h"

#include <stdio.h>
#include <string.h>

static recording golden;
static bench golden_end;

typedef struct tally {
    int moments, moved, undefined, not_back, other_motion;
    uint32_t steps;      /* of a node that had lost its power, before a new session */
    uint32_t coasted_us; /* longest with voltages after the rig's last frame          */
} tally;

static void play(bench *on, int from, int to) {
    laconic_frame sent;
    for (int k = from; k < to; k++) {
        on->time_us = golden.event[k].time_us;
        if (golden.event[k].is_tick)
            bench_tick(on);
        else
            bench_frame(on, &golden.event[k].frame);
        while (bench_next(on, &sent)) {
        }
    }
}

static bool has_voltage(const laconic_node *node) {
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++)
        if (node->input[0].voltage_V[i] != 0) return true;
    return false;
}

/* A session of a new rig ends as that of the first one. The vehicle is loaded anew, so it starts where that one did. */
static void come_back(bench *on, tally *result) {
    if (!rig_session(on, NULL, NULL, NULL))
        result->not_back++;
    else if (!same_motion(&on->node, &golden_end.node))
        result->other_motion++;
}

static void node_restarts(const bench *before, int event, tally *result) {
    static bench on;
    bench_power_up(&on, 4711U + (uint32_t)event, before->time_us * 3U, before->checks);
    for (int k = event; k < golden.events; k++) {
        play(&on, k, k + 1);
        if (is_moving(&on.node) || has_voltage(&on.node)) result->moved++;
    }
    result->steps += (uint32_t)on.node.plant.steps;
    if (on.node.state != LACONIC_WIRE_STATE_EMPTY) result->undefined++;
    come_back(&on, result);
}

/* The watchdog of a free run ends the voltages; in lockstep nothing moves without a frame. */
static void rig_is_silent(const bench *before, tally *result) {
    static bench on;
    memcpy(&on, before, sizeof on);
    const uint32_t last_us = on.time_us;
    const uint64_t steps = on.node.plant.steps;
    const bool was_free = on.node.state == LACONIC_WIRE_STATE_FREE_RUN;
    laconic_frame sent;
    for (int k = 0; k < 80; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
        while (bench_next(&on, &sent)) {
        }
        if (was_free && has_voltage(&on.node) && on.time_us - last_us > result->coasted_us)
            result->coasted_us = on.time_us - last_us;
    }
    const uint8_t state = on.node.state;
    if (was_free ? state != LACONIC_WIRE_STATE_TIMEOUT || has_voltage(&on.node) : on.node.plant.steps > steps + 1)
        result->moved++;
    if (!was_free && state != before->node.state) result->undefined++;
    come_back(&on, result);
}

static int tell(const char *who, const tally *result) {
    printf("%s|moments|%d\n%s|moved|%d\n%s|undefined|%d\n%s|not back|%d\n%s|other motion|%d\n", who, result->moments,
           who, result->moved + (int)result->steps, who, result->undefined, who, result->not_back, who,
           result->other_motion);
    return result->moved + (int)result->steps + result->undefined + result->not_back + result->other_motion > 0;
}

int campaign_power(void) {
    static bench on;
    tally node = {0}, rig = {0};
    bench_power_up(&golden_end, 1905, 0, LACONIC_INTEGRITY_ALL);
    if (!rig_session(&golden_end, &golden, NULL, NULL)) return 1;
    bench_power_up(&on, 1905, 0, LACONIC_INTEGRITY_ALL);
    for (int k = 0; k < golden.events; k++) {
        play(&on, k, k + 1);
        node_restarts(&on, k + 1, &node);
        rig_is_silent(&on, &rig);
        node.moments++;
        rig.moments++;
    }
    const int bad = tell("node", &node) + tell("rig", &rig);
    printf("rig|longest voltage us|%u\n", (unsigned)rig.coasted_us);
    return bad > 0;
}
