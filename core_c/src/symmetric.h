/* What the symmetric methods share: a base step for b linear over the step, forces that turn with the
 * heading, and Richardson's extrapolation. Everything is inlined into the method that names its base. */
#ifndef LACONIC_SYMMETRIC_H
#define LACONIC_SYMMETRIC_H

#include "load.h"
#include "passivity.h"
#include "zeta.h"

/* A second-order symmetric step of size step_s/2^level from ζ; b goes linearly from `b` to b + change
 * (NULL: constant). */
typedef laconic_status (*base_step)(const laconic_model *model, const laconic_integrator *integrator, int level,
                                    const real zeta[3], const real b[3], const real *change, laconic_increment *out);

typedef struct drive { /* b over one base step, and how far the vehicle turned in it */
    real b[3], change[3];
    bool varies;
    real turn_rad;
} drive;

static inline real level_step(const laconic_integrator *integrator, int level) {
    const real fraction[3] = {R(1), R(0.5), R(0.25)};
    return integrator->step_s * fraction[level];
}

/* A force fixed in the world makes b depend on the heading at the step's end, which the step decides:
 * iterate. Three rounds leave an error of h⁷, so symmetry, which extrapolation rests on, is kept. */
static inline laconic_status turning_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                          int level, const real zeta[3], const laconic_heading *heading,
                                          real offset_rad, const laconic_load *start, const laconic_load *end,
                                          drive *d, laconic_increment *out) {
    const real h = level_step(integrator, level);
    laconic_status status = LACONIC_OK;
    int round, k;
    d->varies = true;
    d->turn_rad = h * dot(m->yaw_rate_of_zeta, zeta);
    load_now(d->b, start, heading, offset_rad);
    for (round = 0; round < 3 && status == LACONIC_OK; round++) {
        load_now(d->change, end, heading, offset_rad + d->turn_rad);
        for (k = 0; k < 3; k++) d->change[k] -= d->b[k];
        status = base(m, integrator, level, zeta, d->b, d->change, out);
        d->turn_rad = h * dot(m->yaw_rate_of_zeta, out->mean);
    }
    return status;
}

/* One base step under any pair of loads. */
static inline laconic_status driven_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                         int level, const real zeta[3], const laconic_heading *heading,
                                         real offset_rad, const laconic_load *start, const laconic_load *end,
                                         drive *d, laconic_increment *out) {
    int k;
    if (LACONIC_WITH_WORLD_FORCE && (start->turns || end->turns))
        return turning_step(base, m, integrator, level, zeta, heading, offset_rad, start, end, d, out);
    d->turn_rad = R(0); /* not asked for */
    d->varies = LACONIC_WITH_SAMPLED_INPUT && start != end;
    for (k = 0; k < 3; k++) {
        d->b[k] = start->constant[k];
        d->change[k] = end->constant[k] - start->constant[k];
    }
    return base(m, integrator, level, zeta, d->b, d->varies ? d->change : NULL, out);
}

/* The base step itself as a method. */
static inline laconic_status single_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                         const laconic_state *state, laconic_loads loads, drive *d,
                                         laconic_increment *out) {
    real zeta[3];
    take_zeta(zeta, state);
    return driven_step(base, m, integrator, 0, zeta, &state->heading, R(0), loads.start, loads.end, d, out);
}

/* (4 · two half steps − one full step)/3: the base's error has only even powers of h, so this is fourth order.
 * Mean and slope of the two halves together: the slope of a stair of two means is 3/2 of its height,
 * plus a quarter of each half's own. */
static inline laconic_status extrapolated_step(base_step base, const laconic_model *m,
                                               const laconic_integrator *integrator, const laconic_state *state,
                                               laconic_loads loads, laconic_increment *out) {
    const laconic_heading *heading = &state->heading;
    const real third = R(1) / R(3);
    laconic_increment whole, first, second;
    drive full, half;
    real zeta[3], between[3];
    laconic_status status;
    int k;
    take_zeta(zeta, state);
    status = driven_step(base, m, integrator, 0, zeta, heading, R(0), loads.start, loads.end, &full, &whole);
    if (status != LACONIC_OK) return status;
    status = driven_step(base, m, integrator, 1, zeta, heading, R(0), loads.start, loads.middle, &half, &first);
    if (status != LACONIC_OK) return status;
    for (k = 0; k < 3; k++) between[k] = zeta[k] + first.delta[k];
    status = driven_step(base, m, integrator, 1, between, heading, half.turn_rad, loads.middle, loads.end, &half,
                         &second);
    if (status != LACONIC_OK) return status;
    for (k = 0; k < 3; k++) {
        const real delta = first.delta[k] + second.delta[k];
        const real mean = R(0.5) * (first.mean[k] + second.mean[k]);
        out->delta[k] = delta + third * (delta - whole.delta[k]);
        out->mean[k] = mean + third * (mean - whole.mean[k]);
        out->slope[k] = R(1.5) * (second.mean[k] - first.mean[k]) + R(0.25) * (first.slope[k] + second.slope[k]);
    }
    return passive(zeta, integrator->step_s, full.b, full.varies ? full.change : NULL, out)
               ? LACONIC_OK
               : LACONIC_STEP_GAINS_ENERGY;
}

#endif
