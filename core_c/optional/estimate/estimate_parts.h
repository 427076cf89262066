/* What the files of the error estimate share: an error, and how the linearised motion carries it over some steps. */
#ifndef LACONIC_ESTIMATE_PARTS_H
#define LACONIC_ESTIMATE_PARTS_H

#include "step_internals.h"

#include "laconic/estimate.h"

/* An error of the state, plant less truth. Heading and wheel angles are linear in ∫ζ dt, so their errors are in that
 * of `travel`. `floor_…`: sizes of what rounding makes at least.
 * `doubt_…`: a share of all that the error has changed, since a number that passes 0 is not known to be 0. */
typedef struct state_error {
    vector zeta, travel;
    real place_m[2];
    real floor_zeta, floor_travel, floor_path_m;
    vector doubt_zeta, doubt_travel;
    real doubt_place_m;
} state_error;

/* What a window is: its steps, and the motion over them. */
typedef struct window_motion {
    int32_t steps;
    real step_s;
    vector zeta[2];    /* at start and end            */
    vector way;        /* ∫ζ dt                        */
    real path_m[2];    /* of S, world axes             */
    direction heading; /* in the middle                */
} window_motion;

/* Carries an error over a window, each step of which makes the error `local` (ζ, travel, place) of its own, less and
 * less where it fades. */
void laconic_carry_error(state_error *error, const laconic_estimate *estimate, const laconic_model *model,
                         const window_motion *motion);

/* Factors of one step, into estimate->decay. */
void laconic_carry_prepare(laconic_estimate *estimate, const laconic_model *model, real step_s);

/* The error at the moment of the plant, as far as the window has come; and the error at the window's start, set. */
state_error laconic_estimate_error_now(const laconic_estimate *estimate, const laconic_plant *plant);
void laconic_estimate_keep_error(laconic_estimate *estimate, const state_error *error);

/* How far the plant has been from where the estimate began, up to this state. */
real laconic_estimate_extent(const laconic_estimate *estimate, const laconic_state *now);

#endif
