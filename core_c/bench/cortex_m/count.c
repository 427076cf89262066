/* Counts the instructions of a step on the board: BENCH_STEPS steps in one window of the 24-bit counter. */
#include "bench.h"
#include "board.h"

#ifndef BENCH_STEPS
#error "bench: BENCH_STEPS, the steps to count, must be given"
#endif

static void write_state(const laconic_state *state) {
    for (int k = 0; k < 3; k++) board_write_bits("zeta", &state->zeta[k].value, sizeof(laconic_real));
    board_write_bits("x", &state->x_m.value, sizeof(laconic_real));
    board_write_bits("y", &state->y_m.value, sizeof(laconic_real));
    board_write_bits("heading", &state->heading.fraction, sizeof(laconic_turn));
}

static uint32_t ticks_for(uint32_t steps) {
    board_clock_start();
    const uint32_t before = board_clock_now();
    bench_run(steps);
    return board_clock_since(before);
}

int main(void) {
    board_write_number("calibration", board_calibrate());
    bench_reset();
    bench_run(BENCH_STEPS);
    board_write_number("steps", BENCH_STEPS);
    board_write_number("ticks_1", ticks_for(BENCH_STEPS));
    board_write_number("ticks_2", ticks_for(2U * BENCH_STEPS));
    write_state(bench_state());
    board_write_number("status", (uint64_t)bench_run(1));
    return 0;
}
