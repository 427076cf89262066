/* Drives of one protocol on flywheels, 1 ms a step, and a controller's side of the bus. */
#ifndef DRIVE_BENCH_H
#define DRIVE_BENCH_H

#include "laconic_drives/protocol.h"
#include "unity.h"

#include <string.h>

enum { BENCH_DRIVES = 2, BENCH_COUNTS = 4096 };

static laconic_drives drives;
static uint64_t bench_axes[BENCH_DRIVES * 128];
static laconic_real bench_speed[BENCH_DRIVES]; /* of the flywheels, rad/s */
static uint32_t now_us;

static const laconic_real bench_step_s = (laconic_real)0.001, bench_inertia_kgm2 = (laconic_real)0.01;

static inline void bench_begin(const laconic_drive_protocol *protocol, int32_t first_id, laconic_real gear) {
    const laconic_drive_settings settings = {
        .encoder_counts = BENCH_COUNTS,
        .gear_ratio = gear,
        .torque_constant_Nm_per_A = (laconic_real)0.05,
        .current_limit_A = 20,
        .supply_V = 24,
        .winding_resistance_ohm = (laconic_real)0.1,
        .position_gain_per_s = 20,
        .speed_gain_As = 2,
        .speed_integral_gain_A = 10,
    };
    memset(&drives, 0, sizeof drives);
    memset(bench_axes, 0, sizeof bench_axes);
    memset(bench_speed, 0, sizeof bench_speed);
    drives.protocol = protocol;
    drives.axes = bench_axes;
    drives.count = BENCH_DRIVES;
    drives.step_s = bench_step_s;
    now_us = 0xFFFF0000U; /* the time wraps in the first milliseconds of each test */
    for (int32_t i = 0; i < BENCH_DRIVES; i++) {
        laconic_drive_start(&drives.drive[i], &settings);
        drives.drive[i].settings.node_id = first_id + i;
    }
    TEST_ASSERT_LESS_OR_EQUAL(sizeof bench_axes / BENCH_DRIVES, protocol->axis_bytes);
    protocol->start(&drives, now_us);
}

static inline void bench_step(void) {
    now_us += 1000;
    drives.protocol->on_step(&drives, now_us);
    for (int32_t i = 0; i < BENCH_DRIVES; i++) {
        const laconic_real torque_Nm = laconic_drive_act(&drives.drive[i], bench_step_s), before = bench_speed[i];
        bench_speed[i] += torque_Nm / bench_inertia_kgm2 * bench_step_s;
        laconic_drive_measure(&drives.drive[i], (before + bench_speed[i]) / 2 * bench_step_s, bench_speed[i]);
    }
}

static inline void bench_send(uint32_t id, const void *data, uint8_t length) {
    laconic_frame frame = {.id = id, .length = length, .extended = id > 0x7FF};
    frame.fd = length > 8;
    if (length > 0) memcpy(frame.data, data, length);
    drives.protocol->on_frame(&drives, &frame, now_us);
}

/* The next frame with this identifier; others are dropped. */
static inline bool bench_receive(uint32_t id, laconic_frame *frame) {
    while (drives.protocol->next_frame(&drives, frame))
        if (frame->id == id) return true;
    return false;
}

static inline void bench_drop_frames(void) {
    laconic_frame frame;
    while (drives.protocol->next_frame(&drives, &frame)) continue;
}

static inline void bench_steps(int32_t count) {
    for (int32_t k = 0; k < count; k++) {
        bench_step();
        bench_drop_frames();
    }
}

static inline laconic_real bench_float(const uint8_t *from) {
    float value;
    memcpy(&value, from, sizeof value);
    return (laconic_real)value;
}

#endif
