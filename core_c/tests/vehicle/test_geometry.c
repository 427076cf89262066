/* Tests of geometry.c: payload, and the rows of wheels and constraints. */
#include "geometry.h"
#include "vehicles.h"

static void a_body_without_payload_has_the_papers_numbers(void) {
    const laconic_vehicle v = three_wheels();
    body b;
    laconic_body_of(&b, &v);
    ASSERT_NEAR(ROUNDING, MASS, b.mass_kg);
    ASSERT_NEAR(4 * ROUNDING, BIG_LAMBDA, b.yaw_scale);
    ASSERT_NEAR(ROUNDING, SMALL_LAMBDA * SMALL_LAMBDA, b.wheel_scale_square);
    ASSERT_NEAR(ROUNDING, DELTA * RADIUS, b.com_y_m);
}

/* 10 kg at (0, 0.02) and 5 kg at (0.3, −0.1): S moves a third of the way; the parts lie d = √(0.3² + 0.12²) apart. */
static void a_payload_moves_mass_centre_and_inertia_by_the_parallel_axes(void) {
    laconic_vehicle v = three_wheels();
    const double inertia = 0.225 + 0.04 + 10.0 * 5.0 / 15.0 * (0.09 + 0.0144);
    body b;
    v.payload.mass_kg = REAL(5);
    v.payload.x_m = REAL(0.3);
    v.payload.y_m = REAL(-0.1);
    v.payload.yaw_inertia_kgm2 = REAL(0.04);
    laconic_body_of(&b, &v);
    ASSERT_NEAR(ROUNDING, 15.0, b.mass_kg);
    ASSERT_NEAR(ROUNDING, 0.1, b.com_x_m);
    ASSERT_NEAR(ROUNDING, -0.02, b.com_y_m);
    ASSERT_NEAR(10 * ROUNDING, sqrt(inertia / (15 * RADIUS * RADIUS)), b.yaw_scale);
    ASSERT_NEAR(ROUNDING, 0.009 / (15 * RADIUS * RADIUS), b.wheel_scale_square);
}

/* Of the largest: exactly 1 where they are alike, also without any inertia. */
static void inertias_are_given_as_shares_of_the_largest(void) {
    laconic_vehicle v = mecanum();
    real share[4];
    for (int none = 0; none < 2; none++) {
        if (none) v.wheel_inertia_kgm2 = REAL(0);
        laconic_inertia_shares(share, &v);
        for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE(share[i] == 1);
    }
    for (int i = 0; i < 4; i++) v.wheel[i].own_inertia_kgm2 = REAL(i == 2 ? 0.5 : 0.125);
    laconic_inertia_shares(share, &v);
    for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE((double)share[i] == (i == 2 ? 1 : 0.25));
}

static void a_wheel_pulls_along_its_rollers_axis(void) {
    const laconic_vehicle v = mecanum();
    direction pull;
    const laconic_real sine = laconic_pull_direction(&pull, &v.wheel[0]);
    ASSERT_NEAR(ROUNDING, sqrt(0.5), sine);
    ASSERT_NEAR(ROUNDING, sqrt(0.5), pull.cosine);
    ASSERT_NEAR(ROUNDING, -sqrt(0.5), pull.sine);
}

static void a_fixed_wheel_pulls_where_it_rolls_whatever_its_roller_angle(void) {
    laconic_vehicle v = caster();
    direction pull;
    v.wheel[0].roller_rad = REAL(0.3);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)laconic_pull_direction(&pull, &v.wheel[0]));
    ASSERT_NEAR(ROUNDING, 1.0, pull.cosine);
    ASSERT_NEAR(ROUNDING, 0.0, pull.sine);
}

/* A wheel's speed is that of its centre along the rollers' normal, whatever the frame: compare with velocities. */
static void rows_are_the_velocity_of_the_wheels_centre(void) {
    const laconic_vehicle v = three_wheels();
    const double nu[3] = {0.7, -0.4, 1.1};
    body b;
    laconic_body_of(&b, &v);
    for (int i = 0; i < 3; i++) {
        const double px = (double)v.wheel[i].x_m, py = (double)v.wheel[i].y_m - DELTA * RADIUS;
        const double yaw = nu[2] / BIG_LAMBDA;
        const double vx = RADIUS * nu[0] - yaw * py, vy = RADIUS * nu[1] + yaw * px;
        const double axle = (double)v.wheel[i].axle_rad;
        real row[3], constraint[2][3];
        laconic_wheel fixed = v.wheel[i];
        fixed.kind = LACONIC_WHEEL_FIXED;
        laconic_wheel_row(row, &b, &v.wheel[i]);
        ASSERT_NEAR(4 * ROUNDING, (-sin(axle) * vx + cos(axle) * vy) / RADIUS,
                    nu[0] * (double)row[0] + nu[1] * (double)row[1] + nu[2] * (double)row[2]);
        TEST_ASSERT_EQUAL_INT(1, laconic_constraint_rows(constraint, &b, &fixed));
        ASSERT_NEAR(4 * ROUNDING, (cos(axle) * vx + sin(axle) * vy) / RADIUS,
                    nu[0] * (double)constraint[0][0] + nu[1] * (double)constraint[0][1] +
                        nu[2] * (double)constraint[0][2]);
    }
}

/* Tests of matrices.c against the paper's examples. */

static laconic_matrices x;
static laconic_refusal why;

static void the_three_wheel_example_has_the_papers_matrices(void) {
    const laconic_vehicle v = three_wheels();
    const double rows[3][3] = {{0, 1, SIGMA}, {0, -1, SIGMA}, {-1, 0, RHO}};
    const double square = SMALL_LAMBDA * SMALL_LAMBDA;
    const double a3 = 1 + (2 * SIGMA * SIGMA + RHO * RHO) * square;
    const double inertia[3][3] = {{1 + square, 0, -RHO * square}, {0, 1 + 2 * square, 0}, {-RHO * square, 0, a3}};
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    ASSERT_NEAR(4 * ROUNDING, BIG_LAMBDA, x.lambda_yaw);
    ASSERT_NEAR(ROUNDING, SMALL_LAMBDA, x.lambda_wheel);
    TEST_ASSERT_EQUAL_INT(0, x.constraint_count);
    for (int i = 0; i < 3; i++) {
        ASSERT_NEAR_ALL(ROUNDING, rows[i], x.wheel_rows[i], 3);
        ASSERT_NEAR_ALL(ROUNDING, inertia[i], x.inertia[i], 3);
    }
}

static void the_inverse_inertia_is_the_inverse(void) {
    const laconic_vehicle v = mecanum();
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < 3; k++) sum += (double)x.inertia[r][k] * (double)x.inverse_inertia[k][c];
            ASSERT_NEAR(8 * ROUNDING, r == c ? 1 : 0, sum);
        }
}

static void mecanum_rows_are_the_textbooks(void) {
    const laconic_vehicle v = mecanum();
    const double lever = (0.2 + 0.15) / (RADIUS * BIG_LAMBDA);
    const double rows[4][3] = {{1, -1, -lever}, {1, 1, lever}, {1, 1, -lever}, {1, -1, lever}};
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    for (int i = 0; i < 4; i++) ASSERT_NEAR_ALL(10 * ROUNDING, rows[i], x.wheel_rows[i], 3);
}

static void the_differential_drive_has_the_papers_rows_and_constraint(void) {
    const laconic_vehicle v = differential_drive();
    const double rows[2][3] = {{0, 1, DRIVE_SIGMA}, {0, -1, DRIVE_SIGMA}};
    const double lateral[3] = {1, 0, DELTA / BIG_LAMBDA};
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, NULL));
    TEST_ASSERT_EQUAL_INT(2, x.constraint_count);
    for (int i = 0; i < 2; i++) ASSERT_NEAR_ALL(ROUNDING, rows[i], x.wheel_rows[i], 3);
    for (int k = 0; k < 3; k++) {
        ASSERT_NEAR(ROUNDING, lateral[k], x.constraint_rows[0][k]);
        ASSERT_NEAR(ROUNDING, -lateral[k], x.constraint_rows[1][k]);
    }
}

static void a_locked_wheel_adds_its_own_row_as_a_constraint(void) {
    laconic_vehicle v = differential_drive();
    v.wheel[0].locked = true;
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    TEST_ASSERT_EQUAL_INT(3, x.constraint_count);
    ASSERT_NEAR_ALL(ROUNDING, x.wheel_rows[0], x.constraint_rows[1], 3);
    ASSERT_NEAR(EITHER(1e-9, 1e-6), -1.0, x.constraint_rows[2][0]);
}

static void a_locked_wheel_whose_row_leaves_the_range_is_refused(void) {
    laconic_vehicle v = three_wheels();
    v.wheel[0].locked = true; /* the model does not contain its row, A does */
    v.wheel[0].y_m = v.wheel[0].x_m = REAL(EITHER(1.3e154, 1.8e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_matrices_of(&x, &v, &why), why);
}

/* Its row twice, as a wheel's and as a constraint: each alone is within the range, with a square that is, too. */
static void sizes_of_rows_add_up_whatever_they_are_of(void) {
    laconic_vehicle v = three_wheels();
    v.wheel[0].locked = true;
    v.wheel[0].x_m = REAL(EITHER(1.0e154, 1.3e19) * RADIUS * BIG_LAMBDA);
    v.wheel_inertia_kgm2 = 0;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_matrices_of(&x, &v, &why), why);
    v.wheel[0].x_m *= REAL(0.4);
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
}

static void a_refused_vehicle_changes_nothing(void) {
    laconic_vehicle v = three_wheels();
    laconic_matrices before;
    memset(&x, 7, sizeof x);
    before = x;
    v.mass_kg = 0;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_MASS, 0, laconic_matrices_of(&x, &v, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &x, sizeof x);
}

/* A locked wheel's row counts twice, as a wheel's and as a constraint: most of what fits. λ counts beside it, of which
 * A does not hold the square where the wheel is large; Λ, which is larger, does not. */
static void beside_rows_lambda_of_the_wheels_counts_and_that_of_the_body_does_not(void) {
    const double part = EITHER(2.18e153, 3e18); /* a little less than a sixth of what fits */
    for (int heavy = 0; heavy < 2; heavy++) {
        laconic_vehicle v = bare_body();
        v.wheel_radius_m = 1;
        v.mass_kg = REAL(1 / part);
        v.yaw_inertia_kgm2 = heavy ? v.mass_kg : REAL(5.3 * part);
        v.wheel_inertia_kgm2 = REAL(EITHER(1e-320, 1e-43));
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, 0, PI / 2);
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, 0, PI / 2);
        v.wheel[0].locked = true;
        v.wheel[0].own_radius_m = REAL((heavy ? 1 / 2.4 : 0.5) / part);
        v.wheel[1].own_radius_m = REAL(EITHER(1e153, 1e18));
        if (heavy) v.wheel[1].own_inertia_kgm2 = REAL(2.5 * part);
        ASSERT_STATUS(heavy ? LACONIC_OVERFLOW : LACONIC_OK, laconic_matrices_of(&x, &v, &why));
        if (!heavy) ASSERT_NEAR(1e-6 * part, sqrt(5.3) * part, x.lambda_yaw);
        v.wheel[1].own_inertia_kgm2 = 0;
        ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, &why));
    }
}

/* A constraint is the largest number that fits, the inertia about half a place of it, the wheels' rows about half a
 * place of the inertia: what is added to them before decides. */
static void in_single_sizes_add_up_in_their_order_to_the_end_of_the_range(void) {
    static const struct {
        double lever, inertia_kgm2;
        laconic_status status;
    } wheels[] = {{0x1p14 - 2.5, 0x1.000cp-19, LACONIC_OK},
                  {0x1p14 - 2.5, 0x1.000c02p-19, LACONIC_OVERFLOW},
                  {0x1p14 - 1, 0x1.fffffcp-20, LACONIC_OK},
                  {0x1p14 - 1, 0x1.fffffep-20, LACONIC_OVERFLOW}};
    for (size_t n = 0; n < sizeof wheels / sizeof wheels[0] && !IN_DOUBLE; n++) {
        laconic_vehicle v = bare_body();
        v.mass_kg = v.yaw_inertia_kgm2 = REAL(0x1p-30);
        v.wheel_radius_m = 1;
        v.wheel_inertia_kgm2 = REAL(wheels[n].inertia_kgm2);
        add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0x1p40 - 0x1p64, 0, 0);
        add_wheel(&v, LACONIC_WHEEL_ROLLER, wheels[n].lever, 0, 0, PI / 2);
        ASSERT_STATUS(wheels[n].status, laconic_matrices_of(&x, &v, &why));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_body_without_payload_has_the_papers_numbers);
    RUN_TEST(a_payload_moves_mass_centre_and_inertia_by_the_parallel_axes);
    RUN_TEST(inertias_are_given_as_shares_of_the_largest);
    RUN_TEST(a_wheel_pulls_along_its_rollers_axis);
    RUN_TEST(a_fixed_wheel_pulls_where_it_rolls_whatever_its_roller_angle);
    RUN_TEST(rows_are_the_velocity_of_the_wheels_centre);
    RUN_TEST(the_three_wheel_example_has_the_papers_matrices);
    RUN_TEST(the_inverse_inertia_is_the_inverse);
    RUN_TEST(mecanum_rows_are_the_textbooks);
    RUN_TEST(the_differential_drive_has_the_papers_rows_and_constraint);
    RUN_TEST(a_locked_wheel_adds_its_own_row_as_a_constraint);
    RUN_TEST(a_locked_wheel_whose_row_leaves_the_range_is_refused);
    RUN_TEST(sizes_of_rows_add_up_whatever_they_are_of);
    RUN_TEST(a_refused_vehicle_changes_nothing);
    RUN_TEST(beside_rows_lambda_of_the_wheels_counts_and_that_of_the_body_does_not);
    RUN_TEST(in_single_sizes_add_up_in_their_order_to_the_end_of_the_range);
    return UNITY_END();
}
