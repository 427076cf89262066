/* One bit of the node's memory is flipped in the midst of a session, and the session goes on to its end. What the rig
 * then sees is compared with what it saw of a node that nothing happened to.
 *
 * A bit is tried in a process of its own family: a wrong pointer ends it, as it would restart a board. */
#define _GNU_SOURCE
#include "campaigns.h"

#include "laconic_node/protection.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOMENTS = 12, LOADING = 4, FIRST_S_EVENTS = 300, PATIENCE_US = 300000 };

typedef enum outcome {
    HARMLESS, /* the motion is the same to the last bit                                         */
    SILENT,   /* it is not, and nobody was told                                                */
    BY_MODEL, /* noticed by the node: MEMORY_CHANGED with this item                            */
    BY_RANGE,
    BY_MOTION,
    BY_LOADED,
    BY_CONFIGURATION,
    BY_CORE, /* the core refused a step, the loader or the node an order                       */
    BY_RIG,  /* frames are missing, wrong or too many, or HEARTBEAT tells another state        */
    CRASH,   /* a wrong pointer: a board restarts, and the rig finds it EMPTY                    */
    HANG,    /* a call did not end: a board's watchdog restarts it                               */
    OUTCOMES
} outcome;

static const char *const outcome_names[OUTCOMES] = {"harmless",      "silent", "model", "range", "motion", "loaded",
                                                    "configuration", "core",   "rig",   "crash", "hang"};

typedef struct found {
    uint8_t what; /* outcome */
    uint32_t after_us;
} found;

typedef struct moment {
    int event; /* the flip comes before it */
    bench on;
} moment;

static recording golden;
static bench golden_end;
static moment moments[MOMENTS + LOADING];

/* ------------------------------------------------------------------------- which bit, and when -- */

typedef struct area {
    const char *name;
    size_t offset, size;
} area;

#define AREA(name, member) {name, offsetof(laconic_node, member), sizeof(((laconic_node *)NULL)->member)}

/* Of two that overlap the first counts; what none has is the run's. */
static const area areas[] = {
    AREA("configuration", config),
    AREA("session", session),
    AREA("loader", loader),
    AREA("vehicle and start", start),
    AREA("vehicle and start", plant.vehicle),
    AREA("model", plant.model),
    AREA("model", plant.integrator),
    AREA("friction", plant.friction),
    AREA("friction", plant.slip),
    AREA("state", plant.state),
    AREA("state", plant.steps),
    AREA("inputs", input),
    AREA("inputs", raw_input),
    AREA("outputs", raw_output),
    AREA("outputs", answer),
    AREA("outputs", sent),
    AREA("drives", drive_plan),
    AREA("drives", drives),
    AREA("drives", axes),
    AREA("sensors", sensors),
};

enum { AREAS = sizeof areas / sizeof areas[0] };

static int area_of(size_t byte) {
    for (int k = 0; k < AREAS; k++)
        if (byte - areas[k].offset < areas[k].size) return k;
    return AREAS;
}

static const char *name_of(int k) { return k < AREAS ? areas[k].name : "run"; }

static uint64_t stir(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
}

/* Each number of a sample is another bit: a prime has no divisor in common with their count. */
static size_t bit_of(uint64_t k, uint64_t seed) {
    const uint64_t bits = 8 * sizeof(laconic_node);
    return (size_t)((k * 999999937U + stir(seed)) % bits);
}

/* What is loaded is used at COMMIT alone. */
static const moment *moment_of(size_t bit, uint64_t seed) {
    const uint64_t drawn = stir(seed ^ (bit + 0x9E3779B97F4A7C15U));
    if (strcmp(name_of(area_of(bit / 8)), "loader") == 0) return &moments[MOMENTS + drawn % LOADING];
    return &moments[drawn % MOMENTS];
}

/* ------------------------------------------------------------------------------- what is noticed -- */

static uint32_t offset_of(const laconic_frame *frame) { return frame->id - LACONIC_WIRE_ID_BASE; }

static bool is_value(const laconic_frame *frame) {
    return offset_of(frame) == LACONIC_WIRE_NU || offset_of(frame) == LACONIC_WIRE_POSE;
}

/* What a RESULT that was not expected tells; the number of a refused command is the node's as well. */
static outcome told_by(const laconic_frame *result) {
    const uint8_t status = result->data[3];
    if (status != LACONIC_WIRE_STATUS_MEMORY_CHANGED) return status != 0 ? BY_CORE : BY_RIG;
    const uint8_t item = result->data[5];
    return item >= 1 && item <= 5 ? (outcome)(BY_MODEL + item - 1) : BY_RIG;
}

/* A frame beside the one that was expected. Numbers of the motion that differ are what nobody sees. */
static outcome compared(const laconic_frame *is, const laconic_frame *should) {
    if (is->id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT && memcmp(is, should, sizeof *is) != 0) return told_by(is);
    if (is->id != should->id || is->length != should->length) return BY_RIG;
    if (memcmp(is->data, should->data, sizeof is->data) == 0) return HARMLESS;
    if (!is_value(is) || ((is->data[1] ^ should->data[1]) & 15U) != 0) return BY_RIG;
    return laconic_plain_is_right((uint8_t)offset_of(is), is->data) ? SILENT : BY_RIG;
}

/* What the node sends after one event. A RESULT that nobody expected comes before all other frames. */
static outcome drained(bench *on, int event) {
    const int first = event == 0 ? 0 : golden.sent_until[event - 1];
    const int expected = golden.sent_until[event] - first;
    outcome seen = HARMLESS;
    laconic_frame frame;
    int count = 0;
    for (; bench_next(on, &frame); count++) {
        outcome now = count < expected ? compared(&frame, &golden.sent[first + count]) : BY_RIG;
        if (now == BY_RIG && offset_of(&frame) == LACONIC_WIRE_RESULT) now = told_by(&frame);
        if (now > SILENT) return now;
        if (now == SILENT) seen = SILENT;
        if (count > 64) return BY_RIG;
    }
    return count < expected ? BY_RIG : seen;
}

static found try_bit(size_t bit, const moment *when) {
    static bench on;
    found result = {HARMLESS, 0};
    memcpy(&on, &when->on, sizeof on);
    ((uint8_t *)&on.node)[bit / 8] ^= (uint8_t)(1U << bit % 8);
    for (int k = when->event; k < golden.events; k++) {
        on.time_us = golden.event[k].time_us;
        if (golden.event[k].is_tick)
            bench_tick(&on);
        else
            bench_frame(&on, &golden.event[k].frame);
        const outcome now = drained(&on, k);
        if (now == SILENT) result.what = SILENT;
        if (now <= SILENT) continue;
        result.what = (uint8_t)now;
        result.after_us = on.time_us - when->on.time_us;
        return result;
    }
    if (!same_motion(&on.node, &golden_end.node)) result.what = SILENT;
    return result;
}

/* ------------------------------------------------------------------------------------- all bits -- */

static void at_event(bench *on, void *with) {
    int *event = with;
    ++*event; /* of the next one */
    for (int k = 0; k < MOMENTS + LOADING; k++)
        if (moments[k].event == *event) memcpy(&moments[k].on, on, sizeof *on);
}

static bool prepare(uint64_t seed, uint8_t checks) {
    int event = 0;
    bench_power_up(&golden_end, 1905, 0xFFFF0000U, checks);
    if (!rig_session(&golden_end, &golden, NULL, NULL)) return false;
    for (int k = 0; k < MOMENTS; k++)
        moments[k].event = golden.free_run + 3 + (int)(stir(seed + (uint64_t)k) % (FIRST_S_EVENTS - 3));
    for (int k = 0; k < LOADING; k++)
        moments[MOMENTS + k].event = golden.commit - (int)(stir(seed + 77U + (uint64_t)k) % 30U);
    bench_power_up(&golden_end, 1905, 0xFFFF0000U, checks);
    return rig_session(&golden_end, NULL, at_event, &event);
}

typedef struct shared {
    uint64_t next;
    found result[];
} shared;

/* SIGPROF ends a call that does not. */
static void work(shared *with, uint64_t from, uint64_t to, uint64_t seed) {
    const struct itimerval patience = {{0, 0}, {0, PATIENCE_US}};
    (void)!freopen("/dev/null", "w", stderr);
    for (uint64_t k = with->next; k < to; k++) {
        const size_t bit = bit_of(k, seed);
        with->next = k + 1;
        setitimer(ITIMER_PROF, &patience, NULL);
        with->result[k - from] = try_bit(bit, moment_of(bit, seed));
    }
    _exit(0);
}

static void try_all(shared *with, uint64_t from, uint64_t to, uint64_t seed) {
    with->next = from;
    while (with->next < to) {
        int status = 0;
        const pid_t child = fork();
        if (child == 0) work(with, from, to, seed);
        if (child < 0 || waitpid(child, &status, 0) != child) exit(1);
        if (!WIFSIGNALED(status) && WEXITSTATUS(status) == 0) continue;
        const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF;
        with->result[with->next - 1 - from].what = hung ? HANG : CRASH;
    }
}

/* "area outcome bits mean_us worst_us" for each that there is. */
static void tell(const shared *with, uint64_t from, uint64_t to, uint64_t seed) {
    static uint64_t count[AREAS + 1][OUTCOMES], sum_us[AREAS + 1][OUTCOMES], worst_us[AREAS + 1][OUTCOMES];
    for (uint64_t k = from; k < to; k++) {
        const found *it = &with->result[k - from];
        const int where = area_of(bit_of(k, seed) / 8);
        count[where][it->what]++;
        sum_us[where][it->what] += it->after_us;
        if (it->after_us > worst_us[where][it->what]) worst_us[where][it->what] = it->after_us;
        if ((it->what == SILENT || it->what >= CRASH) && getenv("LACONIC_CAMPAIGN_TELLS") != NULL)
            fprintf(stderr, "%s: %s, bit %zu of byte %zu\n", outcome_names[it->what], name_of(where),
                    bit_of(k, seed) % 8, bit_of(k, seed) / 8);
    }
    for (int k = 0; k <= AREAS; k++)
        for (int n = 0; n < OUTCOMES; n++)
            if (count[k][n] > 0)
                printf("%s|%s|%llu|%llu|%llu\n", name_of(k), outcome_names[n], (unsigned long long)count[k][n],
                       (unsigned long long)sum_us[k][n], (unsigned long long)worst_us[k][n]);
}

int campaign_memory(uint64_t from, uint64_t to, uint64_t seed, uint8_t checks) {
    const size_t size = sizeof(shared) + (size_t)(to - from) * sizeof(found);
    shared *with = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (with == MAP_FAILED || to <= from || to > 8 * sizeof(laconic_node)) return 2;
    if (!prepare(seed, checks)) {
        fprintf(stderr, "fault_campaign: the session without a fault was refused\n");
        return 1;
    }
    try_all(with, from, to, seed);
    tell(with, from, to, seed);
    return 0;
}
