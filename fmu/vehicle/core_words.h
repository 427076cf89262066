/* Refusals of the core in the log of an FMU, and how many internal steps a communication step has. */
#ifndef LACONIC_FMU_CORE_WORDS_H
#define LACONIC_FMU_CORE_WORDS_H

#include "laconic/laconic.h"
#include "model_interface.h"

/* Logs what the core refused, and `when`, by the names of variables. Error. */
fmu_status fmu_refuse_with(const fmu_instance *instance, const laconic_refusal *why, const char *when);

/* The same of a step, with its time. Discard. */
fmu_status fmu_discard_with(const fmu_instance *instance, const laconic_refusal *why);

#endif
