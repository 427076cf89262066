/* The calls of Model Exchange: time, continuous states, their rates. */
#include <string.h>

#include "model_interface.h"

fmu_status fmu_set_time(fmu_instance *instance, double time_s) {
    if (!fmu_is_finite(time_s)) return fmu_refuse(instance, "SetTime: %g is not a time", time_s);
    if (fmu_clock_passes_stop(&instance->clock, time_s, 0.0) && !fmu_clock_allows_overshoot(&instance->clock, time_s))
        return fmu_refuse(instance, "SetTime: %.15g s is beyond the stop time %.15g s", time_s, instance->clock.stop_s);
    if (fmu_clock_is_before_start(&instance->clock, time_s))
        return fmu_refuse(instance, "SetTime: %.15g s is before the start time %.15g s", time_s,
                          instance->clock.start_s);
    instance->model.time_s = time_s;
    return FMU_OK;
}

fmu_status fmu_completed_step(fmu_instance *instance) {
    const double time_s = instance->model.time_s;
    if (fmu_clock_passes_stop(&instance->clock, time_s, 0.0))
        return fmu_refuse(instance, "CompletedIntegratorStep: %.15g s is beyond the stop time %.15g s", time_s,
                          instance->clock.stop_s);
    const fmu_status status = fmu_apply_parameters(instance);
    if (status != FMU_OK) return status;
    instance->clock.completed_s = time_s;
    fmu_model_completed_step(instance);
    return FMU_OK;
}

static fmu_status check_count(const fmu_instance *instance, const double *values, size_t count) {
    const uint32_t states = fmu_model_state_count(&instance->model);
    if (count != states)
        return fmu_refuse(instance, "there are %u continuous states, not %zu", (unsigned)states, count);
    return values != NULL ? FMU_OK : fmu_refuse(instance, "the list of values is missing (NULL)");
}

fmu_status fmu_get_states(fmu_instance *instance, double *values, size_t count) {
    fmu_status status = check_count(instance, values, count);
    if (status == FMU_OK) status = fmu_apply_parameters(instance);
    if (status == FMU_OK) fmu_model_get_states(instance, values);
    return status;
}

fmu_status fmu_set_states(fmu_instance *instance, const double *values, size_t count) {
    const fmu_status status = check_count(instance, values, count);
    if (status != FMU_OK) return status;
    for (size_t k = 0; k < count; k++)
        if (!(values[k] <= FMU_LARGEST_STATE && values[k] >= -FMU_LARGEST_STATE))
            return fmu_log(instance, FMU_DISCARD, FMU_LOG_DISCARD,
                           "continuous state %zu of %zu cannot be %g: take a smaller step", k + 1, count, values[k]);
    fmu_model_set_states(instance, values);
    return FMU_OK;
}

fmu_status fmu_get_rates(fmu_instance *instance, double *values, size_t count) {
    double rates[FMU_MODEL_MOST_STATES];
    fmu_status status = check_count(instance, values, count);
    if (status == FMU_OK) status = fmu_apply_parameters(instance);
    if (status != FMU_OK) return status;
    fmu_model_get_rates(instance, rates);
    for (size_t k = 0; k < count; k++)
        if (!fmu_is_finite(rates[k]))
            return fmu_refuse(instance,
                              "the derivative of continuous state %zu of %zu leaves the range of double "
                              "precision; check inputs and states",
                              k + 1, count);
    memcpy(values, rates, count * sizeof *values);
    return FMU_OK;
}

fmu_status fmu_get_nominals(fmu_instance *instance, double *values, size_t count) {
    const fmu_status status = check_count(instance, values, count);
    if (status == FMU_OK) fmu_model_get_nominals(&instance->model, values);
    return status;
}
