/* Tests of friction_solver.c at the very edges of its tolerances, which one exact wheel reaches to the last bit. */
#include "friction_internals.h"

#include "check.h"
#include "friction.h"

/* One wheel whose roller's axis and the direction across it are given, so that its rows have no rounded sines. */
static problem one_exact_wheel(const double along[3], const double across[3], double inertia, double drag) {
    problem p;
    memset(&p, 0, sizeof p);
    friction_wheel *w = &p.wheel[p.count++];
    for (int k = 0; k < 3; k++) {
        w->along[k] = REAL(along[k]);
        w->across[k] = REAL(across[k]);
    }
    w->rim_along = 1;
    w->inertia = REAL(inertia);
    w->drag = REAL(drag);
    laconic_friction_prepare(w);
    p.load[0].grip = p.load[0].drive_limit = LACONIC_REAL_MAX;
    return p;
}

/* In single both are of the order of the tolerance after the third pass, and together above it. */
static void residual_and_imbalance_are_within_the_tolerance_together(void) {
    const double along[3] = {-1, 0, -0.25}, across[3] = {0, -1, 0.375};
    problem p = one_exact_wheel(along, across, 0.375, 1);
    friction_load *l = &p.load[0];
    l->grip = l->free_speed = p.speed[0] = REAL(0.625);
    l->drive_limit = REAL(0.125);
    l->viscous = REAL(0.25);
    p.free[0] = p.nu[0] = REAL(0.125);
    p.free[1] = p.nu[1] = REAL(-0.625);
    TEST_ASSERT_EQUAL_INT(4, solve(&p));
}

/* It slides; in single the argument comes to lie on the border itself, where slip outwards tells nothing yet. */
static void on_the_border_of_its_grip_a_contact_sticks(void) {
    const double along[3] = {-1, 0, -1}, across[3] = {0, -1, 0};
    problem p = one_exact_wheel(along, across, 0.25, 1);
    p.load[0].grip = REAL(0.125);
    p.load[0].axle = REAL(0.25);
    p.load[0].free_speed = p.speed[0] = REAL(-0.625);
    p.free[1] = p.nu[1] = REAL(0.875);
    TEST_ASSERT_EQUAL_INT(EITHER(2, 3), solve(&p));
}

/* A braked wheel in the air has all the energy of the free motion, the body what counts as rest, to the last bit. */
static void rest_is_a_share_of_the_free_motion_to_the_last_bit(void) {
    const double share = EITHER(1e-10, 1e-4);
    const double along[3] = {1, 0, 0}, across[3] = {0, 1, 0};
    for (int k = 0; k < 50; k++) {
        for (int n = -8; n <= 8; n++) {
            problem p = one_exact_wheel(along, across, 1, 1);
            p.load[0].grip = 0;
            p.load[0].axle = 100;
            p.load[0].free_speed = p.speed[0] = REAL(1 + 0.07 * k);
            const laconic_real energy = p.speed[0] * p.speed[0]; /* beside which the body's is lost */
            const laconic_real rest = REAL(share) * REAL(share) * energy;
            const laconic_real speed = REAL(sqrt((double)rest)) * (1 + REAL(n) * LACONIC_EPSILON / 2);
            p.free[0] = p.nu[0] = speed;
            TEST_ASSERT_GREATER_THAN(0, solve(&p));
            TEST_ASSERT_TRUE(p.nu[0] == (speed * speed > rest ? speed : 0));
        }
    }
}

/* What is left is nearly all that fits, which is no reason not to pass exactly: along the path it is not solved. */
static void the_first_pass_is_exact_however_large_the_residual(void) {
    const double along[3] = {0, 1, 1}, across[3] = {-1, 0, 0};
    const laconic_real large = EITHER(REAL(0x1p508), REAL(0x1p60));
    problem p = one_exact_wheel(along, across, 0.0625, 1);
    p.load[0].grip = large;
    p.load[0].free_speed = p.speed[0] = 5 * large;
    p.free[0] = p.nu[0] = -6 * large;
    p.free[1] = p.nu[1] = 6 * large;
    p.free[2] = p.nu[2] = -13 * large;
    TEST_ASSERT_EQUAL_INT(EITHER(6, 5), solve(&p));
}

/* A wheel in the air, pushed by its motor with just the least energy that is one. */
static void the_least_energy_moves(void) {
    const double along[3] = {1, 0, 0}, across[3] = {0, 1, 0};
    problem p = one_exact_wheel(along, across, EITHER(0x1.357c299a88ea7p+2, 0x1.b7cdfap+0), 1);
    p.load[0].grip = 0;
    p.load[0].drive = EITHER(REAL(0x1p-470), REAL(0x1p-46));
    const laconic_real energy = p.load[0].drive * p.load[0].drive / p.wheel[0].inertia;
    const laconic_real tolerance = EITHER(REAL(1e-12), REAL(1e-5));
    TEST_ASSERT_TRUE(energy == LACONIC_REAL_MIN / (tolerance * tolerance));
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.speed[0] > 0);
    p.load[0].drive *= 1 - LACONIC_EPSILON;
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.speed[0] == 0);
}

/* Rollers that drag by so little that across them there is no slip by just the bound: the impulse there stays. */
static void across_rollers_that_hardly_drag_an_impulse_stays(void) {
    const double along[3] = {1, 0, 0}, across[3] = {0, 1, 0};
    problem p = one_exact_wheel(along, across, 0.625, 0);
    const laconic_real bound = REAL(1e-30) * p.wheel[0].mobility, guess = REAL(sqrt((double)bound));
    for (int n = -8; n <= 8 && p.wheel[0].drag * p.wheel[0].drag != bound; n++)
        p.wheel[0].drag = guess * (1 + REAL(n) * LACONIC_EPSILON / 2);
    laconic_friction_prepare(&p.wheel[0]);
    TEST_ASSERT_TRUE(p.wheel[0].drag * p.wheel[0].drag == REAL(1e-30) * p.wheel[0].mobility);
    p.load[0].grip = REAL(0.125);
    p.free[0] = p.nu[0] = 2;
    p.free[1] = p.nu[1] = 1;
    p.impulse[0][1] = -(p.wheel[0].drag / p.wheel[0].mobility); /* so that it slips along alone */
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.impulse[0][0] == REAL(0.125) && p.impulse[0][1] < 0);
}

/* Where grip over slip is as stiff as the penalty, the penalty's law is taken, which goes on from the impulse. */
static void a_slip_that_is_as_stiff_as_the_penalty_has_these_bits(void) {
    const double along[3] = {1, 0, 0}, across[3] = {0, 1, 0}, penalty = EITHER(1e5, 300);
    problem p = one_exact_wheel(along, across, 0.5, 1);
    TEST_ASSERT_TRUE(p.wheel[0].mobility == 4);
    p.load[0].grip = REAL(ldexp(4 * penalty, -24));
    p.impulse[0][1] = p.load[0].grip / 8;
    p.free[0] = p.nu[0] = REAL(4 * ldexp(4 * penalty + 1, -24));
    p.free[1] = p.nu[1] = -3 * p.impulse[0][1];
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE((double)p.impulse[0][1] == EITHER(-0x1.1b6830535213ep-8, -0x1.b2b5c6p-17));
}

/* After the last pass residual and imbalance are the tolerance, to the last bit: more than that would take more. */
static void a_residual_of_just_the_tolerance_is_solved(void) {
    const double along[3] = {1, 0, -0.125}, across[3] = {0, 1, -0.75};
    problem p = one_exact_wheel(along, across, 1, 0);
    friction_load *l = &p.load[0];
    l->grip = p.impulse[0][1] = REAL(0.75);
    l->axle = REAL(0.1875);
    l->drive_slope = REAL(0.25);
    l->drive_limit = REAL(0.5);
    l->viscous = REAL(0.125);
    l->free_speed = p.speed[0] = REAL(-0.875);
    p.free[0] = p.nu[0] = REAL(0.125);
    p.free[1] = p.nu[1] = EITHER(REAL(-0x1.22d81eb021127p-2), REAL(-0x1.aef388p-1));
    p.free[2] = p.nu[2] = REAL(-0.5);
    TEST_ASSERT_EQUAL_INT(EITHER(6, 4), solve(&p));
}

/* A pass leaves a tenth of the residual, to the last bit: it was worth it, and exact passes go on. */
static void a_pass_that_leaves_just_a_tenth_is_worth_it(void) {
    const double along[3] = {EITHER(-1, 0), EITHER(0, 1), -0.625};
    const double across[3] = {EITHER(0, -1), EITHER(-1, 0), EITHER(-1, 0.5)};
    problem p = one_exact_wheel(along, across, EITHER(1, 0.5), 0);
    friction_load *l = &p.load[0];
    l->grip = REAL(EITHER(0.375, 0.5));
    l->axle = REAL(EITHER(0.25, 0.1875));
    l->drive_slope = REAL(EITHER(0, 0.25));
    if (IN_DOUBLE) l->drive_limit = REAL(0.5);
    l->viscous = REAL(0.125);
    l->free_speed = p.speed[0] = REAL(EITHER(1, -0.125));
    p.impulse[0][1] = REAL(EITHER(-0.375, 0));
    p.free[0] = p.nu[0] = REAL(EITHER(0.75, -1));
    p.free[1] = p.nu[1] = REAL(EITHER(0.25, 1));
    p.free[2] = p.nu[2] = EITHER(REAL(-0x1.1b405ea5dd78p-1), REAL(0x1.a263c8p-2));
    TEST_ASSERT_EQUAL_INT(EITHER(6, 4), solve(&p));
}

/* Light wheels with strong motors push against each other a million times as hard as the free motion: the rounding of
 * their impulses is more than the residual that is asked for elsewhere. */
static void wheels_that_hold_each_other_far_above_the_free_motion_are_solved(void) {
    for (int n = 0; n < 200; n++) {
        problem p;
        memset(&p, 0, sizeof p);
        const double inertia = EITHER(decades(1e-11, 1e-10), decades(1e-6, 1e-5)), push = decades(1e-3, 1e3);
        for (int i = 0; i < 4; i++) {
            friction_load *l = &p.load[i];
            put_wheel(&p, i & 1 ? 0.7 : -0.7, i & 2 ? 0.5 : -0.5, PI / 2, PI / 2, 1, inertia);
            l->grip = l->drive_limit = LACONIC_REAL_MAX;
            l->drive = REAL((i & 2 ? push : -push) * (1 + either_sign(0.1)));
            l->drive_slope = 100;
            l->free_speed = p.speed[i] = REAL(either_sign(1e-3));
        }
        for (int m = 0; m < 3; m++) p.free[m] = p.nu[m] = REAL(either_sign(1e-2));
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < EITHER(1e-9, 0.1));
    }
}

/* Tests of friction_internals.h that no solution shows: roots, pivots and a wheel's own equation at its edges. */

/* The guess is far off where a number is not normal, and the rounds end before they have settled. */
static void below_the_normal_numbers_a_root_has_the_bits_of_its_rounds(void) {
    const real x = REAL(EITHER(0x1.e7p-1066, 0x1.88p-144)), root = quick_root(x);
    TEST_ASSERT_TRUE(root == REAL(EITHER(0x1.769e5b00ac3aep-516, 0x1.76b486p-67)));
    TEST_ASSERT_TRUE((double)root < EITHER(1e-150, 1e-18));
}

static void no_pivot_is_below_the_mass_of_the_body(void) {
    TEST_ASSERT_TRUE(pivot(1 - LACONIC_EPSILON) == 1);
    TEST_ASSERT_TRUE(pivot(1 + LACONIC_EPSILON) == 1 + LACONIC_EPSILON);
}

/* A wheel with the inertia 1 under a push. */
static turning pushed(real push, real axle, real drive, real drive_slope, real drive_limit) {
    friction_load l;
    memset(&l, 0, sizeof l);
    l.drive = drive;
    l.drive_slope = drive_slope;
    l.drive_limit = drive_limit;
    return turning_of(1, &l, 0, axle, push);
}

/* What just does not move the wheel holds it. */
static void friction_of_the_axle_holds_up_to_its_own_size(void) {
    TEST_ASSERT_TRUE(pushed(2, 2, 0, 0, 1).held);
    TEST_ASSERT_TRUE(pushed(-2, 2, 0, 0, 1).held);
    TEST_ASSERT_FALSE(pushed(2 + 4 * LACONIC_EPSILON, 2, 0, 0, 1).held);
}

/* At the speed 2 the motor drives with its limit: it still gives way to a faster one. */
static void a_motor_at_its_limit_still_resists(void) {
    const turning at_limit = pushed(1, 0, 3, 1, 1), beyond = pushed(0, 0, 3, 1, 1);
    TEST_ASSERT_TRUE(at_limit.speed == 2 && at_limit.slope == 2);
    TEST_ASSERT_TRUE(beyond.speed == 1 && beyond.slope == 1);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(residual_and_imbalance_are_within_the_tolerance_together);
    RUN_TEST(on_the_border_of_its_grip_a_contact_sticks);
    RUN_TEST(rest_is_a_share_of_the_free_motion_to_the_last_bit);
    RUN_TEST(the_first_pass_is_exact_however_large_the_residual);
    RUN_TEST(the_least_energy_moves);
    RUN_TEST(across_rollers_that_hardly_drag_an_impulse_stays);
    RUN_TEST(a_slip_that_is_as_stiff_as_the_penalty_has_these_bits);
    RUN_TEST(a_residual_of_just_the_tolerance_is_solved);
    RUN_TEST(a_pass_that_leaves_just_a_tenth_is_worth_it);
    RUN_TEST(wheels_that_hold_each_other_far_above_the_free_motion_are_solved);
    RUN_TEST(below_the_normal_numbers_a_root_has_the_bits_of_its_rounds);
    RUN_TEST(no_pivot_is_below_the_mass_of_the_body);
    RUN_TEST(friction_of_the_axle_holds_up_to_its_own_size);
    RUN_TEST(a_motor_at_its_limit_still_resists);
    return UNITY_END();
}
