/* Random problems for the solver of a friction step, and its residual by a second routine without code of it. */
#ifndef LACONIC_TEST_FRICTION_H
#define LACONIC_TEST_FRICTION_H

#include "check.h"
#include "friction_solver.h"

#define MOST_WHEELS 16

typedef struct problem {
    int count;
    friction_wheel wheel[MOST_WHEELS];
    friction_load load[MOST_WHEELS];
    laconic_real free[3], nu[3], speed[MOST_WHEELS], impulse[MOST_WHEELS][2];
} problem;

static uint64_t seed = 88172645463325252U;

static inline double uniform(double from, double to) { /* xorshift */
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return from + (to - from) * ((double)(seed >> 11) * 0x1p-53);
}

static inline double decades(double from, double to) { return exp(uniform(log(from), log(to))); }

static inline double either_sign(double largest) { return uniform(-largest, largest); }

/* A wheel at (x, y) in units where the body's inertia is 1, its axle's angle β, its roller's γ. */
static inline void put_wheel(problem *p, double x, double y, double beta, double gamma, double drag, double inertia) {
    friction_wheel *w = &p->wheel[p->count++];
    const double u[2] = {cos(beta + gamma), sin(beta + gamma)};
    memset(w, 0, sizeof *w);
    w->along[0] = REAL(u[0]);
    w->along[1] = REAL(u[1]);
    w->along[2] = REAL(x * u[1] - y * u[0]);
    w->across[0] = REAL(-u[1]);
    w->across[1] = REAL(u[0]);
    w->across[2] = REAL(x * u[0] + y * u[1]);
    w->rim_along = REAL(sin(gamma));
    w->rim_across = REAL(cos(gamma));
    w->inertia = REAL(inertia);
    w->drag = REAL(drag);
    laconic_friction_prepare(w);
}

/* A ring of omni wheels, mecanum wheels, fixed wheels, two fixed wheels and others, or wheels anywhere. */
static inline void random_vehicle(problem *p, int count) {
    const int kind = (int)uniform(0, 5);
    const double drag = uniform(0, 1) < 0.35 ? 0 : uniform(0, 1) < 0.3 ? decades(1e-3, 1) : uniform(0.1, 1);
    const double inertia = decades(1e-4, 10), arm = uniform(0.5, 2);
    memset(p, 0, sizeof *p);
    while (p->count < count) {
        const int i = p->count;
        const double front = (i & 1) ? arm : -arm, left = (i & 2) ? 0.7 * arm : -0.7 * arm, ring = 2 * PI * i / count;
        const double side = left > 0 ? PI / 2 : -PI / 2;
        if (kind == 0)
            put_wheel(p, arm * cos(ring), arm * sin(ring), ring, PI / 2, drag, inertia);
        else if (kind == 1)
            put_wheel(p, front, left, side, front * left > 0 ? PI / 4 : -PI / 4, drag, inertia);
        else if (kind == 2)
            put_wheel(p, count < 3 ? 0 : front, left, side, PI / 2, 1, inertia);
        else if (kind == 3 && i < 2)
            put_wheel(p, 0, i ? 0.7 : -0.7, i ? PI / 2 : -PI / 2, PI / 2, 1, inertia);
        else { /* one after the other, as compilers choose the order of arguments */
            const double x = either_sign(arm), y = either_sign(arm), beta = either_sign(PI), gamma = uniform(0.3, 2.8);
            put_wheel(p, x, y, beta, gamma, drag, inertia * decades(0.3, 3));
        }
    }
}

static inline void random_loads(problem *p) {
    const double grip = decades(1e-4, 1), axle = uniform(0, 1) < 0.5 ? 0 : decades(1e-5, 1e-2);
    const double slope = uniform(0, 1) < 0.5 ? 0 : decades(1e-6, 1e-2);
    const bool rigid = uniform(0, 1) < 0.05, limited = uniform(0, 1) < 0.5;
    for (int i = 0; i < p->count; i++) {
        friction_load *l = &p->load[i];
        l->grip = rigid ? LACONIC_REAL_MAX : REAL(grip * uniform(0.5, 1.5));
        l->axle = REAL(axle);
        l->drive = REAL(either_sign(1e-2));
        l->drive_slope = REAL(slope);
        l->drive_limit = limited ? REAL(decades(1e-5, 1e-2)) : LACONIC_REAL_MAX;
        l->viscous = REAL(slope * 0.1);
    }
}

static inline void random_motion(problem *p) {
    const double body = decades(1e-3, 10), wheels = decades(1e-3, 10);
    for (int m = 0; m < 3; m++) p->nu[m] = p->free[m] = REAL(either_sign(body));
    for (int i = 0; i < p->count; i++) p->speed[i] = p->load[i].free_speed = REAL(either_sign(wheels));
}

static inline int solve(problem *p) {
    return (int)laconic_friction_solve(p->wheel, p->load, p->count, p->free, p->nu, p->speed, p->impulse);
}

static inline double within(double x, double limit) { return fmin(fmax(x, -limit), limit); }

/* In single, contacts that hold each other with many times the free motion leave so much of their impulses to rounding,
 * over ACCEPTED. */
#define STRESS EITHER(0, 1e-2)

/* The larger of two norms over that of the free motion: how far the equations of motion are from balance, and how far
 * the impulses are from their projections p = Π(p + slip/W). */
static inline double residual_of(const problem *p) {
    double body[3], scale = 0, motion = 0, projection = 0;
    for (int m = 0; m < 3; m++) {
        body[m] = (double)p->nu[m] - (double)p->free[m];
        scale += (double)p->free[m] * (double)p->free[m];
    }
    for (int i = 0; i < p->count; i++) {
        const friction_wheel *w = &p->wheel[i];
        const friction_load *l = &p->load[i];
        const double j = (double)w->inertia, s = (double)p->speed[i], limit = (double)l->drive_limit;
        const double factor[2] = {1, (double)w->drag};
        const double rim[2] = {(double)w->rim_along, factor[1] * (double)w->rim_across};
        double wheel = j * ((double)l->free_speed - s) - (double)l->viscous * s, mass = 0, t[2], length, free;
        for (int m = 0; m < 2; m++) {
            const laconic_real *row = m ? w->across : w->along;
            t[m] = -rim[m] * s;
            for (int axis = 0; axis < 3; axis++) {
                const double r = factor[m] * (double)row[axis];
                t[m] += r * (double)p->nu[axis];
                mass += r * r;
                body[axis] += r * (double)p->impulse[i][m];
            }
            mass += rim[m] * rim[m] / j;
            wheel += rim[m] * (double)p->impulse[i][m];
        }
        for (int m = 0; m < 2; m++) t[m] = (double)p->impulse[i][m] + t[m] / mass;
        length = hypot(t[0], t[1]);
        for (int m = 0; m < 2; m++) {
            if (length > (double)l->grip) t[m] *= (double)l->grip / length;
            projection += ((double)p->impulse[i][m] - t[m]) * ((double)p->impulse[i][m] - t[m]) * mass;
            scale += STRESS * STRESS * (double)p->impulse[i][m] * (double)p->impulse[i][m] * mass;
        }
        wheel += within((double)l->drive - (double)l->drive_slope * s, limit);
        wheel -= within(wheel + j * s, (double)l->axle); /* the axle's friction as its own projection */
        motion += wheel * wheel / j;
        free = (double)l->free_speed + within((double)l->drive, limit) / j;
        scale += j * free * free;
    }
    for (int m = 0; m < 3; m++) motion += body[m] * body[m];
    return sqrt(fmax(motion, projection) / scale);
}

#endif
