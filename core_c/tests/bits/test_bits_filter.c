/* Tests that the filter's estimate, its covariance and its innovations are, bit for bit, those of the version before,
 * with every instrument, by every method, with a bias and without. test_filter.c and host_tests/tests/control compare
 * them with the plain formulas and with a dense filter. */
#include "bits.h"
#include "laconic/filter.h"
#include "stack.h"

static laconic_filter_settings settings_number(int number) {
    laconic_filter_settings s;
    memset(&s, 0, sizeof s);
    if (number != 3) s.voltage_noise_V_per_sqrt_Hz = REAL(0.2);
    s.force_noise_N_per_sqrt_Hz = REAL(number == 1 ? 0 : 0.05);
    s.moment_noise_Nm_per_sqrt_Hz = REAL(number == 2 ? 0 : 0.01);
    s.slip_noise_m_per_s_per_sqrt_Hz = REAL(number == 1 ? 0 : 0.001);
    s.yaw_slip_noise_rad_per_s_per_sqrt_Hz = REAL(number == 2 ? 0 : 0.003);
    s.bias_noise_rad_per_s2_per_sqrt_Hz = REAL(number == 0 ? 1e-4 : 0);
    for (int k = 0; k < 3; k++) s.nu_std_rad_per_s[k] = REAL(0.3 - 0.1 * k);
    s.position_std_m = REAL(0.1);
    s.heading_std_rad = REAL(0.2);
    s.bias_std_rad_per_s = REAL(number == 3 ? 0 : 0.04);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) s.encoder_std_rad[i] = REAL(i == number ? 0 : 0.002 + 0.001 * i);
    s.yaw_rate_std_rad_per_s = REAL(0.015);
    return s;
}

static void take_filter(const laconic_filter *filter, const laconic_model *model, const laconic_innovation *found) {
    laconic_real covariance[LACONIC_FILTER_OUTPUTS * LACONIC_FILTER_OUTPUTS];
    const laconic_real counts[3] = {REAL(found->count), found->square, filter->bias_rad_per_s};
    laconic_filter_covariance(covariance, filter, model);
    TAKE(covariance);
    TAKE(counts);
    TAKE(filter->state.zeta);
    TAKE(filter->state.x_m);
    TAKE(filter->state.y_m);
    TAKE(filter->state.travel);
    const laconic_real heading = REAL(filter->state.heading.fraction);
    TAKE(heading);
}

static void take_readings(laconic_filter *filter, const laconic_model *model, int step) {
    laconic_real turned[LACONIC_MAX_WHEELS];
    laconic_innovation found = {0, 0};
    laconic_pose_fix fix = {REAL(0.1), REAL(-0.2), REAL(0.4 + 6.283 * step), REAL(0.05), REAL(0.1), 0, 0};
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) turned[i] = REAL(0.01 * i - 0.02);
    fill_stack(ALL_NAN);
    const laconic_real status = REAL(laconic_filter_encoders(filter, model, turned, &found)); /* some have none */
    TAKE(status);
    take_filter(filter, model, &found);
    fill_stack(ALL_NAN);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_yaw_rate(filter, model, REAL(0.3), &found));
    take_filter(filter, model, &found);
    if (step % 2 == 1) fix.place_x_m = REAL(0.3), fix.place_y_m = REAL(-0.1);
    if (step == 4) fix.heading_std_rad = 0;
    if (step == 6) fix.std_m = 0;
    fill_stack(ALL_NAN);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_fix(filter, model, &fix, &found));
    take_filter(filter, model, &found);
}

static void take_filters(const laconic_method *method) {
    static const double step_s[4] = {0.003, 0.01, 0.02, 0.1};
    for (int number = 0; number < MORE_VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        const laconic_filter_settings settings = settings_number(number % 4);
        const laconic_start start = {{0}, REAL(0.3), REAL(-0.2), REAL(0.7), {0}};
        laconic_plant plant;
        laconic_filter filter;
        memset(&filter, 0, sizeof filter);
        if (laconic_plant_start(&plant, &vehicle, method, REAL(step_s[number % 4]), &start, &why) != LACONIC_OK)
            continue;
        fill_stack(ALL_NAN);
        ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &plant.model, &settings, &plant.state));
        for (int step = 0; step < 8; step++) {
            laconic_input held = input_at(step);
            if (number % 2 == 1) held.world_force_N[0] = held.world_force_N[1] = 0;
            fill_stack(ALL_NAN);
            ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&filter, &plant.model, &plant.integrator, &held));
            if (step % 2 == 0) take_readings(&filter, &plant.model, step);
        }
    }
}

static void filters_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x00b58a44eadd2bdaU, 0x7bc0949d72661447U), EITHER(0xec8b8a24987310b1U, 0xf7dc38d4d832a991U),
        EITHER(0x319e1e0a3881a74cU, 0xe495131aee37065eU), EITHER(0xa7446456452fd10bU, 0x81cb1b7ee486d046U),
        EITHER(0x07ac3b34e3c45e9cU, 0xa089b9e9ec86d897U), EITHER(0x690aba2431bfe2d5U, 0x05c8453be3167db0U),
        EITHER(0x7eb41f07559ddec5U, 0xf634bd2533885e45U), EITHER(0x00b58a44eadd2bdaU, 0x7bc0949d72661447U),
    };
    expect_by_method(take_filters, bits);
}

static void angles_of_counts(void) {
    laconic_sensor_settings sensors;
    memset(&sensors, 0, sizeof sensors);
    begin();
    for (int wrap = 0; wrap < 4; wrap++) {
        const int32_t before[4] = {5, 990, -3, 2147483647}, now[4] = {995, 4, 70000, -2147483647};
        laconic_real turned[4] = {0, 0, 0, 0};
        sensors.encoder_wrap = wrap == 3 ? 70001 : 1000 * wrap;
        for (int i = 0; i < 4; i++) sensors.encoder[i] = (laconic_encoder_settings){100 * i, REAL(1.5 - i)};
        laconic_filter_turned(turned, &sensors, before, now, 4);
        TAKE(turned);
    }
    expect(EITHER(0x7bf959c4ff5d22aaU, 0x0928b8864d9c15d1U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(filters_by_every_method);
    RUN_TEST(angles_of_counts);
    return UNITY_END();
}
