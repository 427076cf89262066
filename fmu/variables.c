/* Reading and setting variables by value reference. */
#include <float.h>
#include <stdio.h>
#include <string.h>

#include "plant_api.h"

static const char *const type_names[] = {"a Float64 (Real)", "an Int32 (Integer)", "a UInt64 (Integer)",
                                         "an Enumeration", "a Boolean"};

bool fmu_find(const fmu_instance *instance, uint32_t reference, fmu_slot *slot) {
    const uint32_t row = fmu_row(reference), element = fmu_element(reference);
    uint32_t size;
    if (row >= fmu_variable_count || (row != reference && element == 0)) return false;
    slot->variable = &fmu_variables[row];
    size = slot->variable->size != 0 ? slot->variable->size : FMU_PLANT_ARRAY_SIZE(&instance->plant);
    if (element > size) return false;
    slot->first = element == 0 ? 0 : element - 1;
    slot->count = element == 0 ? size : 1;
    return true;
}

static const void *place_of(const fmu_instance *instance, const fmu_slot *slot, uint32_t element) {
    return (const char *)&instance->plant + slot->variable->offset +
           (size_t)(slot->first + element) * slot->variable->stride;
}

static double load(const fmu_instance *instance, const fmu_slot *slot, uint32_t element) {
    const void *place = place_of(instance, slot, element);
    switch (slot->variable->type) {
    case FMU_REAL: return *(const double *)place;
    case FMU_BOOLEAN: return *(const bool *)place ? 1.0 : 0.0;
    default: return (double)*(const int32_t *)place;
    }
}

static bool is_finite(double value) { return value <= DBL_MAX && value >= -DBL_MAX; }

static double least_of(const fmu_variable *variable) {
    return variable->access == FMU_STATE ? -FMU_LARGEST_STATE : variable->least;
}

static double most_of(const fmu_variable *variable) {
    return variable->access == FMU_STATE ? FMU_LARGEST_STATE : variable->most;
}

#define NAME_LENGTH 80U

static void name_element(char name[NAME_LENGTH], const fmu_slot *slot, uint32_t element) {
    if (slot->variable->size == 1)
        snprintf(name, NAME_LENGTH, "%s", slot->variable->name);
    else
        snprintf(name, NAME_LENGTH, "%s[%u]", slot->variable->name, (unsigned)(slot->first + element + 1));
}

static fmu_status refuse_result(const fmu_instance *instance, const fmu_slot *slot, uint32_t element) {
    char name[NAME_LENGTH];
    name_element(name, slot, element);
    return fmu_refuse(instance, "%s leaves the range of double precision; check inputs and states", name);
}

static fmu_status refuse_value(const fmu_instance *instance, const fmu_slot *slot, uint32_t element, double value) {
    const fmu_variable *variable = slot->variable;
    const double least = least_of(variable), most = most_of(variable);
    char name[NAME_LENGTH];
    name_element(name, slot, element);
    if (!is_finite(value)) return fmu_refuse(instance, "%s: %g is not a finite number", name, value);
    if (most == DBL_MAX) return fmu_refuse(instance, "%s: %.15g is outside its range: at least %g", name, value, least);
    return fmu_refuse(instance, "%s: %.15g is outside its range: %g to %g", name, value, least, most);
}

/* The range that the description declares, which NaN is not in; whether the model can do with the number is for the
 * model to say. */
static bool acceptable(const fmu_variable *variable, double value) {
    return value >= least_of(variable) && value <= most_of(variable);
}

static void store(fmu_instance *instance, const fmu_slot *slot, uint32_t element, double value) {
    void *place =
        (char *)&instance->plant + slot->variable->offset + (size_t)(slot->first + element) * slot->variable->stride;
    switch (slot->variable->type) {
    case FMU_REAL: *(double *)place = value; break;
    case FMU_BOOLEAN: *(bool *)place = value != 0.0; break;
    default: *(int32_t *)place = (int32_t)value;
    }
}

static const char *who_sets(fmu_access access) {
    switch (access) {
    case FMU_INDEPENDENT: return "it is the time; use SetTime";
    case FMU_STRUCTURAL: return "it is set in configuration mode, before initialization";
    case FMU_FIXED: return "it is fixed once initialization has ended";
    case FMU_TUNABLE: return "it is tunable: between steps, or in event mode where that is used";
    case FMU_INPUT: return "it is an input";
    case FMU_STATE: return "it is a state; only Model Exchange sets it";
    default: return "it is computed by the model";
    }
}

static fmu_status check_type(const fmu_instance *instance, fmu_type type, uint32_t reference, fmu_slot *slot) {
    if (!fmu_find(instance, reference, slot))
        return fmu_refuse(instance, "there is no variable with the value reference %u", (unsigned)reference);
    if (slot->variable->type != (uint8_t)type)
        return fmu_refuse(instance, "%s is %s, not %s", slot->variable->name, type_names[slot->variable->type],
                          type_names[type]);
    return FMU_OK;
}

static fmu_status make_ready(fmu_instance *instance, const fmu_variable *variable) {
    fmu_status status;
    if (variable->group == 0) return FMU_OK;
    if (instance->mode < FMU_INITIALIZATION)
        return fmu_refuse(instance, "%s is computed: it has no value before initialization", variable->name);
    status = fmu_make_current(instance);
    if (status == FMU_OK) fmu_plant_refresh(instance, variable->group);
    return status;
}

static fmu_status check_readable(fmu_instance *instance, fmu_type type, uint32_t reference, fmu_slot *slot) {
    const fmu_status status = check_type(instance, type, reference, slot);
    return status == FMU_OK ? make_ready(instance, slot->variable) : status;
}

static fmu_status check_settable(fmu_instance *instance, fmu_type type, uint32_t reference, fmu_slot *slot) {
    const fmu_status status = check_type(instance, type, reference, slot);
    if (status != FMU_OK) return status;
    if (!(instance->settable >> slot->variable->access & 1U))
        return fmu_refuse(instance, "%s cannot be set in %s: %s", slot->variable->name, fmu_mode_names[instance->mode],
                          who_sets((fmu_access)slot->variable->access));
    return slot->variable->access == FMU_STATE ? fmu_make_current(instance) : FMU_OK;
}

static fmu_status refuse_count(const fmu_instance *instance, const fmu_slot *slot, size_t given) {
    return fmu_refuse(instance, "%s has %u values, but only %zu were left of those given", slot->variable->name,
                      (unsigned)slot->count, given);
}

static fmu_status check_lists(const fmu_instance *instance, const void *references, size_t count, const void *values,
                              size_t value_count) {
    if ((count > 0 && references == NULL) || (value_count > 0 && values == NULL))
        return fmu_refuse(instance, "a list of value references or values is missing (NULL)");
    return FMU_OK;
}

/* All is checked before anything is handed out, so that a refused call leaves the importer's values as they were. */
static fmu_status check_get(fmu_instance *instance, fmu_type type, const uint32_t *references, size_t count,
                            const double *values, size_t value_count) {
    size_t k, used = 0;
    uint32_t i;
    fmu_slot slot;
    if (check_lists(instance, references, count, values, value_count) != FMU_OK) return FMU_ERROR;
    for (k = 0; k < count; k++) {
        const fmu_status status = check_readable(instance, type, references[k], &slot);
        if (status != FMU_OK) return status;
        if (slot.count > value_count - used) return refuse_count(instance, &slot, value_count - used);
        for (i = 0; i < slot.count; i++, used++)
            if (!is_finite(load(instance, &slot, i))) return refuse_result(instance, &slot, i);
    }
    if (used != value_count)
        return fmu_refuse(instance, "%zu values asked for, but the variables have %zu", value_count, used);
    return FMU_OK;
}

fmu_status fmu_get(fmu_instance *instance, fmu_type type, const uint32_t *references, size_t count, double *values,
                   size_t value_count) {
    size_t k, used = 0;
    uint32_t i;
    fmu_slot slot;
    const fmu_status status = check_get(instance, type, references, count, values, value_count);
    if (status != FMU_OK) return status;
    for (k = 0; k < count; k++) {
        if (!fmu_find(instance, references[k], &slot)) return FMU_ERROR; /* check_get has found it */
        for (i = 0; i < slot.count; i++) values[used++] = load(instance, &slot, i);
    }
    return FMU_OK;
}

/* All is checked before anything is stored, so that a refused call changes nothing. */
fmu_status fmu_check_set(fmu_instance *instance, fmu_type type, const uint32_t *references, size_t count,
                         const double *values, size_t value_count) {
    size_t k, used = 0;
    uint32_t i;
    fmu_slot slot;
    if (check_lists(instance, references, count, values, value_count) != FMU_OK) return FMU_ERROR;
    for (k = 0; k < count; k++) {
        const fmu_status status = check_settable(instance, type, references[k], &slot);
        if (status != FMU_OK) return status;
        if (slot.count > value_count - used) return refuse_count(instance, &slot, value_count - used);
        for (i = 0; i < slot.count; i++, used++)
            if (!acceptable(slot.variable, values[used])) return refuse_value(instance, &slot, i, values[used]);
    }
    if (used != value_count)
        return fmu_refuse(instance, "%zu values given, but the variables have %zu", value_count, used);
    return FMU_OK;
}

/* Parameters: until initialization ends everything starts anew, afterwards the motion is carried over. */
static void note_change(fmu_instance *instance, fmu_access access) {
    if (access == FMU_INPUT)
        fmu_plant_input_changed(&instance->plant);
    else if (access == FMU_STATE)
        instance->plant.states_changed = instance->plant.states_changed || instance->mode == FMU_EVENT;
    else if (instance->mode <= FMU_INITIALIZATION)
        instance->plant.start_needed = true;
    else
        instance->plant.change_needed = true;
}

fmu_status fmu_set(fmu_instance *instance, fmu_type type, const uint32_t *references, size_t count,
                   const double *values, size_t value_count) {
    size_t k, used = 0;
    uint32_t i;
    fmu_slot slot;
    const fmu_status status = fmu_check_set(instance, type, references, count, values, value_count);
    if (status != FMU_OK) return status;
    for (k = 0; k < count; k++) {
        if (!fmu_find(instance, references[k], &slot)) return FMU_ERROR; /* fmu_check_set has found it */
        if (slot.variable->access == FMU_STATE) fmu_plant_states_lead(instance);
        for (i = 0; i < slot.count; i++) store(instance, &slot, i, values[used++]);
        note_change(instance, (fmu_access)slot.variable->access);
    }
    return FMU_OK;
}

fmu_status fmu_size(fmu_instance *instance, const uint32_t *references, const void *values, size_t which, size_t left,
                    size_t *size) {
    fmu_slot slot;
    *size = 0;
    if (references == NULL || values == NULL)
        return fmu_refuse(instance, "a list of value references or values is missing (NULL)");
    if (!fmu_find(instance, references[which], &slot))
        return fmu_refuse(instance, "there is no variable with the value reference %u", (unsigned)references[which]);
    if (slot.count > left) return refuse_count(instance, &slot, left);
    *size = slot.count;
    return FMU_OK;
}

fmu_status fmu_all_used(const fmu_instance *instance, size_t used, size_t given) {
    if (used == given) return FMU_OK;
    return fmu_refuse(instance, "%zu values, but the variables have %zu", given, used);
}

fmu_status fmu_none_of(const fmu_instance *instance, const char *kind, size_t asked) {
    return asked == 0 ? FMU_OK : fmu_refuse(instance, "there are no variables of the kind %s", kind);
}

fmu_status fmu_check_intermediate(const fmu_instance *instance, const uint32_t *references, size_t count) {
    size_t k;
    fmu_slot slot;
    if (count > 0 && references == NULL)
        return fmu_refuse(instance, "Instantiate: the list of %zu required intermediate variables is missing (NULL)",
                          count);
    for (k = 0; k < count; k++) {
        if (!fmu_find(instance, references[k], &slot))
            return fmu_refuse(instance,
                              "Instantiate: no variable has the value reference %u, which is required as "
                              "intermediate variable",
                              (unsigned)references[k]);
        if (!slot.variable->intermediate)
            return fmu_refuse(instance,
                              "Instantiate: %s is required as intermediate variable, but it has no "
                              "intermediate updates",
                              slot.variable->name);
    }
    return FMU_OK;
}

bool fmu_take_start_value(fmu_instance *instance, uint32_t reference, double value) {
    fmu_slot slot;
    if (!fmu_find(instance, reference, &slot) || slot.count != 1) return false;
    if (slot.variable->access >= FMU_STATE) return false;
    if (slot.variable->access == FMU_STRUCTURAL && value == 0.0) /* a vehicle without wheels: only as a constant */
        instance->scalar = true;
    else if (!acceptable(slot.variable, value))
        return false;
    store(instance, &slot, 0, value);
    return true;
}
