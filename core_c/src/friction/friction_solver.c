/* One step on ground with friction: a semismooth Newton method on speeds and impulses at once.
 *
 * At the solution each contact's impulse p satisfies p = Π(p + slip/W), Π being the projection onto the disc of radius
 * grip: where the argument t stays inside, the contact sticks; where it leaves, the contact slips. A pass takes each
 * contact as its t says and replaces it by a linear law:
 *     slips    p = grip n + h n⊥n⊥ᵀ slip, n = t/|t|: grip/|slip| as h would be the curvature of the norm, h is that
 *              seen from t, which has the same limit and stays bounded
 *     rolls    no slip along the rolling direction, so that p carries the wheel's own equation; square to it a penalty
 *              whose multiplier is p itself
 *     locked   no slip and no turning, as the axle's friction holds the wheel: penalties in both directions
 * Then each wheel's speed is eliminated, which leaves three equations for ν. Near the solution this converges within
 * few passes; from elsewhere it may go in circles, as it does not look at what it minimises. Then passes along the
 * central path of the smoothed problem (friction_smooth.c) lead on, and exact ones are tried from it now and then.
 *
 * The natural map and its augmented Lagrangian: Alart and Curnier 1991; semismooth Newton: Qi and Sun 1993; as
 * primal-dual active set: Hintermüller, Ito and Kunisch 2002. */
#include "friction_solver.h"
#include "friction_internals.h"

/* A contact in a pass: how it stands, then its linear law p += gain_m (row_m·δν), and s with the first row. */
typedef struct contact_in_pass {
    real moved[2];     /* rows·ν: slip if the wheel stood still */
    real t[2], length; /* impulse + slip/W; length 0 where it sticks */
    real axle;         /* impulse of the axle's friction, as its own projection */
    real firm;         /* residual of a slip to which no wheel gives way, which light wheels would hide otherwise */
    real rest;         /* all other residual */
    bool locked;

    int32_t rank; /* of the law: number of rows */
    vector row[2];
    real stiffness[2], gain[2][2], turn;
    real impulse[2], speed;
} contact_in_pass;

void laconic_friction_prepare(friction_wheel *w) {
    w->row[0] = vec(w->along);
    w->row[1] = scaled(w->drag, vec(w->across));
    w->rim[0] = w->rim_along;
    w->rim[1] = w->drag * w->rim_across;
    w->rim_size = quick_root(w->rim[0] * w->rim[0] + w->rim[1] * w->rim[1]);
    for (int m = 0; m < 2; m++) {
        w->rolling[m] = w->rim[m] / w->rim_size;
        w->row_mass[m] = inverse_or_zero(square(w->row[m]));
    }
    w->mobility = square(w->row[0]) + square(w->row[1]) + w->rim_size * w->rim_size / w->inertia;
    w->lateral_mass = inverse_or_zero(square(combined(w->row, -w->rolling[1], w->rolling[0])));
}

static inline real least_of(real a, real b) { return a < b ? a : b; }

/* The most firm residual of a contact that slips on the border of its grip: no slip moves the impulse further. */
RARE real beyond_grip(const friction_wheel *w, real grip, const real p[2]) {
    const real size = p[0] * p[0] + p[1] * p[1], left = (grip * grip - size) / grip;
    return left * left * inverse_or_zero(w->lateral_mass);
}

/* Looks at a contact with the speeds and impulses of the pass before. Returns the square of its residual. */
INLINE real look(contact_in_pass *restrict c, const friction_wheel *w, const friction_load *l, vector nu, real speed,
                 const real p[2]) {
    real inside = R(1), off[2], axle, pushed, size;
    for (int m = 0; m < 2; m++) {
        c->moved[m] = dot(w->row[m], nu);
        off[m] = (c->moved[m] - w->rim[m] * speed) / w->mobility;
        c->t[m] = p[m] + off[m];
    }
    c->length = R(0);
    size = c->t[0] * c->t[0] + c->t[1] * c->t[1];
    if (l->grip < LACONIC_REAL_MAX && size > BORDER * l->grip * l->grip) {
        const real length = quick_root(size), outwards = c->t[0] * off[0] + c->t[1] * off[1];
        if (length > l->grip) inside = l->grip / length;
        if (length > l->grip || outwards > R(0)) c->length = length;
    }
    /* Inside, the slip itself: t − p would lose what is below a unit in the last place of the impulse. */
    for (int m = 0; m < 2 && inside < R(1); m++) off[m] = inside * c->t[m] - p[m];
    axle = w->rim[0] * p[0] + w->rim[1] * p[1] + w->inertia * (l->free_speed - speed) - l->viscous * speed +
           drive_at(l, speed);
    pushed = axle + w->inertia * speed;
    c->locked = magnitude(pushed) < l->axle;
    c->axle = cut(pushed, l->axle);
    c->firm = R(0);
    if (inside >= R(1)) {
        const real lateral = w->rolling[0] * off[1] - w->rolling[1] * off[0];
        const real held = off[0] * off[0] * w->row_mass[0] + off[1] * off[1] * w->row_mass[1];
        c->firm = w->mobility * w->mobility * (c->locked ? held : lateral * lateral * w->lateral_mass);
        if (c->length > R(0) && !c->locked) c->firm = least_of(c->firm, beyond_grip(w, l->grip, p));
    }
    c->rest = (off[0] * off[0] + off[1] * off[1] + HIDDEN * HIDDEN * size) * w->mobility +
              (axle - c->axle) * (axle - c->axle) / w->inertia;
    return c->rest + c->firm;
}

/* Along n the impulse is the grip; across n it turns with the slip. */
INLINE void slips(contact_in_pass *restrict c, const friction_wheel *w, const friction_load *l, const real p[2]) {
    const real n[2] = {c->t[0] / c->length, c->t[1] / c->length};
    const real rim = n[0] * w->rim[1] - n[1] * w->rim[0], moved = n[0] * c->moved[1] - n[1] * c->moved[0];
    const real beyond = (c->length - l->grip) * w->mobility;
    real h, most, turns, across = R(0);
    turning wheel;
    c->rank = 1;
    c->row[0] = combined(w->row, -n[1], n[0]);
    turns = square(c->row[0]) + rim * rim / w->inertia;
    most = turns > NO_SLIP * w->mobility ? PENALTY / turns : R(0);
    if (most * beyond > l->grip) {
        h = l->grip / beyond;
    } else { /* almost no slip: a penalty, as where it sticks */
        h = most;
        across = n[0] * p[1] - n[1] * p[0];
    }
    across += h * moved;
    wheel = turning_of(w->inertia, l, h * rim * rim, l->axle,
                       w->inertia * l->free_speed + l->grip * (n[0] * w->rim[0] + n[1] * w->rim[1]) + rim * across);
    across -= h * rim * wheel.speed;
    c->speed = wheel.speed;
    c->impulse[0] = l->grip * n[0] - across * n[1];
    c->impulse[1] = l->grip * n[1] + across * n[0];
    c->turn = R(0);
    if (!wheel.held) {
        c->turn = h * rim / (wheel.slope + h * rim * rim);
        h *= wheel.slope / (wheel.slope + h * rim * rim);
    }
    c->stiffness[0] = h;
    c->gain[0][0] = -h * n[1];
    c->gain[0][1] = h * n[0];
}

INLINE void stays_locked(contact_in_pass *restrict c, const friction_wheel *w, const real p[2]) {
    c->rank = 2;
    c->speed = c->turn = R(0);
    for (int m = 0; m < 2; m++) {
        c->row[m] = w->row[m];
        c->stiffness[m] = c->gain[m][m] = PENALTY * w->row_mass[m];
        c->gain[m][1 - m] = R(0);
        c->impulse[m] = p[m] + c->stiffness[m] * c->moved[m];
    }
}

INLINE void rolls(contact_in_pass *restrict c, const friction_wheel *w, const friction_load *l, const real p[2]) {
    const real *e = w->rolling;
    const real own = w->inertia + l->viscous, speed = (e[0] * c->moved[0] + e[1] * c->moved[1]) / w->rim_size;
    const real motor = l->drive - l->drive_slope * speed;
    const bool limited = magnitude(motor) > l->drive_limit;
    const real along = (own * speed - w->inertia * l->free_speed + c->axle - cut(motor, l->drive_limit)) / w->rim_size;
    real across = e[0] * p[1] - e[1] * p[0];
    c->rank = 1;
    c->row[0] = combined(w->row, e[0], e[1]);
    c->stiffness[0] = (limited ? own : own + l->drive_slope) / (w->rim_size * w->rim_size);
    c->gain[0][0] = c->stiffness[0] * e[0];
    c->gain[0][1] = c->stiffness[0] * e[1];
    c->turn = R(1) / w->rim_size;
    if (w->lateral_mass > R(0)) {
        c->rank = 2;
        c->row[1] = combined(w->row, -e[1], e[0]);
        c->stiffness[1] = PENALTY * w->lateral_mass;
        c->gain[1][0] = -c->stiffness[1] * e[1];
        c->gain[1][1] = c->stiffness[1] * e[0];
        across += c->stiffness[1] * (e[0] * c->moved[1] - e[1] * c->moved[0]);
    }
    c->speed = speed;
    c->impulse[0] = e[0] * along - e[1] * across;
    c->impulse[1] = e[1] * along + e[0] * across;
}

static real look_at_all(friction_search *at, contact_in_pass contacts[]) {
    real residual = R(0);
    for (int32_t i = 0; i < at->count; i++)
        residual += look(&contacts[i], &at->wheel[i], &at->load[i], at->nu, at->speed[i], at->impulse[i]);
    return residual;
}

/* What the impulses leave of the body's equations. */
static vector imbalance(const friction_search *at) {
    vector rest = minus(at->free, at->nu);
    for (int32_t i = 0; i < at->count; i++)
        rest = minus(rest, combined(at->wheel[i].row, at->impulse[i][0], at->impulse[i][1]));
    return rest;
}

INLINE void move_contact(const contact_in_pass *c, vector by, real *speed, real p[2]) {
    const real first = dot(c->row[0], by);
    p[0] = c->impulse[0] + c->gain[0][0] * first;
    p[1] = c->impulse[1] + c->gain[0][1] * first;
    *speed = c->speed + c->turn * first;
    if (c->rank > 1) {
        const real second = dot(c->row[1], by);
        p[0] += c->gain[1][0] * second;
        p[1] += c->gain[1][1] * second;
    }
}

static void exact_pass(friction_search *at, contact_in_pass contacts[]) {
    equations k = no_wheels(at);
    vector by;
    for (int32_t i = 0; i < at->count; i++) {
        contact_in_pass *c = &contacts[i];
        if (c->length > R(0))
            slips(c, &at->wheel[i], &at->load[i], at->impulse[i]);
        else if (c->locked)
            stays_locked(c, &at->wheel[i], at->impulse[i]);
        else
            rolls(c, &at->wheel[i], &at->load[i], at->impulse[i]);
        k.rest = minus(k.rest, combined(at->wheel[i].row, c->impulse[0], c->impulse[1]));
        add_product(&k, scaled(c->stiffness[0], c->row[0]), c->row[0]);
        if (c->rank > 1) add_product(&k, scaled(c->stiffness[1], c->row[1]), c->row[1]);
    }
    by = solved(&k);
    at->nu = plus(at->nu, by);
    for (int32_t i = 0; i < at->count; i++) move_contact(&contacts[i], by, &at->speed[i], at->impulse[i]);
}

/* Twice the energy of the motion without the contacts, with the motors' damping as inertia, which is what a step's
 * implicit motor is: without it a result could be far less accurate than the motion of a damped wheel. NaN where a
 * limit is, which comparisons would pass over. */
static real free_energy(const friction_search *at) {
    real energy = square(at->free);
    for (int32_t i = 0; i < at->count; i++) {
        const friction_load *l = &at->load[i];
        const real inertia = at->wheel[i].inertia, push = inertia * l->free_speed + drive_at(l, R(0));
        const real slope = magnitude(l->drive) < l->drive_limit ? l->drive_slope : R(0);
        energy += push * push / (inertia + l->viscous + slope);
        energy += zero_if_finite(l->viscous) + zero_if_finite(l->drive_slope);
        energy += zero_if_finite(l->grip) + zero_if_finite(l->axle) + zero_if_finite(l->drive_limit);
    }
    return energy;
}

/* A guess far above what these loads can ask for is stress that opposite contacts kept from former steps. Its rounding
 * errors would drown the speeds, so it is forgotten. */
static void forget_stress(friction_search *at) {
    for (int32_t i = 0; i < at->count; i++) {
        real *p = at->impulse[i];
        if ((p[0] * p[0] + p[1] * p[1]) * at->wheel[i].mobility > MOST_STRESS * at->scale) p[0] = p[1] = R(0);
    }
}

void laconic_friction_follow(friction_search *at) {
    at->nu = plus(at->nu, imbalance(at));
    for (int32_t i = 0; i < at->count; i++) {
        const friction_wheel *w = &at->wheel[i];
        const real push =
            w->inertia * at->load[i].free_speed + w->rim[0] * at->impulse[i][0] + w->rim[1] * at->impulse[i][1];
        at->speed[i] = turning_of(w->inertia, &at->load[i], R(0), at->load[i].axle, push).speed;
    }
}

/* Speeds that are rounding errors of standing still become 0, so that rest stays rest to the last bit. */
static void snap(friction_search *at) {
    real energy = square(at->nu);
    for (int32_t i = 0; i < at->count; i++) energy += at->wheel[i].inertia * at->speed[i] * at->speed[i];
    if (energy > SNAP * SNAP * at->scale) return;
    at->nu = none;
    for (int32_t i = 0; i < at->count; i++) at->speed[i] = R(0);
}

static bool is_solved(const friction_search *at, real residual, real times) {
    const real most = times * TOLERANCE * TOLERANCE * at->scale;
    if (residual > most) return false;
    return residual + square(imbalance(at)) <= most;
}

/* All that rounding leaves to find, where contacts hold each other with many times the free motion, or rollers drag so
 * little that single does not tell it from nothing. */
static bool is_resolved(friction_search *at, contact_in_pass contacts[]) {
    real stress = R(0), residual = R(0);
    (void)look_at_all(at, contacts);
    for (int32_t i = 0; i < at->count; i++) {
        const real *p = at->impulse[i];
        stress += (p[0] * p[0] + p[1] * p[1]) * at->wheel[i].mobility;
        residual += contacts[i].rest;
    }
    return residual + square(imbalance(at)) <= RESOLVED * RESOLVED * at->scale + ROUNDED * ROUNDED * stress;
}

/* Exact passes, at most so many, as long as each but the first is worth it. */
static bool pass_exactly(friction_search *at, contact_in_pass contacts[], int32_t most, int32_t *passes) {
    real before = LACONIC_REAL_MAX;
    for (int32_t pass = 0;; pass++) {
        const real residual = look_at_all(at, contacts);
        ++*passes;
        if (is_solved(at, residual, R(1))) return true;
        if (pass == most || (pass > 1 && residual > WORTH_IT * before)) return false;
        before = residual;
        exact_pass(at, contacts);
    }
}

typedef struct kept_search {
    vector nu;
    real speed[LACONIC_MAX_WHEELS], impulse[LACONIC_MAX_WHEELS][2];
} kept_search;

static void keep(kept_search *kept, const friction_search *at) {
    kept->nu = at->nu;
    for (int32_t i = 0; i < at->count; i++) {
        kept->speed[i] = at->speed[i];
        for (int m = 0; m < 2; m++) kept->impulse[i][m] = at->impulse[i][m];
    }
}

static void go_back(friction_search *at, const kept_search *kept) {
    at->nu = kept->nu;
    for (int32_t i = 0; i < at->count; i++) {
        at->speed[i] = kept->speed[i];
        for (int m = 0; m < 2; m++) at->impulse[i][m] = kept->impulse[i][m];
    }
}

/* Passes along the central path, and from time to time exact ones: they finish at once where they converge. */
RARE bool search_along_path(friction_search *at, contact_in_pass contacts[], int32_t *passes) {
    friction_path path;
    kept_search kept;
    laconic_friction_start_path(at, &path);
    for (int32_t ahead = FIRST_AHEAD; *passes + ahead + TRIED + 1 <= FRICTION_MOST_PASSES; ahead = AHEAD) {
        for (int32_t pass = 0; pass < ahead; pass++) laconic_friction_follow_path(at, &path);
        *passes += ahead;
        keep(&kept, at);
        if (pass_exactly(at, contacts, TRIED, passes)) return true;
        if (ahead == AHEAD && is_solved(at, look_at_all(at, contacts), CLOSE)) return true;
        go_back(at, &kept);
        if (ahead == AHEAD && is_resolved(at, contacts)) return true;
    }
    return false;
}

static int32_t search(friction_search *at) {
    contact_in_pass contacts[LACONIC_MAX_WHEELS];
    int32_t passes = 0;
    if (!pass_exactly(at, contacts, EXACT_PASSES, &passes) && !search_along_path(at, contacts, &passes)) return 0;
    snap(at);
    return passes;
}

int32_t laconic_friction_solve(const friction_wheel wheels[], const friction_load loads[], int32_t count,
                               const real free_nu[3], real nu[3], real speed[], real impulse[][2]) {
    friction_search at = {wheels, loads, count, vec(free_nu), vec(free_nu), speed, impulse, R(0)};
    int32_t passes;
    at.scale = free_energy(&at);
    if (!is_finite(at.scale)) return 0;
    forget_stress(&at);
    if (at.scale < SMALLEST_ENERGY) { /* nothing moves, and forget_stress() took all impulses */
        store(nu, none);
        for (int32_t i = 0; i < count; i++) speed[i] = R(0);
        return 1;
    }
    laconic_friction_follow(&at);
    passes = search(&at);
    store(nu, at.nu);
    return passes;
}
