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
#include "friction_smooth.h"

static void soften_contact(soft_wheel *restrict c, real *fall, const friction_wheel *w, real grip, const real slip[2],
                           const real p[2], const friction_path *path) {
    if (grip < LACONIC_REAL_MAX) {
        soften_grip(c, fall, grip, w->lateral_mass > R(0) ? w->lateral_mass : w->row_mass[0], slip, p, path);
    } else {
        c->xx = PENALTY * w->row_mass[0];
        c->yy = PENALTY * w->row_mass[1];
        c->xy = R(0);
        c->impulse[0] = p[0] + c->xx * slip[0];
        c->impulse[1] = p[1] + c->yy * slip[1];
    }
}

INLINE void add_law(equations *k, const friction_wheel *w, const soft_law *law) {
    k->rest = minus(k->rest, combined(w->row, law->impulse[0], law->impulse[1]));
    add_product(k, w->row[0], combined(w->row, law->xx, law->xy));
    add_product(k, w->row[1], combined(w->row, law->xy, law->yy));
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
        soften_contact(c, &fall, w, l->grip, slip, at->impulse[i], path);
        c->axle = dry_impulse(&c->axle_growth, &fall, l->axle, speed, path->axle[i],
                              tau_of(path, l->axle, w->inertia + w->rim_size * w->rim_size));
        soften_motor(c, &fall, l, speed, path->motor[i], path);
        const soft_law law = without_speed(c, w->rim, w->inertia, l, speed);
        add_law(&k, w, &law);
    }
    by = solved(&k);
    at->nu = plus(at->nu, by);
    for (int32_t i = 0; i < at->count; i++) {
        const friction_wheel *w = &at->wheel[i];
        move_softly(&wheels[i], dot(w->row[0], by), dot(w->row[1], by), w->rim, &at->load[i], &at->speed[i],
                    at->impulse[i], path, i);
    }
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
