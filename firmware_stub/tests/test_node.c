/* Tests of node.c and node_motion.c: frames, steps and answers of a node in lockstep. */
#include "bench.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) { bench_begin(); }
void tearDown(void) {}

static void id_bases_are_multiples_of_32(void) {
    laconic_node_config config = {0x210, true, laconic_method_by_number, 0, NULL};
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.id_base = 0x800;
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.id_base = 0x7E0;
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, 0));
}

static void the_node_identifies_itself(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_identity_t identity;
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 0);
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IDENTITY, data));
    laconic_dbc_identity_unpack(&identity, data, 8);
    TEST_ASSERT_EQUAL_UINT8(sizeof(laconic_real), identity.scalar_bytes);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_MAX_WHEELS, identity.max_wheels);
    TEST_ASSERT_EQUAL_HEX8((1 << LACONIC_METHOD_COUNT) - 1, identity.methods);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_VERSION, identity.protocol);
    TEST_ASSERT_EQUAL_UINT8(1, identity.can_fd);
    char version[16];
    snprintf(version, sizeof version, "%u.%u.%u", identity.version_major, identity.version_minor,
             identity.version_patch);
    TEST_ASSERT_EQUAL_STRING(LACONIC_VERSION, version);
}

static void nothing_starts_without_a_vehicle(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_UNKNOWN_COMMAND, bench_control(99, 0, 0));
}

static void a_sync_steps_and_is_answered_with_what_was_selected(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    bench_voltage(0, 500, 1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(node.plant.steps == 1 && node.input[0].voltage_V[1] == 1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &(laconic_frame){0}));
    bench_sync(100);
    TEST_ASSERT_TRUE(laconic_node_is_busy(&node) && laconic_node_idle_us(&node, now_us) == 0);
    bench_sync(1); /* while it is busy */
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_BUSY, data[3]);
    while (laconic_node_is_busy(&node)) laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(101, node.plant.steps);
}

static void a_sync_of_no_steps_or_too_many_or_without_its_inputs_is_refused(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_select(0, LACONIC_RAW_NU, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    const uint32_t wrong[] = {0, 1000001, UINT32_MAX};
    for (int k = 0; k < 3; k++) {
        bench_sync(wrong[k]);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
    }
    memset(data, 0, sizeof data);
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    bench_sync(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, data[3]);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
}

static void frames_of_the_wrong_shape_change_nothing_but_a_counter(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE, .length = 7};
    laconic_node_on_frame(&node, &frame, now_us);
    frame.length = 8;
    frame.remote = true;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.remote = false;
    frame.id += LACONIC_WIRE_NU; /* one of our own, from a second node */
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(3, node.counters.malformed);
    frame.extended = true;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.extended = false;
    frame.id = LACONIC_WIRE_ID_BASE - 1;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(3, node.counters.malformed);
    frame.id = LACONIC_WIRE_ID_BASE;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.crc_errors);
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &frame));
}

static void a_vehicle_can_only_be_changed_while_it_stands(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_start_lockstep();
    bench_send(LACONIC_WIRE_COMMIT, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_select(0, 0, 0));
}

static void a_step_that_the_core_refuses_ends_in_fault_and_reset_mends_it(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    node.start.nu_rad_per_s[2] = 1;
    bench_start_lockstep();
    node.input[0].voltage_V[0] = LACONIC_REAL_MAX;
    bench_sync(5);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data) && data[3] != 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    node.start.nu_rad_per_s[2] = 0;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
}

static void the_fault_names_the_wheel_whichever_sample_of_the_step_is_to_blame(void) {
    for (int32_t k = 0; k < 3; k++) {
        uint8_t data[LACONIC_FRAME_BYTES];
        struct laconic_dbc_result_t result;
        bench_begin();
        bench_load(3);
        bench_select(0, 0, LACONIC_RAW_SAMPLED);
        bench_start_lockstep();
        node.input[k].voltage_V[k] = (laconic_real)NAN;
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        laconic_dbc_result_unpack(&result, data, 8);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, result.status);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_VOLTAGE, result.field);
        TEST_ASSERT_EQUAL_UINT8(k + 1, result.item);
    }
}

static void can_fd_is_refused_where_there_is_none(void) {
    bench_load(2);
    node.config.can_fd = false;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
    node.config.can_fd = true;
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(id_bases_are_multiples_of_32);
    RUN_TEST(the_node_identifies_itself);
    RUN_TEST(nothing_starts_without_a_vehicle);
    RUN_TEST(a_sync_steps_and_is_answered_with_what_was_selected);
    RUN_TEST(a_sync_of_no_steps_or_too_many_or_without_its_inputs_is_refused);
    RUN_TEST(frames_of_the_wrong_shape_change_nothing_but_a_counter);
    RUN_TEST(a_vehicle_can_only_be_changed_while_it_stands);
    RUN_TEST(a_step_that_the_core_refuses_ends_in_fault_and_reset_mends_it);
    RUN_TEST(the_fault_names_the_wheel_whichever_sample_of_the_step_is_to_blame);
    RUN_TEST(can_fd_is_refused_where_there_is_none);
    return UNITY_END();
}
