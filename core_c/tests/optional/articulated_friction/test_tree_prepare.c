/* Tests of preparing a tree: refusals that name body or wheel with the remedy, normal loads by statics, and trees that
 * other models describe, too. */
#include "slipping_trees.h"

#define FIELD(name) ((laconic_field)LACONIC_FIELD_OF_##name)

static void assert_prepare_refuses(laconic_tree_vehicle v, laconic_status status, laconic_field field, int item,
                                   const char *start_of_text) {
    laconic_tree_model m;
    char text[500];
    memset(&m, 7, sizeof m);
    const laconic_tree_model before = m;
    ASSERT_STATUS(status, laconic_tree_prepare(&m, &v, &refusal));
    ASSERT_STATUS(status, refusal.status);
    TEST_ASSERT_EQUAL(field, refusal.field);
    TEST_ASSERT_EQUAL(item, refusal.item);
    TEST_ASSERT_EQUAL_MEMORY(&before, &m, sizeof m);
    laconic_message(&refusal, text, sizeof text);
    TEST_ASSERT_EQUAL_STRING_LEN(start_of_text, text, strlen(start_of_text));
}

static void ground_without_friction_is_refused(void) {
    laconic_tree_vehicle v = tree_swerve();
    v.hinged.base.ground.friction_coefficient = 0;
    for (int i = 0; i < 4; i++) v.hinged.base.wheel[i].own_axle_friction_Nm = 0;
    assert_prepare_refuses(v, LACONIC_NOT_POSITIVE, LACONIC_FIELD_GROUND_FRICTION_COEFFICIENT, 0,
                           "ground.friction_coefficient: 0 is not positive");
}

static void a_coordinated_hinge_is_refused_with_the_remedy(void) {
    laconic_tree_vehicle v = tree_casters();
    v.hinged.body[1].hinge = LACONIC_HINGE_COORDINATED;
    assert_prepare_refuses(v, LACONIC_COORDINATED_SLIPS, FIELD(BODY_HINGE), 2,
                           "vehicle.body[2].hinge: a twist coordinates hinges on ideal ground alone; on ground with "
                           "friction use 1 (free) with a servo");
}

static void numbers_without_effect_on_their_hinge_are_refused(void) {
    laconic_tree_vehicle v = tree_swerve();
    v.hinged.body[2].hinge = LACONIC_HINGE_PRESCRIBED;
    assert_prepare_refuses(v, LACONIC_NO_EFFECT_ON_HINGE, FIELD(SERVO_GAIN), 3,
                           "vehicle.body[3].servo_gain_Nm_per_rad");
    v = tree_swerve();
    v.hinge[0].loop_V_per_rad = 2;
    assert_prepare_refuses(v, LACONIC_NO_EFFECT_ON_HINGE, FIELD(LOOP_ANGLE_GAIN), 1, "vehicle.body[1].loop_V_per_rad");
    v = tree_casters();
    v.hinged.body[0].hinge = LACONIC_HINGE_PRESCRIBED;
    v.hinge[0].stop_high_rad = 1;
    assert_prepare_refuses(v, LACONIC_NO_EFFECT_ON_HINGE, FIELD(HINGE_STOP_HIGH), 1, "vehicle.body[1].stop_high_rad");
    v.hinge[0].stop_low_rad = -1;
    assert_prepare_refuses(v, LACONIC_NO_EFFECT_ON_HINGE, FIELD(HINGE_STOP_LOW), 1, "vehicle.body[1].stop_low_rad");
    v = tree_casters();
    v.hinge[1].control_period_s = REAL(0.01);
    assert_prepare_refuses(v, LACONIC_NO_EFFECT_ON_HINGE, FIELD(CONTROL_PERIOD), 2, "vehicle.body[2].control_period_s");
}

static void a_limit_without_what_it_limits_is_refused(void) {
    laconic_tree_vehicle v = tree_casters();
    v.hinge[0].servo_limit_Nm = 1;
    assert_prepare_refuses(v, LACONIC_NOT_POSITIVE, FIELD(SERVO_GAIN), 1, "vehicle.body[1].servo_gain_Nm_per_rad");
    v = tree_casters();
    v.hinged.body[1].hinge = LACONIC_HINGE_MOTOR;
    v.hinge[1].current_limit_A = 3;
    assert_prepare_refuses(v, LACONIC_NOT_POSITIVE, FIELD(HINGE_RESISTANCE), 2,
                           "vehicle.body[2].winding_resistance_ohm");
    v = tree_casters();
    v.wheel[3].scrub_fade_m = REAL(0.1);
    assert_prepare_refuses(v, LACONIC_NOT_POSITIVE, FIELD(SCRUB_RADIUS), 4, "vehicle.wheel[4].scrub_radius_m");
    v = tree_casters();
    v.wheel[0].load_N = 50;
    assert_prepare_refuses(v, LACONIC_NOT_POSITIVE, FIELD(WHEEL_LOAD), 2, "vehicle.wheel[2].load_N: 0 is not positive");
}

static void stops_in_the_wrong_order_are_refused(void) {
    laconic_tree_vehicle v = tree_loader();
    v.hinge[0].stop_low_rad = 1;
    assert_prepare_refuses(v, LACONIC_ABOVE_LIMIT, FIELD(HINGE_STOP_LOW), 1,
                           "vehicle.body[1].stop_low_rad: 1 is above 0.7");
}

static void every_number_of_hinges_and_wheels_is_checked(void) {
    laconic_tree_vehicle v = tree_casters();
    v.hinge[1].dry_friction_Nm = -1;
    assert_prepare_refuses(v, LACONIC_NEGATIVE, FIELD(HINGE_DRY_FRICTION), 2, "vehicle.body[2].dry_friction_Nm: -1");
    v = tree_casters();
    v.hinge[0].com_z_m = NOT_A_NUMBER;
    assert_prepare_refuses(v, LACONIC_NOT_FINITE, FIELD(BODY_COM_Z), 1, "vehicle.body[1].com_z_m: NaN");
    v = tree_casters();
    v.wheel[2].scrub_radius_m = REAL(LACONIC_REAL_MAX);
    assert_prepare_refuses(v, LACONIC_OVERFLOW, FIELD(SCRUB_RADIUS), 3, "vehicle.wheel[3].scrub_radius_m");
    v = tree_casters();
    v.hinged.body[0].parent = 1;
    assert_prepare_refuses(v, LACONIC_BODY_UNKNOWN, FIELD(BODY_PARENT), 1, "vehicle.body[1].parent");
}

/* Each number is usable by itself, and their sum is not. */
static void numbers_that_leave_the_range_together_are_refused(void) {
    laconic_tree_vehicle v = tree_casters();
    v.hinged.body[0].hinge_x_m = v.hinged.body[1].hinge_x_m = REAL(EITHER(1.2e154, 1.7e19));
    assert_prepare_refuses(v, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, "");
}

static void a_massless_body_is_refused_unless_its_rate_is_prescribed(void) {
    laconic_tree_vehicle v = tree_casters();
    v.hinged.body[1].mass_kg = v.hinged.body[1].yaw_inertia_kgm2 = 0;
    assert_prepare_refuses(v, LACONIC_MASSLESS_HINGE, FIELD(BODY_YAW_INERTIA), 2, "vehicle.body[2].yaw_inertia_kgm2");
    v.hinged.body[1].hinge = LACONIC_HINGE_PRESCRIBED;
    v.hinged.body[1].damping_Nms = 0;
    v.hinge[1].dry_friction_Nm = 0;
    (void)tree_model(v);
}

static void a_start_beyond_a_stop_is_refused(void) {
    const laconic_tree_model m = tree_model(tree_loader());
    laconic_tree_start start = tree_start_at(0, 0, 0);
    laconic_tree_state s;
    start.hinged.hinge_angle_rad[0] = REAL(0.8);
    ASSERT_STATUS(LACONIC_ABOVE_LIMIT, laconic_tree_state_set(&s, &m, &start, &refusal));
    TEST_ASSERT_EQUAL(FIELD(START_HINGE_ANGLE), refusal.field);
    start.hinged.hinge_angle_rad[0] = REAL(-0.8);
    ASSERT_STATUS(LACONIC_BELOW_LIMIT, laconic_tree_state_set(&s, &m, &start, &refusal));
    start.hinged.hinge_angle_rad[0] = 0;
    start.hinged.yaw_rate_rad_per_s = REAL(EITHER(1e18, 1e7)); /* of a body whose hinge is far out */
    laconic_tree_vehicle far_out = tree_casters();
    far_out.hinged.body[0].hinge_x_m = REAL(EITHER(1e150, 1e17));
    const laconic_tree_model too_large = tree_model(far_out);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_tree_state_set(&s, &too_large, &start, &refusal));
    TEST_ASSERT_EQUAL(FIELD(START_VELOCITY), refusal.field);
    start.hinged.yaw_rate_rad_per_s = 0;
    start.hinged.velocity_m_per_s[1] = INFINITE;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_tree_state_set(&s, &m, &start, &refusal));
    TEST_ASSERT_EQUAL(FIELD(START_VELOCITY), refusal.field);
    TEST_ASSERT_EQUAL(2, refusal.item);
}

/* ----------------------------------------------------------------------------------------- loads -- */

static const double g = 9.80665;

static void loads_follow_casters_as_they_swivel(void) {
    const laconic_tree_model m = tree_model(tree_casters());
    laconic_tree_start start = tree_start_at(0, 0, 0);
    for (int end = 0; end < 2; end++) {
        const double psi = end == 0 ? 0 : PI; /* contacts 3 cm behind the hinges, then 3 cm before them */
        const double caster = -0.25 + (end == 0 ? -0.03 : 0.03), com = -0.25 + (end == 0 ? -0.015 : 0.015);
        double total = 20.6 * g, moment = 0.6 * g * com;
        start.hinged.hinge_angle_rad[0] = start.hinged.hinge_angle_rad[1] = REAL(psi);
        const laconic_tree_state s = tree_state(&m, &start);
        const double rear = (moment - total * 0.03) / (caster - 0.03); /* of both casters */
        ASSERT_NEAR(EITHER(1e-10, 1e-3), (total - rear) / 2, s.normal_N[0]);
        ASSERT_NEAR(EITHER(1e-10, 1e-3), rear / 2, s.normal_N[3]);
    }
}

static void a_trailer_rests_on_its_axle_and_the_hitch(void) {
    const laconic_tree_model m = tree_model(tree_trailer(0.8));
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    const laconic_tree_state s = tree_state(&m, &start);
    const double axle = 1000 * g * 3.0 / 3.2, hitch = 1000 * g - axle;
    const double all = 1400 * g + hitch, front = (hitch * -2.4 + all * 1.4) / 2.7;
    ASSERT_NEAR(EITHER(1e-8, 0.1), axle / 2, s.normal_N[4]);
    ASSERT_NEAR(EITHER(1e-8, 0.1), axle / 2, s.normal_N[5]);
    ASSERT_NEAR(EITHER(1e-8, 0.1), front / 2, s.normal_N[0]);
    ASSERT_NEAR(EITHER(1e-8, 0.1), (all - front) / 2, s.normal_N[2]);
}

/* 12 kg with the centre of mass 5 cm ahead of the axle and 20 cm behind a ball. */
static void a_support_carries_as_a_wheel_does(void) {
    laconic_tree_vehicle v = tree_carriage(12, 0.4, 0.6);
    v.hinged.base.com_x_m = REAL(0.05);
    for (int side = 1; side >= -1; side -= 2) drive_wheel(tree_wheel(&v, 0, 0, 0.2 * side, 0.08, 0.02, 0.05), 0.4, 0.3);
    v.hinged.base.support_count = 1;
    v.hinged.base.support[0].x_m = REAL(0.25);
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    const laconic_tree_state s = tree_state(&m, &start);
    ASSERT_NEAR(EITHER(1e-10, 1e-4), 12 * g / 5, s.normal_N[2]);
    for (int i = 0; i < 2; i++) ASSERT_NEAR(EITHER(1e-10, 1e-4), 12 * g * 2 / 5, s.normal_N[i]);
}

/* Three axles at 0.5, 0 and −0.5 m, the weight 0.4 m ahead: of least norm the last would pull. */
static void the_axles_that_are_left_carry_all_where_one_lifts(void) {
    laconic_tree_vehicle v = tree_carriage(30, 2, 0.8);
    v.hinged.base.com_x_m = REAL(0.4);
    for (int k = 0; k < 6; k++) tree_wheel(&v, 0, 0.5 - k / 2 * 0.5, k % 2 == 0 ? 0.2 : -0.2, 0.05, 0.004, 0.05);
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    const laconic_tree_state s = tree_state(&m, &start);
    for (int k = 0; k < 2; k++) {
        ASSERT_NEAR(EITHER(1e-9, 1e-3), 0.4 * 30 * g, s.normal_N[k]);
        ASSERT_NEAR(EITHER(1e-9, 1e-3), 0.1 * 30 * g, s.normal_N[2 + k]);
        TEST_ASSERT_TRUE(s.normal_N[4 + k] < 0);
        TEST_ASSERT_EQUAL(2, tree_outputs(&m, &s).contact_state[4 + k]);
    }
}

/* The turntable carries pitch, so that trailer and turntable are one group behind the hitch. */
static void a_turntable_of_a_trailer_belongs_to_its_group(void) {
    laconic_tree_vehicle v = tree_trailer(0.8);
    const int b = tree_body(&v, 1, -1, 0, 100, 20, 0, 0);
    for (int side = 1; side >= -1; side -= 2) tree_wheel(&v, b, 0, 0.75 * side, 0.3, 1.2, 2);
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    const laconic_tree_state s = tree_state(&m, &start);
    double sum = 0, car = 0;
    for (int i = 0; i < 8; i++) sum += (double)s.normal_N[i];
    for (int i = 0; i < 4; i++) car += (double)s.normal_N[i] - 1400 * g / 4;
    ASSERT_NEAR(EITHER(1e-8, 0.1), 2500 * g, sum);
    double moment = 1000 * g * -3 + 100 * g * -1; /* about the hitch, of which its force has none */
    for (int i = 4; i < 8; i++) moment -= (double)s.normal_N[i] * (i < 6 ? -3.2 : -1);
    ASSERT_NEAR(EITHER(1e-7, 0.5), 0, moment);
    TEST_ASSERT_TRUE(car < 1000 * g - 1); /* the hitch carries a part at most */
}

/* A pivot that carries pitch makes car and trailer one rigid body on three axles: the least-norm loads then differ. */
static void a_hinge_that_carries_pitch_shares_loads(void) {
    laconic_tree_vehicle v = tree_trailer(0.8);
    v.hinge[0].hitch = false;
    const laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(0, 0, 0);
    const laconic_tree_state s = tree_state(&m, &start);
    double sum = 0, moment = 0;
    for (int i = 0; i < 6; i++) {
        const double x = i < 2 ? 1.3 : i < 4 ? -1.4 : -5.6;
        sum += (double)s.normal_N[i];
        moment += (double)s.normal_N[i] * x;
    }
    ASSERT_NEAR(EITHER(1e-8, 0.1), 2400 * g, sum);
    ASSERT_NEAR(EITHER(1e-7, 0.5), 1000 * g * -5.4, moment);
    TEST_ASSERT_TRUE(fabs((double)s.normal_N[4] - 1000 * g * 3.0 / 3.2 / 2) > 10);
}

static void braking_shifts_the_load_and_a_wheel_that_would_pull_lifts(void) {
    laconic_tree_vehicle v = tree_rigid();
    v.hinged.base.com_z_m = REAL(0.1);
    for (int i = 0; i < 4; i++) v.hinged.base.wheel[i].locked = true;
    laconic_tree_model m = tree_model(v);
    const laconic_tree_start start = tree_start_at(2, 0, 0);
    laconic_tree_state s = tree_state(&m, &start);
    const laconic_tree_input in = tree_nothing();
    tree_run(&m, &s, &in, 0.001, 50);
    const double shift = 0.8 * 36 * g * 0.1 / 0.5; /* of an axle's load */
    ASSERT_NEAR(EITHER(1e-6, 0.05), 36 * g / 4 + shift / 2, s.normal_N[0]);
    ASSERT_NEAR(EITHER(1e-6, 0.05), 36 * g / 4 - shift / 2, s.normal_N[1]);
    v.hinged.base.com_z_m = REAL(0.5); /* tips over the front axle */
    m = tree_model(v);
    s = tree_state(&m, &start);
    tree_run(&m, &s, &in, 0.001, 50);
    TEST_ASSERT_TRUE(s.normal_N[1] < 0 && s.normal_N[2] < 0);
    const laconic_tree_outputs out = tree_outputs(&m, &s);
    TEST_ASSERT_EQUAL(2, out.contact_state[1]);
    TEST_ASSERT_EQUAL(1, out.contact_state[0]);
}

/* --------------------------------------------------------------------- limits to other models -- */

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
    ASSERT_TAKEN(laconic_prepare(&of_body, &v.hinged.base, &refusal));
    rigid.nu_rad_per_s[0] = REAL(0.6 / 0.08);
    rigid.nu_rad_per_s[1] = REAL(-0.2 / 0.08);
    rigid.nu_rad_per_s[2] = REAL(0.5) * of_body.yaw_scale;
    ASSERT_TAKEN(laconic_plant_start(&plant, &v.hinged.base, &laconic_auto, REAL(0.001), &rigid, &refusal));
    laconic_tree_state s = tree_state(&m, &start);
    for (int i = 0; i < 4; i++) in.hinged.base.voltage_V[i] = REAL(i < 3 ? 12 : -3);
    in.hinged.base.body_force_N[1] = 5;
    tree_run(&m, &s, &in, 0.001, 400);
    for (int k = 0; k < 400; k++)
        ASSERT_TAKEN(laconic_friction_step(&plant.friction, &plant.model, REAL(0.001), &plant.state, &plant.slip,
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
    for (int i = 0; i < 4; i++) ASSERT_NEAR(EITHER(1e-8, 1e-2), q.wheel_speed_rad_per_s[i], p.wheel_speed_rad_per_s[i]);
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
    TEST_ASSERT_TRUE(fabs(tree_books_off(&out, before)) < EITHER(1e-10, 1e-2) * before);
    TEST_ASSERT_TRUE(energy == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(ground_without_friction_is_refused);
    RUN_TEST(a_coordinated_hinge_is_refused_with_the_remedy);
    RUN_TEST(numbers_without_effect_on_their_hinge_are_refused);
    RUN_TEST(a_limit_without_what_it_limits_is_refused);
    RUN_TEST(stops_in_the_wrong_order_are_refused);
    RUN_TEST(every_number_of_hinges_and_wheels_is_checked);
    RUN_TEST(numbers_that_leave_the_range_together_are_refused);
    RUN_TEST(a_massless_body_is_refused_unless_its_rate_is_prescribed);
    RUN_TEST(a_start_beyond_a_stop_is_refused);
    RUN_TEST(loads_follow_casters_as_they_swivel);
    RUN_TEST(a_trailer_rests_on_its_axle_and_the_hitch);
    RUN_TEST(a_support_carries_as_a_wheel_does);
    RUN_TEST(the_axles_that_are_left_carry_all_where_one_lifts);
    RUN_TEST(a_turntable_of_a_trailer_belongs_to_its_group);
    RUN_TEST(a_hinge_that_carries_pitch_shares_loads);
    RUN_TEST(braking_shifts_the_load_and_a_wheel_that_would_pull_lifts);
    RUN_TEST(without_hinges_it_is_the_friction_step_of_rigid_vehicles);
    RUN_TEST(a_held_hinge_is_a_rigid_body);
    RUN_TEST(a_chain_of_trailers_keeps_its_books_and_comes_to_rest);
    return UNITY_END();
}
