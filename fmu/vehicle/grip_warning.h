/* Whether the ground can give what the motion asks for: a warning, once a run for each thing that can go wrong. */
#ifndef LACONIC_FMU_VEHICLE_GRIP_WARNING_H
#define LACONIC_FMU_VEHICLE_GRIP_WARNING_H

#include "model_interface.h"

#define FMU_SLIP_WARNING 1U
#define FMU_LIFT_WARNING 2U
#define FMU_ALL_WARNINGS 3U

/* Nothing is computed where no friction coefficient is given, all is said already, or nobody listens. */
static inline bool fmu_grip_is_watched(const fmu_instance *instance) {
    return instance->model.contact.friction_coefficient > 0.0 &&
           (instance->warnings_given | instance->warnings_pending) != FMU_ALL_WARNINGS && instance->deliver != NULL &&
           (instance->log_categories & FMU_LOG_WARNING) != 0;
}

/* Notes what the reactions at that time ask of the ground and it cannot give; fmu_model_settle_warnings says it. */
void fmu_grip_check(fmu_instance *instance, const laconic_reactions *ground, double time_s);

#endif
