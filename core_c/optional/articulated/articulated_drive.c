/* Inputs → what acts and is commanded at each moment of a step. Forces vary linearly over the step. Rates and twist are
 * the cubics through both values with both derivatives (Hermite): with Δ = p₁ − p₀, a = h p',
 *     p = p₀ + s(a₀ + s(c₂ + s c₃)),   c₂ = 3Δ − 2a₀ − a₁,   c₃ = a₀ + a₁ − 2Δ,   s from 0 to 1. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

static bool is_not_0(vector v) { return v.x != R(0) || v.y != R(0) || v.z != R(0); }

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
    drive->turns = m->coordinated && is_not_0(drive->twist[1]);
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
    drive->turns = is_not_0(state->twist_rate);
}

/* --------------------------------------------------------------------------- between both ends -- */

static articulated_cubic cubic_of(real p0, real p1, real d0, real d1, real h) {
    const real change = p1 - p0, a0 = h * d0, a1 = h * d1;
    const articulated_cubic c = {p0, a0, R(3) * change - R(2) * a0 - a1, a0 + a1 - R(2) * change};
    return c;
}

static bool forces_differ(const articulated_course *c, const laconic_articulated_model *m) {
    const articulated_drive *a = &c->start, *b = &c->end;
    real sum = magnitude(a->world_force[0] - b->world_force[0]) + magnitude(a->world_force[1] - b->world_force[1]) +
               magnitude(a->world_force_point[0] - b->world_force_point[0]) +
               magnitude(a->world_force_point[1] - b->world_force_point[1]) + size(minus(a->force[0], b->force[0]));
    for (int32_t k = 0; k < m->body_count; k++)
        sum += size(minus(a->force[k + 1], b->force[k + 1])) + magnitude(a->torque[k] - b->torque[k]);
    return sum > R(0);
}

void laconic_articulated_course_of(articulated_course *course, const laconic_articulated_model *m) {
    const articulated_drive *a = &course->start, *b = &course->end;
    const real h = course->step_s;
    course->forces_vary = forces_differ(course, m);
    for (int32_t k = 0; k < m->body_count; k++)
        if (m->link[k].motion == LACONIC_MOTION_PRESCRIBED)
            course->rate[k] = cubic_of(a->rate[k], b->rate[k], a->acceleration[k], b->acceleration[k], h);
    course->turns = false;
    if (!m->coordinated) return;
    course->twist[0] = cubic_of(a->twist[0].x, b->twist[0].x, a->twist[1].x, b->twist[1].x, h);
    course->twist[1] = cubic_of(a->twist[0].y, b->twist[0].y, a->twist[1].y, b->twist[1].y, h);
    course->twist[2] = cubic_of(a->twist[0].z, b->twist[0].z, a->twist[1].z, b->twist[1].z, h);
    course->turns = is_not_0(minus(a->twist[0], b->twist[0])) || is_not_0(a->twist[1]) || is_not_0(b->twist[1]);
}

static real between(real a, real b, real at) { return a + at * (b - a); }

static void forces_at(articulated_drive *drive, const articulated_course *course, const laconic_articulated_model *m,
                      real at) {
    const articulated_drive *a = &course->start, *b = &course->end;
    for (int32_t k = 0; k <= m->body_count; k++)
        drive->force[k] = plus(a->force[k], scaled(at, minus(b->force[k], a->force[k])));
    for (int32_t k = 0; k < m->body_count; k++) drive->torque[k] = between(a->torque[k], b->torque[k], at);
    for (int k = 0; k < 2; k++) {
        drive->world_force[k] = between(a->world_force[k], b->world_force[k], at);
        drive->world_force_point[k] = between(a->world_force_point[k], b->world_force_point[k], at);
    }
    drive->rotates = a->rotates || b->rotates;
}

static real cubic_value(const articulated_cubic *c, real s) {
    return c->start + s * (c->slope + s * (c->square + s * c->cube));
}

static real cubic_rate(const articulated_cubic *c, real s, real per_step) {
    return per_step * (c->slope + s * (R(2) * c->square + R(3) * s * c->cube));
}

static real cubic_curve(const articulated_cubic *c, real s, real per_step) {
    return per_step * per_step * (R(2) * c->square + R(6) * s * c->cube);
}

static void twist_at(articulated_drive *drive, const articulated_course *course, real s) {
    const articulated_cubic *x = &course->twist[0], *y = &course->twist[1], *z = &course->twist[2];
    const real n = course->rate_per_step;
    drive->twist[0] = vector_of(cubic_value(x, s), cubic_value(y, s), cubic_value(z, s));
    drive->twist[1] = vector_of(cubic_rate(x, s, n), cubic_rate(y, s, n), cubic_rate(z, s, n));
    drive->twist[2] = vector_of(cubic_curve(x, s, n), cubic_curve(y, s, n), cubic_curve(z, s, n));
}

static void commands_at(articulated_drive *drive, const articulated_course *course, const laconic_articulated_model *m,
                        real at) {
    for (int32_t k = 0; k < m->body_count; k++) {
        if (m->link[k].motion != LACONIC_MOTION_PRESCRIBED) continue;
        drive->rate[k] = cubic_value(&course->rate[k], at);
        drive->acceleration[k] = cubic_rate(&course->rate[k], at, course->rate_per_step);
    }
    drive->turns = course->turns;
    if (course->turns) twist_at(drive, course, at);
}

void laconic_articulated_begin_moment(articulated_moment *moment, const articulated_course *course) {
    moment->at = R(-1);
    if (course->constant) return;
    moment->drive = course->start; /* what does not vary stays; of hinges without a command rates are 0 */
}

void laconic_articulated_move_moment(articulated_moment *moment, const articulated_course *course,
                                     const laconic_articulated_model *m, real at) {
    moment->at = at;
    if (course->forces_vary) forces_at(&moment->drive, course, m, at);
    commands_at(&moment->drive, course, m, at);
}

/* Over cubics Simpson's rule is exact. */
real laconic_articulated_commanded_turn(const articulated_course *course, int32_t b, real from, real share) {
    const articulated_cubic *c = &course->rate[b - 1];
    if (course->constant) return share * course->step_s * course->start.rate[b - 1];
    const real sum = cubic_value(c, from) + R(4) * cubic_value(c, from + R(0.5) * share) + cubic_value(c, from + share);
    return share * course->step_s * sum * (R(1) / R(6));
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

#endif
