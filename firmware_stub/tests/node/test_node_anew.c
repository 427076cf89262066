/* Tests that what a node is told anew takes the place of what was: a second frame, a second run, a second refusal; and
 * that what a helper writes does not depend on what stood there before. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "laconic_node/integrity.h"
#include "unity.h"

#define ESTIMATE 0x20U /* of SELECT, with the take_ bits */
#define RAW_BY_FD 0x80U
#define STOOD_THERE 0xA5U

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

/* ------------------------------------------------------------------------------- frames of the rig -- */

static void voltages_fd(int16_t raw) {
    memset(data, 0, sizeof data);
    for (int k = 0; k < 16; k++) put16(data + 4 + 2 * k, (uint16_t)raw);
    bench_send(LACONIC_WIRE_VOLTAGE_FD, data);
}

static void a_second_frame_of_all_voltages_replaces_the_first(void) {
    bench_load(4);
    bench_start_lockstep();
    voltages_fd(3000);
    voltages_fd(2000);
    for (int k = 0; k < 4; k++) TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == 2);
}

/* The frames that wait, a bit for each. */
static uint32_t waiting(void) {
    laconic_frame frame;
    uint32_t offsets = 0;
    while (laconic_node_next_frame(&node, &frame)) offsets |= BIT_OF(frame.id - LACONIC_WIRE_ID_BASE);
    return offsets;
}

static void a_second_selection_replaces_the_first(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_POSE, 0x7U | RAW_BY_FD, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, LACONIC_RAW_NU, 0));
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_HEX32(BIT_OF(LACONIC_WIRE_NU) | BIT_OF(LACONIC_WIRE_RAW_OUTPUT), waiting());
}

/* A double comes in two halves; a number in single precision is whole with its first. */
static void parameter(uint8_t field, laconic_real value, bool lower_half_alone) {
    uint32_t words[2] = {0, 0};
    memcpy(words, &value, sizeof value);
    for (uint8_t upper = 0; upper < (lower_half_alone ? 1U : sizeof value / 4U); upper++) {
        const struct laconic_dbc_parameter_t frame = {.upper_half = upper, .field = field, .value = words[upper]};
        laconic_dbc_parameter_pack(data, &frame, 8);
        laconic_loader_take(&node.loader, data);
    }
}

static void a_number_whose_second_half_is_lost_spoils_none_behind_it(void) {
    parameter(LACONIC_FIELD_MASS, 3, true);
    parameter(LACONIC_FIELD_YAW_INERTIA, 2, false);
    TEST_ASSERT_TRUE(node.loader.parameters.vehicle.yaw_inertia_kgm2 == 2);
    TEST_ASSERT_EQUAL_UINT8(0, node.loader.half_field);
}

/* -------------------------------------------------------------------------------------------- runs -- */

static void a_second_free_run_has_its_own_watchdog(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 50));
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 10));
    bench_pass_ms(9);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FREE_RUN, node.state);
    bench_pass_ms(3);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_TIMEOUT, node.state);
}

/* A period of a 300th of a second is 3333 µs and a third: the third of the run before is not carried on. */
static void periods_of_a_second_run_begin_on_a_whole_microsecond(void) {
    bench_load(2);
    for (int run = 0; run < 2; run++) {
        laconic_node_begin_periods(&node, 300, 1, 0);
        TEST_ASSERT_EQUAL_UINT32(3333, node.free_run.next_us);
        laconic_node_end_period(&node);
        TEST_ASSERT_EQUAL_UINT32(6666, node.free_run.next_us);
        laconic_node_end_period(&node);
        TEST_ASSERT_EQUAL_UINT32(10000, node.free_run.next_us);
        laconic_node_end_period(&node);
    }
}

static void an_estimate_that_cannot_begin_anew_ends(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, ESTIMATE));
    TEST_ASSERT_TRUE(node.estimates);
    node.plant.integrator.step_s = 12 * LACONIC_REAL_MIN;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_OVERFLOW, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_FALSE(node.estimates);
}

/* ---------------------------------------------------------------------------------------- refusals -- */

static void a_result_has_the_request_of_its_frame_whatever_the_answer_says(void) {
    const laconic_node_result answer = {.request = 9, .command = LACONIC_WIRE_COMMAND_SELECT};
    node.answer[LACONIC_WIRE_SELECT].request = 4;
    laconic_node_answer(&node, LACONIC_WIRE_SELECT, answer);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(4, data[1] >> 4);
}

static void a_second_fault_names_its_own_request(void) {
    const laconic_refusal why = {.status = LACONIC_OVERFLOW};
    bench_load(2);
    laconic_node_fail(&node, &why, 3);
    laconic_node_fail(&node, &why, 5);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(5, data[1] >> 4);
}

static void what_a_check_of_drives_tells_does_not_depend_on_what_stood_there(void) {
    uint8_t field = STOOD_THERE, item = STOOD_THERE;
    laconic_drive_plan plan = scene_plan(3);
    plan.drive[1].encoder_counts = 0;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, laconic_node_check_drives(&node, &plan, 4, &field, &item));
    TEST_ASSERT_TRUE(field == LACONIC_DRIVES_FIELD_ENCODER_COUNTS && item == 2);
    plan.drive[1].encoder_counts = 1;
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_check_drives(&node, &plan, 4, &field, &item));
    TEST_ASSERT_TRUE(field == 0 && item == 0);
}

static void what_a_start_of_drives_is_refused_for_does_not_depend_on_what_stood_there(void) {
    uint8_t field = STOOD_THERE;
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, laconic_node_start_drives(&node, now_us, &field));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, field);
    field = STOOD_THERE;
    node.plant.integrator.step_s = 2;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, laconic_node_start_drives(&node, now_us, &field));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_STEP, field);
}

/* An IMU so far away that it feels too much of a turn: the step of the drives was taken, and the sensors refuse it. */
static void a_fault_names_what_sensors_refuse_after_a_step_of_drives(void) {
    const laconic_sensor_settings far = {.imu = {.x_m = REAL(1e15)}};
    const laconic_vehicle vehicle = scene_vehicle(0);
    scene_plant(&node.plant, &vehicle);
    node.drive_plan = scene_plan(3);
    node.state = LACONIC_WIRE_STATE_READY;
    laconic_node_start_sensors(&node, &far);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    bench_pass_ms(2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_DRIVES, node.state);
    node.input[0].body_moment_Nm = 100000;
    bench_pass_ms(1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_OVERFLOW, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_SENSOR_FIELD_IMU_X, data[4]);
}

static void parameter_seen_by(laconic_integrity *integrity, uint8_t field, uint8_t item) {
    laconic_frame frame = {
        .id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_PARAMETER, .length = 8, .data = {0, 0, field, item}};
    laconic_protect_keyed(LACONIC_WIRE_PARAMETER, frame.data, bench_key, ++sent[LACONIC_WIRE_PARAMETER]);
    laconic_integrity_on_frame(integrity, &node, &frame, now_us);
}

static void numbers_that_changed_in_memory_are_told_in_place_of_the_refusal_before(void) {
    static const laconic_integrity_limits limits = {20, 100, 50, 1000};
    const laconic_node_config config = node.config;
    laconic_integrity integrity;
    laconic_integrity_begin(&integrity, &node, &config, &limits, LACONIC_INTEGRITY_ALL);
    parameter_seen_by(&integrity, 200, 7);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, node.answer[LACONIC_WIRE_PARAMETER].status);
    TEST_ASSERT_EQUAL_UINT8(7, node.answer[LACONIC_WIRE_PARAMETER].item);
    node.loader.parameters.vehicle.mass_kg = 5;
    parameter_seen_by(&integrity, LACONIC_FIELD_MASS, 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_MEMORY_CHANGED, node.answer[LACONIC_WIRE_PARAMETER].status);
    TEST_ASSERT_EQUAL_UINT8(0, node.answer[LACONIC_WIRE_PARAMETER].field);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_INTEGRITY_OF_LOADED, node.answer[LACONIC_WIRE_PARAMETER].item);
}

/* --------------------------------------------------------------------------------------- frames sent -- */

static void encoders_behind_one_another_are_each_sent_once(void) {
    laconic_sensor_settings with = {.encoder_wrap = 0};
    bench_load(6);
    for (int k = 1; k <= 3; k++) with.encoder[k].counts_per_turn = 256;
    laconic_node_start_sensors(&node, &with);
    bench_select(LACONIC_NODE_SEND_ENCODER, 0, 0);
    laconic_node_publish(&node);
    for (int k = 1; k <= 3; k++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ENCODER, data));
        TEST_ASSERT_EQUAL_UINT8(k, data[1] >> 4);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ENCODER, data));
}

static void two_numbers_out_of_range_set_the_same_flag(void) {
    const laconic_start start = {{0, 0, 0}, 3000, -3000, 0, {0}};
    bench_load(2);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    TEST_ASSERT_EQUAL_UINT8(1, data[3]);
}

static void a_number_takes_the_place_of_the_bytes_that_stood_there(void) {
    memset(data, STOOD_THERE, sizeof data);
    put16(data, 0x1234);
    put32(data + 2, 0x89ABCDEF);
    TEST_ASSERT_EQUAL_HEX8(0x34, data[0]);
    TEST_ASSERT_EQUAL_HEX8(0x12, data[1]);
    TEST_ASSERT_EQUAL_HEX32(0x89ABCDEF, word32(data + 2));
    TEST_ASSERT_EQUAL_HEX8(STOOD_THERE, data[6]);
}

/* All that RAW_OUTPUT can show, read into zeros and into other numbers. */
static void raw_numbers_take_the_place_of_those_before(void) {
    static laconic_raw_output first, second;
    static laconic_plant plant;
    const laconic_vehicle vehicle = scene_vehicle(0);
    const laconic_start start = {{1, 2, 3}, 4, 5, 6, {0}};
    const laconic_input held = {.axle_torque_Nm = {5, 6, 7, 8}};
    const laconic_sensor_outputs sensed = {.acceleration_body_m_per_s2 = {1, 2},
                                           .imu_acceleration_m_per_s2 = {3, 4},
                                           .imu_yaw_rate_rad_per_s = 5,
                                           .encoder_count = {6, 7, 8, 9}};
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_rk4, SCENE_STEP_S, &start, NULL));
    first.send = second.send = 0xFFU;
    for (size_t k = 0; k < LACONIC_RAW_OUTPUTS; k++) second.number[k] = 1000;
    laconic_raw_collect(&first, &plant, &held, &sensed);
    laconic_raw_collect(&second, &plant, &held, &sensed);
    TEST_ASSERT_EQUAL_UINT16((3 + 3 + 4 + 4 + 1 + 5 + 4 + 4) * sizeof(laconic_real), first.size);
    TEST_ASSERT_EQUAL_UINT16(first.size, second.size);
    TEST_ASSERT_EQUAL_MEMORY(first.number, second.number, first.size);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_second_frame_of_all_voltages_replaces_the_first);
    RUN_TEST(a_second_selection_replaces_the_first);
    RUN_TEST(a_number_whose_second_half_is_lost_spoils_none_behind_it);
    RUN_TEST(a_second_free_run_has_its_own_watchdog);
    RUN_TEST(periods_of_a_second_run_begin_on_a_whole_microsecond);
    RUN_TEST(an_estimate_that_cannot_begin_anew_ends);
    RUN_TEST(a_result_has_the_request_of_its_frame_whatever_the_answer_says);
    RUN_TEST(a_second_fault_names_its_own_request);
    RUN_TEST(what_a_check_of_drives_tells_does_not_depend_on_what_stood_there);
    RUN_TEST(what_a_start_of_drives_is_refused_for_does_not_depend_on_what_stood_there);
    RUN_TEST(a_fault_names_what_sensors_refuse_after_a_step_of_drives);
    RUN_TEST(numbers_that_changed_in_memory_are_told_in_place_of_the_refusal_before);
    RUN_TEST(encoders_behind_one_another_are_each_sent_once);
    RUN_TEST(two_numbers_out_of_range_set_the_same_flag);
    RUN_TEST(a_number_takes_the_place_of_the_bytes_that_stood_there);
    RUN_TEST(raw_numbers_take_the_place_of_those_before);
    return UNITY_END();
}
