/* Whether the ground can give what the motion asks for: a warning, once a run for each thing that can go wrong. */
#ifndef LACONIC_FMU_VEHICLE_GRIP_WARNING_H
#define LACONIC_FMU_VEHICLE_GRIP_WARNING_H

#include "plant_api.h"

#define FMU_TOLD_SLIP 1U
#define FMU_TOLD_LIFT 2U
#define FMU_TOLD_ALL 3U

/* Nothing is computed where no friction coefficient is given, all is said already, or nobody listens. */
static inline bool fmu_grip_is_watched(const fmu_instance *instance) {
    return instance->plant.contact.friction_coefficient > 0.0 && (instance->told | instance->noted) != FMU_TOLD_ALL &&
           instance->deliver != NULL && (instance->log_categories & FMU_LOG_WARNING) != 0;
}

/* Notes what the reactions at that time ask of the ground and it cannot give; fmu_plant_conclude says it. */
void fmu_grip_judge(fmu_instance *instance, const laconic_reactions *ground, double time_s);

#endif
