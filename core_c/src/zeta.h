#ifndef LACONIC_ZETA_H
#define LACONIC_ZETA_H

#include "vector.h"

/* Beyond this a square would leave the range within a few steps: no vehicle moves like that. */
#ifdef LACONIC_SINGLE
#define LARGEST_SPEED R(1e9)
#else
#define LARGEST_SPEED R(1e77)
#endif

static inline vector zeta_of(const laconic_state *state) {
    const vector zeta = {state->zeta[0].value, state->zeta[1].value, state->zeta[2].value};
    return zeta;
}

/* ν → ζ: as GᵀAG = 1 and G diagonalises A, ζ = diag(1 + λ²x) Gᵀ ν, the projection onto the allowed motions. */
static inline vector zeta_of_nu(const laconic_model *m, const real nu[3]) {
    const vector first = scaled(nu[0], vec(m->nu_of_zeta[0])), second = scaled(nu[1], vec(m->nu_of_zeta[1]));
    return times(vec(m->inertia), plus(plus(first, second), scaled(nu[2], vec(m->nu_of_zeta[2]))));
}

static inline void set_zeta(laconic_state *state, vector zeta) {
    state->zeta[0] = sum_of(zeta.x);
    state->zeta[1] = sum_of(zeta.y);
    state->zeta[2] = sum_of(zeta.z);
}

/* diag(r)ζ, what the motors' damping takes off ζ'. */
static inline vector damping(const laconic_model *m, vector z) {
    return LACONIC_WITH_DAMPING ? times(vec(m->decay_per_s), z) : none;
}

/* ζ' = (g·ζ)(ζ×w) − diag(r)ζ + b: equation (4.7) in the coordinates of laconic_model. */
static inline vector zeta_rate(const laconic_model *m, vector z, vector b) {
    const vector turning = scaled(dot(vec(m->nu_of_zeta[2]), z), cross(z, vec(m->gyro)));
    return plus(minus(turning, damping(m, z)), b);
}

/* Free motion turns faster than an explicit method bears. */
static inline bool beyond_rotation(const laconic_model *m, const laconic_integrator *integrator, vector zeta) {
    return magnitude(dot(vec(m->nu_of_zeta[2]), zeta)) > integrator->gyro_limit;
}

#endif
