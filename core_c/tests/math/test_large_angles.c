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

/* tan² of half the angle is just 1/16, up to where the increment is as precise as ζ; numbers without a rounding. */
static void up_to_a_sixteenth_the_increment_is_left_as_it_is(void) {
    const int tenths = EITHER(8, 10);
    const vector zeta = {REAL(0.1) * REAL(tenths), REAL(0.3), REAL(0.5)};
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.nu_of_zeta[2][2] = m.gyro[2] = m.gyro_square = 1;
    TEST_ASSERT_TRUE(free_flow(&m, REAL(0.5), zeta).x == REAL(EITHER(0x1.8181818181816p-5, 0x1.818188p-6)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_infinite_angle_gives_no_finite_result);
    RUN_TEST(a_rotation_by_a_large_angle_keeps_the_length);
    RUN_TEST(up_to_a_sixteenth_the_increment_is_left_as_it_is);
    return UNITY_END();
}
