/* M = LᵀL from leaf to root. */
#include "friction_internals.h"
#include "tree_posture.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

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
