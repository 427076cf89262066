/* Tests of a node on CAN FD: voltages of all wheels in one frame, raw numbers in and out, the state. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

static void voltages(int32_t wheels, uint8_t flags) {
    memset(data, 0, sizeof data);
    data[3] = flags;
    for (int32_t k = 0; k < wheels; k++)
        put16(data + 4 + 2 * k, (uint32_t)(uint16_t)(int16_t)(k % 2 ? -1500 - k : 1000 + k));
    bench_send(LACONIC_WIRE_VOLTAGE_FD, data);
}

static void one_frame_has_the_voltages_of_all_wheels(void) {
    bench_load(LACONIC_MAX_WHEELS < 16 ? LACONIC_MAX_WHEELS : 16);
    bench_start_lockstep();
    voltages(16, 0);
    for (int32_t k = 0; k < node.plant.model.wheel_count; k++) {
        const laconic_real wanted = (laconic_real)(k % 2 ? -1500 - k : 1000 + k) / 1000;
        TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == wanted);
    }
    TEST_ASSERT_EQUAL_UINT32(0, node.lockstep.steps_due);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.overrange);
}

static void voltages_beyond_the_last_wheel_go_nowhere(void) {
    bench_load(2);
    bench_start_lockstep();
    voltages(16, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[1] < 0);
    for (int32_t k = 2; k < LACONIC_MAX_WHEELS; k++) TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == 0);
}

static void its_flags_ask_for_a_step_and_tell_of_a_voltage_out_of_range(void) {
    bench_load(2);
    bench_start_lockstep();
    voltages(2, 2);
    TEST_ASSERT_TRUE(node.counters.overrange == 1 && node.lockstep.steps_due == 0);
    voltages(2, 1);
    TEST_ASSERT_TRUE(node.counters.overrange == 1 && node.lockstep.steps_due == 1);
    TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_VOLTAGE_FD] & 15U, node.lockstep.request);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
}

static void a_count_stays_at_the_largest_that_it_can_be(void) {
    bench_load(2);
    bench_start_lockstep();
    node.counters.overrange = UINT16_MAX - 1;
    for (int k = 0; k < 3; k++) voltages(2, 2);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, node.counters.overrange);
}

static void it_feeds_the_watchdog_at_once(void) {
    bench_load(4);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 10);
    bench_voltage(0, 500, 0); /* one group of two */
    for (int k = 0; k < 9; k++) laconic_node_on_tick(&node, now_us += 1000);
    voltages(4, 0);
    TEST_ASSERT_EQUAL_UINT8(0, node.groups_seen);
    for (int k = 0; k < 9; k++) laconic_node_on_tick(&node, now_us += 1000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
    voltages(4, 1); /* a step by request is for lockstep */
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

static void a_vehicle_with_more_wheels_than_it_has_room_for_takes_none(void) {
    bench_load(2);
    bench_start_lockstep();
    node.plant.model.wheel_count = 17;
    voltages(16, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.counters.refused == 1);
    node.plant.model.wheel_count = 2;
}

/* Numbers that RAW_INPUT_FD brings, RAW_INPUT brings too, and each goes to its place. */
static void raw_inputs_come_by_frames_of_either_length(void) {
    for (int fd = 0; fd < 2; fd++) {
        laconic_real number[20];
        uint8_t bytes[sizeof number + 64] = {0};
        const size_t room = fd ? 60 : 6, size = (size_t)(16 + 4) * sizeof number[0];
        uint16_t frames = 0;
        bench_begin();
        bench_load(8);
        bench_select(0, 0, LACONIC_RAW_VOLTAGE | LACONIC_RAW_AXLE_TORQUE | LACONIC_RAW_WORLD_FORCE);
        bench_start_lockstep();
        for (int k = 0; k < 20; k++) number[k] = (laconic_real)(1.0 / (k + 3));
        memcpy(bytes, number, sizeof number);
        for (size_t at = 0; at < size; at += room, frames++) {
            memset(data, 0, sizeof data);
            if (fd)
                data[3] = (uint8_t)frames;
            else
                data[1] = (uint8_t)(frames << 4);
            memcpy(data + (fd ? 4 : 2), bytes + at, room);
            bench_send(fd ? LACONIC_WIRE_RAW_INPUT_FD : LACONIC_WIRE_RAW_INPUT, data);
            TEST_ASSERT_EQUAL_UINT16(0, node.counters.refused);
        }
        TEST_ASSERT_EQUAL_MEMORY(number, node.input[0].voltage_V, 8 * sizeof number[0]);
        TEST_ASSERT_EQUAL_MEMORY(number + 8, node.input[0].axle_torque_Nm, 8 * sizeof number[0]);
        TEST_ASSERT_EQUAL_MEMORY(number + 16, node.input[0].world_force_N, 2 * sizeof number[0]);
        TEST_ASSERT_EQUAL_MEMORY(number + 18, node.input[0].world_force_point_m, 2 * sizeof number[0]);
        TEST_ASSERT_TRUE(laconic_raw_is_whole(&node.raw_input, frames));
    }
}

static void a_raw_number_out_of_order_is_refused_and_counted(void) {
    bench_load(8);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.refused);
    data[1] = 5U << 4;
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

/* The numbers behind RAW_OUTPUT, in the order of their bits. */
static int expected_numbers(laconic_real *to) {
    const laconic_real *const begin = to;
    laconic_pose pose;
    laconic_nu(&node.plant.model, &node.plant.state, to);
    laconic_pose_of(&pose, &node.plant.model, &node.plant.state);
    to[3] = pose.x_m;
    to[4] = pose.y_m;
    to[5] = pose.heading_rad;
    laconic_plant_wheel_speeds(&node.plant, to + 6);
    laconic_plant_wheel_angles(&node.plant, to + 9);
    to[12] = laconic_plant_energy_J(&node.plant);
    return (int)(to + 13 - begin);
}

static void raw_outputs_go_by_frames_of_either_length_and_end_in_zeros(void) {
    for (int fd = 0; fd < 2; fd++) {
        laconic_real number[16];
        uint8_t all[256];
        const size_t room = fd ? 60 : 6;
        const uint8_t offset = fd ? LACONIC_WIRE_RAW_OUTPUT_FD : LACONIC_WIRE_RAW_OUTPUT;
        size_t got = 0;
        bench_begin();
        bench_load(3);
        bench_select(0, (uint8_t)(0x1FU | (fd ? 0x80U : 0U)), 0);
        bench_start_lockstep();
        const laconic_start start = {{(laconic_real)0.3, (laconic_real)-0.7, (laconic_real)0.9}, 2, -3, 4, {0}};
        laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
        bench_voltage(0, 700, 0);
        bench_sync(3);
        laconic_node_on_tick(&node, now_us);
        const size_t size = (size_t)expected_numbers(number) * sizeof number[0];
        for (uint8_t segment = 0; bench_receive(offset, data); segment++) {
            TEST_ASSERT_EQUAL_UINT8(segment & (fd ? 255U : 15U), fd ? data[3] : data[1] >> 4);
            memcpy(all + got, data + (fd ? 4 : 2), room);
            got += room;
        }
        TEST_ASSERT_EQUAL_size_t((size + room - 1) / room * room, got);
        TEST_ASSERT_EQUAL_MEMORY(number, all, size);
        for (size_t k = size; k < got; k++) TEST_ASSERT_EQUAL_HEX8(0, all[k]);
    }
}

static void a_number_out_of_range_of_the_state_sets_its_flag(void) {
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0);
    bench_start_lockstep();
    const laconic_start start = {{0, 0, 0}, 3000, -2, 0, {0}};
    laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_STATE_FD, data));
    TEST_ASSERT_EQUAL_UINT8(1, data[3]);
    TEST_ASSERT_EQUAL_UINT32(2147000000, word32(data + 20));
    TEST_ASSERT_EQUAL_INT32(-2000000, (int32_t)word32(data + 24));
    for (size_t k = 36; k < 64; k++) TEST_ASSERT_EQUAL_HEX8(0, data[k]);
}

static void a_frame_of_the_other_kind_is_malformed(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_VOLTAGE_FD, .length = 48};
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.malformed);
    frame.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_VOLTAGE;
    frame.length = 8;
    frame.fd = true;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(2, node.counters.malformed);
}

static void a_sync_names_the_frames_of_its_inputs_and_begins_the_next_ones(void) {
    bench_load(2);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    for (int again = 0; again < 2; again++) {
        struct laconic_dbc_sync_t frame = {.step_count = 1, .input_frames = 1};
        memset(data, 0, sizeof data);
        bench_send(LACONIC_WIRE_RAW_INPUT_FD, data);
        laconic_dbc_sync_pack(data, &frame, 8);
        bench_send(LACONIC_WIRE_SYNC, data);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64((uint64_t)again + 1, node.plant.steps);
        TEST_ASSERT_EQUAL_UINT16(0, node.counters.refused);
    }
}

static void raw_numbers_of_another_segment_count_as_refused(void) {
    bench_load(2);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    memset(data, 0, sizeof data);
    data[3] = 5;
    bench_send(LACONIC_WIRE_RAW_INPUT_FD, data);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

static void its_counter_asks_for_no_step(void) {
    bench_load(2);
    bench_start_lockstep();
    for (int k = 0; k < 3; k++) {
        voltages(2, 0);
        TEST_ASSERT_EQUAL_UINT32(0, node.lockstep.steps_due);
    }
}

static void each_step_begins_its_raw_numbers_anew(void) {
    bench_load(2);
    bench_select(0, LACONIC_RAW_NU, 0);
    bench_start_lockstep();
    for (int k = 0; k < 2; k++) {
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RAW_OUTPUT, data));
        TEST_ASSERT_EQUAL_UINT8(0, data[1] >> 4);
    }
}

static void a_longer_frame_than_its_own_is_malformed(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_VOLTAGE_FD, .length = 64, .fd = true};
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(node.counters.malformed == 1 && node.counters.crc_errors == 0);
}

/* Their counters have eight bits, so that a gap of twenty, or of two hundred, is known as one. */
static void twenty_lost_frames_and_two_hundred_are_a_gap(void) {
    static const uint8_t offsets[] = {LACONIC_WIRE_VOLTAGE_FD, LACONIC_WIRE_RAW_INPUT_FD};
    bench_load(2);
    bench_start_lockstep();
    for (uint16_t k = 0; k < 2; k++) {
        bench_send_count(offsets[k], data, 1);
        bench_send_count(offsets[k], data, 21);
        bench_send_count(offsets[k], data, 201);
        TEST_ASSERT_EQUAL_UINT16(2 * (k + 1), node.counters.sequence_errors);
        TEST_ASSERT_EQUAL_UINT16(0, node.counters.crc_errors);
    }
}

static void a_step_by_request_sets_no_voltages_in_free_run(void) {
    bench_load(4);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 10);
    now_us += 300;
    voltages(4, 4);
    TEST_ASSERT_EQUAL_UINT32(now_us, node.free_run.fed_us);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.overrange);
    node.input[0].voltage_V[0] = 7;
    voltages(4, 1);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 7 && node.counters.refused == 1);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(one_frame_has_the_voltages_of_all_wheels);
    RUN_TEST(voltages_beyond_the_last_wheel_go_nowhere);
    RUN_TEST(its_flags_ask_for_a_step_and_tell_of_a_voltage_out_of_range);
    RUN_TEST(a_count_stays_at_the_largest_that_it_can_be);
    RUN_TEST(a_raw_number_out_of_order_is_refused_and_counted);
    RUN_TEST(it_feeds_the_watchdog_at_once);
    RUN_TEST(a_vehicle_with_more_wheels_than_it_has_room_for_takes_none);
    RUN_TEST(raw_inputs_come_by_frames_of_either_length);
    RUN_TEST(raw_outputs_go_by_frames_of_either_length_and_end_in_zeros);
    RUN_TEST(a_number_out_of_range_of_the_state_sets_its_flag);
    RUN_TEST(a_frame_of_the_other_kind_is_malformed);
    RUN_TEST(a_sync_names_the_frames_of_its_inputs_and_begins_the_next_ones);
    RUN_TEST(raw_numbers_of_another_segment_count_as_refused);
    RUN_TEST(its_counter_asks_for_no_step);
    RUN_TEST(each_step_begins_its_raw_numbers_anew);
    RUN_TEST(a_longer_frame_than_its_own_is_malformed);
    RUN_TEST(twenty_lost_frames_and_two_hundred_are_a_gap);
    RUN_TEST(a_step_by_request_sets_no_voltages_in_free_run);
    return UNITY_END();
}
