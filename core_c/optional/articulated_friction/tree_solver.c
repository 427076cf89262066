/* One step of a tree on ground with friction: the semismooth Newton method of friction_solver.c, with rows along the
 * paths of the tree and with scalar elements. There the passes, the residual and the constants are derived.
 *
 * An element satisfies q = Π(q + (x − target − compliance q)/(W + compliance)), W = |row|², Π the projection onto
 * [low, high]. Inside it holds with the stiffness ρ/(1 + ρ compliance), ρ a penalty; outside, q is the bound. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#ifdef LACONIC_SINGLE
#define TREE_STIFF_PENALTY PENALTY
#define TREE_TOLERANCE R(1e-5)
#define TREE_RESOLVED R(4e-5)
#define TREE_ROUNDED R(3e-7)
#define TREE_CLOSE R(9)
#define TREE_SNAP R(1e-4)
#define TREE_BORDER R(1)
#define TREE_HIDDEN R(1e-8)
#define TREE_MOST_STRESS R(1e4)
#else
#define TREE_STIFF_PENALTY R(1e8) /* at first: a pass less than with PENALTY, where contacts keep to stick or slip */
#define TREE_TOLERANCE R(1e-12)
#define TREE_RESOLVED R(3e-11)
#define TREE_ROUNDED R(6e-16)
#define TREE_CLOSE R(900)
#define TREE_SNAP R(1e-10)
#define TREE_BORDER R(0.998)
#define TREE_HIDDEN R(1e-16)
#define TREE_MOST_STRESS R(1e8)
#endif

#define TREE_SMALLEST_ENERGY (LACONIC_REAL_MIN / (TREE_TOLERANCE * TREE_TOLERANCE))
#define TREE_NO_SLIP R(1e-30)
#define TREE_EXACT_PASSES 6
#define TREE_FIRST_AHEAD 5
#define TREE_AHEAD 3
#define TREE_TRIED 3
#define TREE_WORTH_IT R(0.1)
#define TREE_NEARLY R(4) /* where rounding leaves no more to find: twice the tolerance, squared */
#define TREE_MOST_STRESSES 3
#define TREE_SAME R(0.01)     /* of a change, squared */
#define TREE_FARTHEST R(1e12) /* of the change in one pass */
#define TREE_ALMOST (R(1e2) * TREE_TOLERANCE)

/* What a pass sees of a contact. */
typedef struct tree_sight {
    real moved[2], t[2], length, axle, firm, rest;
    bool locked;
} tree_sight;

typedef struct tree_search {
    tree_problem *p;
    tree_sight sight[TREE_WHEELS];
    tree_element_law element[TREE_ELEMENTS];
} tree_search;

static real tree_inverse_or_zero(real x) { return x > R(0) ? R(1) / x : R(0); }

INLINE void tree_prepare_contact(tree_contact *c, bool star) {
    const real *e = c->wheel->rolling;
    c->along = tree_row_product(&c->row[0], &c->row[0], c->on, star);
    c->cross_row = tree_row_product(&c->row[0], &c->row[1], c->on, star);
    c->across = tree_row_product(&c->row[1], &c->row[1], c->on, star);
    c->row_mass[0] = tree_inverse_or_zero(c->along);
    c->row_mass[1] = tree_inverse_or_zero(c->across);
    c->mobility = c->along + c->across + c->wheel->rim_size * c->wheel->rim_size / c->wheel->inertia_kgm2;
    c->inverse_mobility = R(1) / c->mobility;
    c->lateral_mass = c->row_mass[1];
    if (e[1] == R(0)) return;
    c->lateral_mass =
        tree_inverse_or_zero(e[1] * e[1] * c->along - R(2) * e[0] * e[1] * c->cross_row + e[0] * e[0] * c->across);
}

static void tree_stiffen_element(tree_element *e, real of_mass) {
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
        tree_stiffen_element(e, TREE_STIFF_PENALTY);
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
    return left * left * tree_inverse_or_zero(c->lateral_mass);
}

INLINE void tree_see_axle(tree_sight *restrict s, const tree_contact *c) {
    const friction_load *l = &c->load;
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2, speed = c->speed;
    const real axle = rim[0] * c->impulse[0] + rim[1] * c->impulse[1] + inertia * (l->free_speed - speed) -
                      l->viscous * speed + drive_at(l, speed);
    const real pushed = axle + inertia * speed;
    s->locked = magnitude(pushed) < l->axle;
    s->axle = cut(pushed, l->axle);
    s->rest = (axle - s->axle) * (axle - s->axle) / inertia;
}

/* Returns the square of the contact's residual. */
INLINE real tree_see(tree_sight *restrict s, const tree_contact *c, const tree_vector *nu, bool star) {
    const real *rim = c->wheel->rim, *e = c->wheel->rolling, *p = c->impulse, grip = c->load.grip;
    real inside = R(1), off[2], size;
    for (int m = 0; m < 2; m++) {
        s->moved[m] = tree_dot(&c->row[m], c->on, nu, star);
        off[m] = (s->moved[m] - rim[m] * c->speed) * c->inverse_mobility;
        s->t[m] = p[m] + off[m];
    }
    s->length = s->firm = R(0);
    size = s->t[0] * s->t[0] + s->t[1] * s->t[1];
    if (size > TREE_BORDER * grip * grip) {
        const real length = quick_root(size), outwards = s->t[0] * off[0] + s->t[1] * off[1];
        if (length > grip) inside = grip / length;
        if (length > grip || outwards > R(0)) s->length = length;
    }
    for (int m = 0; m < 2 && inside < R(1); m++) off[m] = inside * s->t[m] - p[m];
    tree_see_axle(s, c);
    if (inside >= R(1)) {
        const real lateral = e[0] * off[1] - e[1] * off[0];
        const real held = off[0] * off[0] * c->row_mass[0] + off[1] * off[1] * c->row_mass[1];
        s->firm = c->mobility * c->mobility * (s->locked ? held : lateral * lateral * c->lateral_mass);
        if (s->length > R(0) && !s->locked && s->firm > R(0)) {
            const real most = tree_beyond_grip(c);
            if (most < s->firm) s->firm = most;
        }
    }
    s->rest += (off[0] * off[0] + off[1] * off[1] + TREE_HIDDEN * TREE_HIDDEN * size) * c->mobility;
    return s->rest + s->firm;
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
    return (change * change + TREE_HIDDEN * TREE_HIDDEN * e->q * e->q) * e->all;
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

static real tree_see_all(tree_search *at) { return at->p->m->star ? tree_see_everything(at, true) : tree_see_deep(at); }

/* ------------------------------------------------------------------------------- laws of an exact pass -- */

/* A wheel's speed, and how its resistance grows with it: friction_internals.h. */
static inline turning tree_turning(const tree_contact *c, real added, real axle, real push) {
    friction_wheel of;
    of.inertia = c->wheel->inertia_kgm2;
    return turning_of(&of, &c->load, added, axle, push);
}

/* Along n the impulse is the grip; across n it turns with the slip. */
INLINE void tree_slips(tree_law *restrict law, const tree_sight *s, const tree_contact *c, real penalty) {
    const real n[2] = {s->t[0] / s->length, s->t[1] / s->length}, *rims = c->wheel->rim, grip = c->load.grip;
    const real rim = n[0] * rims[1] - n[1] * rims[0], moved = n[0] * s->moved[1] - n[1] * s->moved[0];
    const real beyond = (s->length - grip) * c->mobility, inertia = c->wheel->inertia_kgm2;
    const real row = n[1] * n[1] * c->along - R(2) * n[0] * n[1] * c->cross_row + n[0] * n[0] * c->across;
    const real turns = row + rim * rim / inertia;
    const real most = turns > TREE_NO_SLIP * c->mobility ? penalty / turns : R(0);
    const bool far_beyond = most * beyond > grip;
    real h = far_beyond ? grip / beyond : most, turn = R(0);
    real across = (far_beyond ? R(0) : n[0] * c->impulse[1] - n[1] * c->impulse[0]) + h * moved;
    const turning wheel =
        tree_turning(c, h * rim * rim, c->load.axle,
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

static void tree_take_law(tree_law *law, const tree_sight *s, const tree_contact *c, real penalty) {
    if (s->length > R(0))
        tree_slips(law, s, c, penalty);
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

static void tree_exact_pass(tree_search *at) {
    tree_problem *p = at->p;
    tree_law laws[TREE_WHEELS];
    tree_vector by;
    for (int32_t i = 0; i < p->contact_count; i++)
        tree_take_law(&laws[i], &at->sight[i], &p->contact[i], p->penalty);
    laconic_tree_move(p, laws, at->element, &by);
    if (p->m->star)
        tree_move_all(at, laws, &by, true);
    else
        tree_move_all_deep(at, laws, &by);
}

/* --------------------------------------------------------------------------------------- the search -- */

/* Twice the energy of the motion without contacts and elements but with what drives them; NaN where a limit is. */
static real tree_free_energy(const tree_problem *p) {
    real energy = tree_square(&p->free, p->m->body_count);
    for (int32_t i = 0; i < p->contact_count; i++) {
        const friction_load *l = &p->contact[i].load;
        const real inertia = p->contact[i].wheel->inertia_kgm2, push = inertia * l->free_speed + drive_at(l, R(0));
        const real slope = magnitude(l->drive) < l->drive_limit ? l->drive_slope : R(0);
        energy += push * push / (inertia + l->viscous + slope);
        energy += zero_if_finite(l->viscous) + zero_if_finite(l->drive_slope);
        energy += zero_if_finite(l->grip) + zero_if_finite(l->axle) + zero_if_finite(l->drive_limit);
    }
    for (int32_t i = 0; i < p->element_count; i++) {
        const tree_element *e = &p->element[i];
        energy += zero_if_finite(e->target) + zero_if_finite(e->compliance) + zero_if_finite(e->mobility);
        if (e->compliance > R(0) && e->high < LACONIC_REAL_MAX) {
            const real q = cut(e->target / e->compliance, e->high);
            energy += q * q * e->mobility / (R(1) + e->mobility / e->compliance);
        } else if (tree_unbounded(e)) {
            energy += e->target * e->target / e->mobility;
        }
    }
    return energy;
}

/* Contacts and elements that hold each other with many times the free motion would drown the speeds in rounding. */
static void tree_forget_stress(tree_problem *p) {
    for (int32_t i = 0; i < p->contact_count; i++) {
        real *q = p->contact[i].impulse;
        if ((q[0] * q[0] + q[1] * q[1]) * p->contact[i].mobility > TREE_MOST_STRESS * p->scale) q[0] = q[1] = R(0);
    }
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        if (e->q * e->q * e->mobility > TREE_MOST_STRESS * p->scale) e->q = R(0);
    }
}

void laconic_tree_follow(tree_problem *p) {
    p->nu.base = p->free.base;
    for (int32_t j = 0; j < p->m->body_count; j++) p->nu.hinge[j] = p->free.hinge[j];
    laconic_tree_take_forces(&p->nu, p);
    for (int32_t i = 0; i < p->contact_count; i++) {
        tree_contact *c = &p->contact[i];
        const real push = c->wheel->inertia_kgm2 * c->load.free_speed + c->wheel->rim[0] * c->impulse[0] +
                          c->wheel->rim[1] * c->impulse[1];
        c->speed = tree_turning(c, R(0), c->load.axle, push).speed;
    }
}

static void tree_rest(tree_problem *p) {
    p->nu.base = none;
    for (int32_t j = 0; j < p->m->body_count; j++) p->nu.hinge[j] = R(0);
    for (int32_t i = 0; i < p->contact_count; i++) p->contact[i].speed = R(0);
}

static void tree_snap(tree_problem *p) {
    real energy = tree_square(&p->nu, p->m->body_count);
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        energy += c->wheel->inertia_kgm2 * c->speed * c->speed;
    }
    if (energy <= TREE_SNAP * TREE_SNAP * p->scale) tree_rest(p);
}

static real tree_imbalance_square(const tree_problem *p) {
    tree_vector rest;
    laconic_tree_imbalance(&rest, p);
    return tree_square(&rest, p->m->body_count);
}

static bool tree_is_solved(const tree_problem *p, real residual, real times) {
    const real most = times * TREE_TOLERANCE * TREE_TOLERANCE * p->scale;
    return residual <= most && residual + tree_imbalance_square(p) <= most;
}

/* All that rounding leaves to find. */
static bool tree_is_resolved(tree_search *at) {
    tree_problem *p = at->p;
    real stress = R(0), residual = tree_see_all(at);
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        stress += (c->impulse[0] * c->impulse[0] + c->impulse[1] * c->impulse[1]) * c->mobility;
        residual -= at->sight[i].firm;
    }
    for (int32_t i = 0; i < p->element_count; i++) stress += p->element[i].q * p->element[i].q * p->element[i].mobility;
    return residual + tree_imbalance_square(p) <=
           TREE_RESOLVED * TREE_RESOLVED * p->scale + TREE_ROUNDED * TREE_ROUNDED * stress;
}

typedef struct tree_kept {
    tree_vector nu;
    real speed[TREE_WHEELS], impulse[TREE_WHEELS][2], q[TREE_ELEMENTS];
} tree_kept;

static void tree_keep(tree_kept *kept, const tree_problem *p) {
    kept->nu = p->nu;
    for (int32_t i = 0; i < p->contact_count; i++) {
        kept->speed[i] = p->contact[i].speed;
        for (int m = 0; m < 2; m++) kept->impulse[i][m] = p->contact[i].impulse[m];
    }
    for (int32_t i = 0; i < p->element_count; i++) kept->q[i] = p->element[i].q;
}

static void tree_go_back(tree_problem *p, const tree_kept *kept) {
    p->nu = kept->nu;
    for (int32_t i = 0; i < p->contact_count; i++) {
        p->contact[i].speed = kept->speed[i];
        for (int m = 0; m < 2; m++) p->contact[i].impulse[m] = kept->impulse[i][m];
    }
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q = kept->q[i];
}

/* How far the contact's impulse can grow by such a change until it is at the border of its grip. */
static real tree_reach(const tree_contact *c, const real change[2]) {
    const real *p = c->impulse, a = change[0] * change[0] + change[1] * change[1];
    const real b = p[0] * change[0] + p[1] * change[1];
    const real left = c->load.grip * c->load.grip - (p[0] * p[0] + p[1] * p[1]), root = b * b + a * left;
    return a > R(0) && left > R(0) && root > R(0) ? left / (b + quick_root(root)) : LACONIC_REAL_MAX;
}

static real tree_element_reach(const tree_element *e, real change) {
    if (change > R(0) && e->high < LACONIC_REAL_MAX) return (e->high - e->q) / change;
    if (change < R(0) && e->low > -LACONIC_REAL_MAX) return (e->low - e->q) / change;
    return LACONIC_REAL_MAX;
}

/* The square of the change of impulses and q between two passes, less `share` of another change. */
static real tree_change(const tree_problem *p, const tree_kept *from, const tree_kept *to, const tree_kept *less,
                        real share) {
    real sum = R(0);
    for (int32_t i = 0; i < p->contact_count; i++)
        for (int m = 0; m < 2; m++) {
            const real was = from->impulse[i][m] - less->impulse[i][m];
            const real off = to->impulse[i][m] - from->impulse[i][m] - share * was;
            sum += off * off * p->contact[i].mobility;
        }
    for (int32_t i = 0; i < p->element_count; i++) {
        const real off = to->q[i] - from->q[i] - share * (from->q[i] - less->q[i]);
        sum += off * off * p->element[i].mobility;
    }
    return sum;
}

/* How often the last change can be added until something is at its bound. */
static real tree_least_reach(const tree_search *at, const tree_kept *before) {
    const tree_problem *p = at->p;
    real reach = LACONIC_REAL_MAX;
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        const real change[2] = {c->impulse[0] - before->impulse[i][0], c->impulse[1] - before->impulse[i][1]};
        const real here = at->sight[i].length > R(0) ? LACONIC_REAL_MAX : tree_reach(c, change);
        if (here < reach) reach = here;
    }
    for (int32_t i = 0; i < p->element_count; i++) {
        const tree_element *e = &p->element[i];
        if (!(at->element[i].stiffness > R(0))) continue;
        const real here = tree_element_reach(e, e->q - before->q[i]);
        if (here < reach) reach = here;
    }
    return reach;
}

/* Contacts and elements that all stick may ask for more than any motion fulfils, by as little as two casters that are
 * not quite in line. Each pass then stresses them against each other by as little more, until the weakest slips: far
 * too many passes. Goes there at once, along the change of a pass, if that of the next is the same: rounding errors
 * would stress them in vain. Returns false where nothing gives way. */
RARE bool tree_stress_to_slip(tree_search *at, int32_t *passes) {
    tree_problem *p = at->p;
    tree_kept first, second, now;
    tree_keep(&first, p);
    tree_exact_pass(at);
    tree_keep(&second, p);
    (void)tree_see_all(at);
    tree_exact_pass(at);
    tree_keep(&now, p);
    *passes += 2;
    if (tree_change(p, &second, &now, &first, R(1)) > TREE_SAME * tree_change(p, &second, &now, &first, R(0)))
        return false;
    const real reach = tree_least_reach(at, &second);
    if (!(reach < TREE_FARTHEST)) return false;
    for (int32_t i = 0; i < p->contact_count; i++)
        for (int m = 0; m < 2; m++)
            p->contact[i].impulse[m] += reach * (p->contact[i].impulse[m] - second.impulse[i][m]);
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q += reach * (p->element[i].q - second.q[i]);
    return true;
}

static bool tree_pass_exactly(tree_search *at, int32_t most, int32_t *passes) {
    real before = LACONIC_REAL_MAX;
    int32_t stresses = 0;
    for (int32_t pass = 0;; pass++) {
        const real residual = tree_see_all(at);
        ++*passes;
        if (tree_is_solved(at->p, residual, R(1))) return true;
        const bool stalls = pass > 1 && residual > TREE_WORTH_IT * before;
        if (stalls && tree_is_solved(at->p, residual, TREE_NEARLY)) return true;
        before = residual;
        if (stalls && stresses < TREE_MOST_STRESSES && residual <= TREE_ALMOST * TREE_ALMOST * at->p->scale &&
            tree_stress_to_slip(at, passes)) {
            stresses++;
            pass = 0;
            continue;
        }
        if (pass == most || stalls) return false;
        tree_exact_pass(at);
    }
}

/* Passes along the central path, and from time to time exact ones: they finish at once where they converge. */
RARE bool tree_search_along_path(tree_search *at, int32_t *passes) {
    tree_path path;
    tree_kept kept;
    at->p->penalty = PENALTY; /* rounding: contacts that hold each other may need it */
    for (int32_t i = 0; i < at->p->element_count; i++) tree_stiffen_element(&at->p->element[i], PENALTY);
    laconic_tree_start_path(at->p, &path);
    for (int32_t ahead = TREE_FIRST_AHEAD; *passes + ahead + TREE_TRIED + 1 <= TREE_MOST_PASSES; ahead = TREE_AHEAD) {
        for (int32_t pass = 0; pass < ahead; pass++) laconic_tree_follow_path(at->p, &path);
        *passes += ahead;
        tree_keep(&kept, at->p);
        if (tree_pass_exactly(at, TREE_TRIED, passes)) return true;
        if (ahead == TREE_AHEAD && tree_is_solved(at->p, tree_see_all(at), TREE_CLOSE)) return true;
        tree_go_back(at->p, &kept);
        if (ahead == TREE_AHEAD && tree_is_resolved(at)) return true;
    }
    return false;
}

/* Nothing moves and nothing drives it: no forces, either. */
RARE int32_t tree_nothing(tree_problem *p) {
    tree_rest(p);
    for (int32_t i = 0; i < p->contact_count; i++) p->contact[i].impulse[0] = p->contact[i].impulse[1] = R(0);
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q = R(0);
    return 1;
}

int32_t laconic_tree_solve(tree_problem *p) {
    tree_search at;
    int32_t passes = 0;
    at.p = p;
    p->scale = tree_free_energy(p);
    if (!is_finite(p->scale)) return 0;
    if (p->scale < TREE_SMALLEST_ENERGY) return tree_nothing(p);
    tree_forget_stress(p);
    laconic_tree_follow(p);
    if (!tree_pass_exactly(&at, TREE_EXACT_PASSES, &passes) && !tree_search_along_path(&at, &passes)) return 0;
    tree_snap(p);
    return passes;
}

#endif
