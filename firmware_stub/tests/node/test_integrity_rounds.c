/* Tests of integrity.c: rounds over model and parameters, slice by slice, each at its time. */
#include "integrity_bench.h"
#include "laconic_node/crc.h"
#include "laconic_node/protection.h"

void setUp(void) {}
void tearDown(void) {}

/* Evenly: ticks of 5 ms find one slice or two due, and a round lasts its half second. */
static void test_a_round_over_the_model_lasts_its_time(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    const uint32_t rounds = on.integrity.rounds, ticks = 4 * LACONIC_INTEGRITY_ROUND_US / TICK_US;
    for (uint32_t k = 0; k < ticks; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
    }
    TEST_ASSERT_TRUE(on.integrity.rounds - rounds >= 3);
    TEST_ASSERT_TRUE(on.integrity.rounds - rounds <= 5);
}

/* How many slices a round has: no slice is of two parts. */
static uint32_t slices_of_the_model(void) {
    const size_t bytes[] = {
        sizeof on.node.start,           sizeof on.node.plant.vehicle,    sizeof on.node.plant.model,
        sizeof on.node.drive_plan,      sizeof on.node.plant.integrator, sizeof on.node.plant.friction,
        sizeof on.node.sensors.settings};
    uint32_t slices = 0;
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        slices += (uint32_t)(bytes[k] / LACONIC_INTEGRITY_SLICE);
        if (bytes[k] % LACONIC_INTEGRITY_SLICE > 0) slices++;
    }
    return slices;
}

/* Time, and a tick; how many slices of the round have been seen then. */
static uint32_t slices_after(uint32_t microseconds) {
    on.time_us += microseconds;
    bench_tick(&on);
    return on.integrity.slices;
}

static void test_each_slice_is_seen_when_it_is_due_and_the_last_ends_the_round(void) {
    const uint32_t slices = slices_of_the_model(), slice_us = LACONIC_INTEGRITY_ROUND_US / slices;
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    while (on.integrity.slices != slices - 1) (void)slices_after(slice_us / 2);
    while (on.integrity.slices != 1) (void)slices_after(1); /* until a round begins, with its first slice */
    const uint32_t rounds = on.integrity.rounds;
    for (uint32_t k = 1; k < slices; k++) {
        TEST_ASSERT_EQUAL_UINT32(k, slices_after(slice_us - 1));
        TEST_ASSERT_EQUAL_UINT32(rounds, on.integrity.rounds);
        TEST_ASSERT_EQUAL_UINT32(k + 1 < slices ? k + 1 : 1, slices_after(1));
    }
    TEST_ASSERT_EQUAL_UINT32(rounds + 1, on.integrity.rounds);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* A frame may have a later time than the tick behind it, and begin a round. */
static void test_before_a_round_has_begun_no_slice_is_due(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    while (on.integrity.slices != 2) (void)slices_after(1000);
    while (on.integrity.slices != 1) (void)slices_after(1); /* until the next begins */
    on.time_us -= 1000;
    TEST_ASSERT_EQUAL_UINT32(1, slices_after(0));
}

/* What waits to be sent stays, too: nothing is found anew. */
static void test_a_model_that_is_known_to_be_wrong_is_told_once_and_seen_no_more(void) {
    laconic_frame frame;
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_SUM);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.plant.vehicle.mass_kg *= 2;
    while (on.integrity.broken == LACONIC_INTEGRITY_SOUND) (void)slices_after(1000);
    TEST_ASSERT_TRUE(bench_next(&on, &frame));
    TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT, frame.id);
    while (bench_next(&on, &frame)) continue;
    on.node.pending |= 1U << LACONIC_WIRE_NU;
    const uint32_t slices = on.integrity.slices;
    for (uint32_t k = 0; k < 3 * LACONIC_INTEGRITY_ROUND_US / 1000; k++)
        TEST_ASSERT_EQUAL_UINT32(slices, slices_after(1000));
    TEST_ASSERT_TRUE(on.node.answers_due == 0 && (on.node.pending & 1U << LACONIC_WIRE_NU) != 0);
    while (bench_next(&on, &frame)) TEST_ASSERT_TRUE(frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT);
}

/* The COMMIT of this session once more; what was loaded is still there. */
static void commit_again(void) {
    const laconic_loader *loaded = &on.node.loader;
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_COMMIT, .length = 8};
    const uint32_t checksum = loaded->checksum ^ LACONIC_CRC32_END;
    memcpy(frame.data + 2, &loaded->frame_count, 2);
    memcpy(frame.data + 4, &checksum, 4);
    laconic_protect_keyed(LACONIC_WIRE_COMMIT, frame.data, on.node.session.key,
                          on.node.session.count[LACONIC_WIRE_COMMIT] + 1U);
    bench_frame(&on, &frame);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_COMMIT].status);
}

static void test_without_the_check_of_motion_what_was_loaded_is_compared_with_nothing(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_RANGE);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    commit_again();
}

/* Of another session, or of the same. */
static void test_a_new_vehicle_begins_a_new_round(void) {
    for (int same = 0; same < 2; same++) {
        bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
        while (on.integrity.slices != 1) (void)slices_after(1000);
        on.node.plant.vehicle.mass_kg *= 2; /* of the second part: wrong in this round, healed by the next COMMIT */
        while (on.integrity.slices != slices_of_the_model() / 2) (void)slices_after(1000);
        if (same)
            commit_again();
        else
            TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
        const uint32_t rounds = on.integrity.rounds;
        while (on.integrity.rounds == rounds && on.integrity.broken == LACONIC_INTEGRITY_SOUND)
            (void)slices_after(1000);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    }
}

static void test_the_model_is_seen_only_where_there_is_one_and_its_sum_is_wanted(void) {
    for (uint8_t checks = 1; checks < LACONIC_INTEGRITY_ALL; checks++) {
        bench_power_up(&on, 7, 0, checks);
        TEST_ASSERT_EQUAL_UINT32(0, slices_after(TICK_US));
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
        TEST_ASSERT_TRUE((on.integrity.slices > 0) == ((checks & LACONIC_INTEGRITY_SUM) != 0));
    }
}

static void test_a_tick_sees_few_slices_however_late_it_comes(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    for (int k = 0; k < 20; k++) {
        const uint32_t before = on.integrity.slices;
        const uint32_t rounds = on.integrity.rounds;
        on.time_us += 10000000U;
        bench_tick(&on);
        if (on.integrity.rounds == rounds)
            TEST_ASSERT_EQUAL(before + LACONIC_INTEGRITY_SLICES_PER_TICK, on.integrity.slices);
        TEST_ASSERT_TRUE(on.integrity.rounds <= rounds + 1);
    }
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_round_over_the_model_lasts_its_time);
    RUN_TEST(test_each_slice_is_seen_when_it_is_due_and_the_last_ends_the_round);
    RUN_TEST(test_before_a_round_has_begun_no_slice_is_due);
    RUN_TEST(test_a_model_that_is_known_to_be_wrong_is_told_once_and_seen_no_more);
    RUN_TEST(test_a_new_vehicle_begins_a_new_round);
    RUN_TEST(test_the_model_is_seen_only_where_there_is_one_and_its_sum_is_wanted);
    RUN_TEST(test_a_tick_sees_few_slices_however_late_it_comes);
    RUN_TEST(test_without_the_check_of_motion_what_was_loaded_is_compared_with_nothing);
    return UNITY_END();
}
