/* Which communication steps a fuzz target leaves out. */
#ifndef LACONIC_FMU_LONG_STEPS_H
#define LACONIC_FMU_LONG_STEPS_H

#include <stdbool.h>

#include "model_interface.h"

/* A communication step of a hundred million internal ones is allowed, of 1e-12 s, too, but takes minutes;
 * thirty show as much as a thousand. */
static inline bool takes_too_long(const void *instance, double communication_step_s) {
    const double own_s = ((const fmu_instance *)instance)->model.step_s;
    return own_s > 0.0 && communication_step_s > 32.0 * own_s;
}

#endif
