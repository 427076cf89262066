/* Tests of decay_change.c that no step shows: what a damping that stays, and one entry of it, make of the factors. */
#include "step_change.h"

#include "methods.h"
#include "stack.h"

/* Decays so fast that slopes by them leave the range of numbers: of a damping that stays, nothing may come of them. */
static void a_damping_that_does_not_change_changes_no_factor_however_fast_it_is(void) {
    const linear_map stays = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    decay_change change, zero;
    laconic_model m;
    memset(&m, 0, sizeof m);
    memset(&change, ALL_NAN, sizeof change);
    memset(&zero, 0, sizeof zero);
    for (int k = 0; k < 3; k++) m.decay_per_s[k] = REAL(EITHER(1e170, 1e25));
    laconic_decay_change_of(&change, &m, 1, &stays);
    TEST_ASSERT_EQUAL_MEMORY(&zero, &change, sizeof change);
}

/* One entry alone, and its mirror image. */
static void an_entry_of_the_damping_changes_that_entry_of_the_factors(void) {
    const linear_map changes = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    decay_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = 2;
    m.decay_per_s[1] = 3;
    laconic_decay_change_of(&change, &m, REAL(0.5), &changes);
    const double slope = (0.5 * (1 - exp(-1.0)) / 1.0 - 0.5 * (1 - exp(-1.5)) / 1.5) / (2 - 3); /* of hφ1 */
    ASSERT_NEAR(EITHER(1e-14, 1e-6), slope, change.gain.x.y);
    ASSERT_NEAR(EITHER(1e-14, 1e-6), slope, change.gain.y.x);
    TEST_ASSERT_TRUE(change.gain.x.x == 0 && change.gain.y.y == 0 && change.gain.z.z == 0);
}

/* One entry alone, and its mirror image; h is 1. */
static decay_change change_between(double rate, double other) {
    const linear_map of_one = {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}, of_two = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    decay_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = REAL(rate);
    m.decay_per_s[1] = REAL(other);
    laconic_decay_change_of(&change, &m, 1, rate == other ? &of_one : &of_two);
    return change;
}

/* By the mean of the slope; in single the difference of the factors themselves has lost a digit. */
static void rates_that_are_just_near_keep_the_digits_of_the_slope(void) {
    const decay_change change = change_between(2, 1);
    ASSERT_NEAR(EITHER(1e-13, 1e-7), 0.7310585786300048793, change.inverse_gain.x.y);
    ASSERT_NEAR(EITHER(1e-13, 6e-8), 0.07454093588033922743, change.mean.x.y);
}

/* In single the formula of faster ones has less digits of the slope here. */
static void a_rate_that_is_not_yet_fast_keeps_the_digits_of_the_series(void) {
    const decay_change change = change_between(1, 1);
    ASSERT_NEAR(EITHER(1e-13, 6e-8), 0.07932640579220768105, change.mean.x.x);
    ASSERT_NEAR(EITHER(1e-13, 3e-7), -0.03180361292542491996, change.slope.x.x);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_damping_that_does_not_change_changes_no_factor_however_fast_it_is);
    RUN_TEST(an_entry_of_the_damping_changes_that_entry_of_the_factors);
    RUN_TEST(rates_that_are_just_near_keep_the_digits_of_the_slope);
    RUN_TEST(a_rate_that_is_not_yet_fast_keeps_the_digits_of_the_series);
    return UNITY_END();
}
