/* Tests of friction_solver.c: cases with known results, and random ones judged by a second routine. */
#include "friction.h"

#define ACCEPTED EITHER(1e-9, 2e-5)

/* One fixed wheel at the body's centre that rolls along x. */
static problem one_wheel(double grip) {
    problem p;
    memset(&p, 0, sizeof p);
    put_wheel(&p, 0, 0, PI / 2, PI / 2, 1, 0.5);
    p.load[0].grip = REAL(grip);
    p.load[0].drive_limit = LACONIC_REAL_MAX;
    return p;
}

static void a_sliding_wheel_loses_the_grip_against_its_slip(void) {
    problem p = one_wheel(0.5);
    p.free[1] = REAL(2); /* sideways: rolling does not help */
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-6, 1.5, p.nu[1]);
    ASSERT_NEAR(1e-6, 0.5, hypot((double)p.impulse[0][0], (double)p.impulse[0][1]));
}

static void rolling_shares_the_motion_by_inertia(void) {
    problem p = one_wheel(10);
    p.free[0] = REAL(3);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-5, 2.0, p.nu[0]); /* (1 + ½) v = 3 */
    ASSERT_NEAR(1e-5, 2.0, fabs((double)p.speed[0]));
}

static void what_the_grip_can_hold_stops_to_the_last_bit(void) {
    problem p = one_wheel(1);
    p.free[1] = REAL(0.9);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.nu[0] == 0 && p.nu[1] == 0 && p.nu[2] == 0 && p.speed[0] == 0);
}

static void random_vehicles_at_random_speeds_are_solved(void) {
    int refused = 0;
    double worst = 0;
    for (int n = 0; n < 3000; n++) {
        problem p;
        random_vehicle(&p, 1 + n % 4);
        random_loads(&p);
        random_motion(&p);
        if (solve(&p) == 0)
            refused++;
        else
            worst = fmax(worst, residual_of(&p));
    }
    TEST_ASSERT_LESS_THAN(EITHER(6, 60), refused); /* 0.2 %, in single 2 % */
    TEST_ASSERT_TRUE(worst < ACCEPTED);
}

static void what_is_not_finite_is_refused(void) {
    problem p = one_wheel(1);
    p.free[0] = NOT_A_NUMBER;
    TEST_ASSERT_EQUAL_INT(0, solve(&p));
    p = one_wheel(1);
    p.load[0].free_speed = INFINITE;
    TEST_ASSERT_EQUAL_INT(0, solve(&p));
}

static void nothing_that_moves_is_no_motion(void) {
    problem p = one_wheel(1);
    p.impulse[0][0] = REAL(1);
    TEST_ASSERT_EQUAL_INT(1, solve(&p));
    TEST_ASSERT_TRUE(p.nu[0] == 0 && p.impulse[0][0] == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_sliding_wheel_loses_the_grip_against_its_slip);
    RUN_TEST(rolling_shares_the_motion_by_inertia);
    RUN_TEST(what_the_grip_can_hold_stops_to_the_last_bit);
    RUN_TEST(random_vehicles_at_random_speeds_are_solved);
    RUN_TEST(what_is_not_finite_is_refused);
    RUN_TEST(nothing_that_moves_is_no_motion);
    return UNITY_END();
}
