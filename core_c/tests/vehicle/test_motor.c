/* Tests of motor.c: a data sheet becomes constants, or is refused. */
#include "vehicles.h"

static laconic_refusal why;

/* R_a = 2 Ω, k_t = 0.1, k_e = 0.12, n = 5, d = 0.001, J_rotor = 2e-5 */
static laconic_motor good_motor(void) {
    laconic_motor m = {REAL(2), REAL(0.1), REAL(0.12), REAL(5), REAL(0.001), REAL(2e-5)};
    return m;
}

static void the_data_sheet_becomes_gain_damping_and_inertia(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 5 * 0.1 / 2, v.motor_gain_Nm_per_V);
    ASSERT_NEAR(ROUNDING, 25 * (0.1 * 0.12 / 2 + 0.001), v.motor_damping_Nms);
    ASSERT_NEAR(ROUNDING, 0.009 + 25 * 2e-5, v.wheel_inertia_kgm2);
}

static void a_gear_that_reverses_negates_the_gain(void) {
    laconic_vehicle v = three_wheels();
    laconic_motor m = good_motor();
    m.gear_ratio = REAL(-5);
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, NULL));
    ASSERT_NEAR(ROUNDING, -0.25, v.motor_gain_Nm_per_V);
    ASSERT_NEAR(ROUNDING, 0.175, v.motor_damping_Nms);
}

static void refuses(laconic_motor m, laconic_status status, laconic_field field) {
    laconic_vehicle v = three_wheels();
    const laconic_vehicle before = v;
    ASSERT_REFUSED(status, field, 0, laconic_motor_fit(&v, &m, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &v, sizeof v);
}

static void a_rotor_turns_with_each_of_as_many_wheels_as_there_may_be(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    while (v.wheel_count < LACONIC_MAX_WHEELS) v.wheel[v.wheel_count++] = v.wheel[0];
    v.wheel[0].undriven = true;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 0.009, v.wheel_inertia_kgm2);
    TEST_ASSERT_TRUE(v.wheel[0].own_inertia_kgm2 == 0);
    for (int i = 1; i < LACONIC_MAX_WHEELS; i++) ASSERT_NEAR(ROUNDING, 0.009 + 25 * 2e-5, v.wheel[i].own_inertia_kgm2);
}

static void every_number_that_is_not_finite_is_named(void) {
    laconic_motor m;
    m = good_motor(), m.resistance_ohm = NOT_A_NUMBER, refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_RESISTANCE);
    m = good_motor(), m.torque_constant_Nm_per_A = INFINITE;
    refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_TORQUE_CONSTANT);
    m = good_motor(), m.back_emf_Vs_per_rad = -INFINITE, refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_BACK_EMF);
    m = good_motor(), m.gear_ratio = NOT_A_NUMBER, refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_GEAR_RATIO);
    m = good_motor(), m.viscous_friction_Nms = NOT_A_NUMBER;
    refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_VISCOUS_FRICTION);
    m = good_motor(), m.rotor_inertia_kgm2 = INFINITE, refuses(m, LACONIC_NOT_FINITE, LACONIC_FIELD_ROTOR_INERTIA);
}

static void resistance_must_be_positive_and_the_gear_not_zero(void) {
    laconic_motor m = good_motor();
    m.resistance_ohm = 0;
    refuses(m, LACONIC_NOT_POSITIVE, LACONIC_FIELD_RESISTANCE);
    m = good_motor();
    m.gear_ratio = 0;
    refuses(m, LACONIC_ZERO, LACONIC_FIELD_GEAR_RATIO);
    m.gear_ratio = LACONIC_REAL_MIN / -2;
    refuses(m, LACONIC_ZERO, LACONIC_FIELD_GEAR_RATIO);
    TEST_ASSERT_TRUE(why.value == LACONIC_REAL_MIN / -2 && why.limit == 0);
}

static void friction_and_rotor_inertia_must_not_be_negative(void) {
    laconic_motor m = good_motor();
    m.viscous_friction_Nms = REAL(-1e-3);
    refuses(m, LACONIC_NEGATIVE, LACONIC_FIELD_VISCOUS_FRICTION);
    m = good_motor();
    m.rotor_inertia_kgm2 = REAL(-1e-5);
    refuses(m, LACONIC_NEGATIVE, LACONIC_FIELD_ROTOR_INERTIA);
}

static void a_motor_whose_constants_leave_the_range_or_add_energy_is_refused(void) {
    laconic_motor m = good_motor();
    m.gear_ratio = REAL(EITHER(1e200, 1e25));
    refuses(m, LACONIC_OVERFLOW, LACONIC_FIELD_GEAR_RATIO);
    m = good_motor();
    m.torque_constant_Nm_per_A = LACONIC_REAL_MAX; /* of the three the gain alone is beyond the range */
    m.back_emf_Vs_per_rad = m.viscous_friction_Nms = 0;
    refuses(m, LACONIC_OVERFLOW, LACONIC_FIELD_GEAR_RATIO);
    m = good_motor();
    m.back_emf_Vs_per_rad = REAL(-0.12); /* damping below zero */
    refuses(m, LACONIC_NEGATIVE, LACONIC_FIELD_BACK_EMF);
}

static void a_motor_without_back_emf_may_pull_either_way(void) {
    for (int sign = -1; sign <= 1; sign += 2) {
        laconic_vehicle v = three_wheels();
        laconic_motor m = good_motor();
        m.back_emf_Vs_per_rad = 0;
        m.torque_constant_Nm_per_A *= REAL(sign);
        ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    }
}

static void a_back_emf_of_the_wrong_sign_is_refused_even_where_friction_outweighs_it(void) {
    laconic_motor m = good_motor();
    m.back_emf_Vs_per_rad = REAL(-0.12);
    m.viscous_friction_Nms = REAL(1);
    refuses(m, LACONIC_NEGATIVE, LACONIC_FIELD_BACK_EMF);
}

static void a_negative_wheel_inertia_is_refused_before_the_rotors_inertia_hides_it(void) {
    laconic_vehicle v = three_wheels();
    laconic_motor m = good_motor();
    m.rotor_inertia_kgm2 = REAL(1);
    v.wheel_inertia_kgm2 = REAL(-0.02);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, laconic_motor_fit(&v, &m, &why), why);
}

/* A vehicle is checked later: a count beyond the array is not followed. */
static void a_motor_is_fitted_to_the_wheels_that_there_can_be(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    v.wheel_count = LACONIC_MAX_WHEELS + 9;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) v.wheel[i].undriven = i < 2;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    TEST_ASSERT_TRUE(v.wheel_count == LACONIC_MAX_WHEELS + 9 && v.motor_gain_Nm_per_V > 0);
    v.wheel_count = -1;
    v.wheel_inertia_kgm2 = REAL(0.009);
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 0.009 + 25 * 2e-5, v.wheel_inertia_kgm2);
}

static void a_negative_inertia_of_a_wheel_is_refused_by_its_number(void) {
    const laconic_motor m = good_motor();
    for (int i = 0; i < 3; i++) {
        laconic_vehicle v = three_wheels();
        v.wheel[i].own_inertia_kgm2 = REAL(-1e-6);
        const laconic_vehicle before = v;
        ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_OWN_INERTIA, i + 1, laconic_motor_fit(&v, &m, &why), why);
        TEST_ASSERT_EQUAL_MEMORY(&before, &v, sizeof v);
    }
}

static void wheels_without_inertia_get_the_rotors(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    v.wheel_inertia_kgm2 = 0;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 25 * 2e-5, v.wheel_inertia_kgm2);
}

/* Where all are driven, only wheels with an inertia of their own need the rotor added to that. */
static void a_rotor_is_added_to_the_inertia_that_a_wheel_has(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    v.wheel[0].own_inertia_kgm2 = REAL(0.02);
    v.wheel[1].own_inertia_kgm2 = 1;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 0.02 + 25 * 2e-5, v.wheel[0].own_inertia_kgm2);
    ASSERT_NEAR(ROUNDING, 1 + 25 * 2e-5, v.wheel[1].own_inertia_kgm2);
    TEST_ASSERT_TRUE(v.wheel[2].own_inertia_kgm2 == 0);
    ASSERT_NEAR(ROUNDING, 0.009 + 25 * 2e-5, v.wheel_inertia_kgm2);
}

static void the_first_wheel_gets_its_rotor_beside_one_without_a_motor(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    v.wheel[2].undriven = true;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    ASSERT_NEAR(ROUNDING, 0.009 + 25 * 2e-5, v.wheel[0].own_inertia_kgm2);
    TEST_ASSERT_TRUE(v.wheel[2].own_inertia_kgm2 == 0);
}

static void what_lies_beyond_the_last_wheel_is_neither_read_nor_written(void) {
    const laconic_motor m = good_motor();
    for (int driven = 0; driven < 2; driven++) {
        laconic_vehicle v = three_wheels();
        v.wheel[0].undriven = driven == 0;
        v.wheel[3].own_inertia_kgm2 = -1;
        v.wheel[3].undriven = driven == 1;
        const laconic_wheel before = v.wheel[3];
        ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
        TEST_ASSERT_EQUAL_MEMORY(&before, &v.wheel[3], sizeof before);
        ASSERT_NEAR(ROUNDING, 0.009 + (driven ? 25 * 2e-5 : 0), v.wheel_inertia_kgm2);
        v.wheel[3].own_inertia_kgm2 = 0;
        const laconic_wheel empty = v.wheel[3];
        ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
        TEST_ASSERT_EQUAL_MEMORY(&empty, &v.wheel[3], sizeof empty);
    }
}

/* One wheel fewer than there may be: the last place is no wheel, and is not asked. */
static void all_but_one_of_the_wheels_that_there_can_be_are_those(void) {
    laconic_vehicle v = three_wheels();
    const laconic_motor m = good_motor();
    while (v.wheel_count < LACONIC_MAX_WHEELS - 1) v.wheel[v.wheel_count++] = v.wheel[0];
    v.wheel[v.wheel_count].own_inertia_kgm2 = -1;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
    TEST_ASSERT_TRUE(v.wheel[v.wheel_count].own_inertia_kgm2 == -1);
}

static void a_motor_that_is_fitted_again_takes_the_place_of_the_first(void) {
    laconic_vehicle v = three_wheels();
    laconic_motor m = good_motor();
    m.rotor_inertia_kgm2 = 0;
    for (int k = 0; k < 2; k++) {
        ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &m, &why));
        TEST_ASSERT_TRUE(v.drive.winding_resistance_ohm == 2);
        ASSERT_NEAR(ROUNDING, 25 * 0.001, v.drive.viscous_friction_Nms);
        ASSERT_NEAR(ROUNDING, 0.25, v.motor_gain_Nm_per_V);
        ASSERT_NEAR(ROUNDING, 0.175, v.motor_damping_Nms);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_data_sheet_becomes_gain_damping_and_inertia);
    RUN_TEST(a_gear_that_reverses_negates_the_gain);
    RUN_TEST(a_rotor_turns_with_each_of_as_many_wheels_as_there_may_be);
    RUN_TEST(every_number_that_is_not_finite_is_named);
    RUN_TEST(resistance_must_be_positive_and_the_gear_not_zero);
    RUN_TEST(friction_and_rotor_inertia_must_not_be_negative);
    RUN_TEST(a_motor_whose_constants_leave_the_range_or_add_energy_is_refused);
    RUN_TEST(a_motor_without_back_emf_may_pull_either_way);
    RUN_TEST(a_back_emf_of_the_wrong_sign_is_refused_even_where_friction_outweighs_it);
    RUN_TEST(a_negative_wheel_inertia_is_refused_before_the_rotors_inertia_hides_it);
    RUN_TEST(a_motor_is_fitted_to_the_wheels_that_there_can_be);
    RUN_TEST(a_negative_inertia_of_a_wheel_is_refused_by_its_number);
    RUN_TEST(wheels_without_inertia_get_the_rotors);
    RUN_TEST(a_rotor_is_added_to_the_inertia_that_a_wheel_has);
    RUN_TEST(the_first_wheel_gets_its_rotor_beside_one_without_a_motor);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_neither_read_nor_written);
    RUN_TEST(all_but_one_of_the_wheels_that_there_can_be_are_those);
    RUN_TEST(a_motor_that_is_fitted_again_takes_the_place_of_the_first);
    return UNITY_END();
}
