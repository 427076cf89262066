/* Counts the instructions of a code behind a frame on the board: preparing a key, making and checking a code; and
 * whether two keys and messages cost the same to the instruction. */
#include "bench_board.h"
#include "laconic_secure/secoc.h"

#define ROUNDS 5 /* the counter has 24 bits */

static laconic_cmac_key key;
static uint8_t bytes[LACONIC_AES_BYTES], payload[LACONIC_SECOC_LONGEST], trailer[1 + LACONIC_SECOC_APART];
static uint64_t last;

static void prepare(size_t length) {
    (void)length;
    laconic_cmac_key_of(&key, bytes);
}

static void seal(size_t length) {
    laconic_secoc_seal(&key, 0x680, last + 1, payload, length, trailer, LACONIC_SECOC_APART);
}

static void open_sealed(size_t length) {
    last = 0;
    (void)laconic_secoc_open(&key, 0x680, &last, payload, length, trailer, LACONIC_SECOC_APART);
    last = 0;
}

static void count(const char *name, void (*volatile work)(size_t), size_t length) {
    board_clock_start();
    const uint32_t before = board_clock_now();
    for (int i = 0; i < ROUNDS; i++) work(length);
    board_write_number(name, board_clock_since(before));
}

static void count_all(const char *const names[4]) {
    count(names[0], prepare, 0);
    count(names[1], seal, 8);
    count(names[2], open_sealed, 8);
    count(names[3], seal, 64);
}

int main(void) {
    static const char *const zeros[4] = {"key", "seal_8", "open_8", "seal_64"};
    static const char *const others[4] = {"key_other", "seal_8_other", "open_8_other", "seal_64_other"};
    board_write_number("calibration", board_calibrate());
    count_all(zeros);
    for (unsigned i = 0; i < sizeof bytes; i++) bytes[i] = (uint8_t)(37U * i + 255U);
    for (unsigned i = 0; i < sizeof payload; i++) payload[i] = (uint8_t)(91U * i + 1U);
    count_all(others);
    return 0;
}
