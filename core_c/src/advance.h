/* From an increment of ζ to the next state: the one place where pose and wheel angles advance. */
#ifndef LACONIC_ADVANCE_H
#define LACONIC_ADVANCE_H

#include "internal.h"

/* Takes the step or refuses (OVERFLOW) and leaves the state as it was. */
laconic_status laconic_advance(laconic_state *state, const laconic_model *model, real step_s,
                               const laconic_increment *increment);

#endif
