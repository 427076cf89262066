/* Tests of polynomials.h: each is the function that its comment names, to the stated error or the rounding of the sum.
 * Compared with the host's library, and where that would cancel with Taylor's series. */
#include "check.h"
#include "least_norm.h"
#include "polynomials.h"

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

/* Tests of least_norm.c. */

static void the_solution_is_exact_where_there_is_one_and_the_shortest(void) {
    const laconic_real rows[4][3] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 2}, {1, 0, -1}};
    const laconic_real wanted[3] = {4, REAL(0.5), 1};
    laconic_real solver[4][3], found[3] = {0, 0, 0};
    laconic_least_norm(solver, rows, 4);
    for (int i = 0; i < 4; i++) {
        laconic_real x = 0;
        for (int c = 0; c < 3; c++) x += solver[i][c] * wanted[c];
        for (int c = 0; c < 3; c++) found[c] += rows[i][c] * x;
    }
    ASSERT_NEAR_ALL(EITHER(1e-14, 1e-5), wanted, found, 3);
}

static void rows_of_zero_carry_nothing(void) {
    const laconic_real rows[2][3] = {{0, 0, 0}, {2, 0, 0}};
    laconic_real solver[2][3];
    laconic_least_norm(solver, rows, 2);
    TEST_ASSERT_TRUE(solver[0][0] == 0 && solver[1][1] == 0);
    ASSERT_NEAR(ROUNDING, 0.5, solver[1][0]);
}

static void rows_that_are_all_zero_carry_nothing_and_give_no_nan(void) {
    const laconic_real rows[2][3] = {{0, 0, 0}, {0, 0, 0}};
    laconic_real solver[2][3] = {{1, 1, 1}, {1, 1, 1}};
    laconic_least_norm(solver, rows, 2);
    for (int i = 0; i < 2; i++)
        for (int c = 0; c < 3; c++) TEST_ASSERT_TRUE(solver[i][c] == 0);
}

/* No unit is preferred: rows twice as long have a solution half as large, however small they are. */
static void the_solution_scales_with_the_rows(void) {
    const laconic_real rows[3][3] = {{1, REAL(0.5), 0}, {REAL(0.25), -1, 1}, {1, 0, 2}};
    laconic_real solver[3][3];
    laconic_least_norm(solver, rows, 3);
    for (int k = -24; k <= 24; k += 4) { /* powers of two, so that nothing is rounded anew */
        const laconic_real scale = REAL(ldexp(1, k));
        laconic_real scaled[3][3], found[3][3];
        for (int n = 0; n < 9; n++) scaled[n / 3][n % 3] = scale * rows[n / 3][n % 3];
        laconic_least_norm(found, (const laconic_real(*)[3])scaled, 3);
        for (int n = 0; n < 9; n++) TEST_ASSERT_TRUE(found[n / 3][n % 3] == solver[n / 3][n % 3] / scale);
    }
}

/* Sweeps beyond the fourth go on to turn the last digits of such a row: their number is one of the bits'. */
static void the_bits_are_those_of_twelve_sweeps(void) {
    const laconic_real row[1][3] = {
        {EITHER(REAL(0.021), REAL(-0.539)), EITHER(REAL(0.528), REAL(-0.938)), EITHER(REAL(0.073), REAL(-0.386))}};
    const double expected[3] = {EITHER(0x1.2e48984769305p-4, -0x1.a255fep-2),
                                EITHER(0x1.db045d0280b9dp+0, -0x1.6c01acp-1),
                                EITHER(0x1.06b2e5dc8921p-2, -0x1.2b966p-2)};
    laconic_real solver[1][3];
    laconic_least_norm(solver, row, 1);
    for (int c = 0; c < 3; c++) TEST_ASSERT_TRUE((double)solver[0][c] == expected[c]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sine_and_cosine_up_to_an_eighth_of_a_turn);
    RUN_TEST(chord_over_its_arc);
    RUN_TEST(displacement_by_a_slope_of_the_speed);
    RUN_TEST(tangent_of_either_sign);
    RUN_TEST(in_single_the_last_digit_of_the_tangent_is_right_here);
    RUN_TEST(the_solution_is_exact_where_there_is_one_and_the_shortest);
    RUN_TEST(rows_of_zero_carry_nothing);
    RUN_TEST(rows_that_are_all_zero_carry_nothing_and_give_no_nan);
    RUN_TEST(the_solution_scales_with_the_rows);
    RUN_TEST(the_bits_are_those_of_twelve_sweeps);
    return UNITY_END();
}
