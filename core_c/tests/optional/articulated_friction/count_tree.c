/* count_tree VEHICLE STEPS: steps of 1 ms of one vehicle on ground with friction, whose instructions host_tests count.
 * VEHICLE is plain (four wheels on one body, by the friction step of rigid vehicles), rigid (the same as a tree without
 * hinges), casters, loader, ackermann, swerve, trailer. Voltages and servos' angles change every 100 steps. Prints the
 * mean of passes of a tree. */
#include <stdio.h>
#include <stdlib.h>

#include "slipping_trees.h"

#define STEP REAL(0.001)

static unsigned long long seed = 12345;

static int plain(long steps) {
    const laconic_vehicle v = tree_rigid().hinged.base;
    laconic_plant plant;
    laconic_start start;
    laconic_input in;
    memset(&start, 0, sizeof start);
    memset(&in, 0, sizeof in);
    if (laconic_plant_start(&plant, &v, &laconic_auto, STEP, &start, NULL) != LACONIC_OK) return 2;
    for (long k = 0; k < steps; k++) {
        for (int i = 0; k % 100 == 0 && i < 4; i++) in.voltage_V[i] = REAL(10 * tree_gust(&seed));
        if (laconic_friction_step(&plant.friction, &plant.model, STEP, &plant.state, &plant.slip, &in) != LACONIC_OK)
            return 3;
    }
    return 0;
}

static laconic_tree_vehicle named(const char *name) {
    if (strcmp(name, "casters") == 0) return tree_casters();
    if (strcmp(name, "loader") == 0) return tree_loader();
    if (strcmp(name, "ackermann") == 0) return tree_ackermann();
    if (strcmp(name, "swerve") == 0) return tree_swerve();
    if (strcmp(name, "trailer") == 0) return tree_trailer(0.8);
    return tree_rigid();
}

int main(int count, char **words) {
    long passes = 0;
    if (count < 3) return 2;
    const long steps = atol(words[2]);
    if (strcmp(words[1], "plain") == 0) return plain(steps);
    const laconic_tree_model m = tree_model(named(words[1]));
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    for (long k = 0; k < steps; k++) {
        for (int i = 0; k % 100 == 0 && i < m.wheel_count; i++)
            in.hinged.base.voltage_V[i] = REAL(10 * tree_gust(&seed));
        for (int b = 0; k % 100 == 0 && b < m.body_count; b++) in.hinge_angle_rad[b] = REAL(0.4 * tree_gust(&seed));
        if (laconic_tree_step(&m, STEP, &s, &in, NULL) != LACONIC_OK) return 3;
        passes += s.passes;
    }
    printf("%.3f\n", (double)passes / (double)steps);
    return 0;
}
