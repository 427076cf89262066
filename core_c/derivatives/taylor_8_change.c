/* The Taylor series of order 8, linearised term by term (taylor_8.c has the recursions and the quadrature). */
#include "step_change.h"

#define TERMS 9 /* s⁰ … s⁸ */
#define KNOTS 4

static const real part[TERMS] = {R(1),       R(1.0 / 2), R(1.0 / 3), R(1.0 / 4), R(1.0 / 5),
                                 R(1.0 / 6), R(1.0 / 7), R(1.0 / 8), R(1.0 / 9)}; /* 1/(n + 1) */

/* Gauss' quadrature on 0 … 1, exact to degree 7. */
static const real knot[KNOTS] = {R(0.069431844202973712388), R(0.33000947820757186760), R(0.66999052179242813240),
                                 R(0.93056815579702628761)};
static const real share[KNOTS] = {R(0.17392742256872692869), R(0.32607257743127307131), R(0.32607257743127307131),
                                  R(0.17392742256872692869)};

/* How the displacement depends on the terms ζn. */
typedef struct pose_of_terms {
    vector along[TERMS], across[TERMS];
    real cosine[TERMS], sine[TERMS];          /* weights of the velocity along and across, turned           */
    real along_yaw[TERMS], across_yaw[TERMS]; /* weights of yaw_rate_of_zeta · ζn                            */
} pose_of_terms;

typedef struct taylor_trace {
    vector zeta[TERMS], zeta_cross_w[TERMS];
    real yaw[TERMS];                 /* g·ζn                                                   */
    real turn[TERMS];                /* h yaw_rate_of_zeta · ζn: the yaw's rate by s           */
    real cosine[TERMS], sine[TERMS]; /* of the yaw since the start: only where b rotates        */
    pose_of_terms pose;
} taylor_trace;

static void keep(taylor_trace *t, const step_point *at, int n, vector zeta) {
    const laconic_model *m = at->model;
    t->zeta[n] = zeta;
    t->yaw[n] = dot(vec(m->nu_of_zeta[2]), zeta);
    t->zeta_cross_w[n] = cross(zeta, vec(m->gyro));
    t->turn[n] = at->integrator->step_s * dot(vec(m->yaw_rate_of_zeta), zeta);
}

static void heading_term(taylor_trace *t, int n) {
    real cosine = R(n == 0), sine = R(0);
    for (int j = 0; j < n; j++) {
        cosine -= part[n - 1] * (t->turn[j] * t->sine[n - 1 - j]);
        sine += part[n - 1] * (t->turn[j] * t->cosine[n - 1 - j]);
    }
    t->cosine[n] = cosine;
    t->sine[n] = sine;
}

static void trace_terms(taylor_trace *t, const step_point *at) {
    const laconic_model *m = at->model;
    keep(t, at, 0, at->zeta);
    for (int n = 0; n < TERMS - 1; n++) {
        vector rate = n == 0 ? at->constant : none;
        if (at->rotates) {
            heading_term(t, n);
            rate = plus(rate, plus(scaled(t->cosine[n], at->cosine), scaled(t->sine[n], at->sine)));
        }
        for (int j = 0; j <= n; j++) rate = added(rate, t->yaw[j], t->zeta_cross_w[n - j]);
        rate = minus(rate, damping(m, t->zeta[n]));
        keep(t, at, n + 1, scaled(at->integrator->step_s * part[n], rate));
    }
}

/* ------------------------------------------------------------------------------------- the pose -- */

typedef struct knots {
    real yaw[KNOTS], cosine[KNOTS], sine[KNOTS]; /* from the mid-step heading                  */
    real along[KNOTS], across[KNOTS];            /* displacement that a knot stands for, turned */
} knots;

/* Velocity and yaw at a knot: Horner's rule for three polynomials. */
static void at_knot(knots *at, const taylor_trace *t, const laconic_model *m, real h, real yaw_change, int k) {
    vector zeta = t->zeta[TERMS - 1];
    real turned = part[TERMS - 1] * t->turn[TERMS - 1];
    for (int n = TERMS - 2; n >= 0; n--) {
        zeta = added(t->zeta[n], knot[k], zeta);
        turned = part[n] * t->turn[n] + knot[k] * turned;
    }
    const direction d = laconic_direction_of_angle(knot[k] * turned - R(0.5) * yaw_change);
    const real along = h * share[k] * dot(vec(m->velocity_of_zeta[0]), zeta);
    const real across = h * share[k] * dot(vec(m->velocity_of_zeta[1]), zeta);
    at->cosine[k] = h * share[k] * d.cosine;
    at->sine[k] = h * share[k] * d.sine;
    at->along[k] = d.cosine * along - d.sine * across;
    at->across[k] = d.sine * along + d.cosine * across;
}

/* The displacement is Σ over the knots of the velocity there, turned by the yaw from the middle: the terms' weights are
 * moments of the knots. */
static void weigh_terms(pose_of_terms *p, const knots *at, const laconic_model *m, real h) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    const vector yaw = vec(m->yaw_rate_of_zeta);
    real along = R(0), across = R(0), power[KNOTS] = {R(1), R(1), R(1), R(1)};
    for (int k = 0; k < KNOTS; k++) along += at->along[k];
    for (int k = 0; k < KNOTS; k++) across += at->across[k];
    for (int n = 0; n < TERMS; n++) {
        real cosine = R(0), sine = R(0), later_along = R(0), later_across = R(0);
        for (int k = 0; k < KNOTS; k++) {
            cosine += power[k] * at->cosine[k];
            sine += power[k] * at->sine[k];
            power[k] *= knot[k];
            later_along += power[k] * at->along[k];
            later_across += power[k] * at->across[k];
        }
        p->cosine[n] = cosine;
        p->sine[n] = sine;
        p->along_yaw[n] = h * part[n] * (R(0.5) * across - later_across);
        p->across_yaw[n] = h * part[n] * (later_along - R(0.5) * along);
        p->along[n] = plus(minus(scaled(cosine, forth), scaled(sine, left)), scaled(p->along_yaw[n], yaw));
        p->across[n] = plus(plus(scaled(sine, forth), scaled(cosine, left)), scaled(p->across_yaw[n], yaw));
    }
}

static pose_change trace_pose(taylor_trace *t, const step_point *at, vector path) {
    const real h = at->integrator->step_s;
    pose_change moved = {R(0), R(0), dot(vec(at->model->yaw_rate_of_zeta), path)};
    knots k;
    for (int i = 0; i < KNOTS; i++) {
        at_knot(&k, t, at->model, h, moved.yaw_change_rad, i);
        moved.along_m += k.along[i];
        moved.across_m += k.across[i];
    }
    weigh_terms(&t->pose, &k, at->model, h);
    return moved;
}

/* What a change of the model adds: of the rows that the pose is computed by. */
static void add_pose_by_model(pose_change *moved, const taylor_trace *t, const dynamics_change *by) {
    for (int n = 0; n < TERMS; n++) {
        const real forth = dot(by->along, t->zeta[n]), left = dot(by->across, t->zeta[n]);
        const real yaw = dot(by->yaw_rate, t->zeta[n]);
        moved->along_m += t->pose.cosine[n] * forth - t->pose.sine[n] * left + t->pose.along_yaw[n] * yaw;
        moved->across_m += t->pose.sine[n] * forth + t->pose.cosine[n] * left + t->pose.across_yaw[n] * yaw;
    }
}

/* --------------------------------------------------------------------------------- a direction -- */

static vector sum_to_end(const vector term[TERMS]) {
    vector sum = none;
    for (int n = TERMS - 1; n > 0; n--) sum = plus(sum, term[n]);
    return sum;
}

static vector mean_of(const vector term[TERMS]) {
    vector sum = none;
    for (int n = TERMS - 1; n >= 0; n--) sum = added(sum, part[n], term[n]);
    return sum;
}

/* The change of bn where b rotates: cos and sin of the yaw follow from the changes of ζ below n. */
typedef struct turn_change {
    real turn[TERMS], cosine[TERMS], sine[TERMS];
} turn_change;

static vector rotating_b_change(turn_change *c, const taylor_trace *t, const step_point *at, const step_direction *in,
                                vector zeta, int n) {
    real cosine = R(0), sine = R(0), turn = dot(vec(at->model->yaw_rate_of_zeta), zeta);
    if (in->model != NULL) turn += dot(in->model->yaw_rate, t->zeta[n]);
    c->turn[n] = at->integrator->step_s * turn;
    for (int j = 0; j < n; j++) {
        cosine -= c->turn[j] * t->sine[n - 1 - j] + t->turn[j] * c->sine[n - 1 - j];
        sine += c->turn[j] * t->cosine[n - 1 - j] + t->turn[j] * c->cosine[n - 1 - j];
    }
    c->cosine[n] = n > 0 ? part[n - 1] * cosine : R(0);
    c->sine[n] = n > 0 ? part[n - 1] * sine : R(0);
    return plus(plus(scaled(t->cosine[n], in->cosine), scaled(t->sine[n], in->sine)),
                plus(scaled(c->cosine[n], at->cosine), scaled(c->sine[n], at->sine)));
}

/* Σ (g·ζj)'(ζn−j × w) + (g·ζj)(ζn−j × w)' to n, with a change of the model what it adds. */
INLINE vector product_change(const taylor_trace *t, const laconic_model *m, const dynamics_change *by,
                             const vector zeta[TERMS], const real yaw[TERMS], int n) {
    vector turned = none, straight = none, by_gyro = none;
    for (int j = 0; j <= n; j++) {
        turned = added(turned, yaw[j], t->zeta_cross_w[n - j]);
        straight = added(straight, t->yaw[j], zeta[n - j]);
    }
    turned = plus(turned, cross(straight, vec(m->gyro)));
    if (by == NULL) return turned;
    for (int j = 0; j <= n; j++) by_gyro = added(by_gyro, t->yaw[j], t->zeta[n - j]);
    return minus(plus(turned, cross(by_gyro, by->gyro)), mapped(&by->damping, t->zeta[n]));
}

INLINE void change_terms(vector zeta[TERMS], const taylor_trace *t, const step_point *at, const step_direction *in,
                         const dynamics_change *by) {
    const laconic_model *m = at->model;
    real yaw[TERMS];
    turn_change turn;
    zeta[0] = in->zeta;
    for (int n = 0; n < TERMS - 1; n++) {
        yaw[n] = dot(vec(m->nu_of_zeta[2]), zeta[n]);
        if (by != NULL) yaw[n] += dot(by->yaw, t->zeta[n]);
        vector rate = minus(product_change(t, m, by, zeta, yaw, n), damping(m, zeta[n]));
        if (n == 0) rate = plus(rate, in->constant);
        if (at->rotates) rate = plus(rate, rotating_b_change(&turn, t, at, in, zeta[n], n));
        zeta[n + 1] = scaled(at->integrator->step_s * part[n], rate);
    }
}

INLINE step_response taylor_response(const taylor_trace *t, const step_point *at, const step_direction *in,
                                     const dynamics_change *by, vector path) {
    vector zeta[TERMS];
    step_response out;
    change_terms(zeta, t, at, in, by);
    out.delta = sum_to_end(zeta);
    out.path = scaled(at->integrator->step_s, mean_of(zeta));
    out.moved.along_m = out.moved.across_m = R(0);
    out.moved.yaw_change_rad = dot(vec(at->model->yaw_rate_of_zeta), out.path);
    for (int n = 0; n < TERMS; n++) {
        out.moved.along_m += dot(t->pose.along[n], zeta[n]);
        out.moved.across_m += dot(t->pose.across[n], zeta[n]);
    }
    if (by == NULL) return out;
    out.moved.yaw_change_rad += dot(by->yaw_rate, path);
    add_pose_by_model(&out.moved, t, by);
    return out;
}

void laconic_taylor_8_responses(step_response *step, step_response out[], const step_point *at,
                                const step_direction in[], int32_t count) {
    taylor_trace t;
    trace_terms(&t, at);
    step->delta = sum_to_end(t.zeta);
    step->path = scaled(at->integrator->step_s, mean_of(t.zeta));
    step->moved = trace_pose(&t, at, step->path);
    for (int32_t k = 0; k < count; k++)
        out[k] = in[k].model != NULL ? taylor_response(&t, at, &in[k], in[k].model, step->path)
                                     : taylor_response(&t, at, &in[k], NULL, step->path);
}
