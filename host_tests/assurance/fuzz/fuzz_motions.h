/* What targets of vehicles and of steps share: numbers out of bytes, and what holds of every motion.
 *
 * Numbers are of one to nine bytes each, of which the first chooses among usual, extreme and any; what is missing is
 * 0. */
#ifndef FUZZ_MOTIONS_H
#define FUZZ_MOTIONS_H

#include "laconic/laconic.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct reader {
    const uint8_t *at, *end;
} reader;

/* Ends the program where a promise is broken, and says which. */
#define must(holds) ((holds) ? (void)0 : broken(#holds, __LINE__))

static inline void broken(const char *what, int line) {
    fprintf(stderr, "line %d: not so: %s\n", line, what);
    abort();
}

static inline uint8_t byte(reader *from) { return from->at < from->end ? *from->at++ : 0; }

static inline laconic_real any(reader *from) {
    uint8_t bytes[sizeof(laconic_real)];
    laconic_real number;
    for (size_t k = 0; k < sizeof bytes; k++) bytes[k] = byte(from);
    memcpy(&number, bytes, sizeof number);
    return number;
}

/* Mostly numbers that a vehicle has, else extreme ones or any bits. */
static inline laconic_real number(reader *from) {
    static const laconic_real chosen[] = {0, 1, -1, 0.1, -0.1, 0.5, 3, 10, 1e-3, 1e3, 1e-9, 1e9, 1e-150, 1e150};
    const uint8_t kind = byte(from);
    if (kind == 255) return any(from);
    if (kind >= 128) return (laconic_real)(kind - 128) / 16;
    return chosen[kind % (sizeof chosen / sizeof chosen[0])];
}

/* One input for `wheels` wheels; the first byte says which numbers follow. */
static inline void fill_input(reader *from, laconic_input *input, int32_t wheels) {
    const uint8_t what = byte(from);
    memset(input, 0, sizeof *input);
    for (int32_t i = 0; i < wheels && (what & 1U) != 0; i++) input->voltage_V[i] = number(from);
    if (what & 2U) input->axle_torque_Nm[0] = number(from);
    if (what & 4U) input->body_force_N[0] = number(from);
    if (what & 8U) input->body_moment_Nm = number(from);
    if (what & 16U) input->world_force_N[1] = number(from);
    if (what & 32U) input->world_force_point_m[0] = number(from);
}

static inline bool is_finite_number(laconic_real x) { return x - x == 0; }

/* Every number of a motion. */
static inline bool is_finite_motion(const laconic_plant *plant) {
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

/* What a motion consists of: saved by copying it, given back by copying it. Its structs have no padding in double. */
typedef struct saved {
    laconic_state state;
    laconic_slip slip;
    uint64_t steps;
} saved;

static inline void save(saved *to, const laconic_plant *plant) {
    memcpy(&to->state, &plant->state, sizeof to->state);
    if (plant->friction.acts) memcpy(&to->slip, &plant->slip, sizeof to->slip);
    to->steps = plant->steps;
}

static inline void restore(laconic_plant *plant, const saved *from) {
    memcpy(&plant->state, &from->state, sizeof from->state);
    if (plant->friction.acts) memcpy(&plant->slip, &from->slip, sizeof from->slip);
    plant->steps = from->steps;
}

static inline bool is_at(const laconic_plant *plant, const saved *there) {
    return memcmp(&plant->state, &there->state, sizeof there->state) == 0 && plant->steps == there->steps &&
           (!plant->friction.acts || memcmp(&plant->slip, &there->slip, sizeof there->slip) == 0);
}

static inline bool same_refusal(const laconic_refusal *a, const laconic_refusal *b) {
    return a->status == b->status && a->field == b->field && a->item == b->item &&
           memcmp(&a->value, &b->value, sizeof a->value) == 0 && memcmp(&a->limit, &b->limit, sizeof a->limit) == 0;
}

#endif
