/* What the kinds of pass of the friction solver share: their constants, the three equations for ν, and a wheel's own
 * equation. */
#ifndef LACONIC_FRICTION_INTERNALS_H
#define LACONIC_FRICTION_INTERNALS_H

#include "elementary.h"
#include "friction_solver.h"

/* Stiffness of the penalty in contacts that stick, over that of their own inertia: brings the impulses of redundant
 * contacts that many times nearer in each pass, and takes as many digits of the sums. */
#ifdef LACONIC_SINGLE
#define PENALTY R(300)
#else
#define PENALTY R(1e5)
#endif

/* The residual that a result must reach, and the speed that counts as rest, both relative to the free motion. Redundant
 * contacts and light wheels let a speed be off by many times the residual, and speeds shall be right to
 * 1e-9. From (|t|/grip)² = BORDER on, slip outwards tells that a contact slips; in single it would tell rounding
 * errors. Rounding hides some HIDDEN of each impulse, which counts as residual. Contacts may hold each other with many
 * times the free motion's impulse, of which MOST_STRESS is the square: above it rounding would hide more than
 * TOLERANCE. Where neither kind of pass brings the residual to TOLERANCE any more, RESOLVED of the free motion and
 * ROUNDED of the contacts' impulses (after exact passes: the root of CLOSE, times TOLERANCE) are all that the scalar
 * type can tell: near breakaway, where little of the free motion is left, and where contacts hold each other. ROUNDED
 * is 2.5 units in the last place in both types. It must exceed HIDDEN, which is part of the residual that it bounds. */
#ifdef LACONIC_SINGLE
#define TOLERANCE R(1e-5)
#define RESOLVED R(4e-5)
#define ROUNDED R(3e-7)
#define CLOSE R(9)
#define SNAP R(1e-4)
#define BORDER R(1)
#define HIDDEN R(1e-8)
#define MOST_STRESS R(1e4)
#else
#define TOLERANCE R(1e-12)
#define RESOLVED R(3e-11)
#define ROUNDED R(6e-16)
#define CLOSE R(900)
#define SNAP R(1e-10)
#define BORDER R(0.998)
#define HIDDEN R(1e-16)
#define MOST_STRESS R(1e8)
#endif

#define SMALLEST_ENERGY (LACONIC_REAL_MIN / (TOLERANCE * TOLERANCE)) /* below it squares of residuals underflow */
#define NO_SLIP R(1e-30) /* a direction without slip, as across free rollers, has this share of the mobility or less */
#define EXACT_PASSES 6   /* of warm steps 1 in 100 needs more */
#define FIRST_AHEAD 5    /* passes along the central path, before exact ones are tried */
#define AHEAD 3          /* and before each time after that */
#define TRIED 3          /* exact passes at a time */
#define WORTH_IT R(0.1)  /* of the residual, squared: an exact pass that does not bring it down to this leads nowhere */

/* 1/x, or 0 where there is nothing to act on. */
static inline real inverse_or_zero(real x) { return x > R(0) ? R(1) / x : R(0); }

static inline real heron(real guess, real x) { return R(0.5) * (guess + x / guess); }

/* √x for x from the least normal number on, some units in the last place; below, a number below 1e-150 (1e-18); not for
 * infinity. It costs a quarter of laconic_root(), which does not use IEEE's layout: half the exponent's bits are the
 * guess, 3.5 % off at most, and each of Heron's rounds squares that: 6e-4, 2e-7, 2e-14, then rounding. */
static inline real quick_root(real x) {
#ifdef LACONIC_SINGLE
    union {
        real number;
        uint32_t bits;
    } guess = {x};
    guess.bits = (guess.bits >> 1) + 0x1fbb4f2eU;
    return heron(heron(heron(guess.number, x), x), x);
#else
    union {
        real number;
        uint64_t bits;
    } guess = {x};
    guess.bits = (guess.bits >> 1) + 0x1ff769e5b00908bcU;
    return heron(heron(heron(heron(guess.number, x), x), x), x);
#endif
}

/* The problem and where the search for its solution stands. */
typedef struct friction_search {
    const friction_wheel *wheel;
    const friction_load *load;
    int32_t count;
    vector free, nu;
    real *speed, (*impulse)[2];
    real scale; /* twice the energy of the free motion */
} friction_search;

static inline real drive_at(const friction_load *l, real speed) {
    return cut(l->drive - l->drive_slope * speed, l->drive_limit);
}

static inline vector combined(const vector rows[2], real first, real second) {
    return plus(scaled(first, rows[0]), scaled(second, rows[1]));
}

/* A wheel's speed, and how its resistance grows with it: inertia, viscous and motor, where it turns at all. */
typedef struct turning {
    real speed, slope;
    bool held;
} turning;

/* Solves (inertia + viscous + added) s + axle sign(s) − motor(s) = push: monotone and linear by pieces. */
static inline turning turning_of(real inertia, const friction_load *l, real added, real axle, real push) {
    const real own = inertia + l->viscous, start = push + cut(l->drive, l->drive_limit);
    const real driven = push + (start > R(0) ? -axle : axle);
    turning out = {R(0), own + l->drive_slope, magnitude(start) <= axle};
    real motor;
    if (out.held) return out;
    out.speed = (driven + l->drive) / (out.slope + added);
    motor = l->drive - l->drive_slope * out.speed;
    if (magnitude(motor) > l->drive_limit) { /* the straight line left the limits, so the wheel is beyond them too */
        out.slope = own;
        out.speed = (driven + cut(motor, l->drive_limit)) / (own + added);
    }
    return out;
}

/* (1 + Σ stiffness row rowᵀ) δν = ν* − ν − Σ rows·impulse */
typedef struct equations {
    vector rest;
    real xx, xy, xz, yy, yz, zz;
} equations;

static inline equations no_wheels(const friction_search *at) {
    const equations k = {minus(at->free, at->nu), R(1), R(0), R(0), R(1), R(0), R(1)};
    return k;
}

/* Adds first secondᵀ, one of a sum that is symmetric. */
static inline void add_product(equations *k, vector first, vector second) {
    k->xx += first.x * second.x;
    k->xy += first.x * second.y;
    k->xz += first.x * second.z;
    k->yy += first.y * second.y;
    k->yz += first.y * second.z;
    k->zz += first.z * second.z;
}

/* The body's own mass is 1, so no pivot is less but by rounding errors. */
static inline real pivot(real x) { return x > R(1) ? x : R(1); }

/* By Cholesky's decomposition without roots: L D Lᵀ. */
static inline vector solved(const equations *k) {
    const real lxy = k->xy / k->xx, lxz = k->xz / k->xx;
    const real dy = pivot(k->yy - lxy * k->xy), below = k->yz - lxz * k->xy, lyz = below / dy;
    const real dz = pivot(k->zz - lxz * k->xz - lyz * below);
    const real y = k->rest.y - lxy * k->rest.x, z = k->rest.z - lxz * k->rest.x - lyz * y;
    vector out;
    out.z = z / dz;
    out.y = y / dy - lyz * out.z;
    out.x = k->rest.x / k->xx - lxy * out.y - lxz * out.z;
    return out;
}

/* The speeds to which the impulses lead: the dual point's primal one. */
void laconic_friction_follow(friction_search *at);

/* Where the search stands on the central path of the smoothed problem, beside speeds and contacts' impulses. */
typedef struct friction_path {
    real softness, fastest;                                   /* fastest: the size of the free motion, rad/s */
    real axle[LACONIC_MAX_WHEELS], motor[LACONIC_MAX_WHEELS]; /* impulses */
} friction_path;

/* Starts from the impulses that the search has, cut to what the contacts can bear. */
void laconic_friction_start_path(friction_search *at, friction_path *path);

/* One pass of Newton's method, then the softness falls. */
void laconic_friction_follow_path(friction_search *at, friction_path *path);

#endif
