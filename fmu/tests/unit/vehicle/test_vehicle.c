/* Tests of vehicle/model.c and the parts beside it: what is refused at the start and in a run, and what a change
 * carries over. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

/* ------------------------------------------------------------------------------------ start and change -- */

static void a_method_that_is_none_and_a_negative_step_cannot_start(void) {
    instance()->model.method = 99;
    ASSERT_REFUSED(initialise_refused(), "this vehicle cannot start: method: there is no such method");
    instance()->model.method = 0;
    instance()->model.step_s = -0.1;
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "this vehicle cannot start: step_s: -0.1 is not positive");
    instance()->model.step_s = 0;
    OK(fmi2ExitInitializationMode(c));
}

static void a_refusal_names_the_element(void) {
    set("wheel_x_m", 3, 1e200);
    ASSERT_REFUSED(initialise_refused(), "this vehicle cannot start: ");
    set("wheel_x_m", 3, 0.2);
    set("roller_rad", 3, 0);
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "cannot start: roller_rad[3]: with 0 rad the roller axis lies");
    set("roller_rad", 1, 0);
    ASSERT_REFUSED(fmi2ExitInitializationMode(c), "cannot start: roller_rad[1]: with 0 rad the roller axis lies");
}

static void wheels_that_prevent_every_motion_are_refused(void) {
    set("friction_coefficient", 0, 0);
    for (uint32_t k = 1; k <= 4; k++) set_flag("wheel_locked", k);
    ASSERT_REFUSED(initialise_refused(),
                   "this vehicle cannot start: wheel_kind[3]: fixed and locked wheels prevent every motion");
}

/* With an explicit method no step that the importer chooses later is refused at the start; one of its own is. */
static void an_own_step_is_checked_at_the_start(void) {
    set_integer("method", 0, 1);
    set("step_s", 0, 100);
    ASSERT_REFUSED(initialise_refused(), "step_s: 100 s is unstable with this method");
    set("step_s", 0, 0);
    OK(fmi2ExitInitializationMode(c));
}

/* Until a step is known a change of the vehicle is prepared for a method that takes every step. */
static void a_change_before_the_first_step_is_for_any_step(void) {
    set_integer("method", 0, 1);
    initialise();
    set("motor_damping_Nms", 0, 1e6); /* an explicit step of 1 s would be unstable */
    set("voltage_V", 1, 2);
    TEST_ASSERT_TRUE(get("x_m", 0) == 0);
    ASSERT_DISCARDED(step(0, 1), "is unstable with this method because the motors damp too fast");
    OK(step(0, 1e-8));
    set("motor_damping_Nms", 0, 1e14);
    ASSERT_REFUSED(step(1e-8, 1e-8), "the changed vehicle is refused: step_s: 1e-8 s is unstable with this method");
}

static void a_limited_drive_changes_before_its_first_step(void) {
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    set("supply_V", 0, 6);
    set("voltage_V", 1, 24);
    OK(step(0, 0.01));
    TEST_ASSERT_TRUE(get("drive_limit", 1) > 0 && get("supply_voltage_V", 0) == 6);
}

/* What has no motor is looked for when the model starts anew, not before. */
static void a_wheel_without_a_motor_is_told_of_once_the_model_has_started(void) {
    set_flag("wheel_undriven", 2);
    OK(fmi2EnterInitializationMode(c));
    TEST_ASSERT_TRUE(get("x_m", 0) == 0);
    set("mass_kg", 0, 20);
    log_clear();
    set("voltage_V", 2, 5);
    TEST_ASSERT_EQUAL_INT(0, lines);
    OK(fmi2ExitInitializationMode(c));
    ASSERT_LOGGED("voltage_V[2]: 5 V has no effect");
}

static void model_exchange_keeps_its_states_in_a_change(void) {
    double state[10], found[10], fresh[10];
    fmi2EventInfo info;
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int k = 0; k < 10; k++) state[k] = 0.1 * k - 0.3;
    OK(fmi2SetContinuousStates(c, state, 10));
    OK(fmi2GetDerivatives(c, fresh, 10));
    OK(fmi2EnterEventMode(c));
    set("motor_damping_Nms", 0, 5);
    OK(fmi2NewDiscreteStates(c, &info));
    TEST_ASSERT_TRUE(info.valuesOfContinuousStatesChanged);
    OK(fmi2GetContinuousStates(c, found, 10));
    for (int k = 3; k < 10; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-13, state[k], found[k]);
    OK(fmi2GetDerivatives(c, found, 10));
    TEST_ASSERT_TRUE(fabs(found[0]) > 1.5 * fabs(fresh[0]));
    set("ground_friction_coefficient", 0, 0.3);
    set("friction_coefficient", 0, 0);
    ASSERT_REFUSED(fmi2NewDiscreteStates(c, &info), "has no states for wheels that slip");
    OK(fmi2EnterContinuousTimeMode(c));
    ASSERT_REFUSED(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL), "has no states for wheels that slip");
    ASSERT_REFUSED(fmi2GetDerivatives(c, found, 10), "has no states for wheels that slip");
    ASSERT_REFUSED(fmi2GetContinuousStates(c, found, 10), "has no states for wheels that slip");
    const fmi2ValueReference x = ref("x_m", 0);
    ASSERT_REFUSED(fmi2SetReal(c, &x, 1, state), "has no states for wheels that slip");
}

static void a_watched_vehicle_is_watched_on_after_a_change(void) {
    set("step_s", 0, 0.01);
    set_integer("encoder_counts_per_turn", 1, 4096);
    initialise();
    set("voltage_V", 1, 6);
    OK(step(0, 0.2));
    const double count = get("encoder_count", 1);
    TEST_ASSERT_TRUE(count != 0);
    set("motor_gain_Nm_per_V", 0, 0.3);
    TEST_ASSERT_TRUE(get("encoder_count", 1) == count);
    TEST_ASSERT_TRUE(get("imu_yaw_rate_rad_per_s", 0) == 0); /* it has none */
    OK(step(0.2, 0.2));
    TEST_ASSERT_TRUE(get("encoder_count", 1) != count);
}

/* Ground that gets friction within the run; before, nothing watched. */
static void ground_may_get_friction_in_a_run(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    initialise();
    OK(step(0, 0.02));
    set("ground_friction_coefficient", 0, 0.4);
    set("voltage_V", 1, 6);
    OK(step(0.02, 0.02));
    TEST_ASSERT_TRUE(isfinite(get("acceleration_body_m_per_s2", 1)) && instance()->model.watched);
    TEST_ASSERT_TRUE(get("slip_loss_J", 0) >= 0 && get("energy_J", 0) > 0);
    set("ground_friction_coefficient", 0, 0);
    OK(step(0.04, 0.02));
    TEST_ASSERT_FALSE(instance()->model.watched);
}

/* ------------------------------------------------------------------------------------------ steps -- */

static void a_sloped_step_that_is_refused_is_taken_back(void) {
    const fmi2ValueReference force = ref("body_force_N", 1);
    const fmi2Integer first = 1;
    const double slope = 1.7e308;
    for (int watched = 0; watched < 2; watched++) {
        make(fmi2CoSimulation);
        set("friction_coefficient", 0, 0);
        set("step_s", 0, 1);
        if (watched) set_integer("encoder_counts_per_turn", 1, 4096);
        initialise();
        set("body_force_N", 1, 1e308);
        set("body_force_N", 2, 1e308);
        OK(fmi2SetRealInputDerivatives(c, &force, 1, &first, &slope));
        ASSERT_DISCARDED(step(0, 3), "the step at 0 s is refused: ");
        TEST_ASSERT_TRUE(get("x_m", 0) == 0 && get("body_force_N", 1) == 1e308 && get("time", 0) == 0);
    }
}

/* A number of internal steps is counted up to 9e15, which doubles still tell apart. */
static void a_step_of_more_internal_ones_than_can_be_counted_is_refused(void) {
    set("step_s", 0, 1);
    initialise();
    ASSERT_REFUSED(step(0, 9e15), "cannot be taken in internal steps of 1 s (step_s): set another step_s");
    ASSERT_REFUSED(step(0, 9.05e15), "cannot be taken in internal steps of 1 s");
    ASSERT_REFUSED(step(0, 2.497), "is no whole number of internal steps of 1 s (step_s); nearest that is: 2 s");
    ASSERT_REFUSED(step(0, 2.503), "is no whole number of internal steps of 1 s (step_s); nearest that is: 3 s");
}

static void a_single_step_that_is_refused_tells_its_reason(void) {
    set("friction_coefficient", 0, 0);
    set("step_s", 0, 0.01);
    initialise();
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    ASSERT_DISCARDED(step(0, 0.01), "the step at 0 s is refused: step_s: a result leaves the range");
    TEST_ASSERT_TRUE(get("x_m", 0) == 0 && get("imu_yaw_rate_rad_per_s", 0) == 0 && get("encoder_count", 1) == 0);
}

/* A state that was kept before the model had started, in a mode that it had later: nobody but an attacker has one. */
static void a_step_starts_a_model_that_must_be_started(void) {
    initialise();
    OK(step(0, 0.1));
    instance()->model.start_needed = true;
    OK(step(0.1, 0.1));
    TEST_ASSERT_FALSE(instance()->model.start_needed);
}

static void a_refused_step_with_friction_is_taken_back(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    initialise();
    set("voltage_V", 1, 8);
    OK(step(0, 0.1));
    const double loss = get("slip_loss_J", 0), angle = get("wheel_angle_rad", 1);
    set("body_force_N", 1, 1.7e308);
    ASSERT_DISCARDED(step(0.1, 0.03), "is refused: ");
    TEST_ASSERT_TRUE(get("slip_loss_J", 0) == loss && get("wheel_angle_rad", 1) == angle && angle != 0);
}

/* -------------------------------------------------------------------------------- Model Exchange -- */

static void rates_beyond_the_range_are_refused(void) {
    double rate[10];
    make(fmi2ModelExchange);
    set("motor_gain_Nm_per_V", 0, 100);
    initialise();
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 1.7e308);
    rate[0] = 7;
    ASSERT_REFUSED(fmi2GetDerivatives(c, rate, 10), "the derivative of continuous state 1 of 10 leaves the range");
    TEST_ASSERT_TRUE(rate[0] == 7);
    ASSERT_REFUSED(fmi2GetDerivatives(c, rate, 9), "there are 10 continuous states, not 9");
    ASSERT_REFUSED(fmi2GetNominalsOfContinuousStates(c, rate, 11), "there are 10 continuous states, not 11");
}

/* A wheel that slips, by its own torque alone: the last of the states. */
static void a_rate_beyond_the_range_is_refused_by_its_number(void) {
    double rate[14];
    with_wheel_states();
    initialise();
    OK(fmi2GetDerivatives(c, rate, 14));
    set("axle_torque_Nm", 4, 1.7e308);
    ASSERT_REFUSED(fmi2GetDerivatives(c, rate, 14), "the derivative of continuous state 14 of 14 leaves the range");
}

static void states_lie_within_what_doubles_tell_apart(void) {
    double state[10] = {0};
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    state[4] = 1e18;
    OK(fmi2SetContinuousStates(c, state, 10));
    state[4] = -1e18;
    OK(fmi2SetContinuousStates(c, state, 10));
    for (int k = 0; k < 10; k++) {
        char told[80];
        double one[10] = {0};
        one[k] = 1.1e18;
        snprintf(told, sizeof told, "continuous state %d of 10 cannot be 1.1e+18: take a smaller step", k + 1);
        ASSERT_DISCARDED(fmi2SetContinuousStates(c, one, 10), told);
    }
    state[4] = -1.1e18;
    ASSERT_DISCARDED(fmi2SetContinuousStates(c, state, 10), "continuous state 5 of 10 cannot be -1.1e+18");
    state[4] = 1.1e18;
    ASSERT_DISCARDED(fmi2SetContinuousStates(c, state, 10), "continuous state 5 of 10 cannot be 1.1e+18");
    TEST_ASSERT_TRUE(get("y_m", 0) == -1e18);
    ASSERT_REFUSED(fmi2SetContinuousStates(c, state, 9), "there are 10 continuous states, not 9");
}

static void nominals_are_those_of_the_description(void) {
    double nominal[14];
    with_wheel_states();
    initialise();
    OK(fmi2GetNominalsOfContinuousStates(c, nominal, 14));
    for (int k = 0; k < 14; k++) TEST_ASSERT_TRUE(nominal[k] == (k < 3 || k > 5 ? 10 : 1));
}

/* On ground with friction nothing is watched in Model Exchange but what lifts; elsewhere only with a coefficient. */
static void a_completed_step_looks_for_warnings_only_where_there_are_some(void) {
    make(fmi2ModelExchange);
    set("friction_coefficient", 0, 0);
    set("com_z_m", 0, 0.5);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    set("body_force_N", 1, 2000);
    log_clear();
    OK(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(0, lines);
}

/* Else one group's numbers would be computed, or become stale, with another's. */
static void each_group_is_a_bit_of_its_own(void) {
    static const uint32_t groups[] = {FMU_GROUP_STATE,   FMU_GROUP_MOTION,  FMU_GROUP_ANGLES,   FMU_GROUP_VELOCITY,
                                      FMU_GROUP_SPEEDS,  FMU_GROUP_TORQUES, FMU_GROUP_GROUND,   FMU_GROUP_ENERGY,
                                      FMU_GROUP_RATES,   FMU_GROUP_POSE,    FMU_GROUP_FRICTION, FMU_GROUP_ACCELERATION,
                                      FMU_GROUP_SENSORS, FMU_GROUP_ESTIMATE};
    uint32_t all = 0;
    for (size_t k = 0; k < sizeof groups / sizeof groups[0]; k++) {
        TEST_ASSERT_TRUE(groups[k] != 0 && (groups[k] & (groups[k] - 1)) == 0);
        TEST_ASSERT_EQUAL_UINT32(0, all & groups[k]);
        all |= groups[k];
    }
    TEST_ASSERT_EQUAL_UINT32(FMU_GROUPS_ALL, all);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_method_that_is_none_and_a_negative_step_cannot_start);
    RUN_TEST(a_refusal_names_the_element);
    RUN_TEST(wheels_that_prevent_every_motion_are_refused);
    RUN_TEST(an_own_step_is_checked_at_the_start);
    RUN_TEST(a_change_before_the_first_step_is_for_any_step);
    RUN_TEST(a_limited_drive_changes_before_its_first_step);
    RUN_TEST(a_wheel_without_a_motor_is_told_of_once_the_model_has_started);
    RUN_TEST(model_exchange_keeps_its_states_in_a_change);
    RUN_TEST(a_watched_vehicle_is_watched_on_after_a_change);
    RUN_TEST(ground_may_get_friction_in_a_run);
    RUN_TEST(a_sloped_step_that_is_refused_is_taken_back);
    RUN_TEST(a_step_of_more_internal_ones_than_can_be_counted_is_refused);
    RUN_TEST(a_single_step_that_is_refused_tells_its_reason);
    RUN_TEST(a_step_starts_a_model_that_must_be_started);
    RUN_TEST(a_refused_step_with_friction_is_taken_back);
    RUN_TEST(rates_beyond_the_range_are_refused);
    RUN_TEST(a_rate_beyond_the_range_is_refused_by_its_number);
    RUN_TEST(states_lie_within_what_doubles_tell_apart);
    RUN_TEST(nominals_are_those_of_the_description);
    RUN_TEST(a_completed_step_looks_for_warnings_only_where_there_are_some);
    RUN_TEST(each_group_is_a_bit_of_its_own);
    return UNITY_END();
}
