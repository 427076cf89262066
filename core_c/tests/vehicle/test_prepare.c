/* Tests of prepare.c: the basis of the allowed motions, and vehicles that cannot be prepared. */
#include "elementary.h"
#include "vehicles.h"

static laconic_refusal why;

static void columns_are_orthonormal_in_the_inertia(laconic_vehicle v) {
    const laconic_model m = model_of(v);
    laconic_matrices x;
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    for (int a = 0; a < m.dof; a++)
        for (int b = 0; b < m.dof; b++) {
            double product = 0;
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    product += (double)m.nu_of_zeta[r][a] * (double)x.inertia[r][c] * (double)m.nu_of_zeta[c][b];
            ASSERT_NEAR(EITHER(4e-15, 2e-6), a == b ? 1 : 0, product);
        }
}

static void the_basis_makes_inertia_the_unit_matrix(void) {
    columns_are_orthonormal_in_the_inertia(three_wheels());
    columns_are_orthonormal_in_the_inertia(mecanum());
    columns_are_orthonormal_in_the_inertia(differential_drive());
    columns_are_orthonormal_in_the_inertia(caster());
    columns_are_orthonormal_in_the_inertia(bare_body());
}

static void the_basis_makes_damping_diagonal(void) {
    const laconic_model m = model_of(with_motors(mecanum()));
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double sum = 0;
            for (int i = 0; i < m.wheel_count; i++)
                sum += (double)m.wheel_of_zeta[i][a] * (double)m.wheel_of_zeta[i][b] * DAMPING / UNIT_INERTIA;
            ASSERT_NEAR(EITHER(1e-14, 1e-5), a == b ? (double)m.decay_per_s[a] : 0, sum);
        }
}

/* Shares of inertia and of damping that differ at one wheel alone, either way, and by less than the first wheel's. */
static void the_basis_makes_damping_diagonal_where_one_wheel_damps_otherwise(void) {
    const double shares[2][3] = {{0.5, 0.6, 1}, {0.5, 0.8, 1}};
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = with_motors(three_wheels());
        for (int i = 0; i < 3; i++) {
            v.wheel[i].own_inertia_kgm2 = REAL(0.009 * shares[k][i]);
            v.wheel[i].own_motor_damping_Nms = REAL(DAMPING * shares[1 - k][i]);
        }
        const laconic_model m = model_of(v);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double sum = 0;
                for (int i = 0; i < 3; i++)
                    sum += (double)m.wheel_of_zeta[i][a] * (double)m.wheel_of_zeta[i][b] * shares[1 - k][i];
                ASSERT_NEAR(EITHER(1e-14, 1e-5), a == b ? (double)m.decay_per_s[a] : 0, sum * DAMPING / UNIT_INERTIA);
            }
    }
}

static void every_constraint_is_built_in(void) {
    const laconic_vehicle v = differential_drive();
    const laconic_model m = model_of(v);
    laconic_matrices x;
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    for (int i = 0; i < x.constraint_count; i++)
        for (int k = 0; k < 3; k++) {
            double slip = 0;
            for (int r = 0; r < 3; r++) slip += (double)x.constraint_rows[i][r] * (double)m.nu_of_zeta[r][k];
            ASSERT_NEAR(2 * ROUNDING, 0, slip);
        }
}

/* There ν2 is decoupled: X22 = 2. The others are the 2×2 problem of [[1, −ρ], [−ρ, 2σ² + ρ²]]. */
static void damping_rates_of_the_three_wheel_example_are_the_closed_form(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const double c = DAMPING / UNIT_INERTIA, square = SMALL_LAMBDA * SMALL_LAMBDA;
    const double trace = 1 + 2 * SIGMA * SIGMA + RHO * RHO, det = 2 * SIGMA * SIGMA;
    const double root = sqrt(trace * trace / 4 - det);
    const double x[3] = {2, trace / 2 + root, trace / 2 - root};
    for (int wanted = 0; wanted < 3; wanted++) {
        double nearest = 1e9;
        for (int k = 0; k < 3; k++) {
            const double off = fabs((double)m.decay_per_s[k] - c * x[wanted] / (1 + square * x[wanted])) +
                               fabs((double)m.inertia[k] - (1 + square * x[wanted]));
            if (off < nearest) nearest = off;
        }
        ASSERT_NEAR(4 * ROUNDING, 0, nearest);
    }
    ASSERT_NEAR(8 * ROUNDING, (1 + square * x[0]) / (1 + square * x[2]), laconic_condition_number(&m));
}

/* Wheels that are alike have the same share in inertia and damping, also where either is 0. */
static void axes_are_the_same_without_damping(void) {
    for (int inert = 0; inert < 2; inert++) {
        laconic_vehicle v = mecanum();
        v.com_x_m = REAL(0.13);
        v.com_y_m = REAL(-0.07);
        v.wheel_inertia_kgm2 = inert ? REAL(0.01) : 0;
        v.motor_damping_Nms = REAL(DAMPING);
        const laconic_model damped = model_of(v);
        v.motor_damping_Nms = 0;
        const laconic_model free = model_of(v);
        TEST_ASSERT_EQUAL_MEMORY(damped.nu_of_zeta, free.nu_of_zeta, sizeof free.nu_of_zeta);
        for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(free.decay_per_s[k] == 0 && damped.decay_per_s[k] > 0);
    }
}

static void degrees_of_freedom_are_counted(void) {
    laconic_vehicle v = differential_drive();
    TEST_ASSERT_EQUAL_INT(3, model_of(bare_body()).dof);
    TEST_ASSERT_EQUAL_INT(3, model_of(three_wheels()).dof);
    TEST_ASSERT_EQUAL_INT(2, model_of(v).dof);
    TEST_ASSERT_EQUAL_INT(2, model_of(caster()).dof);
    v.wheel[0].locked = true;
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
    v = three_wheels();
    v.wheel[2].locked = true;
    TEST_ASSERT_EQUAL_INT(2, model_of(v).dof);
}

static void columns_beyond_the_degrees_of_freedom_are_zero(void) {
    const laconic_model m = model_of(differential_drive());
    for (int i = 0; i < 3; i++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)m.nu_of_zeta[i][2]);
    for (int i = 0; i < 2; i++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)m.wheel_of_zeta[i][2]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)m.decay_per_s[2]);
}

static void axle_lines_that_agree_to_rounding_count_once(void) {
    laconic_vehicle v = differential_drive();
    v.wheel[1].axle_rad += REAL(EITHER(1e-11, 1e-6));
    TEST_ASSERT_EQUAL_INT(2, model_of(v).dof);
    v.wheel[1].axle_rad += REAL(EITHER(1e-6, 1e-2));
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
}

static void a_locked_wheel_does_not_rotate(void) {
    laconic_vehicle v = three_wheels();
    v.wheel[1].locked = true;
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)model_of(v).wheel_of_zeta[1][k]);
}

static void three_fixed_wheels_whose_axles_do_not_meet_prevent_every_motion(void) {
    laconic_vehicle v = bare_body();
    laconic_model model, before;
    memset(&model, 5, sizeof model);
    before = model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.1, 0.0, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.1, PI / 2, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.2, 0.2, 1.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.3, 0.2, 2.0, 0.0);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 3, laconic_prepare(&model, &v, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof model);
}

/* The first two turn the body about the origin. The third stands 0.2 ahead of it and should roll to the left; its axle
 * is turned from that by an angle whose sine is what it would slide. */
static void a_refusal_of_every_motion_has_the_wheel_and_what_part_of_its_way_it_would_slide(void) {
    laconic_vehicle v = bare_body();
    laconic_model model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.1, 0.0, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.1, PI / 2, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, -0.2, PI / 2, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.2, 0.0, EITHER(1e-6, 1e-3), 0.0);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 4, laconic_prepare(&model, &v, &why), why);
    ASSERT_NEAR(EITHER(1e-12, 1e-7), EITHER(1e-6, 1e-3), why.value);
    v.wheel[3].axle_rad = REAL(PI / 6);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 4, laconic_prepare(&model, &v, &why), why);
    ASSERT_NEAR(ROUNDING, 0.5, why.value);
}

static void fixed_wheels_on_parallel_axle_lines_are_refused_unless_they_slip(void) {
    laconic_vehicle v = bare_body();
    laconic_model model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.15, 0.2, -PI / 2, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.15, -0.2, PI / 2, 0.0);
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
    add_wheel(&v, LACONIC_WHEEL_FIXED, -0.15, 0.2, -PI / 2, 0.0);
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 3, laconic_prepare(&model, &v, &why), why);
    ASSERT_NEAR(ROUNDING, 0.3, why.value); /* its line from that of the first */
    v.wheel[3].locked = true;              /* which it has not */
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 3, laconic_prepare(&model, &v, &why), why);
    v.wheel[2].axle_rad = REAL(-0.4); /* its line meets the others': the vehicle rotates about that point */
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
    v.wheel[2].axle_rad = REAL(-PI / 2);
    v.ground.friction_coefficient = REAL(0.5);
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
}

static void a_brake_may_leave_straight_motion_alone(void) {
    laconic_vehicle v = bare_body();
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, -PI / 2, 0.0);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.3, 0.0, 0.0, PI / 2);
    v.wheel[1].locked = true;
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
}

static void what_the_vehicle_check_refuses_is_refused(void) {
    laconic_vehicle v = three_wheels();
    laconic_model model;
    v.wheel[2].x_m = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_WHEEL_X, 3, laconic_prepare(&model, &v, &why), why);
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_prepare(&model, &v, NULL));
}

static void inertias_too_far_apart_for_the_precision_are_refused(void) {
    laconic_vehicle v = three_wheels();
    laconic_model model;
    v.wheel[2].kind = LACONIC_WHEEL_FIXED; /* so that not every motion rotates the wheels */
    v.wheel_count = 1;
    v.wheel_inertia_kgm2 = REAL(EITHER(1e28, 1e11));
    ASSERT_REFUSED(LACONIC_ILL_CONDITIONED, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    TEST_ASSERT_TRUE((double)why.value > EITHER(1e27, 1e9));
    v.wheel_inertia_kgm2 = REAL(EITHER(1e20, 1e6));
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
}

static void numbers_that_leave_the_range_are_refused(void) {
    laconic_vehicle v = three_wheels();
    laconic_model model;
    v.mass_kg = REAL(EITHER(1e-250, 1e-25));
    v.wheel_radius_m = REAL(EITHER(1e-100, 1e-12));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    v = three_wheels();
    v.mass_kg = REAL(EITHER(1e150, 1e19));
    v.wheel_radius_m = REAL(EITHER(1e90, 1e11)); /* M R² overflows */
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    v = three_wheels();
    v.mass_kg = v.yaw_inertia_kgm2 = REAL(EITHER(1e150, 1e19)); /* the same beside a body as heavy */
    v.wheel_radius_m = REAL(EITHER(1e80, 1e10));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    v = three_wheels();
    v.com_x_m = REAL(EITHER(1e100, 1e15)); /* its fourth power would */
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
}

static void a_wheel_that_the_vehicle_has_not_is_not_blamed(void) {
    laconic_vehicle v = three_wheels();
    laconic_model model;
    v.mass_kg = REAL(EITHER(1e150, 1e19));
    v.wheel_radius_m = REAL(EITHER(1e90, 1e11));
    v.wheel[3].own_radius_m = REAL(EITHER(1e-150, 1e-19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    v.wheel_count = 4;
    v.wheel[3].kind = LACONIC_WHEEL_ROLLER;
    v.wheel[3].roller_rad = REAL(PI / 2);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_OWN_RADIUS, 4, laconic_prepare(&model, &v, &why), why);
}

/* In units in which M R² is 1 its torque is counted beside 1, so that both leave the range together. */
static void a_wheel_just_within_the_range_is_blamed_with_its_own_number(void) {
    laconic_vehicle v = three_wheels();
    laconic_model model;
    v.mass_kg = v.wheel_radius_m = 1;
    v.wheel[1].own_inertia_kgm2 = EITHER(REAL(1.2e154), REAL(1.7e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_OWN_INERTIA, 2, laconic_prepare(&model, &v, &why), why);
}

static void a_wheel_at_the_end_of_the_range_is_refused_and_never_gives_nan(void) {
    laconic_vehicle v = differential_drive();
    laconic_model model;
    v.wheel[0].x_m = LACONIC_REAL_MAX;
    v.com_x_m = REAL(EITHER(-1.3e154, -1.8e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_WHEEL_X, 1, laconic_prepare(&model, &v, &why), why);
}

/* Two wheels under the mass centre leave the rotation alone, so that 1/Λ and the one yaw rate fill the range: two
 * thirds of it by each are too much, where either alone would be taken. */
static void a_body_that_turns_alone_is_refused_by_both_of_its_yaw_scales(void) {
    const double part = EITHER(1e154, 1.3e19); /* the root of the range is 1.34e154, or 1.84e19 */
    laconic_vehicle v = bare_body();
    laconic_model model;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, PI / 2, 0.0);
    v.wheel_inertia_kgm2 = 0;
    v.mass_kg = v.wheel_radius_m = REAL(EITHER(1e50, 1e6));
    v.yaw_inertia_kgm2 = REAL((double)v.mass_kg / part / part * (double)v.mass_kg * (double)v.mass_kg);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    v.yaw_inertia_kgm2 *= 9; /* a third */
    TEST_ASSERT_EQUAL_INT(1, model_of(v).dof);
}

/* The radius of gyration of this body is 0 in the scalar type, so a wheel under its centre has the lever 0/0. */
static void a_body_without_any_extent_is_refused_and_never_gives_nan(void) {
    laconic_vehicle v = caster();
    laconic_model model, before;
    memset(&model, 5, sizeof model);
    before = model;
    v.mass_kg = REAL(EITHER(1e150, 1e18));
    v.yaw_inertia_kgm2 = LACONIC_REAL_MIN;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_prepare(&model, &v, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof model);
}

/* Rates many decades apart all keep their digits, since ΞᵀΞ is never formed. */
static void a_slow_rate_keeps_its_digits_beside_a_fast_one(void) {
    const double small = EITHER(1e-9, 1e-5); /* angle between the rolling directions of the two wheels */
    laconic_vehicle v = with_motors(bare_body());
    laconic_model m;
    v.wheel_inertia_kgm2 = 0;
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, 0.0, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, small, PI / 2);
    m = model_of(v);
    double least = HUGE_VAL;
    for (int k = 0; k < 3; k++)
        if (m.decay_per_s[k] > 0 && (double)m.decay_per_s[k] < least) least = (double)m.decay_per_s[k];
    /* two unit vectors at a small angle ε: eigenvalues of ΞᵀΞ are 2 and ε²/2 */
    ASSERT_NEAR(0.02, 1.0, least / (DAMPING / UNIT_INERTIA * small * small / 2));
}

static void sixteen_wheels_and_none_are_both_a_vehicle(void) {
    laconic_vehicle v = with_motors(bare_body());
    const laconic_model none = model_of(v);
    laconic_model many;
    for (int i = 0; i < 3; i++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)none.decay_per_s[i]);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.3 * cos(0.4 * i), 0.3 * sin(0.4 * i), 0.4 * i, i % 2 ? PI / 4 : -PI / 4);
    many = model_of(v);
    TEST_ASSERT_EQUAL_INT(LACONIC_MAX_WHEELS, many.wheel_count);
    columns_are_orthonormal_in_the_inertia(v);
}

static void wheels_far_away_or_all_on_one_spot_give_numbers(void) {
    laconic_vehicle v = with_motors(three_wheels());
    laconic_model m;
    v.wheel[0].x_m = REAL(EITHER(1e7, 1e2));
    m = model_of(v);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(isfinite(m.decay_per_s[k]));
    v = with_motors(bare_body());
    for (int k = 0; k < 5; k++) add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1, 0.1, 0.7, PI / 2);
    m = model_of(v);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(isfinite(m.decay_per_s[k]));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_basis_makes_inertia_the_unit_matrix);
    RUN_TEST(the_basis_makes_damping_diagonal);
    RUN_TEST(the_basis_makes_damping_diagonal_where_one_wheel_damps_otherwise);
    RUN_TEST(every_constraint_is_built_in);
    RUN_TEST(damping_rates_of_the_three_wheel_example_are_the_closed_form);
    RUN_TEST(axes_are_the_same_without_damping);
    RUN_TEST(degrees_of_freedom_are_counted);
    RUN_TEST(columns_beyond_the_degrees_of_freedom_are_zero);
    RUN_TEST(axle_lines_that_agree_to_rounding_count_once);
    RUN_TEST(a_locked_wheel_does_not_rotate);
    RUN_TEST(three_fixed_wheels_whose_axles_do_not_meet_prevent_every_motion);
    RUN_TEST(a_refusal_of_every_motion_has_the_wheel_and_what_part_of_its_way_it_would_slide);
    RUN_TEST(fixed_wheels_on_parallel_axle_lines_are_refused_unless_they_slip);
    RUN_TEST(a_brake_may_leave_straight_motion_alone);
    RUN_TEST(what_the_vehicle_check_refuses_is_refused);
    RUN_TEST(inertias_too_far_apart_for_the_precision_are_refused);
    RUN_TEST(numbers_that_leave_the_range_are_refused);
    RUN_TEST(a_wheel_that_the_vehicle_has_not_is_not_blamed);
    RUN_TEST(a_wheel_just_within_the_range_is_blamed_with_its_own_number);
    RUN_TEST(a_wheel_at_the_end_of_the_range_is_refused_and_never_gives_nan);
    RUN_TEST(a_body_that_turns_alone_is_refused_by_both_of_its_yaw_scales);
    RUN_TEST(a_body_without_any_extent_is_refused_and_never_gives_nan);
    RUN_TEST(a_slow_rate_keeps_its_digits_beside_a_fast_one);
    RUN_TEST(sixteen_wheels_and_none_are_both_a_vehicle);
    RUN_TEST(wheels_far_away_or_all_on_one_spot_give_numbers);
    return UNITY_END();
}
