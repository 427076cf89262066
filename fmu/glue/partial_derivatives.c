/* Directional and adjoint derivatives, output and input derivatives: checks references and distributes seeds. */
#include <string.h>

#include "model_interface.h"

#define NO_TANGENT UINT32_MAX

static double *tangent_at(fmu_tangent *tangent, const fmu_slot *slot, uint32_t element) {
    return (double *)(void *)((char *)tangent + slot->variable->tangent + sizeof(double) * (slot->first + element));
}

/* Known are inputs and continuous states, in initialization mode also the start values of the states, and the time, on
 * which nothing depends. */
static bool is_known(const fmu_instance *instance, const fmu_variable *variable) {
    if (variable->access == FMU_INDEPENDENT || variable->access == FMU_INPUT) return true;
    if (fmu_access_of(instance, variable) == FMU_STATE) return true;
    return variable->tangent != NO_TANGENT && variable->access == FMU_FIXED && instance->mode == FMU_INITIALIZATION;
}

static bool is_unknown(const fmu_variable *variable) {
    return variable->tangent != NO_TANGENT && variable->access >= FMU_STATE;
}

static fmu_status count_known(const fmu_instance *instance, fmu_references list, bool known, size_t *total) {
    fmu_slot slot;
    *total = 0;
    if (list.count > 0 && list.reference == NULL)
        return fmu_refuse(instance, "the list of value references is missing (NULL)");
    for (size_t k = 0; k < list.count; k++) {
        if (!fmu_find(instance, list.reference[k], &slot))
            return fmu_refuse(instance, "there is no variable with the value reference %u",
                              (unsigned)list.reference[k]);
        if (!(known ? is_known(instance, slot.variable) : is_unknown(slot.variable)))
            return fmu_refuse(instance,
                              known ? "%s is neither an input nor a continuous state: no derivative with respect to it"
                                    : "%s is neither an output nor a derivative: it has no partial derivatives",
                              fmu_name_of(slot.variable));
        *total += slot.count;
    }
    return FMU_OK;
}

static fmu_status check_counts(fmu_instance *instance, fmu_references unknowns, fmu_references knowns,
                               size_t unknown_values, size_t known_values) {
    size_t total;
    fmu_status status = count_known(instance, unknowns, false, &total);
    if (status == FMU_OK && total != unknown_values)
        status = fmu_refuse(instance, "%zu values for unknowns that have %zu", unknown_values, total);
    if (status == FMU_OK) status = count_known(instance, knowns, true, &total);
    if (status == FMU_OK && total != known_values)
        status = fmu_refuse(instance, "%zu values for knowns that have %zu", known_values, total);
    if (status == FMU_OK) status = fmu_apply_parameters(instance);
    return status == FMU_OK ? fmu_model_check_tangent(instance) : status;
}

static fmu_status check_derivatives(fmu_instance *instance, fmu_references unknowns, fmu_references knowns,
                                    size_t unknown_values, size_t known_values) {
    const fmu_status status = check_counts(instance, unknowns, knowns, unknown_values, known_values);
    return FMU_MODEL_KEEPS_STEPS && status == FMU_OK ? fmu_model_check_step(instance) : status;
}

/* The response to the seeds in `tangent`. */
static void respond(fmu_instance *instance, fmu_tangent *tangent) {
    if (FMU_MODEL_KEEPS_STEPS)
        fmu_model_step_tangent(instance, tangent);
    else
        fmu_model_tangent(instance, tangent);
}

static fmu_status refuse_result(const fmu_instance *instance, const fmu_variable *variable) {
    return fmu_refuse(instance,
                      "a derivative of or by %s leaves the range of double precision; check inputs, states and "
                      "seeds",
                      fmu_name_of(variable));
}

/* Checks all values before it writes the first. */
static fmu_status read_unknowns(const fmu_instance *instance, fmu_references unknowns, fmu_tangent *tangent,
                                double *values) {
    size_t used = 0;
    fmu_slot slot;
    for (size_t k = 0; k < unknowns.count; k++) {
        fmu_find(instance, unknowns.reference[k], &slot);
        for (uint32_t i = 0; i < slot.count; i++)
            if (!fmu_is_finite(*tangent_at(tangent, &slot, i))) return refuse_result(instance, slot.variable);
    }
    for (size_t k = 0; k < unknowns.count; k++) {
        fmu_find(instance, unknowns.reference[k], &slot);
        for (uint32_t i = 0; i < slot.count; i++) values[used++] = *tangent_at(tangent, &slot, i);
    }
    return FMU_OK;
}

fmu_status fmu_directional(fmu_instance *instance, fmu_references unknowns, fmu_references knowns, const double *seed,
                           size_t seed_count, double *sensitivity, size_t sensitivity_count) {
    fmu_tangent tangent;
    size_t used = 0;
    fmu_slot slot;
    const fmu_status status = check_derivatives(instance, unknowns, knowns, sensitivity_count, seed_count);
    if (status != FMU_OK) return status;
    if ((seed_count > 0 && seed == NULL) || (sensitivity_count > 0 && sensitivity == NULL))
        return fmu_refuse(instance, "the list of seeds or sensitivities is missing (NULL)");
    memset(&tangent, 0, sizeof tangent);
    for (size_t k = 0; k < knowns.count; k++) {
        fmu_find(instance, knowns.reference[k], &slot);
        for (uint32_t i = 0; i < slot.count; i++, used++)
            if (slot.variable->access != FMU_INDEPENDENT) *tangent_at(&tangent, &slot, i) += seed[used];
    }
    respond(instance, &tangent);
    return read_unknowns(instance, unknowns, &tangent, sensitivity);
}

/* Σ over the unknowns of seed · ∂unknown/∂(one known element). */
static double adjoint_of(fmu_instance *instance, fmu_references unknowns, const fmu_slot *known, uint32_t element,
                         const double *seed) {
    fmu_tangent tangent;
    double sum = 0.0;
    size_t used = 0;
    fmu_slot slot;
    if (known->variable->access == FMU_INDEPENDENT) return 0.0;
    memset(&tangent, 0, sizeof tangent);
    *tangent_at(&tangent, known, element) = 1.0;
    respond(instance, &tangent);
    for (size_t k = 0; k < unknowns.count; k++) {
        fmu_find(instance, unknowns.reference[k], &slot);
        for (uint32_t i = 0; i < slot.count; i++) sum += seed[used++] * *tangent_at(&tangent, &slot, i);
    }
    return sum;
}

fmu_status fmu_adjoint(fmu_instance *instance, fmu_references unknowns, fmu_references knowns, const double *seed,
                       size_t seed_count, double *sensitivity, size_t sensitivity_count) {
    size_t used = 0;
    fmu_slot slot;
    const fmu_status status = check_derivatives(instance, unknowns, knowns, seed_count, sensitivity_count);
    if (status != FMU_OK) return status;
    if ((seed_count > 0 && seed == NULL) || (sensitivity_count > 0 && sensitivity == NULL))
        return fmu_refuse(instance, "the list of seeds or sensitivities is missing (NULL)");
    for (size_t k = 0; k < knowns.count; k++) {
        fmu_find(instance, knowns.reference[k], &slot);
        for (uint32_t i = 0; i < slot.count; i++) {
            const double found = adjoint_of(instance, unknowns, &slot, i, seed);
            if (!fmu_is_finite(found)) return refuse_result(instance, slot.variable);
            sensitivity[used++] = found;
        }
    }
    return FMU_OK;
}

static fmu_status check_orders(const fmu_instance *instance, size_t count, const int32_t *orders) {
    if (count > 0 && orders == NULL) return fmu_refuse(instance, "the list of orders is missing (NULL)");
    for (size_t k = 0; k < count; k++)
        if (orders[k] != 1)
            return fmu_refuse(instance, "a derivative of order %d was requested; there is only the first",
                              (int)orders[k]);
    return FMU_OK;
}

/* d/dt of the outputs along the motion, the inputs held (or changing with their slopes). */
fmu_status fmu_output_derivatives(fmu_instance *instance, fmu_references outputs, const int32_t *orders, double *values,
                                  size_t value_count) {
    fmu_tangent tangent;
    const fmu_references none = {NULL, 0};
    fmu_status status = check_counts(instance, outputs, none, value_count, 0);
    if (status == FMU_OK) status = check_orders(instance, outputs.count, orders);
    if (status != FMU_OK) return status;
    if (value_count > 0 && values == NULL) return fmu_refuse(instance, "the list of values is missing (NULL)");
    memset(&tangent, 0, sizeof tangent);
    fmu_model_motion_seed(instance, &tangent);
    fmu_model_tangent(instance, &tangent);
    return read_unknowns(instance, outputs, &tangent, values);
}

static fmu_status check_inputs(const fmu_instance *instance, fmu_references inputs, const double *values) {
    fmu_slot slot;
    if (inputs.count > 0 && (inputs.reference == NULL || values == NULL))
        return fmu_refuse(instance, "a list of value references or values is missing (NULL)");
    for (size_t k = 0; k < inputs.count; k++) {
        if (!fmu_find(instance, inputs.reference[k], &slot))
            return fmu_refuse(instance, "there is no variable with the value reference %u",
                              (unsigned)inputs.reference[k]);
        if (slot.variable->access != FMU_INPUT || slot.count != 1)
            return fmu_refuse(instance, "%s is no scalar input", fmu_name_of(slot.variable));
        if (!fmu_is_finite(values[k]))
            return fmu_refuse(instance, "%s: its derivative %g is not finite", fmu_name_of(slot.variable), values[k]);
    }
    return FMU_OK;
}

fmu_status fmu_set_input_derivatives(fmu_instance *instance, fmu_references inputs, const int32_t *orders,
                                     const double *values) {
    fmu_slot slot;
    fmu_status status = check_inputs(instance, inputs, values);
    if (!FMU_MODEL_TAKES_SLOPES)
        return fmu_refuse(instance, "the inputs are held over a step: they take no derivatives");
    if (status == FMU_OK) status = check_orders(instance, inputs.count, orders);
    if (status != FMU_OK) return status;
    for (size_t k = 0; k < inputs.count; k++) {
        fmu_find(instance, inputs.reference[k], &slot);
        fmu_model_set_slope(&instance->model, slot.variable->tangent + (uint32_t)sizeof(double) * slot.first,
                            values[k]);
    }
    return FMU_OK;
}
