/* Tests of faults by order, laconic_drive_order(), as the controllers of every protocol meet them. */
#include "octets.h"
#include "place.h"

#include "drive_bench.h"
#include "unity.h"

enum { FIRST_ID = 1, SECOND_ID = 2 };

/* What belongs to a protocol: commands for both drives, and what they send by themselves or are asked for. */
typedef struct told {
    const laconic_drive_protocol *protocol;
    void (*command)(void); /* both drives push forward, and answer where the protocol has no cyclic frames */
    bool (*is_of_second)(const laconic_frame *frame);
    bool (*is_sign_of_life)(const laconic_frame *frame);
} told;

void setUp(void) {}
void tearDown(void) {}

/* ------------------------------------------------------------------------------- protocols -- */

static void sdo(uint32_t node_id, uint8_t head, uint16_t index, uint32_t value) {
    const uint8_t data[8] = {head,
                             (uint8_t)(index & 255U),
                             (uint8_t)(index >> 8),
                             0,
                             (uint8_t)(value & 255U),
                             (uint8_t)(value >> 8 & 255U),
                             (uint8_t)(value >> 16 & 255U),
                             0};
    bench_send(0x600 + node_id, data, 8);
}

static void canopen(void) {
    static const uint8_t words[] = {6, 7, 15};
    for (uint32_t id = FIRST_ID; id <= SECOND_ID; id++) {
        sdo(id, 0x2B, 0x1017, 20);
        sdo(id, 0x2F, 0x6060, 3);
        for (int k = 0; k < 3; k++) sdo(id, 0x2B, 0x6040, words[k]);
        sdo(id, 0x23, 0x60FF, 100000);
    }
}
static bool canopen_second(const laconic_frame *frame) { return (frame->id & 127U) == SECOND_ID; }
static bool canopen_alive(const laconic_frame *frame) { return frame->id == 0x700 + SECOND_ID; }

static void robomaster(void) {
    const uint8_t data[8] = {0x10, 0, 0x10, 0};
    bench_send(0x200, data, 8);
}
static bool robomaster_second(const laconic_frame *frame) { return frame->id == 0x200 + SECOND_ID; }

static void odrive(void) {
    static const uint8_t state[4] = {8}, modes[8] = {1, 0, 0, 0, 1}, torque[4] = {0, 0, 0, 0x3F};
    for (uint32_t id = FIRST_ID; id <= SECOND_ID; id++) {
        bench_send(id << 5 | 0x0B, modes, 8);
        bench_send(id << 5 | 0x07, state, 4);
        bench_send(id << 5 | 0x0E, torque, 4);
    }
}
static bool odrive_second(const laconic_frame *frame) { return frame->id >> 5 == SECOND_ID; }
static bool odrive_alive(const laconic_frame *frame) { return frame->id == (SECOND_ID << 5 | 1); }

/* Mode 10, velocity 1 turn/s, no timeout; then asks for mode. */
static void moteus(void) {
    static const uint8_t data[] = {0x01, 0x00, 10,   0x0D, 0x20, 0, 0, 0xC0, 0x7F, 0x0D, 0x21, 0,
                                   0,    0x80, 0x3F, 0x0D, 0x27, 0, 0, 0xC0, 0x7F, 0x11, 0x00, 0x50};
    bench_send(0x8000 | FIRST_ID, data, sizeof data);
    bench_send(0x8000 | SECOND_ID, data, sizeof data);
}
static bool moteus_second(const laconic_frame *frame) { return frame->id >> 8 == SECOND_ID; }

static const told all[] = {{&laconic_canopen, canopen, canopen_second, canopen_alive},
                           {&laconic_odrive, odrive, odrive_second, odrive_alive},
                           {&laconic_robomaster, robomaster, robomaster_second, robomaster_second},
                           {&laconic_robomaster_c610, robomaster, robomaster_second, robomaster_second},
                           {&laconic_moteus, moteus, moteus_second, NULL}};
enum { PROTOCOLS = sizeof all / sizeof all[0] };

/* ----------------------------------------------------------------------------------- bench -- */

typedef struct heard {
    int first, second, alive; /* frames of each drive; signs of life of the second */
} heard;

static heard listen(const told *of, int steps) {
    heard now = {0, 0, 0};
    laconic_frame frame;
    for (int k = 0; k < steps; k++) {
        bench_step();
        while (drives.protocol->next_frame(&drives, &frame)) {
            ++*(of->is_of_second(&frame) ? &now.second : &now.first);
            now.alive += of->is_sign_of_life != NULL && of->is_sign_of_life(&frame);
        }
    }
    return now;
}

static void begin(const told *of) {
    bench_begin(of->protocol, FIRST_ID, 1);
    bench_steps(2);
}

/* ----------------------------------------------------------------------------------- tests -- */

static void a_drive_off_the_bus_neither_hears_nor_is_heard_and_comes_back(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        begin(&all[n]);
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_OFF_BUS);
        all[n].command();
        heard now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.first > 0 && now.second == 0, all[n].protocol->name);
        TEST_ASSERT_TRUE_MESSAGE(bench_speed[0] > 0 && !(bench_speed[1] > 0), all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], 0);
        all[n].command();
        now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.second > 0 && bench_speed[1] > 0, all[n].protocol->name);
    }
}

static void a_silent_drive_goes_on_but_gives_no_sign_of_life(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        if (all[n].is_sign_of_life == NULL) continue;
        begin(&all[n]);
        all[n].command();
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive > 0, all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_SILENT);
        const laconic_real before = bench_speed[1];
        all[n].command();
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive == 0, all[n].protocol->name);
        TEST_ASSERT_TRUE_MESSAGE(bench_speed[1] >= before, all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], 0);
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive > 0, all[n].protocol->name);
    }
}

static void an_order_replaces_the_one_before_it(void) {
    begin(&all[2]);
    laconic_drive_order(&drives.drive[0], LACONIC_DRIVE_FAULT_ENCODER | LACONIC_DRIVE_ORDER_HELD);
    TEST_ASSERT_TRUE(drives.drive[0].brake_Nm > 0);
    laconic_drive_order(&drives.drive[0], LACONIC_DRIVE_FAULT_SUPPLY);
    TEST_ASSERT_TRUE(drives.drive[0].brake_Nm == 0);
    laconic_drive_clear(&drives.drive[0]);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_SUPPLY, drives.drive[0].faults);
    laconic_drive_order(&drives.drive[0], 0);
    laconic_drive_clear(&drives.drive[0]);
    TEST_ASSERT_EQUAL_UINT32(0, drives.drive[0].faults);
}

static void an_order_that_is_repeated_changes_nothing(void) {
    begin(&all[2]);
    robomaster();
    bench_steps(20);
    const laconic_wheel_drive before = drives.drive[0];
    laconic_drive_order(&drives.drive[0], 0);
    TEST_ASSERT_EQUAL_MEMORY(&before, &drives.drive[0], sizeof before);
}

static void a_drive_that_goes_off_the_bus_takes_back_what_was_due(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        begin(&all[n]);
        all[n].command();
        listen(&all[n], 200);
        all[n].command();
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_OFF_BUS);
        const heard now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.first > 0 && now.second == 0, all[n].protocol->name);
    }
}

/* Tests of place.c: places lose nothing over any distance, and motions keep their limits. */

#define R(number) ((laconic_real)(number))
#define STEP_S R(0.001)
#define near(expected, actual, within) TEST_ASSERT_DOUBLE_WITHIN(within, (double)(expected), (double)(actual))

static drive_place at(int64_t count, laconic_real rest) {
    const drive_place place = {count, rest};
    return place;
}

static void is_at(int64_t count, laconic_real rest, drive_place place) {
    TEST_ASSERT_EQUAL_INT64(count, place.count);
    TEST_ASSERT_TRUE(place.rest == rest);
}

/* --- places ------------------------------------------------------------------------------------------------------ */

static void a_place_is_whole_counts_and_a_share_of_one(void) {
    is_at(6, R(0.25), place_moved(at(5, R(0.5)), R(0.75)));
    is_at(4, R(0.75), place_moved(at(5, R(0.5)), R(-0.75)));
    is_at(8, R(0.5), place_moved(at(5, R(0.5)), 3));
    is_at(-2, R(0.5), place_moved(at(0, 0), R(-1.5)));
}

static void a_way_too_small_for_a_share_loses_no_count(void) { is_at(7, 0, place_moved(at(7, 0), -LACONIC_REAL_MIN)); }

static void what_is_no_number_moves_no_place(void) {
    is_at(5, R(0.5), place_moved(at(5, R(0.5)), real_not_a_number()));
}

static void ways_beyond_the_range_are_taken_as_its_ends(void) {
    is_at(2147483520, 0, place_moved(at(0, 0), R(1e20)));
    is_at(-2147483520, 0, place_moved(at(0, 0), R(-1e20)));
    is_at(3LL << 30, 0, place_at(R(1e20), 3));
    is_at(-(3LL << 30), 0, place_at(R(-1e20), 3));
}

static void counts_wrap_at_their_ends(void) {
    is_at(INT64_MIN, 0, place_moved(at(INT64_MAX, 0), 1));
    is_at(INT64_MAX, R(0.5), place_moved(at(INT64_MIN, 0), R(-0.5)));
    is_at(INT64_MIN + 1, 0, place_sum(at(INT64_MAX, 0), at(2, 0)));
    is_at(3, 0, place_difference(at(INT64_MIN + 1, 0), at(INT64_MAX - 1, 0)));
}

static void sums_and_differences_carry_the_share(void) {
    is_at(9, R(0.25), place_sum(at(5, R(0.5)), at(3, R(0.75))));
    is_at(1, R(0.75), place_difference(at(5, R(0.5)), at(3, R(0.75))));
    TEST_ASSERT_TRUE(place_counts(at(5, R(0.5))) == R(5.5));
}

static void turns_become_a_place_and_the_place_these_turns(void) {
    is_at(5120, 0, place_at(R(1.25), 4096));
    is_at(-5120, 0, place_at(R(-1.25), 4096));
    is_at(2, R(0.5), place_at(R(0.25), 10));
    TEST_ASSERT_TRUE(place_turns(at(5120, 0), 4096) == R(1.25));
    TEST_ASSERT_TRUE(place_turns(at(-5120, 0), 4096) == R(-1.25));
    TEST_ASSERT_TRUE(place_turns(at(4096LL << 20, 0), 4096) == R(1048576));
    near(3e18, place_turns(at(3000000000000000000LL, 0), 1), 1e13); /* more turns than a whole number has here */
}

/* --- motions ----------------------------------------------------------------------------------------------------- */

/* To a place 1000 counts away, from rest to rest. */
static drive_motion motion_of(laconic_real way) {
    drive_motion motion = {.speed_limit = 100, .acceleration = 1000, .deceleration = 500};
    motion.target = place_moved(motion.place, way);
    return motion;
}

/* Steps until it arrives: their number. No step changes the speed by more than its limits allow. */
static int arrive(drive_motion *motion) {
    int steps = 1;
    for (laconic_real before = motion->speed; !motion_step(motion, STEP_S) && steps < 100000; steps++) {
        const laconic_real change = real_magnitude(motion->speed - before);
        TEST_ASSERT_TRUE(change <= motion->acceleration * STEP_S * R(1.001));
        before = motion->speed;
    }
    is_at(motion->target.count, motion->target.rest, motion->place);
    TEST_ASSERT_TRUE(motion->speed == motion->target_speed);
    return steps;
}

static void a_motion_takes_the_time_of_its_limits_in_both_directions(void) {
    for (int side = -1; side <= 1; side += 2) {
        drive_motion motion = motion_of(R(1000 * side));
        motion_step(&motion, STEP_S);
        near(side, motion.speed, 1e-4);
        const int steps = arrive(&motion); /* 5 counts to speed up, 10 to slow down, the rest at 100 counts/s */
        near(0.1 + 0.2 + (1000 - 15) / 100.0, steps * 0.001, 0.01);
    }
}

static void a_short_motion_never_reaches_its_limit(void) {
    drive_motion motion = motion_of(R(1.5)); /* 1/2·v²/1000 + 1/2·v²/500 = 1.5: v² = 1000 */
    laconic_real fastest = 0;
    for (int k = 0; k < 1000 && !motion_step(&motion, STEP_S); k++)
        if (motion.speed > fastest) fastest = motion.speed;
    near(31.6, fastest, 1);
    is_at(1, R(0.5), motion.place);
}

static void a_motion_without_a_limit_of_its_speed_only_speeds_up_and_slows_down(void) {
    drive_motion motion = motion_of(1500);
    motion.speed_limit = LACONIC_REAL_MAX * 2;
    near(1 + 2, arrive(&motion) * 0.001, 0.02);
}

static void a_motion_beyond_its_limit_comes_back_to_exactly_it(void) {
    for (int side = -1; side <= 1; side += 2) {
        drive_motion motion = motion_of(1000);
        motion.speed = R(side * 100.75);
        motion_step(&motion, STEP_S);
        near(side * 100.25, motion.speed, 1e-3);
        motion_step(&motion, STEP_S);
        TEST_ASSERT_TRUE(motion.speed == R(side * 100));
    }
}

static void a_motion_that_cannot_stop_in_time_brakes_as_it_may_and_comes_back(void) {
    drive_motion motion = motion_of(1);
    motion.speed = 100;
    motion_step(&motion, STEP_S);
    near(99.5, motion.speed, 1e-3);
    for (int k = 0; k < 199; k++) TEST_ASSERT_FALSE(motion_step(&motion, STEP_S));
    near(0, motion.speed, 0.51);
    near(10, place_counts(motion.place), 0.2); /* v²/(2·500) */
    arrive(&motion);
    is_at(1, 0, motion.place);
}

static void a_motion_away_from_its_target_turns_back(void) {
    drive_motion motion = motion_of(10);
    motion.speed = -50;
    motion_step(&motion, STEP_S);
    near(-49.5, motion.speed, 1e-3);
    arrive(&motion);
    is_at(10, 0, motion.place);
}

static void a_target_that_moves_is_met_at_its_speed(void) {
    drive_motion motion = motion_of(100);
    motion.target_speed = 50;
    arrive(&motion);
    TEST_ASSERT_TRUE(motion.speed == 50 && place_counts(motion.place) > 150);
    TEST_ASSERT_TRUE(motion_step(&motion, STEP_S)); /* and stays with it */
    TEST_ASSERT_TRUE(motion.speed == 50 && place_counts(place_difference(motion.target, motion.place)) == 0);
}

static void a_way_that_a_step_makes_is_made_in_one(void) {
    drive_motion motion = motion_of(R(0.00325)); /* less than a stop from the next step's speed, 1.5, needs */
    motion.acceleration = 1500;
    TEST_ASSERT_TRUE(motion_step(&motion, STEP_S));
    TEST_ASSERT_TRUE(motion.speed == 0 && place_counts(motion.place) == place_counts(motion.target));
}

static void a_slow_motion_arrives_without_a_jolt(void) {
    drive_motion motion = motion_of(R(0.05));
    motion.acceleration = motion.deceleration = 10;
    laconic_real before = 0;
    bool arrives = false;
    for (int k = 0; k < 1000 && !arrives; k++) {
        before = motion.speed;
        arrives = motion_step(&motion, STEP_S);
    }
    TEST_ASSERT_TRUE(arrives);
    TEST_ASSERT_TRUE(before <= 2 * 10 * STEP_S);
}

static void motions_of_any_way_go_never_beyond_their_target_and_end_without_a_jolt(void) {
    for (int k = 1; k <= 500; k++) {
        drive_motion motion = motion_of(R(0.0771) * (laconic_real)k);
        laconic_real before = 0;
        bool arrives = false;
        for (int steps = 0; steps < 10000 && !arrives; steps++) {
            before = motion.speed;
            arrives = motion_step(&motion, STEP_S);
            TEST_ASSERT_FALSE(place_counts(place_difference(motion.target, motion.place)) < 0);
        }
        TEST_ASSERT_TRUE(arrives && before <= 2 * motion.deceleration * STEP_S);
    }
}

static void a_strong_deceleration_ends_at_the_limit_of_the_speed_too(void) {
    for (int side = -1; side <= 1; side += 2) {
        drive_motion motion = motion_of(R(100000 * side));
        motion.speed = R(101 * side);
        motion.deceleration = 100500; /* 100.5 counts/s in a step */
        motion_step(&motion, STEP_S);
        TEST_ASSERT_TRUE(motion.speed == R(100 * side));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_drive_off_the_bus_neither_hears_nor_is_heard_and_comes_back);
    RUN_TEST(a_silent_drive_goes_on_but_gives_no_sign_of_life);
    RUN_TEST(an_order_replaces_the_one_before_it);
    RUN_TEST(an_order_that_is_repeated_changes_nothing);
    RUN_TEST(a_drive_that_goes_off_the_bus_takes_back_what_was_due);
    RUN_TEST(a_place_is_whole_counts_and_a_share_of_one);
    RUN_TEST(a_way_too_small_for_a_share_loses_no_count);
    RUN_TEST(what_is_no_number_moves_no_place);
    RUN_TEST(ways_beyond_the_range_are_taken_as_its_ends);
    RUN_TEST(counts_wrap_at_their_ends);
    RUN_TEST(sums_and_differences_carry_the_share);
    RUN_TEST(turns_become_a_place_and_the_place_these_turns);
    RUN_TEST(a_motion_takes_the_time_of_its_limits_in_both_directions);
    RUN_TEST(a_short_motion_never_reaches_its_limit);
    RUN_TEST(a_motion_without_a_limit_of_its_speed_only_speeds_up_and_slows_down);
    RUN_TEST(a_motion_beyond_its_limit_comes_back_to_exactly_it);
    RUN_TEST(a_motion_that_cannot_stop_in_time_brakes_as_it_may_and_comes_back);
    RUN_TEST(a_motion_away_from_its_target_turns_back);
    RUN_TEST(a_target_that_moves_is_met_at_its_speed);
    RUN_TEST(a_way_that_a_step_makes_is_made_in_one);
    RUN_TEST(a_slow_motion_arrives_without_a_jolt);
    RUN_TEST(motions_of_any_way_go_never_beyond_their_target_and_end_without_a_jolt);
    RUN_TEST(a_strong_deceleration_ends_at_the_limit_of_the_speed_too);
    return UNITY_END();
}
