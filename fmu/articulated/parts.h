/* Parts of the FMU of a vehicle with hinges. */
#ifndef LACONIC_FMU_ARTICULATED_PARTS_H
#define LACONIC_FMU_ARTICULATED_PARTS_H

#include "model_interface.h"

/* The core's state at the start values, or at the nearest motion where a fixed wheel would slide (not `allowed`).
 * Refuses as laconic_articulated_state_set. */
laconic_status fmu_articulated_start(fmu_model *self, bool *allowed, laconic_refusal *why);

/* Logs a start that is not allowed, with the nearest one. */
fmu_status fmu_articulated_refuse_start(const fmu_instance *instance);

/* The continuous states of the core's state and its `motion`, and the core's state of them. The second refuses as
 * laconic_articulated_state_set. */
void fmu_articulated_show_state(fmu_model *self);
laconic_status fmu_articulated_take_state(fmu_model *self, const laconic_articulated_input *input,
                                          laconic_refusal *why);

/* The load of each wheel and support on level ground in this posture. A vertical hinge carries weight and tipping
 * moments, so that bodies on hinges stand as one with their parents; a ball (hinge_is_ball) carries weight alone.
 * shift_m: by how much an acceleration shifts the carriage's own weight, axes of the world. */
void fmu_articulated_loads(fmu_model *self, const double shift_m[2]);

#endif
