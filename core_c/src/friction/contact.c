/* Reactions of the ground, torques of brakes, normal loads, the no-slip margin; and their derivatives along a
 * variation. */
#include "geometry.h"
#include "least_norm.h"
#include "step_internals.h"
#include "wrench.h"

static void fill_wheels(laconic_contact *contact, const laconic_vehicle *vehicle) {
    int32_t row = 0;
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        const laconic_wheel *wheel = &vehicle->wheel[i];
        const direction axle = laconic_direction_of_angle(wheel->axle_rad);
        direction pull;
        contact->inverse_arm_per_m[i] =
            R(1) / (laconic_wheel_values(vehicle, i).radius_m * laconic_pull_direction(&pull, wheel));
        contact->pull[i][0] = pull.cosine;
        contact->pull[i][1] = pull.sine;
        contact->axle[i][0] = axle.cosine;
        contact->axle[i][1] = axle.sine;
        contact->lateral_row[i] = wheel->kind == LACONIC_WHEEL_FIXED ? row++ : -1;
        contact->brake_row[i] = wheel->locked ? row++ : -1;
    }
}

static void fill_points(laconic_contact *contact, const laconic_vehicle *vehicle, const body *b) {
    const int32_t n = vehicle->wheel_count;
    real rows[LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS][3];
    contact->point_count = n + vehicle->support_count;
    for (int32_t i = 0; i < contact->point_count; i++) {
        contact->point_m[i][0] = (i < n ? vehicle->wheel[i].x_m : vehicle->support[i - n].x_m) - b->com_x_m;
        contact->point_m[i][1] = (i < n ? vehicle->wheel[i].y_m : vehicle->support[i - n].y_m) - b->com_y_m;
        rows[i][0] = b->radius_m; /* a length, so that the three balances have one unit */
        rows[i][1] = contact->point_m[i][0];
        rows[i][2] = contact->point_m[i][1];
    }
    laconic_least_norm(contact->normal_load_of_wrench, (const real(*)[3])rows, contact->point_count);
}

/* Of the constants that laconic_matrices_of() has not checked. */
static real contact_size(const laconic_contact *c, int32_t wheel_count) {
    real sum = rows_size(c->multiplier, c->constraint_count) + rows_size(c->normal_load_of_wrench, c->point_count) +
               c->com_z_m + c->friction_coefficient;
    for (int32_t i = 0; i < wheel_count; i++) sum += magnitude(c->inverse_arm_per_m[i]);
    for (int32_t i = 0; i < c->point_count; i++) sum += magnitude(c->point_m[i][0]) + magnitude(c->point_m[i][1]);
    return sum;
}

/* Square to the ground. */
static real gravity_on(const laconic_vehicle *vehicle) {
#if LACONIC_WITH_SLOPE
    return R(LACONIC_GRAVITY_M_PER_S2) * laconic_direction_of_angle(vehicle->ground.slope_rad).cosine;
#else
    return (void)vehicle, R(LACONIC_GRAVITY_M_PER_S2);
#endif
}

laconic_status laconic_contact_prepare(laconic_contact *contact, const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_matrices matrices;
    laconic_contact fresh = ALL_ZERO;
    body b;
    const laconic_status status = laconic_matrices_of(&matrices, vehicle, why);
    if (status != LACONIC_OK) return status;
    laconic_body_of(&b, vehicle);
    fill_wheels(&fresh, vehicle);
    fill_points(&fresh, vehicle, &b);
    fresh.constraint_count = matrices.constraint_count;
    laconic_least_norm(fresh.multiplier, (const real(*)[3])matrices.constraint_rows, matrices.constraint_count);
    for (int32_t i = 0; i < 3; i++)
        for (int32_t k = 0; k < 3; k++) fresh.inertia[i][k] = matrices.inertia[i][k];
    for (int32_t i = 0; i < vehicle->wheel_count; i++)
        for (int32_t k = 0; k < 3; k++) fresh.wheel_rows[i][k] = matrices.wheel_rows[i][k];
    fresh.com_z_m = vehicle->com_z_m;
    fresh.gravity_m_per_s2 = gravity_on(vehicle);
    fresh.friction_coefficient = vehicle->friction_coefficient;
    if (!fits_squared(contact_size(&fresh, vehicle->wheel_count)))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *contact = fresh;
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------- at one moment -- */

/* The quantities in which the reactions are linear: of a motion, or their derivatives. */
typedef struct instant {
    real nu_rate[3];
    real gyro[2]; /* Λ⁻¹a of (4.7) */
    wrench outer;
    real torque_Nm[LACONIC_MAX_WHEELS];
    real weight_N;
} instant;

static void fill_instant(instant *now, const laconic_contact *c, const laconic_model *m, const laconic_state *state,
                         const laconic_input *in) {
    const vector zeta = zeta_of(state);
    laconic_forcing forcing;
    real nu[3], yaw_rate;
    laconic_forcing_of(&forcing, m, in);
    const vector rate = zeta_rate(m, zeta, forcing_after_yaw(&forcing, &state->heading, R(0)));
    for (int k = 0; k < 3; k++) {
        nu[k] = dot(vec(m->nu_of_zeta[k]), zeta);
        now->nu_rate[k] = dot(vec(m->nu_of_zeta[k]), rate);
    }
    yaw_rate = nu[2] / m->yaw_scale;
    now->gyro[0] = yaw_rate * nu[1];
    now->gyro[1] = -yaw_rate * nu[0];
    now->outer = wrench_of(m, in, laconic_direction_of_binary_angle(state->heading.fraction));
    now->weight_N = m->mass_kg * c->gravity_m_per_s2;
    laconic_wheel_torques(m, state, in, now->torque_Nm);
}

/* A ν' − Λ⁻¹a − (MR²)⁻¹(Ξᵀ M_i + F) = Cᵀκ: the part of the balance that the multipliers κ supply. */
static vector left_to_multipliers(const laconic_contact *c, const laconic_model *m, const instant *now) {
    const real force = m->torque_scale * m->wheel_radius_m;
    vector remainder = {dot(vec(c->inertia[0]), vec(now->nu_rate)), dot(vec(c->inertia[1]), vec(now->nu_rate)),
                        dot(vec(c->inertia[2]), vec(now->nu_rate))};
    remainder.x -= now->gyro[0] + force * now->outer.along;
    remainder.y -= now->gyro[1] + force * now->outer.across;
    remainder.z -= m->torque_scale * now->outer.moment / m->yaw_scale;
    for (int32_t i = 0; i < m->wheel_count; i++)
        remainder = minus(remainder, scaled(m->torque_scale * now->torque_Nm[i], vec(c->wheel_rows[i])));
    return remainder;
}

static void wheel_reaction(laconic_reactions *out, const laconic_contact *c, const laconic_model *m, const instant *now,
                           vector remainder, int32_t i) {
    const real unit_N = m->mass_kg * m->wheel_radius_m;
    const int32_t lateral = c->lateral_row[i], brake = c->brake_row[i];
    real acceleration = R(0);
    out->lateral_N[i] = lateral >= 0 ? dot(vec(c->multiplier[lateral]), remainder) * unit_N : R(0);
    out->brake_Nm[i] = brake >= 0 ? dot(vec(c->multiplier[brake]), remainder) * (unit_N * m->wheel_radius_m) : R(0);
    if (brake < 0) acceleration = dot(vec(c->wheel_rows[i]), vec(now->nu_rate));
    out->along_N[i] =
        (now->torque_Nm[i] + out->brake_Nm[i] - m->wheel_inertia_kgm2[own(i)] * acceleration) * c->inverse_arm_per_m[i];
}

/* Σ N = M g; about S the normal loads balance the ground's horizontal force, which acts com_z below it (outer forces
 * are taken to act at the height of S). Columns of `normal_load_of_wrench`: R Σ N, Σ N ξ, Σ N η. */
static void fill_normal_loads(laconic_reactions *out, const laconic_contact *c, const laconic_model *m, real weight_N) {
    real wanted[3], ground[2] = {R(0), R(0)};
    for (int32_t i = 0; i < m->wheel_count; i++) {
        ground[0] += out->along_N[i] * c->pull[i][0] + out->lateral_N[i] * c->axle[i][0];
        ground[1] += out->along_N[i] * c->pull[i][1] + out->lateral_N[i] * c->axle[i][1];
    }
    wanted[0] = m->wheel_radius_m * weight_N;
    wanted[1] = -c->com_z_m * ground[0];
    wanted[2] = -c->com_z_m * ground[1];
    for (int32_t i = 0; i < c->point_count; i++) out->normal_N[i] = dot(vec(c->normal_load_of_wrench[i]), vec(wanted));
}

/* All but the margin, which is not linear. */
static void linear_reactions(laconic_reactions *out, const laconic_contact *c, const laconic_model *m,
                             const instant *now) {
    const vector remainder = left_to_multipliers(c, m, now);
    for (int32_t i = 0; i < m->wheel_count; i++) wheel_reaction(out, c, m, now, remainder, i);
    fill_normal_loads(out, c, m, now->weight_N);
}

static real reaction_size(const laconic_reactions *r, int32_t i) {
    return laconic_root(r->along_N[i] * r->along_N[i] + r->lateral_N[i] * r->lateral_N[i]);
}

static void no_slip_margin(laconic_reactions *out, const laconic_contact *c, const laconic_model *m) {
    out->no_slip_margin_N = R(0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const real margin = c->friction_coefficient * out->normal_N[i] - reaction_size(out, i);
        if (i == 0 || margin < out->no_slip_margin_N || margin != margin)
            out->no_slip_margin_N = margin; /* one NaN makes the margin NaN */
    }
}

void laconic_reactions_of(laconic_reactions *reactions, const laconic_contact *contact, const laconic_model *model,
                          const laconic_state *state, const laconic_input *input) {
    instant now;
    fill_instant(&now, contact, model, state, input);
    linear_reactions(reactions, contact, model, &now);
    no_slip_margin(reactions, contact, model);
}

/* --------------------------------------------------------------------- along a variation -- */

static void fill_change(instant *change, const laconic_model *m, const laconic_motion *at, const laconic_input *input,
                        const laconic_variation *by) {
    const vector zeta = zeta_of_nu(m, at->nu_rad_per_s), d_zeta = zeta_of_nu(m, by->nu_rad_per_s);
    const real rate = dot(vec(m->yaw_rate_of_zeta), zeta), d_rate = dot(vec(m->yaw_rate_of_zeta), d_zeta);
    laconic_rates rates;
    laconic_motion_change outputs;
    laconic_derivative_tangent(&rates, m, at, input, by);
    laconic_motion_tangent(&outputs, m, at, by);
    for (int32_t i = 0; i < 3; i++) change->nu_rate[i] = rates.nu_rad_per_s2[i];
    for (int32_t i = 0; i < m->wheel_count; i++) change->torque_Nm[i] = outputs.wheel_torque_Nm[i];
    change->gyro[0] = d_rate * dot(vec(m->nu_of_zeta[1]), zeta) + rate * dot(vec(m->nu_of_zeta[1]), d_zeta);
    change->gyro[1] = -(d_rate * dot(vec(m->nu_of_zeta[0]), zeta) + rate * dot(vec(m->nu_of_zeta[0]), d_zeta));
    change->outer = wrench_change(m, input, laconic_direction_of_angle(at->heading_rad), by);
    change->weight_N = R(0);
}

/* The margin is the least over the wheels: its derivative is that of the wheel whose margin is least now. */
static void margin_change(laconic_reactions *change, const laconic_contact *c, const laconic_model *m,
                          const laconic_reactions *now) {
    real least = R(0);
    change->no_slip_margin_N = R(0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const real a = now->along_N[i], l = now->lateral_N[i], needed = reaction_size(now, i);
        const real margin = c->friction_coefficient * now->normal_N[i] - needed;
        const real d_needed = needed > R(0) ? (a * change->along_N[i] + l * change->lateral_N[i]) / needed : R(0);
        if (i > 0 && !(margin < least)) continue;
        least = margin;
        change->no_slip_margin_N = c->friction_coefficient * change->normal_N[i] - d_needed;
    }
}

void laconic_reactions_tangent(laconic_reactions *change, const laconic_contact *contact, const laconic_model *model,
                               const laconic_motion *at, const laconic_input *input, const laconic_reactions *now,
                               const laconic_variation *by) {
    instant instant_change;
    fill_change(&instant_change, model, at, input, by);
    linear_reactions(change, contact, model, &instant_change);
    margin_change(change, contact, model, now);
}
