/* Tests of elementary.c against libm, over the whole range. */
#include "check.h"
#include "elementary.h"
#include "exact_flow.c"

static double relative(double expected, double actual) {
    return fabs(actual - expected) / (fabs(expected) > 0 ? fabs(expected) : 1);
}

static void the_square_root_is_right_to_the_last_bits_over_the_whole_range(void) {
    double x;
    for (x = EITHER(1e-300, 1e-36); x < EITHER(1e300, 1e38); x *= 1.7) {
        const double exact = sqrt((double)REAL(x));
        TEST_ASSERT_TRUE(relative(exact, (double)laconic_root(REAL(x))) < 2 * (double)LACONIC_EPSILON);
    }
    TEST_ASSERT_EQUAL_DOUBLE(3.0, (double)laconic_root(REAL(9)));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, (double)laconic_root(REAL(0.25)));
}

static void the_root_of_zero_or_less_is_zero_and_of_infinity_infinity(void) {
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_root(REAL(0)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_root(REAL(-4)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_root(NOT_A_NUMBER));
    TEST_ASSERT_TRUE(isinf(laconic_root(INFINITE)));
}

static void the_exponential_agrees_with_libms(void) {
    for (double a = 0; a < EITHER(700, 80); a += 0.037) {
        const double exact = exp(-(double)REAL(a));
        TEST_ASSERT_TRUE(relative(exact, (double)laconic_decaying_exponential(REAL(a))) < 8 * (double)LACONIC_EPSILON);
    }
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)laconic_decaying_exponential(REAL(0)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_decaying_exponential(REAL(1e4)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_decaying_exponential(INFINITE));
}

static void the_exponential_is_zero_from_the_end_of_the_range_on(void) {
    const double end = EITHER(745, 103);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)laconic_decaying_exponential(REAL(end)));
    TEST_ASSERT_TRUE(laconic_decaying_exponential(REAL(end - 1)) > 0);
}

static void sine_and_cosine_of_an_angle_are_libms_to_the_last_digits(void) {
    double angle;
    for (angle = EITHER(-1e5, -1e3); angle < EITHER(1e5, 1e3); angle += EITHER(7.131, 0.07131)) {
        const direction d = laconic_direction_of_angle(REAL(angle));
        ASSERT_NEAR(2 * (double)LACONIC_EPSILON, cos((double)REAL(angle)), d.cosine);
        ASSERT_NEAR(2 * (double)LACONIC_EPSILON, sin((double)REAL(angle)), d.sine);
    }
}

/* 2π·2²⁰ + 1: beyond the range of the fast reduction. */
static void the_direction_of_a_very_large_angle_is_as_exact_as_the_angle(void) {
    const laconic_real angle = REAL(6.283185307179586 * 1048576.0 * 4.0 + 1.0);
    const direction d = laconic_direction_of_angle(angle), back = laconic_direction_of_angle(-angle);
    const double tolerance = 4 * (double)angle * (double)LACONIC_EPSILON;
    ASSERT_NEAR(tolerance, cos((double)angle), d.cosine);
    ASSERT_NEAR(tolerance, sin((double)angle), d.sine);
    ASSERT_NEAR(tolerance, -sin((double)angle), back.sine);
}

/* The angle that is a million quarters when it is multiplied by 2/π, and the next one towards 0. */
static void from_a_million_quarters_on_an_angle_is_reduced_as_a_binary_angle(void) {
    const laconic_real border = REAL(EITHER(1570796.3267948965, 1570796.375));
    const laconic_real below = REAL(EITHER(nextafter(border, 0), (double)nextafterf((float)border, 0)));
    const direction at = laconic_direction_of_angle(border), near = laconic_direction_of_angle(below);
    const direction binary = laconic_direction_of_binary_angle(laconic_binary_angle_of(border));
    TEST_ASSERT_TRUE(border * REAL(0.6366197723675813431) == REAL(1e6));
    TEST_ASSERT_TRUE(at.cosine == binary.cosine && at.sine == binary.sine);
    ASSERT_NEAR(2 * (double)LACONIC_EPSILON, cos((double)below), near.cosine);
    ASSERT_NEAR(2 * (double)LACONIC_EPSILON, sin((double)below), near.sine);
}

static void a_quarter_turn_is_exact(void) {
    const laconic_binary_angle quarter = (laconic_binary_angle)1 << (sizeof(laconic_binary_angle) * 8 - 2);
    const double expected[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (unsigned k = 0; k < 4; k++) {
        const direction d = laconic_direction_of_binary_angle((laconic_binary_angle)(k * quarter));
        TEST_ASSERT_EQUAL_DOUBLE(expected[k][0], (double)d.cosine);
        TEST_ASSERT_EQUAL_DOUBLE(expected[k][1], (double)d.sine);
    }
}

static void angles_and_binary_angles_agree(void) {
    for (double angle = -20; angle < 20; angle += 0.0173) {
        const direction d = laconic_direction_of_binary_angle(laconic_binary_angle_of(REAL(angle)));
        ASSERT_NEAR(EITHER(4e-15, 3e-6), cos((double)REAL(angle)), d.cosine);
        ASSERT_NEAR(EITHER(4e-15, 3e-6), sin((double)REAL(angle)), d.sine);
    }
}

/* Its units count in pairs, towards zero, so that an angle to the right is as far as that to the left. */
static void a_binary_angle_is_even_and_the_same_to_both_sides(void) {
    for (double angle = EITHER(1e-18, 1e-9); angle < 3; angle *= 1.7) {
        const laconic_binary_angle left = laconic_binary_angle_of(REAL(angle));
        TEST_ASSERT_TRUE(left % 2 == 0);
        TEST_ASSERT_TRUE((laconic_binary_angle)(left + laconic_binary_angle_of(REAL(-angle))) == 0);
    }
}

static void an_angle_without_a_direction_counts_as_zero(void) {
    TEST_ASSERT_TRUE(laconic_binary_angle_of(NOT_A_NUMBER) == 0);
    TEST_ASSERT_TRUE(laconic_binary_angle_of(INFINITE) == 0);
    TEST_ASSERT_TRUE(laconic_binary_angle_of(REAL(1e30)) == 0);
    const laconic_real first = REAL(EITHER(5.795215566461698e19, 13493038080.0)); /* of half the range of turns */
    TEST_ASSERT_TRUE(laconic_binary_angle_of(first) == 0 && laconic_binary_angle_of(-first) == 0);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)laconic_direction_of_angle(NOT_A_NUMBER).cosine);
}

/* By the defining integral, Simpson's rule. */
static double phi_by_quadrature(int k, double a) {
    const int n = 60000;
    double sum = 0, factorial = 1;
    for (int i = 2; i < k; i++) factorial *= i;
    for (int i = 0; i <= n; i++) {
        const double s = (double)i / n, weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * exp(-(1 - s) * a) * pow(s, k - 1) / factorial;
    }
    return sum / (3.0 * n);
}

static void phi_functions_agree_with_their_integrals(void) {
    const double arguments[] = {0, 1e-6, 0.01, 0.3, 1, 2.5, 3.9, 4.0, 4.1, 10, 60};
    for (size_t i = 0; i < sizeof arguments / sizeof arguments[0]; i++) {
        laconic_real phi[6];
        laconic_phi(phi, REAL(arguments[i]));
        for (int k = 1; k <= 5; k++) {
            const double exact = phi_by_quadrature(k, (double)REAL(arguments[i]));
            ASSERT_NEAR(EITHER(4e-13, 2e-6) * exact, exact, phi[k]);
        }
    }
}

/* In 25 digits. At 4 the series would err by 17 units in the last place. */
static void at_four_the_phi_functions_are_those_from_the_exponential_upwards(void) {
    const double exact[6] = {0.01831563888873418029371802, 0.2454210902778164549265705, 0.1886447274305458862683574,
                             0.07783881814236352843291066, 0.022206962131075784558439,  0.004864926133897720527056916};
    laconic_real phi[6];
    laconic_phi(phi, REAL(4));
    for (int k = 0; k < 6; k++) ASSERT_NEAR(3 * (double)LACONIC_EPSILON * exact[k], exact[k], phi[k]);
}

static void phi_functions_stay_finite_for_any_damping(void) {
    laconic_real phi[6];
    laconic_phi(phi, REAL(1e30));
    ASSERT_NEAR(1e-6, 1.0, (double)phi[1] * 1e30);
    ASSERT_NEAR(1e-6, 1.0, (double)phi[2] * 1e30);
    ASSERT_NEAR(1e-6, 0.5, (double)phi[3] * 1e30);
}

/* ---- tests of the parts of exact_flow.c that large angles take, which steps show only in sum. */

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
    RUN_TEST(the_square_root_is_right_to_the_last_bits_over_the_whole_range);
    RUN_TEST(the_root_of_zero_or_less_is_zero_and_of_infinity_infinity);
    RUN_TEST(the_exponential_agrees_with_libms);
    RUN_TEST(the_exponential_is_zero_from_the_end_of_the_range_on);
    RUN_TEST(from_a_million_quarters_on_an_angle_is_reduced_as_a_binary_angle);
    RUN_TEST(at_four_the_phi_functions_are_those_from_the_exponential_upwards);
    RUN_TEST(sine_and_cosine_of_an_angle_are_libms_to_the_last_digits);
    RUN_TEST(the_direction_of_a_very_large_angle_is_as_exact_as_the_angle);
    RUN_TEST(a_quarter_turn_is_exact);
    RUN_TEST(angles_and_binary_angles_agree);
    RUN_TEST(a_binary_angle_is_even_and_the_same_to_both_sides);
    RUN_TEST(an_angle_without_a_direction_counts_as_zero);
    RUN_TEST(phi_functions_agree_with_their_integrals);
    RUN_TEST(phi_functions_stay_finite_for_any_damping);
    RUN_TEST(an_infinite_angle_gives_no_finite_result);
    RUN_TEST(a_rotation_by_a_large_angle_keeps_the_length);
    RUN_TEST(up_to_a_sixteenth_the_increment_is_left_as_it_is);
    return UNITY_END();
}
