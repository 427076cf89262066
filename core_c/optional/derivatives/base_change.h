/* Base steps and their extrapolation, linearised, as the two exponential methods share them (step_internals.h has the
 * steps). The input is held, so b varies over a step only by rotating, and has no curve. */
#ifndef LACONIC_BASE_CHANGE_H
#define LACONIC_BASE_CHANGE_H

#include "step_change.h"

/* What a base step keeps: of exponential Kahan and of the exact flow. */
typedef struct base_trace {
    int level;
    vector zeta, delta; /* delta: as increment_of() takes it                          */
    vector change;      /* of b over the base step, with what follow() adds           */
    bool varies;
    vector mean;              /* of ζ over the base step */
    linear_map by_zeta, by_b; /* of the increment, by the start and by the equivalent constant b */
    union {
        struct {
            vector first;                          /* the increment before follow()                       */
            vector given;                          /* of `change` what is not follow()'s */
            vector gyroscopic;                     /* the change of (g·ζ)(ζ × w) over the base step        */
            vector added;                          /* what follow() added to the increment                */
            linear_map at_start, at_end, at_added; /* gyroscopic_map there            */
        } kahan;
        struct {
            vector before, middle; /* ζ before and after the free motion               */
            vector first, second;  /* constant b of the halves                         */
            vector zeta_cross_w, twice_cross_w;
            vector turn;                        /* of ζ after the free motion, by κ of flow_change.c */
            real ahead, aside;                  /* factors of the two cross products                 */
            real by_along, by_across, by_curve; /* derivatives of κ                     */
            real shrink;                        /* n²/N                                              */
        } flow;
    } of;
} base_trace;

/* A change of the model, with the factors of the exponential steps that follow from it. */
typedef struct base_model_change {
    const dynamics_change *dynamics;
    decay_change decay[3];
} base_model_change;

typedef increment (*base_tracer)(base_trace *t, const step_point *at, int level, vector zeta, const parabola *b);
/* A change of b over a base step: of its start, and of its change. */
typedef struct b_change {
    lanes start, change;
    bool varies; /* false: change is 0 and not set */
} b_change;

typedef increment_change (*base_changer)(const base_trace *t, const step_point *at, lanes zeta, const b_change *b,
                                         const base_model_change *model);

/* increment_of() along directions. */
INLINE increment_change increment_change_of(const base_trace *t, const laconic_decay *d, lanes zeta, lanes delta,
                                            const b_change *b, const decay_change *factors) {
    increment_change by;
    by.delta = delta;
    by.mean = lanes_plus(zeta, lanes_times(vec(d->mean), delta));
    by.slope = lanes_times(vec(d->slope), delta);
    if (b->varies) {
        by.mean = lanes_plus(by.mean, lanes_times(vec(d->mean_ramp), b->change));
        by.slope = lanes_plus(by.slope, lanes_times(vec(d->slope_ramp), b->change));
    }
    if (factors == NULL) return by;
    by.mean = lanes_plus(by.mean, lanes_of(mapped(&factors->mean, t->delta)));
    by.slope = lanes_plus(by.slope, lanes_of(mapped(&factors->slope, t->delta)));
    if (t->varies) {
        by.mean = lanes_plus(by.mean, lanes_of(mapped(&factors->mean_ramp, t->change)));
        by.slope = lanes_plus(by.slope, lanes_of(mapped(&factors->slope_ramp, t->change)));
    }
    return by;
}

/* combine() along directions. */
INLINE increment_change combined_change(increment_change whole, increment_change first, increment_change second) {
    const real third = R(1) / R(3);
    const lanes delta = lanes_plus(first.delta, second.delta);
    const lanes mean = lanes_scaled(R(0.5), lanes_plus(first.mean, second.mean));
    increment_change by;
    by.delta = lanes_added(delta, third, lanes_minus(delta, whole.delta));
    by.mean = lanes_added(mean, third, lanes_minus(mean, whole.mean));
    by.slope = lanes_plus(lanes_scaled(R(1.5), lanes_minus(second.mean, first.mean)),
                          lanes_scaled(R(0.25), lanes_plus(first.slope, second.slope)));
    return by;
}

/* ---------------------------------------------------------------------------------- substeps -- */

#define MOST_ROUNDS 3

/* take_substep() with all of its rounds: `yaw` is the direction at which a round takes b at the end. */
typedef struct substep_trace {
    base_trace round[MOST_ROUNDS];
    direction yaw[MOST_ROUNDS], yaw_before;
    int rounds;
    real h;
} substep_trace;

/* zeta and yaw_rad move on to the end. */
INLINE increment trace_substep(substep_trace *t, base_tracer tracer, const step_point *at, int level, vector *zeta,
                               real *yaw_rad) {
    const vector yaw_rate = vec(at->model->yaw_rate_of_zeta);
    const real before = *yaw_rad;
    parabola b = {at->constant, none, none, at->rotates};
    increment by = {none, none, none};
    t->rounds = at->rotates ? MOST_ROUNDS : 1;
    t->h = at->integrator->step_s * (level == 0 ? R(1) : R(0.5));
    if (at->rotates) {
        t->yaw_before = laconic_direction_of_angle(before);
        b.start = forcing_seen(at, t->yaw_before);
    }
    real end = before + t->h * dot(yaw_rate, *zeta);
    for (int i = 0; i < t->rounds; i++) {
        if (at->rotates) {
            t->yaw[i] = laconic_direction_of_angle(end);
            b.change = minus(forcing_seen(at, t->yaw[i]), b.start);
        }
        by = tracer(&t->round[i], at, level, *zeta, &b);
        t->round[i].mean = by.mean;
        end = before + t->h * dot(yaw_rate, by.mean);
    }
    *zeta = plus(*zeta, by.delta);
    *yaw_rad = end;
    return by;
}

/* The change of the yaw since the start of a step by a base step's mean of ζ. */
static inline lane yaw_change_along(const step_point *at, const base_model_change *model, vector zeta, lanes change) {
    lane yaw = lanes_dot(vec(at->model->yaw_rate_of_zeta), change);
    if (model != NULL) yaw += dot(model->dynamics->yaw_rate, zeta);
    return yaw;
}

/* A change of b at a yaw that changes, too. */
static inline lanes b_change_seen(const step_point *at, const step_direction *in, direction yaw, lane change) {
    return lanes_plus(forcing_change(in, yaw), lanes_along(change, forcing_slope(at, yaw)));
}

/* The same along directions: zeta and yaw_rad are the changes. */
INLINE increment_change change_substep(const substep_trace *t, base_changer changer, const step_point *at,
                                       const step_direction *in, const base_model_change *model, bool rotates,
                                       lanes *zeta, lane *yaw_rad) {
    b_change b = {in->constant, in->constant, rotates};
    increment_change by = {in->constant, in->constant, in->constant};
    if (!rotates) {
        by = changer(&t->round[0], at, *zeta, &b, model);
        *zeta = lanes_plus(*zeta, by.delta);
        return by;
    }
    const lane before = *yaw_rad;
    b.start = b_change_seen(at, in, t->yaw_before, before);
    lane end = before + t->h * yaw_change_along(at, model, t->round[0].zeta, *zeta);
    for (int i = 0; i < MOST_ROUNDS; i++) {
        b.change = lanes_minus(b_change_seen(at, in, t->yaw[i], end), b.start);
        by = changer(&t->round[i], at, *zeta, &b, model);
        end = before + t->h * yaw_change_along(at, model, t->round[i].mean, by.mean);
    }
    *zeta = lanes_plus(*zeta, by.delta);
    *yaw_rad = end;
    return by;
}

/* ------------------------------------------------------------------------------------ a step -- */

/* The whole step, then its halves. */
typedef struct base_steps {
    substep_trace part[3];
    pose_trace pose;
} base_steps;

INLINE increment trace_parts(base_steps *t, base_tracer tracer, const step_point *at, bool halves) {
    vector zeta = at->zeta;
    real yaw = R(0);
    const increment whole = trace_substep(&t->part[0], tracer, at, 0, &zeta, &yaw);
    if (!halves) return whole;
    zeta = at->zeta;
    yaw = R(0);
    const increment first = trace_substep(&t->part[1], tracer, at, 1, &zeta, &yaw);
    return combine(whole, first, trace_substep(&t->part[2], tracer, at, 1, &zeta, &yaw));
}

INLINE increment_change change_parts(const base_steps *t, base_changer changer, const step_point *at,
                                     const step_direction *in, const base_model_change *model, bool rotates,
                                     bool halves) {
    lanes zeta = in->zeta;
    lane yaw = lane_of(R(0));
    const increment_change whole = change_substep(&t->part[0], changer, at, in, model, rotates, &zeta, &yaw);
    if (!halves) return whole;
    zeta = in->zeta;
    yaw = lane_of(R(0));
    const increment_change first = change_substep(&t->part[1], changer, at, in, model, rotates, &zeta, &yaw);
    return combined_change(whole, first, change_substep(&t->part[2], changer, at, in, model, rotates, &zeta, &yaw));
}

static inline void fill_model_change(base_model_change *model, const step_point *at, const dynamics_change *by,
                                     int levels) {
    real h = at->integrator->step_s;
    model->dynamics = by;
    for (int level = 0; level < levels; level++) {
        laconic_decay_change_of(&model->decay[level], at->model, h, &by->damping);
        h *= R(0.5);
    }
}

INLINE void base_responses(base_tracer tracer, base_changer changer, bool halves, int levels, step_result *step,
                           step_response out[], const step_point *at, const step_direction in[], int32_t count) {
    const real h = at->integrator->step_s;
    base_steps t;
    base_model_change model;
    const increment by = trace_parts(&t, tracer, at, halves);
    step->delta = by.delta;
    step->path = scaled(h, by.mean);
    laconic_pose_trace(&t.pose, at->model, step->path, scaled(h, by.slope));
    step->moved = t.pose.moved;
    for (int32_t k = 0; k < count; k++) {
        const bool plain = !at->rotates && in[k].model == NULL; /* the usual case, compiled for itself */
        if (in[k].model != NULL) fill_model_change(&model, at, in[k].model, levels);
        const increment_change change =
            plain ? change_parts(&t, changer, at, &in[k], NULL, false, halves)
                  : change_parts(&t, changer, at, &in[k], in[k].model != NULL ? &model : NULL, at->rotates, halves);
        out[k] = plain ? response_of(&t.pose, at->model, h, change, NULL)
                       : response_of(&t.pose, at->model, h, change, in[k].model);
    }
}

#endif
