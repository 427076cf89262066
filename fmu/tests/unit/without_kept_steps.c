/* Functions that only models with derivatives of steps have. The glue calls them behind conditions that are
 * false in other models; a compiler that counts coverage keeps the calls nevertheless. */
#include <stdlib.h>

#include "model_interface.h"

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
