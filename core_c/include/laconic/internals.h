/* Types that laconic.h needs for the size of its structs and that methods share. Do not rely on their members: for
 * firmware whose integrator is a constant `laconic trim` writes the values. */
#ifndef LACONIC_INTERNALS_H
#define LACONIC_INTERNALS_H

#include "laconic/real.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A compensated sum, which keeps in `rest` what is too small for `value` to take up: its value is value + rest. */
typedef struct laconic_sum {
    laconic_real value, rest;
} laconic_sum;

typedef struct laconic_vector {
    laconic_real x, y, z;
} laconic_vector;

/* Factors of one exponential sub-step, per axis k, a = h r_k, φ at −a: docs/integrators.md derives them.
 * b over the sub-step: start + change·s + curve·s(s − 1), s from 0 to 1. */
typedef struct laconic_decay {
    laconic_real gain[3]; /* h φ1: increment per derivative                                 */
    laconic_real inverse_gain[3];
    laconic_real mean[3];       /* φ2/φ1, ½ … 1: (mean of ζ − ζ at the start)/increment; also the constant
                                   b that leads to the same end as a change of b from 0 to 1      */
    laconic_real bend[3];       /* (2 φ3 − φ2)/φ1: the same constant b for a curve of b           */
    laconic_real mean_ramp[3];  /* h (φ3 − mean φ2): the further share of a change of b in the mean */
    laconic_real mean_bend[3];  /* h (2 φ4 − φ3 − mean (2 φ3 − φ2)): the same for a curve of b    */
    laconic_real slope[3];      /* 12 (φ2/2 − φ3)/φ1, 1 … 0: 12/h² (first moment of ζ)/increment  */
    laconic_real slope_ramp[3]; /* the further share of a change of b in the slope               */
    laconic_real slope_bend[3]; /* the same for a curve of b                                      */
} laconic_decay;

/* The forcing at the start, middle and end of a step. Held inputs: three times the same pointer. */
typedef struct laconic_forcing_samples {
    const struct laconic_forcing *start, *middle, *end;
    bool is_constant; /* b over the step: start->constant */
} laconic_forcing_samples;

#if LACONIC_WITH_EXPONENTIAL_GAUSS
/* The values of laconic_integrator.chosen for laconic_auto; they cannot be prepared by themselves. */
extern const struct laconic_method laconic_auto_slow; /* for slow damping: auto.c */
extern const struct laconic_method laconic_auto_fast; /* where it is fast */
#endif

#ifdef __cplusplus
}
#endif
#endif
