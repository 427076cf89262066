/* The life of an instance: made, initialized, stepped, reset, freed. */
#include "instance.h"

#include <stdlib.h>
#include <string.h>

#include "model_interface.h"

#define SETS(access) (1U << (access))

/* What may be set in which mode; inputs wherever the call itself is allowed. */
static uint32_t settable_in(const fmu_instance *instance, fmu_mode mode) {
    const uint32_t start = SETS(FMU_FIXED) | SETS(FMU_TUNABLE) | SETS(FMU_INPUT);
    /* one by one: FMI 3 allows it, and in FMI 2 importers such as CasADi do it */
    const bool sets_states = instance->kind == FMU_MODEL_EXCHANGE;
    switch (mode) {
    case FMU_INSTANTIATED: return start;
    case FMU_CONFIGURATION: return instance->scalar ? 0 : SETS(FMU_STRUCTURAL);
    case FMU_INITIALIZATION: return start;
    case FMU_EVENT: return SETS(FMU_TUNABLE) | SETS(FMU_INPUT) | (sets_states ? SETS(FMU_STATE) : 0);
    case FMU_STEP: return SETS(FMU_INPUT) | (instance->event_mode_used ? 0 : SETS(FMU_TUNABLE));
    case FMU_CONTINUOUS: return SETS(FMU_INPUT) | SETS(FMU_STATE);
    case FMU_INTERMEDIATE: return SETS(FMU_INPUT);
    default: return 0;
    }
}

static bool allows(const fmu_instance *instance, const fmu_rule *rule, fmu_mode mode) {
    const unsigned modes = instance->kind == FMU_CO_SIMULATION
                               ? (instance->version == 2 ? rule->simulation_2 : rule->simulation_3)
                               : (instance->version == 2 ? rule->exchange_2 : rule->exchange_3);
    return (modes >> mode & 1U) != 0;
}

typedef char fmu_calls_fit_a_word[FMU_CALL_COUNT <= 32 ? 1 : -1];

void fmu_enter(fmu_instance *instance, fmu_mode mode) {
    instance->mode = mode;
    instance->read.count = instance->written.count = 0; /* they were checked for the old mode */
    instance->settable = settable_in(instance, mode);
    instance->allowed = 0;
    for (uint32_t call = 0; call < FMU_CALL_COUNT; call++)
        if (allows(instance, &fmu_rules[call], mode)) instance->allowed |= 1U << call;
}

void fmu_refuse_call(const fmu_instance *instance, fmu_call call) {
    fmu_refuse(instance, "%s is not allowed in %s", fmu_rules[call].what, fmu_mode_names[instance->mode]);
}

static char *copy_text(const char *text) {
    const size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    if (copy != NULL) memcpy(copy, text, size);
    return copy;
}

static bool has_name_and_token(const fmu_instance *instance, const fmu_request *request) {
    if (request->instance_name == NULL || request->instance_name[0] == '\0')
        fmu_refuse(instance, "Instantiate: the instance has no name (%s); give it one",
                   request->instance_name == NULL ? "NULL" : "an empty text");
    else if (request->token == NULL)
        fmu_refuse(instance, "Instantiate: the token is missing (NULL); it stands in modelDescription.xml");
    else
        return true;
    return false;
}

static bool offers_kind(const fmu_instance *instance) {
    if (FMU_MODEL_OFFERS_EXCHANGE || instance->kind == FMU_CO_SIMULATION) return true;
    fmu_refuse(instance, "this FMU offers no Model Exchange; use Co-Simulation");
    return false;
}

fmu_instance *fmu_create(const fmu_request *request) {
    fmu_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) return NULL;
    instance->kind = request->kind;
    instance->version = request->version;
    instance->deliver = request->deliver;
    instance->environment = request->environment;
    memcpy(instance->callback_storage, request->callbacks, request->callbacks_size);
    /* warnings are logged by default, since they state that results are invalid */
    instance->log_categories = request->logging_on ? FMU_LOG_ALL : FMU_LOG_ERROR | FMU_LOG_WARNING;
    instance->name = copy_text(request->instance_name != NULL ? request->instance_name : "");
    if (instance->name == NULL || !has_name_and_token(instance, request) || !offers_kind(instance) ||
        !fmu_load_start_values(instance, request->token, request->resources)) {
        fmu_free(instance);
        return NULL;
    }
    instance->token_hash = fmu_token_hash(request->token);
    fmu_model_made(&instance->model);
    instance->model.start_needed = true;
    instance->initial = instance->model;
    fmu_enter(instance, FMU_INSTANTIATED);
    return instance;
}

void fmu_free(fmu_instance *instance) {
    if (instance == NULL) return;
    free(instance->name);
    free(instance);
}

fmu_status fmu_setup(fmu_instance *instance, double start_s, bool stop_defined, double stop_s) {
    if (!fmu_is_finite(start_s)) return fmu_refuse(instance, "the start time %g is not finite", start_s);
    if (stop_defined && stop_s != stop_s) return fmu_refuse(instance, "the stop time %g is not finite", stop_s);
    if (stop_defined && !(stop_s >= start_s)) {
        const int digits = fmu_digits(stop_s, start_s, start_s);
        return fmu_refuse(instance, "the stop time %.*g s is before the start time %.*g s", digits, stop_s, digits,
                          start_s);
    }
    fmu_clock_start(&instance->clock, start_s, stop_defined, stop_s);
    instance->model.time_s = start_s;
    return FMU_OK;
}

fmu_status fmu_exit_initialization(fmu_instance *instance) {
    const fmu_status status = fmu_apply_parameters(instance);
    if (status != FMU_OK) return status;
    fmu_enter(instance, instance->kind == FMU_MODEL_EXCHANGE || instance->event_mode_used ? FMU_EVENT : FMU_STEP);
    return FMU_OK;
}

/* The next event iteration reports the changed states, whichever call has applied the change. */
static fmu_status apply_change(fmu_instance *instance) {
    const fmu_status status = fmu_model_change(instance);
    if (status == FMU_OK) instance->model.states_changed = true;
    return status;
}

fmu_status fmu_apply_parameters(fmu_instance *instance) {
    if (instance->model.start_needed) return fmu_model_start(instance);
    return instance->model.change_needed ? apply_change(instance) : FMU_OK;
}

fmu_status fmu_update_discrete_states(fmu_instance *instance, bool *states_changed) {
    const fmu_status status = fmu_apply_parameters(instance);
    if (FMU_MODEL_PORTS > 0 && status == FMU_OK) fmu_model_end_event(instance);
    *states_changed = instance->model.states_changed;
    instance->model.states_changed = false;
    return status;
}

fmu_status fmu_reset(fmu_instance *instance) {
    instance->model = instance->initial;
    instance->warnings_given = instance->warnings_pending = 0;
    fmu_clock_start(&instance->clock, 0.0, false, 0.0);
    fmu_enter(instance, FMU_INSTANTIATED);
    return FMU_OK;
}
