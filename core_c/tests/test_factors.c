/* Tests of factors.c: what counts as finite; test_filter.c and test_bits_filter.c see the factors at work. */
#include "../filter/factors.h"

#include "check.h"

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
    RUN_TEST(a_covariance_is_finite_if_all_its_numbers_are);
    return UNITY_END();
}
