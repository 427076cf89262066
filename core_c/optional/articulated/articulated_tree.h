/* What the methods for articulated vehicles share: twists along the tree from root to leaf, forces and inertias from leaf
 * to root, and the equations of motion in η. All of it is inlined into each method.
 *
 * A covector is a force with its moment about a body's origin. The twist of a child is X_b = T_b X_p (+ its own ω, or + a
 * prescribed rate), so a covector of the child counts at the parent as T_bᵀ times it, and an inertia as T_bᵀ A T_b. With
 * the bodies in order of their numbers one pass inwards sums all of it at the root: work grows with H, not with H k². Only
 * own hinges and rows left over travel as covectors of their own. */
#ifndef LACONIC_ARTICULATED_TREE_H
#define LACONIC_ARTICULATED_TREE_H

#include "heading.h"
#include "laconic/articulated.h"
#include "vector.h"

#if LACONIC_MAX_BODIES > 0

#define BODIES (LACONIC_MAX_BODIES + 1)

/* Beyond it squares would leave the range within a few steps. No vehicle is as fast. */
#ifdef LACONIC_SINGLE
#define LARGEST_ETA R(1e9)
#else
#define LARGEST_ETA R(1e77)
#endif

/* ------------------------------------------------------------ what is commanded, at one moment -- */

typedef struct articulated_drive {
    vector force[BODIES];              /* of motors, and on body 0 of the input's wrench; own axes */
    real torque[LACONIC_MAX_BODIES];   /* of free and motor hinges without damping and spring      */
    real rate[LACONIC_MAX_BODIES];     /* r of prescribed hinges                                   */
    real acceleration[LACONIC_MAX_BODIES];
    vector twist[3];                   /* T, T', T'' of S_0                                        */
    real world_force[2], world_force_point[2];
    bool rotates;                      /* a force fixed in the world acts                          */
} articulated_drive;

/* ------------------------------------------------------------------------ the posture and its sweep -- */

typedef struct articulated_sweep {
    vector twist[BODIES];    /* X_b          */
    vector bias[BODIES];     /* γ_b          */
    real rate[LACONIC_MAX_BODIES];           /* ψ_b' */
    direction toward[LACONIC_MAX_BODIES];    /* (cos ψ, sin ψ) */
    real angle_rad[LACONIC_MAX_BODIES];      /* ψ less its rest, only of hinges with a spring */
    vector force[BODIES];        /* what acts at the body and beyond, less I_b γ_b */
    laconic_form inertia[BODIES]; /* of the body and what follows it                */
    vector own[LACONIC_MAX_BODIES];               /* momentum that 1 rad/s of own hinge k has, seen at one body */
    vector row[LACONIC_MAX_LEFT_ROWS];            /* left row, seen at one body                                 */
    real row_of_own[LACONIC_MAX_LEFT_ROWS][LACONIC_MAX_BODIES];
    real row_bias[LACONIC_MAX_LEFT_ROWS], row_value[LACONIC_MAX_LEFT_ROWS];
    vector along[1];                              /* T/|T| in the metric of body 0, where it is commanded       */
    vector along_rate;
    real mass[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES]; /* lower half                                     */
    real push[LACONIC_MAX_VELOCITIES];                         /* right side                                     */
    real left[LACONIC_MAX_LEFT_ROWS][LACONIC_MAX_VELOCITIES];  /* C                                              */
} articulated_sweep;

static inline vector form_times(const laconic_form *f, vector v) {
    return vector_of(f->xx * v.x + f->xy * v.y + f->xw * v.z, f->xy * v.x + f->yy * v.y + f->yw * v.z,
                     f->xw * v.x + f->yw * v.y + f->ww * v.z);
}

/* The parent's twist at the hinge, in the child's axes. */
static inline vector carried(const laconic_link *link, direction d, vector parent) {
    const real x = parent.x - parent.z * link->hinge.y, y = parent.y + parent.z * link->hinge.x;
    return vector_of(d.cosine * x + d.sine * y, d.cosine * y - d.sine * x, parent.z);
}

/* −n·V/ℓ */
static inline real following_rate(const laconic_link *link, vector v) {
    return -(link->axle_per_lever.x * v.x + link->axle_per_lever.y * v.y);
}

/* The commanded motion of the carriage: U = T/|T|, U', where |T|² = T·I₀T. False where T is 0. */
bool laconic_articulated_unit_twist(vector *unit, vector *unit_rate, const laconic_articulated_model *m,
                                    const articulated_drive *drive);

/* One coordinated hinge: direction, ψ' and ψ'' of w = T_v + i T_θ h. False where w is 0. */
bool laconic_articulated_coordinate(direction *d, real *rate, real *acceleration, const laconic_link *link,
                                    const vector twist[3]);

/* --------------------------------------------------------------------------------- root to leaf -- */

static inline real own_rate(const laconic_articulated_model *m, const laconic_link *link, const real *eta) {
    return eta[m->carriage_dof + link->column];
}

/* Twist and γ of one child. `acceleration`: ψ'' as far as it is commanded. */
INLINE void sweep_child(articulated_sweep *s, const laconic_articulated_model *m, int32_t b, const real *eta,
                        real commanded_rate, real acceleration) {
    const laconic_link *link = &m->link[b - 1];
    const direction d = s->toward[b - 1];
    vector v = carried(link, d, s->twist[link->parent]), g = carried(link, d, s->bias[link->parent]);
    const real parent_rate = v.z;
    if (link->motion == LACONIC_MOTION_FOLLOWING)
        v.z = following_rate(link, v);
    else if (link->motion == LACONIC_MOTION_OWN)
        v.z = own_rate(m, link, eta);
    else
        v.z += commanded_rate;
    const real rate = v.z - parent_rate;
    g.x += rate * v.y;
    g.y -= rate * v.x;
    if (link->motion == LACONIC_MOTION_FOLLOWING)
        g.z = following_rate(link, g);
    else if (link->motion == LACONIC_MOTION_OWN)
        g.z = R(0);
    else
        g.z += acceleration;
    s->twist[b] = v;
    s->bias[b] = g;
    s->rate[b - 1] = rate;
}

INLINE void sweep_root(articulated_sweep *s, const laconic_articulated_model *m, const real *eta) {
    if (m->coordinated) {
        s->twist[0] = scaled(eta[0], s->along[0]);
        s->bias[0] = scaled(eta[0], s->along_rate);
        return;
    }
    vector v = scaled(eta[0], m->column[0]);
    if (m->carriage_dof > 1) v = plus(v, scaled(eta[1], m->column[1]));
    if (m->carriage_dof > 2) v = plus(v, scaled(eta[2], m->column[2]));
    s->twist[0] = v;
    s->bias[0] = none;
}

/* All twists, at directions that are set for all but coordinated hinges. Returns the number of the coordinated hinge
 * whose w is 0, −1 where T is 0, else 0. */
INLINE int32_t sweep_outward(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                             const articulated_drive *drive) {
    if (m->coordinated && !laconic_articulated_unit_twist(&s->along[0], &s->along_rate, m, drive)) return -1;
    sweep_root(s, m, eta);
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        real rate = drive->rate[b - 1], acceleration = drive->acceleration[b - 1];
        if (link->motion == LACONIC_MOTION_COORDINATED &&
            !laconic_articulated_coordinate(&s->toward[b - 1], &rate, &acceleration, link, drive->twist))
            return b;
        sweep_child(s, m, b, eta, rate, acceleration);
    }
    return 0;
}

/* ------------------------------------------------------------------------------ forces of a posture -- */

/* a(X): m(−iωV + ω² s), −ω m s·V. */
static inline vector gyroscopic(vector first_moment, vector v) {
    const real w = v.z, mass = first_moment.z;
    return vector_of(w * (mass * v.y + w * first_moment.x), w * (w * first_moment.y - mass * v.x),
                     -w * (first_moment.x * v.x + first_moment.y * v.y));
}

static inline real hinge_torque(const laconic_link *link, const articulated_drive *drive, const articulated_sweep *s,
                                int32_t b) {
    return drive->torque[b - 1] - link->damping_Nms * s->rate[b - 1] - link->stiffness_Nm * s->angle_rad[b - 1];
}

/* What acts on one body, less I_b γ_b. */
INLINE vector load_of(const laconic_link *link, const articulated_drive *drive, const articulated_sweep *s, int32_t b) {
    vector w = minus(plus(gyroscopic(link->first_moment, s->twist[b]), drive->force[b]),
                     form_times(&link->inertia, s->bias[b]));
    if (LACONIC_WITH_DAMPING && link->drags) w = minus(w, form_times(&link->drag, s->twist[b]));
    return w;
}

/* A force fixed in the world on body 0, and the slope's pull on each body; `heading` of body 0. */
void laconic_articulated_add_world(articulated_sweep *s, const laconic_articulated_model *m,
                                   const articulated_drive *drive, direction heading);

/* Loads of all bodies; those of body 0 without I_0 and D_0, which ζ has as 1 and r, but for a commanded twist. */
INLINE void sweep_loads(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive) {
    const vector still = {R(0), R(0), m->mass_kg};
    s->force[0] = plus(gyroscopic(still, s->twist[0]), drive->force[0]);
    if (m->coordinated)
        s->force[0] = minus(s->force[0], plus(form_times(&m->inertia, s->bias[0]), form_times(&m->drag, s->twist[0])));
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        s->force[b] = load_of(link, drive, s, b);
        if (link->motion <= LACONIC_MOTION_OWN) {
            const real torque = hinge_torque(link, drive, s, b);
            s->force[b].z += torque;
            s->force[link->parent].z -= torque;
        }
    }
}

/* --------------------------------------------------------------------------------- leaf to root -- */

static inline vector turned(direction d, real x, real y) {
    return vector_of(d.cosine * x - d.sine * y, d.sine * x + d.cosine * y, R(0));
}

/* T_bᵀ c: a covector of a body as it counts at the parent. Its share in an own ω is c.z. */
INLINE vector pulled(const laconic_link *link, direction d, vector c) {
    const bool follows = link->motion == LACONIC_MOTION_FOLLOWING;
    const real x = follows ? c.x - link->axle_per_lever.x * c.z : c.x;
    const real y = follows ? c.y - link->axle_per_lever.y * c.z : c.y;
    vector p = turned(d, x, y);
    p.z = link->hinge.x * p.y - link->hinge.y * p.x;
    if (link->motion >= LACONIC_MOTION_PRESCRIBED) p.z += c.z;
    return p;
}

/* Adds T_bᵀ A T_b to the parent's inertia: the part on V turns by 2ψ, b (between V and ω) by ψ. */
INLINE void pull_inertia(laconic_form *parent, const laconic_link *link, direction d, const laconic_form *a) {
    real xx = a->xx, xy = a->xy, yy = a->yy;
    if (link->motion == LACONIC_MOTION_FOLLOWING) {
        const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
        const real ux = a->xw - R(0.5) * mx * a->ww, uy = a->yw - R(0.5) * my * a->ww;
        xx -= R(2) * mx * ux;
        yy -= R(2) * my * uy;
        xy -= mx * uy + my * ux;
    }
    const real mean = R(0.5) * (xx + yy), half = R(0.5) * (xx - yy);
    const real cosine = d.cosine * d.cosine - d.sine * d.sine, sine = R(2) * d.cosine * d.sine;
    const real turned_half = cosine * half - sine * xy, turned_xy = sine * half + cosine * xy;
    const real pxx = mean + turned_half, pyy = mean - turned_half;
    const real hx = link->hinge.x, hy = link->hinge.y;
    real bx = hx * turned_xy - hy * pxx, by = hx * pyy - hy * turned_xy;
    real ww = hx * by - hy * bx;
    if (link->motion >= LACONIC_MOTION_PRESCRIBED) {
        const vector w = turned(d, a->xw, a->yw);
        ww += R(2) * (hx * w.y - hy * w.x) + a->ww;
        bx += w.x;
        by += w.y;
    }
    parent->xx += pxx;
    parent->xy += turned_xy;
    parent->yy += pyy;
    parent->xw += bx;
    parent->yw += by;
    parent->ww += ww;
}

/* Own hinge b: its row of the equations, and its momentum, which travels on. */
static inline void meet_own(articulated_sweep *s, const laconic_articulated_model *m, int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    const int32_t k = link->column, i = m->carriage_dof + k;
    const laconic_form *a = &s->inertia[b];
    for (int32_t j = 0; j < m->own_count; j++) {
        if (j == k || (link->own_below >> j & 1U) == 0U) continue;
        const int32_t other = m->carriage_dof + j;
        s->mass[i > other ? i : other][i > other ? other : i] = s->own[j].z;
    }
    s->mass[i][i] = a->ww;
    s->push[i] = s->force[b].z;
    s->own[k] = vector_of(a->xw, a->yw, R(0));
    for (int32_t r = 0; r < m->row_count; r++)
        if (link->rows_below >> r & 1U) s->row_of_own[r][k] = s->row[r].z;
}

static inline void pull_others(articulated_sweep *s, const laconic_articulated_model *m, int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    const direction d = s->toward[b - 1];
    for (int32_t j = 0; j < m->own_count; j++)
        if (link->own_below >> j & 1U) s->own[j] = pulled(link, d, s->own[j]);
    for (int32_t r = 0; r < m->row_count; r++)
        if (link->rows_below >> r & 1U) s->row[r] = pulled(link, d, s->row[r]);
}

/* Makes mass and push entries between own hinges that are not on one path 0, and the rows those of their bodies. */
static inline void begin_inward(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t k = 0; k < m->own_count; k++)
        for (int32_t j = 0; j < k; j++) s->mass[m->carriage_dof + k][m->carriage_dof + j] = R(0);
    for (int32_t r = 0; r < m->row_count; r++) {
        const laconic_left_row *row = &m->row[r];
        s->row[r] = row->axle;
        s->row_bias[r] = dot(row->axle, s->bias[row->body]);
        s->row_value[r] = dot(row->axle, s->twist[row->body]);
        for (int32_t k = 0; k < m->own_count; k++) s->row_of_own[r][k] = R(0);
    }
}

/* Sums forces (and, if wanted, inertias) at the root. */
INLINE void sweep_inward(articulated_sweep *s, const laconic_articulated_model *m) {
    const laconic_form zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    const bool simple = m->own_count + m->row_count == 0;
    s->inertia[0] = zero;
    for (int32_t b = 1; b <= m->body_count; b++) s->inertia[b] = m->link[b - 1].inertia;
    if (!simple) begin_inward(s, m);
    for (int32_t b = m->body_count; b >= 1; b--) {
        const laconic_link *link = &m->link[b - 1];
        const direction d = s->toward[b - 1];
        if (!simple && link->motion == LACONIC_MOTION_OWN) meet_own(s, m, b);
        if (!simple) pull_others(s, m, b);
        pull_inertia(&s->inertia[link->parent], link, d, &s->inertia[b]);
        s->force[link->parent] = plus(s->force[link->parent], pulled(link, d, s->force[b]));
    }
}

/* The same for forces alone, where the inertias of the posture are known: push of own hinges, and the root's force. */
INLINE void sweep_forces_inward(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t b = m->body_count; b >= 1; b--) {
        const laconic_link *link = &m->link[b - 1];
        if (link->motion == LACONIC_MOTION_OWN) s->push[m->carriage_dof + link->column] = s->force[b].z;
        s->force[link->parent] = plus(s->force[link->parent], pulled(link, s->toward[b - 1], s->force[b]));
    }
}

/* ------------------------------------------------------------------------- the equations in η -- */

/* The columns that the carriage moves along: those of ζ, or the commanded twist alone. */
static inline const vector *carriage_columns(const articulated_sweep *s, const laconic_articulated_model *m) {
    return m->coordinated ? s->along : m->column;
}

/* Push of ζ from the force summed at the root. */
INLINE void push_root(articulated_sweep *s, const laconic_articulated_model *m, const real *eta, bool damped) {
    const vector *column = carriage_columns(s, m);
    for (int32_t i = 0; i < m->carriage_dof; i++) {
        s->push[i] = dot(column[i], s->force[0]);
        if (LACONIC_WITH_DAMPING && damped && !m->coordinated) s->push[i] -= m->decay_per_s[i] * eta[i];
    }
}

/* Mass and push of ζ from what is summed at the root. */
INLINE void project_root(articulated_sweep *s, const laconic_articulated_model *m, const real *eta, bool damped) {
    const vector *column = carriage_columns(s, m);
    for (int32_t i = 0; i < m->carriage_dof; i++) {
        const vector momentum = form_times(&s->inertia[0], column[i]);
        for (int32_t j = 0; j < i; j++) s->mass[i][j] = dot(momentum, column[j]);
        s->mass[i][i] = R(1) + dot(momentum, column[i]);
    }
    push_root(s, m, eta, damped);
    for (int32_t k = 0; k < m->own_count; k++)
        for (int32_t i = 0; i < m->carriage_dof; i++) s->mass[m->carriage_dof + k][i] = dot(column[i], s->own[k]);
    for (int32_t r = 0; r < m->row_count; r++) {
        for (int32_t i = 0; i < m->carriage_dof; i++) s->left[r][i] = dot(column[i], s->row[r]);
        for (int32_t k = 0; k < m->own_count; k++) s->left[r][m->carriage_dof + k] = s->row_of_own[r][k];
    }
}

/* Solves mass · x = push + Cᵀκ with C x = target for x; refuses MASSLESS_HINGE, WHEELS_DISAGREE. The multipliers are
 * κ, which may be NULL. */
laconic_status laconic_articulated_solve(real *x, real *multiplier, const articulated_sweep *s,
                                         const laconic_articulated_model *m, const real *target, laconic_refusal *why);

/* Numbers of the rows that count, in kept; refuses as laconic_articulated_solve does. */
laconic_status laconic_articulated_keep_rows(int32_t kept[], int32_t *count, const articulated_sweep *s,
                                             const laconic_articulated_model *m, const real *target,
                                             laconic_refusal *why);

/* x for the usual vehicles: one or two velocities and no row left over. */
INLINE bool solve_small(real *x, const articulated_sweep *s, const laconic_articulated_model *m) {
    if (m->row_count > 0 || m->dof > 2 || m->own_count > 0) return false;
    if (m->dof == 1) {
        x[0] = s->push[0] / s->mass[0][0];
        return true;
    }
    /* ζ alone: the determinant is at least 1 */
    const real scale = R(1) / (s->mass[0][0] * s->mass[1][1] - s->mass[1][0] * s->mass[1][0]);
    x[0] = scale * (s->mass[1][1] * s->push[0] - s->mass[1][0] * s->push[1]);
    x[1] = scale * (s->mass[0][0] * s->push[1] - s->mass[1][0] * s->push[0]);
    return true;
}

/* Refuses for a hinge whose direction the twist does not give: found by sweep_outward. */
laconic_status laconic_articulated_refuse_twist(int32_t hinge, const laconic_articulated_model *m,
                                                const articulated_drive *drive, laconic_refusal *why);

/* η' and all twists of a posture whose directions are set. */
INLINE laconic_status accelerations(real *eta_rate, articulated_sweep *s, const laconic_articulated_model *m,
                                    const real *eta, const articulated_drive *drive, direction heading,
                                    laconic_refusal *why) {
    const int32_t unknown = sweep_outward(s, m, eta, drive);
    real target[LACONIC_MAX_LEFT_ROWS];
    if (unknown != 0) return laconic_articulated_refuse_twist(unknown, m, drive, why);
    sweep_loads(s, m, drive);
    if (drive->rotates) laconic_articulated_add_world(s, m, drive, heading);
    sweep_inward(s, m);
    project_root(s, m, eta, true);
    if (solve_small(eta_rate, s, m)) return LACONIC_OK;
    for (int32_t r = 0; r < m->row_count; r++) target[r] = -s->row_bias[r];
    return laconic_articulated_solve(eta_rate, NULL, s, m, target, why);
}

#endif
#endif
