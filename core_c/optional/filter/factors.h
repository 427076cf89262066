/* Covariances as U D Uᵀ: what prediction and readings do with them. */
#ifndef LACONIC_FACTORS_H
#define LACONIC_FACTORS_H

#include "laconic/filter.h"
#include "step_chain.h"

#define ERRORS LACONIC_FILTER_ERRORS
#define COLUMNS (LACONIC_FILTER_ERRORS + LACONIC_FILTER_NOISES)

/* Rows of the errors in the filter's order. */
static inline int32_t row_of_x(const laconic_filter *f) { return f->travels; }

static inline int32_t row_of_heading(const laconic_filter *f) { return f->travels + 2; }

static inline int32_t row_of_bias(const laconic_filter *f) { return f->travels + 3; }

static inline int32_t row_of_zeta(const laconic_filter *f) { return f->errors - f->dof; }

/* The factors of W diag(d) Wᵀ, d ≥ 0, by weighted Gram-Schmidt from the last row up (Thornton). Spoils W. */
void laconic_factors_of(laconic_factors *out, real row[][COLUMNS], const real weight[], int32_t rows, int32_t columns);

/* A number h·e + noise was read whose variance of noise is `variance` > 0: the covariance of e shrinks (Bierman).
 * `gain` gets what a unit of the residual corrects in each row. Returns the residual's variance. */
real laconic_factors_update(laconic_factors *factors, real gain[], const real h[], real variance, int32_t rows);

/* Whether every number is finite. */
bool laconic_factors_finite(const laconic_factors *factors, int32_t rows);

#endif
