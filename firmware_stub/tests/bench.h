/* A node with a small vehicle, and a rig that sends it right frames. */
#ifndef BENCH_H
#define BENCH_H

#include "laconic_dbc.h"
#include "laconic_node/node.h"

#include <string.h>

static laconic_node node;
static uint8_t sent[LACONIC_WIRE_RIG_OFFSETS];
static uint32_t now_us;

static inline void bench_send(uint8_t offset, uint8_t *data) {
    const laconic_wire_row *row = &laconic_wire[offset];
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + (uint32_t)offset, .length = row->length, .fd = row->fd != 0};
    const uint8_t turn = row->of_session ? node.session : 0;
    if (row->fd) {
        laconic_e2e_p05_protect(data, row->length, (uint16_t)(laconic_wire_data_id(offset) + turn), ++sent[offset]);
    } else {
        laconic_e2e_p22_protect(data, 8, laconic_wire_data_ids[row->list], turn, ++sent[offset]);
    }
    memcpy(frame.data, data, row->length);
    laconic_node_on_frame(&node, &frame, now_us);
}

/* The next frame of that kind; others are dropped. False: none. */
static inline bool bench_receive(uint8_t offset, uint8_t *data) {
    laconic_frame frame;
    while (laconic_node_next_frame(&node, &frame)) {
        memcpy(data, frame.data, frame.length);
        if (frame.id == LACONIC_WIRE_ID_BASE + (uint32_t)offset) return true;
    }
    return false;
}

/* A CONTROL and the status of its RESULT. */
static inline uint8_t bench_control(uint8_t command, uint8_t session, uint16_t rate, uint16_t watchdog) {
    const struct laconic_dbc_control_t frame = {
        .request = 5, .command = command, .session = session, .rate = rate, .watchdog = watchdog};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_control_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_CONTROL, data);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline uint8_t bench_select(uint8_t send, uint8_t raw, uint8_t take) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0, 0, send, raw, take};
    bench_send(LACONIC_WIRE_SELECT, data);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline void bench_voltage(uint8_t group, int16_t raw, uint8_t sync) {
    const struct laconic_dbc_voltage_t frame = {
        .sync = sync, .group = group, .voltage_1 = raw, .voltage_2 = raw, .voltage_3 = raw};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_voltage_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_VOLTAGE, data);
}

static inline void bench_sync(uint32_t steps) {
    const struct laconic_dbc_sync_t frame = {.request = 7, .step_count = steps};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_sync_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_SYNC, data);
}

/* A cart with `wheels` fixed wheels side by side, ready. */
static inline void bench_load(int32_t wheels) {
    laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1, .motor_gain_Nm_per_V = 1};
    vehicle.wheel_count = wheels;
    for (int32_t i = 0; i < wheels; i++) {
        const laconic_wheel wheel = {LACONIC_WHEEL_FIXED, false, 0, (laconic_real)(i + 1), 0, 0};
        vehicle.wheel[i] = wheel;
    }
    laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)0.001, &node.start, NULL);
    node.state = LACONIC_WIRE_STATE_READY;
}

static inline void bench_begin(void) {
    const laconic_node_config config = {LACONIC_WIRE_ID_BASE, true, laconic_method_by_number};
    memset(sent, 0, sizeof sent);
    now_us = 0xFFFFF000U; /* the time wraps in the first milliseconds of each test */
    laconic_node_init(&node, &config, now_us);
}

#endif
