/* Tests of what a node refuses in each state, and that what is refused changes nothing. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "laconic_node/crc.h"
#include "laconic_node/loader.h"
#include "laconic_wire.h"
#include "unity.h"

#include <string.h>

static uint8_t data[LACONIC_FRAME_BYTES];
static laconic_loader loader;

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
    laconic_loader_begin(&loader);
}
void tearDown(void) {}

static uint8_t start_free_run(uint16_t rate) { return bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, rate, 0); }

static void an_empty_node_starts_neither_a_free_run_nor_drives(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, start_free_run(0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, start_free_run(1000));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
}

static void a_start_that_is_refused_leaves_the_run_its_periods(void) {
    bench_load(4);
    TEST_ASSERT_EQUAL_UINT8(0, start_free_run(100));
    const laconic_node_free_run before = node.free_run;
    now_us += 500;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, start_free_run(1000));
    TEST_ASSERT_EQUAL_MEMORY(&before, &node.free_run, sizeof before);
}

static void after_stop_neither_raw_inputs_nor_syncs_act(void) {
    bench_load(2);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT16(0, node.raw_input.frames);
    bench_sync(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, data[3]);
    TEST_ASSERT_EQUAL_UINT32(0, node.lockstep.steps_due);
}

static void voltages_by_can_fd_come_too_late_for_steps_that_are_due(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1000);
    memset(data, 0x11, sizeof data);
    data[3] = 0;
    bench_send(LACONIC_WIRE_VOLTAGE_FD, data);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.counters.refused == 1);
}

static void each_voltage_of_a_group_goes_to_its_own_wheel(void) {
    static const int16_t raw[3] = {100, -200, 300};
    bench_load(9);
    bench_start_lockstep();
    for (uint8_t group = 0; group < 3; group++) {
        const struct laconic_dbc_voltage_t frame = {
            .group = group, .voltage_1 = raw[0], .voltage_2 = raw[1], .voltage_3 = raw[2]};
        laconic_dbc_voltage_pack(data, &frame, 8);
        bench_send(LACONIC_WIRE_VOLTAGE, data);
        for (int k = 0; k < 9; k++)
            TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == (k / 3 > group ? 0 : REAL(raw[k % 3]) / 500));
    }
}

/* Whatever its checksum, of which some hold the bit that asks for CAN FD. */
static void only_what_is_chosen_asks_for_can_fd(void) {
    bench_load(2);
    node.config.can_fd = false;
    for (int k = 0; k < 32; k++) {
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
        TEST_ASSERT_EQUAL_UINT8(
            0, bench_select(LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_IMU | LACONIC_NODE_SEND_ENCODER, 0, 0));
    }
}

static void a_field_behind_the_last_is_unknown(void) {
    const struct laconic_dbc_parameter_t frame = {.field = LACONIC_WIRE_FIELD_DRIVE_FAULTS + 1};
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, node.loader.status);
}

/* ----------------------------------------------------------------------------------------- drives -- */

static void load_driven(double rate_Hz) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    memset(&node.start, 0, sizeof node.start);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_auto, (laconic_real)(1 / rate_Hz),
                                                      &node.start, NULL));
    node.drive_plan = scene_plan(3);
    node.state = LACONIC_WIRE_STATE_READY;
}

static void no_protocol_has_a_number_below_0(void) {
    uint8_t field = 0, item = 0;
    laconic_drive_plan plan = scene_plan(-1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED,
                            laconic_node_check_drives(&node, &plan, 4, &field, &item));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, field);
}

static void a_start_without_drives_names_their_protocol(void) {
    const struct laconic_dbc_control_t frame = {.command = LACONIC_WIRE_COMMAND_START_DRIVES};
    load_driven(1000);
    node.drive_plan.protocol = 0;
    laconic_dbc_control_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_CONTROL, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, data[4]);
}

static void a_rate_is_whole_up_to_a_ten_thousandth(void) {
    load_driven(1000 * 1.0001005);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    load_driven(1000 * 1.0000995);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
}

static void inputs_that_are_taken_begin_no_estimate_and_ask_for_no_single_step(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, LACONIC_RAW_TAKES | 0x10U));
    TEST_ASSERT_FALSE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, LACONIC_RAW_TAKES & ~LACONIC_RAW_SAMPLED));
    bench_start_lockstep();
    bench_sync(2);
    TEST_ASSERT_EQUAL_UINT32(2, node.lockstep.steps_due);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(2, node.plant.steps);
}

static void a_step_by_voltages_has_their_request(void) {
    bench_load(2);
    bench_start_lockstep();
    for (int k = 0; k < 20; k++) {
        bench_voltage(0, 500, 1);
        TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_VOLTAGE] & 15U, node.lockstep.request);
        laconic_node_on_tick(&node, now_us);
        memset(data, 0, sizeof data);
        data[3] = 1;
        bench_send(LACONIC_WIRE_VOLTAGE_FD, data);
        TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_VOLTAGE_FD] & 15U, node.lockstep.request);
        laconic_node_on_tick(&node, now_us);
    }
}

static void bits_beside_that_of_the_half_say_nothing(void) {
    const uint8_t order[8] = {0, 0xEF, LACONIC_WIRE_FIELD_DRIVE_FAULTS, 1, 4};
    load_driven(1000);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_order_drive(&node, order));
}

static void a_refused_sync_is_answered_with_its_request(void) {
    bench_load(2);
    bench_start_lockstep();
    for (int k = 0; k < 20; k++) {
        bench_sync(0);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_SYNC] & 15U, data[1] >> 4);
    }
}

static void cleared_inputs_are_zero_to_their_last_byte(void) {
    static const laconic_input none[3];
    memset(node.input, 0x5A, sizeof node.input);
    laconic_node_clear_inputs(&node);
    TEST_ASSERT_EQUAL_MEMORY(none, node.input, sizeof none);
}

static void an_order_is_refused_for_two_reasons_as_for_one(void) {
    uint8_t order[8] = {0, 0x10, LACONIC_WIRE_FIELD_DRIVE_FAULTS, 1};
    load_driven(1000);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    for (int bit = 0; bit < 32; bit++) {
        put32(order + 4, (uint32_t)1 << bit);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, laconic_node_order_drive(&node, order));
    }
}

/* Of wheels that are not there, and after the run. */
static void voltages_are_refused_for_two_reasons_as_for_one(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_voltage(7, 500, 0);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

static void a_sync_of_too_many_steps_that_would_be_sampled_is_refused(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, LACONIC_RAW_TAKES));
    bench_start_lockstep();
    bench_sync(1000001);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
    TEST_ASSERT_EQUAL_UINT32(0, node.lockstep.steps_due);
}

/* Tests of loader.c: its beginning, the numbers of its fields, and what its checksum is of. */

/* CRC-32 of the upper half's bit and the six bytes behind it, of each frame: not of its protection. */
static void the_checksum_is_that_of_what_a_frame_tells(void) {
    static const uint8_t checked[7] = {0x10, 1, 0, 0x11, 0x22, 0x33, 0x44};
    uint8_t given[9] = {0xAA, 0x1B, 1, 0, 0x11, 0x22, 0x33, 0x44, 0xBB};
    laconic_loader_take(&loader, given);
    TEST_ASSERT_EQUAL_HEX32(laconic_crc32(LACONIC_CRC32_START, checked, 7), loader.checksum);
    TEST_ASSERT_EQUAL_UINT16(1, loader.frame_count);
}

static void a_loader_begins_with_the_usual_plan_of_drives(void) {
    laconic_drive_plan usual;
    memset(&usual, 0, sizeof usual);
    laconic_drive_plan_begin(&usual);
    TEST_ASSERT_EQUAL_MEMORY(&usual, &loader.parameters.drives, sizeof usual);
}

/* laconic.dbc and the rows of vehicle.h, settings.h and sensors.h each have the number. */
static void the_wire_numbers_each_field_as_its_row_does(void) {
#define COMPARED(of, number, IDENTIFIER, ...) \
    TEST_ASSERT_EQUAL_MESSAGE(LACONIC_WIRE_FIELD_##IDENTIFIER, number, #IDENTIFIER);
    LACONIC_LOADER_EVERY(COMPARED)
#undef COMPARED
}

/* Tests of node_pack.c: wheel angles, in groups of three from the first wheel on. */

static void wheel_angles_are_wrapped_and_grouped(void) {
    struct laconic_dbc_wheel_angle_t frame;
    laconic_real angle[LACONIC_MAX_WHEELS];
    bench_load(4);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_voltage(1, 5 * VOLT, 0);
    bench_step(2000);
    laconic_plant_wheel_angles(&node.plant, angle);
    TEST_ASSERT_TRUE(angle[0] > 4);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(0, frame.group);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[0]) * 10000), frame.wheel_angle_1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(1, frame.group);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[3]) * 10000), frame.wheel_angle_1);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
}

static void frames_of_wheels_begin_anew_with_each_step(void) {
    bench_load(4);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    for (int k = 0; k < 2; k++) {
        laconic_frame frame;
        bench_step(1);
        TEST_ASSERT_TRUE(laconic_node_next_frame(&node, &frame)); /* one of two is fetched */
        TEST_ASSERT_EQUAL_UINT8(0, frame.data[1] >> 5);
    }
}

static void every_wheel_of_a_group_shows_its_own_angle(void) {
    struct laconic_dbc_wheel_angle_t frame;
    laconic_real angle[LACONIC_MAX_WHEELS];
    bench_load(3);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_step(500);
    laconic_plant_wheel_angles(&node.plant, angle);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[1]) * 10000), frame.wheel_angle_2);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[2]) * 10000), frame.wheel_angle_3);
    TEST_ASSERT_TRUE(frame.wheel_angle_2 != 0);
}

static void angles_of_all_wheels_come_in_as_many_groups_as_they_need(void) {
    bench_load(LACONIC_MAX_WHEELS);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    for (int k = 0; k < (LACONIC_MAX_WHEELS + 2) / 3; k++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
        TEST_ASSERT_EQUAL_INT(k, data[1] >> 5);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_empty_node_starts_neither_a_free_run_nor_drives);
    RUN_TEST(a_start_that_is_refused_leaves_the_run_its_periods);
    RUN_TEST(after_stop_neither_raw_inputs_nor_syncs_act);
    RUN_TEST(voltages_by_can_fd_come_too_late_for_steps_that_are_due);
    RUN_TEST(each_voltage_of_a_group_goes_to_its_own_wheel);
    RUN_TEST(only_what_is_chosen_asks_for_can_fd);
    RUN_TEST(a_field_behind_the_last_is_unknown);
    RUN_TEST(no_protocol_has_a_number_below_0);
    RUN_TEST(a_start_without_drives_names_their_protocol);
    RUN_TEST(a_rate_is_whole_up_to_a_ten_thousandth);
    RUN_TEST(inputs_that_are_taken_begin_no_estimate_and_ask_for_no_single_step);
    RUN_TEST(a_step_by_voltages_has_their_request);
    RUN_TEST(bits_beside_that_of_the_half_say_nothing);
    RUN_TEST(a_refused_sync_is_answered_with_its_request);
    RUN_TEST(cleared_inputs_are_zero_to_their_last_byte);
    RUN_TEST(an_order_is_refused_for_two_reasons_as_for_one);
    RUN_TEST(voltages_are_refused_for_two_reasons_as_for_one);
    RUN_TEST(a_sync_of_too_many_steps_that_would_be_sampled_is_refused);
    RUN_TEST(the_wire_numbers_each_field_as_its_row_does);
    RUN_TEST(the_checksum_is_that_of_what_a_frame_tells);
    RUN_TEST(a_loader_begins_with_the_usual_plan_of_drives);
    RUN_TEST(wheel_angles_are_wrapped_and_grouped);
    RUN_TEST(frames_of_wheels_begin_anew_with_each_step);
    RUN_TEST(every_wheel_of_a_group_shows_its_own_angle);
    RUN_TEST(angles_of_all_wheels_come_in_as_many_groups_as_they_need);
    return UNITY_END();
}
