/* What the tests of bits share: a hash of every number that a test takes, vehicles of every kind, and what acts on
 * them. The vehicles are written in numbers alone, since a sine of the host's library may differ. */
#ifndef LACONIC_TEST_BITS_H
#define LACONIC_TEST_BITS_H

#include <inttypes.h>
#include <stdio.h>

#include "vehicles.h"

#define QUARTER_TURN 1.57079632679489661923

static laconic_refusal why;
static uint64_t hash; /* FNV-1a of the numbers */

static inline void take(const laconic_real *number, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const laconic_real shown = number[i] == number[i] ? number[i] : 0; /* a NaN has many bits */
        uint8_t bytes[sizeof shown];
        memcpy(bytes, &shown, sizeof shown);
        for (size_t k = 0; k < sizeof bytes; k++) hash = (hash ^ bytes[k]) * 1099511628211U;
    }
}

/* Before a call that writes some items: the others must stay as they were. */
#define FILL(numbers) fill((laconic_real *)(void *)&(numbers), sizeof(numbers) / (sizeof(laconic_real)))

static inline void fill(laconic_real *number, size_t count) {
    for (size_t i = 0; i < count; i++) number[i] = REAL(7.25);
}

#define TAKE(numbers) take((const laconic_real *)&(numbers), sizeof(numbers) / (sizeof(laconic_real)))

static inline void begin(void) { hash = 1469598103934665603U; }

static inline void expect(uint64_t bits) {
    char found[64];
    snprintf(found, sizeof found, "these bits are new: 0x%016" PRIx64, hash);
    TEST_ASSERT_TRUE_MESSAGE(hash == bits, found);
}

/* Methods from number 0 on whose bits these tests hold. Of a later one trajectory_hash.c prints a line, which must be
 * the same from every build. */
#define METHODS_WITH_BITS 8

/* One hash for each method: those of a method that was changed on purpose can be renewed alone. */
static inline void expect_by_method(void (*part)(const laconic_method *), const uint64_t bits[METHODS_WITH_BITS]) {
    char found[60 * METHODS_WITH_BITS] = "these bits are new:";
    bool same = true;
    for (int32_t number = 0; number < METHODS_WITH_BITS; number++) {
        const laconic_method *method = laconic_method_by_number(number);
        begin();
        part(method);
        if (hash == bits[number]) continue;
        same = false;
        const size_t length = strlen(found);
        snprintf(found + length, sizeof found - length, " %s 0x%016" PRIx64, method->name, hash);
    }
    TEST_ASSERT_TRUE_MESSAGE(same, found);
}

static inline void take_refusal(void) {
    const laconic_real told[5] = {REAL(why.status), REAL(why.field), REAL(why.item), why.value, why.limit};
    TAKE(told);
}

/* ------------------------------------------------------------------------------------- vehicles -- */

#define VEHICLES 6
#define MORE_VEHICLES 13

/* One degree of freedom; eight wheels with rollers, no two alike, on a slope; wheels that nothing drives on another
 * slope; a caster whose damping is fast; dampings of four orders of magnitude; two fixed wheels of unlike size; as many
 * wheels and supports as there is room for. */
static inline laconic_vehicle unusual_vehicle(int number) {
    laconic_vehicle v = number == 7 || number == 10 || number == 12 ? bare_body()
                        : number == 9                               ? caster()
                                                                    : differential_drive();
    if (number == 8) v = three_wheels();
    if (number != 8) v = with_motors(v);
    if (number == 6) add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1, 0.2, 0.3, 1.1);
    if (number == 6) v.wheel[2].locked = true;
    for (int i = 0; number == 7 && i < 8; i++) {
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.25 - 0.07 * i, i % 2 == 0 ? 0.15 : -0.17, 0.8 * i - 3, 0.6 + 0.1 * i);
        v.wheel[i].own_radius_m = REAL(0.04 + 0.003 * i);
        v.wheel[i].own_inertia_kgm2 = REAL(0.002 + 0.0015 * i);
        v.wheel[i].own_motor_damping_Nms = REAL(0.01 + 0.004 * i);
        v.wheel[i].own_motor_gain_Nm_per_V = REAL(i == 5 ? 0 : 0.3 - 0.11 * i);
    }
    if (number == 7 || number == 8) v.ground.slope_rad = REAL(number == 7 ? 0.12 : 0.3);
    if (number == 7 || number == 8) v.ground.slope_heading_rad = REAL(number == 7 ? -0.9 : 2.2);
    if (number == 9) v.motor_damping_Nms = 6;
    for (int i = 0; number == 10 && i < 4; i++) {
        const double damping[4] = {0.001, 0.05, 0.7, 9};
        add_wheel(&v, LACONIC_WHEEL_ROLLER, i < 2 ? 0.2 : -0.2, i % 2 == 0 ? 0.15 : -0.15, 0.3 * i, 1.0 + 0.2 * i);
        v.wheel[i].own_motor_damping_Nms = REAL(damping[i]);
    }
    if (number == 11) v = with_own_wheels(v);
    if (number == 11) v.wheel[1].undriven = false;
    if (number == 11) v.payload = (laconic_payload){REAL(2.5), REAL(-0.04), REAL(0.06), REAL(0.02)};
    for (int i = 0; number == 12 && i < LACONIC_MAX_WHEELS; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.3 - 0.04 * i, i % 2 == 0 ? 0.2 : -0.19, 0.5 * i - 4, 1.5 - 0.05 * i);
    v.com_x_m = REAL(number == 9 ? 0.03 : -0.02);
    v.com_z_m = REAL(0.11);
    v.friction_coefficient = REAL(0.45);
    v.support_count = number == 10 || number == 12 ? LACONIC_MAX_SUPPORTS : number == 9 ? 2 : 0;
    for (int i = 0; i < v.support_count; i++) {
        v.support[i].x_m = REAL(0.15 - 0.1 * i);
        v.support[i].y_m = REAL(0.05 * i * i - 0.1);
    }
    return v;
}

/* Omni, mecanum with own wheels, two fixed wheels with a payload, fast damping, a braked wheel, and a puck; then the
 * unusual ones. */
static inline laconic_vehicle vehicle_number(int number) {
    if (number >= VEHICLES) return unusual_vehicle(number);
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
static inline laconic_vehicle slipping_vehicle(int number) { /* 0 … 2 */
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

#define SLIPPING 3
#define MORE_SLIPPING 8

/* A drive with limits on ideal ground; a skid on a slope, one wheel held by its brake, between supports; rollers that
 * drag as tyres do, every wheel on ground of its own; two wheels with a heavy body that leans on casters; as many
 * wheels and supports as there is room for. */
static inline laconic_vehicle more_slipping_vehicle(int number) {
    laconic_vehicle v = slipping_vehicle(number == 4 ? 1 : 0);
    if (number == 3) {
        v.ground = (laconic_ground){.slope_rad = REAL(0.04), .slope_heading_rad = -2};
        v.friction_coefficient = REAL(0.5);
        v.wheel[1].own_motor_gain_Nm_per_V = REAL(-0.4);
        v.drive.current_limit_A = 2;
    }
    if (number == 4) {
        v.ground.slope_rad = REAL(0.2);
        v.ground.axle_friction_Nm = REAL(0.15);
        v.wheel[2].locked = true;
        v.com_x_m = REAL(0.05);
        v.com_z_m = REAL(0.3);
    }
    for (int i = 0; number == 5 && i < 3; i++) {
        v.wheel[i].own_roller_drag = REAL(1 - 0.3 * i);
        v.wheel[i].own_friction_coefficient = REAL(0.2 + 0.25 * i);
        v.wheel[i].own_radius_m = REAL(0.04 + 0.01 * i);
        v.wheel[i].own_inertia_kgm2 = REAL(0.002 + 0.003 * i);
        v.wheel[i].roller_rad = REAL(0.8 + 0.4 * i);
    }
    if (number == 5) v.payload = (laconic_payload){4, REAL(0.05), REAL(-0.03), REAL(0.02)};
    if (number == 6) {
        v.wheel_count = 2;
        v.wheel[0].kind = v.wheel[1].kind = LACONIC_WHEEL_FIXED;
        v.wheel[1].undriven = true;
        v.com_z_m = REAL(0.5);
    }
    for (int i = 3; number == 7 && i < LACONIC_MAX_WHEELS; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.3 - 0.04 * i, i % 2 == 0 ? 0.2 : -0.19, 0.5 * i - 4, 1.5 - 0.05 * i);
    v.support_count = number == 7 ? LACONIC_MAX_SUPPORTS : number == 6 ? 3 : number == 4 ? 2 : 0;
    for (int i = 0; i < v.support_count; i++) {
        v.support[i].x_m = REAL(0.2 - 0.17 * i);
        v.support[i].y_m = REAL(0.12 * i - 0.1);
    }
    return v;
}

/* What acts in one step of a run. */
static inline laconic_input input_at(int step) {
    laconic_input input = every_input();
    const laconic_real sign = step / 20 % 2 == 0 ? 1 : -1;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) input.voltage_V[i] *= 8 * sign;
    input.world_force_N[0] *= sign;
    input.body_moment_Nm += REAL(0.01) * REAL(step % 7);
    return input;
}

static inline void take_all(const laconic_plant *plant, const laconic_contact *contact, const laconic_sensors *sensors,
                            const laconic_input *input) {
    laconic_outputs out;
    memset(&out, 0, sizeof out);
    laconic_outputs_of(&out, plant, input);
    laconic_plant_reactions(&out.reactions, plant, contact, input);
    if (sensors != NULL) laconic_sensors_read(&out.sensors, sensors, plant, input);
    TAKE(out);
}

/* A run with held inputs and, in between, sampled ones. */
static inline void take_run(const laconic_vehicle *vehicle, const laconic_method *method, double step_s, int steps) {
    laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    laconic_contact contact;
    start.heading_rad = REAL(0.4);
    start.y_m = REAL(-0.3);
    if (laconic_plant_start(&plant, vehicle, method, REAL(step_s), &start, &why) != LACONIC_OK) {
        take_refusal();
        return;
    }
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

static inline laconic_sensor_settings every_sensor(void) {
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

#endif
