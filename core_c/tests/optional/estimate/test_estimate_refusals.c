/* Tests of estimate.c where something is refused: windows, steps, their half steps, runs on their way. */
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
    return UNITY_END();
}
