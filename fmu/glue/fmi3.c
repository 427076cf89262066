/* The functions of FMI 3.0: they translate types, nothing else. */
#include <stdlib.h>

#include "fmi3Functions.h"

#include "model_interface.h"

#define SELF(instance) ((fmu_instance *)(instance))
#define ALLOW(instance, call) \
    if ((instance) == NULL) return fmi3Error; \
    if (!FMU_MAY_CALL(SELF(instance), call)) return fmi3Error

static fmi3Status to_fmi(fmu_status status) { return (fmi3Status)status; }

static fmu_references list(const fmi3ValueReference *references, size_t count) {
    const fmu_references pair = {references, count};
    return pair;
}

/* C does not convert pointers to functions to pointers to data, so the instance keeps the callbacks in this struct. */
typedef struct fmu_callbacks_3 {
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
} fmu_callbacks_3;

typedef char fmu_callback_storage_is_large_enough_3
    [sizeof(fmu_callbacks_3) <= sizeof(((fmu_instance *)0)->callback_storage) ? 1 : -1];

static const fmu_callbacks_3 *callbacks(const fmu_instance *instance) {
    return (const fmu_callbacks_3 *)(const void *)&instance->callback_storage;
}

static void log_message(const fmu_instance *instance, fmu_status status, const char *category, const char *text) {
    callbacks(instance)->log(instance->environment, to_fmi(status), category, text);
}

static bool offer_update(fmu_instance *instance, bool finished) {
    fmi3Boolean early = fmi3False;
    fmi3Float64 early_time = 0.0;
    callbacks(instance)->update(instance->environment, fmu_clock_now(&instance->clock), !finished, true, true,
                                instance->early_return_allowed, &early, &early_time);
    return early && instance->early_return_allowed;
}

/* ----------------------------------------------------------------------------- life of an instance -- */

const char *fmi3GetVersion(void) { return fmi3Version; }

static fmu_instance *create(fmu_kind kind, fmi3String name, fmi3String token, fmi3String resources, bool logging_on,
                            fmi3InstanceEnvironment environment, const fmu_callbacks_3 *functions) {
    const fmu_request request = {
        .instance_name = name,
        .token = token,
        .resources = resources,
        .kind = kind,
        .version = 3,
        .logging_on = logging_on,
        .deliver = functions->log != NULL ? log_message : NULL,
        .environment = environment,
        .callbacks = functions,
        .callbacks_size = sizeof *functions,
    };
    return fmu_create(&request);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage) {
    const fmu_callbacks_3 functions = {logMessage, NULL};
    (void)visible;
    return create(FMU_MODEL_EXCHANGE, instanceName, instantiationToken, resourcePath, loggingOn, instanceEnvironment,
                  &functions);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate) {
    const fmu_callbacks_3 functions = {logMessage, intermediateUpdate};
    fmu_instance *instance = create(FMU_CO_SIMULATION, instanceName, instantiationToken, resourcePath, loggingOn,
                                    instanceEnvironment, &functions);
    (void)visible;
    if (instance == NULL) return NULL;
    if (fmu_check_intermediate(instance, requiredIntermediateVariables, nRequiredIntermediateVariables) != FMU_OK) {
        fmu_free(instance);
        return NULL;
    }
    if (FMU_MODEL_PORTS > 0 && !eventModeUsed) {
        fmu_refuse(instance, "Instantiate: the clocks of a bus need event mode; import the FMU with it");
        fmu_free(instance);
        return NULL;
    }
    instance->event_mode_used = eventModeUsed;
    instance->early_return_allowed = earlyReturnAllowed;
    instance->between_steps = intermediateUpdate != NULL ? offer_update : NULL;
    return instance;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption) {
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    if (logMessage != NULL)
        logMessage(instanceEnvironment, fmi3Error, "logStatusError", "this FMU offers no Scheduled Execution");
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance) { fmu_free(SELF(instance)); }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[]) {
    ALLOW(instance, FMU_CALL_SET_DEBUG_LOGGING);
    return to_fmi(fmu_set_logging(SELF(instance), loggingOn, nCategories, categories));
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_ENTER_CONFIGURATION);
    if (SELF(instance)->scalar) return to_fmi(fmu_refuse(SELF(instance), "this FMU has no structural parameters"));
    fmu_enter(SELF(instance), FMU_CONFIGURATION);
    return fmi3OK;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_EXIT_CONFIGURATION);
    fmu_enter(SELF(instance), FMU_INSTANTIATED);
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) {
    (void)toleranceDefined; /* the step is fixed: there is no error control to set */
    (void)tolerance;
    ALLOW(instance, FMU_CALL_ENTER_INITIALIZATION);
    const fmu_status status = fmu_setup(SELF(instance), startTime, stopTimeDefined, stopTime);
    if (status == FMU_OK) fmu_enter(SELF(instance), FMU_INITIALIZATION);
    return to_fmi(status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_EXIT_INITIALIZATION);
    return to_fmi(fmu_exit_initialization(SELF(instance)));
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_ENTER_EVENT);
    if (SELF(instance)->kind == FMU_CO_SIMULATION && !SELF(instance)->event_mode_used)
        return to_fmi(fmu_refuse(SELF(instance), "EnterEventMode: the instance was made without event mode"));
    fmu_enter(SELF(instance), FMU_EVENT);
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_TERMINATE);
    fmu_enter(SELF(instance), FMU_TERMINATED);
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_RESET);
    return to_fmi(fmu_reset(SELF(instance)));
}

/* --------------------------------------------------------------------------------------- variables -- */

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3Float64 values[], size_t nValues) {
    ALLOW(instance, FMU_CALL_GET);
    return to_fmi(fmu_get_reals(SELF(instance), valueReferences, nValueReferences, values, nValues));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3Float64 values[], size_t nValues) {
    ALLOW(instance, FMU_CALL_SET_CONTINUOUS);
    return to_fmi(fmu_set_reals(SELF(instance), valueReferences, nValueReferences, values, nValues));
}

/* The other types in use. Enumerations are read and set as Int64. `number` makes a double of a value that is set. */
#define PLAIN(value) (double)(value)
/* a negative int that the importer has cast to uint64_t is refused as the negative number that it was */
#define SIGNED(value) ((value) >= UINT64_MAX - INT32_MAX ? (double)(int64_t)(value) : (double)(value))
#define TYPED(Name, Type, fmu_type, number) \
    static double read_##Name(const void *values, size_t k) { return number(((const Type *)values)[k]); } \
    static void write_##Name(void *values, size_t k, double value) { ((Type *)values)[k] = (Type)value; } \
    fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                             size_t nValueReferences, Type values[], size_t nValues) { \
        ALLOW(instance, FMU_CALL_GET); \
        return to_fmi(fmu_get(SELF(instance), fmu_type, list(valueReferences, nValueReferences), values, nValues, \
                              write_##Name)); \
    } \
    fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                             size_t nValueReferences, const Type values[], size_t nValues) { \
        ALLOW(instance, FMU_CALL_SET_DISCRETE); \
        return to_fmi( \
            fmu_set(SELF(instance), fmu_type, list(valueReferences, nValueReferences), values, nValues, read_##Name)); \
    }

TYPED(Int32, fmi3Int32, FMU_INT32, PLAIN)
TYPED(Int64, fmi3Int64, FMU_ENUMERATION, PLAIN)
TYPED(UInt64, fmi3UInt64, FMU_UINT64, SIGNED)
TYPED(Boolean, fmi3Boolean, FMU_BOOLEAN, PLAIN)

/* Functions for kinds of variables that this FMU lacks: they succeed with an empty list only. `unread` casts the unused
 * parameters to void. */
#define ABSENT(function, call, kind, asked, unread, ...) \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                        __VA_ARGS__) { \
        (void)valueReferences; \
        unread; \
        ALLOW(instance, call); \
        return to_fmi(fmu_refuse_kind(SELF(instance), kind, asked)); \
    }
#define ABSENT_TYPE(Name, Type) \
    ABSENT(fmi3Get##Name, FMU_CALL_GET, #Name, nValueReferences + nValues, (void)values, Type values[], \
           size_t nValues) \
    ABSENT(fmi3Set##Name, FMU_CALL_SET_CONTINUOUS, #Name, nValueReferences + nValues, (void)values, \
           const Type values[], size_t nValues)

ABSENT_TYPE(Float32, fmi3Float32)
ABSENT_TYPE(Int8, fmi3Int8)
ABSENT_TYPE(UInt8, fmi3UInt8)
ABSENT_TYPE(Int16, fmi3Int16)
ABSENT_TYPE(UInt16, fmi3UInt16)
ABSENT_TYPE(UInt32, fmi3UInt32)
ABSENT_TYPE(String, fmi3String)
#if FMU_MODEL_PORTS == 0 /* else they are in network/fmi3_clocks.c */
ABSENT(fmi3GetBinary, FMU_CALL_GET, "Binary", nValueReferences + nValues, ((void)valueSizes, (void)values),
       size_t valueSizes[], fmi3Binary values[], size_t nValues)
ABSENT(fmi3SetBinary, FMU_CALL_SET_DISCRETE, "Binary", nValueReferences + nValues, ((void)valueSizes, (void)values),
       const size_t valueSizes[], const fmi3Binary values[], size_t nValues)

#define NO_CLOCK(Name, unread, ...) \
    ABSENT(fmi3##Name, FMU_CALL_STATE_OF_FMU, "Clock", nValueReferences, unread, __VA_ARGS__)

NO_CLOCK(GetClock, (void)values, fmi3Clock values[])
NO_CLOCK(SetClock, (void)values, const fmi3Clock values[])
NO_CLOCK(GetShiftDecimal, (void)shifts, fmi3Float64 shifts[])
NO_CLOCK(SetShiftDecimal, (void)shifts, const fmi3Float64 shifts[])
NO_CLOCK(SetIntervalDecimal, (void)intervals, const fmi3Float64 intervals[])
NO_CLOCK(GetIntervalDecimal, ((void)intervals, (void)qualifiers), fmi3Float64 intervals[],
         fmi3IntervalQualifier qualifiers[])
NO_CLOCK(GetShiftFraction, ((void)counters, (void)resolutions), fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NO_CLOCK(SetShiftFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
         const fmi3UInt64 resolutions[])
NO_CLOCK(SetIntervalFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
         const fmi3UInt64 resolutions[])
NO_CLOCK(GetIntervalFraction, ((void)counters, (void)resolutions, (void)qualifiers), fmi3UInt64 counters[],
         fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
#endif

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_UPDATE_DISCRETE_STATES);
    return fmi3OK; /* there are none */
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clockReference,
                                      fmi3Float64 activationTime) {
    (void)clockReference;
    (void)activationTime;
    if (instance == NULL) return fmi3Error;
    return to_fmi(fmu_refuse(SELF(instance), "this FMU offers no Scheduled Execution"));
}

/* ------------------------------------------------------------------------------------ dependencies -- */

/* Dependencies are given in ModelStructure, not per element. */
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference valueReference,
                                               size_t *nDependencies) {
    (void)valueReference;
    (void)nDependencies;
    ALLOW(instance, FMU_CALL_DEPENDENCIES);
    return to_fmi(fmu_refuse(SELF(instance), "dependencies per element are not provided: see ModelStructure"));
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
                                       size_t nDependencies) {
    (void)dependent;
    (void)elementIndicesOfDependent;
    (void)independents;
    (void)elementIndicesOfIndependents;
    (void)dependencyKinds;
    (void)nDependencies;
    ALLOW(instance, FMU_CALL_DEPENDENCIES);
    return to_fmi(fmu_refuse(SELF(instance), "dependencies per element are not provided: see ModelStructure"));
}

/* ------------------------------------------------------------------------------------ saved states -- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_save(SELF(instance), (fmu_snapshot **)state));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_restore(SELF(instance), state));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    fmu_drop((fmu_snapshot **)state);
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_serialized_size(SELF(instance), state, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_serialize(SELF(instance), state, bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    ALLOW(instance, FMU_CALL_STATE_OF_FMU);
    return to_fmi(fmu_deserialize(SELF(instance), bytes, size, (fmu_snapshot **)state));
}

/* ------------------------------------------------------------------------------------- derivatives -- */

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                        const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) {
    ALLOW(instance, FMU_CALL_PARTIAL_DERIVATIVE);
    return to_fmi(fmu_directional(SELF(instance), list(unknowns, nUnknowns), list(knowns, nKnowns), seed, nSeed,
                                  sensitivity, nSensitivity));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
                                    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[],
                                    size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) {
    ALLOW(instance, FMU_CALL_PARTIAL_DERIVATIVE);
    return to_fmi(fmu_adjoint(SELF(instance), list(unknowns, nUnknowns), list(knowns, nKnowns), seed, nSeed,
                              sensitivity, nSensitivity));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                    size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t nValues) {
    ALLOW(instance, FMU_CALL_OUTPUT_DERIVATIVES);
    return to_fmi(
        fmu_output_derivatives(SELF(instance), list(valueReferences, nValueReferences), orders, values, nValues));
}

/* ------------------------------------------------------------------------------------------ events -- */

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime) {
    bool changed;
    ALLOW(instance, FMU_CALL_UPDATE_DISCRETE_STATES);
    const fmu_status status = fmu_update_discrete_states(SELF(instance), &changed);
    if (discreteStatesNeedUpdate != NULL)
        *discreteStatesNeedUpdate = FMU_MODEL_PORTS > 0 && fmu_model_needs_update(&SELF(instance)->model);
    if (terminateSimulation != NULL) *terminateSimulation = fmi3False;
    if (nominalsOfContinuousStatesChanged != NULL) *nominalsOfContinuousStatesChanged = fmi3False;
    if (valuesOfContinuousStatesChanged != NULL) *valuesOfContinuousStatesChanged = changed;
    if (nextEventTimeDefined != NULL) *nextEventTimeDefined = fmi3False;
    if (nextEventTime != NULL) *nextEventTime = 0.0;
    return to_fmi(status);
}

/* --------------------------------------------------------------------------------- Model Exchange -- */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_ENTER_CONTINUOUS_TIME);
    fmu_enter(SELF(instance), FMU_CONTINUOUS);
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation) {
    (void)noSetFMUStatePriorToCurrentPoint;
    ALLOW(instance, FMU_CALL_COMPLETED_STEP);
    if (enterEventMode != NULL) *enterEventMode = fmi3False;
    if (terminateSimulation != NULL) *terminateSimulation = fmi3False;
    return to_fmi(fmu_completed_step(SELF(instance)));
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
    ALLOW(instance, FMU_CALL_SET_TIME);
    return to_fmi(fmu_set_time(SELF(instance), time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 continuousStates[],
                                   size_t nContinuousStates) {
    ALLOW(instance, FMU_CALL_SET_STATES);
    return to_fmi(fmu_set_states(SELF(instance), continuousStates, nContinuousStates));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[],
                                             size_t nContinuousStates) {
    ALLOW(instance, FMU_CALL_GET_RATES);
    return to_fmi(fmu_get_rates(SELF(instance), derivatives, nContinuousStates));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators) {
    (void)eventIndicators;
    ALLOW(instance, FMU_CALL_GET_STATES);
    return to_fmi(fmu_refuse_kind(SELF(instance), "event indicator", nEventIndicators));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates) {
    ALLOW(instance, FMU_CALL_GET_STATES);
    return to_fmi(fmu_get_states(SELF(instance), continuousStates, nContinuousStates));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates) {
    ALLOW(instance, FMU_CALL_GET_NOMINALS);
    return to_fmi(fmu_get_nominals(SELF(instance), nominals, nContinuousStates));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *nEventIndicators) {
    ALLOW(instance, FMU_CALL_COUNT_STATES);
    if (nEventIndicators == NULL)
        return to_fmi(fmu_refuse(SELF(instance), "the pointer to the number is missing (NULL)"));
    *nEventIndicators = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *nContinuousStates) {
    ALLOW(instance, FMU_CALL_COUNT_STATES);
    if (nContinuousStates == NULL)
        return to_fmi(fmu_refuse(SELF(instance), "the pointer to the number is missing (NULL)"));
    *nContinuousStates = fmu_model_state_count(&SELF(instance)->model);
    return fmi3OK;
}

/* ---------------------------------------------------------------------------------- Co-Simulation -- */

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
    ALLOW(instance, FMU_CALL_ENTER_STEP);
    fmu_enter(SELF(instance), FMU_STEP);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime) {
    fmu_step_end end;
    (void)noSetFMUStatePriorToCurrentPoint;
    ALLOW(instance, FMU_CALL_DO_STEP);
    const fmu_status status = fmu_do_step(SELF(instance), currentCommunicationPoint, communicationStepSize, &end);
    if (eventHandlingNeeded != NULL)
        *eventHandlingNeeded = FMU_MODEL_PORTS > 0 && fmu_model_needs_event(&SELF(instance)->model);
    if (terminateSimulation != NULL) *terminateSimulation = fmi3False;
    if (earlyReturn != NULL) *earlyReturn = end.early;
    if (lastSuccessfulTime != NULL) *lastSuccessfulTime = end.time_s;
    return to_fmi(status);
}
