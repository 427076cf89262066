/* The tree at one moment: places of hinges and centres of mass, momenta, the mass matrix and its factor.
 *
 * All is in axes of body 0, from S_0. A point r of body b moves with v_0 + θ' e_z×r + Σ ψ'_j e_z×(r − h_j) over the
 * hinges j from body 0 to b. Mass, first moment and inertia are gathered from leaf to root about each hinge, so that a
 * light body far out keeps its digits. The mass matrix has an entry only where one hinge hangs on the other; eliminated
 * from leaf to root, M = LᵀL has no others. In ζ = Lz the energy is ½|ζ|², and a row becomes L⁻ᵀrow. */
#ifndef LACONIC_TREE_POSTURE_H
#define LACONIC_TREE_POSTURE_H

#include "heading.h"
#include "laconic/articulated_friction.h"
#include "vector.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define TREE_HINGES LACONIC_MAX_BODIES
#define TREE_BODIES (LACONIC_MAX_BODIES + 1)

typedef laconic_tree_model tree_model;
typedef laconic_tree_body tree_body;

/* Along a path: what belongs to the carriage's three speeds, then one number for each hinge of the path. */
typedef struct tree_row {
    vector base;
    real along[TREE_HINGES];
} tree_row;

/* One number for each speed of the tree. */
typedef struct tree_vector {
    vector base;
    real hinge[TREE_HINGES];
} tree_vector;

/* Symmetric; node j has the row of hinge j up to its own diagonal. */
typedef struct tree_matrix {
    tree_row node[TREE_HINGES];
    real xx, xy, xz, yy, yz, zz;
} tree_matrix;

typedef struct tree_posture {
    direction axes[TREE_BODIES];
    real hinge_x[TREE_BODIES], hinge_y[TREE_BODIES];
    real from_x[TREE_BODIES], from_y[TREE_BODIES]; /* the hinge from the parent's hinge     */
    real arm_x[TREE_BODIES], arm_y[TREE_BODIES];   /* the centre of mass from its own hinge */
} tree_posture;

/* L with inverse diagonals. */
typedef struct tree_factor {
    tree_matrix l;
    real inverse[TREE_HINGES], ix, iy, iz;
} tree_factor;

/* ------------------------------------------------------------------------------- rows on paths -- */

/* Hinges on the path of a body. `star`: all hinges are on body 0, as of most vehicles; given as a constant, it turns
 * loops along paths into one step at most. */
INLINE int32_t tree_depth(const tree_body *on, bool star) { return star ? (on->depth > 0 ? 1 : 0) : on->depth; }

INLINE real tree_dot(const tree_row *row, const tree_body *on, const tree_vector *x, bool star) {
    real sum = dot(row->base, x->base);
    for (int32_t k = 0; k < tree_depth(on, star); k++) sum += row->along[k] * x->hinge[on->path[k]];
    return sum;
}

/* The same of both rows of a contact. */
INLINE void tree_dot_both(real out[2], const tree_row rows[2], const tree_body *on, const tree_vector *x, bool star) {
    real first = dot(rows[0].base, x->base), second = dot(rows[1].base, x->base);
    for (int32_t k = 0; k < tree_depth(on, star); k++) {
        const real turn = x->hinge[on->path[k]];
        first += rows[0].along[k] * turn;
        second += rows[1].along[k] * turn;
    }
    out[0] = first;
    out[1] = second;
}

INLINE real tree_row_product(const tree_row *a, const tree_row *b, const tree_body *on, bool star) {
    real sum = dot(a->base, b->base);
    for (int32_t k = 0; k < tree_depth(on, star); k++) sum += a->along[k] * b->along[k];
    return sum;
}

INLINE void tree_subtract(tree_vector *from, const tree_row *row, real times_row, const tree_body *on, bool star) {
    from->base = minus(from->base, scaled(times_row, row->base));
    for (int32_t k = 0; k < tree_depth(on, star); k++) from->hinge[on->path[k]] -= times_row * row->along[k];
}

INLINE void tree_subtract_both(tree_vector *from, const tree_row rows[2], const real by[2], const tree_body *on,
                               bool star) {
    const real a = by[0], b = by[1];
    from->base = minus(from->base, plus(scaled(a, rows[0].base), scaled(b, rows[1].base)));
    for (int32_t k = 0; k < tree_depth(on, star); k++)
        from->hinge[on->path[k]] -= a * rows[0].along[k] + b * rows[1].along[k];
}

static inline void tree_add(tree_vector *to, const tree_vector *x, int32_t hinges) {
    to->base = plus(to->base, x->base);
    for (int32_t k = 0; k < hinges; k++) to->hinge[k] += x->hinge[k];
}

static inline real tree_square(const tree_vector *x, int32_t hinges) {
    real sum = square(x->base);
    for (int32_t k = 0; k < hinges; k++) sum += x->hinge[k] * x->hinge[k];
    return sum;
}

/* --------------------------------------------------------------------------------- the posture -- */

static inline direction tree_turned(direction a, direction by) {
    return direction_with(a.cosine * by.cosine - a.sine * by.sine, a.sine * by.cosine + a.cosine * by.sine);
}

/* Places all bodies. On entry `axes` has each hinge's angle, afterwards each body's. */
static inline void tree_place(tree_posture *p, const tree_model *m) {
    p->axes[0] = direction_with(R(1), R(0));
    p->hinge_x[0] = p->hinge_y[0] = p->arm_x[0] = p->arm_y[0] = R(0);
    for (int32_t b = 1; b <= m->body_count; b++) {
        const tree_body *link = &m->body[b];
        const int32_t on = link->parent;
        p->hinge_x[b] = p->from_x[b] = link->hinge_x_m;
        p->hinge_y[b] = p->from_y[b] = link->hinge_y_m;
        if (on > 0) {
            const direction a = p->axes[on];
            p->from_x[b] = a.cosine * link->hinge_x_m - a.sine * link->hinge_y_m;
            p->from_y[b] = a.sine * link->hinge_x_m + a.cosine * link->hinge_y_m;
            p->hinge_x[b] = p->hinge_x[on] + p->from_x[b];
            p->hinge_y[b] = p->hinge_y[on] + p->from_y[b];
            p->axes[b] = tree_turned(a, p->axes[b]);
        }
        const direction d = p->axes[b];
        p->arm_x[b] = d.cosine * link->com_x_m - d.sine * link->com_y_m;
        p->arm_y[b] = d.sine * link->com_x_m + d.cosine * link->com_y_m;
    }
}

/* Velocities of all centres of mass and yaw rates at z. */
static inline void tree_velocities(vector velocity[], const tree_posture *p, const tree_model *m, const real z[]) {
    real x[TREE_BODIES], y[TREE_BODIES];
    velocity[0] = vector_of(z[0], z[1], z[2]);
    x[0] = z[0];
    y[0] = z[1];
    for (int32_t b = 1; b <= m->body_count; b++) {
        const int32_t on = m->body[b].parent;
        const real before = velocity[on].z, rate = before + z[2 + b];
        x[b] = x[on] - before * p->from_y[b];
        y[b] = y[on] + before * p->from_x[b];
        velocity[b] = vector_of(x[b] - rate * p->arm_y[b], y[b] + rate * p->arm_x[b], rate);
    }
}

/* ----------------------------------------------------------------------- mass matrix and momenta -- */

/* Mass, first moment and inertia of a body and all that hangs on it, and their momentum: about its hinge. */
typedef struct tree_moments {
    real mass, x, y, inertia;
    vector momentum;
} tree_moments;

static inline void tree_node_of(tree_row *node, const tree_posture *p, const tree_body *link, int32_t b,
                                const tree_moments *c) {
    node->base = vector_of(-c->y, c->x, c->inertia + (p->hinge_x[b] * c->x + p->hinge_y[b] * c->y));
    for (int32_t k = 0; k < link->depth - 1; k++) {
        const int32_t on = link->path[k] + 1;
        const real dx = p->hinge_x[b] - p->hinge_x[on], dy = p->hinge_y[b] - p->hinge_y[on];
        node->along[k] = c->inertia + (dx * c->x + dy * c->y);
    }
    node->along[link->depth - 1] = c->inertia + link->padding_kgm2;
}

static inline void tree_moments_of(tree_moments *c, const tree_body *link, real x, real y, vector momentum) {
    c->mass = link->mass_kg;
    c->x = link->mass_kg * x;
    c->y = link->mass_kg * y;
    c->inertia = link->yaw_inertia_kgm2 + (c->x * x + c->y * y);
    c->momentum = momentum;
    c->momentum.z += x * momentum.y - y * momentum.x;
}

/* Adds what hangs on a hinge at (x, y) from the hinge before it. */
static inline void tree_hang(tree_moments *on, const tree_moments *c, real x, real y) {
    on->mass += c->mass;
    on->inertia += c->inertia + R(2) * (x * c->x + y * c->y) + c->mass * (x * x + y * y);
    on->x += c->x + c->mass * x;
    on->y += c->y + c->mass * y;
    on->momentum = plus(on->momentum, c->momentum);
    on->momentum.z += x * c->momentum.y - y * c->momentum.x;
}

/* M, and Jᵀ of the bodies' momenta (linear, and angular about the centre of mass): leaf to root, about each hinge. */
static inline void tree_gather(tree_matrix *out, tree_vector *momentum, const tree_posture *p, const tree_model *m,
                               const vector momenta[]) {
    tree_moments c[TREE_BODIES];
    for (int32_t b = 0; b <= m->body_count; b++)
        tree_moments_of(&c[b], &m->body[b], p->arm_x[b], p->arm_y[b], momenta[b]);
    for (int32_t b = m->body_count; b >= 1; b--) {
        tree_node_of(&out->node[b - 1], p, &m->body[b], b, &c[b]);
        momentum->hinge[b - 1] = c[b].momentum.z;
        tree_hang(&c[m->body[b].parent], &c[b], p->from_x[b], p->from_y[b]);
    }
    momentum->base = c[0].momentum;
    out->xx = out->yy = c[0].mass;
    out->xy = R(0);
    out->xz = -c[0].y;
    out->yz = c[0].x;
    out->zz = c[0].inertia;
}

/* ------------------------------------------------------------------------------------- M = LᵀL -- */

void laconic_tree_factor(tree_factor *f, const tree_model *m);

static inline vector tree_back_base(const tree_factor *f, vector v) {
    v.z *= f->iz;
    v.x -= f->l.xz * v.z;
    v.y = (v.y - f->l.yz * v.z) * f->iy;
    v.x = (v.x - f->l.xy * v.y) * f->ix;
    return v;
}

/* row := L⁻ᵀ row */
INLINE void tree_back_row(tree_row *row, const tree_factor *f, const tree_body *on, bool star) {
    for (int32_t above = 0, k; above < tree_depth(on, star); above++) {
        k = tree_depth(on, star) - 1 - above;
        const int32_t j = on->path[k];
        const tree_row *node = &f->l.node[j];
        const real share = row->along[k] * f->inverse[j];
        row->along[k] = share;
        row->base = minus(row->base, scaled(share, node->base));
        for (int32_t i = 0; i < k && !star; i++) row->along[i] -= share * node->along[i];
    }
    row->base = tree_back_base(f, row->base);
}

static inline void tree_back_vector(tree_vector *x, const tree_factor *f, const tree_model *m) {
    for (int32_t j = m->body_count - 1; j >= 0; j--) {
        const tree_body *link = &m->body[j + 1];
        const tree_row *node = &f->l.node[j];
        const real share = x->hinge[j] * f->inverse[j];
        x->hinge[j] = share;
        x->base = minus(x->base, scaled(share, node->base));
        for (int32_t i = 0; i < link->depth - 1; i++) x->hinge[link->path[i]] -= share * node->along[i];
    }
    x->base = tree_back_base(f, x->base);
}

/* z = L⁻¹ ζ */
static inline void tree_forward(real z[], const tree_vector *zeta, const tree_factor *f, const tree_model *m) {
    z[0] = zeta->base.x * f->ix;
    z[1] = (zeta->base.y - f->l.xy * z[0]) * f->iy;
    z[2] = (zeta->base.z - f->l.xz * z[0] - f->l.yz * z[1]) * f->iz;
    for (int32_t j = 0; j < m->body_count; j++) {
        const tree_body *link = &m->body[j + 1];
        const tree_row *node = &f->l.node[j];
        real rest = zeta->hinge[j] - dot(node->base, vec(z));
        for (int32_t i = 0; i < link->depth - 1; i++) rest -= node->along[i] * z[3 + link->path[i]];
        z[3 + j] = rest * f->inverse[j];
    }
}

/* ---------------------------------------------------------------------------- parts of preparing -- */

static inline bool tree_has_servo(const laconic_tree_hinge *hinge) {
    return hinge->servo_gain_Nm_per_rad > R(0) || hinge->servo_damping_Nms > R(0);
}

static inline bool tree_has_loop(const laconic_tree_hinge *hinge) {
    return hinge->loop_V_per_rad != R(0) || hinge->loop_Vs_per_rad != R(0);
}

static inline bool tree_has_stops(const laconic_tree_hinge *hinge) {
    return hinge->stop_low_rad != R(0) || hinge->stop_high_rad != R(0);
}

/* Every number by itself, and what hinges and wheels need of each other. */
laconic_status laconic_tree_check(const laconic_tree_vehicle *vehicle, laconic_refusal *why);

#endif
#endif
