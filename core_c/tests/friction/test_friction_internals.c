/* Tests of friction_internals.h that no solution shows: roots, pivots and a wheel's own equation at its edges. */
#include "friction_internals.h"

#include "check.h"

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
    friction_wheel w;
    friction_load l;
    memset(&w, 0, sizeof w);
    memset(&l, 0, sizeof l);
    w.inertia = 1;
    l.drive = drive;
    l.drive_slope = drive_slope;
    l.drive_limit = drive_limit;
    return turning_of(&w, &l, 0, axle, push);
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
    RUN_TEST(below_the_normal_numbers_a_root_has_the_bits_of_its_rounds);
    RUN_TEST(no_pivot_is_below_the_mass_of_the_body);
    RUN_TEST(friction_of_the_axle_holds_up_to_its_own_size);
    RUN_TEST(a_motor_at_its_limit_still_resists);
    return UNITY_END();
}
