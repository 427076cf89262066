/* Warnings that a wheel would slip or lift, so that the model no longer holds; each is logged once in a run. */
#ifndef LACONIC_FMU_VEHICLE_GRIP_WARNING_H
#define LACONIC_FMU_VEHICLE_GRIP_WARNING_H

#include "model_interface.h"

#define FMU_SLIP_WARNING 1U
#define FMU_LIFT_WARNING 2U
#define FMU_ALL_WARNINGS 3U

/* False, and nothing is computed, where no friction coefficient is given, all warnings are given, or none is logged. */
static inline bool fmu_grip_is_watched(const fmu_instance *instance) {
    return instance->model.contact.friction_coefficient > 0.0 &&
           (instance->warnings_given | instance->warnings_pending) != FMU_ALL_WARNINGS && instance->deliver != NULL &&
           (instance->log_categories & FMU_LOG_WARNING) != 0;
}

/* Makes slip and lift at that time pending warnings, which fmu_model_settle_warnings logs. */
void fmu_grip_check(fmu_instance *instance, const laconic_reactions *ground, double time_s);

#endif
