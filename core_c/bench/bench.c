/* Takes the steps of the bench, through the scene's segments in a cycle. */
#include "bench.h"

static laconic_state state;
static uint32_t segment, taken; /* steps of this segment */

void bench_reset(void) {
    state = laconic_scene_start;
    segment = taken = 0;
}

const laconic_state *bench_state(void) { return &state; }

static laconic_status sampled_step(const bench_segment *now) {
    return laconic_step_sampled(&laconic_scene_model, &laconic_scene_integrator, &state, &now->start, &now->middle,
                                &now->end);
}

laconic_status bench_step(void) {
    const bench_segment *now = &bench_segments[segment];
    if (LACONIC_WITH_SAMPLED_INPUT && now->sampled) return sampled_step(now);
    return laconic_step(&laconic_scene_model, &laconic_scene_integrator, &state, &now->start);
}

static uint32_t run_within_segment(uint32_t steps, laconic_status *failed) {
    const bench_segment *now = &bench_segments[segment];
    const uint32_t left = now->steps - taken, count = steps < left ? steps : left;
    laconic_status status = LACONIC_OK;
    if (LACONIC_WITH_SAMPLED_INPUT && now->sampled) {
        for (uint32_t i = 0; i < count && status == LACONIC_OK; i++) status = sampled_step(now);
    } else {
        laconic_run(&laconic_scene_model, &laconic_scene_integrator, &state, &now->start, count, &status);
    }
    if (status != LACONIC_OK) *failed = status;
    taken = (taken + count) % now->steps;
    if (taken == 0) segment = (segment + 1) % bench_segment_count;
    return count;
}

laconic_status bench_run(uint32_t steps) {
    laconic_status failed = LACONIC_OK;
    while (steps > 0) steps -= run_within_segment(steps, &failed);
    return failed;
}
