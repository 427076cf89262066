/* The friction step: backward Euler for body and wheels together, first order; the energy never grows by itself.
 *
 *   1. normal loads, by statics with the ground's forces of the step before
 *   2. (ν1, ν2) rotated by h ν3/Λ: the velocity, unchanged in the world, in the axes at the step's end; there outer
 *      forces are added
 *   3. motors with their limits, dry friction of axles and contacts: the convex problem of friction_solver.h
 *   4. pose and wheel angles with the mean of old and new speeds, and the energy of each kind
 *
 * A step that the solver refuses is taken in 2, 4 or 8 parts before it is refused. */
#include "friction_vehicle.h"

#if LACONIC_WITH_FRICTION
#define MOST_PARTS 8

/* One part of a step while it is computed. */
typedef struct part {
    const laconic_friction *f;
    const laconic_model *m;
    const laconic_input *in;
    real h;
    direction end; /* the body's axes at the end, as far as they matter */
    vector old, rotated, forcing, nu;
    real terminal_V;
    normal_loads loads;
    friction_load load[LACONIC_SLIP_WHEELS];
    real speed[LACONIC_SLIP_WHEELS], impulse[LACONIC_SLIP_WHEELS][2];
} part;

/* 0, or NaN where an input is not finite. */
static real check_of(const laconic_friction *f, const laconic_input *in) {
    real sum = in->body_force_N[0] + in->body_force_N[1] + in->body_moment_Nm + in->world_force_N[0] +
               in->world_force_N[1] + in->world_force_point_m[0] + in->world_force_point_m[1];
    for (int32_t i = 0; i < f->wheel_count; i++) sum += in->voltage_V[i] + in->axle_torque_Nm[i];
    return zero_if_finite(sum);
}

static void find_loads(part *p, const laconic_slip *slip) {
    real ground_N[2] = {R(0), R(0)};
    for (int32_t i = 0; i < p->f->wheel_count; i++) {
        const real force_N[2] = {-slip->grip_N[i][0], -p->f->wheel[i].drag * slip->grip_N[i][1]};
        real here_N[2];
        force_in_body(here_N, &p->f->axle[i], force_N);
        ground_N[0] += here_N[0];
        ground_N[1] += here_N[1];
    }
    laconic_normal_loads(&p->loads, p->f, ground_N);
}

static bool turns_with_heading(const part *p) {
    return sloped(p->m) || acts(p->in->world_force_N[0], p->in->world_force_N[1], R(0));
}

/* A velocity that is constant in the world rotates against the body. */
static void move_freely(part *p, const laconic_state *state) {
    const real angle = p->h * p->old.z * p->m->yaw_rate_of_zeta[2];
    const direction by = laconic_direction_of_angle(angle);
    p->rotated =
        vector_of(by.cosine * p->old.x + by.sine * p->old.y, by.cosine * p->old.y - by.sine * p->old.x, p->old.z);
    p->end = direction_with(R(1), R(0));
    if (turns_with_heading(p))
        p->end = laconic_direction_of_binary_angle(
            (laconic_binary_angle)(state->heading.fraction + laconic_binary_angle_of(angle)));
    p->forcing = scaled(p->h, b_of_wrench(p->m, wrench_of(p->m, p->in, p->end)));
}

static void load_wheel(part *p, const laconic_slip *slip, int32_t i) {
    const laconic_friction_axle *a = &p->f->axle[i];
    friction_load *l = &p->load[i];
    const real command_V = p->in->voltage_V[i];
    real volts = R(0);
    if (a->circuit == LACONIC_MOTOR_DRIVEN)
        volts = p->terminal_V < R(0) || magnitude(command_V) <= p->terminal_V ? command_V
                : command_V > R(0)                                            ? p->terminal_V
                                                                              : -p->terminal_V;
    l->grip = p->f->slips ? p->h * a->friction_coefficient * p->loads.carried_N[i] / p->f->impulse_N : LACONIC_REAL_MAX;
    l->axle = p->h * a->dry;
    l->drive = p->h * a->gain * volts;
    l->drive_slope = a->circuit == LACONIC_MOTOR_OPEN ? R(0) : p->h * a->back_emf;
    l->drive_limit = LACONIC_REAL_MAX;
    if (a->circuit == LACONIC_MOTOR_DRIVEN && a->torque_limit < LACONIC_REAL_MAX)
        l->drive_limit = p->h * a->torque_limit;
    l->viscous = p->h * a->viscous;
    l->free_speed =
        slip->wheel_speed_rad_per_s[i] + p->h * p->m->torque_scale * p->in->axle_torque_Nm[i] / p->f->wheel[i].inertia;
    if (!a->locked) return;
    l->axle = LACONIC_REAL_MAX; /* the brake: as dry friction, more than the contact can overcome */
    if (p->f->slips) l->axle = R(2) * p->f->wheel[i].rim_size * l->grip + p->f->wheel[i].inertia;
    l->drive = l->drive_slope = l->viscous = l->free_speed = R(0);
}

/* The search begins with the forces of the step before. */
static laconic_status solve_friction(part *p, const laconic_slip *slip) {
    const real to_impulse = p->h / p->f->impulse_N;
    real free[3], nu[3];
    store(free, plus(p->rotated, p->forcing));
    for (int32_t i = 0; i < p->f->wheel_count; i++) {
        load_wheel(p, slip, i);
        for (int k = 0; k < 2; k++) p->impulse[i][k] = slip->grip_N[i][k] * to_impulse;
    }
    if (laconic_friction_solve(p->f->wheel, p->load, p->f->wheel_count, free, nu, p->speed, p->impulse) == 0)
        return LACONIC_STEP_UNSOLVED;
    p->nu = vec(nu);
    return square(p->nu) <= LARGEST_SPEED * LARGEST_SPEED ? LACONIC_OK : LACONIC_OVERFLOW;
}

/* ------------------------------------------------------------------------------------ the pose -- */

/* By how much the step's energy would grow, twice, if the slope's pull did its work along the mean of old and new
 * velocity: along the new one alone the step loses what contacts dissipate and ½|z⁺ − z|². Motors do not count. */
static real growth_by_mean(const part *p, const laconic_slip *slip, vector change) {
    real growth = dot(p->forcing, change) - square(change);
    for (int32_t i = 0; i < p->f->wheel_count; i++) {
        const laconic_friction_wheel *w = &p->f->wheel[i];
        const real faster = p->speed[i] - slip->wheel_speed_rad_per_s[i];
        real slipped[2];
        slip_of(slipped, w, p->nu, p->speed[i]);
        growth -= w->inertia * faster * faster +
                  R(2) * (p->impulse[i][0] * slipped[0] + p->impulse[i][1] * w->drag * slipped[1]);
    }
    return growth;
}

/* Below it, over speed and pull, the solver's accuracy is what seems to grow. */
#ifdef LACONIC_SINGLE
#define GROWTH_IN_DOUBT R(1e-5)
#else
#define GROWTH_IN_DOUBT R(1e-11)
#endif

/* On a slope the displacement is that of the velocities in the world, so that their work by the slope's pull is exactly
 * the change of its potential. Where the mean would let the energy grow (the motion reverses within the step, or turns
 * across the slope) the velocity at the end is taken. */
static pose_change sloped_displacement(const part *p, const laconic_slip *slip) {
    const vector change = minus(p->nu, p->rotated), mean = scaled(R(0.5), plus(p->nu, p->rotated));
    const real growth = growth_by_mean(p, slip, change);
    const bool grows =
        growth > R(0) && growth * growth > GROWTH_IN_DOUBT * GROWTH_IN_DOUBT * square(p->forcing) * square(p->nu);
    const vector taken = grows ? p->nu : mean;
    const real reach = p->h * p->m->wheel_radius_m;
    const pose_change moved = {reach * taken.x, reach * taken.y,
                               p->h * R(0.5) * (p->old.z + p->nu.z) * p->m->yaw_rate_of_zeta[2]};
    return moved;
}

static pose_change level_displacement(const part *p) {
    const vector path = scaled(R(0.5) * p->h, plus(p->old, p->nu)), bend = scaled(p->h, minus(p->nu, p->old));
    return displacement(p->m, path, bend);
}

static laconic_status move_body(const part *p, const laconic_slip *slip, laconic_state *state) {
    const bool slope = sloped(p->m);
    const pose_change moved = slope ? sloped_displacement(p, slip) : level_displacement(p);
    if (!(magnitude(moved.yaw_change_rad) + magnitude(moved.along_m) + magnitude(moved.across_m) <
          LARGEST_YAW_CHANGE_RAD))
        return LACONIC_OVERFLOW;
    set_zeta(state, p->nu);
    if (slope) {
        heading_advance(&state->heading, moved.yaw_change_rad);
        sum_add(&state->x_m, p->end.cosine * moved.along_m - p->end.sine * moved.across_m);
        sum_add(&state->y_m, p->end.sine * moved.along_m + p->end.cosine * moved.across_m);
    } else {
        advance_pose(state, moved);
    }
    return LACONIC_OK;
}

/* ---------------------------------------------------------------------------- what is remembered -- */

typedef struct energies { /* of one part, over M R² */
    real supplied, outer, slip, axle, motor, numerical;
} energies;

/* Without R_a the electrical side is not known: the motor's loss is then all of its damping. */
static void enter_motor(energies *e, const part *p, laconic_slip *slip, int32_t i) {
    const laconic_friction_axle *a = &p->f->axle[i];
    const real speed = p->speed[i];
    const motor_state motor = laconic_motor_at(p->f, i, p->in->voltage_V[i], speed, p->terminal_V);
    real fed = p->h * a->gain * motor.voltage_V * speed;
    if (a->ampere != R(0)) fed = p->h * motor.voltage_V * motor.current_A / p->f->energy_J;
    slip->current_A[i] = motor.current_A;
    slip->limit[i] = (int32_t)motor.limit;
    e->supplied += fed;
    e->motor += fed - p->h * motor.torque * speed + p->h * a->viscous * speed * speed;
}

static void enter_wheel(energies *e, const part *p, laconic_slip *slip, int32_t i) {
    const laconic_friction_axle *a = &p->f->axle[i];
    const laconic_friction_wheel *w = &p->f->wheel[i];
    const real old = slip->wheel_speed_rad_per_s[i], speed = p->speed[i], change = speed - old;
    real slipped[2];
    slip_of(slipped, w, p->nu, speed);
    e->slip += p->impulse[i][0] * slipped[0] + p->impulse[i][1] * w->drag * slipped[1];
    e->axle += p->h * a->dry * magnitude(speed);
    e->outer += p->h * p->m->torque_scale * p->in->axle_torque_Nm[i] * speed;
    e->numerical += R(0.5) * w->inertia * change * change;
    enter_motor(e, p, slip, i);
    for (int k = 0; k < 2; k++) slip->grip_N[i][k] = p->impulse[i][k] * (p->f->impulse_N / p->h);
    sum_add(&slip->wheel_angle_rad[i], R(0.5) * p->h * (old + speed));
    slip->wheel_speed_rad_per_s[i] = speed;
}

/* The supply gives what the motors take and what its own resistance turns to heat: I V₀ h with I V = Σ U_i I_i. */
static void enter_supply(const energies *e, const part *p, laconic_slip *slip) {
    const real fed_J = e->supplied * p->f->energy_J;
    real loss_J = R(0);
    if (p->terminal_V > R(0)) {
        slip->supply_current_A = fed_J / (p->h * p->terminal_V);
        slip->supply_voltage_V = p->terminal_V;
        loss_J = (p->f->supply_V - p->terminal_V) * slip->supply_current_A * p->h;
    }
    sum_add(&slip->supply_energy_J, fed_J + loss_J);
    sum_add(&slip->supply_loss_J, loss_J);
}

static void remember(const part *p, laconic_slip *slip) {
    const vector change = minus(p->nu, p->rotated);
    energies e = {R(0), dot(p->forcing, p->nu), R(0), R(0), R(0), R(0.5) * square(change)};
    for (int32_t i = 0; i < p->f->wheel_count; i++) enter_wheel(&e, p, slip, i);
    for (int32_t i = 0; i < p->f->point_count; i++) slip->normal_N[i] = p->loads.statics_N[i];
    enter_supply(&e, p, slip);
    sum_add(&slip->outer_work_J, e.outer * p->f->energy_J);
    sum_add(&slip->slip_loss_J, e.slip * p->f->energy_J);
    sum_add(&slip->axle_loss_J, e.axle * p->f->energy_J);
    sum_add(&slip->motor_loss_J, e.motor * p->f->energy_J);
    sum_add(&slip->numerical_loss_J, e.numerical * p->f->energy_J);
}

/* ------------------------------------------------------------------------------------- the step -- */

static laconic_status take(part *p, laconic_state *state, laconic_slip *slip) {
    p->old = zeta_of(state);
    find_loads(p, slip);
    move_freely(p, state);
    p->terminal_V = laconic_supply_voltage(p->f, p->in, slip->wheel_speed_rad_per_s, slip->supply_voltage_V);
    laconic_status status = solve_friction(p, slip);
    if (status == LACONIC_OK) status = move_body(p, slip, state);
    if (status == LACONIC_OK) remember(p, slip);
    return status;
}

RARE laconic_status take_parts(part *p, laconic_state *state, laconic_slip *slip, int32_t count) {
    laconic_state end = *state;
    laconic_slip end_slip = *slip;
    laconic_status status = LACONIC_OK;
    for (int32_t k = 0; k < count && status == LACONIC_OK; k++) status = take(p, &end, &end_slip);
    if (status != LACONIC_OK) return status;
    *state = end;
    *slip = end_slip;
    return LACONIC_OK;
}

laconic_status laconic_friction_step(const laconic_friction *friction, const laconic_model *model, laconic_real step_s,
                                     laconic_state *state, laconic_slip *slip, const laconic_input *held) {
    part p;
    p.f = friction;
    p.m = model;
    p.in = held;
    p.h = step_s;
    if (check_of(friction, held) != R(0) || !heading_has_room(&state->heading)) return LACONIC_OVERFLOW;
    laconic_status status = take(&p, state, slip);
    for (int32_t count = 2; count <= MOST_PARTS && status == LACONIC_STEP_UNSOLVED; count *= 2) {
        p.h = step_s / (real)count;
        status = take_parts(&p, state, slip, count);
    }
    return status;
}

#endif
