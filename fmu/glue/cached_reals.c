/* Gets and sets reals at every step by a fast path: for a list of references that was valid the last time, and finite
 * values. All other cases take the path with all checks (variables.c), which logs the reason of a refusal. */
#include "model_interface.h"

static inline const fmu_variable *row_of(uint32_t reference) {
    const uint32_t row = fmu_row(reference);
    if (row >= fmu_variable_count || (row != reference && fmu_element(reference) == 0) ||
        fmu_variables[row].type != FMU_REAL)
        return NULL;
    return &fmu_variables[row];
}

/* Writes the offsets of the values of a reference and returns their number; 0: not by the fast path. */
static size_t offsets_of(const fmu_instance *instance, const fmu_variable *variable, uint32_t element, uint32_t *offset,
                         size_t room) {
    const uint32_t size = fmu_size_of(&instance->model, variable), first = element != 0 ? element - 1 : 0;
    const uint32_t count = element != 0 ? 1 : size;
    if (element > size || count > room) return 0;
    for (uint32_t i = 0; i < count; i++) offset[i] = variable->offset + (first + i) * variable->stride;
    return count;
}

/* Fills the list; false: not all of the references can take the fast path. */
static bool look_up(const fmu_instance *instance, fmu_list *list, const uint32_t *references, size_t count,
                    bool to_set) {
    list->count = list->values = 0;
    list->groups = 0;
    if (count > FMU_LIST_LENGTH) return false;
    for (size_t k = 0; k < count; k++) {
        const fmu_variable *variable = row_of(references[k]);
        if (variable == NULL || (to_set && variable->access != FMU_INPUT)) return false;
        const size_t found = offsets_of(instance, variable, fmu_element(references[k]), &list->offset[list->values],
                                        FMU_LIST_LENGTH - list->values);
        if (found == 0) return false;
        list->values += found;
        list->groups |= variable->group;
        list->reference[k] = references[k];
    }
    list->count = count;
    return true;
}

static inline bool is_known(const fmu_list *list, const uint32_t *references, size_t count) {
    if (list->count != count) return false;
    for (size_t k = 0; k < count; k++)
        if (list->reference[k] != references[k]) return false;
    return true;
}

static inline double *value_at(fmu_model *model, uint32_t offset) { return (double *)(void *)((char *)model + offset); }

/* 0, or NaN where the value is not finite: the sum over many is looked at once. */
static inline double zero_if_finite(double value) { return value - value; }

static bool get_quickly(fmu_instance *instance, const uint32_t *references, size_t count, double *values,
                        size_t value_count) {
    fmu_model *model = &instance->model;
    fmu_list *list = &instance->read;
    double not_finite = 0.0;
    if (model->start_needed || model->change_needed) return false;
    if (!is_known(list, references, count) && !look_up(instance, list, references, count, false)) return false;
    if (list->values != value_count) return false;
    if (list->groups & model->stale) fmu_model_refresh(instance, list->groups);
    for (size_t i = 0; i < value_count; i++) not_finite += zero_if_finite(*value_at(model, list->offset[i]));
    if (not_finite != 0.0) return false; /* variables.c logs which */
    for (size_t i = 0; i < value_count; i++) values[i] = *value_at(model, list->offset[i]);
    return true;
}

/* All is checked before anything is stored. Inputs may be set wherever the call is allowed (lifecycle.c). */
static bool set_quickly(fmu_instance *instance, const uint32_t *references, size_t count, const double *values,
                        size_t value_count) {
    fmu_model *model = &instance->model;
    fmu_list *list = &instance->written;
    double not_finite = 0.0;
    if (!is_known(list, references, count) && !look_up(instance, list, references, count, true)) return false;
    if (list->values != value_count) return false;
    for (size_t i = 0; i < value_count; i++) not_finite += zero_if_finite(values[i]);
    if (not_finite != 0.0) return false;
    for (size_t i = 0; i < value_count; i++) *value_at(model, list->offset[i]) = values[i];
    fmu_model_input_changed(instance);
    return true;
}

static double read_real(const void *values, size_t k) { return ((const double *)values)[k]; }

static void write_real(void *values, size_t k, double number) { ((double *)values)[k] = number; }

fmu_status fmu_get_reals(fmu_instance *instance, const uint32_t *references, size_t count, double *values,
                         size_t value_count) {
    if (references != NULL && values != NULL && get_quickly(instance, references, count, values, value_count))
        return FMU_OK;
    return fmu_get(instance, FMU_REAL, (fmu_references){references, count}, values, value_count, write_real);
}

fmu_status fmu_set_reals(fmu_instance *instance, const uint32_t *references, size_t count, const double *values,
                         size_t value_count) {
    if (references != NULL && values != NULL && set_quickly(instance, references, count, values, value_count))
        return FMU_OK;
    return fmu_set(instance, FMU_REAL, (fmu_references){references, count}, values, value_count, read_real);
}
