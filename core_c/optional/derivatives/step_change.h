/* What the files of this room share: linear maps of ζ, the step that is linearised, a direction in which all that the
 * step depends on changes, and the response to it. Each method first keeps what its stages found (a trace), then
 * answers any number of directions from it. */
#ifndef LACONIC_STEP_CHANGE_H
#define LACONIC_STEP_CHANGE_H

#include "direction_lanes.h"
#include "laconic/derivatives.h"
#include "step_internals.h"

/* -------------------------------------------------------------------------------- linear maps -- */

/* A 3×3 matrix by its rows. */
typedef struct linear_map {
    vector x, y, z;
} linear_map;

static inline vector mapped(const linear_map *a, vector v) {
    return vector_of(dot(a->x, v), dot(a->y, v), dot(a->z, v));
}

static inline lanes lanes_mapped(const linear_map *a, lanes v) {
    return lanes_with(lanes_dot(a->x, v), lanes_dot(a->y, v), lanes_dot(a->z, v));
}

static inline vector mapped_rows(const real a[3][3], vector v) {
    return vector_of(dot(vec(a[0]), v), dot(vec(a[1]), v), dot(vec(a[2]), v));
}

/* Aᵀv of a matrix by its rows. */
static inline vector transposed_rows(const real a[3][3], vector v) {
    return plus(plus(scaled(v.x, vec(a[0])), scaled(v.y, vec(a[1]))), scaled(v.z, vec(a[2])));
}

/* a + factor·v */
static inline vector added(vector a, real factor, vector v) { return plus(a, scaled(factor, v)); }

/* ------------------------------------------------------------------------------ the step itself -- */

/* A step with the input held. The part of b that rotates is given in axes at the heading at the step's start: after the
 * further yaw φ, b = constant + cos φ · cosine + sin φ · sine. */
typedef struct step_point {
    const laconic_model *model;
    const laconic_integrator *integrator;
    vector zeta, constant, cosine, sine;
    direction heading; /* at the start */
    bool rotates;
} step_point;

/* How the numbers of the model change that ζ's motion depends on. */
typedef struct dynamics_change {
    vector yaw;           /* of g = nu_of_zeta[2]                               */
    vector gyro;          /* of w                                               */
    vector yaw_rate;      /* of yaw_rate_of_zeta                                */
    vector along, across; /* of velocity_of_zeta: the pose alone                */
    linear_map damping;   /* of diag(r): symmetric, and not diagonal in general */
} dynamics_change;

/* A direction in each lane; `model`, the same for all, NULL: the model stays. Forcing as in step_point. */
typedef struct step_direction {
    lanes zeta, constant, cosine, sine;
    const dynamics_change *model;
} step_direction;

/* What a step does to ζ, travel and pose. */
typedef struct step_result {
    vector delta, path; /* path: ∫ζ dt over the step */
    pose_change moved;
} step_result;

/* How that changes along the directions of the lanes. */
typedef struct step_response {
    lanes delta, path;
    lane along_m, across_m, yaw_change_rad;
} step_response;

/* A change of an increment. */
typedef struct increment_change {
    lanes delta, mean, slope;
} increment_change;

/* Answers `count` groups of directions; `step` gets what the step itself does. */
typedef void (*responder)(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                          int32_t count);

void laconic_rk4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                           int32_t count);
void laconic_taylor_8_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                                int32_t count);
void laconic_gauss_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                             int32_t count);
void laconic_kahan_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                             int32_t count);
void laconic_kahan_4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                               int32_t count);
void laconic_flow_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                            int32_t count);
void laconic_flow_4_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                              int32_t count);

/* A method that may take a step, and what answers directions through it. */
typedef struct derived_step {
    const laconic_method *method; /* NULL: none */
    responder responds;
} derived_step;

/* What an integrator with this method tries in turn. */
struct laconic_derived_method {
    const laconic_method *chosen; /* of the integrator */
    derived_step tried[3];
};

/* ------------------------------------------------------------------- the rate, and b, that change -- */

/* The derivative of (g·ζ)(ζ × w) at ζ: dζ ↦ (g·dζ)(ζ × w) + (g·ζ)(dζ × w). Linear in ζ. */
INLINE linear_map gyroscopic_map(const laconic_model *m, vector zeta) {
    const vector g = vec(m->nu_of_zeta[2]), turned = cross(zeta, vec(m->gyro));
    const vector s = scaled(dot(g, zeta), vec(m->gyro));
    const linear_map a = {{turned.x * g.x, turned.x * g.y + s.z, turned.x * g.z - s.y},
                          {turned.y * g.x - s.z, turned.y * g.y, turned.y * g.z + s.x},
                          {turned.z * g.x + s.y, turned.z * g.y - s.x, turned.z * g.z}};
    return a;
}

/* ∂ζ'/∂ζ at ζ, with b held. */
INLINE linear_map rate_map(const laconic_model *m, vector zeta) {
    linear_map a = gyroscopic_map(m, zeta);
    const vector r = LACONIC_WITH_DAMPING ? vec(m->decay_per_s) : none;
    a.x.x -= r.x;
    a.y.y -= r.y;
    a.z.z -= r.z;
    return a;
}

/* What a change of the model adds to a change of (g·ζ)(ζ × w). */
static inline vector gyroscopic_change(const laconic_model *m, const dynamics_change *by, vector zeta) {
    return plus(scaled(dot(by->yaw, zeta), cross(zeta, vec(m->gyro))),
                scaled(dot(vec(m->nu_of_zeta[2]), zeta), cross(zeta, by->gyro)));
}

/* The same of ζ'. */
static inline vector dynamics_rate_change(const laconic_model *m, const dynamics_change *by, vector zeta) {
    return minus(gyroscopic_change(m, by, zeta), mapped(&by->damping, zeta));
}

/* b after a further yaw, and its rate of change by that yaw. */
static inline vector forcing_seen(const step_point *at, direction yaw) {
    return plus(at->constant, plus(scaled(yaw.cosine, at->cosine), scaled(yaw.sine, at->sine)));
}

static inline vector forcing_slope(const step_point *at, direction yaw) {
    return minus(scaled(yaw.cosine, at->sine), scaled(yaw.sine, at->cosine));
}

/* The change of b at a given yaw. */
static inline lanes forcing_change(const step_direction *by, direction yaw) {
    return lanes_plus(by->constant, lanes_plus(lanes_scaled(yaw.cosine, by->cosine), lanes_scaled(yaw.sine, by->sine)));
}

/* ------------------------------------------------------------------------------------- the pose -- */

/* Derivatives of displacement() by path and bend, with the yaw's own part in the rows. */
typedef struct pose_trace {
    pose_change moved;
    vector path, bend;
    vector along_path, along_bend, across_path, across_bend;
    real sinc, half_j1, yaw_bend, forth, left;
    real along_yaw, across_yaw; /* by the yaw of the step */
} pose_trace;

void laconic_pose_trace(pose_trace *trace, const laconic_model *m, vector path, vector bend);

/* What a change of the model adds to a change of the displacement. */
pose_change laconic_pose_by_model(const pose_trace *trace, const dynamics_change *by);

/* The response from a change of the increment. */
INLINE step_response response_of(const pose_trace *p, const laconic_model *m, real h, increment_change by,
                                 const dynamics_change *model) {
    const lanes bend = lanes_scaled(h, by.slope);
    step_response out;
    out.delta = by.delta;
    out.path = lanes_scaled(h, by.mean);
    out.along_m = lanes_dot(p->along_path, out.path) + lanes_dot(p->along_bend, bend);
    out.across_m = lanes_dot(p->across_path, out.path) + lanes_dot(p->across_bend, bend);
    out.yaw_change_rad = lanes_dot(vec(m->yaw_rate_of_zeta), out.path);
    if (model != NULL) {
        const pose_change more = laconic_pose_by_model(p, model);
        out.along_m += more.along_m;
        out.across_m += more.across_m;
        out.yaw_change_rad += more.yaw_change_rad;
    }
    return out;
}

/* ------------------------------------------------------------ factors of exponential steps -- */

/* How the factors of a laconic_decay change, as symmetric maps, along a change of the damping: entry jk is the entry of
 * the damping's change times the divided difference of the factor between the rates j and k. Held inputs have no
 * curve, so its factors are left out. */
typedef struct decay_change {
    linear_map gain, inverse_gain, mean, mean_ramp, slope, slope_ramp;
} decay_change;

void laconic_decay_change_of(decay_change *change, const laconic_model *m, real h, const linear_map *damping);

#endif
