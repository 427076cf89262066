/* Tests of co_simulation.c: which steps are taken, by how many internal ones, and what a refused one leaves. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

static void begin(double start_s, bool has_stop, double stop_s) {
    OK(fmi2SetupExperiment(c, fmi2False, 0, start_s, has_stop, stop_s));
    initialise();
}

static uint64_t ticks(void) { return instance()->clock.ticks; }

static void a_step_that_begins_off_the_models_time_is_refused_on_either_side(void) {
    begin(-5, false, 0);
    OK(step(-5, 0.1));
    OK(step(-4.9 + 0.9e-4, 0.1)); /* a thousandth of a step is the importer's rounding */
    OK(step(-4.8 - 0.9e-4, 0.1));
    ASSERT_REFUSED(step(-4.7 + 1.1e-4, 0.1), "but the model is at -4.7 s");
    ASSERT_REFUSED(step(-4.7 - 1.1e-4, 0.1), "but the model is at -4.7 s");
    ASSERT_REFUSED(step(-4.7 + 1.1e-4, 0.2), "but the model is at -4.7 s"); /* of the last step, if that was shorter */
    ASSERT_REFUSED(step(-4.7 - 0.6e-4, 0.05), "but the model is at -4.7 s");
    OK(step(-4.7 + 0.9e-4, 0.2));
}

/* An importer that adds up its times is wrong by so many roundings as it took steps, half a step at most. */
static void the_roundings_of_many_steps_are_forgiven(void) {
    begin(0, false, 0);
    OK(step(0, 1e-6));
    instance()->clock.ticks = 1000000000000U;
    instance()->model.time_s = 1e6;
    ASSERT_REFUSED(step(1e6 + 0.6e-6, 1e-6), "but the model is at");
    OK(step(1e6 + 0.4e-6, 1e-6));
    make(fmi2CoSimulation);
    begin(0, false, 0);
    OK(step(0, 1e-3));
    instance()->clock.ticks = 1000000000U;
    instance()->model.time_s = 1e6;
    OK(step(1e6 + 1e-6 + 0.2e-3, 1e-3)); /* ε · 10⁶ s · 10⁹ steps */
    ASSERT_REFUSED(step(1e6 + 0.6e-3 + 1e-3, 1e-3), "but the model is at");
}

static void with_an_own_step_half_of_it_is_forgiven(void) {
    set("step_s", 0, 0.01);
    begin(0, false, 0);
    OK(step(0.0049, 0.03));
    OK(step(0.03 - 0.0049, 0.03));
    ASSERT_REFUSED(step(0.06 + 0.00501, 0.03), "but the model is at");
    ASSERT_REFUSED(step(0.06 - 0.00501, 0.03), "but the model is at");
    TEST_ASSERT_EQUAL_UINT64(6, ticks());
    ASSERT_REFUSED(step(0.06 + 0.003, 0.004), "is no whole number of internal steps"); /* of a shorter step, too */
    make(fmi2CoSimulation);
    set("step_s", 0, 0.25);
    begin(0, false, 0);
    OK(step(0.125, 0.5)); /* half of it exactly */
    OK(step(0.5 - 0.125, 0.5));
}

/* A thousandth exactly, of a step that differs from the one before by rounding. */
static void the_border_of_what_is_forgiven_is_forgiven(void) {
    const double step_s = 1 + 0.9e-9;
    for (int side = -1; side <= 1; side += 2) {
        make(fmi2CoSimulation);
        begin(-2, false, 0);
        OK(step(-2, 1));
        OK(step(-1, step_s));
        TEST_ASSERT_TRUE(instance()->clock.step_s == 1 && instance()->model.time_s == 0);
        OK(step(side * 1e-3 * step_s, step_s));
        TEST_ASSERT_EQUAL_UINT64(3, ticks());
    }
}

/* Before the first second the roundings of a long run count as they do behind it. */
static void roundings_count_on_either_side_of_zero(void) {
    begin(-10, false, 0);
    OK(step(-10, 1e-6));
    instance()->clock.ticks = 9500000U;
    instance()->model.time_s = -0.5;
    ASSERT_REFUSED(step(-0.5 + 2.1e-9, 1e-6), "but the model is at"); /* a thousandth, and ε · 0.5 s · 9.5·10⁶ */
    OK(step(-0.5 + 2e-9, 1e-6));
    make(fmi2CoSimulation);
    begin(-10, false, 0);
    OK(step(-10, 1e-6));
    instance()->clock.ticks = 10500000U;
    instance()->model.time_s = 0.5;
    ASSERT_REFUSED(step(0.5 + 2.2e-9, 1e-6), "but the model is at"); /* a thousandth, and ε · 0.5 s · 10.5·10⁶ */
    OK(step(0.5 + 2.12e-9, 1e-6));
}

static void equal_steps_are_checked_each_time(void) {
    begin(0, true, 1);
    ASSERT_REFUSED(step(0, 0), "it must be more than 0");
    OK(step(0, 0.5));
    OK(step(0.5, 0.5));
    ASSERT_REFUSED(step(1, 0.5), "the step from 1 s to 1.5 s goes beyond the stop time 1 s");
    make(fmi2CoSimulation);
    begin(0, false, 0);
    ASSERT_REFUSED(step(0, 0), "it must be more than 0");
    OK(step(0, 1));
    OK(step(1, 1));
    ASSERT_REFUSED(step(-2, 1), "the step starts at -2 s, but the model is at 2 s");
    ASSERT_REFUSED(step(1, 2), "the step starts at 1 s, but the model is at 2 s");
    make(fmi2CoSimulation);
    set("step_s", 0, 0.01);
    begin(0, false, 0);
    for (unsigned k = 0; k < 3; k++) {
        OK(step(0.02 * k, 0.02));
        TEST_ASSERT_EQUAL_UINT64(2 * k + 2, ticks());
    }
}

/* Before the first step there is no rounding of earlier ones. */
static void the_first_step_begins_at_the_start(void) {
    begin(0, false, 0);
    ASSERT_REFUSED(step(0.0011, 0.1 * 10), "but the model is at");
    OK(step(0.0009, 1));
}

/* A step that is shorter than the last: what counts of the rounding is how many of the last there were. */
static void roundings_are_those_of_the_steps_that_were(void) {
    begin(0, false, 0);
    for (int k = 0; k < 20; k++) OK(step(0.5 * k, 0.5));
    ASSERT_REFUSED(step(10 + 1.1e-8, 1e-5), "but the model is at");
    OK(step(10 + 0.9e-8, 1e-5));
}

static void steps_that_differ_by_rounding_are_one_step(void) {
    begin(0, false, 0);
    OK(step(0, 0.1));
    OK(step(0.1, 0.1 + 0.9e-10));
    OK(step(0.2, 0.1 - 0.9e-10));
    TEST_ASSERT_TRUE(ticks() == 3 && instance()->clock.step_s == 0.1);
    OK(step(0.3, 0.1 - 1.1e-10));
    TEST_ASSERT_TRUE(ticks() == 1 && instance()->clock.step_s == 0.1 - 1.1e-10);
    OK(step(0.4, 0.1 + 0.1e-10));
    TEST_ASSERT_TRUE(ticks() == 1 && instance()->clock.step_s == 0.1 + 0.1e-10);
    for (int side = -1; side <= 1; side += 2) { /* a billionth exactly, in bits: 2⁻³⁰ of 10⁹ · 2⁻³⁰ */
        const double step_s = 1e9 / (1 << 30), first_s = step_s + side * 1.0 / (1 << 30);
        make(fmi2CoSimulation);
        begin(0, false, 0);
        OK(step(0, first_s));
        OK(step(first_s, step_s));
        TEST_ASSERT_TRUE(ticks() == 2 && instance()->clock.step_s == first_s);
    }
}

/* A remainder of time is no step; the time stays, and the next step is as before. */
static void a_millionth_of_a_step_is_none(void) {
    begin(0, false, 0);
    OK(step(0, 0.1));
    OK(step(0.1, 0.9e-7));
    TEST_ASSERT_TRUE(ticks() == 1 && get("time", 0) == 0.1);
    OK(step(0.1, 0.1));
    TEST_ASSERT_TRUE(ticks() == 2 && instance()->clock.step_s == 0.1);
    OK(step(0.2 + 0.5e-4, 0.9e-7)); /* at the importer's time */
    TEST_ASSERT_TRUE(ticks() == 2 && get("time", 0) == 0.2);
    OK(step(0.2, 1.1e-7));
    TEST_ASSERT_TRUE(ticks() == 1 && instance()->clock.step_s == 1.1e-7);
    make(fmi2CoSimulation);
    begin(0, false, 0);
    OK(step(0, 1));
    OK(step(1, 1e-6)); /* exactly so much */
    TEST_ASSERT_TRUE(ticks() == 1 && get("time", 0) == 1);
    make(fmi2CoSimulation);
    set("step_s", 0, 0.01);
    begin(0, false, 0);
    OK(step(0, 0.9e-8));
    TEST_ASSERT_TRUE(ticks() == 0 && get("time", 0) == 0);
    ASSERT_REFUSED(step(0, 1.1e-8), "is no whole number of internal steps of 0.01 s (step_s); nearest that is: 0.01 s");
    OK(step(0, 0.01));
    TEST_ASSERT_EQUAL_UINT64(1, ticks());
}

static void the_nearest_step_that_would_be_taken_is_named(void) {
    set("step_s", 0, 0.1);
    begin(0, true, 1);
    ASSERT_REFUSED(step(0, 0.234), "nearest that is: 0.2 s");
    ASSERT_REFUSED(step(0, 0.266), "nearest that is: 0.3 s");
    OK(step(0, 0.7));
    ASSERT_REFUSED(step(0.7, 0.04), "nearest that is: 0.1 s");
    OK(step(0.7, 0.2));
    make(fmi2CoSimulation);
    set("step_s", 0, 0.1);
    begin(0, true, 0.17);
    ASSERT_REFUSED(step(0, 0.16), "nearest that is: 0.1 s"); /* 0.2 s would pass the stop time */
    OK(step(0, 0.1));
    ASSERT_REFUSED(step(0.1, 0.06), "cannot be taken in internal steps of 0.1 s (step_s): set another step_s");
    make(fmi2CoSimulation);
    set("step_s", 0, 1e-20);
    begin(0, false, 0);
    ASSERT_REFUSED(step(0, 1), "the communication step of 1 s cannot be taken in internal steps of 1e-20 s");
}

static void a_step_that_the_method_refuses_is_discarded_and_a_smaller_one_taken(void) {
    set_integer("method", 0, 1);
    begin(0, false, 0);
    ASSERT_DISCARDED(step(0, 100), "the step at 0 s is refused: step_s: 100 s is unstable with this method");
    TEST_ASSERT_TRUE(get("time", 0) == 0);
    OK(step(0, 0.01));
    ASSERT_DISCARDED(step(0.01, 100), "the step at 0.01 s is refused: ");
    TEST_ASSERT_TRUE(get("time", 0) == 0.01);
    OK(step(0.01, 0.01));
    TEST_ASSERT_TRUE(get("time", 0) == 0.02);
}

/* Inputs beyond any motion: the core refuses the first step, or a later one. */
static void a_refused_step_leaves_time_and_motion(void) {
    for (int several = 0; several < 2; several++) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.01);
        begin(0, false, 0);
        OK(step(0, 0.01));
        const double x = get("x_m", 0);
        set("body_force_N", 1, 1.7e308);
        set("body_force_N", 2, 1.7e308);
        ASSERT_DISCARDED(step(0.01, several ? 0.05 : 0.01), "the step at 0.01 s is refused: step_s: a result leaves");
        TEST_ASSERT_TRUE(get("time", 0) == 0.01 && get("x_m", 0) == x);
        set("body_force_N", 1, 0);
        set("body_force_N", 2, 0);
        OK(step(0.01, 0.02));
        TEST_ASSERT_EQUAL_UINT64(3, ticks());
    }
}

/* What only bytes could bring that nobody has run: an own step that the method refuses. */
static void an_own_step_that_is_refused_is_not_taken(void) {
    set_integer("method", 0, 1);
    set("step_s", 0, 0.01);
    begin(0, false, 0);
    instance()->model.step_s = 100;
    ASSERT_DISCARDED(step(0, 100), "100 s is unstable with this method");
    instance()->model.step_s = 0.01;
    OK(step(0, 0.02));
    TEST_ASSERT_EQUAL_UINT64(2, ticks());
}

static void a_tuned_parameter_that_is_refused_stops_the_step(void) {
    begin(0, false, 0);
    OK(step(0, 0.1));
    set("ground_roller_drag", 0, 0.2);
    ASSERT_REFUSED(step(0.1, 0.1), "the changed vehicle is refused: ground_roller_drag: 0.2 has no effect on ideal");
    TEST_ASSERT_TRUE(ticks() == 1 && !instance()->model.states_changed);
    set("ground_roller_drag", 0, 0);
    OK(step(0.1, 0.1));
    TEST_ASSERT_EQUAL_UINT64(2, ticks());
}

/* --------------------------------------------------------------------------- by the callback of FMI 3 -- */

static fmi3Instance third;
static int seen;
static bool asks_at_2, asks_at_4, asks_at_5, overloads, says_nothing;
static double times[8];

static double get_3(const char *name) {
    const fmi3ValueReference reference = ref(name, 0);
    double value = NOT_A_NUMBER;
    OK(fmi3GetFloat64(third, &reference, 1, &value, 1));
    return value;
}

static void between(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested, fmi3Boolean get_allowed,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    const fmi3ValueReference force = ref("body_force_N", 1);
    const double far_too_much = 1.7e308;
    (void)e, (void)get_allowed, (void)can_return, (void)early_time;
    times[seen++] = time;
    TEST_ASSERT_TRUE(get_3("time") == time);
    TEST_ASSERT_TRUE(finished && set_requested == (seen != 5));
    if (overloads && seen == 3) OK(fmi3SetFloat64(third, &force, 1, &far_too_much, 1));
    if (says_nothing) return;
    *early = (asks_at_2 && seen == 2) || (asks_at_4 && seen == 4) || (asks_at_5 && seen == 5);
}

static fmi3Status step_by_callback(bool may_return, bool *returned, double *end_s) {
    const fmi3ValueReference own = ref("step_s", 0);
    const double own_s = 0.01;
    bool event, terminate;
    seen = 0;
    fmi3FreeInstance(third);
    third = fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, may_return, NULL, 0, NULL, log_3,
                                        between);
    OK(fmi3SetFloat64(third, &own, 1, &own_s, 1));
    OK(fmi3EnterInitializationMode(third, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(third));
    return fmi3DoStep(third, 0, 0.05, true, &event, &terminate, returned, end_s);
}

static void who_may_not_return_early_does_not(void) {
    bool returned;
    double end_s;
    asks_at_2 = true;
    OK(step_by_callback(false, &returned, &end_s));
    TEST_ASSERT_TRUE(seen == 5 && !returned && end_s == 0.05);
    OK(step_by_callback(true, &returned, &end_s));
    TEST_ASSERT_TRUE(seen == 2 && returned && end_s == 0.02 && get_3("time") == 0.02);
    asks_at_2 = false;
    asks_at_4 = true; /* before the last one */
    OK(step_by_callback(true, &returned, &end_s));
    TEST_ASSERT_TRUE(seen == 4 && returned && end_s == 0.04);
    asks_at_4 = false;
    asks_at_5 = true; /* at its end: that is not early */
    OK(step_by_callback(true, &returned, &end_s));
    TEST_ASSERT_TRUE(seen == 5 && !returned && end_s == 0.05);
    asks_at_5 = false;
    for (int k = 0; k < 5; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.01 * (k + 1), times[k]);
}

static void who_does_not_ask_to_return_does_not(void) {
    bool returned = true;
    double end_s;
    says_nothing = true;
    OK(step_by_callback(true, &returned, &end_s));
    says_nothing = false;
    TEST_ASSERT_TRUE(seen == 5 && !returned && end_s == 0.05);
    fmi3Instance alone = make_3(false); /* whose importer cannot ask */
    OK(fmi3EnterInitializationMode(alone, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(alone));
    asks_at_2 = true;
    OK(step_by_callback(true, &returned, &end_s));
    for (int k = 0; k < 3; k++) {
        bool of_third;
        seen = 0;
        const fmi3Status first = fmi3DoStep(third, 0.02 * k + 0.02, 0.05, true, NULL, NULL, &of_third, NULL);
        const fmi3Status second = fmi3DoStep(alone, 0.5 * k, 0.5, true, NULL, NULL, &returned, &end_s);
        TEST_ASSERT_TRUE(first == fmi3OK && of_third); /* just before, somebody else's */
        TEST_ASSERT_TRUE(second == fmi3OK && !returned && end_s == 0.5 * k + 0.5);
    }
    asks_at_2 = false;
    fmi3FreeInstance(alone);
}

static void a_callback_sees_every_step_also_equal_ones(void) {
    bool returned;
    double end_s;
    OK(step_by_callback(true, &returned, &end_s));
    seen = 4; /* so that the next one is the last of its step */
    OK(fmi3DoStep(third, 0.05, 0.01, true, NULL, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(5, seen);
    seen = 4;
    OK(fmi3DoStep(third, 0.06, 0.01, true, NULL, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(5, seen);
}

static void a_step_that_is_refused_on_its_way_goes_back_to_its_start(void) {
    bool returned;
    double end_s = 7;
    overloads = true;
    log_clear();
    TEST_ASSERT_EQUAL_INT(fmi3Discard, step_by_callback(true, &returned, &end_s));
    overloads = false;
    ASSERT_LOGGED("the step at 0.03 s is refused");
    TEST_ASSERT_TRUE(seen == 3 && end_s == 0 && !returned && get_3("x_m") == 0 && get_3("time") == 0);
    OK(fmi3DoStep(third, 0, 0.02, true, NULL, NULL, NULL, NULL));
    TEST_ASSERT_TRUE(get_3("time") == 0.02);
    fmi3FreeInstance(third);
    third = NULL;
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_step_that_begins_off_the_models_time_is_refused_on_either_side);
    RUN_TEST(the_roundings_of_many_steps_are_forgiven);
    RUN_TEST(with_an_own_step_half_of_it_is_forgiven);
    RUN_TEST(the_border_of_what_is_forgiven_is_forgiven);
    RUN_TEST(roundings_count_on_either_side_of_zero);
    RUN_TEST(equal_steps_are_checked_each_time);
    RUN_TEST(the_first_step_begins_at_the_start);
    RUN_TEST(roundings_are_those_of_the_steps_that_were);
    RUN_TEST(steps_that_differ_by_rounding_are_one_step);
    RUN_TEST(a_millionth_of_a_step_is_none);
    RUN_TEST(the_nearest_step_that_would_be_taken_is_named);
    RUN_TEST(a_step_that_the_method_refuses_is_discarded_and_a_smaller_one_taken);
    RUN_TEST(a_refused_step_leaves_time_and_motion);
    RUN_TEST(an_own_step_that_is_refused_is_not_taken);
    RUN_TEST(a_tuned_parameter_that_is_refused_stops_the_step);
    RUN_TEST(who_may_not_return_early_does_not);
    RUN_TEST(who_does_not_ask_to_return_does_not);
    RUN_TEST(a_callback_sees_every_step_also_equal_ones);
    RUN_TEST(a_step_that_is_refused_on_its_way_goes_back_to_its_start);
    return UNITY_END();
}
