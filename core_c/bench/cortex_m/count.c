/* Counts the instructions of a step on the board: BENCH_STEPS of them, then twice as many, each in one window of
 * the 24-bit counter; and the stack that a step takes. */
#include "bench.h"
#include "bench_board.h"

#ifndef BENCH_STEPS
#error "bench: BENCH_STEPS, the steps to count, must be given"
#endif

static uint32_t ticks_for(uint32_t steps) {
    board_clock_start();
    const uint32_t before = board_clock_now();
    bench_run(steps);
    return board_clock_since(before);
}

static void one_step(void) { bench_step(); }

int main(void) {
    board_write_number("calibration", board_calibrate());
    bench_reset();
    board_write_number("steps", BENCH_STEPS);
    board_write_number("ticks_1", ticks_for(BENCH_STEPS));
    board_write_number("ticks_2", ticks_for(2U * BENCH_STEPS));
    write_state(board_write_bits, bench_state());
    board_write_number("stack", board_stack_of(one_step));
    board_write_number("status", (uint64_t)bench_run(1));
    return 0;
}
