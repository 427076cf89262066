/* A scene's steps in a loop: the same code is timed on the host, counted there and on a Cortex-M.
 *
 * The scene's tables are generated as constants (laconic.report.tables), so nothing is prepared here: what the
 * linker keeps is what a control loop needs. */
#ifndef BENCH_H
#define BENCH_H

#include "laconic/laconic.h"

typedef struct bench_segment { /* an interval with the input held */
    uint32_t steps;
    laconic_input input;
} bench_segment;

extern const laconic_model bench_model;
extern const laconic_integrator bench_integrator;
extern const laconic_state bench_start;
extern const bench_segment bench_segments[];
extern const uint32_t bench_segment_count;

void bench_reset(void);

/* Steps on through the segments, again and again. The first refusal stays and is returned. */
laconic_status bench_run(uint32_t steps);

/* Where the vehicle is now. */
const laconic_state *bench_state(void);

#endif
