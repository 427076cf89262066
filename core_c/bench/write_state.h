/* Writes every bit of a state as text: `name hexadecimal`, one number a line. */
#ifndef WRITE_STATE_H
#define WRITE_STATE_H

#include "bench.h"

typedef void (*write_bits)(const char *name, const void *bytes, uint32_t size);

static inline void write_sum(write_bits write, const char *name, const laconic_sum *sum) {
    write(name, &sum->value, sizeof sum->value);
    write(name, &sum->rest, sizeof sum->rest);
}

static inline void write_state(write_bits write, const laconic_state *state) {
    for (int k = 0; k < 3; k++) write_sum(write, "zeta", &state->zeta[k]);
    if (LACONIC_WITH_POSE) {
        write_sum(write, "x", &state->x_m);
        write_sum(write, "y", &state->y_m);
        write("turns", &state->heading.turns, sizeof state->heading.turns);
        write("heading", &state->heading.fraction, sizeof state->heading.fraction);
    }
    if (LACONIC_WITH_WHEEL_ANGLES)
        for (int k = 0; k < 3; k++) write_sum(write, "travel", &state->travel[k]);
#ifdef LACONIC_SCENE_SLIPS
    for (int32_t i = 0; i < laconic_scene_friction.wheel_count; i++) {
        const laconic_real *speed = &bench_slip()->wheel_speed_rad_per_s[i];
        write("wheel_speed", speed, sizeof *speed);
        write_sum(write, "wheel_angle", &bench_slip()->wheel_angle_rad[i]);
    }
#endif
}

#endif
