/* Tests of the sizes that an estimate tells of an error that is known. */
#include "estimate_parts.h"
#include "estimates.h"

/* A body that is light to turn between wheels that are heavy to turn: w of its model is longer than g. */
static laconic_vehicle light_to_turn(void) {
    laconic_vehicle v = three_wheels();
    v.yaw_inertia_kgm2 = REAL(0.002);
    for (int i = 0; i < 3; i++) {
        v.wheel[i].x_m *= 4;
        v.wheel[i].y_m *= 4;
    }
    return v;
}

/* The components of ν and the wheels' angles are of the one that is farthest off, and of no row beyond them. */
static void assert_sizes(laconic_vehicle v, vector zeta, vector travel) {
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    const laconic_model *m = &plant.model;
    double nu = 0, wheel = 0;
    store(estimate.zeta, zeta);
    store(estimate.travel, travel);
    estimate.place_m[0] = REAL(0.3);
    estimate.place_m[1] = REAL(-0.4);
    for (int k = 0; k < 3; k++) nu = larger(nu, fabs((double)dot(vec(m->nu_of_zeta[k]), zeta)));
    for (int i = 0; i < v.wheel_count; i++) wheel = larger(wheel, fabs((double)dot(vec(m->wheel_of_zeta[i]), travel)));
    const laconic_errors found = errors_now(&estimate, &plant);
    ASSERT_NEAR(10 * ROUNDING, nu, found.now.nu_rad_per_s);
    ASSERT_NEAR(10 * ROUNDING, wheel, found.now.wheel_angle_rad);
    ASSERT_NEAR(10 * ROUNDING, fabs((double)dot(vec(m->yaw_rate_of_zeta), travel)), found.now.heading_rad);
    ASSERT_NEAR(10 * ROUNDING, 0.5, found.now.place_m);
}

static void sizes_are_of_the_component_that_is_farthest_off(void) {
    const laconic_vehicle v[3] = {three_wheels(), mecanum(), light_to_turn()};
    const laconic_model light = model_of(v[2]);
    TEST_ASSERT_TRUE(size(vec(light.gyro)) > size(vec(light.nu_of_zeta[2])));
    for (int k = 0; k < 3; k++) {
        const vector along = scaled(REAL(1) / size(vec(light.gyro)), vec(light.gyro));
        assert_sizes(v[k], along, scaled(REAL(-0.5), along));
        assert_sizes(v[k], vector_of(REAL(0.3), REAL(-0.2), REAL(0.1)), vector_of(REAL(0.2), REAL(0.7), REAL(-0.4)));
        assert_sizes(v[k], vector_of(REAL(-0.1), REAL(0.8), REAL(0.1)), vector_of(REAL(-1), REAL(0.1), REAL(0.1)));
    }
}

/* Doubts and floors are sizes of their own: they are added, whatever the sign of a row. */
static void doubts_and_floors_are_added(void) {
    const laconic_vehicle v = three_wheels();
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    const laconic_model *m = &plant.model;
    double nu = 0, farthest = 0;
    for (int k = 0; k < 3; k++) estimate.doubt_zeta[k] = REAL(0.1 * (k + 1));
    estimate.floor_zeta = REAL(0.01);
    estimate.floor_travel = REAL(0.02);
    estimate.floor_path_m = REAL(0.03);
    estimate.doubt_place_m = REAL(0.04);
    for (int k = 0; k < 3; k++) {
        double doubt = 0, row = 0; /* sums of magnitudes */
        for (int i = 0; i < 3; i++) {
            doubt += fabs((double)m->nu_of_zeta[k][i]) * 0.1 * (i + 1);
            row += fabs((double)m->nu_of_zeta[k][i]);
        }
        nu = larger(nu, doubt);
        farthest = larger(farthest, row);
    }
    const laconic_errors found = errors_now(&estimate, &plant);
    const double heading = 0.02 * (double)size(vec(m->yaw_rate_of_zeta));
    ASSERT_NEAR(10 * ROUNDING, 0.01 * farthest, found.rounding.nu_rad_per_s);
    ASSERT_NEAR(10 * ROUNDING, nu + 0.01 * farthest, found.now.nu_rad_per_s);
    ASSERT_NEAR(10 * ROUNDING, heading, found.rounding.heading_rad);
    ASSERT_NEAR(10 * ROUNDING, heading, found.now.heading_rad);
    ASSERT_NEAR(10 * ROUNDING, 0.03, found.rounding.place_m);
    ASSERT_NEAR(10 * ROUNDING, 0.07, found.now.place_m);
}

static void assert_infinite(const laconic_error *error) {
    TEST_ASSERT_TRUE(isinf(error->nu_rad_per_s) && isinf(error->place_m));
    TEST_ASSERT_TRUE(isinf(error->heading_rad) && isinf(error->wheel_angle_rad));
}

/* The largest of several numbers is given, but where one of them is NaN no other stands for it. */
static void an_error_that_is_nan_is_infinite(void) {
    const laconic_vehicle v = three_wheels();
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    for (int k = 0; k < 3; k++) estimate.zeta[k] = estimate.travel[k] = NOT_A_NUMBER;
    estimate.doubt_place_m = NOT_A_NUMBER;
    const laconic_errors found = errors_now(&estimate, &plant);
    assert_infinite(&found.now);
    assert_infinite(&found.largest);
}

static void a_rounding_that_is_nan_is_infinite(void) {
    const laconic_vehicle v = three_wheels();
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    estimate.floor_zeta = estimate.floor_travel = estimate.floor_path_m = NOT_A_NUMBER;
    laconic_errors found = errors_now(&estimate, &plant);
    assert_infinite(&found.rounding);
    assert_infinite(&found.now);
    estimate = estimate_of(&plant, 16);
    plant.state.travel[0].value = NOT_A_NUMBER; /* and with it each wheel's angle */
    found = errors_now(&estimate, &plant);
    TEST_ASSERT_TRUE(isinf(found.rounding.wheel_angle_rad));
    plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    plant.state.y_m.value = NOT_A_NUMBER;
    TEST_ASSERT_TRUE(isnan(laconic_estimate_extent(&estimate, &plant.state)));
}

/* With friction the error is what plant and twin differ by. */
static void a_twin_that_is_nan_is_infinitely_far_off(void) {
    laconic_vehicle v = with_motors(mecanum());
    v.ground.friction_coefficient = REAL(0.5);
    const laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    for (int k = 0; k < 3; k++) estimate.twin.zeta[k].value = NOT_A_NUMBER;
    TEST_ASSERT_TRUE(isinf(errors_now(&estimate, &plant).now.nu_rad_per_s));
    for (int i = 0; i < 4; i++) estimate.twin_slip.wheel_angle_rad[i].value = NOT_A_NUMBER;
    TEST_ASSERT_TRUE(isinf(errors_now(&estimate, &plant).now.wheel_angle_rad));
    TEST_ASSERT_TRUE(isinf(errors_now(&estimate, &plant).largest.wheel_angle_rad));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(sizes_are_of_the_component_that_is_farthest_off);
    RUN_TEST(doubts_and_floors_are_added);
    RUN_TEST(an_error_that_is_nan_is_infinite);
    RUN_TEST(a_rounding_that_is_nan_is_infinite);
    RUN_TEST(a_twin_that_is_nan_is_infinitely_far_off);
    return UNITY_END();
}
