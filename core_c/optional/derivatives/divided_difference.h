/* Divided differences of functions of a damping rate. */
#ifndef LACONIC_DIVIDED_DIFFERENCE_H
#define LACONIC_DIVIDED_DIFFERENCE_H

#include "common.h"

/* Gauss' quadrature of five points on −1 … 1: where h·r of two rates are at most 1 apart, the mean of the slope
 * between them to 1e-13, without the cancellation of a difference. */
#define SLOPE_POINTS 5
static const real slope_point[SLOPE_POINTS] = {R(0), R(0.53846931010568309104), R(-0.53846931010568309104),
                                               R(0.90617984593866399280), R(-0.90617984593866399280)};
static const real slope_share[SLOPE_POINTS] = {R(0.28444444444444444444), R(0.23931433524968323402),
                                               R(0.23931433524968323402), R(0.11846344252809454376),
                                               R(0.11846344252809454376)};

#define MOST_FUNCTIONS 40

/* `count` functions of a rate, for a step of h. */
typedef void (*functions_of_rate)(real value[], real h, real rate);

/* (f(a) − f(b))/(a − b) of each, from f or from its slope. */
static inline void divided_difference_of(real out[], int count, functions_of_rate value, functions_of_rate slope,
                                         real h, real a, real b) {
    real at[MOST_FUNCTIONS];
    for (int k = 0; k < count; k++) out[k] = R(0);
    if (magnitude(h * (a - b)) > R(1)) {
        value(at, h, a);
        for (int k = 0; k < count; k++) out[k] = at[k] / (a - b);
        value(at, h, b);
        for (int k = 0; k < count; k++) out[k] -= at[k] / (a - b);
        return;
    }
    for (int i = 0; i < SLOPE_POINTS; i++) {
        slope(at, h, R(0.5) * (a + b) + R(0.5) * (b - a) * slope_point[i]);
        for (int k = 0; k < count; k++) out[k] += slope_share[i] * at[k];
    }
}

#endif
