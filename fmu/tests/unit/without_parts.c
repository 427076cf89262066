/* Functions that only some models have: with bus terminals, with derivatives of steps, with an error estimate. The glue
 * calls them behind conditions that are false in other models; a compiler that counts coverage keeps the calls
 * nevertheless. */
#include <stdlib.h>

#include "model_interface.h"

#if FMU_MODEL_PORTS == 0
bool fmu_model_take_private(fmu_instance *instance, uint32_t reference, uint64_t bits) {
    (void)instance, (void)reference, (void)bits;
    abort();
}

void fmu_model_end_event(fmu_instance *instance) {
    (void)instance;
    abort();
}

bool fmu_model_needs_update(const fmu_model *model) {
    (void)model;
    abort();
}

bool fmu_model_needs_event(const fmu_model *model) {
    (void)model;
    abort();
}
#endif

#if !FMU_MODEL_KEEPS_STEPS
void fmu_model_begin_step(fmu_model *model) {
    (void)model;
    abort();
}

void fmu_model_end_step(fmu_model *model, fmu_status status) {
    (void)model, (void)status;
    abort();
}

void fmu_model_spoil_step(fmu_model *model, int32_t reason) {
    (void)model, (void)reason;
    abort();
}

fmu_status fmu_model_check_step(fmu_instance *instance) {
    (void)instance;
    abort();
}

void fmu_model_step_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance, (void)tangent;
    abort();
}
#endif

#if defined FMU_MODEL_ESTIMATES && !FMU_MODEL_ESTIMATES
#include "parts.h"

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
#endif
