/* What laconic.h needs to know the size of and methods share with each other. Do not rely on the contents: only sizes
 * matter to users, and firmware whose integrator is a constant gets these values from `laconic trim`. */
#ifndef LACONIC_INTERNALS_H
#define LACONIC_INTERNALS_H

#include "laconic/real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Factors of one exponential sub-step, per axis k, a = h r_k, φ at −a: docs/integrators.md derives them.
 * b over the sub-step: start + change·s + curve·s(s − 1), s from 0 to 1. */
typedef struct laconic_decay {
    laconic_real gain[3]; /* h φ1: increment per derivative                                 */
    laconic_real inverse_gain[3];
    laconic_real mean[3];       /* κ = φ2/φ1, ½ … 1: how far the mean of ζ lies along the increment, and
                                   what constant b a change of b is worth                         */
    laconic_real bend[3];       /* (2 φ3 − φ2)/φ1: what constant b a curve of b is worth          */
    laconic_real mean_ramp[3];  /* h (φ3 − κ φ2): what a change of b adds to the mean beside that */
    laconic_real mean_bend[3];  /* h (2 φ4 − φ3 − κ (2 φ3 − φ2)): the same for a curve of b       */
    laconic_real slope[3];      /* 12 (φ2/2 − φ3)/φ1: first moment along the increment, 1 … 0     */
    laconic_real slope_ramp[3]; /* its part per change of b                                       */
    laconic_real slope_bend[3]; /* its part per curve of b                                        */
} laconic_decay;

/* What acts at the start, middle and end of a step. Held inputs: three times the same pointer. */
typedef struct laconic_forcing_samples {
    const struct laconic_forcing *start, *middle, *end;
    bool steady; /* nothing varies over the step: `start` says it all                             */
} laconic_forcing_samples;

/* What laconic_auto has chosen (laconic_integrator.chosen); they cannot be prepared by themselves. */
extern const struct laconic_method laconic_auto_slow; /* exact-flow-4 or taylor-8, else exact-flow */
extern const struct laconic_method laconic_auto_fast; /* exponential-kahan-4, else exact-flow      */

#ifdef __cplusplus
}
#endif
#endif
