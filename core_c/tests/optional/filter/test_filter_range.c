/* Tests of filter_readings.c at the ends of the range: corrections up to them are made, others change nothing. */
#include "factors.h"

#include "check.h"
#include "laconic/filter.h"
#include "vehicles.h"

#define CERTAIN REAL(1e-10) /* an error whose square is 0 beside 1 */

typedef struct reader {
    laconic_model model;
    laconic_filter filter;
} reader;

/* A gyro that shows component `seen` of the velocity alone, of which the variance is 1 as that of all errors. */
static reader reader_with(int seen, laconic_real encoder_std_rad) {
    laconic_filter_settings settings;
    reader r;
    memset(&settings, 0, sizeof settings);
    settings.yaw_rate_std_rad_per_s = CERTAIN;
    settings.encoder_std_rad[0] = encoder_std_rad;
    settings.bias_std_rad_per_s = REAL(1);
    r.model = model_of(mecanum());
    for (int k = 0; k < 3; k++) r.model.yaw_rate_of_zeta[k] = REAL(k == seen);
    const laconic_state state = moving(&r.model, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&r.filter, &r.model, &settings, &state));
    memset(&r.filter.covariance, 0, sizeof r.filter.covariance);
    for (int32_t i = 0; i < r.filter.errors; i++) r.filter.covariance.upper[i][i] = r.filter.covariance.diagonal[i] = 1;
    r.filter.covariance.diagonal[row_of_bias(&r.filter)] = 0;
    return r;
}

static reader reader_of(int seen) { return reader_with(seen, REAL(1)); }

static void assert_shown(laconic_status expected, reader *r, laconic_real yaw_rate_rad_per_s) {
    const laconic_filter before = r->filter;
    ASSERT_STATUS(expected, laconic_filter_yaw_rate(&r->filter, &r->model, yaw_rate_rad_per_s, NULL));
    if (expected != LACONIC_OK) TEST_ASSERT_EQUAL_MEMORY(&before, &r->filter, sizeof before);
}

static void a_velocity_is_corrected_up_to_the_largest_in_any_direction(void) {
    for (int k = 0; k < 3; k++) {
        reader r = reader_of(k);
        assert_shown(LACONIC_OVERFLOW, &r, LARGEST_SPEED * REAL(1.5));
        r.filter.state.zeta[k].value = LARGEST_SPEED;
        assert_shown(LACONIC_OK, &r, LARGEST_SPEED);
        TEST_ASSERT_TRUE(r.filter.state.zeta[k].value == LARGEST_SPEED);
    }
}

/* The estimate is below the largest speed, and so is what it lacks: their sum is not. */
static void a_correction_is_judged_by_where_it_leads(void) {
    for (int k = 0; k < 3; k++) {
        reader r = reader_of(k);
        r.filter.state.zeta[k].value = LARGEST_SPEED * REAL(0.75);
        assert_shown(LACONIC_OVERFLOW, &r, LARGEST_SPEED * REAL(1.25));
        assert_shown(LACONIC_OK, &r, LARGEST_SPEED * REAL(-0.5));
    }
}

/* The heading's error is that of the velocity times `by`. */
static reader with_heading_by(laconic_real by) {
    reader r = reader_of(2);
    r.filter.covariance.upper[row_of_heading(&r.filter)][r.filter.errors - 1] = by;
    return r;
}

/* The same without encoders, so that the filter keeps no errors of travels. */
static void without_encoders_a_velocity_is_corrected_up_to_the_largest_too(void) {
    for (int k = 0; k < 3; k++) {
        reader r = reader_with(k, 0);
        TEST_ASSERT_EQUAL_INT(0, r.filter.travels);
        assert_shown(LACONIC_OVERFLOW, &r, LARGEST_SPEED * REAL(1.5));
        assert_shown(LACONIC_OK, &r, LARGEST_SPEED * REAL(0.75));
    }
}

static void a_heading_is_corrected_by_less_than_can_be_counted(void) {
    reader r = with_heading_by(LARGEST_YAW_CHANGE_RAD);
    assert_shown(LACONIC_OVERFLOW, &r, 1);
    r = with_heading_by(LARGEST_YAW_CHANGE_RAD * (1 - LACONIC_EPSILON));
    assert_shown(LACONIC_OK, &r, 1);
}

static void an_infinite_correction_of_any_error_is_refused(void) {
    for (int32_t i = 0; i < 9; i++) {
        reader r = reader_of(2);
        r.filter.covariance.upper[i][9] = LACONIC_REAL_MAX / 4; /* the tenth error is that of the velocity shown */
        TEST_ASSERT_EQUAL_INT(10, r.filter.errors);
        assert_shown(LACONIC_OVERFLOW, &r, 8);
    }
}

/* A vehicle with as many wheels as there may be, each turned by its own angle; the arrays are no longer. */
static void encoders_of_the_most_wheels_are_read(void) {
    laconic_vehicle v = bare_body();
    laconic_real turned[LACONIC_MAX_WHEELS], angle[LACONIC_MAX_WHEELS];
    laconic_filter_settings settings;
    laconic_filter filter;
    laconic_innovation found;
    memset(&settings, 0, sizeof settings);
    settings.nu_std_rad_per_s[0] = settings.yaw_rate_std_rad_per_s = REAL(1);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1 * i, 0.1, PI / 4 * i, PI / 2);
        settings.encoder_std_rad[i] = REAL(0.01);
        turned[i] = REAL(0.001 * (i + 1));
    }
    const laconic_model m = model_of(v);
    const laconic_state state = moving(&m, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &state));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_encoders(&filter, &m, turned, &found));
    TEST_ASSERT_EQUAL_INT(LACONIC_MAX_WHEELS, found.count);
    laconic_wheel_angles(&m, &filter.state, angle);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) ASSERT_NEAR(ROUNDING, -0.001 * (i + 1), angle[i]);
}

/* An encoder of one count a turn is one; of what lies behind the wheels nothing is written. */
static void counts_are_those_of_the_wheels_alone(void) {
    const int32_t before[3] = {0, 0, 0}, now[3] = {3, 5, 7};
    laconic_sensor_settings sensors;
    laconic_real turned[3] = {REAL(9), REAL(9), REAL(9)};
    memset(&sensors, 0, sizeof sensors);
    for (int i = 0; i < 3; i++) sensors.encoder[i].counts_per_turn = 1;
    laconic_filter_turned(turned, &sensors, before, now, 2);
    ASSERT_NEAR(20 * ROUNDING, 6 * PI, turned[0]);
    ASSERT_NEAR(40 * ROUNDING, 10 * PI, turned[1]);
    TEST_ASSERT_EQUAL_DOUBLE(9, (double)turned[2]);
}

static void a_fix_is_its_seven_numbers(void) {
    reader r = reader_of(0);
    struct {
        laconic_real before;
        laconic_pose_fix fix;
        laconic_real behind;
    } at;
    memset(&at, 0, sizeof at);
    at.fix.std_m = at.fix.heading_std_rad = REAL(1);
    at.before = at.behind = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_filter_fix(&r.filter, &r.model, &at.fix, NULL));
    at.fix.place_y_m = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_filter_fix(&r.filter, &r.model, &at.fix, NULL));
}

/* The variances' sum is 3/4 of the largest number; then they are 1.69 times as large. */
static void the_noise_of_forces_counts_once_up_to_the_end_of_the_range(void) {
    const laconic_model m = model_of(mecanum());
    const laconic_state state = moving(&m, 0, 0, 0);
    laconic_filter_settings settings;
    laconic_filter filter;
    laconic_real sum = 0;
    memset(&settings, 0, sizeof settings);
    settings.yaw_rate_std_rad_per_s = settings.force_noise_N_per_sqrt_Hz = 1;
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &state));
    for (int k = 0; k < 3; k++) sum += filter.forcing_variance_s[k];
    settings.force_noise_N_per_sqrt_Hz = REAL(sqrt((double)(REAL(0.75) * LACONIC_REAL_MAX) / (double)sum));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &state));
    settings.force_noise_N_per_sqrt_Hz *= REAL(1.3);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &m, &settings, &state));
}

/* A fix that is so far off, along or across, that its square leaves the range, and what it corrects does not. */
static void a_fix_whose_innovation_is_no_number_is_refused(void) {
    for (int k = 0; k < 4; k++) {
        const laconic_real far = REAL(EITHER(1e170, 1e25)) * REAL(k < 2 ? 1 : -1);
        const laconic_pose_fix fix = {k % 2 == 0 ? far : 0, k % 2 == 1 ? far : 0, 0, 1, 0, 0, 0};
        reader r = reader_of(0);
        const laconic_filter before = r.filter;
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
        TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
    }
}

/* A point a metre ahead is seen far aside: a heading of which nothing is known would turn there by so many radians. */
static void a_yaw_beyond_what_can_be_counted_is_refused_in_either_direction(void) {
    for (int sign = -1; sign < 2; sign += 2) {
        reader r = reader_of(0);
        laconic_pose_fix fix = {0, LARGEST_YAW_CHANGE_RAD * REAL(4 * sign), 0, 1, 0, 1, 0};
        fix.place_x_m += r.model.com_x_m;
        fix.place_y_m += r.model.com_y_m;
        r.filter.covariance.diagonal[row_of_x(&r.filter)] = r.filter.covariance.diagonal[row_of_x(&r.filter) + 1] = 0;
        const laconic_filter before = r.filter;
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
        TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
    }
}

static void a_wheel_without_counts_has_not_turned(void) {
    const int32_t before[2] = {0, 0}, now[2] = {5, 5};
    laconic_real turned[2] = {7, 7};
    laconic_sensor_settings sensors;
    memset(&sensors, 0, sizeof sensors);
    sensors.encoder[1].counts_per_turn = -100;
    laconic_filter_turned(turned, &sensors, before, now, 2);
    TEST_ASSERT_TRUE(turned[0] == 0 && turned[1] == 0);
}

/* Tests of what a filter takes over at its start, and what not; test_filter.c sees it at work. */

/* Each travel alone turns some of these wheels. */
static laconic_vehicle most_wheels(void) {
    laconic_vehicle v = bare_body();
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1 * i - 0.2, 0.1, PI / 4 * i, PI / 2);
    return v;
}

/* Wheel angles are those since the start, whatever was set or travelled before. */
static void wheel_angles_are_not_taken_over(void) {
    const laconic_model m = model_of(most_wheels());
    laconic_filter_settings settings;
    memset(&settings, 0, sizeof settings);
    for (int with_encoders = 0; with_encoders < 2; with_encoders++) {
        laconic_state state = moving(&m, 0.3, -0.2, 0.5);
        laconic_real angle[LACONIC_MAX_WHEELS];
        laconic_filter filter;
        settings.encoder_std_rad[1] = REAL(with_encoders);
        for (int k = 0; k < 3; k++) state.travel[k].value = state.travel[k].rest = REAL(0.4 + k);
        for (int i = 0; i < LACONIC_MAX_WHEELS; i++) state.wheel_angle_set_rad[i] = REAL(0.1 * (i + 1));
        state.wheel_angle_set_rad[with_encoders] = NOT_A_NUMBER;
        ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &state));
        laconic_wheel_angles(&m, &filter.state, angle);
        for (int i = 0; i < LACONIC_MAX_WHEELS; i++) TEST_ASSERT_EQUAL_DOUBLE(0, (double)angle[i]);
        TEST_ASSERT_EQUAL_MEMORY(&state.zeta, &filter.state.zeta, offsetof(laconic_state, travel));
    }
}

static void numbers_before_and_behind_the_settings_are_not_read(void) {
    const laconic_model m = model_of(most_wheels());
    const laconic_state state = moving(&m, 0, 0, 0);
    laconic_filter filter;
    struct {
        laconic_real before;
        laconic_filter_settings settings;
        laconic_real behind;
    } of;
    memset(&of, 0, sizeof of);
    of.before = of.behind = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &of.settings, &state));
}

/* Whichever wheel it is, the first or the last. */
static void a_single_encoder_is_enough_to_read(void) {
    const laconic_model m = model_of(most_wheels());
    const laconic_state state = moving(&m, 0, 0, 0);
    const laconic_real turned[LACONIC_MAX_WHEELS] = {0};
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        laconic_filter_settings settings;
        laconic_filter filter;
        memset(&settings, 0, sizeof settings);
        settings.encoder_std_rad[i] = REAL(0.1);
        ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &state));
        ASSERT_STATUS(LACONIC_OK, laconic_filter_encoders(&filter, &m, turned, NULL));
    }
}

/* Nobody squares that of an encoder before its first reading. */
static void a_deviation_whose_square_leaves_the_range_is_refused_at_the_start(void) {
    const laconic_model m = model_of(most_wheels());
    const laconic_state state = moving(&m, 0, 0, 0);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        laconic_filter_settings settings;
        laconic_filter filter;
        memset(&settings, 0, sizeof settings);
        settings.encoder_std_rad[i] = REAL(EITHER(1e160, 1e25));
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &m, &settings, &state));
    }
}

/* As after a prediction that left the range. */
static void what_lies_in_the_room_for_a_prediction_changes_none(void) {
    const laconic_model m = model_of(most_wheels());
    const laconic_state state = moving(&m, 0.3, -0.2, 0.5);
    const laconic_input held = no_input();
    laconic_integrator integrator;
    laconic_filter_settings settings;
    laconic_filter clean, spoilt;
    memset(&settings, 0, sizeof settings);
    settings.force_noise_N_per_sqrt_Hz = settings.slip_noise_m_per_s_per_sqrt_Hz = REAL(0.1);
    settings.bias_noise_rad_per_s2_per_sqrt_Hz = settings.encoder_std_rad[0] = settings.heading_std_rad = REAL(0.2);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&integrator, &laconic_rk4, &m, REAL(0.01), NULL));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&clean, &m, &settings, &state));
    spoilt = clean;
    memset(&spoilt.room, 0xFF, sizeof spoilt.room); /* NaN in every number */
    ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&clean, &m, &integrator, &held));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&spoilt, &m, &integrator, &held));
    for (int32_t j = 0; j < clean.errors; j++) {
        TEST_ASSERT_TRUE(clean.covariance.diagonal[j] == spoilt.covariance.diagonal[j]);
        for (int32_t i = 0; i < j; i++) TEST_ASSERT_TRUE(clean.covariance.upper[i][j] == spoilt.covariance.upper[i][j]);
    }
}

/* White noise of density s (one-sided, N/√Hz) on a mass m: after T the variance of its velocity is s² T/(2 m²). */
static void the_noise_of_a_force_spreads_the_velocity_with_the_root_of_the_time(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_state at_rest = state_of(&m, start_with(0, 0, 0));
    const laconic_input none_acts = no_input();
    laconic_filter_settings settings;
    laconic_integrator integrator;
    laconic_filter filter;
    laconic_real p[LACONIC_FILTER_OUTPUTS * LACONIC_FILTER_OUTPUTS];
    memset(&settings, 0, sizeof settings);
    settings.force_noise_N_per_sqrt_Hz = REAL(0.3);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&integrator, &laconic_auto, &m, REAL(0.01), NULL));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &m, &settings, &at_rest));
    for (int k = 0; k < 50; k++)
        ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&filter, &m, &integrator, &none_acts));
    laconic_filter_covariance(p, &filter, &m);
    const double of_velocity = 0.3 * 0.3 * 0.5 / (2 * MASS * MASS);
    ASSERT_NEAR(EITHER(1e-12, 1e-5) * of_velocity, of_velocity, (double)p[0] * RADIUS * RADIUS);
}

/* Tests of factors.c: the factors of a matrix, and what counts as finite. */

#define ROWS 5
#define MANY 8

/* Whole numbers from −8 to 8, the same in both types. */
static laconic_real whole_number(uint32_t *seed) {
    *seed = *seed * 1664525U + 1013904223U;
    return (laconic_real)(int32_t)(*seed >> 16) / 4096 - 8;
}

static double product_of(const laconic_factors *f, int32_t i, int32_t j) {
    double sum = 0;
    for (int32_t k = 0; k < ROWS; k++) sum += (double)f->upper[i][k] * (double)f->diagonal[k] * (double)f->upper[j][k];
    return sum;
}

/* U D Uᵀ is W diag(d) Wᵀ, and U is upper triangular with ones on its diagonal, whatever stood there before. */
static void factors_are_those_of_the_weighted_rows(void) {
    laconic_real row[LACONIC_FILTER_ERRORS][COLUMNS], weight[COLUMNS];
    double expected[ROWS][ROWS];
    laconic_factors found;
    uint32_t seed = 7;
    memset(&found, 7, sizeof found);
    memset(row, 0, sizeof row);
    for (int32_t c = 0; c < MANY; c++) weight[c] = REAL(c % 3 + 1);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t c = 0; c < MANY; c++) row[i][c] = whole_number(&seed);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t j = 0; j < ROWS; j++) {
            expected[i][j] = 0;
            for (int32_t c = 0; c < MANY; c++)
                expected[i][j] += (double)row[i][c] * (double)weight[c] * (double)row[j][c];
        }
    laconic_factors_of(&found, row, weight, ROWS, MANY);
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t j = 0; j < ROWS; j++) {
            ASSERT_NEAR(EITHER(1e-12, 1e-3), expected[i][j], product_of(&found, i, j));
            if (j <= i) TEST_ASSERT_TRUE(found.upper[i][j] == (i == j ? REAL(1) : 0));
        }
    for (int32_t i = 0; i < ROWS; i++) TEST_ASSERT_TRUE(found.diagonal[i] > 0);
}

/* The last row is 0, and so is the second where it counts: neither has a part of those above it. */
static void a_row_of_which_nothing_is_left_has_no_part_of_others(void) {
    laconic_real row[LACONIC_FILTER_ERRORS][COLUMNS];
    const laconic_real weight[COLUMNS] = {REAL(2), 0, REAL(3)};
    laconic_factors found;
    memset(row, 0, sizeof row);
    memset(&found, 7, sizeof found);
    row[0][0] = row[0][1] = row[1][1] = row[2][2] = REAL(1);
    laconic_factors_of(&found, row, weight, 4, 3);
    for (int32_t i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(i == 0 ? 2 : i == 2 ? 3 : 0, (double)found.diagonal[i]);
        for (int32_t j = 0; j < 4; j++) TEST_ASSERT_EQUAL_DOUBLE(i == j, (double)found.upper[i][j]);
    }
}

static void a_covariance_is_finite_if_all_its_numbers_are(void) {
    laconic_factors factors;
    memset(&factors, 0, sizeof factors);
    for (int32_t rows = 1; rows <= LACONIC_FILTER_ERRORS; rows++)
        for (int32_t row = 0; row < LACONIC_FILTER_ERRORS; row++)
            for (int32_t column = row; column < LACONIC_FILTER_ERRORS; column++) {
                laconic_factors wrong = factors;
                *(row == column ? &wrong.diagonal[row] : &wrong.upper[row][column]) = INFINITE;
                TEST_ASSERT_TRUE(laconic_factors_finite(&wrong, rows) == (column >= rows));
            }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_noise_of_a_force_spreads_the_velocity_with_the_root_of_the_time);
    RUN_TEST(a_velocity_is_corrected_up_to_the_largest_in_any_direction);
    RUN_TEST(a_correction_is_judged_by_where_it_leads);
    RUN_TEST(without_encoders_a_velocity_is_corrected_up_to_the_largest_too);
    RUN_TEST(a_heading_is_corrected_by_less_than_can_be_counted);
    RUN_TEST(an_infinite_correction_of_any_error_is_refused);
    RUN_TEST(encoders_of_the_most_wheels_are_read);
    RUN_TEST(counts_are_those_of_the_wheels_alone);
    RUN_TEST(a_fix_is_its_seven_numbers);
    RUN_TEST(the_noise_of_forces_counts_once_up_to_the_end_of_the_range);
    RUN_TEST(a_fix_whose_innovation_is_no_number_is_refused);
    RUN_TEST(a_yaw_beyond_what_can_be_counted_is_refused_in_either_direction);
    RUN_TEST(a_wheel_without_counts_has_not_turned);
    RUN_TEST(wheel_angles_are_not_taken_over);
    RUN_TEST(a_single_encoder_is_enough_to_read);
    RUN_TEST(a_deviation_whose_square_leaves_the_range_is_refused_at_the_start);
    RUN_TEST(numbers_before_and_behind_the_settings_are_not_read);
    RUN_TEST(what_lies_in_the_room_for_a_prediction_changes_none);
    RUN_TEST(factors_are_those_of_the_weighted_rows);
    RUN_TEST(a_row_of_which_nothing_is_left_has_no_part_of_others);
    RUN_TEST(a_covariance_is_finite_if_all_its_numbers_are);
    return UNITY_END();
}
