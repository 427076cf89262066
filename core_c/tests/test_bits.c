/* Tests that every number of the core is, bit for bit, that of the version before: motions by every method, with
 * friction and without, what sensors show, constants and derivatives. A recording then replays in a later version as it
 * was made. Other tests compare the numbers with independent ones; a change of bits on purpose is one of these and goes
 * with a line of the changelog. The vehicles are written in numbers alone, since a sine of the host's library may
 * differ. */
#include <inttypes.h>
#include <stdio.h>

#include "vehicles.h"

#define QUARTER_TURN 1.57079632679489661923

static laconic_refusal why;
static uint64_t hash; /* FNV-1a of the numbers */

static void take(const laconic_real *number, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const laconic_real shown = number[i] == number[i] ? number[i] : 0; /* a NaN has many bits */
        uint8_t bytes[sizeof shown];
        memcpy(bytes, &shown, sizeof shown);
        for (size_t k = 0; k < sizeof bytes; k++) hash = (hash ^ bytes[k]) * 1099511628211U;
    }
}

#define TAKE(numbers) take((const laconic_real *)&(numbers), sizeof(numbers) / sizeof(laconic_real))

static void begin(void) { hash = 1469598103934665603U; }

static void expect(uint64_t bits) {
    char found[64];
    snprintf(found, sizeof found, "these bits are new: 0x%016" PRIx64, hash);
    TEST_ASSERT_TRUE_MESSAGE(hash == bits, found);
}

/* ------------------------------------------------------------------------------------- vehicles -- */

#define VEHICLES 6

/* Omni, mecanum with own wheels, two fixed wheels with a payload, fast damping, a braked wheel, and a puck. */
static laconic_vehicle vehicle_number(int number) {
    laconic_vehicle v = number == 2 ? differential_drive() : number == 5 ? bare_body() : three_wheels();
    if (number == 1) {
        v = bare_body();
        for (int i = 0; i < 4; i++)
            add_wheel(&v, LACONIC_WHEEL_ROLLER, i < 2 ? 0.2 : -0.2, i % 2 == 0 ? 0.15 : -0.15, -QUARTER_TURN,
                      i == 0 || i == 3 ? 0.8 : -0.75);
    }
    if (number < 5) v = with_motors(v);
    if (number == 1) v = with_own_wheels(v);
    if (number == 2) v.payload = (laconic_payload){.mass_kg = 3, .x_m = REAL(0.02), .y_m = REAL(-0.05)};
    if (number == 2) v.payload.yaw_inertia_kgm2 = REAL(0.01);
    if (number == 3) v.motor_damping_Nms = REAL(1.7);
    if (number == 4) v.wheel[1].locked = true;
    v.com_x_m = REAL(0.013);
    v.com_z_m = REAL(0.09);
    v.friction_coefficient = REAL(0.6);
    v.support_count = 1;
    v.support[0].x_m = REAL(-0.2);
    v.support[0].y_m = REAL(0.03);
    return v;
}

/* Three omni wheels on ground with friction and a slope; four fixed wheels that skid; wheels of every kind, each with
 * its own ground and motor circuit. */
static laconic_vehicle slipping_vehicle(int number) {
    static const double bearing[3][3] = {{0.065, 0.11258330249197702, 1.0471975511965976},
                                         {-0.13, 0, 3.14159265358979323846},
                                         {0.065, -0.11258330249197702, 5.2359877559829882}};
    laconic_vehicle v = bare_body();
    v.mass_kg = 20;
    v.com_z_m = REAL(0.1);
    v.wheel_inertia_kgm2 = REAL(0.003);
    for (int i = 0; number != 1 && i < 3; i++)
        add_wheel(&v, number == 2 && i == 1 ? LACONIC_WHEEL_FIXED : LACONIC_WHEEL_ROLLER, bearing[i][0], bearing[i][1],
                  bearing[i][2], number == 2 ? 1.2 : QUARTER_TURN);
    for (int i = 0; number == 1 && i < 4; i++)
        add_wheel(&v, LACONIC_WHEEL_FIXED, i < 2 ? 0.15 : -0.15, i % 2 == 0 ? 0.2 : -0.2, -QUARTER_TURN, 0);
    v.ground.friction_coefficient = REAL(number == 1 ? 0.8 : 0.3);
    v.ground.roller_drag = REAL(number == 0 ? 0.2 : 0);
    v.ground.axle_friction_Nm = REAL(0.02);
    v.ground.slope_rad = REAL(number == 0 ? 0.05 : 0);
    v.ground.slope_heading_rad = REAL(0.7);
    v.motor_gain_Nm_per_V = REAL(0.5);
    v.motor_damping_Nms = REAL(0.26);
    v.drive.winding_resistance_ohm = 2;
    v.drive.viscous_friction_Nms = REAL(0.01);
    if (number != 1) v.drive.supply_V = 12;
    if (number == 0) v.drive.supply_resistance_ohm = REAL(0.3);
    if (number == 1) v.drive.current_limit_A = 3;
    if (number == 2) {
        v.wheel[0].motor_circuit = LACONIC_MOTOR_SHORTED;
        v.wheel[2].motor_circuit = LACONIC_MOTOR_OPEN;
        v.wheel[0].own_friction_coefficient = REAL(0.45);
        v.wheel[2].own_roller_drag = REAL(0.6);
        v.wheel[0].own_axle_friction_Nm = REAL(0.05);
        v.support_count = 1;
        v.support[0].x_m = REAL(0.1);
    }
    return v;
}

/* What acts in one step of a run. */
static laconic_input input_at(int step) {
    laconic_input input = every_input();
    const laconic_real sign = step / 20 % 2 == 0 ? 1 : -1;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) input.voltage_V[i] *= 8 * sign;
    input.world_force_N[0] *= sign;
    input.body_moment_Nm += REAL(0.01) * REAL(step % 7);
    return input;
}

static void take_all(const laconic_plant *plant, const laconic_contact *contact, const laconic_sensors *sensors,
                     const laconic_input *input) {
    laconic_outputs out;
    memset(&out, 0, sizeof out);
    laconic_outputs_of(&out, plant, input);
    laconic_plant_reactions(&out.reactions, plant, contact, input);
    if (sensors != NULL) laconic_sensors_read(&out.sensors, sensors, plant, input);
    TAKE(out);
}

/* A run with held inputs and, in between, sampled ones. */
static void take_run(const laconic_vehicle *vehicle, const laconic_method *method, double step_s, int steps) {
    laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    laconic_contact contact;
    start.heading_rad = REAL(0.4);
    start.y_m = REAL(-0.3);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, vehicle, method, REAL(step_s), &start, &why));
    const bool slips = laconic_vehicle_has_friction(vehicle);
    if (!slips) ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, vehicle, &why));
    for (int step = 0; step < steps; step++) {
        const laconic_input samples[3] = {input_at(step), input_at(step + 3), input_at(step + 5)};
        const laconic_status status = step % 4 == 3 ? laconic_plant_run_sampled(&plant, samples, &why)
                                                    : laconic_plant_run(&plant, samples, 1, &why);
        if (status != LACONIC_OK) { /* of a method that cannot take it: as it says so, too */
            TAKE(why.value);
            TAKE(why.limit);
        }
        if (step % 5 == 0) take_all(&plant, slips ? NULL : &contact, NULL, samples);
    }
}

static void motions_by_every_method(void) {
    begin();
    for (int32_t method = 0; method < LACONIC_METHOD_COUNT; method++)
        for (int number = 0; number < VEHICLES; number++) {
            const laconic_vehicle vehicle = vehicle_number(number);
            take_run(&vehicle, laconic_method_by_number(method), 0.004, 60);
            take_run(&vehicle, laconic_method_by_number(method), 0.02, 10);
        }
    expect(EITHER(0xce5c8950d524321aU, 0xc0d3d248a3a1ca5aU));
}

static void motions_with_friction(void) {
    begin();
    for (int number = 0; number < 3; number++) {
        const laconic_vehicle vehicle = slipping_vehicle(number);
        take_run(&vehicle, &laconic_auto, 0.004, 100);
        take_run(&vehicle, &laconic_auto, 0.05, 20);
    }
    expect(EITHER(0xca45fce8a1b553baU, 0x74323d94cc13fc4eU));
}

static void the_smooth_law_of_friction(void) {
    begin();
    for (int number = 0; number < 3; number++) {
        const laconic_vehicle vehicle = slipping_vehicle(number);
        const laconic_start start = start_with(0.8, -0.5, 1.4);
        laconic_plant plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
        for (int k = 0; k < 10; k++) {
            laconic_rates rates;
            laconic_real nu[3], wheel_rate[LACONIC_MAX_WHEELS] = {0};
            const laconic_input input = input_at(7 * k);
            memset(&rates, 0, sizeof rates);
            laconic_nu(&plant.model, &plant.state, nu);
            laconic_friction_derivative(&rates, wheel_rate, &plant.friction, &plant.model, nu, REAL(0.3 * k),
                                        plant.slip.wheel_speed_rad_per_s, &input);
            TAKE(rates);
            TAKE(wheel_rate);
            laconic_slip_smooth(&plant.slip, &plant.friction, &plant.state, &input);
            take_all(&plant, NULL, NULL, &input);
            for (int i = 0; i < vehicle.wheel_count; i++)
                plant.slip.wheel_speed_rad_per_s[i] += REAL(0.02) * wheel_rate[i];
        }
    }
    expect(EITHER(0xd9859e09f83feb04U, 0x859cf3c579b6ff80U));
}

static laconic_sensor_settings every_sensor(void) {
    laconic_sensor_settings s;
    memset(&s, 0, sizeof s);
    s.imu.x_m = REAL(0.07);
    s.imu.y_m = REAL(-0.03);
    s.imu.heading_rad = REAL(0.4);
    s.imu.acceleration_scale_error[0] = REAL(0.01);
    s.imu.acceleration_scale_error[1] = REAL(-0.02);
    s.imu.acceleration_bias_m_per_s2[0] = REAL(0.1);
    s.imu.acceleration_bias_m_per_s2[1] = REAL(0.05);
    s.imu.acceleration_noise_m_per_s2_per_sqrt_Hz = REAL(0.003);
    s.imu.acceleration_range_m_per_s2 = 20;
    s.imu.yaw_rate_scale_error = REAL(0.003);
    s.imu.yaw_rate_bias_rad_per_s = REAL(-0.01);
    s.imu.yaw_rate_noise_rad_per_s_per_sqrt_Hz = REAL(0.0002);
    s.imu.yaw_rate_range_rad_per_s = 8;
    s.imu.delay_steps = 2;
    s.imu.seed = 77;
    s.encoder_wrap = 5000;
    s.encoder[0] = (laconic_encoder_settings){4096, 20};
    s.encoder[1] = (laconic_encoder_settings){500, REAL(-3.5)};
    return s;
}

static void what_sensors_show(void) {
    begin();
    for (int number = 0; number < 5; number++) {
        const laconic_vehicle vehicle = number < 2 ? vehicle_number(number) : slipping_vehicle(number - 2);
        const laconic_sensor_settings settings = every_sensor();
        const laconic_start start = start_with(0.5, 0.2, -0.3);
        laconic_plant plant;
        laconic_sensors sensors;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.005), &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_sensors_start(&sensors, &settings, &plant, &why));
        for (int step = 0; step < 60; step++) {
            const laconic_input samples[3] = {input_at(step), input_at(step + 3), input_at(step + 5)};
            ASSERT_STATUS(LACONIC_OK, step % 4 == 3 ? laconic_sensors_run_sampled(&sensors, &plant, samples, &why)
                                                    : laconic_sensors_run(&sensors, &plant, samples, 1, &why));
            laconic_sensor_outputs out;
            memset(&out, 0, sizeof out);
            laconic_sensors_read(&out, &sensors, &plant, samples);
            TAKE(out);
        }
    }
    expect(EITHER(0x1f24a5c0af800197U, 0x7ef8940c731721beU));
}

static void constants_of_vehicles(void) {
    begin();
    for (int number = 0; number < VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        const laconic_model model = model_of(vehicle);
        laconic_matrices matrices;
        laconic_contact contact;
        memset(&matrices, 0, sizeof matrices);
        memset(&contact, 0, sizeof contact);
        ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&matrices, &vehicle, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicle, &why));
        TAKE(matrices.wheel_rows);
        TAKE(matrices.inertia);
        TAKE(matrices.inverse_inertia);
        TAKE(matrices.constraint_rows);
        TAKE(matrices.lambda_yaw);
        TAKE(matrices.lambda_wheel);
        TAKE(contact.multiplier);
        TAKE(contact.normal_load_of_wrench);
        TAKE(contact.point_m);
        TAKE(model.nu_of_zeta);
        TAKE(model.decay_per_s);
        const laconic_real condition = laconic_condition_number(&model);
        TAKE(condition);
    }
    expect(EITHER(0x5a5a66ffd489ed46U, 0xd6c1a3f0b7041f8aU));
}

static void a_motor_fitted_to_its_wheels(void) {
    const laconic_motor motor = {REAL(1.3), REAL(0.05), REAL(0.048), -14, REAL(2e-5), REAL(3e-6)};
    laconic_vehicle vehicle = vehicle_number(0);
    begin();
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&vehicle, &motor, &why));
    TAKE(vehicle.motor_gain_Nm_per_V);
    TAKE(vehicle.motor_damping_Nms);
    TAKE(vehicle.wheel_inertia_kgm2);
    TAKE(vehicle.drive);
    expect(EITHER(0x9aa55b60f301398aU, 0x112f1ef59da293f2U));
}

static void rates_and_directional_derivatives(void) {
    begin();
    for (int number = 0; number < VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        const laconic_model model = model_of(vehicle);
        const laconic_motion at = {{REAL(0.8), REAL(-0.5), REAL(1.4)}, REAL(0.9)};
        laconic_variation by = {{REAL(0.3), REAL(-0.2), REAL(0.5)}, REAL(0.4), REAL(-0.3), REAL(0.7), input_at(3)};
        laconic_state state;
        laconic_contact contact;
        laconic_rates rates, change;
        laconic_motion_change moved;
        laconic_reactions now, bent;
        const laconic_start start = {
            {at.nu_rad_per_s[0], at.nu_rad_per_s[1], at.nu_rad_per_s[2]}, 0, 0, REAL(0.9), {0}};
        const laconic_input input = input_at(25);
        memset(&rates, 0, sizeof rates);
        memset(&change, 0, sizeof change);
        memset(&moved, 0, sizeof moved);
        memset(&now, 0, sizeof now);
        memset(&bent, 0, sizeof bent);
        ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, &model, &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicle, &why));
        laconic_derivative(&rates, &model, at.nu_rad_per_s, at.heading_rad, &input);
        laconic_derivative_tangent(&change, &model, &at, &input, &by);
        laconic_motion_tangent(&moved, &model, &at, &by);
        laconic_reactions_of(&now, &contact, &model, &state, &input);
        laconic_reactions_tangent(&bent, &contact, &model, &at, &input, &now, &by);
        TAKE(rates);
        TAKE(change);
        TAKE(moved);
        TAKE(now);
        TAKE(bent);
    }
    expect(EITHER(0x9b698df8b9a73ce6U, 0xe44dfe384e31acddU));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(motions_by_every_method);
    RUN_TEST(motions_with_friction);
    RUN_TEST(the_smooth_law_of_friction);
    RUN_TEST(what_sensors_show);
    RUN_TEST(constants_of_vehicles);
    RUN_TEST(a_motor_fitted_to_its_wheels);
    RUN_TEST(rates_and_directional_derivatives);
    return UNITY_END();
}
