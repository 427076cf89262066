/* Examines a prepared model at a few postures that are nothing special: does every own hinge turn with inertia, does
 * the carriage move, and how fast does the fastest motion decay or swing?
 *
 * Decay: the largest eigenvalue of mass⁻¹ D, with D = Σ B_bᵀD_bB_b and the hinges' damping; swing: the root of that of
 * mass⁻¹ K. Both depend on the angles only mildly; rows left over only lower them. So steps need not compute them. */
#include "articulated_vehicle.h"

#if LACONIC_MAX_BODIES > 0

#define POSTURES 6
#define POWER_ROUNDS 60
#define MARGIN R(1.1) /* for other postures */

/* Angles and twist without symmetry: multiples of the golden angle, and so on. */
static void take_posture(articulated_sweep *s, articulated_drive *drive, const laconic_articulated_model *m,
                         int32_t posture) {
    const articulated_drive still = ALL_ZERO;
    *drive = still;
    forget_sizes(s, m);
    for (int32_t b = 1; b <= m->body_count; b++)
        s->toward[b - 1] = laconic_direction_of_angle(posture == 0 ? R(0) : R(2.399963) * (real)(posture + 7 * b));
    for (int32_t k = 0; k < m->column_count; k++) {
        const real share = laconic_direction_of_angle(R(0.7) * (real)(posture + 3 * k) + R(0.3)).cosine;
        drive->twist[0] = plus(drive->twist[0], scaled(share, m->column[k]));
    }
}

/* Mass and rows of the posture; false where the twist gives a hinge no direction there. */
static bool posture_mass(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive) {
    const real at_rest[LACONIC_MAX_VELOCITIES] = {R(0)};
    if (sweep_outward(s, m, at_rest, drive) != 0) return false;
    for (int32_t b = 0; b <= m->body_count; b++) s->force[b] = none;
    sweep_inward(s, m);
    project_root(s, m, at_rest, false);
    return true;
}

/* ------------------------------------------------------------------------------ the carriage moves -- */

typedef struct independent_rows {
    int32_t count;
    real row[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES];
} independent_rows;

static void count_row(independent_rows *known, const real *from, int32_t n) {
    real v[LACONIC_MAX_VELOCITIES], whole = R(0), left = R(0);
    if (known->count >= n) return;
    for (int32_t i = 0; i < n; i++) whole += from[i] * from[i];
    for (int32_t i = 0; i < n; i++) v[i] = from[i];
    for (int32_t k = 0; k < known->count; k++) {
        real along = R(0);
        for (int32_t i = 0; i < n; i++) along += v[i] * known->row[k][i];
        for (int32_t i = 0; i < n; i++) v[i] -= along * known->row[k][i];
    }
    for (int32_t i = 0; i < n; i++) left += v[i] * v[i];
    if (!(left > R(1e4) * LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE * whole)) return;
    const real inverse = R(1) / laconic_root(left);
    for (int32_t i = 0; i < n; i++) known->row[known->count][i] = inverse * v[i];
    known->count++;
}

static bool is_commanded(const laconic_articulated_model *m, int32_t b) {
    for (; b > 0; b = m->link[b - 1].parent)
        if (m->link[b - 1].motion == LACONIC_MOTION_PRESCRIBED) return true;
    return false;
}

/* Motions that the rows leave, less those in which own hinges alone turn. Rows of commanded bodies hold at the angles
 * that are commanded, which may be special; steps judge them. */
static bool carriage_moves(const articulated_sweep *s, const laconic_articulated_model *m) {
    independent_rows all = ALL_ZERO, own = ALL_ZERO;
    for (int32_t r = 0; r < m->row_count; r++) {
        if (is_commanded(m, m->row[r].body)) continue;
        count_row(&all, s->left[r], m->dof);
        count_row(&own, &s->left[r][m->carriage_dof], m->own_count);
    }
    return m->dof - all.count > m->own_count - own.count;
}

/* --------------------------------------------------------------------------- the fastest motion -- */

/* mass⁻¹ F e_l, with the forces F that damping or, `stiff`, springs give for the motion e_l. */
static void response_to(real *x, articulated_sweep *s, const laconic_articulated_model *m,
                        const articulated_drive *drive, int32_t l, bool stiff) {
    real eta[LACONIC_MAX_VELOCITIES] = {R(0)};
    eta[l] = R(1);
    (void)sweep_outward(s, m, eta, drive);
    s->force[0] = m->coordinated && !stiff ? form_times(&m->drag, s->twist[0]) : none;
    for (int32_t b = 1; b <= m->body_count; b++) s->force[b] = none;
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const real torque = s->rate[b - 1] * (stiff ? link->stiffness_Nm : link->damping_Nms);
        if (!stiff) s->force[b] = plus(s->force[b], form_times(&link->drag, s->twist[b]));
        s->force[b].z += torque;
        s->force[link->parent].z -= torque;
    }
    sweep_inward(s, m);
    project_root(s, m, eta, false);
    if (!stiff && !m->coordinated && l < m->carriage_dof) s->push[l] += m->decay_per_s[l];
    (void)laconic_articulated_solve(x, NULL, s, m, NULL, NULL);
}

/* Largest eigenvalue by powers; mass⁻¹F has real ones, none negative. */
static real largest_eigenvalue(const real a[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES], int32_t n) {
    real v[LACONIC_MAX_VELOCITIES], value = R(0);
    for (int32_t i = 0; i < n; i++) v[i] = R(1) + R(0.1) * (real)i;
    for (int round = 0; round < POWER_ROUNDS; round++) {
        real next[LACONIC_MAX_VELOCITIES], before = R(0), after = R(0);
        for (int32_t i = 0; i < n; i++) {
            next[i] = R(0);
            for (int32_t j = 0; j < n; j++) next[i] += a[j][i] * v[j];
            before += magnitude(v[i]);
            after += magnitude(next[i]);
        }
        if (!(after > R(0)) || !is_finite(after)) return is_finite(after) ? value : after;
        value = after / before;
        for (int32_t i = 0; i < n; i++) v[i] = next[i] / after;
    }
    return value;
}

/* `m` without rows. */
static real fastest_of(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive,
                       bool stiff) {
    real column[LACONIC_MAX_VELOCITIES][LACONIC_MAX_VELOCITIES];
    for (int32_t l = 0; l < m->dof; l++) response_to(column[l], s, m, drive, l, stiff);
    return largest_eigenvalue((const real(*)[LACONIC_MAX_VELOCITIES])column, m->dof);
}

static void include_rate(laconic_articulated_model *m, articulated_sweep *s, const laconic_articulated_model *bare,
                         const articulated_drive *drive) {
    const real decay = MARGIN * fastest_of(s, bare, drive, false);
    const real swing = MARGIN * laconic_root(fastest_of(s, bare, drive, true));
    if (!(decay <= m->fastest_decay_per_s)) m->fastest_decay_per_s = decay;
    if (!(swing <= m->fastest_swing_per_s)) m->fastest_swing_per_s = swing;
}

laconic_status laconic_articulated_examine(laconic_articulated_model *m, laconic_refusal *why) {
    laconic_articulated_model bare = *m;
    articulated_sweep s;
    articulated_drive drive;
    bool stuck = false;
    bare.row_count = 0;
    for (int32_t posture = 0; posture < POSTURES; posture++) {
        real x[LACONIC_MAX_VELOCITIES];
        take_posture(&s, &drive, m, posture);
        if (!posture_mass(&s, m, &drive)) continue;
        stuck = stuck || (posture > 0 && !carriage_moves(&s, m)); /* posture 0 is special: all hinges straight */
        const laconic_status status = laconic_articulated_solve(x, NULL, &s, &bare, NULL, why);
        if (status != LACONIC_OK) return status;
        include_rate(m, &s, &bare, &drive);
    }
    if (!stuck) return LACONIC_OK;
    return refuse(why, LACONIC_STEERED_TOO_OFTEN, (laconic_field)LACONIC_FIELD_OF_BODY_COUNT, 0,
                  (real)(m->row_count + 3 - m->column_count), R(0));
}

#endif
