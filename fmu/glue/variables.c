/* Reading and setting variables by value reference. */
#include <float.h>
#include <stdio.h>
#include <string.h>

#include "model_interface.h"

static const char *const type_names[] = {"a Float64 (Real)",
                                         "an Int32 (Integer)",
                                         "a UInt64 (Integer)",
                                         "an Enumeration",
                                         "a Boolean",
                                         "an Int32 (Integer)",
#if FMU_MODEL_PORTS
                                         "a Binary",
                                         "a Clock"
#endif
};

bool fmu_find(const fmu_instance *instance, uint32_t reference, fmu_slot *slot) {
    const uint32_t row = fmu_row(reference), element = fmu_element(reference);
    uint32_t size;
    if (row >= fmu_variable_count || (row != reference && element == 0)) return false;
    slot->variable = &fmu_variables[row];
    size = fmu_size_of(&instance->model, slot->variable);
    if (element > size) return false;
    slot->first = element == 0 ? 0 : element - 1;
    slot->count = element == 0 ? size : 1;
    return true;
}

static size_t offset_of(const fmu_slot *slot, uint32_t element) {
    return slot->variable->offset + (size_t)(slot->first + element) * slot->variable->stride;
}

static double load(const fmu_instance *instance, const fmu_slot *slot, uint32_t element) {
    const void *address = (const char *)&instance->model + offset_of(slot, element);
    switch (slot->variable->type) {
    case FMU_REAL: return *(const double *)address;
    case FMU_BOOLEAN: return *(const bool *)address ? 1.0 : 0.0;
    default: return (double)*(const int32_t *)address;
    }
}

static double least_of(const fmu_instance *instance, const fmu_variable *variable) {
    return fmu_access_of(instance, variable) == FMU_STATE ? -FMU_LARGEST_STATE : variable->least;
}

static double most_of(const fmu_instance *instance, const fmu_variable *variable) {
    return fmu_access_of(instance, variable) == FMU_STATE ? FMU_LARGEST_STATE : variable->most;
}

#define NAME_LENGTH 80U

static void name_element(char name[NAME_LENGTH], const fmu_slot *slot, uint32_t element) {
    if (slot->variable->size == 1)
        (void)snprintf(name, NAME_LENGTH, "%s", fmu_name_of(slot->variable));
    else
        (void)snprintf(name, NAME_LENGTH, "%s[%u]", fmu_name_of(slot->variable), (unsigned)(slot->first + element + 1));
}

static fmu_status refuse_result(const fmu_instance *instance, const fmu_slot *slot, uint32_t element) {
    char name[NAME_LENGTH];
    name_element(name, slot, element);
    return fmu_refuse(instance, "%s leaves the range of double precision; check inputs and states", name);
}

static fmu_status refuse_value(const fmu_instance *instance, const fmu_slot *slot, uint32_t element, double value) {
    const fmu_variable *variable = slot->variable;
    const double least = least_of(instance, variable), most = most_of(instance, variable);
    char name[NAME_LENGTH];
    name_element(name, slot, element);
    if (!fmu_is_finite(value)) return fmu_refuse(instance, "%s: %g is not a finite number", name, value);
    const int digits = fmu_digits(value, least, most);
    if (most == DBL_MAX)
        return fmu_refuse(instance, "%s: %.*g is outside its range: at least %.*g", name, digits, value, digits, least);
    return fmu_refuse(instance, "%s: %.*g is outside its range: %.*g to %.*g", name, digits, value, digits, least,
                      digits, most);
}

/* Whether the value lies in the range that the description declares; NaN does not. The model checks the rest. */
static bool acceptable(const fmu_instance *instance, const fmu_variable *variable, double value) {
    return value >= least_of(instance, variable) && value <= most_of(instance, variable);
}

static void store(fmu_instance *instance, const fmu_slot *slot, uint32_t element, double value) {
    void *address = (char *)&instance->model + offset_of(slot, element);
    switch (slot->variable->type) {
    case FMU_REAL: *(double *)address = value; break;
    case FMU_BOOLEAN: *(bool *)address = value != 0.0; break;
    default: *(int32_t *)address = (int32_t)value; break;
    }
}

static const char *who_sets(fmu_access access) {
    switch (access) {
    case FMU_INDEPENDENT: return "it is the time; use SetTime";
    case FMU_STRUCTURAL: return "it is set in configuration mode, before initialization";
    case FMU_FIXED: return "it is fixed once initialization has ended";
    case FMU_TUNABLE: return "it is tunable: between steps, or in event mode where that is used";
    case FMU_STATE: return "it is a state; only Model Exchange sets it";
    default: return "it is computed by the model";
    }
}

static bool is_of(fmu_type type, uint8_t own) {
    if (type == FMU_INTEGER) return own == FMU_INT32 || own == FMU_UINT64 || own == FMU_ENUMERATION;
    return own == (uint8_t)type;
}

static fmu_status find_typed(const fmu_instance *instance, fmu_type type, uint32_t reference, fmu_slot *slot) {
    if (!fmu_find(instance, reference, slot))
        return fmu_refuse(instance, "there is no variable with the value reference %u", (unsigned)reference);
    if (!is_of(type, slot->variable->type))
        return fmu_refuse(instance, "%s is %s, not %s", fmu_name_of(slot->variable), type_names[slot->variable->type],
                          type_names[type]);
    return FMU_OK;
}

static fmu_status make_ready(fmu_instance *instance, const fmu_variable *variable) {
    if (variable->group == 0) return FMU_OK;
    if (instance->mode < FMU_INITIALIZATION)
        return fmu_refuse(instance, "%s is computed: it has no value before initialization", fmu_name_of(variable));
    const fmu_status status = fmu_apply_parameters(instance);
    if (status == FMU_OK) fmu_model_refresh(instance, variable->group);
    return status;
}

/* One call of the importer: the list of its values, which get writes and set reads. */
typedef struct exchange {
    void *asked;
    fmu_write write;
    const void *given;
    fmu_read read;
    size_t count;
    const char *what; /* for messages: what the importer does with the values */
} exchange;

/* An action on one variable, whose values begin at number `used` of the exchange. */
typedef fmu_status (*visit)(fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used);

static fmu_status check_room(const fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used) {
    if (slot->count <= values->count - used) return FMU_OK;
    return fmu_refuse(instance, "%s has %u values, but only %zu were left of those given", fmu_name_of(slot->variable),
                      (unsigned)slot->count, values->count - used);
}

static fmu_status check_get(fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used) {
    fmu_status status = make_ready(instance, slot->variable);
    if (status == FMU_OK) status = check_room(instance, slot, values, used);
    for (uint32_t i = 0; status == FMU_OK && i < slot->count; i++)
        if (!fmu_is_finite(load(instance, slot, i))) status = refuse_result(instance, slot, i);
    return status;
}

static fmu_status copy_out(fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used) {
    for (uint32_t i = 0; i < slot->count; i++) values->write(values->asked, used + i, load(instance, slot, i));
    return FMU_OK;
}

static fmu_status check_settable(fmu_instance *instance, const fmu_variable *variable) {
    const fmu_access access = fmu_access_of(instance, variable);
    if (!(instance->settable >> access & 1U))
        return fmu_refuse(instance, "%s cannot be set in %s: %s", fmu_name_of(variable), fmu_mode_names[instance->mode],
                          who_sets(access));
    return access == FMU_STATE ? fmu_apply_parameters(instance) : FMU_OK;
}

static fmu_status check_set(fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used) {
    fmu_status status = check_settable(instance, slot->variable);
    if (status == FMU_OK) status = check_room(instance, slot, values, used);
    for (uint32_t i = 0; status == FMU_OK && i < slot->count; i++) {
        const double value = values->read(values->given, used + i);
        if (!acceptable(instance, slot->variable, value)) status = refuse_value(instance, slot, i, value);
    }
    return status;
}

/* A parameter that is set before initialization ends makes the model start anew; later the motion is carried over. */
static void note_change(fmu_instance *instance, fmu_access access) {
    if (access == FMU_INPUT)
        fmu_model_input_changed(instance);
    else if (access == FMU_STATE)
        instance->model.states_changed = instance->model.states_changed || instance->mode == FMU_EVENT;
    else if (instance->mode <= FMU_INITIALIZATION)
        instance->model.start_needed = true;
    else
        instance->model.change_needed = true;
}

static fmu_status copy_in(fmu_instance *instance, const fmu_slot *slot, const exchange *values, size_t used) {
    const fmu_access access = fmu_access_of(instance, slot->variable);
    if (access == FMU_STATE) fmu_model_before_set_state(instance);
    for (uint32_t i = 0; i < slot->count; i++) store(instance, slot, i, values->read(values->given, used + i));
    note_change(instance, access);
    return FMU_OK;
}

static fmu_status visit_each(fmu_instance *instance, fmu_type type, fmu_references list, const exchange *values,
                             visit what) {
    size_t used = 0;
    for (size_t k = 0; k < list.count; k++) {
        fmu_slot slot;
        fmu_status status = find_typed(instance, type, list.reference[k], &slot);
        if (status == FMU_OK) status = what(instance, &slot, values, used);
        if (status != FMU_OK) return status;
        used += slot.count;
    }
    if (used == values->count) return FMU_OK;
    return fmu_refuse(instance, "%zu values %s, but the variables have %zu", values->count, values->what, used);
}

static fmu_status check_then(fmu_instance *instance, fmu_type type, fmu_references list, const exchange *values,
                             visit check, visit act) {
    const bool missing = values->asked == NULL && values->given == NULL;
    if ((list.count > 0 && list.reference == NULL) || (values->count > 0 && missing))
        return fmu_refuse(instance, "a list of value references or values is missing (NULL)");
    const fmu_status status = visit_each(instance, type, list, values, check);
    return status == FMU_OK ? visit_each(instance, type, list, values, act) : status;
}

fmu_status fmu_get(fmu_instance *instance, fmu_type type, fmu_references list, void *values, size_t value_count,
                   fmu_write write) {
    const exchange asked = {.asked = values, .write = write, .count = value_count, .what = "asked for"};
    return check_then(instance, type, list, &asked, check_get, copy_out);
}

fmu_status fmu_set(fmu_instance *instance, fmu_type type, fmu_references list, const void *values, size_t value_count,
                   fmu_read read) {
    const exchange given = {.given = values, .read = read, .count = value_count, .what = "given"};
    return check_then(instance, type, list, &given, check_set, copy_in);
}

fmu_status fmu_refuse_kind(const fmu_instance *instance, const char *kind, size_t asked) {
    return asked == 0 ? FMU_OK : fmu_refuse(instance, "there are no variables of the kind %s", kind);
}

fmu_status fmu_check_intermediate(const fmu_instance *instance, const uint32_t *references, size_t count) {
    fmu_slot slot;
    if (count > 0 && references == NULL)
        return fmu_refuse(instance, "Instantiate: the list of %zu required intermediate variables is missing (NULL)",
                          count);
    for (size_t k = 0; k < count; k++) {
        if (!fmu_find(instance, references[k], &slot))
            return fmu_refuse(instance,
                              "Instantiate: no variable has the value reference %u, which is required as "
                              "intermediate variable",
                              (unsigned)references[k]);
        if (!slot.variable->intermediate)
            return fmu_refuse(instance,
                              "Instantiate: %s is required as intermediate variable, but it has no "
                              "intermediate updates",
                              fmu_name_of(slot.variable));
    }
    return FMU_OK;
}

bool fmu_set_start_value(fmu_instance *instance, uint32_t reference, double value) {
    fmu_slot slot;
    if (!fmu_find(instance, reference, &slot) || slot.count != 1) return false;
    if (slot.variable->access >= FMU_STATE) return false;
    if (slot.variable->access == FMU_STRUCTURAL && value == 0.0) /* without wheels it is a constant */
        instance->scalar = true;
    else if (!acceptable(instance, slot.variable, value))
        return false;
    store(instance, &slot, 0, value);
    return true;
}
