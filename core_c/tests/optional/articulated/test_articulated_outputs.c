/* Tests of articulated_outputs.c and _reactions.c: poses, wheels, forces of cases that can be worked out by hand. */
#include "hinged_vehicles.h"

static void poses_of_bodies_follow_the_hinges(void) {
    laconic_articulated_vehicle v = free_tree();
    v.base.com_x_m = v.base.com_y_m = 0;
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0, 0, 0);
    start.x_m = 2;
    start.y_m = REAL(-1);
    start.heading_rad = REAL(PI / 2);
    start.hinge_angle_rad[0] = REAL(PI / 2);
    start.hinge_angle_rad[1] = REAL(PI);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const laconic_articulated_motion now = motion_of(&m, &s);
    ASSERT_NEAR(ROUNDING * 8, 2 - 0.03, now.body_x_m[0]); /* hinge (−0.25, 0.03), turned by 90° */
    ASSERT_NEAR(ROUNDING * 8, -1 - 0.25, now.body_y_m[0]);
    ASSERT_NEAR(ROUNDING * 8, PI, fabs((double)now.body_heading_rad[0]));
    ASSERT_NEAR(ROUNDING * 8, 2 - 0.03 + 0.5, now.body_x_m[1]); /* hinge (−0.5, 0.05) of body 1, turned by 180° */
    ASSERT_NEAR(ROUNDING * 8, -1 - 0.25 - 0.05, now.body_y_m[1]);
    ASSERT_NEAR(ROUNDING * 8, 0, now.body_heading_rad[1]);
    ASSERT_NEAR(ROUNDING * 8, PI, now.hinge_angle_rad[1]);
}

/* Two wheels push 20 kg and pull a trailer of 10 kg, whose wheels weigh 2 J/R² more: all in one line. */
static void a_straight_pull_gives_every_part_its_force(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    laconic_articulated_reactions r;
    drive_wheel(hang_wheel(&v, 0, 0, 0.2, 0), 0.5, 0);
    drive_wheel(hang_wheel(&v, 0, 0, -0.2, 0), 0.5, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, -0.3, 0, 10, 0.4, -0.4, 0);
    hang_wheel(&v, 1, -0.5, 0.2, 0.01);
    hang_wheel(&v, 1, -0.5, -0.2, 0.01);
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.base.voltage_V[0] = in.base.voltage_V[1] = 6; /* 3 N·m each at 0.1 m: 60 N */
    ASSERT_TAKEN(laconic_articulated_reactions_of(&r, &m, &s, &in, NULL, &refusal));
    const double trailer = 10 + 2 * 0.01 / (0.1 * 0.1), gain = 60 / (20 + trailer);
    ASSERT_NEAR(ROUNDING * 200, 30, r.along_N[0]);
    ASSERT_NEAR(ROUNDING * 200, 3, r.wheel_torque_Nm[1]);
    ASSERT_NEAR(ROUNDING * 200, trailer * gain, r.hinge_force_N[0][0]);
    ASSERT_NEAR(ROUNDING * 200, -0.01 * gain / 0.1 / 0.1, r.along_N[2]);
    ASSERT_NEAR(ROUNDING * 200, 0, r.hinge_torque_Nm[0]);
    ASSERT_NEAR(ROUNDING * 200, 0, r.lateral_N[2]);
    ASSERT_NEAR(ROUNDING * 10, 0, r.balance);
    ASSERT_NEAR(ROUNDING * 200, 30, r.largest_N);
}

/* A steady circle: the wheels together give the mass its centripetal force. */
static void lateral_forces_hold_a_tricycle_on_its_circle(void) {
    laconic_articulated_vehicle v = carriage(100, 10, 0.5, 0);
    laconic_articulated_reactions r;
    laconic_real load[3] = {400, 400, 200};
    v.base.friction_coefficient = REAL(0.8);
    hang_wheel(&v, 0, 0, 0.35, 0);
    hang_wheel(&v, 0, 0, -0.35, 0);
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 1.2, 0, 0, 0, 0, 0);
    hang_wheel(&v, 1, 0, 0, 0);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    const double steering = 0.3, rate = 1.0, forward = rate * 1.2 / tan(steering);
    laconic_articulated_start start = start_at(forward, rate * 0.5, rate);
    start.hinge_angle_rad[0] = REAL(steering);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    ASSERT_TAKEN(laconic_articulated_reactions_of(&r, &m, &s, &in, load, &refusal));
    const double front = (double)r.lateral_N[2], rear = (double)(r.lateral_N[0] + r.lateral_N[1]);
    /* axles point along −η: the forces to the left are −lateral */
    ASSERT_NEAR(EITHER(1e-10, 1e-2), 100 * rate * forward, -rear - cos(steering) * front);
    ASSERT_NEAR(EITHER(1e-10, 1e-2), 0.5 * -rear, 0.7 * cos(steering) * -front); /* no moment about S */
    ASSERT_NEAR(ROUNDING * 1e3, (double)r.lateral_N[0], r.lateral_N[1]);
    const double least = fmin(0.8 * 400 - fabs((double)r.lateral_N[0]), 0.8 * 200 - fabs(front));
    TEST_ASSERT_TRUE((double)r.no_slip_margin_N <= least + 1);
    ASSERT_NEAR(ROUNDING * 10, 0, r.balance);
}

static void a_brake_and_a_commanded_hinge_report_their_torques(void) {
    laconic_articulated_vehicle v = free_carriage();
    laconic_articulated_reactions r;
    for (int k = 0; k < 4; k++) v.base.wheel[k].own_inertia_kgm2 = 0;
    v.base.com_x_m = v.base.com_y_m = 0;
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 0, 0, 2, 0.3, 0, 0);
    laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.hinge_acceleration_rad_per_s2[0] = 4; /* against 0.9 kg·m² that turn the other way */
    ASSERT_TAKEN(laconic_articulated_reactions_of(&r, &m, &s, &in, NULL, &refusal));
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 4 * 0.3 * 0.9 / 1.2, r.hinge_torque_Nm[0]);
    v = two_wheeler();
    v.base.wheel[0].locked = true;
    m = hinged_model(v);
    in = nothing();
    s = hinged_state(&m, &start, &in);
    in.base.voltage_V[0] = 4; /* 2 N·m that the brake holds */
    ASSERT_TAKEN(laconic_articulated_reactions_of(&r, &m, &s, &in, NULL, &refusal));
    ASSERT_NEAR(EITHER(1e-13, 1e-5), -2, r.brake_Nm[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0, r.along_N[0]);
}

/* On a slope a vehicle that rolls freely gains g sin α, trailer and all. */
static void a_slope_pulls_every_body(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    laconic_articulated_rates r;
    hang_wheel(&v, 0, 0, 0.2, 0);
    hang_wheel(&v, 0, 0, -0.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, -0.3, 0, 10, 0.4, -0.4, 0);
    hang_wheel(&v, 1, -0.5, 0, 0);
    v.base.ground.slope_rad = REAL(0.1);
    v.base.ground.slope_heading_rad = REAL(PI); /* downhill along X */
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    ASSERT_TAKEN(laconic_articulated_rates_of(&r, &m, &s, &in, &refusal));
    ASSERT_NEAR(EITHER(1e-14, 1e-5), 9.80665 * sin(0.1), r.twist_rate[0].x);
    ASSERT_NEAR(EITHER(1e-14, 1e-5), 9.80665 * sin(0.1), r.twist_rate[1].x);
}

/* At a heading of 0.5 rad: the force turned back by it, with its moment about S. */
static void a_force_fixed_in_the_world_is_the_force_that_the_body_sees(void) {
    const laconic_articulated_model m = hinged_model(with_trailer(free_carriage()));
    laconic_articulated_input world = nothing(), body = nothing();
    laconic_articulated_start start = start_at(0.4, -0.3, 0.7);
    start.heading_rad = REAL(0.5);
    laconic_articulated_state s = hinged_state(&m, &start, &world);
    const double ahead = 3 * cos(0.5) + 4 * sin(0.5), left = 4 * cos(0.5) - 3 * sin(0.5);
    world.base.world_force_N[0] = 3;
    world.base.world_force_N[1] = 4;
    world.base.world_force_point_m[0] = REAL(0.5);
    world.base.world_force_point_m[1] = REAL(0.1);
    body.base.body_force_N[0] = REAL(ahead);
    body.base.body_force_N[1] = REAL(left);
    body.base.body_moment_Nm = REAL(0.5 * left - 0.1 * ahead);
    laconic_articulated_reactions a, b;
    laconic_articulated_rates p, q;
    ASSERT_TAKEN(laconic_articulated_reactions_of(&a, &m, &s, &world, NULL, &refusal));
    ASSERT_TAKEN(laconic_articulated_reactions_of(&b, &m, &s, &body, NULL, &refusal));
    ASSERT_TAKEN(laconic_articulated_rates_of(&p, &m, &s, &world, &refusal));
    ASSERT_TAKEN(laconic_articulated_rates_of(&q, &m, &s, &body, &refusal));
    for (int i = 0; i < m.wheel_count; i++) ASSERT_NEAR(ROUNDING * 1e3, b.along_N[i], a.along_N[i]);
    for (int k = 0; k < 2; k++) ASSERT_NEAR(ROUNDING * 1e3, b.hinge_force_N[0][k], a.hinge_force_N[0][k]);
    ASSERT_NEAR(ROUNDING * 100, q.twist_rate[0].z, p.twist_rate[0].z);
    ASSERT_NEAR(ROUNDING * 100, q.twist_rate[1].y, p.twist_rate[1].y);
    ASSERT_NEAR(ROUNDING * 100, 0, a.balance);
    TEST_ASSERT_TRUE(fabs((double)p.twist_rate[0].z) > 0.1);
}

static void wheel_angles_go_on_from_where_they_were_set(void) {
    const laconic_articulated_model m = hinged_model(with_two_casters());
    const laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const laconic_real angles[4] = {1, 2, 3, 4};
    run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.01, 10, &in);
    TEST_ASSERT_TRUE(fabs((double)motion_of(&m, &s).wheel_angle_rad[0]) > 0.1);
    laconic_articulated_wheel_angles_set(&m, &s, angles);
    const laconic_articulated_motion set = motion_of(&m, &s);
    ASSERT_NEAR_ALL(0, angles, set.wheel_angle_rad, 4);
    run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.001, 1, &in);
    ASSERT_NEAR(1e-4, 4 + 0.001 * (double)motion_of(&m, &s).wheel_speed_rad_per_s[3],
                motion_of(&m, &s).wheel_angle_rad[3]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(poses_of_bodies_follow_the_hinges);
    RUN_TEST(a_straight_pull_gives_every_part_its_force);
    RUN_TEST(lateral_forces_hold_a_tricycle_on_its_circle);
    RUN_TEST(a_brake_and_a_commanded_hinge_report_their_torques);
    RUN_TEST(a_slope_pulls_every_body);
    RUN_TEST(a_force_fixed_in_the_world_is_the_force_that_the_body_sees);
    RUN_TEST(wheel_angles_go_on_from_where_they_were_set);
    return UNITY_END();
}
