/* No step may make energy out of nothing: the sign by which a method notices that it has failed. */
#ifndef LACONIC_PASSIVITY_H
#define LACONIC_PASSIVITY_H

#include "vector.h"

/* What a method finds out about one step. */
typedef struct increment {
    vector delta; /* ζ(t+h) − ζ(t)                                                            */
    vector mean;  /* mean of ζ over the step                                                  */
    vector slope; /* 12/h² times the first moment of ζ about the middle of the step: = delta
                     where ζ changes evenly, 0 where it jumps at once                         */
} increment;

/* b over one step: start + change·s + curve·s(s − 1), s from 0 to 1. */
typedef struct drive {
    vector start, change, curve;
    bool varies; /* false: change and curve are 0 and not looked at */
} drive;

/* Relative to |ζ|² + |ζ⁺|². What an accurate step gains by its truncation error is far below. */
#define ENERGY_TOLERANCE R(0.0009765625) /* 2⁻¹⁰ */

/* Exactly: |ζ⁺|² − |ζ|² = 2∫(b·ζ − ζ·diag(r)ζ)dt <= 2∫ b·ζ dt. The work is looked at only if |ζ| grew at
 * all. False for NaN, too. */
static inline bool passive(vector zeta, real step_s, const drive *b, increment by) {
    const real before = square(zeta), after = square(plus(zeta, by.delta));
    real gain, work;
    if (after <= (R(1) + ENERGY_TOLERANCE) * before) return true;
    gain = R(2) * dot(zeta, by.delta) + square(by.delta);
    work = dot(b->start, by.mean);
    if (b->varies)
        work += R(0.5) * dot(b->change, by.mean) + (R(1) / R(12)) * dot(b->change, by.slope) -
                (R(1) / R(6)) * dot(b->curve, by.mean);
    return gain - R(2) * step_s * work <= ENERGY_TOLERANCE * (before + after);
}

#endif
