/* Tests of firmware_stub/drives/moteus: limits, defaults and what each mode leaves alone. */
#include "moteus_bench.h"

#define TURN_RAD ((laconic_real)6.28318530717958647693)

void setUp(void) { bench_begin(&laconic_moteus, NODE, GEAR); }
void tearDown(void) {}

/* A position mode that waits for no other command; registers follow. */
static void begin_position(laconic_real position, laconic_real velocity) {
    put_mode(POSITION);
    put_float(0x20, position);
    put_float(0x21, velocity);
    put_float(0x27, none);
}

static laconic_real control_position(void) { return read_float(0x38); }

/* --- defaults and limits ----------------------------------------------------------------------------------------- */

static void the_scenes_speed_limit_is_the_fastest(void) {
    drives.drive[0].settings.speed_limit_rad_per_s = GEAR * TURN_RAD / 2;
    hold(none, 2, 2000);
    near(0.5, read_float(0x39), 1e-5);
    near(0.5, read_float(0x02), 0.01);
    hold(none, -2, 2000);
    near(-0.5, read_float(0x39), 1e-5);
}

static void a_velocity_that_is_not_set_is_0(void) {
    begin_position(none, none);
    send();
    bench_steps(100);
    near(0, read_float(0x39), 0);
    near(0, read_float(0x02), 1e-6);
}

static void without_an_acceleration_limit_it_glides_at_the_limit_of_the_speed(void) {
    for (int side = -1; side <= 1; side += 2) {
        bench_begin(&laconic_moteus, NODE, GEAR);
        begin_position((laconic_real)side, 0);
        put_float(0x28, (laconic_real)0.5);
        put_float(0x29, -1);
        send();
        bench_step();
        near(0.5 * side, read_float(0x39), 1e-6);
        near(0.0005 * side, control_position(), 1e-6);
        bench_steps(999);
        near(0.5 * side, control_position(), 1e-4);
        near(0, read_float(0x0B), 0);
        bench_steps(1001);
        near(side, control_position(), 1e-6);
        near(0, read_float(0x39), 0);
        near(1, read_float(0x0B), 0); /* the trajectory is complete */
    }
}

/* By half the acceleration times the square of the time, step by step: its mean speed, not that of a step's end. */
static void a_speed_that_rises_moves_the_place_by_its_mean(void) {
    begin_position(none, 1);
    put_float(0x29, 2);
    send();
    for (int k = 1; k <= 400; k++) {
        bench_steps(1);
        const double time_s = 0.001 * k;
        near(2 * time_s, read_float(0x39), 1e-5);
        near(time_s * time_s, control_position(), 1e-5);
    }
}

static void a_gliding_target_that_moves_goes_on_with_its_speed(void) {
    begin_position((laconic_real)0.5, (laconic_real)0.25);
    put_float(0x28, (laconic_real)0.5);
    put_float(0x29, -1);
    send();
    bench_steps(3000); /* met at 2 s: 0.5 + 0.25·2 = 0.5·2 */
    near(0.5 + 0.25 * 3, control_position(), 0.002);
    near(0.25, read_float(0x39), 1e-6);
}

static void a_stop_position_turns_the_speed_to_its_side(void) {
    begin_position(none, (laconic_real)0.5);
    put_float(0x26, (laconic_real)-0.25);
    put_float(0x29, -1);
    send();
    bench_steps(200);
    near(-0.5, read_float(0x39), 1e-6);
    bench_steps(2000);
    near(-0.25, control_position(), 1e-5);
    near(0, read_float(0x39), 0);
}

static void without_speed_a_stop_position_moves_nothing(void) {
    for (int side = -1; side <= 1; side += 2) {
        begin_position(none, 0);
        put_float(0x26, (laconic_real)(side * 0.25));
        put_float(0x29, -1);
        send();
        bench_steps(100);
        near(0, control_position(), 1e-6);
        near(0, read_float(0x01), 1e-6);
    }
}

static void a_stop_position_with_a_limit_of_the_speed_alone_is_fault_45_too(void) {
    begin_position(none, (laconic_real)0.5);
    put_float(0x26, 1);
    put_float(0x28, 1);
    put_float(0x29, -1);
    send();
    near(FAULT, read_float(0x00), 0);
    near(45, read_float(0x0F), 0);
}

/* --- modes ------------------------------------------------------------------------------------------------------- */

static void modes_of_the_firmwares_own_are_no_commands(void) {
    hold(none, (laconic_real)0.5, 40);
    for (uint8_t mode = 1; mode <= 4; mode++) {
        put_mode(mode); /* fault, enabling, calibrating twice */
        put_float(0x21, 5);
        send();
        bench_steps(1);
        near(POSITION, read_float(0x00), 0);
        near(0.5, read_float(0x39), 1e-5);
    }
}

static void a_fault_is_left_by_stopped_alone(void) {
    hold(none, 1, 5);
    laconic_drive_fail(&drives.drive[0], LACONIC_DRIVE_FAULT_SUPPLY);
    bench_steps(1);
    hold(none, 1, 100);
    near(FAULT, read_float(0x00), 0);
    near(40, read_float(0x0F), 0);
    TEST_ASSERT_TRUE(drives.drive[0].torque_Nm == 0);
    put_mode(STOPPED);
    send();
    hold(none, 1, 5);
    near(POSITION, read_float(0x00), 0);
}

static void a_current_that_is_no_number_is_none(void) {
    put_mode(CURRENT);
    put_float(0x1C, none);
    send();
    bench_step();
    TEST_ASSERT_TRUE(drives.drive[0].current_A == 0 && drives.drive[0].faults == 0);
    near(CURRENT, read_float(0x00), 0);
}

static void stay_within_pulls_back_from_its_upper_bound(void) {
    put_mode(STAY_WITHIN);
    put_float(0x40, none);
    put_float(0x41, (laconic_real)-0.5);
    put_float(0x46, none);
    send();
    bench_steps(1);
    near(-0.5, control_position(), 1e-6);
    TEST_ASSERT_TRUE(drives.drive[0].torque_Nm < 0);
    bench_steps(3000);
    near(-0.5, read_float(0x01), 0.02);
}

static void silence_ends_stay_within_too(void) {
    put_mode(STAY_WITHIN);
    put_float(0x40, -1);
    put_float(0x41, 1);
    send();
    bench_steps(90);
    near(STAY_WITHIN, read_float(0x00), 0);
    bench_steps(20);
    near(TIMEOUT, read_float(0x00), 0);
    TEST_ASSERT_TRUE(drives.drive[0].unheard);
}

/* The wheel turns at 1 turn/s, where damping alone would take 10 N m. */
static void in_the_timeout_the_torque_is_5_newton_metres_at_most_whatever_was_commanded(void) {
    static const laconic_real most_Nm[] = {(laconic_real)0.02, 50, 0};
    for (int k = 0; k < 3; k++) {
        bench_begin(&laconic_moteus, NODE, GEAR);
        begin_position(none, 0);
        if (k < 2) put_float(0x25, most_Nm[k]);
        put_float(0x27, (laconic_real)0.002);
        send();
        bench_steps(5);
        near(TIMEOUT, read_float(0x00), 0);
        bench_speed[0] = TURN_RAD;
        laconic_drive_measure(&drives.drive[0], 0, bench_speed[0]);
        drives.protocol->on_step(&drives, now_us);
        near(-5, read_float(0x34), 1e-5);
    }
}

static void a_brake_is_the_back_emf_through_the_winding(void) {
    put_mode(BRAKE);
    send();
    drives.drive[0].speed_rad_per_s = 10;
    bench_step();
    near(-10 * 0.05 / 0.1, drives.drive[0].current_A, 1e-5);
    drives.drive[0].settings.winding_resistance_ohm = 0; /* not known */
    drives.drive[0].speed_rad_per_s = 10;
    bench_step();
    near(0, drives.drive[0].current_A, 0);
}

static void a_register_says_what_limits_the_current(void) {
    put_mode(CURRENT);
    put_float(0x1C, 30);
    send();
    bench_step();
    near(99, read_float(0x0F), 0); /* 20 A */
    drives.drive[0].speed_rad_per_s = 470;
    bench_step();
    near((24 - 470 * 0.05) / 0.1, drives.drive[0].current_A, 1e-3);
    near(98, read_float(0x0F), 0);
}

/* --- places ------------------------------------------------------------------------------------------------------ */

static void an_index_that_is_required_anew_makes_this_place_0(void) {
    hold(none, 1, 1000);
    TEST_ASSERT_TRUE(read_float(0x01) > (laconic_real)0.5);
    bench_send(TO_NODE, "\x0D\xB1\x02\x00\x00\x80\x42", 7); /* 64 turns */
    bench_drop_frames();
    near(2, read_float(0x0C), 0);
    bench_send(TO_NODE, "\x01\xB2\x02\x01", 4);
    bench_drop_frames();
    near(0, read_float(0x01), 0);
    near(1, read_float(0x0C), 0);
}

static void an_output_that_is_no_number_stays(void) {
    hold(none, 1, 500);
    const laconic_real before = read_float(0x01);
    bench_send(TO_NODE, "\x0D\xB1\x02\x00\x00\xC0\x7F", 7);
    bench_send(TO_NODE, "\x0D\xB0\x02\x00\x00\xC0\x7F", 7);
    bench_drop_frames();
    TEST_ASSERT_TRUE(read_float(0x01) == before);
    near(1, read_float(0x0C), 0);
}

static void the_nearest_place_is_found_on_both_sides(void) {
    drives.drive[0].encoder.count = BENCH_COUNTS / 8; /* a share of 1/8 of the shaft's turn, 1/32 of the output's */
    static const struct {
        float asked, given;
    } rows[] = {{1.0F, 1.03125F}, {-1.0F, -0.96875F}, {-1.1F, -0.96875F - 0.25F}, {1.15F, 1.03125F}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        drives.protocol->start(&drives, now_us);
        drives.drive[0].encoder.count += BENCH_COUNTS / 8;
        put("\x0D\xB0\x02", 3);
        put(&rows[k].asked, 4);
        send();
        bench_drop_frames();
        near(rows[k].given, read_float(0x01), 1e-6);
    }
}

static void capturing_anew_begins_where_the_wheel_is(void) {
    begin_position(none, 0);
    send();
    bench_steps(10);
    drives.drive[0].encoder.count += GEAR * BENCH_COUNTS / 100; /* dragged by a hundredth of a turn */
    bench_send(TO_NODE, "\x01\xB3\x02\x01", 4);
    bench_drop_frames();
    TEST_ASSERT_TRUE(control_position() != control_position()); /* none until the next step */
    drives.protocol->on_step(&drives, now_us += 1000);
    near(0.01, control_position(), 1e-3);
    near(0, drives.drive[0].target.current_A, 1e-3);
}

static void within_its_bounds_a_place_has_no_error(void) {
    put_mode(STAY_WITHIN);
    put_float(0x40, -1);
    put_float(0x41, 1);
    put_float(0x42, (laconic_real)0.125);
    put_float(0x46, none);
    send();
    bench_steps(200);
    TEST_ASSERT_TRUE(read_float(0x01) != 0);
    drives.protocol->on_step(&drives, now_us += 1000);
    near(0, read_float(0x3B), 0);
    near(0.125, read_float(0x34), 1e-6); /* the feed-forward alone */
    TEST_ASSERT_TRUE(control_position() != control_position());
}

static void a_slow_motion_stops_at_its_stop_position(void) {
    begin_position(none, (laconic_real)0.01);
    put_float(0x26, (laconic_real)0.005);
    put_float(0x29, -1);
    send();
    for (int k = 0; k < 600; k++) {
        bench_steps(1);
        TEST_ASSERT_TRUE(control_position() <= (laconic_real)0.00502);
    }
    near(0.005, control_position(), 1e-6);
    near(0, read_float(0x39), 0);
}

static void a_way_of_whole_steps_ends_with_the_last_of_them(void) {
    const laconic_real counts = GEAR * BENCH_COUNTS;
    begin_position(4 / counts, 0);
    put_float(0x28, 2000 / counts); /* two counts a step */
    put_float(0x29, -1);
    send();
    bench_step();
    near(0, read_float(0x0B), 0);
    bench_step();
    near(1, read_float(0x0B), 0);
    near(0, read_float(0x39), 0);
}

static void a_mode_begins_a_command_from_its_defaults(void) {
    begin_position(none, (laconic_real)0.5);
    put_float(0x23, (laconic_real)0.25);
    put_float(0x25, 1);
    send();
    near(0.25, read_float(0x23), 0);
    put_mode(POSITION);
    send();
    near(1, read_float(0x23), 0);
    near(0, read_float(0x20), 0);
    near(0, read_float(0x21), 0);
    near(0, read_float(0x27), 0);
    TEST_ASSERT_TRUE(read_float(0x25) != read_float(0x25));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_scenes_speed_limit_is_the_fastest);
    RUN_TEST(a_velocity_that_is_not_set_is_0);
    RUN_TEST(without_an_acceleration_limit_it_glides_at_the_limit_of_the_speed);
    RUN_TEST(a_speed_that_rises_moves_the_place_by_its_mean);
    RUN_TEST(a_gliding_target_that_moves_goes_on_with_its_speed);
    RUN_TEST(a_stop_position_turns_the_speed_to_its_side);
    RUN_TEST(without_speed_a_stop_position_moves_nothing);
    RUN_TEST(a_stop_position_with_a_limit_of_the_speed_alone_is_fault_45_too);
    RUN_TEST(modes_of_the_firmwares_own_are_no_commands);
    RUN_TEST(a_fault_is_left_by_stopped_alone);
    RUN_TEST(a_current_that_is_no_number_is_none);
    RUN_TEST(stay_within_pulls_back_from_its_upper_bound);
    RUN_TEST(silence_ends_stay_within_too);
    RUN_TEST(in_the_timeout_the_torque_is_5_newton_metres_at_most_whatever_was_commanded);
    RUN_TEST(a_brake_is_the_back_emf_through_the_winding);
    RUN_TEST(a_register_says_what_limits_the_current);
    RUN_TEST(an_index_that_is_required_anew_makes_this_place_0);
    RUN_TEST(an_output_that_is_no_number_stays);
    RUN_TEST(the_nearest_place_is_found_on_both_sides);
    RUN_TEST(capturing_anew_begins_where_the_wheel_is);
    RUN_TEST(within_its_bounds_a_place_has_no_error);
    RUN_TEST(a_slow_motion_stops_at_its_stop_position);
    RUN_TEST(a_way_of_whole_steps_ends_with_the_last_of_them);
    RUN_TEST(a_mode_begins_a_command_from_its_defaults);
    return UNITY_END();
}
