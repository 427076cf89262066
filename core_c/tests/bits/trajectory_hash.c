/* Prints numbers that depend on every bit of many trajectories: every method, roller and fixed wheels, slow and fast
 * damping, every input. The first line is of the methods 1 to 6, which every build has; each later method
 * has a line of its own, so that a new one leaves the lines of the others as they are; auto steps by these. Builds of
 * the core that differ in compiler, optimisation or processor must print the same (same_bits.py compares them). */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "laconic/laconic.h"

#ifndef STEPS
#define STEPS 4000
#endif
#define FIRST_OF_ALL 1
#define FIRST_WITH_A_LINE 7

#ifdef LACONIC_SINGLE
typedef uint32_t word;
#else
typedef uint64_t word;
#endif

static uint64_t hash; /* FNV-1a */

static void take(const laconic_real *numbers, int count) {
    for (int i = 0; i < count; i++) {
        word bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        for (size_t k = 0; k < sizeof bits; k++) hash = (hash ^ (bits >> 8 * k & 0xFF)) * 1099511628211U;
    }
}

static void take_outputs(const laconic_plant *plant, const laconic_contact *contact, const laconic_input *input) {
    laconic_real nu[3], angle[LACONIC_MAX_WHEELS], energy = laconic_energy_J(&plant->model, &plant->state);
    laconic_pose pose;
    laconic_reactions reactions;
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    laconic_wheel_angles(&plant->model, &plant->state, angle);
    laconic_reactions_of(&reactions, contact, &plant->model, &plant->state, input);
    take(nu, 3);
    take(&pose.x_m, 1);
    take(&pose.y_m, 1);
    take(&pose.heading_rad, 1);
    take(angle, plant->model.wheel_count);
    take(reactions.along_N, plant->model.wheel_count);
    take(&reactions.no_slip_margin_N, 1);
    take(&energy, 1);
}

static laconic_input input_of(int step) {
    laconic_input input;
    const laconic_real sign = step / 500 % 2 == 0 ? (laconic_real)1 : (laconic_real)-1;
    memset(&input, 0, sizeof input);
    input.voltage_V[0] = (laconic_real)2 * sign;
    input.voltage_V[1] = (laconic_real)-1.7;
    input.voltage_V[2] = (laconic_real)0.9 * sign;
    input.axle_torque_Nm[1] = (laconic_real)0.013;
    input.body_force_N[0] = (laconic_real)0.3;
    input.body_moment_Nm = (laconic_real)0.021;
    input.world_force_N[0] = (laconic_real)-0.4 * sign;
    input.world_force_N[1] = (laconic_real)0.2;
    input.world_force_point_m[1] = (laconic_real)0.06;
    return input;
}

static laconic_vehicle vehicle_of(int which) {
    const laconic_real turn = (laconic_real)1.0471975511966;
    laconic_vehicle v;
    memset(&v, 0, sizeof v);
    v.mass_kg = (laconic_real)10.3;
    v.yaw_inertia_kgm2 = (laconic_real)0.231;
    v.com_x_m = (laconic_real)0.013;
    v.com_y_m = (laconic_real)0.021;
    v.com_z_m = (laconic_real)0.1;
    v.wheel_radius_m = (laconic_real)0.051;
    v.wheel_inertia_kgm2 = (laconic_real)0.0087;
    v.motor_gain_Nm_per_V = (laconic_real)0.5;
    v.motor_damping_Nms = which == 2 ? (laconic_real)3 : (laconic_real)0.02;
    v.friction_coefficient = (laconic_real)0.7;
    v.wheel_count = which == 1 ? 2 : 4;
    for (int i = 0; i < v.wheel_count; i++) {
        v.wheel[i].kind = which == 1 ? LACONIC_WHEEL_FIXED : LACONIC_WHEEL_ROLLER;
        v.wheel[i].x_m = which == 1 ? (laconic_real)0 : (laconic_real)(i - 1) * (laconic_real)0.11;
        v.wheel[i].y_m = (laconic_real)(i % 2 == 0 ? 1 : -1) * (laconic_real)0.13;
        v.wheel[i].axle_rad = which == 1 ? (laconic_real)-1.5707963267949 : (laconic_real)i * turn;
        v.wheel[i].roller_rad = i % 2 == 0 ? (laconic_real)0.8 : (laconic_real)-1.3;
    }
    return v;
}

static int run(const laconic_method *method, int which) {
    const laconic_vehicle vehicle = vehicle_of(which);
    laconic_start start;
    laconic_plant plant;
    laconic_contact contact;
    laconic_refusal why;
    memset(&start, 0, sizeof start);
    start.heading_rad = (laconic_real)0.4;
    if (laconic_plant_start(&plant, &vehicle, method, (laconic_real)0.003, &start, &why) != LACONIC_OK ||
        laconic_contact_prepare(&contact, &vehicle, &why) != LACONIC_OK)
        return 1;
    for (int step = 0; step < STEPS; step++) {
        const laconic_input input = input_of(step);
        if (laconic_plant_run(&plant, &input, 1, &why) != LACONIC_OK) return 1;
        if (step % 10 == 0) take_outputs(&plant, &contact, &input);
    }
    return 0;
}

/* The line of the methods first … end − 1. */
static int print_line(int32_t first, int32_t end) {
    hash = 1469598103934665603U;
    for (int32_t number = first; number < end; number++)
        for (int which = 0; which < 3; which++)
            if (run(laconic_method_by_number(number), which) != 0) return 1;
    printf("%016" PRIx64 "\n", hash);
    return 0;
}

int main(void) {
    int failed = print_line(FIRST_OF_ALL, FIRST_WITH_A_LINE);
    for (int32_t number = FIRST_WITH_A_LINE; failed == 0 && number < LACONIC_METHOD_COUNT; number++)
        failed = print_line(number, number + 1);
    return failed;
}
