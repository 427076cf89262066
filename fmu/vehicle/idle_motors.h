/* Voltages of wheels that have no motor: without effect, and logged once in a run. */
#ifndef LACONIC_FMU_VEHICLE_IDLE_MOTORS_H
#define LACONIC_FMU_VEHICLE_IDLE_MOTORS_H

#include "model_interface.h"

/* To be called when the plant was prepared: sets idle_wheels, so that vehicles without such wheels check nothing. */
void fmu_idle_motors_find(fmu_model *model);

/* Logs the first voltage without effect, once in a run. */
void fmu_idle_motors_check(fmu_instance *instance);

#endif
