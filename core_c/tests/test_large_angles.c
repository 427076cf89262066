/* Tests of the parts of exact_flow.c that large angles take, which steps show only in sum. */
#include "exact_flow.c"

#include "check.h"

static void a_rotation_by_a_large_angle_keeps_the_length(void) {
    const vector zeta = {REAL(3), REAL(4), REAL(0)};
    const vector off = {REAL(-6), REAL(0.001), REAL(0)}; /* −3, 4.001: longer than 5 */
    const vector turned = plus(zeta, length_kept(zeta.x, zeta.y, zeta.z, off));
    ASSERT_NEAR(1e-6, 5.0, sqrt((double)square(turned)));
    TEST_ASSERT_TRUE(length_kept(REAL(0), REAL(0), REAL(0), none).x == 0);
}

static void an_infinite_angle_gives_no_finite_result(void) {
    const real most = LACONIC_REAL_MAX;
    TEST_ASSERT_FALSE(is_finite(large_half_angle(most * REAL(2), REAL(1), REAL(1)).denominator));
    TEST_ASSERT_TRUE(is_finite(large_half_angle(most, REAL(1), REAL(1)).denominator));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_infinite_angle_gives_no_finite_result);
    RUN_TEST(a_rotation_by_a_large_angle_keeps_the_length);
    return UNITY_END();
}
