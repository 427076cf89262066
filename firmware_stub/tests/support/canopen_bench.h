/* Two CANopen drives, each of which turns a wheel with an inertia of its own, on a bus of which every frame is kept.
 * Time passes only by step(). */
#ifndef CANOPEN_BENCH_H
#define CANOPEN_BENCH_H

#include "canopen/canopen.h"
#include "unity.h"

#include <string.h>

enum { ID = 5, OTHER_ID = 9, COUNTS = 4096, STEP_US = 1000, KEPT = 256 };

typedef struct bench {
    laconic_drives drives;
    canopen_axis axes[2];
    laconic_frame sent[KEPT]; /* since the last forget() */
    int count;
    uint32_t now_us;
    laconic_real wheel_rad_per_s[2];
} bench;

static bench on;

static inline void collect(void) {
    while (on.count < KEPT && laconic_canopen.next_frame(&on.drives, &on.sent[on.count])) on.count++;
}

static inline void forget(void) { on.count = 0; }

static inline void deliver(uint32_t id, const void *bytes, uint8_t length) {
    laconic_frame frame = {.id = id, .length = length};
    memcpy(frame.data, bytes, length);
    laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
    collect();
}

static inline void step(int steps) {
    const laconic_real step_s = on.drives.step_s, inertia_kgm2 = (laconic_real)0.001;
    for (int n = 0; n < steps; n++) {
        on.now_us += STEP_US;
        laconic_canopen.on_step(&on.drives, on.now_us);
        for (int k = 0; k < on.drives.count; k++) {
            laconic_wheel_drive *drive = &on.drives.drive[k];
            const laconic_real before = on.wheel_rad_per_s[k], torque_Nm = laconic_drive_act(drive, step_s);
            on.wheel_rad_per_s[k] += torque_Nm / inertia_kgm2 * step_s;
            laconic_drive_measure(drive, (before + on.wheel_rad_per_s[k]) / 2 * step_s, on.wheel_rad_per_s[k]);
        }
        collect();
    }
}

static inline void power_up(void) {
    static const laconic_drive_settings settings = {
        .node_id = ID,
        .encoder_counts = COUNTS,
        .gear_ratio = 1,
        .torque_constant_Nm_per_A = (laconic_real)0.1,
        .current_limit_A = 10,
        .supply_V = 24,
        .position_gain_per_s = 20,
        .speed_gain_As = 3,
    };
    memset(&on, 0, sizeof on);
    on.drives.protocol = &laconic_canopen;
    on.drives.axes = on.axes;
    on.drives.count = 2;
    on.drives.step_s = (laconic_real)STEP_US / 1000000;
    for (int k = 0; k < 2; k++) laconic_drive_start(&on.drives.drive[k], &settings);
    on.drives.drive[1].settings.node_id = OTHER_ID;
    laconic_canopen.start(&on.drives, 0);
    collect();
}

static inline void nmt(uint8_t command, uint8_t id) {
    const uint8_t data[2] = {command, id};
    deliver(0, data, 2);
}

static inline void start_nodes(void) { nmt(1, 0); }

/* --- SDO --------------------------------------------------------------------------------------------------------- */

static inline const uint8_t *request(const uint8_t data[8]) {
    forget();
    deliver(0x600 + ID, data, 8);
    for (int k = 0; k < on.count; k++) {
        if (on.sent[k].id == 0x580 + ID) return on.sent[k].data;
    }
    return NULL;
}

/* Abort code, 0 iff the request was done. */
static inline uint32_t write_as(uint16_t index, uint8_t sub, uint32_t value, uint8_t size) {
    uint8_t data[8] = {(uint8_t)(0x23 | (4 - size) << 2)};
    canopen_put(data + 1, index, 2);
    data[3] = sub;
    canopen_put(data + 4, value, 4);
    const uint8_t *answer = request(data);
    TEST_ASSERT_NOT_NULL(answer);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(data + 1, answer + 1, 3);
    if (answer[0] == 0x80) return canopen_get(answer + 4, 4);
    TEST_ASSERT_EQUAL_HEX8(0x60, answer[0]);
    return 0;
}

static inline uint32_t read_as(uint16_t index, uint8_t sub, uint32_t *value, uint8_t *size) {
    uint8_t data[8] = {0x40};
    canopen_put(data + 1, index, 2);
    data[3] = sub;
    const uint8_t *answer = request(data);
    TEST_ASSERT_NOT_NULL(answer);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(data + 1, answer + 1, 3);
    *value = canopen_get(answer + 4, 4);
    if (answer[0] == 0x80) return *value;
    *size = answer[0] & 2 ? (uint8_t)(4 - (answer[0] >> 2 & 3)) : 0;
    return 0;
}

static inline uint8_t size_of(uint16_t index, uint8_t sub) {
    uint32_t abort;
    return canopen_size(canopen_row_at(canopen_find(index, sub, &abort)));
}

static inline void set(uint16_t index, uint8_t sub, int64_t value) {
    TEST_ASSERT_EQUAL_HEX32(0, write_as(index, sub, (uint32_t)value, size_of(index, sub)));
}

static inline int32_t get(uint16_t index, uint8_t sub) {
    uint32_t value;
    uint8_t size = 0;
    TEST_ASSERT_EQUAL_HEX32(0, read_as(index, sub, &value, &size));
    const uint32_t sign = 1U << (8U * size - 1U);
    const uint32_t abort_free = size == 4 ? value : value & ((1U << 8U * size) - 1U);
    return (int32_t)((abort_free ^ sign) - sign);
}

/* --- the drive --------------------------------------------------------------------------------------------------- */

static inline uint16_t statusword(void) { return (uint16_t)get(0x6041, 0); }

/* The bits of the statusword that show the state. */
static inline uint16_t state(void) {
    const uint16_t word = statusword();
    return word & (word & 0x40 || (word & 0x0F) == 0x08 || (word & 0x0F) == 0x0F ? 0x4F : 0x6F);
}

enum {
    SWITCH_ON_DISABLED = 0x40,
    READY = 0x21,
    SWITCHED_ON = 0x23,
    ENABLED = 0x27,
    QUICK_STOP = 0x07,
    REACTION = 0x0F,
    FAULT = 0x08
};

static inline void control(uint16_t word) { set(0x6040, 0, word); }

static inline void enable(int mode) {
    set(0x6060, 0, mode);
    control(6);
    control(7);
    control(15);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
}

/* --- frames ------------------------------------------------------------------------------------------------------ */

static inline const laconic_frame *last(uint32_t id) {
    for (int k = on.count - 1; k >= 0; k--) {
        if (on.sent[k].id == id) return &on.sent[k];
    }
    return NULL;
}

static inline int count_of(uint32_t id) {
    int count = 0;
    for (int k = 0; k < on.count; k++) count += on.sent[k].id == id;
    return count;
}

static inline void sync(void) { deliver(0x80, "", 0); }

#endif
