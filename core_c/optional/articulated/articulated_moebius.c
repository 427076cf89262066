/* moebius-4: a symmetric step of second order, extrapolated to the fourth.
 *
 * The step of h splits what moves the angles from what moves η:
 *
 *     1. all hinges for h/2 with η at the start, from root to leaf: following ones by exact maps of the circle
 *        (articulated_circle.h), own ones by their rate, commanded ones to the middle of the step
 *     2. η for h at these angles. With f quadratic in η and J = ∂f/∂η, Kahan's linearly implicit step is
 *            (mass − ½h J + ¼h² K) d = h f,   η⁺ = η + d,      K: springs, taken at ψ + ¼h(ψ'⁺ − ψ')
 *        and with mass_ii (a/(1 − e^−a) − 1 − a/2) added to the diagonal, a = h r_i, it is exponential in the decay of
 *        each velocity: a steady motion stays, and what decays fast is gone after one step.
 *     3. all hinges for h/2 with η⁺, from leaf to root: the mirror of 1, so that the step is symmetric
 *
 * The error of a symmetric step has even powers of h alone, so (4 · two half steps − one step)/3 is of fourth order,
 * for η, angles and means. The mean of η is η + κ d, κ = φ2/φ1: exact for decay alone, where the mean of both ends is
 * wrong. Rows left over hold on average over the base step, C(η + d/2) = 0, and are restored at the end, which costs an
 * order.
 *
 * Extrapolation would amplify a swing that the step does not resolve (by 5/3). Where a spring swings faster than the
 * step the two half steps stand as they are: of second order, and stable at any stiffness.
 *
 * J follows from f itself, exactly, as f is quadratic: J e = (f(η + e) − f(η − e))/2. */
#include "articulated_circle.h"

#if LACONIC_MAX_BODIES > 0

#define MOEBIUS_UNKNOWNS (2 * LACONIC_MAX_VELOCITIES)

/* A motion within a step; `turn_rad` since the step's start. */
typedef struct moebius_point {
    real eta[LACONIC_MAX_VELOCITIES];
    direction toward[LACONIC_MAX_BODIES], facing;
    real angle_rad[LACONIC_MAX_BODIES], turn_rad[LACONIC_MAX_BODIES];
} moebius_point;

/* What a base step adds besides: means of all twists, and of X_0 12/h times the first moment about the middle. */
typedef struct moebius_means {
    vector mean[BODIES], slope;
} moebius_means;

/* ------------------------------------------------------------------------------------ angles -- */

/* Moves one hinge for h, from the share `from`; the twist of its parent is in s. */
static void move_hinge(moebius_point *p, const articulated_sweep *s, const laconic_articulated_model *m,
                       const articulated_course *course, int32_t b, real from, real share) {
    const laconic_link *link = &m->link[b - 1];
    const vector parent = s->twist[link->parent];
    const direction before = p->toward[b - 1];
    const real h = share * course->step_s;
    real turn = R(0);
    if (link->motion == LACONIC_MOTION_COORDINATED) return;
    if (link->motion == LACONIC_MOTION_FOLLOWING) {
        p->toward[b - 1] = circle_map(before, circle_flow_of(link, parent), h);
        turn = laconic_articulated_turn_from_to(before, p->toward[b - 1]);
    } else {
        turn = link->motion == LACONIC_MOTION_OWN ? h * (own_rate(m, link, p->eta) - parent.z)
                                                  : laconic_articulated_commanded_turn(course, b, from, share);
        p->toward[b - 1] = turned_by(before, turn);
    }
    p->turn_rad[b - 1] += turn;
    p->angle_rad[b - 1] += turn;
}

static void child_twist(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive,
                        const real *eta, int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    real rate = drive->rate[b - 1], acceleration = drive->acceleration[b - 1];
    if (link->motion == LACONIC_MOTION_COORDINATED) {
        const coordinated_motion c = coordinate(s, link, drive, b);
        rate = c.rate;
        acceleration = c.acceleration;
    }
    sweep_child(s, m, b, eta, rate, acceleration);
}

static void move_outward(moebius_point *p, articulated_sweep *s, const laconic_articulated_model *m,
                         const articulated_course *course, const articulated_drive *drive, real from, real share) {
    sweep_root(s, m, p->eta);
    for (int32_t b = 1; b <= m->body_count; b++) {
        move_hinge(p, s, m, course, b, from, share);
        s->toward[b - 1] = p->toward[b - 1];
        s->angle_rad[b - 1] = p->angle_rad[b - 1];
        child_twist(s, m, drive, p->eta, b);
    }
    if (drive->rotates) p->facing = turned_by(p->facing, share * course->step_s * s->twist[0].z);
}

static void move_inward(moebius_point *p, articulated_sweep *s, const laconic_articulated_model *m,
                        const articulated_course *course, const articulated_drive *drive, real from, real share) {
    sweep_root(s, m, p->eta);
    for (int32_t b = 1; b <= m->body_count; b++) child_twist(s, m, drive, p->eta, b);
    for (int32_t b = m->body_count; b >= 1; b--) move_hinge(p, s, m, course, b, from, share);
    if (drive->rotates) p->facing = turned_by(p->facing, share * course->step_s * s->twist[0].z);
}

/* -------------------------------------------------------------------------------- velocities -- */

/* f at another η, with angles and drive as they are. */
static void push_at(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive,
                    const moebius_point *p, const real *eta) {
    sweep_root(s, m, eta);
    for (int32_t b = 1; b <= m->body_count; b++) child_twist(s, m, drive, eta, b);
    sweep_loads(s, m, drive);
    if (drive->rotates) laconic_articulated_add_world(s, m, drive, p->facing);
    sweep_forces_inward(s, m);
    push_root(s, m, eta, true);
}

/* A column of J. The difference is as long as η, so that it keeps its digits. */
static void jacobian_column(real *column, articulated_sweep *s, const laconic_articulated_model *m,
                            const articulated_drive *drive, const moebius_point *p, int32_t l) {
    real eta[LACONIC_MAX_VELOCITIES], length = R(1);
    for (int32_t i = 0; i < m->dof; i++) {
        eta[i] = p->eta[i];
        if (magnitude(eta[i]) > length) length = magnitude(eta[i]);
    }
    eta[l] = p->eta[l] + length;
    push_at(s, m, drive, p, eta);
    for (int32_t i = 0; i < m->dof; i++) column[i] = s->push[i];
    eta[l] = p->eta[l] - length;
    push_at(s, m, drive, p, eta);
    for (int32_t i = 0; i < m->dof; i++) column[i] = (column[i] - s->push[i]) / (R(2) * length);
}

/* Solves a[n][n + 1] by elimination with pivots; false where it is singular. */
static bool eliminate_unknowns(real a[MOEBIUS_UNKNOWNS][MOEBIUS_UNKNOWNS + 1], real *x, int32_t n) {
    for (int32_t c = 0; c < n; c++) {
        int32_t p = c;
        for (int32_t r = c + 1; r < n; r++)
            if (magnitude(a[r][c]) > magnitude(a[p][c])) p = r;
        if (!(magnitude(a[p][c]) > LACONIC_REAL_MIN)) return false;
        for (int32_t j = c; j <= n && p != c; j++) {
            const real swap = a[c][j];
            a[c][j] = a[p][j];
            a[p][j] = swap;
        }
        const real inverse = R(1) / a[c][c];
        for (int32_t r = c + 1; r < n; r++) {
            const real factor_of_row = a[r][c] * inverse;
            for (int32_t j = c + 1; j <= n; j++) a[r][j] -= factor_of_row * a[c][j];
        }
        a[c][c] = inverse;
    }
    for (int32_t i = n - 1; i >= 0; i--) {
        real sum = a[i][n];
        for (int32_t j = i + 1; j < n; j++) sum -= a[i][j] * x[j];
        x[i] = sum * a[i][i];
    }
    return true;
}

/* ¼h² K, K = Σ stiffness (ω_b − ω_p)(ω_b − ω_p)ᵀ, from the rates that each velocity alone gives a hinge. */
static void add_springs(real a[MOEBIUS_UNKNOWNS][MOEBIUS_UNKNOWNS + 1], articulated_sweep *s,
                        const laconic_articulated_model *m, const articulated_drive *drive, real h) {
    real rate[LACONIC_MAX_VELOCITIES][LACONIC_MAX_BODIES];
    articulated_drive still = *drive;
    bool springs = false;
    for (int32_t b = 0; b < m->body_count; b++) springs = springs || m->link[b].stiffness_Nm > R(0);
    if (!springs) return;
    for (int32_t b = 0; b < m->body_count; b++) still.rate[b] = R(0);
    for (int32_t l = 0; l < m->dof; l++) {
        real eta[LACONIC_MAX_VELOCITIES] = {R(0)};
        eta[l] = R(1);
        sweep_root(s, m, eta);
        for (int32_t b = 1; b <= m->body_count; b++) {
            child_twist(s, m, &still, eta, b);
            rate[l][b - 1] = s->rate[b - 1];
        }
    }
    for (int32_t b = 0; b < m->body_count; b++)
        for (int32_t i = 0; i < m->dof; i++)
            for (int32_t j = 0; j < m->dof; j++)
                a[i][j] += R(0.25) * h * h * m->link[b].stiffness_Nm * rate[i][b] * rate[j][b];
}

/* The increment d of η; s is swept outward at the middle of the step. */
static laconic_status velocity_step(real *d, articulated_sweep *s, const laconic_articulated_model *m,
                                    const laconic_articulated_factors *factors, const articulated_drive *drive,
                                    const moebius_point *p, real h, laconic_refusal *why) {
    real a[MOEBIUS_UNKNOWNS][MOEBIUS_UNKNOWNS + 1], target[LACONIC_MAX_LEFT_ROWS], x[MOEBIUS_UNKNOWNS];
    int32_t kept[LACONIC_MAX_VELOCITIES], rows = 0;
    sweep_loads(s, m, drive);
    if (drive->rotates) laconic_articulated_add_world(s, m, drive, p->facing);
    sweep_inward(s, m);
    project_root(s, m, p->eta, true);
    for (int32_t r = 0; r < m->row_count; r++) target[r] = R(-2) * s->row_value[r];
    const laconic_status status = laconic_articulated_keep_rows(kept, &rows, s, m, target, why);
    if (status != LACONIC_OK) return status;
    const int32_t k = m->dof, n = k + rows;
    for (int32_t i = 0; i < k; i++) {
        for (int32_t j = 0; j < k; j++) a[i][j] = i >= j ? s->mass[i][j] : s->mass[j][i];
        a[i][i] += factors->correction[i] * s->mass[i][i];
        for (int32_t q = 0; q < rows; q++) {
            a[i][k + q] = -s->left[kept[q]][i];
            a[k + q][i] = s->left[kept[q]][i];
        }
        a[i][n] = h * s->push[i];
    }
    for (int32_t q = 0; q < rows; q++) {
        for (int32_t r = 0; r < rows; r++) a[k + q][k + r] = R(0);
        a[k + q][n] = target[kept[q]];
    }
    for (int32_t l = 0; l < k; l++) {
        real column[LACONIC_MAX_VELOCITIES];
        jacobian_column(column, s, m, drive, p, l);
        for (int32_t i = 0; i < k; i++) a[i][l] -= R(0.5) * h * column[i];
    }
    add_springs(a, s, m, drive, h);
    if (!eliminate_unknowns(a, x, n)) return refuse(why, LACONIC_STEP_SINGULAR, LACONIC_FIELD_STEP, 0, h, R(0.5) * h);
    for (int32_t i = 0; i < k; i++) d[i] = x[i];
    return LACONIC_OK;
}

/* --------------------------------------------------------------------------------- base step -- */

static laconic_status commanded_ready(articulated_sweep *s, const laconic_articulated_model *m, const moebius_point *p,
                                      const articulated_drive *drive, laconic_refusal *why) {
    forget_sizes(s, m);
    if (!m->coordinated) return LACONIC_OK;
    if (!take_unit_twist(s, m, drive)) return laconic_articulated_refuse_twist(-1, m, drive, why);
    for (int32_t b = 1; b <= m->body_count; b++) {
        s->toward[b - 1] = p->toward[b - 1];
        if (m->link[b - 1].motion == LACONIC_MOTION_COORDINATED &&
            !(coordinate(s, &m->link[b - 1], drive, b).size > R(0)))
            return laconic_articulated_refuse_twist(b, m, drive, why);
    }
    return LACONIC_OK;
}

/* Means of all twists at the middle's angles; slope of X_0. */
static void take_means(moebius_means *means, articulated_sweep *s, const laconic_articulated_model *m,
                       const laconic_articulated_factors *factors, const articulated_drive *drive, const real *before,
                       const real *d, real h) {
    real mean[LACONIC_MAX_VELOCITIES], slope[LACONIC_MAX_VELOCITIES];
    for (int32_t i = 0; i < m->dof; i++) {
        mean[i] = before[i] + factors->mean[i] * d[i];
        slope[i] = factors->slope[i] * d[i];
    }
    sweep_root(s, m, slope);
    means->slope = s->twist[0];
    if (m->coordinated) means->slope = plus(means->slope, scaled(h * mean[0], s->along_rate));
    sweep_root(s, m, mean);
    for (int32_t b = 1; b <= m->body_count; b++) child_twist(s, m, drive, mean, b);
    for (int32_t b = 0; b <= m->body_count; b++) means->mean[b] = s->twist[b];
}

static laconic_status base_step_of(moebius_point *p, moebius_means *means, const laconic_articulated_model *m,
                                   const laconic_articulated_factors *factors, const articulated_course *course,
                                   real from, real share, laconic_refusal *why) {
    articulated_sweep s;
    articulated_moment moment;
    const real half = R(0.5) * share;
    laconic_articulated_begin_moment(&moment, course);
    const articulated_drive *drive = commands_of(&moment, course, m, from + half);
    real d[LACONIC_MAX_VELOCITIES], before[LACONIC_MAX_VELOCITIES];
    laconic_status status = commanded_ready(&s, m, p, drive, why);
    if (status != LACONIC_OK) return status;
    move_outward(p, &s, m, course, drive, from, half);
    status = velocity_step(d, &s, m, factors, drive, p, share * course->step_s, why);
    if (status != LACONIC_OK) return status;
    for (int32_t i = 0; i < m->dof; i++) {
        before[i] = p->eta[i];
        p->eta[i] += d[i];
    }
    take_means(means, &s, m, factors, drive, before, d, share * course->step_s);
    move_inward(p, &s, m, course, drive, from + half, half);
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------------- the method -- */

static void start_point(moebius_point *p, const laconic_articulated_model *m, const laconic_articulated_state *state) {
    articulated_sweep s;
    take_posture_of(&s, m, state);
    take_eta(p->eta, m, state);
    p->facing = direction_of_heading(&state->heading);
    for (int32_t b = 0; b < m->body_count; b++) {
        p->toward[b] = s.toward[b];
        p->angle_rad[b] = s.angle_rad[b];
        p->turn_rad[b] = R(0);
    }
}

static real extrapolated_number(real twice, real once, real share) { return twice + (twice - once) * share; }

static void combine_points(articulated_increment *by, const laconic_articulated_model *m,
                           const laconic_articulated_state *state, const moebius_point *once,
                           const moebius_point *twice, const moebius_means means[3], real share) {
    for (int32_t i = 0; i < m->dof; i++)
        by->eta[i] =
            extrapolated_number(twice->eta[i] - state->eta[i].value, once->eta[i] - state->eta[i].value, share);
    for (int32_t b = 0; b < m->body_count; b++)
        by->turn_rad[b] = extrapolated_number(twice->turn_rad[b], once->turn_rad[b], share);
    for (int32_t b = 0; b <= m->body_count; b++) {
        const vector mean = scaled(R(0.5), plus(means[1].mean[b], means[2].mean[b]));
        by->mean[b] = plus(mean, scaled(share, minus(mean, means[0].mean[b])));
    }
    by->bend = plus(scaled(R(1.5), minus(means[2].mean[0], means[1].mean[0])),
                    scaled(R(0.25), plus(means[1].slope, means[2].slope)));
}

laconic_status laconic_articulated_moebius_4(laconic_articulated_state *state, const laconic_articulated_model *m,
                                             const laconic_articulated_factors factors[2],
                                             const articulated_course *course, real from, real share,
                                             laconic_refusal *why) {
    moebius_point once, twice;
    moebius_means means[3];
    articulated_increment by;
    articulated_moment moment;
    const real h = share * course->step_s, half = R(0.5) * share;
    start_point(&once, m, state);
    twice = once;
    laconic_status status = base_step_of(&once, &means[0], m, &factors[0], course, from, share, why);
    if (status == LACONIC_OK) status = base_step_of(&twice, &means[1], m, &factors[1], course, from, half, why);
    if (status == LACONIC_OK) status = base_step_of(&twice, &means[2], m, &factors[1], course, from + half, half, why);
    if (status != LACONIC_OK) return status;
    combine_points(&by, m, state, &once, &twice, means, h * m->fastest_swing_per_s > R(1) ? R(0) : R(1) / R(3));
    laconic_articulated_begin_moment(&moment, course);
    const articulated_drive *end = commands_of(&moment, course, m, from + share);
    laconic_articulated_turn_coordinated(&by, m, state, end);
    status = laconic_articulated_accept(state, m, &by, h);
    if (status != LACONIC_OK) return refuse(why, status, LACONIC_FIELD_STEP, 0, h, R(0));
    return laconic_articulated_project(state, m, end, why);
}

#endif
