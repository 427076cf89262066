/* Numbers that the Taylor series of order 8 and its derivative share: 1/(n + 1), and the quadrature of the pose. */
#ifndef LACONIC_TAYLOR_8_H
#define LACONIC_TAYLOR_8_H

#include "common.h"

#define ORDER 8
#define NODES 4 /* of Gauss' quadrature on 0 … 1, exact to degree 7 */

#define N(x) ((laconic_number)(x)) /* R(x) in tables */

static const laconic_number inverse[ORDER + 1] = {N(1),       N(1.0 / 2), N(1.0 / 3), N(1.0 / 4), N(1.0 / 5),
                                                  N(1.0 / 6), N(1.0 / 7), N(1.0 / 8), N(1.0 / 9)}; /* 1/(n + 1) */

static const laconic_number node[NODES] = {N(0.069431844202973712388), N(0.33000947820757186760),
                                           N(0.66999052179242813240), N(0.93056815579702628761)};
static const laconic_number weight[NODES] = {N(0.17392742256872692869), N(0.32607257743127307131),
                                             N(0.32607257743127307131), N(0.17392742256872692869)};

#endif
