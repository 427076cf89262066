/* What a model behind the glue provides: vehicle/model.c and controller/model.c. Its struct fmu_model (model.h) is plain
 * data, so that it can be copied; every model has the members `start_needed`, `change_needed`, `states_changed`, `time_s` and
 * `stale` (the groups to compute before they are read), and the macros FMU_MODEL_ARRAY_SIZE, FMU_MODEL_LARGEST_ARRAY. */
#ifndef LACONIC_FMU_MODEL_INTERFACE_H
#define LACONIC_FMU_MODEL_INTERFACE_H

#include "instance.h"
#include "stream.h"

/* Parameters → prepared model and initial state; refuses with the model's own message. */
fmu_status fmu_model_start(fmu_instance *instance);

/* Tunable parameters set since → prepared anew, the motion carried over. */
fmu_status fmu_model_change(fmu_instance *instance);

/* An input was set: what depends on it is no longer fresh. */
void fmu_model_input_changed(fmu_model *model);

/* Computes the groups that are not fresh. */
void fmu_model_refresh(fmu_instance *instance, uint32_t groups);

/* The internal step that the parameters ask for; 0: as long as the communication step. */
double fmu_model_own_step(const fmu_model *model);
fmu_status fmu_model_set_step(fmu_instance *instance, double step_s);

/* Whole number of own steps in a communication step; refused with both numbers where there is none. */
fmu_status fmu_model_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps);

/* Takes up to `steps` internal steps; *taken says how many. Refused: the state is where *taken steps lead. */
fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken);

/* What was noted in a communication step (fmu_instance.warnings_pending) is said, or forgotten because the step was refused. */
void fmu_model_settle_warnings(fmu_instance *instance, bool accepted);

/* Model Exchange has taken a step: what must be said about where it led is said. */
void fmu_model_completed_step(fmu_instance *instance);

/* Remembers and brings back everything that steps change, for a communication step that is refused half-way. */
void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion);
void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion);

/* Continuous states of Model Exchange, in the order of the description. */
uint32_t fmu_model_state_count(const fmu_model *model);
void fmu_model_get_states(fmu_instance *instance, double *values);
void fmu_model_set_states(fmu_instance *instance, const double *values);
/* Some of them are about to be set one by one. */
void fmu_model_before_set_state(fmu_instance *instance);
void fmu_model_get_rates(fmu_instance *instance, double *values);
void fmu_model_get_nominals(const fmu_model *model, double *values);

/* Directional derivative: `tangent` holds the seeds, laid out by the table's `tangent` offsets; the outputs' part is filled. */
void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent);
/* Seeds of d/dt along the motion: rates of the states and slopes of the inputs. */
void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent);
/* Slopes of the inputs within the next step (FMI 2), laid out as the tangent's inputs. */
void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope);

/* Writes or reads all that the model consists of (stream.h). False: the bytes make no sense. */
bool fmu_model_serialize(fmu_stream *stream, fmu_model *model);

#endif
