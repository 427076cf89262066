/* No step may make energy out of nothing: the sign by which a method notices that it has failed. */
#ifndef LACONIC_PASSIVITY_H
#define LACONIC_PASSIVITY_H

#include "internal.h"

/* Relative to |ζ|² + |ζ⁺|². What an accurate step gains by its truncation error is far below. */
#define ENERGY_TOLERANCE R(0.0009765625) /* 2⁻¹⁰ */

/* Exactly: |ζ⁺|² − |ζ|² = 2∫(b·ζ − ζ·diag(r)ζ)dt <= 2∫ b·ζ dt, for b linear in the step from b to b + change
 * (NULL: constant). The work is looked at only if |ζ| grew at all. False for NaN, too. */
static inline bool passive(const real zeta[3], real step_s, const real b[3], const real *change,
                           const laconic_increment *out) {
    const real *d = out->delta;
    const real before = dot(zeta, zeta);
    const real gain = R(2) * dot(zeta, d) + dot(d, d);
    real work;
    if (gain <= ENERGY_TOLERANCE * before) return true;
    work = dot(b, out->mean);
    if (change != NULL) work += R(0.5) * dot(change, out->mean) + (R(1) / R(12)) * dot(change, out->slope);
    return gain - R(2) * step_s * work <= ENERGY_TOLERANCE * (R(2) * before + gain);
}

#endif
