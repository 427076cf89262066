/* Tests of the step of a tree: limits to other models, hinges, drives, energy, rest, refusals. */
#include "slipping_trees.h"

static double largest(double a, double b) { return fabs(a) > fabs(b) ? fabs(a) : fabs(b); }

/* --------------------------------------------------------------------------- limits to other models -- */

/* Pose is by the mean of velocities here and along the arc there: the same at first order. */
static void without_hinges_it_is_the_friction_step_of_rigid_vehicles(void) {
    laconic_tree_vehicle v = tree_rigid();
    v.hinged.base.com_z_m = REAL(0.12);
    v.hinged.base.com_x_m = REAL(0.03);
    v.hinged.base.payload.mass_kg = 4;
    v.hinged.base.payload.x_m = REAL(0.1);
    v.hinged.base.wheel[1].kind = LACONIC_WHEEL_ROLLER;
    v.hinged.base.wheel[1].roller_rad = REAL(PI / 4);
    v.hinged.base.wheel[1].own_roller_drag = REAL(0.4);
    v.hinged.base.wheel[3].locked = true;
    v.hinged.base.drive.winding_resistance_ohm = 1;
    v.hinged.base.drive.supply_V = 9;
    v.hinged.base.drive.supply_resistance_ohm = REAL(0.05);
    v.hinged.base.drive.current_limit_A = 7;
    const laconic_tree_model m = tree_model(v);
    laconic_plant plant;
    laconic_start rigid;
    laconic_tree_start start = tree_start_at(0.6, -0.2, 0.5);
    laconic_tree_input in = tree_nothing();
    memset(&rigid, 0, sizeof rigid);
    memset(&plant, 0, sizeof plant);
    laconic_model of_body; /* ν of these velocities */
    TREE_TAKEN(laconic_prepare(&of_body, &v.hinged.base, &tree_why));
    rigid.nu_rad_per_s[0] = REAL(0.6 / 0.08);
    rigid.nu_rad_per_s[1] = REAL(-0.2 / 0.08);
    rigid.nu_rad_per_s[2] = REAL(0.5) * of_body.yaw_scale;
    TREE_TAKEN(laconic_plant_start(&plant, &v.hinged.base, &laconic_auto, REAL(0.001), &rigid, &tree_why));
    laconic_tree_state s = tree_state(&m, &start);
    for (int i = 0; i < 4; i++) in.hinged.base.voltage_V[i] = REAL(i < 3 ? 12 : -3);
    in.hinged.base.body_force_N[1] = 5;
    tree_run(&m, &s, &in, 0.001, 400);
    for (int k = 0; k < 400; k++)
        TREE_TAKEN(laconic_friction_step(&plant.friction, &plant.model, REAL(0.001), &plant.state, &plant.slip,
                                         &in.hinged.base));
    for (int i = 0; i < 4; i++) {
        ASSERT_NEAR(EITHER(1e-8, 0.02), plant.slip.wheel_speed_rad_per_s[i], s.wheel_speed_rad_per_s[i]);
        ASSERT_NEAR(EITHER(1e-6, 0.2), plant.slip.normal_N[i], s.normal_N[i]);
        ASSERT_NEAR(EITHER(1e-7, 0.01), plant.slip.current_A[i], s.current_A[i]);
        TEST_ASSERT_EQUAL(plant.slip.limit[i], s.limit[i]);
    }
    ASSERT_NEAR(EITHER(1e-8, 0.01), plant.slip.supply_voltage_V, s.supply_voltage_V);
    ASSERT_NEAR(EITHER(1e-8, 1e-3), laconic_friction_energy_J(&plant.friction, &plant.state, &plant.slip),
                tree_outputs(&m, &s).motion.energy_J);
    ASSERT_NEAR(EITHER(1e-7, 0.1), plant.slip.supply_energy_J.value, s.supply_energy_J.value);
    ASSERT_NEAR(EITHER(1e-7, 0.1), plant.slip.slip_loss_J.value, s.slip_loss_J.value);
    ASSERT_NEAR(EITHER(1e-7, 0.1), plant.slip.motor_loss_J.value, s.motor_loss_J.value);
    ASSERT_NEAR(1e-4, plant.state.x_m.value, s.x_m.value);
    ASSERT_NEAR(1e-4, plant.state.y_m.value, s.y_m.value);
}

/* A prescribed hinge at rate 0 is one rigid body. */
static void a_held_hinge_is_a_rigid_body(void) {
    laconic_tree_vehicle v = tree_rigid(), merged = tree_rigid();
    const int b = tree_body(&v, 0, -0.2, 0.1, 6, 0.2, -0.1, 0.05);
    v.hinged.body[b - 1].hinge = LACONIC_HINGE_PRESCRIBED;
    const double x = -0.3 / 7, y = 0.15 / 7; /* of the common centre of mass: 36 kg at 0, 6 kg at (−0.3, 0.15) */
    merged.hinged.base.mass_kg = 42;
    merged.hinged.base.com_x_m = REAL(x);
    merged.hinged.base.com_y_m = REAL(y);
    merged.hinged.base.yaw_inertia_kgm2 = REAL(2.2 + 0.2 + 36.0 * 6 / 42 * (0.3 * 0.3 + 0.15 * 0.15));
    for (int i = 0; i < 4; i++) v.wheel[i].load_N = merged.wheel[i].load_N = 100;
    const laconic_tree_model a = tree_model(v), c = tree_model(merged);
    const double w = 0.8;
    laconic_tree_start one = tree_start_at(0.5, 0.3, w), other = tree_start_at(0.5 - w * y, 0.3 + w * x, w);
    laconic_tree_state p = tree_state(&a, &one), q = tree_state(&c, &other);
    laconic_tree_input in = tree_nothing();
    for (int i = 0; i < 4; i++) in.hinged.base.voltage_V[i] = REAL(3 + i);
    tree_run(&a, &p, &in, 0.001, 300);
    tree_run(&c, &q, &in, 0.001, 300);
    ASSERT_NEAR(EITHER(1e-9, 1e-3), q.z[2], p.z[2]);
    ASSERT_NEAR(EITHER(1e-9, 1e-3), q.z[0] + q.z[2] * REAL(y), p.z[0]);
    ASSERT_NEAR(EITHER(1e-9, 1e-3), q.z[1] - q.z[2] * REAL(x), p.z[1]);
    for (int i = 0; i < 4; i++)
        ASSERT_NEAR(EITHER(1e-8, 1e-2), q.wheel_speed_rad_per_s[i], p.wheel_speed_rad_per_s[i]);
}

/* ------------------------------------------------------------------------------------------- hinges -- */

static void a_prescribed_hinge_turns_as_commanded_with_or_without_mass(void) {
    for (int massless = 0; massless < 2; massless++) {
        laconic_tree_vehicle v = tree_casters();
        v.hinged.body[0].hinge = LACONIC_HINGE_PRESCRIBED;
        if (massless) v.hinged.body[0].mass_kg = v.hinged.body[0].yaw_inertia_kgm2 = 0;
        const laconic_tree_model m = tree_model(v);
        const laconic_tree_start start = tree_start_at(0, 0, 0);
        laconic_tree_state s = tree_state(&m, &start);
        laconic_tree_input in = tree_nothing();
        in.hinged.hinge_rate_rad_per_s[0] = REAL(1.5);
        in.hinged.base.voltage_V[0] = 4;
        tree_run(&m, &s, &in, 0.001, 500);
        ASSERT_NEAR(EITHER(1e-9, 1e-3), 1.5, s.z[3]);
        ASSERT_NEAR(EITHER(1e-9, 1e-4), 1.5 * 0.4995, tree_outputs(&m, &s).motion.hinge_angle_rad[0]);
    }
}

static void a_stop_is_plastic_and_is_not_passed(void) {
    laconic_tree_vehicle v = tree_loader();
    tree_servo(&v, 1, 0, 0, 0);
    v.hinge[0].dry_friction_Nm = 0;
    const laconic_tree_model m = tree_model(v);
    laconic_tree_start start = tree_start_at(0, 0, 0);
    start.hinged.hinge_rate_rad_per_s[0] = 2;
    laconic_tree_state s = tree_state(&m, &start);
    const laconic_tree_input in = tree_nothing();
    laconic_tree_input pushed = tree_nothing();
    double most = 0;
    pushed.hinged.hinge_torque_Nm[0] = 9000;
    for (int k = 0; k < 1500; k++) {
        tree_run(&m, &s, k < 100 ? &in : &pushed, 0.001, 1);
        most = fmax(most, (double)tree_outputs(&m, &s).motion.hinge_angle_rad[0]);
    }
    TEST_ASSERT_TRUE(most <= 0.7 + EITHER(1e-9, 1e-5));
    ASSERT_NEAR(EITHER(1e-6, 1e-3), 0.7, most);
    TEST_ASSERT_TRUE(tree_outputs(&m, &s).stop_torque_Nm[0] < -1000);
    TEST_ASSERT_TRUE(s.stop_loss_J.value > 0);
}

static void a_limited_servo_gives_its_limit_and_reports_it(void) {
    const laconic_tree_model m = tree_model(tree_swerve());
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    in.hinge_angle_rad[0] = 1;
    tree_run(&m, &s, &in, 0.001, 3);
    laconic_tree_outputs out = tree_outputs(&m, &s);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 3, out.hinge_torque_Nm[0]);
    TEST_ASSERT_EQUAL(LACONIC_LIMIT_CURRENT, out.drive_limit[4]);
    tree_run(&m, &s, &in, 0.001, 2000);
    out = tree_outputs(&m, &s);
    TEST_ASSERT_EQUAL(LACONIC_LIMIT_NONE, out.drive_limit[4]);
    TEST_ASSERT_TRUE(fabs((double)out.motion.hinge_angle_rad[0] - 1) <= 0.05 / 60 + 1e-6); /* dry friction holds it */
}

/* Slow sampling holds its torque, which a fast one nearly is. */
static void a_sampled_servo_looks_at_its_own_rate(void) {
    laconic_tree_vehicle v = tree_swerve();
    v.hinge[0].control_period_s = REAL(0.02);
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    in.hinge_angle_rad[0] = REAL(0.02);
    double torque = 0;
    int changes = 0;
    for (int k = 0; k < 100; k++) {
        tree_run(&m, &s, &in, 0.001, 1);
        const double now = (double)tree_outputs(&m, &s).hinge_torque_Nm[0];
        changes += now < torque || now > torque;
        torque = now;
    }
    TEST_ASSERT_EQUAL(5, changes);
    ASSERT_STATUS(LACONIC_STEP_DOES_NOT_FIT, laconic_tree_step(&m, REAL(0.0030001), &s, &in, &tree_why));
    TEST_ASSERT_EQUAL((laconic_field)LACONIC_FIELD_OF_CONTROL_PERIOD, tree_why.field);
    TEST_ASSERT_EQUAL(1, tree_why.item);
}

/* ------------------------------------------------------------------------------------------- drives -- */

static laconic_tree_vehicle steered_by_motors(void) {
    laconic_tree_vehicle v = tree_swerve();
    v.hinged.base.drive.supply_V = 24;
    v.hinged.base.drive.supply_resistance_ohm = REAL(0.02);
    v.hinged.base.drive.winding_resistance_ohm = 1;
    for (int b = 0; b < 4; b++) {
        tree_servo(&v, b + 1, 0, 0, 0);
        v.hinged.body[b].hinge = LACONIC_HINGE_MOTOR;
        v.hinged.body[b].gain_Nm_per_V = REAL(0.5);
        v.hinged.body[b].damping_Nms = REAL(0.3);
        v.hinge[b].viscous_friction_Nms = REAL(0.02);
        v.hinge[b].winding_resistance_ohm = 2;
        v.hinge[b].current_limit_A = 4;
        v.hinge[b].loop_V_per_rad = 80;
        v.hinge[b].loop_Vs_per_rad = 1;
        v.hinge[b].control_period_s = REAL(0.002);
    }
    return v;
}

static void steering_motors_share_the_supply_and_keep_their_limits(void) {
    const laconic_tree_model m = tree_model(steered_by_motors());
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    for (int k = 0; k < 4; k++) {
        in.hinge_angle_rad[k] = REAL(0.5);
        in.hinged.base.voltage_V[k] = 12;
    }
    tree_run(&m, &s, &in, 0.001, 3);
    laconic_tree_outputs out = tree_outputs(&m, &s);
    ASSERT_NEAR(EITHER(1e-9, 1e-4), 4, out.motor_current_A[4]);
    ASSERT_NEAR(EITHER(1e-9, 1e-4), 4 * 0.5 * 2, out.hinge_torque_Nm[0]); /* c1 R_a per ampere */
    TEST_ASSERT_EQUAL(LACONIC_LIMIT_CURRENT, out.drive_limit[4]);
    ASSERT_NEAR(0.1, 24 - 0.02 * (double)out.supply_current_A, out.supply_voltage_V); /* of the step before */
    TEST_ASSERT_TRUE(out.supply_voltage_V < REAL(23.5));
    tree_run(&m, &s, &in, 0.001, 1500);
    out = tree_outputs(&m, &s);
    for (int b = 0; b < 4; b++) ASSERT_NEAR(0.01, 0.5, out.motion.hinge_angle_rad[b]);
}

static void a_hinge_motor_without_loop_follows_its_voltage(void) {
    laconic_tree_vehicle v = steered_by_motors();
    v.hinge[0].loop_V_per_rad = v.hinge[0].loop_Vs_per_rad = v.hinge[0].control_period_s = 0;
    v.hinge[0].dry_friction_Nm = 0;
    v.hinged.body[0].damping_Nms = REAL(0.3);
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    in.hinged.hinge_voltage_V[0] = 2;
    tree_run(&m, &s, &in, 0.001, 1000);
    TEST_ASSERT_TRUE(fabs((double)s.z[3] - 2 * 0.5 / 0.3) < 0.7); /* c1 U/c2, less what the ground takes */
}

/* ------------------------------------------------------------------------------------- energy, scrub -- */

static double books_off(const laconic_tree_outputs *o, double start) {
    const double in = (double)(o->supply_energy_J + o->outer_work_J + o->servo_work_J);
    const double out = (double)(o->slip_loss_J + o->scrub_loss_J + o->axle_loss_J + o->hinge_loss_J + o->stop_loss_J +
                                o->motor_loss_J + o->supply_loss_J + o->numerical_loss_J);
    return (double)(o->motion.energy_J + o->spring_energy_J) - start - (in - out);
}

static void the_books_close_with_motors_slope_springs_and_scrub(void) {
    laconic_tree_vehicle v = steered_by_motors();
    v.hinged.base.ground.slope_rad = REAL(0.1);
    v.hinged.base.ground.slope_heading_rad = REAL(0.7);
    v.hinged.body[1].stiffness_Nm = 20;
    v.hinged.body[1].rest_rad = REAL(0.2);
    v.hinge[2].stop_low_rad = REAL(-0.3);
    v.hinge[2].stop_high_rad = REAL(0.3);
    for (int i = 0; i < 4; i++) {
        v.wheel[i].scrub_radius_m = REAL(0.01);
        v.wheel[i].scrub_fade_m = REAL(i < 2 ? 0.1 : 0);
    }
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0.5, 0.2, 0.4);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_outputs out = tree_outputs(&m, &s);
    const double before = (double)(out.motion.energy_J + out.spring_energy_J);
    laconic_tree_input in = tree_nothing();
    for (int k = 0; k < 4; k++) in.hinged.base.voltage_V[k] = REAL(10 - 4 * k);
    in.hinge_angle_rad[2] = REAL(0.6);
    in.hinged.hinge_torque_Nm[0] = REAL(0.3);
    in.hinged.base.world_force_N[0] = 8;
    in.hinged.base.world_force_point_m[1] = REAL(0.2);
    tree_run(&m, &s, &in, 0.001, 800);
    out = tree_outputs(&m, &s);
    TEST_ASSERT_TRUE(fabs(books_off(&out, before)) < EITHER(1e-9, 5e-2));
    TEST_ASSERT_TRUE(out.scrub_loss_J > 0 && out.slip_loss_J > 0 && out.hinge_loss_J > 0 && out.motor_loss_J > 0);
}

/* A module that is turned on the spot: its wheel resists with μ N a, and less once it rolls. */
static void scrub_resists_turning_and_fades_when_the_wheel_rolls(void) {
    laconic_tree_vehicle v = tree_swerve();
    for (int k = 0; k < 4; k++) {
        tree_servo(&v, k + 1, 0, 0, 0);
        v.hinge[k].dry_friction_Nm = v.hinged.body[k].damping_Nms = 0;
        v.hinged.body[k].com_x_m = 0;
        v.wheel[k].load_N = 80;
        v.wheel[k].scrub_radius_m = REAL(0.02);
        v.wheel[k].scrub_fade_m = REAL(0.05);
    }
    const laconic_tree_model m = tree_model(v);
    laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    const double bound = 0.8 * 80 * 0.02;
    in.hinged.hinge_torque_Nm[0] = REAL(0.9 * bound);
    tree_run(&m, &s, &in, 0.001, 100);
    TEST_ASSERT_TRUE(s.z[3] == 0);
    in.hinged.hinge_torque_Nm[0] = REAL(1.2 * bound);
    tree_run(&m, &s, &in, 0.001, 100);
    ASSERT_NEAR(EITHER(1e-9, 1e-4), -bound, tree_outputs(&m, &s).scrub_Nm[0]);
    start = tree_start_at(1, 0, 0);
    s = tree_state(&m, &start);
    in.hinged.hinge_torque_Nm[0] = REAL(0.1);
    tree_run(&m, &s, &in, 0.001, 1);
    const double turning = (double)s.z[3], speed = 1; /* torque = μ N a ρ_s ψ'/v while the path's radius is large */
    ASSERT_NEAR(0.02, bound * 0.05 * turning / speed, -(double)tree_outputs(&m, &s).scrub_Nm[0]);
}

/* ----------------------------------------------------------------------------- rest, bits, refusals -- */

static void rest_stays_rest_to_the_last_bit(void) {
    const laconic_tree_model m = tree_model(tree_casters());
    const laconic_tree_start start = tree_start_at(0.5, 0, 0.8);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    in.hinged.base.body_force_N[1] = 3;
    tree_run(&m, &s, &in, 0.001, 15000);
    const laconic_tree_state before = s;
    for (int k = 0; k < 5; k++) TEST_ASSERT_TRUE(s.z[k] == 0);
    tree_run(&m, &s, &in, 0.001, LONG_RUN(100000));
    TEST_ASSERT_EQUAL_MEMORY(&before.x_m, &s.x_m, sizeof s.x_m);
    TEST_ASSERT_EQUAL_MEMORY(&before.heading, &s.heading, sizeof s.heading);
    TEST_ASSERT_EQUAL_MEMORY(before.hinge, s.hinge, sizeof s.hinge);
    for (int k = 0; k < 5; k++) TEST_ASSERT_TRUE(s.z[k] == 0);
}

static void a_caster_robot_that_reverses_flips_its_casters(void) {
    const laconic_tree_model m = tree_model(tree_casters());
    laconic_tree_start start = tree_start_at(0, 0, 0);
    start.hinged.hinge_angle_rad[0] = REAL(0.3);
    start.hinged.hinge_angle_rad[1] = REAL(-0.2);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_input in = tree_nothing();
    in.hinged.base.voltage_V[0] = -8;
    in.hinged.base.voltage_V[1] = -6;
    tree_run(&m, &s, &in, 0.001, 3000);
    const laconic_tree_outputs out = tree_outputs(&m, &s);
    for (int b = 0; b < 2; b++) {
        const double turned = fabs(remainder((double)out.motion.hinge_angle_rad[b], 2 * PI));
        ASSERT_NEAR(0.3, PI, turned);
    }
}

static void a_trailer_jackknifes_where_the_cars_rear_wheels_lock(void) {
    laconic_tree_vehicle v = tree_trailer(0.2);
    double angle[2];
    for (int brake = 0; brake < 2; brake++) {
        for (int i = 2; i < 4; i++) v.hinged.base.wheel[i].locked = brake == 1;
        const laconic_tree_model m = tree_model(v);
        laconic_tree_start start = tree_start_at(15, 0.1, 0.05);
        laconic_tree_state s = tree_state(&m, &start);
        const laconic_tree_input in = tree_nothing();
        tree_run(&m, &s, &in, 0.002, 1500);
        angle[brake] = fabs((double)tree_outputs(&m, &s).motion.hinge_angle_rad[0]);
    }
    TEST_ASSERT_TRUE(angle[0] < 0.1 && angle[1] > 0.5);
}

/* Chains: bodies on bodies on bodies. */
static void a_chain_of_trailers_keeps_its_books_and_comes_to_rest(void) {
    laconic_tree_vehicle v = tree_casters();
    int on = 0;
    for (int k = 0; k < 4; k++) {
        on = tree_body(&v, on, k == 0 ? -0.3 : -0.5, 0, 5, 0.1, -0.3, 0);
        v.hinge[on - 1].hitch = true;
        v.hinge[on - 1].dry_friction_Nm = REAL(0.01);
        tree_wheel(&v, on, -0.4, 0.15, 0.05, 1e-3, 0.01);
        tree_wheel(&v, on, -0.4, -0.15, 0.05, 1e-3, 0.01);
    }
    const laconic_tree_model m = tree_model(v);
    laconic_tree_start start = tree_start_at(0.8, 0, 1);
    for (int k = 0; k < 6; k++) start.hinged.hinge_angle_rad[k] = REAL(0.2 * k - 0.4);
    laconic_tree_state s = tree_state(&m, &start);
    laconic_tree_outputs out = tree_outputs(&m, &s);
    const double before = (double)out.motion.energy_J;
    laconic_tree_input in = tree_nothing();
    double energy = before;
    for (int k = 0; k < 6000; k++) {
        tree_run(&m, &s, &in, 0.001, 1);
        const double now = (double)tree_outputs(&m, &s).motion.energy_J;
        TEST_ASSERT_TRUE(now <= energy);
        energy = now;
    }
    out = tree_outputs(&m, &s);
    TEST_ASSERT_TRUE(fabs(books_off(&out, before)) < EITHER(1e-10, 1e-2) * before);
    TEST_ASSERT_TRUE(energy == 0);
}

static void numbers_that_are_not_finite_are_refused_by_name(void) {
    const laconic_tree_model m = tree_model(tree_swerve());
    const laconic_tree_start start = tree_start_at(0.3, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    const laconic_tree_state before = s;
    laconic_tree_input in = tree_nothing();
    in.hinge_angle_rad[2] = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_tree_step(&m, REAL(0.001), &s, &in, &tree_why));
    TEST_ASSERT_EQUAL((laconic_field)LACONIC_FIELD_OF_HINGE_ANGLE, tree_why.field);
    TEST_ASSERT_EQUAL(3, tree_why.item);
    in = tree_nothing();
    in.hinged.base.voltage_V[1] = INFINITE;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_tree_step(&m, REAL(0.001), &s, &in, &tree_why));
    TEST_ASSERT_EQUAL(LACONIC_FIELD_VOLTAGE, tree_why.field);
    in = tree_nothing();
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_tree_step(&m, 0, &s, &in, &tree_why));
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_tree_step(&m, NOT_A_NUMBER, &s, &in, NULL));
    in.hinged.base.body_force_N[0] = REAL(LACONIC_REAL_MAX);
    TEST_ASSERT_TRUE(laconic_tree_step(&m, REAL(0.001), &s, &in, &tree_why) != LACONIC_OK);
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

/* Passes of warm steps under commands that change every 0.15 s, three times in ten to nothing; none is refused. */
static void warm_steps_take_few_passes(void) {
    const laconic_tree_vehicle vehicles[] = {tree_casters(), tree_loader(), tree_ackermann(), tree_swerve()};
    for (int n = 0; n < 4 && IN_DOUBLE; n++) {
        const laconic_tree_model m = tree_model(vehicles[n]);
        const laconic_tree_start start = tree_start_at(0, 0, 0);
        laconic_tree_state s = tree_state(&m, &start);
        laconic_tree_input in = tree_nothing();
        unsigned long long seed = 77 + (unsigned long long)n;
        int few = 0, some = 0;
        const int steps = LONG_RUN(30000);
        for (int k = 0; k < steps; k++) {
            const double driven = k % 150 == 0 && tree_random(&seed) > -0.4 ? 24 : 0;
            for (int i = 0; k % 150 == 0 && i < 4; i++) in.hinged.base.voltage_V[i] = REAL(driven * tree_gust(&seed));
            for (int b = 0; k % 150 == 0 && b < 4; b++) in.hinge_angle_rad[b] = REAL(0.5 * tree_gust(&seed));
            tree_run(&m, &s, &in, 0.001, 1);
            few += s.passes <= 3;
            some += s.passes <= 6;
        }
        TEST_ASSERT_TRUE(few * 2 >= steps);
        TEST_ASSERT_TRUE(some * 100 >= steps * 99);
    }
}

static void the_same_step_gives_the_same_bits(void) {
    const laconic_tree_model m = tree_model(tree_swerve());
    const laconic_tree_start start = tree_start_at(0.3, 0.1, -0.2);
    laconic_tree_state a = tree_state(&m, &start), b = a;
    laconic_tree_input in = tree_nothing();
    for (int k = 0; k < 4; k++) {
        in.hinged.base.voltage_V[k] = REAL(4 - k);
        in.hinge_angle_rad[k] = REAL(0.3 * k);
    }
    tree_run(&m, &a, &in, 0.001, 50);
    tree_run(&m, &b, &in, 0.001, 25);
    laconic_tree_state copy = b;
    tree_run(&m, &copy, &in, 0.001, 25);
    TEST_ASSERT_EQUAL_MEMORY(&a, &copy, sizeof a);
    TEST_ASSERT_TRUE(largest((double)a.z[0], 0) > 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(without_hinges_it_is_the_friction_step_of_rigid_vehicles);
    RUN_TEST(a_held_hinge_is_a_rigid_body);
    RUN_TEST(a_prescribed_hinge_turns_as_commanded_with_or_without_mass);
    RUN_TEST(a_stop_is_plastic_and_is_not_passed);
    RUN_TEST(a_limited_servo_gives_its_limit_and_reports_it);
    RUN_TEST(a_sampled_servo_looks_at_its_own_rate);
    RUN_TEST(steering_motors_share_the_supply_and_keep_their_limits);
    RUN_TEST(a_hinge_motor_without_loop_follows_its_voltage);
    RUN_TEST(the_books_close_with_motors_slope_springs_and_scrub);
    RUN_TEST(scrub_resists_turning_and_fades_when_the_wheel_rolls);
    RUN_TEST(rest_stays_rest_to_the_last_bit);
    RUN_TEST(a_caster_robot_that_reverses_flips_its_casters);
    RUN_TEST(a_trailer_jackknifes_where_the_cars_rear_wheels_lock);
    RUN_TEST(a_chain_of_trailers_keeps_its_books_and_comes_to_rest);
    RUN_TEST(numbers_that_are_not_finite_are_refused_by_name);
    RUN_TEST(warm_steps_take_few_passes);
    RUN_TEST(the_same_step_gives_the_same_bits);
    return UNITY_END();
}
