/* What the tests of saved states share: an instance to bytes and back, and numbers that differ from each other. */
#ifndef SAVED_BENCH_H
#define SAVED_BENCH_H

#include "fmi2_bench.h"
#include "model_interface.h"

static fmi2Byte bytes[65536];

static inline size_t write(void) {
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    TEST_ASSERT_TRUE(size < sizeof bytes);
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(fmi2FreeFMUstate(c, &kept));
    return size;
}

static inline fmi2Status read(size_t size) {
    fmi2FMUstate kept = NULL;
    const fmi2Status status = fmi2DeSerializeFMUstate(c, bytes, size, &kept);
    if (kept != NULL) OK(fmi2SetFMUstate(c, kept));
    OK(fmi2FreeFMUstate(c, &kept));
    return status;
}

static double filled;

/* Each number another one, with bits down to its last. */
static inline void fill(double *numbers, size_t size) {
    for (size_t k = 0; k < size / sizeof(double); k++) numbers[k] = (filled += 1) / 3;
}

#define FILL(member) fill((double *)(void *)&(member), sizeof(member))

static inline void fill_state(laconic_state *state) {
    FILL(state->zeta);
    FILL(state->x_m);
    FILL(state->y_m);
    state->heading.turns = -123456789012345;
    state->heading.fraction = 0xFEDCBA9876543210U;
    state->heading.rest = 1 / (filled += 1);
    FILL(state->travel);
    FILL(state->wheel_angle_set_rad);
}

static inline void fill_slip(laconic_slip *slip) {
    FILL(slip->wheel_speed_rad_per_s);
    FILL(slip->wheel_angle_rad);
    FILL(slip->grip_N);
    FILL(slip->normal_N);
    FILL(slip->current_A);
    for (int32_t i = 0; i < LACONIC_SLIP_WHEELS; i++) slip->limit[i] = i % (LACONIC_LIMIT_CURRENT + 1);
    FILL(slip->supply_current_A);
    FILL(slip->supply_voltage_V);
    FILL(slip->supply_energy_J);
    FILL(slip->outer_work_J);
    FILL(slip->slip_loss_J);
    FILL(slip->axle_loss_J);
    FILL(slip->motor_loss_J);
    FILL(slip->supply_loss_J);
    FILL(slip->numerical_loss_J);
}

/* Writes the instance, and reads it into another one. */
static inline void into_another(fmi2Type kind) {
    const size_t size = write();
    make(kind);
    OK(read(size));
}

#define COMES_BACK(member) \
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before.member, &after->member, sizeof before.member, #member)

#endif
