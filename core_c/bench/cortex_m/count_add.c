/* Counts the instructions of additions in double precision on the board, over a thousand random pairs of each kind; the
 * call and the loop around it are taken off. */
#include "bench_board.h"

#define PAIRS 1000

uint64_t __aeabi_dadd(uint64_t a, uint64_t b);

static uint64_t first[PAIRS], second[PAIRS];

__attribute__((noinline)) static uint64_t nothing(uint64_t a, uint64_t b) {
    __asm volatile("" : : "r"(&b));
    return a;
}

static uint64_t next(void) {
    static uint64_t state = 88172645463325252U;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
}

static uint64_t random_number(uint64_t exponents) { return next() >> 12 | (1000 + next() % exponents) << 52; }

static uint32_t ticks_of(uint64_t (*volatile add)(uint64_t, uint64_t)) {
    uint64_t (*const called)(uint64_t, uint64_t) = add;
    board_clock_start();
    const uint32_t before = board_clock_now();
    for (int i = 0; i < PAIRS; i++) called(first[i], second[i]);
    return board_clock_since(before);
}

static void count(const char *name) { board_write_number(name, ticks_of(__aeabi_dadd) - ticks_of(nothing)); }

static void fill(uint64_t exponents, uint64_t sign) {
    for (int i = 0; i < PAIRS; i++) {
        first[i] = random_number(exponents);
        second[i] = random_number(exponents) | sign << 63;
    }
}

int main(void) {
    board_write_number("calibration", board_calibrate());
    fill(30, 0);
    count("sum");
    fill(30, 1);
    count("difference");
    fill(1, 1);
    count("cancellation");
    for (int i = 0; i < PAIRS; i++) second[i] = 0;
    count("zero");
    return 0;
}
