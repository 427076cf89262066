/* Classical Runge-Kutta, linearised stage by stage (rk4.c). */
#include "step_change.h"

#define STAGES 4

typedef struct rk4_trace {
    real ahead[STAGES]; /* time from the step's start to a stage                          */
    vector zeta[STAGES];
    linear_map rate[STAGES]; /* ∂ζ'/∂ζ                                                         */
    direction yaw[STAGES];   /* at which b is taken: read only where b rotates                  */
    vector slope[STAGES];    /* ∂b/∂yaw there                                                  */
    pose_trace pose;
} rk4_trace;

/* ζ whose yaw a stage's b is taken at: that of the stage before. */
static inline int before(int stage) { return stage > 0 ? stage - 1 : 0; }

static inline increment weighted(real h, vector k1, vector k2, vector k3, vector k4) {
    const real sixth = h * (R(1) / R(6));
    const vector inner = plus(k2, k3);
    increment by;
    by.mean = scaled(sixth, plus(k1, inner));
    by.delta = plus(by.mean, scaled(sixth, plus(inner, k4)));
    by.slope = by.delta;
    return by;
}

INLINE increment trace_stages(rk4_trace *t, const step_point *at, bool rotates) {
    const laconic_model *m = at->model;
    const real h = at->integrator->step_s;
    vector rate[STAGES], b = at->constant;
    for (int i = 0; i < STAGES; i++) {
        t->ahead[i] = i == 0 ? R(0) : (i == STAGES - 1 ? h : R(0.5) * h);
        t->zeta[i] = i == 0 ? at->zeta : added(at->zeta, t->ahead[i], rate[i - 1]);
        if (rotates) {
            t->yaw[i] = laconic_direction_of_angle(t->ahead[i] * dot(vec(m->yaw_rate_of_zeta), t->zeta[before(i)]));
            t->slope[i] = forcing_slope(at, t->yaw[i]);
            b = forcing_seen(at, t->yaw[i]);
        }
        t->rate[i] = rate_map(m, t->zeta[i]);
        rate[i] = zeta_rate(m, t->zeta[i], b);
    }
    increment by = weighted(h, rate[0], rate[1], rate[2], rate[3]);
    by.mean = plus(at->zeta, by.mean);
    return by;
}

/* The change of b at a stage, by the change of ζ of the stage before. */
INLINE lanes b_change(const rk4_trace *t, const step_point *at, const step_direction *in, int i, lanes zeta,
                      bool rotates) {
    if (!rotates) return in->constant;
    lane yaw = lanes_dot(vec(at->model->yaw_rate_of_zeta), zeta);
    if (in->model != NULL) yaw += dot(in->model->yaw_rate, t->zeta[before(i)]);
    return lanes_plus(forcing_change(in, t->yaw[i]), lanes_along(t->ahead[i] * yaw, t->slope[i]));
}

/* The change of the mean is without that of ζ at the start. */
INLINE increment_change weighted_changes(real h, const lanes k[STAGES]) {
    const real sixth = h * (R(1) / R(6));
    const lanes inner = lanes_plus(k[1], k[2]);
    increment_change by;
    by.mean = lanes_scaled(sixth, lanes_plus(k[0], inner));
    by.delta = lanes_plus(by.mean, lanes_scaled(sixth, lanes_plus(inner, k[3])));
    by.slope = by.delta;
    return by;
}

INLINE step_response stage_response(const rk4_trace *t, const step_point *at, const step_direction *in, bool rotates,
                                    bool with_model) {
    const real h = at->integrator->step_s;
    lanes rate[STAGES], zeta = in->zeta;
    for (int i = 0; i < STAGES; i++) {
        const lanes b = b_change(t, at, in, i, zeta, rotates);
        if (i > 0) zeta = lanes_added(in->zeta, t->ahead[i], rate[i - 1]);
        rate[i] = lanes_plus(lanes_mapped(&t->rate[i], zeta), b);
        if (with_model) rate[i] = lanes_plus(rate[i], lanes_of(dynamics_rate_change(at->model, in->model, t->zeta[i])));
    }
    increment_change by = weighted_changes(h, rate);
    by.mean = lanes_plus(in->zeta, by.mean);
    return response_of(&t->pose, at->model, h, by, with_model ? in->model : NULL);
}

INLINE void stage_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                            int32_t count, bool rotates) {
    const real h = at->integrator->step_s;
    rk4_trace t;
    const increment by = trace_stages(&t, at, rotates);
    step->delta = by.delta;
    step->path = scaled(h, by.mean);
    laconic_pose_trace(&t.pose, at->model, step->path, scaled(h, by.slope));
    step->moved = t.pose.moved;
    for (int32_t k = 0; k < count; k++)
        out[k] = in[k].model != NULL ? stage_response(&t, at, &in[k], rotates, true)
                                     : stage_response(&t, at, &in[k], rotates, false);
}

void laconic_rk4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                           int32_t count) {
    if (at->rotates)
        stage_responses(step, out, at, in, count, true);
    else
        stage_responses(step, out, at, in, count, false);
}
