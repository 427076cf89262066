/* The friction problem with its corners rounded: the way to the solution from where the exact passes go in circles.
 *
 * Contacts, axles and motors at their limit are dry friction of one kind: an impulse of at most `bound` against a
 * speed. |speed| becomes w = √(|speed|² + τ²), so that impulse = bound speed/w is smooth. Newton's method on
 * impulse w = bound speed with the impulse as an unknown of its own converges from far away, where the one on speeds
 * alone overshoots (Chan, Golub and Mulet 1999). τ = softness/bound makes the energy that the rounding adds the same
 * for all of them: solutions for falling softness are the central path of an interior-point method for this cone
 * program (Boyd and Vandenberghe 2004, chapter 11). The problem is strongly convex, so the path exists and is unique
 * whatever the contacts, also where their impulses are not; it ends in the solution. The softness falls as fast as
 * the passes follow: by much where all impulses are near to what the path asks, by little where one is far off. */
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

static real fall_at(real off, real bound) {
    return off > bound * bound ? FALL_FAR : (off > CLOSE_BY * bound * bound ? FALL_ASIDE : FALL_NEAR);
}

/* One wheel in a pass: its impulses at the speeds of the pass before, and how they grow. */
typedef struct soft_wheel {
    real xx, xy, yy, impulse[2]; /* of the contact, with slip: a symmetric matrix H */
    real axle, axle_growth, motor, motor_fall;
    real turn[2], excess; /* wheel speed per slip of a standing wheel, and by itself */
    real fall;            /* of the softness */
} soft_wheel;

RARE void soften_contact(soft_wheel *restrict c, const friction_wheel *w, real grip, const real slip[2],
                         const real p[2], const friction_path *path) {
    if (grip < LACONIC_REAL_MAX) {
        const real tau = tau_of(path, grip, w->lateral_mass > R(0) ? w->lateral_mass : w->row_mass[0]);
        const real size = root_of(slip[0] * slip[0] + slip[1] * slip[1] + tau * tau);
        const real x = slip[0] / size, y = slip[1] / size, off[2] = {p[0] - grip * x, p[1] - grip * y};
        c->xx = (grip - p[0] * x) / size;
        c->yy = (grip - p[1] * y) / size;
        c->xy = R(-0.5) * (p[0] * y + p[1] * x) / size;
        c->impulse[0] = grip * x;
        c->impulse[1] = grip * y;
        c->fall = fall_at(off[0] * off[0] + off[1] * off[1], grip);
    } else {
        c->xx = PENALTY * w->row_mass[0];
        c->yy = PENALTY * w->row_mass[1];
        c->xy = R(0);
        c->impulse[0] = p[0] + c->xx * slip[0];
        c->impulse[1] = p[1] + c->yy * slip[1];
        c->fall = FALL_NEAR;
    }
}

RARE real dry_impulse(soft_wheel *restrict c, real *growth, real bound, real speed, real now, real tau) {
    const real size = root_of(speed * speed + tau * tau), x = speed / size, impulse = bound * x;
    const real off = now - impulse, fall = fall_at(off * off, bound);
    *growth = (bound - now * x) / size;
    if (fall > c->fall) c->fall = fall;
    return impulse;
}

/* A motor with a limit: a damper in series with dry friction, whose speed is what the damper leaves. */
INLINE void soften_motor(soft_wheel *restrict c, const friction_load *l, real speed, real now,
                         const friction_path *path) {
    c->motor = drive_at(l, speed);
    c->motor_fall = l->drive_slope;
    if (l->drive_slope > R(0) && l->drive_limit < LACONIC_REAL_MAX) {
        const real left = (l->drive - l->drive_slope * speed - now) / l->drive_slope;
        real growth;
        const real limited =
            dry_impulse(c, &growth, l->drive_limit, left, now, tau_of(path, l->drive_limit, l->drive_slope));
        const real share = l->drive_slope / (l->drive_slope + growth);
        c->motor = now + share * (limited - now);
        c->motor_fall = share * growth;
    }
}

/* Takes the wheel's speed out of the equations: G = H − H rim rimᵀ H / all, written so that nothing cancels. */
INLINE void eliminate(soft_wheel *restrict c, equations *k, const friction_wheel *w, const friction_load *l,
                      real speed) {
    const real own = w->inertia + l->viscous + c->motor_fall + c->axle_growth, area = c->xx * c->yy - c->xy * c->xy;
    const real lateral = area > R(0) ? area : R(0); /* rounding errors could make it negative, and G indefinite */
    const real x = c->xx * w->rim[0] + c->xy * w->rim[1], y = c->xy * w->rim[0] + c->yy * w->rim[1];
    const real all = own + w->rim[0] * x + w->rim[1] * y;
    const real g[3] = {(own * c->xx + lateral * w->rim[1] * w->rim[1]) / all,
                       (own * c->xy - lateral * w->rim[0] * w->rim[1]) / all,
                       (own * c->yy + lateral * w->rim[0] * w->rim[0]) / all};
    c->excess = (w->inertia * (l->free_speed - speed) - l->viscous * speed + c->motor - c->axle +
                 w->rim[0] * c->impulse[0] + w->rim[1] * c->impulse[1]) /
                all;
    c->turn[0] = x / all;
    c->turn[1] = y / all;
    k->rest = minus(k->rest, combined(w->row, c->impulse[0] - x * c->excess, c->impulse[1] - y * c->excess));
    add_product(k, w->row[0], combined(w->row, g[0], g[1]));
    add_product(k, w->row[1], combined(w->row, g[1], g[2]));
}

RARE void put_inside(real p[2], real grip) {
    const real size = p[0] * p[0] + p[1] * p[1];
    if (grip < LACONIC_REAL_MAX && size > grip * grip) {
        const real by = grip / root_of(size);
        p[0] *= by;
        p[1] *= by;
    }
}

static void move_softly(const soft_wheel *c, friction_search *at, friction_path *path, int32_t i, vector by) {
    const friction_wheel *w = &at->wheel[i];
    const real x = dot(w->row[0], by), y = dot(w->row[1], by);
    const real turned = c->excess + c->turn[0] * x + c->turn[1] * y;
    const real slip[2] = {x - w->rim[0] * turned, y - w->rim[1] * turned};
    at->speed[i] += turned;
    at->impulse[i][0] = c->impulse[0] + c->xx * slip[0] + c->xy * slip[1];
    at->impulse[i][1] = c->impulse[1] + c->xy * slip[0] + c->yy * slip[1];
    put_inside(at->impulse[i], at->load[i].grip);
    path->axle[i] = cut(c->axle + c->axle_growth * turned, at->load[i].axle);
    path->motor[i] = cut(c->motor - c->motor_fall * turned, at->load[i].drive_limit);
}

void laconic_friction_follow_path(friction_search *at, friction_path *path) {
    soft_wheel wheels[LACONIC_MAX_WHEELS];
    equations k = no_wheels(at);
    const real least = LEAST_SOFTNESS * at->scale;
    real fall = FALL_NEAR;
    vector by;
    for (int32_t i = 0; i < at->count; i++) {
        const friction_wheel *w = &at->wheel[i];
        const friction_load *l = &at->load[i];
        const real speed = at->speed[i];
        const real slip[2] = {dot(w->row[0], at->nu) - w->rim[0] * speed, dot(w->row[1], at->nu) - w->rim[1] * speed};
        soft_wheel *c = &wheels[i];
        soften_contact(c, w, l->grip, slip, at->impulse[i], path);
        c->axle = dry_impulse(c, &c->axle_growth, l->axle, speed, path->axle[i],
                              tau_of(path, l->axle, w->inertia + w->rim_size * w->rim_size));
        soften_motor(c, l, speed, path->motor[i], path);
        eliminate(c, &k, w, l, speed);
        if (c->fall > fall) fall = c->fall;
    }
    by = solved(&k);
    at->nu = plus(at->nu, by);
    for (int32_t i = 0; i < at->count; i++) move_softly(&wheels[i], at, path, i, by);
    path->softness *= fall;
    if (path->softness < least) path->softness = least;
}

void laconic_friction_start_path(friction_search *at, friction_path *path) {
    path->fastest = root_of(at->scale);
    path->softness = FIRST_SOFTNESS * at->scale;
    for (int32_t i = 0; i < at->count; i++) put_inside(at->impulse[i], at->load[i].grip);
    laconic_friction_follow(at);
    for (int32_t i = 0; i < at->count; i++) {
        path->axle[i] = R(0);
        path->motor[i] = drive_at(&at->load[i], at->speed[i]);
    }
}
