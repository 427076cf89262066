/* The analytic linearisation of (4.7) and of the outputs along a direction of states and inputs. */
#include "load.h"
#include "zeta.h"

typedef struct wrench { /* a wrench or its change: F_ξ, F_η, τ about S, all in body axes */
    real along, across, moment;
} wrench;

/* Turning the body by dθ turns a force that is fixed in the world by −dθ against it. */
static wrench wrench_change(const laconic_input *in, direction heading, const laconic_variation *by) {
    const real *f = in->world_force_N, *df = by->input.world_force_N;
    const real *r = in->world_force_point_m, *dr = by->input.world_force_point_m;
    const real along = heading.cosine * f[0] + heading.sine * f[1];
    const real across = heading.cosine * f[1] - heading.sine * f[0];
    const real d_along = heading.cosine * df[0] + heading.sine * df[1] + by->heading_rad * across;
    const real d_across = heading.cosine * df[1] - heading.sine * df[0] - by->heading_rad * along;
    const wrench w = {by->input.body_force_N[0] + d_along, by->input.body_force_N[1] + d_across,
                      by->input.body_moment_Nm + (dr[0] * across - dr[1] * along) + (r[0] * d_across - r[1] * d_along)};
    return w;
}

/* b of a wrench and of the torques besides the damping, both linear. */
static vector load_of_wrench(const laconic_model *m, const laconic_input *in, wrench w) {
    vector b =
        scaled(m->torque_scale,
               plus(plus(scaled(w.along, vec(m->velocity_of_zeta[0])), scaled(w.across, vec(m->velocity_of_zeta[1]))),
                    scaled(w.moment, vec(m->yaw_rate_of_zeta))));
    int32_t i;
    for (i = 0; i < m->wheel_count; i++)
        b = plus(b, scaled(m->voltage_scale * in->voltage_V[i] + m->torque_scale * in->axle_torque_Nm[i],
                           vec(m->wheel_of_zeta[i])));
    return b;
}

/* d[(g·ζ)(ζ×w) − diag(r)ζ + b] */
static vector rate_change(const laconic_model *m, vector zeta, vector d_zeta, vector d_load) {
    const vector gyro = vec(m->gyro), yaw = vec(m->nu_of_zeta[2]);
    const vector turning =
        plus(scaled(dot(yaw, d_zeta), cross(zeta, gyro)), scaled(dot(yaw, zeta), cross(d_zeta, gyro)));
    return plus(turning, minus(d_load, times(vec(m->decay_per_s), d_zeta)));
}

void laconic_derivative_tangent(laconic_rates *change, const laconic_model *model, const laconic_motion *at,
                                const laconic_input *input, const laconic_variation *by) {
    const direction heading = laconic_direction_of_angle(at->heading_rad);
    const vector zeta = zeta_of_nu(model, at->nu_rad_per_s), d_zeta = zeta_of_nu(model, by->nu_rad_per_s);
    const vector d_load = load_of_wrench(model, &by->input, wrench_change(input, heading, by));
    const vector d_rate = rate_change(model, zeta, d_zeta, d_load);
    const real along = dot(vec(model->velocity_of_zeta[0]), zeta), across = dot(vec(model->velocity_of_zeta[1]), zeta);
    const real d_along = dot(vec(model->velocity_of_zeta[0]), d_zeta) - by->heading_rad * across;
    const real d_across = dot(vec(model->velocity_of_zeta[1]), d_zeta) + by->heading_rad * along;
    int32_t i;
    for (i = 0; i < 3; i++) change->nu_rad_per_s2[i] = dot(vec(model->nu_of_zeta[i]), d_rate);
    change->x_m_per_s = d_along * heading.cosine - d_across * heading.sine;
    change->y_m_per_s = d_along * heading.sine + d_across * heading.cosine;
    change->yaw_rate_rad_per_s = dot(vec(model->yaw_rate_of_zeta), d_zeta);
    for (i = 0; i < model->wheel_count; i++)
        change->wheel_speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), d_zeta);
}

void laconic_motion_tangent(laconic_motion_change *change, const laconic_model *model, const laconic_motion *at,
                            const laconic_variation *by) {
    const direction heading = laconic_direction_of_angle(at->heading_rad);
    const vector zeta = zeta_of_nu(model, at->nu_rad_per_s), d_zeta = zeta_of_nu(model, by->nu_rad_per_s);
    const real sx = model->com_x_m, sy = model->com_y_m, turn = by->heading_rad;
    int32_t i;
    change->origin_x_m = by->x_m + turn * (heading.sine * sx + heading.cosine * sy);
    change->origin_y_m = by->y_m - turn * (heading.cosine * sx - heading.sine * sy);
    change->velocity_m_per_s[0] = dot(vec(model->velocity_of_zeta[0]), d_zeta);
    change->velocity_m_per_s[1] = dot(vec(model->velocity_of_zeta[1]), d_zeta);
    change->yaw_rate_rad_per_s = dot(vec(model->yaw_rate_of_zeta), d_zeta);
    change->energy_J = dot(zeta, d_zeta) * (model->mass_kg * model->wheel_radius_m * model->wheel_radius_m);
    for (i = 0; i < model->wheel_count; i++) {
        change->wheel_speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), d_zeta);
        change->wheel_torque_Nm[i] = model->motor_gain_Nm_per_V * by->input.voltage_V[i] -
                                     model->motor_damping_Nms * change->wheel_speed_rad_per_s[i] +
                                     by->input.axle_torque_Nm[i];
    }
}

/* ------------------------------------------------------------------------- ground reactions -- */

/* d of A ν' − Λ⁻¹a − (MR²)⁻¹(Ξᵀ M + w): what the constraints' multipliers answer for. */
static vector imbalance_change(const laconic_contact *c, const laconic_model *m, const laconic_motion *at,
                               const laconic_input *input, const laconic_variation *by, const laconic_rates *d_rates,
                               const real *d_torque) {
    const vector zeta = zeta_of_nu(m, at->nu_rad_per_s), d_zeta = zeta_of_nu(m, by->nu_rad_per_s);
    const wrench dw = wrench_change(input, laconic_direction_of_angle(at->heading_rad), by);
    const real rate = dot(vec(m->yaw_rate_of_zeta), zeta), d_rate = dot(vec(m->yaw_rate_of_zeta), d_zeta);
    const real force = m->torque_scale * m->wheel_radius_m;
    const real nu[2] = {dot(vec(m->nu_of_zeta[0]), zeta), dot(vec(m->nu_of_zeta[1]), zeta)};
    const real d_nu[2] = {dot(vec(m->nu_of_zeta[0]), d_zeta), dot(vec(m->nu_of_zeta[1]), d_zeta)};
    vector left = {dot(vec(c->inertia[0]), vec(d_rates->nu_rad_per_s2)),
                   dot(vec(c->inertia[1]), vec(d_rates->nu_rad_per_s2)),
                   dot(vec(c->inertia[2]), vec(d_rates->nu_rad_per_s2))};
    int32_t i;
    left.x -= d_rate * nu[1] + rate * d_nu[1] + force * dw.along;
    left.y -= -(d_rate * nu[0] + rate * d_nu[0]) + force * dw.across;
    left.z -= m->torque_scale * dw.moment / m->yaw_scale;
    for (i = 0; i < m->wheel_count; i++)
        left = minus(left, scaled(m->torque_scale * d_torque[i], vec(c->wheel_rows[i])));
    return left;
}

static void wheel_change(laconic_reactions *change, const laconic_contact *c, const laconic_model *m,
                         const laconic_rates *d_rates, real d_torque, vector left, int32_t i) {
    const int32_t lateral = c->lateral_row[i], brake = c->brake_row[i];
    const real unit_N = m->mass_kg * m->wheel_radius_m;
    real d_acceleration = R(0);
    change->lateral_N[i] = lateral >= 0 ? dot(vec(c->multiplier[lateral]), left) * unit_N : R(0);
    change->brake_Nm[i] = brake >= 0 ? dot(vec(c->multiplier[brake]), left) * (unit_N * m->wheel_radius_m) : R(0);
    if (brake < 0) d_acceleration = dot(vec(c->wheel_rows[i]), vec(d_rates->nu_rad_per_s2));
    change->along_N[i] =
        (d_torque + change->brake_Nm[i] - m->wheel_inertia_kgm2 * d_acceleration) * c->inverse_arm_per_m[i];
}

static void normal_change(laconic_reactions *change, const laconic_contact *c, const laconic_model *m) {
    real ground[2] = {R(0), R(0)};
    int32_t i;
    for (i = 0; i < m->wheel_count; i++) {
        ground[0] += change->along_N[i] * c->pull[i][0] + change->lateral_N[i] * c->axle[i][0];
        ground[1] += change->along_N[i] * c->pull[i][1] + change->lateral_N[i] * c->axle[i][1];
    }
    for (i = 0; i < c->point_count; i++)
        change->normal_N[i] = -c->com_z_m * (c->load_of_wrench[i][1] * ground[0] + c->load_of_wrench[i][2] * ground[1]);
}

/* The margin is the least over the wheels: its change is that of the wheel which is least now. */
static void margin_change(laconic_reactions *change, const laconic_contact *c, const laconic_model *m,
                          const laconic_reactions *now) {
    real least = R(0);
    int32_t i;
    change->no_slip_margin_N = R(0);
    for (i = 0; i < m->wheel_count; i++) {
        const real a = now->along_N[i], l = now->lateral_N[i], needed = laconic_root(a * a + l * l);
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
    laconic_rates d_rates;
    laconic_motion_change d_motion;
    vector left;
    int32_t i;
    laconic_derivative_tangent(&d_rates, model, at, input, by);
    laconic_motion_tangent(&d_motion, model, at, by);
    left = imbalance_change(contact, model, at, input, by, &d_rates, d_motion.wheel_torque_Nm);
    for (i = 0; i < model->wheel_count; i++)
        wheel_change(change, contact, model, &d_rates, d_motion.wheel_torque_Nm[i], left, i);
    normal_change(change, contact, model);
    margin_change(change, contact, model, now);
}
