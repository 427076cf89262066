/* A scene's steps in a loop: the same code is timed on the host, counted there and on a Cortex-M.
 *
 * Model, integrator and start are generated constants (`laconic trim`), and so are the segments here, so the
 * linker keeps only what a control loop needs. */
#ifndef BENCH_H
#define BENCH_H

#include "laconic_scene_model.h"

typedef struct bench_segment { /* some steps with the input held, or one step with it sampled */
    uint32_t steps;
    bool sampled;
    laconic_input start, middle, end; /* held: only start is used */
} bench_segment;

extern const bench_segment bench_segments[];
extern const uint32_t bench_segment_count;

void bench_reset(void);

/* One step of the current segment. */
laconic_status bench_step(void);

/* Takes steps through the segments in a cycle. A refusal does not end the run; the last one is returned. */
laconic_status bench_run(uint32_t steps);

/* The present state. */
const laconic_state *bench_state(void);

#ifdef LACONIC_SCENE_SLIPS /* wheels have states of their own */
#define BENCH_STATE_BYTES (sizeof(laconic_state) + sizeof(laconic_slip))
const laconic_slip *bench_slip(void);
#else
#define BENCH_STATE_BYTES sizeof(laconic_state)
#endif

/* Writes every bit of a state as text: `name hexadecimal`, one number a line. */
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
