/* Tests of exact_flow.c: order, energy and K, free motion in closed form, refusals. */
#include "step_internals.h"

#include "check.h"
#include "exact_steps.h"
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

/* One step of made-up vehicles by every method beside the same map in 50 digits, which has no code of the core's:
 * rollers, fixed wheels, a locked one, wheels of their own, none; payloads, slopes, forces fixed in the world; damping
 * from slow to stiff, yaws of a step on both sides of the polynomials' bounds. */

/* The tables' numbers, one after the other. */
typedef struct reader {
    const double *at;
} reader;

static laconic_real next(reader *from) { return REAL(*from->at++); }

static void read_wheel(laconic_wheel *wheel, reader *from) {
    wheel->kind = (laconic_wheel_kind)next(from);
    wheel->locked = next(from) > 0;
    wheel->undriven = next(from) > 0;
    laconic_real *const to[8] = {&wheel->x_m,
                                 &wheel->y_m,
                                 &wheel->axle_rad,
                                 &wheel->roller_rad,
                                 &wheel->own_radius_m,
                                 &wheel->own_inertia_kgm2,
                                 &wheel->own_motor_gain_Nm_per_V,
                                 &wheel->own_motor_damping_Nms};
    for (int k = 0; k < 8; k++) *to[k] = next(from);
}

static void read_input(laconic_input *input, reader *from) {
    for (int i = 0; i < EXACT_WHEELS; i++) input->voltage_V[i] = next(from);
    for (int i = 0; i < EXACT_WHEELS; i++) input->axle_torque_Nm[i] = next(from);
    for (int k = 0; k < 2; k++) input->body_force_N[k] = next(from);
    input->body_moment_Nm = next(from);
    for (int k = 0; k < 2; k++) input->world_force_N[k] = next(from);
    for (int k = 0; k < 2; k++) input->world_force_point_m[k] = next(from);
}

typedef struct given {
    laconic_vehicle vehicle;
    laconic_real step_s;
    laconic_start start;
    laconic_input input;
} given;

static given read_case(int number) {
    reader from = {exact_given[number]};
    given g;
    memset(&g, 0, sizeof g);
    laconic_vehicle *v = &g.vehicle;
    laconic_real *const to[14] = {&v->mass_kg,
                                  &v->yaw_inertia_kgm2,
                                  &v->com_x_m,
                                  &v->com_y_m,
                                  &v->wheel_radius_m,
                                  &v->wheel_inertia_kgm2,
                                  &v->motor_gain_Nm_per_V,
                                  &v->motor_damping_Nms,
                                  &v->payload.mass_kg,
                                  &v->payload.x_m,
                                  &v->payload.y_m,
                                  &v->payload.yaw_inertia_kgm2,
                                  &v->ground.slope_rad,
                                  &v->ground.slope_heading_rad};
    for (int k = 0; k < 14; k++) *to[k] = next(&from);
    g.step_s = next(&from);
    for (int k = 0; k < 3; k++) g.start.nu_rad_per_s[k] = next(&from);
    g.start.heading_rad = next(&from);
    v->wheel_count = (int32_t)next(&from);
    for (int i = 0; i < EXACT_WHEELS; i++) read_wheel(&v->wheel[i], &from);
    read_input(&g.input, &from);
    TEST_ASSERT_TRUE(from.at == exact_given[number] + EXACT_GIVEN);
    return g;
}

/* The largest magnitude, but not below `least`. */
static double size_of(const double *values, int count, double least) {
    double size = least;
    for (int k = 0; k < count; k++) size = fabs(values[k]) > size ? fabs(values[k]) : size;
    return size;
}

static void assert_state(const given *g, const laconic_plant *plant, const double *expected) {
    laconic_real nu[3], angle[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    double fastest = 0;
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    laconic_plant_wheel_angles(plant, angle);
    for (int k = 0; k < 3; k++) fastest = fmax(fastest, fabs((double)g->start.nu_rad_per_s[k]));
    const double turned = fastest * (double)g->step_s, rolled = turned * (double)g->vehicle.wheel_radius_m;
    const laconic_real position[2] = {pose.x_m, pose.y_m};
    /* Cramer's rule in a stiff step costs a digit. */
    ASSERT_NEAR_ALL(EITHER(2e-14, 6e-6) * size_of(expected, 3, 0), expected, nu, 3);
    /* One coefficient of the chord is exact to 3e-12 of what is of second order in the step. */
    ASSERT_NEAR_ALL(EITHER(6e-14, 2e-6) * size_of(expected + 3, 2, rolled), expected + 3, position, 2);
    ASSERT_NEAR(EITHER(4e-15, 4e-6) * size_of(expected + 5, 1, 0), expected[5], pose.heading_rad);
    ASSERT_NEAR_ALL(EITHER(4e-15, 4e-6) * size_of(expected + 6, g->vehicle.wheel_count, turned), expected + 6, angle,
                    g->vehicle.wheel_count);
}

/* False: the core does not take the step. */
static bool is_taken(const given *g, laconic_plant *plant, const laconic_method *method) {
    laconic_start rest;
    memset(&rest, 0, sizeof rest);
    memset(plant, 0, sizeof *plant);
    rest.heading_rad = g->start.heading_rad;
    if (laconic_plant_start(plant, &g->vehicle, method, g->step_s, &rest, NULL) != LACONIC_OK) return false;
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&plant->state, &plant->model, &g->start, NULL));
    return laconic_plant_run(plant, &g->input, 1, NULL) == LACONIC_OK;
}

static laconic_plant plant;

static void every_method_takes_the_step_that_its_derivation_states(void) {
    int taken = 0;
    for (int number = 0; number < EXACT_CASES; number++) {
        const given g = read_case(number);
        for (int k = 0; k < EXACT_METHODS; k++) {
            const double *expected = exact_found[number][k];
            const laconic_method *method = laconic_method_by_name(exact_method[k]);
            TEST_ASSERT_NOT_NULL(method);
            const bool is_refused = expected[0] >= REFUSED;
            TEST_ASSERT_EQUAL(!is_refused, is_taken(&g, &plant, method));
            if (is_refused) continue;
            assert_state(&g, &plant, expected);
            taken++;
        }
    }
    TEST_ASSERT_TRUE(taken > EXACT_CASES * (EXACT_METHODS - 1));
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
    RUN_TEST(every_method_takes_the_step_that_its_derivation_states);
    return UNITY_END();
}
