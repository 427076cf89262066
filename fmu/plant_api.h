/* What a model behind the glue provides: vehicle/plant.c and controller/plant.c. Its struct fmu_plant (plant.h) is plain
 * data, so that it can be copied; every plant has the members `start_needed`, `change_needed`, `states_changed`, `time_s` and
 * `stale` (the groups to compute before they are read), and the macros FMU_PLANT_ARRAY_SIZE, FMU_PLANT_LARGEST_ARRAY. */
#ifndef LACONIC_FMU_PLANT_API_H
#define LACONIC_FMU_PLANT_API_H

#include "instance.h"
#include "stream.h"

/* Parameters → prepared model and initial state; refuses with the model's own message. */
fmu_status fmu_plant_start(fmu_instance *instance);

/* Tunable parameters set since → prepared anew, the motion carried over. */
fmu_status fmu_plant_change(fmu_instance *instance);

/* An input was set: what depends on it is no longer fresh. */
void fmu_plant_input_changed(fmu_plant *plant);

/* Computes the groups that are not fresh. */
void fmu_plant_refresh(fmu_instance *instance, uint32_t groups);

/* The internal step that the parameters ask for; 0: as long as the communication step. */
double fmu_plant_own_step(const fmu_plant *plant);
fmu_status fmu_plant_set_step(fmu_instance *instance, double step_s);

/* Whole number of own steps in a communication step; refused with both numbers where there is none. */
fmu_status fmu_plant_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps);

/* Takes up to `steps` internal steps; *taken says how many. Refused: the state is where *taken steps lead. */
fmu_status fmu_plant_run(fmu_instance *instance, uint64_t steps, uint64_t *taken);

/* What was noted in a communication step (fmu_instance.noted) is said, or forgotten because the step was refused. */
void fmu_plant_conclude(fmu_instance *instance, bool accepted);

/* Model Exchange has taken a step: what must be said about where it led is said. */
void fmu_plant_watch(fmu_instance *instance);

/* Remembers and brings back everything that steps change, for a communication step that is refused half-way. */
void fmu_plant_mark(const fmu_plant *plant, fmu_plant_motion *motion);
void fmu_plant_return(fmu_plant *plant, const fmu_plant_motion *motion);

/* Continuous states of Model Exchange, in the order of the description. */
uint32_t fmu_plant_state_count(const fmu_plant *plant);
void fmu_plant_get_states(fmu_instance *instance, double *values);
void fmu_plant_set_states(fmu_instance *instance, const double *values);
/* Some of them are about to be set one by one. */
void fmu_plant_states_lead(fmu_instance *instance);
void fmu_plant_get_rates(fmu_instance *instance, double *values);
void fmu_plant_get_nominals(const fmu_plant *plant, double *values);

/* Directional derivative: `tangent` holds the seeds, laid out by the table's `tangent` offsets; the outputs' part is filled. */
void fmu_plant_tangent(fmu_instance *instance, fmu_tangent *tangent);
/* Seeds of d/dt along the motion: rates of the states and slopes of the inputs. */
void fmu_plant_motion_seed(fmu_instance *instance, fmu_tangent *tangent);
/* Slopes of the inputs within the next step (FMI 2), laid out as the tangent's inputs. */
void fmu_plant_set_slope(fmu_plant *plant, uint32_t tangent_offset, double slope);

/* Writes or reads all that the plant consists of (stream.h). False: the bytes make no sense. */
bool fmu_plant_transfer(fmu_stream *stream, fmu_plant *plant);

#endif
