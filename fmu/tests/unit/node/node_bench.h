/* What the tests of the node behind a bus terminal share: the same node without one, a rig that loads it, and what
 * the rig has sent, for the FMU. */
#ifndef NODE_BENCH_H
#define NODE_BENCH_H

#include "laconic_node/crc.h"
#include "laconic_node/node.h"
#include "model_interface.h"
#include "network_bench.h"

/* What the rig sends to the other node is kept, and given to the FMU. */
static laconic_frame kept[256];
static size_t kept_count;

static inline void keep_on_frame(laconic_node *node, const laconic_frame *frame, uint32_t now_us) {
    TEST_ASSERT_TRUE(kept_count < sizeof kept / sizeof kept[0]);
    kept[kept_count++] = *frame;
    laconic_node_on_frame(node, frame, now_us);
}

#define laconic_node_on_frame keep_on_frame
#include "bench.h"
#undef laconic_node_on_frame

void setUp(void) {
    const laconic_node_config config = {LACONIC_WIRE_ID_BASE, false, laconic_method_by_number, 0,
                                        laconic_drive_protocol_by_number};
    kept_count = 0;
    now_us = 0;
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, 0));
    begin_test();
}
void tearDown(void) { end_test(); }

/* ------------------------------------------------------------------------------------ how it is loaded -- */

static inline void parameter(uint8_t field, uint8_t item, double value, bool is_real) {
    uint64_t bits;
    uint8_t payload[LACONIC_FRAME_BYTES], data[LACONIC_FRAME_BYTES];
    if (is_real)
        memcpy(&bits, &value, sizeof bits);
    else
        bits = (uint64_t)value;
    for (unsigned half = 0; half < (is_real ? 2U : 1U); half++) {
        const struct laconic_dbc_parameter_t frame = {
            .upper_half = (uint8_t)half, .field = field, .item = item, .value = (uint32_t)(bits >> (32 * half))};
        laconic_dbc_parameter_pack(payload, &frame, 8);
        bench_send(LACONIC_WIRE_PARAMETER, payload);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    }
}

/* A cart of two wheels with a motor on each, by a rig that the other node hears. The second motor has a drive of that
 * protocol; 0: none has. */
static inline void cart_with(uint8_t protocol) {
    const bool has_drive = protocol != 0;
    static const uint8_t ones[] = {LACONIC_FIELD_MASS,          LACONIC_FIELD_YAW_INERTIA, LACONIC_FIELD_WHEEL_RADIUS,
                                   LACONIC_FIELD_WHEEL_INERTIA, LACONIC_FIELD_MOTOR_GAIN,  LACONIC_FIELD_MOTOR_DAMPING};
    uint8_t payload[LACONIC_FRAME_BYTES] = {0}, data[LACONIC_FRAME_BYTES];
    TEST_ASSERT_EQUAL_UINT8(0, bench_open(0x1ACC0DE));
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    for (size_t k = 0; k < sizeof ones; k++) parameter(ones[k], 0, 1, true);
    parameter(LACONIC_FIELD_STEP, 0, 0.001, true);
    parameter(LACONIC_FIELD_START_X, 0, 7, true);
    parameter(LACONIC_FIELD_START_HEADING, 0, 0.5, true);
    parameter(LACONIC_FIELD_WHEEL_COUNT, 0, 2, false);
    for (uint8_t wheel = 1; wheel <= 2; wheel++) {
        parameter(LACONIC_FIELD_WHEEL_KIND, wheel, LACONIC_WHEEL_FIXED, false);
        parameter(LACONIC_FIELD_WHEEL_X, wheel, wheel, true);
        parameter(LACONIC_FIELD_WHEEL_Y, wheel, 0, true);
        parameter(LACONIC_FIELD_AXLE, wheel, 0, true);
    }
    if (has_drive) {
        parameter(LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, 0, protocol, false);
        parameter(LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, 2, 7, false);
        parameter(LACONIC_DRIVES_FIELD_ENCODER_COUNTS, 2, 8192, false);
        parameter(LACONIC_DRIVES_FIELD_DRIVE_GEAR_RATIO, 2, -19, true);
        parameter(LACONIC_DRIVES_FIELD_DRIVE_TORQUE_CONSTANT, 2, 0.015, true);
        parameter(LACONIC_DRIVES_FIELD_DRIVE_CURRENT_LIMIT, 2, 20, true);
    }
    const struct laconic_dbc_commit_t commit = {.frame_count = node.loader.frame_count,
                                                .checksum = node.loader.checksum ^ LACONIC_CRC32_END};
    laconic_dbc_commit_pack(payload, &commit, 8);
    bench_send(LACONIC_WIRE_COMMIT, payload);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data) && data[3] == 0);
    if (has_drive) TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
}

/* With a drive of RoboMaster, or without. */
static inline void cart(bool has_drive) { cart_with(has_drive ? 3 : 0); }

static inline bool give_private(uint32_t offset, const uint8_t data[8]) {
    uint64_t bits = 0;
    for (unsigned k = 0; k < 8; k++) bits |= (uint64_t)data[k] << (8 * k);
    return fmu_model_take_private(instance(), FMU_PRIVATE_START + offset, bits);
}

/* The FMU gets what the rig has sent so far, as start values. */
static inline void load(void) {
    for (size_t k = 0; k < kept_count; k++)
        TEST_ASSERT_TRUE(give_private(kept[k].id - LACONIC_WIRE_ID_BASE, kept[k].data));
    kept_count = 0;
}

static inline void begin(void) { OK(begin_from(0)); }

/* ... and from then on by the bus. */
static inline void by_bus(void) {
    for (size_t k = 0; k < kept_count; k++) ls_bus_put_frame(&out, &kept[k], false);
    give("CAN", &out);
    out.size = kept_count = 0;
    update();
}

#endif
