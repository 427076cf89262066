/* Error estimate of a run: how far the numbers of a plant are from the exact solution of its equations.
 * docs/accuracy.md derives it and has measured figures.
 *
 *     laconic_estimate_start(&estimate, &plant, 16, laconic_finer_method(&plant), &why);
 *     laconic_estimate_run(&estimate, &plant, &input, 1000, &why);    the bits of laconic_plant_run
 *     laconic_estimate_read(&errors, &estimate, &plant);              errors.now.place_m: the distance in metres
 *
 * Optional: a program that calls nothing of it carries nothing of it.
 *
 * What      the first step of each window of up to K steps is taken again as two half steps. What they differ by
 *           stands for the error of each step of the window. It is carried on by the linearised motion: damping,
 *           gyroscopic rotation, and the path that an error of the heading turns. After a change of the input windows
 *           begin at one step and double. Beside it stands what rounding makes at least.
 * Friction  a vehicle with friction has a twin, which takes two half steps for each step: the error is twice (first
 *           order) what plant and twin differ by. K does not count there.
 * Counts    as error: of the method, and of rounding. Not: of the vehicle's numbers, and of an input that varies
 *           between the samples that a step takes.
 * Cost      two half steps and some 3,000 instructions for each window; the plant's bits stay the same.
 * Memory    the caller owns every struct; no heap, no globals. Plain data: copy it with its plant to save both. */
#ifndef LACONIC_ESTIMATE_H
#define LACONIC_ESTIMATE_H

#include "laconic/laconic.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sizes of an error of the state; infinity where one leaves the scalar type's range. */
typedef struct laconic_error {
    laconic_real nu_rad_per_s;    /* of the component of ν that is farthest off */
    laconic_real place_m;         /* distance of the centre of mass S from its true place */
    laconic_real heading_rad;     /* of the heading                             */
    laconic_real wheel_angle_rad; /* of the wheel that is farthest off          */
} laconic_error;

/* The known error of a plant. */
typedef struct laconic_errors {
    laconic_error now;      /* at this moment, rounding included                          */
    laconic_error largest;  /* at any window's end since the start, and now               */
    laconic_error rounding; /* the part of `now` that rounding makes whatever the step is */
    uint64_t unknown;       /* steps of which no half was taken: all that they change counts as error. 0: none */
} laconic_errors;

/* Longest windows: K is 1 … LACONIC_ESTIMATE_MOST. */
#define LACONIC_ESTIMATE_USUAL 16
#define LACONIC_ESTIMATE_MOST 1024

/* Do not rely on the members. */
typedef struct laconic_estimate {
    int32_t most_steps;             /* K                                                         */
    laconic_integrator halves;      /* the plant's method for half of its step                   */
    laconic_integrator finer;       /* that of the half steps, unless it refuses one              */
    laconic_real decay[3][3];       /* of one step, each axis: e^−a, hφ1, h²φ2 at a = h r         */
    laconic_real angle_per_zeta[2]; /* bounds of |w||g| and of the yaw rate, over |ζ|              */

    laconic_real zeta[3], travel[3], place_m[2];                /* error at the window's start: plant less truth    */
    laconic_real floor_zeta, floor_travel, floor_path_m;        /* what rounding makes at least, then       */
    laconic_real doubt_zeta[3], doubt_travel[3], doubt_place_m; /* a share of all that the error has changed */
    laconic_error largest;
    laconic_real origin_m[2], extent_m; /* place at the start of the estimate; the farthest from there since */
    uint64_t unknown;

    int32_t length, taken;        /* steps that the window may have; those that it has               */
    bool begun;                   /* the plant has had a step before                                 */
    laconic_input input;          /* of the last step, at its end                                    */
    laconic_state start, twin;    /* plant at the window's start; and after two half steps           */
    laconic_real local[8];        /* error of one step: ζ, travel, place                             */
    laconic_real fading;          /* what of it is left after as many steps as the last window had, at most 1 */
    int32_t last_length;          /* of the last window */
    laconic_real first_path_m[2]; /* way of the window's first step                                  */
    laconic_forcing forcing;      /* at the window's start: how b follows the heading                 */
#if LACONIC_WITH_FRICTION
    laconic_slip twin_slip; /* with friction: of the copy */
#endif
} laconic_estimate;

/* An estimate of no error, for a plant that stands where it is, with windows of up to `most_steps` steps. Start it
 * again after laconic_plant_restart and where the state was set. Refuses ABOVE_LIMIT (step) where
 * most_steps is not 1 … LACONIC_ESTIMATE_MOST, and as laconic_integrator_prepare() does for half of the step. */
laconic_status laconic_estimate_start(laconic_estimate *estimate, const laconic_plant *plant, int32_t most_steps,
                                      const laconic_method *finer, laconic_refusal *why);

/* After laconic_plant_set_step or _change: continues with the previous error, from the plant as it was `before` to
 * `plant`, whose state is the same motion. If friction begins or ends with the change, it starts anew. Refuses, and
 * leaves all as it was, as laconic_estimate_start() does. */
laconic_status laconic_estimate_carry(laconic_estimate *estimate, const laconic_plant *before,
                                      const laconic_plant *plant, const laconic_method *finer, laconic_refusal *why);

/* Returns the method for the half steps of a plant: its own, or with fast damping that of eighth order. Methods
 * whose order falls there err in two half steps nearly as in one. Links that method. */
const laconic_method *laconic_finer_method(const laconic_plant *plant);

/* laconic_plant_run() and laconic_plant_run_sampled() with an estimate that watches: the same bits and refusals. */
laconic_status laconic_estimate_run(laconic_estimate *estimate, laconic_plant *plant, const laconic_input *held,
                                    uint64_t steps, laconic_refusal *why);
laconic_status laconic_estimate_run_sampled(laconic_estimate *estimate, laconic_plant *plant,
                                            const laconic_input samples[3], laconic_refusal *why);

/* Rows of errors along a run: those of `now` at the start of each step whose number `every` divides. */
typedef struct laconic_error_rows {
    uint64_t every;     /* 0: none                                             */
    laconic_error *row; /* space for row_room                                   */
    uint64_t row_count, row_room;
} laconic_error_rows;

/* laconic_plant_follow() with an estimate that watches; `recorder` and `rows` may be NULL. Also ends when the rows
 * are full. */
laconic_status laconic_estimate_follow(laconic_estimate *estimate, laconic_plant *plant,
                                       const laconic_schedule *schedule, uint64_t until_step,
                                       laconic_recorder *recorder, laconic_error_rows *rows, laconic_refusal *why);

/* For callers that step the plant themselves. Before: `inputs` as they act in the next step, one that is held for up to
 * `steps` steps, or three samples of one step (count 3). Returns how many of the steps to take, at least one. After
 * they were taken: _after. A step that is refused needs none. */
uint64_t laconic_estimate_before(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *inputs,
                                 int32_t count, uint64_t steps);
void laconic_estimate_after(laconic_estimate *estimate, const laconic_plant *plant, uint64_t steps);

/* The errors at this moment. */
void laconic_estimate_read(laconic_errors *errors, const laconic_estimate *estimate, const laconic_plant *plant);

#ifdef __cplusplus
}
#endif
#endif
