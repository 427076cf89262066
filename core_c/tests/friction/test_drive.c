/* Tests of drive.c: limits of voltage and current, and the supply that sags. */
#include "friction_vehicle.h"

#include "slipping.h"

static laconic_friction drive_of(double supply_V, double resistance_ohm, double limit_A) {
    laconic_vehicle v = with_drive(robotino(0.5, 0, 0));
    laconic_friction f;
    v.drive.supply_V = REAL(supply_V);
    v.drive.supply_resistance_ohm = REAL(resistance_ohm);
    v.drive.current_limit_A = REAL(limit_A);
    v.wheel[2].motor_circuit = LACONIC_MOTOR_OPEN;
    const laconic_model model = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_friction_of(&f, &model, &v, &why));
    return f;
}

static void voltages_are_cut_to_the_supply_s(void) {
    const laconic_friction f = drive_of(12, 0, 0);
    const motor_state above = laconic_motor_at(&f, 0, 20, 0, 12), below = laconic_motor_at(&f, 0, -20, 0, 12);
    const motor_state within = laconic_motor_at(&f, 0, 5, 4, 12), free = laconic_motor_at(&f, 0, 20, 0, -1);
    ASSERT_NEAR(ROUNDING * 10, 6, above.current_A);
    ASSERT_NEAR(ROUNDING * 10, -6, below.current_A);
    ASSERT_NEAR(ROUNDING * 10, (5 * 0.5 - 0.25 * 4), within.current_A);
    ASSERT_NEAR(ROUNDING * 10, 10, free.current_A);
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_VOLTAGE, above.limit);
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_NONE, within.limit);
}

static void a_supply_of_less_than_a_volt_is_one(void) {
    const laconic_friction stiff = drive_of(0.5, 0, 0), sagging = drive_of(0.5, 0.5, 0);
    const laconic_real at_rest[3] = {0, 0, 0};
    laconic_input input = no_input();
    ASSERT_NEAR(0, 0.5, laconic_supply_voltage(&stiff, &input, at_rest, 0));
    input.voltage_V[0] = input.voltage_V[1] = 30; /* two of 2 Ω in parallel, as below */
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 0.5 / 1.5, laconic_supply_voltage(&sagging, &input, at_rest, 0));
}

static void a_limited_motor_has_the_voltage_of_its_current(void) {
    const laconic_friction f = drive_of(24, 0, 3);
    const motor_state m = laconic_motor_at(&f, 1, -20, 2, 24);
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_CURRENT, m.limit);
    ASSERT_NEAR(EITHER(1e-14, 1e-5), -3, m.current_A);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), -3 * 2 + 0.5 * 2, m.voltage_V);
}

static void a_limit_of_less_than_an_ampere_is_one(void) {
    const laconic_friction f = drive_of(24, 0, 0.5);
    const motor_state m = laconic_motor_at(&f, 0, 20, 0, 24);
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_CURRENT, m.limit);
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 0.5, m.current_A);
}

static void an_open_motor_takes_no_current(void) {
    const laconic_friction f = drive_of(24, 0, 3);
    const motor_state m = laconic_motor_at(&f, 2, 20, 7, 24);
    TEST_ASSERT_TRUE(m.current_A == 0 && m.torque == 0 && m.voltage_V == 0);
}

/* No controller stands between: at 100 rad/s −K ω/R_a, whatever the limit. */
static void a_shorted_motor_has_no_current_limit(void) {
    laconic_vehicle v = with_drive(robotino(0.5, 0, 0));
    laconic_friction f;
    v.drive.current_limit_A = 3;
    v.wheel[2].motor_circuit = LACONIC_MOTOR_SHORTED;
    const laconic_model model = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_friction_of(&f, &model, &v, &why));
    const motor_state m = laconic_motor_at(&f, 2, 20, 100, 24);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), -0.5 * 100 / 2, m.current_A);
    TEST_ASSERT_TRUE(m.voltage_V == 0 && m.limit == LACONIC_LIMIT_NONE);
}

/* Before, there was a voltage of none; and the speed of a wheel that there is not is no speed. */
static void a_supply_starts_from_its_own_voltage_where_there_was_none(void) {
    const laconic_friction f = drive_of(24, 0.5, 0);
    const laconic_real at_rest[4] = {0, 0, 0, NOT_A_NUMBER};
    laconic_input input = no_input();
    input.voltage_V[0] = 10;
    const laconic_real volts = laconic_supply_voltage(&f, &input, at_rest, 24);
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, at_rest, 0) == volts);
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, at_rest, -1) == volts);
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, at_rest, NOT_A_NUMBER) == volts);
    ASSERT_NEAR(EITHER(1e-13, 1e-4), 12 + sqrt(144 - 25), volts); /* V = 24 − 0.5 · 10/V · 5 A */
}

/* At stall two motors of 2 Ω in parallel hang on the supply: V = V₀ 1/(1 + R_s). */
static void the_supply_sags_under_the_currents_of_all_motors(void) {
    const laconic_friction f = drive_of(24, 0.5, 0), stiff = drive_of(24, 0, 0), unlimited = drive_of(0, 0, 3);
    const laconic_real at_rest[3] = {0, 0, 0};
    laconic_input input = no_input();
    input.voltage_V[0] = 30;
    input.voltage_V[1] = -30;
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 24 / 1.5, laconic_supply_voltage(&f, &input, at_rest, 24));
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 24 / 1.5, laconic_supply_voltage(&f, &input, at_rest, 0));
    ASSERT_NEAR(0, 24, laconic_supply_voltage(&stiff, &input, at_rest, 24));
    TEST_ASSERT_TRUE(laconic_supply_voltage(&unlimited, &input, at_rest, 24) == -1);
    input.voltage_V[0] = 10; /* V = 24 − 0.5 · 10/V · 5 A: a converter takes what its motor takes */
    input.voltage_V[1] = 0;
    const double volts = (double)laconic_supply_voltage(&f, &input, at_rest, 24);
    ASSERT_NEAR(EITHER(1e-6, 1e-4), 24 - 0.5 * 50 / volts, volts);
}

/* A supply that is far too weak still leaves a voltage above 0. */
static void a_supply_that_breaks_down_stays_above_0(void) {
    const laconic_friction f = drive_of(24, 1000, 0);
    const laconic_real fast[3] = {-400, 0, 0};
    laconic_input input = no_input();
    input.voltage_V[0] = 30;
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, fast, 24) > 0);
}

/* Whatever it was before: a vehicle may get another supply in motion. */
static void a_supply_without_resistance_has_its_voltage(void) {
    const laconic_friction f = drive_of(24, 0, 0);
    const laconic_real at_rest[3] = {0, 0, 0};
    laconic_input input = no_input();
    input.voltage_V[0] = 10;
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, at_rest, REAL(1e6)) == 24);
    TEST_ASSERT_TRUE(laconic_supply_voltage(&f, &input, at_rest, REAL(1e-6)) == 24);
}

/* The least supply that there is, of which a generating motor leaves nothing: 0 V are 0 V, as in a shorted motor. */
static void a_supply_of_which_nothing_is_left_drives_nothing(void) {
    const laconic_real least_V = LACONIC_REAL_MIN * LACONIC_EPSILON;
    laconic_vehicle v = with_drive(robotino(0.5, 0, 0));
    laconic_input input = no_input();
    laconic_plant plant[2];
    v.drive.supply_V = least_V;
    v.drive.supply_resistance_ohm = 1000;
    for (int shorted = 0; shorted < 2; shorted++) {
        if (shorted) v.wheel[0].motor_circuit = LACONIC_MOTOR_SHORTED;
        plant[shorted] = started(v, 1e-3, 0, 0, 0);
        plant[shorted].slip.wheel_speed_rad_per_s[0] = -400;
        input.voltage_V[0] = shorted ? 0 : 30;
        if (!shorted) {
            const laconic_slip *s = &plant[0].slip;
            TEST_ASSERT_TRUE(laconic_supply_voltage(&plant[0].friction, &input, s->wheel_speed_rad_per_s, least_V) ==
                             0);
            laconic_slip smooth = *s;
            laconic_slip_smooth(&smooth, &plant[0].friction, &plant[0].state, &input);
            TEST_ASSERT_TRUE(smooth.supply_voltage_V == 0 && smooth.supply_current_A == 0);
        }
        run(&plant[shorted], &input, 1);
    }
    const motor_state motor = laconic_motor_at(&plant[0].friction, 0, 30, 0, 0);
    TEST_ASSERT_TRUE(motor.voltage_V == 0 && motor.limit == LACONIC_LIMIT_VOLTAGE);
    TEST_ASSERT_TRUE(plant[0].slip.supply_current_A == 0);
    TEST_ASSERT_TRUE(plant[0].slip.wheel_speed_rad_per_s[0] > -400);
    ASSERT_NEAR_ALL(0, plant[1].slip.wheel_speed_rad_per_s, plant[0].slip.wheel_speed_rad_per_s, 3);
}

/* Where the voltage is nearly found a round more changes its last digit: the tolerance is one of the bits'. */
static void the_rounds_end_at_a_tolerance_of_just_its_size(void) {
    static const struct {
        double supply_V, resistance_ohm, command_V[2], speed, bits;
    } cases[] = {{1.5, 0.75, {-1.5, 8.3000000000000007}, 7.0999999999999996, 0x1.8af8af8af8af1p-4},
                 {2.6, 0.8, {-0.90000000000000036, -1.0999999999999996}, 7, 0x1.5555555555557p-1}};
    for (int n = 0; n < 2; n++) {
        const laconic_friction f = drive_of(cases[n].supply_V, cases[n].resistance_ohm, 0);
        const laconic_real speed[3] = {REAL(cases[n].speed), 0, 0};
        laconic_input input = no_input();
        for (int i = 0; i < 2; i++) input.voltage_V[i] = REAL(cases[n].command_V[i]);
        const double volts = (double)laconic_supply_voltage(&f, &input, speed, 0);
        ASSERT_NEAR(EITHER(0, 1e-6), cases[n].bits, volts);
    }
}

/* In single a round is off by just the tolerance here. One more would change the last digit. */
static void the_rounds_end_where_they_are_off_by_just_the_tolerance(void) {
    const laconic_friction f = drive_of(16.6, 0.5, 0);
    const laconic_real speed[3] = {REAL(3.4), 0, 0};
    laconic_input input = no_input();
    input.voltage_V[0] = REAL(-5.2);
    input.voltage_V[1] = 18;
    ASSERT_NEAR(EITHER(1e-5, 0), 0x1.96e6aap+3, laconic_supply_voltage(&f, &input, speed, 0));
}

/* As a smooth law may be asked of any input. */
static void a_command_that_is_no_number_has_reached_no_limit(void) {
    const laconic_friction f = drive_of(12, 0, 3);
    const motor_state unknown = laconic_motor_at(&f, 0, NOT_A_NUMBER, 0, 12);
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_NONE, unknown.limit);
    TEST_ASSERT_TRUE(unknown.voltage_V != unknown.voltage_V && unknown.torque != unknown.torque);
}

/* Of a motor that is shorted the supply knows nothing, however large its current. */
static void a_current_beyond_the_range_in_a_shorted_motor_leaves_the_supply_alone(void) {
    laconic_friction f = drive_of(12, 0.5, 0);
    const laconic_real speed[3] = {REAL(EITHER(1e75, 1e9)), 0, 0};
    laconic_input input = no_input();
    f.axle[0].circuit = LACONIC_MOTOR_SHORTED;
    f.axle[0].back_emf = f.axle[0].ampere = REAL(EITHER(1e150, 1e18));
    TEST_ASSERT_FALSE(isfinite((double)laconic_motor_at(&f, 0, 0, speed[0], 12).current_A));
    ASSERT_NEAR(0, 12, laconic_supply_voltage(&f, &input, speed, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(voltages_are_cut_to_the_supply_s);
    RUN_TEST(a_supply_of_less_than_a_volt_is_one);
    RUN_TEST(a_limited_motor_has_the_voltage_of_its_current);
    RUN_TEST(a_limit_of_less_than_an_ampere_is_one);
    RUN_TEST(an_open_motor_takes_no_current);
    RUN_TEST(a_shorted_motor_has_no_current_limit);
    RUN_TEST(a_supply_starts_from_its_own_voltage_where_there_was_none);
    RUN_TEST(the_supply_sags_under_the_currents_of_all_motors);
    RUN_TEST(a_supply_that_breaks_down_stays_above_0);
    RUN_TEST(a_supply_without_resistance_has_its_voltage);
    RUN_TEST(a_supply_of_which_nothing_is_left_drives_nothing);
    RUN_TEST(the_rounds_end_at_a_tolerance_of_just_its_size);
    RUN_TEST(the_rounds_end_where_they_are_off_by_just_the_tolerance);
    RUN_TEST(a_command_that_is_no_number_has_reached_no_limit);
    RUN_TEST(a_current_beyond_the_range_in_a_shorted_motor_leaves_the_supply_alone);
    return UNITY_END();
}
