/* Tests of tangent, adjoint and Jacobian where only a part is asked for or acts: a gradient without others, a slope
 * along one axis, wheels that are not there. test_step_derivatives.c compares with differences of the step. */
#include "methods.h"
#include "stiff.h"

#define CLOSE EITHER(1e-12, 1e-4)
#define UNTOUCHED 7 /* in every byte */

typedef struct robot {
    laconic_model model;
    laconic_integrator integrator;
    laconic_state state;
} robot;

static robot robot_by(const laconic_method *method, laconic_vehicle v) {
    robot r;
    r.model = model_of(v);
    r.integrator = integrator_of(method, &r.model, 0.05);
    r.state = moving(&r.model, 0.4, -0.3, 0.6);
    return r;
}

static laconic_vehicle with_wheels(int count) {
    laconic_vehicle v = with_motors(bare_body());
    for (int i = 0; i < count; i++)
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1 * i - 0.2, 0.1, PI / 4 * i, PI / 2 - 0.05 * i);
    return v;
}

static laconic_input without_world_force(void) {
    laconic_input held = every_input();
    held.world_force_N[0] = held.world_force_N[1] = 0;
    return held;
}

static laconic_state_change some_change(void) {
    laconic_state_change c = {{REAL(0.3), REAL(-0.2), REAL(0.5)}, REAL(0.1), REAL(0.7), REAL(-0.4), {0}};
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) c.wheel_angle_rad[i] = REAL(0.2 - 0.1 * i);
    return c;
}

/* Also by a force fixed in the world where none acts. */
static void a_gradient_by_the_input_needs_none_by_the_model(void) {
    const laconic_input held = without_world_force();
    const laconic_state_change after = some_change();
    FOR_EACH_DERIVED(number) {
        const robot r = robot_by(laconic_method_by_number(number), with_wheels(4));
        laconic_state_change before, alone;
        laconic_input input, input_alone;
        laconic_model_change by_model;
        memset(&before, UNTOUCHED, sizeof before);
        memset(&input, UNTOUCHED, sizeof input);
        alone = before;
        input_alone = input;
        ASSERT_STATUS(LACONIC_OK, laconic_step_adjoint(&before, &input, &by_model, &r.model, &r.integrator, &r.state,
                                                       &held, &after));
        ASSERT_STATUS(LACONIC_OK, laconic_step_adjoint(&alone, &input_alone, NULL, &r.model, &r.integrator, &r.state,
                                                       &held, &after));
        TEST_ASSERT_EQUAL_MEMORY(&before, &alone, sizeof before);
        TEST_ASSERT_EQUAL_MEMORY(&input, &input_alone, sizeof input);
        TEST_ASSERT_TRUE(fabs((double)input.world_force_N[1]) > 1e-5);
    }
}

/* The pull of a slope is a force fixed in the world at S. */
static void a_slope_changes_a_step_as_a_force_at_the_centre_of_mass_does(void) {
    const laconic_input held = no_input();
    const laconic_state_change none = {{0}, 0, 0, 0, {0}};
    FOR_EACH_DERIVED(number)
    for (int k = 0; k < 2; k++) {
        const robot r = robot_by(laconic_method_by_number(number), with_wheels(4));
        laconic_state_change by_slope = none, by_force = none;
        laconic_input force = no_input();
        struct {
            laconic_model_change slope;
            laconic_real behind; /* is no part of it */
        } by;
        memset(&by, 0, sizeof by);
        by.slope.slope_force_N[k] = force.world_force_N[k] = REAL(1);
        ASSERT_STATUS(LACONIC_OK, laconic_step_tangent(&by_slope, &r.model, &r.integrator, &r.state, &held, &none, NULL,
                                                       &by.slope));
        ASSERT_STATUS(LACONIC_OK,
                      laconic_step_tangent(&by_force, &r.model, &r.integrator, &r.state, &held, &none, &force, NULL));
        ASSERT_NEAR_ALL(CLOSE * fabs((double)by_force.x_m), &by_force.x_m, &by_slope.x_m, 2);
        ASSERT_NEAR_ALL(CLOSE, by_force.nu_rad_per_s, by_slope.nu_rad_per_s, 3);
        ASSERT_NEAR_ALL(CLOSE, by_force.wheel_angle_rad, by_slope.wheel_angle_rad, 4);
        TEST_ASSERT_TRUE((k == 0 ? by_slope.x_m : by_slope.y_m) > 0);
    }
}

/* A velocity beyond the range, which all that auto tries in turn refuse. */
static void what_every_method_of_auto_refuses_has_no_derivative(void) {
    for (int is_stiff = 0; is_stiff < 2; is_stiff++) {
        robot r = robot_by(&laconic_auto, is_stiff ? stiff() : with_wheels(4));
        const laconic_input held = no_input();
        const laconic_state_change before = some_change();
        laconic_state_change after, untouched;
        memset(&after, UNTOUCHED, sizeof after);
        untouched = after;
        r.state.zeta[0].value = REAL(EITHER(1e78, 1e10));
        laconic_state state = r.state;
        const laconic_status refused = laconic_step(&r.model, &r.integrator, &state, &held);
        TEST_ASSERT_TRUE(refused != LACONIC_OK && r.integrator.stiff == (is_stiff == 1));
        ASSERT_STATUS(refused,
                      laconic_step_tangent(&after, &r.model, &r.integrator, &r.state, &held, &before, NULL, NULL));
        ASSERT_STATUS(refused,
                      laconic_step_adjoint(&after, NULL, NULL, &r.model, &r.integrator, &r.state, &held, &before));
        TEST_ASSERT_EQUAL_MEMORY(&untouched, &after, sizeof after);
    }
}

/* ---------------------------------------------------------------------------- wheels that are not there -- */

static void assert_written_up_to(int wheels, const laconic_state_change *change) {
    laconic_real untouched;
    memset(&untouched, UNTOUCHED, sizeof untouched);
    for (int i = 0; i < wheels; i++) TEST_ASSERT_TRUE(isfinite((double)change->wheel_angle_rad[i]));
    for (int i = wheels; i < LACONIC_MAX_WHEELS; i++)
        TEST_ASSERT_EQUAL_MEMORY(&untouched, &change->wheel_angle_rad[i], sizeof untouched);
}

static void spoil_input(laconic_input *input, int wheels) {
    for (int i = wheels; i < LACONIC_MAX_WHEELS; i++) input->voltage_V[i] = input->axle_torque_Nm[i] = NOT_A_NUMBER;
}

static laconic_state_change change_of(int wheels) {
    laconic_state_change change = some_change();
    for (int i = wheels; i < LACONIC_MAX_WHEELS; i++) change.wheel_angle_rad[i] = NOT_A_NUMBER;
    return change;
}

static laconic_model_change model_change_of(int wheels) {
    laconic_model_change by;
    memset(&by, 0, sizeof by);
    by.torque_scale = REAL(0.1);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        by.voltage_scale[i] = i < wheels ? REAL(0.2) : NOT_A_NUMBER;
        for (int k = 0; k < 3; k++) by.wheel_of_zeta[i][k] = i < wheels ? REAL(0.3 * k - 0.1 * i) : NOT_A_NUMBER;
    }
    return by;
}

static void assert_tangent_of(const robot *r, int wheels, const laconic_input *held) {
    const laconic_state_change before = change_of(wheels);
    const laconic_model_change by_model = model_change_of(wheels);
    laconic_state_change after;
    memset(&after, UNTOUCHED, sizeof after);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_tangent(&after, &r->model, &r->integrator, &r->state, held, &before, held, &by_model));
    assert_written_up_to(wheels, &after);
}

static void assert_adjoint_of(const robot *r, int wheels, const laconic_input *held) {
    const laconic_state_change after = change_of(wheels);
    laconic_state_change before;
    laconic_input input;
    laconic_model_change by_model;
    memset(&before, UNTOUCHED, sizeof before);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_adjoint(&before, &input, &by_model, &r->model, &r->integrator, &r->state, held, &after));
    assert_written_up_to(wheels, &before);
    for (int i = wheels; i < LACONIC_MAX_WHEELS; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)by_model.voltage_scale[i]);
        for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_DOUBLE(0, (double)by_model.wheel_of_zeta[i][k]);
    }
}

static void assert_jacobian_of(const robot *r, int wheels, const laconic_input *held) {
    laconic_step_jacobian j;
    memset(&j, UNTOUCHED, sizeof j);
    ASSERT_STATUS(LACONIC_OK, laconic_step_jacobian_of(&j, &r->model, &r->integrator, &r->state, held, true));
    for (int k = 0; k < 3; k++) assert_written_up_to(wheels, &j.by_nu[k]);
    assert_written_up_to(wheels, &j.by_heading);
    for (int k = 0; k < wheels; k++) assert_written_up_to(wheels, &j.by_voltage[k]);
    for (int k = 0; k < wheels; k++) assert_written_up_to(wheels, &j.by_axle_torque[k]);
    for (int k = 0; k < 2; k++) assert_written_up_to(wheels, &j.by_body_force[k]);
    assert_written_up_to(wheels, &j.by_body_moment);
    for (int k = 0; k < 2; k++) assert_written_up_to(wheels, &j.by_world_force[k]);
    for (int k = 0; k < 2; k++) assert_written_up_to(wheels, &j.by_world_force_point[k]);
}

/* Up to a vehicle with as many wheels as there may be, behind which the arrays end. */
static void wheels_beyond_the_model_s_are_neither_read_nor_written(void) {
    for (int wheels = 0; wheels <= LACONIC_MAX_WHEELS; wheels++)
        for (int world = 0; world < 2; world++) {
            const robot r = robot_by(&laconic_exponential_gauss_8, with_wheels(wheels));
            laconic_input held = world == 0 ? without_world_force() : every_input();
            spoil_input(&held, wheels);
            assert_tangent_of(&r, wheels, &held);
            assert_adjoint_of(&r, wheels, &held);
            assert_jacobian_of(&r, wheels, &held);
        }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_gradient_by_the_input_needs_none_by_the_model);
    RUN_TEST(a_slope_changes_a_step_as_a_force_at_the_centre_of_mass_does);
    RUN_TEST(what_every_method_of_auto_refuses_has_no_derivative);
    RUN_TEST(wheels_beyond_the_model_s_are_neither_read_nor_written);
    return UNITY_END();
}
