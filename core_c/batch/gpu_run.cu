/* The lanes of a batch on a GPU: each thread takes the steps of one vehicle, by the methods' own text, which is compiled
 * for the device when the program runs (host_tests/laconic/gpu). The batch's memory and what a run leaves in it are those
 * of laconic_batch_run(). One kernel has one method, LACONIC_GPU_METHOD by the numbers of lanes_method with its function
 * LACONIC_GPU_STEP, and leaves lanes of others to theirs. */
#define LACONIC_IN_CORE /* laconic/build.h */
#include "laconic/batch.h"

#include "../src/elementary.c"
#include "../src/step_internals.c"

#include "../src/eighth_order.h" /* of two methods: a file's text stands where it is included first */

#if LACONIC_GPU_METHOD == 0
#include "../src/rk4.c"
#endif
#if LACONIC_GPU_METHOD == 1 || LACONIC_GPU_METHOD == 2 || LACONIC_GPU_METHOD >= 7
#include "../src/exponential_kahan.c"
#endif
#if LACONIC_GPU_METHOD == 3 || LACONIC_GPU_METHOD == 4 || LACONIC_GPU_METHOD >= 7
#include "../src/exact_flow.c"
#endif
#if LACONIC_GPU_METHOD == 5
#include "../src/taylor_8.c"
#endif
#if LACONIC_GPU_METHOD >= 6
#include "../src/exponential_gauss_8.c"
#endif
#if LACONIC_GPU_METHOD >= 7 /* auto_slow and auto_fast, which try several */
#include "../src/auto.c"
#endif

#include "batch_run.c"

static_assert(sizeof(laconic_batch_kind) == LACONIC_GPU_KIND_BYTES, "kinds have another layout here than on the host");

/* laconic_run() with the method known, so that all of a step is inlined. */
INLINE uint64_t gpu_run(const laconic_batch_kind *kind, laconic_state *state, const laconic_input *held, uint64_t steps,
                        laconic_status *status) {
    laconic_forcing forcing;
    laconic_forcing_samples samples = {&forcing, &forcing, &forcing, true};
    uint64_t taken = 0;
    *status = LACONIC_OVERFLOW;
    if (zero_if_finite(world_force_point(held)) != R(0)) return 0;
    forcing_of(&forcing, &kind->model, held);
    samples.is_constant = !forcing.rotates;
    for (*status = LACONIC_OK; taken < steps; taken++) {
        *status = heading_has_room(&state->heading) ? LACONIC_GPU_STEP(&kind->model, &kind->integrator, state, &samples)
                                                    : LACONIC_OVERFLOW;
        if (*status != LACONIC_OK) break;
    }
    return taken;
}

/* `batch` points into a copy of its memory, which begins `here` and on the host began `there`, as its blocks still say;
 * `width`: how many lanes a block has. */
extern "C" __global__ void laconic_gpu_run(laconic_batch *batch, unsigned char *here, const unsigned char *there,
                                           int32_t width, uint64_t steps) {
    const int32_t lane = (int32_t)(blockIdx.x * blockDim.x + threadIdx.x);
    if (lane >= batch->shape.lane_count) return;
    laconic_batch_block *block = &batch->blocks[batch->slot_of[lane] / width];
    if (block->method != LACONIC_GPU_METHOD) return;
    const place at = {here + (block->state - there), (size_t)width * sizeof(real), batch->slot_of[lane] % width};
    laconic_state state;
    laconic_input input;
    laconic_status status;
    state_in(&state, &at);
    laconic_batch_input(batch, lane, &input);
    const uint64_t taken = gpu_run(&batch->kinds[batch->kind_of[lane]], &state, &input, steps, &status);
    put_state(&at, &state);
    mark_far(block, &state);
    *number_of(batch, ROW_X, lane) = state.x_m.value;
    *number_of(batch, ROW_Y, lane) = state.y_m.value;
    batch->status[lane] = (int32_t)status;
    batch->missed[lane] += steps - taken;
}
