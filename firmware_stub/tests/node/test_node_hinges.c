/* Tests of vehicles with hinges in the node: each step and each frame against the core's own functions. */
#include "hinge_bench.h"

/* One step of the core from a copy of the node's state. */
static laconic_articulated_state stepped(laconic_articulated_input start, laconic_articulated_input end) {
    laconic_articulated_state state = node.hinges.state;
    laconic_articulated_ramp(&start, &end, STEP_S);
    TEST_ASSERT_EQUAL_INT(
        LACONIC_OK, laconic_articulated_step(&node.hinges.model, &node.hinges.integrator, &state, &start, &end, NULL));
    return state;
}

#define ASSERT_SAME_STATE(wanted) TEST_ASSERT_EQUAL_MEMORY(&(wanted), &node.hinges.state, sizeof(wanted))

void setUp(void) { bench_begin(); }
void tearDown(void) {}

static void a_vehicle_with_hinges_comes_by_parameters(void) {
    load_tricycle(&prescribed);
    TEST_ASSERT_TRUE(node.hinges.here);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
    TEST_ASSERT_EQUAL_INT32(1, node.hinges.model.body_count);
    TEST_ASSERT_EQUAL_INT32(1, node.hinges.model.wheel[2].body);
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_PRESCRIBED, node.hinges.model.link[0].motion);
    bench_hello();
    laconic_node_pack(&node, LACONIC_WIRE_IDENTITY, data);
    TEST_ASSERT_BITS(0x20U, 0x20U, data[1]);
}

static void a_body_without_a_required_number_is_refused_by_field_and_item(void) {
    const parameter count = INTEGER(BODY_COUNT, 0, 2);
    begin_tricycle(&prescribed);
    send_parameter(&count);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, commit());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_FIELD_BODY_HINGE, data[4]);
    TEST_ASSERT_EQUAL_UINT8(2, data[5]);
}

static void a_kind_of_hinge_beyond_one_byte_is_refused_and_not_cut(void) {
    const parameter kinds[] = {INTEGER(BODY_HINGE, 1, 257), INTEGER(BODY_HINGE, 1, 128)};
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        begin_tricycle(&prescribed);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, send_parameter(&kinds[k]));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, commit());
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_FIELD_BODY_HINGE, data[4]);
        TEST_ASSERT_EQUAL_UINT8(1, data[5]);
    }
}

static void what_a_vehicle_with_hinges_does_not_have_is_refused(void) {
    const parameter others[] = {NUMBER(START_NU, 1, 1), NUMBER(IMU_ACCELERATION_BIAS, 1, 1)};
    const uint8_t fields[] = {LACONIC_WIRE_FIELD_START_NU, LACONIC_WIRE_FIELD_IMU_X};
    for (size_t k = 0; k < 2; k++) {
        begin_tricycle(&prescribed);
        send_parameter(&others[k]);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, commit());
        TEST_ASSERT_EQUAL_UINT8(fields[k], data[4]);
    }
}

static void wheels_of_hinges_slip_as_in_the_core_under_voltages_and_angles(void) {
    laconic_tree_input held = {0};
    begin_slipping();
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_TRUE(node.hinges.here && node.hinges.slips);
    laconic_tree_state wanted = node.hinges.tree;
    TEST_ASSERT_TRUE(wanted.wheel_speed_rad_per_s[0] == 5);
    bench_start_lockstep();
    held.hinge_angle_rad[0] = (laconic_real)0.2; /* of the start, until the first command */
    for (int k = 0; k < 3; k++) held.hinged.base.voltage_V[k] = 5;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_tree_step(&node.hinges.tree_model, STEP_S, &wanted, &held, NULL));
    bench_step(1);
    TEST_ASSERT_EQUAL_MEMORY(&wanted, &node.hinges.tree, sizeof wanted);
    for (int k = 0; k < 3; k++) held.hinged.base.voltage_V[k] = 4;
    held.hinge_angle_rad[0] = 800 / (laconic_real)LACONIC_WIRE_STEERING_HINGE_RATE_1_PER_UNIT;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_tree_step(&node.hinges.tree_model, STEP_S, &wanted, &held, NULL));
    bench_voltage(0, 4 * VOLT, 0);
    steer(0, 800, 0, 0, true);
    TEST_ASSERT_EQUAL_MEMORY(&wanted, &node.hinges.tree, sizeof wanted);
    TEST_ASSERT_TRUE(motion().x_m != 0);
}

static void what_ground_with_friction_lacks_is_refused_by_its_field(void) {
    const parameter method = INTEGER(METHOD, 0, 1), coordination = INTEGER(BODY_HINGE, 1, LACONIC_HINGE_COORDINATED);
    const parameter step = NUMBER(STEP, 0, 0);
    const parameter *wrong[] = {&method, &coordination, &step};
    const uint8_t statuses[] = {LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_COORDINATED_SLIPS, LACONIC_NOT_POSITIVE};
    for (size_t k = 0; k < sizeof statuses; k++) {
        begin_slipping();
        TEST_ASSERT_EQUAL_UINT8(0, send_parameter(wrong[k]));
        TEST_ASSERT_EQUAL_UINT8(statuses[k], commit());
        TEST_ASSERT_EQUAL_UINT8(wrong[k]->field, data[4]);
        TEST_ASSERT_FALSE(node.hinges.here);
    }
}

static void a_vehicle_that_slips_has_no_twist_and_no_samples_and_one_that_rolls_no_angles(void) {
    begin_slipping();
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(0, 0, 0, 0, LACONIC_RAW_STEERING_ANGLE));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, 0, LACONIC_RAW_TWIST));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, LACONIC_RAW_SAMPLED, 0, 0));
    load_tricycle(&prescribed);
    TEST_ASSERT_FALSE(node.hinges.slips);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, 0, LACONIC_RAW_STEERING_ANGLE));
}

static void a_choice_that_the_next_vehicle_has_not_ends_with_it(void) {
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(0, 0, LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE, 0, LACONIC_RAW_TWIST));
    begin_slipping();
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_RAW_VOLTAGE, node.raw_input.take);
    TEST_ASSERT_EQUAL_UINT8(0, node.raw_input.take_hinges);
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(0, 0, LACONIC_RAW_VOLTAGE, 0, LACONIC_RAW_STEERING_ANGLE));
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_RAW_VOLTAGE, node.raw_input.take);
    TEST_ASSERT_EQUAL_UINT8(0, node.raw_input.take_hinges);
}

static void an_accepted_vehicle_names_no_field(void) {
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(0, data[4]);
    TEST_ASSERT_EQUAL_UINT8(0, data[5]);
}

static void a_refused_vehicle_leaves_the_one_before(void) {
    const parameter unknown = INTEGER(BODY_HINGE, 1, 9), parent = INTEGER(BODY_PARENT, 1, 1);
    load_tricycle(&prescribed);
    const laconic_node_hinges before = node.hinges;
    begin_tricycle(&unknown);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_HINGE_KIND_UNKNOWN, commit());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_FIELD_BODY_HINGE, data[4]);
    begin_tricycle(&prescribed);
    send_parameter(&parent);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_BODY_UNKNOWN, commit());
    TEST_ASSERT_EQUAL_MEMORY(&before.model, &node.hinges.model, sizeof before.model);
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &node.hinges.state, sizeof before.state);
}

static void voltages_and_rates_make_the_step_of_the_core(void) {
    laconic_articulated_input start = {0}, end = {0};
    load_tricycle(&prescribed);
    bench_start_lockstep();
    for (int k = 0; k < 3; k++) start.base.voltage_V[k] = end.base.voltage_V[k] = 5;
    for (int k = 1; k <= 20; k++) {
        end.hinge_rate_rad_per_s[0] = (laconic_real)k / 20;
        const laconic_articulated_state wanted = stepped(start, end);
        bench_voltage(0, 5 * VOLT, 0);
        steer(0, (int16_t)(100 * k), 0, 0, true);
        ASSERT_SAME_STATE(wanted);
        start = end;
    }
    TEST_ASSERT_EQUAL_UINT64(20, node.plant.steps);
    TEST_ASSERT_TRUE(motion().hinge_angle_rad[0] > (laconic_real)0.09);
}

static void a_command_is_reached_once_and_then_held(void) {
    load_tricycle(&prescribed);
    bench_start_lockstep();
    steer(0, 1000, 0, 0, false);
    bench_step(3);
    rate_is((laconic_real)0.5);
    const laconic_real angle = motion().hinge_angle_rad[0]; /* one step on the way to the rate, two at it */
    TEST_ASSERT_TRUE(angle > (laconic_real)0.01249 && angle < (laconic_real)0.01251);
}

static void a_twist_of_whole_numbers_rolls_on_the_axle_of_the_carriage(void) {
    const parameter com = NUMBER(COM_X, 0, 0.37);
    begin_tricycle(&coordinated);
    send_parameter(&com);
    send_parameter(&ahead);
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    bench_start_lockstep();
    for (int16_t k = 1; k <= 50; k++) {
        bench_voltage(0, 5 * VOLT, 0);
        steer(6, 30000, 3, (int16_t)(200 * k), true); /* 3: the axle lets no such part pass */
    }
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_LOCKSTEP, node.state);
    const laconic_real angle = motion().hinge_angle_rad[0], third = (laconic_real)0.3217505544; /* atan(1/3) */
    TEST_ASSERT_TRUE(angle > third - (laconic_real)1e-4 && angle < third + (laconic_real)1e-4);
}

static void a_twist_across_the_axle_is_refused_by_the_core(void) {
    load_tricycle(&coordinated);
    bench_start_lockstep();
    steer(6, 30000, 3000, 0, true);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_TWIST_AGAINST_WHEELS, data[3]);
}

static void commands_for_hinges_that_take_none_are_refused(void) {
    static const uint8_t pages[] = {0, 1, 3, 6, 7};
    load_tricycle(&prescribed);
    bench_start_lockstep();
    const uint16_t before = node.counters.refused;
    steer(0, 0, 5, 0, false);                                    /* the second of one hinge */
    for (int k = 1; k < 5; k++) steer(pages[k], 5, 0, 0, false); /* no such hinge, no motor, no twist, no page */
    TEST_ASSERT_EQUAL_UINT16(before + 5U, node.counters.refused);
    TEST_ASSERT_FALSE(node.hinges.changes);
}

static void a_vehicle_without_hinges_takes_neither_steering_nor_frames_of_hinges(void) {
    bench_load(3);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, LACONIC_NODE_SEND_VELOCITY, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, 0, LACONIC_RAW_TWIST));
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(LACONIC_NODE_SEND_NU, 0, 0, 0, 0));
    bench_start_lockstep();
    const uint16_t before = node.counters.refused;
    steer(0, 1, 0, 0, true);
    TEST_ASSERT_EQUAL_UINT16(before + 1U, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
}

static void what_select_asks_of_a_vehicle_with_hinges_is_what_it_has(void) {
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(LACONIC_NODE_SEND_NU, 0, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(LACONIC_NODE_SEND_IMU, 0, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, LACONIC_RAW_NU, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, SELECTS_ESTIMATE, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, 0x40, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, select_bits(0, 0, 0, 0, 0x10));
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(LACONIC_NODE_SEND_POSE, LACONIC_RAW_POSE, 1, 0x3F, 0x0F));
}

static void frames_show_velocity_hinges_and_wheels(void) {
    load_tricycle(&prescribed);
    select_bits(LACONIC_NODE_SEND_POSE | LACONIC_NODE_SEND_WHEEL_SPEED | LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0, 7, 0);
    bench_start_lockstep();
    steer(0, 2000, 0, 0, false);
    bench_step(40);
    const laconic_articulated_motion now = motion();
    const laconic_real wanted[6] = {now.velocity_m_per_s[0] * 2000,     now.velocity_m_per_s[1] * 2000,
                                    now.yaw_rate_rad_per_s * 2000,      now.hinge_angle_rad[0] * 10000,
                                    now.hinge_rate_rad_per_s[0] * 1000, now.wheel_speed_rad_per_s[2] * 200};
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_SPEED, data));
    TEST_ASSERT_EQUAL_INT16(rounded(wanted[5]), (int16_t)word16(data + 6));
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_VELOCITY, data));
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_INT16(rounded(wanted[k]), (int16_t)word16(data + 2 + 2 * k));
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HINGE_ANGLE, data));
    TEST_ASSERT_EQUAL_INT16(rounded(wanted[3]), (int16_t)word16(data + 2));
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HINGE_RATE, data));
    TEST_ASSERT_EQUAL_INT16(rounded(wanted[4]), (int16_t)word16(data + 2));
    TEST_ASSERT_EQUAL_UINT32(0, node.pending);
}

/* Voltage, rate and nothing else, of start and end. */
static void raw_numbers_of_start_and_end_make_the_step_of_the_core(void) {
    const laconic_real number[8] = {1, 2, 3, (laconic_real)0.1, 4, 5, 6, (laconic_real)0.3};
    laconic_articulated_input start = {0}, end = {0};
    uint8_t segment = 0;
    load_tricycle(&prescribed);
    select_bits(0, LACONIC_RAW_POSE, LACONIC_RAW_VOLTAGE | LACONIC_RAW_SAMPLED, 0x38, LACONIC_RAW_STEERING_RATE);
    bench_start_lockstep();
    bench_send_count(LACONIC_WIRE_RAW_INPUT, (const uint8_t[8]){0}, ++sent[LACONIC_WIRE_RAW_INPUT]);
    for (size_t at = 0; at < sizeof number; at += 6, segment++) {
        uint8_t payload[LACONIC_FRAME_BYTES] = {0, (uint8_t)(segment << 4)};
        memcpy(payload + 2, (const uint8_t *)number + at, sizeof number - at < 6 ? sizeof number - at : 6);
        bench_send_count(LACONIC_WIRE_RAW_INPUT, payload, ++sent[LACONIC_WIRE_RAW_INPUT]);
    }
    for (int k = 0; k < 3; k++) start.base.voltage_V[k] = number[k];
    for (int k = 0; k < 3; k++) end.base.voltage_V[k] = number[4 + k];
    start.hinge_rate_rad_per_s[0] = number[3];
    end.hinge_rate_rad_per_s[0] = number[7];
    const laconic_articulated_state wanted = stepped(start, end);
    const struct laconic_dbc_sync_t frame = {.step_count = 1, .input_frames = segment};
    laconic_dbc_sync_pack(data, &frame, 8);
    bench_send_count(LACONIC_WIRE_SYNC, data, 1);
    bench_send_count(LACONIC_WIRE_SYNC, data, 2);
    sent[LACONIC_WIRE_SYNC] = 2;
    bench_tick_lockstep();
    ASSERT_SAME_STATE(wanted);
    TEST_ASSERT_EQUAL_UINT16((3 + 3 + 1 + 1) * sizeof(laconic_real), node.raw_output.size);
    TEST_ASSERT_TRUE(node.raw_output.number[6] == motion().hinge_angle_rad[0]);
    TEST_ASSERT_TRUE(node.raw_output.number[7] == motion().hinge_rate_rad_per_s[0]);
}

static void reset_returns_to_the_start_with_its_commands(void) {
    const parameter more[] = {NUMBER(HINGE_RATE, 1, 0.25), NUMBER(START_HINGE_ANGLE, 1, 0.5), NUMBER(START_X, 0, 3),
                              NUMBER(START_VELOCITY, 1, 1)};
    begin_tricycle(&prescribed);
    for (int k = 0; k < 4; k++) send_parameter(&more[k]);
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    const laconic_articulated_state start = node.hinges.state;
    TEST_ASSERT_TRUE(motion().hinge_angle_rad[0] == (laconic_real)0.5 && motion().x_m == 3);
    rate_is((laconic_real)0.25);
    bench_start_lockstep();
    steer(0, -1000, 0, 0, false);
    bench_step(7);
    bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0);
    ASSERT_SAME_STATE(start);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
    TEST_ASSERT_TRUE(node.hinges.input[0].hinge_rate_rad_per_s[0] == (laconic_real)0.25);
}

static void a_watchdog_holds_the_hinges_and_lets_the_vehicle_coast(void) {
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 100, 50));
    bench_voltage(0, 5 * VOLT, 0);
    steer(0, 2000, 0, 0, false);
    bench_pass_ms(40);
    rate_is(1);
    bench_pass_ms(40);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_TIMEOUT, node.state);
    rate_is(0);
    TEST_ASSERT_TRUE(motion().velocity_m_per_s[0] > 0);
}

static void a_stopped_car_keeps_the_direction_of_its_wheels(void) {
    load_tricycle(&coordinated);
    bench_start_lockstep();
    for (int16_t k = 1; k <= 10; k++) steer(6, 30000, 0, (int16_t)(1000 * k), true);
    const laconic_real angle = motion().hinge_angle_rad[0];
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_start_lockstep();
    bench_step(5);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_LOCKSTEP, node.state);
    const laconic_real change = motion().hinge_angle_rad[0] - angle;
    TEST_ASSERT_TRUE(change < (laconic_real)1e-5 && change > (laconic_real)-1e-5);
}

static void a_plain_vehicle_after_one_with_hinges_moves_by_the_plant(void) {
    load_tricycle(&prescribed);
    select_bits(0, 0, 0, 7, 15);
    bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0);
    for (uint8_t wheel = 1; wheel <= 2; wheel++) send_rolling(wheel);
    for (size_t k = 0; common[k].field != LACONIC_WIRE_FIELD_BODY_COUNT; k++) {
        const bool of_third = common[k].item == 3;
        const parameter two = INTEGER(WHEEL_COUNT, 0, 2);
        if (!of_third) send_parameter(common[k].field == two.field ? &two : &common[k]);
    }
    const parameter method = INTEGER(METHOD, 0, 1);
    send_parameter(&method);
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_FALSE(node.hinges.here);
    bench_start_lockstep();
    bench_step(3);
    TEST_ASSERT_EQUAL_UINT64(3, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT32(0, node.pending & PENDING_OF_HINGES);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_vehicle_with_hinges_comes_by_parameters);
    RUN_TEST(a_body_without_a_required_number_is_refused_by_field_and_item);
    RUN_TEST(a_kind_of_hinge_beyond_one_byte_is_refused_and_not_cut);
    RUN_TEST(what_a_vehicle_with_hinges_does_not_have_is_refused);
    RUN_TEST(wheels_of_hinges_slip_as_in_the_core_under_voltages_and_angles);
    RUN_TEST(what_ground_with_friction_lacks_is_refused_by_its_field);
    RUN_TEST(a_vehicle_that_slips_has_no_twist_and_no_samples_and_one_that_rolls_no_angles);
    RUN_TEST(a_choice_that_the_next_vehicle_has_not_ends_with_it);
    RUN_TEST(an_accepted_vehicle_names_no_field);
    RUN_TEST(a_refused_vehicle_leaves_the_one_before);
    RUN_TEST(voltages_and_rates_make_the_step_of_the_core);
    RUN_TEST(a_command_is_reached_once_and_then_held);
    RUN_TEST(a_twist_of_whole_numbers_rolls_on_the_axle_of_the_carriage);
    RUN_TEST(a_twist_across_the_axle_is_refused_by_the_core);
    RUN_TEST(commands_for_hinges_that_take_none_are_refused);
    RUN_TEST(a_vehicle_without_hinges_takes_neither_steering_nor_frames_of_hinges);
    RUN_TEST(what_select_asks_of_a_vehicle_with_hinges_is_what_it_has);
    RUN_TEST(frames_show_velocity_hinges_and_wheels);
    RUN_TEST(raw_numbers_of_start_and_end_make_the_step_of_the_core);
    RUN_TEST(reset_returns_to_the_start_with_its_commands);
    RUN_TEST(a_watchdog_holds_the_hinges_and_lets_the_vehicle_coast);
    RUN_TEST(a_stopped_car_keeps_the_direction_of_its_wheels);
    RUN_TEST(a_plain_vehicle_after_one_with_hinges_moves_by_the_plant);
    return UNITY_END();
}
