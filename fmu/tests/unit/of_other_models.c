/* Functions that only models with bus terminals or with derivatives of steps have. The glue calls them behind
 * conditions that are false in this model; a compiler that counts coverage keeps the calls nevertheless. */
#include <stdlib.h>

#include "model_interface.h"

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
