/* The outputs of a vehicle with friction, and its right-hand side by a smooth law. */
#include "friction_vehicle.h"

#if LACONIC_WITH_FRICTION
static real torque_on_axle(const laconic_plant *plant, const laconic_input *input, int32_t i) {
    const laconic_friction *f = &plant->friction;
    const real speed = plant->slip.wheel_speed_rad_per_s[i];
    const real terminal_V = f->supply_V > R(0) ? plant->slip.supply_voltage_V : R(-1);
    const motor_state motor = laconic_motor_at(f, i, input->voltage_V[i], speed, terminal_V);
    return (motor.torque - f->axle[i].viscous * speed) * f->energy_J + input->axle_torque_Nm[i];
}

static real contact_state(const laconic_friction *f, const laconic_slip *slip, int32_t i, const real slipped[2]) {
    const real *p = slip->grip_N[i], limit = f->axle[i].friction_coefficient * slip->normal_N[i];
    if (slip->normal_N[i] < R(0)) return R(2);
    if (!f->slips || !(size(vector_of(slipped[0], f->wheel[i].drag * slipped[1], R(0))) > R(0))) return R(0);
    return p[0] * p[0] + p[1] * p[1] >= limit * limit * (R(1) - R(8) * LACONIC_RANK_TOLERANCE) ? R(1) : R(0);
}

static void fill_wheel_outputs(laconic_outputs *out, const laconic_plant *plant, const laconic_input *input, int32_t i,
                               vector nu) {
    const laconic_friction *f = &plant->friction;
    const laconic_slip *s = &plant->slip;
    real slipped[2];
    slip_of(slipped, &f->wheel[i], nu, s->wheel_speed_rad_per_s[i]);
    out->wheel_speed_rad_per_s[i] = s->wheel_speed_rad_per_s[i];
    out->wheel_angle_rad[i] = s->wheel_angle_rad[i].value;
    out->wheel_torque_Nm[i] = torque_on_axle(plant, input, i);
    out->friction.slip_along_m_per_s[i] = f->radius_m * slipped[0];
    out->friction.slip_across_m_per_s[i] = f->radius_m * slipped[1];
    out->friction.contact_state[i] = contact_state(f, s, i, slipped);
    out->friction.drive_limit[i] = (real)s->limit[i];
    out->friction.motor_current_A[i] = s->current_A[i];
}

laconic_real laconic_friction_energy_J(const laconic_friction *friction, const laconic_state *state,
                                       const laconic_slip *slip) {
    real sum = square(zeta_of(state));
    for (int32_t i = 0; i < friction->wheel_count; i++)
        sum += friction->wheel[i].inertia * slip->wheel_speed_rad_per_s[i] * slip->wheel_speed_rad_per_s[i];
    return R(0.5) * friction->energy_J * sum;
}

void laconic_friction_outputs_of(laconic_outputs *outputs, const laconic_plant *plant, const laconic_input *input) {
    const laconic_slip *s = &plant->slip;
    laconic_friction_outputs *out = &outputs->friction;
    const vector nu = zeta_of(&plant->state);
    for (int32_t i = 0; i < plant->friction.wheel_count; i++) fill_wheel_outputs(outputs, plant, input, i, nu);
    outputs->energy_J = laconic_friction_energy_J(&plant->friction, &plant->state, s);
    out->supply_current_A = s->supply_current_A;
    out->supply_voltage_V = s->supply_voltage_V;
    out->supply_energy_J = s->supply_energy_J.value;
    out->outer_work_J = s->outer_work_J.value;
    out->slip_loss_J = s->slip_loss_J.value;
    out->axle_loss_J = s->axle_loss_J.value;
    out->motor_loss_J = s->motor_loss_J.value;
    out->supply_loss_J = s->supply_loss_J.value;
    out->numerical_loss_J = s->numerical_loss_J.value;
}

/* A brake holds its wheel against the ground, the motor and the input. */
void laconic_friction_reactions_of(laconic_reactions *out, const laconic_plant *plant, const laconic_input *input) {
    const laconic_friction *f = &plant->friction;
    const laconic_slip *s = &plant->slip;
    out->no_slip_margin_N = R(0);
    for (int32_t i = 0; i < f->point_count; i++) out->normal_N[i] = s->normal_N[i];
    for (int32_t i = 0; i < f->wheel_count; i++) {
        const laconic_friction_axle *a = &f->axle[i];
        const real along = -s->grip_N[i][0], across = -f->wheel[i].drag * s->grip_N[i][1];
        const real carried = s->normal_N[i] < R(0) ? R(0) : s->normal_N[i];    /* NaN makes the margin NaN */
        const real dragged = f->wheel[i].drag > R(0) ? s->grip_N[i][1] : R(0); /* the law's force: an ellipse's */
        const real margin = a->friction_coefficient * carried - laconic_root(along * along + dragged * dragged);
        out->along_N[i] = along;
        out->lateral_N[i] = -across;
        out->brake_Nm[i] = R(0);
        if (a->locked) out->brake_Nm[i] = a->arm_m[0] * along + a->arm_m[1] * across - torque_on_axle(plant, input, i);
        if (i == 0 || margin < out->no_slip_margin_N || margin != margin) out->no_slip_margin_N = margin;
    }
}

/* The first instant belongs to a step that nobody watched. */
void laconic_friction_watch(laconic_grip *grip, const laconic_plant *plant) {
    const laconic_friction *f = &plant->friction;
    const laconic_slip *s = &plant->slip;
    const vector nu = zeta_of(&plant->state);
    const real moved_m = f->radius_m * plant->integrator.step_s;
    for (int32_t i = 0; grip->instants > 1 && i < f->wheel_count; i++) {
        real slipped[2];
        slip_of(slipped, &f->wheel[i], nu, s->wheel_speed_rad_per_s[i]);
        if (contact_state(f, s, i, slipped) == R(1)) grip->wheel_slips[i] = true;
        sum_add(&grip->slip_loss_J[i],
                moved_m * (s->grip_N[i][0] * slipped[0] + f->wheel[i].drag * s->grip_N[i][1] * slipped[1]));
    }
}

/* ------------------------------------------------------------------------- the smooth law -- */

/* Force of one contact on the body over M R, by slip/√(slip² + ε²) instead of its direction. */
static void smooth_force(real force[2], const laconic_friction *f, int32_t i, vector nu, real speed, real load_N) {
    const real epsilon = R(LACONIC_SMOOTH_SLIP_M_PER_S) / f->radius_m;
    const laconic_friction_wheel *w = &f->wheel[i];
    real slip[2];
    slip_of(slip, w, nu, speed);
    slip[1] *= w->drag;
    const real over = laconic_root(slip[0] * slip[0] + slip[1] * slip[1] + epsilon * epsilon);
    const real per_slip = f->axle[i].friction_coefficient * load_N / (f->impulse_N * over);
    force[0] = -per_slip * slip[0];
    force[1] = -per_slip * slip[1] * w->drag;
}

/* Loads move forces and forces loads, each time by μ z_S over the wheels' distance, usually less than 0.3: after these
 * rounds some 1e-5 is left. A fixed number, so that the law stays smooth. */
#define LOAD_ROUNDS 10

static void smooth_forces(real force[][2], normal_loads *loads, const laconic_friction *f, vector nu,
                          const real speed[]) {
    real ground_N[2] = {R(0), R(0)};
    for (int round = 0; round < LOAD_ROUNDS; round++) { /* loads at rest, then those under the forces that these give */
        laconic_normal_loads(loads, f, ground_N);
        ground_N[0] = ground_N[1] = R(0);
        for (int32_t i = 0; i < f->wheel_count; i++) {
            real here[2];
            smooth_force(force[i], f, i, nu, speed[i], loads->carried_N[i]);
            force_in_body(here, &f->axle[i], force[i]);
            ground_N[0] += here[0] * f->impulse_N;
            ground_N[1] += here[1] * f->impulse_N;
        }
    }
}

static real wheel_acceleration(const laconic_friction *f, const laconic_model *m, const laconic_input *input, int32_t i,
                               real speed, real terminal_V, const real force[2]) {
    const laconic_friction_axle *a = &f->axle[i];
    const laconic_friction_wheel *w = &f->wheel[i];
    const real epsilon = R(LACONIC_SMOOTH_SLIP_M_PER_S) / f->radius_m;
    const motor_state motor = laconic_motor_at(f, i, input->voltage_V[i], speed, terminal_V);
    const real dry = a->dry * speed / laconic_root(speed * speed + epsilon * epsilon);
    const real torque = motor.torque - a->viscous * speed - dry + m->torque_scale * input->axle_torque_Nm[i] -
                        w->rim_along * force[0] - w->rim_across * force[1];
    return a->locked ? R(0) : torque / w->inertia;
}

void laconic_friction_derivative(laconic_rates *rates, laconic_real wheel_rate_rad_per_s2[],
                                 const laconic_friction *friction, const laconic_model *model,
                                 const laconic_real nu_rad_per_s[3], laconic_real heading_rad,
                                 const laconic_real wheel_speed_rad_per_s[], const laconic_input *input) {
    const laconic_friction *f = friction;
    const direction heading = laconic_direction_of_angle(heading_rad);
    const vector nu = vec(nu_rad_per_s);
    const real *speed = wheel_speed_rad_per_s, terminal_V = laconic_supply_voltage(f, input, speed, R(0));
    const real yaw_rate = nu.z * model->yaw_rate_of_zeta[2];
    const real along = f->radius_m * nu.x, across = f->radius_m * nu.y;
    real force[LACONIC_SLIP_WHEELS][2];
    normal_loads loads;
    vector rate =
        plus(vector_of(yaw_rate * nu.y, -yaw_rate * nu.x, R(0)), b_of_wrench(model, wrench_of(model, input, heading)));
    smooth_forces(force, &loads, f, nu, speed);
    for (int32_t i = 0; i < f->wheel_count; i++) {
        const laconic_friction_wheel *w = &f->wheel[i];
        rate = plus(rate, plus(scaled(force[i][0], vec(w->along)), scaled(force[i][1], vec(w->across))));
        rates->wheel_speed_rad_per_s[i] = speed[i];
        wheel_rate_rad_per_s2[i] = wheel_acceleration(f, model, input, i, speed[i], terminal_V, force[i]);
    }
    store(rates->nu_rad_per_s2, rate);
    rates->x_m_per_s = along * heading.cosine - across * heading.sine;
    rates->y_m_per_s = along * heading.sine + across * heading.cosine;
    rates->yaw_rate_rad_per_s = yaw_rate;
}

/* The currents of the motors at these speeds, and the supply's, by the power that they take. */
static void smooth_drive(laconic_slip *slip, const laconic_friction *f, const laconic_input *input) {
    const real terminal_V = laconic_supply_voltage(f, input, slip->wheel_speed_rad_per_s, R(0));
    real power_W = R(0);
    for (int32_t i = 0; i < f->wheel_count; i++) {
        const real speed = slip->wheel_speed_rad_per_s[i];
        const motor_state motor = laconic_motor_at(f, i, input->voltage_V[i], speed, terminal_V);
        slip->current_A[i] = motor.current_A;
        slip->limit[i] = (int32_t)motor.limit;
        power_W += motor.voltage_V * motor.current_A;
    }
    slip->supply_voltage_V = terminal_V > R(0) ? terminal_V : R(0);
    slip->supply_current_A = terminal_V > R(0) ? power_W / terminal_V : R(0);
}

void laconic_slip_smooth(laconic_slip *slip, const laconic_friction *friction, const laconic_state *state,
                         const laconic_input *input) {
    const laconic_friction *f = friction;
    real force[LACONIC_SLIP_WHEELS][2];
    normal_loads loads;
    smooth_forces(force, &loads, f, zeta_of(state), slip->wheel_speed_rad_per_s);
    for (int32_t i = 0; i < f->point_count; i++) slip->normal_N[i] = loads.statics_N[i];
    for (int32_t i = 0; i < f->wheel_count; i++) { /* of the robot on the ground, and across it over k */
        const real drag = f->wheel[i].drag;
        slip->grip_N[i][0] = -force[i][0] * f->impulse_N;
        slip->grip_N[i][1] = drag > R(0) ? -force[i][1] / drag * f->impulse_N : R(0);
    }
    smooth_drive(slip, f, input);
}

#endif
