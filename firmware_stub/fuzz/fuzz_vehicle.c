/* Any vehicle under any method, step and input: what is refused changes nothing, what is accepted is finite, and the
 * same call gives the same bits again.
 *
 * Input: numbers of one to nine bytes each, of which the first chooses among usual, extreme and any; what is missing
 * is 0. */
#include "laconic/laconic.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { WHEELS = 5, STEPS = 4 };

typedef struct reader {
    const uint8_t *at, *end;
} reader;

static void must(bool holds) {
    if (!holds) abort();
}

static uint8_t byte(reader *from) { return from->at < from->end ? *from->at++ : 0; }

static laconic_real any(reader *from) {
    uint8_t bytes[sizeof(laconic_real)];
    laconic_real number;
    for (size_t k = 0; k < sizeof bytes; k++) bytes[k] = byte(from);
    memcpy(&number, bytes, sizeof number);
    return number;
}

/* Mostly numbers that a vehicle has, else extreme ones or any bits. */
static laconic_real number(reader *from) {
    static const laconic_real chosen[] = {0, 1, -1, 0.1, -0.1, 0.5, 3, 10, 1e-3, 1e3, 1e-9, 1e9, 1e-150, 1e150};
    const uint8_t kind = byte(from);
    if (kind == 255) return any(from);
    if (kind >= 128) return (laconic_real)(kind - 128) / 16;
    return chosen[kind % (sizeof chosen / sizeof chosen[0])];
}

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

static void fill_input(reader *from, laconic_input *input) {
    memset(input, 0, sizeof *input);
    for (int32_t i = 0; i < WHEELS; i++) input->voltage_V[i] = number(from);
    input->axle_torque_Nm[0] = number(from);
    input->body_force_N[0] = number(from);
    input->body_moment_Nm = number(from);
    input->world_force_N[1] = number(from);
    input->world_force_point_m[0] = number(from);
}

static bool is_finite_number(laconic_real x) { return x - x == 0; }

/* Every number of a motion. */
static bool is_finite_motion(const laconic_plant *plant) {
    laconic_pose pose;
    laconic_real nu[3], speed[LACONIC_MAX_WHEELS], angle[LACONIC_MAX_WHEELS];
    laconic_real zero = 0;
    laconic_pose_of(&pose, &plant->model, &plant->state);
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_plant_wheel_speeds(plant, speed);
    laconic_plant_wheel_angles(plant, angle);
    for (int k = 0; k < 3; k++) zero += nu[k] - nu[k];
    for (int32_t i = 0; i < plant->model.wheel_count; i++) zero += (speed[i] - speed[i]) + (angle[i] - angle[i]);
    return zero == 0 && is_finite_number(pose.x_m) && is_finite_number(pose.y_m) && is_finite_number(pose.heading_rad);
}

/* One call, twice from the same memory. */
static bool takes_step(laconic_plant *plant, const laconic_input *input) {
    static laconic_plant before, again;
    laconic_refusal why, why_again;
    memset(&why, 0, sizeof why);
    memset(&why_again, 0, sizeof why_again);
    memcpy(&before, plant, sizeof before);
    memcpy(&again, plant, sizeof again);
    const laconic_status status = laconic_plant_run(plant, input, 1, &why);
    must(laconic_plant_run(&again, input, 1, &why_again) == status);
    must(memcmp(&again, plant, sizeof again) == 0 && memcmp(&why, &why_again, sizeof why) == 0);
    if (status != LACONIC_OK) {
        must(memcmp(&before, plant, sizeof before) == 0);
        must(why.status == status);
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
    memset(&plant, 0x5A, sizeof plant);
    memset(&start, 0, sizeof start);
    memcpy(&untouched, &plant, sizeof plant);
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
        fill_input(&from, &input);
        if (!takes_step(&plant, &input)) return 0;
    }
    return 0;
}
