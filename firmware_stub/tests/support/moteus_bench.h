/* Two moteus controllers and a host that writes registers of the first of them. */
#ifndef MOTEUS_BENCH_H
#define MOTEUS_BENCH_H

#include "drive_bench.h"

#define near(expected, actual, within) TEST_ASSERT_DOUBLE_WITHIN(within, (double)(expected), (double)(actual))

enum { NODE = 1, ASK = 0x8000, TO_NODE = ASK | NODE, REPLY = NODE << 8 };
#define GEAR 4
enum {
    STOPPED = 0,
    FAULT = 1,
    CURRENT = 9,
    POSITION = 10,
    TIMEOUT = 11,
    ZERO_VELOCITY = 12,
    STAY_WITHIN = 13,
    BRAKE = 15
};

static laconic_frame frame;

static const laconic_real none = (laconic_real)(1e300 * 1e10 * 0);

/* A frame in the making. */
static struct {
    uint8_t data[64];
    uint8_t length;
} out;

static inline void put(const void *data, size_t length) {
    memcpy(out.data + out.length, data, length);
    out.length = (uint8_t)(out.length + length);
}

static inline void put_mode(uint8_t mode) {
    const uint8_t subframe[] = {0x01, 0x00, mode};
    put(subframe, 3);
}

static inline void put_float(uint8_t number, laconic_real value) {
    const uint8_t subframe[] = {0x0D, number};
    const float narrow = (float)value;
    put(subframe, 2);
    put(&narrow, 4);
}

static inline void send(void) {
    bench_send(TO_NODE, out.data, out.length);
    out.length = 0;
}

static inline const uint8_t *reply(void) {
    TEST_ASSERT_TRUE(bench_receive(REPLY, &frame));
    return frame.data;
}

/* A frame that gets an answer, byte by byte. */
static inline void answers(const char *request, size_t length, const char *expected, size_t expected_length) {
    bench_send(TO_NODE, request, (uint8_t)length);
    reply();
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, frame.data, expected_length);
    for (size_t k = expected_length; k < frame.length; k++) TEST_ASSERT_EQUAL_HEX8(0x50, frame.data[k]);
}
#define ANSWERS(request, expected) answers(request, sizeof(request) - 1, expected, sizeof(expected) - 1)

static inline laconic_real read_float(uint8_t number) {
    const uint8_t request[] = {0x1D, number};
    bench_drop_frames();
    bench_send(TO_NODE, request, 2);
    TEST_ASSERT_EQUAL_HEX8(0x2D, reply()[0]);
    return bench_float(frame.data + 2);
}

/* Steps with the acting command repeated, as a controller does. */
static inline void hold(laconic_real position, laconic_real velocity, int32_t steps) {
    for (int32_t k = 0; k < steps; k++) {
        if (k % 20 == 0) {
            put_mode(POSITION);
            put_float(0x20, k == 0 ? position : none);
            put_float(0x21, velocity);
            send();
        }
        bench_steps(1);
    }
}

#endif
