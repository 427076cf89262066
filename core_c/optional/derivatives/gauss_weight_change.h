/* How the weights of a panel (exponential_gauss_8.h) change with the damping, as functions of a symmetric matrix. */
#ifndef LACONIC_GAUSS_WEIGHT_CHANGE_H
#define LACONIC_GAUSS_WEIGHT_CHANGE_H

#include "exponential_gauss_8.h"
#include "step_change.h"

#if LACONIC_WITH_EXPONENTIAL_GAUSS

/* Of each weight of a row: entry jk of a symmetric map, in the order 00, 11, 22, 01, 02, 12. */
typedef struct gauss_weight_change {
    real entry[6][PANEL_WEIGHTS];
} gauss_weight_change;

void laconic_gauss_weight_change_of(gauss_weight_change *change, const laconic_model *m, real h,
                                    const linear_map *damping);

/* The map of one weight, applied. */
static inline vector laconic_gauss_weight_mapped(const gauss_weight_change *c, int place, vector v) {
    const real xx = c->entry[0][place], yy = c->entry[1][place], zz = c->entry[2][place];
    const real xy = c->entry[3][place], xz = c->entry[4][place], yz = c->entry[5][place];
    return vector_of(xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z);
}

#endif
#endif
