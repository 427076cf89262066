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
typedef increment (*base_step)(const laconic_model *model, const laconic_integrator *integrator, int level, vector zeta,
                               const drive *b);

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
INLINE increment increment_of(const laconic_decay *d, vector zeta, vector delta, const drive *b) {
    increment by;
    by.delta = delta;
    by.mean = plus(zeta, times(vec(d->mean), delta));
    by.slope = times(vec(d->slope), delta);
    if (b->varies) {
        by.mean = plus(by.mean, response(d->mean_ramp, d->mean_bend, b));
        by.slope = plus(by.slope, response(d->slope_ramp, d->slope_bend, b));
    }
    return by;
}

/* (4 · two half steps − one full step)/3: the base's error has only even powers of h, so this is fourth order.
 * The slope of the two halves together is 3/2 of the height between their means, plus a quarter of each own. */
INLINE increment combine(increment whole, increment first, increment second) {
    const real third = R(1) / R(3);
    const vector delta = plus(first.delta, second.delta);
    const vector mean = scaled(R(0.5), plus(first.mean, second.mean));
    increment by;
    by.delta = plus(delta, scaled(third, minus(delta, whole.delta)));
    by.mean = plus(mean, scaled(third, minus(mean, whole.mean)));
    by.slope = plus(scaled(R(1.5), minus(second.mean, first.mean)), scaled(R(0.25), plus(first.slope, second.slope)));
    return by;
}

/* ------------------------------------------------------------------------- b held ------- */

static inline drive held(const laconic_loads *loads) { return (drive){vec(loads->start->constant), none, none, false}; }

/* The base step itself as a method. */
INLINE increment single(base_step base, const laconic_model *m, const laconic_integrator *integrator, vector zeta,
                        const laconic_loads *loads) {
    const drive b = held(loads);
    return base(m, integrator, 0, zeta, &b);
}

/* Written out, so that what the whole step and its first half share is computed once. */
INLINE increment extrapolated(base_step base, const laconic_model *m, const laconic_integrator *integrator, vector zeta,
                              const laconic_loads *loads) {
    const drive b = held(loads);
    const increment whole = base(m, integrator, 0, zeta, &b), first = base(m, integrator, 1, zeta, &b);
    return combine(whole, first, base(m, integrator, 1, plus(zeta, first.delta), &b));
}

/* ------------------------------------------------------------------------- b varies ----- */

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

/* One base step; zeta and turned_rad move on to its end. A force fixed in the world makes b depend on the heading
 * there, which the step itself decides: iterate. Three rounds leave an error of h⁷, so symmetry, which extrapolation
 * rests on, is kept. */
INLINE increment part_step(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                           const laconic_heading *heading, const laconic_loads *loads, part *p) {
    const bool turns = LACONIC_WITH_WORLD_FORCE && (p->start->turns || p->end->turns);
    const real h = integrator->step_s * (p->level == 0 ? R(1) : R(0.5)), before = p->turned_rad;
    drive b = drive_of(heading, loads, p);
    increment by;
    int rounds = turns ? 3 : 1;
    p->turned_rad = before + h * dot(vec(m->yaw_rate_of_zeta), p->zeta);
    do {
        if (turns) b.change = minus(load_now(p->end, heading, p->turned_rad), b.start);
        by = base(m, integrator, p->level, p->zeta, &b);
        p->turned_rad = before + h * dot(vec(m->yaw_rate_of_zeta), by.mean);
    } while (--rounds > 0);
    p->zeta = plus(p->zeta, by.delta);
    return by;
}

/* The base step itself as a method. */
INLINE increment single_varying(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                const laconic_state *state, const laconic_loads *loads) {
    part whole = {0, zeta_of(state), R(0), loads->start, loads->end};
    return part_step(base, m, integrator, &state->heading, loads, &whole);
}

/* A loop, so that the base is inlined once: the halves follow each other from where the whole began. */
INLINE increment extrapolated_varying(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                      const laconic_state *state, const laconic_loads *loads) {
    increment parts[3];
    part p = {0, zeta_of(state), R(0), loads->start, loads->end};
    int i;
    for (i = 0; i < 3; i++) {
        parts[i] = part_step(base, m, integrator, &state->heading, loads, &p);
        if (i == 0) {
            p = (part){1, zeta_of(state), R(0), loads->start, loads->middle};
        } else {
            p.start = loads->middle;
            p.end = loads->end;
        }
    }
    return combine(parts[0], parts[1], parts[2]);
}

#endif
