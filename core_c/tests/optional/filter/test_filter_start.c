/* Tests of what a filter takes over at its start, and what not; test_filter.c sees it at work. */
#include "laconic/filter.h"
#include "vehicles.h"

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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(wheel_angles_are_not_taken_over);
    RUN_TEST(a_single_encoder_is_enough_to_read);
    RUN_TEST(a_deviation_whose_square_leaves_the_range_is_refused_at_the_start);
    RUN_TEST(numbers_before_and_behind_the_settings_are_not_read);
    RUN_TEST(what_lies_in_the_room_for_a_prediction_changes_none);
    return UNITY_END();
}
