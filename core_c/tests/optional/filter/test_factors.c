/* Tests of factors.c: the factors of a matrix, and what counts as finite; test_filter.c and test_bits_filter.c see them
 * at work. */
#include "factors.h"

#include "check.h"

#define ROWS 5
#define MANY 8

/* Whole numbers from −8 to 8, the same in both types. */
static laconic_real whole_number(uint32_t *seed) {
    *seed = *seed * 1664525U + 1013904223U;
    return (laconic_real)(int32_t)(*seed >> 16) / 4096 - 8;
}

static double product_of(const laconic_factors *f, int32_t i, int32_t j) {
    double sum = 0;
    for (int32_t k = 0; k < ROWS; k++) sum += (double)f->upper[i][k] * (double)f->diagonal[k] * (double)f->upper[j][k];
    return sum;
}

/* U D Uᵀ is W diag(d) Wᵀ, and U is upper triangular with ones on its diagonal, whatever stood there before. */
static void factors_are_those_of_the_weighted_rows(void) {
    laconic_real row[LACONIC_FILTER_ERRORS][COLUMNS], weight[COLUMNS];
    double expected[ROWS][ROWS];
    laconic_factors found;
    uint32_t seed = 7;
    memset(&found, 7, sizeof found);
    memset(row, 0, sizeof row);
    for (int32_t c = 0; c < MANY; c++) weight[c] = REAL(c % 3 + 1);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t c = 0; c < MANY; c++) row[i][c] = whole_number(&seed);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t j = 0; j < ROWS; j++) {
            expected[i][j] = 0;
            for (int32_t c = 0; c < MANY; c++)
                expected[i][j] += (double)row[i][c] * (double)weight[c] * (double)row[j][c];
        }
    laconic_factors_of(&found, row, weight, ROWS, MANY);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t j = 0; j < ROWS; j++) {
            ASSERT_NEAR(EITHER(1e-12, 1e-3), expected[i][j], product_of(&found, i, j));
            if (j <= i) TEST_ASSERT_TRUE(found.upper[i][j] == (i == j ? REAL(1) : 0));
        }
    for (int32_t i = 0; i < ROWS; i++) TEST_ASSERT_TRUE(found.diagonal[i] > 0);
}

/* The last row is 0, and so is the second where it counts: neither has a part of those above it. */
static void a_row_of_which_nothing_is_left_has_no_part_of_others(void) {
    laconic_real row[LACONIC_FILTER_ERRORS][COLUMNS];
    const laconic_real weight[COLUMNS] = {REAL(2), 0, REAL(3)};
    laconic_factors found;
    memset(row, 0, sizeof row);
    memset(&found, 7, sizeof found);
    row[0][0] = row[0][1] = row[1][1] = row[2][2] = REAL(1);
    laconic_factors_of(&found, row, weight, 4, 3);
    for (int32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(i == 0 ? 2 : i == 2 ? 3 : 0, (double)found.diagonal[i]);
        for (int32_t j = 0; j < 4; j++) TEST_ASSERT_EQUAL_DOUBLE(i == j, (double)found.upper[i][j]);
    }
}

static void a_covariance_is_finite_if_all_its_numbers_are(void) {
    laconic_factors factors;
    memset(&factors, 0, sizeof factors);
    for (int32_t rows = 1; rows <= LACONIC_FILTER_ERRORS; rows++)
        for (int32_t row = 0; row < LACONIC_FILTER_ERRORS; row++)
            for (int32_t column = row; column < LACONIC_FILTER_ERRORS; column++) {
                laconic_factors wrong = factors;
                *(row == column ? &wrong.diagonal[row] : &wrong.upper[row][column]) = INFINITE;
                TEST_ASSERT_TRUE(laconic_factors_finite(&wrong, rows) == (column >= rows));
            }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(factors_are_those_of_the_weighted_rows);
    RUN_TEST(a_row_of_which_nothing_is_left_has_no_part_of_others);
    RUN_TEST(a_covariance_is_finite_if_all_its_numbers_are);
    return UNITY_END();
}
