#ifndef LACONIC_ZETA_H
#define LACONIC_ZETA_H

#include "internal.h"

static inline void take_zeta(real zeta[3], const laconic_state *state) {
    zeta[0] = state->zeta[0].value;
    zeta[1] = state->zeta[1].value;
    zeta[2] = state->zeta[2].value;
}

/* ζ' = (g·ζ)(ζ×w) − diag(r)ζ + b: equation (4.7) in the coordinates of laconic_model. */
static inline void zeta_rate(real out[3], const laconic_model *m, const real z[3], const real b[3]) {
    const real yaw = dot(m->nu_of_zeta[2], z);
    int k;
    cross(out, z, m->gyro);
    for (k = 0; k < 3; k++) out[k] = yaw * out[k] + (b[k] - m->decay_per_s[k] * z[k]);
}

#endif
