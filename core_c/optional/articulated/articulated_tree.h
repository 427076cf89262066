/* What the methods for articulated vehicles share: twists along the tree from root to leaf, forces and inertias from
 * leaf to root, and the equations of motion in η. All of it is inlined into each method.
 *
 * A covector is a force with its moment about a body's origin. The twist of a child is X_b = T_b X_p (+ its own ω, or +
 * a prescribed rate), so a covector of the child counts at the parent as T_bᵀ times it, and an inertia as T_bᵀ A T_b.
 * With the bodies in order of their numbers one pass inwards sums all of it at the root: work grows with H, not with H
 * k². Only own hinges and rows left over travel as covectors of their own. */
#ifndef LACONIC_ARTICULATED_TREE_H
#define LACONIC_ARTICULATED_TREE_H

#include "articulated_coordinated.h"

#if LACONIC_MAX_BODIES > 0

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

#endif
#endif
