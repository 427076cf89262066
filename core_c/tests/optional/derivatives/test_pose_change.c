/* Tests of pose_change.c at the borders of its three formulas, each of which has the last digit where it is taken. */
#include "step_change.h"

#include "check.h"

/* ½ j₁ of half the yaw. */
static laconic_real half_j1_at(double alpha) {
    pose_trace trace;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.yaw_rate_of_zeta[0] = 2;
    laconic_pose_trace(&trace, &m, vector_of(REAL(alpha), 0, 0), none);
    return trace.half_j1;
}

/* The quotient that larger angles take is a unit in the last place off here. */
static void up_to_one_radian_the_series_is_taken(void) {
    TEST_ASSERT_TRUE(half_j1_at(1) == REAL(EITHER(0x1.34658fea80cc5p-3, 0x1.34659p-3)));
}

/* So is in double, at these angles, the longer series. */
static void small_angles_take_the_shorter_series(void) {
    TEST_ASSERT_TRUE(half_j1_at(0.1203) == REAL(EITHER(0x1.48062765b2ba9p-6, 0x1.48062ap-6)));
    TEST_ASSERT_TRUE(half_j1_at(0.1152) == REAL(EITHER(0x1.3a27d09e06095p-6, 0x1.3a27d2p-6)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(up_to_one_radian_the_series_is_taken);
    RUN_TEST(small_angles_take_the_shorter_series);
    return UNITY_END();
}
