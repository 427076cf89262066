/* The functions of FMI 2.0: they translate types, nothing else. */
#include "fmi2Functions.h"

/* Some importers' copies of that header know no prefix. */
#if defined FMI2_FUNCTION_PREFIX && !defined FMI2_OVERRIDE_FUNCTION_PREFIX
#undef fmi2FullName
#define FMU_PASTED(prefix, name) prefix##name
#define FMU_PREFIXED(prefix, name) FMU_PASTED(prefix, name)
#define fmi2FullName(name) FMU_PREFIXED(FMI2_FUNCTION_PREFIX, name)
#endif

#include "model_interface.h"

#define SELF(component) ((fmu_instance *)(component))
#define ALLOW(component, call) \
    if ((component) == NULL) return fmi2Error; \
    if (!FMU_MAY_CALL(SELF(component), call)) return fmi2Error

static fmi2Status to_fmi(fmu_status status) { return (fmi2Status)status; }

static fmu_references list(const fmi2ValueReference *references, size_t count) {
    const fmu_references pair = {references, count};
    return pair;
}

/* The importer's struct need not outlive fmi2Instantiate: the logger is copied. */
typedef struct fmu_callbacks_2 {
    fmi2CallbackLogger log;
} fmu_callbacks_2;

typedef char fmu_callback_storage_is_large_enough_2
    [sizeof(fmu_callbacks_2) <= sizeof(((fmu_instance *)0)->callback_storage) ? 1 : -1];

static const fmu_callbacks_2 *callbacks(const fmu_instance *instance) {
    return (const fmu_callbacks_2 *)(const void *)&instance->callback_storage;
}

/* The logger formats like printf, and no arguments are passed to it: each % must be doubled. Importers that print
 * the text as it is show both. */
static void log_message(const fmu_instance *instance, fmu_status status, const char *category, const char *text) {
    char safe[2 * FMU_LINE_LENGTH];
    size_t used = 0;
    for (; *text != '\0'; text++) {
        if (*text == '%') safe[used++] = '%';
        safe[used++] = *text;
    }
    safe[used] = '\0';
    callbacks(instance)->log(instance->environment, instance->name, to_fmi(status), category, safe);
}

/* ----------------------------------------------------------------------------- life of an instance -- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn) {
    fmu_callbacks_2 stored;
    (void)visible;
    if (functions == NULL) return NULL;
    if (fmuType != fmi2ModelExchange && fmuType != fmi2CoSimulation) {
        if (functions->logger != NULL)
            functions->logger(
                functions->componentEnvironment, instanceName, fmi2Error, "logStatusError",
                "Instantiate: there is no such fmuType; use fmi2ModelExchange (0) or fmi2CoSimulation (1)");
        return NULL;
    }
    stored.log = functions->logger;
    const fmu_request request = {
        .instance_name = instanceName,
        .token = fmuGUID,
        .resources = fmuResourceLocation,
        .kind = fmuType == fmi2ModelExchange ? FMU_MODEL_EXCHANGE : FMU_CO_SIMULATION,
        .version = 2,
        .logging_on = loggingOn != fmi2False,
        .deliver = functions->logger != NULL ? log_message : NULL,
        .environment = functions->componentEnvironment,
        .callbacks = &stored,
        .callbacks_size = sizeof stored,
    };
    return fmu_create(&request);
}

void fmi2FreeInstance(fmi2Component c) { fmu_free(SELF(c)); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[]) {
    ALLOW(c, FMU_CALL_SET_DEBUG_LOGGING);
    return to_fmi(fmu_set_logging(SELF(c), loggingOn != fmi2False, nCategories, categories));
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    (void)toleranceDefined; /* the step is fixed: there is no error control to set */
    (void)tolerance;
    ALLOW(c, FMU_CALL_SETUP_EXPERIMENT);
    return to_fmi(fmu_setup(SELF(c), startTime, stopTimeDefined != fmi2False, stopTime));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ALLOW(c, FMU_CALL_ENTER_INITIALIZATION);
    fmu_enter(SELF(c), FMU_INITIALIZATION);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ALLOW(c, FMU_CALL_EXIT_INITIALIZATION);
    return to_fmi(fmu_exit_initialization(SELF(c)));
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ALLOW(c, FMU_CALL_TERMINATE);
    fmu_enter(SELF(c), FMU_TERMINATED);
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    ALLOW(c, FMU_CALL_RESET);
    return to_fmi(fmu_reset(SELF(c)));
}

/* --------------------------------------------------------------------------------------- variables -- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]) {
    ALLOW(c, FMU_CALL_GET);
    return to_fmi(fmu_get_reals(SELF(c), vr, nvr, value, nvr));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]) {
    ALLOW(c, FMU_CALL_SET_CONTINUOUS);
    return to_fmi(fmu_set_reals(SELF(c), vr, nvr, value, nvr));
}

static double read_integer(const void *values, size_t k) { return ((const fmi2Integer *)values)[k]; }

static double read_boolean(const void *values, size_t k) { return ((const fmi2Boolean *)values)[k] != fmi2False; }

static void write_integer(void *values, size_t k, double number) { ((fmi2Integer *)values)[k] = (fmi2Integer)number; }

static void write_boolean(void *values, size_t k, double number) { ((fmi2Boolean *)values)[k] = (fmi2Boolean)number; }

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[]) {
    ALLOW(c, FMU_CALL_GET);
    return to_fmi(fmu_get(SELF(c), FMU_INTEGER, list(vr, nvr), value, nvr, write_integer));
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[]) {
    ALLOW(c, FMU_CALL_SET_DISCRETE);
    return to_fmi(fmu_set(SELF(c), FMU_INTEGER, list(vr, nvr), value, nvr, read_integer));
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[]) {
    ALLOW(c, FMU_CALL_GET);
    return to_fmi(fmu_get(SELF(c), FMU_BOOLEAN, list(vr, nvr), value, nvr, write_boolean));
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[]) {
    ALLOW(c, FMU_CALL_SET_DISCRETE);
    return to_fmi(fmu_set(SELF(c), FMU_BOOLEAN, list(vr, nvr), value, nvr, read_boolean));
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[]) {
    (void)vr;
    (void)value;
    ALLOW(c, FMU_CALL_GET);
    return to_fmi(fmu_refuse_kind(SELF(c), "String", nvr));
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[]) {
    (void)vr;
    (void)value;
    ALLOW(c, FMU_CALL_SET_DISCRETE);
    return to_fmi(fmu_refuse_kind(SELF(c), "String", nvr));
}

/* ------------------------------------------------------------------------------------ saved states -- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_save(SELF(c), (fmu_snapshot **)state));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_restore(SELF(c), state));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    fmu_drop((fmu_snapshot **)state);
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_serialized_size(SELF(c), state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_serialize(SELF(c), state, (uint8_t *)bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    ALLOW(c, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_deserialize(SELF(c), (const uint8_t *)bytes, size, (fmu_snapshot **)state));
}

/* ------------------------------------------------------------------------------------- derivatives -- */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t nUnknown,
                                        const fmi2ValueReference knowns[], size_t nKnown, const fmi2Real dKnown[],
                                        fmi2Real dUnknown[]) {
    ALLOW(c, FMU_CALL_PARTIAL_DERIVATIVE);
    return to_fmi(
        fmu_directional(SELF(c), list(unknowns, nUnknown), list(knowns, nKnown), dKnown, nKnown, dUnknown, nUnknown));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    ALLOW(c, FMU_CALL_INPUT_DERIVATIVES);
    return to_fmi(fmu_set_input_derivatives(SELF(c), list(vr, nvr), order, value));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
    ALLOW(c, FMU_CALL_OUTPUT_DERIVATIVES);
    return to_fmi(fmu_output_derivatives(SELF(c), list(vr, nvr), order, value, nvr));
}

/* ---------------------------------------------------------------------------------- Co-Simulation -- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    fmu_step_end end;
    (void)noSetFMUStatePriorToCurrentPoint;
    ALLOW(c, FMU_CALL_DO_STEP);
    return to_fmi(fmu_do_step(SELF(c), currentCommunicationPoint, communicationStepSize, &end));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    if (c == NULL) return fmi2Error;
    return to_fmi(fmu_cancel_step(SELF(c))); /* of another thread: steps are not asynchronous */
}

static fmi2Status no_status(fmi2Component c) {
    ALLOW(c, FMU_CALL_STEP_STATUS);
    return fmi2Discard; /* steps are synchronous: none is ever pending */
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)kind;
    (void)value;
    return no_status(c);
}

/* A refused step leaves the model at the step's start. */
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime || value == NULL) return no_status(c);
    ALLOW(c, FMU_CALL_STEP_STATUS);
    *value = fmu_clock_now(&SELF(c)->clock);
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind;
    (void)value;
    return no_status(c);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != fmi2Terminated || value == NULL) return no_status(c);
    ALLOW(c, FMU_CALL_STEP_STATUS);
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)kind;
    (void)value;
    return no_status(c);
}

/* --------------------------------------------------------------------------------- Model Exchange -- */

fmi2Status fmi2EnterEventMode(fmi2Component c) {
    ALLOW(c, FMU_CALL_ENTER_EVENT);
    fmu_enter(SELF(c), FMU_EVENT);
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    bool changed;
    ALLOW(c, FMU_CALL_UPDATE_DISCRETE_STATES);
    if (info == NULL)
        return to_fmi(fmu_refuse(SELF(c), "NewDiscreteStates: the pointer to the event information is missing (NULL)"));
    const fmu_status status = fmu_update_discrete_states(SELF(c), &changed);
    info->newDiscreteStatesNeeded = fmi2False;
    info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = changed ? fmi2True : fmi2False;
    info->nextEventTimeDefined = fmi2False;
    info->nextEventTime = 0.0;
    return to_fmi(status);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    ALLOW(c, FMU_CALL_ENTER_CONTINUOUS_TIME);
    fmu_enter(SELF(c), FMU_CONTINUOUS);
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
    (void)noSetFMUStatePriorToCurrentPoint;
    ALLOW(c, FMU_CALL_COMPLETED_STEP);
    if (enterEventMode != NULL) *enterEventMode = fmi2False;
    if (terminateSimulation != NULL) *terminateSimulation = fmi2False;
    return to_fmi(fmu_completed_step(SELF(c)));
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    ALLOW(c, FMU_CALL_SET_TIME);
    return to_fmi(fmu_set_time(SELF(c), time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx) {
    ALLOW(c, FMU_CALL_SET_STATES);
    return to_fmi(fmu_set_states(SELF(c), x, nx));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx) {
    ALLOW(c, FMU_CALL_GET_RATES);
    return to_fmi(fmu_get_rates(SELF(c), derivatives, nx));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni) {
    (void)eventIndicators;
    ALLOW(c, FMU_CALL_GET_STATES);
    return to_fmi(fmu_refuse_kind(SELF(c), "event indicator", ni));
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx) {
    ALLOW(c, FMU_CALL_GET_STATES);
    return to_fmi(fmu_get_states(SELF(c), x, nx));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t nx) {
    ALLOW(c, FMU_CALL_GET_NOMINALS);
    return to_fmi(fmu_get_nominals(SELF(c), nominals, nx));
}
