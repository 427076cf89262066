/* Tests of imu.c: what a place of the body feels, and what the instrument makes of it. */
#include "imu.h"

#include "methods.h"
#include "stack.h"

#define STEP 1e-3

static laconic_refusal why;

static laconic_plant plant_of(const laconic_vehicle *v, const laconic_method *method, double step_s,
                              laconic_start start) {
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, v, method, REAL(step_s), &start, &why));
    return plant;
}

static laconic_imu_settings at(double x, double y) { return (laconic_imu_settings){.x_m = REAL(x), .y_m = REAL(y)}; }

static laconic_imu_sample felt(const laconic_plant *plant, const laconic_imu_settings *imu,
                               const laconic_input *input) {
    laconic_imu_sample sample;
    laconic_imu_feel_now(&sample, imu, plant, input);
    return sample;
}

/* ------------------------------------------------------------------------------- hand figures -- */

static void at_rest_on_level_ground_nothing_is_felt(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(0, 0, 0));
    const laconic_imu_settings imu = at(0.3, -0.2);
    const laconic_input input = no_input();
    const laconic_imu_sample sample = felt(&plant, &imu, &input);
    TEST_ASSERT_TRUE(sample.specific_force_m_per_s2[0] == 0 && sample.specific_force_m_per_s2[1] == 0);
    TEST_ASSERT_TRUE(sample.yaw_rate_rad_per_s == 0);
}

/* v = 1 m/s along ξ, ω = 2 rad/s: the force that holds S on its circle is M ω v = 20 N to the left. Beside the 2 m/s²
 * of S a place 0.1 m ahead feels ω² r = 0.4 m/s² towards S. */
static void on_a_steady_circle_a_place_feels_omega_squared_r(void) {
    const laconic_vehicle v = bare_body();
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(20, 0, 6));
    const laconic_imu_settings centre = at(0, 0), ahead = at(0.1, 0);
    laconic_input input = no_input();
    input.body_force_N[1] = REAL(20);
    const laconic_imu_sample a = felt(&plant, &centre, &input), b = felt(&plant, &ahead, &input);
    ASSERT_NEAR(4 * ROUNDING, 0, a.specific_force_m_per_s2[0]);
    ASSERT_NEAR(4 * ROUNDING, 2, a.specific_force_m_per_s2[1]);
    ASSERT_NEAR(4 * ROUNDING, -0.4, b.specific_force_m_per_s2[0]);
    ASSERT_NEAR(4 * ROUNDING, 2, b.specific_force_m_per_s2[1]);
    ASSERT_NEAR(4 * ROUNDING, 2, b.yaw_rate_rad_per_s);
}

/* A moment of 0.225 N·m yaws the body of 0.225 kg m² by 1 rad/s²: a place 0.3 m to the left is pulled backwards. */
static void a_yaw_acceleration_has_its_lever_arm(void) {
    const laconic_vehicle v = bare_body();
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(0, 0, 0));
    const laconic_imu_settings left = at(0, 0.3);
    laconic_input input = no_input();
    input.body_moment_Nm = REAL(0.225);
    const laconic_imu_sample sample = felt(&plant, &left, &input);
    ASSERT_NEAR(4 * ROUNDING, -0.3, sample.specific_force_m_per_s2[0]);
    ASSERT_NEAR(4 * ROUNDING, 0, sample.specific_force_m_per_s2[1]);
}

static void turned_axes_show_the_same_force_turned(void) {
    const laconic_vehicle v = bare_body();
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(0, 0, 0));
    const laconic_imu_settings left = {.heading_rad = REAL(PI / 2)};
    laconic_input input = no_input();
    input.body_force_N[0] = REAL(30);
    const laconic_imu_sample sample = felt(&plant, &left, &input);
    ASSERT_NEAR(4 * ROUNDING, 0, sample.specific_force_m_per_s2[0]); /* its x axis points to the left */
    ASSERT_NEAR(4 * ROUNDING, -3, sample.specific_force_m_per_s2[1]);
}

/* ------------------------------------------------------------------------------------ slopes -- */

static laconic_vehicle on_a_slope(laconic_vehicle v) {
    v.ground.slope_rad = REAL(0.2);
    v.ground.slope_heading_rad = REAL(1.1);
    return v;
}

static void a_puck_that_slides_down_freely_feels_nothing(void) {
    const laconic_vehicle v = on_a_slope(bare_body());
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(1, -2, 0));
    const laconic_imu_settings imu = at(0, 0);
    const laconic_input input = no_input();
    laconic_real acceleration[2];
    const laconic_imu_sample sample = felt(&plant, &imu, &input);
    laconic_accelerate_now(acceleration, &plant, &input);
    ASSERT_NEAR(8 * ROUNDING, 0, sample.specific_force_m_per_s2[0]);
    ASSERT_NEAR(8 * ROUNDING, 0, sample.specific_force_m_per_s2[1]);
    ASSERT_NEAR(8 * ROUNDING, -9.80665 * sin(0.2) * cos(1.1), acceleration[0]);
    ASSERT_NEAR(8 * ROUNDING, -9.80665 * sin(0.2) * sin(1.1), acceleration[1]);
}

/* A force in the world holds it against the slope: at rest it feels g sin α towards the ascent. */
static void at_rest_on_a_slope_it_feels_what_holds_it(void) {
    const laconic_vehicle v = on_a_slope(bare_body());
    laconic_start start = start_with(0, 0, 0);
    start.heading_rad = REAL(0.4);
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start);
    const laconic_imu_settings imu = at(0.2, 0.1);
    laconic_input input = no_input();
    input.world_force_N[0] = REAL(10 * 9.80665 * sin(0.2) * cos(1.1));
    input.world_force_N[1] = REAL(10 * 9.80665 * sin(0.2) * sin(1.1));
    const laconic_imu_sample sample = felt(&plant, &imu, &input);
    ASSERT_NEAR(8 * ROUNDING, 9.80665 * sin(0.2) * cos(0.7), sample.specific_force_m_per_s2[0]);
    ASSERT_NEAR(8 * ROUNDING, 9.80665 * sin(0.2) * sin(0.7), sample.specific_force_m_per_s2[1]);
}

/* --------------------------------------------------------------------------- finite differences -- */

/* Velocity of a place of the body, world axes. */
static void place_velocity(double out[2], const laconic_plant *plant, double x, double y) {
    laconic_real v[2];
    laconic_pose pose;
    const double yaw_rate = (double)laconic_body_velocity(&plant->model, &plant->state, v);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    const double dx = x - (double)plant->model.com_x_m, dy = y - (double)plant->model.com_y_m;
    const double c = cos((double)pose.heading_rad), s = sin((double)pose.heading_rad);
    const double along = (double)v[0] - yaw_rate * dy, across = (double)v[1] + yaw_rate * dx;
    out[0] = c * along - s * across;
    out[1] = s * along + c * across;
}

static const double place[2] = {0.31, -0.17};

/* The acceleration in the middle of two steps, from the places' velocities at their ends. */
static void lever_arms_agree_with_the_change_of_the_place_s_velocity(void) {
    const double h = EITHER(1e-4, 4e-3);
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_plant plant = plant_of(&v, &laconic_taylor_8, h, start_with(9, -4, 7));
    const laconic_imu_settings imu = at(place[0], place[1]);
    const laconic_input input = every_input();
    double before[2], after[2];
    laconic_real origin[2];
    place_velocity(before, &plant, place[0], place[1]);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
    laconic_pose pose;
    laconic_pose_of(&pose, &plant.model, &plant.state);
    const laconic_imu_sample sample = felt(&plant, &imu, &input);
    laconic_accelerate_now(origin, &plant, &input);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
    place_velocity(after, &plant, place[0], place[1]);
    const double c = cos((double)pose.heading_rad), s = sin((double)pose.heading_rad);
    const double ax = (after[0] - before[0]) / (2 * h), ay = (after[1] - before[1]) / (2 * h);
    ASSERT_NEAR(EITHER(1e-6, 3e-3), c * ax + s * ay, sample.specific_force_m_per_s2[0]);
    ASSERT_NEAR(EITHER(1e-6, 3e-3), c * ay - s * ax, sample.specific_force_m_per_s2[1]);
    TEST_ASSERT_TRUE(fabs((double)origin[0] - (double)sample.specific_force_m_per_s2[0]) > 0.05);
}

static void rates_of_an_outer_integrator_give_the_same(void) {
    const laconic_vehicle v = on_a_slope(with_motors(three_wheels()));
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(2, -1, 3));
    const laconic_imu_settings imu = at(place[0], place[1]);
    const laconic_input input = every_input();
    laconic_real nu[3], expected[2], found[2];
    laconic_rates rates;
    laconic_imu_sample sample;
    laconic_nu(&plant.model, &plant.state, nu);
    laconic_derivative(&rates, &plant.model, nu, 0, &input);
    laconic_imu_feel(&sample, &imu, &plant.model, nu, rates.nu_rad_per_s2, 0);
    const laconic_imu_sample now = felt(&plant, &imu, &input);
    ASSERT_NEAR_ALL(20 * ROUNDING, now.specific_force_m_per_s2, sample.specific_force_m_per_s2, 2);
    TEST_ASSERT_TRUE(now.yaw_rate_rad_per_s == sample.yaw_rate_rad_per_s);
    laconic_accelerate_now(expected, &plant, &input);
    laconic_acceleration_of_rates(found, &plant.model, nu, rates.nu_rad_per_s2);
    ASSERT_NEAR_ALL(20 * ROUNDING, expected, found, 2);
}

/* A body that turns at ω about S, where nothing holds it: beside S a place feels −ω² d. The mean over a step, in the
 * axes of its middle, is that times the mean of cos over ± ωh/2. */
static void over_a_step_a_place_feels_its_distance_from_the_mass_centre(void) {
    const double h = 0.05, yaw_rate = 6.0 / BIG_LAMBDA, half = yaw_rate * h / 2;
    laconic_vehicle v = bare_body();
    v.com_x_m = REAL(0.12);
    v.com_y_m = REAL(-0.07);
    laconic_plant plant = plant_of(&v, &laconic_auto, h, start_with(0, 0, 6));
    const laconic_imu_settings imu = at(0.12 + 0.3, -0.07 + 0.2);
    const laconic_input input = no_input();
    laconic_sensor_moment before;
    laconic_imu_sample sample;
    laconic_sensors_before(&before, &plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
    laconic_imu_feel_step(&sample, &imu, &plant, &before);
    const double square = yaw_rate * yaw_rate * sin(half) / half;
    ASSERT_NEAR(EITHER(1e-13, 1e-4), -square * 0.3, sample.specific_force_m_per_s2[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-4), -square * 0.2, sample.specific_force_m_per_s2[1]);
    laconic_real middle[2]; /* of the body's axes, from S at minus its own place */
    laconic_accelerate_over_step(middle, &plant, &before);
    ASSERT_NEAR(EITHER(1e-13, 1e-4), square * 0.12, middle[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-4), -square * 0.07, middle[1]);
}

/* ν and an input are varied; the ν of the differential drive, which slides its wheels, is projected. */
static void the_tangent_of_the_acceleration_is_its_slope(void) {
    const double by[3] = {0.3, -0.8, 0.5}, h = EITHER(1e-4, 2e-2);
    laconic_vehicle each[] = {with_motors(three_wheels()), differential_drive(), with_motors(mecanum())};
    each[2].com_x_m = REAL(0.2);
    for (int k = 0; k < 3; k++) {
        laconic_model m;
        laconic_variation along;
        laconic_rates rates, change;
        laconic_real side[2][2], slope[2];
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&m, &each[k], &why));
        memset(&along, 0, sizeof along);
        for (int i = 0; i < 3; i++) along.nu_rad_per_s[i] = REAL(by[i]);
        along.input.body_force_N[0] = REAL(2);
        const laconic_motion at_rate = {{REAL(2), REAL(-1), REAL(1.5)}, 0};
        for (int s = 0; s < 2; s++) {
            const double way = s == 0 ? -h : h;
            laconic_input input = every_input();
            laconic_motion at_side = at_rate;
            for (int i = 0; i < 3; i++) at_side.nu_rad_per_s[i] += REAL(way * by[i]);
            input.body_force_N[0] += REAL(way * 2);
            laconic_derivative(&rates, &m, at_side.nu_rad_per_s, 0, &input);
            laconic_state state;
            const laconic_start start = {
                .nu_rad_per_s = {at_side.nu_rad_per_s[0], at_side.nu_rad_per_s[1], at_side.nu_rad_per_s[2]}};
            ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, &m, &start, &why));
            laconic_nu(&m, &state, at_side.nu_rad_per_s);
            laconic_acceleration_of_rates(side[s], &m, at_side.nu_rad_per_s, rates.nu_rad_per_s2);
        }
        const laconic_input input = every_input();
        laconic_derivative_tangent(&change, &m, &at_rate, &input, &along);
        laconic_acceleration_tangent(slope, &m, at_rate.nu_rad_per_s, along.nu_rad_per_s, change.nu_rad_per_s2);
        for (int i = 0; i < 2; i++)
            ASSERT_NEAR(EITHER(1e-8, 1e-3), ((double)side[1][i] - (double)side[0][i]) / (2 * h), slope[i]);
        TEST_ASSERT_TRUE(fabs((double)slope[0]) > 0.01);
    }
}

/* ---------------------------------------------------------------------------------- instrument -- */

static const laconic_imu_sample truth = {{REAL(2), REAL(-3)}, REAL(0.5)};

static void scale_and_bias_change_each_axis_by_itself(void) {
    const laconic_imu_settings imu = {.acceleration_scale_error = {REAL(0.5), REAL(-0.25)},
                                      .acceleration_bias_m_per_s2 = {REAL(0.125), REAL(1)},
                                      .yaw_rate_scale_error = 1,
                                      .yaw_rate_bias_rad_per_s = REAL(-0.25)};
    laconic_real acceleration[2], yaw_rate;
    laconic_imu_show(&imu, &truth, 5, REAL(STEP), acceleration, &yaw_rate);
    TEST_ASSERT_TRUE(acceleration[0] == REAL(3.125) && acceleration[1] == REAL(-1.25) && yaw_rate == REAL(0.75));
}

static void an_ideal_imu_shows_the_truth_to_the_last_bit(void) {
    const laconic_imu_settings imu = {0};
    laconic_real acceleration[2], yaw_rate;
    laconic_imu_show(&imu, &truth, 5, REAL(STEP), acceleration, &yaw_rate);
    TEST_ASSERT_TRUE(acceleration[0] == 2 && acceleration[1] == -3 && yaw_rate == REAL(0.5));
}

/* Without noise nothing is drawn, and what stood in memory before plays no part. */
static void without_noise_it_shows_the_truth_whatever_stood_in_memory(void) {
    const laconic_imu_settings imu = {0};
    laconic_real acceleration[2], yaw_rate;
    fill_stack(ALL_NAN);
    laconic_imu_show(&imu, &truth, 5, REAL(STEP), acceleration, &yaw_rate);
    TEST_ASSERT_TRUE(acceleration[0] == 2 && acceleration[1] == -3 && yaw_rate == REAL(0.5));
}

static void beyond_its_range_it_shows_the_end_of_the_range(void) {
    const laconic_imu_settings imu = {.acceleration_range_m_per_s2 = REAL(2.5), .yaw_rate_range_rad_per_s = REAL(0.3)};
    laconic_real acceleration[2], yaw_rate;
    laconic_imu_show(&imu, &truth, 5, REAL(STEP), acceleration, &yaw_rate);
    TEST_ASSERT_TRUE(acceleration[0] == 2 && acceleration[1] == REAL(-2.5) && yaw_rate == REAL(0.3));
}

/* One-sided density d: half the sample rate is its band, so the deviation is d √(500 Hz) at 1 ms. */
static void the_density_of_the_noise_sets_its_deviation_at_every_step(void) {
    const laconic_imu_settings imu = {.acceleration_noise_m_per_s2_per_sqrt_Hz = REAL(0.01),
                                      .yaw_rate_noise_rad_per_s_per_sqrt_Hz = REAL(0.002),
                                      .seed = -7};
    const int count = 20000;
    const double step_s[] = {1e-3, 1e-2}, within = 4 * sqrt(2.0 / count);
    for (int k = 0; k < 2; k++) {
        double square[3] = {0};
        for (int n = 0; n < count; n++) {
            laconic_real a[2], yaw_rate;
            laconic_imu_show(&imu, &truth, (uint64_t)n, REAL(step_s[k]), a, &yaw_rate);
            square[0] += ((double)a[0] - 2) * ((double)a[0] - 2) / count;
            square[1] += ((double)a[1] + 3) * ((double)a[1] + 3) / count;
            square[2] += ((double)yaw_rate - 0.5) * ((double)yaw_rate - 0.5) / count;
        }
        ASSERT_NEAR(within, 1, square[0] / (1e-4 / (2 * step_s[k])));
        ASSERT_NEAR(within, 1, square[1] / (1e-4 / (2 * step_s[k])));
        ASSERT_NEAR(within, 1, square[2] / (4e-6 / (2 * step_s[k])));
    }
}

static void seeds_choose_the_noise(void) {
    laconic_imu_settings imu = {.acceleration_noise_m_per_s2_per_sqrt_Hz = 1, .seed = 1};
    laconic_real one[2], again[2], other[2], yaw_rate;
    laconic_imu_show(&imu, &truth, 9, REAL(STEP), one, &yaw_rate);
    laconic_imu_show(&imu, &truth, 9, REAL(STEP), again, &yaw_rate);
    imu.seed = 2;
    laconic_imu_show(&imu, &truth, 9, REAL(STEP), other, &yaw_rate);
    TEST_ASSERT_TRUE(one[0] == again[0] && one[1] == again[1]);
    TEST_ASSERT_TRUE(one[0] != other[0] && one[1] != other[1]);
    TEST_ASSERT_TRUE(yaw_rate == truth.yaw_rate_rad_per_s);
}

/* ------------------------------------------------------------------------- beside a plant -- */

static void settings_exactly_at_their_limits_are_taken(void) {
    laconic_sensor_settings settings = {0};
    settings.imu.x_m = REAL(1e15);
    settings.imu.y_m = REAL(-1e15);
    settings.imu.heading_rad = LACONIC_SMALLEST_ROLLER_SINE / LACONIC_EPSILON;
    settings.imu.delay_steps = LACONIC_IMU_MAX_DELAY;
    ASSERT_STATUS(LACONIC_OK, laconic_sensor_settings_check(&settings, 3, &why));
    settings.imu.x_m *= 1 + LACONIC_EPSILON;
    ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_IMU_X, 0,
                   laconic_sensor_settings_check(&settings, 3, &why), why);
}

/* What was before the sensors' start was as at their start, at whatever step of the plant that is. */
static void a_delay_that_reaches_before_the_start_shows_the_start(void) {
    const laconic_vehicle v = bare_body();
    laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(1, 2, 3));
    const laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 5, &why));
    for (int32_t delay = 0; delay <= LACONIC_IMU_MAX_DELAY; delay++) {
        laconic_sensor_settings settings = {0};
        settings.imu.delay_steps = delay;
        laconic_sensors sensors;
        laconic_sensor_outputs out;
        memset(&sensors, 0xA5, sizeof sensors); /* as memory comes */
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
        laconic_sensors_read(&out, &sensors, &plant, &input);
        ASSERT_NEAR(4 * ROUNDING, 3 / BIG_LAMBDA, out.imu_yaw_rate_rad_per_s);
    }
}

/* However many steps the plant has taken: a puck is pushed from one of the last on that can be counted. */
static void a_delay_holds_up_to_the_last_number_of_steps(void) {
    const laconic_vehicle v = bare_body();
    laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(0, 0, 0));
    laconic_sensor_settings settings = {0};
    laconic_input input = no_input();
    laconic_sensors sensors;
    input.body_force_N[0] = v.mass_kg;
    settings.imu.delay_steps = 3;
    plant.steps = UINT64_MAX - 5;
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
    for (int k = 1; k <= 5; k++) {
        laconic_sensor_outputs out;
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(&sensors, &plant, &input, 1, &why));
        laconic_sensors_read(&out, &sensors, &plant, &input);
        ASSERT_NEAR(4 * ROUNDING, k < 4 ? 0 : 1, out.imu_acceleration_m_per_s2[0]);
    }
}

static void readings_stay_within_their_struct(void) {
    const laconic_vehicle v = bare_body();
    const laconic_plant plant = plant_of(&v, &laconic_auto, STEP, start_with(1, 2, 3));
    const laconic_input input = no_input();
    const laconic_sensor_settings settings = {0};
    laconic_sensors sensors;
    struct {
        laconic_sensor_outputs out;
        laconic_real beyond[2];
    } read = {.beyond = {7, 7}};
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
    laconic_sensors_read(&read.out, &sensors, &plant, &input);
    TEST_ASSERT_TRUE(read.beyond[0] == 7 && read.beyond[1] == 7);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(at_rest_on_level_ground_nothing_is_felt);
    RUN_TEST(on_a_steady_circle_a_place_feels_omega_squared_r);
    RUN_TEST(a_yaw_acceleration_has_its_lever_arm);
    RUN_TEST(turned_axes_show_the_same_force_turned);
    RUN_TEST(a_puck_that_slides_down_freely_feels_nothing);
    RUN_TEST(at_rest_on_a_slope_it_feels_what_holds_it);
    RUN_TEST(lever_arms_agree_with_the_change_of_the_place_s_velocity);
    RUN_TEST(rates_of_an_outer_integrator_give_the_same);
    RUN_TEST(over_a_step_a_place_feels_its_distance_from_the_mass_centre);
    RUN_TEST(the_tangent_of_the_acceleration_is_its_slope);
    RUN_TEST(scale_and_bias_change_each_axis_by_itself);
    RUN_TEST(an_ideal_imu_shows_the_truth_to_the_last_bit);
    RUN_TEST(without_noise_it_shows_the_truth_whatever_stood_in_memory);
    RUN_TEST(beyond_its_range_it_shows_the_end_of_the_range);
    RUN_TEST(the_density_of_the_noise_sets_its_deviation_at_every_step);
    RUN_TEST(seeds_choose_the_noise);
    RUN_TEST(settings_exactly_at_their_limits_are_taken);
    RUN_TEST(a_delay_that_reaches_before_the_start_shows_the_start);
    RUN_TEST(a_delay_holds_up_to_the_last_number_of_steps);
    RUN_TEST(readings_stay_within_their_struct);
    return UNITY_END();
}
