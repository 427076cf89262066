/* Tests of contact.c at the ends of its ranges: constants that cannot be squared, reactions beyond the scalar's range,
 * and as many wheels as there may be. */
#include "vehicles.h"

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
    RUN_TEST(arms_so_short_that_forces_leave_the_range_are_refused);
    RUN_TEST(brakes_whose_torque_leaves_the_range_are_refused);
    RUN_TEST(points_so_near_that_loads_leave_the_range_are_refused);
    RUN_TEST(one_margin_that_is_nan_makes_that_of_all);
    RUN_TEST(as_many_wheels_as_there_may_be_hold_a_push);
    return UNITY_END();
}
