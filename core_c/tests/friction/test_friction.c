/* Tests of friction.c, and of plant.c and vehicle.c where a vehicle has friction. */
#include "methods.h"
#include "slipping.h"

static void what_contradicts_itself_is_refused_by_name(void) {
    laconic_vehicle v = robotino(0.5, 1.5, 0);
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_GROUND_ROLLER_DRAG, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0.5, -0.1, 0);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_GROUND_ROLLER_DRAG, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0.5, 0, -1);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_GROUND_AXLE_FRICTION, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(-0.5, 0, 0);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_GROUND_FRICTION_COEFFICIENT, 0, laconic_vehicle_check(&v, &why),
                   why);
    v = robotino(0.5, 0, 0);
    v.friction_coefficient = REAL(0.4);
    ASSERT_REFUSED(LACONIC_FRICTION_TWICE, LACONIC_FIELD_FRICTION_COEFFICIENT, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0, 0.5, 0);
    ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_GROUND_ROLLER_DRAG, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0, 0, 0.5);
    ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_GROUND_AXLE_FRICTION, 0, laconic_vehicle_check(&v, &why),
                   why);
    v = robotino(0, 0, 0);
    v.wheel[1].own_roller_drag = REAL(0.5);
    ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_WHEEL_ROLLER_DRAG, 2, laconic_vehicle_check(&v, &why), why);
    v.wheel[1].own_roller_drag = 0;
    v.wheel[2].own_axle_friction_Nm = REAL(0.5);
    ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_WHEEL_AXLE_FRICTION, 3, laconic_vehicle_check(&v, &why),
                   why);
    v = robotino(0.5, 0, 0);
    v.wheel_inertia_kgm2 = 0;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0, 0, 0);
    v.ground.slope_rad = REAL(1.6);
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_SLOPE, 0, laconic_vehicle_check(&v, &why), why);
    v.ground.slope_rad = REAL(-0.1);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_SLOPE, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0, 0, 0);
    v.drive.supply_V = 12;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_WINDING_RESISTANCE, 0, laconic_vehicle_check(&v, &why), why);
    v.drive.supply_V = 0;
    v.drive.current_limit_A = 3;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_WINDING_RESISTANCE, 0, laconic_vehicle_check(&v, &why), why);
    v = with_drive(robotino(0, 0, 0));
    v.drive.supply_resistance_ohm = 1;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_SUPPLY_VOLTAGE, 0, laconic_vehicle_check(&v, &why), why);
    v = robotino(0, 0, 0);
    v.wheel[1].motor_circuit = 3;
    ASSERT_REFUSED(LACONIC_MOTOR_CIRCUIT_UNKNOWN, LACONIC_FIELD_MOTOR_CIRCUIT, 2, laconic_vehicle_check(&v, &why), why);
    v.wheel[1].motor_circuit = -1;
    ASSERT_REFUSED(LACONIC_MOTOR_CIRCUIT_UNKNOWN, LACONIC_FIELD_MOTOR_CIRCUIT, 2, laconic_vehicle_check(&v, &why), why);
}

static void friction_is_what_a_wheel_a_limit_or_a_circuit_gives(void) {
    laconic_vehicle v = robotino(0, 0, 0);
    TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
    v.wheel[2].own_friction_coefficient = REAL(0.3); /* needs the ground's */
    TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
    ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_WHEEL_FRICTION_COEFFICIENT, 3,
                   laconic_vehicle_check(&v, &why), why);
    v.ground.friction_coefficient = REAL(0.5);
    TEST_ASSERT_TRUE(laconic_vehicle_has_friction(&v));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_vehicle_check(&v, &why));
    v = robotino(0, 0, 0);
    v.wheel[0].motor_circuit = LACONIC_MOTOR_OPEN;
    TEST_ASSERT_TRUE(laconic_vehicle_has_friction(&v));
    v.wheel[0].motor_circuit = -1; /* is no driven motor either; the check refuses it */
    TEST_ASSERT_TRUE(laconic_vehicle_has_friction(&v));
    v = with_drive(robotino(0, 0, 0));
    v.drive.current_limit_A = 1;
    TEST_ASSERT_TRUE(laconic_vehicle_has_friction(&v));
    v.wheel_count = 0;
    TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
    v = robotino(0.5, 0, 0);
    v.wheel_count = 0;
    TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
}

static void only_auto_knows_friction(void) {
    const laconic_vehicle v = robotino(0.5, 0, 0);
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    ASSERT_REFUSED(LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD, 0,
                   laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0.01), &start, &why), why);
    ASSERT_REFUSED(LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0,
                   laconic_plant_start(&plant, &v, NULL, REAL(0.01), &start, &why), why);
    plant = started(v, 0.01, 0, 0, 0);
    const laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_METHOD_WITHOUT_FRICTION, laconic_step(&plant.model, &plant.integrator, &plant.state, &input));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.02), &why));
    TEST_ASSERT_EQUAL_STRING("friction", plant.integrator.chosen->name);
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_plant_set_step(&plant, 0, &why));
}

static void wheels_start_as_they_roll_or_as_they_are_given(void) {
    laconic_plant plant = started(robotino(0.5, 0, 0), 1e-3, 3, 0, 0);
    laconic_model ideal;
    const laconic_vehicle level = robotino(0, 0, 0);
    laconic_real rolling[3];
    laconic_start start = start_with(3, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&ideal, &level, &why));
    const laconic_state state = state_of(&ideal, start);
    laconic_wheel_speeds(&ideal, &state, rolling);
    ASSERT_NEAR_ALL(10 * ROUNDING, rolling, plant.slip.wheel_speed_rad_per_s, 3);
    laconic_vehicle v = robotino(0.5, 0, 0);
    start.heading_rad = REAL(0.7);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    ASSERT_NEAR_ALL(10 * ROUNDING, rolling, plant.slip.wheel_speed_rad_per_s, 3);
    v.wheel[1].locked = true;
    start.wheel_speed_rad_per_s[0] = 7;
    start.wheel_speed_rad_per_s[1] = 9;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[0] == 7 && plant.slip.wheel_speed_rad_per_s[1] == 0);
    start.wheel_speed_rad_per_s[2] = INFINITE;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_START_WHEEL_SPEED, 3,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
    start.wheel_speed_rad_per_s[2] = EITHER(REAL(1e200), REAL(1e30));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_WHEEL_SPEED, 3,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
}

/* Whichever wheel's it is; then those of the others are 0. */
static void the_speed_of_a_single_wheel_is_enough_to_give_all(void) {
    const laconic_vehicle v = robotino(0.5, 0, 0);
    for (int i = 0; i < 3; i++) {
        laconic_start start = start_with(3, 0, 0);
        laconic_plant plant;
        start.wheel_speed_rad_per_s[i] = 7;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
        for (int j = 0; j < 3; j++) TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[j] == REAL(i == j ? 7 : 0));
    }
}

/* Force and moments of the loads balance the weight; each wheel has another load, since S lies beside the middle. */
static void at_the_start_each_wheel_carries_its_part_of_the_weight(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    v.com_x_m = REAL(0.02);
    v.com_y_m = REAL(-0.03);
    const laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    double force_N = 0, pitch_Nm = 0, roll_Nm = 0;
    for (int i = 0; i < 3; i++) {
        const double load_N = (double)plant.slip.normal_N[i];
        force_N += load_N;
        pitch_Nm += load_N * (double)(v.wheel[i].x_m - v.com_x_m);
        roll_Nm += load_N * (double)(v.wheel[i].y_m - v.com_y_m);
    }
    ASSERT_NEAR(EITHER(1e-12, 1e-4), 20 * LACONIC_GRAVITY_M_PER_S2, force_N);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), 0, pitch_Nm);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), 0, roll_Nm);
}

/* Found by fuzzing: 1/R is no number there, and neither was the speed. */
static void a_wheel_of_hardly_any_radius_does_not_roll_beyond_all_numbers(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    const laconic_start start = start_with(3, 1, 0);
    laconic_plant plant;
    v.wheel[1].own_radius_m = LACONIC_REAL_MIN * LACONIC_EPSILON;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_WHEEL_SPEED, 2,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
}

static void a_drive_on_ideal_ground_starts_only_as_its_wheels_allow(void) {
    laconic_vehicle v = with_drive(robotino(0, 0, 0));
    laconic_start start = start_with(0, 3, 0);
    laconic_plant plant;
    v.wheel_count = 0;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0.1, -PI / 2, 0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, -0.1, -PI / 2, 0);
    v.drive.supply_V = 12;
    ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 2,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
    laconic_plant moving = started(v, 1e-3, 3, 0, 1);
    laconic_input input = no_input();
    input.voltage_V[0] = 20;
    run(&moving, &input, 200);
    TEST_ASSERT_TRUE(fabs((double)moving.state.zeta[1].value) < EITHER(1e-8, 1e-3));
    TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_VOLTAGE, moving.slip.limit[0]);
}

static void numbers_too_far_apart_overflow_by_name(void) {
    laconic_vehicle v = with_drive(robotino(0.5, 0, 0));
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    v.com_z_m = v.drive.supply_V = EITHER(REAL(1.3e154), REAL(1.8e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
}

/* A third of the largest number with a finite square: as many are its inertia and its mobility. */
static void a_large_rim_counts_with_both_its_directions_in_the_range(void) {
    const double root = sqrt((double)LACONIC_REAL_MAX), share[2] = {0.3, 0.34};
    for (int refused = 0; refused < 2; refused++) {
        laconic_vehicle v = robotino(0.5, 1, 0);
        const laconic_start start = start_with(0, 0, 0);
        laconic_plant plant;
        v.wheel[1].roller_rad = REAL(0.3);
        v.wheel[1].own_radius_m = REAL(0.04 * share[refused] * root);
        v.wheel[1].own_inertia_kgm2 = REAL(20 * 0.04 * 0.04 * share[refused] * root);
        ASSERT_STATUS(refused ? LACONIC_OVERFLOW : LACONIC_OK,
                      laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    }
}

/* Its contact has two masses across the rollers, of 1/k² each. */
static void rollers_that_hardly_drag_are_taken_up_to_half_the_range(void) {
    const double root = sqrt((double)LACONIC_REAL_MAX), share[2] = {0.4, 0.6};
    for (int refused = 0; refused < 2; refused++) {
        laconic_vehicle v = robotino(0.5, 0, 0);
        const laconic_start start = start_with(0, 0, 0);
        laconic_plant plant;
        v.wheel[1].own_roller_drag = REAL(1 / sqrt(share[refused] * root));
        ASSERT_STATUS(refused ? LACONIC_OVERFLOW : LACONIC_OK,
                      laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    }
}

static void a_change_in_motion_keeps_body_and_wheels(void) {
    laconic_vehicle v = with_drive(robotino(0.5, 0.4, 0.05));
    laconic_plant plant = started(v, 1e-3, 5, 3, 4);
    laconic_input input = no_input();
    input.voltage_V[0] = 6;
    run(&plant, &input, 100);
    const laconic_slip before = plant.slip;
    laconic_real velocity[2], then[2];
    laconic_body_velocity(&plant.model, &plant.state, velocity);
    v.payload.mass_kg = 5;
    v.wheel[1].motor_circuit = LACONIC_MOTOR_OPEN;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
    laconic_body_velocity(&plant.model, &plant.state, then);
    ASSERT_NEAR_ALL(10 * ROUNDING, velocity, then, 2);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant.slip, sizeof before);
    v.wheel_inertia_kgm2 = 0;
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_plant_change(&plant, &v, &why));
}

/* A motor that is switched off in motion on ideal ground, and on again. */
static void wheels_are_taken_over_from_the_ideal_model_and_back(void) {
    laconic_vehicle v = with_drive(robotino(0, 0, 0));
    laconic_plant plant = started(v, 1e-3, 5, 3, 4);
    const laconic_input input = no_input();
    laconic_real speed[3], angle[3], after[3];
    run(&plant, &input, 50);
    laconic_wheel_speeds(&plant.model, &plant.state, speed);
    laconic_wheel_angles(&plant.model, &plant.state, angle);
    v.wheel[0].motor_circuit = LACONIC_MOTOR_OPEN;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
    ASSERT_NEAR_ALL(10 * ROUNDING, speed, plant.slip.wheel_speed_rad_per_s, 3);
    for (int i = 0; i < 3; i++) ASSERT_NEAR(10 * ROUNDING, angle[i], plant.slip.wheel_angle_rad[i].value);
    run(&plant, &input, 50);
    for (int i = 0; i < 3; i++) angle[i] = plant.slip.wheel_angle_rad[i].value;
    for (int i = 0; i < 3; i++) speed[i] = plant.slip.wheel_speed_rad_per_s[i];
    v.wheel[0].motor_circuit = LACONIC_MOTOR_DRIVEN;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
    TEST_ASSERT_FALSE(plant.friction.acts);
    laconic_wheel_speeds(&plant.model, &plant.state, after);
    ASSERT_NEAR_ALL(EITHER(1e-8, 1e-3), speed, after, 3);
    laconic_wheel_angles(&plant.model, &plant.state, after);
    ASSERT_NEAR_ALL(10 * ROUNDING, angle, after, 3);
}

static void the_sampled_step_holds_the_input_of_the_middle(void) {
    laconic_plant held = started(robotino(0.5, 0.2, 0), 1e-3, 1, 2, 3), sampled = held;
    laconic_input three[3] = {no_input(), no_input(), no_input()};
    three[1].body_force_N[0] = 10;
    run(&held, &three[1], 1);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run_sampled(&sampled, three, &why));
    TEST_ASSERT_EQUAL_MEMORY(&held.slip, &sampled.slip, sizeof held.slip);
    three[1].body_force_N[0] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_FORCE, 1, laconic_plant_run_sampled(&sampled, three, &why),
                   why);
}

/* A slope in the ideal model is the downhill force that users gave until now. */
static void a_slope_is_a_downhill_force_and_a_lighter_load(void) {
    laconic_vehicle v = robotino(0, 0, 0);
    laconic_input force = no_input();
    const laconic_input none = no_input();
    laconic_plant level = started(v, 1e-3, 2, 1, 3);
    v.ground.slope_rad = REAL(0.2);
    v.ground.slope_heading_rad = REAL(0.7);
    laconic_plant sloped = started(v, 1e-3, 2, 1, 3);
    const double pull = 20 * LACONIC_GRAVITY_M_PER_S2 * sin(0.2);
    force.world_force_N[0] = REAL(-pull * cos(0.7));
    force.world_force_N[1] = REAL(-pull * sin(0.7));
    laconic_contact on_level, on_slope;
    const laconic_vehicle flat = robotino(0, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&on_level, &flat, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&on_slope, &v, &why));
    laconic_reactions a, b;
    laconic_plant_reactions(&a, &level, &on_level, &force);
    laconic_plant_reactions(&b, &sloped, &on_slope, &none);
    ASSERT_NEAR_ALL(EITHER(1e-11, 1e-3), a.along_N, b.along_N, 3);
    double sum = 0;
    for (int i = 0; i < 3; i++) sum += (double)b.normal_N[i];
    ASSERT_NEAR(EITHER(1e-10, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2 * cos(0.2), sum);
    run(&level, &force, 300);
    run(&sloped, &none, 300);
    for (int k = 0; k < 3; k++) ASSERT_NEAR(EITHER(1e-11, 1e-3), level.state.zeta[k].value, sloped.state.zeta[k].value);
    ASSERT_NEAR(EITHER(1e-11, 1e-4), level.state.x_m.value, sloped.state.x_m.value);
}

/* A wheel without a motor has no current that could reach a limit. */
static void limits_of_current_are_of_wheels_with_motors(void) {
    laconic_vehicle v = with_drive(robotino(0.5, 0.1, 0));
    laconic_input input = no_input();
    v.drive.current_limit_A = 2;
    v.wheel[1].undriven = true;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    for (int i = 0; i < 3; i++) input.voltage_V[i] = 24;
    run(&plant, &input, 20);
    const laconic_outputs out = outputs_with(&plant, &input);
    TEST_ASSERT_TRUE(out.friction.drive_limit[0] == REAL(LACONIC_LIMIT_CURRENT));
    TEST_ASSERT_TRUE(out.friction.drive_limit[1] == 0 && out.friction.motor_current_A[1] == 0);
    ASSERT_NEAR(1e-6, 2, out.friction.motor_current_A[0]);
}

/* Motors with a limit on ideal ground move what the wheels allow, which must be something; so must the start. */
static void a_drive_on_ideal_ground_needs_wheels_that_allow_a_motion(void) {
    laconic_vehicle v = with_drive(skid(0));
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    laconic_slip slip;
    v.drive.supply_V = 24;
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 3,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
    laconic_vehicle movable = v;
    movable.wheel_count = 2;
    plant = started(movable, 1e-3, 0, 0, 0);
    memset(&slip, 3, sizeof slip);
    const laconic_slip before = slip;
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 3,
                   laconic_slip_set(&slip, &plant.friction, &v, &start, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &slip, sizeof slip);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_contradicts_itself_is_refused_by_name);
    RUN_TEST(friction_is_what_a_wheel_a_limit_or_a_circuit_gives);
    RUN_TEST(only_auto_knows_friction);
    RUN_TEST(wheels_start_as_they_roll_or_as_they_are_given);
    RUN_TEST(the_speed_of_a_single_wheel_is_enough_to_give_all);
    RUN_TEST(at_the_start_each_wheel_carries_its_part_of_the_weight);
    RUN_TEST(a_wheel_of_hardly_any_radius_does_not_roll_beyond_all_numbers);
    RUN_TEST(a_drive_on_ideal_ground_starts_only_as_its_wheels_allow);
    RUN_TEST(numbers_too_far_apart_overflow_by_name);
    RUN_TEST(a_large_rim_counts_with_both_its_directions_in_the_range);
    RUN_TEST(rollers_that_hardly_drag_are_taken_up_to_half_the_range);
    RUN_TEST(a_change_in_motion_keeps_body_and_wheels);
    RUN_TEST(wheels_are_taken_over_from_the_ideal_model_and_back);
    RUN_TEST(the_sampled_step_holds_the_input_of_the_middle);
    RUN_TEST(a_slope_is_a_downhill_force_and_a_lighter_load);
    RUN_TEST(limits_of_current_are_of_wheels_with_motors);
    RUN_TEST(a_drive_on_ideal_ground_needs_wheels_that_allow_a_motion);
    return UNITY_END();
}
