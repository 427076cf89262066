/* Tests of polynomials.h: each is the function that its comment names, to the stated error or the rounding of the sum.
 * Compared with the host's library, and where that would cancel with Taylor's series. */
#include "polynomials.h"

#include "check.h"

#define POINTS 200
#define LAST_PLACE (double)LACONIC_EPSILON

/* (sin α − α cos α)/α³ = Σ 2k (−z)^(k−1)/(2k+1)!, k from 1. */
static double j1_of(double z) {
    double sum = 0, power = 1, factorial = 6;
    for (int k = 1; k < 12; k++) {
        sum += 2 * k * power / factorial;
        power *= -z;
        factorial *= (2 * k + 2) * (2 * k + 3);
    }
    return sum;
}

static double tangent_of(double z) {
    if (z == 0) return 1;
    return z > 0 ? tan(sqrt(z)) / sqrt(z) : tanh(sqrt(-z)) / sqrt(-z);
}

static void sine_and_cosine_up_to_an_eighth_of_a_turn(void) {
    for (int k = -POINTS; k <= POINTS; k++) {
        const laconic_real x = REAL(PI / 4 / POINTS * k);
        ASSERT_NEAR(LAST_PLACE, sin((double)x), poly_sin(x, x * x));
        ASSERT_NEAR(LAST_PLACE, cos((double)x), poly_cos(x * x));
    }
}

static void chord_over_its_arc(void) {
    for (int k = 1; k <= POINTS; k++) {
        const laconic_real z = CHORD_SMALL / POINTS * REAL(k);
        const double alpha = sqrt((double)z);
        ASSERT_NEAR(2 * LAST_PLACE, sin(alpha) / alpha, poly_sinc(z));
    }
    ASSERT_NEAR(0, 1, poly_sinc(0));
}

static void displacement_by_a_slope_of_the_speed(void) {
    for (int k = 0; k <= POINTS; k++) {
        const laconic_real z = CHORD_SMALL / POINTS * REAL(k);
        ASSERT_NEAR(EITHER(3e-12, 7e-8), j1_of((double)z), poly_j1(z));
    }
}

static void tangent_of_either_sign(void) {
    for (int k = -POINTS; k <= POINTS; k++) {
        const laconic_real z = TANGENT_SMALL / POINTS * REAL(k);
        ASSERT_NEAR(2 * LAST_PLACE, tangent_of((double)z), poly_tangent(z));
    }
}

/* A hundredth of the last term is below the last digit of the sum, and yet decides it. */
static void in_single_the_last_digit_of_the_tangent_is_right_here(void) {
    const laconic_real z = REAL(-977) / REAL(64000);
    ASSERT_NEAR(EITHER(2e-10, 3e-8), tangent_of((double)z), poly_tangent(z));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sine_and_cosine_up_to_an_eighth_of_a_turn);
    RUN_TEST(chord_over_its_arc);
    RUN_TEST(displacement_by_a_slope_of_the_speed);
    RUN_TEST(tangent_of_either_sign);
    RUN_TEST(in_single_the_last_digit_of_the_tangent_is_right_here);
    return UNITY_END();
}
