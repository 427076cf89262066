/* A motion over one step as a series in s, from 0 to 1. */
#ifndef LACONIC_TAYLOR_H
#define LACONIC_TAYLOR_H

#include "vector.h"

#define ORDER 8

/* Coefficients of sⁿ. */
typedef struct course {
    vector zeta[ORDER + 1];
    real yaw[ORDER + 1]; /* g·ζ */
} course;

static const real inverse[ORDER + 1] = {R(1),       R(1.0 / 2), R(1.0 / 3), R(1.0 / 4), R(1.0 / 5),
                                        R(1.0 / 6), R(1.0 / 7), R(1.0 / 8), R(1.0 / 9)}; /* 1/(n + 1) */

/* g·ζ is Λ times the yaw rate: this times it is what the heading turns in a step. */
static inline real turn_of_yaw(const laconic_model *m, real h) { return h / m->yaw_scale; }

#endif
