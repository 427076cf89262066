/* What the tests by FMI 2 share: one instance of the vehicle, and its variables by name. */
#ifndef FMI2_BENCH_H
#define FMI2_BENCH_H

#include "fmi_bench.h"
#include "model_interface.h"

static fmi2Component c;

static inline fmu_instance *instance(void) { return c; }

static inline void make(fmi2Type kind) {
    fmi2FreeInstance(c);
    c = make_2(kind, fmu_token_2);
    TEST_ASSERT_NOT_NULL(c);
}

/* For setUp and tearDown. */
static inline void begin_test(fmi2Type kind) {
    log_clear();
    c = NULL;
    make(kind);
}

static inline void end_test(void) {
    fmi2FreeInstance(c);
    c = NULL;
}

static inline fmi2Status try_set(const char *name, uint32_t element, double value) {
    const fmi2ValueReference reference = ref(name, element);
    return fmi2SetReal(c, &reference, 1, &value);
}

static inline void set(const char *name, uint32_t element, double value) { OK(try_set(name, element, value)); }

static inline void set_integer(const char *name, uint32_t element, int value) {
    const fmi2ValueReference reference = ref(name, element);
    OK(fmi2SetInteger(c, &reference, 1, &value));
}

static inline void set_flag(const char *name, uint32_t element) {
    const fmi2ValueReference reference = ref(name, element);
    const fmi2Boolean yes = fmi2True;
    OK(fmi2SetBoolean(c, &reference, 1, &yes));
}

static inline fmi2Status try_get(const char *name, uint32_t element, double *value) {
    const fmi2ValueReference reference = ref(name, element);
    return fmi2GetReal(c, &reference, 1, value);
}

static inline double get(const char *name, uint32_t element) {
    double value = NOT_A_NUMBER;
    OK(try_get(name, element, &value));
    return value;
}

/* A Model Exchange on ground with friction, whose wheels have angles and speeds of their own. */
static inline void with_wheel_states(void) {
    make(fmi2ModelExchange);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    fmu_model_made(&instance()->model);
}

static inline void initialise(void) {
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
}

static inline fmi2Status initialise_refused(void) {
    OK(fmi2EnterInitializationMode(c));
    return fmi2ExitInitializationMode(c);
}

static inline fmi2Status step(double at_s, double step_s) { return fmi2DoStep(c, at_s, step_s, fmi2True); }

#define ASSERT_DISCARDED(call, part) \
    do { \
        log_clear(); \
        TEST_ASSERT_EQUAL_INT(2, (int)(call)); \
        ASSERT_LOGGED(part); \
    } while (0)

#endif
