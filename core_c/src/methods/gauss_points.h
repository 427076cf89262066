/* Gauss' four points on 0 … 1, and their quadrature, which is exact to degree 7. */
#ifndef LACONIC_GAUSS_POINTS_H
#define LACONIC_GAUSS_POINTS_H

#include "common.h"

#define NODES 4

#define N(x) ((laconic_number)(x)) /* R(x) in tables */

static const laconic_number gauss_node[NODES] = {N(0.069431844202973712388), N(0.33000947820757186760),
                                                 N(0.66999052179242813240), N(0.93056815579702628761)};
static const laconic_number gauss_weight[NODES] = {N(0.17392742256872692869), N(0.32607257743127307131),
                                                   N(0.32607257743127307131), N(0.17392742256872692869)};

#endif
