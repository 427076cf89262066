/* Tests that refusals stay as they were: status, field, item, value and limit, for each number of a vehicle, a start, a
 * step, an input, a motor and the sensors, when it is out of its range; the lines of text; and what the lists of fields
 * say. Hosts and rigs of an earlier version read them. test_vehicle.c, test_message.c and test_fields.c say what
 * is right. */
#include "bits.h"
#include "laconic/estimate.h"
#include "laconic/filter.h"

static void take_text(const char *text) {
    for (; *text != 0; text++) hash = (hash ^ (uint8_t)*text) * 1099511628211U;
}

static void take_why(laconic_status status) {
    TEST_ASSERT_TRUE(status == LACONIC_OK || status == why.status);
    if (status != LACONIC_OK) take_refusal();
    memset(&why, 0, sizeof why);
    hash = (hash ^ (uint64_t)status) * 1099511628211U;
}

/* Numbers that some rule refuses, and neighbours of the limits, which it takes. */
static const laconic_real wrong[] = {REAL(-1),
                                     0,
                                     REAL(1e-7),
                                     REAL(0.5),
                                     1,
                                     REAL(1.01),
                                     REAL(1.5707963),
                                     REAL(1.5708),
                                     REAL(3.14159265358979323846),
                                     REAL(1e4),
                                     REAL(1e9),
                                     REAL(1e11),
                                     REAL(1e15),
                                     REAL(2e15),
                                     REAL(1e30),
                                     LACONIC_REAL_MAX,
                                     -LACONIC_REAL_MAX,
                                     LACONIC_REAL_MIN,
                                     REAL(INFINITY),
                                     -REAL(INFINITY),
                                     REAL(NAN)};
#define WRONGS ((int)(sizeof wrong / sizeof wrong[0]))

/* What begins with a vehicle: a plant by auto and by a method that friction refuses, contact, matrices. */
static void take_vehicle(const laconic_vehicle *vehicle) {
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    laconic_contact contact;
    laconic_matrices matrices;
    take_why(laconic_vehicle_check(vehicle, &why));
    take_why(laconic_plant_start(&plant, vehicle, &laconic_auto, REAL(0.01), &start, &why));
    take_why(laconic_plant_start(&plant, vehicle, &laconic_rk4, REAL(0.01), &start, &why));
    take_why(laconic_contact_prepare(&contact, vehicle, &why));
    take_why(laconic_matrices_of(&matrices, vehicle, &why));
}

#define EACH(of, number, IDENTIFIER, member, ...) EACH_##of(member)
#define EACH_VEHICLE(member) offsetof(laconic_vehicle, member),
#define EACH_PAYLOAD(member) offsetof(laconic_vehicle, payload.member),
#define EACH_GROUND(member) offsetof(laconic_vehicle, ground.member),
#define EACH_DRIVE(member) offsetof(laconic_vehicle, drive.member),
#define EACH_OWN(member) offsetof(laconic_vehicle, wheel[1].own_##member),
#define EACH_SUPPORT(member) offsetof(laconic_vehicle, support[0].member),

static const size_t numbers_of_vehicle[] = {
    LACONIC_VEHICLE_FIELDS(EACH, VEHICLE) LACONIC_PAYLOAD_FIELDS(EACH, PAYLOAD) LACONIC_GROUND_FIELDS(EACH, GROUND)
        LACONIC_DRIVE_FIELDS(EACH, DRIVE) LACONIC_OWN_WHEEL_FIELDS(EACH, OWN) LACONIC_SUPPORT_FIELDS(EACH, SUPPORT)
            offsetof(laconic_vehicle, wheel[1].x_m),
    offsetof(laconic_vehicle, wheel[2].y_m), offsetof(laconic_vehicle, wheel[0].axle_rad),
    offsetof(laconic_vehicle, wheel[1].roller_rad)};

static void a_number_of_a_vehicle(void) {
    begin();
    for (int number = 0; number < 3; number++)
        for (size_t k = 0; k < sizeof numbers_of_vehicle / sizeof numbers_of_vehicle[0]; k++)
            for (int n = 0; n < WRONGS; n++) {
                laconic_vehicle vehicle = number == 2 ? slipping_vehicle(2) : vehicle_number(number);
                memcpy((unsigned char *)&vehicle + numbers_of_vehicle[k], &wrong[n], sizeof wrong[n]);
                take_vehicle(&vehicle);
            }
    expect(EITHER(0xd9d3da9e4b788f14U, 0x35fa48514a5ee199U));
}

static laconic_real power_of_ten(int exponent) {
    laconic_real power = 1;
    for (int k = 0; k < (exponent < 0 ? -exponent : exponent); k++) power *= 10;
    return exponent < 0 ? 1 / power : power;
}

/* The same robot in units so far off that products of its constants leave the range, sooner or later. */
static laconic_vehicle in_units(laconic_vehicle v, laconic_real length, laconic_real mass, laconic_real force) {
    v.mass_kg *= mass;
    v.payload.mass_kg *= mass;
    v.yaw_inertia_kgm2 *= mass * length * length;
    v.payload.yaw_inertia_kgm2 *= mass * length * length;
    v.wheel_inertia_kgm2 *= mass * length * length;
    v.wheel_radius_m *= length;
    v.com_x_m *= length;
    v.com_y_m *= length;
    v.com_z_m *= length;
    v.motor_gain_Nm_per_V *= force;
    v.motor_damping_Nms *= force;
    for (int i = 0; i < v.wheel_count; i++) {
        v.wheel[i].x_m *= length;
        v.wheel[i].y_m *= length;
        v.wheel[i].own_radius_m *= length;
        v.wheel[i].own_inertia_kgm2 *= mass * length * length;
        v.wheel[i].own_motor_gain_Nm_per_V *= force;
        v.wheel[i].own_motor_damping_Nms *= force;
    }
    for (int i = 0; i < v.support_count; i++) v.support[i].x_m *= length;
    return v;
}

static void a_vehicle_in_units_far_off(void) {
    const int step = EITHER(18, 2);
    begin();
    for (int number = 0; number < MORE_VEHICLES; number += number < 2 ? 1 : 2)
        for (int length = -5; length <= 5; length++)
            for (int mass = -5; mass <= 5; mass++) {
                const laconic_real force = power_of_ten(step * ((length * length + mass * mass + number) % 7 - 3));
                const laconic_vehicle vehicle =
                    in_units(vehicle_number(number), power_of_ten(step * length), power_of_ten(step * mass), force);
                laconic_model model;
                laconic_contact contact;
                take_why(laconic_prepare(&model, &vehicle, &why));
                take_why(laconic_contact_prepare(&contact, &vehicle, &why));
            }
    for (int number = 0; number < 5; number++)
        for (int k = 0; k < 4; k++)
            for (int exponent = -8; exponent <= 8; exponent++) {
                laconic_vehicle vehicle = vehicle_number(number);
                laconic_wheel *w = &vehicle.wheel[number % 2];
                laconic_real *const own[4] = {&w->own_radius_m, &w->own_inertia_kgm2, &w->own_motor_gain_Nm_per_V,
                                              &w->own_motor_damping_Nms};
                laconic_model model;
                *own[k] = power_of_ten(exponent * EITHER(20, 3)) * (k == 2 ? -1 : 1);
                if (number > 2) vehicle.mass_kg = power_of_ten(number == 3 ? EITHER(40, 9) : EITHER(-40, -9));
                take_why(laconic_prepare(&model, &vehicle, &why));
            }
    expect(EITHER(0xb715ea324df5908aU, 0x073785e7357be315U));
}

/* Some numbers of a vehicle anywhere in the range, alone and together: each constant comes to its end. */
static void numbers_of_a_vehicle_anywhere_in_the_range(void) {
    const size_t count = sizeof numbers_of_vehicle / sizeof numbers_of_vehicle[0];
    uint32_t seed = 7;
    begin();
    for (int n = 0; n < 6000; n++) {
        laconic_vehicle vehicle = vehicle_number(n % MORE_VEHICLES);
        laconic_model model;
        laconic_contact contact;
        for (int k = 0; k < 1 + n % 5; k++) {
            seed = seed * 1664525U + 1013904223U;
            const size_t which = (seed >> 8) % count;
            seed = seed * 1664525U + 1013904223U;
            const int exponent = (int)((seed >> 8) % EITHER(311U, 39U)) - EITHER(155, 19);
            seed = seed * 1664525U + 1013904223U;
            const laconic_real number = (1 + REAL(seed >> 8) / 2000000) * power_of_ten(exponent);
            memcpy((unsigned char *)&vehicle + numbers_of_vehicle[which], &number, sizeof number);
        }
        take_why(laconic_prepare(&model, &vehicle, &why));
        take_why(laconic_contact_prepare(&contact, &vehicle, &why));
    }
    expect(EITHER(0xbcf64120c4991261U, 0xb6f226eb28f06643U));
}

/* Two numbers near the ends of what may be squared: each alone is taken, both together may leave the range. */
static void two_numbers_of_a_vehicle_near_the_ends_of_the_range(void) {
    const size_t count = sizeof numbers_of_vehicle / sizeof numbers_of_vehicle[0];
    const laconic_real root = EITHER(REAL(1.34e154), REAL(1.84e19));
    const laconic_real near[6] = {root * REAL(0.6), root * REAL(-0.9), REAL(1.7) / root,
                                  -1 / root,        REAL(0.7),         REAL(1e-3)};
    begin();
    for (size_t k = 0; k < count; k++)
        for (size_t other = 0; other <= k; other++)
            for (int n = 0; n < 24; n++) {
                laconic_vehicle vehicle = n % 2 == 0 ? bare_body() : vehicle_number((int)(k + other) % MORE_VEHICLES);
                laconic_model model;
                memcpy((unsigned char *)&vehicle + numbers_of_vehicle[k], &near[n / 2 % 4], sizeof near[0]);
                memcpy((unsigned char *)&vehicle + numbers_of_vehicle[other], &near[n % 6], sizeof near[0]);
                take_why(laconic_prepare(&model, &vehicle, &why));
            }
    expect(EITHER(0x0dbaf1484e349324U, 0xc40d1841b9f6d0faU));
}

static void wheels_and_supports_of_a_vehicle(void) {
    begin();
    for (int k = 0; k < 40; k++) {
        laconic_vehicle vehicle = k % 2 == 0 ? vehicle_number(k % 5) : slipping_vehicle(k % 3);
        const int32_t count[4] = {-1, 17, 16, 0};
        if (k < 8) vehicle.wheel_count = count[k % 4];
        if (k >= 8 && k < 16) vehicle.support_count = k - 10;
        if (k >= 16 && k < 24) vehicle.wheel[k % 3].kind = (laconic_wheel_kind)(k - 16);
        if (k >= 24 && k < 32) vehicle.wheel[k % 3].motor_circuit = k - 26;
        for (int i = 0; k >= 32 && i < vehicle.wheel_count; i++) {
            if (k < 36) vehicle.wheel[i].kind = LACONIC_WHEEL_FIXED;
            if (k >= 36 || k == 34) vehicle.wheel[i].locked = true;
            if (k == 33) vehicle.wheel[i].axle_rad = REAL(0.3);
        }
        take_vehicle(&vehicle);
    }
    expect(EITHER(0xf9e95825578310a8U, 0x3602a635ec547324U));
}

static void a_number_of_a_start_and_a_step(void) {
    begin();
    for (int number = 0; number < MORE_VEHICLES + 3; number++)
        for (int k = 0; k < 8; k++)
            for (int n = 0; n < WRONGS; n++) {
                const laconic_vehicle vehicle =
                    number < MORE_VEHICLES ? vehicle_number(number) : slipping_vehicle(number - MORE_VEHICLES);
                const laconic_method *method = laconic_method_by_number(n % METHODS_WITH_BITS);
                laconic_start start = start_with(0, 0, 0);
                laconic_real *const where[7] = {&start.nu_rad_per_s[0],
                                                &start.nu_rad_per_s[1],
                                                &start.nu_rad_per_s[2],
                                                &start.x_m,
                                                &start.y_m,
                                                &start.heading_rad,
                                                &start.wheel_speed_rad_per_s[1]};
                laconic_plant plant;
                if (k < 7) *where[k] = wrong[n];
                take_why(laconic_plant_start(&plant, &vehicle, n == 5 ? NULL : method, k == 7 ? wrong[n] : REAL(0.004),
                                             &start, &why));
            }
    expect(EITHER(0xb8543e0bef5a12feU, 0x774295e46b1c6502U));
}

static void a_number_of_an_input(void) {
    begin();
    for (int number = 0; number < 3; number++)
        for (size_t k = 0; k < sizeof(laconic_input) / sizeof(laconic_real); k++)
            for (int n = WRONGS - 8; n < WRONGS; n++) {
                const laconic_vehicle vehicle = number == 2 ? slipping_vehicle(2) : vehicle_number(number);
                const laconic_start start = start_with(0, 0, 0);
                laconic_input samples[3] = {every_input(), every_input(), every_input()};
                laconic_plant plant;
                ASSERT_STATUS(LACONIC_OK,
                              laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
                memcpy((unsigned char *)&samples[n % 3] + k * sizeof(laconic_real), &wrong[n], sizeof wrong[n]);
                take_why(laconic_input_check(&plant.model, &samples[n % 3], &why));
                take_why(laconic_plant_run_sampled(&plant, samples, &why));
                take_why(laconic_plant_run(&plant, &samples[n % 3], 2, &why));
            }
    expect(EITHER(0x0de16df40fd2e684U, 0xd3bce0ccba0e6ab5U));
}

static void a_number_of_a_motor(void) {
    begin();
    for (int k = 0; k < 6; k++)
        for (int n = 0; n < WRONGS; n++) {
            laconic_motor motor = {REAL(1.3), REAL(0.05), REAL(0.048), -14, REAL(2e-5), REAL(3e-6)};
            laconic_real *const where[6] = {&motor.resistance_ohm,       &motor.torque_constant_Nm_per_A,
                                            &motor.back_emf_Vs_per_rad,  &motor.gear_ratio,
                                            &motor.viscous_friction_Nms, &motor.rotor_inertia_kgm2};
            laconic_vehicle vehicle = vehicle_number(k);
            *where[k] = wrong[n];
            take_why(laconic_motor_fit(&vehicle, &motor, &why));
            TAKE(vehicle.motor_gain_Nm_per_V);
            TAKE(vehicle.motor_damping_Nms);
            TAKE(vehicle.wheel_inertia_kgm2);
        }
    expect(EITHER(0x620cdf2c57da3828U, 0x1337131018b4993cU));
}

static void a_number_of_the_sensors(void) {
    static const size_t number[] = {
        offsetof(laconic_sensor_settings, imu.x_m),
        offsetof(laconic_sensor_settings, imu.y_m),
        offsetof(laconic_sensor_settings, imu.heading_rad),
        offsetof(laconic_sensor_settings, imu.acceleration_scale_error[1]),
        offsetof(laconic_sensor_settings, imu.acceleration_bias_m_per_s2[0]),
        offsetof(laconic_sensor_settings, imu.acceleration_noise_m_per_s2_per_sqrt_Hz),
        offsetof(laconic_sensor_settings, imu.acceleration_range_m_per_s2),
        offsetof(laconic_sensor_settings, imu.yaw_rate_scale_error),
        offsetof(laconic_sensor_settings, imu.yaw_rate_bias_rad_per_s),
        offsetof(laconic_sensor_settings, imu.yaw_rate_noise_rad_per_s_per_sqrt_Hz),
        offsetof(laconic_sensor_settings, imu.yaw_rate_range_rad_per_s),
        offsetof(laconic_sensor_settings, encoder[2].gear_ratio),
    };
    begin();
    for (size_t k = 0; k < sizeof number / sizeof number[0]; k++)
        for (int n = 0; n < WRONGS; n++) {
            laconic_sensor_settings settings = every_sensor();
            memcpy((unsigned char *)&settings + number[k], &wrong[n], sizeof wrong[n]);
            take_why(laconic_sensor_settings_check(&settings, 3, &why));
        }
    for (int n = -3; n < 70; n++) {
        laconic_sensor_settings settings = every_sensor();
        if (n % 3 == 0) settings.imu.delay_steps = n;
        if (n % 3 == 1) settings.encoder[n % 4].counts_per_turn = n % 4;
        if (n % 3 == 2) settings.encoder_wrap = n - 20;
        take_why(laconic_sensor_settings_check(&settings, n % 5, &why));
    }
    expect(EITHER(0x618d01f3041c284dU, 0x5378481b328489e3U));
}

static void a_number_of_the_filter_and_windows_of_an_estimate(void) {
    const laconic_vehicle vehicle = vehicle_number(0);
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
    begin();
    for (size_t k = 0; k < sizeof(laconic_filter_settings) / sizeof(laconic_real); k++)
        for (int n = 0; n < WRONGS; n++) {
            laconic_filter_settings settings;
            laconic_filter filter;
            memset(&settings, 0, sizeof settings);
            memcpy((unsigned char *)&settings + k * sizeof(laconic_real), &wrong[n], sizeof wrong[n]);
            const laconic_real status = REAL(laconic_filter_start(&filter, &plant.model, &settings, &plant.state));
            TAKE(status);
        }
    for (int32_t most = -1; most < 1026; most += most > 2 && most < 1022 ? 100 : 1) {
        laconic_estimate estimate;
        take_why(laconic_estimate_start(&estimate, &plant, most, &laconic_auto, &why));
    }
    expect(EITHER(0xba3258e7c1dfbb5aU, 0xb3d9f3490030540aU));
}

/* Messages of each status for each field, in room that is ample and in room that ends early. */
static void every_line_of_text(void) {
    begin();
    for (int field = -1; field < 130; field++) {
        const laconic_field_traits *traits = laconic_field_traits_of((laconic_field)field);
        take_text(laconic_field_name((laconic_field)field));
        take_text(laconic_field_path((laconic_field)field));
        const laconic_real told[4] = {
            REAL(traits == NULL ? -1 : (int)traits->kind), REAL(traits == NULL ? -1 : (int)traits->rule),
            REAL(traits == NULL ? -1 : (int)traits->need), REAL(traits == NULL ? -1 : traits->items)};
        TAKE(told);
    }
    for (int status = -1; status <= LACONIC_STATUS_COUNT; status++) {
        take_text(laconic_status_name((laconic_status)status));
        take_text(laconic_arithmetic_text((laconic_arithmetic)status));
        for (int n = 0; n < WRONGS; n++) {
            const laconic_refusal told = {(laconic_status)status, (laconic_field)(3 * n), n, wrong[n],
                                          REAL(1.23456e-9 * n * n * n)};
            char text[600] = "";
            const laconic_real lengths[3] = {REAL(laconic_message(&told, text, (size_t)(7 * n))),
                                             REAL(laconic_explanation(&told, text, (size_t)(9 * n))),
                                             REAL(laconic_message(&told, text, sizeof text))};
            take_text(text);
            TAKE(lengths);
        }
    }
    expect(EITHER(0x4bac28654c1f368fU, 0xe3a09ea58e768c56U));
}

static void lines_of_text_with_numbers_of_every_size(void) {
    begin();
    for (int n = 0; n < 400; n++) {
        laconic_real value = REAL(1.0 + 0.37 * n);
        char text[200] = "";
        for (int k = 0; k < n % 60; k++) value *= n % 2 == 0 ? REAL(0.25) : REAL(4);
        if (n % 3 == 0) value = -value;
        if (n > 350) value = REAL(n - 350) * REAL(n % 2 == 0 ? 1e5 : 0.001);
        const laconic_refusal told = {LACONIC_ABOVE_LIMIT, LACONIC_FIELD_MASS, 0, value, REAL(0.1 * n)};
        laconic_message(&told, text, sizeof text);
        take_text(text);
    }
    expect(EITHER(0x71f782b74265bc7cU, 0xe3b6f9cd188dc837U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_number_of_a_vehicle);
    RUN_TEST(a_vehicle_in_units_far_off);
    RUN_TEST(numbers_of_a_vehicle_anywhere_in_the_range);
    RUN_TEST(two_numbers_of_a_vehicle_near_the_ends_of_the_range);
    RUN_TEST(wheels_and_supports_of_a_vehicle);
    RUN_TEST(a_number_of_a_start_and_a_step);
    RUN_TEST(a_number_of_an_input);
    RUN_TEST(a_number_of_a_motor);
    RUN_TEST(a_number_of_the_sensors);
    RUN_TEST(a_number_of_the_filter_and_windows_of_an_estimate);
    RUN_TEST(every_line_of_text);
    RUN_TEST(lines_of_text_with_numbers_of_every_size);
    return UNITY_END();
}
