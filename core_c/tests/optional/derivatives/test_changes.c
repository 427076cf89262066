/* Tests of cut_change.c: the derivatives of a step whose gain of energy was cut, against differences of the step. */
#include "divided_difference.h"
#include "step_change.h"

#include "check.h"
#include "laconic/derivatives.h"
#include "methods.h"
#include "stack.h"
#include "vehicles.h"

#define SMALL EITHER(1e-6, 4e-3)
#define CLOSE EITHER(1e-7, 1e-2)

/* exponential-kahan-4 would gain 3e-4 of the energy in this step, more than the forces can supply. */
typedef struct cut_case {
    laconic_vehicle vehicle;
    laconic_start start;
    laconic_input held;
} cut_case;

static cut_case case_under(double force_N) {
    cut_case c = {three_wheels(), start_with(0.8, -0.5, 9), no_input()};
    c.vehicle.com_x_m = REAL(0.01);
    c.held.body_force_N[1] = c.held.world_force_N[0] = REAL(force_N);
    return c;
}

static laconic_plant plant_of(const cut_case *c) {
    laconic_plant plant;
    ASSERT_STATUS(LACONIC_OK,
                  laconic_plant_start(&plant, &c->vehicle, &laconic_exponential_kahan_4, REAL(0.4), &c->start, NULL));
    return plant;
}

static double energy_of(const laconic_plant *plant) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += pow((double)plant->state.zeta[k].value, 2);
    return sum;
}

/* A along of the motion, the force in the world, the vehicle. */
static cut_case moved(cut_case c, int along, double by) {
    const double nu[3] = {0.3, -0.6, 0.5};
    if (along == 0)
        for (int k = 0; k < 3; k++) c.start.nu_rad_per_s[k] += REAL(by * nu[k]);
    if (along == 0) c.start.heading_rad += REAL(0.4 * by);
    if (along == 1) c.held.world_force_N[1] += REAL(by), c.held.body_force_N[0] -= REAL(0.5 * by);
    if (along == 2) c.vehicle.mass_kg += REAL(by), c.vehicle.yaw_inertia_kgm2 -= REAL(0.02 * by);
    if (along == 2) c.vehicle.com_x_m += REAL(0.01 * by), c.vehicle.wheel[1].axle_rad += REAL(0.1 * by);
    return c;
}

static void tangent_of(laconic_state_change *after, const cut_case *c, int along) {
    const laconic_plant plant = plant_of(c);
    laconic_state_change before;
    laconic_input input = no_input();
    laconic_vehicle vehicle;
    laconic_model_change by_model;
    memset(&before, 0, sizeof before);
    memset(&vehicle, 0, sizeof vehicle);
    if (along == 0) before.nu_rad_per_s[0] = REAL(0.3), before.nu_rad_per_s[1] = REAL(-0.6);
    if (along == 0) before.nu_rad_per_s[2] = REAL(0.5), before.heading_rad = REAL(0.4);
    if (along == 1) input.world_force_N[1] = REAL(1), input.body_force_N[0] = REAL(-0.5);
    if (along == 2) vehicle.mass_kg = REAL(1), vehicle.yaw_inertia_kgm2 = REAL(-0.02);
    if (along == 2) vehicle.com_x_m = REAL(0.01), vehicle.wheel[1].axle_rad = REAL(0.1);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&by_model, &plant.model, &c->vehicle, &vehicle));
    ASSERT_STATUS(LACONIC_OK, laconic_step_tangent(after, &plant.model, &plant.integrator, &plant.state, &c->held,
                                                   &before, &input, &by_model));
}

static void nu_after(double nu[3], const cut_case *c) {
    laconic_plant plant = plant_of(c);
    laconic_real found[3];
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &c->held, 1, NULL));
    laconic_nu(&plant.model, &plant.state, found);
    for (int k = 0; k < 3; k++) nu[k] = (double)found[k];
}

static void changes_as_differences_say(const cut_case *c, int along) {
    const cut_case high_case = moved(*c, along, SMALL), low_case = moved(*c, along, -SMALL);
    laconic_state_change after;
    double high[3], low[3], size = 0;
    tangent_of(&after, c, along);
    nu_after(high, &high_case);
    nu_after(low, &low_case);
    for (int k = 0; k < 3; k++) size = fmax(size, fabs((double)after.nu_rad_per_s[k]));
    for (int k = 0; k < 3; k++)
        ASSERT_NEAR(CLOSE * size, (high[k] - low[k]) / (2 * SMALL), (double)after.nu_rad_per_s[k]);
}

static void the_gain_is_cut(void) {
    const cut_case c = case_under(0);
    laconic_plant plant = plant_of(&c);
    const double before = energy_of(&plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &c.held, 1, NULL));
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 1, energy_of(&plant) / before);
}

static void the_tangent_along_a_motion_is_what_differences_show(void) {
    const cut_case free = case_under(0), pushed = case_under(EITHER(1e-4, 1e-3));
    changes_as_differences_say(&free, 0);
    changes_as_differences_say(&pushed, 0);
}

static void the_tangent_along_the_vehicle_is_what_differences_show(void) {
    const cut_case free = case_under(0), pushed = case_under(EITHER(1e-4, 1e-3));
    changes_as_differences_say(&free, 2);
    changes_as_differences_say(&pushed, 2);
}

/* In single the differences are so large that the forces supply the gain. */
static void the_tangent_along_weak_forces_is_what_differences_show(void) {
    const cut_case pushed = case_under(1e-4);
    laconic_state_change after;
    if (IN_DOUBLE)
        changes_as_differences_say(&pushed, 1);
    else
        tangent_of(&after, &pushed, 1);
}

/* What the step does otherwise is not touched: it has the derivatives of its method. */
static void a_step_that_is_not_cut_has_the_derivatives_of_its_method(void) {
    cut_case c = case_under(0);
    c.start = start_with(0.8, -0.5, 2); /* loses 5e-8 */
    for (int along = 0; along < 3; along++) changes_as_differences_say(&c, along);
}

/* Tests of pose_change.c at the borders of its three formulas, each of which has the last digit where it is taken. */

/* ½ j₁ of half the yaw. */
static laconic_real half_j1_at(double alpha) {
    pose_trace trace;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.yaw_rate_of_zeta[0] = 2;
    laconic_pose_trace(&trace, &m, vector_of(REAL(alpha), 0, 0), none);
    return trace.half_j1;
}

/* The quotient that larger angles take is a unit in the last place off here. */
static void up_to_one_radian_the_series_is_taken(void) {
    TEST_ASSERT_TRUE(half_j1_at(1) == REAL(EITHER(0x1.34658fea80cc5p-3, 0x1.34659p-3)));
}

/* So is in double, at these angles, the longer series. */
static void small_angles_take_the_shorter_series(void) {
    TEST_ASSERT_TRUE(half_j1_at(0.1203) == REAL(EITHER(0x1.48062765b2ba9p-6, 0x1.48062ap-6)));
    TEST_ASSERT_TRUE(half_j1_at(0.1152) == REAL(EITHER(0x1.3a27d09e06095p-6, 0x1.3a27d2p-6)));
}

/* Tests of divided_difference.h: (f(a) − f(b))/(a − b) of known functions, far apart and near. */

#define FUNCTIONS 3

static void powers(laconic_real value[], laconic_real h, laconic_real rate) {
    value[0] = rate;
    value[1] = rate * rate;
    value[2] = h * rate * rate * rate;
}

static void slopes(laconic_real value[], laconic_real h, laconic_real rate) {
    value[0] = 1;
    value[1] = 2 * rate;
    value[2] = 3 * h * rate * rate;
}

/* Of a cube it is a² + a b + b². What stood there before does not count; the number behind the last is left alone. */
static void check_at(double h, double a, double b) {
    laconic_real found[FUNCTIONS + 1];
    for (int k = 0; k <= FUNCTIONS; k++) found[k] = NOT_A_NUMBER;
    divided_difference_of(found, FUNCTIONS, powers, slopes, REAL(h), REAL(a), REAL(b));
    ASSERT_NEAR(8 * ROUNDING, 1, found[0]);
    ASSERT_NEAR(8 * ROUNDING * (a + b), a + b, found[1]);
    ASSERT_NEAR(8 * ROUNDING * h * (a + b) * (a + b), h * (a * a + a * b + b * b), found[2]);
    TEST_ASSERT_TRUE(found[FUNCTIONS] != found[FUNCTIONS]);
}

static void rates_far_apart_have_the_quotient(void) {
    check_at(1, 5, 2);
    check_at(1, 2, 5);
    check_at(0.125, 1, 40);
}

static void near_and_equal_rates_have_the_mean_of_the_slope(void) {
    check_at(0.5, 5, 4);
    check_at(0.5, 4, 5);
    check_at(2, 3, 3);
    check_at(1, 3, 2); /* just near */
}

/* Tests of decay_change.c that no step shows: what a damping that stays, and one entry of it, make of the factors. */

/* Decays so fast that slopes by them leave the range of numbers: of a damping that stays, nothing may come of them. */
static void a_damping_that_does_not_change_changes_no_factor_however_fast_it_is(void) {
    const linear_map stays = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    decay_change change, zero;
    laconic_model m;
    memset(&m, 0, sizeof m);
    memset(&change, ALL_NAN, sizeof change);
    memset(&zero, 0, sizeof zero);
    for (int k = 0; k < 3; k++) m.decay_per_s[k] = REAL(EITHER(1e170, 1e25));
    laconic_decay_change_of(&change, &m, 1, &stays);
    TEST_ASSERT_EQUAL_MEMORY(&zero, &change, sizeof change);
}

/* One entry alone, and its mirror image. */
static void an_entry_of_the_damping_changes_that_entry_of_the_factors(void) {
    const linear_map changes = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    decay_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = 2;
    m.decay_per_s[1] = 3;
    laconic_decay_change_of(&change, &m, REAL(0.5), &changes);
    const double slope = (0.5 * (1 - exp(-1.0)) / 1.0 - 0.5 * (1 - exp(-1.5)) / 1.5) / (2 - 3); /* of hφ1 */
    ASSERT_NEAR(EITHER(1e-14, 1e-6), slope, change.gain.x.y);
    ASSERT_NEAR(EITHER(1e-14, 1e-6), slope, change.gain.y.x);
    TEST_ASSERT_TRUE(change.gain.x.x == 0 && change.gain.y.y == 0 && change.gain.z.z == 0);
}

/* One entry alone, and its mirror image; h is 1. */
static decay_change change_between(double rate, double other) {
    const linear_map of_one = {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}, of_two = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    decay_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = REAL(rate);
    m.decay_per_s[1] = REAL(other);
    laconic_decay_change_of(&change, &m, 1, rate == other ? &of_one : &of_two);
    return change;
}

/* By the mean of the slope; in single the difference of the factors themselves has lost a digit. */
static void rates_that_are_just_near_keep_the_digits_of_the_slope(void) {
    const decay_change change = change_between(2, 1);
    ASSERT_NEAR(EITHER(1e-13, 1e-7), 0.7310585786300048793, change.inverse_gain.x.y);
    ASSERT_NEAR(EITHER(1e-13, 6e-8), 0.07454093588033922743, change.mean.x.y);
}

/* In single the formula of faster ones has less digits of the slope here. */
static void a_rate_that_is_not_yet_fast_keeps_the_digits_of_the_series(void) {
    const decay_change change = change_between(1, 1);
    ASSERT_NEAR(EITHER(1e-13, 6e-8), 0.07932640579220768105, change.mean.x.x);
    ASSERT_NEAR(EITHER(1e-13, 3e-7), -0.03180361292542491996, change.slope.x.x);
}

/* Tests of how a model changes with its vehicle, beside those of the steps that follow from it
 * (test_step_derivatives.c): of which numbers it is no change at all. */

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
    RUN_TEST(the_gain_is_cut);
    RUN_TEST(the_tangent_along_a_motion_is_what_differences_show);
    RUN_TEST(the_tangent_along_the_vehicle_is_what_differences_show);
    RUN_TEST(the_tangent_along_weak_forces_is_what_differences_show);
    RUN_TEST(a_step_that_is_not_cut_has_the_derivatives_of_its_method);
    RUN_TEST(up_to_one_radian_the_series_is_taken);
    RUN_TEST(small_angles_take_the_shorter_series);
    RUN_TEST(rates_far_apart_have_the_quotient);
    RUN_TEST(near_and_equal_rates_have_the_mean_of_the_slope);
    RUN_TEST(a_damping_that_does_not_change_changes_no_factor_however_fast_it_is);
    RUN_TEST(an_entry_of_the_damping_changes_that_entry_of_the_factors);
    RUN_TEST(rates_that_are_just_near_keep_the_digits_of_the_slope);
    RUN_TEST(a_rate_that_is_not_yet_fast_keeps_the_digits_of_the_series);
    RUN_TEST(wheels_that_a_vehicle_has_not_change_nothing);
    RUN_TEST(the_change_of_a_constraint_is_that_of_its_wheel_whatever_its_number);
    RUN_TEST(a_constraint_changes_alike_however_long_its_row_is);
    RUN_TEST(an_axis_that_constraints_took_away_keeps_its_rate_even_where_theirs_leave_the_range);
    return UNITY_END();
}
