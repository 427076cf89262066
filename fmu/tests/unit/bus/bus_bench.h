/* What the tests of the bus share: frames that a node sends to it, and the time of one. */
#ifndef BUS_BENCH_H
#define BUS_BENCH_H

#include "frame_time.h"
#include "model_interface.h"
#include "network_bench.h"

static inline void put(uint32_t id, bool extended, bool remote) {
    const laconic_frame frame = {
        .id = id, .length = remote ? 0 : 1, .extended = extended, .remote = remote, .data = {9}};
    TEST_ASSERT_TRUE(ls_bus_put_frame(&out, &frame, false));
}

static inline void send(const char *node) {
    give(node, &out);
    out.size = 0;
}

/* Of a frame with one byte at 1 Mbit/s. */
#define ONE_S 55e-6

static inline void begin(void) { OK(begin_from(0)); }

/* A frame on a bus that has carried all but five of the frames that it can count, five of them with an error; every so
 * many have one. */
static inline fmu_model *one_frame_near_the_last_number(int32_t error_every) {
    set_integer("error_every", error_every);
    begin();
    fmu_model *model = &instance()->model;
    model->carried = INT32_MAX - 5;
    model->failed = 5;
    put(0x30, false, false);
    send("Node1");
    update();
    step(0, 1e-3);
    return model;
}

#endif
