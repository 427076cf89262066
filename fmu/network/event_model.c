/* What models of a network answer alike, since frames and clocks alone change them: no parameter is tunable, no input
 * acts before the next frame or period, and no state is saved. */
#include "model_interface.h"

fmu_status fmu_model_change(fmu_instance *instance) {
    instance->model.change_needed = false;
    return FMU_OK;
}

void fmu_model_input_changed(fmu_instance *instance) { (void)instance; }

/* saved_states.c refuses to write a model with bus terminals before it asks. */
bool fmu_model_serialize(fmu_stream *stream, fmu_model *model) {
    (void)model;
    return !stream->failed;
}
