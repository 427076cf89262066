/* Tests of wheels that differ, through the whole core: radius, inertia, gain and damping of each wheel, and wheels
 * without a motor. The reference is the paper's equation with a row, an inertia and a motor for each wheel. */
#include "methods.h"

static laconic_refusal why;

static laconic_vehicle unlike(void) { return with_own_wheels(with_motors(mecanum())); }

/* Deterministic numbers in (−1, 1). */
static uint32_t seed;
static double number(void) {
    seed = seed * 1664525U + 1013904223U;
    return (double)(seed >> 8) / 8388608.0 - 1.0;
}

static void own_values_that_are_the_vehicles_give_the_same_bits(void) {
    laconic_vehicle v = with_motors(mecanum());
    const laconic_model common = model_of(v);
    v.wheel[1].own_radius_m = v.wheel_radius_m;
    v.wheel[2].own_inertia_kgm2 = v.wheel_inertia_kgm2;
    v.wheel[0].own_motor_gain_Nm_per_V = v.motor_gain_Nm_per_V;
    v.wheel[3].own_motor_damping_Nms = v.motor_damping_Nms;
    const laconic_model own = model_of(v);
    TEST_ASSERT_FALSE(common.rotated_twice);
    TEST_ASSERT_EQUAL_MEMORY(&common, &own, sizeof own);
}

static void derivative_is_the_papers_equation_with_each_wheels_values(void) {
    const laconic_vehicle v = unlike();
    const laconic_model m = model_of(v);
    const reference p = reference_of(&v);
    TEST_ASSERT_TRUE(m.rotated_twice);
    seed = 7;
    for (int k = 0; k < 1000; k++) {
        laconic_input input = every_input();
        laconic_real nu[3];
        laconic_rates rates;
        double y[6 + LACONIC_MAX_WHEELS] = {0}, expected[6 + LACONIC_MAX_WHEELS];
        for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(6 * number());
        for (int i = 0; i < 3; i++) nu[i] = REAL(8 * number());
        for (int i = 0; i < 3; i++) y[i] = (double)nu[i];
        const laconic_real heading = REAL(3 * number());
        y[5] = (double)heading;
        laconic_derivative(&rates, &m, nu, heading, &input);
        reference_rate(&p, y, &input, expected);
        ASSERT_NEAR_ALL(EITHER(2e-13, 3e-4), expected, rates.nu_rad_per_s2, 3);
        ASSERT_NEAR_ALL(EITHER(1e-13, 1e-4), expected + 6, rates.wheel_speed_rad_per_s, 4);
    }
}

/* GᵀAG = E, GᵀDG = diag(decay), G⁺G = E. */
static void one_basis_makes_inertia_one_and_damping_diagonal(void) {
    const laconic_vehicle vehicles[] = {unlike(), with_own_wheels(with_motors(differential_drive()))};
    for (int which = 0; which < 2; which++) {
        const laconic_model m = model_of(vehicles[which]);
        laconic_matrices x;
        ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &vehicles[which], &why));
        for (int a = 0; a < m.dof; a++)
            for (int b = 0; b < m.dof; b++) {
                double inertia = 0, damping = 0, unit = 0;
                for (int r = 0; r < 3; r++)
                    for (int c = 0; c < 3; c++)
                        inertia += (double)m.nu_of_zeta[r][a] * (double)x.inertia[r][c] * (double)m.nu_of_zeta[c][b];
                for (int i = 0; i < m.wheel_count; i++)
                    damping += (double)m.wheel_of_zeta[i][a] * (double)m.wheel_of_zeta[i][b] *
                               (double)m.motor_damping_Nms[i] / UNIT_INERTIA;
                for (int r = 0; r < 3; r++) unit += (double)m.zeta_of_nu[a][r] * (double)m.nu_of_zeta[r][b];
                ASSERT_NEAR(EITHER(4e-15, 2e-6), a == b, inertia);
                ASSERT_NEAR(EITHER(1e-14, 1e-5), a == b ? (double)m.decay_per_s[a] : 0, damping);
                ASSERT_NEAR(EITHER(4e-15, 2e-6), a == b, unit);
            }
    }
}

/* ½ M v² + ½ I_S θ'² + ½ Σ J_i χ_i'², and K = (Aν)₃ with the full A. */
static void energy_is_that_of_body_and_wheels_and_k_uses_the_full_inertia(void) {
    const laconic_vehicle v = unlike();
    const laconic_model m = model_of(v);
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    laconic_matrices x;
    laconic_real velocity[2], speed[4];
    const double yaw_rate = (double)laconic_body_velocity(&m, &state, velocity), nu[3] = {0.7, -0.4, 1.9};
    double energy = 0.5 * 0.225 * yaw_rate * yaw_rate, integral = 0;
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    laconic_wheel_speeds(&m, &state, speed);
    for (int k = 0; k < 2; k++) energy += 0.5 * MASS * (double)velocity[k] * (double)velocity[k];
    for (int i = 0; i < 4; i++) energy += 0.5 * (double)m.wheel_inertia_kgm2[i] * (double)speed[i] * (double)speed[i];
    for (int k = 0; k < 3; k++) integral += (double)x.inertia[2][k] * nu[k];
    ASSERT_NEAR(EITHER(1e-15, 1e-7), energy, laconic_energy_J(&m, &state));
    ASSERT_NEAR(EITHER(1e-14, 1e-5), integral, laconic_yaw_integral(&m, &state));
}

static void a_motion_keeps_its_velocity_when_the_motors_change(void) {
    laconic_vehicle v = unlike();
    const laconic_model before = model_of(v);
    laconic_state state = moving(&before, 0.7, -0.4, 1.9);
    laconic_real was[3], is[3];
    v.wheel[3].own_motor_damping_Nms = REAL(0.3);
    const laconic_model after = model_of(v);
    laconic_nu(&before, &state, was);
    ASSERT_STATUS(LACONIC_OK, laconic_state_carry(&state, &before, &after));
    laconic_nu(&after, &state, is);
    ASSERT_NEAR_ALL(EITHER(1e-15, 1e-6), was, is, 3);
}

static void every_method_keeps_its_order(void) {
    static const struct {
        const laconic_method *method;
        double order;
        int steps;
    } methods[] = {{&laconic_rk4, 4, 20},          {&laconic_exponential_kahan, 2, 40},
                   {&laconic_exact_flow, 2, 40},   {&laconic_exponential_kahan_4, 4, 20},
                   {&laconic_exact_flow_4, 4, 20}, {&laconic_taylor_8, 8, 12}};
    const laconic_vehicle v = unlike();
    const laconic_input input = every_input();
    if (!IN_DOUBLE) return;
    for (size_t k = 0; k < sizeof methods / sizeof methods[0]; k++)
        assert_order(methods[k].method, &v, start_with(2, 1, 4), &input, 1.0, methods[k].steps, methods[k].order);
}

static void a_quarter_of_a_second_of_auto_errs_by_rounding(void) {
    const laconic_vehicle v = unlike();
    const laconic_input input = every_input();
    const errors e = errors_of(&laconic_auto, &v, start_with(2, 1, 4), &input, 1.0, 4);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-12, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-12, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-11, 1e-5));
}

static void free_motion_keeps_energy_and_k(void) {
    laconic_vehicle v = unlike();
    v.motor_gain_Nm_per_V = v.motor_damping_Nms = 0;
    v.wheel[0].own_motor_damping_Nms = 0;
    const drift d = free_drift(&laconic_exact_flow, &v, 0.1, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-13, 1e-4));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-13, 1e-4));
}

/* Of 1e-12 of the others' damping: the slow rate keeps its digits beside the fast ones, as c2 of the third wheel alone
 * damps ν1 − ρν3, what the others leave. */
static void a_slow_rate_keeps_its_digits_beside_fast_ones(void) {
    laconic_vehicle v = with_motors(three_wheels());
    double product[2];
    for (int k = 0; k < 2; k++) {
        v.wheel[2].own_motor_damping_Nms = REAL(k == 0 ? 1e-12 : 2e-12);
        const laconic_model m = model_of(v);
        double slowest = 1e9;
        for (int a = 0; a < 3; a++)
            if ((double)m.decay_per_s[a] < slowest) slowest = (double)m.decay_per_s[a];
        product[k] = slowest;
    }
    ASSERT_NEAR(EITHER(1e-10, 1e-4), 2.0, product[1] / product[0]); /* linear in it to first order */
}

static void without_damping_one_rotation_is_enough_whatever_the_inertias(void) {
    laconic_vehicle v = mecanum();
    for (int i = 0; i < 4; i++) v.wheel[i].own_inertia_kgm2 = REAL(0.001) * REAL(1 << i);
    TEST_ASSERT_FALSE(model_of(v).rotated_twice);
    v.motor_damping_Nms = REAL(DAMPING);
    TEST_ASSERT_TRUE(model_of(v).rotated_twice);
}

static void a_damping_of_any_one_wheel_takes_a_second_rotation(void) {
    for (int i = 0; i < 4; i++) {
        laconic_vehicle v = with_motors(mecanum());
        TEST_ASSERT_FALSE(model_of(v).rotated_twice);
        v.wheel[i].own_motor_damping_Nms = REAL(0.5 * DAMPING);
        TEST_ASSERT_TRUE(model_of(v).rotated_twice);
    }
}

static void a_common_ratio_needs_one_rotation_only(void) {
    laconic_vehicle v = with_motors(mecanum());
    for (int i = 0; i < 4; i++) {
        v.wheel[i].own_inertia_kgm2 = REAL(0.001) * REAL(1 << i);
        v.wheel[i].own_motor_damping_Nms = REAL(0.02) * REAL(1 << i);
    }
    TEST_ASSERT_FALSE(model_of(v).rotated_twice);
    v.wheel_inertia_kgm2 = 0; /* without any inertia A is 1, and one rotation is enough, too */
    for (int i = 0; i < 4; i++) v.wheel[i].own_inertia_kgm2 = 0;
    TEST_ASSERT_FALSE(model_of(v).rotated_twice);
    const reference p = reference_of(&v);
    const laconic_input input = every_input();
    const double y[6 + LACONIC_MAX_WHEELS] = {0.7, -0.4, 1.9};
    const laconic_real nu[3] = {REAL(0.7), REAL(-0.4), REAL(1.9)};
    const laconic_model m = model_of(v);
    double expected[6 + LACONIC_MAX_WHEELS];
    laconic_rates rates;
    laconic_derivative(&rates, &m, nu, 0, &input);
    reference_rate(&p, y, &input, expected);
    ASSERT_NEAR_ALL(EITHER(2e-13, 3e-4), expected, rates.nu_rad_per_s2, 3);
}

static void a_wheel_without_a_motor_takes_no_voltage_and_damps_nothing(void) {
    laconic_vehicle v = with_motors(differential_drive());
    v.wheel[1].undriven = true;
    v.wheel[1].own_motor_gain_Nm_per_V = v.wheel[1].own_motor_damping_Nms = REAL(3);
    const laconic_model m = model_of(v);
    const laconic_state state = moving(&m, -DELTA / BIG_LAMBDA * 1.5, 0.8, 1.5);
    laconic_input input = no_input();
    laconic_real torque[2];
    input.voltage_V[1] = REAL(5);
    input.axle_torque_Nm[1] = REAL(0.25);
    laconic_wheel_torques(&m, &state, &input, torque);
    TEST_ASSERT_TRUE(torque[1] == REAL(0.25));
    TEST_ASSERT_TRUE(torque[0] != 0);
}

static void the_rotor_goes_to_the_driven_wheels_only(void) {
    const laconic_motor motor = {REAL(2), REAL(0.1), REAL(0.12), REAL(5), REAL(0.001), REAL(2e-4)}; /* n² J = 0.005 */
    laconic_vehicle v = three_wheels();
    v.wheel[0].own_inertia_kgm2 = REAL(0.003);
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &motor, &why));
    ASSERT_NEAR(ROUNDING, 0.014, v.wheel_inertia_kgm2);
    ASSERT_NEAR(ROUNDING, 0.008, v.wheel[0].own_inertia_kgm2);
    TEST_ASSERT_TRUE(v.wheel[1].own_inertia_kgm2 == 0);
    v = three_wheels();
    v.wheel[0].own_inertia_kgm2 = REAL(0.003);
    v.wheel[2].undriven = true;
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&v, &motor, &why));
    const laconic_model m = model_of(v);
    ASSERT_NEAR(ROUNDING, 0.008, m.wheel_inertia_kgm2[0]);
    ASSERT_NEAR(ROUNDING, 0.014, m.wheel_inertia_kgm2[1]);
    ASSERT_NEAR(ROUNDING, 0.009, m.wheel_inertia_kgm2[2]);
    v = three_wheels();
    v.wheel[1].own_inertia_kgm2 = REAL(-0.003);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_OWN_INERTIA, 2, laconic_motor_fit(&v, &motor, &why), why);
}

static void refuses(const laconic_vehicle *v, laconic_status status, laconic_field field, int item, const char *text) {
    char line[200];
    laconic_model model;
    ASSERT_REFUSED(status, field, item, laconic_prepare(&model, v, &why), why);
    laconic_message(&why, line, sizeof line);
    TEST_ASSERT_EQUAL_STRING(text, line);
}

static void bad_values_are_refused_by_their_key_in_a_scene(void) {
    laconic_vehicle v = unlike();
    v.wheel[1].own_radius_m = REAL(-0.05);
    refuses(&v, LACONIC_NEGATIVE, LACONIC_FIELD_OWN_RADIUS, 2,
            "vehicle.wheel[2].radius_m: -0.05 is negative; give 0 or a value above it");
    v = unlike();
    v.wheel[3].own_inertia_kgm2 = NOT_A_NUMBER;
    refuses(&v, LACONIC_NOT_FINITE, LACONIC_FIELD_OWN_INERTIA, 4,
            "vehicle.wheel[4].inertia_kgm2: NaN is not a finite number; give a number");
    v = unlike();
    v.wheel[0].own_motor_gain_Nm_per_V = INFINITE;
    refuses(&v, LACONIC_NOT_FINITE, LACONIC_FIELD_OWN_MOTOR_GAIN, 1,
            "vehicle.wheel[1].motor_gain_Nm_per_V: infinity is not a finite number; give a number");
    v = unlike();
    v.wheel[2].own_motor_damping_Nms = REAL(-1);
    refuses(&v, LACONIC_NEGATIVE, LACONIC_FIELD_OWN_MOTOR_DAMPING, 3,
            "vehicle.wheel[3].motor_damping_Nms: -1 is negative; give 0 or a value above it");
}

static void a_value_that_leaves_the_range_is_named(void) {
    laconic_vehicle v = unlike();
    laconic_model model;
    v.wheel[1].own_radius_m = REAL(EITHER(1e-200, 1e-30));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_OWN_RADIUS, 2, laconic_prepare(&model, &v, &why), why);
    v = unlike();
    v.wheel[0].own_inertia_kgm2 = REAL(EITHER(1e200, 1e30));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_OWN_INERTIA, 1, laconic_prepare(&model, &v, &why), why);
    v = unlike();
    v.wheel[3].own_motor_gain_Nm_per_V = REAL(EITHER(-1e200, -1e30));
    refuses(&v, LACONIC_OVERFLOW, LACONIC_FIELD_OWN_MOTOR_GAIN, 4,
            "vehicle.wheel[4].motor_gain_Nm_per_V: a result leaves the range of " LACONIC_REAL_NAME
            " precision; check inputs and units");
    v = unlike();
    v.mass_kg = REAL(EITHER(1e300, 1e35));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_MASS, 0, laconic_prepare(&model, &v, &why), why);
}

/* Wheels beyond wheel_count are not read, whatever stands there. */
static void values_beyond_the_last_wheel_are_not_read(void) {
    laconic_vehicle v = unlike();
    v.wheel[4].own_radius_m = v.wheel[5].own_inertia_kgm2 = NOT_A_NUMBER;
    const laconic_model m = model_of(v), clean = model_of(unlike());
    TEST_ASSERT_EQUAL_MEMORY(&clean, &m, sizeof m);
}

/* Of one wheel with its own inertia the vehicle's does not count, larger or smaller. */
static void a_single_wheel_s_own_inertia_takes_the_vehicle_s_place(void) {
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = bare_body(), own;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1, 0.05, 0.3, 1.1);
        own = v;
        own.wheel[0].own_inertia_kgm2 = v.wheel_inertia_kgm2 * REAL(k == 0 ? 0.125 : 8);
        v.wheel_inertia_kgm2 = own.wheel[0].own_inertia_kgm2;
        const laconic_model wanted = model_of(v), found = model_of(own);
        laconic_matrices x[2];
        ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x[0], &v, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x[1], &own, &why));
        TEST_ASSERT_TRUE(x[0].lambda_wheel == x[1].lambda_wheel);
        TEST_ASSERT_EQUAL_MEMORY(wanted.inertia, found.inertia, sizeof wanted.inertia);
        TEST_ASSERT_EQUAL_MEMORY(wanted.nu_of_zeta, found.nu_of_zeta, sizeof wanted.nu_of_zeta);
    }
}

/* In shares of the largest number with a finite square. */
static void rows_count_with_all_their_wheels_and_velocities_in_the_range(void) {
    const double root = sqrt((double)LACONIC_REAL_MAX), radius[2] = {0.07 * root, 0.0895 * root};
    laconic_model m;
    for (int refused = 0; refused < 2; refused++) { /* 1/M, R and twice R, M R² */
        laconic_vehicle v = bare_body();
        v.mass_kg = REAL(1 / (0.745 * root));
        v.wheel_radius_m = REAL(radius[refused]);
        v.yaw_inertia_kgm2 = REAL(radius[refused] / (0.745 * root) * radius[refused]);
        v.wheel_inertia_kgm2 = 0;
        ASSERT_STATUS(refused ? LACONIC_OVERFLOW : LACONIC_OK, laconic_prepare(&m, &v, &why));
    }
    for (int i = 0; i < 3; i++) { /* two rows, each with a length of 0.6 */
        laconic_vehicle v = mecanum();
        v.wheel_inertia_kgm2 = 0;
        v.wheel[i].own_radius_m = v.wheel[3].own_radius_m = REAL(RADIUS / (0.42 * root));
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&m, &v, &why), why);
    }
}

/* Two gains that leave the range together; whether M R² has an inverse within it or not. */
static void a_number_that_fits_by_itself_is_not_named(void) {
    const double gain = 0.7 * sqrt((double)LACONIC_REAL_MAX);
    for (int small = 0; small < 2; small++) {
        laconic_vehicle v = mecanum();
        laconic_model m;
        v.wheel_radius_m = small ? EITHER(REAL(1e-80), REAL(1e-11)) : REAL(10);
        v.wheel_inertia_kgm2 = 0;
        for (int i = 0; i < 4; i++) v.wheel[i].own_motor_gain_Nm_per_V = REAL(gain);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&m, &v, &why), why);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(own_values_that_are_the_vehicles_give_the_same_bits);
    RUN_TEST(derivative_is_the_papers_equation_with_each_wheels_values);
    RUN_TEST(one_basis_makes_inertia_one_and_damping_diagonal);
    RUN_TEST(energy_is_that_of_body_and_wheels_and_k_uses_the_full_inertia);
    RUN_TEST(a_motion_keeps_its_velocity_when_the_motors_change);
    RUN_TEST(every_method_keeps_its_order);
    RUN_TEST(a_quarter_of_a_second_of_auto_errs_by_rounding);
    RUN_TEST(free_motion_keeps_energy_and_k);
    RUN_TEST(a_slow_rate_keeps_its_digits_beside_fast_ones);
    RUN_TEST(without_damping_one_rotation_is_enough_whatever_the_inertias);
    RUN_TEST(a_damping_of_any_one_wheel_takes_a_second_rotation);
    RUN_TEST(a_common_ratio_needs_one_rotation_only);
    RUN_TEST(a_wheel_without_a_motor_takes_no_voltage_and_damps_nothing);
    RUN_TEST(the_rotor_goes_to_the_driven_wheels_only);
    RUN_TEST(bad_values_are_refused_by_their_key_in_a_scene);
    RUN_TEST(a_value_that_leaves_the_range_is_named);
    RUN_TEST(values_beyond_the_last_wheel_are_not_read);
    RUN_TEST(a_single_wheel_s_own_inertia_takes_the_vehicle_s_place);
    RUN_TEST(rows_count_with_all_their_wheels_and_velocities_in_the_range);
    RUN_TEST(a_number_that_fits_by_itself_is_not_named);
    return UNITY_END();
}
