/* A node with a small vehicle, and a rig that sends it right frames. */
#ifndef BENCH_H
#define BENCH_H

#include "laconic_dbc.h"
#include "laconic_node/crc.h"
#include "laconic_node/node.h"
#include "laconic_node/protection.h"

#ifdef BENCH_WITH_MASTER
#include "unity.h"
#endif

#include <string.h>

static laconic_node node;
static uint32_t sent[LACONIC_WIRE_OFFSETS]; /* counts since OPEN or START */
static uint32_t bench_key, bench_run_key;
static uint32_t now_us;

/* A frame with a count that the test chooses. */
static inline void bench_send_count(uint8_t offset, const uint8_t *payload, uint32_t count) {
    const laconic_wire_row *row = &laconic_wire[offset];
    const bool of_run = row->key == LACONIC_WIRE_KEY_RUN;
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + (uint32_t)offset, .length = row->length, .fd = row->fd != 0};
    memcpy(frame.data, payload, row->length);
    laconic_protect_keyed(offset, frame.data, of_run ? bench_run_key : bench_key, count);
    laconic_node_on_frame(&node, &frame, now_us);
}

/* The next frame of its kind. The first motion frame after START does not act, so it is sent twice. */
static inline void bench_send(uint8_t offset, const uint8_t *payload) {
    if (laconic_wire[offset].key == LACONIC_WIRE_KEY_RUN && sent[offset] == 0)
        bench_send_count(offset, payload, ++sent[offset]);
    bench_send_count(offset, payload, ++sent[offset]);
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
static inline uint8_t bench_control(uint8_t command, uint16_t rate, uint16_t watchdog) {
    const struct laconic_dbc_control_t frame = {.command = command, .rate = rate, .watchdog = watchdog};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_control_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_CONTROL, data);
    const uint8_t status = bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
    const bool starts =
        command == LACONIC_WIRE_COMMAND_START_LOCKSTEP || command == LACONIC_WIRE_COMMAND_START_FREE_RUN;
    if (starts && status == 0) {
        bench_run_key = laconic_run_key(bench_key, sent[LACONIC_WIRE_CONTROL]);
        for (uint8_t k = 0; k < LACONIC_WIRE_OFFSETS; k++)
            if (laconic_wire[k].key == LACONIC_WIRE_KEY_RUN) sent[k] = 0;
    }
    return status;
}

/* The status of COMMIT; its field and item stay in `data`. */
static inline uint8_t bench_commit(uint8_t data[LACONIC_FRAME_BYTES]) {
    const struct laconic_dbc_commit_t frame = {.frame_count = node.loader.frame_count,
                                               .checksum = node.loader.checksum ^ LACONIC_CRC32_END};
    laconic_dbc_commit_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_COMMIT, data);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline uint8_t bench_start_lockstep(void) { return bench_control(LACONIC_WIRE_COMMAND_START_LOCKSTEP, 0, 0); }

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
    const struct laconic_dbc_sync_t frame = {.step_count = steps};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_sync_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_SYNC, data);
}

/* Ticks until no step is due. */
static inline void bench_tick_lockstep(void) {
    while (node.lockstep.steps_due > 0) laconic_node_on_tick(&node, now_us);
}

#define VOLT 500 /* in units of VOLTAGE */

/* Some steps in lockstep with 5 V on the first three wheels. */
static inline void bench_step(uint32_t steps) {
    bench_voltage(0, 5 * VOLT, 0);
    bench_sync(steps);
    bench_tick_lockstep();
}

/* A tick each millisecond. */
static inline void bench_pass_ms(uint32_t milliseconds) {
    for (uint32_t k = 0; k < milliseconds; k++) {
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
    }
}

/* A cart with `wheels` fixed wheels on one axle, ready. */
static inline void bench_load(int32_t wheels) {
    laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1, .motor_gain_Nm_per_V = 1};
    vehicle.wheel_count = wheels;
    for (int32_t i = 0; i < wheels; i++) {
        const laconic_wheel wheel = {.kind = LACONIC_WHEEL_FIXED, .x_m = (laconic_real)(i + 1)};
        vehicle.wheel[i] = wheel;
    }
    laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)0.001, &node.start, NULL);
    node.state = LACONIC_WIRE_STATE_READY;
}

/* What a frame tells of a number in its units. */
static inline int32_t rounded(laconic_real value) {
    return (int32_t)(value < 0 ? value - (laconic_real)0.5 : value + (laconic_real)0.5);
}

/* HELLO; the nonce of the CHALLENGE. */
static inline uint32_t bench_hello(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    struct laconic_dbc_challenge_t challenge = {0};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 0);
    laconic_node_on_frame(&node, &frame, now_us);
    if (bench_receive(LACONIC_WIRE_CHALLENGE, data)) laconic_dbc_challenge_unpack(&challenge, data, 8);
    return challenge.nonce;
}

static inline laconic_frame bench_open_frame(uint32_t session, uint32_t nonce) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_OPEN, .length = 8};
    const struct laconic_dbc_open_t open = {.nonce_echo = (uint16_t)nonce, .session = session};
    laconic_dbc_open_pack(frame.data, &open, 8);
    laconic_protect_keyed(LACONIC_WIRE_OPEN, frame.data, nonce, 3);
    return frame;
}

/* The handshake; the status of OPEN's RESULT, 255: none came. */
static inline uint8_t bench_open(uint32_t session) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const uint32_t nonce = bench_hello();
    const laconic_frame frame = bench_open_frame(session, nonce);
    laconic_node_on_frame(&node, &frame, now_us);
    bench_key = laconic_mix(session, nonce);
    memset(sent, 0, sizeof sent);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static inline void bench_begin(void) {
    const laconic_node_config config = {.id_base = LACONIC_WIRE_ID_BASE,
                                        .can_fd = LACONIC_NODE_CAN_FD != 0,
                                        .method = laconic_method_by_number,
#if LACONIC_NODE_WITH_DRIVES
                                        .protocol = laconic_drive_protocol_by_number,
#endif
                                        .nonce_seed = 1905};
    now_us = 0xFFFFF000U; /* the time wraps in the first milliseconds of each test */
    laconic_node_init(&node, &config, now_us);
    bench_open(0x5E55104EU);
}

/* ------------------------------------------------------------------------- a master of XCP -- */

#if LACONIC_NODE_WITH_XCP && defined BENCH_WITH_MASTER

enum { DONE = 0xFF };

static uint8_t answer[8], answer_length;

/* The next frame of the slave; false: none. */
static inline bool hear(void) {
    laconic_frame frame;
    while (laconic_node_next_frame(&node, &frame)) {
        if (frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_XCP_RESPONSE) continue;
        answer_length = frame.length;
        memcpy(answer, frame.data, 8);
        return true;
    }
    answer_length = 0;
    return false;
}

static inline void tell(const uint8_t *command, uint8_t length) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_XCP_COMMAND, .length = length};
    memcpy(frame.data, command, length);
    laconic_node_on_frame(&node, &frame, now_us);
}

/* DONE, the error of the answer, or 1 where there is no answer. */
static inline uint8_t ask(const uint8_t *command, uint8_t length) {
    tell(command, length);
    if (!hear()) return 1;
    return answer[0] == 0xFE ? answer[1] : answer[0];
}

#define ASK(...) ask((const uint8_t[]){__VA_ARGS__}, (uint8_t)sizeof((const uint8_t[]){__VA_ARGS__}))
#define DONE_BY(...) TEST_ASSERT_EQUAL_HEX8(DONE, ASK(__VA_ARGS__))
#define REFUSED(error, ...) TEST_ASSERT_EQUAL_HEX8(error, ASK(__VA_ARGS__))
#define BYTES(address) \
    (uint8_t)(address), (uint8_t)((address) >> 8), (uint8_t)((address) >> 16), (uint8_t)((address) >> 24)
#define PARAMETER(field, k) (LACONIC_XCP_PARAMETERS + LACONIC_XCP_EACH * (uint32_t)(field) + 4U * (k))
#define OUTPUT(bit, k) (LACONIC_XCP_OUTPUTS + LACONIC_XCP_EACH * (uint32_t)(bit) + 4U * (k))

static inline float real_at(uint32_t address) {
    float value;
    DONE_BY(0xF4, 4, 0, 0, BYTES(address));
    memcpy(&value, answer + 1, sizeof value);
    return value;
}

static inline uint32_t word_at(uint32_t address) {
    DONE_BY(0xF4, 4, 0, 0, BYTES(address));
    return word32(answer + 1);
}

static inline uint8_t write_word(uint32_t address, uint32_t word) {
    DONE_BY(0xF6, 0, 0, 0, BYTES(address));
    return ASK(0xF0, 4, BYTES(word));
}

static inline uint8_t write_real(uint32_t address, float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return write_word(address, word);
}

#endif

#endif
