/* Tests of firmware_stub/drives/odrive: numbers at and beyond their bounds, and what each message leaves alone. */
#include "odrive_bench.h"

#define TURN_RAD ((laconic_real)6.28318530717958647693)

static const float none = (float)(1e300 * 1e10 * 0), endless = (float)(1e300 * 1e10);

void setUp(void) { bench_begin(&laconic_odrive, NODE, 1); }
void tearDown(void) {}

static laconic_real asked_speed(void) { return drives.drive[0].target.speed_rad_per_s / TURN_RAD; }

static void go_to(float turns, int16_t speed, int16_t torque) {
    const struct {
        float turns;
        int16_t speed, torque;
    } input = {turns, speed, torque};
    bench_send(id(INPUT_POS), &input, 8);
}

/* --- limits ------------------------------------------------------------------------------------------------------ */

static void a_scenes_speed_limit_is_that_of_the_axis(void) {
    drives.drive[0].settings.speed_limit_rad_per_s = 2 * TURN_RAD;
    drives.protocol->start(&drives, now_us);
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(INPUT_VEL, 5, 0);
    bench_step();
    near(2, asked_speed(), 1e-5);
    drives.drive[0].speed_rad_per_s = (laconic_real)2.3 * TURN_RAD;
    is_in(CLOSED_LOOP, BUSY);
    drives.drive[0].speed_rad_per_s = (laconic_real)2.5 * TURN_RAD; /* beyond 1.2 of it */
    is_in(IDLE, DISARMED);
}

static void a_shaft_that_is_dragged_backwards_beyond_its_limit_disarms(void) {
    send_floats(LIMITS, 1, 20);
    close_loop(VELOCITY, PASSTHROUGH);
    drives.drive[0].speed_rad_per_s = (laconic_real)-1.1 * TURN_RAD;
    is_in(CLOSED_LOOP, BUSY);
    drives.drive[0].speed_rad_per_s = (laconic_real)-1.3 * TURN_RAD;
    is_in(IDLE, DISARMED);
    TEST_ASSERT_EQUAL_HEX32(0x8000, ask_word(GET_ERROR, 4));
}

static void an_infinite_speed_is_no_limit(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(LIMITS, 1, 20);
    send_floats(LIMITS, endless, 20);
    send_floats(INPUT_VEL, 5, 0);
    bench_steps(2000);
    near(5, speed(), 0.01);
    TEST_ASSERT_TRUE(drives.drive[0].settings.speed_limit_rad_per_s == 0);
    is_in(CLOSED_LOOP, BUSY);
}

static void a_speed_limit_of_0_holds_the_shaft(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(LIMITS, 0, 20);
    send_floats(INPUT_VEL, 5, 0);
    bench_steps(100);
    TEST_ASSERT_TRUE(speed() == 0);
    is_in(CLOSED_LOOP, BUSY);
    TEST_ASSERT_TRUE(drives.drive[0].settings.speed_limit_rad_per_s > 0); /* 0 would be none there */
}

static void limits_that_are_none_or_negative_change_neither(void) {
    static const float wrong[][2] = {{1, -1}, {-1, 1}};
    const laconic_drive_settings before = drives.drive[0].settings;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) send_floats(LIMITS, wrong[k][0], wrong[k][1]);
    send_floats(LIMITS, 1, none);
    TEST_ASSERT_EQUAL_MEMORY(&before, &drives.drive[0].settings, sizeof before);
}

static void a_saved_current_limit_is_not_the_most_that_the_drive_has(void) {
    send_floats(LIMITS, 5, 3);
    bench_send(id(REBOOT), "\1", 1); /* saves */
    near(3, drives.drive[0].settings.current_limit_A, 1e-6);
    send_floats(LIMITS, 5, 10);
    near(10, drives.drive[0].settings.current_limit_A, 1e-6);
    send_floats(LIMITS, 5, 1000);
    near(20, drives.drive[0].settings.current_limit_A, 1e-6); /* the scene's */
}

static void torque_control_keeps_the_speed_limit_both_ways(void) {
    close_loop(TORQUE, PASSTHROUGH);
    send_floats(LIMITS, 1, 20);
    for (int side = -1; side <= 1; side += 2) {
        send_floats(INPUT_TORQUE, (float)side * 0.5F, 0);
        bench_step();
        near(0.5 * side, drives.drive[0].torque_Nm, 1e-6);
        bench_steps(5000);
        near(side, speed(), 0.001);
    }
    is_in(CLOSED_LOOP, BUSY);
}

static void without_a_gain_of_the_speed_nothing_holds_a_torque_back(void) {
    close_loop(TORQUE, PASSTHROUGH);
    send_floats(LIMITS, 1, 20);
    send_floats(INPUT_TORQUE, 0.1F, 0);
    drives.drive[0].speed_rad_per_s = (laconic_real)1.1 * TURN_RAD;
    drives.protocol->on_step(&drives, now_us += 1000);
    TEST_ASSERT_TRUE(drives.drive[0].target.current_A < 0); /* the gain of the speed loop slows it down */
    send_floats(SET_VEL_GAINS, 0, 0);
    drives.protocol->on_step(&drives, now_us += 1000);
    near(2, drives.drive[0].target.current_A, 1e-5);
}

/* --- numbers ----------------------------------------------------------------------------------------------------- */

static void numbers_beyond_any_shaft_are_taken_as_a_million(void) {
    const float huge = 1e9F;
    bench_send(id(SET_POS_GAIN), &huge, 4);
    TEST_ASSERT_TRUE(drives.drive[0].settings.position_gain_per_s == 1000000);
}

static void two_numbers_are_taken_both_or_none(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(INPUT_VEL, 2, 0.25F);
    send_floats(INPUT_VEL, 3, none);
    send_floats(INPUT_VEL, none, 0.5F);
    bench_step();
    near(2, asked_speed(), 1e-6);
    near(0.25 / 0.05, drives.drive[0].target.current_A, 1e-5);
}

static void feed_forwards_of_a_position_are_thousandths(void) {
    close_loop(POSITION, PASSTHROUGH);
    go_to(0, 1500, -250);
    bench_step();
    near(1.5, asked_speed(), 1e-5);
    near(-0.25 / 0.05, drives.drive[0].target.current_A, 1e-5);
}

static void a_shaft_with_inertia_gets_its_torque_while_it_speeds_up(void) {
    const float inertia = 0.05F;
    bench_send(id(0x13), &inertia, 4);
    close_loop(VELOCITY, VEL_RAMP);
    send_floats(INPUT_VEL, 3, 0);
    bench_step();
    near(0.05 / 0.05, drives.drive[0].target.current_A, 1e-3); /* 1 turn/s² */
}

static void without_a_supply_the_bus_has_neither_voltage_nor_current(void) {
    close_loop(TORQUE, PASSTHROUGH);
    send_floats(INPUT_TORQUE, 0.5F, 0);
    bench_step();
    const laconic_wheel_drive *drive = &drives.drive[0];
    const double power_W = (0.05 * (double)drive->speed_rad_per_s + 0.1 * 10) * 10;
    near(24, bench_float(ask(0x17)), 1e-5);
    near(power_W / 24, bench_float(frame.data + 4), 1e-5);
    drives.drive[0].settings.supply_V = 0;
    near(0, bench_float(ask(0x17)), 0);
    near(0, bench_float(frame.data + 4), 0);
}

/* --- states and modes -------------------------------------------------------------------------------------------- */

static void inactive_input_leaves_the_set_points(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    send_floats(INPUT_VEL, 2, 0);
    bench_step();
    send_words(SET_MODE, VELOCITY, 0);
    send_floats(INPUT_VEL, 5, 0);
    is_in(CLOSED_LOOP, BUSY);
    near(2, asked_speed(), 1e-6);
}

static void a_long_step_takes_the_filter_slower_and_stays_stable(void) {
    drives.step_s = (laconic_real)0.25;
    close_loop(POSITION, POS_FILTER);
    go_to(1, 0, 0);
    for (int32_t k = 0; k < 200; k++) {
        const int64_t before = drives.drive[0].target.position_count;
        drives.protocol->on_step(&drives, now_us += 250000);
        if (k == 0) TEST_ASSERT_EQUAL_INT64(BENCH_COUNTS / 16, drives.drive[0].target.position_count);
        TEST_ASSERT_TRUE(drives.drive[0].target.position_count >= before);
        TEST_ASSERT_TRUE(drives.drive[0].target.position_count <= BENCH_COUNTS);
    }
    TEST_ASSERT_INT_WITHIN(1, BENCH_COUNTS, (int)drives.drive[0].target.position_count);
}

static void a_place_to_go_to_starts_no_trajectory_but_in_closed_loop(void) {
    send_words(SET_MODE, POSITION, TRAP_TRAJ);
    go_to(5, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(1, ask(HEARTBEAT)[6]); /* done: none runs */
    close_loop(POSITION, PASSTHROUGH);
    go_to(0, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(1, ask(HEARTBEAT)[6]);
}

static void clearing_errors_leaves_a_running_axis_alone(void) {
    close_loop(VELOCITY, PASSTHROUGH);
    bench_send(id(CLEAR_ERRORS), "\0", 1);
    is_in(CLOSED_LOOP, BUSY);
}

static void idle_of_an_idle_axis_is_a_success(void) {
    send_words(SET_STATE, 99, 0);
    is_in(IDLE, INVALID_STATE);
    send_words(SET_STATE, IDLE, 0);
    is_in(IDLE, SUCCESS);
}

static void a_reboot_without_a_byte_is_a_plain_one(void) {
    const float gain = 7;
    const laconic_real before = drives.drive[0].settings.position_gain_per_s;
    close_loop(VELOCITY, PASSTHROUGH);
    bench_send(id(SET_POS_GAIN), &gain, 4);
    bench_send(id(REBOOT), NULL, 0);
    is_in(IDLE, SUCCESS);
    TEST_ASSERT_TRUE(drives.drive[0].settings.position_gain_per_s == before);
}

static void a_serial_number_that_differs_in_its_high_half_is_another_drive(void) {
    uint8_t data[8];
    memcpy(data, ask(ADDRESS), 8);
    data[0] = 20;
    data[5] ^= 1;
    bench_send(0x3F << 5 | ADDRESS, data, 7);
    TEST_ASSERT_EQUAL_UINT8(NODE, ask(ADDRESS)[0]);
}

static void messages_that_came_too_late_are_not_made_up_for(void) {
    bench_steps(50);
    now_us += 349000;
    int32_t heartbeats = 0;
    for (int32_t k = 0; k < 100; k++) {
        bench_step();
        while (drives.protocol->next_frame(&drives, &frame)) heartbeats += frame.id == id(HEARTBEAT);
        TEST_ASSERT_EQUAL_INT32(1, heartbeats);
    }
    bench_step();
    TEST_ASSERT_TRUE(bench_receive(id(HEARTBEAT), &frame)); /* 100 ms after the late one */
}

static void a_speed_ramp_takes_its_torque_from_inertia_alone(void) {
    close_loop(VELOCITY, VEL_RAMP);
    send_floats(INPUT_VEL, 3, 0.5F);
    bench_steps(100);
    near(0, drives.drive[0].target.current_A, 0);
}

static void each_message_has_its_numbers(void) {
    static const uint8_t address[7] = {NODE, 0, 0, 0x6F, 0x63, 0x61, 0x4C};
    laconic_wheel_drive *drive = &drives.drive[0];
    drive->current_A = 4;
    drive->speed_rad_per_s = 100;
    for (int k = 0; k < 2; k++) {
        near(4, bench_float(ask(0x14) + 4 * k), 1e-6);
        near(25, bench_float(ask(0x15) + 4 * k), 0);
        near(4 * 0.05, bench_float(ask(0x1C) + 4 * k), 1e-6);
    }
    near((0.05 * 100 + 0.1 * 4) * 4, bench_float(ask(0x1D)), 1e-5);
    near(0.05 * 100 * 4, bench_float(frame.data + 4), 1e-5);
    near(100 / (double)TURN_RAD, bench_float(ask(ESTIMATES) + 4), 1e-5);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(address, ask(ADDRESS), 7);
}

static void a_trajectory_that_is_not_told_otherwise_has_the_defaults_of_0_5_6(void) {
    close_loop(POSITION, TRAP_TRAJ);
    go_to(100, 0, 0);
    bench_steps(1000);
    near(0.5, asked_speed(), 0.01);
    bench_steps(4000);
    near(2, asked_speed(), 1e-5);
}

static void a_procedure_takes_200_milliseconds(void) {
    send_words(SET_STATE, 3, 0);
    drives.protocol->on_step(&drives, now_us + 199999);
    TEST_ASSERT_EQUAL_UINT8(3, ask(HEARTBEAT)[4]);
    drives.protocol->on_step(&drives, now_us + 200000);
    TEST_ASSERT_EQUAL_UINT8(IDLE, ask(HEARTBEAT)[4]);
}

static void the_watchdog_is_exact_and_fed_by_any_message(void) {
    drives.watchdog_s = (laconic_real)0.0625;
    close_loop(VELOCITY, PASSTHROUGH);
    now_us += 62000;
    bench_send(id(ENTER_DFU), NULL, 0);
    drives.protocol->on_step(&drives, now_us + 62500);
    TEST_ASSERT_TRUE(drives.drive[0].faults == 0);
    drives.protocol->on_step(&drives, now_us + 62501);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_WATCHDOG, drives.drive[0].faults);
}

static void an_axis_that_was_idle_when_it_erred_does_not_arm(void) {
    bench_send(id(ESTOP), NULL, 0);
    is_in(IDLE, SUCCESS);
    TEST_ASSERT_EQUAL_HEX32(0, ask_word(GET_ERROR, 4)); /* nothing was disarmed */
    send_words(SET_STATE, CLOSED_LOOP, 0);
    is_in(IDLE, DISARMED);
}

static void a_filtered_place_gets_the_torque_of_its_acceleration(void) {
    const float inertia = 0.05F;
    bench_send(id(0x13), &inertia, 4);
    close_loop(POSITION, POS_FILTER);
    go_to(1, 0, 0);
    bench_step();
    near(4 * 0.05 / 0.05, drives.drive[0].target.current_A, 1e-4); /* 4/s² for a turn, by the bandwidth of 2/s */
    near(4 * 0.001, asked_speed(), 1e-6);
}

static void a_trajectory_has_the_torque_of_its_acceleration_until_it_is_done(void) {
    const float inertia = 0.05F;
    bench_send(id(0x13), &inertia, 4);
    close_loop(POSITION, TRAP_TRAJ);
    go_to(1, 0, 0);
    bench_step();
    near(0.5 * 0.05 / 0.05, drives.drive[0].target.current_A, 1e-3);
    for (int k = 0; k < 5000 && ask(HEARTBEAT)[6] == 0; k++) bench_step();
    near(0, drives.drive[0].target.current_A, 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_scenes_speed_limit_is_that_of_the_axis);
    RUN_TEST(a_shaft_that_is_dragged_backwards_beyond_its_limit_disarms);
    RUN_TEST(an_infinite_speed_is_no_limit);
    RUN_TEST(a_speed_limit_of_0_holds_the_shaft);
    RUN_TEST(limits_that_are_none_or_negative_change_neither);
    RUN_TEST(a_saved_current_limit_is_not_the_most_that_the_drive_has);
    RUN_TEST(torque_control_keeps_the_speed_limit_both_ways);
    RUN_TEST(without_a_gain_of_the_speed_nothing_holds_a_torque_back);
    RUN_TEST(numbers_beyond_any_shaft_are_taken_as_a_million);
    RUN_TEST(two_numbers_are_taken_both_or_none);
    RUN_TEST(feed_forwards_of_a_position_are_thousandths);
    RUN_TEST(a_shaft_with_inertia_gets_its_torque_while_it_speeds_up);
    RUN_TEST(without_a_supply_the_bus_has_neither_voltage_nor_current);
    RUN_TEST(inactive_input_leaves_the_set_points);
    RUN_TEST(a_long_step_takes_the_filter_slower_and_stays_stable);
    RUN_TEST(a_place_to_go_to_starts_no_trajectory_but_in_closed_loop);
    RUN_TEST(clearing_errors_leaves_a_running_axis_alone);
    RUN_TEST(idle_of_an_idle_axis_is_a_success);
    RUN_TEST(a_reboot_without_a_byte_is_a_plain_one);
    RUN_TEST(a_serial_number_that_differs_in_its_high_half_is_another_drive);
    RUN_TEST(messages_that_came_too_late_are_not_made_up_for);
    RUN_TEST(a_speed_ramp_takes_its_torque_from_inertia_alone);
    RUN_TEST(each_message_has_its_numbers);
    RUN_TEST(a_trajectory_that_is_not_told_otherwise_has_the_defaults_of_0_5_6);
    RUN_TEST(a_procedure_takes_200_milliseconds);
    RUN_TEST(the_watchdog_is_exact_and_fed_by_any_message);
    RUN_TEST(an_axis_that_was_idle_when_it_erred_does_not_arm);
    RUN_TEST(a_filtered_place_gets_the_torque_of_its_acceleration);
    RUN_TEST(a_trajectory_has_the_torque_of_its_acceleration_until_it_is_done);
    return UNITY_END();
}
