/* Tests of kept_step.c: derivatives of the last communication step, beside differences of steps from other starts, and
 * the reasons why a step has none. */
#include "saved_bench.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

static const struct {
    const char *start, *known; /* the start value, and the state or input by which the derivative is */
    uint32_t element;
    double value;
} by[] = {{"start_nu_rad_per_s", "nu_rad_per_s", 1, 0.5},
          {"start_nu_rad_per_s", "nu_rad_per_s", 2, -0.3},
          {"start_nu_rad_per_s", "nu_rad_per_s", 3, 0.8},
          {"start_x_m", "x_m", 0, 1},
          {"start_y_m", "y_m", 0, 2},
          {"start_heading_rad", "heading_rad", 0, 0.7},
          {"voltage_V", "voltage_V", 1, 1},
          {"voltage_V", "voltage_V", 2, 3},
          {"voltage_V", "voltage_V", 4, -2},
          {"axle_torque_Nm", "axle_torque_Nm", 1, 0.1},
          {"axle_torque_Nm", "axle_torque_Nm", 4, -0.2},
          {"body_force_N", "body_force_N", 1, 4},
          {"body_force_N", "body_force_N", 2, -1},
          {"body_moment_Nm", "body_moment_Nm", 0, 0.5},
          {"world_force_N", "world_force_N", 1, 2},
          {"world_force_N", "world_force_N", 2, 1},
          {"world_force_point_m", "world_force_point_m", 1, 1.2},
          {"world_force_point_m", "world_force_point_m", 2, 2.3}};
#define KNOWNS (sizeof by / sizeof by[0])

static const struct {
    const char *name;
    uint32_t element;
} of[] = {{"nu_rad_per_s", 1}, {"nu_rad_per_s", 2},    {"nu_rad_per_s", 3},    {"x_m", 0},
          {"y_m", 0},          {"heading_rad", 0},     {"wheel_angle_rad", 1}, {"wheel_angle_rad", 4},
          {"energy_J", 0},     {"wheel_torque_Nm", 2}, {"wheel_reaction_N", 3}};
#define UNKNOWNS (sizeof of / sizeof of[0])

static void list_unknowns(fmi2ValueReference list[UNKNOWNS]) {
    for (size_t k = 0; k < UNKNOWNS; k++) list[k] = ref(of[k].name, of[k].element);
}

#define STEP_S 0.1

/* One communication step of four internal ones, one start or input changed. */
static void step_from(size_t changed, double change) {
    make(fmi2CoSimulation);
    set("step_s", 0, STEP_S / 4);
    for (size_t k = 0; k < KNOWNS; k++) set(by[k].start, by[k].element, by[k].value + (k == changed ? change : 0));
    initialise();
    OK(step(0, STEP_S));
}

static void a_step_s_derivatives_are_those_of_differences(void) {
    fmi2ValueReference list[UNKNOWNS];
    double found[KNOWNS][UNKNOWNS], side[2][UNKNOWNS];
    const double one = 1, change = 1e-6;
    step_from(KNOWNS, 0);
    list_unknowns(list);
    for (size_t n = 0; n < KNOWNS; n++) {
        const fmi2ValueReference known = ref(by[n].known, by[n].element);
        OK(fmi2GetDirectionalDerivative(c, list, UNKNOWNS, &known, 1, &one, found[n]));
    }
    for (size_t n = 0; n < KNOWNS; n++) {
        for (int k = 0; k < 2; k++) {
            step_from(n, k == 0 ? -change : change);
            OK(fmi2GetReal(c, list, UNKNOWNS, side[k]));
        }
        for (size_t k = 0; k < UNKNOWNS; k++)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e-7 * (1 + fabs(found[n][k])), (side[1][k] - side[0][k]) / (2 * change),
                                              found[n][k], by[n].known);
    }
}

static double of_nu_by_voltage(void) {
    const fmi2ValueReference nu = ref("nu_rad_per_s", 1), voltage = ref("voltage_V", 1);
    const double one = 1;
    double found = NOT_A_NUMBER;
    OK(fmi2GetDirectionalDerivative(c, &nu, 1, &voltage, 1, &one, &found));
    return found;
}

/* A motion of the body along itself is linear, so that each of equal steps has the derivatives of the first. */
static void derivatives_are_those_of_the_last_step_alone(void) {
    set("step_s", 0, STEP_S / 4);
    initialise();
    OK(step(0, STEP_S));
    const double first = of_nu_by_voltage();
    TEST_ASSERT_TRUE(first > 1e-3);
    for (int n = 1; n < 5; n++) {
        OK(step(n * STEP_S, STEP_S));
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, first, of_nu_by_voltage());
    }
    OK(step(5 * STEP_S, STEP_S / 4));
    TEST_ASSERT_TRUE(of_nu_by_voltage() < 0.5 * first);
}

/* As many as a vehicle may have: the last one's voltage moves the last one's angle, whose start shifts its end. */
static void sixteen_wheels_have_derivatives(void) {
    laconic_vehicle *v = &instance()->model.vehicle;
    for (int k = 4; k < LACONIC_MAX_WHEELS; k++) {
        v->wheel[k] = v->wheel[k % 4];
        v->wheel[k].y_m *= 1 + 0.1 * k;
    }
    v->wheel_count = LACONIC_MAX_WHEELS;
    set("step_s", 0, STEP_S / 4);
    initialise();
    OK(step(0, STEP_S));
    const fmi2ValueReference angle = ref("wheel_angle_rad", 16), torque = ref("wheel_torque_Nm", 16),
                             known[2] = {ref("wheel_angle_rad", 16), ref("voltage_V", 16)};
    const double seeds[2] = {1, 0}, one = 1;
    double found, by_volt, of_torque;
    OK(fmi2GetDirectionalDerivative(c, &angle, 1, known, 2, seeds, &found));
    OK(fmi2GetDirectionalDerivative(c, &angle, 1, &known[1], 1, &one, &by_volt));
    OK(fmi2GetDirectionalDerivative(c, &torque, 1, &known[1], 1, &one, &of_torque));
    TEST_ASSERT_TRUE(found == 1 && by_volt > 1e-6 && of_torque > 1e-3);
}

/* A wheel's angle at the start shifts that at the end; seeds of several knowns add up. */
static void angles_shift_and_seeds_add_up(void) {
    const fmi2ValueReference angle = ref("wheel_angle_rad", 2),
                             known[2] = {ref("wheel_angle_rad", 2), ref("voltage_V", 2)};
    double first, second, both;
    const double one = 1, seeds[2] = {2, -3};
    step_from(KNOWNS, 0);
    OK(fmi2GetDirectionalDerivative(c, &angle, 1, &known[0], 1, &one, &first));
    OK(fmi2GetDirectionalDerivative(c, &angle, 1, &known[1], 1, &one, &second));
    OK(fmi2GetDirectionalDerivative(c, &angle, 1, known, 2, seeds, &both));
    TEST_ASSERT_TRUE(first == 1 && fabs(second) > 1e-6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2 - 3 * second, both);
}

/* Outputs are those with the input that was held, whatever the importer has set since; and its input stays. */
static void an_input_that_was_set_since_counts_for_the_next_step(void) {
    const fmi2ValueReference energy = ref("energy_J", 0), point = ref("world_force_point_m", 1),
                             reaction = ref("wheel_reaction_N", 1), heading = ref("heading_rad", 0);
    const double one = 1;
    double before[2], after[2], by_heading[2];
    step_from(KNOWNS, 0);
    OK(fmi2GetDirectionalDerivative(c, &energy, 1, &point, 1, &one, &before[0]));
    OK(fmi2GetDirectionalDerivative(c, &reaction, 1, &heading, 1, &one, &by_heading[0]));
    OK(fmi2GetReal(c, &reaction, 1, &before[1]));
    set("world_force_N", 2, 50);
    OK(fmi2GetDirectionalDerivative(c, &energy, 1, &point, 1, &one, &after[0]));
    OK(fmi2GetDirectionalDerivative(c, &reaction, 1, &heading, 1, &one, &by_heading[1]));
    OK(fmi2GetReal(c, &reaction, 1, &after[1]));
    TEST_ASSERT_TRUE(before[0] == after[0] && before[0] != 0 && by_heading[0] == by_heading[1]);
    TEST_ASSERT_TRUE(before[1] != after[1] && get("world_force_N", 2) == 50);
}

/* Also where outputs were read with the new input before the derivatives were asked for. */
static void reactions_to_a_new_input_are_not_those_of_the_step(void) {
    const fmi2ValueReference margin = ref("no_slip_margin_N", 0), known = ref("voltage_V", 1);
    const double one = 1;
    double before, after;
    set("com_z_m", 0, 0.1);
    step_from(KNOWNS, 0);
    OK(fmi2GetDirectionalDerivative(c, &margin, 1, &known, 1, &one, &before));
    for (int side = -1; side <= 1; side += 2) {
        set("body_force_N", 1, 60 * side);
        set("voltage_V", 1, -20 * side);
        TEST_ASSERT_TRUE(get("wheel_reaction_N", 1) != 0);
        OK(fmi2GetDirectionalDerivative(c, &margin, 1, &known, 1, &one, &after));
        TEST_ASSERT_TRUE(before == after && before != 0);
    }
}

/* Of a force that does not act: at rest and unrotated world and body have the same axes. */
static void a_force_on_the_world_s_axes_has_derivatives_where_none_acts(void) {
    const fmi2ValueReference nu = ref("nu_rad_per_s", 0), x = ref("x_m", 0);
    const double one = 1;
    initialise();
    OK(step(0, STEP_S));
    for (uint32_t k = 1; k <= 2; k++) {
        const fmi2ValueReference known[2] = {ref("body_force_N", k), ref("world_force_N", k)};
        const fmi2ValueReference of_nu = nu << FMU_ELEMENT_SHIFT | k;
        double found[2][2];
        for (int n = 0; n < 2; n++) {
            OK(fmi2GetDirectionalDerivative(c, &of_nu, 1, &known[n], 1, &one, &found[n][0]));
            OK(fmi2GetDirectionalDerivative(c, &x, 1, &known[n], 1, &one, &found[n][1]));
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, found[0][0], found[1][0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, found[0][1], found[1][1]);
        TEST_ASSERT_TRUE(found[0][0] > 1e-3 && (k == 2 || found[0][1] > 1e-5));
    }
}

static double by_voltage(void) {
    const fmi2ValueReference x = ref("x_m", 0), voltage = ref("voltage_V", 2);
    const double one = 1;
    double found = NOT_A_NUMBER;
    OK(fmi2GetDirectionalDerivative(c, &x, 1, &voltage, 1, &one, &found));
    return found;
}

static fmi2Status refused_by_voltage(void) {
    const fmi2ValueReference x = ref("x_m", 0), voltage = ref("voltage_V", 2);
    const double one = 1;
    double found = 7;
    const fmi2Status status = fmi2GetDirectionalDerivative(c, &x, 1, &voltage, 1, &one, &found);
    TEST_ASSERT_TRUE(found == 7);
    return status;
}

static void before_a_step_derivatives_are_those_of_the_instant(void) {
    const fmi2ValueReference rate = ref("der(nu_rad_per_s)", 1), state = ref("nu_rad_per_s", 1),
                             voltage = ref("voltage_V", 1);
    const double one = 1;
    double found[2], exchange[2];
    for (int kind = 0; kind < 2; kind++) {
        make(kind == 0 ? fmi2CoSimulation : fmi2ModelExchange);
        initialise();
        OK(fmi2GetDirectionalDerivative(c, &rate, 1, &state, 1, &one, kind == 0 ? &found[0] : &exchange[0]));
        OK(fmi2GetDirectionalDerivative(c, &rate, 1, &voltage, 1, &one, kind == 0 ? &found[1] : &exchange[1]));
    }
    TEST_ASSERT_TRUE(found[0] == exchange[0] && found[1] == exchange[1] && found[0] < -1e-3 && found[1] > 1e-3);
    make(fmi2CoSimulation);
    initialise();
    TEST_ASSERT_TRUE(by_voltage() == 0);
    OK(step(0, STEP_S));
    TEST_ASSERT_TRUE(by_voltage() != 0);
}

static void a_remainder_and_a_refused_step_leave_the_last_one(void) {
    set_integer("method", 0, 1);
    initialise();
    set("voltage_V", 2, 3);
    OK(step(0, 0.01));
    OK(step(0.01, 0.01));
    const double found = by_voltage();
    TEST_ASSERT_TRUE(found != 0);
    OK(step(0.02, 1e-9));
    TEST_ASSERT_TRUE(by_voltage() == found);
    ASSERT_DISCARDED(step(0.02, 100), "is refused");
    TEST_ASSERT_TRUE(by_voltage() == found);
    OK(step(0.02, 0.02));
    const double longer = by_voltage();
    TEST_ASSERT_TRUE(fabs(longer) > 2 * fabs(found));
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    ASSERT_DISCARDED(step(0.04, 0.01), "is refused");
    TEST_ASSERT_TRUE(by_voltage() == longer);
    instance()->model.has_jacobian = false; /* as if it had not been asked for before the other step */
    TEST_ASSERT_TRUE(by_voltage() == longer);
    OK(fmi2Terminate(c));
    TEST_ASSERT_TRUE(by_voltage() == longer);
}

static void a_step_with_slopes_has_none(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    const double slope = 3;
    initialise();
    OK(step(0, STEP_S));
    OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
    OK(step(STEP_S, STEP_S));
    ASSERT_REFUSED(refused_by_voltage(), "the last communication step has no derivatives: its inputs had slopes");
    OK(step(2 * STEP_S, STEP_S));
    TEST_ASSERT_TRUE(by_voltage() != 0);
}

static void after_a_change_of_the_vehicle_there_are_none(void) {
    initialise();
    set("motor_gain_Nm_per_V", 0, 0.3);
    TEST_ASSERT_TRUE(by_voltage() == 0); /* no step yet: those of the instant */
    OK(step(0, STEP_S));
    TEST_ASSERT_TRUE(by_voltage() != 0);
    set("motor_gain_Nm_per_V", 0, 0.4);
    ASSERT_REFUSED(refused_by_voltage(), "the vehicle has changed since; take another step first");
    OK(step(STEP_S, STEP_S));
    TEST_ASSERT_TRUE(by_voltage() != 0);
}

static void friction_has_no_derivatives(void) {
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    OK(step(0, STEP_S));
    ASSERT_REFUSED(refused_by_voltage(), "limits of its drive has no partial derivatives");
}

/* What only bytes could bring that nobody has run: a start or a length that the core refuses. */
static void a_step_that_was_never_taken_has_none(void) {
    fmu_model *model = &instance()->model;
    initialise();
    OK(step(0, STEP_S));
    const fmu_model good = *model;
    model->last.state.zeta[0].value = NOT_A_NUMBER;
    ASSERT_REFUSED(refused_by_voltage(), "the last communication step has no derivatives: the core refuses them");
    *model = good;
    model->last.step_s = NOT_A_NUMBER;
    ASSERT_REFUSED(refused_by_voltage(), "the core refuses them");
    *model = good;
    TEST_ASSERT_TRUE(by_voltage() != 0);
}

static void a_step_is_kept_in_bytes(void) {
    initialise();
    set("voltage_V", 2, 3);
    OK(step(0, STEP_S));
    OK(step(STEP_S, STEP_S));
    const double found = by_voltage();
    const size_t size = write();
    OK(step(2 * STEP_S, 3 * STEP_S));
    TEST_ASSERT_TRUE(by_voltage() != found);
    OK(read(size));
    TEST_ASSERT_TRUE(by_voltage() == found);
}

static void every_member_of_a_step_comes_back_in_another_instance(void) {
    fmu_model *model = &instance()->model;
    initialise();
    OK(step(0, STEP_S));
    (void)by_voltage();
    model->last.kept = FMU_STEP_CHANGED;
    fill_state(&model->last.state);
    FILL(model->last.input);
    FILL(model->last.step_s);
    model->last.steps = 0x1020304050607080U;
    TEST_ASSERT_EQUAL_size_t(6528 + VEHICLE_BYTES, write()); /* another size is another STATE_VERSION */
    const fmu_model before = *model;
    into_another(fmi2CoSimulation);
    const fmu_model *after = &instance()->model;
    COMES_BACK(last);
    TEST_ASSERT_TRUE(before.has_jacobian && !after->has_jacobian);
    instance()->model.last.kept = FMU_STEP_KINDS;
    ASSERT_REFUSED(read(write()), "no possible state");
}

/* ------------------------------------------------------------------------------------------- by FMI 3 -- */

static fmi3Instance third;
static bool touches;

static void between(fmi3InstanceEnvironment e, fmi3Float64 time, fmi3Boolean set_requested, fmi3Boolean get_allowed,
                    fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *early, fmi3Float64 *early_time) {
    const fmi3ValueReference voltage = ref("voltage_V", 1);
    const double volt = 3;
    (void)e, (void)time, (void)set_requested, (void)get_allowed, (void)finished, (void)can_return, (void)early_time;
    if (touches) OK(fmi3SetFloat64(third, &voltage, 1, &volt, 1));
    *early = false;
}

static fmi3Status third_by_voltage(double *found) {
    const fmi3ValueReference x = ref("x_m", 0), voltage = ref("voltage_V", 2);
    const double one = 1;
    return fmi3GetDirectionalDerivative(third, &x, 1, &voltage, 1, &one, 1, found, 1);
}

static void a_step_whose_inputs_were_set_within_has_none(void) {
    double found = 7;
    third =
        fmi3InstantiateCoSimulation("one", fmu_token_3, NULL, false, true, false, false, NULL, 0, NULL, log_3, between);
    OK(fmi3EnterInitializationMode(third, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(third));
    for (int k = 0; k < 2; k++) {
        touches = k == 1;
        OK(fmi3DoStep(third, k * STEP_S, STEP_S, true, NULL, NULL, NULL, NULL));
        if (!touches) OK(third_by_voltage(&found));
    }
    TEST_ASSERT_TRUE(found != 7 && found != 0);
    ASSERT_REFUSED(third_by_voltage(&found), "inputs were set within it, and derivatives are by inputs that are held");
    fmi3FreeInstance(third);
}

static void in_event_mode_derivatives_are_those_of_the_instant(void) {
    double found = 7;
    third = make_3(true);
    OK(fmi3EnterInitializationMode(third, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(third));
    OK(fmi3EnterStepMode(third));
    OK(fmi3DoStep(third, 0, STEP_S, true, NULL, NULL, NULL, NULL));
    OK(third_by_voltage(&found));
    TEST_ASSERT_TRUE(found != 0);
    OK(fmi3EnterEventMode(third));
    OK(third_by_voltage(&found));
    TEST_ASSERT_TRUE(found == 0);
    fmi3FreeInstance(third);
}

static void terminated_model_exchange_is_at_its_instant(void) {
    make(fmi2ModelExchange);
    initialise();
    OK(fmi2Terminate(c));
    TEST_ASSERT_TRUE(by_voltage() == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_step_s_derivatives_are_those_of_differences);
    RUN_TEST(derivatives_are_those_of_the_last_step_alone);
    RUN_TEST(sixteen_wheels_have_derivatives);
    RUN_TEST(angles_shift_and_seeds_add_up);
    RUN_TEST(an_input_that_was_set_since_counts_for_the_next_step);
    RUN_TEST(reactions_to_a_new_input_are_not_those_of_the_step);
    RUN_TEST(a_force_on_the_world_s_axes_has_derivatives_where_none_acts);
    RUN_TEST(before_a_step_derivatives_are_those_of_the_instant);
    RUN_TEST(a_remainder_and_a_refused_step_leave_the_last_one);
    RUN_TEST(a_step_with_slopes_has_none);
    RUN_TEST(after_a_change_of_the_vehicle_there_are_none);
    RUN_TEST(friction_has_no_derivatives);
    RUN_TEST(a_step_that_was_never_taken_has_none);
    RUN_TEST(a_step_is_kept_in_bytes);
    RUN_TEST(every_member_of_a_step_comes_back_in_another_instance);
    RUN_TEST(a_step_whose_inputs_were_set_within_has_none);
    RUN_TEST(in_event_mode_derivatives_are_those_of_the_instant);
    RUN_TEST(terminated_model_exchange_is_at_its_instant);
    return UNITY_END();
}
