/* Many vehicles with hinges: each lane by laconic_articulated_step() or laconic_tree_step(), one after the other. Their
 * trees differ too much in shape for lanes of a register. */
#include "laconic/batch.h"

#if LACONIC_MAX_BODIES > 0

/* The kind of a lane. */
static const laconic_articulated_kind *articulated_kind_of(const laconic_articulated_batch *batch, int32_t lane) {
    return &batch->kinds[batch->kind_of[lane]];
}

/* One step of a lane. */
static laconic_status step_articulated_lane(laconic_articulated_batch *batch, int32_t lane) {
    const laconic_articulated_kind *kind = articulated_kind_of(batch, lane);
#if LACONIC_WITH_FRICTION
    if (kind->tree != NULL)
        return laconic_tree_step(kind->tree, kind->tree_step_s, &batch->tree_states[lane], &batch->tree_inputs[lane],
                                 &batch->why[lane]);
#endif
    const laconic_articulated_input *held = &batch->inputs[lane];
    return laconic_articulated_step(kind->model, &kind->integrator, &batch->states[lane], held, held,
                                    &batch->why[lane]);
}

/* Runs one lane until a step is refused. */
static laconic_status run_articulated_lane(laconic_articulated_batch *batch, int32_t lane, uint64_t steps) {
    laconic_status status = LACONIC_OK;
    uint64_t left = steps;
    for (; left > 0; left--) {
        status = step_articulated_lane(batch, lane);
        if (status != LACONIC_OK) break;
    }
    batch->missed[lane] += left;
    return status;
}

int32_t laconic_articulated_batch_run(laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                      uint64_t steps) {
    int32_t refused = 0;
    for (int32_t lane = first_lane; lane < first_lane + lanes; lane++) {
        batch->status[lane] = (int32_t)run_articulated_lane(batch, lane, steps);
        refused += batch->status[lane] != LACONIC_OK;
    }
    return refused;
}

#if LACONIC_WITH_FRICTION
void laconic_articulated_batch_outputs(const laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                       laconic_tree_outputs *outputs) {
    for (int32_t k = 0; k < lanes; k++) {
        const int32_t lane = first_lane + k;
        laconic_tree_outputs_of(&outputs[k], articulated_kind_of(batch, lane)->tree, &batch->tree_states[lane]);
    }
}
#endif

static void observe_articulated_lane(const laconic_articulated_batch *batch, int32_t lane,
                                     laconic_articulated_motion *motion) {
    const laconic_articulated_kind *kind = articulated_kind_of(batch, lane);
#if LACONIC_WITH_FRICTION
    if (kind->tree != NULL) {
        laconic_tree_motion_of(motion, kind->tree, &batch->tree_states[lane]);
        return;
    }
#endif
    laconic_articulated_motion_of(motion, kind->model, &batch->states[lane]);
}

void laconic_articulated_batch_observe(const laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                       laconic_articulated_motion *motions) {
    for (int32_t k = 0; k < lanes; k++) observe_articulated_lane(batch, first_lane + k, &motions[k]);
}

#endif
