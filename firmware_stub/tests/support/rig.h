/* A bus with one node and one rig in virtual time. Records one session with everything that a vehicle needs, frame by
 * frame, so that it can be played again to a node in which something has failed. */
#ifndef LACONIC_TEST_RIG_H
#define LACONIC_TEST_RIG_H

#include "laconic_node/integrity.h"

enum { MOST_EVENTS = 1200, MOST_FRAMES = 2400, TICK_US = 5000, WATCHDOG_MS = 100, FREE_TICKS = 270, LOCK_STEPS = 20 };

/* A node with what watches its memory, and the time. `checks` 0: the node alone. `clock_ppm`: how much faster its clock
 * is than the rig's; `shift_us`: by how much it was set forwards. */
typedef struct bench {
    laconic_node node;
    laconic_integrity integrity;
    laconic_node_config config;
    uint8_t checks;
    uint32_t time_us, start_us, shift_us; /* of the rig's clock since the start; the node's at the start */
    int32_t clock_ppm;
} bench;

/* What happens on the bus: a frame of the rig, or a tick of the node. */
typedef struct bus_event {
    uint32_t time_us;
    bool is_tick;
    laconic_frame frame;
} bus_event;

typedef struct recording {
    bus_event event[MOST_EVENTS];
    laconic_frame sent[MOST_FRAMES]; /* by the node */
    int sent_until[MOST_EVENTS];     /* frames that it had sent after each event */
    int events, frames;
    int commit, free_run, lockstep; /* the first events of each part */
} recording;

/* A node that has just got power. */
void bench_power_up(bench *on, uint32_t nonce_seed, uint32_t start_us, uint8_t checks);
uint32_t bench_node_time(const bench *on);
void bench_frame(bench *on, const laconic_frame *frame);
void bench_tick(bench *on);
bool bench_next(bench *on, laconic_frame *frame);

/* The whole session of a rig with this node: handshake, vehicle, free run, lockstep, stop. `to`: what is recorded, or
 * NULL. `watch`: called after each event, or NULL. False iff a command was refused. */
typedef void (*bench_watch)(bench *on, void *with);
bool rig_session(bench *on, recording *to, bench_watch watch, void *with);

/* A new rig's handshake and one command; its status, 255: no answer. */
uint8_t rig_command(bench *on, uint8_t command);
bool rig_open(bench *on);

bool is_moving(const laconic_node *node);
/* The motion's numbers, all their bits. */
bool same_motion(const laconic_node *a, const laconic_node *b);

#endif
