/* Takes the steps of the bench, through the scene's segments in a cycle. */
#include "bench.h"

static laconic_state state;
#ifdef LACONIC_SCENE_SLIPS
static laconic_slip slip;
#endif
static uint32_t segment, taken; /* steps of this segment */

void bench_reset(void) {
    state = laconic_scene_start;
#ifdef LACONIC_SCENE_SLIPS
    slip = laconic_scene_slip;
#endif
    segment = taken = 0;
}

const laconic_state *bench_state(void) { return &state; }

#ifdef LACONIC_SCENE_SLIPS
const laconic_slip *bench_slip(void) { return &slip; }

static laconic_status held_step(const laconic_input *held) {
    return laconic_friction_step(&laconic_scene_friction, &laconic_scene_model, laconic_scene_integrator.step_s, &state,
                                 &slip, held);
}

static laconic_status sampled_step(const bench_segment *now) { return held_step(&now->middle); }

static void held_steps(const laconic_input *held, uint32_t count, laconic_status *status) {
    for (uint32_t taken = 0; taken < count && *status == LACONIC_OK; taken++) *status = held_step(held);
}
#else
static laconic_status sampled_step(const bench_segment *now) {
    return laconic_step_sampled(&laconic_scene_model, &laconic_scene_integrator, &state, &now->start, &now->middle,
                                &now->end);
}

static laconic_status held_step(const laconic_input *held) {
    return laconic_step(&laconic_scene_model, &laconic_scene_integrator, &state, held);
}

static void held_steps(const laconic_input *held, uint32_t count, laconic_status *status) {
    laconic_run(&laconic_scene_model, &laconic_scene_integrator, &state, held, count, status);
}
#endif

laconic_status bench_step(void) {
    const bench_segment *now = &bench_segments[segment];
    if (LACONIC_WITH_SAMPLED_INPUT && now->sampled) return sampled_step(now);
    return held_step(&now->start);
}

static uint32_t run_within_segment(uint32_t steps, laconic_status *failed) {
    const bench_segment *now = &bench_segments[segment];
    const uint32_t left = now->steps - taken, count = steps < left ? steps : left;
    laconic_status status = LACONIC_OK;
    if (LACONIC_WITH_SAMPLED_INPUT && now->sampled) {
        for (uint32_t i = 0; i < count && status == LACONIC_OK; i++) status = sampled_step(now);
    } else {
        held_steps(&now->start, count, &status);
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
