/* What the symmetric methods share: a base step for b quadratic over the step, forces that turn with the
 * heading, and Richardson's extrapolation. Everything is inlined into the method that names its base. */
#ifndef LACONIC_SYMMETRIC_H
#define LACONIC_SYMMETRIC_H

#include "advance.h"
#include "load.h"
#include "zeta.h"

/* A second-order symmetric step of size step_s/2^level from ζ under b. */
typedef laconic_status (*base_step)(const laconic_model *model, const laconic_integrator *integrator, int level,
                                    vector zeta, const drive *b, increment *out);

/* What a b that varies adds to one that does not. */
static inline vector response(const real ramp[3], const real bend[3], const drive *b) {
    return plus(times(vec(ramp), b->change), times(vec(bend), b->curve));
}

/* Mean and first moment of ζ over the step from its increment: exact for damping and drive alone, and
 * symmetric, so that they gain two orders by extrapolation as the increment does. */
static inline void fill(increment *out, const laconic_decay *d, vector zeta, vector delta, const drive *b) {
    out->delta = delta;
    out->mean = plus(zeta, times(vec(d->mean), delta));
    out->slope = times(vec(d->slope), delta);
    if (b->varies) {
        out->mean = plus(out->mean, response(d->mean_ramp, d->mean_bend, b));
        out->slope = plus(out->slope, response(d->slope_ramp, d->slope_bend, b));
    }
}

/* Where a part of a step begins: ζ and the angle turned since the step's start. */
typedef struct origin {
    const laconic_heading *heading;
    vector zeta;
    real turned_rad;
} origin;

/* The loads of one base step; `curve` bends b between them. */
typedef struct stretch {
    const laconic_load *start, *end;
    vector curve;
} stretch;

/* A force fixed in the world makes b depend on the heading at the step's end, which the step decides:
 * iterate. Three rounds leave an error of h⁷, so symmetry, which extrapolation rests on, is kept. */
static inline laconic_status turning_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                          int level, origin *from, const stretch *over, drive *b, increment *out) {
    const real h = integrator->step_s * (level == 0 ? R(1) : R(0.5));
    const vector yaw_rate = vec(m->yaw_rate_of_zeta);
    const real before = from->turned_rad;
    laconic_status status = LACONIC_OK;
    int round;
    from->turned_rad = before + h * dot(yaw_rate, from->zeta);
    b->start = load_now(over->start, from->heading, before);
    b->curve = over->curve;
    b->varies = true;
    for (round = 0; round < 3 && status == LACONIC_OK; round++) {
        b->change = minus(load_now(over->end, from->heading, from->turned_rad), b->start);
        status = base(m, integrator, level, from->zeta, b, out);
        from->turned_rad = before + h * dot(yaw_rate, out->mean);
    }
    return status;
}

/* One base step under any loads; `from` moves on to its end. */
static inline laconic_status driven_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                         int level, origin *from, const stretch *over, drive *b, increment *out) {
    laconic_status status;
    if (LACONIC_WITH_WORLD_FORCE && (over->start->turns || over->end->turns)) {
        status = turning_step(base, m, integrator, level, from, over, b, out);
    } else {
        b->start = vec(over->start->constant);
        b->varies = LACONIC_WITH_SAMPLED_INPUT && over->start != over->end;
        if (b->varies) {
            b->change = minus(vec(over->end->constant), b->start);
            b->curve = over->curve;
        }
        status = base(m, integrator, level, from->zeta, b, out);
    }
    from->zeta = plus(from->zeta, out->delta);
    return status;
}

/* 2 (b₀ + b₁ − 2 b½): the parabola through three samples. Of a force fixed in the world it sees the rest. */
static inline vector curve_of(const laconic_loads *loads) {
    const vector ends = plus(vec(loads->start->constant), vec(loads->end->constant));
    const vector none = {R(0), R(0), R(0)};
    if (!LACONIC_WITH_SAMPLED_INPUT || loads->start == loads->end) return none;
    return scaled(R(2), minus(ends, scaled(R(2), vec(loads->middle->constant))));
}

/* The whole step, or one of its halves: a parabola's half bends a quarter as much. */
static inline stretch whole_of(const laconic_loads *loads) {
    return (stretch){loads->start, loads->end, curve_of(loads)};
}

static inline stretch half_of(const laconic_load *start, const laconic_load *end, vector curve) {
    return (stretch){start, end, scaled(R(0.25), curve)};
}

static inline origin start_of(const laconic_state *state) {
    const origin from = {&state->heading, zeta_of(state), R(0)};
    return from;
}

/* (4 · two half steps − one full step)/3: the base's error has only even powers of h, so this is fourth order.
 * The slope of the two halves together is 3/2 of the height between their means, plus a quarter of each own. */
static inline increment combine(const increment *whole, const increment *first, const increment *second) {
    const real third = R(1) / R(3);
    const vector delta = plus(first->delta, second->delta);
    const vector mean = scaled(R(0.5), plus(first->mean, second->mean));
    increment by;
    by.delta = plus(delta, scaled(third, minus(delta, whole->delta)));
    by.mean = plus(mean, scaled(third, minus(mean, whole->mean)));
    by.slope = plus(scaled(R(1.5), minus(second->mean, first->mean)),
                    scaled(R(0.25), plus(first->slope, second->slope)));
    return by;
}

static inline laconic_status extrapolated_step(base_step base, const laconic_model *m,
                                               const laconic_integrator *integrator, laconic_state *state,
                                               const laconic_loads *loads) {
    increment whole, first, second;
    drive full, half;
    origin from = start_of(state);
    const stretch all = whole_of(loads);
    const stretch early = half_of(loads->start, loads->middle, all.curve);
    const stretch late = half_of(loads->middle, loads->end, all.curve);
    laconic_status status = driven_step(base, m, integrator, 0, &from, &all, &full, &whole);
    if (status != LACONIC_OK) return status;
    from = start_of(state);
    status = driven_step(base, m, integrator, 1, &from, &early, &half, &first);
    if (status != LACONIC_OK) return status;
    status = driven_step(base, m, integrator, 1, &from, &late, &half, &second);
    if (status != LACONIC_OK) return status;
    return advance_if_passive(state, m, integrator->step_s, zeta_of(state), &full, combine(&whole, &first, &second));
}

#endif
