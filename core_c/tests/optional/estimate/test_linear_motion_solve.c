/* Test of the equation in linear_motion.c that a window's error is found by. */
#include "linear_motion.c"

#include "check.h"

/* A determinant of just 0.05 is not usable: what is on the right then stands for the solution. */
static void a_determinant_of_just_the_least_gives_the_right_hand_side(void) {
    const vector zeta = {REAL(-0.25), REAL(0.5), 0}, right = {1, 2, 3};
    const vector edge = {REAL(EITHER(0x1.e1f00783fe1fp+0, 0x1.e2767p+0)), REAL(EITHER(0x1.3p-1, 0x1.11p-1)), 0};
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.nu_of_zeta[2][0] = m.nu_of_zeta[2][1] = m.gyro[2] = 1;
    const vector at_edge = solve(&m, zeta, edge, right);
    TEST_ASSERT_TRUE(at_edge.x == 1 && at_edge.y == 2 && at_edge.z == 3);
    const vector within = {edge.x * (1 - 64 * LACONIC_EPSILON), edge.y, 0}, found = solve(&m, zeta, within, right);
    TEST_ASSERT_TRUE(magnitude(found.x) > 10);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_determinant_of_just_the_least_gives_the_right_hand_side);
    return UNITY_END();
}
