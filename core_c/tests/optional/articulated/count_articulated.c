/* count_articulated VEHICLE METHOD STEPS: steps of one vehicle, whose instructions host_tests count. VEHICLE is
 * plain-3 … plain-6 (that many wheels, without hinges, by rk4), casters-1, casters-2, tricycle-motor,
 * tricycle-prescribed, ackermann, swerve, trailers-3. Commands vary: two inputs alternate, as a controller's would. */
#include <stdio.h>
#include <stdlib.h>

#include "hinged_vehicles.h"

#define STEP 0.001

static void plain_steps(int wheels, long steps) {
    laconic_vehicle v = two_wheeler().base;
    laconic_model m;
    laconic_integrator in;
    laconic_state s;
    laconic_start start;
    laconic_input input;
    memset(&start, 0, sizeof start);
    memset(&input, 0, sizeof input);
    memset(&in, 0, sizeof in);
    for (int i = 2; i < wheels; i++) {
        laconic_wheel *w = &v.wheel[v.wheel_count++];
        w->kind = LACONIC_WHEEL_ROLLER;
        w->x_m = REAL(0.2);
        w->y_m = REAL(0.1 * i);
        w->axle_rad = REAL(ALONG);
        w->roller_rad = REAL(PI / 2);
    }
    for (int i = 0; i < 2; i++) input.voltage_V[i] = REAL(3 + i);
    if (laconic_prepare(&m, &v, NULL) != LACONIC_OK) exit(2);
    if (laconic_integrator_prepare(&in, &laconic_rk4, &m, REAL(STEP), NULL) != LACONIC_OK) exit(2);
    if (laconic_state_set(&s, &m, &start, NULL) != LACONIC_OK) exit(2);
    for (long k = 0; k < steps; k++)
        if (laconic_step(&m, &in, &s, &input) != LACONIC_OK) exit(3);
}

static laconic_articulated_vehicle named_vehicle(const char *name) {
    laconic_articulated_vehicle v = two_wheeler();
    if (strcmp(name, "casters-1") == 0) hang_caster(&v, 0.22, 0.15, 0.04);
    if (strcmp(name, "casters-2") == 0) v = with_two_casters();
    if (strcmp(name, "tricycle-motor") == 0) v = tricycle(LACONIC_HINGE_MOTOR);
    if (strcmp(name, "tricycle-prescribed") == 0) v = tricycle(LACONIC_HINGE_PRESCRIBED);
    if (strcmp(name, "swerve") == 0) v = swerve(LACONIC_HINGE_COORDINATED, 4);
    if (strcmp(name, "ackermann") == 0 || strcmp(name, "trailers-3") == 0) v = car_with_trailer();
    if (strcmp(name, "ackermann") == 0) {
        v.body_count = 2;
        v.base.wheel_count = 4;
    }
    for (int b = 4; strcmp(name, "trailers-3") == 0 && b <= 5; b++) {
        hang_body(&v, b - 1, LACONIC_HINGE_FREE, -2.6, 0, 400, 300, -1.8, 0.03);
        hang_wheel(&v, b, -2.2, 0.6, 0.4);
        hang_wheel(&v, b, -2.2, -0.6, 0.4);
    }
    return v;
}

/* Commands go to and fro, with the rates of a steady change, so that the state needs no jump. */
static void commands(laconic_articulated_input ends[2]) {
    for (int k = 0; k < 2; k++) {
        ends[k] = nothing();
        for (int i = 0; i < 3; i++) ends[k].base.voltage_V[i] = REAL(5 + i);
        ends[k].hinge_voltage_V[0] = 1;
        ends[k].hinge_rate_rad_per_s[0] = REAL(k == 0 ? 0.1 : 0.1001);
        ends[k].twist[0] = 1;
        ends[k].twist[2] = REAL(k == 0 ? 0.1 : 0.1001);
    }
}

int main(int count, char **words) {
    laconic_articulated_input ends[2];
    if (count < 4) return 2;
    const long steps = atol(words[3]);
    if (strncmp(words[1], "plain-", 6) == 0) {
        plain_steps(atoi(words[1] + 6), steps);
        return 0;
    }
    const bool commanded = strncmp(words[1], "casters", 7) != 0 && strcmp(words[1], "tricycle-motor") != 0;
    const laconic_articulated_model m = hinged_model(named_vehicle(words[1]));
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    commands(ends);
    laconic_articulated_state s = hinged_state(&m, &start, &ends[0]);
    const laconic_articulated_integrator i = hinged_integrator(&m, laconic_articulated_method_by_name(words[2]), STEP);
    for (long k = 0; k < steps; k++) {
        const laconic_articulated_input *a = &ends[k % 2], *b = commanded ? &ends[(k + 1) % 2] : a;
        if (!commanded) a = b = &ends[0];
        if (laconic_articulated_step(&m, &i, &s, a, b, NULL) != LACONIC_OK) return 3;
    }
    return 0;
}
