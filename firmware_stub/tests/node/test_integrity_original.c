/* Tests of integrity.c: what is compared, and that a change is noticed whichever way it goes. */
#include "integrity_bench.h"

void setUp(void) {}
void tearDown(void) {}

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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_member_of_the_configuration_that_became_smaller_or_larger_is_repaired);
    RUN_TEST(test_a_change_that_one_of_the_two_sums_shows_is_noticed_both_ways);
    RUN_TEST(test_a_change_of_motion_and_of_what_is_sent_is_noticed_as_either_is);
    return UNITY_END();
}
