/* Tests of estimate.c: the estimate is near the true error, whatever the method, and the plant keeps its bits. */
#include "estimates.h"

/* ------------------------------------------------------------------- beside the reference -- */

static laconic_error true_error(const laconic_plant *plant, const double *y, int wheels) {
    laconic_error e = {0, 0, 0, 0};
    laconic_real nu[3], angle[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    laconic_wheel_angles(&plant->model, &plant->state, angle);
    for (int k = 0; k < 3; k++) e.nu_rad_per_s = REAL(larger((double)e.nu_rad_per_s, fabs((double)nu[k] - y[k])));
    e.place_m = REAL(hypot((double)pose.x_m - y[3], (double)pose.y_m - y[4]));
    e.heading_rad = REAL(fabs((double)pose.heading_rad - y[5]));
    for (int i = 0; i < wheels; i++)
        e.wheel_angle_rad = REAL(larger((double)e.wheel_angle_rad, fabs((double)angle[i] - y[6 + i])));
    return e;
}

/* Of the reference itself: 4,000 steps of fourth order in double. With four times as many it moves by half of this. */
#define REFERENCE_ERROR 1e-13

/* `blind`: an error below it may be taken for it, as one that passes 0 is known to a share of others. */
static void assert_size(const char *what, laconic_real found, laconic_real truth, laconic_real rounding,
                        laconic_real blind) {
    TEST_ASSERT_TRUE_MESSAGE(found >= rounding, what);
    if (truth <= 3 * rounding || truth < REAL(REFERENCE_ERROR)) return;
    TEST_ASSERT_TRUE_MESSAGE(found > REAL(0.1) * truth, what);
    TEST_ASSERT_TRUE_MESSAGE(found < 10 * truth || found < blind, what);
}

static void assert_errors(const laconic_errors *found, const laconic_error *truth) {
    const laconic_error *now = &found->now, *rounding = &found->rounding;
    const laconic_real blind = REAL(0.03) * now->wheel_angle_rad; /* place and heading follow from the wheels' */
    assert_size("nu", now->nu_rad_per_s, truth->nu_rad_per_s, rounding->nu_rad_per_s, 0);
    assert_size("place", now->place_m, truth->place_m, rounding->place_m, blind * REAL(RADIUS));
    assert_size("heading", now->heading_rad, truth->heading_rad, rounding->heading_rad, blind);
    assert_size("wheels", now->wheel_angle_rad, truth->wheel_angle_rad, rounding->wheel_angle_rad, 0);
    TEST_ASSERT_TRUE(found->largest.place_m >= now->place_m);
    TEST_ASSERT_EQUAL_UINT64(0, found->unknown);
}

/* Two stretches with different inputs; in `steps` steps each. */
static void assert_estimate(const laconic_method *method, laconic_vehicle vehicle, double step, int steps,
                            int32_t most_steps) {
    const laconic_start start = start_with(2, 1, 4);
    const reference p = reference_of(&vehicle);
    laconic_plant plant = plant_by(method, &vehicle, start, step);
    laconic_estimate estimate = estimate_of(&plant, most_steps);
    double y[6 + LACONIC_MAX_WHEELS] = {2, 1, 4};
    laconic_input input = every_input();
    for (int stretch = 0; stretch < 2; stretch++) {
        reference_run(&p, y, &input, step * steps, 4000);
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, (uint64_t)steps, &why));
        const laconic_errors found = errors_now(&estimate, &plant);
        const laconic_error truth = true_error(&plant, y, p.wheels);
        assert_errors(&found, &truth);
        input.voltage_V[0] = -input.voltage_V[0];
    }
}

static void every_method_estimates_within_a_factor_of_10(void) {
    const double step[2] = {0.01, 0.04};
    const int32_t windows[3] = {1, 16, 100};
    for (int k = 0; k < 2 * 3 * LACONIC_METHOD_COUNT; k++) {
        const laconic_method *method = laconic_method_by_number(k / 6);
        assert_estimate(method, with_motors(three_wheels()), step[k % 2], 27, windows[k / 2 % 3]);
        assert_estimate(method, with_motors(mecanum()), step[k % 2], 27, windows[k / 2 % 3]);
    }
}

static void a_stiff_vehicle_is_estimated_where_the_order_falls(void) {
    const double damping[3] = {3, 30, 300};
    for (int k = 0; k < 3; k++) {
        laconic_vehicle v = with_motors(mecanum());
        v.motor_damping_Nms = REAL(DAMPING * damping[k]);
        assert_estimate(&laconic_exponential_kahan, v, 0.02, 11, 16);
        assert_estimate(&laconic_exponential_kahan_4, v, 0.02, 11, 16);
        assert_estimate(&laconic_exact_flow, v, 0.02, 11, 16);
        assert_estimate(&laconic_auto, v, 0.02, 11, 16);
    }
}

static void at_rest_the_error_is_none(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    const laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 50, &why));
    const laconic_errors found = errors_now(&estimate, &plant);
    TEST_ASSERT_TRUE(found.now.nu_rad_per_s == 0);
    TEST_ASSERT_TRUE(found.now.place_m == 0);
    TEST_ASSERT_TRUE(found.largest.wheel_angle_rad == 0);
}

/* -------------------------------------------------------------------------- what stays as it is -- */

static void the_plant_keeps_its_bits(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01), watched = plant;
    laconic_estimate estimate = estimate_of(&watched, 8);
    laconic_input input = every_input();
    for (int k = 0; k < 20; k++) {
        input.voltage_V[1] = REAL(k / 4);
        const laconic_input samples[3] = {input, every_input(), input};
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, (uint64_t)(1 + k), &why));
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &watched, &input, (uint64_t)(1 + k), &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run_sampled(&plant, samples, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &watched, samples, &why));
    }
    TEST_ASSERT_EQUAL_MEMORY(&plant.state, &watched.state, sizeof plant.state);
    TEST_ASSERT_EQUAL_UINT64(plant.steps, watched.steps);
}

/* One call for many steps, a call for each, and readings on the way tell the same. */
static void the_estimate_does_not_depend_on_calls(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01), other = plant;
    laconic_estimate estimate = estimate_of(&plant, 16), stepwise = estimate;
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 45, &why));
    for (int k = 0; k < 45; k++) {
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&stepwise, &other, &input, 1, &why));
        (void)errors_now(&stepwise, &other);
    }
    const laconic_errors one = errors_now(&estimate, &plant), two = errors_now(&stepwise, &other);
    TEST_ASSERT_EQUAL_MEMORY(&one, &two, sizeof one);
}

/* ------------------------------------------------------------------------------- along a schedule -- */

#define ROWS 12

static void a_schedule_gives_rows_and_the_bits_of_runs(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01), by_hand = plant;
    laconic_estimate estimate = estimate_of(&plant, 16), same = estimate;
    const uint32_t signal = offsetof(laconic_input, voltage_V);
    const laconic_real values[3] = {REAL(1), REAL(-2), REAL(3)};
    const uint64_t ends[3] = {7, 20, UINT64_MAX};
    const laconic_schedule schedule = {1, &signal, values, ends, 3, 0};
    laconic_error row[ROWS];
    laconic_error_rows rows = {5, row, 0, ROWS};
    laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 1000, NULL, &rows, &why));
    TEST_ASSERT_EQUAL_UINT64(ROWS, rows.row_count);
    TEST_ASSERT_EQUAL_UINT64(5 * ROWS, plant.steps);
    for (uint64_t step = 0; step < 5 * ROWS; step++) {
        input.voltage_V[0] = values[step < 7 ? 0 : step < 20 ? 1 : 2];
        const laconic_errors now = errors_now(&same, &by_hand);
        if (step % 5 == 0) TEST_ASSERT_EQUAL_MEMORY(&now.now, &row[step / 5], sizeof now.now);
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&same, &by_hand, &input, 1, &why));
    }
    TEST_ASSERT_EQUAL_MEMORY(&by_hand.state, &plant.state, sizeof plant.state);
}

static void samples_that_follow_one_another_share_windows(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_exponential_kahan, &v, start_with(2, 1, 4), 0.01);
    laconic_plant fine = plant_by(&laconic_exponential_kahan, &v, start_with(2, 1, 4), 0.0001);
    laconic_estimate estimate = estimate_of(&plant, 16);
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    for (int k = 0; k < 6000; k++) {
        for (int j = 0; j < 3; j++) samples[j].voltage_V[0] = REAL(1e-4 * (k + 0.5 * j));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run_sampled(&fine, samples, &why));
        for (int j = 0; j < 3; j++) samples[j].voltage_V[0] = REAL(1e-2 * (k / 100 + 0.5 * j));
        if (k % 100 == 0) ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, samples, &why));
    }
    const laconic_errors found = errors_now(&estimate, &plant);
    const double off = hypot((double)(plant.state.x_m.value - fine.state.x_m.value),
                             (double)(plant.state.y_m.value - fine.state.y_m.value));
    TEST_ASSERT_TRUE(estimate.length == 16);
    if (IN_DOUBLE) assert_size("place", found.now.place_m, REAL(off), found.rounding.place_m, 0);
    TEST_ASSERT_TRUE(found.now.place_m < REAL(1e-3));
}

/* ---------------------------------------------------------------------------------- with friction -- */

static void a_vehicle_with_friction_has_a_twin(void) {
    laconic_vehicle v = with_motors(mecanum());
    v.ground.friction_coefficient = REAL(0.5);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    laconic_plant fine = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.00025);
    laconic_estimate estimate = estimate_of(&plant, 16);
    laconic_input input = no_input();
    input.voltage_V[0] = input.voltage_V[1] = REAL(2);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 40, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&fine, &input, 1600, &why));
    const laconic_errors found = errors_now(&estimate, &plant);
    const double off = hypot((double)(plant.state.x_m.value - fine.state.x_m.value),
                             (double)(plant.state.y_m.value - fine.state.y_m.value));
    assert_size("place", found.now.place_m, REAL(off), 0, 0);
    TEST_ASSERT_TRUE(found.largest.nu_rad_per_s >= found.now.nu_rad_per_s);
    TEST_ASSERT_TRUE(found.now.wheel_angle_rad > 0);
}

/* In ν as laconic_nu() has it. */
static void assert_twice_what_plant_and_twin_differ_by(laconic_vehicle v) {
    v.ground.friction_coefficient = REAL(0.5);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    for (int k = 0; k < 20; k++) {
        laconic_real nu[3], of_twin[3], off = 0;
        laconic_pose pose, pose_of_twin;
        laconic_input input = no_input();
        input.voltage_V[k % 3] = REAL(k - 10);
        input.body_moment_Nm = REAL(k % 5 - 2);
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 3, &why));
        laconic_nu(&plant.model, &plant.state, nu);
        laconic_nu(&plant.model, &estimate.twin, of_twin);
        laconic_pose_of(&pose, &plant.model, &plant.state);
        laconic_pose_of(&pose_of_twin, &plant.model, &estimate.twin);
        for (int i = 0; i < 3; i++) off = REAL(larger((double)off, 2 * fabs((double)(nu[i] - of_twin[i]))));
        const laconic_errors found = errors_now(&estimate, &plant);
        ASSERT_NEAR(EITHER(1e-12, 1e-4), off, found.now.nu_rad_per_s);
        ASSERT_NEAR(EITHER(1e-12, 1e-5),
                    2 * hypot((double)(pose.x_m - pose_of_twin.x_m), (double)(pose.y_m - pose_of_twin.y_m)),
                    found.now.place_m);
        ASSERT_NEAR(EITHER(1e-12, 1e-5), 2 * fabs((double)(pose.heading_rad - pose_of_twin.heading_rad)),
                    found.now.heading_rad);
        TEST_ASSERT_TRUE(off > REAL(1e-3));
    }
}

static void with_friction_the_error_is_twice_what_plant_and_twin_differ_by(void) {
    laconic_vehicle light = with_motors(three_wheels());
    light.yaw_inertia_kgm2 = REAL(0.01); /* below M R²: w of its model is longer than g */
    assert_twice_what_plant_and_twin_differ_by(with_motors(three_wheels()));
    assert_twice_what_plant_and_twin_differ_by(light);
}

/* ------------------------------------------------------------------------- another step or vehicle -- */

/* What two plants at the same time differ by; wheel angles of three wheels. */
static laconic_error between(const laconic_plant *plant, const laconic_plant *fine) {
    double y[6 + LACONIC_MAX_WHEELS];
    laconic_real nu[3], angle[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    laconic_nu(&fine->model, &fine->state, nu);
    laconic_pose_of(&pose, &fine->model, &fine->state);
    laconic_wheel_angles(&fine->model, &fine->state, angle);
    for (int k = 0; k < 3; k++) y[k] = (double)nu[k];
    y[3] = (double)pose.x_m;
    y[4] = (double)pose.y_m;
    y[5] = (double)pose.heading_rad;
    for (int i = 0; i < 3; i++) y[6 + i] = (double)angle[i];
    return true_error(plant, y, 3);
}

static laconic_vehicle with_load(laconic_vehicle v) {
    v.payload.mass_kg = REAL(8);
    v.payload.x_m = REAL(0.15);
    v.payload.y_m = REAL(-0.2);
    v.payload.yaw_inertia_kgm2 = REAL(0.4);
    return v;
}

/* The same changes of the vehicle and of the step, fifty times finer: the estimate must hold after them, which it would
 * not if it had begun anew, since the later steps are ten times shorter. */
static void after_a_change_the_estimate_goes_on(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_vehicle loaded = with_load(v);
    const laconic_input input = every_input();
    laconic_plant plant = plant_by(&laconic_exact_flow, &v, start_with(2, 1, 4), 0.04);
    laconic_plant fine = plant_by(&laconic_exact_flow, &v, start_with(2, 1, 4), 0.0008);
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 20, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&fine, &input, 1000, &why));
    laconic_plant before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&fine, &loaded, &why));
    const laconic_errors until = errors_now(&estimate, &before);
    laconic_estimate unsure = estimate;
    unsure.unknown = 30;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&unsure, &before, &plant, NULL, &why));
    TEST_ASSERT_EQUAL_UINT64(30, errors_now(&unsure, &plant).unknown);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    laconic_errors found = errors_now(&estimate, &plant);
    laconic_error truth = between(&plant, &fine);
    assert_errors(&found, &truth);
    TEST_ASSERT_TRUE(found.largest.nu_rad_per_s >= until.largest.nu_rad_per_s);
    before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.004), &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    for (int k = 0; k < 2; k++) {
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 10, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&fine, &input, 50, &why));
        found = errors_now(&estimate, &plant);
        truth = between(&plant, &fine);
        assert_errors(&found, &truth);
    }
}

static void a_twin_goes_on_after_a_change_and_begins_where_friction_does(void) {
    const laconic_vehicle ideal = with_motors(mecanum());
    laconic_vehicle v = ideal;
    v.ground.friction_coefficient = REAL(0.5);
    const laconic_vehicle loaded = with_load(v);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    laconic_input input = no_input();
    input.voltage_V[0] = input.voltage_V[1] = REAL(2);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 40, &why));
    const laconic_errors until = errors_now(&estimate, &plant);
    laconic_plant before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    const laconic_errors then = errors_now(&estimate, &plant);
    TEST_ASSERT_TRUE(then.now.wheel_angle_rad == until.now.wheel_angle_rad);
    TEST_ASSERT_TRUE(then.now.place_m > REAL(0.5) * until.now.place_m && then.now.place_m < 2 * until.now.place_m);
    laconic_estimate spoilt = estimate;
    spoilt.twin.x_m.value = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0,
                   laconic_estimate_carry(&spoilt, &before, &plant, NULL, &why), why);
    TEST_ASSERT_TRUE(why.value == 0 && why.limit == 0); /* of a twin nobody has given a number */
    before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &ideal, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&spoilt, &before, &plant, NULL, &why)); /* its twin has ended */
    const laconic_errors fresh = errors_now(&estimate, &plant);
    TEST_ASSERT_TRUE(fresh.largest.wheel_angle_rad < REAL(0.5) * until.now.wheel_angle_rad);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 20, &why));
    before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    TEST_ASSERT_EQUAL_INT(0, estimate.taken);
    TEST_ASSERT_EQUAL_MEMORY(&plant.state, &estimate.twin, sizeof plant.state);
}

/* To a vehicle with friction and back: of the first motion's error nothing is left. */
static void an_estimate_that_began_anew_with_friction_has_no_older_error(void) {
    const laconic_vehicle ideal = with_motors(mecanum());
    laconic_vehicle v = ideal;
    v.ground.friction_coefficient = REAL(0.5);
    laconic_plant plant = plant_by(&laconic_auto, &ideal, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 40, &why));
    for (int k = 0; k < 2; k++) {
        const laconic_plant before = plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, k == 0 ? &v : &ideal, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
        laconic_estimate fresh;
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&fresh, &plant, 16, NULL, &why));
        const laconic_errors expected = errors_now(&fresh, &plant), found = errors_now(&estimate, &plant);
        TEST_ASSERT_EQUAL_MEMORY(&expected, &found, sizeof found);
    }
}

static void a_step_without_half_of_it_is_refused_after_a_change(void) {
    laconic_vehicle v[2] = {with_motors(three_wheels()), with_motors(mecanum())};
    v[1].ground.friction_coefficient = REAL(0.5);
    for (int k = 0; k < 2; k++) {
        laconic_plant plant = plant_by(&laconic_auto, &v[k], start_with(2, 1, 4), 0.01), before = plant;
        laconic_estimate estimate = estimate_of(&plant, 4);
        const laconic_estimate kept = estimate;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(12.0 * (double)LACONIC_REAL_MIN), &why));
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0,
                       laconic_estimate_carry(&estimate, &before, &plant, NULL, &why), why);
        TEST_ASSERT_EQUAL_MEMORY(&kept, &estimate, sizeof kept);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_method_estimates_within_a_factor_of_10);
    RUN_TEST(a_stiff_vehicle_is_estimated_where_the_order_falls);
    RUN_TEST(at_rest_the_error_is_none);
    RUN_TEST(the_plant_keeps_its_bits);
    RUN_TEST(the_estimate_does_not_depend_on_calls);
    RUN_TEST(a_schedule_gives_rows_and_the_bits_of_runs);
    RUN_TEST(samples_that_follow_one_another_share_windows);
    RUN_TEST(a_vehicle_with_friction_has_a_twin);
    RUN_TEST(with_friction_the_error_is_twice_what_plant_and_twin_differ_by);
    RUN_TEST(after_a_change_the_estimate_goes_on);
    RUN_TEST(a_twin_goes_on_after_a_change_and_begins_where_friction_does);
    RUN_TEST(an_estimate_that_began_anew_with_friction_has_no_older_error);
    RUN_TEST(a_step_without_half_of_it_is_refused_after_a_change);
    return UNITY_END();
}
