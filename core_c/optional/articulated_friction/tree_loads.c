/* Normal loads of a tree by statics, with its wheels where they are.
 *
 * Bodies on hinges that carry pitch are one rigid group; a hitch parts two groups and passes on a vertical force alone.
 * From the last group to the first each is balanced by the least-norm loads of its wheels, supports and hitch:
 *     Σ N = weight,   Σ N r = Σ m g r − z F
 * F is the ground's horizontal force on the group in the step before, z the height of its centre of mass. A wheel or
 * support that would pull lifts, and the others share its load. */
#include "least_norm.h"
#include "tree_step.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define TREE_LIFTS (-LACONIC_RANK_TOLERANCE)
#ifdef LACONIC_SINGLE
#define TREE_LEAST_PIVOT R(1e-4)
#else
#define TREE_LEAST_PIVOT R(1e-10)
#endif
#define TREE_STATIC_POINTS (LACONIC_TREE_POINTS + 1)

/* A wheel or support on the ground; the hitch, which never lifts, has the index −1. */
typedef struct tree_point {
    real x, y, load_N;
    int32_t index;
    bool lifted;
} tree_point;

typedef struct tree_group {
    int32_t count;
    tree_point point[TREE_STATIC_POINTS];
    vector wanted; /* Σ of loads, of loads x, of loads y */
} tree_group;

INLINE void tree_add_point(tree_group *g, int32_t index, real x, real y) {
    tree_point *point = &g->point[g->count++];
    point->x = x;
    point->y = y;
    point->index = index;
    point->lifted = false;
}

static void tree_add_weight(tree_group *g, real force_N, real x, real y) {
    g->wanted = plus(g->wanted, vector_of(force_N, force_N * x, force_N * y));
}

/* Solves Σ row rowᵀ λ = wanted, row = (1, x, y), over the points on the ground. Returns false where they do not
 * determine it. */
static bool tree_balance(vector *lambda, const tree_group *g) {
    equations e;
    e.xx = e.xy = e.xz = e.yy = e.yz = e.zz = R(0);
    for (const tree_point *t = g->point; t < g->point + g->count; t++) {
        if (t->lifted) continue;
        e.xx += R(1);
        e.xy += t->x;
        e.xz += t->y;
        e.yy += t->x * t->x;
        e.yz += t->x * t->y;
        e.zz += t->y * t->y;
    }
    if (!(e.xx > R(0))) return false;
    const real lxy = e.xy / e.xx, lxz = e.xz / e.xx, dy = e.yy - lxy * e.xy, below = e.yz - lxz * e.xy;
    if (!(dy > TREE_LEAST_PIVOT * e.yy)) return false;
    const real lyz = below / dy, dz = e.zz - lxz * e.xz - lyz * below;
    if (!(dz > TREE_LEAST_PIVOT * e.zz)) return false;
    const real y = g->wanted.y - lxy * g->wanted.x, z = g->wanted.z - lxz * g->wanted.x - lyz * y;
    lambda->z = z / dz;
    lambda->y = y / dy - lyz * lambda->z;
    lambda->x = g->wanted.x / e.xx - lxy * lambda->y - lxz * lambda->z;
    return true;
}

/* Loads of the points on the ground. Returns the least. */
static real tree_spread(tree_group *g, vector lambda) {
    real least = R(0);
    for (tree_point *t = g->point; t < g->point + g->count; t++) {
        if (t->lifted) continue;
        t->load_N = lambda.x + lambda.y * t->x + lambda.z * t->y;
        if (t->load_N < least) least = t->load_N;
    }
    return least;
}

/* Points on one line, or fewer than three: the least-norm part that they can hold. */
RARE void tree_balance_what_can_be(tree_group *g) {
    real rows[TREE_STATIC_POINTS][3], solver[TREE_STATIC_POINTS][3];
    for (int32_t k = 0; k < g->count; k++)
        store(rows[k], g->point[k].lifted ? none : vector_of(R(1), g->point[k].x, g->point[k].y));
    laconic_least_norm(solver, (const real(*)[3])rows, g->count);
    for (int32_t k = 0; k < g->count; k++)
        if (!g->point[k].lifted) g->point[k].load_N = dot(vec(solver[k]), g->wanted);
}

/* What the wheels and supports left carry is the weight, whatever moments they cannot hold. */
static void tree_carry_weight(tree_group *g) {
    real sum = R(0), weight = g->wanted.x;
    for (int32_t k = 0; k < g->count; k++) {
        tree_point *t = &g->point[k];
        if (t->index < 0) weight -= t->load_N;
        if (t->index < 0 || t->lifted) continue;
        if (t->load_N < R(0)) t->load_N = R(0);
        sum += t->load_N;
    }
    for (int32_t k = 0; k < g->count && sum > R(0); k++)
        if (g->point[k].index >= 0 && !g->point[k].lifted) g->point[k].load_N *= weight / sum;
}

static bool tree_lift(tree_group *g) {
    bool another = false;
    for (int32_t k = 0; k < g->count; k++) {
        tree_point *t = &g->point[k];
        if (t->index >= 0 && !t->lifted && t->load_N < TREE_LIFTS * magnitude(g->wanted.x)) t->lifted = another = true;
    }
    return another;
}

/* Points that would pull lift until none does. */
RARE void tree_share_again(tree_group *g) {
    while (tree_lift(g)) { /* ends: each round lifts a point */
        vector lambda;
        if (tree_balance(&lambda, g))
            (void)tree_spread(g, lambda);
        else
            tree_balance_what_can_be(g);
    }
    tree_carry_weight(g);
}

static void tree_share(tree_group *g) {
    vector lambda;
    const bool balanced = tree_balance(&lambda, g);
    if (!balanced) tree_balance_what_can_be(g);
    if (!balanced || tree_spread(g, lambda) < R(0)) tree_share_again(g);
}

/* Weights of a group, and what its trailers press on their hitches. */
static void tree_add_weights(tree_group *g, int32_t number, const tree_model *m, const tree_posture *at,
                             const real hitch_N[]) {
    for (int32_t b = number; b <= m->body_count; b++) {
        const tree_body *link = &m->body[b];
        if (link->group == number)
            tree_add_weight(g, link->mass_kg * m->gravity_m_per_s2, at->hinge_x[b] + at->arm_x[b],
                            at->hinge_y[b] + at->arm_y[b]);
        else if (link->hitch && m->body[link->parent].group == number)
            tree_add_weight(g, hitch_N[b], at->hinge_x[b], at->hinge_y[b]);
    }
}

/* The ground's force on a group acts below its centre of mass. */
static void tree_add_pitch(tree_group *g, int32_t number, const tree_model *m, const tree_place_of_wheel place[],
                           const tree_state *state) {
    real fx = R(0), fy = R(0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const real along = -state->grip_N[i][0], across = -m->wheel[i].drag * state->grip_N[i][1];
        if (m->body[m->wheel[i].body].group != number) continue;
        fx += along * place[i].pull.cosine - across * place[i].pull.sine;
        fy += along * place[i].pull.sine + across * place[i].pull.cosine;
    }
    g->wanted.y -= m->body[number].com_z_m * fx;
    g->wanted.z -= m->body[number].com_z_m * fy;
}

static void tree_fill_group(tree_group *g, int32_t number, const tree_model *m, const tree_posture *at,
                            const tree_place_of_wheel place[], const tree_state *state, const real hitch_N[]) {
    g->count = 0;
    g->wanted = none;
    tree_add_weights(g, number, m, at, hitch_N);
    if (m->body[number].com_z_m != R(0)) tree_add_pitch(g, number, m, place, state);
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->body[m->wheel[i].body].group == number) tree_add_point(g, i, place[i].x, place[i].y);
    for (int32_t i = m->wheel_count; number == 0 && i < m->point_count; i++)
        tree_add_point(g, i, m->support_m[i - m->wheel_count][0], m->support_m[i - m->wheel_count][1]);
    if (number > 0) tree_add_point(g, -1, at->hinge_x[number], at->hinge_y[number]);
}

void laconic_tree_loads(tree_loads *loads, const tree_model *m, const tree_posture *at,
                        const tree_place_of_wheel place[], const tree_state *state) {
    real hitch_N[TREE_BODIES];
    tree_group g;
    for (int32_t i = 0; m->loads_given && i < m->point_count; i++)
        loads->carried_N[i] = loads->statics_N[i] = i < m->wheel_count ? m->wheel[i].load_N : R(0);
    for (int32_t b = m->body_count; !m->loads_given && b >= 0; b--) {
        if (m->body[b].group != b) continue;
        tree_fill_group(&g, b, m, at, place, state, hitch_N);
        tree_share(&g);
        hitch_N[b] = R(0);
        for (const tree_point *t = g.point; t < g.point + g.count; t++) {
            if (t->index < 0) {
                hitch_N[b] = t->load_N;
                continue;
            }
            loads->carried_N[t->index] = t->lifted || t->load_N < R(0) ? R(0) : t->load_N;
            loads->statics_N[t->index] = t->lifted ? t->load_N : loads->carried_N[t->index];
        }
    }
}

#endif
