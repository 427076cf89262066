/* Tests of the windows of an estimate: which changes of the input begin one, how long they are, what a refused step
 * leaves, and which rows a schedule has. */
#include "estimates.h"
#include "stack.h"

/* ------------------------------------------------------------------------- changes of the input -- */

#define INPUT_NUMBERS (sizeof(laconic_input) / sizeof(laconic_real))

/* In the middle of a window of eight steps. */
static laconic_estimate amid_a_window(laconic_plant *plant, const laconic_input *input) {
    const laconic_vehicle v = with_motors(three_wheels());
    *plant = plant_by(&laconic_rk4, &v, start_with(0.2, 0.1, 0.4), 0.001);
    laconic_estimate estimate = estimate_of(plant, 8);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, plant, input, 1 + 1 + 2 + 4 + 3, &why));
    return estimate;
}

static void the_same_input_goes_on_with_the_window(void) {
    laconic_plant plant;
    const laconic_input input = every_input();
    laconic_estimate estimate = amid_a_window(&plant, &input);
    TEST_ASSERT_EQUAL_UINT64(5, laconic_estimate_before(&estimate, &plant, &input, 1, 100));
    TEST_ASSERT_EQUAL_UINT64(4, laconic_estimate_before(&estimate, &plant, &input, 1, 4));
    TEST_ASSERT_EQUAL_INT(3, estimate.taken);
}

static void a_change_of_any_number_of_the_input_begins_a_window_of_one_step(void) {
    for (size_t k = 0; k < INPUT_NUMBERS; k++) {
        laconic_plant plant;
        laconic_input input = every_input();
        laconic_estimate estimate = amid_a_window(&plant, &input);
        ((laconic_real *)(void *)&input)[k] += REAL(0.5);
        TEST_ASSERT_EQUAL_UINT64(1, laconic_estimate_before(&estimate, &plant, &input, 1, 100));
        TEST_ASSERT_EQUAL_INT(0, estimate.taken);
        TEST_ASSERT_EQUAL_INT(1, estimate.length);
    }
}

/* ------------------------------------------------------------------------------------ how long -- */

static double length_of(const laconic_real row[3]) {
    return sqrt((double)row[0] * (double)row[0] + (double)row[1] * (double)row[1] + (double)row[2] * (double)row[2]);
}

/* Free motion keeps |ζ|, so that its yaw rate stays below one bound: as many steps as turn by half a radian at that
 * rate may be in a window, and they double up to there. */
static void windows_double_until_they_could_turn_half_a_radian(void) {
    const double steps[5] = {4.1, 3.9, 33, 31, 100};
    const int32_t expected[5] = {4, 2, 32, 16, 64};
    for (int k = 0; k < 5; k++) {
        const laconic_vehicle v = three_wheels();
        const laconic_start start = start_with(2, 1, 4);
        const laconic_model m = model_of(v);
        const laconic_state s = state_of(&m, start);
        const laconic_real zeta[3] = {s.zeta[0].value, s.zeta[1].value, s.zeta[2].value};
        const laconic_input input = no_input();
        laconic_plant plant = plant_by(&laconic_exponential_gauss_8, &v, start,
                                       0.5 / (steps[k] * length_of(zeta) * length_of(m.yaw_rate_of_zeta)));
        laconic_estimate estimate = estimate_of(&plant, 64);
        int32_t longest = 0;
        for (int n = 0; n < 200; n++) {
            ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 1, &why));
            if (estimate.length > longest) longest = estimate.length;
        }
        TEST_ASSERT_EQUAL_INT(expected[k], longest);
        TEST_ASSERT_EQUAL_INT(expected[k], estimate.length);
    }
}

/* A puck that yaws by an eighth of a radian in each step: four steps turn by just half a radian. */
static void a_window_may_turn_by_half_a_radian_to_the_last_bit(void) {
    laconic_vehicle v = bare_body();
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = 1;
    const laconic_input input = no_input();
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0.125), 1);
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 1 + 1 + 2, &why));
    TEST_ASSERT_EQUAL_UINT64(1, laconic_estimate_before(&estimate, &plant, &input, 1, 10));
    TEST_ASSERT_EQUAL_INT(4, estimate.length);
}

/* Windows of hundreds of steps measure one of them each. What they say is what windows of one step say, within a
 * fiftieth, also amid a window. */
static void long_windows_say_what_single_steps_say(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_exact_flow, &v, start_with(0.2, 0.1, 0.4), 0.001), other = plant;
    laconic_estimate wide = estimate_of(&plant, 256), narrow = estimate_of(&plant, 1);
    laconic_input input = no_input();
    input.voltage_V[0] = REAL(0.05);
    for (int k = 0; k < 10; k++) {
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&wide, &plant, &input, 97, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&narrow, &other, &input, 97, &why));
        const laconic_errors far = errors_now(&wide, &plant), near = errors_now(&narrow, &other);
        if (!IN_DOUBLE) continue; /* rounding is larger there */
        ASSERT_NEAR(0.02 * (double)near.now.nu_rad_per_s, near.now.nu_rad_per_s, far.now.nu_rad_per_s);
        ASSERT_NEAR(0.02 * (double)near.now.place_m, near.now.place_m, far.now.place_m);
        ASSERT_NEAR(0.02 * (double)near.now.heading_rad, near.now.heading_rad, far.now.heading_rad);
        ASSERT_NEAR(0.02 * (double)near.now.wheel_angle_rad, near.now.wheel_angle_rad, far.now.wheel_angle_rad);
    }
    TEST_ASSERT_EQUAL_INT(256, wide.length);
}

/* What is left of the error of a step: at most 1, which it is where there was none before, and at rest. */
static void what_fades_is_a_share(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 4);
    laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 5, &why));
    TEST_ASSERT_TRUE(estimate.fading == 1);
    input.voltage_V[0] = REAL(5);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 1, &why));
    TEST_ASSERT_TRUE(estimate.fading == 1);
    for (int k = 0; k < 100; k++) {
        input.body_moment_Nm += REAL(0.1);
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 2, &why));
        TEST_ASSERT_TRUE(estimate.fading > 0 && estimate.fading <= 1);
    }
}

/* ------------------------------------------------------------------------- what a refusal leaves -- */

/* A step that is refused, and taken later, leaves an estimate as one that was taken at once. */
static void assert_refusal_leaves_nothing(bool by_schedule) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01);
    const uint32_t signal = offsetof(laconic_input, voltage_V);
    const laconic_real value = REAL(1);
    const uint64_t end = UINT64_MAX;
    const laconic_schedule schedule = {1, &signal, &value, &end, 1, 0};
    laconic_estimate estimate = estimate_of(&plant, 4);
    laconic_input input = no_input();
    input.voltage_V[0] = value;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 1 + 1 + 2 + 4, &why));
    laconic_plant at_once = plant;
    laconic_estimate expected = estimate;
    plant.integrator.gyro_limit = 0;
    ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT,
                  by_schedule ? laconic_estimate_follow(&estimate, &plant, &schedule, plant.steps + 3, NULL, NULL, &why)
                              : laconic_estimate_run(&estimate, &plant, &input, 3, &why));
    TEST_ASSERT_EQUAL_UINT64(at_once.steps, plant.steps);
    plant.integrator = at_once.integrator;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 3, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&expected, &at_once, &input, 3, &why));
    const laconic_errors found = errors_now(&estimate, &plant), as_before = errors_now(&expected, &at_once);
    TEST_ASSERT_EQUAL_MEMORY(&as_before, &found, sizeof found);
    TEST_ASSERT_EQUAL_MEMORY(expected.local, estimate.local, sizeof estimate.local);
    TEST_ASSERT_TRUE(expected.fading == estimate.fading);
}

static void a_refused_step_leaves_nothing_in_the_estimate(void) {
    assert_refusal_leaves_nothing(false);
    assert_refusal_leaves_nothing(true);
}

/* ---------------------------------------------------------------------------------------- rows -- */

/* One volt on the first wheel until that step. */
static laconic_schedule one_volt_until(const uint64_t *end) {
    static const uint32_t signal = offsetof(laconic_input, voltage_V);
    static const laconic_real value = 1;
    const laconic_schedule schedule = {1, &signal, &value, end, 1, 0};
    return schedule;
}

static laconic_plant turning(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    return plant_by(&laconic_auto, &v, start_with(2, 1, 4), 0.01);
}

/* Rows are of starts of steps: the end of the last step has none. */
static void the_end_of_a_run_has_no_row(void) {
    laconic_plant plant = turning();
    laconic_estimate estimate = estimate_of(&plant, 16);
    const uint64_t end = UINT64_MAX;
    const laconic_schedule schedule = one_volt_until(&end);
    laconic_error row[5];
    laconic_error_rows rows = {5, row, 0, 5};
    for (uint64_t until = 10; until <= 20; until += 10) {
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, until, NULL, &rows, &why));
        TEST_ASSERT_EQUAL_UINT64(until, plant.steps);
        TEST_ASSERT_EQUAL_UINT64(until / 5, rows.row_count);
    }
}

/* Nor has the end of the schedule. */
static void the_end_of_a_schedule_has_no_row(void) {
    laconic_plant plant = turning();
    laconic_estimate estimate = estimate_of(&plant, 16);
    const uint64_t end = 20;
    const laconic_schedule schedule = one_volt_until(&end);
    laconic_error row[5];
    laconic_error_rows rows = {5, row, 0, 5};
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 100, NULL, &rows, &why));
    TEST_ASSERT_EQUAL_UINT64(20, plant.steps);
    TEST_ASSERT_EQUAL_UINT64(4, rows.row_count);
}

static void rows_without_room_end_the_run_and_no_rows_need_none(void) {
    laconic_plant plant = turning();
    laconic_estimate estimate = estimate_of(&plant, 16);
    const uint64_t end = UINT64_MAX;
    const laconic_schedule schedule = one_volt_until(&end);
    laconic_error row[3];
    laconic_error_rows full = {5, NULL, 0, 0}, never = {0, row, 0, 3};
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 9, NULL, &full, &why));
    TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, 9, NULL, &never, &why));
    TEST_ASSERT_EQUAL_UINT64(9, plant.steps);
    TEST_ASSERT_EQUAL_UINT64(0, never.row_count);
}

/* Wherever windows and the schedule's rows end; and the errors are those of single steps. */
static void following_ends_at_the_step_that_is_asked_for(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0.2, 0.1, 0.4), 0.001), stepwise = plant;
    laconic_estimate estimate = estimate_of(&plant, 64), same = estimate;
    const uint32_t signal = offsetof(laconic_input, voltage_V);
    const laconic_real values[2] = {REAL(1), REAL(2)};
    const uint64_t ends[2] = {150, UINT64_MAX};
    const laconic_schedule schedule = {1, &signal, values, ends, 2, 0};
    laconic_input input = no_input();
    laconic_error row[20];
    laconic_error_rows rows = {20, row, 0, 20};
    for (uint64_t until = 3; until < 400; until += until / 2) {
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, until, NULL, &rows, &why));
        TEST_ASSERT_EQUAL_UINT64(until, plant.steps);
        TEST_ASSERT_EQUAL_UINT64((until + 19) / 20, rows.row_count);
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_follow(&estimate, &plant, &schedule, until - 1, NULL, NULL, &why));
        TEST_ASSERT_EQUAL_UINT64(until, plant.steps); /* what lies behind is not gone back to */
        while (stepwise.steps < until) {
            input.voltage_V[0] = values[stepwise.steps >= 150];
            ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&same, &stepwise, &input, 1, &why));
        }
        const laconic_errors expected = errors_now(&same, &stepwise), found = errors_now(&estimate, &plant);
        TEST_ASSERT_EQUAL_MEMORY(&expected, &found, sizeof found);
    }
    TEST_ASSERT_EQUAL_INT(64, estimate.length);
}

/* ---------------------------------------------------------------------------------------- memory -- */

/* The whole life of an estimate, on a stack of these bytes. */
static laconic_errors on_a_stack_of(uint8_t byte, const laconic_vehicle *v) {
    laconic_plant plant = plant_by(&laconic_auto, v, start_with(0.5, 0.2, 1), 0.01), before;
    laconic_estimate estimate;
    laconic_errors found;
    const laconic_input samples[3] = {every_input(), no_input(), every_input()};
    memset(&estimate, byte, sizeof estimate);
    fill_stack(byte);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 16, laconic_finer_method(&plant), &why));
    for (int k = 0; k < 30; k++) {
        fill_stack(byte);
        ASSERT_STATUS(LACONIC_OK, k % 10 == 5 ? laconic_estimate_run_sampled(&estimate, &plant, samples, &why)
                                              : laconic_estimate_run(&estimate, &plant, samples, 3, &why));
        fill_stack(byte);
        laconic_estimate_read(&found, &estimate, &plant);
    }
    before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.005), &why));
    fill_stack(byte);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    fill_stack(byte);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, samples, 25, &why));
    fill_stack(byte);
    laconic_estimate_read(&found, &estimate, &plant);
    return found;
}

static void what_the_stack_held_tells_nothing(void) {
    laconic_vehicle v[2] = {with_motors(three_wheels()), with_motors(mecanum())};
    v[1].ground.friction_coefficient = REAL(0.5);
    for (int k = 0; k < 2; k++) {
        const laconic_errors of_zeros = on_a_stack_of(0, &v[k]), of_ones = on_a_stack_of(1, &v[k]),
                             of_nan = on_a_stack_of(ALL_NAN, &v[k]);
        TEST_ASSERT_TRUE(of_zeros.now.place_m > 0);
        TEST_ASSERT_EQUAL_MEMORY(&of_zeros, &of_ones, sizeof of_ones);
        TEST_ASSERT_EQUAL_MEMORY(&of_zeros, &of_nan, sizeof of_nan);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_same_input_goes_on_with_the_window);
    RUN_TEST(a_change_of_any_number_of_the_input_begins_a_window_of_one_step);
    RUN_TEST(windows_double_until_they_could_turn_half_a_radian);
    RUN_TEST(a_window_may_turn_by_half_a_radian_to_the_last_bit);
    RUN_TEST(long_windows_say_what_single_steps_say);
    RUN_TEST(what_fades_is_a_share);
    RUN_TEST(a_refused_step_leaves_nothing_in_the_estimate);
    RUN_TEST(the_end_of_a_run_has_no_row);
    RUN_TEST(the_end_of_a_schedule_has_no_row);
    RUN_TEST(rows_without_room_end_the_run_and_no_rows_need_none);
    RUN_TEST(following_ends_at_the_step_that_is_asked_for);
    RUN_TEST(what_the_stack_held_tells_nothing);
    return UNITY_END();
}
