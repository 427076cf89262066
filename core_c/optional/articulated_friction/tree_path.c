/* The problem of a tree with its corners rounded: friction_smooth.c, which derives it, with rows along the paths of the
 * tree and with elements. Dry elements are as axles there; servos and motors of hinges have their compliance in series;
 * a stop's q is (t + √(t² + 4 softness/W))/2 with t = q + (x − target)/W, which tends to the larger of t and 0. */
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define TREE_FIRST_SOFTNESS R(1e-5)
#define TREE_FALL_NEAR R(0.01)
#define TREE_FALL_ASIDE R(0.05)
#define TREE_FALL_FAR R(0.3)
#define TREE_CLOSE_BY R(0.0625)
#ifdef LACONIC_SINGLE
#define TREE_STIFFEST R(1e7)
#define TREE_LEAST_SOFTNESS R(1e-14)
#define TREE_LEAST_GAP R(1e-6)
#else
#define TREE_STIFFEST R(1e14)
#define TREE_LEAST_SOFTNESS R(1e-24)
#define TREE_LEAST_GAP R(1e-14)
#endif

/* What a pass needs of a wheel besides its law. */
typedef struct tree_soft {
    real xx, xy, yy, impulse[2], axle, axle_growth, motor, motor_fall, excess, turn[2];
} tree_soft;

RARE real tree_root_of(real x) { return quick_root(x); }

RARE real tree_tau(const tree_path *path, real bound, real mass) {
    const real wanted = path->softness / (bound + path->softness / path->fastest);
    const real least = bound / (TREE_STIFFEST * mass);
    return wanted > least ? wanted : least;
}

static void tree_fall_by(real *fall, real off_square, real bound) {
    const real now = off_square > bound * bound                   ? TREE_FALL_FAR
                     : off_square > TREE_CLOSE_BY * bound * bound ? TREE_FALL_ASIDE
                                                                  : TREE_FALL_NEAR;
    if (now > *fall) *fall = now;
}

RARE void tree_soften_contact(tree_soft *restrict s, real *fall, const tree_contact *c, const real slip[2],
                              const tree_path *path) {
    const real grip = c->load.grip, *p = c->impulse;
    const real tau = tree_tau(path, grip, c->lateral_mass > R(0) ? c->lateral_mass : c->row_mass[0]);
    const real size = tree_root_of(slip[0] * slip[0] + slip[1] * slip[1] + tau * tau);
    const real x = slip[0] / size, y = slip[1] / size, off[2] = {p[0] - grip * x, p[1] - grip * y};
    s->xx = (grip - p[0] * x) / size;
    s->yy = (grip - p[1] * y) / size;
    s->xy = R(-0.5) * (p[0] * y + p[1] * x) / size;
    s->impulse[0] = grip * x;
    s->impulse[1] = grip * y;
    tree_fall_by(fall, off[0] * off[0] + off[1] * off[1], grip);
}

/* A compliance in series, whose slip is taken off before: impulse = (1 + creep H)⁻¹(impulse + creep H p), and H in the
 * same way. */
static void tree_soften_creep(tree_soft *restrict s, const tree_contact *c) {
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

RARE real tree_dry(real *growth, real *fall, real bound, real speed, real now, real tau) {
    const real size = tree_root_of(speed * speed + tau * tau), x = speed / size, impulse = bound * x;
    *growth = (bound - now * x) / size;
    tree_fall_by(fall, (now - impulse) * (now - impulse), bound);
    return impulse;
}

static void tree_soften_motor(tree_soft *restrict s, real *fall, const friction_load *l, real speed, real now,
                              const tree_path *path) {
    s->motor = drive_at(l, speed);
    s->motor_fall = l->drive_slope;
    if (l->drive_slope > R(0) && l->drive_limit < LACONIC_REAL_MAX) {
        const real left = (l->drive - l->drive_slope * speed - now) / l->drive_slope;
        real growth;
        const real limited =
            tree_dry(&growth, fall, l->drive_limit, left, now, tree_tau(path, l->drive_limit, l->drive_slope));
        const real share = l->drive_slope / (l->drive_slope + growth);
        s->motor = now + share * (limited - now);
        s->motor_fall = share * growth;
    }
}

/* Takes the wheel's speed out: S = H − H rim rimᵀ H/all, written so that nothing cancels. */
static void tree_take_out_speed(tree_law *law, tree_soft *restrict s, const tree_contact *c) {
    const friction_load *l = &c->load;
    const real *rim = c->wheel->rim, inertia = c->wheel->inertia_kgm2;
    const real own = inertia + l->viscous + s->motor_fall + s->axle_growth, area = s->xx * s->yy - s->xy * s->xy;
    const real lateral = area > R(0) ? area : R(0);
    const real x = s->xx * rim[0] + s->xy * rim[1], y = s->xy * rim[0] + s->yy * rim[1];
    const real all = own + rim[0] * x + rim[1] * y;
    law->xx = (own * s->xx + lateral * rim[1] * rim[1]) / all;
    law->xy = (own * s->xy - lateral * rim[0] * rim[1]) / all;
    law->yy = (own * s->yy + lateral * rim[0] * rim[0]) / all;
    s->excess = (inertia * (l->free_speed - c->speed) - l->viscous * c->speed + s->motor - s->axle +
                 rim[0] * s->impulse[0] + rim[1] * s->impulse[1]) /
                all;
    s->turn[0] = x / all;
    s->turn[1] = y / all;
    law->impulse[0] = s->impulse[0] - x * s->excess;
    law->impulse[1] = s->impulse[1] - y * s->excess;
}

static void tree_soften_wheel(tree_law *law, tree_soft *restrict s, real *fall, const tree_problem *p, int32_t i,
                              const tree_path *path) {
    const tree_contact *c = &p->contact[i];
    const real *rim = c->wheel->rim, size = c->wheel->rim_size;
    const real slip[2] = {tree_dot(&c->row[0], c->on, &p->nu, false) - rim[0] * c->speed - c->creep * c->impulse[0],
                          tree_dot(&c->row[1], c->on, &p->nu, false) - rim[1] * c->speed - c->creep * c->impulse[1]};
    s->xx = s->xy = s->yy = s->impulse[0] = s->impulse[1] = s->axle = s->axle_growth = R(0);
    if (c->load.grip > R(0)) tree_soften_contact(s, fall, c, slip, path);
    if (c->load.grip > R(0) && c->creep > R(0)) tree_soften_creep(s, c);
    if (c->load.axle > R(0))
        s->axle = tree_dry(&s->axle_growth, fall, c->load.axle, c->speed, path->axle[i],
                           tree_tau(path, c->load.axle, c->wheel->inertia_kgm2 + size * size));
    tree_soften_motor(s, fall, &c->load, c->speed, path->motor[i], path);
    tree_take_out_speed(law, s, c);
}

/* A stop, by Newton's method on q as an unknown of its own. */
static void tree_soften_stop(tree_element_law *law, real *fall, const tree_element *e, real away,
                             const tree_path *path) {
    const real sign = e->high >= LACONIC_REAL_MAX ? R(1) : R(-1), q = sign * e->q;
    const real t = q + sign * away / e->mobility;
    const real root = tree_root_of(t * t + R(4) * path->softness / e->mobility), slope = R(0.5) * (R(1) + t / root);
    const real off = q - R(0.5) * (t + root), left = R(1) - slope;
    const real gap = left > TREE_LEAST_GAP ? left : TREE_LEAST_GAP;
    const real stiffness = slope / (e->mobility * gap), most = TREE_STIFFEST / e->mobility;
    law->q = sign * (q - off / gap);
    law->stiffness = stiffness < most ? stiffness : most;
    tree_fall_by(fall, off * off * e->mobility, tree_root_of(path->softness));
}

static void tree_soften_element(tree_element_law *law, real *fall, const tree_element *e, const tree_vector *nu,
                                const tree_path *path) {
    const real away = tree_dot(e->row, e->on, nu, false) - e->target;
    if (tree_unbounded(e)) {
        const real penalty = PENALTY / e->mobility, soft = R(1) + penalty * e->compliance;
        law->stiffness = penalty / soft;
        law->q = (e->q + penalty * away) / soft;
    } else if (tree_one_sided(e)) {
        tree_soften_stop(law, fall, e, away, path);
    } else if (e->high > R(0)) {
        real growth;
        const real tau = tree_tau(path, e->high, R(1) / (e->mobility + e->compliance));
        const real q = tree_dry(&growth, fall, e->high, away - e->compliance * e->q, e->q, tau);
        const real share = R(1) / (R(1) + growth * e->compliance);
        law->q = e->q + share * (q - e->q);
        law->stiffness = growth * share;
    } else {
        law->q = law->stiffness = R(0);
    }
}

RARE void tree_put_inside(real p[2], real grip) {
    const real size = p[0] * p[0] + p[1] * p[1];
    if (size > grip * grip) {
        const real by = grip / tree_root_of(size);
        p[0] *= by;
        p[1] *= by;
    }
}

static void tree_move_softly(tree_contact *c, const tree_soft *s, tree_path *path, int32_t i, const tree_vector *by) {
    const real x = tree_dot(&c->row[0], c->on, by, false), y = tree_dot(&c->row[1], c->on, by, false);
    const real turned = s->excess + s->turn[0] * x + s->turn[1] * y;
    const real slip[2] = {x - c->wheel->rim[0] * turned, y - c->wheel->rim[1] * turned};
    c->speed += turned;
    c->impulse[0] = s->impulse[0] + s->xx * slip[0] + s->xy * slip[1];
    c->impulse[1] = s->impulse[1] + s->xy * slip[0] + s->yy * slip[1];
    tree_put_inside(c->impulse, c->load.grip);
    path->axle[i] = cut(s->axle + s->axle_growth * turned, c->load.axle);
    path->motor[i] = cut(s->motor - s->motor_fall * turned, c->load.drive_limit);
}

void laconic_tree_follow_path(tree_problem *p, tree_path *path) {
    tree_soft wheels[TREE_WHEELS];
    tree_law laws[TREE_WHEELS];
    tree_element_law elements[TREE_ELEMENTS];
    tree_vector by;
    const real least = TREE_LEAST_SOFTNESS * p->scale;
    real fall = TREE_FALL_NEAR;
    for (int32_t i = 0; i < p->contact_count; i++) tree_soften_wheel(&laws[i], &wheels[i], &fall, p, i, path);
    for (int32_t i = 0; i < p->element_count; i++)
        tree_soften_element(&elements[i], &fall, &p->element[i], &p->nu, path);
    laconic_tree_move(p, laws, elements, &by);
    for (int32_t i = 0; i < p->contact_count; i++) tree_move_softly(&p->contact[i], &wheels[i], path, i, &by);
    for (int32_t i = 0; i < p->element_count; i++) {
        tree_element *e = &p->element[i];
        e->q = tree_boxed(elements[i].q + elements[i].stiffness * tree_dot(e->row, e->on, &by, false), e->low, e->high);
    }
    path->softness *= fall;
    if (path->softness < least) path->softness = least;
}

void laconic_tree_start_path(tree_problem *p, tree_path *path) {
    path->fastest = tree_root_of(p->scale);
    path->softness = TREE_FIRST_SOFTNESS * p->scale;
    for (int32_t i = 0; i < p->contact_count; i++) tree_put_inside(p->contact[i].impulse, p->contact[i].load.grip);
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
