/* Tests of what a node tells: RESULTs with command, field and item, the vehicle's own pose, numbers of sensors. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

/* ---------------------------------------------------------------------------------------- RESULTs -- */

static void every_result_names_its_command(void) {
    static const uint8_t commands[] = {LACONIC_WIRE_COMMAND_BEGIN, LACONIC_WIRE_COMMAND_START_LOCKSTEP,
                                       LACONIC_WIRE_COMMAND_STOP, LACONIC_WIRE_COMMAND_RESET};
    bench_load(2);
    for (size_t k = 0; k < sizeof commands; k++) {
        const struct laconic_dbc_control_t frame = {.command = commands[k]};
        laconic_dbc_control_pack(data, &frame, 8);
        bench_send(LACONIC_WIRE_CONTROL, data);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(commands[k], data[2]);
        TEST_ASSERT_TRUE(data[3] == 0 && data[4] == 0 && data[5] == 0);
    }
    const uint8_t select[LACONIC_FRAME_BYTES] = {0, 0, 0, 0, SELECTS_ESTIMATE};
    bench_send(LACONIC_WIRE_SELECT, select);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_SELECT, data[2]);
    TEST_ASSERT_TRUE(node.estimates);
}

/* Another number has come before: in double, the lower half of one of another field. */
static void a_parameter_that_is_refused_is_named_with_its_item(void) {
    struct laconic_dbc_parameter_t frame = {.field = LACONIC_FIELD_WHEEL_X, .item = 2, .value = 5};
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    frame = (struct laconic_dbc_parameter_t){.field = 201, .item = 7, .value = 1};
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_PARAMETER, data[2]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, data[3]);
    TEST_ASSERT_TRUE(data[4] == 201 && data[5] == 7);
}

static void a_plan_of_drives_that_is_refused_is_named_with_its_wheel(void) {
    laconic_drive_plan plan = scene_plan(3);
    uint8_t field = 0, item = 0;
    plan.drive[2].gear_ratio = 0;
    const uint8_t status = laconic_node_check_drives(&node, &plan, 4, &field, &item);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, status);
    TEST_ASSERT_TRUE(field == LACONIC_DRIVES_FIELD_DRIVE_GEAR_RATIO && item == 3 && status != 3);
}

/* ------------------------------------------------------------------------------------------- steps -- */

/* Sampled inputs wait for their SYNC like all others, and nothing is published meanwhile. */
static void in_lockstep_a_tick_without_a_sync_does_nothing(void) {
    for (int sampled = 0; sampled < 2; sampled++) {
        bench_begin();
        bench_load(2);
        TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, 0, sampled ? LACONIC_RAW_SAMPLED : 0));
        bench_start_lockstep();
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
        TEST_ASSERT_EQUAL_HEX32(0, node.pending & BIT_OF(LACONIC_WIRE_NU));
    }
}

static void a_vehicle_without_wheels_takes_no_second_group_of_voltages(void) {
    const struct laconic_dbc_voltage_t first = {.group = 0}, second = {.group = 1};
    bench_load(0);
    bench_start_lockstep();
    laconic_dbc_voltage_pack(data, &first, 8);
    TEST_ASSERT_TRUE(laconic_node_voltage(&node, data, now_us));
    laconic_dbc_voltage_pack(data, &second, 8);
    TEST_ASSERT_FALSE(laconic_node_voltage(&node, data, now_us));
}

static void lateness_is_that_of_the_period_that_was_latest(void) {
    bench_load(2);
    now_us = 5000;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 0));
    laconic_node_on_tick(&node, now_us + 1300);
    TEST_ASSERT_EQUAL_UINT32(300, node.free_run.worst_lateness_us);
    laconic_node_on_tick(&node, now_us + 2100);
    TEST_ASSERT_EQUAL_UINT32(300, node.free_run.worst_lateness_us);
}

/* ------------------------------------------------------------------------------------------- poses -- */

/* A vehicle that is loaded unevenly, turned by more than half a turn: its pose is as laconic_pose_of tells. */
static laconic_pose turned(void) {
    const laconic_start start = {{0, 0, 0}, (laconic_real)1.5, (laconic_real)-2.25, 7, {0}};
    laconic_vehicle vehicle = scene_vehicle(0);
    laconic_pose pose;
    vehicle.com_x_m = (laconic_real)0.125;
    vehicle.com_y_m = (laconic_real)0.0625;
    TEST_ASSERT_EQUAL(LACONIC_OK,
                      laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)0.001, &start, NULL));
    laconic_pose_of(&pose, &node.plant.model, &node.plant.state);
    TEST_ASSERT_TRUE(pose.x_m != pose.origin_x_m && pose.y_m != pose.origin_y_m);
    TEST_ASSERT_TRUE(pose.heading_rad > 6 && pose.heading_wrapped_rad < 1);
    return pose;
}

static void a_pose_is_that_of_the_centre_of_mass_with_its_heading_in_one_turn(void) {
    struct laconic_dbc_pose_t frame;
    const laconic_pose pose = turned();
    laconic_node_pack(&node, LACONIC_WIRE_POSE, data);
    laconic_dbc_pose_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(rounded(pose.x_m * LACONIC_WIRE_POSE_X_PER_UNIT), frame.x);
    TEST_ASSERT_EQUAL_INT(rounded(pose.y_m * LACONIC_WIRE_POSE_Y_PER_UNIT), frame.y);
    TEST_ASSERT_EQUAL_INT(rounded(pose.heading_wrapped_rad * LACONIC_WIRE_POSE_HEADING_PER_UNIT), frame.heading);
    TEST_ASSERT_EQUAL_UINT8(0, frame.overrange);
}

static void the_fd_frame_has_the_same_pose(void) {
    int32_t told[3];
    const laconic_pose pose = turned();
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    memcpy(told, data + 20, sizeof told);
    TEST_ASSERT_EQUAL_INT32(rounded(pose.x_m * LACONIC_WIRE_STATE_FD_X_PER_UNIT), told[0]);
    TEST_ASSERT_EQUAL_INT32(rounded(pose.y_m * LACONIC_WIRE_STATE_FD_Y_PER_UNIT), told[1]);
    TEST_ASSERT_EQUAL_INT32(rounded(pose.heading_wrapped_rad * LACONIC_WIRE_STATE_FD_HEADING_PER_UNIT), told[2]);
}

/* RAW_OUTPUT tells the heading with its whole turns. */
static void a_raw_pose_has_its_whole_heading(void) {
    laconic_sensor_outputs sensed = {0};
    const laconic_pose pose = turned();
    node.raw_output.send = LACONIC_RAW_POSE;
    laconic_raw_collect(&node.raw_output, &node.plant, &node.input[0], &sensed);
    TEST_ASSERT_TRUE(node.raw_output.number[0] == pose.x_m && node.raw_output.number[1] == pose.y_m);
    TEST_ASSERT_TRUE(node.raw_output.number[2] == pose.heading_rad);
}

static void half_a_unit_and_a_hundredth_is_one(void) {
    const laconic_start start = {{(laconic_real)(0.51 / 200), (laconic_real)(-0.51 / 200), 0}, 0, 0, 0, {0}};
    struct laconic_dbc_nu_t nu;
    bench_load(0);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_NU, data);
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_TRUE(nu.nu_1 == 1 && nu.nu_2 == -1);
}

/* ----------------------------------------------------------------------------------------- sensors -- */

/* Noise has a density, so its size depends on the step. */
static void an_imu_frame_has_the_noise_of_the_plants_step(void) {
    const laconic_sensor_settings with = {.imu = {.acceleration_noise_m_per_s2_per_sqrt_Hz = (laconic_real)0.5,
                                                  .yaw_rate_noise_rad_per_s_per_sqrt_Hz = (laconic_real)0.05,
                                                  .seed = 5}};
    struct laconic_dbc_imu_t frame;
    laconic_real acceleration[2], yaw_rate;
    bench_load(2);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
    laconic_imu_read(&node.sensors, node.plant.integrator.step_s, acceleration, &yaw_rate);
    laconic_node_pack(&node, LACONIC_WIRE_IMU, data);
    laconic_dbc_imu_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(rounded(acceleration[0] * LACONIC_WIRE_IMU_ACCELERATION_X_PER_UNIT), frame.acceleration_x);
    TEST_ASSERT_EQUAL_INT(rounded(acceleration[1] * LACONIC_WIRE_IMU_ACCELERATION_Y_PER_UNIT), frame.acceleration_y);
    TEST_ASSERT_EQUAL_INT(rounded(yaw_rate * LACONIC_WIRE_IMU_YAW_RATE_PER_UNIT), frame.yaw_rate);
    TEST_ASSERT_TRUE(frame.acceleration_x != 0 && frame.yaw_rate != 0);
}

/* Tests of node_session.c and protection.c: what passes before a session is open, and the keys of its runs. */

/* A node that has answered one HELLO since it was powered up. */
static uint32_t greeted(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    return bench_hello();
}

static void a_later_hello_leaves_the_nonce_of_a_handshake_that_goes_on(void) {
    const uint32_t nonce = greeted();
    now_us += 1000;
    TEST_ASSERT_EQUAL_HEX32(nonce, bench_hello());
    const laconic_frame open = bench_open_frame(9, nonce);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void each_challenge_names_the_hello_that_it_answers(void) {
    greeted();
    for (uint8_t count = 1; count < 16; count += 7) {
        laconic_frame hello = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
        struct laconic_dbc_challenge_t challenge = {0};
        laconic_protect_plain(LACONIC_WIRE_HELLO, hello.data, count);
        laconic_node_on_frame(&node, &hello, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_CHALLENGE, data));
        laconic_dbc_challenge_unpack(&challenge, data, 8);
        TEST_ASSERT_EQUAL(count, challenge.request);
    }
}

/* The keys of a node whose session was never opened are zero, and so is the number of its session. */
static void a_nonce_opens_nothing_by_itself(void) {
    greeted();
    bench_key = 0;
    sent[LACONIC_WIRE_CONTROL] = 0;
    TEST_ASSERT_EQUAL_UINT8(255, bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0));
    const laconic_frame nothing = bench_open_frame(0, 0);
    laconic_node_on_frame(&node, &nothing, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

/* The numbers are those of mix(key, count + 32) in reference_client.py. */
static void a_run_has_a_key_of_its_session_and_its_start(void) {
    TEST_ASSERT_EQUAL_HEX32(0x511477A0U, laconic_run_key(0x12345678U, 1));
    TEST_ASSERT_EQUAL_HEX32(0x689BB163U, laconic_run_key(0x9ABCDEF0U, 7));
}

static void a_motion_frame_that_is_spoilt_is_counted_as_that(void) {
    bench_load(2);
    bench_start_lockstep();
    const uint16_t gaps = node.counters.sequence_errors, spoilt = node.counters.crc_errors;
    const struct laconic_dbc_sync_t sync = {.step_count = 1};
    laconic_dbc_sync_pack(data, &sync, 8);
    bench_run_key ^= 1U;
    bench_send_count(LACONIC_WIRE_SYNC, data, 1);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == gaps && node.counters.crc_errors == spoilt + 1);
    bench_run_key ^= 1U;
    bench_send_count(LACONIC_WIRE_SYNC, data, 3);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == gaps + 1 && node.counters.crc_errors == spoilt + 1);
}

static void a_new_session_has_open_ears(void) {
    node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    bench_open(12);
    TEST_ASSERT_EQUAL_HEX32(0, node.session.deaf);
}

/* One that is not right, before any HELLO. */
static void an_open_that_nobody_asked_for_opens_nothing(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    const laconic_frame open = bench_open_frame(9, 0x12345678U);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_FALSE(node.session.open);
    TEST_ASSERT_TRUE(node.counters.crc_errors == 1 && node.counters.accepted == 0);
}

static void a_command_with_a_wrong_key_is_not_executed_before_a_session_either(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    bench_send_count(LACONIC_WIRE_CONTROL, data, 1);
    TEST_ASSERT_TRUE(node.counters.crc_errors == 1 && node.counters.accepted == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_result_names_its_command);
    RUN_TEST(a_parameter_that_is_refused_is_named_with_its_item);
    RUN_TEST(a_plan_of_drives_that_is_refused_is_named_with_its_wheel);
    RUN_TEST(in_lockstep_a_tick_without_a_sync_does_nothing);
    RUN_TEST(a_vehicle_without_wheels_takes_no_second_group_of_voltages);
    RUN_TEST(lateness_is_that_of_the_period_that_was_latest);
    RUN_TEST(a_pose_is_that_of_the_centre_of_mass_with_its_heading_in_one_turn);
    RUN_TEST(the_fd_frame_has_the_same_pose);
    RUN_TEST(a_raw_pose_has_its_whole_heading);
    RUN_TEST(half_a_unit_and_a_hundredth_is_one);
    RUN_TEST(an_imu_frame_has_the_noise_of_the_plants_step);
    RUN_TEST(each_challenge_names_the_hello_that_it_answers);
    RUN_TEST(a_later_hello_leaves_the_nonce_of_a_handshake_that_goes_on);
    RUN_TEST(a_nonce_opens_nothing_by_itself);
    RUN_TEST(a_run_has_a_key_of_its_session_and_its_start);
    RUN_TEST(a_motion_frame_that_is_spoilt_is_counted_as_that);
    RUN_TEST(a_new_session_has_open_ears);
    RUN_TEST(an_open_that_nobody_asked_for_opens_nothing);
    RUN_TEST(a_command_with_a_wrong_key_is_not_executed_before_a_session_either);
    return UNITY_END();
}
