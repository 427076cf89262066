/* Warnings that a wheel would slip or lift, so that the model no longer holds; each is logged once in a run. */
#ifndef LACONIC_FMU_VEHICLE_GRIP_WARNING_H
#define LACONIC_FMU_VEHICLE_GRIP_WARNING_H

#include "model_interface.h"

#define FMU_SLIP_WARNING 1U
#define FMU_LIFT_WARNING 2U
#define FMU_ALL_WARNINGS 3U /* of the ground */
#define FMU_IDLE_WARNING 4U /* of a voltage without effect; see idle_motors.h */

static inline bool fmu_wheels_slip(const fmu_model *model) {
    return model->plant.friction.acts && model->plant.friction.slips;
}

/* Warnings that this vehicle will not give any more. Slip is no news on ground with friction. */
static inline uint32_t fmu_warnings_done(const fmu_instance *instance) {
    return instance->warnings_given | instance->warnings_pending |
           (fmu_wheels_slip(&instance->model) ? FMU_SLIP_WARNING : 0U);
}

/* False, and nothing is computed, where no friction coefficient is given, all warnings are given, or none is logged. */
static inline bool fmu_grip_is_watched(const fmu_instance *instance) {
    const fmu_model *model = &instance->model;
    return (model->contact.friction_coefficient > 0.0 || fmu_wheels_slip(model)) &&
           (fmu_warnings_done(instance) & FMU_ALL_WARNINGS) != FMU_ALL_WARNINGS && instance->deliver != NULL &&
           (instance->log_categories & FMU_LOG_WARNING) != 0;
}

/* Makes slip and lift at that time pending warnings, which fmu_model_settle_warnings logs. */
void fmu_grip_check(fmu_instance *instance, const laconic_reactions *ground, double time_s);

#endif
