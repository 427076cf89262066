/* The equations that every peer integrates: (4.7) with pose and wheel angles, held voltages, one right-hand side.
 *
 * peer_scene.h is generated for a scene: PEER_WHEELS, PEER_SEGMENTS, the constant matrices and the voltages.
 * State: ν1 ν2 ν3, x, y, θ, χ1 … χN. */
#ifndef PEER_H
#define PEER_H

#include "peer_scene.h"

#define PEER_STATES (6 + PEER_WHEELS)

void peer_derivative(const double *state, const double *voltage_V, double *rates);

#endif
