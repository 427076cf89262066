/* Tests of carried.c: an error that was, in the coordinates of another model. */
#include "estimate_parts.h"
#include "estimates.h"

/* Velocity of the body's origin, or with an error of travel its way, and the yaw. */
static void of_origin(double motion[3], const laconic_model *m, const laconic_real zeta[3]) {
    const double ahead = (double)dot(vec(m->velocity_of_zeta[0]), vec(zeta));
    const double aside = (double)dot(vec(m->velocity_of_zeta[1]), vec(zeta));
    const double yaw = (double)dot(vec(m->yaw_rate_of_zeta), vec(zeta));
    motion[0] = ahead + yaw * (double)m->com_y_m;
    motion[1] = aside - yaw * (double)m->com_x_m;
    motion[2] = yaw;
}

/* Another mass in another place. */
static laconic_vehicle changed(laconic_vehicle v) {
    v.payload.mass_kg = REAL(8);
    v.payload.x_m = REAL(0.15);
    v.payload.y_m = REAL(-0.2);
    v.payload.yaw_inertia_kgm2 = REAL(0.4);
    return v;
}

/* ν, and so an error of it, is of the same motion of the body's origin in either model; the place is that of S, and an
 * error of the heading turns what lies between the one and the other. */
static void an_error_is_of_the_same_motion_in_another_model(void) {
    const laconic_vehicle v = with_motors(three_wheels()), other = changed(v);
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    double velocity[2][3], way[2][3];
    for (int k = 0; k < 3; k++) {
        estimate.zeta[k] = REAL(0.3 - 0.2 * k);
        estimate.travel[k] = REAL(0.1 * k - 0.25);
    }
    estimate.place_m[0] = REAL(0.5);
    estimate.place_m[1] = REAL(-0.7);
    plant.state.heading.fraction = laconic_binary_angle_of(REAL(0.6));
    const laconic_plant before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &other, &why));
    laconic_estimate carried = estimate;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&carried, &before, &plant, NULL, &why));
    of_origin(velocity[0], &before.model, estimate.zeta);
    of_origin(velocity[1], &plant.model, carried.zeta);
    of_origin(way[0], &before.model, estimate.travel);
    of_origin(way[1], &plant.model, carried.travel);
    for (int k = 0; k < 3; k++) {
        ASSERT_NEAR(10 * ROUNDING, velocity[0][k], velocity[1][k]);
        ASSERT_NEAR(10 * ROUNDING, way[0][k], way[1][k]);
    }
    const double x = (double)(plant.model.com_x_m - before.model.com_x_m), c = cos(0.6), s = sin(0.6);
    const double y = (double)(plant.model.com_y_m - before.model.com_y_m);
    ASSERT_NEAR(10 * ROUNDING, 0.5 - way[0][2] * (s * x + c * y), carried.place_m[0]);
    ASSERT_NEAR(10 * ROUNDING, -0.7 + way[0][2] * (c * x - s * y), carried.place_m[1]);
}

static laconic_estimate carried_with(const laconic_plant *before, const laconic_plant *plant,
                                     laconic_estimate estimate) {
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, before, plant, NULL, &why));
    return estimate;
}

/* Of sizes each component counts with the magnitude of what an error along it becomes. */
static void doubts_and_floors_are_carried_as_sizes(void) {
    bool turned = false;
    for (int n = 0; n < 24; n++) {
        laconic_vehicle v = with_motors(n % 2 == 0 ? three_wheels() : mecanum()), other;
        if (n % 3 == 0) v = with_own_wheels(v);
        v.payload.mass_kg = REAL(25 - n);
        v.payload.x_m = REAL(0.3 - 0.2 * (n % 4));
        v.payload.y_m = REAL(0.1 * (n % 3) - 0.2);
        other = v;
        other.payload.mass_kg = REAL(1 + n);
        other.payload.x_m = REAL(0.1 * (n % 5) - 0.2);
        other.payload.y_m = REAL(0.3 - 0.1 * (n % 7));
        other.payload.yaw_inertia_kgm2 = REAL(0.02 * n * n);
        laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
        const laconic_plant before = plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &other, &why));
        laconic_estimate estimate = estimate_of(&before, 16);
        double expected[3] = {0, 0, 0}, every = 0;
        for (int k = 0; k < 3; k++) {
            laconic_estimate along = estimate_of(&before, 16);
            along.zeta[k] = 1;
            along = carried_with(&before, &plant, along);
            for (int i = 0; i < 3; i++) expected[i] += fabs((double)along.zeta[i]) * (0.1 + 0.2 * k);
            for (int i = 0; i < 3; i++) every += fabs((double)along.zeta[i]) / sqrt(3);
            turned |= along.zeta[k] < 0;
            estimate.doubt_zeta[k] = estimate.doubt_travel[k] = REAL(0.1 + 0.2 * k);
        }
        estimate.floor_zeta = REAL(0.5);
        estimate.floor_travel = REAL(0.25);
        estimate = carried_with(&before, &plant, estimate);
        ASSERT_NEAR_ALL(10 * ROUNDING, expected, estimate.doubt_zeta, 3);
        ASSERT_NEAR_ALL(10 * ROUNDING, expected, estimate.doubt_travel, 3);
        ASSERT_NEAR(10 * ROUNDING, 0.5 * every, estimate.floor_zeta);
        ASSERT_NEAR(10 * ROUNDING, 0.25 * every, estimate.floor_travel);
    }
    TEST_ASSERT_TRUE(turned); /* an axis of one model is against that of the other */
}

/* A refusal is told where there is one: with friction, too, a change that is made leaves it as it was. */
static void a_change_that_is_made_tells_no_refusal(void) {
    laconic_vehicle v = with_motors(mecanum());
    v.ground.friction_coefficient = REAL(0.5);
    laconic_vehicle loaded = v;
    loaded.payload.mass_kg = REAL(2);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    const laconic_plant before = plant;
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    memset(&why, 0, sizeof why);
    why.status = LACONIC_NOT_FINITE;
    why.item = 7;
    const laconic_refusal as_it_was = why;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    TEST_ASSERT_EQUAL_MEMORY(&as_it_was, &why, sizeof why);
}

/* The change takes S outwards, where a place is known to fewer digits, and the body drives back: no window ends out
 * there, and none does where its first step is refused. */
static void a_step_that_is_refused_after_a_change_leaves_nothing_in_the_estimate(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_vehicle loaded = v;
    loaded.payload.mass_kg = 30;
    loaded.payload.x_m = REAL(-1);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    const laconic_plant before = plant;
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    estimate = carried_with(&before, &plant, estimate);
    laconic_plant other = plant;
    laconic_estimate without = estimate;
    laconic_input input = no_input();
    input.voltage_V[0] = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_estimate_run(&estimate, &plant, &input, 1, &why));
    input = no_input();
    input.body_force_N[0] = 50;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 50, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&without, &other, &input, 50, &why));
    const laconic_errors found = errors_now(&estimate, &plant), expected = errors_now(&without, &other);
    TEST_ASSERT_EQUAL_MEMORY(&expected.now, &found.now, sizeof found.now);
    TEST_ASSERT_EQUAL_MEMORY(&expected.largest, &found.largest, sizeof found.largest);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_error_is_of_the_same_motion_in_another_model);
    RUN_TEST(doubts_and_floors_are_carried_as_sizes);
    RUN_TEST(a_change_that_is_made_tells_no_refusal);
    RUN_TEST(a_step_that_is_refused_after_a_change_leaves_nothing_in_the_estimate);
    return UNITY_END();
}
