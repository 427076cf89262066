/* What is commanded at one moment, and one posture of the tree with all that is known of it. */
#ifndef LACONIC_ARTICULATED_SWEEP_H
#define LACONIC_ARTICULATED_SWEEP_H

#include "heading.h"
#include "laconic/articulated.h"
#include "vector.h"

#if LACONIC_MAX_BODIES > 0

#define BODIES (LACONIC_MAX_BODIES + 1)

/* Beyond it squares would leave the range within a few steps. No vehicle is as fast. */
#ifdef LACONIC_SINGLE
#define LARGEST_ETA R(1e9)
#else
#define LARGEST_ETA R(1e77)
#endif

/* ------------------------------------------------------------ what is commanded, at one moment -- */

typedef struct articulated_drive {
    vector force[BODIES];            /* of motors, and on body 0 of the input's wrench; own axes */
    real torque[LACONIC_MAX_BODIES]; /* of free and motor hinges without damping and spring      */
    real rate[LACONIC_MAX_BODIES];   /* r of prescribed hinges                                   */
    real acceleration[LACONIC_MAX_BODIES];
    vector twist[3]; /* T, T', T'' of S_0                                        */
    bool turns;      /* T' or T'' is not 0                                       */
    real world_force[2], world_force_point[2];
    bool rotates; /* a force fixed in the world acts                          */
} articulated_drive;

/* ------------------------------------------------------------------------ the posture and its sweep -- */

typedef struct articulated_sweep {
    vector twist[BODIES];                 /* X_b          */
    vector bias[BODIES];                  /* γ_b          */
    real rate[LACONIC_MAX_BODIES];        /* ψ_b' */
    direction toward[LACONIC_MAX_BODIES]; /* (cos ψ, sin ψ) */
    real angle_rad[LACONIC_MAX_BODIES];   /* ψ less its rest, only of hinges with a spring */
    vector force[BODIES];                 /* what acts at the body and beyond, less I_b γ_b */
    laconic_form inertia[BODIES];         /* of the body and what follows it                */
    vector own[LACONIC_MAX_BODIES];       /* momentum that 1 rad/s of own hinge k has, seen at one body */
    vector row[LACONIC_MAX_LEFT_ROWS];    /* left row, seen at one body                                 */
    real row_of_own[LACONIC_MAX_LEFT_ROWS][LACONIC_MAX_BODIES];
    real row_bias[LACONIC_MAX_LEFT_ROWS], row_value[LACONIC_MAX_LEFT_ROWS];
    vector along[1]; /* U = T/|T| in the metric of body 0, where it is commanded   */
    vector along_rate;
    real along_share;  /* T·I₀T'/|T|²                                                                          */
    real least_square; /* |w|² of a hinge without direction                                                    */
    real module_mass, module_push; /* of coordinated leaves, seen along U; 0 where they are summed at the root       */
    real inverse_size
        [BODIES]; /* 1/|w| of coordinated hinges, 1/|T| of body 0, of the posture before; 0: unknown       */
    real mass[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES]; /* lower half                                     */
    real push[LACONIC_MAX_VELOCITIES];                         /* right side                                     */
    real left[LACONIC_MAX_LEFT_ROWS][LACONIC_MAX_VELOCITIES];  /* C                                              */
} articulated_sweep;

static inline vector form_times(const laconic_form *f, vector v) {
    return vector_of(f->xx * v.x + f->xy * v.y + f->xw * v.z, f->xy * v.x + f->yy * v.y + f->yw * v.z,
                     f->xw * v.x + f->yw * v.y + f->ww * v.z);
}

/* The parent's twist at the hinge, in the child's axes. */
static inline vector carried(const laconic_link *link, direction d, vector parent) {
    const real x = parent.x - parent.z * link->hinge.y, y = parent.y + parent.z * link->hinge.x;
    return vector_of(d.cosine * x + d.sine * y, d.cosine * y - d.sine * x, parent.z);
}

/* −n·V/ℓ */
static inline real following_rate(const laconic_link *link, vector v) {
    return -(link->axle_per_lever.x * v.x + link->axle_per_lever.y * v.y);
}

#endif
#endif
