/* The equations of motion in η: mass and push from what is summed at the root, and their solution for usual
 * vehicles. */
#ifndef LACONIC_ARTICULATED_EQUATIONS_H
#define LACONIC_ARTICULATED_EQUATIONS_H

#include "articulated_tree.h"

#if LACONIC_MAX_BODIES > 0

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
            return false; /* GCOVR_EXCL_LINE: a prepared vehicle has inertia along both */
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

#endif
#endif
