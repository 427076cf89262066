/* Least-norm solutions of three equations, of any rank. */
#ifndef LACONIC_LEAST_NORM_H
#define LACONIC_LEAST_NORM_H

#include "common.h"

/* rows C (n×3) → solver (n×3): κ = solver · f is the shortest κ with Cᵀκ = f, or the nearest to it. */
void laconic_least_norm(real solver[][3], const real rows[][3], int32_t count);

#endif
