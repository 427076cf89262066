/* Tests of estimate.c where something is refused: windows, steps, their half steps, runs on their way. */
#include "estimate_parts.h"

#include "estimates.h"

static void windows_without_steps_are_refused(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, LACONIC_ESTIMATE_MOST);
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_NONE, 0,
                   laconic_estimate_start(&estimate, &plant, 0, NULL, &why), why);
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0,
                   laconic_estimate_start(&estimate, &plant, LACONIC_ESTIMATE_MOST + 1, NULL, &why), why);
    TEST_ASSERT_EQUAL_INT(LACONIC_FIELD_NONE, why.field);
    TEST_ASSERT_TRUE(why.value == LACONIC_ESTIMATE_MOST + 1 && why.limit == LACONIC_ESTIMATE_MOST);
    TEST_ASSERT_EQUAL_INT(LACONIC_ESTIMATE_MOST, estimate.most_steps);
}

static void a_refused_step_is_refused_as_without(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 4);
    laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 3, &why));
    input.voltage_V[0] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 1,
                   laconic_estimate_run(&estimate, &plant, &input, 3, &why), why);
    TEST_ASSERT_EQUAL_UINT64(3, plant.steps);
    TEST_ASSERT_TRUE(errors_now(&estimate, &plant).now.place_m < 1);
    TEST_ASSERT_EQUAL_UINT64(1, errors_now(&estimate, &plant).unknown); /* the first of the three is tried alone */
}

/* Where no half step is taken all that the step has changed counts as its error, and it is said. */
static void half_steps_that_are_refused_are_counted(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 1);
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 3, &why));
    const laconic_errors before = errors_now(&estimate, &plant);
    estimate.halves.gyro_limit = estimate.finer.gyro_limit = 0;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 2, &why));
    TEST_ASSERT_EQUAL_UINT64(2, errors_now(&estimate, &plant).unknown);
    TEST_ASSERT_TRUE(errors_now(&estimate, &plant).now.place_m > estimate.first_path_m[0] + before.now.place_m);
}

static void a_half_step_that_cannot_be_prepared_is_refused(void) {
    laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 12.0 * (double)LACONIC_REAL_MIN);
    laconic_estimate estimate;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, laconic_estimate_start(&estimate, &plant, 1, NULL, &why),
                   why);
    /* The finer method, which cannot be prepared at all, is not reached. */
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0,
                   laconic_estimate_start(&estimate, &plant, 1, &laconic_auto_slow, &why), why);
    v.motor_damping_Nms = REAL(100 * DAMPING);
    plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.1);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_estimate_start(&estimate, &plant, 1, &laconic_rk4, &why), why);
}

static laconic_real turning_speed(const laconic_plant *plant) {
    laconic_real nu[3];
    laconic_nu(&plant->model, &plant->state, nu);
    return nu[2];
}

/* The third step of a window of four yaws beyond what the method takes. */
static void of_a_run_that_is_refused_midway_the_steps_that_were_taken_count(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 0.1), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    laconic_input input = no_input();
    input.body_moment_Nm = REAL(50);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 4, &why));
    laconic_plant ahead = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&ahead, &input, 1, &why));
    const laconic_real taken = turning_speed(&ahead);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&ahead, &input, 1, &why));
    plant.integrator.gyro_limit = (taken + turning_speed(&ahead)) / 2;
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_estimate_run(&estimate, &plant, &input, 4, &why), why);
    TEST_ASSERT_EQUAL_UINT64(6, plant.steps);
    TEST_ASSERT_EQUAL_INT(2, estimate.taken);
}

static void samples_whose_half_steps_are_refused_are_counted(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 1);
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    for (int k = 0; k < 3; k++) samples[k].body_moment_Nm = REAL(5); /* yaws faster and faster */
    const laconic_real yaw = plant.model.nu_of_zeta[2][0] * plant.state.zeta[0].value +
                             plant.model.nu_of_zeta[2][1] * plant.state.zeta[1].value +
                             plant.model.nu_of_zeta[2][2] * plant.state.zeta[2].value;
    estimate.halves.gyro_limit = estimate.finer.gyro_limit = yaw * REAL(1.0001); /* reached by the first half step */
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, samples, &why));
    TEST_ASSERT_EQUAL_UINT64(1, errors_now(&estimate, &plant).unknown);
    TEST_ASSERT_TRUE(estimate.local[6] == estimate.first_path_m[0]); /* whole, not from a first half on */
    TEST_ASSERT_TRUE(estimate.local[7] == estimate.first_path_m[1]);
    samples[0].voltage_V[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 2,
                   laconic_estimate_run_sampled(&estimate, &plant, samples, &why), why);
    TEST_ASSERT_EQUAL_UINT64(2, errors_now(&estimate, &plant).unknown);
}

static bool are_sizes(const laconic_error *error) {
    return error->nu_rad_per_s >= 0 && error->place_m >= 0 && error->heading_rad >= 0 && error->wheel_angle_rad >= 0;
}

/* Methods of second order do not use the world force in the middle of a step, so they accept one whose effect leaves
 * the range. The true motion follows it: the error is infinite, and it stays so. */
static void an_error_beyond_the_range_is_infinite_and_not_nan(void) {
    static const laconic_method *const methods[] = {&laconic_exact_flow, &laconic_exponential_kahan};
    const laconic_vehicle v = with_motors(three_wheels());
    for (int k = 0; k < 2; k++)
        for (double share = 1e-30; share < 1; share *= 10) {
            laconic_plant plant = plant_by(methods[k], &v, start_with(2, 1, 4), 0.01);
            laconic_estimate estimate = estimate_of(&plant, 4);
            laconic_input samples[3] = {every_input(), every_input(), every_input()};
            ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, samples, &why));
            samples[1].world_force_N[0] = REAL(share) * LACONIC_REAL_MAX;
            for (int step = 0; step < 6; step++) {
                ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, samples, &why));
                const laconic_errors found = errors_now(&estimate, &plant);
                TEST_ASSERT_TRUE(are_sizes(&found.now) && are_sizes(&found.largest));
                TEST_ASSERT_TRUE(found.largest.nu_rad_per_s >= found.now.nu_rad_per_s);
                if (step > 2) samples[1].world_force_N[0] = 0;
            }
            if (share > 0.05) TEST_ASSERT_TRUE(errors_now(&estimate, &plant).now.nu_rad_per_s > LACONIC_REAL_MAX);
        }
}

static void a_twin_that_is_refused_stays(void) {
    laconic_vehicle v = with_motors(mecanum());
    v.ground.friction_coefficient = REAL(0.5);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    const laconic_state before = estimate.twin;
    laconic_input input = no_input();
    input.voltage_V[0] = NOT_A_NUMBER;
    TEST_ASSERT_EQUAL_UINT64(1, laconic_estimate_before(&estimate, &plant, &input, 1, 5));
    TEST_ASSERT_EQUAL_UINT64(1, errors_now(&estimate, &plant).unknown);
    TEST_ASSERT_EQUAL_MEMORY(&before, &estimate.twin, sizeof before);
    TEST_ASSERT_EQUAL_UINT64(1, laconic_estimate_before(&estimate, &plant, &input, 1, 5));
    TEST_ASSERT_EQUAL_UINT64(2, errors_now(&estimate, &plant).unknown);
}

/* It ends where the schedule does, where a step is refused, and where the recorder has no room; rows may be none. */
static void following_ends_as_without_an_estimate(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 4);
    const uint32_t signal = offsetof(laconic_input, voltage_V), column = offsetof(laconic_outputs, energy_J);
    const laconic_real values[2] = {REAL(1), NOT_A_NUMBER};
    const uint64_t ends[2] = {20, 30};
    laconic_real row[3];
    laconic_schedule schedule = {1, &signal, values, ends, 1, 0};
    laconic_recorder recorder = {NULL, NULL, 5, 1, &column, row, 0, 3, NULL};
    laconic_error_rows none_of_them = {0, NULL, 0, 0};
    ASSERT_STATUS(LACONIC_OK,
                  laconic_estimate_follow(&estimate, &plant, &schedule, 100, &recorder, &none_of_them, &why));
    TEST_ASSERT_EQUAL_UINT64(15, plant.steps);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 17, NULL, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(17, plant.steps);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 100, NULL, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(20, plant.steps);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 10, NULL, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(20, plant.steps); /* which lies behind */
    schedule.count = 2;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 1,
                   laconic_estimate_follow(&estimate, &plant, &schedule, 100, NULL, NULL, &why), why);
    TEST_ASSERT_EQUAL_UINT64(20, plant.steps);
}

/* Tests of the sizes that an estimate tells of an error that is known. */

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
    RUN_TEST(windows_without_steps_are_refused);
    RUN_TEST(a_refused_step_is_refused_as_without);
    RUN_TEST(half_steps_that_are_refused_are_counted);
    RUN_TEST(a_half_step_that_cannot_be_prepared_is_refused);
    RUN_TEST(of_a_run_that_is_refused_midway_the_steps_that_were_taken_count);
    RUN_TEST(samples_whose_half_steps_are_refused_are_counted);
    RUN_TEST(an_error_beyond_the_range_is_infinite_and_not_nan);
    RUN_TEST(a_twin_that_is_refused_stays);
    RUN_TEST(following_ends_as_without_an_estimate);
    RUN_TEST(sizes_are_of_the_component_that_is_farthest_off);
    RUN_TEST(doubts_and_floors_are_added);
    RUN_TEST(an_error_that_is_nan_is_infinite);
    RUN_TEST(a_rounding_that_is_nan_is_infinite);
    RUN_TEST(a_twin_that_is_nan_is_infinitely_far_off);
    return UNITY_END();
}
