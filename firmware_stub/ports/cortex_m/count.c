/* Counts the instructions of the node for a frame and for a step, under QEMU with -icount; prints them and ends. */
#include "bench_board.h"
#include "laconic_node/integrity.h"
#include "laconic_node/protection.h"
#include "laconic_node/slcan.h"
#include "laconic_wire.h"
#include "linked.h"

#include <string.h>

static laconic_node node;
static laconic_slcan slcan;
static uint32_t ticks_of_65536;

/* Three omni wheels with motors: the scene s1 in round numbers. */
static const laconic_vehicle vehicle = {
    .mass_kg = 10,
    .yaw_inertia_kgm2 = (laconic_real)0.225,
    .wheel_radius_m = (laconic_real)0.05,
    .wheel_inertia_kgm2 = (laconic_real)0.009,
    .motor_gain_Nm_per_V = (laconic_real)0.5,
    .motor_damping_Nms = (laconic_real)0.02,
    .wheel_count = 3,
    .wheel = {{LACONIC_WHEEL_ROLLER, false, (laconic_real)0.05, 0, 0, (laconic_real)1.5707963267948966},
              {LACONIC_WHEEL_ROLLER, false, (laconic_real)-0.05, 0, (laconic_real)3.141592653589793,
               (laconic_real)1.5707963267948966},
              {LACONIC_WHEEL_ROLLER, false, 0, (laconic_real)0.06, (laconic_real)1.5707963267948966,
               (laconic_real)1.5707963267948966}},
};

static void print_count(const char *what, uint32_t ticks, uint32_t times) {
    board_write_number(what, (uint64_t)ticks * 65536U / ticks_of_65536 / times);
}

static void voltage_frame(laconic_frame *frame, uint8_t counter) {
    memset(frame, 0, sizeof *frame);
    frame->id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_VOLTAGE;
    frame->length = 8;
    frame->data[1] = 0x10; /* sync */
    frame->data[2] = 100;
    frame->data[4] = 100;
    laconic_protect_keyed(LACONIC_WIRE_VOLTAGE, frame->data, node.session.run_key, counter);
}

static bool start(void) {
    laconic_node_config config = {.id_base = LACONIC_WIRE_ID_BASE, .method = port_method};
    port_add_protocols(&config);
    const laconic_start rest = {0};
    laconic_node_init(&node, &config, 0);
    if (laconic_plant_start(&node.plant, &vehicle, port_method(1), (laconic_real)0.001, &rest, NULL) != LACONIC_OK)
        return false;
    node.state = LACONIC_WIRE_STATE_LOCKSTEP;
    node.session.open = true;
    node.session.armed = 1U << LACONIC_WIRE_VOLTAGE;
    node.send = LACONIC_NODE_SEND_NU;
    return true;
}

enum { TIMES = 8 };

/* The calls of a node that watches its memory, which stands still meanwhile: a frame for nobody, and a tick without a
 * step and with one slice, or with none. */
static void count_watched(void) {
    static laconic_integrity integrity;
    static laconic_node_config original;
    static const laconic_integrity_limits none = {0, 0, 0, 0};
    const laconic_frame other = {.id = 0x7FF, .length = 8};
    uint32_t frames = 0, ticks = 0, slices = 0;
    original = node.config;
    laconic_integrity_begin(&integrity, &node, &original, &none, LACONIC_INTEGRITY_ALL);
    for (int k = 0; k < TIMES; k++) {
        integrity.has_vehicle = false;
        uint32_t begin = board_clock_now();
        laconic_integrity_on_frame(&integrity, &node, &other, 0);
        frames += board_clock_since(begin);
        begin = board_clock_now();
        laconic_integrity_on_tick(&integrity, &node, 0);
        ticks += board_clock_since(begin);
        integrity.has_vehicle = true;
        integrity.part = 1;
        integrity.at = 0;
        integrity.slices = 0;
        begin = board_clock_now();
        laconic_integrity_on_tick(&integrity, &node, 0);
        slices += board_clock_since(begin);
    }
    print_count("watched_frame", frames, TIMES);
    print_count("watched_tick", ticks, TIMES);
    print_count("watched_slice", slices - ticks, TIMES);
}

int main(void) {
    uint32_t on_frame = 0, on_tick = 0, next = 0, reading = 0, writing = 0;
    char line[LACONIC_SLCAN_LINE];
    laconic_frame frame, out;
    ticks_of_65536 = board_calibrate();
    if (!start()) return 1;
    laconic_slcan_init(&slcan, 0);
    slcan.open = true;
    for (uint8_t k = 1; k <= TIMES; k++) {
        voltage_frame(&frame, k);
        const size_t length = laconic_slcan_write(&slcan, &frame, line);
        uint32_t begin = board_clock_now();
        for (size_t i = 0; i < length; i++) laconic_slcan_feed(&slcan, line[i], &frame);
        reading += board_clock_since(begin);
        begin = board_clock_now();
        laconic_node_on_frame(&node, &frame, k);
        on_frame += board_clock_since(begin);
        begin = board_clock_now();
        laconic_node_on_tick(&node, k);
        on_tick += board_clock_since(begin);
        begin = board_clock_now();
        if (!laconic_node_next_frame(&node, &out)) return 1;
        next += board_clock_since(begin);
        begin = board_clock_now();
        laconic_slcan_write(&slcan, &out, line);
        writing += board_clock_since(begin);
    }
    print_count("read_line", reading, TIMES);
    print_count("on_frame", on_frame, TIMES);
    print_count("on_tick_with_step", on_tick, TIMES);
    print_count("next_frame", next, TIMES);
    print_count("write_line", writing, TIMES);
    count_watched();
    return node.plant.steps == TIMES ? 0 : 1;
}
