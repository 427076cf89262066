/* Functions that only models with bus terminals have. The glue calls them behind conditions that are
 * false in other models; a compiler that counts coverage keeps the calls nevertheless. */
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
