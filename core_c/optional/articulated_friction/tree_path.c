/* The problem of a tree with its corners rounded: friction_smooth.c, which derives it, with rows along the paths of the
 * tree and with elements. Dry elements are as axles there; servos and motors of hinges have their compliance in series;
 * a stop's q is (t + √(t² + 4 softness/W))/2 with t = q + (x − target)/W, which tends to the larger of t and 0. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION
#include "friction_smooth.h"

/* The least that is left of 1 − dq/dt where a stop holds. */
#ifdef LACONIC_SINGLE
#define TREE_LEAST_GAP R(1e-6)
#else
#define TREE_LEAST_GAP R(1e-14)
#endif

/* A compliance in series, whose slip is taken off before: impulse = (1 + creep H)⁻¹(impulse + creep H p), and H in the
 * same way. */
static void tree_soften_creep(soft_wheel *restrict s, const tree_contact *c) {
    const real a = c->creep, *p = c->impulse, area = s->xx * s->yy - s->xy * s->xy, det = area > R(0) ? area : R(0);
    const real whole = R(1) + a * (s->xx + s->yy) + a * a * det;
    const real x = s->impulse[0] + a * (s->xx * p[0] + s->xy * p[1]);
    const real y = s->impulse[1] + a * (s->xy * p[0] + s->yy * p[1]);
    s->impulse[0] = ((R(1) + a * s->yy) * x - a * s->xy * y) / whole;
    s->impulse[1] = ((R(1) + a * s->xx) * y - a * s->xy * x) / whole;
    s->xx = (s->xx + a * det) / whole;
    s->yy = (s->yy + a * det) / whole;
    s->xy = s->xy / whole;
}

static void tree_soften_wheel(soft_wheel *restrict s, real *fall, tree_problem *p, int32_t i, const tree_path *path) {
    tree_contact *c = &p->contact[i];
    const real *rim = c->wheel->rim, size = c->wheel->rim_size;
    const real slip[2] = {c->moved[0] - rim[0] * c->speed - c->creep * c->impulse[0],
                          c->moved[1] - rim[1] * c->speed - c->creep * c->impulse[1]};
    const real speed = c->speed, inertia = c->wheel->inertia_kgm2;
    s->xx = s->xy = s->yy = s->impulse[0] = s->impulse[1] = s->axle = s->axle_growth = R(0);
    if (c->load.grip > R(0))
        soften_grip(s, fall, c->load.grip, c->lateral_mass > R(0) ? c->lateral_mass : c->row_mass[0], slip, c->impulse,
                    path);
    if (c->load.grip > R(0) && c->creep > R(0)) tree_soften_creep(s, c);
    if (c->load.axle > R(0))
        s->axle = dry_impulse(&s->axle_growth, fall, c->load.axle, speed, path->axle[i],
                              tau_of(path, c->load.axle, inertia + size * size));
    soften_motor(s, fall, &c->load, speed, path->motor[i], path);
    const soft_law g = without_speed(s, rim, inertia, &c->load, speed);
    laconic_tree_split(&c->law, g.xx, g.xy, g.yy);
    c->law.impulse[0] = g.impulse[0];
    c->law.impulse[1] = g.impulse[1];
}

/* A stop, by Newton's method on q as an unknown of its own. */
static void tree_soften_stop(tree_element *e, real *fall, real mobility, real away, const tree_path *path) {
    const real sign = e->high >= LACONIC_REAL_MAX ? R(1) : R(-1), q = sign * e->q;
    const real t = q + sign * away / mobility;
    const real root = root_of(t * t + R(4) * path->softness / mobility), slope = R(0.5) * (R(1) + t / root);
    const real off = q - R(0.5) * (t + root), left = R(1) - slope;
    const real gap = left > TREE_LEAST_GAP ? left : TREE_LEAST_GAP;
    const real stiffness = slope / (mobility * gap), most = STIFFEST / mobility;
    e->law_q = sign * (q - off / gap);
    e->law_stiffness = stiffness < most ? stiffness : most;
    fall_by(fall, off * off * mobility, root_of(path->softness));
}

static void tree_soften_element(tree_element *e, real *fall, const tree_bundle *b, const tree_path *path) {
    const real away = b->moved - e->target;
    if (tree_unbounded(e)) {
        const real penalty = PENALTY / b->mobility, soft = R(1) + penalty * e->compliance;
        e->law_stiffness = penalty / soft;
        e->law_q = (e->q + penalty * away) / soft;
    } else if (tree_one_sided(e)) {
        tree_soften_stop(e, fall, b->mobility, away, path);
    } else if (e->high > R(0)) {
        real growth;
        const real tau = tau_of(path, e->high, R(1) / e->all);
        const real q = dry_impulse(&growth, fall, e->high, away - e->compliance * e->q, e->q, tau);
        const real share = R(1) / (R(1) + growth * e->compliance);
        e->law_q = e->q + share * (q - e->q);
        e->law_stiffness = growth * share;
    } else {
        e->law_q = e->law_stiffness = R(0);
    }
}

void laconic_tree_follow_path(tree_problem *p, tree_path *path) {
    soft_wheel wheels[TREE_WHEELS];
    const real least = LEAST_SOFTNESS * p->scale;
    real fall = FALL_NEAR;
    for (int32_t i = 0; i < p->contact_count; i++) tree_soften_wheel(&wheels[i], &fall, p, i, path);
    for (int32_t i = 0; i < p->bundle_count; i++) {
        const tree_bundle *b = &p->bundle[i];
        for (tree_element *e = b->first; e < b->end; e++) tree_soften_element(e, &fall, b, path);
    }
    laconic_tree_move(p);
    for (int32_t i = 0; i < p->contact_count; i++) {
        tree_contact *c = &p->contact[i];
        move_softly(&wheels[i], c->law.slip[0], c->law.slip[1], c->wheel->rim, &c->load, &c->speed, c->impulse, path,
                    i);
    }
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        e->q = tree_boxed(e->q, e->low, e->high);
    }
    path->softness *= fall;
    if (path->softness < least) path->softness = least;
}

void laconic_tree_start_path(tree_problem *p, tree_path *path) {
    path->fastest = root_of(p->scale);
    path->softness = FIRST_SOFTNESS * p->scale;
    for (int32_t i = 0; i < p->contact_count; i++) put_inside(p->contact[i].impulse, p->contact[i].load.grip);
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        e->q = tree_boxed(e->q, e->low, e->high);
    }
    laconic_tree_follow(p);
    for (int32_t i = 0; i < p->contact_count; i++) {
        path->axle[i] = R(0);
        path->motor[i] = drive_at(&p->contact[i].load, p->contact[i].speed);
    }
}

#endif
