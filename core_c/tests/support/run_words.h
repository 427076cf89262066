/* What the programs share that run vehicles with hinges from plain numbers on standard input. */
#ifndef LACONIC_TEST_RUN_WORDS_H
#define LACONIC_TEST_RUN_WORDS_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "laconic/articulated.h"

static laconic_refusal why;

static inline double number(void) {
    double x;
    if (scanf("%lf", &x) != 1) exit(2);
    return x;
}

static inline laconic_real real_number(void) { return (laconic_real)number(); }

static inline void read_many(laconic_real *into, int count) {
    for (int i = 0; i < count; i++) into[i] = real_number();
}

/* Wheels' voltages and torques, body wrench, world force and its point. */
static inline void read_base_input(laconic_input *in, int wheels) {
    read_many(in->voltage_V, wheels);
    read_many(in->axle_torque_Nm, wheels);
    read_many(in->body_force_N, 2);
    in->body_moment_Nm = real_number();
    read_many(in->world_force_N, 2);
    read_many(in->world_force_point_m, 2);
}

static inline void print_many(const laconic_real *x, int count) {
    for (int i = 0; i < count; i++) printf(" %.17g", (double)x[i]);
}

/* Prints a refusal and ends the program with status 3. */
static inline void check(laconic_status status) {
    char text[500];
    if (status == LACONIC_OK) return;
    laconic_message(&why, text, sizeof text);
    printf("refused: %s | %s\n", laconic_status_name(status), text);
    exit(3);
}

#endif
