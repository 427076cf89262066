/* Tests of encoder.c: whole counts, their wrap and the index. */
#include "check.h"

static const laconic_encoder_settings plain = {.counts_per_turn = 4096};

static laconic_encoder turned(const laconic_encoder_settings *settings, double rad) {
    laconic_encoder encoder = {0, 0};
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, settings, REAL(rad)));
    return encoder;
}

static void half_a_turn_gives_half_its_counts(void) {
    TEST_ASSERT_EQUAL_INT(2048, (int)turned(&plain, PI * 1.0001).count);
    TEST_ASSERT_EQUAL_INT(2047, (int)turned(&plain, PI * 0.9999).count);
    TEST_ASSERT_EQUAL_INT(-2049, (int)turned(&plain, -PI * 1.0001).count); /* rounded down, as an edge is passed */
}

static void a_gear_multiplies_and_a_negative_one_counts_backwards(void) {
    const laconic_encoder_settings behind = {.counts_per_turn = 16, .gear_ratio = REAL(-33.014)};
    TEST_ASSERT_EQUAL_INT(-529, (int)turned(&behind, 2 * PI).count); /* 16 · 33.014 = 528.2 */
    TEST_ASSERT_EQUAL_INT(528, (int)turned(&behind, -2 * PI).count);
}

/* A million steps of an irrational part of a count, and as many back. */
static void no_count_is_lost_however_small_the_steps(void) {
    const int32_t steps = 1000000;
    const laconic_real step = REAL(1e-4);
    laconic_encoder encoder = {0, 0};
    for (int32_t k = 0; k < steps; k++) laconic_encoder_turn(&encoder, &plain, step);
    const double counts = (double)step * steps * 4096 / (2 * PI);
    ASSERT_NEAR(EITHER(1e-6, 0.05), counts, (double)encoder.count + (double)encoder.rest);
    for (int32_t k = 0; k < steps; k++) laconic_encoder_turn(&encoder, &plain, -step);
    ASSERT_NEAR(EITHER(1e-9, 0.05), 0, (double)encoder.count + (double)encoder.rest);
}

/* At 10^15 counts a floating-point angle in single would be off by 10^8 of them. */
static void a_shaft_far_from_its_start_counts_as_well_as_near_it(void) {
    const laconic_encoder_settings one = {.counts_per_turn = 1};
    laconic_encoder far = {INT64_C(1000000000000000), REAL(0.25)};
    for (int k = 0; k < 4; k++) laconic_encoder_turn(&far, &one, REAL(0.5 * PI * 1.001));
    TEST_ASSERT_TRUE(far.count == INT64_C(1000000000000001));
}

static void the_share_of_a_count_stays_below_one(void) {
    laconic_encoder encoder = {0, 0};
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, &plain, REAL(-1e-25)));
    TEST_ASSERT_TRUE(encoder.count == 0 && encoder.rest == 0); /* −10^-22 rounds to the edge itself */
    encoder.rest = REAL(0.75);
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, &plain, REAL(2 * PI / 4096 * 1.75)));
    TEST_ASSERT_EQUAL_INT(2, (int)encoder.count);
    ASSERT_NEAR(4 * ROUNDING, 0.5, encoder.rest);
}

static void a_step_that_no_count_can_hold_is_refused(void) {
    const double too_far[] = {1e12, -1e12, (double)NAN, (double)INFINITY};
    for (int k = 0; k < 4; k++) {
        laconic_encoder encoder = {7, REAL(0.5)};
        TEST_ASSERT_FALSE(laconic_encoder_turn(&encoder, &plain, REAL(too_far[k])));
        TEST_ASSERT_TRUE(encoder.count == 7 && encoder.rest == REAL(0.5));
    }
}

static void the_index_is_passed_once_a_turn_in_either_direction(void) {
    const int64_t count[] = {0, 9, 10, 11, 29, -1, -10, -11};
    const int32_t place[] = {0, 9, 0, 1, 9, 9, 0, 9};
    const int64_t turns[] = {0, 0, 1, 1, 2, -1, -1, -2};
    for (int k = 0; k < 8; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(place[k], laconic_encoder_place(&encoder, 10));
        TEST_ASSERT_EQUAL_INT((int)turns[k], (int)laconic_encoder_turns(&encoder, 10));
    }
}

static void it_shows_its_count_wrapped(void) {
    const int64_t count[] = {0, 65535, 65536, -1, -65537};
    const int32_t shown[] = {0, 65535, 0, 65535, 65535};
    for (int k = 0; k < 5; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(shown[k], laconic_encoder_shown(&encoder, 65536));
    }
}

static void without_a_wrap_it_shows_32_bits(void) {
    const int64_t count[] = {
        5, -5, INT64_C(2147483647), INT64_C(2147483648), INT64_C(-2147483649), INT64_C(4294967297)};
    const int32_t shown[] = {5, -5, 2147483647, -2147483647 - 1, 2147483647, 1};
    for (int k = 0; k < 6; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(shown[k], laconic_encoder_shown(&encoder, 0));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(half_a_turn_gives_half_its_counts);
    RUN_TEST(a_gear_multiplies_and_a_negative_one_counts_backwards);
    RUN_TEST(no_count_is_lost_however_small_the_steps);
    RUN_TEST(a_shaft_far_from_its_start_counts_as_well_as_near_it);
    RUN_TEST(the_share_of_a_count_stays_below_one);
    RUN_TEST(a_step_that_no_count_can_hold_is_refused);
    RUN_TEST(the_index_is_passed_once_a_turn_in_either_direction);
    RUN_TEST(it_shows_its_count_wrapped);
    RUN_TEST(without_a_wrap_it_shows_32_bits);
    return UNITY_END();
}
