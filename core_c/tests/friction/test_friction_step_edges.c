/* Tests of friction_step.c where a step nearly fails: parts of a step, ends of the range, doubtful energy. */
#include "friction_vehicle.h"

#include "slipping.h"

#define PARTS_STEP_S 1e-3
#define STRONG_DAMPING 320.0

/* A torque whose impulse has a square beyond the range of the scalar type, against a strong damping: the
 * solver refuses the whole step, and takes its halves; of 2.3 times as much its quarters, of 4.5 times its eighths. */
static laconic_plant pushed_beyond_range(laconic_input *input, double times) {
    laconic_vehicle v = robotino(0.5, 0.3, 0);
    v.motor_damping_Nms = REAL(STRONG_DAMPING);
    *input = no_input();
    input->axle_torque_Nm[1] = REAL(times) * EITHER(REAL(5e155), REAL(7e20));
    return started(v, PARTS_STEP_S, 1, 0, 0);
}

/* The wheel follows J s' = T − c s by that many backward Euler steps: nothing else counts beside such a torque. */
static void a_step_that_the_solver_refuses_is_taken_in_parts(void) {
    const double times[3] = {1, 2.3, 4.5}, inertia = 0.003;
    for (int k = 0; k < 3; k++) {
        laconic_input input;
        laconic_plant plant = pushed_beyond_range(&input, times[k]);
        const double parts = 2 << k, h = PARTS_STEP_S / parts;
        const double last = (double)input.axle_torque_Nm[1] / STRONG_DAMPING;
        double speed = 0, angle = 0; /* over those of the speed that it tends to */
        for (int part = 0; part < parts; part++) {
            const double before = speed;
            speed = (speed + h * STRONG_DAMPING / inertia) / (1 + h * STRONG_DAMPING / inertia);
            angle += 0.5 * (before + speed) / parts;
        }
        run(&plant, &input, 1);
        TEST_ASSERT_EQUAL_UINT64(1, plant.steps);
        TEST_ASSERT_TRUE(plant.state.x_m.value > 0); /* the body went on, too */
        ASSERT_NEAR(EITHER(1e-12, 1e-6), speed, (double)plant.slip.wheel_speed_rad_per_s[1] / last);
        ASSERT_NEAR(EITHER(1e-12, 1e-6), angle, (double)plant.slip.wheel_angle_rad[1].value / (last * PARTS_STEP_S));
    }
}

/* Sixteen parts would do, eight do not. */
static void a_step_that_the_solver_refuses_in_all_parts_changes_nothing(void) {
    const double times[2] = {9, 100};
    for (int k = 0; k < 2; k++) {
        laconic_input input;
        laconic_plant plant = pushed_beyond_range(&input, times[k]);
        const laconic_plant before = plant;
        ASSERT_REFUSED(LACONIC_STEP_UNSOLVED, LACONIC_FIELD_STEP, 0, laconic_plant_run(&plant, &input, 1, &why), why);
        TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof before.state);
        TEST_ASSERT_EQUAL_MEMORY(&before.slip, &plant.slip, sizeof before.slip);
    }
}

/* Any two numbers of an input: each is finite, their sum is not. */
static void inputs_that_leave_the_range_together_are_refused(void) {
    laconic_plant plant = started(robotino(0.5, 0, 0), 1e-3, 0, 0, 0);
    const laconic_plant before = plant;
    for (int first = 0; first < 10; first++)
        for (int second = 0; second < first; second++) {
            laconic_input input = no_input();
            laconic_real *numbers[10] = {&input.body_force_N[0],        &input.body_force_N[1],
                                         &input.body_moment_Nm,         &input.world_force_N[0],
                                         &input.world_force_N[1],       &input.world_force_point_m[0],
                                         &input.world_force_point_m[1], &input.voltage_V[0],
                                         &input.axle_torque_Nm[0],      &input.axle_torque_Nm[2]};
            *numbers[first] = *numbers[second] = REAL(0.6) * LACONIC_REAL_MAX;
            ASSERT_STATUS(LACONIC_OVERFLOW,
                          laconic_friction_step(&plant.friction, &plant.model, plant.integrator.step_s, &plant.state,
                                                &plant.slip, &input));
        }
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof before);
}

/* A body that turned to some heading: a push along the world's x or y moves it there. */
static void a_world_force_along_either_axis_turns_with_the_heading(void) {
    for (int axis = 0; axis < 2; axis++) {
        const laconic_vehicle v = robotino(1e-9, 0, 0);
        laconic_start start = start_with(0, 0, 0);
        laconic_input input = no_input();
        laconic_plant plant;
        memset(&plant, 0, sizeof plant);
        start.heading_rad = REAL(0.7);
        input.world_force_N[axis] = 40;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-2), &start, &why));
        run(&plant, &input, 1);
        const double change = 40 / 20.0 * 1e-2 / 0.04; /* F h/(M R) */
        ASSERT_NEAR(1e-6, change * (axis == 0 ? cos(0.7) : sin(0.7)), plant.state.zeta[0].value);
        ASSERT_NEAR(1e-6, change * (axis == 0 ? -sin(0.7) : cos(0.7)), plant.state.zeta[1].value);
    }
}

/* Its contact has four times the vehicle's arm. */
static void the_brake_of_a_large_wheel_holds_what_its_contact_can_give(void) {
    for (int i = 0; i < 3; i++) {
        for (int oblique = -1; oblique <= 1; oblique++) {
            laconic_vehicle v = robotino(0.5, 0.3, 0);
            laconic_input input = no_input();
            v.wheel[i].locked = true;
            v.wheel[i].own_radius_m = REAL(0.16);
            if (oblique != 0) v.wheel[i].roller_rad = REAL(0.3 * oblique);
            laconic_plant plant = started(v, 0.1, 0, 0, 0);
            input.body_force_N[1] = 300;
            run(&plant, &input, 3);
            TEST_ASSERT_TRUE(outputs_with(&plant, &input).friction.contact_state[i] == 1);
            TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[i] == 0);
        }
    }
}

/* Constants of a wheel that is not there are no numbers. */
static void a_brake_of_the_only_wheel_asks_no_other(void) {
    laconic_vehicle v = caster();
    const laconic_input input = no_input();
    v.ground.friction_coefficient = REAL(0.5);
    v.wheel[0].locked = true;
    laconic_plant plant = started(v, 1e-3, 0, 2, 0);
    plant.friction.wheel[1].inertia = NOT_A_NUMBER;
    run(&plant, &input, 3);
    TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[0] == 0);
}

/* As long as it stays there, nothing is wrong with it. */
static void a_body_at_the_end_of_the_range_of_speeds_is_stepped(void) {
    const laconic_input coasting = no_input();
    laconic_plant plant = started(robotino(1e-9, 0, 0), EITHER(1e-80, 1e-12), (double)LARGEST_SPEED, 0, 0);
    run(&plant, &coasting, 1);
    TEST_ASSERT_TRUE(plant.state.zeta[0].value == LARGEST_SPEED);
}

/* Steps in which contacts take more than the slope's pull would give along the mean velocity, but not twice as much. */
static void what_contacts_take_counts_as_it_is_where_the_motion_reverses_on_a_slope(void) {
    static const struct {
        double mu, drag, slope, heading, step_s, nu[3];
    } scenes[] = {
        {0.206, 0.841, 0.187, -0.0786, 0.44, {5.025, -2.535, -1.817}},
        {0.794, 0.525, 0.301, 0.827, 0.174, {0.7552, 0.8863, -0.241}},
        {1.2, 0.614, 0.75, -0.945, 0.00669, {0.3895, -0.1556, 0.06829}},
        {0.98, 0.847, 0.631, 2.07, 0.487, {-8.287, 9.419, 3.689}},
    };
    const laconic_input coasting = no_input();
    for (size_t n = 0; n < sizeof scenes / sizeof scenes[0]; n++) {
        laconic_vehicle v = robotino(scenes[n].mu, scenes[n].drag, 0);
        v.com_z_m = 0;
        v.ground.slope_rad = REAL(scenes[n].slope);
        v.ground.slope_heading_rad = REAL(scenes[n].heading);
        laconic_plant plant = started(v, scenes[n].step_s, scenes[n].nu[0], scenes[n].nu[1], scenes[n].nu[2]);
        const double before = kinetic_J(&plant) + potential_J(&plant);
        run(&plant, &coasting, 1);
        TEST_ASSERT_TRUE(kinetic_J(&plant) + potential_J(&plant) < before);
    }
}

/* A step that takes so little time that it hardly turns; one in even less, with all speeds as much smaller, goes the
 * same way by the square of that, since what counts as growth is a matter of proportions. */
static void a_motion_that_reverses_on_a_slope_goes_the_same_way_however_slow(void) {
    const laconic_input coasting = no_input();
    double way[2];
    for (int slow = 0; slow < 2; slow++) {
        const double times = slow ? EITHER(1e-14, 1e-6) : EITHER(1e-6, 1e-3);
        laconic_vehicle v = robotino(0.794, 0.525, 0);
        v.com_z_m = 0;
        v.ground.slope_rad = REAL(0.301);
        v.ground.slope_heading_rad = REAL(0.827);
        laconic_plant plant = started(v, 0.174 * times, 0.7552 * times, 0.8863 * times, -0.241 * times);
        const double before = kinetic_J(&plant) + potential_J(&plant);
        run(&plant, &coasting, 1);
        TEST_ASSERT_TRUE(kinetic_J(&plant) + potential_J(&plant) < before);
        way[slow] = (double)plant.state.x_m.value / (times * times);
    }
    ASSERT_NEAR(EITHER(1e-12, 1e-5) * fabs(way[0]), way[0], way[1]);
}

/* Uphill, where it comes to rest: what grows has no square, so that nothing grows, and the mean velocity is taken. */
static void a_motion_too_slow_to_be_squared_goes_by_its_mean(void) {
    const laconic_input coasting = no_input();
    const double speed = EITHER(1e-180, 1e-27), step_s = 0.25;
    laconic_vehicle v = robotino(0.8, 0.5, 0);
    v.ground.slope_rad = REAL(0.1);
    laconic_plant plant = started(v, step_s, speed, 0, 0);
    run(&plant, &coasting, 1);
    TEST_ASSERT_TRUE(plant.state.zeta[0].value == 0);
    ASSERT_NEAR(0.01, 1, (double)plant.state.x_m.value / (0.5 * step_s * 0.04 * speed));
}

/* A body that slides on its only wheel and turns across the slope: by its mean velocity it would gain, over speed and
 * pull, 1.005 of GROWTH_IN_DOUBT in the last of these steps, and from the other heading 0.995 of it. */
static void what_grows_by_more_than_is_in_doubt_goes_by_the_velocity_at_the_end(void) {
    const laconic_input coasting = no_input();
    const double times = EITHER(1, 200), step_s = 1.7e-4 * times;
    const double heading[2] = {EITHER(-0.0613, -0.2587), EITHER(-0.0608, -0.2571)};
    for (int in_doubt = 0; in_doubt < 2; in_doubt++) {
        laconic_vehicle v = {0};
        laconic_start start = start_with(0.00085 * times, 0.006 * times, 0.00384 * times);
        laconic_plant plant;
        v.mass_kg = REAL(9.5);
        v.yaw_inertia_kgm2 = REAL(4.4);
        v.wheel_radius_m = REAL(0.8);
        v.wheel_inertia_kgm2 = REAL(0.34);
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 1.9, 0, 0, PI / 2);
        v.ground.friction_coefficient = REAL(0.05);
        v.ground.axle_friction_Nm = 250;
        v.ground.slope_rad = REAL(0.0166);
        start.heading_rad = REAL(heading[in_doubt]);
        start.wheel_speed_rad_per_s[0] = REAL(0.011 * times);
        memset(&plant, 0, sizeof plant);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(step_s), &start, &why));
        run(&plant, &coasting, EITHER(24, 33));
        const laconic_plant before = plant;
        run(&plant, &coasting, 1);
        laconic_pose pose;
        laconic_real end[2];
        laconic_pose_of(&pose, &plant.model, &plant.state);
        laconic_body_velocity(&plant.model, &plant.state, end);
        const double cosine = cos((double)pose.heading_rad), sine = sin((double)pose.heading_rad);
        const double way = (double)plant.state.x_m.value - (double)before.state.x_m.value;
        const double at_end = step_s * (cosine * (double)end[0] - sine * (double)end[1]);
        if (in_doubt)
            TEST_ASSERT_TRUE(way > 1.01 * at_end);
        else
            ASSERT_NEAR(1e-4 * at_end, at_end, way);
    }
}

/* Metres and radians together have one bound: what one step of so fast a body adds must fit its heading. */
static void a_body_that_goes_further_in_a_step_than_a_heading_can_turn_is_refused(void) {
    const laconic_input coasting = no_input();
    const double step_s = 1e3, turn = 0.04 * sqrt(20 / 0.7); /* R/√(I/M): rad of yaw per rad of zeta */
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2)
            for (int beyond = 0; beyond < 2; beyond++) {
                const double way = sign * (beyond ? 1.2 : 0.8) * (double)LARGEST_YAW_CHANGE_RAD;
                laconic_plant plant = started(robotino(1e-9, 0, 0), step_s, 0, 0, 0);
                plant.state.zeta[axis].value = REAL(way / (step_s * (axis == 2 ? turn : 0.04)));
                ASSERT_NEAR(1e-6, turn, plant.model.yaw_rate_of_zeta[2]);
                const laconic_plant before = plant;
                const laconic_status status = laconic_plant_run(&plant, &coasting, 1, &why);
                ASSERT_STATUS(beyond ? LACONIC_OVERFLOW : LACONIC_OK, status);
                if (beyond) TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof before.state);
            }
}

/* To the last bit: a body that hardly grips anything and goes along, or in single also across while it turns. */
static void the_bound_of_metres_and_radians_is_beyond_what_a_step_may_add(void) {
    const laconic_input coasting = no_input();
    laconic_vehicle v = bare_body();
    v.mass_kg = 16;
    v.yaw_inertia_kgm2 = 1;
    v.wheel_radius_m = REAL(0.0625);
    v.wheel_inertia_kgm2 = REAL(1.0 / 256);
    v.ground.friction_coefficient = REAL(EITHER(1e-250, 1e-30));
    for (int i = 0; i < 3; i++) add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.125 * (i - 1), i == 1 ? 0.125 : 0, i, 1.5);
    for (int beyond = 0; beyond < 2; beyond++) {
        const double along = (double)LARGEST_YAW_CHANGE_RAD / 64 * (beyond ? 1 : 1 - (double)LACONIC_EPSILON);
        laconic_plant plant = started(v, 1024, along, 0, 0);
        ASSERT_STATUS(beyond ? LACONIC_OVERFLOW : LACONIC_OK, laconic_plant_run(&plant, &coasting, 1, &why));
        if (IN_DOUBLE) continue;
        plant = started(v, 1048576, beyond ? 0x1.d09a98p+22 : 0x1.d09a96p+22, 0x1.908p+15, 0x1.61ffdp-14);
        ASSERT_STATUS(beyond ? LACONIC_OVERFLOW : LACONIC_OK, laconic_plant_run(&plant, &coasting, 1, &why));
    }
}

/* A push by a thousandth of the largest speed. */
static void a_body_that_is_pushed_beyond_the_range_of_speeds_is_refused(void) {
    const double step_s = EITHER(1e-80, 1e-12);
    for (int back = 0; back < 2; back++) {
        laconic_input input = no_input();
        laconic_plant plant = started(robotino(1e-9, 0, 0), step_s, (double)LARGEST_SPEED, 0, 0);
        input.body_force_N[0] = REAL((back ? -1e-3 : 1e-3) * (double)LARGEST_SPEED * 20 * 0.04 / step_s);
        ASSERT_STATUS(back ? LACONIC_OK : LACONIC_OVERFLOW, laconic_plant_run(&plant, &input, 1, &why));
    }
}

/* Without R_a the electrical side is the torque that the voltage makes, and the speed. */
static void without_a_winding_resistance_a_motor_takes_what_its_voltage_gives(void) {
    laconic_vehicle v = robotino(0.5, 0.3, 0);
    laconic_input input = no_input();
    v.motor_gain_Nm_per_V = REAL(0.5);
    v.motor_damping_Nms = REAL(0.26);
    laconic_plant plant = started(v, 1e-2, 0, 0, 0);
    input.voltage_V[0] = 5;
    run(&plant, &input, 1);
    const double speed = (double)plant.slip.wheel_speed_rad_per_s[0];
    TEST_ASSERT_TRUE(speed > 1e-3);
    ASSERT_NEAR(EITHER(1e-12, 1e-5) * speed, 1e-2 * 0.5 * 5 * speed, plant.slip.supply_energy_J.value);
}

static void with_one_it_takes_what_its_current_gives_whether_its_bearings_rub_or_not(void) {
    for (int rub = 0; rub < 2; rub++) {
        laconic_vehicle v = with_drive(robotino(0.5, 0.3, 0));
        laconic_input input = no_input();
        if (!rub) v.drive.viscous_friction_Nms = 0;
        laconic_plant plant = started(v, 1e-2, 0, 0, 0);
        input.voltage_V[0] = 5;
        run(&plant, &input, 1);
        const double current = (double)plant.slip.current_A[0];
        TEST_ASSERT_TRUE(current > 1e-3);
        ASSERT_NEAR(EITHER(1e-12, 1e-5) * current, 1e-2 * 5 * current, plant.slip.supply_energy_J.value);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_step_that_the_solver_refuses_is_taken_in_parts);
    RUN_TEST(a_step_that_the_solver_refuses_in_all_parts_changes_nothing);
    RUN_TEST(inputs_that_leave_the_range_together_are_refused);
    RUN_TEST(a_world_force_along_either_axis_turns_with_the_heading);
    RUN_TEST(the_brake_of_a_large_wheel_holds_what_its_contact_can_give);
    RUN_TEST(a_brake_of_the_only_wheel_asks_no_other);
    RUN_TEST(a_body_at_the_end_of_the_range_of_speeds_is_stepped);
    RUN_TEST(what_contacts_take_counts_as_it_is_where_the_motion_reverses_on_a_slope);
    RUN_TEST(a_motion_that_reverses_on_a_slope_goes_the_same_way_however_slow);
    RUN_TEST(a_motion_too_slow_to_be_squared_goes_by_its_mean);
    RUN_TEST(what_grows_by_more_than_is_in_doubt_goes_by_the_velocity_at_the_end);
    RUN_TEST(a_body_that_goes_further_in_a_step_than_a_heading_can_turn_is_refused);
    RUN_TEST(the_bound_of_metres_and_radians_is_beyond_what_a_step_may_add);
    RUN_TEST(a_body_that_is_pushed_beyond_the_range_of_speeds_is_refused);
    RUN_TEST(without_a_winding_resistance_a_motor_takes_what_its_voltage_gives);
    RUN_TEST(with_one_it_takes_what_its_current_gives_whether_its_bearings_rub_or_not);
    return UNITY_END();
}
