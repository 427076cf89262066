/* Tests of articulated motion against exact results: energy, a held hinge, casters, trailers, jumps. */
#include "hinged_vehicles.h"

static void free_motion_keeps_its_energy(void) {
    const laconic_articulated_model m = hinged_model(with_trailer(free_carriage()));
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.12, -0.1, 0.28);
    start.hinge_angle_rad[0] = REAL(0.9);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const double before = (double)motion_of(&m, &s).energy_J;
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.001, LONG_RUN(100000), &in);
    ASSERT_NEAR(EITHER(1e-12, 2e-4) * before, before, motion_of(&m, &s).energy_J);
}

static void a_tree_without_fixed_wheels_and_wheel_inertia_keeps_its_momentum(void) {
    laconic_articulated_vehicle v = free_tree();
    for (int k = 0; k < 4; k++) v.base.wheel[k].own_inertia_kgm2 = 0;
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.3, -0.2, 0.5);
    for (int k = 0; k < 4; k++) {
        start.hinge_angle_rad[k] = REAL(0.3 * k - 0.5);
        start.hinge_rate_rad_per_s[k] = REAL(0.4 - 0.3 * k);
    }
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    double momentum[2][2];
    for (int end = 0; end < 2; end++) {
        laconic_articulated_rates r;
        ASSERT_TAKEN(laconic_articulated_rates_of(&r, &m, &s, &in, &refusal));
        const laconic_articulated_motion now = motion_of(&m, &s);
        momentum[end][0] = momentum[end][1] = 0;
        for (int b = 0; b <= m.body_count; b++) { /* m(V + iω s), turned to the world */
            const laconic_vector f = b > 0 ? m.link[b - 1].first_moment : (laconic_vector){0, 0, m.mass_kg};
            const double w = (double)r.twist[b].z, h = (double)(b > 0 ? now.body_heading_rad[b - 1] : now.heading_rad);
            const double px = (double)(f.z * r.twist[b].x) - w * (double)f.y;
            const double py = (double)(f.z * r.twist[b].y) + w * (double)f.x;
            momentum[end][0] += cos(h) * px - sin(h) * py;
            momentum[end][1] += sin(h) * px + cos(h) * py;
        }
        if (end == 0) run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.001, 3000, &in);
    }
    ASSERT_NEAR_ALL(EITHER(1e-10, 1e-4), momentum[0], momentum[1], 2);
}

static void a_hinge_held_at_rate_0_is_the_merged_rigid_carriage(void) {
    laconic_articulated_vehicle v = free_carriage(), merged = free_carriage();
    const double angle = 0.7, sine = sin(angle), cosine = cos(angle), total = 25 + 10;
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, -0.25, 0.03, 10, 0.4, -0.3, 0.02);
    const double x = -0.25 + cosine * -0.3 - sine * 0.02, y = 0.03 + sine * -0.3 + cosine * 0.02;
    const double gap = (x - 0.01) * (x - 0.01) + (y - 0.02) * (y - 0.02);
    merged.base.mass_kg = REAL(total);
    merged.base.yaw_inertia_kgm2 = REAL(0.9 + 0.4 + 25 * 10 / total * gap);
    merged.base.com_x_m = REAL((25 * 0.01 + 10 * x) / total);
    merged.base.com_y_m = REAL((25 * 0.02 + 10 * y) / total);
    const laconic_articulated_model a = hinged_model(v), b = hinged_model(merged);
    laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.6, -0.5, 1.4);
    start.hinge_angle_rad[0] = REAL(angle);
    laconic_articulated_state p = hinged_state(&a, &start, &in);
    const double dx = (double)(merged.base.com_x_m - REAL(0.01)), dy = (double)(merged.base.com_y_m - REAL(0.02));
    laconic_articulated_start other = start_at(0.6 - 1.4 * dy, -0.5 + 1.4 * dx, 1.4);
    laconic_articulated_state q = hinged_state(&b, &other, &in);
    run_held(&a, &p, LACONIC_ARTICULATED_RK4, 0.001, 3000, &in);
    run_held(&b, &q, LACONIC_ARTICULATED_RK4, 0.001, 3000, &in);
    const laconic_articulated_motion m = motion_of(&a, &p), n = motion_of(&b, &q);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), m.yaw_rate_rad_per_s, n.yaw_rate_rad_per_s);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), m.velocity_m_per_s[0] - m.yaw_rate_rad_per_s * REAL(dy), n.velocity_m_per_s[0]);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), m.velocity_m_per_s[1] + m.yaw_rate_rad_per_s * REAL(dx), n.velocity_m_per_s[1]);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), m.heading_rad, n.heading_rad);
}

static void a_massless_body_without_wheels_changes_nothing(void) {
    laconic_articulated_vehicle v = with_two_casters();
    const laconic_articulated_model a = hinged_model(v);
    hang_body(&v, 1, LACONIC_HINGE_PRESCRIBED, 0.3, 0.1, 0, 0, 0.2, 0);
    const laconic_articulated_model b = hinged_model(v);
    laconic_articulated_input in = nothing();
    in.base.voltage_V[0] = 8;
    in.base.voltage_V[1] = 5;
    laconic_articulated_start start = start_at(0, 0, 0);
    start.hinge_angle_rad[0] = REAL(0.4);
    laconic_articulated_state p = hinged_state(&a, &start, &in);
    in.hinge_rate_rad_per_s[2] = 3;
    laconic_articulated_state q = hinged_state(&b, &start, &in);
    run_held(&a, &p, LACONIC_ARTICULATED_RK4, 0.002, 500, &in);
    run_held(&b, &q, LACONIC_ARTICULATED_RK4, 0.002, 500, &in);
    const laconic_articulated_motion m = motion_of(&a, &p), n = motion_of(&b, &q);
    TEST_ASSERT_TRUE(difference(&a, &m, &n) < EITHER(1e-12, 1e-4));
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 3, n.hinge_angle_rad[2]);
}

/* ------------------------------------------------------------------------------------ casters -- */

/* A heavy straight carriage with a massless caster of this trail, at a speed. */
static double caster_angle_after(int method, double speed, double trail, double psi, double step, int steps) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    hang_wheel(&v, 0, 0, 0.2, 0);
    hang_wheel(&v, 0, 0, -0.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, 0.25, 0, 0, 0, 0, 0);
    hang_wheel(&v, 1, -trail, 0, 0);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(speed, 0, 0);
    start.hinge_angle_rad[0] = REAL(psi);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    run_held(&m, &s, method, step, steps, &in);
    return (double)motion_of(&m, &s).hinge_angle_rad[0];
}

static void a_caster_swings_in_by_its_law_forward_and_out_in_reverse(void) {
    for (int method = LACONIC_ARTICULATED_CIRCLE; method <= LACONIC_ARTICULATED_MOEBIUS_4; method++) {
        double expected = 2 * atan(tan(2.5 / 2) * exp(-0.8 * 0.5 / 0.05));
        ASSERT_NEAR(EITHER(1e-14, 1e-5), expected, caster_angle_after(method, 0.8, 0.05, 2.5, 0.1, 5));
        expected = 2 * atan(tan(0.01 / 2) * exp(0.8 * 0.4 / 0.05)); /* jackknife */
        ASSERT_NEAR(EITHER(1e-12, 1e-4), expected, caster_angle_after(method, -0.8, 0.05, 0.01, 0.1, 4));
    }
    ASSERT_NEAR(EITHER(1e-9, 1e-5), 2 * atan(tan(2.5 / 2) * exp(-8)),
                caster_angle_after(LACONIC_ARTICULATED_AUTO, 0.8, 0.05, 2.5, 0.001, 500));
}

static void a_caster_of_5_mm_at_3_m_per_s_steps_by_10_ms(void) {
    ASSERT_NEAR(EITHER(1e-6, 1e-5), 2 * atan(tan(1.0 / 2) * exp(-6)),
                caster_angle_after(LACONIC_ARTICULATED_AUTO, 3, 0.005, 1, 0.01, 1));
    ASSERT_NEAR(EITHER(1e-6, 1e-5), 0, caster_angle_after(LACONIC_ARTICULATED_AUTO, 3, 0.005, 1, 0.01, 10));
    ASSERT_NEAR(EITHER(1e-5, 1e-4), 0, caster_angle_after(LACONIC_ARTICULATED_AUTO, 3, EITHER(1e-6, 1e-4), 1, 0.1, 10));
}

static void nearer_to_the_turning_centre_than_its_trail_a_caster_turns_for_ever(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    hang_wheel(&v, 0, 0, 0.2, 0);
    hang_wheel(&v, 0, 0, -0.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, 0, 0.02, 0, 0, 0, 0); /* on the axle, near the middle */
    hang_wheel(&v, 1, -0.05, 0, 0);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 2); /* spins about the middle */
    const double rate = 0.02 * 2 / 0.05, period = 2 * PI / sqrt(2.0 * 2.0 - rate * rate);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    run_held(&m, &s, LACONIC_ARTICULATED_CIRCLE, 10 * period / 400, 400, &in);
    ASSERT_NEAR(EITHER(1e-10, 1e-3), -20 * PI, motion_of(&m, &s).hinge_angle_rad[0]);
}

static void trailers_settle_on_their_circles(void) {
    const double length = 0.9, overhang = 0.15, front = 2.0;
    laconic_articulated_vehicle v = carriage(200, 20, 0, 0);
    hang_wheel(&v, 0, 0, 0.3, 0);
    hang_wheel(&v, 0, 0, -0.3, 0);
    for (int b = 1; b <= 3; b++) {
        hang_body(&v, b - 1, LACONIC_HINGE_FREE, b == 1 ? -overhang : -length - overhang, 0, 0, 0, 0, 0);
        hang_wheel(&v, b, -length, 0, 0);
    }
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(1, 0, 1 / front);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    run_held(&m, &s, LACONIC_ARTICULATED_MOEBIUS_4, 0.05, 1200, &in);
    const laconic_articulated_motion now = motion_of(&m, &s);
    double radius = (double)now.velocity_m_per_s[0] / (double)now.yaw_rate_rad_per_s;
    for (int b = 0; b < 3; b++) {
        const double after = sqrt(radius * radius + overhang * overhang - length * length);
        const double angle = -(atan(overhang / radius) + atan(length / after));
        ASSERT_NEAR(EITHER(1e-6, 1e-3), angle, now.hinge_angle_rad[b]);
        radius = after;
    }
}

/* ------------------------------------------------------------------------------------- jumps -- */

/* Momenta along the allowed motions are kept: the impulse of the hinge does no work on them, so of all motions with the
 * new rate the nearest in kinetic energy is taken, and a jump to the same rate changes nothing. */
static void a_jump_to_the_same_commands_changes_nothing(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.4, 0, 0);
    in.hinge_rate_rad_per_s[0] = REAL(0.3);
    laconic_articulated_state s = hinged_state(&m, &start, &in), before;
    run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.01, 100, &in);
    before = s;
    ASSERT_TAKEN(laconic_articulated_jump(&m, &s, &in, &refusal));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

static void a_jump_keeps_the_momentum_of_a_carriage_that_turns_freely(void) {
    laconic_articulated_vehicle v = free_carriage();
    for (int k = 0; k < 4; k++) v.base.wheel[k].own_inertia_kgm2 = 0;
    v.base.com_x_m = v.base.com_y_m = 0;
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, 0, 0, 2, 0.3, 0, 0); /* a turntable over the centre of mass */
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.4, 0.1, 1);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.hinge_rate_rad_per_s[0] = 4;
    ASSERT_TAKEN(laconic_articulated_jump(&m, &s, &in, &refusal));
    const laconic_articulated_motion now = motion_of(&m, &s);
    ASSERT_NEAR(ROUNDING * 4, 1 - 4 * 0.3 / (0.9 + 0.3), now.yaw_rate_rad_per_s);
    ASSERT_NEAR(ROUNDING * 4, 0.4, now.velocity_m_per_s[0]);
    ASSERT_NEAR(ROUNDING * 4, 4, now.hinge_rate_rad_per_s[0]);
}

static void a_step_jumps_by_itself_to_what_its_input_commands(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.4, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in), other;
    run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.01, 10, &in);
    other = s;
    in.hinge_rate_rad_per_s[0] = REAL(-1.5);
    ASSERT_TAKEN(laconic_articulated_jump(&m, &other, &in, &refusal));
    run_held(&m, &s, LACONIC_ARTICULATED_RK4, 0.01, 10, &in);
    run_held(&m, &other, LACONIC_ARTICULATED_RK4, 0.01, 10, &in);
    TEST_ASSERT_EQUAL_MEMORY(&other, &s, sizeof s);
}

/* ------------------------------------------------------------------------------- other results -- */

/* R = L/tan δ */
static void a_tricycle_turns_about_the_centre_of_its_steering_angle(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(1, 0, 0);
    start.hinge_angle_rad[0] = REAL(0.5);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    const laconic_articulated_motion now = motion_of(&m, &s);
    const double forward = (double)now.velocity_m_per_s[0] + 0.02 * (double)now.yaw_rate_rad_per_s; /* of the origin */
    ASSERT_NEAR(EITHER(1e-13, 1e-5), forward * tan(0.5) / 1.2, now.yaw_rate_rad_per_s);
}

static void a_steered_wheel_across_the_vehicle_is_regular(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0, 0, 1);
    start.hinge_angle_rad[0] = REAL(PI / 2);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.base.voltage_V[2] = 6;
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.01, 100, &in);
    ASSERT_NEAR(EITHER(1e-12, 1e-4), 0,
                motion_of(&m, &s).velocity_m_per_s[0] +
                    REAL(0.02) * motion_of(&m, &s).yaw_rate_rad_per_s); /* it turns about the middle of the rear axle */
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(free_motion_keeps_its_energy);
    RUN_TEST(a_tree_without_fixed_wheels_and_wheel_inertia_keeps_its_momentum);
    RUN_TEST(a_hinge_held_at_rate_0_is_the_merged_rigid_carriage);
    RUN_TEST(a_massless_body_without_wheels_changes_nothing);
    RUN_TEST(a_caster_swings_in_by_its_law_forward_and_out_in_reverse);
    RUN_TEST(a_caster_of_5_mm_at_3_m_per_s_steps_by_10_ms);
    RUN_TEST(nearer_to_the_turning_centre_than_its_trail_a_caster_turns_for_ever);
    RUN_TEST(trailers_settle_on_their_circles);
    RUN_TEST(a_jump_to_the_same_commands_changes_nothing);
    RUN_TEST(a_jump_keeps_the_momentum_of_a_carriage_that_turns_freely);
    RUN_TEST(a_step_jumps_by_itself_to_what_its_input_commands);
    RUN_TEST(a_tricycle_turns_about_the_centre_of_its_steering_angle);
    RUN_TEST(a_steered_wheel_across_the_vehicle_is_regular);
    return UNITY_END();
}
