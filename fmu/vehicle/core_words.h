/* What models of vehicles share: refusals of the core and idle inputs in the log, and directions. */
#ifndef LACONIC_FMU_CORE_WORDS_H
#define LACONIC_FMU_CORE_WORDS_H

#include "laconic/laconic.h"
#include "model_interface.h"

/* Logs what the core refused, and `when`, by the names of variables. Error. */
fmu_status fmu_refuse_with(const fmu_instance *instance, const laconic_refusal *why, const char *when);

/* The same of a step, with its time. Discard. */
fmu_status fmu_discard_with(const fmu_instance *instance, const laconic_refusal *why);

/* An input that some vehicles do not read: its variable, its unit, and what the vehicle lacks. */
typedef struct fmu_idle_input {
    const char *name, *unit, *needs;
} fmu_idle_input;

/* Logs that element `element`, from 0, of an input has no effect, unless it is 0; once a run for each `kind`, below
 * 32. */
void fmu_warn_idle(fmu_instance *instance, const fmu_idle_input *idle, unsigned kind, int32_t element, double value);

/* (x, y) turned by a heading. */
void fmu_turn(double turned[2], const laconic_heading *heading, double x, double y);

#endif
