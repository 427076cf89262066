/* A schedule of any signals and numbers, and a recorder of any columns, with arrays of the caller that have so many
 * stretches (of sampled schedules steps) and rows. */
#ifndef LACONIC_PROOF_ANY_SCHEDULE_H
#define LACONIC_PROOF_ANY_SCHEDULE_H

#include "any_plant.h"

#define STRETCHES 1000
#define ROWS 1000
#define SIGNALS (int)(sizeof(laconic_input) / sizeof(laconic_real))
#define COLUMNS (int)(sizeof(laconic_outputs) / sizeof(laconic_real))

static laconic_schedule schedule;
static laconic_recorder recorder;
static laconic_contact contact;
static laconic_grip grip;
static uint32_t signal[SIGNALS], column[COLUMNS];
static laconic_real value[3 * STRETCHES * SIGNALS], row[ROWS * COLUMNS];
static uint64_t until_step[STRETCHES];

static void any_schedule(void) {
    ANYTHING(value);
    ANYTHING(until_step);
    for (int k = 0; k < SIGNALS; k++)
        signal[k] = (uint32_t)Frama_C_interval(0, SIGNALS - 1) * (uint32_t)sizeof(laconic_real);
    schedule.signal_count = Frama_C_interval(0, SIGNALS);
    schedule.signal = signal;
    schedule.value = value;
    schedule.until_step = ANY_BOOL() ? until_step : NULL;
    schedule.count = Frama_C_unsigned_int_interval(0, STRETCHES);
    schedule.first_step = any_count();
}

static laconic_recorder *any_recorder(void) {
    any_contact(&contact);
    any_sensors();
    ANYTHING(grip);
    for (int k = 0; k < COLUMNS; k++)
        column[k] = (uint32_t)Frama_C_interval(0, COLUMNS - 1) * (uint32_t)sizeof(laconic_real);
    recorder.contact = ANY_BOOL() ? &contact : NULL;
    recorder.grip = ANY_BOOL() ? &grip : NULL;
    recorder.sensors = ANY_BOOL() ? &sensors : NULL;
    recorder.every = any_count();
    recorder.column_count = Frama_C_interval(0, COLUMNS);
    recorder.column = column;
    recorder.row = row;
    recorder.row_room = Frama_C_unsigned_int_interval(0, ROWS);
    recorder.row_count = Frama_C_unsigned_int_interval(0, ROWS);
    return ANY_BOOL() ? &recorder : NULL;
}

#endif
