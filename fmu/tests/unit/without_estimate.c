/* Functions that only models with an error estimate have. The glue calls them behind conditions that are
 * false in other models; a compiler that counts coverage keeps the calls nevertheless. */
#include <stdlib.h>

#include "estimate_part.h"

bool fmu_estimate_is_on(const fmu_model *model) {
    (void)model;
    abort();
}

bool fmu_estimate_refuses(const fmu_instance *instance) {
    (void)instance;
    abort();
}

laconic_status fmu_estimate_start(fmu_model *model, laconic_refusal *why) {
    (void)model, (void)why;
    abort();
}

laconic_status fmu_estimate_set_step(fmu_model *model, double step_s, laconic_refusal *why) {
    (void)model, (void)step_s, (void)why;
    abort();
}

laconic_status fmu_estimate_change(fmu_model *model, const laconic_plant *changed, laconic_refusal *why) {
    (void)model, (void)changed, (void)why;
    abort();
}

laconic_status fmu_estimate_run(fmu_model *model, uint64_t steps, laconic_refusal *why) {
    (void)model, (void)steps, (void)why;
    abort();
}

laconic_status fmu_estimate_run_sampled(fmu_model *model, const laconic_input samples[3], laconic_refusal *why) {
    (void)model, (void)samples, (void)why;
    abort();
}

void fmu_estimate_refresh(fmu_model *model) {
    (void)model;
    abort();
}

void fmu_estimate_save(const fmu_model *model, fmu_model_motion *motion) {
    (void)model, (void)motion;
    abort();
}

void fmu_estimate_restore(fmu_model *model, const fmu_model_motion *motion) {
    (void)model, (void)motion;
    abort();
}
