/* Internals of articulated steps: the input over a step, the posture of a state, the increment of a step and the state
 * after it. */
#ifndef LACONIC_ARTICULATED_STEP_H
#define LACONIC_ARTICULATED_STEP_H

#include "articulated_visit.h"

#if LACONIC_MAX_BODIES > 0

/* ------------------------------------------------------------------------ the input over a step -- */

/* start + s (slope + s (square + s cube)), s from 0 to 1. */
typedef struct articulated_cubic {
    real start, slope, square, cube;
} articulated_cubic;

typedef struct articulated_course {
    articulated_drive start, end;
    real step_s, rate_per_step; /* h, 1/h */
    bool constant;              /* the same at every moment; then only `start` is set */
    bool forces_vary, turns;    /* forces or torques differ at both ends; T does      */
    articulated_cubic rate[LACONIC_MAX_BODIES], twist[3];
} articulated_course;

/* The drive at one share of the step, kept while stages ask for the same. */
typedef struct articulated_moment {
    articulated_drive drive;
    real at;
} articulated_moment;

/* Forces, torques, rates and T, T' of one input; T'' is 0. */
void laconic_articulated_drive_of(articulated_drive *drive, const laconic_articulated_model *m,
                                  const laconic_articulated_input *input);

/* Rates, T and T' that a state has; no forces. */
void laconic_articulated_drive_kept(articulated_drive *drive, const laconic_articulated_model *m,
                                    const laconic_articulated_state *state);

/* Cubics and flags of a course whose ends are set and that is not constant. */
void laconic_articulated_course_of(articulated_course *course, const laconic_articulated_model *m);

void laconic_articulated_begin_moment(articulated_moment *moment, const articulated_course *course);
void laconic_articulated_move_moment(articulated_moment *moment, const articulated_course *course,
                                     const laconic_articulated_model *m, real at);

/* The drive at a share of the step: that of the start where it is the same everywhere. */
INLINE const articulated_drive *commands_of(articulated_moment *moment, const articulated_course *course,
                                            const laconic_articulated_model *m, real at) {
    if (course->constant) return &course->start;
    if (moment->at != at) laconic_articulated_move_moment(moment, course, m, at);
    return &moment->drive;
}

/* ∫ of the rate of prescribed hinge b from one share of the step on. */
real laconic_articulated_commanded_turn(const articulated_course *course, int32_t b, real from, real share);

/* False where a number of it is not finite. */
bool laconic_articulated_drive_is_finite(const articulated_drive *drive, const laconic_articulated_model *m);

/* Refuses a twist that the carriage's wheels do not allow, or that gives a hinge no direction or turns it too far
 * between the two: beyond that sine, or beyond a quarter turn. */
laconic_status laconic_articulated_check_twist(const laconic_articulated_model *m, const articulated_drive *from,
                                               const articulated_drive *to, real largest_sine, laconic_refusal *why);

/* ------------------------------------------------------------------------- angles and directions -- */

/* The angle of a direction that need not have length 1, in (−π, π]; 0 for (0, 0). */
real laconic_articulated_angle_of(direction d);

/* d turned by a small angle, as a step turns it. */
INLINE direction turned_by(direction d, real angle_rad) {
    const direction by =
        magnitude(angle_rad) < R(0.78) ? direction_near(angle_rad, 0) : laconic_direction_of_angle(angle_rad);
    return direction_with(d.cosine * by.cosine - d.sine * by.sine, d.sine * by.cosine + d.cosine * by.sine);
}

/* From one direction to another. */
static inline direction from_to(direction from, direction to) {
    return direction_with(from.cosine * to.cosine + from.sine * to.sine, from.cosine * to.sine - from.sine * to.cosine);
}

/* The angle from one direction of length 1 to another, in (−π, π]. */
real laconic_articulated_turn_from_to(direction from, direction to);

static inline direction direction_of_heading(const laconic_heading *heading) {
    return laconic_direction_of_binary_angle(heading->fraction);
}

/* Direction of hinge b + 1, and its angle where it has a spring. */
INLINE void take_hinge_of(articulated_sweep *s, const laconic_articulated_model *m,
                          const laconic_articulated_state *state, int32_t b) {
    s->toward[b] = direction_of_binary_angle(state->hinge[b].fraction);
    s->angle_rad[b] = R(0);
    if (m->link[b].stiffness_Nm > R(0)) s->angle_rad[b] = heading_unwrapped(&state->hinge[b]) - m->link[b].rest_rad;
}

INLINE void take_posture_of(articulated_sweep *s, const laconic_articulated_model *m,
                            const laconic_articulated_state *state) {
    s->angle_rad[0] = R(0); /* where LACONIC_MAX_BODIES is 1, compilers doubt that the loop sets it */
    for (int32_t b = 0; b < m->body_count; b++) take_hinge_of(s, m, state, b);
    forget_sizes(s, m);
}

static inline void take_eta(real *eta, const laconic_articulated_model *m, const laconic_articulated_state *state) {
    for (int32_t i = 0; i < m->dof; i++) eta[i] = state->eta[i].value;
}

/* Of all bodies with these twists. */
static inline real energy_of_twists(const laconic_articulated_model *m, const vector twist[]) {
    real twice = dot(twist[0], form_times(&m->inertia, twist[0]));
    for (int32_t b = 1; b <= m->body_count; b++) twice += dot(twist[b], form_times(&m->link[b - 1].inertia, twist[b]));
    return R(0.5) * twice;
}

/* ------------------------------------------------------------------------------ the next state -- */

/* What a step of h adds. */
typedef struct articulated_increment {
    real eta[LACONIC_MAX_VELOCITIES];
    real turn_rad[LACONIC_MAX_BODIES];
    vector mean[BODIES]; /* of X_b over the step          */
    vector bend;         /* of X_0: last less first twist */
} articulated_increment;

/* Takes the increment, or refuses OVERFLOW and leaves the state as it was. */
laconic_status laconic_articulated_accept(laconic_articulated_state *state, const laconic_articulated_model *m,
                                          const articulated_increment *by, real h);

/* Coordinated hinges point exactly along the twist of the drive: their turn from where the state has them. */
void laconic_articulated_turn_coordinated(articulated_increment *by, const laconic_articulated_model *m,
                                          const laconic_articulated_state *state, const articulated_drive *end);

/* Moves η back onto the rows left over, least in the kinetic metric. */
laconic_status laconic_articulated_project(laconic_articulated_state *state, const laconic_articulated_model *m,
                                           const articulated_drive *drive, laconic_refusal *why);

/* Rates and twist of the drive from now on, with the momenta kept. */
laconic_status laconic_articulated_take_drive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                              const articulated_drive *drive, laconic_refusal *why);

/* Notes in the state what is commanded at this moment. */
void laconic_articulated_keep_drive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                    const articulated_drive *drive);

/* ------------------------------------------------------------------------------------ methods -- */

/* The largest rate of a posture, 1/s: of casters (speed over trail) and of yaw. s: swept outward. */
typedef struct posture_rates {
    real caster_square, yaw;
} posture_rates;

/* (v/a)² of a body that follows. */
INLINE real square_following_rate(const laconic_link *link, vector v) {
    const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
    return (v.x * v.x + v.y * v.y) * (mx * mx + my * my);
}

INLINE posture_rates rates_of_posture(const articulated_sweep *s, const laconic_articulated_model *m) {
    posture_rates fast = {R(0), magnitude(s->twist[0].z)};
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const vector v = s->twist[b];
        if (magnitude(v.z) > fast.yaw) fast.yaw = magnitude(v.z);
        if (link->motion != LACONIC_MOTION_FOLLOWING) continue;
        const real square_rate = square_following_rate(link, v);
        if (square_rate > fast.caster_square) fast.caster_square = square_rate;
    }
    return fast;
}

/* The first body whose wheels follow as fast as that, to a share of 5e-4; 0: none follows. */
int32_t laconic_articulated_follower(const articulated_sweep *s, const laconic_articulated_model *m, real square_rate);

/* For steps of h and h/2. */
void laconic_articulated_factors_of(laconic_articulated_factors factors[2], const laconic_articulated_model *m, real h);

#define LARGEST_EXPLICIT_RATE R(2.785) /* h·rate: |Σ (−a)ⁿ/n!| to n = 4 exceeds 1 beyond, |Σ (ia)ⁿ/n!| later */

/* One part of a step by each method: from the share `from`, of length `share`. rk4 and circle refuse a part in which h
 * times a caster's or yaw rate is above `largest`. */
laconic_status laconic_articulated_rk4(laconic_articulated_state *state, const laconic_articulated_model *m,
                                       const articulated_course *course, real from, real share, bool circle,
                                       real largest, laconic_refusal *why);
laconic_status laconic_articulated_moebius_4(laconic_articulated_state *state, const laconic_articulated_model *m,
                                             const laconic_articulated_factors factors[2],
                                             const articulated_course *course, real from, real share,
                                             laconic_refusal *why);
/* Into how many parts a rate divides a step of auto; more than 256: moebius-4 takes it. */
int32_t laconic_articulated_parts_for(real rate_step);

/* Whether nothing drives or damps the vehicle over the step, so that its energy stays. */
bool laconic_articulated_keeps_energy(const laconic_articulated_model *m, const articulated_course *course);

/* For such a vehicle: whether the energy after a step is right. What a method's error adds is taken back. */
bool laconic_articulated_hold_energy(laconic_articulated_state *after, const laconic_articulated_state *before,
                                     const laconic_articulated_model *m, const articulated_drive *drive);

#define LARGEST_AUTO_RATE R(64) /* rate · step, of what auto follows by its rule of parts */

/* The step from `done` of 2²⁰ units on, in parts that judge themselves; refuses a step for the body whose wheels
 * follow fastest. */
laconic_status laconic_articulated_adaptive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                            const articulated_course *course, uint32_t done, laconic_refusal *why);

laconic_status laconic_articulated_auto(laconic_articulated_state *state, const laconic_articulated_model *m,
                                        const laconic_articulated_integrator *integrator,
                                        const articulated_course *course, laconic_refusal *why);

#endif
#endif
