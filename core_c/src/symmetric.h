/* What the symmetric methods share: a base step for b quadratic over the step, forces that turn with the
 * heading, and Richardson's extrapolation. Everything is inlined into the method that names its base. */
#ifndef LACONIC_SYMMETRIC_H
#define LACONIC_SYMMETRIC_H

#include "advance.h"
#include "load.h"
#include "zeta.h"

/* b over one base step: start + change·s + curve·s(s − 1), s from 0 to 1. */
typedef struct drive {
    vector start, change, curve;
    bool varies; /* false: change and curve are 0 and not looked at */
} drive;

/* A second-order symmetric step of size step_s/2^level from ζ under b. */
typedef laconic_status (*base_step)(const laconic_model *model, const laconic_integrator *integrator, int level,
                                    vector zeta, const drive *b, increment *out);

/* What a b that varies adds to one that does not. */
static inline vector response(const real ramp[3], const real bend[3], const drive *b) {
    return plus(times(vec(ramp), b->change), times(vec(bend), b->curve));
}

/* The constant b that leads to the same ζ at the end. */
INLINE vector constant_like(const drive *b, const laconic_decay *d) {
    return b->varies ? plus(b->start, response(d->mean, d->bend, b)) : b->start;
}

/* Mean and first moment of ζ over the step from its increment: exact for damping and drive alone, and
 * symmetric, so that they gain two orders by extrapolation as the increment does. */
INLINE void fill(increment *out, const laconic_decay *d, vector zeta, vector delta, const drive *b) {
    out->delta = delta;
    out->mean = plus(zeta, times(vec(d->mean), delta));
    out->slope = times(vec(d->slope), delta);
    if (b->varies) {
        out->mean = plus(out->mean, response(d->mean_ramp, d->mean_bend, b));
        out->slope = plus(out->slope, response(d->slope_ramp, d->slope_bend, b));
    }
}

/* A base step within a step: its size, where it begins, what acts. */
typedef struct part {
    int level;
    vector zeta;
    real turned_rad; /* since the step's start, for forces fixed in the world */
    const laconic_load *start, *end;
} part;

/* 2 (b₀ + b₁ − 2 b½): the parabola through three samples; its half bends a quarter as much. Of a force fixed in
 * the world it sees nothing: that one is followed by its heading. */
static inline vector curve_of(const laconic_loads *loads, int level) {
    const vector ends = plus(vec(loads->start->constant), vec(loads->end->constant));
    return scaled(level == 0 ? R(2) : R(0.5), minus(ends, scaled(R(2), vec(loads->middle->constant))));
}

/* b at the part's start, and how it goes on as far as the inputs say. */
static inline drive drive_of(const laconic_heading *heading, const laconic_loads *loads, const part *p) {
    drive b;
    b.varies = true;
    b.start = load_now(p->start, heading, p->turned_rad);
    b.change = minus(vec(p->end->constant), b.start);
    b.curve = curve_of(loads, p->level);
    return b;
}

/* One base step under loads that vary. A force fixed in the world makes b depend on the heading at the end,
 * which the step itself decides: iterate. Three rounds leave an error of h⁷, so symmetry, which extrapolation
 * rests on, is kept. */
INLINE laconic_status varying_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                   const laconic_heading *heading, const laconic_loads *loads, part *p,
                                   increment *out) {
    const bool turns = LACONIC_WITH_WORLD_FORCE && (p->start->turns || p->end->turns);
    const real h = integrator->step_s * (p->level == 0 ? R(1) : R(0.5)), before = p->turned_rad;
    drive b = drive_of(heading, loads, p);
    int rounds;
    p->turned_rad = before + h * dot(vec(m->yaw_rate_of_zeta), p->zeta);
    for (rounds = turns ? 3 : 1; rounds > 0; rounds--) {
        laconic_status status;
        if (turns) b.change = minus(load_now(p->end, heading, p->turned_rad), b.start);
        status = base(m, integrator, p->level, p->zeta, &b, out);
        if (status != LACONIC_OK) return status;
        p->turned_rad = before + h * dot(vec(m->yaw_rate_of_zeta), out->mean);
    }
    return LACONIC_OK;
}

/* One base step; zeta and turned_rad move on to its end. */
INLINE laconic_status part_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                const laconic_heading *heading, const laconic_loads *loads, bool steady, part *p,
                                increment *out) {
    laconic_status status;
    if (steady) {
        const drive held = {vec(p->start->constant), {R(0), R(0), R(0)}, {R(0), R(0), R(0)}, false};
        status = base(m, integrator, p->level, p->zeta, &held, out);
    } else {
        status = varying_step(base, m, integrator, heading, loads, p, out);
    }
    p->zeta = plus(p->zeta, out->delta);
    return status;
}

/* The base step itself as a method. */
INLINE laconic_status single_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                  const laconic_state *state, const laconic_loads *loads, increment *out) {
    part whole = {0, zeta_of(state), R(0), loads->start, loads->end};
    if (steady_over(loads)) return part_step(base, m, integrator, &state->heading, loads, true, &whole, out);
    return part_step(base, m, integrator, &state->heading, loads, false, &whole, out);
}

/* (4 · two half steps − one full step)/3: the base's error has only even powers of h, so this is fourth order.
 * The slope of the two halves together is 3/2 of the height between their means, plus a quarter of each own. */
INLINE increment combine(const increment *whole, const increment *first, const increment *second) {
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

/* A loop, so that the base is inlined once: the halves follow each other from where the whole began. */
INLINE laconic_status extrapolate(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                  const laconic_state *state, const laconic_loads *loads, bool steady,
                                  increment *by) {
    const laconic_load *ends[4] = {loads->start, loads->start, loads->middle, loads->end};
    increment parts[3];
    part p = {0, zeta_of(state), R(0), loads->start, loads->end};
    int i;
    for (i = 0; i < 3; i++) {
        const laconic_status status =
            part_step(base, m, integrator, &state->heading, loads, steady, &p, &parts[i]);
        if (status != LACONIC_OK) return status;
        if (i == 0) {
            p.zeta = zeta_of(state);
            p.turned_rad = R(0);
            p.level = 1;
        }
        p.start = ends[i + 1];
        p.end = i == 0 ? loads->middle : loads->end;
    }
    *by = combine(&parts[0], &parts[1], &parts[2]);
    return LACONIC_OK;
}

INLINE laconic_status extrapolated_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                        laconic_state *state, const laconic_loads *loads) {
    increment by;
    const laconic_status status = steady_over(loads) ? extrapolate(base, m, integrator, state, loads, true, &by)
                                                     : extrapolate(base, m, integrator, state, loads, false, &by);
    if (status != LACONIC_OK) return status;
    return advance_if_passive(state, m, integrator->step_s, loads, zeta_of(state), by);
}

#endif
