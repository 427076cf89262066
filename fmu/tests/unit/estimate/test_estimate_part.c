/* Tests of estimate_part.c: the error that the FMU shows is that of the core's estimate beside the same plant, through
 * changes, slopes, sensors and refusals; and the bits of the motion stay. */
#include "parts.h"
#include "saved_bench.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* The description's start value is "yes". */
static void without_estimate(void) {
    const fmi2ValueReference on = ref("estimate_error", 0);
    const fmi2Boolean no = fmi2False;
    OK(fmi2SetBoolean(c, &on, 1, &no));
}

/* The same by the core alone. */
static laconic_plant twin;
static laconic_estimate beside;
static laconic_input held;

static void begin(double own_s, double first_s) {
    const fmu_model *model = &instance()->model;
    set("friction_coefficient", 0, 0); /* so that steps are taken together */
    set_flag("estimate_error", 0);
    set_integer("estimate_window_steps", 0, 8);
    set_integer("method", 0, 1);
    set("step_s", 0, own_s);
    initialise();
    memset(&held, 0, sizeof held);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_start(&twin, &model->vehicle, laconic_method_by_number(1), first_s,
                                                      &model->start, NULL));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_estimate_start(&beside, &twin, 8, laconic_finer_method(&twin), NULL));
}

static void apply(double volts) {
    for (uint32_t k = 1; k <= 4; k++) {
        held.voltage_V[k - 1] = volts * k;
        set("voltage_V", k, volts * k);
    }
}

static void run_beside(uint64_t steps) {
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_estimate_run(&beside, &twin, &held, steps, NULL));
}

#define SAME(prefix, error) \
    TEST_ASSERT_TRUE(get(prefix "nu_rad_per_s", 0) == (error).nu_rad_per_s); \
    TEST_ASSERT_TRUE(get(prefix "place_m", 0) == (error).place_m); \
    TEST_ASSERT_TRUE(get(prefix "heading_rad", 0) == (error).heading_rad); \
    TEST_ASSERT_TRUE(get(prefix "wheel_angle_rad", 0) == (error).wheel_angle_rad);

static void compare(void) {
    laconic_errors errors;
    laconic_estimate_read(&errors, &beside, &twin);
    TEST_ASSERT_EQUAL_MEMORY(&twin.state, &instance()->model.plant.state, sizeof twin.state);
    SAME("estimated_error_", errors.now)
    SAME("estimated_error_largest_", errors.largest)
    SAME("estimated_error_rounding_", errors.rounding)
    TEST_ASSERT_TRUE(get("estimated_error_unknown_windows", 0) == (double)errors.unknown);
    TEST_ASSERT_TRUE(errors.now.place_m > 0);
}

static void the_error_is_that_of_the_core_s_estimate(void) {
    begin(0.05, 0.05);
    TEST_ASSERT_TRUE(get("estimated_error_place_m", 0) == 0);
    apply(2);
    OK(step(0, 1));
    run_beside(20);
    compare();
    apply(-1);
    for (int k = 0; k < 5; k++) OK(step(1 + 0.05 * k, 0.05));
    for (int k = 0; k < 5; k++) run_beside(1);
    compare();
}

/* Without an own step the estimate begins with the first step, and goes on when the importer takes another one. */
static void the_estimate_follows_the_steps_that_importers_choose(void) {
    const laconic_real steps_s[3] = {0.05, 0.02, 0.05};
    double at = 0;
    begin(0, steps_s[0]);
    apply(2);
    TEST_ASSERT_TRUE(!instance()->model.estimate_begun && get("estimated_error_place_m", 0) == 0);
    for (int n = 0; n < 3; n++) {
        if (n > 0) {
            const laconic_plant before = twin;
            TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_set_step(&twin, steps_s[n], NULL));
            TEST_ASSERT_EQUAL(LACONIC_OK,
                              laconic_estimate_carry(&beside, &before, &twin, laconic_finer_method(&twin), NULL));
        }
        for (int k = 0; k < 7; k++, at += steps_s[n]) OK(step(at, steps_s[n]));
        for (int k = 0; k < 7; k++) run_beside(1);
        compare();
    }
    TEST_ASSERT_TRUE(instance()->model.estimate_begun);
    const laconic_integrator used = instance()->model.plant.integrator;
    ASSERT_DISCARDED(step(at, 100), "is unstable with this method");
    TEST_ASSERT_TRUE(instance()->model.plant.integrator.step_s == used.step_s);
    OK(step(at, 0.05));
    run_beside(1);
    compare();
}

static void a_first_step_that_is_refused_begins_nothing(void) {
    begin(0, 0.05);
    apply(2);
    ASSERT_DISCARDED(step(0, 100), "is unstable with this method");
    TEST_ASSERT_FALSE(instance()->model.estimate_begun);
    OK(step(0, 0.05));
    run_beside(1);
    compare();
}

static void change_beside(double damping_Nms) {
    laconic_vehicle changed = twin.vehicle;
    changed.motor_damping_Nms = damping_Nms;
    const laconic_plant before = twin;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_change(&twin, &changed, NULL));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_estimate_carry(&beside, &before, &twin, laconic_finer_method(&twin), NULL));
}

/* Of two changes the first is refused, and leaves the estimate as it was. */
static void a_change_of_the_vehicle_carries_the_error_on(void) {
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    run_beside(10);
    set("motor_damping_Nms", 0, 0.25);
    set("ground_roller_drag", 0, 0.2);
    ASSERT_REFUSED(step(0.5, 0.5), "the changed vehicle is refused: ground_roller_drag");
    set("ground_roller_drag", 0, 0);
    OK(step(0.5, 0.5));
    change_beside(0.25);
    run_beside(10);
    compare();
}

/* Before the first step there is no estimate that a change could carry on. */
static void a_change_before_the_first_step_carries_nothing(void) {
    begin(0, 0.05);
    set("motor_damping_Nms", 0, 0.25);
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(instance()->model.estimate_begun && get("x_m", 0) == 0);
}

static void slopes_are_watched_as_samples(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 2);
    const fmi2Integer first = 1;
    const double slope = 30;
    laconic_input at[3];
    for (int sensors = 0; sensors < 2; sensors++) {
        make(fmi2CoSimulation);
        if (sensors) set_integer("encoder_counts_per_turn", 1, 4096);
        begin(0.05, 0.05);
        apply(2);
        OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
        OK(step(0, 0.5));
        for (int n = 0; n < 10; n++) {
            for (int k = 0; k < 3; k++) {
                at[k] = held;
                at[k].voltage_V[1] = held.voltage_V[1] + (((double)n + 0.5 * k) * 0.05) * slope;
            }
            TEST_ASSERT_EQUAL(LACONIC_OK, laconic_estimate_run_sampled(&beside, &twin, at, NULL));
        }
        compare();
        TEST_ASSERT_TRUE((get("encoder_count", 1) != 0) == sensors);
    }
}

/* Whatever samples have for wheels that are not there: the estimate takes them for the input that was held before. */
static void samples_of_wheels_that_are_not_there_do_not_count(void) {
    fmu_model *model = &instance()->model;
    laconic_input at[3], clean[3];
    double left = 7;
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    run_beside(10);
    for (int n = 0; n < 9; n++) {
        for (int k = 0; k < 3; k++) {
            at[k] = clean[k] = held;
            for (int i = 4; i < LACONIC_MAX_WHEELS; i++) at[k].voltage_V[i] = at[k].axle_torque_Nm[i] = left++;
        }
        TEST_ASSERT_EQUAL(LACONIC_OK, fmu_estimate_run_sampled(model, at, NULL));
        TEST_ASSERT_EQUAL(LACONIC_OK, laconic_estimate_run_sampled(&beside, &twin, clean, NULL));
        TEST_ASSERT_EQUAL_INT32(beside.length, model->estimate.length);
        TEST_ASSERT_EQUAL_INT32(beside.taken, model->estimate.taken);
    }
    model->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    compare();
}

/* Also one that has begun, in a start before: the step is not known any more. */
static void a_start_without_a_step_has_no_estimate_yet(void) {
    set("start_x_m", 0, 5);
    set("start_heading_rad", 0, 1);
    set("step_s", 0, 0.05);
    set_flag("estimate_error", 0);
    OK(fmi2EnterInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 5 && instance()->model.estimate_begun);
    set("step_s", 0, 0);
    OK(fmi2ExitInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 5 && get("estimated_error_rounding_place_m", 0) == 0);
    TEST_ASSERT_TRUE(get("estimated_error_place_m", 0) == 0 && get("estimated_error_heading_rad", 0) == 0);
    TEST_ASSERT_FALSE(instance()->model.estimate_begun);
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(instance()->model.estimate_begun && get("estimated_error_rounding_place_m", 0) > 0);
}

/* Only where it is asked for. */
static void an_estimate_is_read_when_it_is_asked_for(void) {
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    instance()->model.estimated_unknown = 77;
    for (uint32_t group = FMU_GROUP_MOTION; group <= FMU_GROUP_SENSORS; group *= 2)
        fmu_model_refresh(instance(), group);
    TEST_ASSERT_TRUE(instance()->model.estimated_unknown == 77);
    TEST_ASSERT_TRUE(get("estimated_error_unknown_windows", 0) == 0);
}

static void a_sampled_step_that_is_refused_is_taken_back(void) {
    const fmi2ValueReference force = ref("body_force_N", 1);
    const fmi2Integer first = 1;
    const double slope = 1e308;
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    run_beside(10);
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    OK(fmi2SetRealInputDerivatives(c, &force, 1, &first, &slope));
    ASSERT_DISCARDED(step(0.5, 0.1), "is refused");
    ASSERT_DISCARDED(step(0.5, 0.05), "is refused");
    instance()->model.sloped = false;
    set("body_force_N", 1, 0);
    set("body_force_N", 2, 0);
    compare();
}

static void sensors_and_an_estimate_watch_the_same_steps(void) {
    set_integer("encoder_counts_per_turn", 1, 4096);
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 1));
    run_beside(20);
    compare();
    TEST_ASSERT_TRUE(get("encoder_count", 1) != 0);
}

/* A step that is refused on its way: motion and estimate go back to where the communication step began. */
static void a_refused_step_takes_the_estimate_back(void) {
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    run_beside(10);
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    ASSERT_DISCARDED(step(0.5, 0.25), "is refused");
    ASSERT_DISCARDED(step(0.5, 0.05), "is refused");
    set("body_force_N", 1, 0);
    set("body_force_N", 2, 0);
    compare();
    OK(step(0.5, 0.5));
    run_beside(10);
    compare();
}

static void without_an_estimate_all_is_zero(void) {
    const fmi2ValueReference force = ref("body_force_N", 1);
    const fmi2Integer first = 1;
    const double slope = 1;
    without_estimate();
    set("friction_coefficient", 0, 0);
    set("step_s", 0, 0.05);
    initialise();
    set("voltage_V", 1, 5);
    FILL(instance()->model.estimated.now); /* of another run, whose state was left */
    FILL(instance()->model.estimated.largest);
    FILL(instance()->model.estimated.rounding);
    instance()->model.estimated.unknown = 5;
    instance()->model.estimated_unknown = 5;
    OK(step(0, 0.5));
    OK(step(0.5, 0.05));
    TEST_ASSERT_TRUE(get("estimated_error_place_m", 0) == 0 && get("estimated_error_largest_place_m", 0) == 0);
    TEST_ASSERT_TRUE(get("estimated_error_rounding_place_m", 0) == 0 && get("x_m", 0) != 0);
    TEST_ASSERT_TRUE(get("estimated_error_unknown_windows", 0) == 0);
    const laconic_errors none = {0};
    TEST_ASSERT_EQUAL_MEMORY(&none, &instance()->model.estimated, sizeof none);
    OK(fmi2SetRealInputDerivatives(c, &force, 1, &first, &slope));
    OK(step(0.55, 0.05));
    const double x = get("x_m", 0);
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    ASSERT_DISCARDED(step(0.6, 0.1), "is refused");
    TEST_ASSERT_TRUE(get("x_m", 0) == x);
}

static void model_exchange_has_no_estimate(void) {
    make(fmi2ModelExchange);
    set_flag("estimate_error", 0);
    ASSERT_REFUSED(initialise_refused(), "estimate_error: an estimate follows internal steps, which Model Exchange");
    make(fmi2ModelExchange);
    without_estimate();
    initialise();
    make(fmi2CoSimulation);
    set_flag("estimate_error", 0);
    set_integer("estimate_window_steps", 0, 1);
    set("step_s", 0, 0.05);
    instance()->model.estimate_window_steps = 0;
    ASSERT_REFUSED(initialise_refused(), "this vehicle cannot start: 0 is not positive");
    set("mass_kg", 0, 0);
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "this vehicle cannot start: mass_kg: ");
}

/* A step that the estimate refuses is none: the plant keeps the one before. */
static void a_step_that_the_estimate_refuses_is_not_the_plant_s(void) {
    set_flag("estimate_error", 0);
    initialise();
    instance()->model.estimate_window_steps = 0;
    ASSERT_DISCARDED(step(0, 0.05), "the step at 0 s is refused: ");
    TEST_ASSERT_TRUE(instance()->model.plant.integrator.step_s == 1);
    instance()->model.estimate_window_steps = 16;
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(instance()->model.plant.integrator.step_s == 0.05);
}

static void an_estimate_is_kept_in_bytes(void) {
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    for (int friction = 0; friction < 2; friction++) {
        make(fmi2CoSimulation);
        if (friction) set("friction_coefficient", 0, 0);
        if (friction) set("ground_friction_coefficient", 0, 0.4);
        set_flag("estimate_error", 0);
        set("step_s", 0, 0.01);
        initialise();
        apply(2);
        OK(step(0, 0.13));
        OK(fmi2GetFMUstate(c, &kept));
        OK(fmi2SerializedFMUstateSize(c, kept, &size));
        TEST_ASSERT_TRUE(size < sizeof bytes);
        OK(fmi2SerializeFMUstate(c, kept, bytes, size));
        const double now = get("estimated_error_place_m", 0);
        OK(step(0.13, 0.13));
        const double later = get("estimated_error_place_m", 0), largest = get("estimated_error_largest_place_m", 0);
        OK(fmi2DeSerializeFMUstate(c, bytes, size, &kept));
        OK(fmi2SetFMUstate(c, kept));
        OK(fmi2FreeFMUstate(c, &kept));
        TEST_ASSERT_TRUE(get("estimated_error_place_m", 0) == now && now > 0);
        OK(step(0.13, 0.13));
        TEST_ASSERT_TRUE(get("estimated_error_place_m", 0) == later);
        TEST_ASSERT_TRUE(get("estimated_error_largest_place_m", 0) == largest);
    }
}

/* All that the estimate carries on, as another run would have it; what follows from the plant is prepared again. */
static void every_member_of_an_estimate_comes_back_in_another_instance(void) {
    laconic_estimate *e = &instance()->model.estimate;
    begin(0.05, 0.05);
    apply(2);
    OK(step(0, 0.5));
    FILL(e->zeta);
    FILL(e->travel);
    FILL(e->place_m);
    FILL(e->floor_zeta);
    FILL(e->floor_travel);
    FILL(e->floor_path_m);
    FILL(e->doubt_zeta);
    FILL(e->doubt_travel);
    FILL(e->doubt_place_m);
    FILL(e->largest);
    FILL(e->origin_m);
    FILL(e->extent_m);
    e->unknown = 0x1020304050607080U;
    e->length = 8, e->taken = 5, e->last_length = 7, e->begun = true;
    FILL(e->input);
    fill_state(&e->start);
    fill_state(&e->twin);
    FILL(e->local);
    FILL(e->fading);
    FILL(e->first_path_m);
    FILL(e->forcing.constant);
    FILL(e->forcing.cosine);
    FILL(e->forcing.sine);
    e->forcing.rotates = true;
    fill_slip(&e->twin_slip);
    TEST_ASSERT_EQUAL_size_t(8400 + VEHICLE_BYTES, write()); /* another size is another STATE_VERSION */
    const fmu_model before = instance()->model;
    into_another(fmi2CoSimulation);
    const fmu_model *after = &instance()->model;
    COMES_BACK(estimate);
    COMES_BACK(estimate_error);
    COMES_BACK(estimate_begun);
    COMES_BACK(estimate_window_steps);
}

/* Also before the start, and before the first step, where there is nothing to write but the settings. */
static void an_estimate_that_could_not_be_is_no_state(void) {
    fmi2FMUstate kept = NULL;
    set_flag("estimate_error", 0);
    OK(fmi2DeSerializeFMUstate(c, bytes, write(), &kept));
    instance()->model.estimate_begun = true; /* as in a run that was started anew */
    OK(fmi2DeSerializeFMUstate(c, bytes, write(), &kept));
    instance()->model.estimate_begun = false;
    initialise();
    const size_t size = write();
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &kept));
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(write() > size + 500);
    instance()->model.estimate_window_steps = 0;
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, write(), &kept), "no possible state");
    instance()->model.estimate_window_steps = 16;
    instance()->model.plant.vehicle.mass_kg = 0;
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, write(), &kept), "no possible state");
    OK(fmi2FreeFMUstate(c, &kept));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_error_is_that_of_the_core_s_estimate);
    RUN_TEST(the_estimate_follows_the_steps_that_importers_choose);
    RUN_TEST(a_first_step_that_is_refused_begins_nothing);
    RUN_TEST(a_change_of_the_vehicle_carries_the_error_on);
    RUN_TEST(a_change_before_the_first_step_carries_nothing);
    RUN_TEST(slopes_are_watched_as_samples);
    RUN_TEST(samples_of_wheels_that_are_not_there_do_not_count);
    RUN_TEST(a_start_without_a_step_has_no_estimate_yet);
    RUN_TEST(an_estimate_is_read_when_it_is_asked_for);
    RUN_TEST(a_sampled_step_that_is_refused_is_taken_back);
    RUN_TEST(sensors_and_an_estimate_watch_the_same_steps);
    RUN_TEST(a_refused_step_takes_the_estimate_back);
    RUN_TEST(without_an_estimate_all_is_zero);
    RUN_TEST(model_exchange_has_no_estimate);
    RUN_TEST(a_step_that_the_estimate_refuses_is_not_the_plant_s);
    RUN_TEST(an_estimate_is_kept_in_bytes);
    RUN_TEST(every_member_of_an_estimate_comes_back_in_another_instance);
    RUN_TEST(an_estimate_that_could_not_be_is_no_state);
    return UNITY_END();
}
