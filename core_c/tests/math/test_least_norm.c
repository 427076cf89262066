/* Tests of least_norm.c. */
#include "check.h"
#include "least_norm.h"

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
    RUN_TEST(the_solution_is_exact_where_there_is_one_and_the_shortest);
    RUN_TEST(rows_of_zero_carry_nothing);
    RUN_TEST(rows_that_are_all_zero_carry_nothing_and_give_no_nan);
    RUN_TEST(the_solution_scales_with_the_rows);
    RUN_TEST(the_bits_are_those_of_twelve_sweeps);
    return UNITY_END();
}
