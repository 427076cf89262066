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

INLINE void tree_prepare_contact(tree_contact *c, bool star) {
    const real *e = c->wheel->rolling;
    c->along = tree_row_product(&c->row[0], &c->row[0], c->on, star);
    c->cross_row = tree_row_product(&c->row[0], &c->row[1], c->on, star);
    c->across = tree_row_product(&c->row[1], &c->row[1], c->on, star);
    c->row_mass[0] = inverse_or_zero(c->along);
    c->row_mass[1] = inverse_or_zero(c->across);
    c->mobility = c->along + c->across + c->wheel->rim_size * c->wheel->rim_size / c->wheel->inertia_kgm2 + c->creep;
    c->inverse_mobility = R(1) / c->mobility;
    c->lateral_mass = c->row_mass[1];
    if (e[1] == R(0)) return;
    c->lateral_mass =
        inverse_or_zero(e[1] * e[1] * c->along - R(2) * e[0] * e[1] * c->cross_row + e[0] * e[0] * c->across);
}

void laconic_tree_stiffen(tree_element *e, real of_mass) {
    const real penalty = of_mass / e->mobility;
    e->share = R(1);
    e->stiffness = penalty;
    if (e->compliance == R(0)) return;
    e->share = R(1) / (R(1) + penalty * e->compliance);
    e->stiffness = penalty * e->share;
}

INLINE void tree_prepare_all(tree_problem *p, bool star) {
    p->penalty = TREE_STIFF_PENALTY;
    for (int32_t i = 0; i < p->contact_count; i++) tree_prepare_contact(&p->contact[i], star);
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        const bool again = i > 0 && p->element[i - 1].row == e->row;
        e->mobility = again ? p->element[i - 1].mobility : tree_row_product(e->row, e->row, e->on, star);
        e->all = e->mobility + e->compliance;
        e->inverse_all = R(1) / e->all;
        laconic_tree_stiffen(e, TREE_STIFF_PENALTY);
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

/* Returns the square of the axle's residual. */
INLINE real tree_see_axle(tree_sight *restrict s, const tree_contact *c) {
    const friction_load *l = &c->load;
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2, speed = c->speed;
    const real axle = rim[0] * c->impulse[0] + rim[1] * c->impulse[1] + inertia * (l->free_speed - speed) -
                      l->viscous * speed + drive_at(l, speed);
    const real pushed = axle + inertia * speed;
    s->locked = magnitude(pushed) < l->axle;
    s->axle = cut(pushed, l->axle);
    return (axle - s->axle) * (axle - s->axle) / inertia;
}

/* Returns the square of the contact's residual. */
INLINE real tree_see(tree_sight *restrict s, const tree_contact *c, const tree_vector *nu, bool star) {
    const real *rim = c->wheel->rim, *e = c->wheel->rolling, *p = c->impulse, grip = c->load.grip;
    real inside = R(1), off[2], size;
    for (int m = 0; m < 2; m++) {
        s->moved[m] = tree_dot(&c->row[m], c->on, nu, star);
        off[m] = s->moved[m] - rim[m] * c->speed;
        if (c->creep > R(0)) off[m] -= c->creep * p[m];
        off[m] *= c->inverse_mobility;
        s->t[m] = p[m] + off[m];
    }
    s->length = s->firm = R(0);
    size = s->t[0] * s->t[0] + s->t[1] * s->t[1];
    if (size > BORDER * grip * grip) {
        const real length = quick_root(size), outwards = s->t[0] * off[0] + s->t[1] * off[1];
        if (length > grip) inside = grip / length;
        if (length > grip || outwards > R(0)) s->length = length;
    }
    for (int m = 0; m < 2 && inside < R(1); m++) off[m] = inside * s->t[m] - p[m];
    const real rest = tree_see_axle(s, c);
    if (inside >= R(1)) {
        const real lateral = e[0] * off[1] - e[1] * off[0];
        const real held = off[0] * off[0] * c->row_mass[0] + off[1] * off[1] * c->row_mass[1];
        s->firm = c->mobility * c->mobility * (s->locked ? held : lateral * lateral * c->lateral_mass);
        if (s->length > R(0) && !s->locked && s->firm > R(0)) {
            const real most = tree_beyond_grip(c);
            if (most < s->firm) s->firm = most;
        }
    }
    return rest + (off[0] * off[0] + off[1] * off[1] + HIDDEN * HIDDEN * size) * c->mobility + s->firm;
}

/* The same of an element with x; its law for the pass follows at once. */
INLINE real tree_see_element(tree_element_law *restrict law, const tree_element *e, real x) {
    const real away = x - e->target, off = (away - e->compliance * e->q) * e->inverse_all, t = e->q + off;
    real change = off;
    if (t > e->low && t < e->high) {
        law->stiffness = e->stiffness;
        law->q = e->share * e->q + e->stiffness * away;
    } else {
        law->stiffness = R(0);
        law->q = t >= e->high ? e->high : e->low;
        change = law->q - e->q;
    }
    return (change * change + HIDDEN * HIDDEN * e->q * e->q) * e->all;
}

INLINE real tree_see_everything(tree_search *at, bool star) {
    const tree_problem *p = at->p;
    real residual = R(0), x = R(0);
    for (int32_t i = 0; i < p->contact_count; i++) residual += tree_see(&at->sight[i], &p->contact[i], &p->nu, star);
    for (int32_t i = 0; i < p->element_count; i++) {
        const tree_element *e = &p->element[i];
        if (i == 0 || e[-1].row != e->row) x = tree_dot(e->row, e->on, &p->nu, star);
        residual += tree_see_element(&at->element[i], e, x);
    }
    return residual;
}

RARE real tree_see_deep(tree_search *at) { return tree_see_everything(at, false); }

real laconic_tree_see(tree_search *at) { return at->p->m->star ? tree_see_everything(at, true) : tree_see_deep(at); }

/* ------------------------------------------------------------------------------- laws of an exact pass -- */

/* Along n the impulse is the grip; across n it turns with the slip. */
INLINE void tree_slips(tree_law *restrict law, const tree_sight *s, const tree_contact *c, real penalty) {
    const real n[2] = {s->t[0] / s->length, s->t[1] / s->length}, *rims = c->wheel->rim, grip = c->load.grip;
    const real rim = n[0] * rims[1] - n[1] * rims[0], moved = n[0] * s->moved[1] - n[1] * s->moved[0];
    const real beyond = (s->length - grip) * c->mobility + grip * c->creep, inertia = c->wheel->inertia_kgm2;
    const real row = n[1] * n[1] * c->along - R(2) * n[0] * n[1] * c->cross_row + n[0] * n[0] * c->across;
    const real turns = row + rim * rim / inertia;
    const real most = turns > NO_SLIP * c->mobility ? penalty / turns : R(0);
    const bool far_beyond = most * beyond > grip;
    real h = far_beyond ? grip / beyond : most, turn = R(0);
    real across = (far_beyond ? R(0) : n[0] * c->impulse[1] - n[1] * c->impulse[0]) + h * moved;
    const turning wheel =
        turning_of(inertia, &c->load, h * rim * rim, c->load.axle,
                   inertia * c->load.free_speed + grip * (n[0] * rims[0] + n[1] * rims[1]) + rim * across);
    across -= h * rim * wheel.speed;
    if (!wheel.held) {
        const real all = wheel.slope + h * rim * rim;
        turn = h * rim / all;
        h *= wheel.slope / all;
    }
    law->speed = wheel.speed;
    law->impulse[0] = grip * n[0] - across * n[1];
    law->impulse[1] = grip * n[1] + across * n[0];
    law->turn[0] = -turn * n[1];
    law->turn[1] = turn * n[0];
    law->xx = h * n[1] * n[1];
    law->xy = -h * n[0] * n[1];
    law->yy = h * n[0] * n[0];
}

INLINE void tree_stays_locked(tree_law *restrict law, const tree_sight *s, const tree_contact *c, real penalty) {
    law->xx = penalty * c->row_mass[0];
    law->yy = penalty * c->row_mass[1];
    law->xy = law->speed = law->turn[0] = law->turn[1] = R(0);
    law->impulse[0] = c->impulse[0] + law->xx * s->moved[0];
    law->impulse[1] = c->impulse[1] + law->yy * s->moved[1];
}

INLINE void tree_rolls(tree_law *restrict law, const tree_sight *s, const tree_contact *c, real penalty) {
    const real *e = c->wheel->rolling, size = c->wheel->rim_size, inertia = c->wheel->inertia_kgm2;
    const friction_load *l = &c->load;
    const real own = inertia + l->viscous, speed = (e[0] * s->moved[0] + e[1] * s->moved[1]) / size;
    const real motor = l->drive - l->drive_slope * speed;
    const bool limited = magnitude(motor) > l->drive_limit;
    const real along = (own * speed - inertia * l->free_speed + s->axle - cut(motor, l->drive_limit)) / size;
    const real k = (limited ? own : own + l->drive_slope) / (size * size), side = penalty * c->lateral_mass;
    const real across = e[0] * c->impulse[1] - e[1] * c->impulse[0] + side * (e[0] * s->moved[1] - e[1] * s->moved[0]);
    law->speed = speed;
    law->impulse[0] = e[0] * along - e[1] * across;
    law->impulse[1] = e[1] * along + e[0] * across;
    law->turn[0] = e[0] / size;
    law->turn[1] = e[1] / size;
    law->xx = k * e[0] * e[0] + side * e[1] * e[1];
    law->xy = (k - side) * e[0] * e[1];
    law->yy = k * e[1] * e[1] + side * e[0] * e[0];
}

/* Below its limit a tyre that creeps has the slip creep · impulse, in both directions; the wheel turns as it may. */
static void tree_creeps(tree_law *restrict law, const tree_sight *s, const tree_contact *c, real penalty) {
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2;
    real stiff[2], held[2], pulled[2];
    for (int m = 0; m < 2; m++) {
        const real hard = penalty * c->row_mass[m], share = R(1) / (R(1) + hard * c->creep);
        stiff[m] = hard * share;
        held[m] = share * c->impulse[m] + stiff[m] * s->moved[m];
        pulled[m] = stiff[m] * rim[m];
    }
    const real added = pulled[0] * rim[0] + pulled[1] * rim[1];
    const turning wheel = turning_of(inertia, &c->load, added, c->load.axle,
                                     inertia * c->load.free_speed + rim[0] * held[0] + rim[1] * held[1]);
    const real all = wheel.held ? R(1) : wheel.slope + added, own = wheel.held ? R(1) : wheel.slope;
    const real yields = wheel.held ? R(0) : R(1);
    law->speed = wheel.speed;
    for (int m = 0; m < 2; m++) {
        law->impulse[m] = held[m] - pulled[m] * wheel.speed;
        law->turn[m] = yields * pulled[m] / all;
    }
    law->xx = stiff[0] * (own + yields * pulled[1] * rim[1]) / all;
    law->yy = stiff[1] * (own + yields * pulled[0] * rim[0]) / all;
    law->xy = -yields * pulled[0] * pulled[1] / all;
}

static void tree_take_law(tree_law *law, const tree_sight *s, const tree_contact *c, real penalty) {
    if (s->length > R(0))
        tree_slips(law, s, c, penalty);
    else if (c->creep > R(0))
        tree_creeps(law, s, c, penalty);
    else if (s->locked)
        tree_stays_locked(law, s, c, penalty);
    else
        tree_rolls(law, s, c, penalty);
}

INLINE void tree_move_contact(tree_contact *c, const tree_law *law, const tree_vector *by, bool star) {
    const real x = tree_dot(&c->row[0], c->on, by, star), y = tree_dot(&c->row[1], c->on, by, star);
    c->impulse[0] = law->impulse[0] + law->xx * x + law->xy * y;
    c->impulse[1] = law->impulse[1] + law->xy * x + law->yy * y;
    c->speed = law->speed + law->turn[0] * x + law->turn[1] * y;
}

INLINE void tree_move_all(tree_search *at, const tree_law laws[], const tree_vector *by, bool star) {
    tree_problem *p = at->p;
    real x = R(0);
    for (int32_t i = 0; i < p->contact_count; i++) tree_move_contact(&p->contact[i], &laws[i], by, star);
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        if (i == 0 || e[-1].row != e->row) x = tree_dot(e->row, e->on, by, star);
        e->q = at->element[i].q + at->element[i].stiffness * x;
    }
}

RARE void tree_move_all_deep(tree_search *at, const tree_law laws[], const tree_vector *by) {
    tree_move_all(at, laws, by, false);
}

void laconic_tree_exact_pass(tree_search *at) {
    tree_problem *p = at->p;
    tree_law laws[TREE_WHEELS];
    tree_vector by;
    for (int32_t i = 0; i < p->contact_count; i++) tree_take_law(&laws[i], &at->sight[i], &p->contact[i], p->penalty);
    laconic_tree_move(p, laws, at->element, &by);
    if (p->m->star)
        tree_move_all(at, laws, &by, true);
    else
        tree_move_all_deep(at, laws, &by);
}

#endif
