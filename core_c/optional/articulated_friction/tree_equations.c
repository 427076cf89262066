/* The equations of a pass, (1 + Σ rowsᵀ S rows) δν = rest, and the factor of M: both eliminated from leaf to root. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

INLINE void tree_unit_matrix(tree_matrix *k, const tree_model *m, bool star) {
    for (int32_t j = 0; j < m->body_count; j++) {
        tree_row *node = &k->node[j];
        const int32_t own = star ? 0 : m->body[j + 1].depth - 1;
        node->base = none;
        for (int32_t i = 0; i < own; i++) node->along[i] = R(0);
        node->along[own] = R(1);
    }
    k->xx = k->yy = k->zz = R(1);
    k->xy = k->xz = k->yz = R(0);
}

/* Adds first secondᵀ, one of a sum that is symmetric. */
INLINE void tree_add_product(tree_matrix *k, const tree_row *first, const tree_row *second, const tree_body *on,
                             bool star) {
    const vector a = first->base, b = second->base;
    k->xx += a.x * b.x;
    k->xy += a.x * b.y;
    k->xz += a.x * b.z;
    k->yy += a.y * b.y;
    k->yz += a.y * b.z;
    k->zz += a.z * b.z;
    for (int32_t i = 0; i < tree_depth(on, star); i++) {
        tree_row *node = &k->node[on->path[i]];
        const real share = first->along[i];
        node->base = plus(node->base, scaled(share, b));
        node->along[i] += share * second->along[i];
        for (int32_t l = 0; l < i && !star; l++) node->along[l] += share * second->along[l];
    }
}

INLINE void tree_scale(tree_row *out, const tree_row *row, real by, int32_t depth) {
    out->base = scaled(by, row->base);
    for (int32_t k = 0; k < depth; k++) out->along[k] = by * row->along[k];
}

INLINE void tree_combine(tree_row *out, const tree_row rows[2], const real by[2], int32_t depth) {
    out->base = plus(scaled(by[0], rows[0].base), scaled(by[1], rows[1].base));
    for (int32_t k = 0; k < depth; k++) out->along[k] = by[0] * rows[0].along[k] + by[1] * rows[1].along[k];
}

/* Adds stiffness row rowᵀ. */
INLINE void tree_add_square(tree_matrix *k, const tree_row *row, real stiffness, const tree_body *on, bool star) {
    tree_row part;
    part.along[0] = R(0); /* else compilers doubt it */
    tree_scale(&part, row, stiffness, tree_depth(on, star));
    tree_add_product(k, &part, row, on, star);
}

INLINE void tree_add_contact(tree_matrix *k, tree_vector *rest, const tree_contact *c, bool star) {
    const tree_law *law = &c->law;
    const int32_t depth = tree_depth(c->on, star);
    tree_row part;
    part.along[0] = R(0); /* else compilers doubt it */
    tree_subtract_both(rest, c->row, law->impulse, c->on, star);
    if (law->axis[1] == R(0)) { /* most wheels that roll */
        tree_add_square(k, &c->row[0], law->along, c->on, star);
        tree_add_square(k, &c->row[1], law->across, c->on, star);
        return;
    }
    tree_combine(&part, c->row, law->axis, depth);
    tree_add_square(k, &part, law->along, c->on, star);
    if (law->across == R(0)) return; /* wheels that slip */
    tree_combine(&part, c->row, law->other, depth);
    tree_add_square(k, &part, law->across, c->on, star);
}

/* By the larger pivot: what is left beside it is as exact as the smaller one. */
void laconic_tree_split(tree_law *law, real xx, real xy, real yy) {
    const bool first = xx >= yy, diagonal = xy == R(0);
    const real more = first ? xx : yy, share = more > R(0) ? xy / more : R(0);
    const real rest = (first ? yy : xx) - share * xy;
    law->along = diagonal ? xx : more;
    law->across = diagonal ? yy : (rest > R(0) ? rest : R(0));
    law->axis[0] = first ? R(1) : share;
    law->axis[1] = diagonal ? R(0) : (first ? share : R(1));
    law->other[0] = first ? R(0) : R(1);
    law->other[1] = first ? R(1) : R(0);
}

INLINE void tree_add_bundle(tree_matrix *k, tree_vector *rest, const tree_bundle *b, bool star) {
    real q = R(0), stiffness = R(0);
    for (const tree_element *e = b->first; e < b->end; e++) {
        q += e->law_q;
        stiffness += e->law_stiffness;
    }
    tree_subtract(rest, &b->row, q, b->on, star);
    if (stiffness > R(0)) tree_add_square(k, &b->row, stiffness, b->on, star);
}

/* Takes hinge j out of the equations of those before it. */
INLINE void tree_take_out(tree_matrix *k, tree_vector *x, real inverse[], const tree_body *link, int32_t j, bool star) {
    const tree_row *node = &k->node[j];
    const int32_t own = star ? 0 : link->depth - 1;
    const real d = inverse[j] = R(1) / pivot(node->along[own]), r = x->hinge[j];
    const vector b = node->base, share = scaled(d, b);
    for (int32_t i = 0; i < own; i++) {
        const real f = node->along[i] * d;
        tree_row *on = &k->node[link->path[i]];
        on->base = minus(on->base, scaled(f, b));
        for (int32_t l = 0; l <= i; l++) on->along[l] -= f * node->along[l];
        x->hinge[link->path[i]] -= f * r;
    }
    k->xx -= share.x * b.x;
    k->xy -= share.x * b.y;
    k->xz -= share.x * b.z;
    k->yy -= share.y * b.y;
    k->yz -= share.y * b.z;
    k->zz -= share.z * b.z;
    x->base = minus(x->base, scaled(r, share));
}

INLINE vector tree_solved_base(const tree_matrix *k, vector rest) {
    equations e;
    e.rest = rest;
    e.xx = pivot(k->xx);
    e.xy = k->xy;
    e.xz = k->xz;
    e.yy = k->yy;
    e.yz = k->yz;
    e.zz = k->zz;
    return solved(&e);
}

INLINE void tree_solve_equations(tree_matrix *k, tree_vector *x, const tree_model *m, bool star) {
    real inverse[TREE_HINGES];
    inverse[0] = R(0);
    for (int32_t j = m->body_count - 1; j >= 0; j--) tree_take_out(k, x, inverse, &m->body[j + 1], j, star);
    x->base = tree_solved_base(k, x->base);
    for (int32_t j = 0; j < m->body_count; j++) {
        const tree_body *link = &m->body[j + 1];
        const tree_row *node = &k->node[j];
        real rest = x->hinge[j] - dot(node->base, x->base);
        for (int32_t i = 0; i < link->depth - 1 && !star; i++) rest -= node->along[i] * x->hinge[link->path[i]];
        x->hinge[j] = rest * inverse[j];
    }
}

INLINE void tree_difference(tree_vector *rest, const tree_problem *p) {
    rest->base = minus(p->free.base, p->nu.base);
    for (int32_t j = 0; j < p->m->body_count; j++) rest->hinge[j] = p->free.hinge[j] - p->nu.hinge[j];
}

INLINE void tree_move_bundle(tree_bundle *b, const tree_vector *by, bool star) {
    const real x = tree_dot(&b->row, b->on, by, star);
    b->moved += x;
    for (tree_element *e = b->first; e < b->end; e++) e->q = e->law_q + e->law_stiffness * x;
}

INLINE void tree_move_on(tree_problem *p, bool star) {
    tree_contact *const beyond = p->contact + p->contact_count;
    tree_bundle *const last = p->bundle + p->bundle_count;
    tree_matrix k;
    tree_vector by;
    tree_unit_matrix(&k, p->m, star);
    tree_difference(&by, p);
    for (const tree_contact *c = p->contact; c < beyond; c++) tree_add_contact(&k, &by, c, star);
    for (const tree_bundle *b = p->bundle; b < last; b++) tree_add_bundle(&k, &by, b, star);
    tree_solve_equations(&k, &by, p->m, star);
    tree_add(&p->nu, &by, p->m->body_count);
    for (tree_contact *c = p->contact; c < beyond; c++) {
        tree_dot_both(c->law.slip, c->row, c->on, &by, star);
        c->moved[0] += c->law.slip[0];
        c->moved[1] += c->law.slip[1];
    }
    for (tree_bundle *b = p->bundle; b < last; b++) tree_move_bundle(b, &by, star);
}

RARE void tree_move_deep(tree_problem *p) { tree_move_on(p, false); }

void laconic_tree_move(tree_problem *p) {
    if (p->m->star)
        tree_move_on(p, true);
    else
        tree_move_deep(p);
}

/* ------------------------------------------------------------------------------- ν and its forces -- */

INLINE void tree_look_on(tree_problem *p, bool star) {
    for (int32_t i = 0; i < p->contact_count; i++) {
        tree_contact *c = &p->contact[i];
        tree_dot_both(c->moved, c->row, c->on, &p->nu, star);
    }
    for (int32_t i = 0; i < p->bundle_count; i++) {
        tree_bundle *b = &p->bundle[i];
        b->moved = tree_dot(&b->row, b->on, &p->nu, star);
    }
}

RARE void tree_look_deep(tree_problem *p) { tree_look_on(p, false); }

void laconic_tree_look(tree_problem *p) {
    if (p->m->star)
        tree_look_on(p, true);
    else
        tree_look_deep(p);
}

INLINE void tree_take_forces(tree_vector *from, const tree_problem *p, bool star) {
    for (int32_t i = 0; i < p->contact_count; i++)
        tree_subtract_both(from, p->contact[i].row, p->contact[i].impulse, p->contact[i].on, star);
    for (int32_t i = 0; i < p->bundle_count; i++) {
        const tree_bundle *b = &p->bundle[i];
        real q = R(0);
        for (const tree_element *e = b->first; e < b->end; e++) q += e->q;
        tree_subtract(from, &b->row, q, b->on, star);
    }
}

RARE void tree_take_forces_deep(tree_vector *from, const tree_problem *p) { tree_take_forces(from, p, false); }

void laconic_tree_take_forces(tree_vector *from, const tree_problem *p) {
    if (p->m->star)
        tree_take_forces(from, p, true);
    else
        tree_take_forces_deep(from, p);
}

void laconic_tree_imbalance(tree_vector *rest, const tree_problem *p) {
    tree_difference(rest, p);
    laconic_tree_take_forces(rest, p);
}

/* ------------------------------------------------------------------------------------- M = LᵀL -- */

/* Of pivots, which are far inside the range. */
static inline real tree_inverse_root(real pivot) { return R(1) / quick_root(pivot); }

static void tree_eliminate(tree_matrix *k, const tree_row *node, const tree_body *link) {
    const vector b = node->base;
    for (int32_t i = 0; i < link->depth - 1; i++) {
        const real share = node->along[i];
        tree_row *on = &k->node[link->path[i]];
        on->base = minus(on->base, scaled(share, b));
        for (int32_t l = 0; l <= i; l++) on->along[l] -= share * node->along[l];
    }
    k->xx -= b.x * b.x;
    k->xy -= b.x * b.y;
    k->xz -= b.x * b.z;
    k->yy -= b.y * b.y;
    k->yz -= b.y * b.z;
    k->zz -= b.z * b.z;
}

void laconic_tree_factor(tree_factor *f, const tree_model *m) {
    tree_matrix *k = &f->l;
    for (int32_t j = m->body_count - 1; j >= 0; j--) {
        const tree_body *link = &m->body[j + 1];
        tree_row *node = &k->node[j];
        const real s = f->inverse[j] = tree_inverse_root(node->along[link->depth - 1]);
        node->base = scaled(s, node->base);
        for (int32_t i = 0; i < link->depth - 1; i++) node->along[i] *= s;
        tree_eliminate(k, node, link);
    }
    f->iz = tree_inverse_root(k->zz);
    k->xz *= f->iz;
    k->yz *= f->iz;
    k->xx -= k->xz * k->xz;
    k->xy -= k->xz * k->yz;
    k->yy -= k->yz * k->yz;
    f->iy = tree_inverse_root(k->yy);
    k->xy *= f->iy;
    k->xx -= k->xy * k->xy;
    f->ix = tree_inverse_root(k->xx);
}

#endif
