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
    const size_t bytes[] = {sizeof on.node.start,
                            sizeof on.node.plant.vehicle,
                            sizeof on.node.plant.model,
                            sizeof on.node.drive_plan,
                            sizeof on.node.plant.integrator,
                            sizeof on.node.plant.friction,
                            sizeof on.node.sensors.settings,
                            sizeof on.node.hinges.model,
                            sizeof on.node.hinges.slips,
                            sizeof on.node.hinges.tree_model,
                            sizeof on.node.hinges.integrator,
                            sizeof on.node.hinges.start,
                            sizeof on.node.hinges.first,
                            sizeof on.node.xcp.page};
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

/* Tests of integrity.c: what is compared, and that a change is noticed whichever way it goes. */

/* A node that was begun with the original, and whose own copy is another since. */
static void expect_repaired(const laconic_node_config *original, const laconic_node_config *changed) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_SUM);
    on.config = *original;
    TEST_ASSERT_TRUE(laconic_node_init(&on.node, &on.config, 0));
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    on.node.config = *changed;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_CONFIGURATION, on.integrity.broken);
    TEST_ASSERT_EQUAL_HEX16(original->id_base, on.node.config.id_base);
    TEST_ASSERT_EQUAL(original->can_fd, on.node.config.can_fd);
    TEST_ASSERT_TRUE(original->method == on.node.config.method);
    TEST_ASSERT_EQUAL_UINT32(original->nonce_seed, on.node.config.nonce_seed);
    TEST_ASSERT_TRUE(original->protocol == on.node.config.protocol);
}

static const laconic_method *no_method(int32_t number) {
    (void)number;
    return NULL;
}

static void test_a_member_of_the_configuration_that_became_smaller_or_larger_is_repaired(void) {
    const laconic_node_config usual = {LACONIC_WIRE_ID_BASE, true, laconic_method_by_number, 7,
                                       laconic_drive_protocol_by_number};
    laconic_node_config other[6] = {usual, usual, usual, usual, usual, usual};
    other[0].id_base = LACONIC_WIRE_ID_BASE + LACONIC_NODE_ID_STRIDE;
    other[1].can_fd = false;
    other[2].method = no_method;
    other[3].nonce_seed = 8;
    other[4].protocol = NULL;
    other[5].id_base = LACONIC_WIRE_ID_BASE + LACONIC_NODE_ID_STRIDE; /* of two members at once */
    other[5].can_fd = false;
    for (int k = 0; k < 6; k++) {
        expect_repaired(&usual, &other[k]);
        expect_repaired(&other[k], &usual);
    }
}

/* The first two words of a motion are these when it is sealed, and then those. */
static bool notices(const uint32_t these[2], const uint32_t those[2]) {
    memcpy(&on.node.plant.state, these, 2 * sizeof these[0]);
    laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
    on.integrity.has_vehicle = true;
    memcpy(&on.node.plant.state, those, 2 * sizeof those[0]);
    bench_tick(&on);
    return on.integrity.broken == LACONIC_INTEGRITY_OF_MOTION;
}

/* The highest bit of every second word counts an even number of times in the sum of sums, so that only the sum of words
 * tells; of what one word gives to the next only the sum of sums. */
static void test_a_change_that_one_of_the_two_sums_shows_is_noticed_both_ways(void) {
    static const uint32_t none[2] = {0, 0}, top[2][2] = {{0x80000000U, 0}, {0, 0x80000000U}};
    static const uint32_t first[2] = {1, 0}, second[2] = {0, 1};
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_MOTION);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(notices(none, top[k]));
        TEST_ASSERT_TRUE(notices(top[k], none));
    }
    TEST_ASSERT_TRUE(notices(first, second));
    TEST_ASSERT_TRUE(notices(second, first));
    TEST_ASSERT_FALSE(notices(first, first));
}

static void test_a_change_of_motion_and_of_what_is_sent_is_noticed_as_either_is(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_MOTION);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.plant.state.x_m.value += 1;
    on.node.pending ^= 1U;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
}

/* A command of an XCP master; the code of its answer, 255: done. */
static uint8_t master(const uint8_t *command, uint8_t length) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_XCP_COMMAND, .length = length};
    memcpy(frame.data, command, length);
    bench_frame(&on, &frame);
    while (bench_next(&on, &frame))
        if (frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_XCP_RESPONSE)
            return frame.data[0] == 0xFE ? frame.data[1] : frame.data[0];
    return 1;
}

/* The mass becomes 12.5; the code of the answer. */
static uint8_t calibrate(void) {
    static const uint8_t connect[2] = {0xFF}, address[8] = {0xF6, 0, 0, 0, 0x80, 0, 1};
    static const uint8_t mass[6] = {0xF0, 4, 0, 0, 0x48, 0x41};
    TEST_ASSERT_EQUAL_HEX8(255, master(connect, 2));
    TEST_ASSERT_EQUAL_HEX8(255, master(address, 8));
    return master(mass, 6);
}

static void test_numbers_of_a_master_of_xcp_are_part_of_what_is_compared(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_HEX8(255, calibrate());
    TEST_ASSERT_TRUE(on.node.plant.vehicle.mass_kg == (laconic_real)12.5);
    const uint32_t rounds = on.integrity.rounds;
    while (on.integrity.rounds < rounds + 2 && on.integrity.broken == LACONIC_INTEGRITY_SOUND) (void)slices_after(1000);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    on.node.xcp.page[1].mass_kg = 1;
    while (on.integrity.broken == LACONIC_INTEGRITY_SOUND) (void)slices_after(1000);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
    TEST_ASSERT_EQUAL_HEX8(0x33, calibrate());
}

static void test_a_model_that_has_changed_by_itself_is_not_calibrated(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.start.x_m = 3;
    TEST_ASSERT_EQUAL_HEX8(0x33, calibrate());
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
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
    RUN_TEST(test_a_member_of_the_configuration_that_became_smaller_or_larger_is_repaired);
    RUN_TEST(test_a_change_that_one_of_the_two_sums_shows_is_noticed_both_ways);
    RUN_TEST(test_a_change_of_motion_and_of_what_is_sent_is_noticed_as_either_is);
    RUN_TEST(test_numbers_of_a_master_of_xcp_are_part_of_what_is_compared);
    RUN_TEST(test_a_model_that_has_changed_by_itself_is_not_calibrated);
    return UNITY_END();
}
