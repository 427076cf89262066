/* A checked vehicle → the body with its payload, rows of Ξ and constraint rows. */
#include "geometry.h"

wheel_values laconic_wheel_values(const laconic_vehicle *vehicle, int32_t wheel) {
    wheel_values v = {vehicle->wheel_radius_m, vehicle->wheel_inertia_kgm2, vehicle->motor_gain_Nm_per_V,
                      vehicle->motor_damping_Nms};
#if LACONIC_WITH_OWN_WHEELS
    const laconic_wheel *w = &vehicle->wheel[wheel];
    if (w->own_radius_m != R(0)) v.radius_m = w->own_radius_m;
    if (w->own_inertia_kgm2 != R(0)) v.inertia_kgm2 = w->own_inertia_kgm2;
    if (w->own_motor_gain_Nm_per_V != R(0)) v.motor_gain_Nm_per_V = w->own_motor_gain_Nm_per_V;
    if (w->own_motor_damping_Nms != R(0)) v.motor_damping_Nms = w->own_motor_damping_Nms;
    if (w->undriven) v.motor_gain_Nm_per_V = v.motor_damping_Nms = R(0);
#else
    (void)wheel;
#endif
    return v;
}

/* Without wheels the vehicle's. */
static real largest_inertia(const laconic_vehicle *vehicle) {
    if (!LACONIC_WITH_OWN_WHEELS) return vehicle->wheel_inertia_kgm2;
    real largest = vehicle->wheel_count > 0 ? R(0) : vehicle->wheel_inertia_kgm2;
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        const real inertia = laconic_wheel_values(vehicle, i).inertia_kgm2;
        if (inertia > largest) largest = inertia;
    }
    return largest;
}

void laconic_inertia_shares(real share[], const laconic_vehicle *vehicle) {
    const real largest = largest_inertia(vehicle);
    for (int32_t i = 0; i < vehicle->wheel_count; i++)
        share[i] = largest > R(0) ? laconic_wheel_values(vehicle, i).inertia_kgm2 / largest : R(1);
}

/* Parallel axes: two bodies at distance d add m₁m₂/(m₁+m₂) d² to their own inertias. */
void laconic_body_of(body *b, const laconic_vehicle *vehicle) {
    const laconic_payload *payload = &vehicle->payload;
    const real total = vehicle->mass_kg + payload->mass_kg;
    const real share = payload->mass_kg / total;
    const real dx = payload->x_m - vehicle->com_x_m, dy = payload->y_m - vehicle->com_y_m;
    const real inertia =
        vehicle->yaw_inertia_kgm2 + payload->yaw_inertia_kgm2 + share * vehicle->mass_kg * (dx * dx + dy * dy);
    b->mass_kg = total;
    b->com_x_m = vehicle->com_x_m + share * dx;
    b->com_y_m = vehicle->com_y_m + share * dy;
    b->radius_m = vehicle->wheel_radius_m;
    b->yaw_scale = laconic_root(inertia / total) / b->radius_m;
    b->wheel_scale_square = largest_inertia(vehicle) / total / b->radius_m / b->radius_m;
}

real laconic_pull_direction(direction *pull, const laconic_wheel *wheel) {
    const direction axle = laconic_direction_of_angle(wheel->axle_rad);
    direction roller = {R(0), R(1)}; /* a fixed wheel: γ = π/2 exactly */
    if (wheel->kind != LACONIC_WHEEL_FIXED) roller = laconic_direction_of_angle(wheel->roller_rad);
    pull->cosine = axle.cosine * roller.cosine - axle.sine * roller.sine;
    pull->sine = axle.sine * roller.cosine + axle.cosine * roller.sine;
    return roller.sine;
}

/* (d_ξ, d_η, lever/(R Λ)): generalised direction of a line through the wheel's centre along d. */
static void line_row(real row[3], const body *b, const laconic_wheel *wheel, direction d) {
    const real lever = (wheel->x_m - b->com_x_m) * d.sine - (wheel->y_m - b->com_y_m) * d.cosine;
    row[0] = d.cosine;
    row[1] = d.sine;
    row[2] = lever / (b->radius_m * b->yaw_scale);
}

void laconic_wheel_row(real row[3], const body *b, const laconic_wheel *wheel) {
    direction pull;
    real sine = laconic_pull_direction(&pull, wheel);
#if LACONIC_WITH_OWN_WHEELS
    if (wheel->own_radius_m != R(0)) sine *= wheel->own_radius_m / b->radius_m;
#endif
    line_row(row, b, wheel, pull);
    row[0] /= sine;
    row[1] /= sine;
    row[2] /= sine;
}

int32_t laconic_constraint_rows(real rows[2][3], const body *b, const laconic_wheel *wheel) {
    int32_t count = 0;
    if (wheel->kind == LACONIC_WHEEL_FIXED)
        line_row(rows[count++], b, wheel, laconic_direction_of_angle(wheel->axle_rad));
    if (wheel->locked) laconic_wheel_row(rows[count++], b, wheel);
    return count;
}
