/* A scene's steps in a loop: the same code is timed on the host, counted there and on a Cortex-M.
 *
 * Model, integrator and start are generated constants (`laconic trim`), and so are the segments here, so the
 * linker keeps only what a control loop needs. */
#ifndef BENCH_H
#define BENCH_H

#include "laconic_scene_model.h"

typedef struct bench_segment { /* some steps with the input held, or one step with it sampled */
    uint32_t steps;
    bool sampled;
    laconic_input start, middle, end; /* held: only start is used */
} bench_segment;

extern const bench_segment bench_segments[];
extern const uint32_t bench_segment_count;

void bench_reset(void);

/* One step of the current segment. */
laconic_status bench_step(void);

/* Takes steps through the segments in a cycle. A refusal does not end the run; the last one is returned. */
laconic_status bench_run(uint32_t steps);

/* The present state. */
const laconic_state *bench_state(void);

#ifdef LACONIC_SCENE_SLIPS /* wheels have states of their own */
#define BENCH_STATE_BYTES (sizeof(laconic_state) + sizeof(laconic_slip))
const laconic_slip *bench_slip(void);
#else
#define BENCH_STATE_BYTES sizeof(laconic_state)
#endif

#endif
