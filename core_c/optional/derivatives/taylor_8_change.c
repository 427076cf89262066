/* The Taylor series of order 8, linearised term by term (taylor_8.c has the recursions and the quadrature). */
#include "step_change.h"
#include "taylor_8.h"

#define TERMS (ORDER + 1) /* s⁰ … s⁸ */

/* How the displacement depends on the terms ζn. */
typedef struct pose_of_terms {
    vector along[TERMS], across[TERMS];
    real cosine[TERMS], sine[TERMS];          /* weights of the velocity along and across, turned           */
    real along_yaw[TERMS], across_yaw[TERMS]; /* weights of yaw_rate_of_zeta · ζn                            */
} pose_of_terms;

typedef struct taylor_trace {
    vector zeta[TERMS], zeta_cross_w[TERMS];
    lanes side_by_side[TERMS]; /* ζn × w and g·ζn in every lane, for the sums over all terms      */
    lane yaw_by_side[TERMS];
    lane share_s[TERMS];             /* h/(n + 1) */
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
    t->side_by_side[n] = lanes_of(t->zeta_cross_w[n]);
    t->yaw_by_side[n] = lane_of(t->yaw[n]);
    t->share_s[n] = lane_of(at->integrator->step_s * inverse[n]);
    t->turn[n] = at->integrator->step_s * dot(vec(m->yaw_rate_of_zeta), zeta);
}

static void heading_term(taylor_trace *t, int n) {
    real cosine = R(n == 0), sine = R(0);
    for (int j = 0; j < n; j++) {
        cosine -= inverse[n - 1] * (t->turn[j] * t->sine[n - 1 - j]);
        sine += inverse[n - 1] * (t->turn[j] * t->cosine[n - 1 - j]);
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
        keep(t, at, n + 1, scaled(at->integrator->step_s * inverse[n], rate));
    }
}

/* ------------------------------------------------------------------------------------- the pose -- */

#define NODE_GROUPS (NODES / LANES)

/* At the nodes, side by side in lanes. */
typedef struct nodes {
    lane at[NODE_GROUPS];
    lane cosine[NODE_GROUPS], sine[NODE_GROUPS];  /* of the yaw from the mid-step heading, with the nodes' weights */
    lane along[NODE_GROUPS], across[NODE_GROUPS]; /* displacement that a node stands for, turned                   */
} nodes;

/* The direction of the yaw at each node, with the nodes' weights. */
static void turn_nodes(nodes *at, real h, const lane yaw[NODE_GROUPS]) {
    for (int k = 0; k < NODES; k++) {
        const direction d = laconic_direction_of_angle(lane_number(yaw[k / LANES], k % LANES));
        set_lane(&at->cosine[k / LANES], k % LANES, h * gauss_weight[k] * d.cosine);
        set_lane(&at->sine[k / LANES], k % LANES, h * gauss_weight[k] * d.sine);
    }
}

/* Velocity and yaw: Horner's rule for four polynomials. */
static void at_every_node(nodes *at, const taylor_trace *t, const laconic_model *m, real h, real yaw_change) {
    lane yaw[NODE_GROUPS];
    lanes zeta[NODE_GROUPS];
    for (int k = 0; k < NODES; k++) set_lane(&at->at[k / LANES], k % LANES, gauss_node[k]);
    for (int g = 0; g < NODE_GROUPS; g++) {
        const lane s = at->at[g];
        zeta[g] = lanes_of(t->zeta[TERMS - 1]);
        yaw[g] = lane_of(inverse[TERMS - 1] * t->turn[TERMS - 1]);
        for (int n = TERMS - 2; n >= 0; n--) {
            const vector term = t->zeta[n];
            zeta[g] = lanes_with(s * zeta[g].x + term.x, s * zeta[g].y + term.y, s * zeta[g].z + term.z);
            yaw[g] = s * yaw[g] + inverse[n] * t->turn[n];
        }
        yaw[g] = s * yaw[g] - R(0.5) * yaw_change;
    }
    turn_nodes(at, h, yaw);
    for (int g = 0; g < NODE_GROUPS; g++) {
        const lane forth = lanes_dot(vec(m->velocity_of_zeta[0]), zeta[g]);
        const lane left = lanes_dot(vec(m->velocity_of_zeta[1]), zeta[g]);
        at->along[g] = at->cosine[g] * forth - at->sine[g] * left;
        at->across[g] = at->sine[g] * forth + at->cosine[g] * left;
    }
}

static real sum_of_nodes(const lane a[NODE_GROUPS]) {
    lane sum = a[0];
    real total;
    /* cannot be reached in single: there is one group */
    for (int g = 1; g < NODE_GROUPS; g++) sum = sum + a[g];
    total = lane_number(sum, 0);
    for (int k = 1; k < LANES; k++) total += lane_number(sum, k);
    return total;
}

/* Σ over the nodes; then `a` moves on to the next power of the nodes. */
static inline real next_moment(lane a[NODE_GROUPS], const nodes *k) {
    const real sum = sum_of_nodes(a);
    for (int g = 0; g < NODE_GROUPS; g++) a[g] = a[g] * k->at[g];
    return sum;
}

/* The displacement is Σ over the nodes of the velocity there, turned by the yaw from the middle: the terms' weights are
 * moments of the nodes. */
static void weigh_terms(pose_of_terms *p, nodes *k, pose_change moved, const laconic_model *m, real h) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    const vector yaw = vec(m->yaw_rate_of_zeta);
    for (int g = 0; g < NODE_GROUPS; g++) {
        k->along[g] = k->along[g] * k->at[g];
        k->across[g] = k->across[g] * k->at[g];
    }
    for (int n = 0; n < TERMS; n++) {
        const real cosine = next_moment(k->cosine, k), sine = next_moment(k->sine, k);
        const real along = h * inverse[n] * (R(0.5) * moved.across_m - next_moment(k->across, k));
        const real across = h * inverse[n] * (next_moment(k->along, k) - R(0.5) * moved.along_m);
        p->cosine[n] = cosine;
        p->sine[n] = sine;
        p->along_yaw[n] = along;
        p->across_yaw[n] = across;
        p->along[n] = plus(minus(scaled(cosine, forth), scaled(sine, left)), scaled(along, yaw));
        p->across[n] = plus(plus(scaled(sine, forth), scaled(cosine, left)), scaled(across, yaw));
    }
}

static pose_change trace_pose(taylor_trace *t, const step_point *at, vector path) {
    const real h = at->integrator->step_s;
    pose_change moved = {R(0), R(0), dot(vec(at->model->yaw_rate_of_zeta), path)};
    nodes k;
    at_every_node(&k, t, at->model, h, moved.yaw_change_rad);
    moved.along_m = sum_of_nodes(k.along);
    moved.across_m = sum_of_nodes(k.across);
    weigh_terms(&t->pose, &k, moved, at->model, h);
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

/* --------------------------------------------------------------------------------- directions -- */

static vector sum_to_end(const vector term[TERMS]) {
    vector sum = none;
    for (int n = TERMS - 1; n > 0; n--) sum = plus(sum, term[n]);
    return sum;
}

static vector mean_of(const vector term[TERMS]) {
    vector sum = none;
    for (int n = TERMS - 1; n >= 0; n--) sum = added(sum, inverse[n], term[n]);
    return sum;
}

/* The change of bn where b rotates: cos and sin of the yaw follow from the changes of ζ below n. */
typedef struct turn_change {
    lane turn[TERMS], cosine[TERMS], sine[TERMS];
} turn_change;

static lanes rotating_b_change(turn_change *c, const taylor_trace *t, const step_point *at, const step_direction *in,
                               lanes zeta, int n) {
    lane cosine = lane_of(R(0)), sine = cosine, turn = lanes_dot(vec(at->model->yaw_rate_of_zeta), zeta);
    if (in->model != NULL) turn += dot(in->model->yaw_rate, t->zeta[n]);
    c->turn[n] = at->integrator->step_s * turn;
    for (int j = 0; j < n; j++) {
        cosine -= c->turn[j] * t->sine[n - 1 - j] + t->turn[j] * c->sine[n - 1 - j];
        sine += c->turn[j] * t->cosine[n - 1 - j] + t->turn[j] * c->cosine[n - 1 - j];
    }
    c->cosine[n] = n > 0 ? inverse[n - 1] * cosine : cosine;
    c->sine[n] = n > 0 ? inverse[n - 1] * sine : sine;
    return lanes_plus(lanes_plus(lanes_scaled(t->cosine[n], in->cosine), lanes_scaled(t->sine[n], in->sine)),
                      lanes_plus(lanes_along(c->cosine[n], at->cosine), lanes_along(c->sine[n], at->sine)));
}

/* Σ (g·ζj)'(ζn−j × w) + (g·ζj)(ζn−j × w)' to n. */
INLINE lanes product_change(const taylor_trace *t, const laconic_model *m, const lanes zeta[TERMS],
                            const lane yaw[TERMS], int n) {
    lanes turned = no_lanes(), straight = turned;
    for (int j = 0; j <= n; j++) {
        const lanes *w = &t->side_by_side[n - j], *z = &zeta[n - j];
        const lane turn = yaw[j], ahead = t->yaw_by_side[j];
        turned = lanes_with(turned.x + turn * w->x, turned.y + turn * w->y, turned.z + turn * w->z);
        straight = lanes_with(straight.x + ahead * z->x, straight.y + ahead * z->y, straight.z + ahead * z->z);
    }
    return lanes_plus(turned, lanes_cross(straight, vec(m->gyro)));
}

/* What a change of the model adds to it, with the damping's. */
static vector product_by_model(const taylor_trace *t, const dynamics_change *by, int n) {
    vector straight = none;
    for (int j = 0; j <= n; j++) straight = added(straight, t->yaw[j], t->zeta[n - j]);
    return minus(cross(straight, by->gyro), mapped(&by->damping, t->zeta[n]));
}

INLINE void change_terms(lanes zeta[TERMS], const taylor_trace *t, const step_point *at, const step_direction *in,
                         const dynamics_change *by) {
    const laconic_model *m = at->model;
    lane yaw[TERMS];
    turn_change turn;
    zeta[0] = in->zeta;
    for (int n = 0; n < TERMS - 1; n++) {
        yaw[n] = lanes_dot(vec(m->nu_of_zeta[2]), zeta[n]);
        if (by != NULL) yaw[n] += dot(by->yaw, t->zeta[n]);
        lanes rate = product_change(t, m, zeta, yaw, n);
        if (LACONIC_WITH_DAMPING) rate = lanes_minus(rate, lanes_times(vec(m->decay_per_s), zeta[n]));
        if (by != NULL) rate = lanes_plus(rate, lanes_of(product_by_model(t, by, n)));
        if (n == 0) rate = lanes_plus(rate, in->constant);
        if (at->rotates) rate = lanes_plus(rate, rotating_b_change(&turn, t, at, in, zeta[n], n));
        const lane s = t->share_s[n];
        zeta[n + 1] = lanes_with(s * rate.x, s * rate.y, s * rate.z);
    }
}

/* What one term adds to path and displacement. */
INLINE void add_term(step_response *out, const taylor_trace *t, int n, lanes z) {
    const lane s = t->share_s[n];
    out->path = lanes_with(out->path.x + s * z.x, out->path.y + s * z.y, out->path.z + s * z.z);
    out->along_m += lanes_dot(t->pose.along[n], z);
    out->across_m += lanes_dot(t->pose.across[n], z);
}

INLINE step_response taylor_response(const taylor_trace *t, const step_point *at, const step_direction *in,
                                     const dynamics_change *by, vector path) {
    lanes zeta[TERMS];
    step_response out = {no_lanes(), no_lanes(), lane_of(R(0)), lane_of(R(0)), lane_of(R(0))};
    change_terms(zeta, t, at, in, by);
    for (int n = TERMS - 1; n > 0; n--) {
        out.delta = lanes_plus(out.delta, zeta[n]);
        add_term(&out, t, n, zeta[n]);
    }
    add_term(&out, t, 0, zeta[0]);
    out.yaw_change_rad = lanes_dot(vec(at->model->yaw_rate_of_zeta), out.path);
    if (by == NULL) return out;
    pose_change more = {R(0), R(0), dot(by->yaw_rate, path)};
    add_pose_by_model(&more, t, by);
    out.along_m += more.along_m;
    out.across_m += more.across_m;
    out.yaw_change_rad += more.yaw_change_rad;
    return out;
}

void laconic_taylor_8_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                                int32_t count) {
    taylor_trace t;
    trace_terms(&t, at);
    step->delta = sum_to_end(t.zeta);
    step->path = scaled(at->integrator->step_s, mean_of(t.zeta));
    step->moved = trace_pose(&t, at, step->path);
    for (int32_t k = 0; k < count; k++)
        out[k] = in[k].model != NULL ? taylor_response(&t, at, &in[k], in[k].model, step->path)
                                     : taylor_response(&t, at, &in[k], NULL, step->path);
}
