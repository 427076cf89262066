/* The friction problem with its corners rounded: the way to the solution from where the exact passes go in circles.
 *
 * |slip| becomes w = √(|slip|² + τ²), so p = grip slip/w is smooth; |s| of the axle's friction likewise. Newton's
 * method on p w = grip slip with p as an unknown of its own converges from far away, where the one on speeds alone
 * overshoots (Chan, Golub and Mulet 1999). τ = softness/grip (at most 1 rad/s) makes the energy that the rounding
 * adds the same for each contact, as on the central path of an interior-point method, and shrinks from pass to pass. */
#include "friction_internals.h"

/* Of the free motion's energy. Softer at first would forget the guess, which exact passes made; less soft, or faster,
 * goes in circles too; softer at last leaves more to exact passes. One pass fewer doubles the refusals: in double 1 in
 * 900 of random states up to four wheels, in single 1 in 140. */
#define FIRST_SOFTNESS R(1e-5)
#define SOFTER R(0.1)

/* A contact that sticks has the stiffness grip/τ. Above this multiple of what its row meets, rounding errors of the
 * speeds, times it, would be all that is left of the impulse; much below, a vehicle that is held by an impulse many
 * times that of its motion still creeps when exact passes take over. */
#ifdef LACONIC_SINGLE
#define STIFFEST R(3e5)
#define SMOOTH_PASSES 5 /* beyond it the rounding errors of the sums show */
#else
#define STIFFEST R(1e15)
#define SMOOTH_PASSES 7
#endif

/* A contact's linear law p += G rows·δν and s += turn·rows·δν, and the axle's q += grow δs. */
typedef struct soft_contact {
    real g[3], turn[2];
    real impulse[2], speed, axle, grow;
} soft_contact;

/* A symmetric matrix H, and the impulse where its wheel turns as in the pass before. */
typedef struct soft_law {
    real xx, xy, yy, impulse[2];
} soft_law;

INLINE soft_law law_of(const friction_wheel *w, const friction_load *l, const real slip[2], const real p[2],
                       real softness) {
    const real wanted = softness / (l->grip + softness), least = l->grip / (STIFFEST * w->row_mass[0]);
    const real tau = wanted > least ? wanted : least;
    const real size = rough_root(slip[0] * slip[0] + slip[1] * slip[1] + tau * tau);
    const real x = slip[0] / size, y = slip[1] / size;
    soft_law law;
    if (l->grip < LACONIC_REAL_MAX) {
        law.xx = (l->grip - p[0] * x) / size;
        law.yy = (l->grip - p[1] * y) / size;
        law.xy = R(-0.5) * (p[0] * y + p[1] * x) / size;
        law.impulse[0] = l->grip * x;
        law.impulse[1] = l->grip * y;
    } else {
        law.xx = PENALTY * w->row_mass[0];
        law.yy = PENALTY * w->row_mass[1];
        law.xy = R(0);
        law.impulse[0] = p[0] + law.xx * slip[0];
        law.impulse[1] = p[1] + law.yy * slip[1];
    }
    return law;
}

/* Eliminates the wheel's speed: G = H − H rim rimᵀ H / d, written so that nothing cancels. */
INLINE void eliminate(soft_contact *restrict c, const friction_wheel *w, const friction_load *l, const soft_law *h,
                      real speed, real axle, real softness) {
    const real x = h->xx * w->rim[0] + h->xy * w->rim[1], y = h->xy * w->rim[0] + h->yy * w->rim[1];
    const real rim = w->rim[0] * x + w->rim[1] * y, area = h->xx * h->yy - h->xy * h->xy;
    const real tau = softness / (l->axle + softness), size = rough_root(speed * speed + tau * tau);
    real own, all;
    turning wheel;
    c->axle = l->axle * (speed / size);
    c->grow = (l->axle - axle * (speed / size)) / size;
    wheel = turning_of(w, l, rim + c->grow, R(0),
                       w->inertia * l->free_speed + w->rim[0] * h->impulse[0] + w->rim[1] * h->impulse[1] - c->axle +
                           (rim + c->grow) * speed);
    c->speed = wheel.speed;
    c->impulse[0] = h->impulse[0] - x * (wheel.speed - speed);
    c->impulse[1] = h->impulse[1] - y * (wheel.speed - speed);
    own = wheel.slope + c->grow;
    all = own + rim;
    c->turn[0] = x / all;
    c->turn[1] = y / all;
    c->g[0] = (own * h->xx + area * w->rim[1] * w->rim[1]) / all;
    c->g[1] = (own * h->xy - area * w->rim[0] * w->rim[1]) / all;
    c->g[2] = (own * h->yy + area * w->rim[0] * w->rim[0]) / all;
}

/* Into the disc, by one of Heron's rounds instead of a root: exact at the border, a little inside beyond it. */
INLINE void put_inside(real p[2], real grip) {
    const real size = p[0] * p[0] + p[1] * p[1], border = grip * grip;
    if (grip < LACONIC_REAL_MAX && size > border) {
        const real by = R(2) * border / (border + size);
        p[0] *= by;
        p[1] *= by;
    }
}

static void smooth_pass(friction_search *at, real axle[], real softness) {
    soft_contact contacts[LACONIC_MAX_WHEELS];
    equations k = no_wheels(at);
    vector by;
    for (int32_t i = 0; i < at->count; i++) {
        const friction_wheel *w = &at->wheel[i];
        const real slip[2] = {dot(w->row[0], at->nu) - w->rim[0] * at->speed[i],
                              dot(w->row[1], at->nu) - w->rim[1] * at->speed[i]};
        const soft_law law = law_of(w, &at->load[i], slip, at->impulse[i], softness);
        soft_contact *c = &contacts[i];
        eliminate(c, w, &at->load[i], &law, at->speed[i], axle[i], softness);
        k.rest = minus(k.rest, combined(w->row, c->impulse[0], c->impulse[1]));
        add_product(&k, w->row[0], combined(w->row, c->g[0], c->g[1]));
        add_product(&k, w->row[1], combined(w->row, c->g[1], c->g[2]));
    }
    by = solved(&k);
    at->nu = plus(at->nu, by);
    for (int32_t i = 0; i < at->count; i++) {
        const soft_contact *c = &contacts[i];
        const real x = dot(at->wheel[i].row[0], by), y = dot(at->wheel[i].row[1], by), before = at->speed[i];
        at->speed[i] = c->speed + c->turn[0] * x + c->turn[1] * y;
        axle[i] = cut(c->axle + c->grow * (at->speed[i] - before), at->load[i].axle);
        at->impulse[i][0] = c->impulse[0] + c->g[0] * x + c->g[1] * y;
        at->impulse[i][1] = c->impulse[1] + c->g[1] * x + c->g[2] * y;
        put_inside(at->impulse[i], at->load[i].grip);
    }
}

int32_t laconic_friction_smooth(friction_search *at) {
    real axle[LACONIC_MAX_WHEELS], softness = FIRST_SOFTNESS * at->scale;
    for (int32_t i = 0; i < at->count; i++) {
        axle[i] = R(0);
        put_inside(at->impulse[i], at->load[i].grip);
    }
    laconic_friction_follow(at);
    for (int32_t pass = 0; pass < SMOOTH_PASSES; pass++) {
        smooth_pass(at, axle, softness);
        softness *= SOFTER;
    }
    return SMOOTH_PASSES;
}
