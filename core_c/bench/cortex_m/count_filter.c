/* Counts the instructions of each part of a filter's cycle on the board, each in one window of the 24-bit counter; the
 * stack that each takes; and writes the estimate at the end. */
#include "bench_board.h"
#include "filter.h"

static uint32_t last_part;

static void again(void) { bench_part(last_part, bench_reading_count - 1U); }

static void nothing(void) {}

static uint32_t overhead(void) {
    board_clock_start();
    const uint32_t before = board_clock_now();
    nothing();
    return board_clock_since(before);
}

static laconic_status run(uint64_t ticks[BENCH_PARTS]) {
    laconic_status status = bench_filter_start();
    for (uint32_t cycle = 0; cycle < bench_reading_count && status == LACONIC_OK; cycle++)
        for (uint32_t part = 0; part < BENCH_PARTS && status == LACONIC_OK; part++) {
            board_clock_start();
            const uint32_t before = board_clock_now();
            status = bench_part(part, cycle);
            ticks[part] += board_clock_since(before);
        }
    return status;
}

int main(void) {
    uint64_t ticks[BENCH_PARTS] = {0};
    board_write_number("calibration", board_calibrate());
    board_write_number("overhead", overhead());
    const laconic_status status = run(ticks);
    for (uint32_t part = 0; part < BENCH_PARTS; part++) board_write_number(bench_part_names[part], ticks[part]);
    board_write_number("cycles", bench_reading_count);
    board_write_number("filter", sizeof(laconic_filter));
    board_write("estimate\n");
    bench_write_filter(board_write_bits);
    board_write("end\n");
    for (last_part = 0; last_part < BENCH_PARTS; last_part++) board_write_number("stack", board_stack_of(again));
    board_write_number("status", (uint64_t)status);
    return 0;
}
