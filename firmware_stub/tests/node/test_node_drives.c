/* Tests of node_drives.c: a node that plays drives, its periods, its bus and its ends. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

#define SELECT_RAW_AXLE_TORQUE 16U /* in the byte of the take_ bits */

static void load(laconic_real step_s) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    memset(&node.start, 0, sizeof node.start);
    laconic_plant_start(&node.plant, &vehicle, &laconic_auto, step_s, &node.start, NULL);
    node.drive_plan = scene_plan(3);
    node.state = LACONIC_WIRE_STATE_READY;
}

void setUp(void) {
    bench_begin();
    load(SCENE_STEP_S);
}
void tearDown(void) {}

static uint8_t start(void) { return bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0); }

static void pass(uint32_t microseconds, uint32_t each_us) {
    for (uint32_t k = 0; k < microseconds; k += each_us) {
        now_us += each_us;
        laconic_node_on_tick(&node, now_us);
    }
}

static void command(int raw) {
    laconic_frame frame = {.id = 0x200, .length = 8};
    for (int k = 0; k < 4; k++) {
        frame.data[2 * k] = (uint8_t)((unsigned)raw >> 8 & 255U);
        frame.data[2 * k + 1] = (uint8_t)((unsigned)raw & 255U);
    }
    laconic_node_on_frame(&node, &frame, now_us);
}

/* Frames that wait: of the protocol, and of the node itself. */
static void fetch(int *of_drives, int *of_node) {
    laconic_frame frame;
    *of_drives = *of_node = 0;
    while (laconic_node_next_frame(&node, &frame)) ++*(frame.id < 0x210 ? of_drives : of_node);
}

static void one_step_is_taken_each_period(void) {
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_DRIVES, node.state);
    command(1000);
    pass(50000, 100);
    TEST_ASSERT_EQUAL_UINT64(50, node.plant.steps);
    TEST_ASSERT_TRUE(node.drives.drive[0].encoder.count > 0 && node.counters.late_periods == 0);
    TEST_ASSERT_EQUAL_UINT32(1000, laconic_node_idle_us(&node, now_us));
}

static void ten_thousand_steps_a_second_are_taken(void) {
    load(REAL(0.0001));
    TEST_ASSERT_EQUAL_UINT8(0, start());
    pass(100000, 100);
    TEST_ASSERT_EQUAL_UINT64(1000, node.plant.steps);
    load(REAL(1.0 / 3000));
    TEST_ASSERT_EQUAL_UINT8(0, start());
    pass(100000, 50);
    TEST_ASSERT_EQUAL_UINT64(300, node.plant.steps);
}

static void steps_without_a_whole_rate_are_refused(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    static const double steps_s[] = {0.0007, 0.00009, 1.5, 2, 1 / 1000.4};
    for (size_t k = 0; k < sizeof steps_s / sizeof steps_s[0]; k++) {
        load((laconic_real)steps_s[k]);
        const struct laconic_dbc_control_t frame = {.command = LACONIC_WIRE_COMMAND_START_DRIVES};
        laconic_dbc_control_pack(data, &frame, 8);
        bench_send(LACONIC_WIRE_CONTROL, data);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_STEP, data[4]);
    }
    load(1);
    TEST_ASSERT_EQUAL_UINT8(0, start());
}

static void late_periods_are_counted_and_none_is_left_out(void) {
    start();
    now_us += 5500;
    for (int k = 0; k < 10; k++) laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(5, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT32(4500, node.free_run.worst_lateness_us);
    TEST_ASSERT_EQUAL_UINT16(4, node.counters.late_periods);
}

static void a_node_that_plays_sends_the_protocols_frames_alone(void) {
    int of_drives, of_node;
    start();
    fetch(&of_drives, &of_node);
    pass(300000, 1000);
    fetch(&of_drives, &of_node);
    TEST_ASSERT_EQUAL_INT(4, of_drives); /* the newest of each */
    TEST_ASSERT_EQUAL_INT(0, of_node);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    pass(100000, 1000);
    fetch(&of_drives, &of_node);
    TEST_ASSERT_TRUE(of_drives == 0 && of_node == 1); /* HEARTBEAT again */
}

static void a_rig_may_select_frames_while_drives_play(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    int of_drives, of_node;
    start();
    command(2000);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, 0, 0));
    pass(5000, 1000);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    pass(100000, 1000);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HEARTBEAT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_DRIVES, data[1] >> 4);
    TEST_ASSERT_TRUE(node.drives.drive[0].encoder.count > 1000); /* SELECT has not stopped it */
    fetch(&of_drives, &of_node);
}

/* Whoever reads the torques and takes the same steps with a plant of the core has the wheels' motion, bit for bit. */
static void raw_axle_torques_are_those_of_the_step_and_give_its_motion(void) {
    laconic_plant twin = node.plant;
    laconic_input held = {0};
    laconic_real number[2 * 4], speed[4];
    int of_drives, of_node;
    start();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, LACONIC_RAW_WHEEL_SPEED, SELECT_RAW_AXLE_TORQUE));
    TEST_ASSERT_EQUAL_UINT8(0, node.raw_input.take);
    for (int k = 0; k < 20; k++) {
        command(500 * k);
        pass(1000, 1000);
        TEST_ASSERT_EQUAL_UINT16(sizeof number, node.raw_output.size);
        memcpy(number, node.raw_output.number, sizeof number);
        memcpy(held.axle_torque_Nm, number + 4, sizeof speed);
        TEST_ASSERT_TRUE(LACONIC_OK == laconic_plant_run(&twin, &held, 1, NULL));
        laconic_plant_wheel_speeds(&twin, speed);
        TEST_ASSERT_EQUAL_MEMORY(speed, number, sizeof speed);
        TEST_ASSERT_TRUE(number[4] == node.drives.drive[0].torque_Nm);
        fetch(&of_drives, &of_node);
        TEST_ASSERT_EQUAL_INT((sizeof number + 5) / 6, of_node);
    }
    TEST_ASSERT_TRUE(number[4] > 0 && speed[0] > 0);
}

static void the_next_step_waits_until_the_raw_axle_torques_of_the_last_are_sent(void) {
    int of_drives, of_node;
    start();
    bench_select(0, LACONIC_RAW_WHEEL_SPEED, 0);
    pass(5000, 1000);
    TEST_ASSERT_EQUAL_UINT64(5, node.plant.steps);
    fetch(&of_drives, &of_node);
    bench_select(0, LACONIC_RAW_WHEEL_SPEED, SELECT_RAW_AXLE_TORQUE);
    pass(5000, 1000);
    TEST_ASSERT_EQUAL_UINT64(6, node.plant.steps);
    for (int k = 0; k < 4; k++) {
        fetch(&of_drives, &of_node);
        laconic_node_on_tick(&node, now_us);
    }
    TEST_ASSERT_EQUAL_UINT64(10, node.plant.steps); /* late, none left out */
}

static void frames_for_drives_do_nothing_before_they_play(void) {
    command(1000);
    TEST_ASSERT_EQUAL_INT(0, node.drives.count);
    start();
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, node.drives.drive[0].target.mode);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.malformed);
}

static void stop_switches_the_drives_off_and_a_start_is_their_power_up(void) {
    start();
    command(2000);
    pass(100000, 1000);
    const uint64_t steps = node.plant.steps;
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
    TEST_ASSERT_TRUE(node.drives.drive[0].torque_Nm == 0 && node.input[0].axle_torque_Nm[0] == 0);
    pass(10000, 1000);
    TEST_ASSERT_EQUAL_UINT64(steps, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_TRUE(node.drives.drive[0].encoder.count == 0 && node.drives.drive[0].speed_rad_per_s > 1);
}

static void a_refused_step_is_a_fault_with_the_drives_off(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    start();
    command(2000);
    pass(3000, 1000);
    node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
    pass(1000, 1000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_SYNC, data[2]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_BODY_MOMENT, data[4]);
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, node.drives.drive[0].target.mode);
}

static void start_needs_a_vehicle_with_drives_that_is_ready(void) {
    node.drive_plan.protocol = 0;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, start());
    node.drive_plan.protocol = 3;
    start();
    command(1000);
    pass(3000, 100);
    const laconic_drives before = node.drives;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, start()); /* and they go on as they were */
    TEST_ASSERT_EQUAL_MEMORY(&before, &node.drives, sizeof before);
}

static void voltages_and_syncs_of_a_rig_do_not_act_while_drives_play(void) {
    start();
    bench_voltage(0, 500, 0);
    pass(5000, 1000);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
}

static void a_plan_is_checked_against_the_protocols_that_are_linked(void) {
    uint8_t field = 0;
    uint8_t item = 0;
    laconic_drive_plan plan = scene_plan(3);
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_check_drives(&node, &plan, 4, &field, &item));
    plan.drive[1].encoder_counts = 0;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_POSITIVE, laconic_node_check_drives(&node, &plan, 4, &field, &item));
    TEST_ASSERT_TRUE(field == LACONIC_DRIVES_FIELD_ENCODER_COUNTS && item == 2);
    plan.protocol = 77;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED,
                            laconic_node_check_drives(&node, &plan, 4, &field, &item));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, field);
    plan.protocol = 0; /* numbers of drives that are not there do not count */
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_check_drives(&node, &plan, 4, &field, &item));
    node.config.protocol = NULL;
    plan.protocol = 3;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED,
                            laconic_node_check_drives(&node, &plan, 4, &field, &item));
}

/* PARAMETER with DRIVE_FAULTS; the status of its RESULT. */
static uint8_t order(uint8_t wheel, uint32_t faults, uint8_t upper_half) {
    const struct laconic_dbc_parameter_t frame = {
        .upper_half = upper_half, .field = LACONIC_WIRE_FIELD_DRIVE_FAULTS, .item = wheel, .value = faults};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    return bench_receive(LACONIC_WIRE_RESULT, data) ? data[3] : 255U;
}

static void faults_of_a_drive_are_ordered_by_its_wheel_while_it_plays(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, order(1, 4, 0));
    start();
    TEST_ASSERT_EQUAL_UINT8(0, order(2, LACONIC_DRIVE_FAULT_TEMPERATURE, 0));
    TEST_ASSERT_TRUE(node.drives.drive[0].faults == 0 &&
                     node.drives.drive[1].faults == LACONIC_DRIVE_FAULT_TEMPERATURE);
    TEST_ASSERT_EQUAL_UINT8(0, order(2, LACONIC_DRIVE_ORDER_HELD, 0));
    TEST_ASSERT_TRUE(node.drives.drive[1].causes == 0 && node.drives.drive[1].brake_Nm > 0);
    TEST_ASSERT_EQUAL_UINT16(0, node.loader.frame_count); /* no number of a vehicle */
    TEST_ASSERT_EQUAL_UINT8(0, node.loader.status);
}

static void an_order_that_cannot_be_is_refused_and_changes_nothing(void) {
    start();
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, order(1, LACONIC_DRIVE_FAULT_WATCHDOG, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, order(1, 4, 1));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, order(0, 4, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, order(9, 4, 0));
    for (int k = 0; k < node.drives.count; k++) TEST_ASSERT_EQUAL_UINT32(0, node.drives.drive[k].faults);
}

static void a_plays_periods_are_single_steps_and_its_answer_names_no_field(void) {
    uint8_t field = 99;
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_start_drives(&node, now_us, &field));
    TEST_ASSERT_EQUAL_UINT8(0, field);
    TEST_ASSERT_EQUAL_UINT32(1, node.free_run.steps_per_period);
}

static void a_refused_step_answers_no_request(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    start();
    node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
    pass(1000, 1000);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(0, data[1] >> 4);
}

static void an_order_is_answered_with_its_wheel(void) {
    const struct laconic_dbc_parameter_t frame = {.field = LACONIC_WIRE_FIELD_DRIVE_FAULTS, .item = 3, .value = 4};
    uint8_t data[LACONIC_FRAME_BYTES];
    start();
    laconic_dbc_parameter_pack(data, &frame, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_TRUE(data[4] == LACONIC_WIRE_FIELD_DRIVE_FAULTS && data[5] == 3);
}

static void more_than_ten_thousand_steps_a_second_are_refused(void) {
    load(REAL(1.0 / 10050));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start());
}

/* Byte 0 is the checksum, whose bits tell nothing of the order. */
static void the_half_of_an_order_stands_beside_its_counter(void) {
    uint8_t lower[8] = {0x10, 0x0F, LACONIC_WIRE_FIELD_DRIVE_FAULTS, 1, 4}, upper[8];
    start();
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_order_drive(&node, lower));
    memcpy(upper, lower, sizeof upper);
    upper[0] = 0;
    upper[1] = 0x1F;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, laconic_node_order_drive(&node, upper));
}

/* The step whose rate is that number, but for rounding. */
static void load_rate(double rate_Hz) { load((laconic_real)(1 / rate_Hz)); }

/* A rate may be off by a ten-thousandth, and the nearest whole one is taken; above 10,000 there is none. */
static void a_rate_is_rounded_to_the_nearest(void) {
    load_rate(9999.4965);
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_EQUAL_UINT32(9999, node.free_run.rate_Hz);
    load_rate(9998.6);
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_EQUAL_UINT32(9999, node.free_run.rate_Hz);
    load_rate(10000.5);
    TEST_ASSERT_TRUE(1 / node.plant.integrator.step_s == (laconic_real)10000.5);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start());
}

/* An ideal IMU feels what the drives do, in the very step. */
static void sensors_watch_what_the_drives_do(void) {
    laconic_real number[5];
    start();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, LACONIC_RAW_IMU, 0));
    command(3000);
    pass(3000, 1000);
    memcpy(number, node.raw_output.number, sizeof number);
    TEST_ASSERT_TRUE(number[0] > REAL(0.1));
    TEST_ASSERT_TRUE(number[2] == number[0] && number[3] == number[1]);
    TEST_ASSERT_EQUAL_UINT64(3, node.sensors.newest);
}

static void an_order_for_a_wheel_without_a_drive_is_unknown(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    node.drive_plan.drive[0].node_id = -1;
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_EQUAL_INT(3, node.drives.count);
    for (uint8_t wheel = 1; wheel <= 4; wheel++) {
        const struct laconic_dbc_parameter_t frame = {.field = LACONIC_WIRE_FIELD_DRIVE_FAULTS, .item = wheel};
        laconic_dbc_parameter_pack(data, &frame, 8);
        bench_send(LACONIC_WIRE_PARAMETER, data);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(wheel == 1 ? LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN : 0, data[3]);
    }
}

static laconic_drive_protocol of_size;

static const laconic_drive_protocol *large_protocol(int32_t number) { return number == 3 ? &of_size : NULL; }

/* A node has so many bytes for what a protocol knows of each drive, and not one more. */
static void a_protocol_may_fill_its_room(void) {
    of_size = laconic_robomaster;
    node.config.protocol = large_protocol;
    of_size.axis_bytes = LACONIC_NODE_AXIS_BYTES + 1;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, start());
    of_size.axis_bytes = LACONIC_NODE_AXIS_BYTES;
    TEST_ASSERT_EQUAL_UINT8(0, start());
}

static void raw_numbers_alone_make_the_node_speak_while_drives_play(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    start();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, LACONIC_RAW_WHEEL_SPEED, 0));
    pass(100000, 1000);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HEARTBEAT, data));
}

static void a_step_that_is_refused_under_sensors_is_a_fault_too(void) {
    start();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, LACONIC_RAW_IMU, 0));
    pass(2000, 1000);
    node.input[0].body_moment_Nm = LACONIC_REAL_MAX * 2;
    pass(1000, 1000);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_EQUAL_UINT64(2, node.sensors.newest);
}

/* Of all steps this one alone has a rate that is off by exactly the ten-thousandth, and in single precision alone. */
static void a_rate_at_the_very_edge_of_its_tolerance_is_refused(void) {
    if (sizeof(laconic_real) == 8) return;
    load(REAL(0.00026408766279928386));
    const laconic_real rate_Hz = 1 / node.plant.integrator.step_s, slack = REAL(1e-4);
    TEST_ASSERT_TRUE(rate_Hz - 3787 == -slack * rate_Hz);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, start());
}

/* As a bit of the count that changes would make it. */
static void a_count_of_drives_below_none_is_none(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0, 0, LACONIC_WIRE_FIELD_DRIVE_FAULTS, 1, 4};
    TEST_ASSERT_EQUAL_UINT8(0, start());
    TEST_ASSERT_EQUAL_UINT8(0, laconic_node_order_drive(&node, data));
    node.drives.drive[1].unheard = true;
    node.drives.count = INT32_MIN + node.drives.count;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, laconic_node_order_drive(&node, data));
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0, data[7] & 0x80U);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(one_step_is_taken_each_period);
    RUN_TEST(ten_thousand_steps_a_second_are_taken);
    RUN_TEST(steps_without_a_whole_rate_are_refused);
    RUN_TEST(late_periods_are_counted_and_none_is_left_out);
    RUN_TEST(a_node_that_plays_sends_the_protocols_frames_alone);
    RUN_TEST(a_rig_may_select_frames_while_drives_play);
    RUN_TEST(raw_axle_torques_are_those_of_the_step_and_give_its_motion);
    RUN_TEST(the_next_step_waits_until_the_raw_axle_torques_of_the_last_are_sent);
    RUN_TEST(frames_for_drives_do_nothing_before_they_play);
    RUN_TEST(stop_switches_the_drives_off_and_a_start_is_their_power_up);
    RUN_TEST(a_refused_step_is_a_fault_with_the_drives_off);
    RUN_TEST(start_needs_a_vehicle_with_drives_that_is_ready);
    RUN_TEST(voltages_and_syncs_of_a_rig_do_not_act_while_drives_play);
    RUN_TEST(a_plan_is_checked_against_the_protocols_that_are_linked);
    RUN_TEST(faults_of_a_drive_are_ordered_by_its_wheel_while_it_plays);
    RUN_TEST(an_order_that_cannot_be_is_refused_and_changes_nothing);
    RUN_TEST(a_plays_periods_are_single_steps_and_its_answer_names_no_field);
    RUN_TEST(a_refused_step_answers_no_request);
    RUN_TEST(an_order_is_answered_with_its_wheel);
    RUN_TEST(more_than_ten_thousand_steps_a_second_are_refused);
    RUN_TEST(the_half_of_an_order_stands_beside_its_counter);
    RUN_TEST(a_rate_is_rounded_to_the_nearest);
    RUN_TEST(sensors_watch_what_the_drives_do);
    RUN_TEST(an_order_for_a_wheel_without_a_drive_is_unknown);
    RUN_TEST(a_protocol_may_fill_its_room);
    RUN_TEST(raw_numbers_alone_make_the_node_speak_while_drives_play);
    RUN_TEST(a_step_that_is_refused_under_sensors_is_a_fault_too);
    RUN_TEST(a_rate_at_the_very_edge_of_its_tolerance_is_refused);
    RUN_TEST(a_count_of_drives_below_none_is_none);
    return UNITY_END();
}
