/* The friction step, which entries of its own follow for each number of wheels, as what it may leave: any motion. */
#ifndef LACONIC_PROOF_FRICTION_STEP_STAND_IN_H
#define LACONIC_PROOF_FRICTION_STEP_STAND_IN_H

#include "anything.h"

laconic_status laconic_friction_step(const laconic_friction *friction, const laconic_model *of, laconic_real step_s,
                                     laconic_state *moved, laconic_slip *slip, const laconic_input *held) {
    const laconic_status status = (laconic_status)Frama_C_interval(0, LACONIC_STATUS_COUNT - 1);
    (void)friction;
    (void)of;
    (void)step_s;
    (void)held;
    if (status != LACONIC_OK) return status;
    Frama_C_make_unknown((char *)moved, sizeof *moved);
    Frama_C_make_unknown((char *)slip, sizeof *slip);
    moved->heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
    return status;
}

#endif
