/* Tests that every number of the core is, bit for bit, that of the version before: motions with friction, what
 * sensors show, constants, rates and their directional derivatives; test_bits_motions.c has the motions by every
 * method. A recording then replays in a later version as it was made. Other tests compare the numbers with independent
 * ones; a change of bits on purpose is one of these and goes with a line of the changelog. */
#include "bits.h"

static void motions_with_friction(void) {
    begin();
    for (int number = 0; number < 3; number++) {
        const laconic_vehicle vehicle = slipping_vehicle(number);
        take_run(&vehicle, &laconic_auto, 0.004, 100);
        take_run(&vehicle, &laconic_auto, 0.05, 20);
    }
    expect(EITHER(0xca45fce8a1b553baU, 0x74323d94cc13fc4eU));
}

static void more_motions_with_friction(void) {
    begin();
    for (int number = SLIPPING; number < MORE_SLIPPING; number++) {
        const laconic_vehicle vehicle = more_slipping_vehicle(number);
        take_run(&vehicle, &laconic_auto, 0.002, 100);
        take_run(&vehicle, &laconic_auto, 0.01, 50);
        take_run(&vehicle, &laconic_auto, 0.2, 20);
    }
    expect(EITHER(0xe8be871ff53224e8U, 0xba4db7753ad60fe2U));
}

/* Fast over ground that holds little, with one wheel that turns the other way. */
static void wheels_that_spin(void) {
    begin();
    for (int number = 0; number < MORE_SLIPPING; number++) {
        const laconic_vehicle vehicle = number < SLIPPING ? slipping_vehicle(number) : more_slipping_vehicle(number);
        laconic_start start = start_with(40, -25, 30);
        laconic_plant plant;
        if (number == 3) start = start_with(0, 0, 0);
        start.wheel_speed_rad_per_s[0] = -60;
        start.wheel_speed_rad_per_s[1] = REAL(1e-9);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
        for (int step = 0; step < 80; step++) {
            const laconic_input input = step < 20 ? no_input() : input_at(step);
            if (laconic_plant_run(&plant, &input, 1, &why) != LACONIC_OK) take_refusal();
            if (step % 8 == 0) take_all(&plant, NULL, NULL, &input);
        }
    }
    expect(EITHER(0xbbabd4a8bd406d35U, 0x0388c216731c3df9U));
}

/* A supply that sags under more than it can give, beside wheels that draw nothing. */
static void a_supply_that_sags(void) {
    begin();
    for (int number = 0; number < MORE_SLIPPING; number++)
        for (int k = 0; k < 4; k++) {
            laconic_vehicle vehicle = number < SLIPPING ? slipping_vehicle(number) : more_slipping_vehicle(number);
            const laconic_start start = start_with(0, 0, 0);
            laconic_plant plant;
            vehicle.drive.supply_V = 12;
            vehicle.drive.supply_resistance_ohm = REAL(0.2 + 0.9 * k);
            vehicle.drive.current_limit_A = REAL(k == 3 ? 4 : 0);
            vehicle.wheel[k % 2].undriven = k < 3;
            ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.01), &start, &why));
            for (int step = 0; step < 24; step++) {
                laconic_input input = input_at(7 * step);
                for (int i = 0; i < LACONIC_MAX_WHEELS; i++) input.voltage_V[i] *= REAL(0.4 * (step % 8));
                ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 2, &why));
                if (step % 3 == 0) take_all(&plant, NULL, NULL, &input);
            }
        }
    expect(EITHER(0x03d9bab658481b9dU, 0x2efbf758186cc02aU));
}

/* Ground that begins to hold and ceases to, other vehicles, and vehicles that a motion cannot be carried over to. */
static void changes_of_the_ground(void) {
    begin();
    for (int number = 0; number < MORE_SLIPPING; number++) {
        laconic_vehicle vehicle = number < SLIPPING ? slipping_vehicle(number) : more_slipping_vehicle(number);
        const laconic_start start = start_with(0, 0, 0);
        laconic_plant plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.005), &start, &why));
        for (int k = 0; k < 8; k++) {
            laconic_vehicle other = vehicle;
            const laconic_input input = input_at(5 * k + number);
            ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 9, &why));
            if (k % 2 == 0 && number < 4) {
                other.ground = (laconic_ground){0};
                other.drive = (laconic_drive){0};
                for (int i = 0; i < other.wheel_count; i++) {
                    laconic_wheel *w = &other.wheel[i];
                    w->own_friction_coefficient = w->own_roller_drag = w->own_axle_friction_Nm = 0;
                    w->motor_circuit = LACONIC_MOTOR_DRIVEN;
                }
            }
            other.payload.mass_kg = REAL(0.4 * k);
            if (k >= 5) other.wheel_count -= 1; /* none comes back: a plant takes no more wheels */
            if (k == 6) other.mass_kg = EITHER(REAL(1e200), REAL(1e25));
            if (k == 7) other.payload.x_m = EITHER(REAL(1e140), REAL(1e17));
            why = (laconic_refusal){LACONIC_OK, LACONIC_FIELD_NONE, 0, 0, 0};
            laconic_plant_change(&plant, &other, &why);
            take_refusal();
            laconic_outputs out;
            memset(&out, 0, sizeof out);
            laconic_outputs_of(&out, &plant, &input);
            TAKE(out);
        }
    }
    expect(EITHER(0x3e9fcd5067653102U, 0x87706efa0bc51c07U));
}

/* A schedule with a recorder that watches the grip. */
static void what_a_recorder_keeps(void) {
    static const uint32_t signals[] = {offsetof(laconic_input, voltage_V), offsetof(laconic_input, world_force_N)};
    static const uint32_t columns[] = {offsetof(laconic_outputs, energy_J),
                                       offsetof(laconic_outputs, reactions.no_slip_margin_N),
                                       offsetof(laconic_outputs, input.world_force_N)};
    static const uint64_t until[3] = {9, 20, 60};
    laconic_real value[2 * 3 * 60];
    for (int i = 0; i < 2 * 3 * 60; i++) value[i] = REAL(i % 2 == 0 ? 7 - i % 5 : 60 * (i % 3));
    begin();
    for (int number = 0; number < MORE_VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        const laconic_start start = start_with(0, 0, 0);
        const laconic_schedule schedule = {2, signals, value, number % 2 == 0 ? until : NULL, number % 2 == 0 ? 3 : 60,
                                           0};
        laconic_real cell[3 * 30];
        laconic_plant plant;
        laconic_contact contact;
        laconic_grip grip;
        laconic_recorder recorder = {&contact, &grip, 2 + (uint64_t)number, 3, columns, cell, 0, 30, NULL};
        memset(&grip, 0, sizeof grip);
        memset(cell, 0, sizeof cell);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, &laconic_auto, REAL(0.005), &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicle, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_follow(&plant, &schedule, 60, &recorder, &why));
        const laconic_grip_event *const events[4] = {&grip.first_slip, &grip.worst_slip, &grip.first_lift,
                                                     &grip.worst_lift};
        const laconic_real counts[5] = {REAL(grip.instants), REAL(grip.slipping), REAL(grip.lifting),
                                        REAL(recorder.row_count), REAL(plant.steps)};
        TAKE(cell);
        TAKE(counts);
        for (int k = 0; k < 4; k++) {
            const laconic_real event[5] = {REAL(events[k]->steps), REAL(events[k]->point), events[k]->needed_N,
                                           events[k]->normal_N, events[k]->margin_N};
            TAKE(event);
        }
    }
    expect(EITHER(0x19422733d9c4442bU, 0x003ee673a4123af3U));
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

static void take_model(const laconic_model *model) {
    TAKE(model->nu_of_zeta);
    TAKE(model->gyro);
    TAKE(model->gyro_square);
    TAKE(model->spin_gain);
    TAKE(model->spin_curve);
    TAKE(model->decay_per_s);
    TAKE(model->inertia);
    TAKE(model->velocity_of_zeta);
    TAKE(model->yaw_rate_of_zeta);
    TAKE(model->wheel_of_zeta);
    TAKE(model->zeta_of_nu);
    TAKE(model->voltage_scale);
    TAKE(model->motor_gain_Nm_per_V);
    TAKE(model->motor_damping_Nms);
    TAKE(model->wheel_inertia_kgm2);
    TAKE(model->slope_force_N);
}

static void take_integrator(const laconic_integrator *integrator) {
    for (int level = 0; level < 3; level++) {
        TAKE(integrator->decay[level].gain);
        TAKE(integrator->decay[level].inverse_gain);
        TAKE(integrator->decay[level].mean);
        TAKE(integrator->decay[level].bend);
        TAKE(integrator->decay[level].mean_ramp);
        TAKE(integrator->decay[level].mean_bend);
        TAKE(integrator->decay[level].slope);
        TAKE(integrator->decay[level].slope_ramp);
        TAKE(integrator->decay[level].slope_bend);
    }
    TAKE(integrator->gyro_limit);
    TAKE(integrator->first_share);
    TAKE(integrator->rest_share);
    TAKE(integrator->collocation);
    TAKE(integrator->collocation_of_rest);
    const laconic_real whole[3] = {REAL(integrator->stretches), REAL(integrator->has_rest), REAL(integrator->stiff)};
    TAKE(whole);
}

static void take_integrators(const laconic_method *method) {
    const double step_s[5] = {1e-4, 0.004, 0.05, 0.5, 7};
    for (int number = 0; number < MORE_VEHICLES; number++)
        for (int k = 0; k < 5; k++) {
            const laconic_vehicle vehicle = vehicle_number(number);
            const laconic_model model = model_of(vehicle);
            laconic_integrator integrator;
            memset(&integrator, 0, sizeof integrator);
            if (laconic_integrator_prepare(&integrator, method, &model, REAL(step_s[k]), &why) == LACONIC_OK)
                take_integrator(&integrator);
            else
                take_refusal();
        }
}

static void constants_of_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x1cd6d6934f664c13U, 0x2066298a86590b90U), EITHER(0x3f80bb7c22a7fcc2U, 0xc1184992cc7143bcU),
        EITHER(0x0a0f007ed4bb18fbU, 0x9962aa2deacf64c0U), EITHER(0x64120461bb5b28eeU, 0x33485eb5ca7d78acU),
        EITHER(0x64120461bb5b28eeU, 0x33485eb5ca7d78acU), EITHER(0x5230edcb7bec8329U, 0x32d47d4b8e3f05fbU),
        EITHER(0xb6c26837c136c74aU, 0xb63778127551bc2dU), EITHER(0x5f8612fa034e5368U, 0xccf83c5f59901b99U),
    };
    expect_by_method(take_integrators, bits);
}

static void constants_of_vehicles(void) {
    begin();
    for (int number = 0; number < MORE_VEHICLES; number++) {
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
        take_model(&model);
        const laconic_real condition = laconic_condition_number(&model);
        TAKE(condition);
    }
    expect(EITHER(0xdbb4eb581f98879aU, 0x28548accca592a9dU));
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
    for (int number = 0; number < MORE_VEHICLES; number++) {
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
    expect(EITHER(0x12c3bb930294c38aU, 0xfeb9bcba732aa633U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(motions_with_friction);
    RUN_TEST(more_motions_with_friction);
    RUN_TEST(wheels_that_spin);
    RUN_TEST(a_supply_that_sags);
    RUN_TEST(changes_of_the_ground);
    RUN_TEST(what_a_recorder_keeps);
    RUN_TEST(the_smooth_law_of_friction);
    RUN_TEST(what_sensors_show);
    RUN_TEST(constants_of_vehicles);
    RUN_TEST(constants_of_every_method);
    RUN_TEST(a_motor_fitted_to_its_wheels);
    RUN_TEST(rates_and_directional_derivatives);
    return UNITY_END();
}
