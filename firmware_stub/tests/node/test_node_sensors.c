/* Tests of a node's IMU and encoders: settings, frames, raw numbers. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

static laconic_sensor_settings settings(void) {
    laconic_sensor_settings s = {.imu = {.x_m = REAL(0.1), .acceleration_bias_m_per_s2 = {REAL(0.5), 0}}};
    s.encoder_wrap = 1000;
    s.encoder[1] = (laconic_encoder_settings){256, -3};
    return s;
}

/* The cart at rest with these sensors. */
static void load(laconic_sensor_settings with) {
    bench_load(2);
    node.has_sensors = true;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
}

void setUp(void) { bench_begin(); }

void tearDown(void) {}

static laconic_sensor_outputs readings(void) {
    laconic_sensor_outputs out;
    memset(&out, 0, sizeof out);
    laconic_sensors_read(&out, &node.sensors, &node.plant, &node.input[0]);
    return out;
}

/* -------------------------------------------------------------------------------------- settings -- */

static void parameter(uint8_t upper, uint8_t field, uint8_t item, uint32_t value) {
    const struct laconic_dbc_parameter_t frame = {.upper_half = upper, .field = field, .item = item, .value = value};
    uint8_t payload[LACONIC_FRAME_BYTES];
    laconic_dbc_parameter_pack(payload, &frame, 8);
    laconic_loader_take(&node.loader, payload);
}

static void real_parameter(uint8_t field, uint8_t item, laconic_real value) {
    uint32_t words[2] = {0, 0};
    memcpy(words, &value, sizeof value);
    parameter(0, field, item, words[0]);
    if (sizeof value == 8) parameter(1, field, item, words[1]);
}

static void each_setting_has_its_number_on_the_wire(void) {
    const laconic_sensor_settings *got = &node.loader.parameters.sensors;
    real_parameter(81, 0, REAL(0.25));
    real_parameter(84, 2, REAL(-0.5));
    parameter(0, 91, 0, 7);
    parameter(0, 92, 0, (uint32_t)-3);
    parameter(0, 93, 2, 4096);
    real_parameter(94, 2, REAL(-19.5));
    parameter(0, 95, 0, 65536);
    TEST_ASSERT_EQUAL_UINT8(0, node.loader.status);
    TEST_ASSERT_TRUE(got->imu.y_m == REAL(0.25) && got->imu.acceleration_bias_m_per_s2[1] == REAL(-0.5));
    TEST_ASSERT_TRUE(got->imu.delay_steps == 7 && got->imu.seed == -3 && got->encoder_wrap == 65536);
    TEST_ASSERT_TRUE(got->encoder[1].counts_per_turn == 4096 && got->encoder[1].gear_ratio == REAL(-19.5));
    real_parameter(84, 3, 1); /* there is no third axis */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, node.loader.status);
}

/* A puck with what it must have, and the delay; the status of COMMIT's RESULT, which stays in `data`. */
static uint8_t commit_puck(int32_t delay_steps) {
    laconic_loader_begin(&node.loader);
    real_parameter(LACONIC_FIELD_MASS, 0, 2);
    real_parameter(LACONIC_FIELD_YAW_INERTIA, 0, 1);
    real_parameter(LACONIC_FIELD_WHEEL_RADIUS, 0, 1);
    real_parameter(LACONIC_FIELD_STEP, 0, REAL(0.01));
    parameter(0, LACONIC_FIELD_WHEEL_COUNT, 0, 0);
    parameter(0, LACONIC_SENSOR_FIELD_IMU_DELAY, 0, (uint32_t)delay_steps);
    return bench_commit(data);
}

static void bad_settings_are_refused_with_their_field_and_the_vehicle_stays(void) {
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(5));
    TEST_ASSERT_TRUE(node.has_sensors && node.sensors.settings.imu.delay_steps == 5);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_ABOVE_LIMIT, commit_puck(100000));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_SENSOR_FIELD_IMU_DELAY, data[4]);
    TEST_ASSERT_EQUAL_INT(5, node.sensors.settings.imu.delay_steps);
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(0));
    TEST_ASSERT_FALSE(node.has_sensors);
}

/* ---------------------------------------------------------------------------------------- frames -- */

static void imu_frames_show_its_readings_scaled(void) {
    load(settings());
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_IMU, 0, 0));
    bench_start_lockstep();
    bench_step(20);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IMU, data));
    const laconic_sensor_outputs now = readings();
    TEST_ASSERT_TRUE(now.imu_acceleration_m_per_s2[1] > 1 && now.imu_acceleration_m_per_s2[0] > REAL(0.3));
    struct laconic_dbc_imu_t frame;
    laconic_dbc_imu_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(rounded(now.imu_acceleration_m_per_s2[0] * 200), frame.acceleration_x);
    TEST_ASSERT_EQUAL_INT(rounded(now.imu_acceleration_m_per_s2[1] * 200), frame.acceleration_y);
    TEST_ASSERT_EQUAL_INT(rounded(now.imu_yaw_rate_rad_per_s * 1000), frame.yaw_rate);
    TEST_ASSERT_EQUAL_INT(0, frame.overrange);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_IMU, data));
}

static void a_reading_beyond_its_frame_saturates_with_the_flag(void) {
    laconic_sensor_settings with = settings();
    with.imu.acceleration_bias_m_per_s2[0] = -1000;
    load(with);
    bench_select(LACONIC_NODE_SEND_IMU, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IMU, data));
    struct laconic_dbc_imu_t frame;
    laconic_dbc_imu_unpack(&frame, data, 8);
    TEST_ASSERT_TRUE(frame.acceleration_x == -32767 && frame.overrange == 1);
}

static void encoder_frames_come_for_the_wheels_that_have_one(void) {
    struct laconic_dbc_encoder_t frame;
    load(settings());
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    bench_start_lockstep();
    bench_step(2000);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
    laconic_dbc_encoder_unpack(&frame, data, 8);
    const int64_t count = node.sensors.encoder[1].count;
    TEST_ASSERT_TRUE(count < -500); /* its gear turns it backwards */
    TEST_ASSERT_EQUAL_INT(1, frame.wheel);
    TEST_ASSERT_EQUAL_INT((int)(count % 1000 + 1000), frame.count);
    TEST_ASSERT_EQUAL_INT((int)((count + 1) / 256 - 1), frame.index_count);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
    bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0);
    TEST_ASSERT_TRUE(node.sensors.encoder[1].count == 0 && node.has_sensors);
}

static void two_encoders_take_two_frames(void) {
    laconic_sensor_settings with = settings();
    with.encoder[0] = (laconic_encoder_settings){256, 3};
    load(with);
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
        TEST_ASSERT_EQUAL_INT(k, data[1] >> 4);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
}

/* The bus is busy: a frame of the encoder waits while another vehicle, without encoders, is committed. */
static void an_encoder_frame_that_waits_falls_away_with_its_encoder(void) {
    load(settings());
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(0));
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
}

static void an_encoder_frame_that_waits_survives_a_reset(void) {
    load(settings());
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
    TEST_ASSERT_EQUAL_INT(1, data[1] >> 4);
}

static void frames_of_all_sensors_wait_side_by_side(void) {
    uint32_t seen = 0;
    laconic_frame frame;
    load(settings());
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE | LACONIC_NODE_SEND_ENCODER | LACONIC_NODE_SEND_IMU, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    while (laconic_node_next_frame(&node, &frame)) seen |= BIT_OF(frame.id - LACONIC_WIRE_ID_BASE);
    const uint32_t wanted = BIT_OF(LACONIC_WIRE_WHEEL_ANGLE) | BIT_OF(LACONIC_WIRE_IMU) | BIT_OF(LACONIC_WIRE_ENCODER);
    TEST_ASSERT_EQUAL_HEX32(wanted, seen & wanted);
}

static void a_vehicle_without_wheels_sends_neither_angles_nor_encoders(void) {
    bench_load(0);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE | LACONIC_NODE_SEND_ENCODER | LACONIC_NODE_SEND_IMU, 0, 0);
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    laconic_frame frame;
    TEST_ASSERT_TRUE(laconic_node_next_frame(&node, &frame));
    TEST_ASSERT_EQUAL_INT(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_IMU, (int)frame.id);
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &frame));
}

/* ------------------------------------------------------------------------------------ raw numbers -- */

static void have_all_their_bits_behind(size_t others, uint8_t raw) {
    laconic_real number[5 + 2];
    bench_begin();
    load(settings());
    bench_select(0, LACONIC_RAW_IMU | LACONIC_RAW_ENCODER | raw, 0);
    bench_start_lockstep();
    bench_step(30);
    const laconic_sensor_outputs now = readings();
    TEST_ASSERT_EQUAL_UINT16(others * sizeof number[0] + sizeof number, node.raw_output.size);
    memcpy(number, node.raw_output.number + others, sizeof number);
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(number[k] == now.acceleration_body_m_per_s2[k]);
        TEST_ASSERT_TRUE(number[2 + k] == now.imu_acceleration_m_per_s2[k]);
        TEST_ASSERT_TRUE(number[5 + k] == now.encoder_count[k]);
    }
    TEST_ASSERT_TRUE(number[4] == now.imu_yaw_rate_rad_per_s);
}

static void raw_numbers_of_sensors_have_all_their_bits(void) {
    have_all_their_bits_behind(0, 0);
    have_all_their_bits_behind(3, LACONIC_RAW_NU);
}

static void without_settings_a_selected_imu_is_an_ideal_one(void) {
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_IMU, LACONIC_RAW_IMU, 0);
    bench_start_lockstep();
    bench_step(10);
    const laconic_real *number = node.raw_output.number;
    TEST_ASSERT_TRUE(number[1] > REAL(9.9) &&
                     number[1] < REAL(10.1)); /* 2 · 5 V at 1 kg, 1 m and no inertia of wheels */
    TEST_ASSERT_TRUE(number[2] == number[0] && number[3] == number[1]);
    TEST_ASSERT_EQUAL_UINT64(10, node.sensors.newest);
}

static void sampled_and_free_running_steps_are_watched_too(void) {
    uint8_t frame[LACONIC_FRAME_BYTES] = {0};
    load(settings());
    bench_select(0, LACONIC_RAW_IMU, LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.sensors.newest);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_select(0, LACONIC_RAW_IMU, 0);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 0);
    for (int k = 0; k < 5; k++) {
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
    }
    TEST_ASSERT_EQUAL_UINT64(6, node.sensors.newest);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RAW_OUTPUT, frame));
}

/* ---------------------------------------------------------------------------------------- drives -- */

/* An encoder of the same counts and gear counts what the drive's counts: there is one kind of encoder. */
static void while_drives_play_a_wheels_encoder_counts_as_its_drives_does(void) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    laconic_sensor_settings with = {.encoder_wrap = 0};
    scene_plant(&node.plant, &vehicle);
    node.drive_plan = scene_plan(3);
    for (int i = 0; i < 4; i++) with.encoder[i] = (laconic_encoder_settings){8192, 20};
    node.has_sensors = true;
    laconic_sensors_start(&node.sensors, &with, &node.plant, NULL);
    node.state = LACONIC_WIRE_STATE_READY;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    for (int k = 0; k < 300; k++) {
        for (int i = 0; i < 4; i++) {
            node.drives.drive[i].target.mode = LACONIC_DRIVE_SPEED;
            node.drives.drive[i].target.speed_rad_per_s = REAL(10.0 * (i + 1));
        }
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
    }
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_TRUE(node.sensors.encoder[i].count > 1000);
        TEST_ASSERT_TRUE(node.sensors.encoder[i].count == node.drives.drive[i].encoder.count);
        TEST_ASSERT_TRUE(node.sensors.encoder[i].rest == node.drives.drive[i].encoder.rest);
    }
}

static void an_imu_that_was_not_selected_is_not_sent(void) {
    load(settings());
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)1 << LACONIC_WIRE_WHEEL_ANGLE, node.pending);
}

static void sensors_that_nobody_asks_for_see_nothing(void) {
    bench_load(2);
    bench_select(0, LACONIC_RAW_NU, 0);
    bench_start_lockstep();
    bench_step(5);
    TEST_ASSERT_EQUAL_UINT64(0, node.sensors.newest);
}

/* Either frame, either raw number, and settings alone: each is enough for the sensors to watch. */
static void one_wish_of_any_kind_makes_the_sensors_watch(void) {
    static const uint8_t wish[][2] = {
        {LACONIC_NODE_SEND_IMU, 0}, {LACONIC_NODE_SEND_ENCODER, 0}, {0, LACONIC_RAW_IMU}, {0, LACONIC_RAW_ENCODER}};
    for (size_t k = 0; k < sizeof wish / sizeof wish[0]; k++) {
        bench_begin();
        bench_load(2);
        TEST_ASSERT_EQUAL_UINT8(0, bench_select(wish[k][0], wish[k][1], 0));
        bench_start_lockstep();
        bench_step(3);
        TEST_ASSERT_EQUAL_UINT64(3, node.sensors.newest);
    }
    bench_begin();
    load(settings());
    bench_start_lockstep();
    bench_step(3);
    TEST_ASSERT_EQUAL_UINT64(3, node.sensors.newest);
}

/* A setting is one that is not 0, whichever byte of it says so. */
static void any_setting_but_0_gives_the_vehicle_sensors(void) {
    laconic_sensor_settings with;
    bench_load(2);
    for (size_t k = 0; k < sizeof with; k++) {
        memset(&with, 0, sizeof with);
        ((uint8_t *)&with)[k] = 1;
        node.has_sensors = false;
        laconic_node_start_sensors(&node, &with);
        TEST_ASSERT_TRUE(node.has_sensors);
    }
    memset(&with, 0, sizeof with);
    laconic_node_start_sensors(&node, &with);
    TEST_ASSERT_FALSE(node.has_sensors);
}

static void angles_that_were_not_selected_are_not_sent(void) {
    load(settings());
    bench_select(LACONIC_NODE_SEND_IMU, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)1 << LACONIC_WIRE_IMU, node.pending);
}

/* One of two frames of each kind is fetched; then a selection without sensors, and a step. */
static void frames_that_wait_go_on_where_they_were_though_no_sensor_is_selected_now(void) {
    laconic_sensor_settings with = settings();
    with.encoder[3] = (laconic_encoder_settings){256, 3};
    bench_load(4);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE | LACONIC_NODE_SEND_ENCODER, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    TEST_ASSERT_EQUAL_INT(0, data[1] >> 5);
    node.pending &= ~BIT_OF(LACONIC_WIRE_WHEEL_ANGLE);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
    TEST_ASSERT_EQUAL_INT(1, data[1] >> 4);
    node.pending |= BIT_OF(LACONIC_WIRE_WHEEL_ANGLE);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    TEST_ASSERT_EQUAL_INT(1, data[1] >> 5);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
    TEST_ASSERT_EQUAL_INT(3, data[1] >> 4);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
}

/* The bit of the one in `send` is that of the other in RAW_OUTPUT. */
static void an_imus_frame_and_raw_counts_are_sent_together(void) {
    load(settings());
    bench_select(LACONIC_NODE_SEND_IMU, LACONIC_RAW_ENCODER, 0);
    bench_start_lockstep();
    bench_step(2000);
    TEST_ASSERT_TRUE(node.raw_output.number[1] == readings().encoder_count[1]);
    TEST_ASSERT_TRUE(node.raw_output.number[1] > 0);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IMU, data));
}

/* Not even behind the last wheel. */
static void without_encoders_none_is_next(void) {
    for (int32_t wheel = 0; wheel <= LACONIC_MAX_WHEELS; wheel++)
        TEST_ASSERT_EQUAL_UINT8(LACONIC_MAX_WHEELS, laconic_node_encoder_from(&node, wheel));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(each_setting_has_its_number_on_the_wire);
    RUN_TEST(bad_settings_are_refused_with_their_field_and_the_vehicle_stays);
    RUN_TEST(imu_frames_show_its_readings_scaled);
    RUN_TEST(a_reading_beyond_its_frame_saturates_with_the_flag);
    RUN_TEST(encoder_frames_come_for_the_wheels_that_have_one);
    RUN_TEST(two_encoders_take_two_frames);
    RUN_TEST(an_encoder_frame_that_waits_falls_away_with_its_encoder);
    RUN_TEST(an_encoder_frame_that_waits_survives_a_reset);
    RUN_TEST(frames_of_all_sensors_wait_side_by_side);
    RUN_TEST(a_vehicle_without_wheels_sends_neither_angles_nor_encoders);
    RUN_TEST(raw_numbers_of_sensors_have_all_their_bits);
    RUN_TEST(without_settings_a_selected_imu_is_an_ideal_one);
    RUN_TEST(sampled_and_free_running_steps_are_watched_too);
    RUN_TEST(while_drives_play_a_wheels_encoder_counts_as_its_drives_does);
    RUN_TEST(an_imu_that_was_not_selected_is_not_sent);
    RUN_TEST(sensors_that_nobody_asks_for_see_nothing);
    RUN_TEST(one_wish_of_any_kind_makes_the_sensors_watch);
    RUN_TEST(any_setting_but_0_gives_the_vehicle_sensors);
    RUN_TEST(angles_that_were_not_selected_are_not_sent);
    RUN_TEST(frames_that_wait_go_on_where_they_were_though_no_sensor_is_selected_now);
    RUN_TEST(an_imus_frame_and_raw_counts_are_sent_together);
    RUN_TEST(without_encoders_none_is_next);
    return UNITY_END();
}
