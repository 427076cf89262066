/* The convex problem of one step on ground with friction. It knows wheels by their rows only, not vehicles.
 *
 * Unknowns are the body's three speeds ν and the speed s_i of each wheel. Each contact slips by two numbers, both
 * linear in them: along·ν − rim_along s along the roller axis, and k (across·ν − rim_across s) across it, k the
 * roller's drag. The speeds after the step minimise
 *
 *     ½|ν − ν*|² + Σ_i [ ½ j (s − s*)² + V(s) + ½ viscous s² + axle |s| + grip |slip| ],     V' = −motor impulse
 *
 * ν*, s* being the speeds that all other forces would lead to. The minimum exists and is unique. All terms stand in
 * units of the body's energy M R²; speeds in rad/s. */
#ifndef LACONIC_FRICTION_SOLVER_H
#define LACONIC_FRICTION_SOLVER_H

#include "vector.h"

/* What stays the same from step to step: its first part is given, the second is laconic_friction_prepare()'s. */
typedef laconic_friction_wheel friction_wheel;

/* One wheel in one step, all but the speed as impulses: force times step. */
typedef struct friction_load {
    real grip; /* h μN / (M R) >= 0; LACONIC_REAL_MAX: the contact is rigid */
    real axle; /* h T / (M R²) >= 0: dry friction of the axle */
    real drive, drive_slope,
        drive_limit; /* motor: drive − drive_slope s, cut to ±drive_limit (LACONIC_REAL_MAX: not) */
    real viscous;    /* >= 0: −viscous s beside the motor's */
    real free_speed; /* s* */
} friction_load;

void laconic_friction_prepare(friction_wheel *wheel);

/* Finds nu[3], speed[count] and the impulses that the contacts give to the ground: |impulse[i]| <= grip; the robot gets
 * −impulse[i][0] along u_i and −k impulse[i][1] along w_i, the wheel's axis rim·impulse. On entry impulse holds a
 * guess: that of the step before, or 0. Returns the number of passes, at least 1; or 0 if it refuses because the
 * numbers are not finite or FRICTION_MOST_PASSES did not suffice, and then the contents of nu, speed and impulse mean
 * nothing. count is at most LACONIC_MAX_WHEELS.
 * Accepted results have a residual of at most 1e-9, relative to the free motion (ν* and (j s* + motor)/(j + viscous +
 * slope), in the norm of these masses), and 6e-16 of the contacts' impulses where these are larger; in single of 1e-4
 * and 3e-7.
 * Speeds below 1e-10 (1e-4) of it are made exactly 0, and so is a free motion below 1e-142 rad/s (1e-14). */
#define FRICTION_MOST_PASSES 50
int32_t laconic_friction_solve(const friction_wheel wheels[], const friction_load loads[], int32_t count,
                               const real free_nu[3], real nu[3], real speed[], real impulse[][2]);

#endif
