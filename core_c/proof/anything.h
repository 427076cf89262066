/* What a proof knows of its arguments: nothing but what stands here. Every real is any number, infinity or NaN. */
#ifndef LACONIC_PROOF_ANYTHING_H
#define LACONIC_PROOF_ANYTHING_H

#include "laconic/laconic.h"

#include "__fc_builtin.h"

/* Any bytes; a member in which not every byte is a value (bool) is then set by itself. */
#define ANYTHING(thing) Frama_C_make_unknown((char *)&(thing), sizeof(thing))
#define ANY_BOOL() ((bool)Frama_C_interval(0, 1))
/* Any of a function's cases, in one run of the analyser. */
#define PERHAPS if (Frama_C_interval(0, 1) != 0)

/* Steps begin within 2^62 turns and add less than 2^62 (heading.h). */
#define MOST_TURNS ((1LL << 62) + ((1LL << 62) - 2))

/* Each step adds less than 2^32 counts, so an encoder needs 2^31 steps to come here. */
#define MOST_COUNTS (1LL << 62)

static laconic_vehicle vehicle;
static laconic_model model, other;
static laconic_state state;
static laconic_input input[3];
static laconic_start start;
static laconic_refusal refusal;
static laconic_integrator integrator;

/* For a result of one number for each wheel. */
static laconic_real of_wheels[LACONIC_MAX_WHEELS];

static laconic_refusal *any_refusal(void) { return ANY_BOOL() ? &refusal : NULL; }

/* Counts and kinds are any number, too. */
static void any_vehicle(void) {
    ANYTHING(vehicle);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        vehicle.wheel[i].locked = ANY_BOOL();
        vehicle.wheel[i].undriven = ANY_BOOL();
    }
}

/* Counts that laconic_vehicle_check() lets pass: prove_vehicle_check. Every function that takes a vehicle calls it
 * first. */
static void countable_vehicle(void) {
    any_vehicle();
    vehicle.wheel_count = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    vehicle.support_count = Frama_C_interval(0, LACONIC_MAX_SUPPORTS);
}

/* A model that laconic_prepare() has made has so many wheels and degrees of freedom; its numbers are not used here. */
static void any_model(laconic_model *of) {
    Frama_C_make_unknown((char *)of, sizeof *of);
    of->wheel_count = Frama_C_interval(0, LACONIC_MAX_WHEELS);
    of->dof = Frama_C_interval(1, 3);
    of->rotated_twice = ANY_BOOL();
    of->sloped = ANY_BOOL();
}

static void any_state(void) {
    ANYTHING(state);
    state.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
}

static void any_inputs(void) { ANYTHING(input); }

static uint64_t any_count(void) {
    uint64_t count;
    ANYTHING(count);
    return count;
}

/* Rows and points as laconic_contact_prepare() counts them. */
static void any_contact(laconic_contact *of) {
    Frama_C_make_unknown((char *)of, sizeof *of);
    of->constraint_count = Frama_C_interval(0, 2 * LACONIC_MAX_WHEELS);
    of->point_count = Frama_C_interval(0, LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        of->lateral_row[i] = Frama_C_interval(-1, 2 * LACONIC_MAX_WHEELS - 1);
        of->brake_row[i] = Frama_C_interval(-1, 2 * LACONIC_MAX_WHEELS - 1);
    }
}

#endif
