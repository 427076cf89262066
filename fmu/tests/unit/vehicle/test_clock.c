/* Tests of clock.c: times of many steps, of changed steps, and the ends of a run. */
#include "clock.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void a_clock_counts_ticks_and_does_not_add_them_up(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, 5.0, false, 0.0);
    TEST_ASSERT_TRUE(fmu_clock_now(&clock) == 5.0 && clock.step_s == 0.0 && clock.ticks == 0);
    fmu_clock_change_step(&clock, 0.1);
    clock.ticks = 1000000;
    TEST_ASSERT_TRUE(fmu_clock_now(&clock) == 5.0 + 1000000 * 0.1);
}

/* A million changes between two steps: the sum is that of exact numbers, to its last bit. */
static void changed_steps_lose_nothing(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, 1000.0, false, 0.0);
    for (int k = 0; k < 1000000; k++) {
        fmu_clock_change_step(&clock, 0.001);
        clock.ticks = 1;
    }
    fmu_clock_change_step(&clock, 1.0);
    TEST_ASSERT_TRUE(clock.ticks == 0 && clock.communication_s == 0.0);
    TEST_ASSERT_TRUE(fmu_clock_now(&clock) - 2000.0 < 1e-12 && fmu_clock_now(&clock) - 2000.0 > -1e-12);
}

static void the_stop_time_is_passed_by_more_than_rounding_and_a_millionth_of_a_step(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, 0.0, true, 10.0);
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 10.0 + 0.9e-8, 0.0));
    TEST_ASSERT_TRUE(fmu_clock_passes_stop(&clock, 10.0 + 1.1e-8, 0.0));
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 10.0 + 0.9e-6, 1.0));
    TEST_ASSERT_TRUE(fmu_clock_passes_stop(&clock, 10.0 + 1.1e-6, 1.0));
    fmu_clock_start(&clock, -100.0, true, 10.0); /* the larger of both ends is rounded */
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 10.0 + 0.9e-7, 0.0));
    TEST_ASSERT_TRUE(fmu_clock_passes_stop(&clock, 10.0 + 1.1e-7, 0.0));
    fmu_clock_start(&clock, 0.0, false, 10.0);
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 1e9, 0.0));
    fmu_clock_start(&clock, 0.0, true, 0.5); /* also of less than a second */
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 0.5 + 0.4e-9, 0.0));
    TEST_ASSERT_TRUE(fmu_clock_passes_stop(&clock, 0.5 + 0.6e-9, 0.0));
    fmu_clock_start(&clock, 0.0, true, 0.0); /* the border itself */
    TEST_ASSERT_FALSE(fmu_clock_passes_stop(&clock, 0.0, 0.0));
}

static void a_time_before_the_start_is_before_it_by_more_than_rounding(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, -20.0, false, 0.0);
    TEST_ASSERT_FALSE(fmu_clock_is_before_start(&clock, -20.0 - 1.9e-8));
    TEST_ASSERT_TRUE(fmu_clock_is_before_start(&clock, -20.0 - 2.1e-8));
    TEST_ASSERT_FALSE(fmu_clock_is_before_start(&clock, -20.0 - 1e-9 * 20.0)); /* the border itself */
}

static void a_solver_may_look_beyond_the_stop_by_a_fiftieth_of_the_run_on_its_way(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, 10.0, true, 20.0);
    TEST_ASSERT_FALSE(fmu_clock_allows_overshoot(&clock, 20.1)); /* before the first step */
    clock.completed_s = 15.0;
    TEST_ASSERT_TRUE(fmu_clock_allows_overshoot(&clock, 20.19));
    TEST_ASSERT_FALSE(fmu_clock_allows_overshoot(&clock, 20.201));
    fmu_clock_start(&clock, 0.0, true, 50.0);
    clock.completed_s = 1.0;
    TEST_ASSERT_TRUE(fmu_clock_allows_overshoot(&clock, 51.0));
    clock.completed_s = 50.0;
    TEST_ASSERT_FALSE(fmu_clock_allows_overshoot(&clock, 50.5));
}

/* Importers add up their times: who has come to the stop time but for a billionth of the run has come there. */
static void a_solver_is_on_its_way_until_a_billionth_of_the_run_is_left(void) {
    fmu_clock clock;
    fmu_clock_start(&clock, 0.0, true, 1e6);
    clock.completed_s = 1e6 - 1.1e-3;
    TEST_ASSERT_TRUE(fmu_clock_allows_overshoot(&clock, 1e6 + 1));
    clock.completed_s = 1e6 - 0.9e-3;
    TEST_ASSERT_FALSE(fmu_clock_allows_overshoot(&clock, 1e6 + 1));
    fmu_clock_start(&clock, 0.0, true, 1.0);
    clock.completed_s = 1.0 - 1e-9 * 1.0; /* the border itself */
    TEST_ASSERT_FALSE(fmu_clock_allows_overshoot(&clock, 1.01));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_clock_counts_ticks_and_does_not_add_them_up);
    RUN_TEST(changed_steps_lose_nothing);
    RUN_TEST(the_stop_time_is_passed_by_more_than_rounding_and_a_millionth_of_a_step);
    RUN_TEST(a_time_before_the_start_is_before_it_by_more_than_rounding);
    RUN_TEST(a_solver_may_look_beyond_the_stop_by_a_fiftieth_of_the_run_on_its_way);
    RUN_TEST(a_solver_is_on_its_way_until_a_billionth_of_the_run_is_left);
    return UNITY_END();
}
