/* Covariances as U D Uᵀ. D comes out of sums and products of numbers that are not negative, so it is not negative
 * either, whatever is rounded: that is why a filter in single precision does not diverge. G. J. Bierman, Factorization
 * methods for discrete sequential estimation, 1977, chapters V and VII. */
#include "factors.h"

static real product(const real a[], const real b[], int32_t columns) {
    real sum = R(0);
    for (int32_t c = 0; c < columns; c++) sum += a[c] * b[c];
    return sum;
}

/* A row of which nothing is left has no part of any other. */
void laconic_factors_of(laconic_factors *out, real row[][COLUMNS], const real weight[], int32_t rows, int32_t columns) {
    real pivot[COLUMNS];
    for (int32_t j = rows - 1; j >= 0; j--) {
        for (int32_t c = 0; c < columns; c++) pivot[c] = weight[c] * row[j][c];
        const real square = product(row[j], pivot, columns);
        for (int32_t i = 0; i < j; i++) {
            const real part = square > R(0) ? product(row[i], pivot, columns) / square : R(0);
            for (int32_t c = 0; c < columns; c++) row[i][c] -= part * row[j][c];
            out->upper[i][j] = part;
            out->upper[j][i] = R(0);
        }
        out->diagonal[j] = square;
        out->upper[j][j] = R(1);
    }
}

real laconic_factors_update(laconic_factors *factors, real gain[], const real h[], real variance, int32_t rows) {
    real sum = variance;
    for (int32_t j = 0; j < rows; j++) {
        real seen = R(0); /* (Uᵀh)_j */
        for (int32_t i = 0; i <= j; i++) seen += factors->upper[i][j] * h[i];
        const real weighed = factors->diagonal[j] * seen, before = sum, ratio = seen / before;
        sum += seen * weighed;
        factors->diagonal[j] *= before / sum;
        for (int32_t i = 0; i < j; i++) {
            const real upper = factors->upper[i][j];
            factors->upper[i][j] = upper - ratio * gain[i];
            gain[i] += upper * weighed;
        }
        gain[j] = weighed;
    }
    for (int32_t j = 0; j < rows; j++) gain[j] /= sum;
    return sum;
}

bool laconic_factors_finite(const laconic_factors *factors, int32_t rows) {
    real zero = R(0);
    for (int32_t j = 0; j < rows; j++) {
        zero += zero_if_finite(factors->diagonal[j]);
        for (int32_t i = 0; i < j; i++) zero += zero_if_finite(factors->upper[i][j]);
    }
    return zero == R(0);
}
