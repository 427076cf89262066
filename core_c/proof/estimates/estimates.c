/* Estimates of any plant's error, for Frama-C's analyser. The half steps are those of the plant's own method. */
#include "any_schedule.h"

#include "friction_step_stand_in.h"

#include "laconic/estimate.h"

static laconic_estimate estimate;
static laconic_errors errors;

/* As it is between two steps. */
static bool any_estimate(void) {
    laconic_estimate made;
    if (laconic_estimate_start(&made, &plant, Frama_C_interval(1, LACONIC_ESTIMATE_MOST), NULL, NULL) != LACONIC_OK)
        return false;
    ANYTHING(estimate);
    estimate.halves = made.halves;
    estimate.finer = made.finer;
    estimate.most_steps = Frama_C_interval(1, LACONIC_ESTIMATE_MOST);
    estimate.length = Frama_C_interval(0, LACONIC_ESTIMATE_MOST);
    estimate.taken = Frama_C_interval(0, LACONIC_ESTIMATE_MOST);
    estimate.last_length = Frama_C_interval(0, LACONIC_ESTIMATE_MOST);
    estimate.begun = ANY_BOOL();
    estimate.forcing.rotates = ANY_BOOL();
    estimate.start.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
    estimate.twin.heading.turns = Frama_C_long_long_interval(-MOST_TURNS - 1, MOST_TURNS);
    return true;
}

void prove_estimate_start(void) {
    if (!any_plant(&laconic_rk4)) return;
    (void)laconic_finer_method(&plant);
    (void)laconic_estimate_start(&estimate, &plant, Frama_C_interval(-2147483647 - 1, 2147483647),
                                 ANY_BOOL() ? NULL : &laconic_taylor_8, any_refusal());
}

/* The wheels of the changed vehicle are those of the old one. */
void prove_estimate_carry(void) {
    static laconic_plant before;
    if (!any_plant(&laconic_rk4) || !any_estimate()) return;
    before = plant;
    if (!any_plant(&laconic_rk4)) return;
    plant.model.wheel_count = before.model.wheel_count;
    plant.friction.wheel_count = before.model.wheel_count;
    (void)laconic_estimate_carry(&estimate, &before, &plant, NULL, any_refusal());
}

void prove_estimate_run(void) {
    if (!any_plant(&laconic_rk4) || !any_estimate()) return;
    PERHAPS(void) laconic_estimate_run(&estimate, &plant, &input[0], any_count(), any_refusal());
    PERHAPS(void) laconic_estimate_run_sampled(&estimate, &plant, input, any_refusal());
    laconic_estimate_read(&errors, &estimate, &plant);
}

void prove_estimate_follow(void) {
    static laconic_error_rows rows;
    static laconic_error row_of_errors[ROWS];
    if (!any_plant(&laconic_rk4) || !any_estimate()) return;
    plant.friction.acts = false;
    any_schedule();
    rows.every = any_count();
    rows.row = row_of_errors;
    rows.row_room = Frama_C_unsigned_int_interval(0, ROWS);
    rows.row_count = Frama_C_unsigned_int_interval(0, ROWS);
    (void)laconic_estimate_follow(&estimate, &plant, &schedule, any_count(), NULL, ANY_BOOL() ? &rows : NULL,
                                  any_refusal());
}
