/* Tests of sensors.c: settings, and what the sensors of a vehicle see of each step. */
#include "slipping.h"

#define STEP 1e-3

static laconic_sensor_settings nothing(void) {
    laconic_sensor_settings settings;
    memset(&settings, 0, sizeof settings);
    return settings;
}

/* Every kind of sensor with every kind of error. */
static laconic_sensor_settings everything(void) {
    laconic_sensor_settings settings = nothing();
    settings.imu = (laconic_imu_settings){.x_m = REAL(0.1),
                                          .y_m = REAL(-0.05),
                                          .heading_rad = REAL(0.3),
                                          .acceleration_bias_m_per_s2 = {REAL(0.02), REAL(-0.01)},
                                          .acceleration_noise_m_per_s2_per_sqrt_Hz = REAL(2e-3),
                                          .yaw_rate_noise_rad_per_s_per_sqrt_Hz = REAL(1e-4),
                                          .delay_steps = 3,
                                          .seed = 11};
    settings.encoder_wrap = 65536;
    for (int i = 0; i < 3; i++) settings.encoder[i] = (laconic_encoder_settings){1024, REAL(i == 1 ? -20.5 : 20.5)};
    return settings;
}

static laconic_sensors beside(const laconic_plant *plant, laconic_sensor_settings settings) {
    laconic_sensors sensors;
    memset(&sensors, 0xA5, sizeof sensors); /* as memory comes */
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, plant, &why));
    return sensors;
}

static void watch(laconic_sensors *sensors, laconic_plant *plant, const laconic_input *held, uint64_t steps) {
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(sensors, plant, held, steps, &why));
}

static laconic_sensor_outputs readings(const laconic_sensors *sensors, const laconic_plant *plant,
                                       const laconic_input *input) {
    laconic_sensor_outputs out;
    memset(&out, 0, sizeof out);
    laconic_sensors_read(&out, sensors, plant, input);
    return out;
}

static laconic_input push(double voltage) {
    laconic_input input = no_input();
    for (int i = 0; i < 3; i++) input.voltage_V[i] = REAL(voltage * (i + 1));
    return input;
}

static laconic_vehicle wheels(void) { return with_motors(three_wheels()); }

/* ----------------------------------------------------------------------------------- settings -- */

#define REFUSED_SETTING(change, status, IDENTIFIER, item) \
    do { \
        laconic_sensor_settings settings = everything(); \
        settings.change; \
        ASSERT_REFUSED(status, (laconic_field)LACONIC_SENSOR_FIELD_##IDENTIFIER, item, \
                       laconic_sensor_settings_check(&settings, 3, &why), why); \
    } while (0)

static void settings_that_make_no_sense_are_refused_by_name(void) {
    REFUSED_SETTING(imu.x_m = NOT_A_NUMBER, LACONIC_NOT_FINITE, IMU_X, 0);
    REFUSED_SETTING(imu.x_m = REAL(-2e15), LACONIC_OVERFLOW, IMU_X, 0);
    REFUSED_SETTING(imu.y_m = INFINITE, LACONIC_NOT_FINITE, IMU_Y, 0);
    REFUSED_SETTING(imu.heading_rad = REAL(1e30), LACONIC_OVERFLOW, IMU_HEADING, 0);
    REFUSED_SETTING(imu.acceleration_scale_error[1] = NOT_A_NUMBER, LACONIC_NOT_FINITE, IMU_ACCELERATION_SCALE_ERROR,
                    2);
    REFUSED_SETTING(imu.acceleration_bias_m_per_s2[0] = -INFINITE, LACONIC_NOT_FINITE, IMU_ACCELERATION_BIAS, 1);
    REFUSED_SETTING(imu.acceleration_noise_m_per_s2_per_sqrt_Hz = -1, LACONIC_NEGATIVE, IMU_ACCELERATION_NOISE, 0);
    REFUSED_SETTING(imu.acceleration_range_m_per_s2 = -1, LACONIC_NEGATIVE, IMU_ACCELERATION_RANGE, 0);
    REFUSED_SETTING(imu.yaw_rate_scale_error = NOT_A_NUMBER, LACONIC_NOT_FINITE, IMU_YAW_RATE_SCALE_ERROR, 0);
    REFUSED_SETTING(imu.yaw_rate_bias_rad_per_s = NOT_A_NUMBER, LACONIC_NOT_FINITE, IMU_YAW_RATE_BIAS, 0);
    REFUSED_SETTING(imu.yaw_rate_noise_rad_per_s_per_sqrt_Hz = -1, LACONIC_NEGATIVE, IMU_YAW_RATE_NOISE, 0);
    REFUSED_SETTING(imu.yaw_rate_range_rad_per_s = -1, LACONIC_NEGATIVE, IMU_YAW_RATE_RANGE, 0);
    REFUSED_SETTING(imu.delay_steps = -1, LACONIC_NEGATIVE, IMU_DELAY, 0);
    REFUSED_SETTING(imu.delay_steps = LACONIC_IMU_MAX_DELAY + 1, LACONIC_ABOVE_LIMIT, IMU_DELAY, 0);
    REFUSED_SETTING(encoder_wrap = -1, LACONIC_NEGATIVE, WHEEL_ENCODER_WRAP, 0);
    REFUSED_SETTING(encoder[1].counts_per_turn = -1, LACONIC_NEGATIVE, WHEEL_ENCODER_COUNTS, 2);
    REFUSED_SETTING(encoder[2].gear_ratio = NOT_A_NUMBER, LACONIC_NOT_FINITE, WHEEL_ENCODER_GEAR_RATIO, 3);
    REFUSED_SETTING(encoder[3].counts_per_turn = 1, LACONIC_ABOVE_LIMIT, WHEEL_ENCODER_COUNTS, 4);
}

static void a_refusal_names_the_key_of_the_scene_and_changes_nothing(void) {
    const laconic_plant plant = started(wheels(), STEP, 0, 0, 0);
    laconic_sensor_settings settings = everything();
    laconic_sensors sensors = beside(&plant, settings);
    const laconic_sensors before = sensors;
    char text[200];
    settings.imu.delay_steps = 1000;
    ASSERT_STATUS(LACONIC_ABOVE_LIMIT, laconic_sensors_start(&sensors, &settings, &plant, &why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &sensors, sizeof sensors);
    laconic_message(&why, text, sizeof text);
    TEST_ASSERT_EQUAL_STRING("sensors.imu.delay_steps: 1000 is above 64; give 64 or less", text);
}

/* ----------------------------------------------------------------------------------- plant -- */

static void a_watched_plant_takes_the_same_steps_to_the_last_bit(void) {
    laconic_plant alone = started(wheels(), STEP, 1, 2, 3), watched = alone;
    const laconic_input input = push(2);
    laconic_sensors sensors = beside(&watched, everything());
    watch(&sensors, &watched, &input, 500);
    run(&alone, &input, 500);
    TEST_ASSERT_EQUAL_MEMORY(&alone.state, &watched.state, sizeof alone.state);
    TEST_ASSERT_TRUE(alone.steps == watched.steps);
}

static void readings_do_not_depend_on_how_steps_are_grouped(void) {
    const laconic_input input = push(2);
    for (int kind = 0; kind < 3; kind++) { /* watched step by step, without need, and for a delay alone */
        laconic_plant one = started(wheels(), STEP, 1, 2, 3), other = one;
        laconic_sensor_settings settings = kind == 0 ? everything() : nothing();
        if (kind == 2) settings.imu.delay_steps = 1;
        settings.imu.acceleration_noise_m_per_s2_per_sqrt_Hz = REAL(0.1);
        laconic_sensors a = beside(&one, settings), b = beside(&other, settings);
        watch(&a, &one, &input, 70);
        for (int k = 0; k < 70; k++) watch(&b, &other, &input, 1);
        const laconic_sensor_outputs together = readings(&a, &one, &input), single = readings(&b, &other, &input);
        TEST_ASSERT_EQUAL_MEMORY(&together, &single, sizeof single);
    }
}

static void a_copy_goes_on_as_the_original_does(void) {
    laconic_plant plant = started(wheels(), STEP, 1, 2, 3);
    const laconic_input input = push(2);
    laconic_sensors sensors = beside(&plant, everything());
    watch(&sensors, &plant, &input, 10);
    const laconic_plant kept = plant;
    const laconic_sensors kept_sensors = sensors;
    watch(&sensors, &plant, &input, 10);
    const laconic_sensor_outputs first = readings(&sensors, &plant, &input);
    plant = kept;
    sensors = kept_sensors;
    watch(&sensors, &plant, &input, 10);
    const laconic_sensor_outputs again = readings(&sensors, &plant, &input);
    TEST_ASSERT_EQUAL_MEMORY(&first, &again, sizeof first);
}

/* ------------------------------------------------------------------------------------- time -- */

static void a_delay_shows_the_sample_of_so_many_steps_ago(void) {
    const laconic_input input = push(2);
    for (int32_t delay = 0; delay <= LACONIC_IMU_MAX_DELAY; delay += LACONIC_IMU_MAX_DELAY / 4) {
        laconic_plant one = started(wheels(), STEP, 1, 2, 3), other = one;
        laconic_sensor_settings settings = everything();
        settings.imu.delay_steps = 0;
        laconic_sensors prompt = beside(&one, settings);
        settings.imu.delay_steps = delay;
        laconic_sensors late = beside(&other, settings);
        watch(&prompt, &one, &input, 100);
        watch(&late, &other, &input, 100 + (uint64_t)delay);
        const laconic_sensor_outputs now = readings(&prompt, &one, &input), then = readings(&late, &other, &input);
        TEST_ASSERT_TRUE(now.imu_acceleration_m_per_s2[0] == then.imu_acceleration_m_per_s2[0]);
        TEST_ASSERT_TRUE(now.imu_acceleration_m_per_s2[1] == then.imu_acceleration_m_per_s2[1]);
        TEST_ASSERT_TRUE(now.imu_yaw_rate_rad_per_s == then.imu_yaw_rate_rad_per_s);
    }
}

/* The puck moves from step 1 on: a delay of 3 shows it at step 4. */
static void a_command_is_felt_in_its_own_step_and_shown_after_the_delay(void) {
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 0);
    laconic_sensor_settings settings = nothing();
    laconic_input input = no_input();
    settings.imu.delay_steps = 3;
    laconic_sensors sensors = beside(&plant, settings);
    input.body_force_N[0] = REAL(10);
    for (int k = 1; k <= 4; k++) {
        watch(&sensors, &plant, &input, 1);
        ASSERT_NEAR(4 * ROUNDING, k < 4 ? 0 : 1, readings(&sensors, &plant, &input).imu_acceleration_m_per_s2[0]);
    }
}

static void the_imu_keeps_what_acted_while_the_acceleration_takes_what_acts(void) {
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 0);
    laconic_input input = no_input();
    laconic_sensors sensors = beside(&plant, nothing());
    input.body_force_N[0] = REAL(10);
    TEST_ASSERT_TRUE(readings(&sensors, &plant, &input).imu_acceleration_m_per_s2[0] == 0);
    watch(&sensors, &plant, &input, 1);
    input.body_force_N[0] = REAL(-20);
    const laconic_sensor_outputs out = readings(&sensors, &plant, &input);
    ASSERT_NEAR(4 * ROUNDING, 1, out.imu_acceleration_m_per_s2[0]);
    ASSERT_NEAR(4 * ROUNDING, -2, out.acceleration_body_m_per_s2[0]);
}

static void a_sampled_step_is_felt_with_the_input_at_its_end(void) {
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 0);
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    laconic_sensors sensors = beside(&plant, nothing());
    samples[2].body_force_N[0] = REAL(10);
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_run_sampled(&sensors, &plant, samples, &why));
    ASSERT_NEAR(4 * ROUNDING, 1, readings(&sensors, &plant, samples).imu_acceleration_m_per_s2[0]);
}

static void refused_steps_leave_the_last_sample(void) {
    laconic_sensor_settings each[2] = {nothing(), everything()};
    for (int k = 0; k < 2; k++) {
        laconic_plant plant = started(wheels(), STEP, 1, 2, 3);
        laconic_input samples[3] = {push(2), push(2), push(2)};
        laconic_sensors sensors = beside(&plant, each[k]);
        watch(&sensors, &plant, samples, 5);
        const laconic_sensors before = sensors;
        samples[0].voltage_V[0] = NOT_A_NUMBER;
        ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_sensors_run(&sensors, &plant, samples, 7, &why));
        ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_sensors_run_sampled(&sensors, &plant, samples, &why));
        TEST_ASSERT_EQUAL_MEMORY(&before, &sensors, sizeof sensors);
    }
}

/* Explicit methods refuse a puck that spins up: the steps before have been taken, and are felt. */
static void a_run_that_is_refused_on_its_way_is_felt_up_to_there(void) {
    laconic_vehicle v = three_wheels();
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    laconic_input input = no_input();
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0.1), &start, &why));
    laconic_sensors sensors = beside(&plant, nothing());
    input.body_moment_Nm = REAL(50);
    TEST_ASSERT_TRUE(laconic_sensors_run(&sensors, &plant, &input, 1000, &why) != LACONIC_OK);
    TEST_ASSERT_TRUE(plant.steps > 0 && sensors.newest == plant.steps);
    laconic_real velocity[2];
    const laconic_real yaw_rate = laconic_body_velocity(&plant.model, &plant.state, velocity);
    ASSERT_NEAR(1e-5 * (double)yaw_rate, yaw_rate, readings(&sensors, &plant, &input).imu_yaw_rate_rad_per_s);
}

/* --------------------------------------------------------------------------------- encoders -- */

static void encoders_count_the_angles_of_their_wheels(void) {
    for (int ground = 0; ground < 2; ground++) {
        laconic_plant plant = started(ground == 0 ? wheels() : robotino(0.4, 0.1, 0), STEP, 1, 2, 3);
        laconic_sensor_settings settings = everything();
        const laconic_input input = push(1);
        laconic_real angle[3];
        settings.encoder_wrap = 0;
        laconic_sensors sensors = beside(&plant, settings);
        watch(&sensors, &plant, &input, 400);
        laconic_plant_wheel_angles(&plant, angle);
        for (int i = 0; i < 3; i++) {
            const double counts = (double)angle[i] * (double)settings.encoder[i].gear_ratio * 1024 / (2 * PI);
            TEST_ASSERT_TRUE(fabs(counts) > 20);
            ASSERT_NEAR(1.01, counts - 0.5, readings(&sensors, &plant, &input).encoder_count[i]);
        }
        TEST_ASSERT_TRUE(readings(&sensors, &plant, &input).encoder_count[3] == 0);
    }
}

static void a_change_of_the_vehicle_turns_no_encoder(void) {
    laconic_plant plant = started(wheels(), STEP, 1, 2, 3);
    laconic_vehicle loaded = wheels();
    const laconic_input input = push(1);
    laconic_sensors sensors = beside(&plant, everything());
    watch(&sensors, &plant, &input, 100);
    const laconic_sensor_outputs before = readings(&sensors, &plant, &input);
    loaded.payload.mass_kg = 5;
    loaded.payload.x_m = REAL(0.1);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    const laconic_sensor_outputs after = readings(&sensors, &plant, &input);
    TEST_ASSERT_EQUAL_MEMORY(before.encoder_count, after.encoder_count, sizeof after.encoder_count);
    watch(&sensors, &plant, &input, 1);
    for (int i = 0; i < 3; i++) {
        const double moved =
            (double)readings(&sensors, &plant, &input).encoder_count[i] - (double)before.encoder_count[i];
        TEST_ASSERT_TRUE(fabs(moved) < 40 || fabs(moved) > 65536 - 40);
    }
}

/* On each alone, and on all. The sanitizers of continuous integration watch the ends of the arrays. */
static void each_of_as_many_wheels_as_there_may_be_can_have_an_encoder(void) {
    laconic_vehicle v = with_motors(bare_body());
    const laconic_input input = no_input();
    laconic_real angle_rad[LACONIC_MAX_WHEELS];
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        const double angle = 2 * PI * i / LACONIC_MAX_WHEELS;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.2 * cos(angle), 0.2 * sin(angle), angle, PI / 2);
    }
    for (int alone = 0; alone <= LACONIC_MAX_WHEELS; alone++) {
        laconic_plant plant = started(v, STEP, 1, 2, 3);
        laconic_sensor_settings settings = nothing();
        for (int i = 0; i < LACONIC_MAX_WHEELS; i++)
            settings.encoder[i].counts_per_turn = alone == i || alone == LACONIC_MAX_WHEELS ? 4096 : 0;
        laconic_sensors sensors = beside(&plant, settings);
        watch(&sensors, &plant, &input, 400);
        laconic_plant_wheel_angles(&plant, angle_rad);
        const laconic_sensor_outputs out = readings(&sensors, &plant, &input);
        for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
            const double turned = settings.encoder[i].counts_per_turn * (double)angle_rad[i] / (2 * PI);
            TEST_ASSERT_TRUE(fabs(turned - (double)out.encoder_count[i]) < 1.5);
        }
    }
}

static void a_wheel_that_is_too_fast_to_count_is_refused(void) {
    laconic_plant plant = started(wheels(), 10, 0, 0, 1e5);
    laconic_sensor_settings settings = nothing();
    const laconic_input input = no_input();
    settings.encoder[1] = (laconic_encoder_settings){1000000000, 1000};
    laconic_sensors sensors = beside(&plant, settings);
    ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS, 2,
                   laconic_sensors_run(&sensors, &plant, &input, 1, &why), why);
    TEST_ASSERT_TRUE(why.limit == 0); /* it is of counts, the value of radians */
}

static void a_place_so_far_that_its_acceleration_overflows_is_refused_by_the_step(void) {
    const laconic_input input = no_input();
    for (int axis = 0; axis < 2; axis++) {
        laconic_plant plant = started(bare_body(), STEP, 0, 0, 30);
        laconic_sensor_settings settings = nothing();
        *(axis == 0 ? &settings.imu.x_m : &settings.imu.y_m) = REAL(0.9e15);
        laconic_sensors sensors = beside(&plant, settings);
        const laconic_sensor_field far = axis == 0 ? LACONIC_SENSOR_FIELD_IMU_X : LACONIC_SENSOR_FIELD_IMU_Y;
        ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)far, 0, laconic_sensors_run(&sensors, &plant, &input, 1, &why),
                       why);
        TEST_ASSERT_TRUE(fabs((double)why.value) > 1e15); /* the acceleration that is too large */
        TEST_ASSERT_TRUE(why.limit == 0);
    }
}

/* --------------------------------------------------------------------------------- friction -- */

static void velocity_in_the_world(double out[2], const laconic_plant *plant, double dx, double dy) {
    laconic_real v[2];
    laconic_pose pose;
    const double yaw_rate = (double)laconic_body_velocity(&plant->model, &plant->state, v);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    const double c = cos((double)pose.heading_rad), s = sin((double)pose.heading_rad);
    const double along = (double)v[0] - yaw_rate * dy, across = (double)v[1] + yaw_rate * dx;
    out[0] = c * along - s * across;
    out[1] = s * along + c * across;
}

/* In the axes of the step's middle. */
static void assert_change(const double before[2], const double after[2], double middle_rad, double step_s,
                          const laconic_real acceleration[2]) {
    const double ax = (after[0] - before[0]) / step_s, ay = (after[1] - before[1]) / step_s;
    const double tolerance = EITHER(1e-10, 3e-3);
    ASSERT_NEAR(tolerance, cos(middle_rad) * ax + sin(middle_rad) * ay, acceleration[0]);
    ASSERT_NEAR(tolerance, cos(middle_rad) * ay - sin(middle_rad) * ax, acceleration[1]);
}

static void with_friction_acceleration_is_the_change_of_velocity_over_the_step(void) {
    laconic_plant plant = started(with_drive(robotino(0.4, 0.1, 0)), STEP, 5, -3, 4);
    laconic_sensor_settings settings = nothing();
    const laconic_input input = push(3);
    double before[2], after[2], origin_before[2], origin_after[2];
    laconic_pose start, end;
    settings.imu.x_m = REAL(0.12);
    settings.imu.y_m = REAL(0.07);
    laconic_sensors sensors = beside(&plant, settings);
    watch(&sensors, &plant, &input, 20);
    velocity_in_the_world(before, &plant, 0.12, 0.07);
    velocity_in_the_world(origin_before, &plant, 0, 0);
    laconic_pose_of(&start, &plant.model, &plant.state);
    watch(&sensors, &plant, &input, 1);
    velocity_in_the_world(after, &plant, 0.12, 0.07);
    velocity_in_the_world(origin_after, &plant, 0, 0);
    laconic_pose_of(&end, &plant.model, &plant.state);
    const double middle = ((double)start.heading_rad + (double)end.heading_rad) / 2;
    const laconic_sensor_outputs out = readings(&sensors, &plant, &input);
    assert_change(before, after, middle, STEP, out.imu_acceleration_m_per_s2);
    assert_change(origin_before, origin_after, middle, STEP, out.acceleration_body_m_per_s2);
}

/* It stands on its wheels: their grip holds g sin α against the slope. */
static void a_vehicle_that_stands_on_a_slope_feels_the_ground_that_holds_it(void) {
    laconic_vehicle v = robotino(0.9, 1, 0);
    laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    const laconic_input input = no_input();
    v.ground.slope_rad = REAL(0.1);
    v.ground.slope_heading_rad = REAL(0.5);
    start.heading_rad = REAL(0.2);
    for (int i = 0; i < 3; i++) v.wheel[i].locked = true;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(STEP), &start, &why));
    laconic_sensors sensors = beside(&plant, nothing());
    watch(&sensors, &plant, &input, 10);
    const laconic_sensor_outputs out = readings(&sensors, &plant, &input);
    const double pull = 9.80665 * sin(0.1), tolerance = EITHER(1e-6, 1e-3);
    ASSERT_NEAR(tolerance, pull * cos(0.3), out.imu_acceleration_m_per_s2[0]);
    ASSERT_NEAR(tolerance, pull * sin(0.3), out.imu_acceleration_m_per_s2[1]);
    ASSERT_NEAR(tolerance, 0, out.acceleration_body_m_per_s2[0]);
}

/* --------------------------------------------------------------------------------- recording -- */

static void step_beside(laconic_sensors *sensors, laconic_plant *plant, const laconic_input *input, int sampled) {
    const laconic_input three[3] = {*input, *input, *input};
    if (sampled)
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_run_sampled(sensors, plant, three, &why));
    else
        watch(sensors, plant, input, 1);
}

static void a_recorder_shows_the_readings_of_the_steps_taken_one_by_one(void) {
    static const uint32_t column[3] = {offsetof(laconic_outputs, sensors.imu_acceleration_m_per_s2),
                                       offsetof(laconic_outputs, sensors.acceleration_body_m_per_s2),
                                       offsetof(laconic_outputs, sensors.encoder_count)};
    static const uint32_t signal[1] = {offsetof(laconic_input, voltage_V)};
    const laconic_real value[3] = {2, 2, 2};
    const uint64_t until[1] = {30};
    for (int sampled = 0; sampled < 2; sampled++) {
        laconic_plant plant = started(wheels(), STEP, 1, 2, 3), other = plant;
        laconic_sensors sensors = beside(&plant, everything()), others = sensors;
        laconic_real row[5][3], values[90];
        for (int k = 0; k < 90; k++) values[k] = 2;
        const laconic_schedule held = {1, signal, value, until, 1, 0}, samples = {1, signal, values, NULL, 30, 0};
        laconic_recorder recorder = {
            .every = 7, .column_count = 3, .column = column, .row = &row[0][0], .row_room = 5, .sensors = &sensors};
        laconic_input input = no_input();
        input.voltage_V[0] = 2;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, sampled ? &samples : &held, 30, &recorder, &why));
        TEST_ASSERT_EQUAL_INT(5, (int)recorder.row_count);
        for (int k = 0; k < 5; k++) {
            const laconic_sensor_outputs out = readings(&others, &other, &input);
            TEST_ASSERT_TRUE(row[k][0] == out.imu_acceleration_m_per_s2[0]);
            TEST_ASSERT_TRUE(row[k][1] == out.acceleration_body_m_per_s2[0]);
            TEST_ASSERT_TRUE(row[k][2] == out.encoder_count[0]);
            for (int n = 0; n < 7; n++) step_beside(&others, &other, &input, sampled);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(settings_that_make_no_sense_are_refused_by_name);
    RUN_TEST(a_refusal_names_the_key_of_the_scene_and_changes_nothing);
    RUN_TEST(a_watched_plant_takes_the_same_steps_to_the_last_bit);
    RUN_TEST(readings_do_not_depend_on_how_steps_are_grouped);
    RUN_TEST(a_copy_goes_on_as_the_original_does);
    RUN_TEST(a_delay_shows_the_sample_of_so_many_steps_ago);
    RUN_TEST(a_command_is_felt_in_its_own_step_and_shown_after_the_delay);
    RUN_TEST(the_imu_keeps_what_acted_while_the_acceleration_takes_what_acts);
    RUN_TEST(a_sampled_step_is_felt_with_the_input_at_its_end);
    RUN_TEST(refused_steps_leave_the_last_sample);
    RUN_TEST(a_run_that_is_refused_on_its_way_is_felt_up_to_there);
    RUN_TEST(encoders_count_the_angles_of_their_wheels);
    RUN_TEST(a_change_of_the_vehicle_turns_no_encoder);
    RUN_TEST(each_of_as_many_wheels_as_there_may_be_can_have_an_encoder);
    RUN_TEST(a_wheel_that_is_too_fast_to_count_is_refused);
    RUN_TEST(a_place_so_far_that_its_acceleration_overflows_is_refused_by_the_step);
    RUN_TEST(with_friction_acceleration_is_the_change_of_velocity_over_the_step);
    RUN_TEST(a_vehicle_that_stands_on_a_slope_feels_the_ground_that_holds_it);
    RUN_TEST(a_recorder_shows_the_readings_of_the_steps_taken_one_by_one);
    return UNITY_END();
}
