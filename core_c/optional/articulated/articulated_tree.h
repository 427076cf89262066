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
    vector force[BODIES];            /* of motors, and on body 0 of the input's wrench; own axes */
    real torque[LACONIC_MAX_BODIES]; /* of free and motor hinges without damping and spring      */
    real rate[LACONIC_MAX_BODIES];   /* r of prescribed hinges                                   */
    real acceleration[LACONIC_MAX_BODIES];
    vector twist[3]; /* T, T', T'' of S_0                                        */
    bool turns;      /* T' or T'' is not 0                                       */
    real world_force[2], world_force_point[2];
    bool rotates; /* a force fixed in the world acts                          */
} articulated_drive;

/* ------------------------------------------------------------------------ the posture and its sweep -- */

typedef struct articulated_sweep {
    vector twist[BODIES];                 /* X_b          */
    vector bias[BODIES];                  /* γ_b          */
    real rate[LACONIC_MAX_BODIES];        /* ψ_b' */
    direction toward[LACONIC_MAX_BODIES]; /* (cos ψ, sin ψ) */
    real angle_rad[LACONIC_MAX_BODIES];   /* ψ less its rest, only of hinges with a spring */
    vector force[BODIES];                 /* what acts at the body and beyond, less I_b γ_b */
    laconic_form inertia[BODIES];         /* of the body and what follows it                */
    vector own[LACONIC_MAX_BODIES];       /* momentum that 1 rad/s of own hinge k has, seen at one body */
    vector row[LACONIC_MAX_LEFT_ROWS];    /* left row, seen at one body                                 */
    real row_of_own[LACONIC_MAX_LEFT_ROWS][LACONIC_MAX_BODIES];
    real row_bias[LACONIC_MAX_LEFT_ROWS], row_value[LACONIC_MAX_LEFT_ROWS];
    vector along[1]; /* U = T/|T| in the metric of body 0, where it is commanded   */
    vector along_rate;
    real along_share;  /* T·I₀T'/|T|²                                                                          */
    real least_square; /* |w|² of a hinge without direction                                                    */
    real module_mass, module_push; /* of coordinated leaves, seen along U; 0 where they are summed at the root       */
    real inverse_size
        [BODIES]; /* 1/|w| of coordinated hinges, 1/|T| of body 0, of the posture before; 0: unknown       */
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

/* ----------------------------------------------------------------------------- coordinated steering --
 *
 * One twist T(t) = (T_ξ, T_η, T_θ) commands every steered wheel, so that the carriage has one degree of freedom, X_0 = σ U
 * with U = T/|T|, |T|² = T·I₀T, and the rank of the wheels' rows is exact: no angle is given twice. A hinge at h points
 * along w = T_v + i T_θ h:
 *
 *     e^{iψ} = w/|w|,     ψ' = Im(w'/w),     ψ'' = Im(w''/w) − 2 ψ' Re(w'/w),     U' = T'/|T| − U (T·I₀T')/|T|² */

/* 1/√x, from a number that is near it, or by a root. 0 where x is not positive or not finite. */
real laconic_articulated_inverse_root(real x);

/* Two rounds of Halley's kind, each of which takes e to about e³. */
INLINE real inverse_root_near(real x, real guess) {
    real e = R(1) - x * guess * guess;
    if (!(magnitude(e) < R(0.02))) return laconic_articulated_inverse_root(x);
    guess += guess * e * (R(0.5) + R(0.375) * e);
    e = R(1) - x * guess * guess;
    return guess + guess * e * (R(0.5) + R(0.375) * e);
}

/* |w|² up to which w is too short beside T_v, of which it is the rest near a turning centre. */
static inline real least_square_of(vector twist) {
    return LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE * (twist.x * twist.x + twist.y * twist.y);
}

/* U and U'. False where T is 0. */
INLINE bool take_unit_twist(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive) {
    const vector t = drive->twist[0], momentum = form_times(&m->inertia, t);
    const real inverse = inverse_root_near(dot(momentum, t), s->inverse_size[0]);
    s->inverse_size[0] = inverse;
    s->least_square = least_square_of(t);
    s->along[0] = scaled(inverse, t);
    s->along_rate = none;
    s->along_share = R(0);
    if (drive->turns) {
        s->along_share = inverse * inverse * dot(momentum, drive->twist[1]);
        s->along_rate = minus(scaled(inverse, drive->twist[1]), scaled(s->along_share, s->along[0]));
    }
    return inverse > R(0);
}

static inline direction twist_at_hinge(const laconic_link *link, vector twist) {
    return direction_with(twist.x - twist.z * link->hinge.y, twist.y + twist.z * link->hinge.x);
}

typedef struct coordinated_motion {
    direction w;                     /* not of length 1 */
    real square_size, size;          /* |w|², |w|       */
    real rate, acceleration, growth; /* ψ', ψ'', |w|'/|w| */
} coordinated_motion;

/* Coordinated hinge b; sets its direction. A hinge without one has the size 0. */
INLINE coordinated_motion coordinate(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive,
                                     int32_t b) {
    const direction w = twist_at_hinge(link, drive->twist[0]);
    coordinated_motion c = {w, w.cosine * w.cosine + w.sine * w.sine, R(0), R(0), R(0), R(0)};
    real guess = s->inverse_size[b];
    if (guess == R(0)) guess = R(1) / (s->toward[b - 1].cosine * w.cosine + s->toward[b - 1].sine * w.sine);
    const real inverse = inverse_root_near(c.square_size, guess);
    s->inverse_size[b] = inverse;
    s->toward[b - 1] = direction_with(w.cosine * inverse, w.sine * inverse);
    if (c.square_size > s->least_square) c.size = c.square_size * inverse;
    if (drive->turns) {
        const direction w1 = twist_at_hinge(link, drive->twist[1]), w2 = twist_at_hinge(link, drive->twist[2]);
        const real per_square = inverse * inverse;
        c.rate = (w.cosine * w1.sine - w.sine * w1.cosine) * per_square;
        c.growth = (w.cosine * w1.cosine + w.sine * w1.sine) * per_square;
        c.acceleration = (w.cosine * w2.sine - w.sine * w2.cosine) * per_square - R(2) * c.rate * c.growth;
    }
    return c;
}

/* Forgets sizes of another posture. */
static inline void forget_sizes(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t b = 0; m->coordinated && b <= m->body_count; b++) s->inverse_size[b] = R(0);
}

/* --------------------------------------------------------------------------------- root to leaf -- */

static inline real own_rate(const laconic_articulated_model *m, const laconic_link *link, const real *eta) {
    return eta[m->carriage_dof + link->column];
}

/* Twist, γ and ψ' of one child. */
typedef struct child_motion {
    vector twist, bias;
    real rate;
} child_motion;

/* `acceleration`: ψ'' as far as it is commanded. `bias`: γ of the parent; NULL: it is 0. */
INLINE child_motion motion_of_child(const laconic_link *link, direction d, vector parent, const vector *bias,
                                    real own_yaw_rate, real commanded_rate, real acceleration) {
    child_motion c;
    c.twist = carried(link, d, parent);
    c.bias = bias != NULL ? carried(link, d, *bias) : none;
    if (link->motion == LACONIC_MOTION_FOLLOWING)
        c.twist.z = following_rate(link, c.twist);
    else if (link->motion == LACONIC_MOTION_OWN)
        c.twist.z = own_yaw_rate;
    else
        c.twist.z += commanded_rate;
    c.rate = c.twist.z - parent.z;
    c.bias.x += c.rate * c.twist.y;
    c.bias.y -= c.rate * c.twist.x;
    if (link->motion == LACONIC_MOTION_FOLLOWING)
        c.bias.z = following_rate(link, c.bias);
    else if (link->motion == LACONIC_MOTION_OWN)
        c.bias.z = R(0);
    else
        c.bias.z += acceleration;
    return c;
}

static inline real own_rate_or_0(const laconic_articulated_model *m, const laconic_link *link, const real *eta) {
    return link->motion == LACONIC_MOTION_OWN ? own_rate(m, link, eta) : R(0);
}

INLINE void sweep_child(articulated_sweep *s, const laconic_articulated_model *m, int32_t b, const real *eta,
                        real commanded_rate, real acceleration) {
    const laconic_link *link = &m->link[b - 1];
    const child_motion c = motion_of_child(link, s->toward[b - 1], s->twist[link->parent], &s->bias[link->parent],
                                           own_rate_or_0(m, link, eta), commanded_rate, acceleration);
    s->twist[b] = c.twist;
    s->bias[b] = c.bias;
    s->rate[b - 1] = c.rate;
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
    if (m->coordinated && !take_unit_twist(s, m, drive)) return -1;
    sweep_root(s, m, eta);
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        real rate = drive->rate[b - 1], acceleration = drive->acceleration[b - 1];
        if (link->motion == LACONIC_MOTION_COORDINATED) {
            const coordinated_motion c = coordinate(s, link, drive, b);
            if (!(c.size > R(0))) return b;
            rate = c.rate;
            acceleration = c.acceleration;
        }
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

static inline real hinge_torque(const laconic_link *link, const articulated_drive *drive, real rate, real angle_rad,
                                int32_t b) {
    return drive->torque[b - 1] - link->damping_Nms * rate - link->stiffness_Nm * angle_rad;
}

/* What acts on one body, less I_b γ_b. */
INLINE vector load_of(const laconic_link *link, vector force, vector twist, vector bias) {
    vector w = minus(plus(gyroscopic(link->first_moment, twist), force), form_times(&link->inertia, bias));
    if (LACONIC_WITH_DAMPING && link->drags) w = minus(w, form_times(&link->drag, twist));
    return w;
}

/* A force fixed in the world on body 0, and the slope's pull on each body; `heading` of body 0. */
void laconic_articulated_add_world(articulated_sweep *s, const laconic_articulated_model *m,
                                   const articulated_drive *drive, direction heading);

/* Load of body 0 without I_0 and D_0, which ζ has as 1 and r, but for a commanded twist. */
INLINE vector load_of_carriage(const articulated_sweep *s, const laconic_articulated_model *m, vector force) {
    const vector v = s->twist[0];
    const real turning = m->mass_kg * v.z;
    force.x += turning * v.y;
    force.y -= turning * v.x;
    if (!m->coordinated) return force;
    return minus(force, plus(form_times(&m->inertia, s->bias[0]), form_times(&m->drag, v)));
}

/* Loads of all bodies. */
INLINE void sweep_loads(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive) {
    s->force[0] = load_of_carriage(s, m, drive->force[0]);
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        s->force[b] = load_of(link, drive->force[b], s->twist[b], s->bias[b]);
        if (link->motion <= LACONIC_MOTION_OWN) {
            const real torque = hinge_torque(link, drive, s->rate[b - 1], s->angle_rad[b - 1], b);
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

/* The part on V of a body's inertia, with ω = −n·V/ℓ where the hinge follows. */
typedef struct plane_form {
    real xx, xy, yy;
} plane_form;

INLINE plane_form plane_part(const laconic_link *link, const laconic_form *a) {
    plane_form p = {a->xx, a->xy, a->yy};
    if (link->motion == LACONIC_MOTION_FOLLOWING) {
        const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
        const real ux = a->xw - R(0.5) * mx * a->ww, uy = a->yw - R(0.5) * my * a->ww;
        p.xx -= R(2) * mx * ux;
        p.yy -= R(2) * my * uy;
        p.xy -= mx * uy + my * ux;
    }
    return p;
}

/* Adds T_bᵀ A T_b to the parent's inertia: the part on V turns by 2ψ. */
INLINE void pull_plane(laconic_form *parent, const laconic_link *link, direction d, plane_form a) {
    const real mean = R(0.5) * (a.xx + a.yy), half = R(0.5) * (a.xx - a.yy);
    const real cosine = d.cosine * d.cosine - d.sine * d.sine, sine = R(2) * d.cosine * d.sine;
    const real turned_half = cosine * half - sine * a.xy, turned_xy = sine * half + cosine * a.xy;
    const real pxx = mean + turned_half, pyy = mean - turned_half, hx = link->hinge.x, hy = link->hinge.y;
    const real bx = hx * turned_xy - hy * pxx, by = hx * pyy - hy * turned_xy;
    parent->xx += pxx;
    parent->xy += turned_xy;
    parent->yy += pyy;
    parent->xw += bx;
    parent->yw += by;
    parent->ww += hx * by - hy * bx;
}

/* The part between V and ω, which turns by ψ, and that on ω, of a body whose ω is commanded against its parent's. */
INLINE void pull_inertia(laconic_form *parent, const laconic_link *link, direction d, const laconic_form *a) {
    pull_plane(parent, link, d, plane_part(link, a));
    if (link->motion < LACONIC_MOTION_PRESCRIBED) return;
    const vector w = turned(d, a->xw, a->yw);
    parent->xw += w.x;
    parent->yw += w.y;
    parent->ww += R(2) * (link->hinge.x * w.y - link->hinge.y * w.x) + a->ww;
}

/* Own hinge b: its row of the equations, and its momentum, which travels on. */
static inline void meet_own(articulated_sweep *s, const laconic_articulated_model *m, int32_t b, const laconic_form *a,
                            real torque) {
    const laconic_link *link = &m->link[b - 1];
    const int32_t k = link->column, i = m->carriage_dof + k;
    for (int32_t j = 0; j < m->own_count; j++) {
        if (j == k || (link->own_below >> j & 1U) == 0U) continue;
        const int32_t other = m->carriage_dof + j;
        s->mass[i > other ? i : other][i > other ? other : i] = s->own[j].z;
    }
    s->mass[i][i] = a->ww;
    s->push[i] = torque;
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

/* Makes entries between own hinges that are not on one path 0, and those of rows. */
static inline void begin_inward(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t k = 1; k < m->own_count; k++)
        for (int32_t j = 0; j < k; j++) s->mass[m->carriage_dof + k][m->carriage_dof + j] = R(0);
    for (int32_t r = 0; r < m->row_count; r++)
        for (int32_t k = 0; k < m->own_count; k++) s->row_of_own[r][k] = R(0);
}

/* Rows left over of one body, as they are there. */
static inline void begin_rows(articulated_sweep *s, const laconic_articulated_model *m, int32_t b) {
    for (int32_t r = m->link[b - 1].first_row; r < m->link[b - 1].row_end; r++) {
        s->row[r] = m->row[r].axle;
        s->row_bias[r] = dot(s->row[r], s->bias[b]);
        s->row_value[r] = dot(s->row[r], s->twist[b]);
    }
}

/* Sums forces and inertias at the root. */
INLINE void sweep_inward(articulated_sweep *s, const laconic_articulated_model *m) {
    const laconic_form zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    const bool simple = m->own_count + m->row_count == 0;
    s->inertia[0] = zero;
    s->module_mass = s->module_push = R(0);
    for (int32_t b = 1; b <= m->body_count; b++) s->inertia[b] = m->link[b - 1].inertia;
    if (!simple) begin_inward(s, m);
    for (int32_t b = m->body_count; b >= 1; b--) {
        const laconic_link *link = &m->link[b - 1];
        const direction d = s->toward[b - 1];
        if (!simple) begin_rows(s, m, b);
        if (!simple && link->motion == LACONIC_MOTION_OWN) meet_own(s, m, b, &s->inertia[b], s->force[b].z);
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
    const vector force = s->force[0];
    const bool decays = LACONIC_WITH_DAMPING && damped;
    if (m->coordinated) {
        s->push[0] = dot(s->along[0], force) + s->module_push;
        return;
    }
    s->push[0] = dot(m->column[0], force) - (decays ? m->decay_per_s[0] * eta[0] : R(0));
    if (m->carriage_dof > 1) s->push[1] = dot(m->column[1], force) - (decays ? m->decay_per_s[1] * eta[1] : R(0));
    if (m->carriage_dof > 2) s->push[2] = dot(m->column[2], force) - (decays ? m->decay_per_s[2] * eta[2] : R(0));
}

static inline real form_product(const laconic_form *a, laconic_form b) {
    return (a->xx * b.xx + a->xy * b.xy) + (a->yy * b.yy + a->xw * b.xw) + (a->yw * b.yw + a->ww * b.ww);
}

/* E₀ + columnᵀ A column */
INLINE void mass_of_root(articulated_sweep *s, const laconic_articulated_model *m) {
    const laconic_form a = s->inertia[0];
    if (m->coordinated) {
        s->mass[0][0] = R(1) + dot(s->along[0], form_times(&a, s->along[0])) + s->module_mass;
        return;
    }
    s->mass[0][0] = R(1) + form_product(&m->pair[0], a);
    if (m->carriage_dof > 1) {
        s->mass[1][0] = form_product(&m->pair[1], a);
        s->mass[1][1] = R(1) + form_product(&m->pair[2], a);
    }
    if (m->carriage_dof > 2) {
        s->mass[2][0] = form_product(&m->pair[3], a);
        s->mass[2][1] = form_product(&m->pair[4], a);
        s->mass[2][2] = R(1) + form_product(&m->pair[5], a);
    }
}

/* What own hinges and rows left over have in ζ. */
static inline void root_of_others(articulated_sweep *s, const laconic_articulated_model *m) {
    const vector *column = carriage_columns(s, m);
    for (int32_t k = 0; k < m->own_count; k++)
        for (int32_t i = 0; i < m->carriage_dof; i++) s->mass[m->carriage_dof + k][i] = dot(column[i], s->own[k]);
    for (int32_t r = 0; r < m->row_count; r++) {
        for (int32_t i = 0; i < m->carriage_dof; i++) s->left[r][i] = dot(column[i], s->row[r]);
        for (int32_t k = 0; k < m->own_count; k++) s->left[r][m->carriage_dof + k] = s->row_of_own[r][k];
    }
}

/* Mass, push and C from what is summed at the root. */
INLINE void project_root(articulated_sweep *s, const laconic_articulated_model *m, const real *eta, bool damped) {
    push_root(s, m, eta, damped);
    mass_of_root(s, m);
    if (m->own_count + m->row_count > 0) root_of_others(s, m);
}

/* Solves mass · x = push + Cᵀκ with C x = target for x; refuses MASSLESS_HINGE, WHEELS_DISAGREE. The multipliers are
 * κ, which may be NULL. */
laconic_status laconic_articulated_solve(real *x, real *multiplier, const articulated_sweep *s,
                                         const laconic_articulated_model *m, const real *target, laconic_refusal *why);

/* η' of a sweep with rows left over or own hinges; `correction` as in accelerations(). */
laconic_status laconic_articulated_solve_rates(real *eta_rate, real *correction, const articulated_sweep *s,
                                               const laconic_articulated_model *m, laconic_refusal *why);

/* Numbers of the rows that count, in kept; refuses as laconic_articulated_solve does. */
laconic_status laconic_articulated_keep_rows(int32_t kept[], int32_t *count, const articulated_sweep *s,
                                             const laconic_articulated_model *m, const real *target,
                                             laconic_refusal *why);

/* Two unknowns with a positive definite matrix. */
INLINE bool solve_two(real *x, real *y, real a, real b, real c, real f, real g) {
    const real determinant = a * c - b * b, scale = R(1) / determinant;
    *x = scale * (c * f - b * g);
    *y = scale * (a * g - b * f);
    return determinant > R(1000) * LACONIC_EPSILON * a * c;
}

/* The usual vehicles: one or two velocities, no row left over. False for others. */
INLINE bool solve_small(real *x, const articulated_sweep *s, const laconic_articulated_model *m) {
    if (m->row_count > 0 || m->dof > 2) return false;
    if (m->dof == 2)
        return solve_two(&x[0], &x[1], s->mass[0][0], s->mass[1][0], s->mass[1][1], s->push[0], s->push[1]);
    x[0] = s->push[0] / s->mass[0][0]; /* mass of ζ: at least 1 */
    return true;
}

/* One steered wheel on a carriage with two velocities: its row c·ζ = 0 leaves ζ = σu with u = (c₂, −c₁), so that σ, and
 * where the steering is an own hinge its ω, are all that is solved. False for other vehicles. */
INLINE bool solve_steered(real *x, real *correction, const articulated_sweep *s, const laconic_articulated_model *m) {
    if (m->row_count != 1 || m->carriage_dof != 2 || m->own_count > 1) return false;
    const real c0 = s->left[0][0], c1 = s->left[0][1], m00 = s->mass[0][0], m10 = s->mass[1][0], m11 = s->mass[1][1];
    const real square_size = c0 * c0 + c1 * c1, inverse = R(1) / square_size;
    const real target = -s->row_bias[0] * inverse, p0 = target * c0, p1 = target * c1;
    const real f0 = s->push[0] - (m00 * p0 + m10 * p1), f1 = s->push[1] - (m10 * p0 + m11 * p1);
    const real mass = c1 * c1 * m00 - R(2) * c0 * c1 * m10 + c0 * c0 * m11, push = c1 * f0 - c0 * f1;
    real sigma = R(0);
    if (!(square_size > LACONIC_REAL_MIN)) return false;
    if (m->own_count == 0) {
        sigma = push / mass;
    } else {
        const real o0 = s->mass[2][0], o1 = s->mass[2][1];
        if (s->row_of_own[0][0] != R(0)) return false;
        if (!solve_two(&sigma, &x[2], mass, c1 * o0 - c0 * o1, s->mass[2][2], push, s->push[2] - (o0 * p0 + o1 * p1)))
            return false;
    }
    x[0] = p0 + sigma * c1;
    x[1] = p1 - sigma * c0;
    if (correction == NULL) return true;
    const real off = -s->row_value[0] * inverse; /* nearest in ζ, of the size of a step's error */
    correction[0] = off * c0;
    correction[1] = off * c1;
    if (m->own_count > 0) correction[2] = R(0);
    return true;
}

/* Refuses for a hinge whose direction the twist does not give: found by sweep_outward. */
laconic_status laconic_articulated_refuse_twist(int32_t hinge, const laconic_articulated_model *m,
                                                const articulated_drive *drive, laconic_refusal *why);

/* A following body on which nothing hangs: its forces and inertia count at the parent at once, from registers, by
 * constants for V alone, I and D with ω = −n·V/ℓ put in. `bias`: γ of the parent; NULL: it is 0. */
INLINE void visit_follower(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive, int32_t b,
                           const vector *bias) {
    const direction d = s->toward[b - 1];
    const vector parent = s->twist[link->parent], force = drive->force[b];
    vector v = carried(link, d, parent), g = bias != NULL ? carried(link, d, *bias) : none;
    const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
    v.z = -(mx * v.x + my * v.y);
    const real rate = v.z - parent.z, gx = g.x + rate * v.y, gy = g.y - rate * v.x;
    const vector a = gyroscopic(link->first_moment, v);
    const real torque = hinge_torque(link, drive, rate, s->angle_rad[b - 1], b), moment = a.z + force.z + torque;
    const laconic_form *in = &link->followed_inertia, *drag = &link->followed_drag;
    real x = a.x + force.x - mx * moment - (in->xx * gx + in->xy * gy);
    real y = a.y + force.y - my * moment - (in->xy * gx + in->yy * gy);
    if (LACONIC_WITH_DAMPING && link->drags) {
        x -= drag->xx * v.x + drag->xy * v.y;
        y -= drag->xy * v.x + drag->yy * v.y;
    }
    const vector pull = turned(d, x, y);
    const plane_form plane = {in->xx, in->xy, in->yy};
    vector *at = &s->force[link->parent];
    at->x += pull.x;
    at->y += pull.y;
    at->z += link->hinge.x * pull.y - link->hinge.y * pull.x - torque;
    pull_plane(&s->inertia[link->parent], link, d, plane);
    s->twist[b] = v;
    s->rate[b - 1] = rate;
}

/* Another body on which nothing hangs: its own hinge and its rows left over are its alone. */
INLINE void visit_other_leaf(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive,
                             int32_t b, direction d, const child_motion *c) {
    const laconic_link *link = &m->link[b - 1];
    const laconic_form *in = &link->inertia;
    vector w = load_of(link, drive->force[b], c->twist, c->bias);
    if (link->motion <= LACONIC_MOTION_OWN) {
        const real torque = hinge_torque(link, drive, c->rate, s->angle_rad[b - 1], b);
        w.z += torque;
        s->force[link->parent].z -= torque;
    }
    if (link->motion == LACONIC_MOTION_OWN) {
        const int32_t i = m->carriage_dof + link->column;
        s->mass[i][i] = in->ww;
        s->push[i] = w.z;
        s->own[link->column] = pulled(link, d, vector_of(in->xw, in->yw, R(0)));
    }
    for (int32_t r = link->first_row; r < link->row_end; r++) {
        const vector axle = m->row[r].axle;
        if (link->motion == LACONIC_MOTION_OWN) s->row_of_own[r][link->column] = axle.z;
        s->row[r] = pulled(link, d, axle);
        s->row_bias[r] = dot(axle, c->bias);
        s->row_value[r] = dot(axle, c->twist);
    }
    pull_inertia(&s->inertia[link->parent], link, d, in);
    s->force[link->parent] = plus(s->force[link->parent], pulled(link, d, w));
}

/* A body on which others hang waits for them with its load and inertia. */
INLINE void visit_inner(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive, int32_t b,
                        const child_motion *c) {
    s->bias[b] = c->bias;
    s->force[b] = load_of(link, drive->force[b], c->twist, c->bias);
    s->inertia[b] = link->inertia;
    if (link->motion > LACONIC_MOTION_OWN) return;
    const real torque = hinge_torque(link, drive, c->rate, s->angle_rad[b - 1], b);
    s->force[b].z += torque;
    s->force[link->parent].z -= torque;
}

/* A coordinated body on which nothing hangs rolls along its ξ with σμ, μ = |w|/|T|, whatever ψ: X = (σμ, 0, ω) with
 * γ = (σμ', 0, σU_θ' + ψ''). So it counts along U at once, and no vector is turned. */
INLINE bool visit_module(articulated_sweep *s, const articulated_drive *drive, const laconic_link *link, real sigma,
                         int32_t b) {
    const coordinated_motion c = coordinate(s, link, drive, b);
    const laconic_form *in = &link->inertia, *drag = &link->drag;
    const real mu = c.size * s->inverse_size[0], yaw = s->along[0].z;
    const vector v = vector_of(sigma * mu, R(0), sigma * yaw + c.rate), force = drive->force[b];
    const real gx = v.x * (c.growth - s->along_share), gw = sigma * s->along_rate.z + c.acceleration;
    real x = v.z * v.z * link->first_moment.x + force.x - (in->xx * gx + in->xw * gw);
    real moment = force.z - v.z * link->first_moment.x * v.x - (in->xw * gx + in->ww * gw);
    if (LACONIC_WITH_DAMPING && link->drags) {
        x -= drag->xx * v.x + drag->xw * v.z;
        moment -= drag->xw * v.x + drag->ww * v.z;
    }
    s->module_push += mu * x + yaw * moment;
    s->module_mass += mu * (in->xx * mu + R(2) * in->xw * yaw) + in->ww * yaw * yaw;
    s->twist[b] = v;
    s->rate[b - 1] = c.rate;
    return c.size > R(0);
}

/* One body, from its parent outward. Returns false for a coordinated hinge that gets no direction. */
INLINE bool visit(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                  const articulated_drive *drive, int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    const vector *bias = link->parent == 0 && !m->coordinated ? NULL : &s->bias[link->parent];
    if (link->is_plain_follower) {
        visit_follower(s, link, drive, b, bias);
        return true;
    }
    real rate = drive->rate[b - 1], acceleration = drive->acceleration[b - 1];
    if (link->motion == LACONIC_MOTION_COORDINATED) {
        if (link->is_leaf) return visit_module(s, drive, link, eta[0], b);
        const coordinated_motion commanded = coordinate(s, link, drive, b);
        if (!(commanded.size > R(0))) return false;
        rate = commanded.rate;
        acceleration = commanded.acceleration;
    }
    const direction d = s->toward[b - 1];
    const child_motion c =
        motion_of_child(link, d, s->twist[link->parent], bias, own_rate_or_0(m, link, eta), rate, acceleration);
    s->twist[b] = c.twist;
    s->rate[b - 1] = c.rate;
    if (!link->is_leaf)
        visit_inner(s, link, drive, b, &c);
    else
        visit_other_leaf(s, m, drive, b, d, &c);
    return true;
}

/* Inner bodies, to the root. */
INLINE void gather(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t b = m->last_inner; b >= 1; b--) {
        const laconic_link *link = &m->link[b - 1];
        if (link->is_leaf) continue;
        begin_rows(s, m, b);
        if (link->motion == LACONIC_MOTION_OWN) meet_own(s, m, b, &s->inertia[b], s->force[b].z);
        if (m->own_count + m->row_count > 0) pull_others(s, m, b);
        pull_inertia(&s->inertia[link->parent], link, s->toward[b - 1], &s->inertia[b]);
        s->force[link->parent] = plus(s->force[link->parent], pulled(link, s->toward[b - 1], s->force[b]));
    }
}

/* The same with forces that are fixed in the world: loads change after all twists are known. */
int32_t laconic_articulated_sweep_rotating(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                                           const articulated_drive *drive, direction heading);

/* Twists, forces and inertias of a posture, summed at the root. Returns as sweep_outward does. */
INLINE int32_t sweep_all(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                         const articulated_drive *drive, direction heading) {
    const laconic_form zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    if (drive->rotates) return laconic_articulated_sweep_rotating(s, m, eta, drive, heading);
    if (m->coordinated && !take_unit_twist(s, m, drive)) return -1;
    sweep_root(s, m, eta);
    s->force[0] = load_of_carriage(s, m, drive->force[0]);
    s->inertia[0] = zero;
    s->module_mass = s->module_push = R(0);
    if (m->own_count + m->row_count > 0) begin_inward(s, m);
    for (int32_t b = 1; b <= m->body_count; b++)
        if (!visit(s, m, eta, drive, b)) return b;
    gather(s, m);
    return 0;
}

/* η' and all twists of a posture whose directions are set. `correction` (NULL: not wanted) is the change of η that
 * restores the rows left over. */
INLINE laconic_status accelerations(real *eta_rate, real *correction, articulated_sweep *s,
                                    const laconic_articulated_model *m, const real *eta, const articulated_drive *drive,
                                    direction heading, laconic_refusal *why) {
    const int32_t unknown = sweep_all(s, m, eta, drive, heading);
    if (unknown != 0) return laconic_articulated_refuse_twist(unknown, m, drive, why);
    project_root(s, m, eta, true);
    if (solve_small(eta_rate, s, m) || solve_steered(eta_rate, correction, s, m)) return LACONIC_OK;
    return laconic_articulated_solve_rates(eta_rate, correction, s, m, why);
}

#endif
#endif
