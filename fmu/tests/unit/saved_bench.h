/* What the tests of saved states of vehicles share: states and wheels that slip, of numbers that differ from each
 * other. */
#ifndef SAVED_BENCH_H
#define SAVED_BENCH_H

#include "bytes_bench.h"

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

#endif
