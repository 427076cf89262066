/* Counts the instructions of each of BENCH_STEPS steps by itself: those of a friction step differ from step to step. */
#include "bench.h"
#include "bench_board.h"

#ifndef BENCH_STEPS
#error "bench: BENCH_STEPS, the steps to count, must be given"
#endif

static uint32_t ticks[BENCH_STEPS];

static uint32_t ticks_for(uint32_t steps) {
    board_clock_start();
    const uint32_t before = board_clock_now();
    bench_run(steps);
    return board_clock_since(before);
}

int main(void) {
    board_write_number("calibration", board_calibrate());
    bench_reset();
    for (uint32_t k = 0; k < BENCH_STEPS; k++) ticks[k] = ticks_for(1);
    for (uint32_t k = 0; k < BENCH_STEPS; k++) board_write_number("ticks", ticks[k]);
    board_write_number("overhead", ticks_for(0));
    write_state(board_write_bits, bench_state());
    return 0;
}
