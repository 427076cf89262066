/* Tests of motion.c: each mode of operation, in counts and counts/s, and following errors. */
#include "canopen_bench.h"

void setUp(void) { power_up(); }
void tearDown(void) {}

static void profile_velocity_ramps_up_and_down_and_turns_back(void) {
    set(0x6083, 0, 50000);
    set(0x6084, 0, 100000);
    enable(3);
    set(0x60FF, 0, 10000);
    step(100);
    TEST_ASSERT_INT_WITHIN(60, 5000, get(0x606B, 0));
    TEST_ASSERT_BITS_LOW(1024, statusword());
    step(300);
    TEST_ASSERT_EQUAL(10000, get(0x606B, 0));
    TEST_ASSERT_INT_WITHIN(100, 10000, get(0x606C, 0));
    TEST_ASSERT_BITS_HIGH(1024, statusword());
    TEST_ASSERT_BITS_LOW(4096, statusword());
    set(0x60FF, 0, -10000);
    step(100);
    TEST_ASSERT_INT_WITHIN(110, 0, get(0x606B, 0));
    step(200);
    TEST_ASSERT_EQUAL(-10000, get(0x606B, 0));
    set(0x60FF, 0, 0);
    step(600);
    TEST_ASSERT_BITS_HIGH(1024 | 4096, statusword());
}

static void profile_velocity_stays_below_607F(void) {
    set(0x607F, 0, 3000);
    enable(3);
    set(0x60FF, 0, -10000);
    step(500);
    TEST_ASSERT_EQUAL(-3000, get(0x606B, 0));
}

static void cyclic_velocity_takes_target_and_offset_at_once(void) {
    enable(9);
    set(0x60FF, 0, 4000);
    set(0x60B1, 0, -500);
    step(1);
    TEST_ASSERT_EQUAL(3500, get(0x606B, 0));
    step(400);
    TEST_ASSERT_INT_WITHIN(30, 3500, get(0x606C, 0));
    TEST_ASSERT_BITS_HIGH(4096, statusword());
}

static void cyclic_torque_is_thousandths_of_the_rated_torque(void) {
    enable(10);
    set(0x6071, 0, 250);
    set(0x60B2, 0, 50);
    step(1);
    TEST_ASSERT_EQUAL(300, get(0x6077, 0) & 0xFFFF);
    TEST_ASSERT_EQUAL(300, get(0x6078, 0) & 0xFFFF);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, (double)on.drives.drive[0].torque_Nm); /* 3 A, 0.1 Nm/A */
    TEST_ASSERT_EQUAL(10000, get(0x6075, 0));
    TEST_ASSERT_EQUAL(1000, get(0x6076, 0));
}

static void max_torque_limits_every_mode_and_shows_in_the_statusword(void) {
    set(0x6072, 0, 100);
    enable(10);
    set(0x6071, 0, -800);
    step(1);
    TEST_ASSERT_EQUAL(-100, get(0x6077, 0));
    TEST_ASSERT_BITS_HIGH(2048, statusword());
    set(0x6060, 0, 9);
    set(0x60FF, 0, 100000);
    step(1);
    TEST_ASSERT_EQUAL(100, get(0x6077, 0));
    set(0x6072, 0, 1000);
    step(1);
    TEST_ASSERT_EQUAL(1000, get(0x6077, 0));
}

static void cyclic_position_goes_straight_from_target_to_target(void) {
    set(0x60C2, 1, 10);
    set(0x60C2, 2, -3);
    enable(8);
    for (int k = 1; k <= 20; k++) {
        set(0x607A, 0, 50 * k);
        step(5);
        TEST_ASSERT_INT_WITHIN(1, 50 * k - 25, get(0x6062, 0));
        TEST_ASSERT_EQUAL(5000, get(0x606B, 0));
        step(5);
        TEST_ASSERT_EQUAL(50 * k, get(0x6062, 0));
    }
    step(1); /* no target came: it stays where the last one was */
    TEST_ASSERT_EQUAL(0, get(0x606B, 0));
    step(1000);
    TEST_ASSERT_EQUAL(1000, get(0x6062, 0));
    TEST_ASSERT_INT_WITHIN(3, 1000, get(0x6064, 0));
}

static void a_step_longer_than_the_interpolation_feeds_forward_no_more_than_its_own_speed(void) {
    on.drives.step_s = (laconic_real)0.01;
    enable(8);
    set(0x607A, 0, 100);
    step(1);
    TEST_ASSERT_EQUAL(100, get(0x6062, 0));
    TEST_ASSERT_EQUAL(10000, get(0x606B, 0));
}

static void cyclic_position_does_not_move_before_a_target_came(void) {
    set(0x607A, 0, 100000);
    enable(8);
    step(100);
    TEST_ASSERT_EQUAL(0, get(0x6062, 0));
    TEST_ASSERT_EQUAL(0, get(0x6064, 0));
}

static void cyclic_position_goes_on_beyond_the_end_of_32_bits(void) {
    on.drives.drive[0].encoder.count = INT32_MAX - 20;
    enable(8);
    for (int k = 1; k <= 40; k++) {
        set(0x607A, 0, (int32_t)((uint32_t)(INT32_MAX - 20) + (uint32_t)k));
        step(1);
    }
    TEST_ASSERT_EQUAL(INT32_MIN + 19, get(0x6062, 0));
    TEST_ASSERT_TRUE(on.axes[0].demand == (int64_t)INT32_MAX + 20);
}

static void a_following_error_stops_the_drive(void) {
    set(0x6065, 0, 500);
    set(0x6066, 0, 20);
    set(0x6072, 0, 10);
    enable(8);
    set(0x607A, 0, 20000);
    step(3);
    TEST_ASSERT_BITS_HIGH(8192, statusword());
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    TEST_ASSERT_INT_WITHIN(100, 20000, get(0x60F4, 0));
    step(30);
    TEST_ASSERT_EQUAL_HEX16(0x8611, get(0x603F, 0) & 0xFFFF);
    step(500);
    TEST_ASSERT_EQUAL_HEX16(FAULT, state());
}

/* --- profile position -------------------------------------------------------------------------------------------- */

static int steps_until_reached(int most) {
    int steps = 0;
    while ((statusword() & 1024) == 0 && steps < most) {
        step(1);
        steps++;
    }
    TEST_ASSERT_LESS_THAN(most, steps);
    return steps;
}

static void prepare_profile_position(void) {
    set(0x6081, 0, 20000);
    set(0x6083, 0, 200000);
    set(0x6084, 0, 100000);
    set(0x6067, 0, 10);
    enable(1);
}

static void profile_position_goes_to_its_target_by_ramps(void) {
    prepare_profile_position();
    set(0x607A, 0, 12000);
    step(10);
    TEST_ASSERT_EQUAL(0, get(0x6064, 0)); /* no set-point yet */
    control(15 | 16);
    TEST_ASSERT_BITS_HIGH(4096, statusword());
    control(15);
    TEST_ASSERT_BITS_LOW(4096, statusword());
    step(100);
    TEST_ASSERT_EQUAL(20000, get(0x606B, 0)); /* reached after 0.1 s */
    /* 0.1 s to speed over 1000 counts, 0.2 s to rest over 2000, 9000 at speed: 0.75 s */
    while (get(0x6062, 0) < 12000) step(1);
    TEST_ASSERT_INT_WITHIN(12, 750, (int)(on.now_us / 1000) - 10);
    steps_until_reached(1000);
    TEST_ASSERT_INT_WITHIN(10, 12000, get(0x6064, 0));
    control(15 | 16 | 64); /* relative, and back */
    set(0x607A, 0, -2000);
    control(15);
    control(15 | 16 | 64);
    step(2);
    steps_until_reached(2000);
    TEST_ASSERT_INT_WITHIN(10, 12000 - 2000 + 12000, get(0x6064, 0));
}

static void a_second_set_point_waits_and_one_at_once_does_not(void) {
    prepare_profile_position();
    set(0x607A, 0, 4000);
    control(15 | 16);
    control(15);
    set(0x607A, 0, 1000);
    control(15 | 16);
    control(15);
    TEST_ASSERT_BITS_HIGH(4096, statusword()); /* no room for a third */
    int32_t largest = 0;
    for (int k = 0; k < 1500; k++) {
        step(1);
        if (get(0x6062, 0) > largest) largest = get(0x6062, 0);
    }
    TEST_ASSERT_EQUAL(4000, largest);
    TEST_ASSERT_EQUAL(1000, get(0x6062, 0));
    set(0x607A, 0, 9000);
    control(15 | 16);
    control(15);
    step(20);
    set(0x607A, 0, -500);
    control(15 | 16 | 32);
    for (int k = 0; k < 1500; k++) {
        step(1);
        TEST_ASSERT_LESS_THAN(4000, get(0x6062, 0));
    }
    TEST_ASSERT_EQUAL(-500, get(0x6062, 0));
}

static void another_mode_begins_where_the_wheel_is(void) {
    enable(9);
    set(0x60FF, 0, 5000);
    step(500);
    set(0x6060, 0, 8);
    TEST_ASSERT_EQUAL(8, get(0x6061, 0));
    TEST_ASSERT_EQUAL(get(0x6064, 0), get(0x6062, 0));
    set(0x6060, 0, 0); /* no change */
    TEST_ASSERT_EQUAL(8, get(0x6061, 0));
}

static void a_third_set_point_finds_no_room(void) {
    prepare_profile_position();
    for (int k = 1; k <= 3; k++) {
        set(0x607A, 0, 1000 * k);
        control(15 | 16);
        control(15);
    }
    TEST_ASSERT_BITS_HIGH(4096, statusword());
    step(3000);
    TEST_ASSERT_EQUAL(2000, get(0x6062, 0));
    TEST_ASSERT_BITS_LOW(4096, statusword());
}

static void a_set_point_at_once_replaces_one_that_waits(void) {
    prepare_profile_position();
    for (int k = 1; k <= 3; k++) {
        set(0x607A, 0, 1000 * k);
        control(k < 3 ? 15 | 16 : 15 | 16 | 32);
        control(15);
    }
    step(3000);
    TEST_ASSERT_EQUAL(3000, get(0x6062, 0));
}

static void profile_position_stays_below_607F(void) {
    prepare_profile_position();
    set(0x607F, 0, 5000);
    set(0x607A, 0, 12000);
    control(15 | 16);
    for (int k = 0; k < 3000; k++) {
        step(1);
        TEST_ASSERT_LESS_OR_EQUAL(5000, get(0x606B, 0));
    }
    TEST_ASSERT_EQUAL(12000, get(0x6062, 0));
}

/* Even where a single step of the deceleration is further than the way. */
static void a_short_way_keeps_the_profiles_speed(void) {
    prepare_profile_position();
    set(0x6081, 0, 100);
    set(0x6084, 0, 100000000);
    set(0x607A, 0, 5);
    control(15 | 16);
    step(25);
    TEST_ASSERT_INT_WITHIN(1, 2, get(0x6062, 0));
    step(30);
    TEST_ASSERT_EQUAL(5, get(0x6062, 0));
}

static void enabled_without_a_mode_the_wheel_coasts(void) {
    set(0x60FF, 0, 20000);
    enable(0);
    step(5);
    TEST_ASSERT_EQUAL(LACONIC_DRIVE_OFF, on.drives.drive[0].target.mode);
    TEST_ASSERT_BITS_LOW(1024 | 4096, statusword());
}

static void another_mode_leaves_a_drive_that_slows_down_alone(void) {
    set(0x605C, 0, 1);
    set(0x60FF, 0, 20000);
    enable(9);
    step(500);
    control(7);
    step(50);
    const int32_t demand = get(0x606B, 0);
    set(0x6060, 0, 3);
    TEST_ASSERT_EQUAL(3, get(0x6061, 0));
    TEST_ASSERT_EQUAL(demand, get(0x606B, 0));
    step(20);
    TEST_ASSERT_INT_WITHIN(100, demand - 2000, get(0x606B, 0)); /* 100,000 counts/s² as before */
}

static void the_following_error_is_that_of_modes_of_positions(void) {
    static const int modes[5] = {1, 8, 3, 9, 10};
    for (int k = 0; k < 5; k++) {
        power_up();
        set(0x6065, 0, 10);
        enable(modes[k]);
        on.drives.drive[0].encoder.count += 1000; /* dragged */
        step(1);
        TEST_ASSERT_EQUAL(k < 2 ? 8192 : 0, statusword() & 8192);
        on.axes[0].demand += 100000;
        step(15);
        TEST_ASSERT_EQUAL_HEX16(k < 2 ? REACTION : ENABLED, state());
    }
}

static void speeds_beyond_32_bits_are_shown_as_their_ends(void) {
    on.drives.drive[0].speed_rad_per_s = (laconic_real)1e9;
    TEST_ASSERT_EQUAL(INT32_MAX, get(0x606C, 0));
    on.drives.drive[0].speed_rad_per_s = (laconic_real)-1e9;
    TEST_ASSERT_EQUAL(-INT32_MAX, get(0x606C, 0));
    on.drives.drive[0].speed_rad_per_s = LACONIC_REAL_MAX * 2;
    on.drives.drive[0].speed_rad_per_s -= on.drives.drive[0].speed_rad_per_s; /* no number */
    TEST_ASSERT_EQUAL(0, get(0x606C, 0));
}

static void a_following_error_lasts_its_time_to_the_microsecond(void) {
    set(0x6065, 0, 10);
    set(0x6066, 0, 20);
    enable(8);
    on.axes[0].demand += 11;
    laconic_canopen.on_step(&on.drives, 1000);
    laconic_canopen.on_step(&on.drives, 20999);
    TEST_ASSERT_EQUAL_HEX16(ENABLED, state());
    laconic_canopen.on_step(&on.drives, 21000);
    TEST_ASSERT_EQUAL_HEX16(REACTION, state());
}

/* Each step of the ramp is 100 counts/s, so that the last one back to 0 is a shorter one. */
static void a_set_point_behind_turns_the_motion_back_by_a_standstill(void) {
    bool stood = false;
    prepare_profile_position();
    set(0x6081, 0, 15050);
    set(0x607A, 0, -12000);
    control(15 | 16);
    control(15);
    step(150);
    TEST_ASSERT_EQUAL(-15050, get(0x606B, 0));
    set(0x607A, 0, 12000);
    control(15 | 16 | 32);
    for (int32_t k = 0, speed = -15050; k < 160; k++) {
        step(1);
        const int32_t now = get(0x606B, 0);
        TEST_ASSERT_TRUE(now >= speed);
        TEST_ASSERT_TRUE(now <= 0 || stood);
        stood = stood || now == 0;
        speed = now;
    }
    TEST_ASSERT_TRUE(stood);
}

static void a_drive_that_is_enabled_anew_has_no_following_error(void) {
    set(0x605C, 0, 0);
    set(0x6065, 0, 10);
    set(0x6066, 0, 100);
    enable(8);
    on.drives.drive[0].encoder.count += 1000; /* dragged */
    step(1);
    TEST_ASSERT_BITS_HIGH(8192, statusword());
    control(7);
    control(15);
    TEST_ASSERT_BITS_LOW(8192, statusword());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(profile_velocity_ramps_up_and_down_and_turns_back);
    RUN_TEST(profile_velocity_stays_below_607F);
    RUN_TEST(cyclic_velocity_takes_target_and_offset_at_once);
    RUN_TEST(cyclic_torque_is_thousandths_of_the_rated_torque);
    RUN_TEST(max_torque_limits_every_mode_and_shows_in_the_statusword);
    RUN_TEST(cyclic_position_goes_straight_from_target_to_target);
    RUN_TEST(a_step_longer_than_the_interpolation_feeds_forward_no_more_than_its_own_speed);
    RUN_TEST(cyclic_position_does_not_move_before_a_target_came);
    RUN_TEST(cyclic_position_goes_on_beyond_the_end_of_32_bits);
    RUN_TEST(a_following_error_stops_the_drive);
    RUN_TEST(profile_position_goes_to_its_target_by_ramps);
    RUN_TEST(a_second_set_point_waits_and_one_at_once_does_not);
    RUN_TEST(another_mode_begins_where_the_wheel_is);
    RUN_TEST(a_third_set_point_finds_no_room);
    RUN_TEST(a_set_point_at_once_replaces_one_that_waits);
    RUN_TEST(profile_position_stays_below_607F);
    RUN_TEST(a_short_way_keeps_the_profiles_speed);
    RUN_TEST(enabled_without_a_mode_the_wheel_coasts);
    RUN_TEST(another_mode_leaves_a_drive_that_slows_down_alone);
    RUN_TEST(the_following_error_is_that_of_modes_of_positions);
    RUN_TEST(speeds_beyond_32_bits_are_shown_as_their_ends);
    RUN_TEST(a_following_error_lasts_its_time_to_the_microsecond);
    RUN_TEST(a_set_point_behind_turns_the_motion_back_by_a_standstill);
    RUN_TEST(a_drive_that_is_enabled_anew_has_no_following_error);
    return UNITY_END();
}
