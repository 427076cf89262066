/* What methods need from a model when they are prepared. */
#ifndef LACONIC_INTEGRATOR_H
#define LACONIC_INTEGRATOR_H

#include "elementary.h"

/* A build whose integrator is a prepared constant leaves preparation out. */
#define PREPARE(function) (LACONIC_WITH_PREPARE ? (function) : NULL)

#define SMALLEST_STEP_S (R(8) * LACONIC_REAL_MIN) /* one over a quarter of it is still a number */
#define LARGEST_STEP_S R(1e9)                     /* thirty years: beyond, products with speeds would leave the range */

/* max r_k */
real laconic_fastest_decay(const laconic_model *model);

/* Sets how fast a motion an explicit method bears, from where its stability ends on the real and on the imaginary
 * axis; refuses a step that is too large for the damping. */
laconic_status laconic_explicit_limits(laconic_integrator *integrator, const laconic_model *model, real largest_damping,
                                       real largest_rotation, laconic_refusal *why);

/* Factors of an exponential step of size h: decay[level] for h = step_s / 2^level. */
void laconic_decay_of(laconic_decay *decay, const laconic_model *model, real h);

/* Fills decay[0] … decay[levels − 1] of an integrator. */
void laconic_decay_levels(laconic_integrator *integrator, const laconic_model *model, int levels);

#endif
