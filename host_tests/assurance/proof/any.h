/* What a proof assumes of its arguments: nothing but what is here. Every real is any number, infinity or NaN. */
#ifndef LACONIC_PROOF_ANY_H
#define LACONIC_PROOF_ANY_H

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

/* ---- a plant that has been started, and its sensors: counts and flags are as the functions that prepare leave them
 * -- */

static laconic_plant plant;
static laconic_sensors sensors;

/* As laconic_friction_of() leaves it: its counts are those of the vehicle. */
static void any_friction(laconic_friction *of, int32_t wheels) {
    Frama_C_make_unknown((char *)of, sizeof *of);
    of->acts = ANY_BOOL();
    of->slips = ANY_BOOL();
    of->wheel_count = wheels;
    of->point_count = wheels + Frama_C_interval(0, LACONIC_MAX_SUPPORTS);
    for (int32_t i = 0; i < LACONIC_SLIP_WHEELS; i++) of->axle[i].locked = ANY_BOOL();
}

/* A plant that has been started by some method; with friction, or without. */
static bool any_plant(const laconic_method *method) {
    ANYTHING(plant);
    any_model(&plant.model);
    any_state();
    plant.state = state;
    any_friction(&plant.friction, plant.model.wheel_count);
    any_inputs();
    return laconic_integrator_prepare(&plant.integrator, method, &plant.model, plant.integrator.step_s, NULL) ==
           LACONIC_OK;
}

/* Settings that laconic_sensor_settings_check() lets pass have such a delay. */
static void any_sensors(void) {
    ANYTHING(sensors);
    sensors.settings.imu.delay_steps = Frama_C_interval(0, LACONIC_IMU_MAX_DELAY);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        sensors.settings.encoder[i].counts_per_turn = Frama_C_interval(0, 2147483647);
        sensors.encoder[i].count = Frama_C_long_long_interval(-MOST_COUNTS, MOST_COUNTS);
    }
    sensors.settings.encoder_wrap = Frama_C_interval(0, 2147483647);
}

#endif
