/* Tests of drive.c: loops, limits, encoder and faults of one drive on a shaft with an inertia. */
#include "laconic_drives/drive.h"
#include "unity.h"

#define R(number) ((laconic_real)(number))
#define STEP_S R(0.001)

static laconic_wheel_drive drive;
static laconic_real wheel_rad_per_s, inertia_kgm2, load_Nm;

/* 10 A make 1 N m at the shaft and 10 N m at the wheel, whose inertia turns 1 N m into 10 rad/s². */
static const laconic_drive_settings settings = {.node_id = 1,
                                                .encoder_counts = 4096,
                                                .gear_ratio = 10,
                                                .torque_constant_Nm_per_A = R(0.1),
                                                .current_limit_A = 10,
                                                .position_gain_per_s = 10,
                                                .speed_gain_As = R(0.3),
                                                .speed_integral_gain_A = 3};

void setUp(void) {
    laconic_drive_start(&drive, &settings);
    wheel_rad_per_s = 0;
    inertia_kgm2 = R(0.1);
    load_Nm = 0;
}
void tearDown(void) {}

static laconic_real run(int steps) {
    laconic_real torque_Nm = 0;
    for (int k = 0; k < steps; k++) {
        torque_Nm = laconic_drive_act(&drive, STEP_S);
        const laconic_real before = wheel_rad_per_s;
        wheel_rad_per_s += STEP_S * (torque_Nm + load_Nm) / inertia_kgm2;
        laconic_drive_measure(&drive, STEP_S * (before + wheel_rad_per_s) / 2, wheel_rad_per_s);
    }
    return torque_Nm;
}

static void ask_speed(laconic_real speed_rad_per_s) {
    drive.target.mode = LACONIC_DRIVE_SPEED;
    drive.target.speed_rad_per_s = speed_rad_per_s;
}

static void a_drive_starts_off_and_lets_its_wheel_coast(void) {
    wheel_rad_per_s = 5;
    TEST_ASSERT_TRUE(run(100) == 0);
    TEST_ASSERT_TRUE(wheel_rad_per_s == 5 && drive.current_A == 0);
}

/* k_t n² k_v/J = 0.1 · 100 · 0.3/0.1 = 30 rad/s: after a tenth of a second three time constants have passed. */
static void the_speed_loop_steps_to_its_set_speed_within_its_bandwidth(void) {
    ask_speed(10);
    run(100);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(9) && drive.speed_rad_per_s < R(12));
    run(1000);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(9.999) && drive.speed_rad_per_s < R(10.001));
}

static void the_integral_holds_the_speed_against_a_load(void) {
    load_Nm = -4;
    ask_speed(10);
    run(3000);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(9.99) && drive.speed_rad_per_s < R(10.01));
    TEST_ASSERT_TRUE(drive.current_A > R(3.99) && drive.current_A < R(4.01));
}

static void the_current_limit_holds_exactly_in_every_mode(void) {
    drive.target.current_A = -1000;
    for (int mode = LACONIC_DRIVE_CURRENT; mode <= LACONIC_DRIVE_POSITION; mode++) {
        drive.target.mode = (laconic_drive_mode)mode;
        drive.target.position_count = -1000000;
        drive.target.speed_rad_per_s = -1000;
        laconic_drive_act(&drive, STEP_S);
        TEST_ASSERT_TRUE(drive.current_A == -10 && drive.limits & LACONIC_DRIVE_AT_CURRENT);
    }
}

static void the_speed_limit_holds_in_position_and_speed_control(void) {
    drive.settings.speed_limit_rad_per_s = 20;
    ask_speed(1000);
    run(2000);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(19.99) && drive.speed_rad_per_s < R(20.01));
    TEST_ASSERT_BITS(LACONIC_DRIVE_AT_SPEED, LACONIC_DRIVE_AT_SPEED, drive.limits);
    drive.target.mode = LACONIC_DRIVE_POSITION;
    drive.target.position_count = drive.encoder.count + 10000000;
    run(500);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(19.99) && drive.speed_rad_per_s < R(20.01));
}

/* 24 V through 2 Ω are 12 A at rest; at 120 rad/s the back-EMF of 12 V leaves 6 A, and braking is at its own limit. */
static void the_supply_limits_the_current_against_the_back_emf(void) {
    drive.settings.supply_V = 24;
    drive.settings.winding_resistance_ohm = 2;
    drive.settings.current_limit_A = 100;
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = 50;
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_TRUE(drive.current_A == 12);
    laconic_drive_measure(&drive, 0, 12);
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_TRUE(drive.current_A > R(5.9999) && drive.current_A < R(6.0001));
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_AT_SUPPLY, drive.limits);
    drive.settings.back_emf_Vs_per_rad = R(0.2); /* its own constant: 24 V at this speed */
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_TRUE(drive.current_A > R(-0.0001) && drive.current_A < R(0.0001));
}

static void beyond_its_no_load_speed_a_drive_can_only_brake(void) {
    drive.settings.supply_V = 24;
    drive.settings.winding_resistance_ohm = 2;
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = 5;
    laconic_drive_measure(&drive, 0, 30); /* the shaft at 300 rad/s: 30 V */
    TEST_ASSERT_TRUE(laconic_drive_act(&drive, STEP_S) < R(-2.9));
}

static void a_load_that_holds_the_wheel_winds_no_integral_up(void) {
    ask_speed(100);
    for (int k = 0; k < 5000; k++) laconic_drive_act(&drive, STEP_S); /* the wheel does not turn */
    ask_speed(0);
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_TRUE(drive.current_A < R(0.1) && drive.current_A > R(-0.1));
}

/* The integral takes up an error that leads back from the limit. */
static void a_limit_does_not_keep_the_integral_from_unwinding(void) {
    ask_speed(100);
    drive.target.current_A = 20; /* the feed-forward alone is twice the limit */
    drive.speed_rad_per_s = 102;
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_TRUE(drive.current_A == 10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -2 * 3 * 0.001, (double)drive.integral_A);
    ask_speed(104); /* what leads further beyond the limit is not taken up */
    laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -2 * 3 * 0.001, (double)drive.integral_A);
}

static void the_current_follows_with_its_bandwidth_and_never_overshoots(void) {
    drive.settings.current_bandwidth_rad_per_s = 100;
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = 5;
    for (int k = 0; k < 10; k++) laconic_drive_act(&drive, STEP_S); /* a time constant: 63 % */
    TEST_ASSERT_TRUE(drive.current_A > R(2.9) && drive.current_A < R(3.3));
    for (int k = 0; k < 200; k++) {
        laconic_drive_act(&drive, STEP_S);
        TEST_ASSERT_TRUE(drive.current_A <= 5);
    }
    TEST_ASSERT_TRUE(drive.current_A > R(4.999));
}

static void the_position_loop_goes_to_its_count_and_stays(void) {
    drive.target.mode = LACONIC_DRIVE_POSITION;
    drive.target.position_count = 4096;
    run(3000);
    TEST_ASSERT_INT_WITHIN(2, 4096, (int)drive.encoder.count);
    TEST_ASSERT_TRUE(wheel_rad_per_s < R(0.01) && wheel_rad_per_s > R(-0.01));
}

static void a_far_position_loses_no_count(void) {
    drive.encoder.count = (int64_t)1 << 60;
    drive.target.mode = LACONIC_DRIVE_POSITION;
    drive.target.position_count = drive.encoder.count + 1;
    run(3000);
    TEST_ASSERT_INT_WITHIN(1, 1, (int)(drive.encoder.count - ((int64_t)1 << 60)));
}

/* 2^24 steps of a tenth of a count would be lost in single precision if counts were one number. */
static void counts_keep_their_resolution_after_any_number_of_turns(void) {
    const laconic_real tenth_rad = R(0.1) * R(6.28318530717958647693) / (4096 * 10);
    drive.encoder.count = (int64_t)1 << 40;
    for (int k = 0; k < 1000; k++) laconic_drive_measure(&drive, tenth_rad, 0);
    TEST_ASSERT_INT_WITHIN(1, 100, (int)(drive.encoder.count - ((int64_t)1 << 40)));
    for (int k = 0; k < 2000; k++) laconic_drive_measure(&drive, -tenth_rad, 0);
    TEST_ASSERT_INT_WITHIN(1, -100, (int)(drive.encoder.count - ((int64_t)1 << 40)));
    TEST_ASSERT_TRUE(drive.encoder.rest >= 0 && drive.encoder.rest < 1);
}

static void a_tiny_turn_backwards_takes_a_whole_count_and_leaves_a_rest_below_one(void) {
    laconic_drive_measure(&drive, R(-1e-30), 0);
    TEST_ASSERT_TRUE(drive.encoder.rest >= 0 && drive.encoder.rest < 1);
    TEST_ASSERT_TRUE(drive.encoder.count == 0 || drive.encoder.count == -1);
}

static void the_place_within_a_turn_wraps_in_both_directions(void) {
    const int64_t counts[] = {0, 1, 4095, 4096, -1, -4096, -4097};
    const int32_t places[] = {0, 1, 4095, 0, 4095, 0, 4095};
    for (int k = 0; k < 7; k++) {
        drive.encoder.count = counts[k];
        TEST_ASSERT_EQUAL_INT32(places[k], laconic_drive_shaft_count(&drive));
    }
}

static void a_step_beyond_the_range_of_counts_is_a_fault_of_the_encoder(void) {
    laconic_drive_measure(&drive, R(1e9), 0);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_ENCODER, drive.faults);
    TEST_ASSERT_EQUAL_INT(0, (int)drive.encoder.count);
}

static void a_wheel_that_does_not_move_at_the_limit_is_a_stall_after_its_time(void) {
    drive.settings.stall_time_s = R(0.1);
    ask_speed(100);
    for (int k = 0; k < 99; k++) laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_EQUAL_UINT32(0, drive.faults);
    for (int k = 0; k < 4; k++) laconic_drive_act(&drive, STEP_S);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_STALL, drive.faults);
    TEST_ASSERT_TRUE(drive.target.mode == LACONIC_DRIVE_OFF && drive.current_A == 0);
}

static void a_wheel_that_accelerates_at_the_limit_is_no_stall(void) {
    drive.settings.stall_time_s = R(0.1);
    inertia_kgm2 = 100;
    ask_speed(100);
    run(1000);
    TEST_ASSERT_EQUAL_UINT32(0, drive.faults);
    TEST_ASSERT_BITS(LACONIC_DRIVE_AT_CURRENT, LACONIC_DRIVE_AT_CURRENT, drive.limits);
}

static void a_fault_keeps_the_drive_off_until_it_is_cleared_and_asked_again(void) {
    ask_speed(10);
    run(10);
    laconic_drive_fail(&drive, LACONIC_DRIVE_FAULT_TEMPERATURE);
    ask_speed(10);
    TEST_ASSERT_TRUE(run(10) == 0);
    laconic_drive_clear(&drive);
    TEST_ASSERT_TRUE(drive.faults == 0 && run(10) == 0);
    ask_speed(20);
    TEST_ASSERT_TRUE(run(1) > 0);
}

static void a_fault_whose_cause_remains_is_not_cleared(void) {
    laconic_drive_break(&drive, LACONIC_DRIVE_FAULT_TEMPERATURE);
    laconic_drive_clear(&drive);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_TEMPERATURE, drive.faults);
    laconic_drive_mend(&drive, LACONIC_DRIVE_FAULT_TEMPERATURE);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_TEMPERATURE, drive.faults);
    laconic_drive_clear(&drive);
    TEST_ASSERT_EQUAL_UINT32(0, drive.faults);
}

static void a_lost_encoder_shows_no_motion(void) {
    wheel_rad_per_s = 3;
    run(100);
    const int64_t count = drive.encoder.count;
    laconic_drive_break(&drive, LACONIC_DRIVE_FAULT_ENCODER);
    run(100);
    TEST_ASSERT_TRUE(drive.encoder.count == count && drive.speed_rad_per_s == 0);
    laconic_drive_mend(&drive, LACONIC_DRIVE_FAULT_ENCODER);
    run(100);
    TEST_ASSERT_TRUE(drive.encoder.count > count && drive.speed_rad_per_s == 30);
}

static void a_target_that_is_no_number_is_a_fault_and_never_a_torque(void) {
    const laconic_real zero = 0;
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = zero / zero;
    TEST_ASSERT_TRUE(laconic_drive_act(&drive, STEP_S) == 0);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_TARGET, drive.faults);
    laconic_drive_clear(&drive);
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = 1 / zero;
    TEST_ASSERT_TRUE(laconic_drive_act(&drive, STEP_S) == 10); /* beyond the limit */
}

static void a_reversed_gear_turns_the_shaft_against_the_wheel(void) {
    drive.settings.gear_ratio = -10;
    ask_speed(10);
    run(1000);
    TEST_ASSERT_TRUE(drive.speed_rad_per_s > R(9.9) && wheel_rad_per_s < R(-0.99) && drive.encoder.count > 0);
}

static void a_drive_that_is_cleared_is_off(void) {
    ask_speed(10);
    run(100);
    TEST_ASSERT_TRUE(drive.torque_Nm != 0 || drive.integral_A != 0);
    laconic_drive_clear(&drive);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, drive.target.mode);
    TEST_ASSERT_TRUE(drive.current_A == 0 && drive.torque_Nm == 0 && drive.integral_A == 0);
}

static void a_supply_limits_no_current_unless_the_resistance_is_known(void) {
    drive.target.mode = LACONIC_DRIVE_CURRENT;
    drive.target.current_A = 5;
    drive.settings.supply_V = 24;
    laconic_drive_measure(&drive, 0, 30); /* the shaft at 300 rad/s: 30 V */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 5, (double)laconic_drive_act(&drive, STEP_S));
    drive.settings.supply_V = 0;
    drive.settings.winding_resistance_ohm = 2;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 5, (double)laconic_drive_act(&drive, STEP_S));
    TEST_ASSERT_EQUAL_UINT8(0, drive.limits);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_drive_starts_off_and_lets_its_wheel_coast);
    RUN_TEST(the_speed_loop_steps_to_its_set_speed_within_its_bandwidth);
    RUN_TEST(the_integral_holds_the_speed_against_a_load);
    RUN_TEST(the_current_limit_holds_exactly_in_every_mode);
    RUN_TEST(the_speed_limit_holds_in_position_and_speed_control);
    RUN_TEST(the_supply_limits_the_current_against_the_back_emf);
    RUN_TEST(beyond_its_no_load_speed_a_drive_can_only_brake);
    RUN_TEST(a_load_that_holds_the_wheel_winds_no_integral_up);
    RUN_TEST(a_limit_does_not_keep_the_integral_from_unwinding);
    RUN_TEST(the_current_follows_with_its_bandwidth_and_never_overshoots);
    RUN_TEST(the_position_loop_goes_to_its_count_and_stays);
    RUN_TEST(a_far_position_loses_no_count);
    RUN_TEST(counts_keep_their_resolution_after_any_number_of_turns);
    RUN_TEST(a_tiny_turn_backwards_takes_a_whole_count_and_leaves_a_rest_below_one);
    RUN_TEST(the_place_within_a_turn_wraps_in_both_directions);
    RUN_TEST(a_step_beyond_the_range_of_counts_is_a_fault_of_the_encoder);
    RUN_TEST(a_wheel_that_does_not_move_at_the_limit_is_a_stall_after_its_time);
    RUN_TEST(a_wheel_that_accelerates_at_the_limit_is_no_stall);
    RUN_TEST(a_fault_keeps_the_drive_off_until_it_is_cleared_and_asked_again);
    RUN_TEST(a_fault_whose_cause_remains_is_not_cleared);
    RUN_TEST(a_lost_encoder_shows_no_motion);
    RUN_TEST(a_target_that_is_no_number_is_a_fault_and_never_a_torque);
    RUN_TEST(a_reversed_gear_turns_the_shaft_against_the_wheel);
    RUN_TEST(a_drive_that_is_cleared_is_off);
    RUN_TEST(a_supply_limits_no_current_unless_the_resistance_is_known);
    return UNITY_END();
}
