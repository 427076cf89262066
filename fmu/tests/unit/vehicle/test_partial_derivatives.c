/* Tests of partial_derivatives.c and tangent.c: what is known and unknown in which mode, every derivative beside a
 * difference, and lists that do not fit. */
#include "fmi2_bench.h"
#include "model_interface.h"

#define STATES (3 + 3 + 4)

static const double here[STATES] = {0.5, -0.3, 0.2, 1, 2, 0.7, 0.1, 0.2, 0.3, 0.4};

void setUp(void) { begin_test(fmi2ModelExchange); }
void tearDown(void) { end_test(); }

static void at_here(void) {
    set_integer("support_count", 0, 1);
    set("support_x_m", 1, 0.3);
    set("com_z_m", 0, 0.2);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    OK(fmi2SetContinuousStates(c, here, STATES));
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 2.5 * k - 4);
    set("body_force_N", 1, 3);
    set("body_moment_Nm", 0, -0.5);
    set("world_force_N", 1, 2);
    set("world_force_N", 2, -1);
    set("world_force_point_m", 1, 0.3);
    set("world_force_point_m", 2, 1.3);
}

/* Every output and rate, with the number of its elements. */
static const struct {
    const char *name;
    uint32_t count;
} unknowns[] = {{"x_m", 1},
                {"y_m", 1},
                {"heading_rad", 1},
                {"nu_rad_per_s", 3},
                {"origin_x_m", 1},
                {"origin_y_m", 1},
                {"energy_J", 1},
                {"velocity_body_m_per_s", 2},
                {"wheel_angle_rad", 4},
                {"wheel_speed_rad_per_s", 4},
                {"wheel_torque_Nm", 4},
                {"wheel_reaction_N", 4},
                {"yaw_rate_rad_per_s", 1},
                {"acceleration_body_m_per_s2", 2},
                {"der(nu_rad_per_s)", 3},
                {"der(x_m)", 1},
                {"der(y_m)", 1},
                {"der(heading_rad)", 1},
                {"der(wheel_angle_rad)", 4},
                {"wheel_lateral_N", 4},
                {"heading_wrapped_rad", 1},
                {"no_slip_margin_N", 1},
                {"wheel_load_N", 4},
                {"support_load_N", 4}};

#define UNKNOWNS 54U

static uint32_t list_unknowns(fmi2ValueReference list[UNKNOWNS]) {
    uint32_t used = 0;
    for (size_t k = 0; k < sizeof unknowns / sizeof unknowns[0]; k++)
        for (uint32_t i = 1; i <= unknowns[k].count; i++)
            list[used++] = ref(unknowns[k].name, unknowns[k].count == 1 ? 0 : i);
    TEST_ASSERT_EQUAL_UINT32(UNKNOWNS, used);
    return used;
}

static const struct {
    const char *name;
    uint32_t element;
} knowns[] = {{"nu_rad_per_s", 1},
              {"nu_rad_per_s", 2},
              {"nu_rad_per_s", 3},
              {"x_m", 0},
              {"y_m", 0},
              {"heading_rad", 0},
              {"wheel_angle_rad", 2},
              {"voltage_V", 3},
              {"axle_torque_Nm", 2},
              {"body_force_N", 1},
              {"body_force_N", 2},
              {"body_moment_Nm", 0},
              {"world_force_N", 1},
              {"world_force_N", 2},
              {"world_force_point_m", 1},
              {"world_force_point_m", 2}};

static void every_derivative_is_that_of_a_difference(void) {
    fmi2ValueReference list[UNKNOWNS];
    double found[UNKNOWNS], side[2][UNKNOWNS];
    const double one = 1, by = 1e-6;
    at_here();
    list_unknowns(list);
    for (size_t n = 0; n < sizeof knowns / sizeof knowns[0]; n++) {
        const fmi2ValueReference known = ref(knowns[n].name, knowns[n].element);
        const double at = get(knowns[n].name, knowns[n].element);
        OK(fmi2GetDirectionalDerivative(c, list, UNKNOWNS, &known, 1, &one, found));
        for (int k = 0; k < 2; k++) {
            set(knowns[n].name, knowns[n].element, at + (k == 0 ? -by : by));
            OK(fmi2GetReal(c, list, UNKNOWNS, side[k]));
        }
        set(knowns[n].name, knowns[n].element, at);
        for (uint32_t k = 0; k < UNKNOWNS; k++)
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e-7 + 2e-7 * fabs(found[k]), (side[1][k] - side[0][k]) / (2 * by),
                                              found[k], knowns[n].name);
    }
}

/* In initialization mode also the start values of the states; nothing depends on the time. */
static void what_is_known_depends_on_the_mode(void) {
    const fmi2ValueReference rate = ref("der(nu_rad_per_s)", 1), start = ref("start_nu_rad_per_s", 1),
                             time = ref("time", 0), mass = ref("mass_kg", 0);
    double seed = 1, found = 7;
    OK(fmi2EnterInitializationMode(c));
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &rate, 1, &mass, 1, &seed, &found),
                   "mass_kg is neither an input nor a continuous state: no derivative with respect to it");
    const fmi2ValueReference energy = ref("energy_J", 0); /* it has derivatives, but nothing has one by it */
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &rate, 1, &energy, 1, &seed, &found),
                   "energy_J is neither an input");
    OK(fmi2GetDirectionalDerivative(c, &rate, 1, &start, 1, &seed, &found));
    const double by_start = found;
    OK(fmi2GetDirectionalDerivative(c, &rate, 1, &time, 1, &seed, &found));
    TEST_ASSERT_TRUE(found == 0);
    OK(fmi2ExitInitializationMode(c));
    const fmi2ValueReference state = ref("nu_rad_per_s", 1);
    OK(fmi2GetDirectionalDerivative(c, &rate, 1, &state, 1, &seed, &found));
    TEST_ASSERT_TRUE(found == by_start && found < -1e-3);
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &rate, 1, &start, 1, &seed, &found),
                   "start_nu_rad_per_s is neither an input nor a continuous state");
}

static void what_is_unknown_is_computed_and_has_derivatives(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1), start = ref("start_nu_rad_per_s", 1),
                             count = ref("supply_energy_J", 0);
    double seed = 1, found = 7;
    OK(fmi2EnterInitializationMode(c));
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &voltage, 1, &voltage, 1, &seed, &found),
                   "voltage_V is neither an output nor a derivative: it has no partial derivatives");
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &start, 1, &voltage, 1, &seed, &found), "is neither an output");
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &count, 1, &voltage, 1, &seed, &found), "is neither an output");
}

static void seeds_of_one_known_that_is_named_twice_add_up(void) {
    const fmi2ValueReference rate = ref("der(nu_rad_per_s)", 1);
    const fmi2ValueReference twice[2] = {ref("voltage_V", 1), ref("voltage_V", 1)};
    const double seeds[2] = {2, 3}, one = 1;
    double sum, found;
    initialise();
    OK(fmi2GetDirectionalDerivative(c, &rate, 1, twice, 1, &one, &found));
    OK(fmi2GetDirectionalDerivative(c, &rate, 1, twice, 2, seeds, &sum));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 5 * found, sum);
    TEST_ASSERT_TRUE(fabs(found) > 1e-3);
}

static void lists_that_are_missing_are_refused_and_empty_ones_are_not(void) {
    fmi3Instance i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    const fmi3ValueReference rate = ref("der(nu_rad_per_s)", 1), voltage = ref("voltage_V", 1), time = ref("time", 0);
    const double seed = 1;
    double found = 7;
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &rate, 1, &voltage, 1, NULL, 1, &found, 1),
                   "seeds or sensitivities");
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &rate, 1, &voltage, 1, &seed, 1, NULL, 1), "is missing (NULL)");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &rate, 1, &voltage, 1, NULL, 1, &found, 1), "seeds or sensitivities");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &rate, 1, &voltage, 1, &seed, 1, NULL, 1), "is missing (NULL)");
    OK(fmi3GetDirectionalDerivative(i, NULL, 0, NULL, 0, NULL, 0, NULL, 0));
    OK(fmi3GetDirectionalDerivative(i, &rate, 1, NULL, 0, NULL, 0, &found, 1));
    TEST_ASSERT_TRUE(found == 0);
    OK(fmi3GetAdjointDerivative(i, NULL, 0, NULL, 0, NULL, 0, NULL, 0));
    OK(fmi3GetAdjointDerivative(i, &rate, 1, &voltage, 1, &seed, 1, &found, 1));
    TEST_ASSERT_TRUE(found != 0);
    OK(fmi3GetAdjointDerivative(i, &rate, 1, &time, 1, &seed, 1, &found, 1));
    TEST_ASSERT_TRUE(found == 0);
    OK(fmi3GetDirectionalDerivative(i, NULL, 0, &voltage, 1, &seed, 1, NULL, 0));
    OK(fmi3GetAdjointDerivative(i, &rate, 1, NULL, 0, &seed, 1, NULL, 0));
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &rate, 1, &voltage, 1, &seed, 1, &found, 2), "2 values for knowns");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &rate, 1, &voltage, 1, &seed, 2, &found, 1), "2 values for unknowns");
    fmi3FreeInstance(i);
}

static void derivatives_beyond_the_range_are_refused_and_nothing_is_written(void) {
    fmi3Instance i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    const fmi3ValueReference torque = ref("wheel_torque_Nm", 1), voltage = ref("voltage_V", 1),
                             gain = ref("motor_gain_Nm_per_V", 0);
    const double seed = 1e308, strong = 100;
    double found = 7;
    OK(fmi3SetFloat64(i, &gain, 1, &strong, 1));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &torque, 1, &voltage, 1, &seed, 1, &found, 1),
                   "a derivative of or by wheel_torque_Nm leaves the range of double precision");
    ASSERT_REFUSED(fmi3GetAdjointDerivative(i, &torque, 1, &voltage, 1, &seed, 1, &found, 1),
                   "a derivative of or by voltage_V leaves the range of double precision");
    TEST_ASSERT_TRUE(found == 7);
    fmi3FreeInstance(i);
}

/* Of two motors, one beyond the range: the other's derivative is read, but not in a list with that one. */
static void a_list_has_its_derivatives_as_a_whole_or_not_at_all(void) {
    fmi3Instance i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    const fmi3ValueReference of[2] = {ref("wheel_torque_Nm", 1), ref("wheel_torque_Nm", 2)},
                             whole = ref("wheel_torque_Nm", 0), voltage = ref("voltage_V", 2),
                             gain = ref("motor_gain_Nm_per_V", 0);
    const double seed = 1e308, strong = 100;
    double found[4] = {7, 7, 7, 7};
    OK(fmi3SetFloat64(i, &gain, 1, &strong, 1));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, of, 2, &voltage, 1, &seed, 1, found, 2), "wheel_torque_Nm");
    ASSERT_REFUSED(fmi3GetDirectionalDerivative(i, &whole, 1, &voltage, 1, &seed, 1, found, 4), "wheel_torque_Nm");
    TEST_ASSERT_TRUE(found[0] == 7 && found[1] == 7);
    OK(fmi3GetDirectionalDerivative(i, of, 1, &voltage, 1, &seed, 1, found, 1));
    TEST_ASSERT_TRUE(found[0] == 0);
    fmi3FreeInstance(i);
}

/* Each unknown with its own seed, also where the list has several; what does not depend is 0 to the last bit. */
static void an_adjoint_derivative_is_the_sum_over_all_unknowns(void) {
    fmi3Instance i = fmi3InstantiateModelExchange("one", fmu_token_3, NULL, false, true, NULL, log_3);
    const fmi3ValueReference of[3] = {ref("wheel_torque_Nm", 1), ref("der(x_m)", 0), ref("wheel_torque_Nm", 2)};
    const fmi3ValueReference by[2] = {ref("voltage_V", 1), ref("voltage_V", 2)}, other = ref("voltage_V", 3);
    const double gain = 0.2;                       /* of the description, Nm per V */
    double *const seed = malloc(3 * sizeof *seed); /* sanitizers see what is read behind it */
    double found[2];
    TEST_ASSERT_NOT_NULL(seed);
    seed[0] = 2, seed[1] = 100, seed[2] = -3;
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3GetAdjointDerivative(i, of, 3, by, 2, seed, 3, found, 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2 * gain, found[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, -3 * gain, found[1]);
    OK(fmi3GetAdjointDerivative(i, of, 3, &other, 1, seed, 3, found, 1));
    TEST_ASSERT_TRUE(found[0] == 0);
    OK(fmi3GetDirectionalDerivative(i, of, 3, &other, 1, seed, 1, seed, 3));
    TEST_ASSERT_TRUE(seed[0] == 0 && seed[1] == 0 && seed[2] == 0);
    free(seed);
    fmi3FreeInstance(i);
}

static void a_model_that_cannot_start_has_no_derivatives(void) {
    const fmi2ValueReference rate = ref("der(nu_rad_per_s)", 1), voltage = ref("voltage_V", 1);
    double seed = 1, found = 7;
    set("mass_kg", 0, 0);
    OK(fmi2EnterInitializationMode(c));
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &rate, 1, &voltage, 1, &seed, &found), "this vehicle cannot start");
    make(fmi2CoSimulation);
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    ASSERT_REFUSED(fmi2GetDirectionalDerivative(c, &rate, 1, &voltage, 1, &seed, &found),
                   "limits of its drive has no partial derivatives");
}

/* ------------------------------------------------------------------ derivatives in time, of outputs and inputs -- */

static void outputs_change_in_time_as_differences_of_short_steps_do(void) {
    static const char *const names[6] = {"x_m", "heading_rad", "energy_J", "wheel_torque_Nm", "wheel_angle_rad", "y_m"};
    const fmi2Integer first[6] = {1, 1, 1, 1, 1, 1};
    const double by_s = 1e-4, slope = 40;
    fmi2ValueReference list[6];
    double before[6], after[6], rate[6];
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    for (uint32_t k = 0; k < 6; k++) list[k] = ref(names[k], k < 3 || k == 5 ? 0 : 1);
    make(fmi2CoSimulation);
    set_integer("method", 0, 0);
    initialise();
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 2.0 * k - 3);
    for (int k = 0; k < 40; k++) OK(step(0.02 * k, 0.02));
    const double heading = get("heading_rad", 0), turned = get("wheel_angle_rad", 1);
    TEST_ASSERT_TRUE(fabs(heading) > 1e-3 && fabs(turned) > 1e-2);
    OK(fmi2GetReal(c, list, 6, before));
    OK(fmi2SetRealInputDerivatives(c, &voltage, 1, first, &slope));
    OK(fmi2GetRealOutputDerivatives(c, list, 6, first, rate));
    OK(step(0.8, by_s));
    OK(fmi2GetReal(c, list, 6, after));
    for (int k = 0; k < 6; k++)
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-3 * (1 + fabs(rate[k])), (after[k] - before[k]) / by_s, rate[k], names[k]);
    TEST_ASSERT_TRUE(fabs(rate[3]) > 1 && fabs(rate[5]) > 0.01);
}

static void at_rest_nothing_changes_in_time(void) {
    const fmi2ValueReference list[3] = {ref("wheel_torque_Nm", 1), ref("x_m", 0), ref("energy_J", 0)};
    const fmi2Integer first[3] = {1, 1, 1};
    double rate[3];
    make(fmi2CoSimulation);
    initialise();
    for (int stepped = 0; stepped < 2; stepped++) {
        OK(fmi2GetRealOutputDerivatives(c, list, 3, first, rate));
        TEST_ASSERT_TRUE(rate[0] == 0 && rate[1] == 0 && rate[2] == 0);
        OK(step(0.1 * stepped, 0.1));
    }
}

static void lists_of_orders_and_values_in_time_are_checked(void) {
    const fmi2ValueReference x = ref("x_m", 0), voltage = ref("voltage_V", 1), none = 0x7FFFFFFF;
    const fmi2Integer first = 1, second = 2;
    double value = 3;
    make(fmi2CoSimulation);
    initialise();
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, &x, 1, NULL, &value), "the list of orders is missing (NULL)");
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, &x, 1, &first, NULL), "the list of values is missing (NULL)");
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, &x, 1, &second, &value), "a derivative of order 2 was requested");
    OK(fmi2GetRealOutputDerivatives(c, NULL, 0, NULL, NULL));
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, NULL, 1, &first, &value), "a list of value references or values");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, NULL), "a list of value references or values");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &voltage, 1, NULL, &value), "the list of orders is missing");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &voltage, 1, &second, &value), "order 2");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &none, 1, &first, &value), "there is no variable");
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &x, 1, &first, &value), "x_m is no scalar input");
    const fmi2ValueReference whole = ref("voltage_V", 0);
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &whole, 1, &first, &value), "voltage_V is no scalar input");
    value = NOT_A_NUMBER;
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &value), "voltage_V: its derivative nan is not");
    OK(fmi2SetRealInputDerivatives(c, NULL, 0, NULL, NULL));
    TEST_ASSERT_FALSE(instance()->model.sloped);
    const fmi2ValueReference inputs[2] = {voltage, x}, outputs[2] = {x, ref("y_m", 0)}; /* the second is wrong */
    const fmi2Integer orders[2] = {1, 2}, firsts[2] = {1, 1};
    double values[2] = {1, 2};
    ASSERT_REFUSED(fmi2SetRealInputDerivatives(c, inputs, 2, firsts, values), "x_m is no scalar input");
    ASSERT_REFUSED(fmi2GetRealOutputDerivatives(c, outputs, 2, orders, values), "order 2");
    TEST_ASSERT_FALSE(instance()->model.sloped);
}

/* Each input with its own slope; those of the step before are forgotten. */
static void slopes_move_their_own_inputs_for_one_step(void) {
    static const char *const inputs[] = {"voltage_V", "axle_torque_Nm", "body_force_N", "world_force_N",
                                         "world_force_point_m"};
    const fmi2Integer first = 1;
    make(fmi2CoSimulation);
    set("step_s", 0, 0.01);
    initialise();
    for (int again = 0; again < 2; again++) {
        for (uint32_t k = 0; k < 5; k++) {
            const fmi2ValueReference input = ref(inputs[k], 2);
            const double slope = 1.0 + k;
            if (again == 0 || k == 3) OK(fmi2SetRealInputDerivatives(c, &input, 1, &first, &slope));
        }
        const fmi2ValueReference moment = ref("body_moment_Nm", 0);
        const double slope = -3;
        if (again == 0) OK(fmi2SetRealInputDerivatives(c, &moment, 1, &first, &slope));
        OK(step(0.1 * again, 0.1));
        for (uint32_t k = 0; k < 5; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.1 * (1.0 + k) * (again && k == 3 ? 2 : 1), get(inputs[k], 2));
            TEST_ASSERT_TRUE(get(inputs[k], 1) == 0);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, -0.3, get("body_moment_Nm", 0));
    }
    OK(step(0.2, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.8, get("world_force_N", 2));
    const fmi2ValueReference both[2] = {ref("voltage_V", 3), ref("voltage_V", 4)}; /* in one call */
    const fmi2Integer orders[2] = {1, 1};
    const double slopes[2] = {5, -7};
    OK(fmi2SetRealInputDerivatives(c, both, 2, orders, slopes));
    OK(step(0.3, 0.1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.5, get("voltage_V", 3));
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, -0.7, get("voltage_V", 4));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_derivative_is_that_of_a_difference);
    RUN_TEST(what_is_known_depends_on_the_mode);
    RUN_TEST(what_is_unknown_is_computed_and_has_derivatives);
    RUN_TEST(seeds_of_one_known_that_is_named_twice_add_up);
    RUN_TEST(lists_that_are_missing_are_refused_and_empty_ones_are_not);
    RUN_TEST(derivatives_beyond_the_range_are_refused_and_nothing_is_written);
    RUN_TEST(a_list_has_its_derivatives_as_a_whole_or_not_at_all);
    RUN_TEST(an_adjoint_derivative_is_the_sum_over_all_unknowns);
    RUN_TEST(a_model_that_cannot_start_has_no_derivatives);
    RUN_TEST(outputs_change_in_time_as_differences_of_short_steps_do);
    RUN_TEST(at_rest_nothing_changes_in_time);
    RUN_TEST(lists_of_orders_and_values_in_time_are_checked);
    RUN_TEST(slopes_move_their_own_inputs_for_one_step);
    return UNITY_END();
}
