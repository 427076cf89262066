/* What the tests of FMUs with bus terminals share: an instance in event mode, its clocks and its bytes. */
#ifndef NETWORK_BENCH_H
#define NETWORK_BENCH_H

#include "ls_bus.h"
#include "shared_bench.h"

static fmi3Instance c;

static inline fmu_instance *instance(void) { return c; }

static inline fmi3ValueReference of_terminal(const char *terminal, const char *member) {
    char name[64];
    snprintf(name, sizeof name, "%s.%s", terminal, member);
    return ref(name, 0);
}

static inline void make(void) {
    fmi3FreeInstance(c);
    c = make_3(true);
    TEST_ASSERT_NOT_NULL(c);
}

/* What a test is about to send to a terminal. */
static ls_bus_buffer out;

static inline void begin_test(void) {
    log_clear();
    c = NULL;
    out.size = 0;
    make();
}

static inline void end_test(void) {
    fmi3FreeInstance(c);
    c = NULL;
}

static inline void set_real(const char *name, uint32_t element, double value) {
    const fmi3ValueReference reference = ref(name, element);
    OK(fmi3SetFloat64(c, &reference, 1, &value, 1));
}

static inline void set_integer(const char *name, int32_t value) {
    const fmi3ValueReference reference = ref(name, 0);
    OK(fmi3SetInt32(c, &reference, 1, &value, 1));
}

static inline void set_flag(const char *name) {
    const fmi3ValueReference reference = ref(name, 0);
    const bool yes = true;
    OK(fmi3SetBoolean(c, &reference, 1, &yes, 1));
}

static inline double get_real(const char *name, uint32_t element) {
    const fmi3ValueReference reference = ref(name, element);
    double value = NOT_A_NUMBER;
    OK(fmi3GetFloat64(c, &reference, 1, &value, 1));
    return value;
}

static inline int32_t get_integer(const char *name) {
    const fmi3ValueReference reference = ref(name, 0);
    int32_t value = -7;
    OK(fmi3GetInt32(c, &reference, 1, &value, 1));
    return value;
}

/* Ends initialization; from then on the instance is in event mode. */
static inline fmi3Status begin_from(double start_s) {
    OK(fmi3EnterInitializationMode(c, false, 0, start_s, false, 0));
    return fmi3ExitInitializationMode(c);
}

static inline bool update(void) {
    bool again = false;
    OK(fmi3UpdateDiscreteStates(c, &again, NULL, NULL, NULL, NULL, NULL));
    return again;
}

/* Bytes come to a terminal, in an event iteration. */
static inline void give(const char *terminal, const ls_bus_buffer *bytes) {
    const fmi3ValueReference data = of_terminal(terminal, "Rx_Data"), clock = of_terminal(terminal, "Rx_Clock");
    const fmi3Binary value = bytes->bytes;
    const bool active = true;
    OK(fmi3SetBinary(c, &data, 1, &bytes->size, &value, 1));
    OK(fmi3SetClock(c, &clock, 1, &active));
}

/* What a terminal sends when its clock is set, as a countdown clock is; then that is gone. */
static ls_bus_buffer got;
static inline void take(const char *terminal) {
    const fmi3ValueReference data = of_terminal(terminal, "Tx_Data"), clock = of_terminal(terminal, "Tx_Clock");
    const bool active = true;
    fmi3Binary value;
    OK(fmi3SetClock(c, &clock, 1, &active));
    OK(fmi3GetBinary(c, &data, 1, &got.size, &value, 1));
    memcpy(got.bytes, value, got.size);
    update();
}

/* The next operation of what was taken; its code, 0: none. */
static ls_bus_operation told;
static size_t told_to;
static inline uint32_t next(void) {
    if (ls_bus_read(got.bytes, got.size, &told_to, &told) == LS_BUS_END) return 0;
    return told.code;
}

static inline uint32_t first_of(const char *terminal) {
    take(terminal);
    told_to = 0;
    return next();
}

static inline fmi3Status try_step(double at_s, double step_s) {
    bool event = false;
    if (instance()->mode == FMU_EVENT) OK(fmi3EnterStepMode(c));
    return fmi3DoStep(c, at_s, step_s, true, &event, NULL, NULL, NULL);
}

/* A step, and the event mode behind it. */
static inline void step(double at_s, double step_s) {
    OK(try_step(at_s, step_s));
    OK(fmi3EnterEventMode(c));
}

static inline double countdown(const char *terminal, bool *known) {
    const fmi3ValueReference clock = of_terminal(terminal, "Tx_Clock");
    fmi3IntervalQualifier qualifier;
    double interval_s = NOT_A_NUMBER;
    OK(fmi3GetIntervalDecimal(c, &clock, 1, &interval_s, &qualifier));
    *known = qualifier == fmi3IntervalChanged;
    return interval_s;
}

#endif
