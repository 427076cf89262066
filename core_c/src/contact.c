/* What the ground must deliver: reactions, brakes, normal loads, the no-slip margin. */
#include "geometry.h"
#include "load.h"
#include "zeta.h"

/* Least-norm solution of Cᵀκ = f for rows C (n×3) of any rank: κ = C (CᵀC)⁺ f. The 3×3 pseudo-inverse comes
 * from the eigenvectors of S = CᵀC by cyclic Jacobi. */
typedef struct symmetric3 {
    real value[3][3], vector[3][3];
} symmetric3;

static void rotate(symmetric3 *s, int p, int q) {
    const real off = s->value[p][q];
    real cotangent, tangent, c, d;
    int k;
    if (off == R(0)) return;
    cotangent = (s->value[q][q] - s->value[p][p]) / (R(2) * off);
    tangent = R(1) / (magnitude(cotangent) + laconic_root(R(1) + cotangent * cotangent));
    if (cotangent < R(0)) tangent = -tangent;
    c = R(1) / laconic_root(R(1) + tangent * tangent);
    d = c * tangent;
    for (k = 0; k < 3; k++) {
        const real kp = s->value[k][p], kq = s->value[k][q];
        s->value[k][p] = c * kp - d * kq;
        s->value[k][q] = d * kp + c * kq;
    }
    for (k = 0; k < 3; k++) {
        const real pk = s->value[p][k], qk = s->value[q][k], vp = s->vector[k][p], vq = s->vector[k][q];
        s->value[p][k] = c * pk - d * qk;
        s->value[q][k] = d * pk + c * qk;
        s->vector[k][p] = c * vp - d * vq;
        s->vector[k][q] = d * vp + c * vq;
    }
}

static void pseudo_inverse(real out[3][3], const real matrix[3][3]) {
    symmetric3 s;
    real largest = R(0);
    int r, c, k;
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) {
            s.value[r][c] = matrix[r][c];
            s.vector[r][c] = r == c ? R(1) : R(0);
            out[r][c] = R(0);
        }
    for (k = 0; k < 12; k++) {
        rotate(&s, 0, 1);
        rotate(&s, 0, 2);
        rotate(&s, 1, 2);
    }
    for (k = 0; k < 3; k++)
        if (s.value[k][k] > largest) largest = s.value[k][k];
    for (k = 0; k < 3; k++) {
        if (!(s.value[k][k] > LACONIC_RANK_TOLERANCE * largest)) continue;
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++) out[r][c] += s.vector[r][k] * s.vector[c][k] / s.value[k][k];
    }
}

/* rows (n×3) → solver (n×3) with κ = solver · f. */
static void least_norm(real solver[][3], const real rows[][3], int32_t count) {
    real gram[3][3], inverse[3][3];
    int32_t i, r, c;
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) {
            gram[r][c] = R(0);
            for (i = 0; i < count; i++) gram[r][c] += rows[i][r] * rows[i][c];
        }
    pseudo_inverse(inverse, (const real(*)[3])gram);
    for (i = 0; i < count; i++)
        for (c = 0; c < 3; c++)
            solver[i][c] = rows[i][0] * inverse[0][c] + rows[i][1] * inverse[1][c] + rows[i][2] * inverse[2][c];
}

static void take_wheels(laconic_contact *contact, const laconic_vehicle *vehicle, const body *b) {
    int32_t i, row = 0;
    for (i = 0; i < vehicle->wheel_count; i++) {
        const laconic_wheel *wheel = &vehicle->wheel[i];
        const direction axle = laconic_direction_of_angle(wheel->axle_rad);
        direction pull;
        contact->inverse_arm_per_m[i] = R(1) / (b->radius_m * laconic_pull_direction(&pull, wheel));
        contact->pull[i][0] = pull.cosine;
        contact->pull[i][1] = pull.sine;
        contact->axle[i][0] = axle.cosine;
        contact->axle[i][1] = axle.sine;
        contact->lateral_row[i] = wheel->kind == LACONIC_WHEEL_FIXED ? row++ : -1;
        contact->brake_row[i] = wheel->locked ? row++ : -1;
    }
}

static void take_points(laconic_contact *contact, const laconic_vehicle *vehicle, const body *b) {
    const int32_t n = vehicle->wheel_count;
    int32_t i;
    real rows[LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS][3];
    contact->point_count = n + vehicle->support_count;
    for (i = 0; i < contact->point_count; i++) {
        contact->point_m[i][0] = (i < n ? vehicle->wheel[i].x_m : vehicle->support[i - n].x_m) - b->com_x_m;
        contact->point_m[i][1] = (i < n ? vehicle->wheel[i].y_m : vehicle->support[i - n].y_m) - b->com_y_m;
        rows[i][0] = b->radius_m; /* a length, so that the three balances are of one unit */
        rows[i][1] = contact->point_m[i][0];
        rows[i][2] = contact->point_m[i][1];
    }
    least_norm(contact->load_of_wrench, (const real(*)[3])rows, contact->point_count);
}

/* What the matrices do not hold: heights and supports are in no model. */
static real contact_size(const laconic_contact *c, int32_t wheel_count) {
    real sum = rows_size(c->multiplier, c->constraint_count) + rows_size(c->load_of_wrench, c->point_count) +
               c->com_z_m + c->friction_coefficient;
    int32_t i;
    for (i = 0; i < wheel_count; i++) sum += magnitude(c->inverse_arm_per_m[i]);
    for (i = 0; i < c->point_count; i++) sum += magnitude(c->point_m[i][0]) + magnitude(c->point_m[i][1]);
    return sum;
}

laconic_status laconic_contact_prepare(laconic_contact *contact, const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_matrices matrices;
    laconic_contact fresh = {0};
    int32_t i, k;
    body b;
    const laconic_status status = laconic_matrices_of(&matrices, vehicle, why);
    if (status != LACONIC_OK) return status;
    laconic_body_of(&b, vehicle);
    take_wheels(&fresh, vehicle, &b);
    take_points(&fresh, vehicle, &b);
    fresh.constraint_count = matrices.constraint_count;
    least_norm(fresh.multiplier, (const real(*)[3])matrices.constraint_rows, matrices.constraint_count);
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) fresh.inertia[i][k] = matrices.inertia[i][k];
    for (i = 0; i < vehicle->wheel_count; i++)
        for (k = 0; k < 3; k++) fresh.wheel_rows[i][k] = matrices.wheel_rows[i][k];
    fresh.com_z_m = vehicle->com_z_m;
    fresh.friction_coefficient = vehicle->friction_coefficient;
    if (!fits_squared(contact_size(&fresh, vehicle->wheel_count)))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *contact = fresh;
    return LACONIC_OK;
}

typedef struct instant { /* everything at one moment */
    real nu[3], nu_rate[3], wrench[3], torque[LACONIC_MAX_WHEELS];
} instant;

/* Outer wrench at S in body axes: F_ξ, F_η, τ. */
static void take_wrench(real wrench[3], const laconic_input *in, direction heading) {
    const real *f = in->world_force_N, *r = in->world_force_point_m;
    const real along = heading.cosine * f[0] + heading.sine * f[1];
    const real across = heading.cosine * f[1] - heading.sine * f[0];
    wrench[0] = in->body_force_N[0] + along;
    wrench[1] = in->body_force_N[1] + across;
    wrench[2] = in->body_moment_Nm + (r[0] * across - r[1] * along);
}

static void take_instant(instant *now, const laconic_model *m, const laconic_state *state, const laconic_input *in) {
    const direction heading = laconic_direction_of_turn(state->heading.fraction);
    const vector zeta = zeta_of(state);
    laconic_load load;
    vector rate;
    int k;
    laconic_load_of(&load, m, in);
    rate = zeta_rate(m, zeta, load_now(&load, &state->heading, R(0)));
    for (k = 0; k < 3; k++) {
        now->nu[k] = dot(vec(m->nu_of_zeta[k]), zeta);
        now->nu_rate[k] = dot(vec(m->nu_of_zeta[k]), rate);
    }
    take_wrench(now->wrench, in, heading);
    laconic_wheel_torques(m, state, in, now->torque);
}

/* κ from A ν' − Λ⁻¹a − (MR²)⁻¹(Ξᵀ M + w) = Cᵀκ */
static void multipliers(real *kappa, const laconic_contact *c, const laconic_model *m, const instant *now) {
    const real yaw_rate = now->nu[2] / m->yaw_scale, radius = m->wheel_radius_m;
    real left[3];
    int32_t i, k;
    for (k = 0; k < 3; k++) left[k] = dot(vec(c->inertia[k]), vec(now->nu_rate));
    left[0] -= yaw_rate * now->nu[1] + m->torque_scale * radius * now->wrench[0];
    left[1] -= -yaw_rate * now->nu[0] + m->torque_scale * radius * now->wrench[1];
    left[2] -= m->torque_scale * now->wrench[2] / m->yaw_scale;
    for (i = 0; i < m->wheel_count; i++)
        for (k = 0; k < 3; k++) left[k] -= m->torque_scale * now->torque[i] * c->wheel_rows[i][k];
    for (i = 0; i < c->constraint_count; i++) kappa[i] = dot(vec(c->multiplier[i]), vec(left));
}

static void wheel_reaction(laconic_reactions *out, const laconic_contact *c, const laconic_model *m, const instant *now,
                           const real *kappa, int32_t i) {
    const real unit_Nm = m->mass_kg * m->wheel_radius_m * m->wheel_radius_m;
    const int32_t lateral = c->lateral_row[i], brake = c->brake_row[i];
    real acceleration = R(0);
    out->lateral_N[i] = lateral >= 0 ? kappa[lateral] * (m->mass_kg * m->wheel_radius_m) : R(0);
    out->brake_Nm[i] = brake >= 0 ? kappa[brake] * unit_Nm : R(0);
    if (brake < 0) acceleration = dot(vec(c->wheel_rows[i]), vec(now->nu_rate));
    out->along_N[i] =
        (now->torque[i] + out->brake_Nm[i] - m->wheel_inertia_kgm2 * acceleration) * c->inverse_arm_per_m[i];
}

/* Σ N = M g; about S the loads balance the ground's horizontal force, which acts com_z below it (outer forces
 * are taken to act at the height of S). Columns of `load_of_wrench`: R Σ N, Σ N ξ, Σ N η. */
static void normal_loads(laconic_reactions *out, const laconic_contact *c, const laconic_model *m) {
    const real weight = m->mass_kg * R(LACONIC_GRAVITY_M_PER_S2);
    real wanted[3], ground[2] = {R(0), R(0)};
    int32_t i;
    for (i = 0; i < m->wheel_count; i++) {
        ground[0] += out->along_N[i] * c->pull[i][0] + out->lateral_N[i] * c->axle[i][0];
        ground[1] += out->along_N[i] * c->pull[i][1] + out->lateral_N[i] * c->axle[i][1];
    }
    wanted[0] = m->wheel_radius_m * weight;
    wanted[1] = -c->com_z_m * ground[0];
    wanted[2] = -c->com_z_m * ground[1];
    for (i = 0; i < c->point_count; i++) out->normal_N[i] = dot(vec(c->load_of_wrench[i]), vec(wanted));
}

static void no_slip_margin(laconic_reactions *out, const laconic_contact *c, const laconic_model *m) {
    int32_t i;
    out->no_slip_margin_N = R(0);
    for (i = 0; i < m->wheel_count; i++) {
        const real needed = laconic_root(out->along_N[i] * out->along_N[i] + out->lateral_N[i] * out->lateral_N[i]);
        const real margin = c->friction_coefficient * out->normal_N[i] - needed;
        if (i == 0 || margin < out->no_slip_margin_N || margin != margin)
            out->no_slip_margin_N = margin; /* where one is NaN, all is */
    }
}

void laconic_reactions_of(laconic_reactions *reactions, const laconic_contact *contact, const laconic_model *model,
                          const laconic_state *state, const laconic_input *input) {
    instant now;
    real kappa[2 * LACONIC_MAX_WHEELS];
    int32_t i;
    take_instant(&now, model, state, input);
    multipliers(kappa, contact, model, &now);
    for (i = 0; i < model->wheel_count; i++) wheel_reaction(reactions, contact, model, &now, kappa, i);
    normal_loads(reactions, contact, model);
    no_slip_margin(reactions, contact, model);
}
