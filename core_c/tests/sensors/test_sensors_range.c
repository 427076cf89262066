/* Tests of sensors.c: samples beyond the range, what a run says of them, and a vehicle whose ground changes. */
#include "check.h"
#include "slipping.h"

#define STEP 1e-3

static laconic_sensors beside(const laconic_plant *plant, laconic_sensor_settings settings) {
    laconic_sensors sensors;
    memset(&sensors, 0xA5, sizeof sensors); /* as memory comes */
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, plant, &why));
    return sensors;
}

static void every_number_is_a_seed(void) {
    const int32_t seeds[] = {INT32_MIN, -1, 0, INT32_MAX};
    for (int k = 0; k < 4; k++) {
        const laconic_sensor_settings settings = {.imu = {.seed = seeds[k]}};
        ASSERT_STATUS(LACONIC_OK, laconic_sensor_settings_check(&settings, 3, &why));
    }
}

static void the_last_encoder_that_there_can_be_is_checked(void) {
    laconic_sensor_settings settings = {0};
    settings.encoder[LACONIC_MAX_WHEELS - 1].gear_ratio = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, (laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_GEAR_RATIO, LACONIC_MAX_WHEELS,
                   laconic_sensor_settings_check(&settings, 3, &why), why);
}

/* By either sign of its speed: told is by how much it turned. */
static void of_a_wheel_that_is_too_fast_to_count_its_turn_is_told(void) {
    const laconic_input input = no_input();
    for (int way = -1; way <= 1; way += 2) {
        laconic_sensor_settings settings = {0};
        laconic_plant plant = started(caster(), STEP, 500 * way, 0, 0);
        settings.encoder[0] = (laconic_encoder_settings){1000000000, 1000};
        laconic_sensors sensors = beside(&plant, settings);
        ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS, 1,
                       laconic_sensors_run(&sensors, &plant, &input, 1, &why), why);
        ASSERT_NEAR(EITHER(1e-12, 1e-6), 500 * way * STEP, why.value);
    }
}

/* A body that yaws by 2 rad/s feels −4 d m/s² along its axes at a place d: the coordinate that is farther is named, and
 * the larger part told. */
static void of_a_sample_beyond_the_range_the_farther_coordinate_and_the_larger_part_are_told(void) {
    const struct {
        double x_m, y_m, heading_rad;
        laconic_sensor_field far;
        double told;
    } places[] = {{1e15, 3e14, 0, LACONIC_SENSOR_FIELD_IMU_X, -4e15},
                  {-1e15, 3e14, 0, LACONIC_SENSOR_FIELD_IMU_X, 4e15},
                  {-1e15, -3e14, PI / 2, LACONIC_SENSOR_FIELD_IMU_X, -4e15},
                  {3e14, 1e15, 0, LACONIC_SENSOR_FIELD_IMU_Y, -4e15},
                  {-3e14, -1e15, 0, LACONIC_SENSOR_FIELD_IMU_Y, 4e15}};
    const laconic_input input = no_input();
    for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
        laconic_plant plant = started(bare_body(), STEP, 0, 0, 2 * BIG_LAMBDA);
        laconic_sensor_settings settings = {0};
        settings.imu.x_m = REAL(places[k].x_m);
        settings.imu.y_m = REAL(places[k].y_m);
        settings.imu.heading_rad = REAL(places[k].heading_rad);
        laconic_sensors sensors = beside(&plant, settings);
        ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)places[k].far, 0,
                       laconic_sensors_run(&sensors, &plant, &input, 1, &why), why);
        ASSERT_NEAR(EITHER(1e3, 1e10), places[k].told, why.value);
    }
}

/* Half a metre from the axis, and where both are as far or as large but for the last digits: the first coordinate of
 * two that are as far, and of two parts that are as large the second. */
static void ties_and_small_differences_are_told_apart(void) {
    const double next = 2e5 + EITHER(3e-11, 0.02); /* the next number */
    const struct {
        double yaw_rad_per_s, x_m, y_m;
        laconic_sensor_field far;
        int sign; /* of the part that is told */
    } places[] = {{1e8, 0, 0.5, LACONIC_SENSOR_FIELD_IMU_Y, -1},     {1e8, 0.5, 0, LACONIC_SENSOR_FIELD_IMU_X, -1},
                  {1e8, 0.5, -0.25, LACONIC_SENSOR_FIELD_IMU_X, -1}, {1e8, 2, 2, LACONIC_SENSOR_FIELD_IMU_X, -1},
                  {1e8, 2, -2, LACONIC_SENSOR_FIELD_IMU_X, 1},       {1e5, next, -2e5, LACONIC_SENSOR_FIELD_IMU_X, -1},
                  {1e5, 2e5, -next, LACONIC_SENSOR_FIELD_IMU_Y, 1}};
    laconic_vehicle v = bare_body();
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = 1;
    const laconic_input input = no_input();
    for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
        laconic_plant plant = started(v, 1e-6, 0, 0, places[k].yaw_rad_per_s);
        laconic_sensor_settings settings = {0};
        settings.imu.x_m = REAL(places[k].x_m);
        settings.imu.y_m = REAL(places[k].y_m);
        laconic_sensors sensors = beside(&plant, settings);
        ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)places[k].far, 0,
                       laconic_sensors_run(&sensors, &plant, &input, 1, &why), why);
        TEST_ASSERT_TRUE(places[k].sign < 0 ? why.value < 0 : why.value > 0);
    }
}

/* A body that yaws by 1e5 rad/s feels the largest number that there may be at 1e5 m; the next number is beyond. */
static void a_sample_may_be_the_largest_number_and_no_larger(void) {
    laconic_vehicle v = bare_body();
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = 1;
    const laconic_input input = no_input();
    const laconic_real far = REAL(1e5), farther = far + EITHER(REAL(6e-11), REAL(0.01));
    for (int axis = 0; axis < 2; axis++) {
        laconic_plant plant = started(v, 1e-6, 0, 0, 1e5);
        laconic_sensor_settings settings = {0};
        laconic_real *place = axis == 0 ? &settings.imu.x_m : &settings.imu.y_m;
        *place = far;
        laconic_sensors sensors = beside(&plant, settings);
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(&sensors, &plant, &input, 1, &why));
        TEST_ASSERT_TRUE(sensors.sample[1].specific_force_m_per_s2[axis] == -REAL(1e15));
        *place = farther;
        sensors = beside(&plant, settings);
        TEST_ASSERT_TRUE((double)farther * 1e10 < 1e15 + EITHER(1, 1e8));
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_sensors_run(&sensors, &plant, &input, 1, &why));
    }
}

static void a_watched_run_ends_with_the_step_whose_sample_is_refused(void) {
    const laconic_sensor_settings settings = {.imu = {.x_m = REAL(1e15), .delay_steps = 1}};
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 2 * BIG_LAMBDA);
    laconic_sensors sensors = beside(&plant, settings);
    const laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_sensors_run(&sensors, &plant, &input, 5, &why));
    TEST_ASSERT_EQUAL_UINT64(1, plant.steps);
}

/* Of a run along a schedule, too. */
static void a_recorded_run_ends_with_the_step_whose_sample_is_refused(void) {
    const laconic_sensor_settings settings = {.imu = {.x_m = REAL(1e15)}};
    const laconic_real none[2] = {0};
    const uint32_t signals[] = {offsetof(laconic_input, body_moment_Nm)};
    const uint64_t until = 5;
    const laconic_schedule schedule = {1, signals, none, &until, 1, 0};
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 2 * BIG_LAMBDA);
    laconic_sensors sensors = beside(&plant, settings);
    laconic_recorder recorder = {.sensors = &sensors};
    ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_IMU_X, 0,
                   laconic_plant_follow(&plant, &schedule, until, &recorder, &why), why);
    const laconic_real nothing[3] = {0};
    const laconic_schedule sampled = {1, signals, nothing, NULL, 1, plant.steps};
    ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_IMU_X, 0,
                   laconic_plant_follow(&plant, &sampled, plant.steps + 1, &recorder, &why), why);
}

/* Of a wheel that turned by a quarter. */
static void an_encoder_of_any_number_of_counts_counts(void) {
    for (int32_t counts = 1; counts < 9; counts++) {
        const laconic_input input = no_input();
        laconic_sensor_settings settings = {0};
        laconic_sensor_outputs shown;
        laconic_plant plant = started(caster(), STEP, PI / 2, 0, 0);
        settings.encoder[0] = (laconic_encoder_settings){counts, 4};
        laconic_sensors sensors = beside(&plant, settings);
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(&sensors, &plant, &input, 1010, &why));
        laconic_sensors_read(&shown, &sensors, &plant, &input);
        TEST_ASSERT_EQUAL_INT(counts, (int)shown.encoder_count[0]);
    }
}

static void a_sampled_step_whose_sample_is_beyond_the_range_is_refused(void) {
    const laconic_sensor_settings settings = {.imu = {.y_m = REAL(1e15)}};
    laconic_plant plant = started(bare_body(), STEP, 0, 0, 2 * BIG_LAMBDA);
    laconic_sensors sensors = beside(&plant, settings);
    const laconic_input samples[3] = {no_input(), no_input(), no_input()};
    ASSERT_REFUSED(LACONIC_OVERFLOW, (laconic_field)LACONIC_SENSOR_FIELD_IMU_Y, 0,
                   laconic_sensors_run_sampled(&sensors, &plant, samples, &why), why);
    TEST_ASSERT_EQUAL_UINT64(1, plant.steps);
}

/* An explicit method refuses a body that spins up; what it feels by then is beyond the range as well. */
static void of_a_refused_step_its_own_reason_is_told(void) {
    const laconic_sensor_settings settings = {.imu = {.x_m = REAL(1e15)}};
    const laconic_vehicle v = three_wheels();
    const laconic_start start = start_with(0, 0, 0);
    laconic_input input = no_input();
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0.1), &start, &why));
    laconic_sensors sensors = beside(&plant, settings);
    input.body_moment_Nm = REAL(10);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_sensors_run(&sensors, &plant, &input, 1000, &why), why);
    const uint64_t taken = plant.steps;
    TEST_ASSERT_TRUE(taken > 0);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_sensors_run(&sensors, &plant, &input, 1000, &why), why);
    TEST_ASSERT_EQUAL_UINT64(taken, plant.steps);
    TEST_ASSERT_EQUAL_UINT64(plant.steps, sensors.newest);
}

/* The acceleration beside friction is the mean of a step: before the first there is none. */
static void ground_that_gets_friction_shows_no_acceleration_before_its_first_step(void) {
    const laconic_sensor_settings settings = {0};
    laconic_vehicle v = three_wheels();
    laconic_plant plant = started(v, STEP, 1, 2, 3);
    laconic_sensors sensors = beside(&plant, settings);
    const laconic_input input = no_input();
    laconic_real acceleration[2] = {1, 1};
    v.ground.friction_coefficient = REAL(0.5);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
    laconic_acceleration_body(acceleration, &sensors, &plant, &input);
    TEST_ASSERT_TRUE(acceleration[0] == 0 && acceleration[1] == 0);
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(&sensors, &plant, &input, 1, &why));
    laconic_acceleration_body(acceleration, &sensors, &plant, &input);
    TEST_ASSERT_TRUE(acceleration[0] != 0 && acceleration[1] != 0);
}

/* Tests of noise.c: the deviates are normal, independent, and a function of seed, stream and index alone. */

#define PAIRS 100000
#define DEVIATES (2 * PAIRS)

static laconic_real deviate[DEVIATES];

static void draw(uint64_t seed, uint32_t stream) {
    for (int k = 0; k < PAIRS; k++) laconic_normal_pair(&deviate[2 * k], seed, stream, (uint64_t)k);
}

/* Of the algorithm, in 40 digits. */
static void the_deviates_are_those_of_an_independent_computation(void) {
    static const struct {
        uint64_t seed;
        uint32_t stream;
        uint64_t index;
        double pair[2];
    } known[] = {
        {0, 0, 0, {-0.1766018926540237253, 1.462162844123599351}},
        {0, 0, 1, {-1.6021330001690335355, 0.20066267715082806541}},
        {0, 1, 0, {1.0821993744951434107, 2.9502102345625278839}},
        {1, 0, 0, {-1.1555550284866270317, 0.58301474149137348203}},
        {12345, 1, UINT64_C(1000000000000), {0.17935178274646716135, 0.31527301537846285905}},
        {3, 0, UINT64_C(3651683935388646773), {6.9989972334352838299, -6.3037192861070711446}}, /* its share is 0 */
        {0, 0, UINT64_C(73309687144073641), {8.1411145491259408851, 4.4997631529166852893}},    /* and here 3 of 2^64 */
        {UINT64_C(4294967295), 0, UINT64_C(18446744073709551613), {1.2976304681674344532, 1.576964164913850127}}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, known[k].seed, known[k].stream, known[k].index);
        ASSERT_NEAR(4 * ROUNDING, known[k].pair[0], pair[0]);
        ASSERT_NEAR(4 * ROUNDING, known[k].pair[1], pair[1]);
    }
}

/* Where the logarithm rounds otherwise once its series has one more term, or begins with another number than 0. */
static void some_deviates_are_the_same_to_the_last_bit(void) {
    static const struct {
        uint64_t index;
        double pair[2], in_single[2];
    } known[] = {{871, {-0x1.fd2761a318dp-2, 0x1.5672786a9f244p-1}, {-0x1.fd2764p-2, 0x1.567276p-1}},
                 {1132, {-0x1.8c8ff66c8cea4p-1, -0x1.3d13551dab563p-2}, {-0x1.8c8ff8p-1, -0x1.3d1356p-2}},
                 {6782, {-0x1.a2c735e3da90dp-1, 0x1.e580a49d12936p-3}, {-0x1.a2c738p-1, 0x1.e580a8p-3}},
                 {64659, {0x1.a7c187ca5f297p-1, 0x1.4978fba1274d8p-11}, {0x1.a7c188p-1, 0x1.4978f6p-11}}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, 1, 0, known[k].index);
        for (int m = 0; m < 2; m++)
            TEST_ASSERT_TRUE((double)pair[m] == EITHER(known[k].pair[m], known[k].in_single[m]));
    }
}

/* Standard errors of n deviates: mean 1/√n, variance √(2/n), third moment √(15/n), fourth √(96/n). */
static void mean_variance_and_higher_moments_are_those_of_the_normal_distribution(void) {
    const double expected[4] = {0, 1, 0, 3}, error[4] = {1, sqrt(2), sqrt(15), sqrt(96)};
    double sum[4] = {0};
    draw(1, 0);
    for (int k = 0; k < DEVIATES; k++) {
        double power = 1;
        for (int m = 0; m < 4; m++) sum[m] += power *= (double)deviate[k];
    }
    for (int m = 0; m < 4; m++) ASSERT_NEAR(4 * error[m] / sqrt(DEVIATES), expected[m], sum[m] / DEVIATES);
}

/* How many lie beyond so many standard deviations, by the table of the normal distribution. */
static void tails_are_those_of_the_table(void) {
    static const struct {
        double beyond, share;
    } table[] = {{0.5, 0.6170750774519738},  {1, 0.31731050786291415},    {2, 0.04550026389635842},
                 {3, 0.0026997960632601866}, {3.5, 4.652581580710502e-4}, {4, 6.334248366623985e-5}};
    draw(2, 1);
    for (size_t t = 0; t < sizeof table / sizeof table[0]; t++) {
        int above = 0, below = 0;
        const double half = table[t].share / 2 * DEVIATES; /* on either side */
        for (int k = 0; k < DEVIATES; k++) {
            above += (double)deviate[k] > table[t].beyond;
            below += (double)deviate[k] < -table[t].beyond;
        }
        ASSERT_NEAR(4 * sqrt(half), half, above);
        ASSERT_NEAR(4 * sqrt(half), half, below);
    }
}

static double correlation(uint64_t seed, uint32_t stream, uint64_t later, int part) {
    double sum = 0;
    for (int k = 0; k < 20000; k++) {
        laconic_real one[2], other[2];
        laconic_normal_pair(one, 3, 0, (uint64_t)k);
        laconic_normal_pair(other, seed, stream, (uint64_t)k + later);
        sum += (double)one[0] * (double)other[part];
    }
    return sum / 20000;
}

static void neighbours_in_seed_stream_index_and_pair_are_independent(void) {
    const double within = 4 / sqrt(20000);
    ASSERT_NEAR(within, 0, correlation(3, 0, 0, 1));
    ASSERT_NEAR(within, 0, correlation(3, 0, 1, 0));
    ASSERT_NEAR(within, 0, correlation(3, 1, 0, 0));
    ASSERT_NEAR(within, 0, correlation(4, 0, 0, 0));
    ASSERT_NEAR(within, 0, correlation(4, 1, 1, 1));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_number_is_a_seed);
    RUN_TEST(the_last_encoder_that_there_can_be_is_checked);
    RUN_TEST(of_a_wheel_that_is_too_fast_to_count_its_turn_is_told);
    RUN_TEST(of_a_sample_beyond_the_range_the_farther_coordinate_and_the_larger_part_are_told);
    RUN_TEST(ties_and_small_differences_are_told_apart);
    RUN_TEST(a_sample_may_be_the_largest_number_and_no_larger);
    RUN_TEST(a_watched_run_ends_with_the_step_whose_sample_is_refused);
    RUN_TEST(a_recorded_run_ends_with_the_step_whose_sample_is_refused);
    RUN_TEST(an_encoder_of_any_number_of_counts_counts);
    RUN_TEST(a_sampled_step_whose_sample_is_beyond_the_range_is_refused);
    RUN_TEST(of_a_refused_step_its_own_reason_is_told);
    RUN_TEST(ground_that_gets_friction_shows_no_acceleration_before_its_first_step);
    RUN_TEST(the_deviates_are_those_of_an_independent_computation);
    RUN_TEST(some_deviates_are_the_same_to_the_last_bit);
    RUN_TEST(mean_variance_and_higher_moments_are_those_of_the_normal_distribution);
    RUN_TEST(tails_are_those_of_the_table);
    RUN_TEST(neighbours_in_seed_stream_index_and_pair_are_independent);
    return UNITY_END();
}
