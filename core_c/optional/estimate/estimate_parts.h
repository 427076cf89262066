/* What the files of the error estimate share. */
#ifndef LACONIC_ESTIMATE_PARTS_H
#define LACONIC_ESTIMATE_PARTS_H

#include "linear_motion.h"

/* The error at the moment of the plant, as far as the window has come; and the error at the window's start, set. */
state_error laconic_estimate_error_now(const laconic_estimate *estimate, const laconic_plant *plant);
void laconic_estimate_keep_error(laconic_estimate *estimate, const state_error *error);

/* How far the plant has been from where the estimate began, up to this state. */
real laconic_estimate_extent(const laconic_estimate *estimate, const laconic_state *now);

#endif
