/* Tests that error estimates are, bit for bit, those of the version before: by every method and window, with friction,
 * in panels, over changes of step and vehicle, and as rows along a schedule. test_estimate.c compares them with the
 * true errors. */
#include "bits.h"
#include "laconic/estimate.h"
#include "laconic/filter.h"
#include "stack.h"

static void take_errors(const laconic_estimate *estimate, const laconic_plant *plant) {
    laconic_errors errors;
    memset(&errors, 0, sizeof errors);
    laconic_estimate_read(&errors, estimate, plant);
    const laconic_real unknown = REAL(errors.unknown);
    TAKE(errors.now);
    TAKE(errors.largest);
    TAKE(errors.rounding);
    TAKE(unknown);
}

/* Held for some steps, sampled, changed to another step and another vehicle. */
static void take_estimate_from(laconic_start start, laconic_vehicle vehicle, const laconic_method *method,
                               double step_s, int32_t most_steps) {
    laconic_plant plant, before;
    laconic_estimate estimate;
    memset(&estimate, 0, sizeof estimate);
    if (laconic_plant_start(&plant, &vehicle, method, REAL(step_s), &start, &why) != LACONIC_OK) return;
    ASSERT_STATUS(LACONIC_OK,
                  laconic_estimate_start(&estimate, &plant, most_steps, laconic_finer_method(&plant), &why));
    for (int k = 0; k < 8; k++) {
        const laconic_input samples[3] = {input_at(11 * k), input_at(11 * k + 5), input_at(11 * k + 9)};
        laconic_estimate_run(&estimate, &plant, samples, k < 3 ? 1 : 21, &why);
        take_errors(&estimate, &plant);
        if (k % 2 == 1) laconic_estimate_run_sampled(&estimate, &plant, samples, &why);
        take_errors(&estimate, &plant);
        if (k != 3 && k != 5) continue;
        before = plant;
        vehicle.payload.mass_kg += REAL(1.5);
        if (k == 3) ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.7 * step_s), &why));
        if (k == 5) ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &vehicle, &why));
        ASSERT_STATUS(LACONIC_OK,
                      laconic_estimate_carry(&estimate, &before, &plant, laconic_finer_method(&plant), &why));
        take_errors(&estimate, &plant);
    }
}

static void take_estimate(laconic_vehicle vehicle, const laconic_method *method, double step_s, int32_t most_steps) {
    const laconic_start start = {{0}, REAL(0.3), REAL(-0.2), REAL(0.7), {0}};
    take_estimate_from(start, vehicle, method, step_s, most_steps);
}

static void take_estimates(const laconic_method *method) {
    static const int32_t window[4] = {1, 16, 5, 200};
    static const double step_s[3] = {0.003, 0.02, 0.08};
    for (int number = 0; number < MORE_VEHICLES; number++)
        take_estimate(vehicle_number(number), method, step_s[number % 3], window[number % 4]);
    take_estimate(vehicle_number(3), method, 0.3, 16);
}

static void estimates_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x4c01a6001bc625bbU, 0x8dbfb47e9073c7caU), EITHER(0xbc8529ad0e2bf40eU, 0xacfecd6e67ce4f66U),
        EITHER(0xf65f04153f3266aaU, 0x419369543da98ed7U), EITHER(0xfe9f92e5e0377111U, 0x7a3c548a5cd09104U),
        EITHER(0x607ad9ed59da434cU, 0x6194f352c1ea44f3U), EITHER(0xb598a72436c08115U, 0x97ab45ba982fffcdU),
        EITHER(0x16450fecdc6f19e4U, 0x071584e17f6663ceU), EITHER(0x4c01a6001bc625bbU, 0x8dbfb47e9073c7caU),
    };
    expect_by_method(take_estimates, bits);
}

/* One input over hundreds of steps, so that windows grow long, read amid them. */
static void take_long_estimate(laconic_vehicle vehicle, double step_s, int32_t most_steps) {
    const laconic_start start = start_with(0, 0, 0);
    const laconic_input input = input_at(3);
    laconic_plant plant;
    laconic_estimate estimate;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_exact_flow_4, REAL(step_s), &start, &why));
    ASSERT_STATUS(LACONIC_OK,
                  laconic_estimate_start(&estimate, &plant, most_steps, laconic_finer_method(&plant), &why));
    for (int k = 0; k < 40; k++) {
        laconic_estimate_run(&estimate, &plant, &input, 13, &why);
        take_errors(&estimate, &plant);
    }
}

static void estimates_in_long_windows(void) {
    begin();
    for (int number = 0; number < MORE_VEHICLES; number++) {
        take_long_estimate(vehicle_number(number), 0.0005, 200);
        take_long_estimate(vehicle_number(number), 0.005, 32);
    }
    expect(EITHER(0x99182d1a05fd8eb4U, 0x41fd48b535b629efU));
}

static void estimates_of_wheels_that_slip_from_the_start(void) {
    laconic_start start = start_with(12, -7, 5);
    start.wheel_speed_rad_per_s[0] = -20;
    begin();
    for (int number = 0; number < MORE_SLIPPING; number++) {
        if (number == 3) continue; /* wheels that hold cannot slip */
        const laconic_vehicle vehicle = number < SLIPPING ? slipping_vehicle(number) : more_slipping_vehicle(number);
        take_estimate_from(start, vehicle, &laconic_auto, 0.004, 4);
    }
    expect(EITHER(0x54ac6b3f2564dfd3U, 0x421f07520b9584deU));
}

static void estimates_with_friction(void) {
    begin();
    for (int number = 0; number < 3; number++) {
        take_estimate(slipping_vehicle(number), &laconic_auto, 0.004, 16);
        take_estimate(slipping_vehicle(number), &laconic_auto, 0.03, 1);
    }
    expect(EITHER(0x0ac28a6244ea452cU, 0x91f8f323f539414dU));
}

/* Rows along held and sampled schedules, with and without a recorder. */
static void rows_of_errors(void) {
    static const uint32_t signals[] = {offsetof(laconic_input, voltage_V), offsetof(laconic_input, body_moment_Nm)};
    static const uint32_t columns[] = {offsetof(laconic_outputs, energy_J), offsetof(laconic_outputs, pose.x_m)};
    static const uint64_t until[3] = {10, 17, 40};
    laconic_real value[2 * 3 * 40];
    for (int i = 0; i < 2 * 3 * 40; i++) value[i] = REAL(0.1 * (i % 7) - 0.05 * (i % 11));
    begin();
    for (int number = 0; number < 8; number++) {
        const laconic_vehicle vehicle = number % 4 == 3 ? slipping_vehicle(0) : vehicle_number(number);
        const laconic_start start = start_with(0, 0, 0);
        laconic_schedule schedule = {2, signals, value, number < 4 ? until : NULL, number < 4 ? 3 : 40, 0};
        laconic_error row[20];
        laconic_real cell[40];
        laconic_recorder recorder;
        laconic_error_rows rows = {3, row, 0, number == 2 ? 5 : 20};
        laconic_plant plant;
        laconic_estimate estimate;
        memset(row, 0, sizeof row);
        memset(cell, 0, sizeof cell);
        memset(&recorder, 0, sizeof recorder);
        recorder.every = 4;
        recorder.column_count = 2;
        recorder.column = columns;
        recorder.row = cell;
        recorder.row_room = number == 6 ? 3 : 20;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 16, laconic_finer_method(&plant), &why));
        ASSERT_STATUS(LACONIC_OK,
                      laconic_estimate_follow(&estimate, &plant, &schedule, 40, number < 2 ? NULL : &recorder,
                                              number % 2 == 1 && number != 7 ? NULL : &rows, &why));
        const laconic_real counts[3] = {REAL(plant.steps), REAL(rows.row_count), REAL(recorder.row_count)};
        TAKE(row);
        TAKE(cell);
        TAKE(counts);
        take_errors(&estimate, &plant);
    }
    expect(EITHER(0x1b9a88856488a65eU, 0x0915313f1eb5575aU));
}

/* Tests that the filter's estimate, its covariance and its innovations are, bit for bit, those of the version before,
 * with every instrument, by every method, with a bias and without. test_filter.c and host_tests/tests/control compare
 * them with the plain formulas and with a dense filter. */

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
    RUN_TEST(estimates_by_every_method);
    RUN_TEST(estimates_with_friction);
    RUN_TEST(estimates_of_wheels_that_slip_from_the_start);
    RUN_TEST(rows_of_errors);
    RUN_TEST(estimates_in_long_windows);
    RUN_TEST(filters_by_every_method);
    RUN_TEST(angles_of_counts);
    return UNITY_END();
}
