/* One FMU instance, the same for both FMI versions and both FMU models.
 *
 *     importer -> fmi2.c | fmi3.c  (translate types)
 *                   |
 *                   v
 *     instance.c, variables.c, co_simulation.c, model_exchange.c, …   (what both versions share)
 *                   |
 *                   v
 *     model_interface.h   (the FMU model: vehicle/ or controller/)
 *
 * The numbers of fmu_status are those of fmi2Status and fmi3Status. A refused call changes nothing and gives the reason
 * through the importer's logger. Memory is allocated only to make an instance and to save and serialize states.
 * Different instances may be used in different threads at the same time. */
#ifndef LACONIC_FMU_INSTANCE_H
#define LACONIC_FMU_INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "clock.h"
#include "lifecycle.h"
#include "model.h"

/* Start values and tolerances would be off by 1e-7 or 0. */
typedef char fmu_needs_compiling_without_fsingle_precision_constant[sizeof(1.0) == sizeof(double) ? 1 : -1];

typedef enum fmu_status { FMU_OK, FMU_WARNING, FMU_DISCARD, FMU_ERROR, FMU_FATAL } fmu_status;

typedef enum fmu_kind { FMU_MODEL_EXCHANGE, FMU_CO_SIMULATION } fmu_kind;

/* Log categories, as in the descriptions; a bit each. */
typedef enum fmu_category {
    FMU_LOG_WARNING = 1,
    FMU_LOG_DISCARD = 2,
    FMU_LOG_ERROR = 4,
    FMU_LOG_EVENTS = 8
} fmu_category;
#define FMU_LOG_ALL 15U

typedef struct fmu_instance fmu_instance;

/* False for NaN and for both infinities. */
static inline bool fmu_is_finite(double value) { return value - value == 0.0; }

/* Passes a finished line of the log to the importer; in fmi2.c and fmi3.c. */
typedef void (*fmu_deliver)(const fmu_instance *instance, fmu_status status, const char *category, const char *text);

/* Lets the importer get and set variables after each internal step; true: the step returns early. In fmi3.c. */
typedef bool (*fmu_between_steps)(fmu_instance *instance, bool finished);

/* The last valid list of value references and the offsets of its values: importers pass the same list at every step. */
#define FMU_LIST_LENGTH 64U
typedef struct fmu_list {
    size_t count, values; /* 0: none yet */
    uint32_t groups;      /* of all its variables */
    uint32_t reference[FMU_LIST_LENGTH];
    uint32_t offset[FMU_LIST_LENGTH]; /* of each value, in fmu_model */
} fmu_list;

struct fmu_instance {
    fmu_kind kind;
    int version; /* of FMI: 2 or 3 */
    fmu_mode mode;
    bool event_mode_used;
    bool early_return_allowed;
    bool scalar;             /* no structural parameter: the arrays' size is fixed          */
    uint32_t allowed;        /* bit per fmu_call: what may be called in this mode           */
    uint32_t settable;       /* bit per fmu_access: what may be set in this mode            */
    unsigned log_categories; /* bit per fmu_category                                        */
    fmu_deliver deliver;
    void *environment;
    void (*callback_storage[2])(void); /* for fmu_callbacks_2 or fmu_callbacks_3 */
    char *name;
    uint64_t token_hash;
    uint32_t warnings_given;         /* bit per warning that was logged in this run */
    uint32_t warnings_pending;       /* bit per warning of a step that may still be refused */
    fmu_between_steps between_steps; /* NULL: no intermediate updates */
    volatile bool running;           /* a communication step of several internal ones      */
    volatile bool cancelled;         /* another thread wants it to end: models look at it now and then */
    fmu_clock clock;
    fmu_model model;
    fmu_model initial;      /* right after instantiation, for reset                        */
    fmu_list read, written; /* the last valid lists of reals (cached_reals.c)                      */
};

typedef struct fmu_request {
    const char *instance_name;
    const char *token;     /* fmuGUID, instantiationToken                                   */
    const char *resources; /* path of the resources folder, or a file: URI; may be NULL     */
    fmu_kind kind;
    int version;
    bool logging_on;
    fmu_deliver deliver;
    void *environment;
    const void *callbacks; /* callbacks for fmu_instance.callback_storage, which holds them */
    size_t callbacks_size;
} fmu_request;

/* NULL when name or token is missing, the token is not this FMU's, the start values cannot be read, or memory is
 * short; the log gives the reason. */
fmu_instance *fmu_create(const fmu_request *request);
void fmu_free(fmu_instance *instance);

/* Logs that the call is not allowed in the instance's present mode (lifecycle.h). */
void fmu_refuse_call(const fmu_instance *instance, fmu_call call);

/* A macro, since compilers that look for size would make a function of it that importers' every call pays for. */
#define FMU_MAY_CALL(instance, call) \
    (((instance)->allowed >> (call) & 1U) != 0 || (fmu_refuse_call((instance), (call)), false))

void fmu_enter(fmu_instance *instance, fmu_mode mode);

/* Puts the start values that came with the FMU into the model (start_file.c); false: they cannot be read. */
bool fmu_load_start_values(fmu_instance *instance, const char *token, const char *resources);

fmu_status fmu_setup(fmu_instance *instance, double start_s, bool stop_defined, double stop_s);
fmu_status fmu_exit_initialization(fmu_instance *instance);
fmu_status fmu_update_discrete_states(fmu_instance *instance, bool *states_changed);
fmu_status fmu_reset(fmu_instance *instance);
/* Starts or changes the model if parameters were set since the last call; precedes everything that is computed. */
fmu_status fmu_apply_parameters(fmu_instance *instance);

/* ---------------------------------------------------------------------------------- messages -- */

/* Of a line of the log, with the 0 behind it; longer ones are cut. */
#define FMU_LINE_LENGTH 512U

#if defined(__GNUC__)
#define FMU_LIKE_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define FMU_LIKE_PRINTF(text, first)
#endif

fmu_status fmu_log(const fmu_instance *instance, fmu_status status, fmu_category category, const char *format, ...)
    FMU_LIKE_PRINTF(4, 5);
fmu_status fmu_refuse(const fmu_instance *instance, const char *format, ...) FMU_LIKE_PRINTF(2, 3);
/* For the %.*g of one line: 15 digits, or as many more as show which of three numbers differ. */
int fmu_digits(double a, double b, double c);
/* Of a communication step: it begins at another time than the model's; it ends beyond the stop time. */
fmu_status fmu_refuse_start(const fmu_instance *instance, double at_s, double now_s);
fmu_status fmu_refuse_end(const fmu_instance *instance, double from_s, double to_s);
fmu_status fmu_set_logging(fmu_instance *instance, bool on, size_t count, const char *const categories[]);

/* --------------------------------------------------------------------------------- variables -- */

typedef enum fmu_type {
    FMU_REAL,
    FMU_INT32,
    FMU_UINT64,
    FMU_ENUMERATION,
    FMU_BOOLEAN,
    FMU_INTEGER, /* in calls only: FMI 2's Integer, any of the three integer types above */
    FMU_BINARY,  /* of bus terminals (network/fmi3_clocks.c) */
    FMU_CLOCK
} fmu_type;

typedef enum fmu_access { /* who sets it, and when (variables.c) */
                          FMU_INDEPENDENT,
                          FMU_STRUCTURAL,
                          FMU_FIXED,
                          FMU_TUNABLE,
                          FMU_INPUT,
                          FMU_STATE,          /* an output that is a continuous state */
                          FMU_OPTIONAL_STATE, /* one where FMU_MODEL_HAS_OPTIONAL_STATES, else an output */
                          FMU_OUTPUT,
                          FMU_LOCAL
} fmu_access;

/* One row of the table that is generated from the description; the row's number is the value reference. */
typedef struct fmu_variable {
    uint32_t offset; /* in fmu_model                                          */
    uint16_t name;   /* in fmu_variable_names: a pointer would cost every FMU a relocation       */
    uint16_t stride; /* from one element to the next                          */
    uint16_t size;   /* elements; 0: FMU_MODEL_ARRAY_SIZE of them, FMU_OTHER_SIZE: see below */
    uint8_t type, access;
    bool intermediate;  /* may be got or set between internal steps (FMI 3) */
    double least, most; /* what it may be set to                              */
    uint32_t group;     /* to compute before it is read, see model.h */
    uint32_t tangent;   /* in fmu_tangent; UINT32_MAX: not differentiated       */
} fmu_variable;

/* Models with arrays of two lengths have a macro FMU_MODEL_OTHER_ARRAY_SIZE, which gives that of the others. */
#define FMU_OTHER_SIZE 65535U

/* Its number of elements in this instance. */
static inline uint32_t fmu_size_of(const fmu_model *model, const fmu_variable *variable) {
#ifdef FMU_MODEL_OTHER_ARRAY_SIZE
    if (variable->size == FMU_OTHER_SIZE) return FMU_MODEL_OTHER_ARRAY_SIZE(model);
#endif
    return variable->size != 0 ? variable->size : FMU_MODEL_ARRAY_SIZE(model);
}

extern const fmu_variable fmu_variables[];
extern const char fmu_variable_names[];
extern const uint32_t fmu_variable_count;

static inline const char *fmu_name_of(const fmu_variable *variable) { return &fmu_variable_names[variable->name]; }

/* Start values of the description this was built with. */
typedef struct fmu_start_value {
    uint32_t reference;
    double value;
} fmu_start_value;

extern const fmu_start_value fmu_built_in_starts[];
extern const size_t fmu_built_in_start_count;
extern const char *const fmu_token_2, *const fmu_token_3; /* of the descriptions this was built with */

/* From here on references are no variables: start values of FMUs with bus terminals. */
#define FMU_PRIVATE_START 0x80000000U

/* Reference v is all of row v, reference 1024·v + i its element i, from 1. The references of an array's elements are
 * consecutive, since some importers join them to an array again. Row 0, the time, has no elements. */
#define FMU_ELEMENT_SHIFT 10
static inline uint32_t fmu_row(uint32_t reference) {
    return reference >> FMU_ELEMENT_SHIFT != 0 ? reference >> FMU_ELEMENT_SHIFT : reference;
}
static inline uint32_t fmu_element(uint32_t reference) { /* 0: the whole */
    return reference >> FMU_ELEMENT_SHIFT != 0 ? reference & ((1U << FMU_ELEMENT_SHIFT) - 1U) : 0;
}

typedef struct fmu_slot {
    const fmu_variable *variable;
    uint32_t first, count;
} fmu_slot;

/* Its access in this instance: never FMU_OPTIONAL_STATE. */
static inline fmu_access fmu_access_of(const fmu_instance *instance, const fmu_variable *variable) {
    if (variable->access != FMU_OPTIONAL_STATE) return (fmu_access)variable->access;
    return FMU_MODEL_HAS_OPTIONAL_STATES(&instance->model) ? FMU_STATE : FMU_OUTPUT;
}

bool fmu_find(const fmu_instance *instance, uint32_t reference, fmu_slot *slot);

typedef struct fmu_references {
    const uint32_t *reference;
    size_t count;
} fmu_references;

/* Reads or writes value k of a list whose C type only fmi2.c or fmi3.c knows. Numbers pass as double, which holds every
 * value in the range of a variable exactly. */
typedef double (*fmu_read)(const void *values, size_t k);
typedef void (*fmu_write)(void *values, size_t k, double number);

/* Every variable must have that type. All values are checked first: a refused call writes and sets none. */
fmu_status fmu_get(fmu_instance *instance, fmu_type type, fmu_references list, void *values, size_t value_count,
                   fmu_write write);
fmu_status fmu_set(fmu_instance *instance, fmu_type type, fmu_references list, const void *values, size_t value_count,
                   fmu_read read);
/* The same for reals, with a fast path (cached_reals.c). */
fmu_status fmu_get_reals(fmu_instance *instance, const uint32_t *references, size_t count, double *values,
                         size_t value_count);
fmu_status fmu_set_reals(fmu_instance *instance, const uint32_t *references, size_t count, const double *values,
                         size_t value_count);
/* Refuses unless `asked` is 0: the FMU has no variables of that kind. */
fmu_status fmu_refuse_kind(const fmu_instance *instance, const char *kind, size_t asked);
/* Refuses unless every one of them may be got or set between internal steps. */
fmu_status fmu_check_intermediate(const fmu_instance *instance, const uint32_t *references, size_t count);
/* Sets the start value of one element, in any mode; false: no such variable, or a value outside its range. */
bool fmu_set_start_value(fmu_instance *instance, uint32_t reference, double value);

/* ------------------------------------------------------------------------------------- steps -- */

/* Where a communication step ended, and whether the importer ended it early. */
typedef struct fmu_step_end {
    double time_s;
    bool early;
} fmu_step_end;

fmu_status fmu_do_step(fmu_instance *instance, double at_s, double step_s, fmu_step_end *end);
/* Makes the communication step that runs in another thread end soon; DoStep takes it back and discards it. */
fmu_status fmu_cancel_step(fmu_instance *instance);

/* ------------------------------------------------------------- continuous states (Model Exchange) -- */

/* Largest magnitude of a continuous state: doubles beyond it are at least 128 apart, in rad many turns. */
#define FMU_LARGEST_STATE 1e18

fmu_status fmu_set_time(fmu_instance *instance, double time_s);
fmu_status fmu_completed_step(fmu_instance *instance);
fmu_status fmu_get_states(fmu_instance *instance, double *values, size_t count);
fmu_status fmu_set_states(fmu_instance *instance, const double *values, size_t count);
fmu_status fmu_get_rates(fmu_instance *instance, double *values, size_t count);
fmu_status fmu_get_nominals(fmu_instance *instance, double *values, size_t count);

/* ------------------------------------------------------------------------ partial derivatives -- */

fmu_status fmu_directional(fmu_instance *instance, fmu_references unknowns, fmu_references knowns, const double *seed,
                           size_t seed_count, double *sensitivity, size_t sensitivity_count);
fmu_status fmu_adjoint(fmu_instance *instance, fmu_references unknowns, fmu_references knowns, const double *seed,
                       size_t seed_count, double *sensitivity, size_t sensitivity_count);
fmu_status fmu_output_derivatives(fmu_instance *instance, fmu_references outputs, const int32_t *orders, double *values,
                                  size_t value_count);
fmu_status fmu_set_input_derivatives(fmu_instance *instance, fmu_references inputs, const int32_t *orders,
                                     const double *values);

/* ------------------------------------------------------------------------------- saved states -- */

typedef struct fmu_snapshot fmu_snapshot;

uint64_t fmu_token_hash(const char *token);

fmu_status fmu_save(fmu_instance *instance,
                    fmu_snapshot **snapshot); /* fills *snapshot, or makes one where it is NULL */
fmu_status fmu_restore(fmu_instance *instance, const fmu_snapshot *snapshot);
void fmu_drop(fmu_snapshot **snapshot);
fmu_status fmu_serialized_size(fmu_instance *instance, const fmu_snapshot *snapshot, size_t *size);
fmu_status fmu_serialize(fmu_instance *instance, const fmu_snapshot *snapshot, uint8_t *bytes, size_t size);
fmu_status fmu_deserialize(fmu_instance *instance, const uint8_t *bytes, size_t size, fmu_snapshot **snapshot);

#endif
