/* Square root, exponential, sine and cosine: the core's own, so that every platform gives the same bits. */
#ifndef LACONIC_ELEMENTARY_H
#define LACONIC_ELEMENTARY_H

#include "common.h"

typedef struct direction {
    real cosine, sine;
} direction;

static inline direction direction_with(real cosine, real sine) {
    const direction d = {cosine, sine};
    return d;
}

/* √x for x >= 0 with an error of at most two units in the last place; 0 for x <= 0 and NaN. */
real laconic_root(real x);

/* e^−a for a >= 0, relative error a few units in the last place; 0 where it is below the range. */
real laconic_decaying_exponential(real a);

/* cos and sin of an angle in rad: a few units in the last place up to |angle| ~ 10⁵ (10³ in single);
 * beyond that the resolution of the angle bounds the error. */
direction laconic_direction_of_angle(real angle_rad);

/* cos and sin of a binary angle; its bits give the quarter, so range reduction is exact for every argument. */
direction laconic_direction_of_binary_angle(laconic_binary_angle angle);

/* An angle as a binary angle, without its whole turns. 0 for NaN and from |angle| ~ 10¹⁰ in single, 6·10¹⁹ in double
 * on. */
laconic_binary_angle laconic_binary_angle_of(real angle_rad);

/* φk(−a) = ∫₀¹ e^{−(1−s)a} s^{k−1}/(k−1)! ds for k = 1 … 5 and a >= 0; phi[k], phi[0] = e^−a. */
void laconic_phi(real phi[6], real a);

#endif
