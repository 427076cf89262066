/* Runs of a plant with friction or without, its changes, and sensors that watch it, for Frama-C's analyser. */
#include "any_plant.h"

#include "friction_step_stand_in.h"

void prove_plant_run_slipping(void) {
    if (!any_plant(&laconic_rk4)) return;
    PERHAPS(void) laconic_plant_run(&plant, &input[0], any_count(), any_refusal());
    PERHAPS(void) laconic_plant_run_sampled(&plant, input, any_refusal());
}

void prove_plant_restart_slipping(void) {
    if (!any_plant(&laconic_rk4)) return;
    countable_vehicle();
    vehicle.wheel_count = plant.friction.wheel_count;
    plant.vehicle = vehicle;
    ANYTHING(start);
    (void)laconic_plant_restart(&plant, &start, any_refusal());
}

void prove_plant_change(void) {
    if (!any_plant(&laconic_rk4)) return;
    countable_vehicle();
    (void)laconic_plant_change(&plant, &vehicle, any_refusal());
}

/* -------------------------------------------------------------------------------------- sensors -- */

void prove_sensors_start(void) {
    static laconic_sensor_settings settings;
    if (!any_plant(&laconic_rk4)) return;
    ANYTHING(settings);
    (void)laconic_sensors_start(&sensors, &settings, &plant, any_refusal());
}

void prove_sensors_run(void) {
    if (!any_plant(&laconic_rk4)) return;
    any_sensors();
    PERHAPS(void) laconic_sensors_run(&sensors, &plant, &input[0], any_count(), any_refusal());
    PERHAPS(void) laconic_sensors_run_sampled(&sensors, &plant, input, any_refusal());
}
