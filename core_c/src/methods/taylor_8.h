/* Numbers that the Taylor series of order 8 and its derivative share. */
#ifndef LACONIC_TAYLOR_8_H
#define LACONIC_TAYLOR_8_H

#include "gauss_points.h"

#define ORDER 8

static const laconic_number inverse[ORDER + 1] = {N(1),       N(1.0 / 2), N(1.0 / 3), N(1.0 / 4), N(1.0 / 5),
                                                  N(1.0 / 6), N(1.0 / 7), N(1.0 / 8), N(1.0 / 9)}; /* 1/(n + 1) */

#endif
