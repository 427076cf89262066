/* Tests of normal_loads.c: statics with points that lift. */
#include "friction_vehicle.h"

#include "slipping.h"

static laconic_friction friction_of(laconic_vehicle v) {
    const laconic_model model = model_of(v);
    laconic_friction f;
    ASSERT_STATUS(LACONIC_OK, laconic_friction_of(&f, &model, &v, &why));
    return f;
}

static double sum_of_loads(const laconic_friction *f, const normal_loads *loads) {
    double sum = 0;
    for (int32_t i = 0; i < f->point_count; i++) sum += (double)loads->carried_N[i];
    return sum;
}

static void at_rest_three_wheels_share_the_weight(void) {
    const laconic_friction f = friction_of(robotino(0.5, 0, 0));
    const laconic_real none_N[2] = {0, 0};
    normal_loads loads;
    laconic_normal_loads(&loads, &f, none_N);
    for (int i = 0; i < 3; i++) ASSERT_NEAR(EITHER(1e-12, 1e-4), 20 * LACONIC_GRAVITY_M_PER_S2 / 3, loads.carried_N[i]);
}

static void the_ground_s_pull_below_the_centre_of_mass_moves_load(void) {
    const laconic_friction f = friction_of(skid(0.5));
    const laconic_real forward_N[2] = {40, 0};
    normal_loads loads;
    laconic_normal_loads(&loads, &f, forward_N);
    ASSERT_NEAR(EITHER(1e-11, 1e-4), -40 * 0.1 / (2 * 0.3),
                (double)loads.carried_N[0] - 20 * LACONIC_GRAVITY_M_PER_S2 / 4);
    ASSERT_NEAR(EITHER(1e-11, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2, sum_of_loads(&f, &loads));
}

/* Of 20 kg, and of 20 g, whose points carry less than a newton in all. */
static void a_wheel_that_lifts_carries_nothing_and_the_others_carry_the_weight(void) {
    for (int light = 0; light < 2; light++) {
        laconic_vehicle v = robotino(0.5, 0, 0);
        const double share = light ? 1e-3 : 1;
        const laconic_real forward_N[2] = {REAL(400 * share), 0};
        normal_loads loads;
        v.com_z_m = REAL(0.3);
        v.mass_kg *= REAL(share);
        v.yaw_inertia_kgm2 *= REAL(share);
        const laconic_friction f = friction_of(v);
        laconic_normal_loads(&loads, &f, forward_N);
        int lifted = 0;
        for (int i = 0; i < 3; i++) {
            if (loads.statics_N[i] < 0) TEST_ASSERT_TRUE(loads.carried_N[i] == 0);
            lifted += loads.statics_N[i] < 0;
            TEST_ASSERT_TRUE(loads.carried_N[i] >= 0);
        }
        TEST_ASSERT_TRUE(lifted > 0);
        ASSERT_NEAR(EITHER(1e-10, 1e-3) * share, 20 * share * LACONIC_GRAVITY_M_PER_S2, sum_of_loads(&f, &loads));
    }
}

static void on_a_slope_only_the_part_across_the_ground_loads(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    const laconic_real none_N[2] = {0, 0};
    normal_loads loads;
    v.ground.slope_rad = REAL(0.5);
    const laconic_friction f = friction_of(v);
    laconic_normal_loads(&loads, &f, none_N);
    ASSERT_NEAR(EITHER(1e-10, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2 * cos(0.5), sum_of_loads(&f, &loads));
}

/* A vehicle on one wheel tips over: what the ground pushes turns it off that wheel. Nothing is divided by. */
static void where_all_points_lift_nothing_is_carried(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    const laconic_real forward_N[2] = {10000, 0};
    normal_loads loads;
    v.wheel_count = 1;
    const laconic_friction f = friction_of(v);
    laconic_normal_loads(&loads, &f, forward_N);
    TEST_ASSERT_TRUE(loads.statics_N[0] < 0 && loads.carried_N[0] == 0);
}

/* Two wheels in line with the centre of mass, but for a hair, carry all; the third is lifted by rounding, or more. */
static void a_load_below_zero_by_rounding_carries_nothing_and_has_not_lifted(void) {
    const double parts[2] = {0.5, 2};
    for (int k = 0; k < 2; k++) {
        const laconic_real none_N[2] = {0, 0};
        const double arm_m = 0.2, weight_N = 20 * LACONIC_GRAVITY_M_PER_S2;
        laconic_vehicle v = robotino(0.5, 0, 0);
        normal_loads loads;
        v.wheel_count = 0;
        for (int i = 0; i < 3; i++)
            add_wheel(&v, LACONIC_WHEEL_ROLLER, i < 2 ? 0.2 - 0.4 * i : 0, i < 2 ? 0 : arm_m, 0, PI / 2);
        v.com_y_m = REAL(-parts[k] * (double)LACONIC_RANK_TOLERANCE * arm_m);
        const laconic_friction f = friction_of(v);
        laconic_normal_loads(&loads, &f, none_N);
        ASSERT_NEAR(0.1 * (double)LACONIC_RANK_TOLERANCE * weight_N,
                    -parts[k] * (double)LACONIC_RANK_TOLERANCE * weight_N, loads.statics_N[2]);
        TEST_ASSERT_TRUE(loads.carried_N[2] == 0);
        ASSERT_NEAR(EITHER(1e-12, 1e-4), weight_N / 2, loads.carried_N[0]);
        if (k == 0) /* still the whole wrench's statics: nothing was shared again */
            TEST_ASSERT_TRUE(loads.statics_N[0] + loads.statics_N[1] > loads.carried_N[0] + loads.carried_N[1]);
    }
}

static void where_a_load_is_no_number_nothing_is_carried(void) {
    const laconic_friction f = friction_of(robotino(0.5, 0, 0));
    const laconic_real pull_N[2] = {NOT_A_NUMBER, 0};
    normal_loads loads;
    laconic_normal_loads(&loads, &f, pull_N);
    for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(isnan(loads.statics_N[i]) && loads.carried_N[i] == 0);
}

/* All wheels and supports that there can be, and those beyond fewer of them. */
static void points_are_as_many_as_the_vehicle_has(void) {
    const laconic_real forward_N[2] = {2000, 0};
    laconic_vehicle v = robotino(0.5, 0, 0);
    normal_loads loads;
    memset(&loads, 0xFF, sizeof loads);
    const laconic_friction few = friction_of(v);
    laconic_normal_loads(&loads, &few, forward_N);
    for (int i = 3; i < LACONIC_SLIP_POINTS; i++)
        TEST_ASSERT_TRUE(isnan(loads.statics_N[i]) && isnan(loads.carried_N[i]));
    v.wheel_count = 0;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.3 * cos(i), 0.3 * sin(i), i, PI / 2);
    v.support_count = LACONIC_MAX_SUPPORTS;
    for (int i = 0; i < LACONIC_MAX_SUPPORTS; i++) {
        v.support[i].x_m = REAL(-0.2 * cos(i));
        v.support[i].y_m = REAL(-0.2 * sin(i));
    }
    const laconic_friction many = friction_of(v);
    laconic_normal_loads(&loads, &many, forward_N);
    int lifted = 0;
    for (int i = 0; i < LACONIC_SLIP_POINTS; i++) lifted += loads.statics_N[i] < 0;
    TEST_ASSERT_TRUE(lifted > 0 && lifted < LACONIC_SLIP_POINTS);
    ASSERT_NEAR(EITHER(1e-10, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2, sum_of_loads(&many, &loads));
}

/* A wheel in front lifts, and the two supports behind it cannot hold the moment: they carry the weight all the same. */
static void supports_that_cannot_hold_the_moment_carry_the_weight(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    const laconic_real forward_N[2] = {400, 0};
    normal_loads loads;
    v.com_z_m = REAL(0.3);
    v.wheel_count = 0;
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.2, 0, -PI / 2, PI / 4);
    v.support_count = 2;
    for (int i = 0; i < 2; i++) {
        v.support[i].x_m = REAL(-0.2);
        v.support[i].y_m = REAL(i == 0 ? 0.1 : -0.1);
    }
    const laconic_friction f = friction_of(v);
    laconic_normal_loads(&loads, &f, forward_N);
    TEST_ASSERT_TRUE(loads.statics_N[0] < 0 && loads.carried_N[0] == 0);
    for (int i = 1; i < 3; i++) {
        TEST_ASSERT_TRUE(fabs((double)loads.carried_N[i] - (double)loads.statics_N[i]) > 1);
        ASSERT_NEAR(EITHER(1e-10, 1e-3), 10 * LACONIC_GRAVITY_M_PER_S2, loads.carried_N[i]);
    }
}

/* Two points of which one would be pulled by just what counts as rounding: it stays, and the other's load is not solved
 * for again. */
static void a_load_below_zero_by_just_the_tolerance_is_rounding(void) {
    const laconic_real none_N[2] = {0, 0};
    for (int beyond = 0; beyond < 2; beyond++) {
        normal_loads loads;
        laconic_friction f;
        memset(&f, 0, sizeof f);
        f.point_count = 2;
        f.radius_m = f.weight_N = f.point_row[1][0] = 1;
        f.normal_load_of_wrench[0][0] = -LACONIC_RANK_TOLERANCE * (1 + REAL(beyond) * 2 * LACONIC_EPSILON);
        f.normal_load_of_wrench[1][0] = REAL(0.5);
        laconic_normal_loads(&loads, &f, none_N);
        ASSERT_NEAR(beyond ? ROUNDING : 0, beyond ? 1 : 0.5, loads.statics_N[1]);
        ASSERT_NEAR(ROUNDING, 1, loads.carried_N[1]);
        TEST_ASSERT_TRUE(loads.carried_N[0] == 0);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(at_rest_three_wheels_share_the_weight);
    RUN_TEST(the_ground_s_pull_below_the_centre_of_mass_moves_load);
    RUN_TEST(a_wheel_that_lifts_carries_nothing_and_the_others_carry_the_weight);
    RUN_TEST(on_a_slope_only_the_part_across_the_ground_loads);
    RUN_TEST(where_all_points_lift_nothing_is_carried);
    RUN_TEST(a_load_below_zero_by_rounding_carries_nothing_and_has_not_lifted);
    RUN_TEST(where_a_load_is_no_number_nothing_is_carried);
    RUN_TEST(points_are_as_many_as_the_vehicle_has);
    RUN_TEST(supports_that_cannot_hold_the_moment_carry_the_weight);
    RUN_TEST(a_load_below_zero_by_just_the_tolerance_is_rounding);
    return UNITY_END();
}
