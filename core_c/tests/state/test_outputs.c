/* Tests of outputs.c: velocities, pose, wheels, torques and energy. */
#include "methods.h"
#include "stack.h"
#include "step_chain.h"

/* -------------------------------------------------------------------------------- velocities -- */

static void velocity_is_r_nu_and_yaw_rate_nu3_over_lambda(void) {
    const laconic_model m = model_of(mecanum());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    laconic_real nu[3], velocity[2];
    const laconic_real yaw_rate = laconic_body_velocity(&m, &state, velocity);
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR(4 * ROUNDING, 0.7, nu[0]);
    ASSERT_NEAR(4 * ROUNDING, -0.4, nu[1]);
    ASSERT_NEAR(4 * ROUNDING, 1.9, nu[2]);
    ASSERT_NEAR(ROUNDING, RADIUS * 0.7, velocity[0]);
    ASSERT_NEAR(ROUNDING, RADIUS * -0.4, velocity[1]);
    ASSERT_NEAR(ROUNDING, 1.9 / BIG_LAMBDA, yaw_rate);
}

static void a_constrained_vehicle_shows_its_dependent_component(void) {
    const laconic_model m = model_of(differential_drive());
    const laconic_state state = moving(&m, -DELTA / BIG_LAMBDA * 2.0, 1.0, 2.0);
    laconic_real nu[3];
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR(2 * ROUNDING, -DELTA / BIG_LAMBDA * 2.0, nu[0]);
    ASSERT_NEAR(2 * ROUNDING, 1.0, nu[1]);
    ASSERT_NEAR(2 * ROUNDING, 2.0, nu[2]);
}

/* -------------------------------------------------------------------------------------- pose -- */

static void the_origin_lies_where_the_heading_puts_it(void) {
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(0, 0, 0);
    laconic_model m;
    laconic_state state;
    laconic_pose pose;
    v.com_x_m = REAL(0.13);
    v.com_y_m = REAL(-0.07);
    m = model_of(v);
    start.x_m = REAL(2);
    start.y_m = REAL(-1);
    for (double heading = -9; heading < 9; heading += 0.77) {
        start.heading_rad = REAL(heading);
        state = state_of(&m, start);
        laconic_pose_of(&pose, &m, &state);
        ASSERT_NEAR(2 * ROUNDING, 2 - (0.13 * cos(heading) + 0.07 * sin(heading)), pose.origin_x_m);
        ASSERT_NEAR(2 * ROUNDING, -1 - (0.13 * sin(heading) - 0.07 * cos(heading)), pose.origin_y_m);
        ASSERT_NEAR(EITHER(1e-14, 4e-6), heading, pose.heading_rad);
        ASSERT_NEAR(EITHER(1e-14, 4e-6), atan2(sin(heading), cos(heading)), pose.heading_wrapped_rad);
    }
}

static void any_angle_is_wrapped_to_half_a_turn_on_either_side(void) {
    for (double angle = -40; angle < 40; angle += 0.37)
        ASSERT_NEAR(EITHER(1e-14, 5e-6), atan2(sin(angle), cos(angle)), laconic_angle_wrapped(REAL(angle)));
    TEST_ASSERT_TRUE(laconic_angle_wrapped(0) == 0);
}

/* ---------------------------------------------------------------------------------- position -- */

static void the_position_is_that_of_the_pose_to_the_last_bit(void) {
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(1, 2, 3);
    laconic_model m = model_of(v);
    laconic_state state;
    laconic_pose pose;
    laconic_real x, y, heading;
    for (double angle = -40; angle < 40; angle += 1.7) {
        start.x_m = REAL(angle / 3);
        start.y_m = REAL(-angle);
        start.heading_rad = REAL(angle);
        state = state_of(&m, start);
        laconic_pose_of(&pose, &m, &state);
        laconic_position(&state, &x, &y, &heading);
        TEST_ASSERT_TRUE(x == pose.x_m && y == pose.y_m && heading == pose.heading_rad);
    }
}

/* ------------------------------------------------------------------------------ wheel speeds -- */

static void wheel_speeds_are_xi_nu(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const double expected[3] = {-0.4 + SIGMA * 1.9, 0.4 + SIGMA * 1.9, -0.7 + RHO * 1.9};
    laconic_real speed[3];
    laconic_wheel_speeds(&m, &state, speed);
    ASSERT_NEAR_ALL(4 * ROUNDING, expected, speed, 3);
}

static void a_wheel_with_its_axle_to_the_right_rolls_forward_when_the_vehicle_moves_forward(void) {
    const laconic_model m = model_of(caster());
    const laconic_state state = moving(&m, 2, 0, 0);
    laconic_real speed[1];
    laconic_wheel_speeds(&m, &state, speed);
    ASSERT_NEAR(ROUNDING, 2, speed[0]);
}

static void a_locked_wheel_has_no_speed(void) {
    laconic_vehicle v = three_wheels();
    laconic_model m;
    laconic_state state;
    laconic_real speed[3];
    v.wheel[2].locked = true;
    m = model_of(v);
    state = moving(&m, RHO * 3, 1, 3);
    laconic_wheel_speeds(&m, &state, speed);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)speed[2]);
    ASSERT_NEAR(4 * ROUNDING, 1 + SIGMA * 3, speed[0]);
}

/* ------------------------------------------------------------------------------ wheel angles -- */

static void angles_start_at_zero_and_can_be_set(void) {
    const laconic_model m = model_of(three_wheels());
    laconic_state state = moving(&m, 1, 2, 3);
    const laconic_real wanted[3] = {REAL(0.5), REAL(-40), REAL(1000)};
    laconic_real angle[3];
    laconic_wheel_angles(&m, &state, angle);
    TEST_ASSERT_EACH_EQUAL_DOUBLE(0.0, ((double[3]){(double)angle[0], (double)angle[1], (double)angle[2]}), 3);
    laconic_wheel_angles_set(&m, &state, wanted);
    laconic_wheel_angles(&m, &state, angle);
    ASSERT_NEAR_ALL(0, wanted, angle, 3);
}

/* Straight ahead at ν = (2, 0, 0) a caster's wheel rotates by 2 rad a second. */
static void angles_grow_with_the_wheels_speed_from_what_they_were_set_to(void) {
    const laconic_model m = model_of(caster());
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 2, 0, 0);
    const laconic_real wanted[1] = {REAL(10)};
    laconic_real angle[1];
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.125, 8);
    laconic_wheel_angles_set(&m, &state, wanted);
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.125, 16);
    laconic_wheel_angles(&m, &state, angle);
    ASSERT_NEAR(EITHER(1e-14, 4e-6), 14.0, angle[0]);
}

static void the_angle_of_a_locked_wheel_stays(void) {
    laconic_vehicle v = three_wheels();
    const laconic_input input = no_input();
    const laconic_real wanted[3] = {0, 0, REAL(7)};
    laconic_real angle[3];
    laconic_model m;
    laconic_state state;
    v.wheel[2].locked = true;
    m = model_of(v);
    state = moving(&m, RHO, 1, 1);
    laconic_wheel_angles_set(&m, &state, wanted);
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.1, 50);
    laconic_wheel_angles(&m, &state, angle);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, (double)angle[2]);
}

/* ----------------------------------------------------------------------------- wheel torques -- */

static void torque_is_gain_times_voltage_less_damping_plus_what_is_applied(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const laconic_input input = every_input();
    laconic_real speed[3], torque[3];
    laconic_wheel_speeds(&m, &state, speed);
    laconic_wheel_torques(&m, &state, &input, torque);
    for (int i = 0; i < 3; i++)
        ASSERT_NEAR(2 * ROUNDING, GAIN * (1.5 - 0.7 * i) - DAMPING * (double)speed[i] + 0.02 * i - 0.03, torque[i]);
}

static void without_motors_only_the_applied_torque_is_left(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const laconic_input input = every_input();
    laconic_real torque[3];
    laconic_wheel_torques(&m, &state, &input, torque);
    ASSERT_NEAR(ROUNDING, 0.01, torque[2]);
}

/* -------------------------------------------------------------- integrals of the free motion -- */

/* ½ M v² + ½ I_S θ'² + Σ ½ J χ'², from velocities in m/s and rad/s alone. */
static void energy_is_that_of_the_moving_masses(laconic_vehicle v, double nu1, double nu2, double nu3) {
    const laconic_model m = model_of(v);
    const laconic_state state = moving(&m, nu1, nu2, nu3);
    const double speed_square = RADIUS * RADIUS * (nu1 * nu1 + nu2 * nu2), yaw = nu3 / BIG_LAMBDA;
    double energy = 0.5 * MASS * speed_square + 0.5 * 0.225 * yaw * yaw;
    laconic_real wheel[LACONIC_MAX_WHEELS];
    laconic_wheel_speeds(&m, &state, wheel);
    for (int i = 0; i < v.wheel_count; i++) energy += 0.5 * 0.009 * (double)wheel[i] * (double)wheel[i];
    ASSERT_NEAR(8 * ROUNDING, energy, laconic_energy_J(&m, &state));
}

static void energy_counts_body_and_wheels(void) {
    energy_is_that_of_the_moving_masses(three_wheels(), 0.7, -0.4, 1.9);
    energy_is_that_of_the_moving_masses(mecanum(), -0.2, 1.1, 0.3);
    energy_is_that_of_the_moving_masses(bare_body(), 1, 2, 3);
    energy_is_that_of_the_moving_masses(caster(), 1, 0, 3);
    energy_is_that_of_the_moving_masses(differential_drive(), -DELTA / BIG_LAMBDA * 2, 1, 2);
}

static void the_second_integral_is_the_third_component_of_a_nu(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const double square = SMALL_LAMBDA * SMALL_LAMBDA;
    const double expected = -RHO * square * 0.7 + (1 + (2 * SIGMA * SIGMA + RHO * RHO) * square) * 1.9;
    ASSERT_NEAR(4 * ROUNDING, expected, laconic_yaw_integral(&m, &state));
}

/* --------------------------------------------------------------------------------------- all -- */

static laconic_refusal why;

static void all_outputs_are_those_of_the_single_functions(void) {
    laconic_plant plant;
    laconic_outputs out;
    laconic_pose pose;
    laconic_real nu[3], velocity[2], wheels[LACONIC_MAX_WHEELS];
    const laconic_vehicle v = with_motors(mecanum());
    const laconic_input input = every_input();
    const laconic_start start = start_with(1, 2, 3);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 17, &why));
    laconic_outputs_of(&out, &plant, &input);
    laconic_nu(&plant.model, &plant.state, nu);
    TEST_ASSERT_EQUAL_MEMORY(nu, out.nu_rad_per_s, sizeof nu);
    laconic_pose_of(&pose, &plant.model, &plant.state);
    TEST_ASSERT_EQUAL_MEMORY(&pose, &out.pose, sizeof pose);
    TEST_ASSERT_TRUE(out.yaw_rate_rad_per_s == laconic_body_velocity(&plant.model, &plant.state, velocity));
    TEST_ASSERT_EQUAL_MEMORY(velocity, out.velocity_body_m_per_s, sizeof velocity);
    TEST_ASSERT_TRUE(out.energy_J == laconic_energy_J(&plant.model, &plant.state));
    laconic_wheel_speeds(&plant.model, &plant.state, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_speed_rad_per_s, 4 * sizeof wheels[0]);
    laconic_wheel_angles(&plant.model, &plant.state, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_angle_rad, 4 * sizeof wheels[0]);
    laconic_wheel_torques(&plant.model, &plant.state, &input, wheels);
    TEST_ASSERT_EQUAL_MEMORY(wheels, out.wheel_torque_Nm, 4 * sizeof wheels[0]);
    TEST_ASSERT_EQUAL_MEMORY(&input, &out.input, sizeof input);
}

/* Tests of what answers directions through a step of each method: it reads no number that it has not set. What the
 * answers are, test_step_derivatives.c compares with differences. */

/* A step, with and without a part of b that rotates, and two directions: one changes the model, too. */
typedef struct question {
    laconic_model model;
    laconic_integrator integrator;
    laconic_state state;
    taken_step step;
    dynamics_change dynamics;
    step_direction in[2];
} question;

static const dynamics_change some_dynamics = {
    {REAL(0.1), REAL(-0.2), REAL(0.3)},
    {REAL(-0.3), REAL(0.2), REAL(0.1)},
    {REAL(0.2), REAL(0.1), REAL(-0.1)},
    {REAL(0.4), REAL(-0.1), REAL(0.2)},
    {REAL(0.1), REAL(0.3), REAL(-0.2)},
    {{REAL(0.2), REAL(0.1), REAL(-0.1)}, {REAL(0.1), REAL(0.3), REAL(0.05)}, {REAL(-0.1), REAL(0.05), REAL(0.4)}}};

static void ask(question *q, const laconic_method *method, double step_s, bool rotates) {
    laconic_input held = every_input();
    memset(q, 0, sizeof *q);
    if (!rotates) held.world_force_N[0] = held.world_force_N[1] = 0;
    q->model = model_of(with_motors(three_wheels()));
    q->integrator = integrator_of(method, &q->model, step_s);
    q->state = moving(&q->model, 0.8, -0.5, 2.4);
    q->dynamics = some_dynamics;
    ASSERT_STATUS(LACONIC_OK, laconic_take_step(&q->step, &laconic_derivation_of_all, &q->model, &q->integrator,
                                                &q->state, &held, false));
    for (int k = 0; k < 2; k++) {
        q->in[k].zeta = lanes_of(vector_of(REAL(0.3), REAL(-0.2), REAL(0.7)));
        q->in[k].constant = lanes_of(vector_of(REAL(0.1), REAL(0.4), REAL(-0.6)));
        q->in[k].cosine = q->in[k].sine = rotates ? q->in[k].constant : no_lanes();
    }
    q->in[1].model = &q->dynamics;
}

/* Where `byte` was on the stack. */
typedef struct answers {
    step_result step;
    step_response by[2];
} answers;

static answers answered_over(const question *q, uint8_t byte) {
    answers a;
    memset(&a, 0, sizeof a);
    fill_stack(byte);
    q->step.responds(&a.step, a.by, &q->step.at, q->in, 2);
    return a;
}

static void what_lay_on_the_stack_changes_no_answer(void) {
    static const double step_s[3] = {0.01, 0.2, 0.8};
    FOR_EACH_DERIVED(number)
    for (int k = 0; k < 6; k++) {
        question q;
        const char *const name = laconic_method_by_number(number)->name;
        ask(&q, laconic_method_by_number(number), step_s[k / 2], k % 2 == 0);
        const answers clean = answered_over(&q, 0), spoilt = answered_over(&q, ALL_NAN);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&clean.step, &spoilt.step, sizeof clean.step, name);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(clean.by, spoilt.by, sizeof clean.by, name);
        TEST_ASSERT_TRUE(lane_number(spoilt.by[1].along_m, 0) == lane_number(spoilt.by[1].along_m, 0));
    }
}

/* Whether the columns are found without a number written to what the caller has on its stack, here `above`. */
static bool found_below(const core_columns *c, question *q) {
    volatile uint8_t above[1024];
    bool same = true;
    for (size_t i = 0; i < sizeof above; i++) above[i] = ALL_NAN;
    laconic_core_columns(c, &q->step, &q->state);
    for (size_t i = 0; i < sizeof above; i++) same = same && above[i] == ALL_NAN;
    return same;
}

/* Those of a step in which b rotates fill all directions that there is room for. */
static void columns_are_found_in_a_room_of_their_own(void) {
    bool (*volatile opaque)(const core_columns *, question *) = found_below;
    laconic_state_change column[CORE_COLUMNS];
    question q;
    core_columns c;
    ask(&q, &laconic_rk4, 0.01, true);
    memset(column, 0, sizeof column);
    laconic_jacobian_directions(&c, &q.model);
    for (int k = 0; k < CORE_COLUMNS; k++) c.column[k] = &column[k];
    TEST_ASSERT_TRUE(opaque(&c, &q));
    for (int k = 0; k < CORE_COLUMNS; k++) TEST_ASSERT_TRUE(column[k].x_m != 0 || column[k].y_m != 0);
}

/* With a change of the model or without, first or second. */
static void a_direction_beside_another_is_answered_as_alone(void) {
    static const double step_s[2] = {0.01, 0.8};
    FOR_EACH_DERIVED(number)
    for (int k = 0; k < 8; k++) {
        const char *const name = laconic_method_by_number(number)->name;
        question q;
        answers both;
        ask(&q, laconic_method_by_number(number), step_s[k / 4], k % 2 == 0);
        q.in[1].zeta = lanes_of(vector_of(REAL(-0.4), REAL(0.5), REAL(0.2)));
        if (k / 2 % 2 == 1) {
            const step_direction first = q.in[0];
            q.in[0] = q.in[1];
            q.in[1] = first;
        }
        memset(&both, 0, sizeof both);
        q.step.responds(&both.step, both.by, &q.step.at, q.in, 2);
        for (int i = 0; i < 2; i++) {
            answers alone;
            memset(&alone, 0, sizeof alone);
            q.step.responds(&alone.step, alone.by, &q.step.at, &q.in[i], 1);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&both.by[i], &alone.by[0], sizeof alone.by[0], name);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&both.step, &alone.step, sizeof alone.step, name);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(velocity_is_r_nu_and_yaw_rate_nu3_over_lambda);
    RUN_TEST(a_constrained_vehicle_shows_its_dependent_component);
    RUN_TEST(the_origin_lies_where_the_heading_puts_it);
    RUN_TEST(any_angle_is_wrapped_to_half_a_turn_on_either_side);
    RUN_TEST(the_position_is_that_of_the_pose_to_the_last_bit);
    RUN_TEST(wheel_speeds_are_xi_nu);
    RUN_TEST(a_wheel_with_its_axle_to_the_right_rolls_forward_when_the_vehicle_moves_forward);
    RUN_TEST(a_locked_wheel_has_no_speed);
    RUN_TEST(angles_start_at_zero_and_can_be_set);
    RUN_TEST(angles_grow_with_the_wheels_speed_from_what_they_were_set_to);
    RUN_TEST(the_angle_of_a_locked_wheel_stays);
    RUN_TEST(torque_is_gain_times_voltage_less_damping_plus_what_is_applied);
    RUN_TEST(without_motors_only_the_applied_torque_is_left);
    RUN_TEST(energy_counts_body_and_wheels);
    RUN_TEST(the_second_integral_is_the_third_component_of_a_nu);
    RUN_TEST(all_outputs_are_those_of_the_single_functions);
    RUN_TEST(what_lay_on_the_stack_changes_no_answer);
    RUN_TEST(columns_are_found_in_a_room_of_their_own);
    RUN_TEST(a_direction_beside_another_is_answered_as_alone);
    return UNITY_END();
}
