/* Why was a step refused? Found afterwards, so that steps that succeed pay nothing for it. */
#include "internal.h"

void laconic_step_refusal(laconic_refusal *why, laconic_status status, const laconic_model *model,
                          const laconic_integrator *integrator, const laconic_state *state, const laconic_input *inputs,
                          int32_t input_count) {
    real limit = R(0);
    int32_t i;
    if (why == NULL) return;
    for (i = 0; i < input_count; i++)
        if (laconic_input_check(model, &inputs[i], why) != LACONIC_OK) return;
    if (status == LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT)
        limit = laconic_largest_stable_step_s(integrator->method, model, state);
    if (status == LACONIC_STEP_GAINS_ENERGY || status == LACONIC_STEP_SINGULAR) limit = R(0.5) * integrator->step_s;
    refuse(why, status, LACONIC_FIELD_STEP, 0, integrator->step_s, limit);
}
