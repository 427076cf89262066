/* Collocation at Gauss' points, linearised panel by panel (exponential_gauss_8.c). A direction goes through a panel as
 * ζ does: with F at the nodes and the panel's weights, by rounds until they settle. The step has been taken, so the
 * rounds of ζ find the solution of the collocation: all rounds of a direction are linearised there. */
#include "exponential_gauss_8.h"
#include "gauss_weight_change.h"
#include "step_change.h"

#if LACONIC_WITH_EXPONENTIAL_GAUSS

/* F at the nodes; ζ × w and g·ζ in every lane; where b rotates, the yaw at which it is taken and ∂b/∂yaw there. */
typedef struct rate_trace {
    node_vectors rate;
    lanes turned[NODES];
    lane yaw_speed[NODES];
    direction yaw[NODES];
    vector slope[NODES];
} rate_trace;

static inline lanes lanes_multiplied(lanes a, lanes b) { return lanes_with(a.x * b.x, a.y * b.y, a.z * b.z); }

static inline vector node_vector(const node_vectors *v, int j) { return vector_of(v->x[j], v->y[j], v->z[j]); }

/* A panel; `row`: its weights on each axis. Where it is the whole step, the yaw at the nodes is a quadrature of ζ, else
 * it comes from weights, and `lacking` is what the quadrature lacks of ∫ζ dt. */
typedef struct panel_trace {
    const real *row[3];
    lanes weight[PANEL_WEIGHTS]; /* the same in every lane */
    real h;
    bool is_whole;
    int most_rounds;     /* of a direction: those of ζ converge as fast */
    vector start, still; /* still: what F is without turning        */
    vector path, lacking;
    node_vectors zeta; /* at the nodes, and F of that */
    rate_trace of;
    real cosine[NODES], sine[NODES];  /* of the yaw from the panel's middle, times h·weight */
    real along[NODES], across[NODES]; /* displacement that a node stands for, turned */
    direction to_start;               /* half of the panel's yaw back               */
    pose_change before, moved;        /* of the panels before it, and its own       */
    real yaw_change_rad;              /* of the panels before it                    */
} panel_trace;

static inline vector weight_at(const panel_trace *t, int place) {
    return vector_of(t->row[0][place], t->row[1][place], t->row[2][place]);
}

#define TO_POINT(i, j) (NODES * (i) + (j))          /* A_ij */
#define MEAN_TO(i, j) (WEIGHTS + NODES * (i) + (j)) /* D_ij */

/* ------------------------------------------------------------------------------- the step itself -- */

static void trace_turning_forcing(rate_trace *of, const panel_trace *t, const step_point *at) {
    real yaw[NODES];
    yaw_at_nodes(yaw, at->model, t->h, &t->zeta);
    for (int j = 0; j < NODES; j++) {
        of->yaw[j] = laconic_direction_of_angle(t->before.yaw_change_rad + yaw[j]);
        const vector b = forcing_seen(at, of->yaw[j]);
        of->rate.x[j] += b.x;
        of->rate.y[j] += b.y;
        of->rate.z[j] += b.z;
    }
}

/* ζ at the start at all nodes. */
static void begin_rounds(panel_trace *t) {
    for (int j = 0; j < NODES; j++) {
        t->zeta.x[j] = t->start.x;
        t->zeta.y[j] = t->start.y;
        t->zeta.z[j] = t->start.z;
    }
}

/* F at the nodes, from ζ there. */
static void trace_rates(panel_trace *t, const step_point *at) {
    rates_at(&t->of.rate, at->model, &t->zeta, t->still);
    if (at->rotates) trace_turning_forcing(&t->of, t, at);
}

/* ζ and F at the nodes. Rounds that go on changing the last digits have settled, too. */
static void trace_rounds(panel_trace *t, const step_point *at) {
    real move = R(1);
    int round = 0;
    begin_rounds(t);
    while (round < MOST_ROUNDS && move != R(0) && (round < ROUNDS || !nodes_settled(&t->zeta, move, SETTLED))) {
        const node_vectors before = t->zeta;
        trace_rates(t, at);
        answer(&t->zeta, t->start, t->row, &t->of.rate);
        move = distance_of_nodes(&t->zeta, &before);
        round++;
    }
    t->most_rounds = round <= ROUNDS ? ROUNDS : MOST_ROUNDS;
}

/* What ∂F/∂ζ and ∂F/∂yaw are made of. */
static void trace_slopes(rate_trace *of, const panel_trace *t, const step_point *at) {
    const laconic_model *m = at->model;
    for (int j = 0; j < NODES; j++) {
        const vector zeta = node_vector(&t->zeta, j);
        of->turned[j] = lanes_of(cross(zeta, vec(m->gyro)));
        of->yaw_speed[j] = lane_of(dot(vec(m->nu_of_zeta[2]), zeta));
        if (at->rotates) of->slope[j] = forcing_slope(at, of->yaw[j]);
    }
}

/* Σ weight · F, from a place of the row on, `stride` places apart. */
static vector summed_rates(const panel_trace *t, int place, int stride) {
    vector sum = none;
    const node_vectors *rate = &t->of.rate;
    for (int i = 0; i < NODES; i++) sum = plus(sum, times(weight_at(t, place + stride * i), node_vector(rate, i)));
    return sum;
}

static void trace_displacement(panel_trace *t, const laconic_model *m) {
    const vector yaw_rate = vec(m->yaw_rate_of_zeta), forth = vec(m->velocity_of_zeta[0]),
                 left = vec(m->velocity_of_zeta[1]);
    const pose_change still = {R(0), R(0), dot(yaw_rate, t->path)};
    real yaw[NODES];
    t->moved = still;
    t->lacking = t->path;
    if (t->is_whole) yaw_at_nodes(yaw, m, t->h, &t->zeta);
    for (int j = 0; j < NODES; j++) {
        const vector zeta = node_vector(&t->zeta, j);
        if (!t->is_whole)
            yaw[j] = t->h * dot(yaw_rate, added(summed_rates(t, MEAN_TO(0, j), NODES), gauss_node[j], t->start));
        yaw[j] -= R(0.5) * t->moved.yaw_change_rad;
        const direction d = laconic_direction_of_angle(yaw[j]);
        t->cosine[j] = t->h * gauss_weight[j] * d.cosine;
        t->sine[j] = t->h * gauss_weight[j] * d.sine;
        t->along[j] = t->cosine[j] * dot(forth, zeta) - t->sine[j] * dot(left, zeta);
        t->across[j] = t->sine[j] * dot(forth, zeta) + t->cosine[j] * dot(left, zeta);
        t->moved.along_m += t->along[j];
        t->moved.across_m += t->across[j];
        t->lacking = added(t->lacking, -(t->h * gauss_weight[j]), zeta);
    }
    if (t->is_whole) return;
    t->to_start = laconic_direction_of_angle(R(-0.5) * t->moved.yaw_change_rad);
    t->moved.along_m += t->to_start.cosine * dot(forth, t->lacking) - t->to_start.sine * dot(left, t->lacking);
    t->moved.across_m += t->to_start.sine * dot(forth, t->lacking) + t->to_start.cosine * dot(left, t->lacking);
}

/* `step` holds what the panels before have done, and moves on; without that the panel is the first. */
static void trace_panel(panel_trace *t, step_result *step, const step_point *at) {
    const int weights = t->is_whole ? WEIGHTS : PANEL_WEIGHTS;
    t->start = plus(at->zeta, step->delta);
    t->before = step->moved;
    for (int k = 0; k < weights; k++) t->weight[k] = lanes_of(weight_at(t, k));
    const vector damped = damping(at->model, t->start);
    t->still = at->rotates ? minus(none, damped) : minus(at->constant, damped);
    trace_rounds(t, at);
    trace_slopes(&t->of, t, at);
    t->path = scaled(t->h, plus(t->start, summed_rates(t, OF_MEAN, 1)));
    step->delta = plus(step->delta, summed_rates(t, AT_END, 1));
    step->path = plus(step->path, t->path);
    trace_displacement(t, at->model);
    if (t->is_whole) {
        step->moved = t->moved;
        return;
    }
    const direction back = t->to_start, on = laconic_direction_of_angle(R(0.5) * t->before.yaw_change_rad);
    step->moved.along_m = back.cosine * t->before.along_m - back.sine * t->before.across_m +
                          (on.cosine * t->moved.along_m - on.sine * t->moved.across_m);
    step->moved.across_m = back.sine * t->before.along_m + back.cosine * t->before.across_m +
                           (on.sine * t->moved.along_m + on.cosine * t->moved.across_m);
    step->moved.yaw_change_rad += t->moved.yaw_change_rad;
}

/* ------------------------------------------------------------------------------------ directions -- */

/* What a change of the model adds in a panel: of each weight, of F at each node. */
typedef struct panel_model {
    const dynamics_change *by;
    gauss_weight_change weight;
} panel_model;

/* Σ changed weight · F. */
static vector weight_response(const panel_trace *t, const panel_model *model, int place, int stride) {
    vector sum = none;
    for (int i = 0; i < NODES; i++)
        sum = plus(sum, laconic_gauss_weight_mapped(&model->weight, place + stride * i, node_vector(&t->of.rate, i)));
    return sum;
}

INLINE lanes summed_changes(const panel_trace *t, const lanes rate[NODES], int place, int stride) {
    const lanes *w = &t->weight[place];
    return lanes_plus(lanes_plus(lanes_multiplied(w[0], rate[0]), lanes_multiplied(w[stride], rate[1])),
                      lanes_plus(lanes_multiplied(w[2 * stride], rate[2]), lanes_multiplied(w[3 * stride], rate[3])));
}

/* The change of the yaw since the panel's start at node j, where it is a quadrature of ζ. */
INLINE lane quadrature_yaw_change(const panel_trace *t, const laconic_model *m, const lanes zeta[NODES], int j,
                                  const dynamics_change *by) {
    lane yaw = lane_of(R(0));
    for (int i = 0; i < NODES; i++) {
        lane rate = lanes_dot(vec(m->yaw_rate_of_zeta), zeta[i]);
        if (by != NULL) rate += dot(by->yaw_rate, node_vector(&t->zeta, i));
        yaw += t->h * undamped[i][j] * rate;
    }
    return yaw;
}

/* The change of F at the nodes. */
INLINE void rate_changes(lanes rate[NODES], const panel_trace *t, const step_point *at, const step_direction *in,
                         const step_response *before, const lanes zeta[NODES], lanes still, const panel_model *model) {
    const dynamics_change *by = model != NULL ? model->by : NULL;
    const laconic_model *m = at->model;
    const rate_trace *r = &t->of;
    for (int j = 0; j < NODES; j++) {
        const lane turn = lanes_dot(vec(m->nu_of_zeta[2]), zeta[j]);
        const lanes twist = lanes_cross(zeta[j], vec(m->gyro)), *turned = &r->turned[j];
        rate[j].x = still.x + (turn * turned->x + r->yaw_speed[j] * twist.x);
        rate[j].y = still.y + (turn * turned->y + r->yaw_speed[j] * twist.y);
        rate[j].z = still.z + (turn * turned->z + r->yaw_speed[j] * twist.z);
        if (by != NULL) rate[j] = lanes_plus(rate[j], lanes_of(gyroscopic_change(m, by, node_vector(&t->zeta, j))));
        if (at->rotates) {
            const lane yaw = before->yaw_change_rad + quadrature_yaw_change(t, m, zeta, j, by);
            rate[j] = lanes_plus(rate[j], lanes_plus(forcing_change(in, r->yaw[j]), lanes_along(yaw, r->slope[j])));
        }
    }
}

/* The change of the yaw since the panel's start at each node, at the end of the rounds. */
INLINE void yaw_changes(lane yaw[NODES], const panel_trace *t, const laconic_model *m, lanes start,
                        const lanes zeta[NODES], const lanes rate[NODES], const panel_model *model) {
    const dynamics_change *by = model != NULL ? model->by : NULL;
    for (int j = 0; j < NODES; j++) {
        if (t->is_whole) {
            yaw[j] = quadrature_yaw_change(t, m, zeta, j, by);
            continue;
        }
        lanes mean = lanes_added(summed_changes(t, rate, MEAN_TO(0, j), NODES), gauss_node[j], start);
        if (model != NULL) mean = lanes_plus(mean, lanes_of(weight_response(t, model, MEAN_TO(0, j), NODES)));
        lane turn = lanes_dot(vec(m->yaw_rate_of_zeta), mean);
        if (by != NULL)
            turn += dot(by->yaw_rate, added(summed_rates(t, MEAN_TO(0, j), NODES), gauss_node[j], t->start));
        yaw[j] = t->h * turn;
    }
}

/* A displacement and its change, turned by an angle and its change. */
INLINE void add_turned(step_response *out, direction by, lane angle, lane along, lane across, real along_m,
                       real across_m) {
    out->along_m += by.cosine * along - by.sine * across - angle * (by.sine * along_m + by.cosine * across_m);
    out->across_m += by.sine * along + by.cosine * across + angle * (by.cosine * along_m - by.sine * across_m);
}

INLINE void displacement_change(step_response *out, const panel_trace *t, const laconic_model *m,
                                const lanes zeta[NODES], const lane yaw[NODES], const dynamics_change *by) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    const lane half = R(0.5) * out->yaw_change_rad;
    lanes lacking = out->path;
    for (int j = 0; j < NODES; j++) {
        lane ahead = lanes_dot(forth, zeta[j]), aside = lanes_dot(left, zeta[j]);
        if (by != NULL) {
            ahead += dot(by->along, node_vector(&t->zeta, j));
            aside += dot(by->across, node_vector(&t->zeta, j));
        }
        const lane turn = yaw[j] - half;
        out->along_m += t->cosine[j] * ahead - t->sine[j] * aside - turn * t->across[j];
        out->across_m += t->sine[j] * ahead + t->cosine[j] * aside + turn * t->along[j];
        lacking = lanes_added(lacking, -(t->h * gauss_weight[j]), zeta[j]);
    }
    if (t->is_whole) return;
    lane ahead = lanes_dot(forth, lacking), aside = lanes_dot(left, lacking);
    if (by != NULL) {
        ahead += dot(by->along, t->lacking);
        aside += dot(by->across, t->lacking);
    }
    add_turned(out, t->to_start, -half, ahead, aside, dot(forth, t->lacking), dot(left, t->lacking));
}

/* What ζ at the nodes has of the start and of changed weights. */
INLINE void own_changes(lanes own[NODES], const panel_trace *t, lanes start, const panel_model *model) {
    for (int j = 0; j < NODES; j++)
        own[j] = model != NULL ? lanes_plus(start, lanes_of(weight_response(t, model, TO_POINT(0, j), NODES))) : start;
}

/* A round of a direction; returns whether it left every number as it was. */
INLINE bool settled_by_round(lanes zeta[NODES], lanes rate[NODES], const lanes own[NODES], const panel_trace *t,
                             const step_point *at, const step_direction *in, const step_response *before, lanes still,
                             const panel_model *model) {
    bool settled = true;
    rate_changes(rate, t, at, in, before, zeta, still, model);
    for (int j = 0; j < NODES; j++) {
        const lanes now = lanes_plus(own[j], summed_changes(t, rate, TO_POINT(0, j), NODES));
        settled = settled && lanes_same(now, zeta[j]);
        zeta[j] = now;
    }
    return settled;
}

/* The response of this panel alone, from that of the panels before it. */
INLINE step_response panel_response(const panel_trace *t, const step_point *at, const step_direction *in,
                                    const step_response *before, const panel_model *model) {
    const laconic_model *m = at->model;
    const lanes start = lanes_plus(in->zeta, before->delta);
    step_response out = {no_lanes(), no_lanes(), lane_of(R(0)), lane_of(R(0)), lane_of(R(0))};
    lanes zeta[NODES], own[NODES], rate[NODES], still = at->rotates ? no_lanes() : in->constant;
    lane yaw[NODES];
    if (LACONIC_WITH_DAMPING) still = lanes_minus(still, lanes_times(vec(m->decay_per_s), start));
    if (model != NULL) still = lanes_minus(still, lanes_of(mapped(&model->by->damping, t->start)));
    for (int j = 0; j < NODES; j++) zeta[j] = start;
    own_changes(own, t, start, model);
    bool settled = false;
    for (int round = 0; round < t->most_rounds && !settled; round++)
        settled = settled_by_round(zeta, rate, own, t, at, in, before, still, model);
    lanes mean = lanes_plus(start, summed_changes(t, rate, OF_MEAN, 1));
    out.delta = summed_changes(t, rate, AT_END, 1);
    if (model != NULL) {
        mean = lanes_plus(mean, lanes_of(weight_response(t, model, OF_MEAN, 1)));
        out.delta = lanes_plus(out.delta, lanes_of(weight_response(t, model, AT_END, 1)));
    }
    out.path = lanes_scaled(t->h, mean);
    out.yaw_change_rad = lanes_dot(vec(m->yaw_rate_of_zeta), out.path);
    if (model != NULL) out.yaw_change_rad += dot(model->by->yaw_rate, t->path);
    yaw_changes(yaw, t, m, start, zeta, rate, model);
    displacement_change(&out, t, m, zeta, yaw, model != NULL ? model->by : NULL);
    return out;
}

/* Two displacements, one after the other, in axes at the heading half-way of both together. */
static void join_response(step_response *so_far, const panel_trace *t, const step_response *own) {
    const direction on = laconic_direction_of_angle(R(0.5) * t->before.yaw_change_rad);
    step_response out = {lanes_plus(so_far->delta, own->delta), lanes_plus(so_far->path, own->path), lane_of(R(0)),
                         lane_of(R(0)), so_far->yaw_change_rad + own->yaw_change_rad};
    add_turned(&out, t->to_start, R(-0.5) * own->yaw_change_rad, so_far->along_m, so_far->across_m, t->before.along_m,
               t->before.across_m);
    add_turned(&out, on, R(0.5) * so_far->yaw_change_rad, own->along_m, own->across_m, t->moved.along_m,
               t->moved.across_m);
    *so_far = out;
}

static const panel_model *model_change_of(panel_model *room, const panel_trace *t, const step_point *at,
                                          const dynamics_change *by) {
    room->by = by;
    laconic_gauss_weight_change_of(&room->weight, at->model, t->h, &by->damping);
    return room;
}

static void respond_in_panel(step_response out[], const panel_trace *t, const step_point *at, const step_direction in[],
                             int32_t count) {
    panel_model room;
    for (int32_t k = 0; k < count; k++) {
        const step_response own =
            in[k].model != NULL ? panel_response(t, at, &in[k], &out[k], model_change_of(&room, t, at, in[k].model))
                                : panel_response(t, at, &in[k], &out[k], NULL);
        if (t->is_whole)
            out[k] = own;
        else
            join_response(&out[k], t, &own);
    }
}

void laconic_gauss_responses(step_result *step, step_response out[], const step_point *at, const step_direction in[],
                             int32_t count) {
    const laconic_integrator *integrator = at->integrator;
    const step_response still = {no_lanes(), no_lanes(), lane_of(R(0)), lane_of(R(0)), lane_of(R(0))};
    const step_result rest = {none, none, {R(0), R(0), R(0)}};
    panel_trace t;
    panel_among among;
    *step = rest;
    t.is_whole = integrator->stretches == 0;
    t.h = integrator->step_s;
    for (int axis = 0; axis < 3; axis++) t.row[axis] = integrator->collocation[axis];
    if (!t.is_whole) {
        first_panel(&among, at->model, integrator);
        for (int axis = 0; axis < 3; axis++) t.row[axis] = among.row[axis];
        t.h = among.h;
    }
    for (int32_t k = 0; k < count; k++) out[k] = still;
    for (int32_t panel = 0; panel < panels_of(integrator); panel++) {
        if (panel > 0) {
            next_panel(&among, at->model, integrator, panel);
            t.h = among.h;
        }
        trace_panel(&t, step, at);
        respond_in_panel(out, &t, at, in, count);
    }
}

#endif
