/* Tests of friction_step.c: rest, energy, drives and the limits of the friction step. */
#include <stdio.h>

#include "slipping.h"
#include "stack.h"

static void rest_below_breakaway_holds_to_the_last_bit(void) {
    laconic_vehicle v = robotino(0.6, 1, 0.2);
    laconic_input push = no_input();
    v.ground.slope_rad = REAL(0.1);
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    push.body_force_N[0] = 15;
    run(&plant, &push, 20000);
    const laconic_outputs now = outputs_with(&plant, &push);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(plant.state.zeta[k].value == 0);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[k] == 0);
    TEST_ASSERT_TRUE(plant.state.x_m.value == 0 && plant.state.y_m.value == 0);
    TEST_ASSERT_TRUE(plant.state.heading.fraction == 0 && now.energy_J == 0);
}

static void coasting_ends_in_exact_rest(void) {
    const laconic_input none = no_input();
    laconic_plant plant = started(robotino(0.5, 0.5, 0.1), 2e-3, 20, -10, 15);
    run(&plant, &none, 3000);
    TEST_ASSERT_TRUE(kinetic_J(&plant) == 0);
    TEST_ASSERT_TRUE((double)plant.slip.slip_loss_J.value > 0 && (double)plant.slip.axle_loss_J.value > 0);
}

/* Kinetic and potential energy of what no motor drives; and all energies of what one does. */
static void energy_never_grows_on_a_slope_and_its_balance_closes(void) {
    const double slopes[2] = {0.05, 0.5}, drags[3] = {0, 0.4, 1};
    const laconic_input none = no_input();
    for (int k = 0; k < 6; k++) {
        laconic_vehicle v = k % 2 == 0 ? robotino(0.3, drags[k / 2], 0.05) : skid(0.4);
        v.ground.slope_rad = REAL(slopes[k % 2]);
        v.ground.slope_heading_rad = REAL(0.3 * k);
        laconic_plant plant = started(v, 5e-3, 30, 12 - 8 * k, 25);
        const double first = kinetic_J(&plant);
        double before = first + potential_J(&plant), scale = first;
        for (int n = 0; n < 300; n++) {
            run(&plant, &none, 1);
            const double now = kinetic_J(&plant) + potential_J(&plant);
            if (fabs(now) > scale) scale = fabs(now);
            TEST_ASSERT_TRUE(now - before <= (double)EITHER(1e-14, 3e-6) * scale);
            before = now;
        }
        const laconic_slip *s = &plant.slip;
        const double lost = (double)s->slip_loss_J.value + (double)s->axle_loss_J.value +
                            (double)s->motor_loss_J.value + (double)s->numerical_loss_J.value;
        ASSERT_NEAR(EITHER(1e-10, 3e-4) * scale, first + (double)s->outer_work_J.value - lost, kinetic_J(&plant));
    }
}

/* Rollers that hardly drag hold an impulse of former steps, beside which the slip of a step is less than a unit in the
 * last place: single precision took it for sticking, and the impulse went on to push the vehicle. */
static void assert_that_forces_of_former_steps_do_not_push(laconic_plant *plant, const double grip_N[][2]) {
    const laconic_input none = no_input();
    const double first = kinetic_J(plant);
    for (int32_t i = 0; i < 2 * plant->friction.wheel_count; i++)
        plant->slip.grip_N[i / 2][i % 2] = REAL(grip_N[i / 2][i % 2]);
    for (int n = 0; n < 50; n++) {
        const double before = kinetic_J(plant);
        run(plant, &none, 1);
        TEST_ASSERT_TRUE(kinetic_J(plant) <= before + (double)EITHER(1e-14, 1e-6) * first);
    }
}

static void wheels_that_hold_each_other_by_their_rollers_bring_no_energy(void) {
    const double grip_N[4][2] = {{0, -0.372}, {0, 0}, {0, 0.401}, {0, 0}};
    laconic_vehicle v = {0};
    v.mass_kg = REAL(0.49);
    v.yaw_inertia_kgm2 = REAL(0.0465);
    v.wheel_radius_m = REAL(0.0433);
    v.wheel_inertia_kgm2 = REAL(2.24e-6);
    v.ground.friction_coefficient = REAL(1.43);
    v.ground.roller_drag = REAL(3e-4);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.324, 0, 0, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0.324, PI / 2, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, -0.324, 0, PI, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.17, 0.214, -2.45, PI / 2);
    laconic_plant plant = started(v, 3.64e-3, -0.0018, 0.0048, -0.0229);
    assert_that_forces_of_former_steps_do_not_push(&plant, grip_N);
}

static void a_locked_wheel_on_rollers_that_hardly_drag_brings_no_energy(void) {
    const double grip_N[1][2] = {{-0.0191, -108}};
    laconic_vehicle v = {0};
    v.mass_kg = REAL(14.0925124);
    v.yaw_inertia_kgm2 = REAL(2.0620902);
    v.wheel_radius_m = REAL(0.0449423276);
    v.wheel_inertia_kgm2 = REAL(5.4595020e-4);
    v.ground.friction_coefficient = REAL(1.18468025);
    v.ground.roller_drag = REAL(4.54464726e-4);
    v.ground.axle_friction_Nm = REAL(0.366038584);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.430856611, 0, -PI / 2, PI / 4);
    laconic_plant plant = started(v, 1.93654127e-3, -1.0034e-8, 0.0162131924, -0.0143944609);
    plant.slip.wheel_speed_rad_per_s[0] = 0;
    assert_that_forces_of_former_steps_do_not_push(&plant, grip_N);
}

static void the_energy_drawn_from_the_supply_balances(void) {
    laconic_vehicle v = with_drive(robotino(0.8, 0.3, 0.05));
    laconic_input input = no_input();
    v.drive.supply_V = 20;
    v.drive.supply_resistance_ohm = REAL(0.3);
    v.drive.current_limit_A = 4;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[0] = 15;
    input.voltage_V[2] = -30;
    input.axle_torque_Nm[1] = REAL(0.3);
    run(&plant, &input, 800);
    const laconic_slip *s = &plant.slip;
    const double in = (double)s->supply_energy_J.value + (double)s->outer_work_J.value;
    const double lost = (double)s->slip_loss_J.value + (double)s->axle_loss_J.value + (double)s->motor_loss_J.value +
                        (double)s->supply_loss_J.value + (double)s->numerical_loss_J.value;
    TEST_ASSERT_TRUE(in > 10 && (double)s->supply_loss_J.value > 0 && (double)s->supply_voltage_V < 20);
    ASSERT_NEAR(EITHER(1e-10, 1e-4) * in, in, kinetic_J(&plant) + lost);
}

static void at_stall_the_current_is_the_limit(void) {
    laconic_vehicle v = with_drive(robotino(0, 0, 0));
    laconic_input input = no_input();
    v.drive.current_limit_A = 3;
    for (int i = 0; i < 3; i++) input.voltage_V[i] = i == 1 ? REAL(-24) : REAL(24);
    v.mass_kg = REAL(1e9); /* stands still, but for rounding, for a step */
    laconic_plant plant = started(v, 1e-6, 0, 0, 0);
    run(&plant, &input, 1);
    for (int i = 0; i < 3; i++) {
        ASSERT_NEAR(EITHER(3e-12, 3e-6), i == 1 ? -3 : 3, plant.slip.current_A[i]);
        TEST_ASSERT_EQUAL_INT(LACONIC_LIMIT_CURRENT, plant.slip.limit[i]);
    }
}

/* The wheel of an open motor slows down by n² d alone: by e^(−d t/J), to first order in the step. */
static void an_open_motor_keeps_only_its_viscous_friction(void) {
    laconic_vehicle v = with_drive(robotino(1e-9, 0, 0));
    laconic_start start = start_with(0, 0, 0);
    const laconic_input none = no_input();
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    v.wheel[0].motor_circuit = LACONIC_MOTOR_OPEN;
    v.wheel[1].motor_circuit = LACONIC_MOTOR_SHORTED;
    for (int i = 0; i < 3; i++) start.wheel_speed_rad_per_s[i] = 10;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-4), &start, &why));
    run(&plant, &none, 100);
    ASSERT_NEAR(EITHER(1e-5, 1e-4), 10 * pow(1 + 1e-4 * 0.01 / 0.003, -100), plant.slip.wheel_speed_rad_per_s[0]);
    ASSERT_NEAR(EITHER(1e-5, 1e-4), 10 * pow(1 + 1e-4 * 0.26 / 0.003, -100), plant.slip.wheel_speed_rad_per_s[1]);
}

/* μ → ∞ with free rollers is the ideal model: the difference halves with the step. */
static void without_slip_it_tends_to_the_ideal_model_at_first_order(void) {
    double error[3];
    laconic_input input = no_input();
    input.voltage_V[0] = 8;
    input.voltage_V[2] = -5;
    input.world_force_N[1] = 6;
    for (int k = 0; k < 3; k++) {
        const uint64_t steps = (uint64_t)(400 << k);
        laconic_vehicle v = with_drive(robotino(1e6, 0, 0));
        v.com_z_m = 0; /* no wheel lifts */
        laconic_plant slipping = started(v, 0.4 / (double)steps, 3, 2, 4);
        laconic_plant ideal = started(with_drive(robotino(0, 0, 0)), 0.4 / (double)steps, 3, 2, 4);
        run(&slipping, &input, steps);
        run(&ideal, &input, steps);
        laconic_real nu[3];
        laconic_nu(&ideal.model, &ideal.state, nu);
        error[k] = 0;
        for (int c = 0; c < 3; c++) error[k] += fabs((double)slipping.state.zeta[c].value - (double)nu[c]);
    }
    printf("against (4.7) %.3g, %.3g, %.3g at 1, 1/2, 1/4 ms\n", error[0], error[1], error[2]);
    TEST_ASSERT_TRUE(error[0] < 0.1);
    if (IN_DOUBLE) ASSERT_NEAR(0.15, 2, error[0] / error[1]);
    if (IN_DOUBLE) ASSERT_NEAR(0.15, 2, error[1] / error[2]);
}

/* Rollers that do not turn are a tyre, wherever their axes point. */
static void a_fixed_wheel_is_a_roller_wheel_with_full_drag(void) {
    const double angles[2] = {PI / 2, 0.3};
    laconic_input input = no_input();
    laconic_plant fixed = started(skid(0.5), 1e-3, 10, 5, 8);
    input.body_moment_Nm = 12;
    run(&fixed, &input, 200);
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = skid(0.5);
        v.ground.roller_drag = 1;
        for (int i = 0; i < 4; i++) {
            v.wheel[i].kind = LACONIC_WHEEL_ROLLER;
            v.wheel[i].roller_rad = REAL(angles[k]);
        }
        laconic_start start = start_with(10, 5, 8);
        for (int i = 0; i < 4; i++) start.wheel_speed_rad_per_s[i] = REAL(i % 2 == 0 ? 4 : 16);
        laconic_plant a = fixed, b;
        memset(&b, 0, sizeof b);
        const laconic_vehicle tyres = skid(0.5);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&b, &v, &laconic_auto, REAL(1e-3), &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&a, &tyres, &laconic_auto, REAL(1e-3), &start, &why));
        run(&a, &input, 200);
        run(&b, &input, 200);
        for (int c = 0; c < 3; c++) ASSERT_NEAR(EITHER(1e-8, 1e-2), a.state.zeta[c].value, b.state.zeta[c].value);
    }
}

/* Wheels held by strong motors at the speeds for 0.2 m/s: the robot goes less far where rollers drag. */
static void dragging_rollers_shorten_the_way_as_recorded(void) {
    const double expected[2] = {1.68, 1.26};
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = robotino(0.26, 0.87, 0);
        laconic_plant plant;
        v.motor_gain_Nm_per_V = v.motor_damping_Nms = 100;
        v.com_z_m = 0;
        plant = started(v, 1e-3, 0, 0, 0);
        laconic_input input = no_input();
        const laconic_real nu[3] = {k == 0 ? 5 : 0, k == 1 ? 5 : 0, 0};
        for (int i = 0; i < 3; i++) {
            input.voltage_V[i] = 0;
            for (int c = 0; c < 3; c++) input.voltage_V[i] += plant.friction.wheel[i].along[c] * nu[c];
        }
        run(&plant, &input, 1500);
        const double speed = (double)plant.state.zeta[k].value;
        ASSERT_NEAR(0.02, expected[k], 5 / speed);
    }
}

static void four_fixed_wheels_turn_by_slipping(void) {
    laconic_vehicle v = with_drive(skid(0.5));
    laconic_input input = no_input();
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    for (int i = 0; i < 4; i++) input.voltage_V[i] = i % 2 == 0 ? REAL(-20) : REAL(20);
    run(&plant, &input, 1000);
    TEST_ASSERT_TRUE((double)plant.state.zeta[2].value > 1);
    TEST_ASSERT_TRUE((double)plant.slip.slip_loss_J.value > 1);
    laconic_start start = start_with(0, 0, 0);
    v.ground.friction_coefficient = 0;
    ASSERT_REFUSED(LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, 3,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
    v.wheel[3].axle_rad = 0;
    v.wheel[2].axle_rad = REAL(0.7);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 4,
                   laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
}

static void a_step_that_cannot_be_taken_changes_nothing(void) {
    laconic_plant plant = started(robotino(0.5, 0.5, 0), 1e-3, 1, 2, 3);
    laconic_input input = no_input();
    run(&plant, &input, 5);
    const laconic_plant before = plant;
    input.voltage_V[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_VOLTAGE, 2, laconic_plant_run(&plant, &input, 1, &why), why);
    input = no_input();
    input.body_force_N[0] = LACONIC_REAL_MAX;
    TEST_ASSERT_TRUE(laconic_plant_run(&plant, &input, 1, &why) != LACONIC_OK);
    plant.state.heading.turns = before.state.heading.turns;
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof before.state);
    TEST_ASSERT_EQUAL_MEMORY(&before.slip, &plant.slip, sizeof before.slip);
    plant.state.heading.turns = INT64_MAX;
    input = no_input();
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, laconic_plant_run(&plant, &input, 1, &why), why);
}

/* A push so strong that the pose would leave its range, at a speed that is still allowed. */
static void a_step_too_far_is_refused(void) {
    laconic_plant plant = started(robotino(0.5, 0, 0), 1e9, 0, 0, 0);
    laconic_input input = no_input();
    input.body_moment_Nm = EITHER(REAL(1e9), REAL(1e4));
    TEST_ASSERT_TRUE(laconic_plant_run(&plant, &input, 1, &why) != LACONIC_OK);
    TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
}

static void a_locked_wheel_does_not_turn(void) {
    laconic_vehicle v = robotino(0.5, 0.3, 0);
    laconic_input input = no_input();
    v.wheel[1].locked = true;
    laconic_plant plant = started(v, 1e-3, 5, 5, 5);
    input.axle_torque_Nm[1] = 2;
    run(&plant, &input, 50);
    TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[1] == 0);
    TEST_ASSERT_TRUE(plant.slip.wheel_angle_rad[1].value == 0);
}

/* A wheel that rolls in a curve on a slope loses nothing to the ground: only the slope's pull may give it energy. */
static void a_wheel_that_rolls_in_a_curve_on_a_slope_gains_no_energy(void) {
    const laconic_input none = no_input();
    laconic_vehicle v = skid(2);
    v.wheel_count = 1;
    v.ground.slope_rad = REAL(0.3);
    laconic_plant plant = started(v, 2e-3, 3, 0, 8);
    double before = kinetic_J(&plant), largest = before;
    for (int n = 0; n < 500; n++) {
        run(&plant, &none, 1);
        const double now = kinetic_J(&plant) + potential_J(&plant);
        largest = fmax(largest, kinetic_J(&plant));
        TEST_ASSERT_TRUE(now - before <= (double)EITHER(1e-12, 3e-5) * largest);
        before = now;
    }
}

/* Motors with a limit on ideal ground: a brake takes a motion away, as it does in the model without limits. */
static void a_locked_wheel_on_ideal_ground_does_not_turn(void) {
    laconic_vehicle v = with_drive(robotino(0, 0, 0));
    laconic_input input = no_input();
    v.drive.current_limit_A = 3;
    v.wheel[1].locked = true;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    for (int i = 0; i < 3; i++) input.voltage_V[i] = 24;
    run(&plant, &input, 500);
    TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[1] == 0 && plant.slip.wheel_angle_rad[1].value == 0);
    TEST_ASSERT_TRUE(kinetic_J(&plant) > 0.1);
    laconic_real rolling = 0;
    for (int k = 0; k < 3; k++) rolling += plant.friction.wheel[1].along[k] * plant.state.zeta[k].value;
    ASSERT_NEAR(EITHER(1e-9, 1e-3), 0, rolling);
}

static void a_push_out_of_the_range_is_refused(double step_s, laconic_real force_N) {
    laconic_plant plant = started(robotino(0.5, 0, 0), step_s, 0, 0, 0);
    const laconic_plant before = plant;
    laconic_input input = no_input();
    input.body_force_N[0] = force_N;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, laconic_plant_run(&plant, &input, 1, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof before.state);
    TEST_ASSERT_EQUAL_MEMORY(&before.slip, &plant.slip, sizeof before.slip);
}

/* The solver can still be right about it, a state could not. */
static void a_speed_beyond_the_range_is_refused(void) {
    a_push_out_of_the_range_is_refused(1e-3, EITHER(REAL(1e90), REAL(1e15)));
    a_push_out_of_the_range_is_refused(EITHER(1e-66, 1e-5), EITHER(REAL(1e144), REAL(1e15)));
}

static void a_displacement_beyond_the_range_is_refused(void) {
    a_push_out_of_the_range_is_refused(EITHER(1e9, 1e8), EITHER(REAL(1e9), REAL(1)));
}

/* Nothing brakes this body, so its displacement is that of the mean velocity: x = ½ g sin α t², whatever the step. What
 * rounding makes of the energy's growth is not taken for a growth. */
static void a_body_that_only_slides_falls_as_a_stone_does(void) {
    const double h = 0.01, slope = 0.3, seconds = 2;
    const laconic_input none = no_input();
    for (int k = 0; k < 8; k++) {
        laconic_vehicle v = robotino(1e-20, 0, 0);
        v.ground.slope_rad = REAL(slope);
        v.ground.slope_heading_rad = REAL(0.7 * k);
        laconic_plant plant = started(v, h, 0, 0, 0);
        run(&plant, &none, (uint64_t)(seconds / h + 0.5));
        const double fallen = 0.5 * LACONIC_GRAVITY_M_PER_S2 * sin(slope) * seconds * seconds;
        ASSERT_NEAR(EITHER(1e-9, 1e-3), -fallen * cos(0.7 * k), plant.state.x_m.value);
        ASSERT_NEAR(EITHER(1e-9, 1e-3), -fallen * sin(0.7 * k), plant.state.y_m.value);
    }
}

static void what_stood_in_memory_before_a_step_does_not_matter(void) {
    laconic_input input = no_input();
    laconic_plant plant = started(with_drive(robotino(0.3, 0.5, 0.05)), 1e-3, 2, 1, 0), other = plant;
    input.voltage_V[1] = 4;
    for (int step = 0; step < 20; step++) {
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
        fill_stack(ALL_NAN);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&other, &input, 1, &why));
        TEST_ASSERT_EQUAL_MEMORY(&plant.state, &other.state, sizeof plant.state);
        TEST_ASSERT_EQUAL_MEMORY(&plant.slip, &other.slip, sizeof plant.slip);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(rest_below_breakaway_holds_to_the_last_bit);
    RUN_TEST(coasting_ends_in_exact_rest);
    RUN_TEST(energy_never_grows_on_a_slope_and_its_balance_closes);
    RUN_TEST(wheels_that_hold_each_other_by_their_rollers_bring_no_energy);
    RUN_TEST(a_locked_wheel_on_rollers_that_hardly_drag_brings_no_energy);
    RUN_TEST(the_energy_drawn_from_the_supply_balances);
    RUN_TEST(at_stall_the_current_is_the_limit);
    RUN_TEST(an_open_motor_keeps_only_its_viscous_friction);
    RUN_TEST(without_slip_it_tends_to_the_ideal_model_at_first_order);
    RUN_TEST(a_fixed_wheel_is_a_roller_wheel_with_full_drag);
    RUN_TEST(dragging_rollers_shorten_the_way_as_recorded);
    RUN_TEST(four_fixed_wheels_turn_by_slipping);
    RUN_TEST(a_step_that_cannot_be_taken_changes_nothing);
    RUN_TEST(a_step_too_far_is_refused);
    RUN_TEST(a_locked_wheel_does_not_turn);
    RUN_TEST(a_wheel_that_rolls_in_a_curve_on_a_slope_gains_no_energy);
    RUN_TEST(a_locked_wheel_on_ideal_ground_does_not_turn);
    RUN_TEST(a_speed_beyond_the_range_is_refused);
    RUN_TEST(a_displacement_beyond_the_range_is_refused);
    RUN_TEST(a_body_that_only_slides_falls_as_a_stone_does);
    RUN_TEST(what_stood_in_memory_before_a_step_does_not_matter);
    return UNITY_END();
}
