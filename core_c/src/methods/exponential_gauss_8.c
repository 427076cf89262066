/* Exponential collocation at Gauss' four points: of eighth order, takes any damping, keeps every steady state. The
 * gyroscopic term and the forcing together, M = (g·ζ)(ζ × w) + b, are taken for the polynomial through their values at
 * the points; ζ' = M − diag(r)ζ is then exact. For η = ζ − ζ(start), with F = M − diag(r)ζ(start),
 *     η(point j) = h Σi A_ij F_i,   η(end) = h Σi B_i F_i,   mean of η = h Σi C_i F_i,
 * the weights, for each axis its own, being integrals of Lagrange's polynomials times the decay; for r = 0 they are
 * those of Gauss' quadrature. F depends on η; ROUNDS rounds from F(start) on find it, each an order better.
 *
 * Where damping is fast beside the step, what the start is away from the steady state dies out within its first part.
 * The step is then taken in panels: the first so short that this is smooth in it, longer ones while it dies out, one
 * for the rest of the step. */
#include "exponential_gauss_8.h"
#include "eighth_order.h"

#if LACONIC_WITH_EXPONENTIAL_GAUSS

#define GAUSS_ROTATION R(2) /* h·|w||g·ζ|: the rounds converge; free motion gains 1.4e-5 of ζ in such a step */

/* -------------------------------------------------------------------------- one panel -- */

typedef struct panel {
    real h;                         /* its length                                            */
    const real *weight[3];          /* of each axis                                          */
    real first, share;              /* where it starts, of the step's s from 0 to 1; its length of that */
    vector constant;                /* b, where it does not vary                             */
    const forcing_terms *varying;   /* NULL where it does not                                */
    const laconic_heading *heading; /* at the step's start                                 */
    bool is_whole;                  /* the only panel of the step */
} panel;

/* What has been found of the step; ζ(start) + delta is ζ where the next panel starts. */
typedef struct progress {
    vector delta, mean; /* ∫ζ ds */
    pose_change moved;
    mask settled; /* the rounds of every panel so far */
} progress;

static vector parabola_at(const vector term[3], real s) {
    return plus(term[0], scaled(s, plus(term[1], scaled(s, term[2]))));
}

INLINE void add_varying_forcing(node_vectors *rate, const laconic_model *m, const panel *p, const node_vectors *zeta,
                                real yaw_before) {
    const forcing_terms *f = p->varying;
    real yaw[NODES];
    if (f->rotates) yaw_at_nodes(yaw, m, p->h, zeta);
    for (int j = 0; j < NODES; j++) {
        const real s = p->first + R(gauss_node[j]) * p->share;
        vector b = parabola_at(f->constant, s);
        if (f->rotates) {
            const laconic_binary_angle turned = laconic_binary_angle_of(yaw_before + yaw[j]);
            const direction heading =
                laconic_direction_of_binary_angle((laconic_binary_angle)(p->heading->fraction + turned));
            b = plus(b, plus(scaled(heading.cosine, parabola_at(f->cosine, s)),
                             scaled(heading.sine, parabola_at(f->sine, s))));
        }
        rate->x[j] += b.x;
        rate->y[j] += b.y;
        rate->z[j] += b.z;
    }
}

INLINE pose_change whole_displacement(const laconic_model *m, real h, const node_vectors *zeta, vector path) {
    const real yaw_change = dot(vec(m->yaw_rate_of_zeta), path);
    real yaw[NODES];
    yaw_at_nodes(yaw, m, h, zeta);
    for (int j = 0; j < NODES; j++) yaw[j] -= R(0.5) * yaw_change;
    return displacement_at_nodes(m, h, yaw_change, zeta->x, zeta->y, zeta->z, yaw);
}

/* Mean of η from the panel's start to each node on one axis, times the node. */
INLINE void mean_to_nodes(real mean[NODES], const real *row, const real rate[NODES]) {
    for (int j = 0; j < NODES; j++) mean[j] = MEAN_TO_POINT(row, 0, j) * rate[0];
    for (int i = 1; i < NODES; i++)
        for (int j = 0; j < NODES; j++) mean[j] += MEAN_TO_POINT(row, i, j) * rate[i];
}

/* The same where something dies out within the panel, in axes at the heading of the step's start. The quadrature does
 * not see that well: the yaw comes from weights, and what the quadrature lacks of ∫v dt belongs to the heading at the
 * panel's start. */
RARE void add_displacement(pose_change *moved, const laconic_model *m, const panel *p, vector start,
                           const node_vectors *zeta, const node_vectors *rate, vector path) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    const vector yaw_rate = vec(m->yaw_rate_of_zeta);
    const real before = moved->yaw_change_rad;
    real x[NODES], y[NODES], z[NODES], yaw[NODES];
    vector lacking = path;
    mean_to_nodes(x, p->weight[0], rate->x);
    mean_to_nodes(y, p->weight[1], rate->y);
    mean_to_nodes(z, p->weight[2], rate->z);
    for (int j = 0; j < NODES; j++) {
        const vector mean = plus(scaled(R(gauss_node[j]), start), vector_of(x[j], y[j], z[j]));
        yaw[j] = before + p->h * dot(yaw_rate, mean);
        lacking = minus(lacking, scaled(p->h * R(gauss_weight[j]), vector_of(zeta->x[j], zeta->y[j], zeta->z[j])));
    }
    const pose_change by = displacement_at_nodes(m, p->h, dot(yaw_rate, path), zeta->x, zeta->y, zeta->z, yaw);
    const direction at_start = laconic_direction_of_binary_angle(laconic_binary_angle_of(before));
    moved->along_m += by.along_m + (at_start.cosine * dot(forth, lacking) - at_start.sine * dot(left, lacking));
    moved->across_m += by.across_m + (at_start.sine * dot(forth, lacking) + at_start.cosine * dot(left, lacking));
    moved->yaw_change_rad += by.yaw_change_rad;
}

/* Into axes at the heading half-way between start and end. */
RARE pose_change seen_half_way(pose_change moved) {
    const direction back = laconic_direction_of_binary_angle(laconic_binary_angle_of(R(-0.5) * moved.yaw_change_rad));
    const pose_change seen = {back.cosine * moved.along_m - back.sine * moved.across_m,
                              back.sine * moved.along_m + back.cosine * moved.across_m, moved.yaw_change_rad};
    return seen;
}

/* Σ weight · F on each axis; `weights`: the first of its weights in the row. */
INLINE vector weighted(const panel *p, int weights, const node_vectors *rate) {
    vector sum = none;
    for (int i = 0; i < NODES; i++) {
        sum.x += p->weight[0][weights + i] * rate->x[i];
        sum.y += p->weight[1][weights + i] * rate->y[i];
        sum.z += p->weight[2][weights + i] * rate->z[i];
    }
    return sum;
}

/* A round; returns how far it moved the numbers: 0 where it left every one as it was. Then all further rounds would,
 * too, so that ending there changes no bit. */
INLINE real moved_by_answer(node_vectors *zeta, vector start, const panel *p, const node_vectors *rate) {
    const node_vectors before = *zeta;
    answer(zeta, start, p->weight, rate);
    return distance_of_nodes(zeta, &before);
}

/* Takes the rounds after the first ROUNDS, for one vehicle. Returns whether they found the solution. */
RARE mask take_more_rounds(node_vectors *zeta, node_vectors *rate, const laconic_model *m, const panel *p, vector start,
                           real yaw_before, real last_move) {
    const vector still = minus(p->constant, damping(m, start));
    real move = last_move;
    if (!ALONE) return nodes_settled(zeta, move, SETTLED);
    for (int round = ROUNDS; round < MOST_ROUNDS; round++) {
        if (!ALL(is_finite(move)) || ALL(nodes_settled(zeta, move, SETTLED))) break;
        rates_at(rate, m, zeta, still);
        if (p->varying != NULL) add_varying_forcing(rate, m, p, zeta, yaw_before);
        move = moved_by_answer(zeta, start, p, rate);
    }
    return nodes_settled(zeta, move, SETTLED_AT_LAST);
}

/* Finds ζ and F at the nodes, by rounds from F at the start on. Returns whether they are the solution. */
INLINE mask take_rounds(node_vectors *zeta, node_vectors *rate, const laconic_model *m, const panel *p, vector start) {
    const vector still = minus(p->constant, damping(m, start));
    real move = R(0);
    first_answer(zeta, start, p->weight, first_rate(m, start, still));
    for (int round = 1; round < ROUNDS; round++) {
        rates_at(rate, m, zeta, still);
        move = moved_by_answer(zeta, start, p, rate);
        if (ALL(move == R(0))) return MASK_OF(true, move == R(0));
    }
    node_vectors at = *zeta, f = *rate; /* only copies are in memory */
    const mask settled = take_more_rounds(&at, &f, m, p, start, R(0), move);
    *zeta = at;
    *rate = f;
    return settled;
}

RARE mask take_varying_rounds(node_vectors *zeta, node_vectors *rate, const laconic_model *m, const panel *p,
                              vector start, real yaw_before) {
    const vector still = minus(none, damping(m, start));
    real move = R(0);
    for (int j = 0; j < NODES; j++) {
        zeta->x[j] = start.x;
        zeta->y[j] = start.y;
        zeta->z[j] = start.z;
    }
    for (int round = 0; round < ROUNDS; round++) {
        rates_at(rate, m, zeta, still);
        add_varying_forcing(rate, m, p, zeta, yaw_before);
        move = moved_by_answer(zeta, start, p, rate);
        if (ALL(move == R(0))) return MASK_OF(true, move == R(0));
    }
    return take_more_rounds(zeta, rate, m, p, start, yaw_before, move);
}

/* What follows from ζ and F at the nodes. */
INLINE void finish_panel(progress *sum, const laconic_model *m, const panel *p, vector start, const node_vectors *zeta,
                         const node_vectors *rate) {
    const vector mean = plus(start, weighted(p, OF_MEAN, rate));
    sum->delta = plus(sum->delta, weighted(p, AT_END, rate));
    sum->mean = plus(sum->mean, scaled(p->share, mean));
    if (!LACONIC_WITH_POSE) return; /* then no force is fixed in the world */
    const vector path = scaled(p->h, mean);
    if (p->is_whole) {
        sum->moved = whole_displacement(m, p->h, zeta, path);
    } else {
        const node_vectors at = *zeta, f = *rate; /* only copies are in memory */
        add_displacement(&sum->moved, m, p, start, &at, &f, path);
    }
}

static void take_panel(progress *sum, const laconic_model *m, const panel *p, vector step_start) {
    const vector start = plus(step_start, sum->delta);
    if (p->varying == NULL) {
        node_vectors zeta, rate;
        const mask settled = take_rounds(&zeta, &rate, m, p, start);
        sum->settled = AND(sum->settled, settled);
        finish_panel(sum, m, p, start, &zeta, &rate);
    } else {
        node_vectors zeta, rate; /* others, since these are in memory */
        const mask settled = take_varying_rounds(&zeta, &rate, m, p, start, sum->moved.yaw_change_rad);
        sum->settled = AND(sum->settled, settled);
        finish_panel(sum, m, p, start, &zeta, &rate);
    }
}

/* -------------------------------------------------------------------------------- the step -- */

RARE void take_panels(progress *sum, const laconic_model *m, const laconic_integrator *integrator, panel *p,
                      vector step_start) {
    panel_among among;
    first_panel(&among, m, integrator);
    for (int axis = 0; axis < 3; axis++) p->weight[axis] = among.row[axis];
    for (int32_t k = 0; k < panels_of(integrator); k++) {
        if (k > 0) next_panel(&among, m, integrator, k);
        p->h = among.h;
        p->first = among.first;
        p->share = among.share;
        take_panel(sum, m, p, step_start);
    }
    if (LACONIC_WITH_POSE) sum->moved = seen_half_way(sum->moved);
}

static laconic_status exponential_gauss_8_step(const laconic_model *model, const laconic_integrator *integrator,
                                               laconic_state *state, const laconic_forcing_samples *samples) {
    vector zeta = zeta_of(state);
    progress sum = {none, none, {R(0), R(0), R(0)}, R(0) == R(0)};
    forcing_terms terms;
    panel p;
    if (UNLIKELY(beyond_rotation(model, integrator, zeta), &zeta.x)) return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    p.h = integrator->step_s;
    for (int axis = 0; axis < 3; axis++) p.weight[axis] = integrator->collocation[axis];
    p.first = R(0);
    p.share = R(1);
    p.is_whole = integrator->stretches == 0;
    p.constant = none;
    p.varying = NULL;
    p.heading = &state->heading;
    if (constant_over(samples)) {
        p.constant = vec(samples->start->constant);
    } else {
        forcing_terms_of(&terms, samples);
        p.varying = &terms;
    }
    if (p.is_whole)
        take_panel(&sum, model, &p, zeta);
    else
        take_panels(&sum, model, integrator, &p, zeta);
    increment by = {sum.delta, sum.mean, sum.delta};
    if (!LIKELY(sum.settled, &sum.moved.along_m)) return LACONIC_STEP_SINGULAR;
    if (!LIKELY(keeps_energy(model, state, integrator->step_s, samples, zeta, &by), &sum.moved.along_m))
        return not_passive(by);
    if (!LIKELY(in_range(zeta, by.delta), &sum.moved.along_m)) return LACONIC_OVERFLOW;
    return end_levelled(state, model, integrator->step_s, samples, by, sum.moved);
}

/* ------------------------------------------------------------------------------ preparation -- */

/* The stretches end when they cover the step, or when what dies out has done so on the slowest of those axes on which
 * the step would be too long a panel. */
static void choose_panels(laconic_integrator *integrator, const laconic_model *m) {
    const real scale = integrator->halved ? R(0.5) : R(1), parts = integrator->halved ? R(2 * PARTS) : R(PARTS);
    const real panel_decay = scale * PANEL_DECAY, first = parts * panel_decay, dead_after = DEAD_AFTER / scale;
    const real fastest = integrator->step_s * laconic_fastest_decay(m);
    real slowest = fastest, end = R(0), length = R(1); /* in units of the first stretch */
    integrator->stretches = 0;
    integrator->has_rest = false;
    if (!ANY(fastest > scale * WHOLE_DECAY)) return;
    for (int axis = 0; axis < 3; axis++) {
        const real a = integrator->step_s * m->decay_per_s[axis];
        if (ANY(AND(a > panel_decay, a < slowest))) slowest = a;
    }
    do {
        if (integrator->stretches >= 2) length *= R(2);
        end += length;
        integrator->stretches++;
        integrator->has_rest = ANY(end * first * slowest >= dead_after * fastest);
    } while (ANY(end * first < fastest) && !integrator->has_rest && integrator->stretches < MOST_STRETCHES);
    integrator->has_rest = integrator->has_rest && ANY(end * first < fastest);
    integrator->first_share = (integrator->has_rest ? first / fastest : R(1) / end) / parts;
    integrator->rest_share = R(1) - end * parts * integrator->first_share;
}

static void phis_at_nodes(real phi[PHIS * (NODES + 1)], real a) {
    for (int j = 0; j <= NODES; j++) {
        real of_node[PHIS];
        laconic_phi(of_node, a * (j < NODES ? R(gauss_node[j]) : R(1)));
        for (int n = 0; n < PHIS; n++) PHI(phi, j, n) = of_node[n];
    }
}

static void prepare_panels(laconic_integrator *integrator, const laconic_model *model) {
    const real h = integrator->step_s;
    choose_panels(integrator, model);
    for (int axis = 0; axis < 3; axis++) {
        const real a = h * model->decay_per_s[axis];
        real *kept = integrator->collocation[axis];
        if (integrator->stretches == 0) {
            real phi[PHIS * (NODES + 1)], weights[PANEL_WEIGHTS];
            phis_at_nodes(phi, a);
            weights_of(weights, phi, h, a);
            for (int n = 0; n < WEIGHTS; n++) kept[n] = weights[n];
        } else {
            phis_at_nodes(kept, a * integrator->first_share);
        }
        if (integrator->has_rest) phis_at_nodes(integrator->collocation_of_rest[axis], a * integrator->rest_share);
    }
}

#if LACONIC_WITH_PREPARE /* lanes have constants alone */
void laconic_halve_panels(laconic_integrator *integrator, const laconic_model *model) {
    integrator->halved = integrator->stretches > 0 || integrator->collocation[0][0] != R(0); /* others set neither */
    if (integrator->halved) prepare_panels(integrator, model);
}
#endif

static laconic_status exponential_gauss_8_prepare(laconic_integrator *integrator, const laconic_model *model,
                                                  laconic_refusal *why) {
    prepare_panels(integrator, model);
    return laconic_explicit_limits(integrator, model, R(LACONIC_REAL_MAX), GAUSS_ROTATION, why);
}

const laconic_method laconic_exponential_gauss_8 = {"exponential-gauss-8", 8, PREPARE(exponential_gauss_8_prepare),
                                                    exponential_gauss_8_step};

#endif
