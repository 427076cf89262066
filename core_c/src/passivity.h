/* No step may make energy out of nothing: the sign by which a method notices that it has failed. */
#ifndef LACONIC_PASSIVITY_H
#define LACONIC_PASSIVITY_H

#include "load.h"

/* What a method finds out about one step. */
typedef struct increment {
    vector delta; /* ζ(t+h) − ζ(t)                                                            */
    vector mean;  /* mean of ζ over the step                                                  */
    vector slope; /* 12/h² times the first moment of ζ about the middle of the step: = delta
                     where ζ changes evenly, 0 where it jumps at once                         */
} increment;

/* Relative to |ζ|² + |ζ⁺|². What an accurate step gains by its truncation error is far below. */
#define ENERGY_TOLERANCE R(0.0009765625) /* 2⁻¹⁰ */

/* What `passive` asks, with all that the loads do over the step. */
bool laconic_growth_is_driven(const laconic_model *model, const laconic_state *state, real step_s,
                              const laconic_loads *loads, const increment *by);

/* Exactly: |ζ⁺|² − |ζ|² = 2∫(b·ζ − ζ·diag(r)ζ)dt <= 2∫ b·ζ dt. Tried first as if b were held; false for NaN, and
 * in free motion for infinity. */
INLINE bool passive(const laconic_model *model, const laconic_state *state, real step_s, const laconic_loads *loads,
                    vector zeta, increment by) {
    const real before = square(zeta), after = square(plus(zeta, by.delta));
    const real excess = (R(1) - ENERGY_TOLERANCE) * after - (R(1) + ENERGY_TOLERANCE) * before;
    if (excess <= R(0)) return true;
    if (excess <= R(2) * step_s * dot(vec(loads->start->constant), by.mean)) return true;
    if (steady_over(loads)) return false;
    return laconic_growth_is_driven(model, state, step_s, loads, &by);
}

/* What to say of a step that is not. */
static inline laconic_status not_passive(increment by) {
    return is_finite(size(by.delta)) ? LACONIC_STEP_GAINS_ENERGY : LACONIC_STEP_SINGULAR;
}

#endif
