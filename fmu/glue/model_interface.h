/* The functions of an FMU model, which vehicle/model.c and controller/model.c implement for the glue. The struct
 * fmu_model (model.h) is plain data, so that it can be copied. Each model has the members `start_needed`,
 * `change_needed`, `states_changed`, `time_s` and `stale` (bits of the groups that must be computed before they are
 * read), and the macros FMU_MODEL_ARRAY_SIZE, FMU_MODEL_LARGEST_ARRAY, FMU_MODEL_MOST_STATES,
 * FMU_MODEL_HAS_OPTIONAL_STATES, FMU_MODEL_TAKES_SLOPES and FMU_MODEL_PORTS. Where FMU_MODEL_PORTS is not 0 it has bus
 * terminals (network/network_port.h), is for Co-Simulation only, and takes its steps by network/step.c. Others offer
 * Model Exchange unless FMU_MODEL_OFFERS_EXCHANGE is 0. */
#ifndef LACONIC_FMU_MODEL_INTERFACE_H
#define LACONIC_FMU_MODEL_INTERFACE_H

#include "instance.h"
#include "stream.h"

/* Only of models with bus terminals. */

/* Takes a start value that is no variable's (start_file.c): a reference from FMU_PRIVATE_START on, and 64 bits. */
bool fmu_model_take_private(fmu_instance *instance, uint32_t reference, uint64_t bits);
/* Ends an event iteration: takes what was received. */
void fmu_model_end_event(fmu_instance *instance);
/* Whether another event iteration must follow. */
bool fmu_model_needs_update(const fmu_model *model);
/* Whether a step has made a triggered clock due. */
bool fmu_model_needs_event(const fmu_model *model);

/* To be called when the FMU's own start values are in the model, before the importer sets any. */
void fmu_model_made(fmu_model *model);

/* Prepares the model from its parameters and sets the initial state. The log gives the reason of a refusal. */
fmu_status fmu_model_start(fmu_instance *instance);

/* Prepares the model again after tunable parameters were set; the motion is carried over. */
fmu_status fmu_model_change(fmu_instance *instance);

/* To be called after an input was set: marks the groups that depend on inputs as stale; logs inputs without effect. */
void fmu_model_input_changed(fmu_instance *instance);

/* Computes those of the groups that are stale. */
void fmu_model_refresh(fmu_instance *instance, uint32_t groups);

/* The internal step that the parameters set; 0: the internal step is the communication step. */
double fmu_model_own_step(const fmu_model *model);
fmu_status fmu_model_set_step(fmu_instance *instance, double step_s);

/* Writes how many internal steps of own_s the communication step has; refuses, with both lengths, a fraction of one. */
fmu_status fmu_model_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps);

/* Takes `steps` internal steps, fewer where fmu_instance.cancelled becomes true. When the core refuses one, the state
 * is that after the *taken steps before it. */
fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken);

/* Logs the warnings of a communication step (fmu_instance.warnings_pending) if the step is accepted, else drops
 * them. */
void fmu_model_settle_warnings(fmu_instance *instance, bool accepted);

/* To be called when Model Exchange has completed a step: logs the warnings about the state it has reached. */
void fmu_model_completed_step(fmu_instance *instance);

/* Copies everything that steps change, and restores it when a communication step is refused after some internal
 * steps. */
void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion);
void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion);

/* Continuous states of Model Exchange, in the order of the description. */
uint32_t fmu_model_state_count(const fmu_model *model);
void fmu_model_get_states(fmu_instance *instance, double *values);
void fmu_model_set_states(fmu_instance *instance, const double *values);
/* To be called before single continuous states are set: computes all of them; from then on the state follows them. */
void fmu_model_before_set_state(fmu_instance *instance);
void fmu_model_get_rates(fmu_instance *instance, double *values);
void fmu_model_get_nominals(const fmu_model *model, double *values);

/* Whether the model has partial derivatives as it is now; the log gives the reason if not. */
fmu_status fmu_model_check_tangent(const fmu_instance *instance);
/* Directional derivative: `tangent` has the seeds at the `tangent` offsets of the variable table, and gets the
 * outputs'. */
void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent);
/* Writes the seeds of the time derivative: rates of the states and slopes of the inputs. */
void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent);
/* Sets du/dt of one input in the next communication step (FMI 2); `tangent_offset` is that of the input in
 * fmu_tangent. */
void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope);

#ifndef FMU_MODEL_OFFERS_EXCHANGE
#define FMU_MODEL_OFFERS_EXCHANGE (FMU_MODEL_PORTS == 0)
#endif

#ifndef FMU_MODEL_KEEPS_STEPS
#define FMU_MODEL_KEEPS_STEPS 0
#endif

/* Only of models with FMU_MODEL_KEEPS_STEPS 1 (vehicle/kept_step.c). */

/* Before and after a communication step. */
void fmu_model_begin_step(fmu_model *model);
void fmu_model_end_step(fmu_model *model, fmu_status status);
/* From now on the step has no derivatives, for a reason that the model knows. */
void fmu_model_spoil_step(fmu_model *model, int32_t reason);
/* Whether the last communication step has derivatives, or there was none yet; the log gives the reason if not. */
fmu_status fmu_model_check_step(fmu_instance *instance);
/* fmu_model_tangent, but along the last communication step where the instance is in step mode or terminated: seeds of
 * states are those of its start, seeds of inputs those held over it. */
void fmu_model_step_tangent(fmu_instance *instance, fmu_tangent *tangent);

/* Writes or reads the whole model (stream.h). False: the bytes are too few, or a value is impossible. */
bool fmu_model_serialize(fmu_stream *stream, fmu_model *model);

#endif
