/* Tests of the panels of a step with fast damping: how many, how long, and those of an integrator of half steps. */
#include "exponential_gauss_8.h"

#include "methods.h"

/* One stretch of the first kind in decay times. */
#define FIRST (REAL(PARTS) * PANEL_DECAY)

static laconic_model damped(laconic_real x, laconic_real y, laconic_real z) {
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = x;
    m.decay_per_s[1] = y;
    m.decay_per_s[2] = z;
    return m;
}

static laconic_integrator with_panels(laconic_real x, laconic_real y, laconic_real z) {
    const laconic_model m = damped(x, y, z);
    return integrator_of(&laconic_exponential_gauss_8, &m, 1);
}

static laconic_integrator halved(laconic_real x, laconic_real y, laconic_real z) {
    const laconic_model m = damped(x, y, z);
    laconic_integrator in = integrator_of(&laconic_exponential_gauss_8, &m, 1);
    laconic_halve_panels(&in, &m);
    TEST_ASSERT_TRUE(in.halved);
    return in;
}

/* 1, 1, 2, 4 …: the time that has passed after the stretches, in units of the first. */
static laconic_real end_of(int32_t stretches) { return (laconic_real)((uint64_t)1 << (stretches - 1)); }

static void the_longest_step_of_one_panel_is_one(void) {
    const laconic_real above = WHOLE_DECAY * (1 + LACONIC_EPSILON);
    TEST_ASSERT_EQUAL_INT(0, with_panels(WHOLE_DECAY, 0, 0).stretches);
    TEST_ASSERT_TRUE(with_panels(above, 0, 0).stretches > 0);
    TEST_ASSERT_EQUAL_INT(0, halved(0, WHOLE_DECAY / 2, 0).stretches);
    TEST_ASSERT_TRUE(halved(0, above / 2, 0).stretches > 0);
}

static void stretches_end_when_they_cover_the_step(void) {
    laconic_integrator in = with_panels(0, 0, 2 * FIRST);
    TEST_ASSERT_EQUAL_INT(2, in.stretches);
    TEST_ASSERT_FALSE(in.has_rest);
    ASSERT_NEAR(ROUNDING, 1.0 / (2 * PARTS), in.first_share);
    in = with_panels(0, 0, 2 * FIRST * (1 + LACONIC_EPSILON));
    TEST_ASSERT_EQUAL_INT(3, in.stretches);
    ASSERT_NEAR(ROUNDING, 1.0 / (4 * PARTS), in.first_share);
}

/* Not before it is dead, and not a stretch later; `scale`: 2 where panels are halved. */
static void assert_rest_once_dead(const laconic_integrator *in, int scale) {
    const laconic_real end = end_of(in->stretches);
    TEST_ASSERT_TRUE(in->has_rest);
    TEST_ASSERT_TRUE(end * FIRST >= (laconic_real)scale * DEAD_AFTER);
    TEST_ASSERT_TRUE(end / 2 * FIRST < (laconic_real)scale * DEAD_AFTER);
    ASSERT_NEAR(ROUNDING, 1, in->rest_share + end * REAL(scale * PARTS) * in->first_share);
}

static void when_all_has_died_out_the_rest_of_the_step_is_one_panel(void) {
    const laconic_integrator whole = with_panels(0, 0, REAL(1e4)), half = halved(0, 0, REAL(1e4));
    assert_rest_once_dead(&whole, 1);
    assert_rest_once_dead(&half, 2);
    ASSERT_NEAR(ROUNDING * 1e-4, PANEL_DECAY * REAL(1e-4), whole.first_share);
    ASSERT_NEAR(ROUNDING * 1e-4, PANEL_DECAY * REAL(0.5e-4), half.first_share);
}

/* After 18 decay times, in single 12, of the slower axis: of 32 first stretches, or of 64 where 32 end just before. */
static void an_axis_has_died_out_after_so_many_decay_times(void) {
    const double fast = 1000, reached = 32 * EITHER(3 * 0.375, 0.5) / fast; /* of the slow axis, by its decay */
    const laconic_integrator dead = with_panels(REAL(EITHER(18.01, 12.01) / reached), 0, REAL(fast));
    const laconic_integrator alive = with_panels(REAL(EITHER(17.99, 11.99) / reached), 0, REAL(fast));
    TEST_ASSERT_TRUE(dead.has_rest && alive.has_rest);
    ASSERT_NEAR(ROUNDING, 32, end_of(dead.stretches));
    ASSERT_NEAR(ROUNDING, 64, end_of(alive.stretches));
}

/* An axis on which the whole step is no longer than a panel may be has nothing that must die out before the rest. */
static void an_axis_that_fits_one_panel_does_not_put_off_the_rest(void) {
    const laconic_integrator in = with_panels(PANEL_DECAY, 0, REAL(1000));
    assert_rest_once_dead(&in, 1);
    TEST_ASSERT_FALSE(with_panels(PANEL_DECAY * (1 + LACONIC_EPSILON), 0, REAL(1000)).has_rest);
}

static void there_are_no_more_stretches_than_the_most(void) {
    const laconic_integrator in = with_panels(REAL(1), 0, REAL(1e9));
    TEST_ASSERT_EQUAL_INT(MOST_STRETCHES, in.stretches);
    TEST_ASSERT_FALSE(in.has_rest);
    ASSERT_NEAR(ROUNDING, 1, end_of(MOST_STRETCHES) * REAL(PARTS) * in.first_share);
}

/* Nothing changes in an integrator of a method without panels. */
static void panels_of_other_methods_are_not_halved(void) {
    const laconic_model m = damped(REAL(1), REAL(2), REAL(0.5));
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        if (method == &laconic_auto || method == &laconic_exponential_gauss_8) continue;
        const laconic_integrator before = integrator_of(method, &m, 1);
        laconic_integrator in = before;
        laconic_halve_panels(&in, &m);
        TEST_ASSERT_EQUAL_MEMORY(&before, &in, sizeof in);
    }
}

static void an_axis_without_damping_does_not_keep_panels_from_being_halved(void) {
    TEST_ASSERT_TRUE(halved(0, 0, REAL(9)).stretches > 0);
    TEST_ASSERT_TRUE(halved(REAL(9), 0, 0).stretches > 0);
    TEST_ASSERT_TRUE(halved(0, REAL(9), 0).stretches > 0);
}

/* Their first panel is so long that what there is at its nodes has underflowed. */
static void the_longest_panels_are_halved_too(void) {
    const laconic_integrator in = with_panels(REAL(1e15), 0, REAL(1));
    TEST_ASSERT_TRUE(in.collocation[0][0] == 0);
    TEST_ASSERT_TRUE(halved(REAL(1e15), 0, REAL(1)).first_share == in.first_share / 2);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_longest_step_of_one_panel_is_one);
    RUN_TEST(stretches_end_when_they_cover_the_step);
    RUN_TEST(when_all_has_died_out_the_rest_of_the_step_is_one_panel);
    RUN_TEST(an_axis_has_died_out_after_so_many_decay_times);
    RUN_TEST(an_axis_that_fits_one_panel_does_not_put_off_the_rest);
    RUN_TEST(there_are_no_more_stretches_than_the_most);
    RUN_TEST(panels_of_other_methods_are_not_halved);
    RUN_TEST(an_axis_without_damping_does_not_keep_panels_from_being_halved);
    RUN_TEST(the_longest_panels_are_halved_too);
    return UNITY_END();
}
