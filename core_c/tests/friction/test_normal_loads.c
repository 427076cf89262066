/* Tests of normal_loads.c: statics with points that lift. */
#include "friction_vehicle.h"
#include "slipping.h"
#include "vehicles.h"

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

/* Tests of contact.c at the ends of its ranges: constants that cannot be squared, reactions beyond the scalar's range,
 * and as many wheels as there may be. */

static laconic_refusal why;

/* The largest number whose square is one, too. */
static double most(void) { return sqrt((double)LACONIC_REAL_MAX); }

/* Small enough that wheels may be smaller by as much again. */
static laconic_vehicle small_mecanum(void) {
    laconic_vehicle v = mecanum();
    v.wheel_inertia_kgm2 = 0;
    v.wheel_radius_m = REAL(1 / sqrt(most()));
    return v;
}

static void assert_contact(laconic_status expected, laconic_vehicle v) {
    laconic_contact contact;
    laconic_matrices matrices;
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&matrices, &v, &why)); /* nothing but contact refuses it */
    ASSERT_STATUS(expected, laconic_contact_prepare(&contact, &v, &why));
}

/* The arm of any wheel counts; and where rollers point either way, one does not make up for another. */
static void arms_so_short_that_forces_leave_the_range_are_refused(void) {
    for (int from = 0; from < 2; from++) {
        laconic_vehicle v = small_mecanum();
        for (int i = from; i < 2; i++) v.wheel[i].own_radius_m = REAL(3 / most());
        assert_contact(LACONIC_OK, v);
        for (int i = from; i < 2; i++) v.wheel[i].own_radius_m = REAL(0.5 / most());
        assert_contact(LACONIC_OVERFLOW, v);
    }
}

/* The brake of a huge wheel needs a torque as large. The supports stand so far off that loads are small. */
static void brakes_whose_torque_leaves_the_range_are_refused(void) {
    for (int far = 0; far < 2; far++) {
        laconic_vehicle v = mecanum();
        v.wheel[0].locked = true;
        v.support_count = 3;
        for (int i = 0; i < 3; i++) {
            v.support[i].x_m = REAL((far ? sqrt(most()) : 1) * cos(2 * PI / 3 * i));
            v.support[i].y_m = REAL((far ? sqrt(most()) : 1) * sin(2 * PI / 3 * i));
        }
        v.wheel[0].own_radius_m = REAL(0.3 * RADIUS * most());
        assert_contact(LACONIC_OK, v);
        v.wheel[0].own_radius_m = REAL(3 * RADIUS * most());
        assert_contact(LACONIC_OVERFLOW, v);
    }
}

/* A vehicle without constraints on three points that all but meet. */
static void points_so_near_that_loads_leave_the_range_are_refused(void) {
    laconic_vehicle v = bare_body();
    v.wheel_inertia_kgm2 = 0;
    v.mass_kg = REAL(most() / 10);
    v.wheel_radius_m = v.yaw_inertia_kgm2 = REAL(10 / most());
    v.support_count = 3;
    for (int near = 0; near < 2; near++) {
        const double apart = (near ? 0.5 : 20) / most();
        for (int i = 0; i < 3; i++) {
            v.support[i].x_m = REAL(apart * cos(2 * PI / 3 * i));
            v.support[i].y_m = REAL(apart * sin(2 * PI / 3 * i));
        }
        assert_contact(near ? LACONIC_OVERFLOW : LACONIC_OK, v);
    }
}

/* A wheel pulls with a force that cannot be squared, and so does its load times its friction: inf less inf. The first
 * wheel has no such force. */
static void one_margin_that_is_nan_makes_that_of_all(void) {
    laconic_vehicle v = with_motors(mecanum());
    int nan_count = 0;
    v.wheel_inertia_kgm2 = 0;
    v.com_z_m = 1;
    v.friction_coefficient = REAL(most() / 100);
    for (int sign = -1; sign < 2; sign += 2) {
        const laconic_model model = model_of(v);
        const laconic_state state = state_of(&model, start_with(0, 0, 0));
        laconic_contact contact;
        laconic_reactions out;
        laconic_input input = no_input();
        input.voltage_V[1] = REAL(sign * 1e5 * most());
        ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &v, &why));
        laconic_reactions_of(&out, &contact, &model, &state, &input);
        TEST_ASSERT_TRUE(out.along_N[0] == 0);
        if (!(v.friction_coefficient * out.normal_N[1] > LACONIC_REAL_MAX)) continue;
        nan_count++;
        TEST_ASSERT_TRUE(out.no_slip_margin_N != out.no_slip_margin_N);
    }
    TEST_ASSERT_EQUAL_INT(1, nan_count);
}

/* Fixed wheels on one axle line, pushed along it: together they hold the push. */
static void as_many_wheels_as_there_may_be_hold_a_push(void) {
    laconic_vehicle v = bare_body();
    laconic_contact contact;
    laconic_reactions out;
    laconic_input input = no_input();
    double sum = 0;
    v.com_z_m = REAL(0.12);
    v.friction_coefficient = REAL(0.6);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) add_wheel(&v, LACONIC_WHEEL_FIXED, 0.05 * (i - 7.5), 0, 0, 0);
    const laconic_model model = model_of(v);
    const laconic_state state = state_of(&model, start_with(0, 0, 0));
    input.body_force_N[0] = REAL(6);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &v, &why));
    laconic_reactions_of(&out, &contact, &model, &state, &input);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        sum += (double)out.lateral_N[i];
        ASSERT_NEAR(EITHER(1e-12, 1e-5), 0, out.along_N[i]);
    }
    ASSERT_NEAR(EITHER(1e-12, 1e-5), -6, sum);
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
    RUN_TEST(arms_so_short_that_forces_leave_the_range_are_refused);
    RUN_TEST(brakes_whose_torque_leaves_the_range_are_refused);
    RUN_TEST(points_so_near_that_loads_leave_the_range_are_refused);
    RUN_TEST(one_margin_that_is_nan_makes_that_of_all);
    RUN_TEST(as_many_wheels_as_there_may_be_hold_a_push);
    return UNITY_END();
}
