/* Tests of drives that turn steering axes, and wheels of a vehicle with hinges. */
#include "hinge_bench.h"

void setUp(void) { bench_begin(); }
void tearDown(void) {}

/* CANopen; node 1 turns the third wheel, node 2 the hinge behind the wheels. */
static void begin_with_drives(const parameter *hinge) {
    const parameter drives[] = {INTEGER(DRIVE_PROTOCOL, 0, 1), INTEGER(DRIVE_NODE_ID, 3, 1),
                                INTEGER(DRIVE_NODE_ID, 4, 2)};
    begin_tricycle(hinge);
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&drives[k]));
    for (uint8_t item = 3; item <= 4; item++) {
        const parameter numbers[] = {INTEGER(ENCODER_COUNTS, item, 1000),      NUMBER(DRIVE_GEAR_RATIO, item, -10),
                                     NUMBER(DRIVE_TORQUE_CONSTANT, item, 0.1), NUMBER(DRIVE_CURRENT_LIMIT, item, 5),
                                     NUMBER(DRIVE_SPEED_LIMIT, item, 4),       NUMBER(DRIVE_POSITION_GAIN, item, 5)};
        for (int k = 0; k < 6; k++) TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&numbers[k]));
    }
}

static void start_drives(const parameter *hinge) {
    begin_with_drives(hinge);
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    TEST_ASSERT_EQUAL_INT32(2, node.drives.count);
    TEST_ASSERT_EQUAL_UINT8(3, node.drives.wheel[1]);
}

static const parameter motor = INTEGER(BODY_HINGE, 1, LACONIC_HINGE_MOTOR);

static void a_drive_turns_a_prescribed_axis_at_its_set_speed_within_its_limit(void) {
    start_drives(&prescribed);
    node.drives.drive[1].target.mode = LACONIC_DRIVE_SPEED;
    node.drives.drive[1].target.speed_rad_per_s = 3;
    bench_pass_ms(100);
    rate_is((laconic_real)-0.3); /* the gear is mirrored */
    TEST_ASSERT_EQUAL_UINT8(0, node.drives.drive[1].limits);
    node.drives.drive[1].target.speed_rad_per_s = 9;
    bench_pass_ms(100);
    rate_is((laconic_real)-0.4);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_DRIVE_AT_SPEED, node.drives.drive[1].limits);
    const laconic_real counts = motion().hinge_angle_rad[0] * -10 * 1000 / (laconic_real)6.283185307;
    const laconic_real off = (laconic_real)node.drives.drive[1].encoder.count - counts;
    TEST_ASSERT_TRUE(off <= (laconic_real)0.01 && off >= (laconic_real)-1.01); /* counts are whole, downwards */
}

/* A gear of −10 and 1,000 counts a turn: −500 counts are a twentieth of the axis's turn. */
static void turn_to_its_position(void) {
    node.drives.drive[1].target.mode = LACONIC_DRIVE_POSITION;
    node.drives.drive[1].target.position_count = -500;
    bench_pass_ms(6000);
    const laconic_real off = motion().hinge_angle_rad[0] - (laconic_real)0.3141592654;
    TEST_ASSERT_TRUE(off < (laconic_real)1e-3 && off > (laconic_real)-1e-3);
}

static void a_drive_brings_a_prescribed_axis_to_its_position(void) {
    start_drives(&prescribed);
    turn_to_its_position();
    node.drives.drive[1].target.mode = LACONIC_DRIVE_CURRENT; /* of which such an axis has none */
    bench_pass_ms(20);
    rate_is(0);
}

static void a_speed_that_is_no_number_is_a_fault_of_the_drive(void) {
    start_drives(&prescribed);
    node.drives.drive[1].settings.speed_limit_rad_per_s = 0;
    node.drives.drive[1].target.mode = LACONIC_DRIVE_SPEED;
    node.drives.drive[1].target.speed_rad_per_s = LACONIC_REAL_MAX * 2;
    bench_pass_ms(20);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_TARGET, node.drives.drive[1].faults);
    rate_is(0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_DRIVES, node.state);
}

static void a_drive_turns_a_motor_axis_by_its_torque(void) {
    start_drives(&motor);
    node.drives.drive[1].target.mode = LACONIC_DRIVE_CURRENT;
    node.drives.drive[1].target.current_A = 2;
    bench_pass_ms(10);
    TEST_ASSERT_TRUE(node.hinges.input[0].hinge_torque_Nm[0] == 2 * (laconic_real)0.1 * -10);
    bench_pass_ms(100);
    TEST_ASSERT_TRUE(motion().hinge_rate_rad_per_s[0] < (laconic_real)-0.1);
    TEST_ASSERT_TRUE(node.drives.drive[1].speed_rad_per_s > 1 && node.drives.drive[1].encoder.count > 0);
}

static void a_drive_turns_a_wheel_of_a_vehicle_with_hinges(void) {
    start_drives(&prescribed);
    node.drives.drive[0].target.mode = LACONIC_DRIVE_CURRENT;
    node.drives.drive[0].target.current_A = -5;
    node.drives.drive[1].target.mode = LACONIC_DRIVE_SPEED; /* on a curve each wheel rolls another way */
    node.drives.drive[1].target.speed_rad_per_s = 4;
    bench_pass_ms(500);
    const laconic_articulated_motion now = motion();
    TEST_ASSERT_TRUE(now.wheel_angle_rad[0] - now.wheel_angle_rad[2] > (laconic_real)0.002);
    TEST_ASSERT_TRUE(now.velocity_m_per_s[0] > (laconic_real)0.05);
    const laconic_real counts = now.wheel_angle_rad[2] * -10 * 1000 / (laconic_real)6.283185307;
    const laconic_real off = (laconic_real)node.drives.drive[0].encoder.count - counts;
    TEST_ASSERT_TRUE(off <= (laconic_real)0.1 && off >= (laconic_real)-1.1);
}

static void a_drive_on_an_axis_that_a_twist_leads_is_refused(void) {
    begin_with_drives(&coordinated);
    send_parameter(&ahead);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, commit());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_FIELD_DRIVE_NODE_ID, data[4]);
    TEST_ASSERT_EQUAL_UINT8(4, data[5]);
}

static void a_drive_beyond_the_last_hinge_is_refused(void) {
    const parameter fifth = INTEGER(DRIVE_NODE_ID, 5, 3);
    begin_with_drives(&prescribed);
    send_parameter(&fifth);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_ABOVE_LIMIT, commit());
    TEST_ASSERT_EQUAL_UINT8(5, data[5]);
}

static void no_brake_by_order_holds_a_vehicle_with_hinges_on_ideal_ground(void) {
    const parameter held = INTEGER(DRIVE_FAULTS, 4, LACONIC_DRIVE_ORDER_HELD);
    const parameter lost = INTEGER(DRIVE_FAULTS, 4, LACONIC_DRIVE_FAULT_ENCODER);
    start_drives(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, send_parameter(&held));
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&lost));
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_ENCODER, node.drives.drive[1].faults);
}

/* Nothing drives on after a step that was not taken. */
static void a_step_that_the_core_refuses_turns_the_drives_off(void) {
    start_drives(&prescribed);
    node.drives.drive[1].target.mode = LACONIC_DRIVE_SPEED;
    node.drives.drive[1].target.speed_rad_per_s = 3;
    bench_pass_ms(100);
    const laconic_articulated_state before = node.hinges.state;
    node.hinges.state.heading.turns = INT64_MAX; /* as if a bit had flipped */
    bench_pass_ms(20);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(before.hinge[0].fraction == node.hinges.state.hinge[0].fraction);
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_OFF, node.drives.drive[1].target.mode);
}

/* ------------------------------------------------------------------------ ground with friction -- */

static const parameter ground = NUMBER(GROUND_FRICTION_COEFFICIENT, 0, 0.3);
static const parameter forward = NUMBER(COM_X, 0, 0.6); /* the front wheel carries more than the others */

static void start_slipping_drives(const parameter *hinge) {
    begin_with_drives(hinge);
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&ground));
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&forward));
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_TRUE(node.hinges.slips);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
}

static void drives_move_a_vehicle_that_slips_as_the_core_with_their_torques(void) {
    laconic_tree_input held = {0};
    start_slipping_drives(&motor);
    laconic_tree_state wanted = node.hinges.tree;
    for (int k = 0; k < 2; k++) {
        node.drives.drive[k].target.mode = LACONIC_DRIVE_SPEED;
        node.drives.drive[k].target.speed_rad_per_s = -3;
        node.drives.drive[k].settings.speed_gain_As = (laconic_real)0.5;
    }
    for (int step = 0; step < 50; step++) {
        bench_pass_ms(10);
        held.hinged.base.axle_torque_Nm[2] = node.drives.drive[0].torque_Nm;
        held.hinged.hinge_torque_Nm[0] = node.drives.drive[1].torque_Nm;
        TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_tree_step(&node.hinges.tree_model, STEP_S, &wanted, &held, NULL));
        TEST_ASSERT_EQUAL_MEMORY(&wanted, &node.hinges.tree, sizeof wanted);
    }
    TEST_ASSERT_TRUE(motion().x_m > (laconic_real)0.005 && motion().hinge_angle_rad[0] > (laconic_real)0.01);
    TEST_ASSERT_TRUE(node.drives.drive[0].encoder.count < -100 && node.drives.drive[1].encoder.count < -10);
    TEST_ASSERT_TRUE(node.drives.drive[0].speed_rad_per_s == motion().wheel_speed_rad_per_s[2] * -10);
}

static void a_drive_turns_a_prescribed_axis_on_ground_with_friction(void) {
    start_slipping_drives(&prescribed);
    turn_to_its_position();
    const laconic_real missing = (laconic_real)node.drives.drive[1].encoder.count + 500;
    TEST_ASSERT_TRUE(missing >= -2 && missing <= 2);
}

static void a_drive_on_an_axis_that_a_servo_or_loop_leads_is_refused(void) {
    const parameter free = INTEGER(BODY_HINGE, 1, LACONIC_HINGE_FREE), servo = NUMBER(SERVO_GAIN, 1, 60);
    const parameter gain = NUMBER(HINGE_GAIN, 1, 0.5), loop = NUMBER(LOOP_RATE_GAIN, 1, 2);
    const parameter *kinds[] = {&free, &motor}, *leaders[] = {&servo, &loop};
    for (int k = 0; k < 2; k++) {
        begin_with_drives(kinds[k]);
        send_parameter(&ground);
        if (k == 1) send_parameter(&gain);
        send_parameter(leaders[k]);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, commit());
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_FIELD_DRIVE_NODE_ID, data[4]);
        TEST_ASSERT_EQUAL_UINT8(4, data[5]);
    }
}

static void order_held(uint8_t axis, bool is_held) {
    const parameter order = {LACONIC_WIRE_FIELD_DRIVE_FAULTS, axis, is_held ? LACONIC_DRIVE_ORDER_HELD : 0, true};
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&order));
}

static void a_brake_by_order_holds_a_wheel_that_the_ground_drags_and_lets_it_go(void) {
    start_slipping_drives(&motor);
    node.drives.drive[0].target.mode = LACONIC_DRIVE_CURRENT;
    node.drives.drive[0].target.current_A = -5;
    bench_pass_ms(1000);
    TEST_ASSERT_TRUE(motion().wheel_speed_rad_per_s[2] > 1);
    order_held(3, true);
    bench_pass_ms(20);
    TEST_ASSERT_TRUE(motion().wheel_speed_rad_per_s[2] == 0 && motion().velocity_m_per_s[0] > (laconic_real)0.05);
    TEST_ASSERT_TRUE(node.hinges.tree_model.wheel[2].dry_Nm == 0); /* the vehicle's own, between two steps */
    order_held(3, false);
    bench_pass_ms(1000);
    TEST_ASSERT_TRUE(motion().wheel_speed_rad_per_s[2] > 1);
}

static void a_brake_by_order_holds_a_steering_axis(void) {
    const parameter *hinges[] = {&motor, &prescribed};
    for (int k = 0; k < 2; k++) {
        bench_begin();
        start_slipping_drives(hinges[k]);
        order_held(4, true);
        node.drives.drive[1].target.mode = LACONIC_DRIVE_SPEED;
        node.drives.drive[1].target.speed_rad_per_s = 3;
        node.drives.drive[1].settings.speed_gain_As = 1;
        node.drives.drive[1].settings.stall_time_s = (laconic_real)0.5;
        bench_pass_ms(400);
        TEST_ASSERT_TRUE(motion().hinge_angle_rad[0] < (laconic_real)1e-9);
        TEST_ASSERT_TRUE(motion().hinge_angle_rad[0] > (laconic_real)-1e-9);
        order_held(4, false);
        bench_pass_ms(100);
        TEST_ASSERT_TRUE(motion().hinge_angle_rad[0] < (laconic_real)-1e-3);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_drive_turns_a_prescribed_axis_at_its_set_speed_within_its_limit);
    RUN_TEST(a_drive_brings_a_prescribed_axis_to_its_position);
    RUN_TEST(a_speed_that_is_no_number_is_a_fault_of_the_drive);
    RUN_TEST(a_drive_turns_a_motor_axis_by_its_torque);
    RUN_TEST(a_drive_turns_a_wheel_of_a_vehicle_with_hinges);
    RUN_TEST(a_drive_on_an_axis_that_a_twist_leads_is_refused);
    RUN_TEST(a_drive_beyond_the_last_hinge_is_refused);
    RUN_TEST(a_step_that_the_core_refuses_turns_the_drives_off);
    RUN_TEST(no_brake_by_order_holds_a_vehicle_with_hinges_on_ideal_ground);
    RUN_TEST(drives_move_a_vehicle_that_slips_as_the_core_with_their_torques);
    RUN_TEST(a_drive_turns_a_prescribed_axis_on_ground_with_friction);
    RUN_TEST(a_drive_on_an_axis_that_a_servo_or_loop_leads_is_refused);
    RUN_TEST(a_brake_by_order_holds_a_wheel_that_the_ground_drags_and_lets_it_go);
    RUN_TEST(a_brake_by_order_holds_a_steering_axis);
    return UNITY_END();
}
