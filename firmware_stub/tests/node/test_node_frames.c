/* Tests of the node's frames: which wait to be fetched, how they are counted, what they tell. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

#define EVERY_FRAME 0xFFU  /* of SELECT's send_ bits */
#define EVERY_NUMBER 0x1FU /* of the plant in RAW_OUTPUT */
#define RAW_BY_FD 0x80U    /* with the bits of RAW_OUTPUT */

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

/* A cart of four wheels with an encoder on the second. */
static void load(void) {
    const laconic_sensor_settings with = {.encoder[1] = {256, 3}};
    bench_load(4);
    node.has_sensors = true;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
}

static void send_hello(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 0);
    laconic_node_on_frame(&node, &frame, now_us);
}

static void send_control(uint8_t command) {
    const struct laconic_dbc_control_t frame = {.command = command};
    laconic_dbc_control_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_CONTROL, data);
}

static void pass_a_heartbeat(void) {
    now_us += LACONIC_NODE_HEARTBEAT_US;
    laconic_node_on_tick(&node, now_us);
}

/* How many frames of each kind wait; all of them. */
static int fetch_all(int count[LACONIC_WIRE_OFFSETS]) {
    laconic_frame frame;
    int all = 0;
    memset(count, 0, LACONIC_WIRE_OFFSETS * sizeof count[0]);
    for (; laconic_node_next_frame(&node, &frame); all++) count[frame.id - LACONIC_WIRE_ID_BASE]++;
    return all;
}

/* ---------------------------------------------------------------------------------------- waiting -- */

/* A bus that was busy for two steps, two heartbeats and two HELLOs has all their frames, each once. */
static void a_frame_that_waits_goes_on_waiting_when_it_is_due_again(void) {
    static const uint8_t once[] = {LACONIC_WIRE_IDENTITY, LACONIC_WIRE_CHALLENGE, LACONIC_WIRE_NU,
                                   LACONIC_WIRE_POSE,     LACONIC_WIRE_HEARTBEAT, LACONIC_WIRE_STATE_FD,
                                   LACONIC_WIRE_IMU,      LACONIC_WIRE_ENCODER};
    int count[LACONIC_WIRE_OFFSETS];
    load();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(EVERY_FRAME, 0, 0));
    bench_start_lockstep();
    for (int k = 0; k < 2; k++) {
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        pass_a_heartbeat();
        send_hello();
    }
    TEST_ASSERT_EQUAL_INT(sizeof once + 2 + 2 + 3, fetch_all(count));
    for (size_t k = 0; k < sizeof once; k++) TEST_ASSERT_EQUAL_INT(1, count[once[k]]);
    TEST_ASSERT_TRUE(count[LACONIC_WIRE_WHEEL_SPEED] == 2 && count[LACONIC_WIRE_WHEEL_ANGLE] == 2);
    TEST_ASSERT_EQUAL_INT(3, count[LACONIC_WIRE_COUNTERS]);
}

static void a_command_that_comes_again_leaves_its_answer_waiting(void) {
    send_control(LACONIC_WIRE_COMMAND_BEGIN);
    bench_send_count(LACONIC_WIRE_CONTROL, data, sent[LACONIC_WIRE_CONTROL]);
    TEST_ASSERT_EQUAL_HEX16(BIT_OF(LACONIC_WIRE_CONTROL), node.answers_due);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_BEGIN, data[2]);
}

static void a_reset_makes_nothing_due_but_its_answer(void) {
    int count[LACONIC_WIRE_OFFSETS];
    bench_load(2);
    send_control(LACONIC_WIRE_COMMAND_RESET);
    TEST_ASSERT_EQUAL_INT(1, fetch_all(count));
    TEST_ASSERT_EQUAL_INT(1, count[LACONIC_WIRE_RESULT]);
}

/* IMU has in one choice the bit that encoders have in the other. */
static void frames_of_the_imu_come_beside_raw_numbers_of_encoders(void) {
    load();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_IMU, LACONIC_RAW_ENCODER, 0));
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IMU, data));
}

static void the_frames_of_a_sync_come_after_its_last_step(void) {
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    bench_sync(2 * LACONIC_NODE_STEPS_PER_TICK + 3);
    for (int k = 1; k <= 3; k++) {
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL(k == 3, bench_receive(LACONIC_WIRE_NU, data));
    }
}

/* --------------------------------------------------------------------------------------- counting -- */

/* Fetches all, each of which has the next count of its kind. */
static void fetch_counted(uint8_t counts[LACONIC_WIRE_OFFSETS], uint32_t *seen) {
    laconic_frame frame;
    while (laconic_node_next_frame(&node, &frame)) {
        const uint8_t offset = (uint8_t)(frame.id - LACONIC_WIRE_ID_BASE);
        counts[offset]++;
        TEST_ASSERT_EQUAL_UINT8(counts[offset] & (frame.fd ? 255U : 15U), laconic_counter_of(offset, frame.data));
        *seen |= BIT_OF(offset);
    }
}

static void every_kind_of_frame_has_a_count_of_its_own(void) {
    uint8_t counts[LACONIC_WIRE_OFFSETS] = {0};
    uint32_t seen = 0;
    load();
    memcpy(counts + LACONIC_WIRE_NODE_FIRST, node.sent, sizeof node.sent);
    for (int k = 0; k < 6; k++) {
        const uint8_t select[LACONIC_FRAME_BYTES] = {
            0, 0, EVERY_FRAME, (uint8_t)(EVERY_NUMBER | (k % 2 ? RAW_BY_FD : 0U)), SELECTS_ESTIMATE};
        bench_send(LACONIC_WIRE_SELECT, select);
        laconic_node_publish(&node);
        pass_a_heartbeat();
        send_hello();
        fetch_counted(counts, &seen);
        send_control(LACONIC_WIRE_COMMAND_BEGIN);
        fetch_counted(counts, &seen);
    }
    TEST_ASSERT_EQUAL_HEX32(BIT_OF(LACONIC_WIRE_STEERING) - BIT_OF(LACONIC_WIRE_NODE_FIRST), seen); /* no hinges */
}

/* ---------------------------------------------------------------------------------------- telling -- */

static void two_numbers_out_of_range_set_the_flag_as_one_does(void) {
    const laconic_start start = {{1000, -1000, 0}, 0, 0, 0, {0}};
    bench_load(0);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_NU, data);
    TEST_ASSERT_EQUAL_HEX8(0x10, data[1]);
}

static void a_heartbeat_tells_while_drives_play_that_one_is_unheard(void) {
    bench_load(2);
    node.state = LACONIC_WIRE_STATE_DRIVES;
    node.drives.count = 1;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0, data[7] & 0x80U);
    node.drives.drive[0].unheard = true;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0x80, data[7] & 0x80U);
}

static void the_state_has_each_wheel_with_its_own_speed(void) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    const laconic_start start = {{10, 20, 35}, 0, 0, 0, {0}};
    laconic_real speed[LACONIC_MAX_WHEELS];
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, SCENE_STEP_S, &start, NULL));
    laconic_plant_wheel_speeds(&node.plant, speed);
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_INT_WITHIN(1, (int)(speed[k] * 200), (int16_t)word16(data + 32 + 2 * k));
        if (k > 0) TEST_ASSERT_TRUE(word16(data + 32 + 2 * k) != word16(data + 32));
    }
}

static void a_heartbeat_comes_to_the_microsecond_and_with_counters_where_they_were_chosen(void) {
    int count[LACONIC_WIRE_OFFSETS];
    load();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(EVERY_FRAME & ~LACONIC_NODE_SEND_COUNTERS, 0, 0));
    now_us = node.heartbeat_us + LACONIC_NODE_HEARTBEAT_US - 1U;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_INT(0, fetch_all(count));
    laconic_node_on_tick(&node, ++now_us);
    TEST_ASSERT_EQUAL_INT(1, fetch_all(count));
    TEST_ASSERT_EQUAL_INT(1, count[LACONIC_WIRE_HEARTBEAT]);
}

/* Of two encoders, on the first wheel and on the last, the first has been fetched when a reset comes. */
static void encoders_of_the_last_wheel_are_sent_and_wait_through_a_reset(void) {
    laconic_sensor_settings with = {.encoder[0] = {256, 3}};
    with.encoder[LACONIC_MAX_WHEELS - 1] = with.encoder[0];
    bench_load(LACONIC_MAX_WHEELS);
    node.has_sensors = true;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    for (int k = 0; k < 2; k++) {
        laconic_node_publish(&node);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
        TEST_ASSERT_EQUAL_UINT8(0, data[1] >> 4);
        if (k == 1) TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_MAX_WHEELS - 1, data[1] >> 4);
        TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
    }
}

static void an_encoder_that_falls_away_takes_no_other_frame_along(void) {
    static const laconic_sensor_settings none;
    load();
    bench_select(LACONIC_NODE_SEND_ENCODER | LACONIC_NODE_SEND_NU, 0, 0);
    laconic_node_publish(&node);
    node.pending |= BIT_OF(LACONIC_WIRE_ERROR_ESTIMATE);
    laconic_node_start_sensors(&node, &none);
    TEST_ASSERT_EQUAL_HEX32(BIT_OF(LACONIC_WIRE_NU) | BIT_OF(LACONIC_WIRE_ERROR_ESTIMATE), node.pending);
}

static void a_frame_that_is_none_of_the_nodes_is_so_for_one_reason_or_for_two(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE, .length = 8, .extended = true};
    for (uint32_t k = 0; k < 3; k++) {
        frame.id = LACONIC_WIRE_ID_BASE + k * LACONIC_NODE_ID_STRIDE;
        laconic_node_on_frame(&node, &frame, now_us);
    }
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.malformed);
    const laconic_frame wrong = {.id = LACONIC_WIRE_ID_BASE, .length = 8, .remote = true, .fd = true};
    laconic_node_on_frame(&node, &wrong, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.malformed);
}

static void each_encoders_frame_tells_its_own_counts(void) {
    load();
    for (uint8_t wheel = 0; wheel < 4; wheel++) {
        struct laconic_dbc_encoder_t frame;
        node.encoder_wheel = wheel;
        node.sensors.settings.encoder[wheel].counts_per_turn = wheel + 1;
        node.sensors.encoder[wheel].count = 100 + wheel;
        laconic_node_pack(&node, LACONIC_WIRE_ENCODER, data);
        laconic_dbc_encoder_unpack(&frame, data, 8);
        TEST_ASSERT_TRUE(frame.wheel == wheel && frame.count == 100 + wheel &&
                         frame.index_count == (100 + wheel) / (wheel + 1));
    }
}

/* As a bit of the count that changes would make it: no voltage is taken, and nothing of wheels is sent. */
static void a_count_of_wheels_below_none_is_none(void) {
    load();
    bench_select(LACONIC_NODE_SEND_WHEEL_SPEED | LACONIC_NODE_SEND_WHEEL_ANGLE, LACONIC_RAW_ENCODER, 0x10);
    TEST_ASSERT_EQUAL_HEX8(LACONIC_RAW_ENCODER | LACONIC_RAW_HELD_TORQUE, node.raw_output.send);
    bench_start_lockstep();
    node.plant.model.wheel_count = INT32_MIN + node.plant.model.wheel_count;
    bench_voltage(0, 500, 0);
    memset(data, 1, sizeof data);
    data[3] = 0;
    bench_send(LACONIC_WIRE_VOLTAGE_FD, data);
    for (int k = 0; k < LACONIC_MAX_WHEELS; k++) TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == 0);
    laconic_node_publish(&node);
    TEST_ASSERT_EQUAL_HEX32(0, node.pending);
    TEST_ASSERT_EQUAL_UINT16(0, node.raw_output.size);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_frame_that_waits_goes_on_waiting_when_it_is_due_again);
    RUN_TEST(a_command_that_comes_again_leaves_its_answer_waiting);
    RUN_TEST(a_reset_makes_nothing_due_but_its_answer);
    RUN_TEST(frames_of_the_imu_come_beside_raw_numbers_of_encoders);
    RUN_TEST(the_frames_of_a_sync_come_after_its_last_step);
    RUN_TEST(every_kind_of_frame_has_a_count_of_its_own);
    RUN_TEST(two_numbers_out_of_range_set_the_flag_as_one_does);
    RUN_TEST(a_heartbeat_tells_while_drives_play_that_one_is_unheard);
    RUN_TEST(the_state_has_each_wheel_with_its_own_speed);
    RUN_TEST(a_heartbeat_comes_to_the_microsecond_and_with_counters_where_they_were_chosen);
    RUN_TEST(encoders_of_the_last_wheel_are_sent_and_wait_through_a_reset);
    RUN_TEST(an_encoder_that_falls_away_takes_no_other_frame_along);
    RUN_TEST(a_frame_that_is_none_of_the_nodes_is_so_for_one_reason_or_for_two);
    RUN_TEST(each_encoders_frame_tells_its_own_counts);
    RUN_TEST(a_count_of_wheels_below_none_is_none);
    return UNITY_END();
}
