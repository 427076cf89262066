/* One step of a tree on ground with friction: the semismooth Newton method of friction_solver.c, with rows along the
 * paths of the tree and with scalar elements. There the passes, the residual and the constants are derived. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define TREE_NEARLY R(4) /* where rounding leaves no more to find: twice the tolerance, squared */
#define TREE_MOST_STRESSES 3
#define TREE_SAME R(0.01)     /* of a change, squared */
#define TREE_FARTHEST R(1e12) /* of the change in one pass */
#define TREE_ALMOST (R(1e2) * TOLERANCE)

/* --------------------------------------------------------------------------------------- the search -- */

/* Contacts and elements that hold each other with many times the free motion would drown the speeds in rounding. */
RARE void tree_forget_stress(tree_problem *p) {
    const real most = MOST_STRESS * p->scale;
    for (int32_t i = 0; i < p->contact_count; i++) {
        real *q = p->contact[i].impulse;
        if ((q[0] * q[0] + q[1] * q[1]) * p->contact[i].mobility > most) q[0] = q[1] = R(0);
    }
    for (int32_t i = 0; i < p->bundle_count; i++) {
        const tree_bundle *b = &p->bundle[i];
        for (tree_element *e = b->first; e < b->end; e++)
            if (e->q * e->q * b->mobility > most) e->q = R(0);
    }
}

void laconic_tree_follow(tree_problem *p) {
    p->nu = p->free;
    laconic_tree_take_forces(&p->nu, p);
    laconic_tree_look(p);
    for (int32_t i = 0; i < p->contact_count; i++) {
        tree_contact *c = &p->contact[i];
        const real push = c->push + c->wheel->rim[0] * c->impulse[0] + c->wheel->rim[1] * c->impulse[1];
        c->speed = turning_of(c->wheel->inertia_kgm2, &c->load, R(0), c->load.axle, push).speed;
    }
}

static void tree_rest(tree_problem *p) {
    p->nu.base = none;
    for (int32_t j = 0; j < p->m->body_count; j++) p->nu.hinge[j] = R(0);
    for (int32_t i = 0; i < p->contact_count; i++) p->contact[i].speed = R(0);
    laconic_tree_look(p);
}

RARE void tree_snap_slow(tree_problem *p, real most) {
    real energy = tree_square(&p->nu, p->m->body_count);
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        energy += c->wheel->inertia_kgm2 * c->speed * c->speed;
    }
    if (energy <= most) tree_rest(p);
}

static void tree_snap(tree_problem *p) {
    const real most = SNAP * SNAP * p->scale;
    if (square(p->nu.base) <= most) tree_snap_slow(p, most);
}

static real tree_imbalance_square(const tree_problem *p) {
    tree_vector rest;
    laconic_tree_imbalance(&rest, p);
    return tree_square(&rest, p->m->body_count);
}

static bool tree_is_solved(const tree_problem *p, real residual, real times) {
    const real most = times * TOLERANCE * TOLERANCE * p->scale;
    return residual <= most && residual + tree_imbalance_square(p) <= most;
}

/* All that rounding leaves to find. */
static bool tree_is_resolved(tree_problem *p) {
    real stress = R(0), residual = laconic_tree_see(p);
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        stress += (c->impulse[0] * c->impulse[0] + c->impulse[1] * c->impulse[1]) * c->mobility;
        residual -= c->sight.firm;
    }
    for (int32_t i = 0; i < p->bundle_count; i++)
        for (const tree_element *e = p->bundle[i].first; e < p->bundle[i].end; e++)
            stress += e->q * e->q * p->bundle[i].mobility;
    return residual + tree_imbalance_square(p) <= RESOLVED * RESOLVED * p->scale + ROUNDED * ROUNDED * stress;
}

typedef struct tree_kept {
    tree_vector nu;
    real speed[TREE_WHEELS], impulse[TREE_WHEELS][2], q[TREE_ELEMENTS];
} tree_kept;

static void tree_keep(tree_kept *kept, const tree_problem *p) {
    kept->nu = p->nu;
    for (int32_t i = 0; i < p->contact_count; i++) {
        kept->speed[i] = p->contact[i].speed;
        for (int m = 0; m < 2; m++) kept->impulse[i][m] = p->contact[i].impulse[m];
    }
    for (int32_t i = 0; i < p->element_count; i++) kept->q[i] = p->element[i].q;
}

static void tree_go_back(tree_problem *p, const tree_kept *kept) {
    p->nu = kept->nu;
    for (int32_t i = 0; i < p->contact_count; i++) {
        p->contact[i].speed = kept->speed[i];
        for (int m = 0; m < 2; m++) p->contact[i].impulse[m] = kept->impulse[i][m];
    }
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q = kept->q[i];
    laconic_tree_look(p);
}

/* How far the contact's impulse can grow by such a change until it is at the border of its grip. */
static real tree_reach(const tree_contact *c, const real change[2]) {
    const real *p = c->impulse, a = change[0] * change[0] + change[1] * change[1];
    const real b = p[0] * change[0] + p[1] * change[1];
    const real left = c->load.grip * c->load.grip - (p[0] * p[0] + p[1] * p[1]), root = b * b + a * left;
    return a > R(0) && left > R(0) && root > R(0) ? left / (b + quick_root(root)) : LACONIC_REAL_MAX;
}

static real tree_element_reach(const tree_element *e, real change) {
    if (change > R(0) && e->high < LACONIC_REAL_MAX) return (e->high - e->q) / change;
    if (change < R(0) && e->low > -LACONIC_REAL_MAX) return (e->low - e->q) / change;
    return LACONIC_REAL_MAX;
}

/* The square of the change of impulses and q between two passes, less `share` of another change. */
static real tree_change(const tree_problem *p, const tree_kept *from, const tree_kept *to, const tree_kept *less,
                        real share) {
    real sum = R(0);
    for (int32_t i = 0; i < p->contact_count; i++)
        for (int m = 0; m < 2; m++) {
            const real was = from->impulse[i][m] - less->impulse[i][m];
            const real off = to->impulse[i][m] - from->impulse[i][m] - share * was;
            sum += off * off * p->contact[i].mobility;
        }
    for (int32_t i = 0; i < p->bundle_count; i++)
        for (const tree_element *e = p->bundle[i].first; e < p->bundle[i].end; e++) {
            const int32_t j = (int32_t)(e - p->element);
            const real off = to->q[j] - from->q[j] - share * (from->q[j] - less->q[j]);
            sum += off * off * p->bundle[i].mobility;
        }
    return sum;
}

/* How often the last change can be added until something is at its bound. */
static real tree_least_reach(const tree_problem *p, const tree_kept *before) {
    real reach = LACONIC_REAL_MAX;
    for (int32_t i = 0; i < p->contact_count; i++) {
        const tree_contact *c = &p->contact[i];
        const real change[2] = {c->impulse[0] - before->impulse[i][0], c->impulse[1] - before->impulse[i][1]};
        const real here = c->sight.length > R(0) ? LACONIC_REAL_MAX : tree_reach(c, change);
        if (here < reach) reach = here;
    }
    for (int32_t i = 0; i < p->element_count; i++) {
        const tree_element *e = &p->element[i];
        if (!(e->law_stiffness > R(0))) continue;
        const real here = tree_element_reach(e, e->q - before->q[i]);
        if (here < reach) reach = here;
    }
    return reach;
}

/* Contacts and elements that all stick may ask for more than any motion fulfils, by as little as two casters that are
 * not quite in line. Each pass then stresses them against each other by as little more, until the weakest slips: far
 * too many passes. Goes there at once, along the change of a pass, if that of the next is the same: rounding errors
 * would stress them in vain. Returns false where nothing gives way. */
RARE bool tree_stress_to_slip(tree_problem *p, int32_t *passes) {
    tree_kept first, second, now;
    tree_keep(&first, p);
    laconic_tree_exact_pass(p);
    tree_keep(&second, p);
    (void)laconic_tree_see(p);
    laconic_tree_exact_pass(p);
    tree_keep(&now, p);
    *passes += 2;
    if (tree_change(p, &second, &now, &first, R(1)) > TREE_SAME * tree_change(p, &second, &now, &first, R(0)))
        return false;
    const real reach = tree_least_reach(p, &second);
    if (!(reach < TREE_FARTHEST)) return false;
    for (int32_t i = 0; i < p->contact_count; i++)
        for (int m = 0; m < 2; m++)
            p->contact[i].impulse[m] += reach * (p->contact[i].impulse[m] - second.impulse[i][m]);
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q += reach * (p->element[i].q - second.q[i]);
    return true;
}

static bool tree_pass_exactly(tree_problem *p, int32_t most, int32_t *passes) {
    real before = LACONIC_REAL_MAX;
    int32_t stresses = 0;
    for (int32_t pass = 0;; pass++) {
        const real residual = laconic_tree_see(p);
        ++*passes;
        if (tree_is_solved(p, residual, R(1))) return true;
        const bool stalls = pass > 1 && residual > WORTH_IT * before;
        if (stalls && tree_is_solved(p, residual, TREE_NEARLY)) return true;
        before = residual;
        if (stalls && stresses < TREE_MOST_STRESSES && residual <= TREE_ALMOST * TREE_ALMOST * p->scale &&
            tree_stress_to_slip(p, passes)) {
            stresses++;
            pass = 0;
            continue;
        }
        if (pass == most || stalls) return false;
        laconic_tree_exact_pass(p);
    }
}

/* Passes along the central path, and from time to time exact ones: they finish at once where they converge. */
RARE bool tree_search_along_path(tree_problem *p, int32_t *passes) {
    tree_path path;
    tree_kept kept;
    laconic_tree_stiffen(p, PENALTY); /* rounding: contacts that hold each other may need it */
    laconic_tree_start_path(p, &path);
    for (int32_t ahead = FIRST_AHEAD; *passes + ahead + TRIED + 1 <= FRICTION_MOST_PASSES; ahead = AHEAD) {
        for (int32_t pass = 0; pass < ahead; pass++) laconic_tree_follow_path(p, &path);
        *passes += ahead;
        tree_keep(&kept, p);
        if (tree_pass_exactly(p, TRIED, passes)) return true;
        if (ahead == AHEAD && tree_is_solved(p, laconic_tree_see(p), CLOSE)) return true;
        tree_go_back(p, &kept);
        if (ahead == AHEAD && tree_is_resolved(p)) return true;
    }
    return false;
}

/* Nothing moves and nothing drives it: no forces, either. */
RARE int32_t tree_nothing(tree_problem *p) {
    tree_rest(p);
    for (int32_t i = 0; i < p->contact_count; i++) p->contact[i].impulse[0] = p->contact[i].impulse[1] = R(0);
    for (int32_t i = 0; i < p->element_count; i++) p->element[i].q = R(0);
    return 1;
}

int32_t laconic_tree_solve(tree_problem *p) {
    int32_t passes = 0;
    if (!is_finite(p->scale)) return 0;
    if (p->scale < SMALLEST_ENERGY) return tree_nothing(p);
    if (p->stress > MOST_STRESS * p->scale) tree_forget_stress(p);
    laconic_tree_follow(p);
    if (!tree_pass_exactly(p, EXACT_PASSES, &passes) && !tree_search_along_path(p, &passes)) return 0;
    tree_snap(p);
    return passes;
}

#endif
