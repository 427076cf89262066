/* Two ODrives and a controller that speaks CANSimple to the first of them. */
#ifndef ODRIVE_BENCH_H
#define ODRIVE_BENCH_H

#include "drive_bench.h"

#define near(expected, actual, within) TEST_ASSERT_DOUBLE_WITHIN(within, (double)(expected), (double)(actual))

enum { NODE = 3, IDLE = 1, CLOSED_LOOP = 8, TORQUE = 1, VELOCITY = 2, POSITION = 3 };
enum { HEARTBEAT = 0x01, ESTOP = 0x02, GET_ERROR = 0x03, ADDRESS = 0x06, SET_STATE = 0x07, ESTIMATES = 0x09 };
enum { SET_MODE = 0x0B, INPUT_POS = 0x0C, INPUT_VEL = 0x0D, INPUT_TORQUE = 0x0E, LIMITS = 0x0F, REBOOT = 0x16 };
enum { CLEAR_ERRORS = 0x18, SET_POSITION = 0x19, SET_POS_GAIN = 0x1A, SET_VEL_GAINS = 0x1B, ENTER_DFU = 0x1F };
enum { PASSTHROUGH = 1, VEL_RAMP = 2, POS_FILTER = 3, TRAP_TRAJ = 5, TORQUE_RAMP = 6 };
enum { SUCCESS = 0, BUSY = 1, CANCELLED = 2, DISARMED = 3, HOMING_WITHOUT_ENDSTOP = 12, INVALID_STATE = 13 };

static laconic_frame frame;

static inline uint32_t id(uint32_t command) { return (uint32_t)NODE << 5 | command; }

static inline void send_words(uint32_t command, uint32_t first, uint32_t second) {
    const uint32_t words[2] = {first, second};
    bench_send(id(command), words, 8);
}

static inline void send_floats(uint32_t command, float first, float second) {
    const float floats[2] = {first, second};
    bench_send(id(command), floats, 8);
}

/* The answer to a remote frame. */
static inline const uint8_t *ask(uint32_t command) {
    const laconic_frame request = {.id = id(command), .length = 8, .remote = true};
    bench_drop_frames();
    drives.protocol->on_frame(&drives, &request, now_us);
    TEST_ASSERT_TRUE(bench_receive(id(command), &frame));
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    return frame.data;
}

static inline uint32_t ask_word(uint32_t command, uint32_t byte) {
    uint32_t word;
    memcpy(&word, ask(command) + byte, sizeof word);
    return word;
}

static inline void is_in(uint8_t state, uint8_t result) {
    bench_step();
    TEST_ASSERT_EQUAL_UINT8(state, ask(HEARTBEAT)[4]);
    TEST_ASSERT_EQUAL_UINT8(result, frame.data[5]);
}

static inline void close_loop(uint32_t control, uint32_t input) {
    send_words(SET_MODE, control, input);
    send_words(SET_STATE, CLOSED_LOOP, 0);
    is_in(CLOSED_LOOP, BUSY);
}

static inline laconic_real speed(void) {
    ask(ESTIMATES);
    return bench_float(frame.data + 4);
}

static inline laconic_real position(void) { return bench_float(ask(ESTIMATES)); }

#endif
