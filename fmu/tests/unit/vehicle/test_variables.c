/* Tests of variables.c and cached_reals.c: lists of any form by the fast path and by the other one, with all or
 * nothing. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

#define MANY 70U /* more than FMU_LIST_LENGTH */

static void a_list_longer_than_the_fast_path_keeps_is_read_and_set(void) {
    fmi2ValueReference list[MANY];
    double given[MANY], found[MANY];
    initialise();
    for (uint32_t k = 0; k < MANY; k++) {
        list[k] = ref("voltage_V", k % 4 + 1);
        given[k] = 0.25 * k;
    }
    for (uint32_t count = FMU_LIST_LENGTH - 1; count <= MANY; count++) {
        OK(fmi2SetReal(c, list, count, given));
        OK(fmi2GetReal(c, list, count, found));
        for (uint32_t k = 0; k < count; k++) TEST_ASSERT_TRUE(found[k] == given[count - 1 - (count - 1 - k) % 4]);
    }
}

static void arrays_of_more_values_than_the_fast_path_keeps_are_read_and_set(void) {
    fmi3ValueReference list[17];
    double given[17 * 4], found[17 * 4];
    fmi3Instance i = make_3(false);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    for (uint32_t k = 0; k < 17; k++) list[k] = ref("voltage_V", 0);
    for (uint32_t k = 0; k < 17 * 4; k++) given[k] = k;
    for (uint32_t count = 15; count <= 17; count++) {
        OK(fmi3SetFloat64(i, list, count, given, 4 * (size_t)count));
        OK(fmi3GetFloat64(i, list, count, found, 4 * (size_t)count));
        for (uint32_t k = 0; k < 4 * count; k++) TEST_ASSERT_TRUE(found[k] == given[4 * (count - 1) + k % 4]);
    }
    fmi3FreeInstance(i);
}

/* Which path a list takes shows in nothing but its time; so here by what is kept for the next call. */
static void a_list_for_the_fast_path_is_kept_with_all_of_its_values(void) {
    fmi3ValueReference list[16];
    double given[64] = {0}, found[64];
    fmi3Instance i = make_3(false);
    const fmu_instance *it = i;
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    for (uint32_t k = 0; k < 16; k++) list[k] = ref("voltage_V", 0);
    for (uint32_t count = 1; count <= 16; count += 5) {
        OK(fmi3SetFloat64(i, list, count, given, 4 * (size_t)count));
        OK(fmi3GetFloat64(i, list, count, found, 4 * (size_t)count));
        TEST_ASSERT_EQUAL(count, it->written.count);
        TEST_ASSERT_EQUAL(4 * count, it->written.values);
        TEST_ASSERT_EQUAL(count, it->read.count);
        TEST_ASSERT_EQUAL(4 * count, it->read.values);
    }
    fmi3ValueReference longest[FMU_LIST_LENGTH + 1];
    double many[FMU_LIST_LENGTH] = {0};
    for (uint32_t k = 0; k < FMU_LIST_LENGTH + 1; k++) longest[k] = list[0] << FMU_ELEMENT_SHIFT | 1;
    OK(fmi3SetFloat64(i, longest, FMU_LIST_LENGTH, many, FMU_LIST_LENGTH));
    OK(fmi3GetFloat64(i, longest, FMU_LIST_LENGTH, many, FMU_LIST_LENGTH));
    TEST_ASSERT_TRUE(it->written.count == FMU_LIST_LENGTH && it->read.count == FMU_LIST_LENGTH);
    ASSERT_REFUSED(fmi3SetFloat64(i, longest, FMU_LIST_LENGTH + 1, many, 0), "but only 0 were left");
    ASSERT_REFUSED(fmi3GetFloat64(i, longest, FMU_LIST_LENGTH + 1, many, 0), "but only 0 were left");
    list[0] = ref("energy_J", 0);
    OK(fmi3GetFloat64(i, list, 1, found, 1));
    TEST_ASSERT_EQUAL_UINT32(FMU_GROUP_ENERGY, it->read.groups); /* no more is computed than is read */
    list[0] = ref("voltage_V", 0) << FMU_ELEMENT_SHIFT | 4;
    OK(fmi3GetFloat64(i, list, 1, found, 1));
    TEST_ASSERT_EQUAL(1, it->read.values);
    TEST_ASSERT_EQUAL_UINT32(0, it->read.groups);
    list[0] = ref("mass_kg", 0); /* cannot be set in this mode */
    ASSERT_REFUSED(fmi3SetFloat64(i, list, 1, given, 1), "mass_kg");
    TEST_ASSERT_EQUAL(0, it->written.count);
    fmi3FreeInstance(i);
}

/* The fast path stops at such a reference; those before it, or none, are as many values as are given. */
static void a_list_that_cannot_be_set_or_read_is_refused_whatever_its_number_of_values(void) {
    const fmi3ValueReference behind = ref("voltage_V", 0) << FMU_ELEMENT_SHIFT | 5, none = 0x7FFFFFFF;
    const fmi3ValueReference to_set[2] = {ref("voltage_V", 0), ref("mass_kg", 0)}, to_get[2] = {to_set[0], none};
    double values[4] = {1, 2, 3, 4}, five[5] = {5, 6, 7, 8, 9};
    fmi3Instance i = make_3(false);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3SetFloat64(i, to_set, 2, values, 4), "mass_kg");
    ASSERT_REFUSED(fmi3GetFloat64(i, to_get, 2, values, 4), "there is no variable with the value reference");
    ASSERT_REFUSED(fmi3GetFloat64(i, &behind, 1, values, 0), "there is no variable with the value reference");
    const fmi3ValueReference force = ref("body_force_N", 0), twice[2] = {to_set[0], to_set[0]};
    ASSERT_REFUSED(fmi3SetFloat64(i, &force, 1, values, 4), "4 values given, but the variables have 2");
    ASSERT_REFUSED(fmi3GetFloat64(i, &force, 1, values, 4), "4 values asked for, but the variables have 2");
    ASSERT_REFUSED(fmi3SetFloat64(i, twice, 2, five, 5), "voltage_V has 4 values, but only 1 were left");
    ASSERT_REFUSED(fmi3GetFloat64(i, twice, 2, five, 5), "voltage_V has 4 values, but only 1 were left");
    OK(fmi3GetFloat64(i, to_get, 1, values, 4));
    TEST_ASSERT_TRUE(values[0] == 0 && values[3] == 0);
    fmi3FreeInstance(i);
}

/* Another number of values than the last time, by a list that the fast path has kept. */
static void the_number_of_values_is_checked_each_time(void) {
    const fmi3ValueReference voltage = ref("voltage_V", 0);
    double volts[5] = {1, 2, 3, 4, 5};
    fmi3Instance i = make_3(false);
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    OK(fmi3SetFloat64(i, &voltage, 1, volts, 4));
    OK(fmi3GetFloat64(i, &voltage, 1, volts, 4));
    ASSERT_REFUSED(fmi3SetFloat64(i, &voltage, 1, volts, 5), "5 values given, but the variables have 4");
    ASSERT_REFUSED(fmi3GetFloat64(i, &voltage, 1, volts, 5), "5 values asked for, but the variables have 4");
    ASSERT_REFUSED(fmi3GetFloat64(i, &voltage, 1, volts, 3), "voltage_V has 4 values, but only 3 were left");
    ASSERT_REFUSED(fmi3GetFloat64(i, &voltage, 1, NULL, 4), "is missing (NULL)");
    ASSERT_REFUSED(fmi3SetFloat64(i, NULL, 1, volts, 4), "is missing (NULL)");
    ASSERT_REFUSED(fmi3SetFloat64(i, &voltage, 1, NULL, 4), "is missing (NULL)");
    OK(fmi3GetFloat64(i, NULL, 0, NULL, 0));
    fmi3FreeInstance(i);
}

/* One value that is not finite behind one that is, in a list that the fast path has kept. */
static void a_value_that_is_not_finite_is_refused_wherever_it_stands(void) {
    const fmi2ValueReference list[2] = {ref("voltage_V", 1), ref("voltage_V", 2)};
    double volts[2] = {1, 2};
    initialise();
    OK(fmi2SetReal(c, list, 2, volts));
    volts[0] = 5, volts[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(fmi2SetReal(c, list, 2, volts), "voltage_V[2]: nan is not a finite number");
    OK(fmi2GetReal(c, list, 2, volts));
    TEST_ASSERT_TRUE(volts[0] == 1 && volts[1] == 2);
    const fmi2ValueReference outputs[2] = {ref("wheel_torque_Nm", 1), ref("wheel_torque_Nm", 2)};
    double torques[2];
    OK(fmi2GetReal(c, outputs, 2, torques));
    set("motor_gain_Nm_per_V", 0, 10);
    set("voltage_V", 2, 1e308);
    torques[0] = torques[1] = 7;
    ASSERT_REFUSED(fmi2GetReal(c, outputs, 2, torques), "wheel_torque_Nm[2] leaves the range of double precision");
    TEST_ASSERT_TRUE(torques[0] == 7 && torques[1] == 7);
}

static void an_element_of_an_array_is_named_where_it_is_refused(void) {
    const fmi3ValueReference voltage = ref("voltage_V", 0), torque = ref("wheel_torque_Nm", 0),
                             gain = ref("motor_gain_Nm_per_V", 0);
    double volts[4] = {1, 2, NOT_A_NUMBER, 4}, torques[4] = {7, 7, 7, 7}, strong = 10;
    fmi3Instance i = make_3(false);
    OK(fmi3SetFloat64(i, &gain, 1, &strong, 1));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(i));
    ASSERT_REFUSED(fmi3SetFloat64(i, &voltage, 1, volts, 4), "voltage_V[3]: nan is not a finite number");
    volts[2] = 1e308;
    OK(fmi3SetFloat64(i, &voltage, 1, volts, 4));
    ASSERT_REFUSED(fmi3GetFloat64(i, &torque, 1, torques, 4), "wheel_torque_Nm[3] leaves the range");
    TEST_ASSERT_TRUE(torques[0] == 7 && torques[3] == 7);
    fmi3FreeInstance(i);
}

/* By the path with all checks, since the list is long: neighbours that cannot be read do not matter. */
static void a_value_is_read_though_its_neighbour_cannot_be(void) {
    fmi2ValueReference list[MANY];
    double torques[MANY];
    set("motor_gain_Nm_per_V", 0, 10);
    initialise();
    set("voltage_V", 1, 2);
    set("voltage_V", 2, 1e308);
    for (uint32_t k = 0; k < MANY; k++) list[k] = ref("wheel_torque_Nm", 1);
    OK(fmi2GetReal(c, list, MANY, torques));
    TEST_ASSERT_TRUE(torques[0] != 0 && torques[MANY - 1] == torques[0]);
}

/* A long list of inputs takes the path with all checks; outputs follow it as they follow a short one. */
static void outputs_follow_inputs_that_are_set_by_either_path(void) {
    fmi2ValueReference list[MANY];
    double volts[MANY];
    initialise();
    set("voltage_V", 1, 1);
    const double torque = get("wheel_torque_Nm", 1);
    for (uint32_t k = 0; k < MANY; k++) list[k] = ref("voltage_V", 1), volts[k] = 3;
    OK(fmi2SetReal(c, list, MANY, volts));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3 * torque, get("wheel_torque_Nm", 1));
    TEST_ASSERT_TRUE(torque > 0);
    set("voltage_V", 1, 1);
    TEST_ASSERT_TRUE(get("wheel_torque_Nm", 1) == torque);
}

/* The memory of lists ends with them; sanitizers see what would be read behind. */
static void no_more_is_read_than_the_list_has(void) {
    fmi2ValueReference *const list = malloc(2 * sizeof *list);
    double *const values = malloc(2 * sizeof *values);
    TEST_ASSERT_TRUE(list != NULL && values != NULL);
    list[0] = ref("voltage_V", 1), list[1] = ref("voltage_V", 2);
    values[0] = 1, values[1] = 2;
    initialise();
    for (int again = 0; again < 2; again++) {
        OK(fmi2SetReal(c, list, 2, values));
        OK(fmi2GetReal(c, list, 2, values));
    }
    TEST_ASSERT_TRUE(values[0] == 1 && values[1] == 2);
    free(values);
    free(list);
}

/* As many references and as many values, but one is another. */
static void a_list_is_another_one_if_one_reference_is(void) {
    fmi2ValueReference list[3] = {ref("voltage_V", 1), ref("voltage_V", 2), ref("voltage_V", 3)};
    double volts[3] = {1, 2, 3};
    initialise();
    OK(fmi2SetReal(c, list, 3, volts));
    OK(fmi2GetReal(c, list, 3, volts));
    list[2] = ref("voltage_V", 4);
    volts[2] = 4;
    OK(fmi2SetReal(c, list, 3, volts));
    TEST_ASSERT_TRUE(get("voltage_V", 3) == 3 && get("voltage_V", 4) == 4);
    list[1] = ref("voltage_V", 3);
    OK(fmi2GetReal(c, list, 3, volts));
    TEST_ASSERT_TRUE(volts[0] == 1 && volts[1] == 3 && volts[2] == 4);
}

/* A list that was checked for four wheels is not that of six; nor is one that was read before the reset. */
static void a_list_is_checked_anew_in_each_mode(void) {
    const fmi3ValueReference voltage = ref("voltage_V", 0), speed = ref("wheel_speed_rad_per_s", 0),
                             wheels = ref("wheel_count", 0);
    const fmi3UInt64 six = 6;
    double values[6] = {1, 2, 3, 4, 5, 6};
    fmi3Instance i = make_3(false);
    OK(fmi3SetFloat64(i, &voltage, 1, values, 4));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3GetFloat64(i, &speed, 1, values, 4));
    OK(fmi3Reset(i));
    ASSERT_REFUSED(fmi3GetFloat64(i, &speed, 1, values, 4), "it has no value before initialization");
    OK(fmi3SetFloat64(i, &voltage, 1, values, 4));
    OK(fmi3EnterConfigurationMode(i));
    OK(fmi3SetUInt64(i, &wheels, 1, &six, 1));
    OK(fmi3ExitConfigurationMode(i));
    ASSERT_REFUSED(fmi3SetFloat64(i, &voltage, 1, values, 4), "voltage_V has 6 values, but only 4 were left");
    OK(fmi3SetFloat64(i, &voltage, 1, values, 6));
    fmi3FreeInstance(i);
}

static void references_that_are_none_are_refused_whatever_their_form(void) {
    const uint32_t voltage = ref("voltage_V", 0) << FMU_ELEMENT_SHIFT;
    const fmi2ValueReference none[] = {0x7FFFFFFF,     voltage,
                                       voltage | 5,    fmu_variable_count,
                                       voltage | 1023, ref("body_moment_Nm", 0) << FMU_ELEMENT_SHIFT};
    double value = 7;
    initialise();
    for (size_t k = 0; k < sizeof none / sizeof none[0]; k++) {
        ASSERT_REFUSED(fmi2GetReal(c, &none[k], 1, &value), "there is no variable with the value reference");
        ASSERT_REFUSED(fmi2SetReal(c, &none[k], 1, &value), "there is no variable with the value reference");
    }
    const fmi2ValueReference method = ref("method", 0), last = voltage | 4;
    ASSERT_REFUSED(fmi2GetReal(c, &method, 1, &value), "method is an Enumeration, not a Float64");
    OK(fmi2SetReal(c, &last, 1, &value));
    TEST_ASSERT_TRUE(get("voltage_V", 4) == 7);
}

static void a_list_of_inputs_and_parameters_is_set_as_a_whole_or_not_at_all(void) {
    const fmi2ValueReference list[2] = {ref("voltage_V", 1), ref("motor_gain_Nm_per_V", 0)};
    const fmi2ValueReference wrong[2] = {ref("voltage_V", 1), ref("mass_kg", 0)};
    double values[2] = {3, 0.3};
    initialise();
    OK(fmi2SetReal(c, list, 2, values));
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 3 && get("motor_gain_Nm_per_V", 0) == 0.3);
    values[0] = 5;
    ASSERT_REFUSED(fmi2SetReal(c, wrong, 2, values), "mass_kg cannot be set in step mode");
    values[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(fmi2SetReal(c, list, 2, values), "motor_gain_Nm_per_V: nan is not a finite number");
    values[0] = -(double)INFINITY;
    ASSERT_REFUSED(fmi2SetReal(c, list, 1, values), "voltage_V[1]: -inf is not a finite number");
    TEST_ASSERT_TRUE(get("voltage_V", 1) == 3);
    values[0] = -NOT_A_NUMBER;
    ASSERT_REFUSED(fmi2SetReal(c, list, 1, values), "voltage_V[1]: nan is not"); /* NaN has no sign */
    TEST_ASSERT_EQUAL_STRING("logStatusError: voltage_V[1]: nan is not a finite number", logged);
}

static void a_flag_is_yes_or_no(void) {
    const fmi2ValueReference locked[2] = {ref("wheel_locked", 1), ref("wheel_locked", 2)};
    const fmi2Boolean given[2] = {fmi2True, fmi2False};
    fmi2Boolean found[2] = {7, 7};
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2SetBoolean(c, locked, 2, given));
    OK(fmi2GetBoolean(c, locked, 2, found));
    TEST_ASSERT_TRUE(found[0] == fmi2True && found[1] == fmi2False);
    OK(fmi2GetBoolean(c, NULL, 0, NULL));
    ASSERT_REFUSED(fmi2GetBoolean(c, locked, 2, NULL), "a list of value references or values is missing (NULL)");
}

static void a_range_is_stated_with_both_its_ends(void) {
    ASSERT_REFUSED(try_set("slope_rad", 0, 2), "slope_rad: 2 is outside its range: 0 to 1.5");
    ASSERT_REFUSED(try_set("slope_rad", 0, -1), "slope_rad: -1 is outside its range: 0 to 1.5");
    OK(try_set("slope_rad", 0, 1.5));
    OK(try_set("slope_rad", 0, 0));
}

static void an_output_beyond_the_range_is_refused_by_its_name(void) {
    double value = 7;
    set("motor_gain_Nm_per_V", 0, 10);
    set("step_s", 0, 0.01);
    initialise();
    OK(step(0, 0.01));
    for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, 1e308);
    ASSERT_REFUSED(try_get("wheel_torque_Nm", 2, &value), "wheel_torque_Nm[2] leaves the range of double precision");
    TEST_ASSERT_TRUE(get("energy_J", 0) == 0);
    instance()->model.energy_J = (double)INFINITY;
    ASSERT_REFUSED(try_get("energy_J", 0, &value), "energy_J leaves the range of double precision");
    TEST_ASSERT_TRUE(value == 7);
}

static void what_is_computed_has_no_value_before_initialization(void) {
    double value;
    fmi3Instance i = make_3(false);
    const fmi3ValueReference x = ref("x_m", 0), mass = ref("mass_kg", 0);
    ASSERT_REFUSED(fmi3GetFloat64(i, &x, 1, &value, 1), "x_m is computed: it has no value before initialization");
    OK(fmi3GetFloat64(i, &mass, 1, &value, 1));
    OK(fmi3EnterInitializationMode(i, false, 0, 0, false, 0));
    OK(fmi3GetFloat64(i, &x, 1, &value, 1));
    fmi3FreeInstance(i);
}

/* A model that cannot start has no outputs; the reason is that of the model. */
static void outputs_of_a_model_that_cannot_start_are_refused_with_its_reason(void) {
    double value;
    set("mass_kg", 0, 0);
    OK(fmi2EnterInitializationMode(c));
    ASSERT_REFUSED(try_get("x_m", 0, &value), "this vehicle cannot start: mass_kg: ");
    set("mass_kg", 0, 2);
    OK(try_get("x_m", 0, &value));
}

static fmi2Boolean states_changed(void) {
    fmi2EventInfo info = {0};
    OK(fmi2NewDiscreteStates(c, &info));
    return info.valuesOfContinuousStatesChanged;
}

static void a_state_set_in_event_mode_is_told_by_the_next_iteration_alone(void) {
    make(fmi2ModelExchange);
    initialise();
    TEST_ASSERT_FALSE(states_changed());
    set("x_m", 0, 3);
    set("y_m", 0, 4);
    TEST_ASSERT_TRUE(states_changed());
    TEST_ASSERT_FALSE(states_changed());
    set("motor_gain_Nm_per_V", 0, 0.1);
    TEST_ASSERT_TRUE(states_changed());
    OK(fmi2EnterContinuousTimeMode(c));
    set("x_m", 0, 5);
    OK(fmi2EnterEventMode(c));
    TEST_ASSERT_FALSE(states_changed());
    TEST_ASSERT_TRUE(get("x_m", 0) == 5 && get("y_m", 0) == 4);
}

/* What a scene with [ground] makes of the FMU: wheel speeds are states. */
static void wheel_speeds_are_states_where_wheels_slip_and_outputs_elsewhere(void) {
    ASSERT_REFUSED((initialise(), try_set("wheel_speed_rad_per_s", 1, 2)), "it is computed by the model");
    make(fmi2ModelExchange);
    ASSERT_REFUSED((initialise(), try_set("wheel_speed_rad_per_s", 1, 2)), "it is computed by the model");
    make(fmi2ModelExchange);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    fmu_model_made(&instance()->model);
    initialise();
    set("wheel_speed_rad_per_s", 1, 2);
    TEST_ASSERT_TRUE(get("wheel_speed_rad_per_s", 1) == 2);
    ASSERT_REFUSED(try_set("wheel_speed_rad_per_s", 1, 2e18), "wheel_speed_rad_per_s[1]: 2e+18 is outside its range");
    ASSERT_REFUSED(try_set("wheel_speed_rad_per_s", 1, -2e18), "outside its range: -1e+18 to 1e+18");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_list_longer_than_the_fast_path_keeps_is_read_and_set);
    RUN_TEST(arrays_of_more_values_than_the_fast_path_keeps_are_read_and_set);
    RUN_TEST(a_list_for_the_fast_path_is_kept_with_all_of_its_values);
    RUN_TEST(a_list_that_cannot_be_set_or_read_is_refused_whatever_its_number_of_values);
    RUN_TEST(the_number_of_values_is_checked_each_time);
    RUN_TEST(a_value_that_is_not_finite_is_refused_wherever_it_stands);
    RUN_TEST(an_element_of_an_array_is_named_where_it_is_refused);
    RUN_TEST(a_value_is_read_though_its_neighbour_cannot_be);
    RUN_TEST(outputs_follow_inputs_that_are_set_by_either_path);
    RUN_TEST(no_more_is_read_than_the_list_has);
    RUN_TEST(a_list_is_another_one_if_one_reference_is);
    RUN_TEST(a_list_is_checked_anew_in_each_mode);
    RUN_TEST(references_that_are_none_are_refused_whatever_their_form);
    RUN_TEST(a_list_of_inputs_and_parameters_is_set_as_a_whole_or_not_at_all);
    RUN_TEST(a_flag_is_yes_or_no);
    RUN_TEST(a_range_is_stated_with_both_its_ends);
    RUN_TEST(an_output_beyond_the_range_is_refused_by_its_name);
    RUN_TEST(what_is_computed_has_no_value_before_initialization);
    RUN_TEST(outputs_of_a_model_that_cannot_start_are_refused_with_its_reason);
    RUN_TEST(a_state_set_in_event_mode_is_told_by_the_next_iteration_alone);
    RUN_TEST(wheel_speeds_are_states_where_wheels_slip_and_outputs_elsewhere);
    return UNITY_END();
}
