/* Tests of exact_flow.c: order, energy and K, free motion in closed form, refusals. */
#include "step_internals.h"

#include "stiff.h"

/* ------------------------------------------------------------------------------ second order -- */

static void is_of_second_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exact_flow, &v, start_with(2, 1, 4), &input, 2.0, EITHER(100, 40), 2);
}

static void free_motion_is_exact_at_any_step(laconic_vehicle v, laconic_start start, double time) {
    const laconic_input input = no_input();
    for (int steps = 1; steps < 40; steps *= 3) {
        const errors e = errors_of(&laconic_exact_flow, &v, start, &input, time, steps);
        TEST_ASSERT_TRUE(e.nu < EITHER(2e-12, 2e-5));
    }
}

/* A periodic motion in which ν3 keeps its sign, one that tends to straight motion, and one that is straight at once. */
static void free_motion_is_exact_of_every_kind(void) {
    free_motion_is_exact_at_any_step(three_wheels(), start_with(0.5, 0.3, 4), 5);
    free_motion_is_exact_at_any_step(three_wheels(), start_with(2, 3, 0.4), 5);
    free_motion_is_exact_at_any_step(three_wheels(), start_with(-2, -3, -0.4), 5);
    free_motion_is_exact_at_any_step(three_wheels(), start_with(1, 2, 0), 5);
    free_motion_is_exact_at_any_step(mecanum(), start_with(1, 2, -3), 5);
    free_motion_is_exact_at_any_step(bare_body(), start_with(1, 2, 3), 5);
}

/* With heading as the variable, (ν1, ν2)(φ) rotates with Ω = √det P about P S₂, and ν3 follows from K. */
static void free_motion_is_the_papers_closed_form(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_model m = model_of(v);
    const laconic_input input = no_input();
    laconic_state state = moving(&m, 0.5, 0.3, 4);
    laconic_matrices x;
    laconic_real nu[3];
    laconic_pose pose;
    double p[2][2], omega, c, s, expected[3];
    const double k = (double)laconic_yaw_integral(&m, &state);
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, &v, NULL));
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.025, 400);
    laconic_nu(&m, &state, nu);
    laconic_pose_of(&pose, &m, &state);
    p[0][0] = (double)x.inverse_inertia[0][0], p[0][1] = (double)x.inverse_inertia[0][1];
    p[1][0] = (double)x.inverse_inertia[1][0], p[1][1] = (double)x.inverse_inertia[1][1];
    omega = sqrt(p[0][0] * p[1][1] - p[0][1] * p[1][0]);
    c = cos(omega * (double)pose.heading_rad);
    s = sin(omega * (double)pose.heading_rad) / omega;
    expected[0] = c * 0.5 + s * (p[0][0] * 0.3 - p[0][1] * 0.5); /* P S₂ ν, S₂ ν = (ν2, −ν1) */
    expected[1] = c * 0.3 + s * (p[1][0] * 0.3 - p[1][1] * 0.5);
    expected[2] =
        (k - (double)x.inertia[0][2] * expected[0] - (double)x.inertia[1][2] * expected[1]) / (double)x.inertia[2][2];
    ASSERT_NEAR_ALL(EITHER(1e-6, 2e-5), expected, nu, 3); /* the heading is of second order */
}

static void energy_and_k_stay_to_rounding(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exact_flow, &v, 0.1, 20000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-13, 1e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-13, 1e-5));
}

static void energy_stays_even_at_steps_of_many_turns(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exact_flow, &v, 30.0, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-12, 1e-4));
}

static void damped_motion_loses_energy_at_every_step_size(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = no_input();
    for (double step = 1e-3; step < 1e3; step *= 3.7) {
        const laconic_integrator in = integrator_of(&laconic_exact_flow, &m, step);
        laconic_state state = moving(&m, 20, -30, 40);
        laconic_real energy = laconic_energy_J(&m, &state);
        for (int i = 0; i < 50; i++) {
            ASSERT_STATUS(LACONIC_OK, laconic_step(&m, &in, &state, &input));
            TEST_ASSERT_TRUE((double)laconic_energy_J(&m, &state) <=
                             (double)energy * (1 + 4 * (double)LACONIC_EPSILON));
            energy = laconic_energy_J(&m, &state);
        }
    }
}

static void a_stiff_vehicle_stays_bounded(void) {
    const laconic_model m = model_of(stiff());
    laconic_state state = moving(&m, 5, 5, 5);
    laconic_input input = no_input();
    laconic_real nu[3];
    input.voltage_V[0] = REAL(1);
    take_steps(&laconic_exact_flow, &m, &state, &input, 0.1, 200);
    laconic_nu(&m, &state, nu);
    TEST_ASSERT_TRUE(fabs((double)nu[0]) + fabs((double)nu[1]) + fabs((double)nu[2]) < 5);
}

static void numbers_beyond_the_range_are_refused(void) {
    laconic_input input = no_input();
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_exact_flow, three_wheels(), start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

/* From rest, by a voltage that makes as many units of velocity in a second. */
static void a_step_may_lead_to_the_largest_speed_and_not_beyond(void) {
    for (int k = 0; k < 2; k++) {
        const laconic_real speed = LARGEST_SPEED * (1 + 2 * REAL(k) * LACONIC_EPSILON);
        laconic_input input = no_input();
        laconic_model m;
        laconic_state state;
        memset(&m, 0, sizeof m);
        memset(&state, 0, sizeof state);
        m.wheel_count = 1;
        m.wheel_of_zeta[0][0] = m.voltage_scale[0] = REAL(1);
        input.voltage_V[0] = speed;
        const laconic_integrator in = integrator_of(&laconic_exact_flow, &m, 1);
        ASSERT_STATUS(k == 0 ? LACONIC_OK : LACONIC_OVERFLOW, laconic_step(&m, &in, &state, &input));
        TEST_ASSERT_TRUE(state.zeta[0].value == (k == 0 ? speed : 0));
    }
}

/* Straight on at an eighth of it a second, eight metres for each unit of velocity. */
static void a_step_is_shorter_than_the_yaw_that_can_be_counted(void) {
    for (int k = 0; k < 2; k++) {
        const laconic_real speed = LARGEST_YAW_CHANGE_RAD / 8 * (1 - REAL(k) * LACONIC_EPSILON);
        const laconic_input input = no_input();
        laconic_model m;
        laconic_state state;
        memset(&m, 0, sizeof m);
        memset(&state, 0, sizeof state);
        m.velocity_of_zeta[k][0] = REAL(8);
        state.zeta[0].value = speed;
        const laconic_integrator in = integrator_of(&laconic_exact_flow, &m, 1);
        ASSERT_STATUS(k == 0 ? LACONIC_OVERFLOW : LACONIC_OK, laconic_step(&m, &in, &state, &input));
        TEST_ASSERT_TRUE(state.x_m.value == 0 && state.y_m.value == (k == 0 ? 0 : 8 * speed));
    }
}

static void more_turns_in_a_step_than_can_be_counted_are_refused(void) {
    assert_step_refused(&laconic_exact_flow, caster(), start_with(1, 0, EITHER(1e20, 1e6)), no_input(), 1e8,
                        LACONIC_OVERFLOW);
}

/* So slow that its square is 0, and turned by far: nothing is divided by that square. */
static void a_motion_whose_square_is_no_number_any_more_is_turned(void) {
    const laconic_real slow = REAL(EITHER(1e-170, 1e-27));
    const laconic_input input = no_input();
    laconic_model m;
    laconic_state state;
    memset(&m, 0, sizeof m);
    memset(&state, 0, sizeof state);
    m.nu_of_zeta[2][2] = 1 / slow;
    m.gyro[0] = m.gyro_square = REAL(1);
    for (int k = 0; k < 3; k++) state.zeta[k].value = slow;
    take_steps(&laconic_exact_flow, &m, &state, &input, 2, 1);
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(state.zeta[k].value == 0); /* as what has decayed ends */
}

static void a_method_that_only_auto_chooses_is_not_prepared(void) {
    const laconic_model m = model_of(bare_body());
    laconic_integrator in;
    laconic_refusal why;
    ASSERT_STATUS(LACONIC_METHOD_UNKNOWN, laconic_integrator_prepare(&in, &laconic_auto_slow, &m, REAL(0.1), &why));
}

/* ------------------------------------------------------------------------------ fourth order -- */

static void is_of_fourth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    assert_order(&laconic_exact_flow_4, &v, start_with(2, 1, 4), &input, 2.0, EITHER(40, 8), 4);
}

static void is_of_fourth_order_without_a_world_force(void) {
    const laconic_vehicle v = with_motors(mecanum());
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_order(&laconic_exact_flow_4, &v, start_with(2, 1, 4), &input, 1.0, EITHER(40, 3), 4);
}

static void free_motion_is_exact(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_input input = no_input();
    const errors e = errors_of(&laconic_exact_flow_4, &v, start_with(1, 2, 3), &input, 4.0, 40);
    TEST_ASSERT_TRUE(e.nu < EITHER(2e-12, 2e-5));
}

static void energy_and_k_stay_to_rounding_in_the_extrapolated(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exact_flow_4, &v, 0.05, 10000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-13, 2e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-13, 2e-5));
}

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_exact_flow_4, bare_body(), every_input(), 1.0, 10);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_second_order_under_everything_that_can_act);
    RUN_TEST(free_motion_is_exact_of_every_kind);
    RUN_TEST(free_motion_is_the_papers_closed_form);
    RUN_TEST(energy_and_k_stay_to_rounding);
    RUN_TEST(energy_stays_even_at_steps_of_many_turns);
    RUN_TEST(damped_motion_loses_energy_at_every_step_size);
    RUN_TEST(a_stiff_vehicle_stays_bounded);
    RUN_TEST(a_motion_whose_square_is_no_number_any_more_is_turned);
    RUN_TEST(a_method_that_only_auto_chooses_is_not_prepared);
    RUN_TEST(numbers_beyond_the_range_are_refused);
    RUN_TEST(a_step_may_lead_to_the_largest_speed_and_not_beyond);
    RUN_TEST(a_step_is_shorter_than_the_yaw_that_can_be_counted);
    RUN_TEST(more_turns_in_a_step_than_can_be_counted_are_refused);
    RUN_TEST(is_of_fourth_order_under_everything_that_can_act);
    RUN_TEST(is_of_fourth_order_without_a_world_force);
    RUN_TEST(free_motion_is_exact);
    RUN_TEST(energy_and_k_stay_to_rounding_in_the_extrapolated);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    return UNITY_END();
}
