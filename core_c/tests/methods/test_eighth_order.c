/* Tests of eighth_order.h: the directions at the nodes. */
#include "eighth_order.h"

#include "check.h"

/* Their sum is just what the polynomials go to. As a share of a turn, which larger angles become, the small one would
 * lose its digits. */
static void at_the_border_a_small_angle_keeps_its_digits(void) {
    const real small = REAL(EITHER(1e-18, 1e-9));
    real cosine[NODES], sine[NODES], angle[NODES] = {REAL(0.78), 0, 0, small};
    TEST_ASSERT_TRUE(angle[0] + small == REAL(0.78));
    directions_at_nodes(cosine, sine, angle);
    TEST_ASSERT_TRUE(sine[3] == small && cosine[3] == 1);
    ASSERT_NEAR(2 * LACONIC_EPSILON, sin(0.78), sine[0]);
    ASSERT_NEAR(2 * LACONIC_EPSILON, cos(0.78), cosine[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(at_the_border_a_small_angle_keeps_its_digits);
    return UNITY_END();
}
