/* Tests of the derivation of one method: it gives what the functions for all methods give, bit by bit, and is of no
 * other method. */
#include "gauss_weight_change.h"

#include "laconic/derivatives.h"
#include "laconic/filter.h"
#include "stiff.h"

typedef struct derivation_case {
    const laconic_method *method;
    const laconic_derivation *derivation;
    double step_s;
    bool is_stiff;
} derivation_case;

static const derivation_case every_case[] = {
    {&laconic_rk4, &laconic_derivation_of_rk4, 0.05, false},
    {&laconic_taylor_8, &laconic_derivation_of_taylor_8, 0.05, false},
    {&laconic_exponential_gauss_8, &laconic_derivation_of_exponential_gauss_8, 0.05, true},
    {&laconic_exponential_kahan, &laconic_derivation_of_exponential_kahan, 0.05, true},
    {&laconic_exponential_kahan_4, &laconic_derivation_of_exponential_kahan_4, 0.05, true},
    {&laconic_exact_flow, &laconic_derivation_of_exact_flow, 0.05, true},
    {&laconic_exact_flow_4, &laconic_derivation_of_exact_flow_4, 0.05, false},
    {&laconic_auto, &laconic_derivation_of_auto, 0.01, false},
    {&laconic_auto, &laconic_derivation_of_auto, 0.1, true},
    {&laconic_auto, &laconic_derivation_of_auto_slow, 0.01, false},
    {&laconic_auto, &laconic_derivation_of_auto_fast, 0.1, true}};
#define CASES ((int)(sizeof every_case / sizeof every_case[0]))

typedef struct robot {
    laconic_model model;
    laconic_integrator integrator;
    laconic_state state;
} robot;

static robot robot_of(const derivation_case *c) {
    robot r;
    r.model = model_of(c->is_stiff ? stiff() : with_motors(three_wheels()));
    r.integrator = integrator_of(c->method, &r.model, c->step_s);
    r.state = moving(&r.model, 0.4, -0.3, 0.6);
    return r;
}

/* With a force fixed in the world, over which b varies, and without. */
static laconic_input held_with(bool world_force) {
    laconic_input held = every_input();
    if (world_force) return held;
    held.world_force_N[0] = held.world_force_N[1] = REAL(0);
    held.world_force_point_m[0] = held.world_force_point_m[1] = REAL(0);
    return held;
}

static void assert_jacobians_are_alike(const robot *r, const laconic_derivation *derivation,
                                       const laconic_input *held) {
    laconic_step_jacobian one, all;
    memset(&one, 0, sizeof one);
    memset(&all, 0, sizeof all);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_jacobian_by(&one, derivation, &r->model, &r->integrator, &r->state, held, true));
    ASSERT_STATUS(LACONIC_OK, laconic_step_jacobian_of(&all, &r->model, &r->integrator, &r->state, held, true));
    TEST_ASSERT_EQUAL_MEMORY(&all, &one, sizeof one);
}

static void assert_tangents_are_alike(const robot *r, const laconic_derivation *derivation, const laconic_input *held) {
    laconic_state_change before, one, all;
    memset(&before, 0, sizeof before);
    memset(&one, 0, sizeof one);
    memset(&all, 0, sizeof all);
    before.nu_rad_per_s[1] = before.heading_rad = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_step_tangent_by(&one, derivation, &r->model, &r->integrator, &r->state, held,
                                                      &before, NULL, NULL));
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_tangent(&all, &r->model, &r->integrator, &r->state, held, &before, NULL, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&all, &one, sizeof one);
    ASSERT_STATUS(LACONIC_OK, laconic_step_adjoint_by(&one, NULL, NULL, derivation, &r->model, &r->integrator,
                                                      &r->state, held, &before));
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_adjoint(&all, NULL, NULL, &r->model, &r->integrator, &r->state, held, &before));
    TEST_ASSERT_EQUAL_MEMORY(&all, &one, sizeof one);
}

static laconic_filter filter_of(const robot *r) {
    laconic_filter filter;
    laconic_filter_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.position_std_m = settings.heading_std_rad = settings.voltage_noise_V_per_sqrt_Hz = REAL(0.1);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &r->model, &settings, &r->state));
    return filter;
}

static void assert_predictions_are_alike(const robot *r, const laconic_derivation *derivation,
                                         const laconic_input *held) {
    laconic_filter one = filter_of(r), all = one;
    ASSERT_STATUS(LACONIC_OK, laconic_filter_predict_by(&one, derivation, &r->model, &r->integrator, held));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&all, &r->model, &r->integrator, held));
    TEST_ASSERT_EQUAL_MEMORY(&all, &one, sizeof one);
}

static void the_derivation_of_a_method_gives_what_that_of_all_gives(void) {
    for (int i = 0; i < 2 * CASES; i++) {
        const derivation_case *c = &every_case[i / 2];
        const robot r = robot_of(c);
        const laconic_input held = held_with(i % 2 == 1);
        assert_jacobians_are_alike(&r, c->derivation, &held);
        assert_tangents_are_alike(&r, c->derivation, &held);
        assert_predictions_are_alike(&r, c->derivation, &held);
    }
}

static void a_derivation_of_another_method_is_refused_and_nothing_is_written(void) {
    const robot r = robot_of(&every_case[0]);
    const laconic_input held = held_with(false);
    const laconic_filter before = filter_of(&r);
    laconic_step_jacobian jacobian, untouched;
    laconic_filter filter = before;
    memset(&jacobian, 7, sizeof jacobian);
    untouched = jacobian;
    for (int i = 1; i < CASES; i++) {
        const laconic_derivation *other = every_case[i].derivation;
        ASSERT_STATUS(LACONIC_METHOD_UNKNOWN,
                      laconic_step_jacobian_by(&jacobian, other, &r.model, &r.integrator, &r.state, &held, false));
        ASSERT_STATUS(LACONIC_METHOD_UNKNOWN,
                      laconic_filter_predict_by(&filter, other, &r.model, &r.integrator, &held));
    }
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &jacobian, sizeof jacobian);
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
}

static void an_adjoint_that_is_asked_for_less_gives_the_rest_as_it_is(void) {
    const robot r = robot_of(&every_case[0]);
    const laconic_input held = held_with(false);
    laconic_state_change before, alone, after;
    laconic_model_change by_model, by_model_alone;
    laconic_input input;
    memset(&after, 0, sizeof after);
    memset(&by_model, 0, sizeof by_model);
    memset(&by_model_alone, 0, sizeof by_model_alone);
    memset(&before, 0, sizeof before);
    memset(&alone, 0, sizeof alone);
    after.nu_rad_per_s[0] = after.x_m = REAL(1);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_adjoint(&before, &input, &by_model, &r.model, &r.integrator, &r.state, &held, &after));
    ASSERT_STATUS(LACONIC_OK, laconic_step_adjoint(&alone, NULL, &by_model_alone, &r.model, &r.integrator, &r.state,
                                                   &held, &after));
    TEST_ASSERT_EQUAL_MEMORY(&before, &alone, sizeof before);
    TEST_ASSERT_EQUAL_MEMORY(&by_model, &by_model_alone, sizeof by_model);
}

static void a_method_that_no_derivation_has_is_refused_by_that_of_all(void) {
    robot r = robot_of(&every_case[0]);
    laconic_step_jacobian jacobian;
    const laconic_input held = held_with(false);
    const laconic_method made_up = *r.integrator.chosen;
    r.integrator.chosen = &made_up;
    ASSERT_STATUS(LACONIC_METHOD_UNKNOWN,
                  laconic_step_jacobian_of(&jacobian, &r.model, &r.integrator, &r.state, &held, false));
}

/* Where none acts yet: along one axis alone as along both without the other. */
static void a_world_force_acts_along_each_axis_alone(void) {
    const robot r = robot_of(&every_case[0]);
    const laconic_input held = no_input();
    laconic_state_change after[3], still;
    memset(after, 0, sizeof after);
    memset(&still, 0, sizeof still);
    for (int k = 0; k < 3; k++) {
        laconic_input by = no_input();
        by.world_force_N[0] = REAL(k != 1);
        by.world_force_N[1] = REAL(k != 0);
        ASSERT_STATUS(LACONIC_OK,
                      laconic_step_tangent(&after[k], &r.model, &r.integrator, &r.state, &held, &still, &by, NULL));
    }
    ASSERT_NEAR(ROUNDING, after[2].x_m, after[0].x_m + after[1].x_m);
    ASSERT_NEAR(ROUNDING, after[2].y_m, after[0].y_m + after[1].y_m);
    TEST_ASSERT_TRUE(after[1].y_m > 0 && after[0].x_m > 0);
}

/* Tests of derivatives of collocation where an input turns the vehicle by radians within a step, so that its
 * rounds converge late; and of the room that its weights take. test_step_derivatives.c has the usual steps. */

#define ROWS (6 + LACONIC_MAX_WHEELS)
#define SMALL EITHER(1e-5, 4e-3)
#define CLOSE EITHER(1e-8, 1e-2)

typedef struct long_step {
    laconic_model model;
    laconic_integrator integrator;
    laconic_state state;
    laconic_input held;
} long_step;

/* A force fixed in the world that pulls far from the middle. */
typedef struct pull {
    bool has_motors; /* with their damping the step has panels, without it is one */
    double force_N, moment_Nm, step_s;
} pull;

static long_step step_under(const pull *by) {
    long_step s;
    s.model = model_of(by->has_motors ? with_motors(three_wheels()) : three_wheels());
    s.integrator = integrator_of(&laconic_exponential_gauss_8, &s.model, by->step_s);
    s.state = moving(&s.model, 0.8, -0.5, 2.4);
    s.held = every_input();
    s.held.world_force_N[0] = REAL(by->force_N);
    s.held.world_force_point_m[0] = REAL(0.5);
    s.held.body_moment_Nm = REAL(by->moment_Nm);
    return s;
}

static void end_of(double end[ROWS], const long_step *s, const laconic_state_change *along,
                   const laconic_input *and_along, double by) {
    laconic_start start;
    laconic_state state;
    laconic_input held = s->held;
    laconic_real nu[3], pose[3], angle[LACONIC_MAX_WHEELS];
    memset(&start, 0, sizeof start);
    laconic_nu(&s->model, &s->state, start.nu_rad_per_s);
    for (int k = 0; k < 3; k++) start.nu_rad_per_s[k] += REAL(by) * along->nu_rad_per_s[k];
    start.heading_rad = REAL(by) * along->heading_rad;
    held.voltage_V[0] += REAL(by) * and_along->voltage_V[0];
    held.world_force_N[1] += REAL(by) * and_along->world_force_N[1];
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, &s->model, &start, NULL));
    ASSERT_STATUS(LACONIC_OK, laconic_step(&s->model, &s->integrator, &state, &held));
    laconic_nu(&s->model, &state, nu);
    laconic_position(&state, &pose[0], &pose[1], &pose[2]);
    laconic_wheel_angles(&s->model, &state, angle);
    for (int k = 0; k < 3; k++) end[k] = (double)nu[k];
    for (int k = 0; k < 3; k++) end[3 + k] = (double)pose[k];
    for (int k = 0; k < s->model.wheel_count; k++) end[6 + k] = (double)angle[k];
}

static void the_tangent_is_what_differences_show(const long_step *s) {
    const int rows = 6 + s->model.wheel_count;
    laconic_state_change along, after;
    laconic_input and_along = no_input();
    double high[ROWS], low[ROWS], found[ROWS], size = 1;
    memset(&along, 0, sizeof along);
    memset(&after, 0, sizeof after);
    along.nu_rad_per_s[1] = REAL(1);
    along.nu_rad_per_s[2] = along.heading_rad = REAL(0.5);
    and_along.voltage_V[0] = REAL(1);
    and_along.world_force_N[1] = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_step_tangent(&after, &s->model, &s->integrator, &s->state, &s->held, &along,
                                                   &and_along, NULL));
    end_of(high, s, &along, &and_along, SMALL);
    end_of(low, s, &along, &and_along, -SMALL);
    for (int k = 0; k < 3; k++) found[k] = (double)after.nu_rad_per_s[k];
    found[3] = (double)after.x_m;
    found[4] = (double)after.y_m;
    found[5] = (double)after.heading_rad;
    for (int k = 6; k < rows; k++) found[k] = (double)after.wheel_angle_rad[k - 6];
    for (int k = 0; k < rows; k++) size = fmax(size, fabs(found[k]));
    for (int k = 0; k < rows; k++) ASSERT_NEAR(CLOSE * size, (high[k] - low[k]) / (2 * SMALL), found[k]);
}

/* ROUNDS are not enough for these. */
static void rounds_that_converge_late_are_linearised_at_the_solution(void) {
    static const pull pulls[] = {
        {false, 10, EITHER(0, -8), 0.8}, {false, 16, -8, 0.8}, {false, 27, 8, 0.8}, {true, 10, 8, 0.8}};
    for (size_t n = 0; n < sizeof pulls / sizeof pulls[0]; n++) {
        const long_step s = step_under(&pulls[n]);
        the_tangent_is_what_differences_show(&s);
    }
}

static void no_number_behind_the_weights_is_written(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const linear_map every = {vector_of(3, 3, 3), vector_of(3, 3, 3), vector_of(3, 3, 3)};
    struct {
        gauss_weight_change change;
        laconic_real behind;
    } room;
    room.behind = 7;
    laconic_gauss_weight_change_of(&room.change, &m, REAL(0.1), &every);
    TEST_ASSERT_TRUE(room.behind == 7);
}

/* From h·r = 4 on the function beyond those of a step is their difference, below it a series, whose terms alternate. */
static void weights_at_the_end_of_the_series_have_the_digits_of_the_difference(void) {
    const linear_map first = {vector_of(1, 0, 0), none, none};
    gauss_weight_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = 4;
    laconic_gauss_weight_change_of(&change, &m, 1, &first);
    ASSERT_NEAR(EITHER(1.9e-16, 1.6e-7), -0.0076565362670373192985, change.entry[0][OF_MEAN + 2]);
}

/* A step of which the rounds do not find the solution has no derivative, either. */
static void a_step_without_a_solution_has_no_derivative(void) {
    const pull by = {false, 5, 8, 0.8};
    const long_step s = step_under(&by);
    laconic_state_change before, after;
    memset(&before, 0, sizeof before);
    before.nu_rad_per_s[0] = 1;
    ASSERT_STATUS(LACONIC_STEP_SINGULAR,
                  laconic_step_tangent(&after, &s.model, &s.integrator, &s.state, &s.held, &before, NULL, NULL));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_derivation_of_a_method_gives_what_that_of_all_gives);
    RUN_TEST(a_derivation_of_another_method_is_refused_and_nothing_is_written);
    RUN_TEST(an_adjoint_that_is_asked_for_less_gives_the_rest_as_it_is);
    RUN_TEST(a_method_that_no_derivation_has_is_refused_by_that_of_all);
    RUN_TEST(a_world_force_acts_along_each_axis_alone);
    RUN_TEST(no_number_behind_the_weights_is_written);
    RUN_TEST(rounds_that_converge_late_are_linearised_at_the_solution);
    RUN_TEST(weights_at_the_end_of_the_series_have_the_digits_of_the_difference);
    RUN_TEST(a_step_without_a_solution_has_no_derivative);
    return UNITY_END();
}
