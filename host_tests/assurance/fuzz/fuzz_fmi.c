/* One input of bytes becomes a sequence of FMI calls, of either version, with valid and invalid arguments: no sanitizer
 * has anything to report. */
#include <float.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include "fuzz_bytes.h"
#include "long_steps.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
const char *__asan_default_options(void);

/* Instances are taken and given back in each input, and memory is the sanitizer's most expensive part. What was freed
 * is held back until some dozen instances have been; then their memory is used again. */
const char *__asan_default_options(void) {
    return "max_malloc_fill_size=0:malloc_context_size=4:quarantine_size_mb=2:allocator_release_to_os_interval_ms=-1";
}

enum { LIVE = 2, STATES = 4, NUMBERS = 3000 };

typedef struct live {
    int version; /* 0: none */
    void *instance;
    void *state[STATES];
    double time;
} live;

static double numbers[NUMBERS];
static double results[NUMBERS];
static fmi3Float32 singles[NUMBERS];
static int wholes[NUMBERS];
static int32_t wholes_32[NUMBERS];
static int64_t wholes_64[NUMBERS];
static uint64_t counts[NUMBERS];
static bool flags[NUMBERS];
static fmi3ValueReference references[NUMBERS];

/* Mostly variables that exist, elements that exist, lists of a sensible length. */
static size_t next_list(source *s) {
    const unsigned choice = next(s);
    size_t count = choice % 5;
    if (choice > 252) count = next_word(s) % NUMBERS;
    for (size_t k = 0; k < count; k++) {
        const unsigned kind = k < 64 ? next(s) : (unsigned)(k % 251);
        references[k] = k >= 64      ? (fmi3ValueReference)(k % fmu_variable_count)
                        : kind < 200 ? next(s) % fmu_variable_count
                                     : next_word(s);
        if (k < 64 && kind % 2) references[k] = references[k] << 10 | (next(s) % 18);
    }
    return count;
}

/* How many values are said to be there. */
static size_t next_total(source *s, size_t count) {
    const unsigned choice = next(s);
    size_t total = count;
    if (choice < 100) total = count * 4;
    if (choice > 250) total = next_word(s) % NUMBERS;
    return total > NUMBERS ? NUMBERS : total;
}

static void fill_values(source *s, size_t total) {
    for (size_t k = 0; k < total && k < 200; k++) {
        numbers[k] = next_number(s);
        wholes[k] = (int)(next(s) % 7) - 1;
        wholes_32[k] = k % 13 == 12 ? (int32_t)next_word(s) : wholes[k];
        wholes_64[k] = k % 13 == 12 ? (int64_t)next_word(s) << 20 : wholes[k];
        counts[k] = (uint64_t)(wholes[k] + 1) + (k % 13 == 12 ? 1ULL << 40 : 0);
        flags[k] = wholes[k] % 2 != 0;
    }
}

static void log_2(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String text,
                  ...) {
    volatile size_t length = strlen(name) + strlen(category) + strlen(text);
    (void)e;
    (void)status;
    (void)length;
}

static void log_3(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text) {
    volatile size_t length = strlen(category) + strlen(text);
    (void)e;
    (void)status;
    (void)length;
}

static void update_3(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set, fmi3Boolean get,
                     fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    (void)e;
    (void)set;
    (void)get;
    (void)finished;
    (void)can_return;
    *early = time > 0.3;
    *early_time = time;
}

static const char *const token_names[] = {NULL, "", "{wrong %s %n}"};

/* Makes it one of a scene with ground friction and a drive with limits; prepared once for all. */
static void give_friction(fmu_instance *instance) {
    static const fmu_start_value given[] = {{11, 0.0}, {63, 0.6}, {64, 0.2}, {65, 0.01}, {68, 12.0},
                                            {69, 0.1}, {70, 5.0}, {71, 0.5}, {72, 0.01}};
    static bool is_made;
    static fmu_model made;
    if (!is_made) {
        for (size_t k = 0; k < sizeof given / sizeof given[0]; k++)
            fmu_set_start_value(instance, given[k].reference, given[k].value);
        fmu_model_made(&instance->model);
        made = instance->model;
        is_made = true;
    }
    instance->initial = instance->model = made;
}

static void create(source *s, live *l) {
    static const fmi2CallbackFunctions with_log = {log_2, calloc, free, NULL, NULL};
    static const fmi2CallbackFunctions without_log = {NULL, NULL, NULL, NULL, NULL};
    const unsigned choice = next(s);
    const bool good = choice % 8 != 0;
    const char *resources = choice % 16 < 13 ? NULL : choice % 16 == 13 ? "file:///nowhere%20at%zz all" : "/nowhere/";
    const char *name = choice == 255 ? NULL : "fuzz%s";
    memset(l, 0, sizeof *l);
    if (choice % 2) {
        const char *token = good ? fmu_token_2 : token_names[choice % 3];
        l->instance = fmi2Instantiate(name, choice % 4 < 2 ? fmi2CoSimulation : fmi2ModelExchange, token, resources,
                                      choice % 5 ? &with_log : &without_log, fmi2False, choice % 7 == 0);
        l->version = l->instance != NULL ? 2 : 0;
    } else {
        const char *token = good ? fmu_token_3 : token_names[choice % 3];
        const fmi3LogMessageCallback log = choice % 5 ? log_3 : NULL;
        l->instance = choice % 4 < 2
                          ? fmi3InstantiateCoSimulation(name, token, resources, false, choice % 7 == 0, choice % 9 < 4,
                                                        choice % 11 < 5, references, 3, NULL, log,
                                                        choice % 13 < 4 ? update_3 : NULL)
                          : fmi3InstantiateModelExchange(name, token, resources, false, choice % 7 == 0, NULL, log);
        l->version = l->instance != NULL ? 3 : 0;
    }
    if (l->instance != NULL && choice % 17 < 6) give_friction(l->instance);
}

/* Brings a new instance into step mode or continuous-time mode, so that many inputs reach the calls allowed there. */
static void begin(live *l, unsigned choice) {
    fmi3Boolean b[5];
    fmi3Float64 time;
    fmi2EventInfo info;
    const fmi2ValueReference step_2 = 30;
    const fmi3ValueReference step_3 = 30;
    const double step_s = 0.001;
    if (l->version == 2) {
        if (choice % 3 == 0) fmi2SetReal(l->instance, &step_2, 1, &step_s);
        fmi2EnterInitializationMode(l->instance);
        fmi2ExitInitializationMode(l->instance);
        if (choice % 2 && fmi2NewDiscreteStates(l->instance, &info) == fmi2OK) fmi2EnterContinuousTimeMode(l->instance);
    } else if (l->version == 3) {
        if (choice % 3 == 0) fmi3SetFloat64(l->instance, &step_3, 1, &step_s, 1);
        fmi3EnterInitializationMode(l->instance, false, 0.0, 0.0, false, 0.0);
        fmi3ExitInitializationMode(l->instance);
        if (choice % 2 && fmi3UpdateDiscreteStates(l->instance, &b[0], &b[1], &b[2], &b[3], &b[4], &time) == fmi3OK &&
            fmi3EnterStepMode(l->instance) != fmi3OK)
            fmi3EnterContinuousTimeMode(l->instance);
    }
}

static void destroy(live *l) {
    for (size_t k = 0; k < STATES; k++) {
        if (l->version == 2) fmi2FreeFMUstate(l->instance, &l->state[k]);
        if (l->version == 3) fmi3FreeFMUState(l->instance, &l->state[k]);
    }
    if (l->version == 2) fmi2FreeInstance(l->instance);
    if (l->version == 3) fmi3FreeInstance(l->instance);
    memset(l, 0, sizeof *l);
}

static double next_step(source *s) {
    static const double steps[] = {0.01, 0.001, 0.1, 0.02, 1.0 / 3.0, 1.0};
    const unsigned choice = next(s);
    const double step = choice < 220 ? steps[choice % 6] : next_number(s);
    return step > 1.0 && step <= DBL_MAX ? 1.0 : step; /* a step of 1e9 s is allowed, but takes too long */
}

/* Serializes a state, flips some bits or cuts the bytes, and deserializes them. */
static void serialize(source *s, live *l) {
    const unsigned choice = next(s);
    void *state = l->state[choice % STATES];
    size_t size = 0;
    uint8_t *bytes;
    if (state == NULL) return;
    if (l->version == 2) fmi2SerializedFMUstateSize(l->instance, state, &size);
    if (l->version == 3) fmi3SerializedFMUStateSize(l->instance, state, &size);
    if (size == 0) return;
    bytes = malloc(size);
    if (l->version == 2)
        fmi2SerializeFMUstate(l->instance, state, (fmi2Byte *)bytes, size);
    else
        fmi3SerializeFMUState(l->instance, state, bytes, size);
    if (choice % 3 == 0) bytes[next_word(s) % size] ^= (uint8_t)next(s);
    if (choice % 7 == 0) size = next_word(s) % size;
    if (choice % 5 == 0 && size > 64) { /* wrong content under a right checksum */
        const uint64_t at = 8 * (next_word(s) % (size / 8));
        bytes[at] = (uint8_t)next(s);
        bytes[at + 7] = (uint8_t)next(s);
        uint64_t sum = fmu_checksum(bytes, size - 8);
        memcpy(bytes + size - 8, &sum, 8);
    }
    if (l->version == 2)
        fmi2DeSerializeFMUstate(l->instance, (const fmi2Byte *)bytes, size, &l->state[(choice / 4) % STATES]);
    else
        fmi3DeserializeFMUState(l->instance, bytes, size, &l->state[(choice / 4) % STATES]);
    free(bytes);
}

/* Only what a call takes is read, so that an input of some length has many calls. */
static bool takes_references_2(unsigned choice) {
    return (choice >= 7 && choice <= 14) || (choice >= 19 && choice <= 21) || choice == 35 || choice == 38;
}

static bool takes_values_2(unsigned choice) {
    return choice == 9 || choice == 10 || choice == 12 || choice == 14 || (choice >= 19 && choice <= 21) ||
           choice == 30 || choice == 31;
}

/* How many an importer believes there to be: mostly as many as there are. */
static size_t next_states(source *s, bool is_asked) {
    if (!is_asked || next(s) % 8) return 10;
    return next(s) % 40;
}

static void call_2(source *s, live *l) {
    const unsigned choice = next(s) % 40;
    const size_t count = takes_references_2(choice) ? next_list(s) : 0;
    fmi2Component c = l->instance;
    fmi2EventInfo info;
    fmi2Real real;
    fmi2Status status;
    fmi2Boolean flag, other;
    const bool sets_states = choice == 30 || choice == 31;
    const size_t states = next_states(s, choice >= 30 && choice <= 34);
    const fmi2Real *null_or = numbers;
    if (takes_values_2(choice)) {
        null_or = next(s) == 77 ? NULL : numbers;
        fill_values(s, sets_states ? states : count);
    }
    switch (choice) {
    case 0: fmi2SetupExperiment(c, fmi2False, 0.0, next_number(s), next(s) % 5 == 0, next_number(s)); break;
    case 1:
    case 2: fmi2EnterInitializationMode(c); break;
    case 3:
    case 4: fmi2ExitInitializationMode(c); break;
    case 5:
        if (next(s) % 8 == 0) fmi2Terminate(c);
        break;
    case 6:
        if (next(s) % 4 == 0) fmi2Reset(c);
        l->time = 0.0;
        break;
    case 7:
    case 8: fmi2GetReal(c, (const fmi2ValueReference *)references, count, results); break;
    case 9:
    case 10: fmi2SetReal(c, (const fmi2ValueReference *)references, count, null_or); break;
    case 11: fmi2GetInteger(c, (const fmi2ValueReference *)references, count, wholes); break;
    case 12: fmi2SetInteger(c, (const fmi2ValueReference *)references, count, wholes); break;
    case 13: fmi2GetBoolean(c, (const fmi2ValueReference *)references, count, wholes); break;
    case 14: fmi2SetBoolean(c, (const fmi2ValueReference *)references, count, wholes); break;
    case 15: fmi2GetFMUstate(c, &l->state[next(s) % STATES]); break;
    case 16: fmi2SetFMUstate(c, l->state[next(s) % STATES]); break;
    case 17: fmi2FreeFMUstate(c, &l->state[next(s) % STATES]); break;
    case 18: serialize(s, l); break;
    case 19:
        fmi2GetDirectionalDerivative(c, (const fmi2ValueReference *)references, count / 2,
                                     (const fmi2ValueReference *)references + count / 2, count - count / 2, null_or,
                                     results);
        break;
    case 20: fmi2SetRealInputDerivatives(c, (const fmi2ValueReference *)references, count, wholes, numbers); break;
    case 21: fmi2GetRealOutputDerivatives(c, (const fmi2ValueReference *)references, count, wholes, results); break;
    case 22:
    case 23:
    case 24: {
        const double step = next_step(s);
        if (takes_too_long(l->instance, step)) break;
        if (fmi2DoStep(c, next(s) % 16 ? l->time : next_number(s), step, fmi2True) == fmi2OK) l->time += step;
        break;
    }
    case 25: fmi2EnterEventMode(c); break;
    case 26: fmi2NewDiscreteStates(c, &info); break;
    case 27: fmi2EnterContinuousTimeMode(c); break;
    case 28: fmi2CompletedIntegratorStep(c, fmi2True, &flag, &other); break;
    case 29: fmi2SetTime(c, next_number(s)); break;
    case 30:
    case 31: fmi2SetContinuousStates(c, null_or, states); break;
    case 32: fmi2GetContinuousStates(c, results, states); break;
    case 33: fmi2GetDerivatives(c, results, states); break;
    case 34: fmi2GetNominalsOfContinuousStates(c, results, states); break;
    case 35: fmi2GetEventIndicators(c, results, count); break;
    case 36:
        fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &real);
        fmi2GetBooleanStatus(c, fmi2Terminated, &flag);
        break;
    case 37:
        fmi2GetStatus(c, fmi2DoStepStatus, &status);
        fmi2CancelStep(c);
        break;
    case 38: fmi2GetString(c, (const fmi2ValueReference *)references, count, NULL); break;
    default: fmi2SetDebugLogging(c, next(s) % 2, 0, NULL);
    }
}

static bool takes_references_3(unsigned choice) {
    return (choice >= 9 && choice <= 20) || (choice >= 25 && choice <= 27) || (choice >= 42 && choice <= 45);
}

static bool takes_values_3(unsigned choice) {
    const bool sets = choice == 11 || choice == 12 || (choice >= 14 && choice <= 20 && choice % 2 == 0);
    return sets || (choice >= 25 && choice <= 27) || choice == 36 || choice == 37;
}

static void call_3(source *s, live *l) {
    const unsigned choice = next(s) % 48;
    const size_t count = takes_references_3(choice) ? next_list(s) : 0;
    const size_t states = next_states(s, (choice >= 36 && choice <= 40));
    const bool sets_states = choice == 36 || choice == 37;
    const bool has_values = takes_values_3(choice);
    const fmi3Float64 *null_or = has_values && next(s) == 77 ? NULL : numbers;
    const size_t total = takes_references_3(choice) ? next_total(s, count) : 0;
    if (has_values) fill_values(s, sets_states ? states : total);
    fmi3Instance c = l->instance;
    fmi3Boolean b[6];
    fmi3Float64 time;
    size_t size;
    switch (choice) {
    case 0: fmi3EnterConfigurationMode(c); break;
    case 1: fmi3ExitConfigurationMode(c); break;
    case 2:
    case 3:
        fmi3EnterInitializationMode(c, false, 0.0, next(s) % 4 ? 0.0 : next_number(s), next(s) % 5 == 0,
                                    next_number(s));
        break;
    case 4:
    case 5: fmi3ExitInitializationMode(c); break;
    case 6: fmi3EnterEventMode(c); break;
    case 7:
        if (next(s) % 8 == 0) fmi3Terminate(c);
        break;
    case 8:
        if (next(s) % 4 == 0) fmi3Reset(c);
        l->time = 0.0;
        break;
    case 9:
    case 10: fmi3GetFloat64(c, references, count, results, total); break;
    case 11:
    case 12: fmi3SetFloat64(c, references, count, null_or, total); break;
    case 13: fmi3GetInt32(c, references, count, wholes_32, total); break;
    case 14: fmi3SetInt32(c, references, count, wholes_32, total); break;
    case 15: fmi3GetInt64(c, references, count, wholes_64, total); break;
    case 16: fmi3SetInt64(c, references, count, wholes_64, total); break;
    case 17: fmi3GetUInt64(c, references, count, counts, total); break;
    case 18: fmi3SetUInt64(c, references, count, counts, total); break;
    case 19: fmi3GetBoolean(c, references, count, flags, total); break;
    case 20: fmi3SetBoolean(c, references, count, flags, total); break;
    case 21: fmi3GetFMUState(c, &l->state[next(s) % STATES]); break;
    case 22: fmi3SetFMUState(c, l->state[next(s) % STATES]); break;
    case 23: fmi3FreeFMUState(c, &l->state[next(s) % STATES]); break;
    case 24: serialize(s, l); break;
    case 25:
        fmi3GetDirectionalDerivative(c, references, count / 2, references + count / 2, count - count / 2, null_or,
                                     next(s) % 40, results, next(s) % 40);
        break;
    case 26:
        fmi3GetAdjointDerivative(c, references, count / 2, references + count / 2, count - count / 2, null_or,
                                 next(s) % 40, results, next(s) % 40);
        break;
    case 27: fmi3GetOutputDerivatives(c, references, count, wholes_32, results, total); break;
    case 28:
    case 29:
    case 30: {
        const double step = next_step(s);
        if (takes_too_long(l->instance, step)) break;
        if (fmi3DoStep(c, next(s) % 16 ? l->time : next_number(s), step, true, &b[0], &b[1], &b[2], &time) == fmi3OK)
            l->time = time;
        break;
    }
    case 31: fmi3UpdateDiscreteStates(c, &b[0], &b[1], &b[2], &b[3], &b[4], &time); break;
    case 32: fmi3EnterContinuousTimeMode(c); break;
    case 33: fmi3EnterStepMode(c); break;
    case 34: fmi3CompletedIntegratorStep(c, true, &b[0], NULL); break;
    case 35: fmi3SetTime(c, next_number(s)); break;
    case 36:
    case 37: fmi3SetContinuousStates(c, null_or, states); break;
    case 38: fmi3GetContinuousStates(c, results, states); break;
    case 39: fmi3GetContinuousStateDerivatives(c, results, states); break;
    case 40: fmi3GetNominalsOfContinuousStates(c, results, states); break;
    case 41: fmi3GetNumberOfContinuousStates(c, next(s) % 9 ? &size : NULL); break;
    case 42: fmi3GetNumberOfVariableDependencies(c, references[0], &size); break;
    case 43: fmi3GetFloat32(c, references, count, singles, total); break;
    case 44: fmi3GetClock(c, references, count, flags); break;
    case 45: fmi3GetEventIndicators(c, results, count); break;
    case 46: fmi3EvaluateDiscreteStates(c); break;
    default: fmi3SetDebugLogging(c, next(s) % 2, 0, NULL);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    source s = {bytes, size, 0};
    live all[LIVE];
    memset(all, 0, sizeof all);
    while (s.at < s.size) {
        live *l = &all[next(&s) % LIVE];
        if (l->version == 0) {
            create(&s, l);
            if (next(&s) % 4) begin(l, next(&s));
        } else if (next(&s) == 1)
            destroy(l);
        else if (l->version == 2)
            call_2(&s, l);
        else
            call_3(&s, l);
    }
    for (size_t k = 0; k < LIVE; k++) destroy(&all[k]);
    return 0;
}
