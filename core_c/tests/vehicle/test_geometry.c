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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_body_without_payload_has_the_papers_numbers);
    RUN_TEST(a_payload_moves_mass_centre_and_inertia_by_the_parallel_axes);
    RUN_TEST(inertias_are_given_as_shares_of_the_largest);
    RUN_TEST(a_wheel_pulls_along_its_rollers_axis);
    RUN_TEST(a_fixed_wheel_pulls_where_it_rolls_whatever_its_roller_angle);
    RUN_TEST(rows_are_the_velocity_of_the_wheels_centre);
    return UNITY_END();
}
