/* Tests of a node's steps: with sensors and without, by drives, sampled, and when the next one is due. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

#define RAW_BY_FD 0x80U              /* with the bits of RAW_OUTPUT */
#define SELECT_RAW_AXLE_TORQUE 0x10U /* with the take_ bits */

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

static void play(uint8_t raw, uint8_t take) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    memset(&node.start, 0, sizeof node.start);
    scene_plant(&node.plant, &vehicle);
    node.drive_plan = scene_plan(3);
    node.state = LACONIC_WIRE_STATE_READY;
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, raw, take));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
}

static void sensors_that_nobody_asks_for_see_nothing_of_drives(void) {
    play(0, 0);
    bench_pass_ms(3);
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT64(0, node.sensors.newest);
}

static void a_step_of_drives_that_is_refused_ends_in_fault_under_sensors_too(void) {
    play(LACONIC_RAW_IMU, 0);
    bench_pass_ms(3);
    TEST_ASSERT_EQUAL_UINT64(3, node.sensors.newest);
    node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
    bench_pass_ms(1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_BODY_MOMENT, data[4]); /* what the step was refused for */
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT64(3, node.sensors.newest);
}

/* As those that go by classic frames. */
static void the_next_step_waits_until_the_torques_are_sent_by_can_fd(void) {
    play(LACONIC_RAW_WHEEL_SPEED | RAW_BY_FD, SELECT_RAW_AXLE_TORQUE);
    bench_pass_ms(1);
    laconic_node_on_tick(&node, now_us); /* and until its time has come */
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    bench_pass_ms(4);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RAW_OUTPUT_FD, data));
    while (bench_receive(LACONIC_WIRE_RAW_OUTPUT_FD, data)) {
    }
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(2, node.plant.steps);
}

/* A sampled step with these voltages at its start, middle and end, beside the core's. */
static void expect_sampled(uint8_t raw) {
    bench_load(2);
    laconic_plant twin = node.plant;
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, raw, LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE));
    bench_start_lockstep();
    for (int k = 0; k < 3; k++) node.input[k].voltage_V[0] = REAL(1 + k * k);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_run_sampled(&twin, node.input, NULL));
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    TEST_ASSERT_EQUAL_MEMORY(&twin.state, &node.plant.state, sizeof twin.state);
}

static void sampled_steps_have_the_cores_bits_whether_sensors_watch_or_not(void) {
    expect_sampled(0);
    TEST_ASSERT_EQUAL_UINT64(0, node.sensors.newest);
    bench_begin();
    expect_sampled(LACONIC_RAW_IMU);
    TEST_ASSERT_EQUAL_UINT64(1, node.sensors.newest);
}

/* The periods of a free run before it do not wake a node in lockstep. */
static void in_lockstep_a_node_sleeps_until_its_heartbeat(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 100, 0));
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL_UINT32(LACONIC_NODE_HEARTBEAT_US - (now_us - node.heartbeat_us),
                             laconic_node_idle_us(&node, now_us));
}

/* So that frames are heard between: 65 steps take a second tick, 64 do not. */
static void a_tick_takes_so_many_steps_and_no_more(void) {
    for (uint32_t more = 0; more < 2; more++) {
        bench_begin();
        bench_load(2);
        bench_start_lockstep();
        laconic_node_sync(&node, LACONIC_NODE_STEPS_PER_TICK + more, 0, 1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(64, node.plant.steps);
        TEST_ASSERT_EQUAL_UINT32(more, node.lockstep.steps_due);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(64 + more, node.plant.steps);
    }
}

/* Frames that come before or behind the torques may wait. */
static void only_the_torques_hold_the_next_step_back(void) {
    const uint8_t select[LACONIC_FRAME_BYTES] = {0, 0, LACONIC_NODE_SEND_IMU, 0, SELECT_RAW_AXLE_TORQUE};
    laconic_frame frame;
    play(0, 0);
    bench_send(LACONIC_WIRE_SELECT, select);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    bench_pass_ms(2);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    while (node.pending & BIT_OF(LACONIC_WIRE_RAW_OUTPUT)) TEST_ASSERT_TRUE(laconic_node_next_frame(&node, &frame));
    TEST_ASSERT_EQUAL_HEX32(BIT_OF(LACONIC_WIRE_IMU), node.pending);
    bench_send(LACONIC_WIRE_SELECT, select);
    TEST_ASSERT_EQUAL_HEX32(BIT_OF(LACONIC_WIRE_RESULT) | BIT_OF(LACONIC_WIRE_IMU), node.pending);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(2, node.plant.steps);
}

static void drives_have_the_time_of_their_node_whoever_watches(void) {
    static const uint8_t raw[] = {0, LACONIC_RAW_IMU, LACONIC_RAW_IMU}, take[] = {0, 0, 0x20U};
    const laconic_frame frame = {.id = 0x200, .length = 8};
    for (int k = 0; k < 3; k++) {
        bench_begin();
        now_us = 5000000;
        play(raw[k], take[k]);
        TEST_ASSERT_EQUAL_UINT32(now_us, node.drives.now_us);
        bench_pass_ms(3);
        TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
        TEST_ASSERT_EQUAL_UINT32(now_us, node.drives.now_us);
        now_us += 500;
        laconic_node_on_frame(&node, &frame, now_us);
        TEST_ASSERT_EQUAL_UINT32(now_us, node.drives.now_us);
    }
}

/* In lockstep, in sampled steps and by drives, watched by nobody, by sensors, by an estimate or by both. */
static void a_refused_step_names_its_field_whoever_watches(void) {
    for (unsigned k = 0; k < 12; k++) {
        const uint8_t raw = k & 1U ? LACONIC_RAW_IMU : 0, estimate = k & 2U ? 0x20U : 0;
        const uint8_t sampled = k / 4 == 1 ? LACONIC_RAW_SAMPLED : 0;
        bench_begin();
        if (k / 4 == 2) {
            play(raw, estimate);
        } else {
            bench_load(2);
            TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, raw, estimate | sampled));
            bench_start_lockstep();
            bench_sync(1);
        }
        node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
        bench_pass_ms(1);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, data[3]);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_BODY_MOMENT, data[4]);
    }
}

static void frames_of_the_plant_ask_for_no_sensors(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0xFFU & ~(LACONIC_NODE_SEND_IMU | LACONIC_NODE_SEND_ENCODER), 0x1F, 0));
    bench_start_lockstep();
    bench_sync(3);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT64(0, node.sensors.newest);
}

/* Whatever number it has: the stream that it found incomplete is forgotten. */
static void a_sync_begins_raw_inputs_anew(void) {
    const uint8_t bytes[6] = {0};
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, LACONIC_RAW_VOLTAGE));
    bench_start_lockstep();
    for (uint8_t request = 0; request < 16; request++) {
        TEST_ASSERT_TRUE(laconic_node_raw(&node, bytes, 0, 15, 6));
        laconic_node_sync(&node, 1, 1, request);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, node.answer[LACONIC_WIRE_SYNC].status);
        TEST_ASSERT_EQUAL_UINT32(0, node.raw_input.frames);
    }
}

static void raw_numbers_and_an_estimate_make_a_node_speak_while_drives_play(void) {
    play(LACONIC_RAW_WHEEL_SPEED, 0x20U);
    bench_pass_ms(100);
    TEST_ASSERT_TRUE(node.pending & BIT_OF(LACONIC_WIRE_HEARTBEAT));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sensors_that_nobody_asks_for_see_nothing_of_drives);
    RUN_TEST(a_sync_begins_raw_inputs_anew);
    RUN_TEST(a_step_of_drives_that_is_refused_ends_in_fault_under_sensors_too);
    RUN_TEST(the_next_step_waits_until_the_torques_are_sent_by_can_fd);
    RUN_TEST(sampled_steps_have_the_cores_bits_whether_sensors_watch_or_not);
    RUN_TEST(in_lockstep_a_node_sleeps_until_its_heartbeat);
    RUN_TEST(a_tick_takes_so_many_steps_and_no_more);
    RUN_TEST(only_the_torques_hold_the_next_step_back);
    RUN_TEST(drives_have_the_time_of_their_node_whoever_watches);
    RUN_TEST(a_refused_step_names_its_field_whoever_watches);
    RUN_TEST(frames_of_the_plant_ask_for_no_sensors);
    RUN_TEST(raw_numbers_and_an_estimate_make_a_node_speak_while_drives_play);
    return UNITY_END();
}
