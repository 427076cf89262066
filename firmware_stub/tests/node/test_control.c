/* Tests of node_control.c: rates, runs, selections, and a vehicle that is committed. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "laconic_node/crc.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

/* ----------------------------------------------------------------------------------------- rates -- */

/* The status of a free run with a step, and what it has chosen. */
static uint8_t run(double step_s, uint16_t rate) {
    const laconic_vehicle vehicle = {.mass_kg = 1, .yaw_inertia_kgm2 = 1, .wheel_radius_m = 1};
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL(
        LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)step_s, &node.start, NULL));
    node.state = LACONIC_WIRE_STATE_READY;
    return bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, rate, 0);
}

static void a_rate_takes_a_whole_number_of_steps_up_to_what_a_tick_may_take(void) {
    TEST_ASSERT_EQUAL_UINT8(0, run(0.001, 1000));
    TEST_ASSERT_TRUE(node.free_run.rate_Hz == 1000 && node.free_run.steps_per_period == 1);
    TEST_ASSERT_EQUAL_UINT8(0, run(0.001, 500));
    TEST_ASSERT_TRUE(node.free_run.rate_Hz == 500 && node.free_run.steps_per_period == 2);
    TEST_ASSERT_EQUAL_UINT8(0, run(1.0 / 6400, 100));
    TEST_ASSERT_EQUAL_UINT32(LACONIC_NODE_STEPS_PER_TICK, node.free_run.steps_per_period);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(1.0 / 6500, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(0.001, 999));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(0.01, 1000)); /* a tenth of a step */
    TEST_ASSERT_EQUAL_UINT8(0, run(1, 0));
    TEST_ASSERT_EQUAL_UINT32(1, node.free_run.rate_Hz);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(3, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(1e-3 / 1.001, 0)); /* 1001 Hz */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(1e-9, 1000));
}

/* A step and a rate may differ by their rounding, not by half of a thousandth. */
static void steps_that_are_nearly_whole_are_refused(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(0.01 / 1.0005, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(0.01 / 0.9995, 100));
    TEST_ASSERT_EQUAL_UINT8(0, run(0.01 / 1.00005, 100));
    TEST_ASSERT_EQUAL_UINT8(0, run(0.01 / 0.99995, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(0.01 / 1.0001005, 100));
    TEST_ASSERT_EQUAL_UINT8(0, run(0.01 / 1.0000995, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, run(100, 1000)); /* a hundred-thousandth of a step */
}

/* The rate that a step has by itself becomes a whole number, and so do the steps of a period, up to the most that it
 * may have. */
static void a_rate_is_rounded_and_so_are_its_steps(void) {
    TEST_ASSERT_EQUAL_UINT8(0, run(1 / 99.9995, 0));
    TEST_ASSERT_EQUAL_UINT32(100, node.free_run.rate_Hz);
    TEST_ASSERT_EQUAL_UINT8(0, run(1 / 64000.03, 1000));
    TEST_ASSERT_EQUAL_UINT32(64, node.free_run.steps_per_period);
}

static void the_watchdog_is_given_in_milliseconds(void) {
    bench_load(2);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 250);
    TEST_ASSERT_EQUAL_UINT32(250000, node.free_run.watchdog_us);
}

/* ------------------------------------------------------------------------------------------ runs -- */

static void a_run_begins_without_what_was_left_of_the_one_before(void) {
    bench_load(2);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    data[1] = 0;
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    TEST_ASSERT_TRUE(node.raw_input.segment == 1 && node.raw_input.filled > 0);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    node.raw_input.broken = true;
    node.raw_input.segment = 3;
    bench_start_lockstep();
    TEST_ASSERT_TRUE(!node.raw_input.broken && node.raw_input.segment == 0 && node.raw_input.filled == 0);
}

static void stop_forgets_the_steps_that_are_due_and_the_inputs(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_voltage(0, 500, 0);
    bench_sync(1000);
    node.session.deaf = 1;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.session.deaf == 0);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
}

static void a_new_session_forgets_selections_and_answers(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, LACONIC_RAW_NU, LACONIC_RAW_VOLTAGE));
    node.answers_due = 4;
    node.pending = BIT_OF(LACONIC_WIRE_NU);
    node.loader.frame_count = 9;
    laconic_node_make_idle(&node);
    TEST_ASSERT_TRUE(node.send == 0 && node.raw_input.take == 0 && node.raw_output.send == 0);
    TEST_ASSERT_TRUE(node.answers_due == 0 && node.pending == 0 && node.loader.frame_count == 0);
}

static void reset_begins_at_the_start_and_counts_anew(void) {
    bench_load(2);
    node.start.x_m = 3;
    bench_start_lockstep();
    bench_sync(5);
    laconic_node_on_tick(&node, now_us);
    node.counters.lost = 4;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    laconic_pose pose;
    laconic_pose_of(&pose, &node.plant.model, &node.plant.state);
    TEST_ASSERT_TRUE(pose.x_m == 3 && node.plant.steps == 0 && node.counters.lost == 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
}

static void reset_begins_every_counter_anew(void) {
    static const laconic_node_counters none;
    bench_load(2);
    memset(&node.counters, 0x5A, sizeof node.counters);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.overrange);
    TEST_ASSERT_EQUAL_MEMORY(&none, &node.counters, sizeof none);
}

static void a_reset_to_a_start_that_cannot_be_names_its_field(void) {
    bench_load(2);
    node.start.nu_rad_per_s[1] = LACONIC_REAL_MAX * 2;
    const struct laconic_dbc_control_t reset = {.command = LACONIC_WIRE_COMMAND_RESET};
    laconic_dbc_control_pack(data, &reset, 8);
    bench_send(LACONIC_WIRE_CONTROL, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_RESET, data[2]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_START_NU, data[4]);
    TEST_ASSERT_EQUAL_UINT8(2, data[5]);
}

/* So that a port can look at its bus in between. */
static void a_tick_takes_no_more_steps_than_it_may(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(2 * LACONIC_NODE_STEPS_PER_TICK + 3);
    for (uint64_t k = 1; k <= 3; k++) {
        TEST_ASSERT_TRUE(laconic_node_is_busy(&node));
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_EQUAL_UINT64(k < 3 ? k * LACONIC_NODE_STEPS_PER_TICK : 2 * LACONIC_NODE_STEPS_PER_TICK + 3,
                                 node.plant.steps);
    }
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
}

static void begin_forgets_what_was_loaded(void) {
    node.loader.frame_count = 3;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0));
    TEST_ASSERT_EQUAL_UINT16(0, node.loader.frame_count);
}

/* ------------------------------------------------------------------------------------- selections -- */

static void each_bit_of_select_has_its_meaning(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0x5FU & ~LACONIC_NODE_SEND_STATE_FD, 0x15, 0x8F));
    TEST_ASSERT_EQUAL_HEX8(0x5F & ~LACONIC_NODE_SEND_STATE_FD, node.send);
    TEST_ASSERT_FALSE(node.raw_fd);
    TEST_ASSERT_EQUAL_HEX8(0x15, node.raw_output.send);
    TEST_ASSERT_EQUAL_HEX8(0x8F, node.raw_input.take);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0x80U | 0x2AU, 0x10));
    TEST_ASSERT_TRUE(node.raw_fd);
    TEST_ASSERT_EQUAL_HEX8(LACONIC_RAW_HELD_TORQUE | 0x2A, node.raw_output.send);
    TEST_ASSERT_EQUAL_HEX8(0, node.raw_input.take);
}

static void the_last_raw_number_asks_for_no_can_fd(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, LACONIC_RAW_ENCODER, 0));
    TEST_ASSERT_FALSE(node.raw_fd);
    TEST_ASSERT_EQUAL_HEX8(LACONIC_RAW_ENCODER, node.raw_output.send);
}

static void raw_numbers_by_can_fd_need_can_fd(void) {
    bench_load(2);
    node.config.can_fd = false;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(0, 0x81, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0x01, 0));
}

static void a_selection_clears_the_inputs(void) {
    bench_load(2);
    node.input[0].voltage_V[0] = 3;
    node.raw_input.filled = 2;
    bench_select(0, 0, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.raw_input.filled == 0);
}

/* --------------------------------------------------------------------------------------- commits -- */

static void parameter(uint8_t upper, uint8_t field, uint8_t item, uint32_t value) {
    const struct laconic_dbc_parameter_t frame = {.upper_half = upper, .field = field, .item = item, .value = value};
    uint8_t payload[LACONIC_FRAME_BYTES];
    laconic_dbc_parameter_pack(payload, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, payload);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void real_of_item(uint8_t field, uint8_t item, laconic_real value) {
    uint32_t words[2] = {0, 0};
    memcpy(words, &value, sizeof value);
    parameter(0, field, item, words[0]);
    if (sizeof value == 8) parameter(1, field, item, words[1]);
}

static void real_parameter(uint8_t field, laconic_real value) { real_of_item(field, 0, value); }

/* A puck; the status of COMMIT's RESULT, which stays in `data`. */
static uint8_t commit_puck(laconic_real mass_kg, uint32_t method) {
    uint8_t payload[LACONIC_FRAME_BYTES] = {0};
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    real_parameter(LACONIC_FIELD_MASS, mass_kg);
    real_parameter(LACONIC_FIELD_YAW_INERTIA, 1);
    real_parameter(LACONIC_FIELD_WHEEL_RADIUS, 1);
    real_parameter(LACONIC_FIELD_STEP, (laconic_real)0.01);
    real_parameter(LACONIC_FIELD_START_X, 7);
    parameter(0, LACONIC_FIELD_WHEEL_COUNT, 0, 0);
    parameter(0, LACONIC_FIELD_METHOD, 0, method);
    const struct laconic_dbc_commit_t commit = {.frame_count = node.loader.frame_count,
                                                .checksum = node.loader.checksum ^ LACONIC_CRC32_END};
    laconic_dbc_commit_pack(payload, &commit, 8);
    bench_send(LACONIC_WIRE_COMMIT, payload);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static void a_committed_vehicle_is_ready_at_its_start_with_cleared_inputs(void) {
    node.input[1].voltage_V[0] = 9;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_EMPTY, node.state);
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(2, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_COMMIT, data[2]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
    TEST_ASSERT_TRUE(node.start.x_m == 7 && node.input[1].voltage_V[0] == 0);
    TEST_ASSERT_TRUE(node.plant.integrator.step_s == (laconic_real)0.01);
    TEST_ASSERT_TRUE(node.plant.state.x_m.value == 7);
    TEST_ASSERT_TRUE(node.plant.integrator.method == laconic_method_by_number(0));
}

static void a_vehicle_that_the_core_refuses_leaves_the_one_before(void) {
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(2, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, commit_puck(-1, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_MASS, data[4]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_METHOD_UNKNOWN, commit_puck(2, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_METHOD, data[4]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
}

static void the_estimate_of_the_vehicle_before_ends_with_a_commit_that_is_taken(void) {
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(2, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, 0x20U));
    TEST_ASSERT_TRUE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, commit_puck(-1, 0));
    TEST_ASSERT_TRUE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(0, commit_puck(3, 0));
    TEST_ASSERT_FALSE(node.estimates);
}

/* A cart with two wheels and a drive on the second, whose gear is given; the status of COMMIT's RESULT, which stays in
 * `data`. */
static uint8_t commit_driven(laconic_real wheel_2_x_m, laconic_real gear_ratio) {
    static const uint8_t single[] = {LACONIC_FIELD_MASS,         LACONIC_FIELD_YAW_INERTIA,
                                     LACONIC_FIELD_WHEEL_RADIUS, LACONIC_FIELD_WHEEL_INERTIA,
                                     LACONIC_FIELD_MOTOR_GAIN,   LACONIC_FIELD_MOTOR_DAMPING};
    uint8_t payload[LACONIC_FRAME_BYTES] = {0};
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    for (size_t k = 0; k < sizeof single; k++) real_parameter(single[k], 1);
    real_parameter(LACONIC_FIELD_STEP, (laconic_real)0.001);
    parameter(0, LACONIC_FIELD_WHEEL_COUNT, 0, 2);
    for (uint8_t wheel = 1; wheel <= 2; wheel++) {
        parameter(0, LACONIC_FIELD_WHEEL_KIND, wheel, LACONIC_WHEEL_FIXED);
        real_of_item(LACONIC_FIELD_WHEEL_X, wheel, wheel == 1 ? 1 : wheel_2_x_m);
        real_of_item(LACONIC_FIELD_WHEEL_Y, wheel, 0);
        real_of_item(LACONIC_FIELD_AXLE, wheel, 0);
    }
    parameter(0, LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, 0, 3);
    parameter(0, LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, 2, 7);
    parameter(0, LACONIC_DRIVES_FIELD_ENCODER_COUNTS, 2, 8192);
    real_of_item(LACONIC_DRIVES_FIELD_DRIVE_GEAR_RATIO, 2, gear_ratio);
    real_of_item(LACONIC_DRIVES_FIELD_DRIVE_TORQUE_CONSTANT, 2, (laconic_real)0.015);
    real_of_item(LACONIC_DRIVES_FIELD_DRIVE_CURRENT_LIMIT, 2, 20);
    const struct laconic_dbc_commit_t commit = {.frame_count = node.loader.frame_count,
                                                .checksum = node.loader.checksum ^ LACONIC_CRC32_END};
    laconic_dbc_commit_pack(payload, &commit, 8);
    bench_send(LACONIC_WIRE_COMMIT, payload);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static void a_committed_vehicle_has_the_drives_that_came_with_it(void) {
    TEST_ASSERT_EQUAL_UINT8(0, commit_driven(2, -19));
    TEST_ASSERT_EQUAL_INT(3, node.drive_plan.protocol);
    TEST_ASSERT_EQUAL_INT(-1, node.drive_plan.drive[0].node_id);
    TEST_ASSERT_EQUAL_INT(7, node.drive_plan.drive[1].node_id);
    TEST_ASSERT_TRUE(node.drive_plan.drive[1].gear_ratio == -19);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    TEST_ASSERT_EQUAL_INT(1, node.drives.count);
}

static void a_refused_vehicle_names_field_and_wheel_and_keeps_the_drives_before(void) {
    TEST_ASSERT_EQUAL_UINT8(0, commit_driven(2, -19));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, commit_driven(2, 0));
    TEST_ASSERT_TRUE(data[4] == LACONIC_DRIVES_FIELD_DRIVE_GEAR_RATIO && data[5] == 2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, commit_driven(LACONIC_REAL_MAX * 2, 5));
    TEST_ASSERT_TRUE(data[4] == LACONIC_FIELD_WHEEL_X && data[5] == 2);
    TEST_ASSERT_TRUE(node.drive_plan.drive[1].gear_ratio == -19);
}

static void a_single_step_that_is_due_keeps_the_node_busy(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1);
    TEST_ASSERT_TRUE(laconic_node_is_busy(&node));
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
}

static void a_commit_names_field_and_item_of_what_is_missing(void) {
    uint8_t payload[LACONIC_FRAME_BYTES] = {0};
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    parameter(0, LACONIC_FIELD_WHEEL_COUNT, 0, LACONIC_MAX_WHEELS + 9);
    real_of_item(LACONIC_FIELD_WHEEL_X, 3, 1);
    node.loader.status = LACONIC_WIRE_STATUS_OUT_OF_RANGE;
    node.loader.field = LACONIC_FIELD_WHEEL_X;
    node.loader.item = 3;
    bench_send(LACONIC_WIRE_COMMIT, payload);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
    TEST_ASSERT_TRUE(data[4] == LACONIC_FIELD_WHEEL_X && data[5] == 3);
}

static void a_voltage_comes_too_late_for_steps_that_are_due(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1000);
    bench_voltage(0, 500, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

static void a_sync_asks_for_a_million_steps_at_most_and_for_one_of_sampled_inputs(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(0);
    bench_sync(1000001);
    TEST_ASSERT_EQUAL_UINT16(2, node.counters.refused);
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
    bench_sync(1000000);
    TEST_ASSERT_EQUAL_UINT32(1000000, node.lockstep.steps_due);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_select(0, 0, LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    bench_sync(2);
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
    bench_sync(1);
    TEST_ASSERT_TRUE(laconic_node_is_busy(&node));
}

static const laconic_method *only_rk4(int32_t number) { return number == 1 ? &laconic_rk4 : NULL; }

static void an_identity_names_the_methods_that_are_there(void) {
    node.config.method = only_rk4;
    laconic_node_pack(&node, LACONIC_WIRE_IDENTITY, data);
    TEST_ASSERT_EQUAL_HEX8(2, data[7]);
}

/* The last wheel may have an encoder and a drive; the one behind it is none. */
static void drives_and_encoders_are_of_wheels_that_are_there(void) {
    laconic_parameters *loaded = &node.loader.parameters;
    uint8_t field = 0, item = 0;
    TEST_ASSERT_EQUAL_UINT8(0, commit_driven(2, -19));
    const struct laconic_dbc_commit_t commit = {.frame_count = node.loader.frame_count,
                                                .checksum = node.loader.checksum ^ LACONIC_CRC32_END};
    laconic_dbc_commit_pack(data, &commit, 8);
    loaded->sensors.encoder[1] = (laconic_encoder_settings){256, 1};
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_commit(&node, data).status);
    loaded->sensors.encoder[2] = loaded->sensors.encoder[1];
    TEST_ASSERT_EQUAL_UINT8(LACONIC_ABOVE_LIMIT, laconic_node_commit(&node, data).status);
    loaded->sensors.encoder[2].counts_per_turn = 0;
    loaded->drives.drive[2] = loaded->drives.drive[1];
    loaded->drives.drive[2].node_id = 8;
    const uint8_t refused = laconic_node_check_drives(&node, &loaded->drives, 2, &field, &item);
    TEST_ASSERT_TRUE(refused != 0);
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_check_drives(&node, &loaded->drives, 3, &field, &item));
    TEST_ASSERT_EQUAL_UINT8(refused, laconic_node_commit(&node, data).status);
}

/* So a rig hears of it first, whatever else is wrong with the vehicle. */
static void a_method_that_is_none_is_refused_before_all_else(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_METHOD_UNKNOWN, commit_puck(-1, 100));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_METHOD, data[4]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_rate_takes_a_whole_number_of_steps_up_to_what_a_tick_may_take);
    RUN_TEST(steps_that_are_nearly_whole_are_refused);
    RUN_TEST(a_rate_is_rounded_and_so_are_its_steps);
    RUN_TEST(the_watchdog_is_given_in_milliseconds);
    RUN_TEST(a_run_begins_without_what_was_left_of_the_one_before);
    RUN_TEST(stop_forgets_the_steps_that_are_due_and_the_inputs);
    RUN_TEST(a_new_session_forgets_selections_and_answers);
    RUN_TEST(reset_begins_at_the_start_and_counts_anew);
    RUN_TEST(reset_begins_every_counter_anew);
    RUN_TEST(a_reset_to_a_start_that_cannot_be_names_its_field);
    RUN_TEST(begin_forgets_what_was_loaded);
    RUN_TEST(each_bit_of_select_has_its_meaning);
    RUN_TEST(the_last_raw_number_asks_for_no_can_fd);
    RUN_TEST(raw_numbers_by_can_fd_need_can_fd);
    RUN_TEST(a_selection_clears_the_inputs);
    RUN_TEST(a_committed_vehicle_is_ready_at_its_start_with_cleared_inputs);
    RUN_TEST(a_vehicle_that_the_core_refuses_leaves_the_one_before);
    RUN_TEST(the_estimate_of_the_vehicle_before_ends_with_a_commit_that_is_taken);
    RUN_TEST(a_committed_vehicle_has_the_drives_that_came_with_it);
    RUN_TEST(a_refused_vehicle_names_field_and_wheel_and_keeps_the_drives_before);
    RUN_TEST(a_tick_takes_no_more_steps_than_it_may);
    RUN_TEST(a_single_step_that_is_due_keeps_the_node_busy);
    RUN_TEST(a_commit_names_field_and_item_of_what_is_missing);
    RUN_TEST(a_voltage_comes_too_late_for_steps_that_are_due);
    RUN_TEST(a_sync_asks_for_a_million_steps_at_most_and_for_one_of_sampled_inputs);
    RUN_TEST(an_identity_names_the_methods_that_are_there);
    RUN_TEST(drives_and_encoders_are_of_wheels_that_are_there);
    RUN_TEST(a_method_that_is_none_is_refused_before_all_else);
    return UNITY_END();
}
