/* The core's error estimate beside the plant, of an FMU with FMU_MODEL_ESTIMATES 1. Elsewhere nothing calls these. */
#ifndef LACONIC_FMU_VEHICLE_ESTIMATE_PART_H
#define LACONIC_FMU_VEHICLE_ESTIMATE_PART_H

#include "model_interface.h"

/* Whether this instance estimates its error. */
bool fmu_estimate_is_on(const fmu_model *model);

/* Whether it is to be estimated in Model Exchange, which has no internal steps; the log says so. */
bool fmu_estimate_refuses(const fmu_instance *instance);

/* No error yet. Where the internal step is not known yet the estimate begins with it. */
laconic_status fmu_estimate_start(fmu_model *model, laconic_refusal *why);

/* laconic_plant_set_step(), and the estimate goes on, or begins. */
laconic_status fmu_estimate_set_step(fmu_model *model, double step_s, laconic_refusal *why);

/* The estimate goes on with a plant whose vehicle has changed; model->plant is still as before. */
laconic_status fmu_estimate_change(fmu_model *model, const laconic_plant *changed, laconic_refusal *why);

/* Steps of the plant, watched by sensors where there are any, with the input held, or one step with three samples. */
laconic_status fmu_estimate_run(fmu_model *model, uint64_t steps, laconic_refusal *why);
laconic_status fmu_estimate_run_sampled(fmu_model *model, const laconic_input samples[3], laconic_refusal *why);

/* What is known of the error now; all 0 where it is not estimated. */
void fmu_estimate_refresh(fmu_model *model);

/* The estimate's part of what steps change. */
void fmu_estimate_save(const fmu_model *model, fmu_model_motion *motion);
void fmu_estimate_restore(fmu_model *model, const fmu_model_motion *motion);

#endif
