/* Outer forces as a wrench in body axes, its change along a variation, and b of it. */
#ifndef LACONIC_WRENCH_H
#define LACONIC_WRENCH_H

#include "elementary.h"
#include "vector.h"

typedef struct wrench { /* F_ξ, F_η, τ about S */
    real along, across, moment;
} wrench;

static inline wrench wrench_with(real along, real across, real moment) {
    const wrench w = {along, across, moment};
    return w;
}

/* b of a wrench, by its power F·v_S + τ θ'. */
static inline vector b_of_wrench(const laconic_model *m, wrench w) {
    const vector along = scaled(w.along, vec(m->velocity_of_zeta[0]));
    const vector across = scaled(w.across, vec(m->velocity_of_zeta[1]));
    return scaled(m->torque_scale, plus(along, plus(across, scaled(w.moment, vec(m->yaw_rate_of_zeta)))));
}

/* The world force in body axes, as a wrench about S. */
static inline wrench world_force_seen(const laconic_input *in, direction heading) {
    const real *f = in->world_force_N, *r = in->world_force_point_m;
    const real along = heading.cosine * f[0] + heading.sine * f[1];
    const real across = heading.cosine * f[1] - heading.sine * f[0];
    return wrench_with(along, across, r[0] * across - r[1] * along);
}

/* The slope's pull in world axes: 0 on level ground. */
static inline const real *slope_force(const laconic_model *m) {
#if LACONIC_WITH_SLOPE
    return m->slope_force_N;
#else
    static const real level[2] = {R(0), R(0)};
    return (void)m, level;
#endif
}

/* The same in body axes. */
static inline wrench slope_seen(const laconic_model *m, direction heading) {
    const real *f = slope_force(m);
    return wrench_with(heading.cosine * f[0] + heading.sine * f[1], heading.cosine * f[1] - heading.sine * f[0], R(0));
}

/* All outer forces: of an input, and the slope's. */
static inline wrench wrench_of(const laconic_model *m, const laconic_input *in, direction heading) {
    const wrench w = world_force_seen(in, heading), slope = slope_seen(m, heading);
    return wrench_with(in->body_force_N[0] + w.along + slope.along, in->body_force_N[1] + w.across + slope.across,
                       in->body_moment_Nm + w.moment);
}

/* Its derivative along a variation: when the body yaws by dθ, a world force rotates by −dθ in body axes. */
static inline wrench wrench_change(const laconic_model *m, const laconic_input *in, direction heading,
                                   const laconic_variation *by) {
    const real *r = in->world_force_point_m, *dr = by->input.world_force_point_m;
    const wrench force = world_force_seen(in, heading), change = world_force_seen(&by->input, heading);
    const wrench slope = slope_seen(m, heading);
    const real along = change.along + by->heading_rad * force.across;
    const real across = change.across - by->heading_rad * force.along;
    return wrench_with(by->input.body_force_N[0] + along + by->heading_rad * slope.across,
                       by->input.body_force_N[1] + across - by->heading_rad * slope.along,
                       by->input.body_moment_Nm + (dr[0] * force.across - dr[1] * force.along) +
                           (r[0] * across - r[1] * along));
}

#endif
