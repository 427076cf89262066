/* Tests of fmi3_clocks.c, network_port.c and step.c: when clocks activate, what they send, and every refusal. */
#include "model_interface.h"
#include "network_bench.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

static void begin(void) { OK(begin_from(0)); }

static fmi3ValueReference tx_clock(void) { return of_terminal("Node2", "Tx_Clock"); }
static fmi3ValueReference rx_clock(void) { return of_terminal("Node2", "Rx_Clock"); }
static fmi3ValueReference rx_data(void) { return of_terminal("Node2", "Rx_Data"); }
static fmi3ValueReference tx_data(void) { return of_terminal("Node2", "Tx_Data"); }

static bool is_active(fmi3ValueReference clock) {
    bool active = false;
    OK(fmi3GetClock(c, &clock, 1, &active));
    return active;
}

static size_t offered(void) {
    const fmi3ValueReference data = tx_data();
    fmi3Binary value;
    size_t size = 99;
    OK(fmi3GetBinary(c, &data, 1, &size, &value, 1));
    TEST_ASSERT_TRUE(value == instance()->model.port[1].tx.bytes);
    return size;
}

/* A frame of the first node is on its way to the second. */
static void with_a_frame(void) {
    const laconic_frame frame = {.id = 1, .length = 8};
    ls_bus_put_frame(&out, &frame, false);
    give("Node1", &out);
    out.size = 0;
    update();
}

/* The first node is told that its frame went, by a clock that is set. */
static void first_is_told(void) {
    const fmi3ValueReference clock = of_terminal("Node1", "Tx_Clock");
    const bool on = true;
    OK(fmi3SetClock(c, &clock, 1, &on));
}

/* A triggered clock: active in the second iteration, once, and a third one follows. */
static void a_triggered_clock_activates_in_the_second_iteration(void) {
    bool needed = false;
    begin();
    with_a_frame();
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, 0, 1e-3, true, &needed, NULL, NULL, NULL));
    TEST_ASSERT_TRUE(needed);
    OK(fmi3EnterEventMode(c));
    first_is_told();
    TEST_ASSERT_TRUE(!is_active(tx_clock()) && offered() == 0);
    TEST_ASSERT_TRUE(update());
    TEST_ASSERT_TRUE(is_active(tx_clock()) && offered() == 24);
    TEST_ASSERT_TRUE(!is_active(tx_clock()) && offered() == 24); /* true once for each activation */
    TEST_ASSERT_TRUE(update());
    TEST_ASSERT_TRUE(!is_active(tx_clock()) && offered() == 0 && instance()->model.port[1].tx.size == 0);
    TEST_ASSERT_FALSE(update());
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, 1e-3, 1e-3, true, &needed, NULL, NULL, NULL));
    TEST_ASSERT_FALSE(needed);
}

/* What no importer asked for stays, and is sent at the next communication point. */
static void what_was_not_asked_for_stays(void) {
    begin();
    with_a_frame();
    step(0, 1e-3);
    TEST_ASSERT_TRUE(update());
    TEST_ASSERT_FALSE(update());
    TEST_ASSERT_TRUE(!is_active(tx_clock()) && instance()->model.port[1].tx.size == 24);
    step(1e-3, 1e-3);
    TEST_ASSERT_TRUE(update() && is_active(tx_clock()) && offered() == 24);
}

/* An importer may leave event mode before the iteration in which the clock would have been active. */
static void a_clock_that_was_ready_becomes_so_anew(void) {
    begin();
    with_a_frame();
    step(0, 1e-3);
    TEST_ASSERT_TRUE(update());
    step(1e-3, 1e-3);
    TEST_ASSERT_TRUE(!is_active(tx_clock()) && offered() == 0);
    TEST_ASSERT_TRUE(update());
    TEST_ASSERT_TRUE(is_active(tx_clock()) && offered() == 24);
}

/* An answer to what comes in the same iteration waits for the next step. */
static void an_answer_waits_for_the_next_step(void) {
    const uint8_t wrong[9] = {0x99, 0, 0, 0, 9, 0, 0, 0, 1};
    begin();
    with_a_frame();
    step(0, 1e-3);
    update();
    memcpy(out.bytes, wrong, 9);
    out.size = 9;
    give("Node2", &out);
    TEST_ASSERT_TRUE(is_active(tx_clock()) && offered() == 24);
    TEST_ASSERT_TRUE(update());
    TEST_ASSERT_TRUE(instance()->model.port[1].tx.size == 19 && !is_active(tx_clock()));
    TEST_ASSERT_FALSE(update());
    step(1e-3, 0);
    TEST_ASSERT_TRUE(update() && is_active(tx_clock()) && offered() == 19);
}

/* A countdown clock is set by the importer, at any event, and sends all. */
static void a_clock_that_the_importer_sets_sends_all(void) {
    const fmi3ValueReference clock = tx_clock();
    const bool on = true, off = false;
    begin();
    with_a_frame();
    step(0, 1e-3);
    first_is_told();
    OK(fmi3SetClock(c, &clock, 1, &off));
    TEST_ASSERT_EQUAL_size_t(0, offered());
    OK(fmi3SetClock(c, &clock, 1, &on));
    TEST_ASSERT_EQUAL_size_t(24, offered());
    TEST_ASSERT_FALSE(update());
    TEST_ASSERT_TRUE(offered() == 0 && instance()->model.port[1].tx.size == 0 && !instance()->model.port[1].tx_clock);
}

static void bytes_count_only_with_their_clock(void) {
    const fmi3ValueReference data = rx_data(), clock = rx_clock();
    const laconic_frame frame = {.id = 1};
    const size_t size = 16;
    const bool on = true, off = false;
    begin();
    ls_bus_put_frame(&out, &frame, false);
    const fmi3Binary value = out.bytes;
    fmi3Binary back;
    size_t found = 0;
    OK(fmi3SetBinary(c, &data, 1, &size, &value, 1));
    const fmi3ValueReference both[2] = {of_terminal("Node1", "Rx_Data"), data};
    fmi3Binary backs[2] = {NULL, NULL};
    size_t sizes[2] = {9, 9};
    OK(fmi3GetBinary(c, both, 2, sizes, backs, 2));
    TEST_ASSERT_TRUE(sizes[0] == 0 && sizes[1] == 16 && memcmp(backs[1], out.bytes, 16) == 0);
    OK(fmi3GetBinary(c, &data, 1, &found, &back, 1));
    TEST_ASSERT_TRUE(found == 16 && memcmp(back, out.bytes, 16) == 0);
    OK(fmi3SetClock(c, &clock, 1, &on));
    TEST_ASSERT_TRUE(is_active(rx_clock()));
    OK(fmi3SetClock(c, &clock, 1, &off));
    TEST_ASSERT_FALSE(is_active(rx_clock()));
    update();
    TEST_ASSERT_TRUE(instance()->model.node[1].queue.size == 0 && instance()->model.port[1].rx.size == 0);
    OK(fmi3SetBinary(c, &data, 1, &size, &value, 1));
    OK(fmi3SetClock(c, &clock, 1, &on));
    update();
    TEST_ASSERT_TRUE(instance()->model.node[1].queue.size == 16 && !is_active(rx_clock()));
}

static void clocks_belong_to_event_and_initialization_mode(void) {
    const fmi3ValueReference clock = tx_clock();
    bool active = false;
    double interval_s;
    uint64_t counter, resolution;
    fmi3IntervalQualifier qualifier;
    ASSERT_REFUSED(fmi3GetClock(c, &clock, 1, &active), "GetClock is not allowed in instantiated");
    OK(fmi3EnterInitializationMode(c, false, 0, 0, false, 0));
    OK(fmi3GetClock(c, &clock, 1, &active));
    OK(fmi3ExitInitializationMode(c));
    OK(fmi3EnterStepMode(c));
    ASSERT_REFUSED(fmi3SetClock(c, &clock, 1, &active), "SetClock is not allowed in step mode");
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, &clock, 1, &interval_s, &qualifier), "GetIntervalDecimal is not allowed");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, &clock, 1, &counter, &resolution, &qualifier),
                   "GetIntervalFraction is not allowed in step mode");
    OK(fmi3Terminate(c));
    const fmi3ValueReference data = rx_data();
    const size_t size = 0;
    fmi3Binary value = out.bytes;
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, &size, &value, 1), "Set is not allowed in terminated");
}

static void lists_are_checked(void) {
    const fmi3ValueReference clock = tx_clock(), rate = ref("bit_rate_bit_per_s", 0), none = 0x7FFFFFFF;
    const fmi3ValueReference data = rx_data(), sent = tx_data(), triggered = rx_clock();
    bool active = true;
    double interval_s;
    uint64_t counter, resolution;
    fmi3IntervalQualifier qualifier;
    size_t size = 1;
    fmi3Binary value = out.bytes;
    begin();
    ASSERT_REFUSED(fmi3GetClock(c, NULL, 1, &active), "a list of value references or values is missing (NULL)");
    ASSERT_REFUSED(fmi3GetClock(c, &clock, 1, NULL), "is missing (NULL)");
    ASSERT_REFUSED(fmi3SetClock(c, NULL, 1, &active), "is missing (NULL)");
    ASSERT_REFUSED(fmi3GetClock(c, &rate, 1, &active), "there is no Clock with the value reference 1");
    ASSERT_REFUSED(fmi3SetClock(c, &none, 1, &active), "there is no Clock with the value reference");
    ASSERT_REFUSED(fmi3GetBinary(c, &clock, 1, &size, &value, 1), "there is no Binary with the value reference");
    ASSERT_REFUSED(fmi3GetBinary(c, &data, 1, &size, &value, 2), "GetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3GetBinary(c, &data, 1, NULL, &value, 1), "GetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3GetBinary(c, NULL, 1, &size, &value, 1), "GetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, &size, &value, 0), "SetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, NULL, &value, 1), "SetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, &size, NULL, 1), "SetBinary: give one value and one size");
    ASSERT_REFUSED(fmi3SetBinary(c, &clock, 1, &size, &value, 1), "there is no Binary");
    ASSERT_REFUSED(fmi3SetBinary(c, &sent, 1, &size, &value, 1), "Node2.Tx_Data cannot be set: it is computed");
    size = LS_BUS_BUFFER_BYTES + 1;
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, &size, &value, 1), "32769 bytes given, at most 32768 are possible");
    size = LS_BUS_BUFFER_BYTES;
    OK(fmi3SetBinary(c, &data, 1, &size, &value, 1));
    size = 1;
    value = NULL;
    ASSERT_REFUSED(fmi3SetBinary(c, &data, 1, &size, &value, 1), "Node2.Rx_Data: 1 bytes given");
    size = 0;
    OK(fmi3SetBinary(c, &data, 1, &size, &value, 1));
    TEST_ASSERT_EQUAL_size_t(0, instance()->model.port[1].rx.size);
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, NULL, 1, &interval_s, &qualifier),
                   "GetIntervalDecimal: a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, &clock, 1, NULL, &qualifier), "GetIntervalDecimal: a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, &clock, 1, &interval_s, NULL), "GetIntervalDecimal: a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, NULL, 1, &counter, &resolution, &qualifier), "a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, &clock, 1, &counter, &resolution, NULL), "a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, &clock, 1, NULL, &resolution, &qualifier), "a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, &clock, 1, &counter, NULL, &qualifier), "a list is missing");
    ASSERT_REFUSED(fmi3GetIntervalFraction(c, &rate, 1, &counter, &resolution, &qualifier), "there is no Clock");
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, &triggered, 1, &interval_s, &qualifier),
                   "Node2.Rx_Clock is triggered: it has no interval");
}

static void empty_lists_need_nothing(void) {
    begin();
    OK(fmi3GetClock(c, NULL, 0, NULL));
    OK(fmi3SetClock(c, NULL, 0, NULL));
    OK(fmi3GetBinary(c, NULL, 0, NULL, NULL, 0));
    OK(fmi3SetBinary(c, NULL, 0, NULL, NULL, 0));
    OK(fmi3GetIntervalDecimal(c, NULL, 0, NULL, NULL));
    OK(fmi3GetIntervalFraction(c, NULL, 0, NULL, NULL, NULL));
}

static void an_interval_is_seconds_or_microseconds(void) {
    const fmi3ValueReference clock = tx_clock();
    uint64_t counter = 0, resolution = 0;
    fmi3IntervalQualifier qualifier;
    begin();
    OK(fmi3GetIntervalFraction(c, &clock, 1, &counter, &resolution, &qualifier));
    TEST_ASSERT_TRUE(qualifier == fmi3IntervalNotYetKnown && counter == 0 && resolution == 1000000);
    with_a_frame();
    OK(fmi3GetIntervalFraction(c, &clock, 1, &counter, &resolution, &qualifier));
    TEST_ASSERT_TRUE(qualifier == fmi3IntervalChanged && counter == 111); /* 47 + 64 bits at 1 Mbit/s */
    bool known;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 111e-6, countdown("Node2", &known));
}

static void a_bus_that_cannot_start_has_no_interval(void) {
    const fmi3ValueReference clock = tx_clock();
    fmi3IntervalQualifier qualifier;
    double interval_s;
    OK(fmi3EnterInitializationMode(c, false, 0, 5e9, false, 0));
    ASSERT_REFUSED(fmi3GetIntervalDecimal(c, &clock, 1, &interval_s, &qualifier),
                   "the start time 5000000000 s cannot be taken: give one from -4e+09 s to 4e+09 s");
    ASSERT_REFUSED(fmi3ExitInitializationMode(c), "the start time 5000000000 s cannot be taken");
    OK(fmi3Reset(c));
    ASSERT_REFUSED(begin_from(-4.1e9), "cannot be taken");
    OK(fmi3Reset(c));
    OK(begin_from(-4e9));
    instance()->model.start_needed = true; /* as a state of another run would have it */
    instance()->clock.start_s = 5e9;
    ASSERT_REFUSED(fmi3UpdateDiscreteStates(c, NULL, NULL, NULL, NULL, NULL, NULL), "cannot be taken");
}

#define NO_CLOCK(call) \
    ASSERT_REFUSED(call(1), "no variables of the kind periodic Clock"); \
    OK(call(0))

static void no_clock_is_periodic(void) {
    static double real[1];
    static uint64_t whole[1];
    const fmi3ValueReference clock = tx_clock();
    begin();
#define GET_SHIFT(n) fmi3GetShiftDecimal(c, &clock, n, real)
#define SET_SHIFT(n) fmi3SetShiftDecimal(c, &clock, n, real)
#define SET_INTERVAL(n) fmi3SetIntervalDecimal(c, &clock, n, real)
#define GET_SHIFT_F(n) fmi3GetShiftFraction(c, &clock, n, whole, whole)
#define SET_SHIFT_F(n) fmi3SetShiftFraction(c, &clock, n, whole, whole)
#define SET_INTERVAL_F(n) fmi3SetIntervalFraction(c, &clock, n, whole, whole)
    NO_CLOCK(GET_SHIFT);
    NO_CLOCK(SET_SHIFT);
    NO_CLOCK(SET_INTERVAL);
    NO_CLOCK(GET_SHIFT_F);
    NO_CLOCK(SET_SHIFT_F);
    NO_CLOCK(SET_INTERVAL_F);
}

static void an_instance_that_is_none_has_no_clocks(void) {
    fmi3Instance none = NULL;
    const fmi3ValueReference clock = 0;
    static double real[1];
    static uint64_t whole[1];
    static bool flag[1];
    static size_t size[1];
    static fmi3Binary binary[1];
    static fmi3IntervalQualifier qualifier[1];
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetClock(none, &clock, 1, flag));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetClock(none, &clock, 1, flag));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetBinary(none, &clock, 1, size, binary, 1));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetBinary(none, &clock, 1, size, (const fmi3Binary *)binary, 1));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetIntervalDecimal(none, &clock, 1, real, qualifier));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetIntervalFraction(none, &clock, 1, whole, whole, qualifier));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetShiftDecimal(none, &clock, 1, real));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetShiftDecimal(none, &clock, 1, real));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetIntervalDecimal(none, &clock, 1, real));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3GetShiftFraction(none, &clock, 1, whole, whole));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetShiftFraction(none, &clock, 1, whole, whole));
    TEST_ASSERT_EQUAL(fmi3Error, fmi3SetIntervalFraction(none, &clock, 1, whole, whole));
}

static void steps_of_any_length_are_taken_but_not_backwards(void) {
    begin();
    OK(try_step(0, 0));
    OK(try_step(0.5e-9, 1));
    TEST_ASSERT_TRUE(get_real("time", 0) == 1 + 0.5e-9);
    ASSERT_REFUSED(try_step(1.1, 0.1), "the step starts at 1.1 s, but the model is at 1.0000000005 s");
    ASSERT_REFUSED(try_step(0.9, 0.1), "but the model is at");
    ASSERT_REFUSED(try_step(1, -0.1), "a communication step of -0.1 s cannot be taken: it must not be negative");
    ASSERT_REFUSED(try_step(1, NOT_A_NUMBER), "a step of nan s from 1 s cannot be taken: they must be finite");
    ASSERT_REFUSED(try_step(NOT_A_NUMBER, 1), "they must be finite");
    ASSERT_REFUSED(try_step(1, 1.1e6),
                   "of 1100000 s from 1 s cannot be taken: give 1e+06 s or less, and an end of 4e+09 s");
    double end_s = 7;
    TEST_ASSERT_EQUAL(fmi3Error, fmi3DoStep(c, 1.1, 0.1, true, NULL, NULL, NULL, &end_s));
    TEST_ASSERT_TRUE(end_s == 1 + 0.5e-9);
    TEST_ASSERT_TRUE(get_real("time", 0) == 1 + 0.5e-9);
    OK(try_step(1, 1e6));
    ASSERT_REFUSED(try_step(1000001 + 0.3e-3, 1), "but the model is at"); /* 10⁶ ε · 10⁶ s of rounding */
    OK(try_step(1000001 + 0.2e-3, 1));
    make();
    OK(begin_from(4e9 - 1));
    ASSERT_REFUSED(try_step(4e9 - 1, 2), "an end of 4e+09 s or less");
    OK(try_step(4e9 - 1, 1));
    make();
    OK(fmi3EnterInitializationMode(c, false, 0, 0, true, 2));
    OK(fmi3ExitInitializationMode(c));
    ASSERT_REFUSED(try_step(0, 2.1), "the step from 0 s to 2.1 s goes beyond the stop time 2 s");
    OK(try_step(0, 2));
}

static fmi3Instance as(bool event_mode, bool exchange) {
    log_clear();
    if (exchange) return fmi3InstantiateModelExchange("a", fmu_token_3, NULL, false, true, NULL, log_3);
    return fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, event_mode, false, NULL, 0, NULL, log_3,
                                       NULL);
}

static void a_bus_needs_event_mode_and_no_model_exchange(void) {
    TEST_ASSERT_NULL(as(false, false));
    ASSERT_LOGGED("the clocks of a bus need event mode");
    TEST_ASSERT_NULL(as(true, true));
    ASSERT_LOGGED("this FMU offers no Model Exchange; use Co-Simulation");
}

/* The glue has these for all FMUs; no mode of Co-Simulation lets an importer come so far. */
static void what_belongs_to_model_exchange_is_refused(void) {
    double values[1] = {0};
    const fmu_references none = {NULL, 0};
    fmu_instance *self = instance();
    begin();
    ASSERT_REFUSED(fmu_set_time(self, 0), "this FMU offers no Model Exchange and no derivatives");
    ASSERT_REFUSED(fmu_completed_step(self), "no Model Exchange and no derivatives");
    ASSERT_REFUSED(fmu_get_states(self, values, 1), "no variables of the kind continuous state");
    ASSERT_REFUSED(fmu_set_states(self, values, 1), "no variables of the kind continuous state");
    ASSERT_REFUSED(fmu_get_rates(self, values, 1), "no variables of the kind continuous state");
    ASSERT_REFUSED(fmu_get_nominals(self, values, 1), "no variables of the kind continuous state");
    OK(fmu_get_states(self, NULL, 0));
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0), "and no derivatives");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(c, NULL, 0, NULL, 0, NULL, 0, NULL, 0), "and no derivatives");
    ASSERT_REFUSED(fmu_output_derivatives(self, none, NULL, NULL, 0), "and no derivatives");
    TEST_ASSERT_EQUAL_UINT32(0, fmu_model_state_count(&self->model));
}

/* Kept within the process, never as bytes. */
static void a_state_is_kept_but_not_written(void) {
    fmi3FMUState kept = NULL;
    fmi3Byte bytes[16];
    size_t size;
    begin();
    with_a_frame();
    OK(fmi3GetFMUState(c, &kept));
    step(0, 1e-3);
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
    OK(fmi3SetFMUState(c, kept));
    TEST_ASSERT_EQUAL_INT32(0, get_integer("frames_carried"));
    step(0, 1e-3);
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_carried"));
    ASSERT_REFUSED(fmi3SerializedFMUStateSize(c, kept, &size), "the state of this FMU cannot be serialized, only kept");
    ASSERT_REFUSED(fmi3SerializeFMUState(c, kept, bytes, sizeof bytes), "cannot be serialized");
    ASSERT_REFUSED(fmi3DeserializeFMUState(c, bytes, sizeof bytes, &kept), "cannot be serialized");
    OK(fmi3FreeFMUState(c, &kept));
}

static void a_bus_has_no_structural_parameters(void) {
    ASSERT_REFUSED(fmi3EnterConfigurationMode(c), "this FMU has no structural parameters");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_triggered_clock_activates_in_the_second_iteration);
    RUN_TEST(what_was_not_asked_for_stays);
    RUN_TEST(a_clock_that_was_ready_becomes_so_anew);
    RUN_TEST(an_answer_waits_for_the_next_step);
    RUN_TEST(a_clock_that_the_importer_sets_sends_all);
    RUN_TEST(bytes_count_only_with_their_clock);
    RUN_TEST(clocks_belong_to_event_and_initialization_mode);
    RUN_TEST(lists_are_checked);
    RUN_TEST(empty_lists_need_nothing);
    RUN_TEST(an_interval_is_seconds_or_microseconds);
    RUN_TEST(a_bus_that_cannot_start_has_no_interval);
    RUN_TEST(no_clock_is_periodic);
    RUN_TEST(an_instance_that_is_none_has_no_clocks);
    RUN_TEST(steps_of_any_length_are_taken_but_not_backwards);
    RUN_TEST(a_bus_needs_event_mode_and_no_model_exchange);
    RUN_TEST(what_belongs_to_model_exchange_is_refused);
    RUN_TEST(a_state_is_kept_but_not_written);
    RUN_TEST(a_bus_has_no_structural_parameters);
    return UNITY_END();
}
