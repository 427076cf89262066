/* What smoothing makes of one wheel, whatever its rows act on: friction_smooth.c derives it. Contacts, axles and motors
 * at their limit are dry friction of one kind. */
#ifndef LACONIC_FRICTION_SMOOTH_H
#define LACONIC_FRICTION_SMOOTH_H

#include "friction_internals.h"

/* Softness over the free motion's energy. Softer at first would forget the guess, which exact passes made. */
#define FIRST_SOFTNESS R(1e-5)
#define FALL_NEAR R(0.01)
#define FALL_ASIDE R(0.05)
#define FALL_FAR R(0.3)
#define CLOSE_BY R(0.0625) /* (1/4)²: of the bound, squared */

/* Something that sticks has the stiffness bound/τ. Above this multiple of the mass that it holds, the sums of the
 * equations would keep nothing of what else acts on the body. */
#ifdef LACONIC_SINGLE
#define STIFFEST R(1e7)
#define LEAST_SOFTNESS R(1e-14)
#else
#define STIFFEST R(1e14)
#define LEAST_SOFTNESS R(1e-24)
#endif

/* What is rare need not be fast: one copy in flash. */
RARE real root_of(real x) { return quick_root(x); }

/* `mass`: which the bound's impulse can move, in the direction where nothing but it gives way. */
RARE real tau_of(const friction_path *path, real bound, real mass) {
    const real wanted = path->softness / (bound + path->softness / path->fastest), least = bound / (STIFFEST * mass);
    return wanted > least ? wanted : least;
}

/* The softness falls as the impulse allows that is farthest from what the path asks. */
static inline void fall_by(real *fall, real off_square, real bound) {
    const real now =
        off_square > bound * bound ? FALL_FAR : (off_square > CLOSE_BY * bound * bound ? FALL_ASIDE : FALL_NEAR);
    if (now > *fall) *fall = now;
}

/* One wheel in a pass: its impulses at the speeds of the pass before, and how they grow. */
typedef struct soft_wheel {
    real xx, xy, yy, impulse[2]; /* of the contact, with slip: a symmetric matrix H */
    real axle, axle_growth, motor, motor_fall;
    real turn[2], excess; /* wheel speed per slip of a standing wheel, and by itself */
} soft_wheel;

/* `p`: the contact's impulse in the pass before. */
RARE void soften_grip(soft_wheel *restrict c, real *fall, real grip, real mass, const real slip[2], const real p[2],
                      const friction_path *path) {
    const real tau = tau_of(path, grip, mass);
    const real size = root_of(slip[0] * slip[0] + slip[1] * slip[1] + tau * tau);
    const real x = slip[0] / size, y = slip[1] / size, off[2] = {p[0] - grip * x, p[1] - grip * y};
    c->xx = (grip - p[0] * x) / size;
    c->yy = (grip - p[1] * y) / size;
    c->xy = R(-0.5) * (p[0] * y + p[1] * x) / size;
    c->impulse[0] = grip * x;
    c->impulse[1] = grip * y;
    fall_by(fall, off[0] * off[0] + off[1] * off[1], grip);
}

RARE real dry_impulse(real *growth, real *fall, real bound, real speed, real now, real tau) {
    const real size = root_of(speed * speed + tau * tau), x = speed / size, impulse = bound * x;
    const real off = now - impulse;
    *growth = (bound - now * x) / size;
    fall_by(fall, off * off, bound);
    return impulse;
}

/* A motor with a limit: a damper in series with dry friction, whose speed is what the damper leaves. */
INLINE void soften_motor(soft_wheel *restrict c, real *fall, const friction_load *l, real speed, real now,
                         const friction_path *path) {
    c->motor = drive_at(l, speed);
    c->motor_fall = l->drive_slope;
    if (l->drive_slope > R(0) && l->drive_limit < LACONIC_REAL_MAX) {
        const real left = (l->drive - l->drive_slope * speed - now) / l->drive_slope;
        real growth;
        const real limited =
            dry_impulse(&growth, fall, l->drive_limit, left, now, tau_of(path, l->drive_limit, l->drive_slope));
        const real share = l->drive_slope / (l->drive_slope + growth);
        c->motor = now + share * (limited - now);
        c->motor_fall = share * growth;
    }
}

/* A contact's law once the wheel's speed is taken out: impulse + G slip of a standing wheel. */
typedef struct soft_law {
    real xx, xy, yy, impulse[2];
} soft_law;

/* G = H − H rim rimᵀ H / all, written so that nothing cancels. */
INLINE soft_law without_speed(soft_wheel *restrict c, const real rim[2], real inertia, const friction_load *l,
                              real speed) {
    const real own = inertia + l->viscous + c->motor_fall + c->axle_growth, area = c->xx * c->yy - c->xy * c->xy;
    const real lateral = area > R(0) ? area : R(0); /* rounding errors could make it negative, and G indefinite */
    const real x = c->xx * rim[0] + c->xy * rim[1], y = c->xy * rim[0] + c->yy * rim[1];
    const real all = own + rim[0] * x + rim[1] * y;
    soft_law g;
    g.xx = (own * c->xx + lateral * rim[1] * rim[1]) / all;
    g.xy = (own * c->xy - lateral * rim[0] * rim[1]) / all;
    g.yy = (own * c->yy + lateral * rim[0] * rim[0]) / all;
    c->excess = (inertia * (l->free_speed - speed) - l->viscous * speed + c->motor - c->axle + rim[0] * c->impulse[0] +
                 rim[1] * c->impulse[1]) /
                all;
    c->turn[0] = x / all;
    c->turn[1] = y / all;
    g.impulse[0] = c->impulse[0] - x * c->excess;
    g.impulse[1] = c->impulse[1] - y * c->excess;
    return g;
}

RARE void put_inside(real p[2], real grip) {
    const real size = p[0] * p[0] + p[1] * p[1];
    if (grip < LACONIC_REAL_MAX && size > grip * grip) {
        const real by = grip / root_of(size);
        p[0] *= by;
        p[1] *= by;
    }
}

/* Moves wheel i and its impulses; x, y: what the pass changes of its slip if the wheel stood still. */
INLINE void move_softly(const soft_wheel *c, real x, real y, const real rim[2], const friction_load *l, real *speed,
                        real p[2], friction_path *path, int32_t i) {
    const real turned = c->excess + c->turn[0] * x + c->turn[1] * y;
    const real slip[2] = {x - rim[0] * turned, y - rim[1] * turned};
    *speed += turned;
    p[0] = c->impulse[0] + c->xx * slip[0] + c->xy * slip[1];
    p[1] = c->impulse[1] + c->xy * slip[0] + c->yy * slip[1];
    put_inside(p, l->grip);
    path->axle[i] = cut(c->axle + c->axle_growth * turned, l->axle);
    path->motor[i] = cut(c->motor - c->motor_fall * turned, l->drive_limit);
}

#endif
