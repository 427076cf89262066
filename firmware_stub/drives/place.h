/* Places of an encoder, and motion from place to place with limited speed and acceleration. */
#ifndef LACONIC_DRIVES_PLACE_H
#define LACONIC_DRIVES_PLACE_H

#include "laconic/laconic.h"

/* Counts since the start and a share of a count, 0 to 1. Unlike one real number it keeps its resolution over any
 * distance, in both scalar types. Counts wrap at the ends of int64_t. */
typedef struct drive_place {
    int64_t count;
    laconic_real rest;
} drive_place;

/* `turns` is finite; more than 2^30 of them are taken as that many. */
drive_place place_at(laconic_real turns, int32_t counts_per_turn);

/* What place_at() turns into the place, but for rounding. */
laconic_real place_turns(drive_place place, int32_t counts_per_turn);

/* Moved by counts; more than 2^31 of them are taken as that many. */
drive_place place_moved(drive_place place, laconic_real counts);

drive_place place_sum(drive_place a, drive_place b);
drive_place place_difference(drive_place a, drive_place b);
laconic_real place_counts(drive_place place);

/* A motion that starts at any speed and arrives at `target` with `target_speed`. Speeds are counts a second. */
typedef struct drive_motion {
    drive_place place, target;
    laconic_real speed, target_speed;
    laconic_real speed_limit;                /* > 0; not finite: none */
    laconic_real acceleration, deceleration; /* > 0 */
} drive_motion;

/* One step of the motion, the target moving too. True once it has arrived: place and speed are the target's. */
bool motion_step(drive_motion *motion, laconic_real step_s);

#endif
