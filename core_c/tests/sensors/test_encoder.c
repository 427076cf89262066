/* Tests of encoder.c: whole counts, their wrap and the index, and how far a wheel has turned. */
#include "methods.h"
#include "vehicles.h"

static const laconic_encoder_settings plain = {.counts_per_turn = 4096};

static laconic_encoder turned(const laconic_encoder_settings *settings, double rad) {
    laconic_encoder encoder = {0, 0};
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, settings, REAL(rad)));
    return encoder;
}

static void half_a_turn_gives_half_its_counts(void) {
    TEST_ASSERT_EQUAL_INT(2048, (int)turned(&plain, PI * 1.0001).count);
    TEST_ASSERT_EQUAL_INT(2047, (int)turned(&plain, PI * 0.9999).count);
    TEST_ASSERT_EQUAL_INT(-2049, (int)turned(&plain, -PI * 1.0001).count); /* rounded down, as an edge is passed */
}

static void a_gear_multiplies_and_a_negative_one_counts_backwards(void) {
    const laconic_encoder_settings behind = {.counts_per_turn = 16, .gear_ratio = REAL(-33.014)};
    TEST_ASSERT_EQUAL_INT(-529, (int)turned(&behind, 2 * PI).count); /* 16 · 33.014 = 528.2 */
    TEST_ASSERT_EQUAL_INT(528, (int)turned(&behind, -2 * PI).count);
}

/* A million steps of an irrational part of a count, and as many back. */
static void no_count_is_lost_however_small_the_steps(void) {
    const int32_t steps = 1000000;
    const laconic_real step = REAL(1e-4);
    laconic_encoder encoder = {0, 0};
    for (int32_t k = 0; k < steps; k++) laconic_encoder_turn(&encoder, &plain, step);
    const double counts = (double)step * steps * 4096 / (2 * PI);
    ASSERT_NEAR(EITHER(1e-6, 0.05), counts, (double)encoder.count + (double)encoder.rest);
    for (int32_t k = 0; k < steps; k++) laconic_encoder_turn(&encoder, &plain, -step);
    ASSERT_NEAR(EITHER(1e-9, 0.05), 0, (double)encoder.count + (double)encoder.rest);
}

/* At 10^15 counts a floating-point angle in single would be off by 10^8 of them. */
static void a_shaft_far_from_its_start_counts_as_well_as_near_it(void) {
    const laconic_encoder_settings one = {.counts_per_turn = 1};
    laconic_encoder far = {INT64_C(1000000000000000), REAL(0.25)};
    for (int k = 0; k < 4; k++) laconic_encoder_turn(&far, &one, REAL(0.5 * PI * 1.001));
    TEST_ASSERT_TRUE(far.count == INT64_C(1000000000000001));
}

static void the_share_of_a_count_stays_below_one(void) {
    laconic_encoder encoder = {0, 0};
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, &plain, REAL(-1e-25)));
    TEST_ASSERT_TRUE(encoder.count == 0 && encoder.rest == 0); /* −10^-22 rounds to the edge itself */
    encoder.rest = REAL(0.75);
    TEST_ASSERT_TRUE(laconic_encoder_turn(&encoder, &plain, REAL(2 * PI / 4096 * 1.75)));
    TEST_ASSERT_EQUAL_INT(2, (int)encoder.count);
    ASSERT_NEAR(4 * ROUNDING, 0.5, encoder.rest);
}

static void a_step_that_no_count_can_hold_is_refused(void) {
    const double too_far[] = {1e12, -1e12, (double)NAN, (double)INFINITY};
    for (int k = 0; k < 4; k++) {
        laconic_encoder encoder = {7, REAL(0.5)};
        TEST_ASSERT_FALSE(laconic_encoder_turn(&encoder, &plain, REAL(too_far[k])));
        TEST_ASSERT_TRUE(encoder.count == 7 && encoder.rest == REAL(0.5));
    }
}

/* Behind a gear of 2π each radian is a count. */
static void the_most_counts_that_every_scalar_type_can_hold_are_taken(void) {
    const laconic_encoder_settings one_a_rad = {.counts_per_turn = 1, .gear_ratio = REAL(2 * PI)};
    const double most = 2147483520.0; /* the largest number below 2^31 of single precision */
    TEST_ASSERT_TRUE(turned(&one_a_rad, most).count == INT64_C(2147483520));
    TEST_ASSERT_TRUE(turned(&one_a_rad, -most).count == -INT64_C(2147483520));
    laconic_encoder encoder = {0, 0};
    TEST_ASSERT_FALSE(laconic_encoder_turn(&encoder, &one_a_rad, REAL(2147483648.0)));
    TEST_ASSERT_FALSE(laconic_encoder_turn(&encoder, &one_a_rad, REAL(-2147483648.0)));
}

static void the_index_is_passed_once_a_turn_in_either_direction(void) {
    const int64_t count[] = {0, 9, 10, 11, 29, -1, -10, -11};
    const int32_t place[] = {0, 9, 0, 1, 9, 9, 0, 9};
    const int64_t turns[] = {0, 0, 1, 1, 2, -1, -1, -2};
    for (int k = 0; k < 8; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(place[k], laconic_encoder_place(&encoder, 10));
        TEST_ASSERT_EQUAL_INT((int)turns[k], (int)laconic_encoder_turns(&encoder, 10));
    }
}

static void it_shows_its_count_wrapped(void) {
    const int64_t count[] = {0, 65535, 65536, -1, -65537};
    const int32_t shown[] = {0, 65535, 0, 65535, 65535};
    for (int k = 0; k < 5; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(shown[k], laconic_encoder_shown(&encoder, 65536));
        TEST_ASSERT_EQUAL_INT(0, laconic_encoder_shown(&encoder, 1));
    }
}

static void without_a_wrap_it_shows_32_bits(void) {
    const int64_t count[] = {
        5, -5, INT64_C(2147483647), INT64_C(2147483648), INT64_C(-2147483649), INT64_C(4294967297)};
    const int32_t shown[] = {5, -5, 2147483647, -2147483647 - 1, 2147483647, 1};
    for (int k = 0; k < 6; k++) {
        const laconic_encoder encoder = {count[k], 0};
        TEST_ASSERT_EQUAL_INT(shown[k], laconic_encoder_shown(&encoder, 0));
    }
}

/* ------------------------------------------------------------------------------------ odometer -- */

static laconic_plant driven(laconic_vehicle v, double friction) {
    laconic_plant plant;
    laconic_refusal why;
    memset(&plant, 0, sizeof plant);
    v.ground.friction_coefficient = REAL(friction);
    const laconic_start start = start_with(3, -2, 5);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 100, &why));
    return plant;
}

/* The rests of the sums, too, are those of the place where it began. */
static void a_wheel_has_not_turned_since_now(void) {
    for (int k = 0; k < 2; k++) {
        const laconic_plant plant = driven(with_motors(three_wheels()), k * 0.5);
        laconic_odometer now;
        laconic_odometer_of(&now, &plant);
        for (int32_t i = 0; i < 3; i++) {
            TEST_ASSERT_TRUE(now.sum[i].rest != 0);
            TEST_ASSERT_TRUE(laconic_wheel_turned_rad(&plant, &now, i) == 0);
        }
    }
}

/* A turn too small for the value of a sum is in its rest. */
static void a_tiny_turn_counts_by_the_rest_of_its_sum(void) {
    const laconic_real tiny = LACONIC_EPSILON * LACONIC_EPSILON;
    for (int k = 0; k < 2; k++) {
        laconic_plant plant = driven(with_motors(three_wheels()), k * 0.5);
        laconic_sum *sums = k == 0 ? plant.state.travel : plant.slip.wheel_angle_rad;
        laconic_odometer before;
        for (int32_t i = 0; i < 3; i++) sums[i].rest = 0;
        laconic_odometer_of(&before, &plant);
        sums[1].rest = tiny;
        for (int32_t i = 0; i < 3; i++) {
            const laconic_real share = k == 0 ? plant.model.wheel_of_zeta[i][1] : (laconic_real)(i == 1);
            TEST_ASSERT_TRUE(laconic_wheel_turned_rad(&plant, &before, i) == share * tiny);
        }
    }
}

static void an_odometer_takes_as_many_sums_as_there_are(void) {
    for (int k = 0; k < 2; k++) {
        const laconic_plant plant = driven(with_motors(mecanum()), k * 0.5);
        const int32_t count = k == 0 ? 3 : 4; /* one a wheel where there is friction */
        laconic_odometer now, before;
        memset(&before, 7, sizeof before);
        now = before;
        laconic_odometer_of(&now, &plant);
        for (int32_t i = 0; i < LACONIC_TURNED_SUMS; i++)
            TEST_ASSERT_EQUAL_INT(i < count, memcmp(&before.sum[i], &now.sum[i], sizeof now.sum[i]) != 0);
    }
}

static void an_encoder_of_one_count_counts_the_turns(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_start start = start_with(0, 0, 100);
    const laconic_input input = no_input();
    laconic_sensor_settings settings = {0};
    laconic_plant plant;
    laconic_sensors sensors;
    laconic_refusal why;
    laconic_real angle[3];
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    settings.encoder[0].counts_per_turn = 1;
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_sensors_run(&sensors, &plant, &input, 1000, &why));
    laconic_plant_wheel_angles(&plant, angle);
    TEST_ASSERT_TRUE((double)angle[0] > 4 * PI);
    TEST_ASSERT_TRUE(sensors.encoder[0].count == (int64_t)floor((double)angle[0] / (2 * PI)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(half_a_turn_gives_half_its_counts);
    RUN_TEST(a_gear_multiplies_and_a_negative_one_counts_backwards);
    RUN_TEST(no_count_is_lost_however_small_the_steps);
    RUN_TEST(a_shaft_far_from_its_start_counts_as_well_as_near_it);
    RUN_TEST(the_share_of_a_count_stays_below_one);
    RUN_TEST(a_step_that_no_count_can_hold_is_refused);
    RUN_TEST(the_most_counts_that_every_scalar_type_can_hold_are_taken);
    RUN_TEST(the_index_is_passed_once_a_turn_in_either_direction);
    RUN_TEST(it_shows_its_count_wrapped);
    RUN_TEST(without_a_wrap_it_shows_32_bits);
    RUN_TEST(a_wheel_has_not_turned_since_now);
    RUN_TEST(a_tiny_turn_counts_by_the_rest_of_its_sum);
    RUN_TEST(an_odometer_takes_as_many_sums_as_there_are);
    RUN_TEST(an_encoder_of_one_count_counts_the_turns);
    return UNITY_END();
}
