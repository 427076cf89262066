/* IMU and encoders, which sample at internal steps; and the acceleration of the body, which every vehicle has. */
#ifndef LACONIC_FMU_VEHICLE_SENSORS_PART_H
#define LACONIC_FMU_VEHICLE_SENSORS_PART_H

#include "model_interface.h"

/* Whether the vehicle has an IMU or an encoder. */
bool fmu_sensors_are_there(const fmu_model *model);

/* Whether there is a counter of one value, or Model Exchange cannot have this vehicle, since it has no internal steps
 * to sample at; the log says so. */
bool fmu_sensors_refuse(const fmu_instance *instance);

/* To be called when the plant was prepared: finds out who must watch its steps (fmu_model.watched). Ground with
 * friction is watched, too, as its acceleration is known of a whole step alone. */
void fmu_sensors_find(fmu_model *model);

/* Sensors as after power-up, if any watch. */
laconic_status fmu_sensors_start(fmu_model *model, laconic_refusal *why);

/* What the sensors show. */
void fmu_sensors_refresh(fmu_model *model);

/* The acceleration of the body's origin; in Model Exchange with friction the rates must be computed before. */
void fmu_sensors_accelerate(fmu_model *model);

#endif
