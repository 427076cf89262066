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

/* The points of one group; the hitch, which never lifts, has the index −1. */
typedef struct tree_group {
    int32_t count, index[TREE_STATIC_POINTS];
    vector row[TREE_STATIC_POINTS]; /* 1 m, x, y */
    real load_N[TREE_STATIC_POINTS];
    bool lifted[TREE_STATIC_POINTS];
    vector wanted;
} tree_group;

static void tree_add_point(tree_group *g, int32_t index, real x, real y) {
    g->index[g->count] = index;
    g->lifted[g->count] = false;
    g->row[g->count++] = vector_of(R(1), x, y);
}

static void tree_add_weight(tree_group *g, real force_N, real x, real y) {
    g->wanted = plus(g->wanted, vector_of(force_N, force_N * x, force_N * y));
}

/* Solves Σ row rowᵀ λ = wanted over the points on the ground; false where they do not determine it. */
static bool tree_balance(vector *lambda, const tree_group *g) {
    equations e;
    e.xx = e.xy = e.xz = e.yy = e.yz = e.zz = R(0);
    for (int32_t k = 0; k < g->count; k++)
        if (!g->lifted[k]) add_product(&e, g->row[k], g->row[k]);
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

/* Points on one line, or fewer than three: the least-norm part that they can hold. */
RARE void tree_balance_what_can_be(tree_group *g) {
    real rows[TREE_STATIC_POINTS][3], solver[TREE_STATIC_POINTS][3];
    for (int32_t k = 0; k < g->count; k++) store(rows[k], g->lifted[k] ? none : g->row[k]);
    laconic_least_norm(solver, (const real(*)[3])rows, g->count);
    for (int32_t k = 0; k < g->count; k++)
        if (!g->lifted[k]) g->load_N[k] = dot(vec(solver[k]), g->wanted);
}

/* What the wheels and supports left carry is the weight, whatever moments they cannot hold. */
static void tree_carry_weight(tree_group *g) {
    real sum = R(0), weight = g->wanted.x;
    for (int32_t k = 0; k < g->count; k++) {
        if (g->index[k] < 0) weight -= g->load_N[k];
        if (g->index[k] < 0 || g->lifted[k]) continue;
        if (g->load_N[k] < R(0)) g->load_N[k] = R(0);
        sum += g->load_N[k];
    }
    for (int32_t k = 0; k < g->count && sum > R(0); k++)
        if (g->index[k] >= 0 && !g->lifted[k]) g->load_N[k] *= weight / sum;
}

static bool tree_lift(tree_group *g) {
    bool another = false;
    for (int32_t k = 0; k < g->count; k++)
        if (g->index[k] >= 0 && !g->lifted[k] && g->load_N[k] < TREE_LIFTS * magnitude(g->wanted.x))
            g->lifted[k] = another = true;
    return another;
}

/* Points that would pull lift until none does. */
RARE void tree_share_again(tree_group *g) {
    while (tree_lift(g)) { /* ends: each round lifts a point */
        vector lambda;
        if (!tree_balance(&lambda, g)) {
            tree_balance_what_can_be(g);
            continue;
        }
        for (int32_t k = 0; k < g->count; k++)
            if (!g->lifted[k]) g->load_N[k] = dot(g->row[k], lambda);
    }
    tree_carry_weight(g);
}

static void tree_share(tree_group *g) {
    vector lambda;
    bool pulls = false;
    if (!tree_balance(&lambda, g)) {
        tree_balance_what_can_be(g);
        tree_share_again(g);
        return;
    }
    for (int32_t k = 0; k < g->count; k++) {
        g->load_N[k] = dot(g->row[k], lambda);
        pulls = pulls || g->load_N[k] < R(0);
    }
    if (pulls) tree_share_again(g);
}

static void tree_fill_group(tree_group *g, int32_t number, const tree_model *m, const tree_posture *at,
                            const tree_place_of_wheel place[], const tree_state *state, const real hitch_N[]) {
    real fx = R(0), fy = R(0);
    g->count = 0;
    g->wanted = none;
    for (int32_t b = number; b <= m->body_count; b++) {
        if (m->body[b].group == number)
            tree_add_weight(g, m->body[b].mass_kg * m->gravity_m_per_s2, at->hinge_x[b] + at->arm_x[b],
                            at->hinge_y[b] + at->arm_y[b]);
        else if (m->body[b].hitch && m->body[m->body[b].parent].group == number)
            tree_add_weight(g, hitch_N[b], at->hinge_x[b], at->hinge_y[b]);
    }
    for (int32_t i = 0; i < m->wheel_count; i++) {
        if (m->body[m->wheel[i].body].group != number) continue;
        tree_add_point(g, i, place[i].x, place[i].y);
        if (m->body[number].com_z_m == R(0)) continue;
        const real along = -state->grip_N[i][0], across = -m->wheel[i].drag * state->grip_N[i][1];
        fx += along * place[i].pull.cosine - across * place[i].pull.sine;
        fy += along * place[i].pull.sine + across * place[i].pull.cosine;
    }
    for (int32_t i = m->wheel_count; number == 0 && i < m->point_count; i++)
        tree_add_point(g, i, m->support_m[i - m->wheel_count][0], m->support_m[i - m->wheel_count][1]);
    if (number > 0) tree_add_point(g, -1, at->hinge_x[number], at->hinge_y[number]);
    g->wanted.y -= m->body[number].com_z_m * fx;
    g->wanted.z -= m->body[number].com_z_m * fy;
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
        for (int32_t k = 0; k < g.count; k++) {
            if (g.index[k] < 0) {
                hitch_N[b] = g.load_N[k];
                continue;
            }
            loads->statics_N[g.index[k]] = g.load_N[k];
            loads->carried_N[g.index[k]] = g.lifted[k] || g.load_N[k] < R(0) ? R(0) : g.load_N[k];
            if (!g.lifted[k]) loads->statics_N[g.index[k]] = loads->carried_N[g.index[k]];
        }
    }
}

#endif
