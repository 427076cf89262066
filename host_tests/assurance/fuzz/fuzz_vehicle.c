/* Any vehicle under any method, step and input: what is refused changes nothing, what is accepted is finite, and the
 * same call gives the same bits again.
 *
 * Input: numbers, as fuzz_motions.h has them. */
#include "fuzz_motions.h"

enum { WHEELS = 5, STEPS = 1 };

static void fill_wheel(reader *from, laconic_wheel *wheel) {
    const uint8_t flags = byte(from);
    wheel->kind = (laconic_wheel_kind)(flags & 3U);
    wheel->locked = (flags & 0xE0U) == 0xE0U;
    wheel->undriven = (flags & 12U) == 12U;
    wheel->x_m = number(from);
    wheel->y_m = number(from);
    wheel->axle_rad = number(from);
    wheel->roller_rad = number(from);
    if ((flags & 16U) == 0) return;
    wheel->own_radius_m = number(from);
    wheel->own_inertia_kgm2 = number(from);
    wheel->own_motor_gain_Nm_per_V = number(from);
    wheel->own_motor_damping_Nms = number(from);
    wheel->own_friction_coefficient = number(from);
    wheel->own_roller_drag = number(from);
    wheel->motor_circuit = byte(from) % 5;
}

static void fill_vehicle(reader *from, laconic_vehicle *vehicle) {
    const uint8_t more = byte(from);
    memset(vehicle, 0, sizeof *vehicle);
    vehicle->mass_kg = number(from);
    vehicle->yaw_inertia_kgm2 = number(from);
    vehicle->wheel_radius_m = number(from);
    vehicle->wheel_inertia_kgm2 = number(from);
    vehicle->motor_gain_Nm_per_V = number(from);
    vehicle->motor_damping_Nms = number(from);
    vehicle->com_x_m = number(from);
    vehicle->com_y_m = number(from);
    vehicle->wheel_count = byte(from) % (WHEELS + 1);
    for (int32_t i = 0; i < vehicle->wheel_count; i++) fill_wheel(from, &vehicle->wheel[i]);
    if (more & 1U) vehicle->payload.mass_kg = number(from);
    if (more & 2U) vehicle->ground.slope_rad = number(from);
    if (more & 4U) vehicle->ground.friction_coefficient = number(from);
    if (more & 8U) vehicle->drive.current_limit_A = number(from);
    if (more & 16U) vehicle->com_z_m = number(from);
}

/* One call, twice from the same motion. */
static bool takes_step(laconic_plant *plant, const laconic_input *input) {
    static saved before, after;
    laconic_refusal why = {0}, why_again = {0};
    save(&before, plant);
    const laconic_status status = laconic_plant_run(plant, input, 1, &why);
    save(&after, plant);
    restore(plant, &before);
    must(laconic_plant_run(plant, input, 1, &why_again) == status);
    must(is_at(plant, &after));
    if (status != LACONIC_OK) {
        must(is_at(plant, &before) && why.status == status && same_refusal(&why, &why_again));
        return false;
    }
    must(plant->steps == before.steps + 1 && is_finite_motion(plant));
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static laconic_plant plant, untouched;
    static laconic_vehicle vehicle;
    reader from = {data, data + size};
    laconic_start start;
    laconic_input input;
    laconic_refusal why;
    if (untouched.vehicle.wheel_count == 0) memset(&untouched, 0x5A, sizeof untouched);
    memcpy(&plant, &untouched, sizeof plant);
    memset(&start, 0, sizeof start);
    const laconic_method *method = laconic_method_by_number(byte(&from) % LACONIC_METHOD_COUNT);
    const laconic_real step_s = number(&from);
    for (int k = 0; k < 3; k++) start.nu_rad_per_s[k] = number(&from);
    start.heading_rad = number(&from);
    fill_vehicle(&from, &vehicle);
    if (laconic_plant_start(&plant, &vehicle, method, step_s, &start, &why) != LACONIC_OK) {
        must(memcmp(&untouched, &plant, sizeof plant) == 0);
        return 0;
    }
    must(is_finite_motion(&plant));
    for (int k = 0; k < STEPS; k++) {
        fill_input(&from, &input, WHEELS);
        if (!takes_step(&plant, &input)) return 0;
    }
    return 0;
}
