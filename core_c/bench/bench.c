#include "bench.h"

static laconic_state state;
static uint32_t segment, taken; /* steps of this segment */
static laconic_status failed;

void bench_reset(void) {
    state = bench_start;
    segment = taken = 0;
    failed = LACONIC_OK;
}

const laconic_state *bench_state(void) { return &state; }

static uint32_t run_within_segment(uint32_t steps) {
    const bench_segment *now = &bench_segments[segment];
    const uint32_t left = now->steps - taken, count = steps < left ? steps : left;
    for (uint32_t i = 0; i < count; i++) {
        const laconic_status status = laconic_step(&bench_model, &bench_integrator, &state, &now->input);
        if (status != LACONIC_OK) failed = status;
    }
    taken = (taken + count) % now->steps;
    if (taken == 0) segment = (segment + 1) % bench_segment_count;
    return count;
}

laconic_status bench_run(uint32_t steps) {
    while (steps > 0) steps -= run_within_segment(steps);
    return failed;
}
