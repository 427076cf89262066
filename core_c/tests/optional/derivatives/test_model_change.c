/* Tests of how a model changes with its vehicle, beside those of the steps that follow from it
 * (test_step_derivatives.c): of which numbers it is no change at all. */
#include "laconic/derivatives.h"
#include "vehicles.h"

static laconic_model_change change_of(const laconic_model *m, const laconic_vehicle *v, const laconic_vehicle *by) {
    laconic_model_change change;
    memset(&change, 0, sizeof change);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&change, m, v, by));
    return change;
}

/* A change of every number of the body and of the wheels that it has. */
static laconic_vehicle some_change_of(const laconic_vehicle *v) {
    laconic_vehicle by;
    memset(&by, 0, sizeof by);
    by.mass_kg = REAL(1);
    by.yaw_inertia_kgm2 = REAL(0.02);
    by.com_x_m = REAL(0.01);
    by.com_y_m = REAL(-0.02);
    by.wheel_radius_m = REAL(0.004);
    by.wheel_inertia_kgm2 = REAL(0.001);
    for (int i = 0; i < v->wheel_count; i++) by.wheel[i].axle_rad = REAL(0.1);
    return by;
}

/* Fixed, locked and of another radius: each would bind the vehicle or turn with it. */
static void add_what_is_not_there(laconic_vehicle *v, laconic_vehicle *by) {
    for (int i = v->wheel_count; i < LACONIC_MAX_WHEELS; i++) {
        v->wheel[i].kind = LACONIC_WHEEL_FIXED;
        v->wheel[i].locked = true;
        v->wheel[i].x_m = REAL(0.3);
        v->wheel[i].axle_rad = REAL(0.8);
        v->wheel[i].own_radius_m = REAL(0.02);
        by->wheel[i].x_m = by->wheel[i].axle_rad = by->wheel[i].own_radius_m = REAL(0.7);
    }
}

static void wheels_that_a_vehicle_has_not_change_nothing(void) {
    const laconic_vehicle vehicles[] = {three_wheels(), differential_drive(), caster(), bare_body()};
    for (int n = 0; n < 4; n++) {
        laconic_vehicle v = with_motors(vehicles[n]), by = some_change_of(&v);
        const laconic_model m = model_of(v);
        const laconic_model_change without = change_of(&m, &v, &by);
        add_what_is_not_there(&v, &by);
        const laconic_model_change with = change_of(&m, &v, &by);
        TEST_ASSERT_EQUAL_MEMORY(&without, &with, sizeof with);
    }
}

/* A fixed wheel behind one with rollers, and before it. */
static void the_change_of_a_constraint_is_that_of_its_wheel_whatever_its_number(void) {
    laconic_model_change change[2];
    for (int fixed = 0; fixed < 2; fixed++) {
        laconic_vehicle v = bare_body(), by = bare_body();
        for (int i = 0; i < 2; i++)
            if (i == fixed)
                add_wheel(&v, LACONIC_WHEEL_FIXED, 0.1, -0.05, 0.3, 0);
            else
                add_wheel(&v, LACONIC_WHEEL_ROLLER, -0.2, 0.15, 1, PI / 2);
        by.wheel[fixed].x_m = REAL(0.7);
        by.wheel[fixed].axle_rad = REAL(-0.4);
        const laconic_model m = model_of(v);
        change[fixed] = change_of(&m, &v, &by);
    }
    for (int i = 0; i < 3; i++) {
        ASSERT_NEAR_ALL(20 * ROUNDING, change[0].nu_of_zeta[i], change[1].nu_of_zeta[i], 3);
        TEST_ASSERT_TRUE(fabs((double)change[0].nu_of_zeta[i][0]) + fabs((double)change[0].nu_of_zeta[i][1]) > 0.01);
    }
}

/* A locked wheel holds the vehicle alike whatever its radius, though its row grows as the radius shrinks. */
static void a_constraint_changes_alike_however_long_its_row_is(void) {
    laconic_vehicle v = mecanum(), by = some_change_of(&v);
    laconic_model_change change[4];
    v.com_x_m = REAL(0.03);
    v.wheel[0].locked = true;
    for (int n = 0; n < 4; n++) {
        v.wheel[0].own_radius_m = REAL(RADIUS * pow(10, -2 * n));
        const laconic_model m = model_of(v);
        change[n] = change_of(&m, &v, &by);
        for (int i = 0; i < 3; i++) {
            ASSERT_NEAR_ALL(EITHER(1e-14, 1e-6), change[0].nu_of_zeta[i], change[n].nu_of_zeta[i], 3);
            ASSERT_NEAR_ALL(EITHER(1e-14, 1e-6), change[0].zeta_of_nu[i], change[n].zeta_of_nu[i], 3);
        }
    }
}

/* The change of the wheel's constraint leaves the range, and with it all that moves. The rate of the axis that the
 * wheel took away stays 0. */
static void an_axis_that_constraints_took_away_keeps_its_rate_even_where_theirs_leave_the_range(void) {
    laconic_vehicle v = bare_body(), by;
    v.wheel_radius_m = REAL(0.1);
    v.yaw_inertia_kgm2 = v.mass_kg / 16;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0, PI / 2, 0);
    memset(&by, 0, sizeof by);
    by.wheel[0].x_m = LACONIC_REAL_MAX;
    const laconic_model m = model_of(v);
    const laconic_model_change change = change_of(&m, &v, &by);
    TEST_ASSERT_EQUAL_INT(2, m.dof);
    TEST_ASSERT_FALSE(isfinite((double)change.damping_per_s[0][0] + (double)change.damping_per_s[1][1]));
    TEST_ASSERT_TRUE(change.damping_per_s[2][2] == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(wheels_that_a_vehicle_has_not_change_nothing);
    RUN_TEST(the_change_of_a_constraint_is_that_of_its_wheel_whatever_its_number);
    RUN_TEST(a_constraint_changes_alike_however_long_its_row_is);
    RUN_TEST(an_axis_that_constraints_took_away_keeps_its_rate_even_where_theirs_leave_the_range);
    return UNITY_END();
}
