/* A vehicle with friction → the constants of its contacts, motors and axles; the state in which its wheels start. How
 * grip and drag act in a step stands in friction_solver.c. */
#include "friction_vehicle.h"

#include "geometry.h"
#include "least_norm.h"

#if LACONIC_WITH_FRICTION
static void fill_contact(laconic_friction *f, const laconic_vehicle *vehicle, const body *b, int32_t i) {
    const laconic_wheel *wheel = &vehicle->wheel[i];
    laconic_friction_wheel *w = &f->wheel[i];
    laconic_friction_axle *a = &f->axle[i];
    const bool fixed = wheel->kind == LACONIC_WHEEL_FIXED;
    const wheel_values own = laconic_wheel_values(vehicle, i);
    const direction roller = laconic_direction_of_angle(wheel->roller_rad);
    const real x = wheel->x_m - b->com_x_m, y = wheel->y_m - b->com_y_m, per_yaw = R(1) / (b->radius_m * b->yaw_scale);
    direction u;
    const real sine = laconic_pull_direction(&u, wheel), cosine = fixed ? R(0) : roller.cosine;
    w->along[0] = a->pull[0] = u.cosine;
    w->along[1] = a->pull[1] = u.sine;
    w->along[2] = (x * u.sine - y * u.cosine) * per_yaw;
    w->across[0] = -u.sine;
    w->across[1] = u.cosine;
    w->across[2] = (x * u.cosine + y * u.sine) * per_yaw;
    a->arm_m[0] = own.radius_m * sine;
    a->arm_m[1] = own.radius_m * cosine;
    w->rim_along = a->arm_m[0] / b->radius_m;
    w->rim_across = a->arm_m[1] / b->radius_m;
    w->inertia = own.inertia_kgm2 / f->energy_J;
    w->drag = fixed ? R(1) : f->slips ? own_or_common(wheel->own_roller_drag, vehicle->ground.roller_drag) : R(0);
    laconic_friction_prepare(w);
}

static void fill_axle(laconic_friction *f, const laconic_vehicle *vehicle, int32_t i) {
    const laconic_wheel *wheel = &vehicle->wheel[i];
    const laconic_drive *drive = &vehicle->drive;
    const wheel_values own = laconic_wheel_values(vehicle, i);
    laconic_friction_axle *a = &f->axle[i];
    const real per_ampere = own.motor_gain_Nm_per_V * drive->winding_resistance_ohm / f->energy_J;
    const bool is_part = drive->viscous_friction_Nms < own.motor_damping_Nms;
    const real viscous = is_part ? drive->viscous_friction_Nms : own.motor_damping_Nms;
    a->circuit = wheel->motor_circuit;
    a->locked = wheel->locked;
    a->gain = own.motor_gain_Nm_per_V / f->energy_J;
    a->back_emf = (own.motor_damping_Nms - viscous) / f->energy_J;
    a->viscous = viscous / f->energy_J;
    a->torque_limit = drive->current_limit_A > R(0) && per_ampere != R(0)
                          ? magnitude(per_ampere) * drive->current_limit_A
                          : LACONIC_REAL_MAX;
    a->ampere = per_ampere != R(0) ? R(1) / per_ampere : R(0);
    a->dry =
        f->slips ? own_or_common(wheel->own_axle_friction_Nm, vehicle->ground.axle_friction_Nm) / f->energy_J : R(0);
    a->friction_coefficient = f->slips
                                  ? own_or_common(wheel->own_friction_coefficient, vehicle->ground.friction_coefficient)
                                  : vehicle->friction_coefficient;
}

static void place_points(laconic_friction *f, const laconic_vehicle *vehicle, const body *b) {
    const int32_t n = vehicle->wheel_count;
    f->point_count = n + vehicle->support_count;
    for (int32_t i = 0; i < f->point_count; i++) {
        f->point_row[i][0] = b->radius_m; /* a length, so that the three balances have one unit */
        f->point_row[i][1] = (i < n ? vehicle->wheel[i].x_m : vehicle->support[i - n].x_m) - b->com_x_m;
        f->point_row[i][2] = (i < n ? vehicle->wheel[i].y_m : vehicle->support[i - n].y_m) - b->com_y_m;
    }
    laconic_least_norm(f->normal_load_of_wrench, (const real(*)[3])f->point_row, f->point_count);
}

static bool friction_in_range(const laconic_friction *f) {
    real sum = rows_size(f->point_row, f->point_count) + rows_size(f->normal_load_of_wrench, f->point_count) +
               f->weight_N + f->com_z_m + f->supply_V + f->supply_resistance_ohm + f->winding_resistance_ohm;
    for (int32_t i = 0; i < f->wheel_count; i++) {
        const laconic_friction_wheel *w = &f->wheel[i];
        const laconic_friction_axle *a = &f->axle[i];
        sum += size(vec(w->along)) + size(vec(w->across)) + w->mobility + w->rim_size + R(1) / w->inertia + w->inertia +
               w->lateral_mass + w->row_mass[0] + w->row_mass[1];
        sum += magnitude(a->gain) + a->back_emf + a->viscous + magnitude(a->ampere) + a->dry + a->friction_coefficient;
    }
    return fits_squared(sum);
}

/* On ideal ground a drive moves what the wheels allow, which must be something. */
static laconic_status check_ideal(const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_model ideal;
    return laconic_vehicle_slips(vehicle) ? LACONIC_OK : laconic_prepare_ideal(&ideal, vehicle, why);
}

laconic_status laconic_friction_of(laconic_friction *friction, const laconic_model *model,
                                   const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_friction f = ALL_ZERO;
    const laconic_status status = check_ideal(vehicle, why);
    body b;
    if (status != LACONIC_OK) return status;
    laconic_body_of(&b, vehicle);
    f.acts = true;
    f.slips = laconic_vehicle_slips(vehicle);
    f.wheel_count = vehicle->wheel_count;
    f.radius_m = b.radius_m;
    f.impulse_N = model->mass_kg * b.radius_m;
    f.energy_J = f.impulse_N * b.radius_m;
    f.com_z_m = vehicle->com_z_m;
    f.weight_N =
        model->mass_kg * R(LACONIC_GRAVITY_M_PER_S2) * laconic_direction_of_angle(vehicle->ground.slope_rad).cosine;
    f.supply_V = vehicle->drive.supply_V;
    f.supply_resistance_ohm = vehicle->drive.supply_resistance_ohm;
    f.winding_resistance_ohm = vehicle->drive.winding_resistance_ohm;
    for (int32_t i = 0; i < f.wheel_count; i++) {
        fill_contact(&f, vehicle, &b, i);
        fill_axle(&f, vehicle, i);
    }
    place_points(&f, vehicle, &b);
    if (!friction_in_range(&f)) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *friction = f;
    return LACONIC_OK;
}

/* --------------------------------------------------------------------------------- the start -- */

/* Of a wheel that does not slip. A wheel of hardly any radius turns beyond all numbers. */
static real rolling_speed(const laconic_friction *f, int32_t i, const real nu[3]) {
    const laconic_friction_wheel *w = &f->wheel[i];
    return f->axle[i].locked ? R(0) : dot(vec(w->along), vec(nu)) / w->rim_along;
}

static laconic_status check_wheel_speed(real speed, laconic_status otherwise, int32_t i, laconic_refusal *why) {
    if (magnitude(speed) <= LARGEST_SPEED) return LACONIC_OK;
    return refuse(why, otherwise, LACONIC_FIELD_START_WHEEL_SPEED, i + 1, speed, R(0));
}

/* ν of the start must suit wheels that cannot slip. */
static laconic_status check_wheel_start(const laconic_friction *f, const laconic_vehicle *vehicle,
                                        const laconic_start *start, laconic_refusal *why) {
    laconic_model ideal;
    laconic_state state;
    laconic_status status = LACONIC_OK;
    if (!f->slips) {
        status = laconic_prepare_ideal(&ideal, vehicle, why);
        return status == LACONIC_OK ? laconic_state_set(&state, &ideal, start, why) : status;
    }
    for (int32_t i = 0; i < f->wheel_count && status == LACONIC_OK; i++) {
        const real speed = start->wheel_speed_rad_per_s[i];
        status = check_wheel_speed(speed, is_finite(speed) ? LACONIC_OVERFLOW : LACONIC_NOT_FINITE, i, why);
        if (status == LACONIC_OK)
            status = check_wheel_speed(rolling_speed(f, i, start->nu_rad_per_s), LACONIC_OVERFLOW, i, why);
    }
    return status;
}

static void roll(laconic_slip *slip, const laconic_friction *f, const real nu[3]) {
    for (int32_t i = 0; i < f->wheel_count; i++) slip->wheel_speed_rad_per_s[i] = rolling_speed(f, i, nu);
}

static void set_at_rest(laconic_slip *slip, const laconic_friction *f) {
    const real none_N[2] = {R(0), R(0)};
    const laconic_slip fresh = ALL_ZERO;
    normal_loads loads;
    *slip = fresh;
    slip->supply_voltage_V = f->supply_V;
    laconic_normal_loads(&loads, f, none_N);
    for (int32_t i = 0; i < f->point_count; i++) slip->normal_N[i] = loads.statics_N[i];
}

laconic_status laconic_slip_set(laconic_slip *slip, const laconic_friction *friction, const laconic_vehicle *vehicle,
                                const laconic_start *start, laconic_refusal *why) {
    const laconic_status status = check_wheel_start(friction, vehicle, start, why);
    bool has_speeds = false;
    if (status != LACONIC_OK) return status;
    set_at_rest(slip, friction);
    for (int32_t i = 0; i < friction->wheel_count; i++)
        has_speeds = has_speeds || start->wheel_speed_rad_per_s[i] != R(0);
    roll(slip, friction, start->nu_rad_per_s);
    for (int32_t i = 0; i < friction->wheel_count && has_speeds && friction->slips; i++)
        if (!friction->axle[i].locked) slip->wheel_speed_rad_per_s[i] = start->wheel_speed_rad_per_s[i];
    return LACONIC_OK;
}

void laconic_slip_take_over(laconic_slip *slip, const laconic_friction *friction, const real speed[],
                            const real angle_rad[]) {
    set_at_rest(slip, friction);
    for (int32_t i = 0; i < friction->wheel_count; i++) {
        slip->wheel_speed_rad_per_s[i] = speed[i];
        slip->wheel_angle_rad[i] = sum_of(angle_rad[i]);
    }
}

#endif
