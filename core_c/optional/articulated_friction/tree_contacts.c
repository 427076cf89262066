/* Contacts and elements of a tree in an exact pass: what they are seen to do, and the linear law that replaces each.
 * friction_solver.c derives both for contacts.
 *
 * An element satisfies q = Π(q + (x − target − compliance q)/(W + compliance)), W = |row|², Π the projection onto
 * [low, high]. Inside it holds with the stiffness ρ/(1 + ρ compliance), ρ a penalty; outside, q is the bound. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#ifdef LACONIC_SINGLE
#define TREE_STIFF_PENALTY PENALTY
#else
#define TREE_STIFF_PENALTY R(1e8) /* at first: a pass less than with PENALTY, where contacts keep to stick or slip */
#endif

static inline real tree_larger(real a, real b) { return b > a ? b : a; }

INLINE void tree_products(tree_contact *c, bool star) {
    c->along = tree_row_product(&c->row[0], &c->row[0], c->on, star);
    c->cross_row = tree_row_product(&c->row[0], &c->row[1], c->on, star);
    c->across = tree_row_product(&c->row[1], &c->row[1], c->on, star);
}

/* Twice the energy that what drives the wheel gives to its free motion; NaN where a limit is. */
INLINE real tree_wheel_energy(const tree_contact *c) {
    const friction_load *l = &c->load;
    const real push = c->push + drive_at(l, R(0));
    const real slope = magnitude(l->drive) < l->drive_limit ? l->drive_slope : R(0);
    return push * push / (c->wheel->inertia_kgm2 + l->viscous + slope) + zero_if_finite(l->drive_limit) +
           zero_if_finite(l->viscous + l->drive_slope + l->grip + l->axle);
}

INLINE void tree_prepare_contact(tree_problem *p, tree_contact *c, bool star) {
    const real *e = c->wheel->rolling, *q = c->impulse;
    tree_products(c, star);
    c->row_mass[0] = inverse_or_zero(c->along);
    c->row_mass[1] = inverse_or_zero(c->across);
    c->mobility = c->along + c->across + c->wheel->rim_size * c->wheel->rim_size / c->wheel->inertia_kgm2 + c->creep;
    c->inverse_mobility = R(1) / c->mobility;
    c->lateral_mass = c->row_mass[1];
    if (e[1] != R(0))
        c->lateral_mass =
            inverse_or_zero(e[1] * e[1] * c->along - R(2) * e[0] * e[1] * c->cross_row + e[0] * e[0] * c->across);
    p->scale += tree_wheel_energy(c);
    p->stress = tree_larger(p->stress, (q[0] * q[0] + q[1] * q[1]) * c->mobility);
}

INLINE void tree_stiffen(tree_element *e, real penalty) {
    e->share = R(1);
    e->stiffness = penalty;
    if (e->compliance == R(0)) return;
    e->share = R(1) / (R(1) + penalty * e->compliance);
    e->stiffness = penalty * e->share;
}

void laconic_tree_stiffen(tree_problem *p, real of_mass) {
    p->penalty = of_mass;
    for (int32_t i = 0; i < p->bundle_count; i++)
        for (tree_element *e = p->bundle[i].first; e < p->bundle[i].end; e++)
            tree_stiffen(e, of_mass / p->bundle[i].mobility);
}

INLINE real tree_element_energy(const tree_element *e, real mobility) {
    const real finite = zero_if_finite(e->target) + zero_if_finite(e->compliance);
    if (e->compliance > R(0) && e->high < LACONIC_REAL_MAX) {
        const real q = cut(e->target / e->compliance, e->high);
        return q * q * mobility / (R(1) + mobility / e->compliance) + finite;
    }
    return tree_unbounded(e) ? e->target * e->target / mobility + finite : finite;
}

INLINE void tree_prepare_element(tree_problem *p, tree_element *e, real mobility, real penalty) {
    e->all = mobility + e->compliance;
    e->inverse_all = R(1) / e->all;
    tree_stiffen(e, penalty);
    p->scale += tree_element_energy(e, mobility);
    p->stress = tree_larger(p->stress, e->q * e->q * mobility);
}

INLINE void tree_prepare_all(tree_problem *p, bool star) {
    p->penalty = TREE_STIFF_PENALTY;
    p->scale = tree_square(&p->free, p->m->body_count);
    p->stress = R(0);
    for (int32_t i = 0; i < p->contact_count; i++) tree_prepare_contact(p, &p->contact[i], star);
    for (int32_t i = 0; i < p->bundle_count; i++) {
        tree_bundle *b = &p->bundle[i];
        const real mobility = b->mobility = tree_row_product(&b->row, &b->row, b->on, star);
        p->scale += zero_if_finite(mobility);
        for (tree_element *e = b->first; e < b->end; e++)
            tree_prepare_element(p, e, mobility, TREE_STIFF_PENALTY / mobility);
    }
}

RARE void tree_prepare_deep(tree_problem *p) { tree_prepare_all(p, false); }

void laconic_tree_prepare_problem(tree_problem *p) {
    if (p->m->star)
        tree_prepare_all(p, true);
    else
        tree_prepare_deep(p);
}

/* --------------------------------------------------------------------------------- what a pass sees -- */

/* The most firm residual of a contact that slips on the border of its grip. */
RARE real tree_beyond_grip(const tree_contact *c) {
    const real *p = c->impulse, grip = c->load.grip;
    const real left = (grip * grip - (p[0] * p[0] + p[1] * p[1])) / grip;
    return left * left * inverse_or_zero(c->lateral_mass);
}

/* Returns the axle's part of the residual, squared. */
INLINE real tree_see_axle(tree_contact *c) {
    tree_sight *s = &c->sight;
    const friction_load *l = &c->load;
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2, speed = c->speed;
    const real pushed =
        c->push + rim[0] * c->impulse[0] + rim[1] * c->impulse[1] - l->viscous * speed + drive_at(l, speed);
    s->locked = magnitude(pushed) < l->axle;
    s->axle = cut(pushed, l->axle);
    const real off = pushed - s->axle - inertia * speed;
    return off * off / inertia;
}

/* The slip that no wheel gives way to, squared, over its mobility: light wheels would hide it otherwise. */
INLINE real tree_firm(const tree_contact *c, real x, real y) {
    const tree_sight *s = &c->sight;
    const real *e = c->wheel->rolling, lateral = e[0] * y - e[1] * x;
    const real firm = s->locked ? x * x * c->row_mass[0] + y * y * c->row_mass[1] : lateral * lateral * c->lateral_mass;
    if (!(s->length > R(0)) || s->locked || !(firm > R(0))) return firm;
    const real most = tree_beyond_grip(c);
    return most < firm ? most : firm;
}

/* Returns the square of the contact's residual. */
INLINE real tree_see(tree_contact *c) {
    tree_sight *s = &c->sight;
    const real *rim = c->wheel->rim, *p = c->impulse, grip = c->load.grip;
    real x = c->moved[0] - rim[0] * c->speed, y = c->moved[1] - rim[1] * c->speed;
    if (c->creep > R(0)) {
        x -= c->creep * p[0];
        y -= c->creep * p[1];
    }
    real off_x = x * c->inverse_mobility, off_y = y * c->inverse_mobility;
    const real t_x = p[0] + off_x, t_y = p[1] + off_y, size = t_x * t_x + t_y * t_y;
    bool beyond = false;
    s->t[0] = t_x;
    s->t[1] = t_y;
    s->length = s->firm = R(0);
    if (size > BORDER * grip * grip) {
        const real length = quick_root(size), outwards = t_x * off_x + t_y * off_y;
        beyond = length > grip;
        if (beyond || outwards > R(0)) s->length = length;
        if (beyond) {
            off_x = grip / length * t_x - p[0];
            off_y = grip / length * t_y - p[1];
        }
    }
    const real rest = tree_see_axle(c);
    if (!beyond) s->firm = tree_firm(c, x, y);
    return rest + (off_x * off_x + off_y * off_y + HIDDEN * HIDDEN * size) * c->mobility + s->firm;
}

/* The same of an element with x; its law for the pass follows at once. */
INLINE real tree_see_element(tree_element *e, real x) {
    const real q = e->q, away = x - e->target, off = (away - e->compliance * q) * e->inverse_all, t = q + off;
    real change = off;
    if (t > e->low && t < e->high) {
        e->law_stiffness = e->stiffness;
        e->law_q = e->share * q + e->stiffness * away;
    } else {
        e->law_stiffness = R(0);
        e->law_q = t >= e->high ? e->high : e->low;
        change = e->law_q - q;
    }
    return (change * change + HIDDEN * HIDDEN * q * q) * e->all;
}

real laconic_tree_see(tree_problem *p) {
    real residual = R(0);
    for (tree_contact *c = p->contact; c < p->contact + p->contact_count; c++) residual += tree_see(c);
    for (tree_bundle *b = p->bundle; b < p->bundle + p->bundle_count; b++)
        for (tree_element *e = b->first; e < b->end; e++) residual += tree_see_element(e, b->moved);
    return residual;
}

/* ------------------------------------------------------------------------------- laws of an exact pass -- */

/* Along n the impulse is the grip; across n it turns with the slip. */
INLINE void tree_slips(tree_contact *c, real penalty) {
    const tree_sight *s = &c->sight;
    tree_law *law = &c->law;
    const real *rims = c->wheel->rim, grip = c->load.grip, inertia = c->wheel->inertia_kgm2;
    const real n_x = s->t[0] / s->length, n_y = s->t[1] / s->length;
    const real rim = n_x * rims[1] - n_y * rims[0], moved = n_x * c->moved[1] - n_y * c->moved[0];
    const real beyond = (s->length - grip) * c->mobility + grip * c->creep;
    const real row = n_y * n_y * c->along - R(2) * n_x * n_y * c->cross_row + n_x * n_x * c->across;
    const real turns = row + rim * rim / inertia;
    const real most = turns > NO_SLIP * c->mobility ? penalty / turns : R(0);
    const bool far_beyond = most * beyond > grip;
    real h = far_beyond ? grip / beyond : most, turn = R(0);
    real across = (far_beyond ? R(0) : n_x * c->impulse[1] - n_y * c->impulse[0]) + h * moved;
    const turning wheel = turning_of(inertia, &c->load, h * rim * rim, c->load.axle,
                                     c->push + grip * (n_x * rims[0] + n_y * rims[1]) + rim * across);
    across -= h * rim * wheel.speed;
    if (!wheel.held) {
        const real all = wheel.slope + h * rim * rim;
        turn = h * rim / all;
        h *= wheel.slope / all;
    }
    law->speed = wheel.speed;
    law->impulse[0] = grip * n_x - across * n_y;
    law->impulse[1] = grip * n_y + across * n_x;
    law->along = h;
    law->across = R(0);
    law->axis[0] = -n_y;
    law->axis[1] = n_x;
    law->turn[0] = -turn * n_y;
    law->turn[1] = turn * n_x;
}

INLINE void tree_stays_locked(tree_contact *c, real penalty) {
    tree_law *law = &c->law;
    law->along = penalty * c->row_mass[0];
    law->across = penalty * c->row_mass[1];
    law->axis[1] = law->speed = law->turn[0] = law->turn[1] = R(0);
    law->impulse[0] = c->impulse[0] + law->along * c->moved[0];
    law->impulse[1] = c->impulse[1] + law->across * c->moved[1];
}

INLINE void tree_rolls(tree_contact *c, real penalty) {
    const tree_sight *s = &c->sight;
    tree_law *law = &c->law;
    const real *e = c->wheel->rolling, size = c->wheel->rim_size;
    const friction_load *l = &c->load;
    const real own = c->wheel->inertia_kgm2 + l->viscous, speed = (e[0] * c->moved[0] + e[1] * c->moved[1]) / size;
    const real motor = l->drive - l->drive_slope * speed;
    const bool limited = magnitude(motor) > l->drive_limit;
    const real along = (own * speed - c->push + s->axle - cut(motor, l->drive_limit)) / size;
    const real side = penalty * c->lateral_mass;
    law->speed = speed;
    law->along = (limited ? own : own + l->drive_slope) / (size * size);
    law->across = side;
    law->axis[1] = e[1];
    law->turn[0] = e[0] / size;
    law->turn[1] = e[1] / size;
    if (e[1] == R(0)) { /* no rollers, or those of an omni wheel */
        law->impulse[0] = e[0] * along;
        law->impulse[1] = c->impulse[1] + side * c->moved[1];
        return;
    }
    const real across = e[0] * c->impulse[1] - e[1] * c->impulse[0] + side * (e[0] * c->moved[1] - e[1] * c->moved[0]);
    law->impulse[0] = e[0] * along - e[1] * across;
    law->impulse[1] = e[1] * along + e[0] * across;
    law->axis[0] = law->other[1] = e[0];
    law->other[0] = -e[1];
}

/* Below its limit a tyre that creeps has the slip creep · impulse, in both directions; the wheel turns as it may. */
static void tree_creeps(tree_contact *c, real penalty) {
    tree_law *law = &c->law;
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2;
    real stiff[2], held[2], pulled[2];
    for (int m = 0; m < 2; m++) {
        const real hard = penalty * c->row_mass[m], share = R(1) / (R(1) + hard * c->creep);
        stiff[m] = hard * share;
        held[m] = share * c->impulse[m] + stiff[m] * c->moved[m];
        pulled[m] = stiff[m] * rim[m];
    }
    const real added = pulled[0] * rim[0] + pulled[1] * rim[1];
    const turning wheel =
        turning_of(inertia, &c->load, added, c->load.axle, c->push + rim[0] * held[0] + rim[1] * held[1]);
    const real all = wheel.held ? R(1) : wheel.slope + added, own = wheel.held ? R(1) : wheel.slope;
    const real yields = wheel.held ? R(0) : R(1);
    law->speed = wheel.speed;
    for (int m = 0; m < 2; m++) {
        law->impulse[m] = held[m] - pulled[m] * wheel.speed;
        law->turn[m] = yields * pulled[m] / all;
    }
    laconic_tree_split(law, stiff[0] * (own + yields * pulled[1] * rim[1]) / all, -yields * pulled[0] * pulled[1] / all,
                       stiff[1] * (own + yields * pulled[0] * rim[0]) / all);
}

static void tree_take_law(tree_contact *c, real penalty) {
    if (c->sight.length > R(0))
        tree_slips(c, penalty);
    else if (c->creep > R(0))
        tree_creeps(c, penalty);
    else if (c->sight.locked)
        tree_stays_locked(c, penalty);
    else
        tree_rolls(c, penalty);
}

INLINE void tree_move_contact(tree_contact *c) {
    const tree_law *law = &c->law;
    const real x = law->slip[0], y = law->slip[1], *axis = law->axis, *other = law->other;
    c->speed = law->speed + law->turn[0] * x + law->turn[1] * y;
    if (axis[1] == R(0)) {
        c->impulse[0] = law->impulse[0] + law->along * x;
        c->impulse[1] = law->impulse[1] + law->across * y;
        return;
    }
    const real along = law->along * (axis[0] * x + axis[1] * y);
    c->impulse[0] = law->impulse[0] + axis[0] * along;
    c->impulse[1] = law->impulse[1] + axis[1] * along;
    if (law->across == R(0)) return;
    const real across = law->across * (other[0] * x + other[1] * y);
    c->impulse[0] += other[0] * across;
    c->impulse[1] += other[1] * across;
}

void laconic_tree_exact_pass(tree_problem *p) {
    tree_contact *const beyond = p->contact + p->contact_count;
    for (tree_contact *c = p->contact; c < beyond; c++) tree_take_law(c, p->penalty);
    laconic_tree_move(p);
    for (tree_contact *c = p->contact; c < beyond; c++) tree_move_contact(c);
}

#endif
