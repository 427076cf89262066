/* One step on ground with friction: a semismooth Newton method on speeds and impulses at once.
 *
 * At the solution each contact's impulse p satisfies p = Π(p + ρ slip), Π being the projection onto the disc of radius
 * grip: where the argument t stays inside, the contact sticks; where it leaves, the contact slips. A pass takes each
 * contact as its t says and replaces it by a linear law p = p₀ + H slip:
 *     slips    p = grip n + H n⊥n⊥ᵀ slip, n = t/|t|, H the curvature grip/|slip| of the norm as seen from t
 *     rolls    no slip; across the rolling direction by a penalty whose multiplier is p itself
 *     locked   as it rolls, and the axle's friction keeps the wheel from turning
 * Then each wheel's speed is eliminated, which leaves three equations for ν.
 *
 * The natural map and its augmented Lagrangian: Alart and Curnier 1991; semismooth Newton: Qi and Sun 1993; as
 * primal-dual active set: Hintermüller, Ito and Kunisch 2002. */
#include "friction_solver.h"

#include "elementary.h"

/* The residual that a result must reach. A penalty of 1e5 times the contact's own stiffness brings the multipliers of
 * redundant contacts five digits nearer in each pass and leaves ten digits to the sums, and in single three and four. */
#ifdef LACONIC_SINGLE
#define TOLERANCE R(4e-6)
#define PENALTY R(1e3)
#define SNAP R(2e-6)
#else
#define TOLERANCE R(2e-10)
#define PENALTY R(1e5)
#define SNAP R(1e-10)
#endif

/* Energy below which squares of residuals would underflow: such speeds count as none. */
#define MOST_STRESS R(100) /* the impulses that steps ask for are some times the free motion's */
#define SMALLEST_ENERGY (LACONIC_REAL_MIN / (TOLERANCE * TOLERANCE))

/* A contact made linear: p += e_m stiffness_m (a_m·δν) for both directions e_m, a_m being their row; s likewise. */
typedef struct contact {
    real e[2][2], stiffness[2], turn[2];
    vector row[2];
    real impulse[2], speed;
} contact;

/* What a contact's law is made from, at the speeds and impulses of the pass. */
typedef struct sight {
    const friction_wheel *wheel;
    const friction_load *load;
    const real *impulse; /* the pass before's */
    real moved[2];       /* rows·ν: slip if the wheel stood still */
    real t[2], length;   /* impulse + ρ slip */
    real axle;           /* impulse of the axle's friction, projected */
    bool locked;
} sight;

static real cut(real x, real limit) { return x > limit ? limit : (x < -limit ? -limit : x); }

static vector combined(const vector rows[2], real first, real second) {
    return plus(scaled(first, rows[0]), scaled(second, rows[1]));
}

/* 1/x, or 0 where there is nothing to act on. */
static real inverse(real x) { return x > R(0) ? R(1) / x : R(0); }

void laconic_friction_prepare(friction_wheel *w) {
    real length;
    w->row[0] = vec(w->along);
    w->row[1] = scaled(w->drag, vec(w->across));
    w->rim[0] = w->rim_along;
    w->rim[1] = w->drag * w->rim_across;
    w->rim_squared = w->rim[0] * w->rim[0] + w->rim[1] * w->rim[1];
    length = laconic_root(w->rim_squared);
    for (int m = 0; m < 2; m++) {
        w->rolling[m] = w->rim[m] / length;
        w->row_mass[m] = inverse(square(w->row[m]));
    }
    w->inverse_mass = square(w->row[0]) + square(w->row[1]) + w->rim_squared / w->inertia;
    w->lateral_mass = inverse(square(combined(w->row, -w->rolling[1], w->rolling[0])));
}

static real drive_at(const friction_load *l, real speed) {
    return cut(l->drive - l->drive_slope * speed, l->drive_limit);
}

/* The wheel's own equation as a function of its speed: slope of (j + viscous) s − motor. */
static real slope_at(const sight *at, real speed) {
    const friction_load *l = at->load;
    const bool free = magnitude(l->drive - l->drive_slope * speed) <= l->drive_limit;
    return at->wheel->inertia + l->viscous + (free ? l->drive_slope : R(0));
}

/* Solves slope s + axle sign(s) − motor(s) = push, which is monotone and linear by pieces. Returns 0 in *slope where the
 * axle holds the wheel. */
static real wheel_speed(const friction_load *l, real push, real *slope) {
    const real start = push + cut(l->drive, l->drive_limit);
    const real driven = push - (start > R(0) ? l->axle : -l->axle), contact_slope = *slope;
    real speed, motor;
    if (magnitude(start) <= l->axle) {
        *slope = R(0);
        return R(0);
    }
    *slope = contact_slope + l->drive_slope;
    speed = (driven + l->drive) / *slope;
    motor = l->drive - l->drive_slope * speed;
    if (magnitude(motor) <= l->drive_limit) return speed;
    *slope = contact_slope;
    return (driven + cut(motor, l->drive_limit)) / contact_slope;
}

static void set_directions(contact *c, const friction_wheel *w, real first, real second) {
    c->e[0][0] = first;
    c->e[0][1] = second;
    c->e[1][0] = -second;
    c->e[1][1] = first;
    c->row[0] = combined(w->row, first, second);
    c->row[1] = combined(w->row, -second, first);
}

/* Along n the impulse is the grip; across n it turns with the slip. */
static void slips(contact *c, const sight *at) {
    const friction_wheel *w = at->wheel;
    const friction_load *l = at->load;
    const real n[2] = {at->t[0] / at->length, at->t[1] / at->length};
    real rim, moved, most, h, rest = R(0), slope;
    set_directions(c, w, n[0], n[1]);
    rim = n[0] * w->rim[1] - n[1] * w->rim[0];
    moved = n[0] * at->moved[1] - n[1] * at->moved[0];
    most = PENALTY / (square(c->row[1]) + rim * rim / w->inertia + LACONIC_REAL_MIN);
    h = l->grip / ((at->length - l->grip) * w->inverse_mass);
    if (!(h < most)) { /* almost no slip: a penalty, as where it sticks */
        h = most;
        rest = n[0] * at->impulse[1] - n[1] * at->impulse[0];
    }
    slope = w->inertia + l->viscous + h * rim * rim;
    c->speed = wheel_speed(
        l, w->inertia * l->free_speed + l->grip * (n[0] * w->rim[0] + n[1] * w->rim[1]) + rim * (rest + h * moved),
        &slope);
    rest += h * (moved - rim * c->speed);
    c->impulse[0] = l->grip * n[0] - rest * n[1];
    c->impulse[1] = l->grip * n[1] + rest * n[0];
    c->stiffness[0] = c->turn[0] = R(0);
    c->turn[1] = h * rim * inverse(slope);
    c->stiffness[1] = h - h * rim * c->turn[1];
    if (slope > R(0)) c->stiffness[1] = h * ((slope - h * rim * rim) / slope);
}

static void is_locked(contact *c, const sight *at) {
    set_directions(c, at->wheel, R(1), R(0));
    c->speed = R(0);
    for (int m = 0; m < 2; m++) {
        c->stiffness[m] = PENALTY * at->wheel->row_mass[m];
        c->turn[m] = R(0);
        c->impulse[m] = at->impulse[m] + c->stiffness[m] * at->moved[m];
    }
}

static void rolls(contact *c, const sight *at) {
    const friction_wheel *w = at->wheel;
    const friction_load *l = at->load;
    const real *e = w->rolling;
    const real length = w->rim[0] * e[0] + w->rim[1] * e[1];
    const real speed = (e[0] * at->moved[0] + e[1] * at->moved[1]) / length;
    const real lateral = PENALTY * w->lateral_mass;
    const real along =
        ((w->inertia + l->viscous) * speed - w->inertia * l->free_speed + at->axle - drive_at(l, speed)) / length;
    const real across =
        e[0] * at->impulse[1] - e[1] * at->impulse[0] + lateral * (e[0] * at->moved[1] - e[1] * at->moved[0]);
    set_directions(c, w, e[0], e[1]);
    c->speed = speed;
    c->impulse[0] = e[0] * along - e[1] * across;
    c->impulse[1] = e[1] * along + e[0] * across;
    c->stiffness[0] = slope_at(at, speed) / w->rim_squared;
    c->stiffness[1] = lateral;
    c->turn[0] = R(1) / length;
    c->turn[1] = R(0);
}

/* Looks at a contact with the speeds and impulses of the pass before. Returns the square of its residual. */
static real look(sight *at, vector nu, real speed) {
    const friction_wheel *w = at->wheel;
    const friction_load *l = at->load;
    const real rho = R(1) / w->inverse_mass;
    real inside = R(1), off[2], axle, of_contact, of_axle;
    for (int m = 0; m < 2; m++) {
        at->moved[m] = dot(w->row[m], nu);
        at->t[m] = at->impulse[m] + rho * (at->moved[m] - w->rim[m] * speed);
    }
    at->length = R(0);
    if (l->grip < LACONIC_REAL_MAX && at->t[0] * at->t[0] + at->t[1] * at->t[1] > l->grip * l->grip) {
        at->length = laconic_root(at->t[0] * at->t[0] + at->t[1] * at->t[1]);
        inside = l->grip / at->length;
    }
    for (int m = 0; m < 2; m++) off[m] = inside * at->t[m] - at->impulse[m];
    axle = w->rim[0] * at->impulse[0] + w->rim[1] * at->impulse[1] + w->inertia * (l->free_speed - speed) -
           l->viscous * speed + drive_at(l, speed);
    at->axle = cut(axle + w->inertia * speed, l->axle);
    at->locked = magnitude(axle + w->inertia * speed) < l->axle;
    of_contact = (off[0] * off[0] + off[1] * off[1]) * w->inverse_mass;
    of_axle = (axle - at->axle) * (axle - at->axle) / w->inertia;
    return of_contact + of_axle;
}

/* ν* − ν − Σ rows·p and 1 + Σ stiffness row rowᵀ: the equations for δν. */
typedef struct equations {
    vector rest;
    real xx, xy, xz, yy, yz, zz;
} equations;

static void add_row(equations *k, vector row, real stiffness) {
    const vector weighted = scaled(stiffness, row);
    k->xx += weighted.x * row.x;
    k->xy += weighted.x * row.y;
    k->xz += weighted.x * row.z;
    k->yy += weighted.y * row.y;
    k->yz += weighted.y * row.z;
    k->zz += weighted.z * row.z;
}

/* By Cholesky's decomposition without roots: L D Lᵀ. */
static vector solved(const equations *k) {
    const real lxy = k->xy / k->xx, lxz = k->xz / k->xx;
    const real dy = k->yy - lxy * k->xy, below = k->yz - lxz * k->xy, lyz = below / dy;
    const real dz = k->zz - lxz * k->xz - lyz * below;
    const real y = k->rest.y - lxy * k->rest.x, z = k->rest.z - lxz * k->rest.x - lyz * y;
    vector out;
    out.z = z / dz;
    out.y = y / dy - lyz * out.z;
    out.x = k->rest.x / k->xx - lxy * out.y - lxz * out.z;
    return out;
}

static void enter(equations *k, contact *c, const sight *at) {
    if (at->length > R(0))
        slips(c, at);
    else if (at->locked)
        is_locked(c, at);
    else
        rolls(c, at);
    k->rest = minus(k->rest, combined(at->wheel->row, c->impulse[0], c->impulse[1]));
    add_row(k, c->row[0], c->stiffness[0]);
    add_row(k, c->row[1], c->stiffness[1]);
}

static void move(const contact *c, vector by, real *speed, real impulse[2]) {
    const real first = dot(c->row[0], by), second = dot(c->row[1], by);
    for (int m = 0; m < 2; m++)
        impulse[m] = c->impulse[m] + c->e[0][m] * c->stiffness[0] * first + c->e[1][m] * c->stiffness[1] * second;
    *speed = c->speed + c->turn[0] * first + c->turn[1] * second;
}

/* Of the motion without the wheels' contacts; NaN where a limit is, which comparisons would pass over. */
static real free_energy(const friction_wheel wheels[], const friction_load loads[], int32_t count, vector free) {
    real energy = square(free);
    for (int32_t i = 0; i < count; i++) {
        const real speed = loads[i].free_speed + drive_at(&loads[i], R(0)) / wheels[i].inertia;
        energy += wheels[i].inertia * speed * speed;
        energy += zero_if_finite(loads[i].grip) + zero_if_finite(loads[i].axle) + zero_if_finite(loads[i].drive_limit);
    }
    return energy;
}

/* A guess far above what these loads can ask for is stress that opposite contacts kept from former steps. Its rounding
 * errors would drown the speeds, so it is forgotten. */
static void forget_stress(const friction_wheel wheels[], int32_t count, real scale, real impulse[][2]) {
    for (int32_t i = 0; i < count; i++) {
        const real size = (impulse[i][0] * impulse[i][0] + impulse[i][1] * impulse[i][1]) * wheels[i].inverse_mass;
        if (size > MOST_STRESS * scale) impulse[i][0] = impulse[i][1] = R(0);
    }
}

static void stop(int32_t count, real nu[3], real speed[]) {
    store(nu, none);
    for (int32_t i = 0; i < count; i++) speed[i] = R(0);
}

/* Speeds that are rounding errors of standing still become 0, so that rest stays rest to the last bit. */
static void snap(const friction_wheel wheels[], int32_t count, real scale, real nu[3], real speed[]) {
    real energy = square(vec(nu));
    for (int32_t i = 0; i < count; i++) energy += wheels[i].inertia * speed[i] * speed[i];
    if (energy < SNAP * SNAP * scale) stop(count, nu, speed);
}

int32_t laconic_friction_solve(const friction_wheel wheels[], const friction_load loads[], int32_t count,
                               const real free_nu[3], real nu[3], real speed[], real impulse[][2]) {
    contact contacts[LACONIC_MAX_WHEELS];
    const vector free = vec(free_nu);
    const real scale = free_energy(wheels, loads, count, free);
    if (!is_finite(scale)) return 0;
    if (scale < SMALLEST_ENERGY) {
        stop(count, nu, speed);
        for (int32_t i = 0; i < count; i++) impulse[i][0] = impulse[i][1] = R(0);
        return 1;
    }
    forget_stress(wheels, count, scale, impulse);
    for (int32_t pass = 0; pass <= FRICTION_MOST_PASSES; pass++) {
        const vector now = vec(nu);
        equations k = {minus(free, now), R(1), R(0), R(0), R(1), R(0), R(1)};
        vector balance = k.rest, by;
        real residual = R(0);
        for (int32_t i = 0; i < count; i++) {
            sight at = {&wheels[i], &loads[i], impulse[i], {R(0), R(0)}, {R(0), R(0)}, R(0), R(0), false};
            residual += look(&at, now, speed[i]);
            balance = minus(balance, combined(wheels[i].row, impulse[i][0], impulse[i][1]));
            enter(&k, &contacts[i], &at);
        }
        if (residual + square(balance) <= TOLERANCE * TOLERANCE * scale) {
            snap(wheels, count, scale, nu, speed);
            return pass + 1;
        }
        by = solved(&k);
        store(nu, plus(now, by));
        for (int32_t i = 0; i < count; i++) move(&contacts[i], by, &speed[i], impulse[i]);
    }
    return 0;
}
