/* Inputs → what acts and is commanded at each moment of a step. Forces vary linearly over the step. Rates and twist are
 * the cubics through both values with both derivatives (Hermite): with Δ = p₁ − p₀, a = h p',
 *     p = p₀ + s(a₀ + s(c₂ + s c₃)),   c₂ = 3Δ − 2a₀ − a₁,   c₃ = a₀ + a₁ − 2Δ,   s from 0 to 1. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

/* NaN counts as acting. */
static bool acts_on(real x, real y) { return !(x == R(0) && y == R(0)); }

/* T of the body frame's origin as it is at S_0. */
static vector twist_at_com(const laconic_articulated_model *m, const real t[3]) {
    return vector_of(t[0] - t[2] * m->com_y_m, t[1] + t[2] * m->com_x_m, t[2]);
}

static void add_wheel_forces(articulated_drive *drive, const laconic_articulated_model *m, const laconic_input *in) {
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_articulated_wheel *w = &m->wheel[i];
        const real torque = w->gain_Nm_per_V * in->voltage_V[i] + in->axle_torque_Nm[i];
        if (torque == R(0)) continue;
        drive->force[w->body] = plus(drive->force[w->body], scaled(torque, w->roll));
    }
}

void laconic_articulated_drive_of(articulated_drive *drive, const laconic_articulated_model *m,
                                  const laconic_articulated_input *input) {
    const laconic_input *in = &input->base;
    drive->force[0] = vector_of(in->body_force_N[0], in->body_force_N[1], in->body_moment_Nm);
    for (int32_t b = 0; b < m->body_count; b++) {
        const laconic_hinge_motion motion = m->link[b].motion;
        const bool prescribed = motion == LACONIC_MOTION_PRESCRIBED;
        drive->force[b + 1] = none;
        drive->torque[b] = R(0);
        if (motion <= LACONIC_MOTION_OWN)
            drive->torque[b] = m->link[b].gain_Nm_per_V * input->hinge_voltage_V[b] + input->hinge_torque_Nm[b];
        drive->rate[b] = prescribed ? input->hinge_rate_rad_per_s[b] : R(0);
        drive->acceleration[b] = prescribed ? input->hinge_acceleration_rad_per_s2[b] : R(0);
    }
    add_wheel_forces(drive, m, in);
    drive->twist[0] = m->coordinated ? twist_at_com(m, input->twist) : none;
    drive->twist[1] = m->coordinated ? twist_at_com(m, input->twist_rate) : none;
    drive->twist[2] = none;
    for (int k = 0; k < 2; k++) {
        drive->world_force[k] = in->world_force_N[k];
        drive->world_force_point[k] = in->world_force_point_m[k];
    }
    drive->rotates = acts_on(drive->world_force[0], drive->world_force[1]) ||
                     acts_on(m->slope_acceleration.x, m->slope_acceleration.y);
}

void laconic_articulated_drive_kept(articulated_drive *drive, const laconic_articulated_model *m,
                                    const laconic_articulated_state *state) {
    const articulated_drive still = ALL_ZERO;
    *drive = still;
    for (int32_t b = 0; b < m->body_count; b++) drive->rate[b] = state->hinge_rate_rad_per_s[b];
    drive->twist[0] = state->twist;
    drive->twist[1] = state->twist_rate;
}

/* --------------------------------------------------------------------------- between both ends -- */

static real between(real a, real b, real at) { return a + at * (b - a); }

static vector between_vectors(vector a, vector b, real at) { return plus(a, scaled(at, minus(b, a))); }

/* p, p' and p'' of the cubic. */
typedef struct cubic {
    real value, rate, curve;
} cubic;

static cubic cubic_at(real p0, real p1, real d0, real d1, const articulated_course *c, real s) {
    const real change = p1 - p0, a0 = c->step_s * d0, a1 = c->step_s * d1;
    const real c2 = R(3) * change - R(2) * a0 - a1, c3 = a0 + a1 - R(2) * change;
    cubic p;
    p.value = p0 + s * (a0 + s * (c2 + s * c3));
    p.rate = c->rate_per_step * (a0 + s * (R(2) * c2 + R(3) * s * c3));
    p.curve = c->rate_per_step * c->rate_per_step * (R(2) * c2 + R(6) * s * c3);
    return p;
}

static void twist_between(articulated_drive *drive, const articulated_course *c, real at) {
    const vector *a = c->start.twist, *b = c->end.twist;
    const cubic x = cubic_at(a[0].x, b[0].x, a[1].x, b[1].x, c, at);
    const cubic y = cubic_at(a[0].y, b[0].y, a[1].y, b[1].y, c, at);
    const cubic z = cubic_at(a[0].z, b[0].z, a[1].z, b[1].z, c, at);
    drive->twist[0] = vector_of(x.value, y.value, z.value);
    drive->twist[1] = vector_of(x.rate, y.rate, z.rate);
    drive->twist[2] = vector_of(x.curve, y.curve, z.curve);
}

void laconic_articulated_drive_at(articulated_drive *drive, const articulated_course *course,
                                  const laconic_articulated_model *m, real at) {
    const articulated_drive *a = &course->start, *b = &course->end;
    for (int32_t k = 0; k <= m->body_count; k++) drive->force[k] = between_vectors(a->force[k], b->force[k], at);
    for (int32_t k = 0; k < m->body_count; k++) {
        drive->torque[k] = between(a->torque[k], b->torque[k], at);
        if (m->link[k].motion != LACONIC_MOTION_PRESCRIBED) {
            drive->rate[k] = drive->acceleration[k] = R(0);
            continue;
        }
        const cubic r = cubic_at(a->rate[k], b->rate[k], a->acceleration[k], b->acceleration[k], course, at);
        drive->rate[k] = r.value;
        drive->acceleration[k] = r.rate;
    }
    if (m->coordinated) twist_between(drive, course, at);
    for (int k = 0; k < 2; k++) {
        drive->world_force[k] = between(a->world_force[k], b->world_force[k], at);
        drive->world_force_point[k] = between(a->world_force_point[k], b->world_force_point[k], at);
    }
    drive->rotates = a->rotates || b->rotates;
}

/* ----------------------------------------------------------------------------------- checks -- */

bool laconic_articulated_drive_is_finite(const articulated_drive *drive, const laconic_articulated_model *m) {
    real zero = zero_if_finite(drive->world_force[0] + drive->world_force[1]) +
                zero_if_finite(drive->world_force_point[0] + drive->world_force_point[1]) +
                zero_if_finite(size(drive->force[0]) + size(drive->twist[0]) + size(drive->twist[1]));
    for (int32_t b = 0; b < m->body_count; b++)
        zero += zero_if_finite(size(drive->force[b + 1]) + magnitude(drive->torque[b]) + magnitude(drive->rate[b]) +
                               magnitude(drive->acceleration[b]));
    return zero == R(0);
}

/* What of a twist is not a motion of the carriage. */
static real against_wheels(const laconic_articulated_model *m, vector twist) {
    const vector momentum = form_times(&m->inertia, twist);
    vector rest = twist;
    for (int32_t k = 0; k < m->column_count; k++)
        rest = minus(rest, scaled(dot(m->column[k], momentum), m->column[k]));
    return magnitude(rest.x) + magnitude(rest.y) + m->length_m * magnitude(rest.z);
}

static laconic_status check_against_wheels(const laconic_articulated_model *m, const articulated_drive *drive,
                                           laconic_refusal *why) {
    for (int k = 0; k < 2 && m->column_count < 3; k++) {
        const vector t = drive->twist[k];
        const real whole = magnitude(t.x) + magnitude(t.y) + m->length_m * magnitude(t.z);
        const real off = against_wheels(m, t);
        if (off > R(10) * LACONIC_RANK_TOLERANCE * whole)
            return refuse(why, LACONIC_TWIST_AGAINST_WHEELS,
                          (laconic_field)(k == 0 ? LACONIC_FIELD_OF_TWIST : LACONIC_FIELD_OF_TWIST_RATE), 0,
                          off / whole, R(0));
    }
    return LACONIC_OK;
}

laconic_status laconic_articulated_check_twist(const laconic_articulated_model *m, const articulated_drive *from,
                                               const articulated_drive *to, real largest_turn_rad,
                                               laconic_refusal *why) {
    laconic_status status = check_against_wheels(m, to, why);
    for (int32_t b = 1; status == LACONIC_OK && b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        direction d, e;
        real rate, acceleration;
        if (link->motion != LACONIC_MOTION_COORDINATED) continue;
        if (!laconic_articulated_coordinate(&d, &rate, &acceleration, link, from->twist))
            return laconic_articulated_refuse_twist(b, m, from, why);
        if (!laconic_articulated_coordinate(&e, &rate, &acceleration, link, to->twist))
            return laconic_articulated_refuse_twist(b, m, to, why);
        const real turn = laconic_articulated_angle_of(from_to(d, e));
        if (magnitude(turn) > largest_turn_rad)
            return refuse(why, LACONIC_TWIST_JUMPS, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE, b, turn,
                          largest_turn_rad);
    }
    return status;
}

#endif
