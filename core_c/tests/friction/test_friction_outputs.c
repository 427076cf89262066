/* Tests of friction_outputs.c: outputs, reactions and the smooth law of a vehicle with friction. */
#include "slipping.h"

static void contacts_that_slip_stick_and_lift_are_told_apart(void) {
    laconic_vehicle v = skid(0.3);
    laconic_input input = no_input();
    v.com_z_m = REAL(0.35);
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    run(&plant, &input, 2);
    laconic_outputs out = outputs_with(&plant, &input);
    for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE(out.friction.contact_state[i] == 0);
    input.body_force_N[1] = 300;
    run(&plant, &input, 100);
    out = outputs_with(&plant, &input);
    for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE(out.friction.contact_state[i] == 1);
    TEST_ASSERT_TRUE(out.friction.slip_across_m_per_s[0] > 0 || out.friction.slip_across_m_per_s[0] < 0);
    v.ground.friction_coefficient = 3;
    plant = started(v, 1e-3, 0, 0, 0);
    input.body_force_N[1] = 200;
    run(&plant, &input, 20);
    out = outputs_with(&plant, &input);
    TEST_ASSERT_TRUE(out.friction.contact_state[0] == 2 || out.friction.contact_state[1] == 2);
    TEST_ASSERT_TRUE(out.reactions.normal_N[0] < 0 || out.reactions.normal_N[1] < 0);
}

/* The middle wheel alone drags across its rolling direction; the whole body moves there, and it is at its limit. */
static void a_contact_slips_across_by_its_own_drag(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.4, 0, 0), 1e-3, 0, 0, 0);
    plant.friction.wheel[1].drag = REAL(0.5);
    for (int i = 0; i < 3; i++) {
        laconic_friction_wheel *w = &plant.friction.wheel[i];
        for (int k = 0; k < 3; k++) w->along[k] = w->across[k] = REAL(0);
        w->along[0] = w->across[1] = 1;
        plant.slip.grip_N[i][1] = plant.friction.axle[i].friction_coefficient * plant.slip.normal_N[i];
    }
    plant.state.zeta[1].value = 2;
    const laconic_outputs out = outputs_with(&plant, &input);
    for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(out.friction.contact_state[i] == REAL(i == 1));
}

/* A wheel that spins on the spot slips along its rolling direction alone. */
static void a_wheel_that_spins_slips_along(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.4, 0, 0), 1e-3, 0, 0, 0);
    plant.slip.wheel_speed_rad_per_s[1] = 5;
    plant.friction.wheel[1].rim_across = 0;
    plant.slip.grip_N[1][0] = plant.friction.axle[1].friction_coefficient * plant.slip.normal_N[1];
    const laconic_outputs out = outputs_with(&plant, &input);
    for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(out.friction.contact_state[i] == REAL(i == 1));
}

/* A contact at its limit slips; one that misses the limit's square by more than eight times the tolerance does not, as
 * where the smooth law moves slowly. Of the border itself each digit counts. */
static void a_contact_slips_within_eight_tolerances_of_its_limit(void) {
    const laconic_input input = no_input();
    for (int k = 0; k < 40; k++) {
        laconic_plant plant = started(robotino(0.3, 1, 0), 1e-3, 0, 0, 0);
        plant.state.zeta[1].value = 2;
        plant.slip.normal_N[0] = REAL(30 + 0.7 * k);
        const laconic_real limit = plant.friction.axle[0].friction_coefficient * plant.slip.normal_N[0];
        const laconic_real border = limit * limit * (1 - 8 * LACONIC_RANK_TOLERANCE);
        for (int n = -8; n <= 8; n++) {
            const laconic_real grip = REAL(sqrt((double)border)) * (1 + REAL(n) * LACONIC_EPSILON / 2);
            plant.slip.grip_N[0][0] = grip;
            const laconic_outputs out = outputs_with(&plant, &input);
            TEST_ASSERT_TRUE(out.friction.contact_state[0] == REAL(grip * grip >= border));
        }
        for (int half = 0; half < 2; half++) { /* half a tolerance to either side */
            const double short_by = (half == 0 ? 7.5 : 8.5) * (double)LACONIC_RANK_TOLERANCE;
            plant.slip.grip_N[0][0] = REAL((double)limit * sqrt(1 - short_by));
            TEST_ASSERT_TRUE(outputs_with(&plant, &input).friction.contact_state[0] == REAL(half == 0));
        }
    }
}

/* Constants of wheels that it has not are no numbers: nothing is computed of them. */
static void what_lies_beyond_the_last_wheel_is_not_read(void) {
    const laconic_real nu[3] = {2, -1, REAL(0.7)};
    laconic_input input = no_input();
    laconic_plant plant = started(with_drive(robotino(0.3, 0.5, 0.05)), 1e-3, 8, 4, 0);
    input.voltage_V[0] = 5;
    plant.slip.wheel_speed_rad_per_s[1] = 3;
    laconic_plant beside = plant;
    memset(&beside.friction.wheel[3], 0xFF, sizeof beside.friction.wheel[3]);
    memset(&beside.friction.axle[3], 0xFF, sizeof beside.friction.axle[3]);
    beside.slip.wheel_speed_rad_per_s[3] = NOT_A_NUMBER;
    input.voltage_V[3] = input.axle_torque_Nm[3] = NOT_A_NUMBER;
    for (int step = 0; step < 5; step++) {
        laconic_rates rates[2];
        laconic_real wheel_rate[2][LACONIC_MAX_WHEELS];
        memset(rates, 0, sizeof rates);
        memset(wheel_rate, 0, sizeof wheel_rate);
        for (int k = 0; k < 2; k++) {
            laconic_plant *of = k == 0 ? &plant : &beside;
            laconic_friction_derivative(&rates[k], wheel_rate[k], &of->friction, &of->model, nu, REAL(0.3),
                                        of->slip.wheel_speed_rad_per_s, &input);
            ASSERT_STATUS(LACONIC_OK, laconic_plant_run(of, &input, 1, &why));
        }
        TEST_ASSERT_EQUAL_MEMORY(&rates[0], &rates[1], sizeof rates[0]);
        TEST_ASSERT_EQUAL_MEMORY(wheel_rate[0], wheel_rate[1], sizeof wheel_rate[0]);
        TEST_ASSERT_EQUAL_MEMORY(&plant.state, &beside.state, sizeof plant.state);
        TEST_ASSERT_EQUAL_MEMORY(plant.slip.grip_N, beside.slip.grip_N, 3 * sizeof plant.slip.grip_N[0]);
    }
}

/* M v' = F + Σ of the wheels' forces, along u and along u turned by −90°. */
static void the_reactions_move_the_body(void) {
    laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.3, 0.5, 0.05), 1e-4, 8, 4, 0);
    input.body_force_N[0] = 3;
    run(&plant, &input, 1);
    const laconic_outputs out = outputs_with(&plant, &input);
    double force[2] = {3, 0};
    const double start[2] = {8, 4};
    for (int i = 0; i < 3; i++) {
        const laconic_real *u = plant.friction.axle[i].pull;
        force[0] += (double)(out.reactions.along_N[i] * u[0] + out.reactions.lateral_N[i] * u[1]);
        force[1] += (double)(out.reactions.along_N[i] * u[1] - out.reactions.lateral_N[i] * u[0]);
    }
    for (int k = 0; k < 2; k++)
        ASSERT_NEAR(EITHER(1e-6, 0.5), force[k], 20 * 0.04 * ((double)plant.state.zeta[k].value - start[k]) / 1e-4);
    TEST_ASSERT_TRUE((double)out.reactions.no_slip_margin_N < 1e-3);
}

static void a_brake_holds_its_wheel_against_motor_and_ground(void) {
    laconic_vehicle v = with_drive(robotino(0.4, 0, 0));
    laconic_input input = no_input();
    v.wheel[0].locked = true;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[0] = 4;
    input.axle_torque_Nm[0] = 1;
    run(&plant, &input, 1);
    const laconic_outputs out = outputs_with(&plant, &input);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 3, out.wheel_torque_Nm[0]);
    ASSERT_NEAR(EITHER(1e-6, 1e-3), -3 + 0.04 * (double)out.reactions.along_N[0], out.reactions.brake_Nm[0]);
    v.drive.supply_V = 6;
    plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[1] = 20;
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 3, outputs_with(&plant, &input).wheel_torque_Nm[1]);
}

static void outputs_are_those_of_the_wheels_own_states(void) {
    laconic_input input = no_input();
    laconic_vehicle v = with_drive(robotino(0.4, 0.3, 0.02));
    v.drive.supply_V = 12;
    v.drive.supply_resistance_ohm = REAL(0.1);
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[0] = 30;
    run(&plant, &input, 100);
    const laconic_outputs out = outputs_with(&plant, &input);
    TEST_ASSERT_TRUE(out.wheel_speed_rad_per_s[0] == plant.slip.wheel_speed_rad_per_s[0]);
    TEST_ASSERT_TRUE(out.wheel_angle_rad[0] == plant.slip.wheel_angle_rad[0].value);
    TEST_ASSERT_TRUE(out.friction.drive_limit[0] == REAL(LACONIC_LIMIT_VOLTAGE) && out.friction.drive_limit[1] == 0);
    TEST_ASSERT_TRUE(out.friction.supply_voltage_V < 12 && out.friction.supply_current_A > 0);
    ASSERT_NEAR(EITHER(1e-3, 1e-3), 12 - 0.1 * (double)out.friction.supply_current_A, out.friction.supply_voltage_V);
    TEST_ASSERT_TRUE((double)out.energy_J == kinetic_J(&plant));
}

/* The smooth law integrated by small Euler steps goes where the friction step goes. */
static void the_smooth_law_follows_the_friction_step(void) {
    laconic_vehicle v = with_drive(robotino(0.4, 0.5, 0.05));
    laconic_input input = no_input();
    v.wheel[2].locked = true;
    v.com_z_m = REAL(0.05);
    const double h = 2e-5;
    laconic_plant plant = started(v, h, 6, 2, 4);
    laconic_real nu[3] = {6, 2, 4}, speed[3], heading = 0;
    double x = 0;
    input.voltage_V[0] = 5;
    input.axle_torque_Nm[1] = REAL(0.2);
    for (int i = 0; i < 3; i++) speed[i] = plant.slip.wheel_speed_rad_per_s[i];
    for (int n = 0; n < 5000; n++) {
        laconic_rates rates;
        laconic_real wheel_rate[3];
        laconic_friction_derivative(&rates, wheel_rate, &plant.friction, &plant.model, nu, heading, speed, &input);
        for (int k = 0; k < 3; k++) nu[k] += REAL(h) * rates.nu_rad_per_s2[k];
        for (int k = 0; k < 3; k++) speed[k] += REAL(h) * wheel_rate[k];
        heading += REAL(h) * rates.yaw_rate_rad_per_s;
        x += h * (double)rates.x_m_per_s;
        TEST_ASSERT_TRUE(rates.wheel_speed_rad_per_s[2] == 0);
    }
    run(&plant, &input, 5000);
    for (int k = 0; k < 3; k++) ASSERT_NEAR(0.15, plant.state.zeta[k].value, nu[k]);
    ASSERT_NEAR(1e-3, plant.state.x_m.value, x);
}

/* Where wheels slip fast, forces of the smooth law are those of the friction step, and so is what the motors draw. */
static void the_smooth_laws_outputs_are_those_of_the_friction_step(void) {
    for (int supplied = 0; supplied < 2; supplied++) {
        laconic_vehicle v = with_drive(robotino(0.1, supplied ? 0.5 : 0, 0));
        laconic_input input = no_input();
        v.drive.supply_V = supplied ? 24 : 0;
        laconic_plant plant = started(v, 1e-5, 0, 0, 0);
        for (int i = 0; i < 3; i++) plant.slip.wheel_speed_rad_per_s[i] = 40;
        input.voltage_V[0] = 30;
        run(&plant, &input, 1);
        laconic_slip smooth = plant.slip;
        laconic_slip_smooth(&smooth, &plant.friction, &plant.state, &input);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 2; k++) ASSERT_NEAR(0.02, plant.slip.grip_N[i][k], smooth.grip_N[i][k]);
        for (int i = 0; i < 3; i++) ASSERT_NEAR(EITHER(1e-9, 1e-3), plant.slip.current_A[i], smooth.current_A[i]);
        ASSERT_NEAR(EITHER(1e-9, 1e-3), plant.slip.supply_current_A, smooth.supply_current_A);
        TEST_ASSERT_TRUE(smooth.limit[0] == (supplied ? LACONIC_LIMIT_VOLTAGE : LACONIC_LIMIT_NONE));
        TEST_ASSERT_TRUE((double)smooth.supply_voltage_V == (supplied ? 24 : 0));
    }
}

/* What is not known of the windings, the motors' losses hold: the supply gives more than the motion has. */
static void without_a_winding_resistance_the_supply_still_gives_energy(void) {
    laconic_vehicle v = with_motors(mecanum());
    laconic_input input = no_input();
    v.ground.friction_coefficient = REAL(0.5);
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(2);
    laconic_plant plant = started(v, 0.005, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 100, &why));
    TEST_ASSERT_TRUE(laconic_plant_energy_J(&plant) > 0);
    TEST_ASSERT_TRUE(plant.slip.supply_energy_J.value > laconic_plant_energy_J(&plant));
    TEST_ASSERT_TRUE(plant.slip.motor_loss_J.value > 0);
}

/* Of a motion that is no number; and if it is only one wheel's load, whatever the margins of the wheels after it. */
static void a_load_that_is_no_number_leaves_no_margin(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.4, 0.3, 0), 1e-3, 0, 0, 0);
    laconic_state state = plant.state;
    state.zeta[1].value = NOT_A_NUMBER;
    laconic_slip_smooth(&plant.slip, &plant.friction, &state, &input);
    TEST_ASSERT_TRUE(isnan(outputs_with(&plant, &input).reactions.no_slip_margin_N));
    for (int i = 0; i < 3; i++) {
        plant = started(robotino(0.4, 0.3, 0), 1e-3, 0, 0, 0);
        TEST_ASSERT_TRUE(outputs_with(&plant, &input).reactions.no_slip_margin_N > 1);
        plant.slip.normal_N[i] = NOT_A_NUMBER;
        TEST_ASSERT_TRUE(isnan(outputs_with(&plant, &input).reactions.no_slip_margin_N));
    }
}

/* Points are wheels and supports: of these only the load is written. */
static void what_lies_beyond_the_last_point_is_not_written(void) {
    const laconic_input input = no_input();
    for (int supports = 0; supports < 2; supports++) {
        laconic_vehicle v = with_drive(robotino(0.4, 0.3, 0));
        v.support_count = supports;
        laconic_plant plant = started(v, 1e-3, 2, 1, 0);
        laconic_slip *s = &plant.slip;
        laconic_reactions reactions;
        s->current_A[3] = s->grip_N[3][0] = s->grip_N[3][1] = s->normal_N[3] = s->normal_N[4] = 7;
        s->limit[3] = 7;
        laconic_slip_smooth(s, &plant.friction, &plant.state, &input);
        TEST_ASSERT_TRUE(s->current_A[3] == 7 && s->grip_N[3][0] == 7 && s->grip_N[3][1] == 7 && s->normal_N[4] == 7);
        TEST_ASSERT_TRUE((s->normal_N[3] == 7) == (supports == 0));
        TEST_ASSERT_EQUAL_INT(7, s->limit[3]);
        memset(&reactions, 0, sizeof reactions);
        laconic_plant_reactions(&reactions, &plant, NULL, &input);
        TEST_ASSERT_TRUE(reactions.normal_N[2] > 0 && (reactions.normal_N[3] > 0) == (supports == 1));
        TEST_ASSERT_TRUE(reactions.normal_N[4] == 0);
    }
}

static void without_brakes_no_brake_has_a_torque(void) {
    const laconic_input input = no_input();
    const laconic_plant plant = started(robotino(0.4, 0.3, 0), 1e-3, 2, 1, 0);
    laconic_reactions reactions;
    memset(&reactions, 0xFF, sizeof reactions);
    laconic_plant_reactions(&reactions, &plant, NULL, &input);
    for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(reactions.brake_Nm[i] == 0);
}

/* A supply of half a volt drives, and is cut, as any other. */
static void a_supply_of_less_than_a_volt_is_one(void) {
    laconic_vehicle v = with_drive(robotino(0.5, 0, 0));
    laconic_input input = no_input();
    v.drive.supply_V = REAL(0.5);
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[0] = 20;
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 0.25, outputs_with(&plant, &input).wheel_torque_Nm[0]);
    laconic_slip_smooth(&plant.slip, &plant.friction, &plant.state, &input);
    TEST_ASSERT_TRUE(plant.slip.supply_voltage_V == REAL(0.5));
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 0.25, plant.slip.supply_current_A);
}

/* A contact that slips and carries just nothing is at its limit: none. */
static void a_contact_that_slips_without_a_load_slips(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(skid(0.3), 1e-3, 0, 2, 0);
    TEST_ASSERT_TRUE(outputs_with(&plant, &input).friction.contact_state[0] == 0);
    plant.slip.normal_N[0] = 0;
    TEST_ASSERT_TRUE(outputs_with(&plant, &input).friction.contact_state[0] == 1);
}

/* Rollers that drag push across; once those of a wheel are free, what they pushed before is no part of its margin. */
static void free_rollers_leave_the_margin_to_the_force_along_them(void) {
    const laconic_input input = no_input();
    laconic_plant dragging = started(robotino(0.4, 0.5, 0), 1e-3, 8, 4, 0);
    run(&dragging, &input, 5);
    for (int all = 1; all < 8; all++) {
        laconic_plant plant = dragging;
        double least = HUGE_VAL;
        for (int i = 0; i < 3; i++) {
            const bool is_free = all >> i & 1;
            const double along = (double)plant.slip.grip_N[i][0], across = (double)plant.slip.grip_N[i][1];
            if (is_free) plant.friction.wheel[i].drag = 0;
            TEST_ASSERT_TRUE(fabs(across) > 1);
            least = fmin(least, 0.4 * (double)plant.slip.normal_N[i] - hypot(along, is_free ? 0 : across));
        }
        ASSERT_NEAR(EITHER(1e-12, 1e-5), least, outputs_with(&plant, &input).reactions.no_slip_margin_N);
    }
}

/* Moments of the loads about S hold the ground's force, which acts com_z below; across the rollers the law's force is
 * that along them times k times their slips' ratio. */
static void loads_of_the_smooth_law_hold_the_forces_that_they_make(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.4, 0.5, 0), 1e-3, 8, 20, 0);
    for (int i = 0; i < 3; i++) plant.slip.wheel_speed_rad_per_s[i] = REAL(9 - 6 * i);
    laconic_slip_smooth(&plant.slip, &plant.friction, &plant.state, &input);
    const laconic_outputs out = outputs_with(&plant, &input);
    double weight = 0, moment[2] = {0, 0}, force[2] = {0, 0};
    for (int i = 0; i < 3; i++) {
        const laconic_real *u = plant.friction.axle[i].pull, *grip = plant.slip.grip_N[i];
        const double load = (double)plant.slip.normal_N[i];
        weight += load;
        moment[0] += load * (double)plant.vehicle.wheel[i].x_m;
        moment[1] += load * (double)plant.vehicle.wheel[i].y_m;
        force[0] += (double)(out.reactions.along_N[i] * u[0] + out.reactions.lateral_N[i] * u[1]);
        force[1] += (double)(out.reactions.along_N[i] * u[1] - out.reactions.lateral_N[i] * u[0]);
        ASSERT_NEAR(1e-3, 0.4 * load, hypot((double)grip[0], (double)grip[1]));
        ASSERT_NEAR(1e-3,
                    (double)grip[0] * 0.5 * (double)out.friction.slip_across_m_per_s[i] /
                        (double)out.friction.slip_along_m_per_s[i],
                    grip[1]);
    }
    ASSERT_NEAR(EITHER(1e-9, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2, weight);
    TEST_ASSERT_TRUE(fabs(force[0]) > 10 && fabs(force[1]) > 10);
    for (int k = 0; k < 2; k++) ASSERT_NEAR(1e-3, -0.1 * force[k], moment[k]);
}

/* The ground's force, whatever the rollers make of it, turns the wheel by its part along the rolling direction. */
static void a_brake_holds_a_wheel_with_oblique_rollers_that_drag(void) {
    laconic_vehicle v = robotino(0.4, 0.5, 0);
    laconic_input input = no_input();
    for (int i = 0; i < 3; i++) v.wheel[i].roller_rad = REAL(PI / 4);
    v.wheel[1].locked = true;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.body_force_N[1] = 60;
    run(&plant, &input, 20);
    const laconic_outputs out = outputs_with(&plant, &input);
    const laconic_real *u = plant.friction.axle[1].pull, along = out.reactions.along_N[1];
    const laconic_real aside = out.reactions.lateral_N[1];
    const double force[2] = {(double)(along * u[0] + aside * u[1]), (double)(along * u[1] - aside * u[0])};
    TEST_ASSERT_TRUE(fabs((double)aside) > 1);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), -0.04 * force[1], out.reactions.brake_Nm[1]); /* its axle is along −x */
}

static void outputs_do_not_hang_on_those_before(void) {
    laconic_vehicle v = with_drive(robotino(0.4, 0.3, 0.02));
    laconic_input input = no_input();
    v.drive.supply_V = 12;
    v.drive.supply_resistance_ohm = REAL(0.1);
    v.drive.current_limit_A = 2;
    v.wheel[2].locked = true;
    laconic_plant plant = started(v, 1e-3, 5, 1, 2);
    input.voltage_V[0] = 10;
    input.body_force_N[1] = 30;
    run(&plant, &input, 20);
    const laconic_outputs once = outputs_with(&plant, &input);
    laconic_outputs again = once;
    laconic_outputs_of(&again, &plant, &input);
    laconic_plant_reactions(&again.reactions, &plant, NULL, &input);
    TEST_ASSERT_EQUAL_MEMORY(&once, &again, sizeof once);
    TEST_ASSERT_TRUE(again.friction.motor_loss_J > 0 && again.friction.supply_loss_J > 0);
    TEST_ASSERT_TRUE(again.friction.axle_loss_J > 0 && again.friction.slip_loss_J > 0);
}

/* On ice, by the smooth law, whatever stood in the rates before. */
static void a_torque_on_an_axle_speeds_up_its_wheel_alone(void) {
    const laconic_plant plant = started(robotino(1e-9, 0.3, 0), 1e-3, 0, 0, 0);
    const laconic_real nu[3] = {1, 2, 3}, speed[LACONIC_MAX_WHEELS] = {0};
    laconic_input input = no_input();
    laconic_real wheel_rate[LACONIC_MAX_WHEELS];
    laconic_rates rates;
    input.axle_torque_Nm[1] = REAL(0.6);
    memset(&rates, 0xFF, sizeof rates);
    memset(wheel_rate, 0xFF, sizeof wheel_rate);
    laconic_friction_derivative(&rates, wheel_rate, &plant.friction, &plant.model, nu, REAL(0.5), speed, &input);
    for (int i = 0; i < 3; i++) ASSERT_NEAR(1e-3, i == 1 ? 0.6 / 0.003 : 0, wheel_rate[i]);
    ASSERT_NEAR(1e-6, 3 * 0.04 * sqrt(20 / 0.7), rates.yaw_rate_rad_per_s);
    ASSERT_NEAR(1e-6, 0.04 * (cos(0.5) - 2 * sin(0.5)), rates.x_m_per_s);
    ASSERT_NEAR(1e-6, 0.04 * (sin(0.5) + 2 * cos(0.5)), rates.y_m_per_s);
}

/* A plant is plain data, and outputs are of any: a slip that is no number is none. */
static void a_contact_whose_slip_is_no_number_does_not_slip(void) {
    const laconic_input input = no_input();
    laconic_plant plant = started(robotino(0.4, 0, 0), 1e-3, 0, 0, 0);
    plant.slip.wheel_speed_rad_per_s[1] = NOT_A_NUMBER;
    plant.slip.grip_N[1][0] = plant.friction.axle[1].friction_coefficient * plant.slip.normal_N[1];
    TEST_ASSERT_TRUE(outputs_with(&plant, &input).friction.contact_state[1] == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(contacts_that_slip_stick_and_lift_are_told_apart);
    RUN_TEST(a_contact_slips_across_by_its_own_drag);
    RUN_TEST(a_wheel_that_spins_slips_along);
    RUN_TEST(a_contact_slips_within_eight_tolerances_of_its_limit);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_not_read);
    RUN_TEST(the_reactions_move_the_body);
    RUN_TEST(a_brake_holds_its_wheel_against_motor_and_ground);
    RUN_TEST(outputs_are_those_of_the_wheels_own_states);
    RUN_TEST(the_smooth_law_follows_the_friction_step);
    RUN_TEST(the_smooth_laws_outputs_are_those_of_the_friction_step);
    RUN_TEST(without_a_winding_resistance_the_supply_still_gives_energy);
    RUN_TEST(a_load_that_is_no_number_leaves_no_margin);
    RUN_TEST(what_lies_beyond_the_last_point_is_not_written);
    RUN_TEST(without_brakes_no_brake_has_a_torque);
    RUN_TEST(a_supply_of_less_than_a_volt_is_one);
    RUN_TEST(a_contact_that_slips_without_a_load_slips);
    RUN_TEST(free_rollers_leave_the_margin_to_the_force_along_them);
    RUN_TEST(loads_of_the_smooth_law_hold_the_forces_that_they_make);
    RUN_TEST(a_brake_holds_a_wheel_with_oblique_rollers_that_drag);
    RUN_TEST(outputs_do_not_hang_on_those_before);
    RUN_TEST(a_torque_on_an_axle_speeds_up_its_wheel_alone);
    RUN_TEST(a_contact_whose_slip_is_no_number_does_not_slip);
    return UNITY_END();
}
