/* Runs along a schedule that record rows, for Frama-C's analyser. */
#include "any_schedule.h"

void prove_schedule_at(void) {
    uint64_t until;
    any_schedule();
    (void)laconic_schedule_at(input, &until, &schedule, any_count());
}

void prove_follow(void) {
    if (!any_plant(&laconic_rk4)) return;
    plant.friction.acts = false;
    any_schedule();
    (void)laconic_plant_follow(&plant, &schedule, any_count(), any_recorder(), any_refusal());
}

/* There is room for the row. */
void prove_record_row(void) {
    if (!any_plant(&laconic_rk4) || any_recorder() == NULL) return;
    recorder.row_count = Frama_C_unsigned_int_interval(0, ROWS - 1);
    laconic_record_row(&recorder, &plant, &input[0]);
}
