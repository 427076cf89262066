/* A plant that has been started, and the sensors beside it: their numbers are any; counts and flags are as the
 * functions that prepare leave them. */
#ifndef LACONIC_PROOF_ANY_PLANT_H
#define LACONIC_PROOF_ANY_PLANT_H

#include "anything.h"

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
