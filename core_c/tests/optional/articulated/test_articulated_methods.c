/* Tests of the methods: order of each, where steps must be divided, what explicit ones refuse. */
#include "hinged_vehicles.h"

/* Voltages, a body wrench, a world force, hinge torques and what the vehicle lets command, in motion over a second. */
typedef struct drive_case {
    laconic_articulated_model model;
    laconic_articulated_state state;
    double rate, twist; /* prescribed rates and twist: how fast they vary */
} drive_case;

static laconic_articulated_input input_of(const drive_case *c, double t) {
    laconic_articulated_input in = nothing();
    for (int i = 0; i < c->model.wheel_count; i++) in.base.voltage_V[i] = REAL(5 - 2 * i);
    in.base.body_force_N[1] = REAL(3);
    in.base.body_moment_Nm = REAL(0.5);
    in.base.world_force_N[0] = REAL(4);
    in.base.world_force_point_m[1] = REAL(0.1);
    for (int b = 0; b < c->model.body_count; b++) {
        in.hinge_voltage_V[b] = REAL(1);
        in.hinge_torque_Nm[b] = REAL(0.02);
        in.hinge_rate_rad_per_s[b] = REAL(c->rate * sin(t));
        in.hinge_acceleration_rad_per_s2[b] = REAL(c->rate * cos(t));
    }
    in.twist[0] = 1;
    in.twist[2] = REAL(c->twist * sin(t));
    in.twist_rate[2] = REAL(c->twist * cos(t));
    return in;
}

static drive_case driven(laconic_articulated_vehicle v, double speed, double rate, double twist) {
    drive_case c;
    memset(&c, 0, sizeof c);
    c.model = hinged_model(v);
    c.rate = rate;
    c.twist = twist;
    laconic_articulated_start start = start_at(speed, 0, 0.2);
    for (int b = 0; b < c.model.body_count; b++) start.hinge_angle_rad[b] = REAL(0.4 - 0.3 * b);
    const laconic_articulated_input in = input_of(&c, 0);
    c.state = hinged_state(&c.model, &start, &in);
    return c;
}

static laconic_articulated_motion end_of(const drive_case *c, int method, int steps) {
    const double h = 1.0 / steps;
    laconic_articulated_state s = c->state;
    const laconic_articulated_integrator i = hinged_integrator(&c->model, method, h);
    for (int k = 0; k < steps; k++) {
        const laconic_articulated_input a = input_of(c, k * h), b = input_of(c, (k + 1) * h);
        ASSERT_TAKEN(laconic_articulated_step(&c->model, &i, &s, &a, &b, &refusal));
    }
    return motion_of(&c->model, &s);
}

/* The error falls by 2^order from `steps` to twice as many. */
static void assert_order(const drive_case *c, int method, int steps, double order) {
    const laconic_articulated_motion exact = end_of(c, LACONIC_ARTICULATED_RK4, IN_DOUBLE ? 8 * steps : 4 * steps);
    const laconic_articulated_motion coarse = end_of(c, method, steps), fine = end_of(c, method, 2 * steps);
    const double error = difference(&c->model, &coarse, &exact), finer = difference(&c->model, &fine, &exact);
    TEST_ASSERT_TRUE(error < 0.05);
    if (IN_DOUBLE) {
        TEST_ASSERT_TRUE_MESSAGE(error / finer > 0.7 * pow(2, order), "the order is lower");
        TEST_ASSERT_TRUE_MESSAGE(error / finer < 2.0 * pow(2, order), "the order is higher");
    } else {
        TEST_ASSERT_TRUE(finer < error + 1e-4);
    }
}

static void rk4_and_circle_are_of_fourth_order_with_everything_that_can_act(void) {
    for (int method = LACONIC_ARTICULATED_RK4; method <= LACONIC_ARTICULATED_CIRCLE; method++) {
        const drive_case casters = driven(with_two_casters(), 0.3, 0, 0);
        const drive_case steered = driven(tricycle(LACONIC_HINGE_PRESCRIBED), 0.4, 0.8, 0);
        const drive_case motor = driven(tricycle(LACONIC_HINGE_MOTOR), 0.4, 0, 0);
        const drive_case car = driven(car_with_trailer(), 2, 0, 0.3);
        const drive_case modules = driven(swerve(LACONIC_HINGE_COORDINATED, 4), 0.4, 0, 1.0);
        const drive_case tree = driven(free_tree(), 0.4, 0, 0);
        assert_order(&casters, method, 100, 4);
        assert_order(&steered, method, 20, 4);
        assert_order(&motor, method, 50, 4);
        assert_order(&car, method, 20, 4);
        assert_order(&modules, method, 40, 4);
        assert_order(&tree, method, 40, 4);
    }
}

static void moebius_4_is_of_fourth_order_and_of_third_with_rows_left_over(void) {
    const int method = LACONIC_ARTICULATED_MOEBIUS_4;
    const drive_case casters = driven(with_two_casters(), 0.3, 0, 0);
    const drive_case car = driven(car_with_trailer(), 2, 0, 0.3);
    const drive_case tree = driven(free_tree(), 0.4, 0, 0);
    const drive_case motor = driven(tricycle(LACONIC_HINGE_MOTOR), 0.4, 0, 0);
    assert_order(&casters, method, 100, 4);
    assert_order(&car, method, 20, 4);
    assert_order(&tree, method, 40, 4);
    assert_order(&motor, method, 50, 3);
}

static void moebius_4_follows_springs_of_any_stiffness(void) {
    laconic_articulated_vehicle v = free_carriage();
    laconic_body *b = hang_body(&v, 0, LACONIC_HINGE_FREE, -0.25, 0.03, 10, 0.4, -0.3, 0.02);
    b->stiffness_Nm = REAL(4e4); /* 200 rad/s and more */
    b->rest_rad = REAL(0.3);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    laconic_articulated_start start = start_at(0.4, 0, 0.3);
    start.hinge_angle_rad[0] = REAL(0.35);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    run_held(&m, &s, LACONIC_ARTICULATED_MOEBIUS_4, 0.05, 200, &in);
    ASSERT_NEAR(0.2, 0.3, motion_of(&m, &s).hinge_angle_rad[0]);
}

/* A steady motion that is fast to reach stays as it is at every step. */
static void moebius_4_keeps_the_steady_speed_of_stiff_motors(void) {
    laconic_articulated_vehicle v = with_two_casters();
    for (int k = 0; k < 2; k++) {
        v.base.wheel[k].own_motor_gain_Nm_per_V = 20;
        v.base.wheel[k].own_motor_damping_Nms = 20;
        v.base.wheel[k].own_inertia_kgm2 = REAL(1e-4);
    }
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.base.voltage_V[0] = in.base.voltage_V[1] = 8;
    run_held(&m, &s, LACONIC_ARTICULATED_MOEBIUS_4, 0.02, 200, &in);
    ASSERT_NEAR(EITHER(2e-2, 2e-2), 0.8, motion_of(&m, &s).velocity_m_per_s[0]);
}

/* ------------------------------------------------------------------------------------- stiff -- */

/* Differences of auto from rk4 at a step of 20 µs, over the size of the rates at the start. */
static double error_of_auto(laconic_articulated_vehicle v, const laconic_articulated_input *in, double speed,
                            double h) {
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_start start = start_at(speed, 0, 0);
    start.hinge_angle_rad[0] = REAL(0.3);
    laconic_articulated_state coarse = hinged_state(&m, &start, in), fine = coarse;
    const double rate = fabs((double)motion_of(&m, &coarse).hinge_rate_rad_per_s[0]);
    run_held(&m, &coarse, LACONIC_ARTICULATED_AUTO, h, (int)(0.1 / h + 0.5), in);
    run_held(&m, &fine, LACONIC_ARTICULATED_RK4, 2e-5, 5000, in);
    const laconic_articulated_motion a = motion_of(&m, &coarse), b = motion_of(&m, &fine);
    return difference(&m, &a, &b) / fmax(1, rate);
}

static void auto_meets_stiff_vehicles_at_1_and_10_ms(void) {
    laconic_articulated_vehicle light = with_two_casters(), motor = tricycle(LACONIC_HINGE_MOTOR), fast;
    laconic_articulated_input in = nothing();
    in.base.voltage_V[0] = in.base.voltage_V[1] = 24;
    for (int k = 0; k < 2; k++) {
        light.base.wheel[k + 2].x_m = REAL(-0.005);
        light.body[k].mass_kg = REAL(0.2);
        light.body[k].yaw_inertia_kgm2 = REAL(1e-4);
        light.body[k].com_x_m = REAL(-0.003);
        light.base.wheel[k + 2].own_inertia_kgm2 = REAL(2e-5);
    }
    fast = light;
    for (int k = 0; k < 2; k++) {
        fast.base.wheel[k].own_motor_gain_Nm_per_V = fast.base.wheel[k].own_motor_damping_Nms = 20;
        fast.base.wheel[k].own_inertia_kgm2 = REAL(1e-4);
    }
    TEST_ASSERT_TRUE(error_of_auto(light, &in, 1, 0.001) < EITHER(1e-7, 1e-2));
    TEST_ASSERT_TRUE(error_of_auto(light, &in, 1, 0.01) < EITHER(1e-5, 1e-2));
    TEST_ASSERT_TRUE(error_of_auto(fast, &in, 1, 0.001) < EITHER(1e-6, 1e-2));
    TEST_ASSERT_TRUE(error_of_auto(fast, &in, 1, 0.01) < EITHER(1e-5, 1e-2));
    motor.body[0].mass_kg = 3;
    motor.body[0].yaw_inertia_kgm2 = REAL(0.01);
    motor.body[0].com_x_m = motor.body[0].com_y_m = 0;
    motor.body[0].gain_Nm_per_V = motor.body[0].damping_Nms = 10;
    in = nothing();
    in.base.voltage_V[2] = 8;
    in.hinge_voltage_V[0] = REAL(0.6);
    TEST_ASSERT_TRUE(error_of_auto(motor, &in, 0.5, 0.001) < EITHER(1e-7, 1e-2));
    TEST_ASSERT_TRUE(error_of_auto(motor, &in, 0.5, 0.01) < EITHER(1e-7, 1e-2));
    motor.body[0].damping_Nms = 4;
    motor.body[0].stiffness_Nm = 60;
    motor.body[0].rest_rad = REAL(0.5);
    TEST_ASSERT_TRUE(error_of_auto(motor, &in, 0.5, 0.001) < EITHER(1e-7, 1e-2));
    TEST_ASSERT_TRUE(error_of_auto(motor, &in, 0.5, 0.01) < EITHER(1e-7, 1e-2));
}

/* ψ is the integral of its rate, which is a cubic through values and accelerations. */
static void every_method_turns_a_prescribed_hinge_by_the_integral_of_its_rate(void) {
    const laconic_articulated_model m = hinged_model(tricycle(LACONIC_HINGE_PRESCRIBED));
    laconic_articulated_input a = nothing(), b = nothing();
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    a.hinge_rate_rad_per_s[0] = REAL(0.3);
    b.hinge_rate_rad_per_s[0] = REAL(0.7);
    a.hinge_acceleration_rad_per_s2[0] = 4;
    b.hinge_acceleration_rad_per_s2[0] = -2;
    for (int method = 0; method < LACONIC_ARTICULATED_METHOD_COUNT; method++) {
        laconic_articulated_state s = hinged_state(&m, &start, &a);
        const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.1);
        ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &a, &b, &refusal));
        ASSERT_NEAR(EITHER(1e-15, 1e-6), 0.05 * (0.3 + 0.7) + 0.01 / 12 * (4 - -2),
                    motion_of(&m, &s).hinge_angle_rad[0]);
    }
}

/* Without damping and on a short trail auto judges by energy where nothing acts, else by its rates. */
static void auto_meets_an_undamped_short_trail_under_every_kind_of_input(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    hang_wheel(&v, 0, 0, 0.2, 0);
    hang_wheel(&v, 0, 0, -0.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, 0.3, 0, 1, 0.01, 0, 0);
    hang_wheel(&v, 1, -0.01, 0, 0);
    hang_body(&v, 0, LACONIC_HINGE_PRESCRIBED, -0.3, 0, 1, 0.01, 0.1, 0);
    for (int kind = 0; kind < 8; kind++) {
        laconic_articulated_input in = nothing();
        laconic_real *const numbers[] = {&in.base.body_force_N[0],   &in.base.body_force_N[1],
                                         &in.base.body_moment_Nm,    &in.base.world_force_N[1],
                                         &in.hinge_torque_Nm[0],     &in.hinge_rate_rad_per_s[1],
                                         &in.base.axle_torque_Nm[0], &in.base.voltage_V[0]};
        *numbers[kind] = REAL(0.4);
        TEST_ASSERT_TRUE(error_of_auto(v, &in, 0.5, 0.01) < EITHER(1e-5, 1e-2));
    }
}

/* Decay of 10⁶ 1/s against a step of 10 ms. */
static void auto_takes_damping_of_any_rate(void) {
    laconic_articulated_vehicle v = tricycle(LACONIC_HINGE_MOTOR);
    v.body[0].damping_Nms = REAL(EITHER(3e5, 3e4));
    v.body[0].gain_Nm_per_V = REAL(EITHER(3e5, 3e4));
    const laconic_articulated_model m = hinged_model(v);
    laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0.5, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in);
    in.hinge_voltage_V[0] = REAL(0.5);
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.01, 100, &in);
    ASSERT_NEAR(0.02, 0.5, motion_of(&m, &s).hinge_rate_rad_per_s[0]);
    ASSERT_NEAR(0.02, 0.5, motion_of(&m, &s).hinge_angle_rad[0]);
}

/* ---------------------------------------------------------------------------------- refusals -- */

static void rk4_refuses_a_caster_that_is_too_fast_with_the_largest_step(void) {
    laconic_articulated_vehicle v = two_wheeler();
    hang_caster(&v, 0.22, 0, 0.005);
    v.base.wheel[2].y_m = 0;
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(3, 0, 0);
    laconic_articulated_state s = hinged_state(&m, &start, &in), before = s;
    laconic_articulated_integrator i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.01);
    memset(&refusal, 0, sizeof refusal);
    ASSERT_STATUS(LACONIC_STEP_BEYOND_TRAIL_LIMIT, laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    ASSERT_NEAR(1e-5, 2.785 * 0.005 / 3, refusal.limit);
    i = hinged_integrator(&m, LACONIC_ARTICULATED_RK4, 0.99 * (double)refusal.limit);
    ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
    s = before;
    i = hinged_integrator(&m, LACONIC_ARTICULATED_CIRCLE, 0.01);
    ASSERT_TAKEN(laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
}

static void explicit_methods_refuse_a_yaw_too_fast_for_the_step(void) {
    const laconic_articulated_model m = hinged_model(free_tree());
    const laconic_articulated_input in = nothing();
    const laconic_articulated_start start = start_at(0, 0, 50);
    laconic_articulated_state s = hinged_state(&m, &start, &in), before = s;
    for (int method = LACONIC_ARTICULATED_RK4; method <= LACONIC_ARTICULATED_CIRCLE; method++) {
        const laconic_articulated_integrator i = hinged_integrator(&m, method, 0.1);
        ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, laconic_articulated_step(&m, &i, &s, &in, &in, &refusal));
        TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
    }
    run_held(&m, &s, LACONIC_ARTICULATED_AUTO, 0.1, 10, &in);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(rk4_and_circle_are_of_fourth_order_with_everything_that_can_act);
    RUN_TEST(moebius_4_is_of_fourth_order_and_of_third_with_rows_left_over);
    RUN_TEST(moebius_4_follows_springs_of_any_stiffness);
    RUN_TEST(moebius_4_keeps_the_steady_speed_of_stiff_motors);
    RUN_TEST(auto_meets_stiff_vehicles_at_1_and_10_ms);
    RUN_TEST(every_method_turns_a_prescribed_hinge_by_the_integral_of_its_rate);
    RUN_TEST(auto_meets_an_undamped_short_trail_under_every_kind_of_input);
    RUN_TEST(auto_takes_damping_of_any_rate);
    RUN_TEST(rk4_refuses_a_caster_that_is_too_fast_with_the_largest_step);
    RUN_TEST(explicit_methods_refuse_a_yaw_too_fast_for_the_step);
    return UNITY_END();
}
