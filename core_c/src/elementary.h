/* Square root, exponential, sine and cosine: the core's own, so that every platform gives the same bits. */
#ifndef LACONIC_ELEMENTARY_H
#define LACONIC_ELEMENTARY_H

#include "internal.h"

typedef struct direction {
    real cosine, sine;
} direction;

/* √x for x >= 0 to the last bit or two; 0 for x <= 0. */
real laconic_root(real x);

/* e^−a for a >= 0, relative error a few units in the last place; 0 beyond the range. */
real laconic_decaying_exponential(real a);

/* cos and sin of an angle in rad: exact to the last digits up to |angle| ~ 10⁵ (10³ in single), beyond
 * that as exact as the angle itself is. */
direction laconic_direction_of_angle(real angle_rad);

/* cos and sin of a turn: range reduction by bits, exact for every argument. */
direction laconic_direction_of_binary_angle(laconic_binary_angle angle);

/* An angle as a turn, whole turns dropped. |angle| below 10⁹ in single, 10¹⁸ in double. */
laconic_binary_angle laconic_binary_angle_of(real angle_rad);

/* φk(−a) = ∫₀¹ e^{−(1−s)a} s^{k−1}/(k−1)! ds for k = 1 … 5 and a >= 0; phi[k], phi[0] = e^−a. */
void laconic_phi(real phi[6], real a);

#endif
