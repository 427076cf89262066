/* Tests that error estimates are, bit for bit, those of the version before: by every method and window, with friction,
 * in panels, over changes of step and vehicle, and as rows along a schedule. test_estimate.c compares them with the
 * true errors. */
#include "bits.h"
#include "laconic/estimate.h"

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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(estimates_by_every_method);
    RUN_TEST(estimates_with_friction);
    RUN_TEST(estimates_of_wheels_that_slip_from_the_start);
    RUN_TEST(rows_of_errors);
    RUN_TEST(estimates_in_long_windows);
    return UNITY_END();
}
