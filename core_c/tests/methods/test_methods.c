/* Tests of methods.c: numbers and names of the methods, and that each row of methods.h states what its source does. */
#include "check.h"
#include "eighth_order.h"
#include "stiff.h"

typedef struct row {
    int32_t number;
    const char *identifier, *name;
    int32_t order;
    const laconic_method *method;
} row;

#define ROW(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) \
    {number, #identifier, name, order, &laconic_##identifier},
static const row rows[] = {LACONIC_METHODS(ROW)};
#define ROWS ((int32_t)(sizeof rows / sizeof rows[0]))

static void every_number_has_its_method_and_every_name_leads_back(void) {
    TEST_ASSERT_EQUAL_INT32(LACONIC_METHOD_COUNT, ROWS);
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_INT32(i, rows[i].number);
        TEST_ASSERT_EQUAL_PTR(rows[i].method, laconic_method_by_number(i));
        TEST_ASSERT_EQUAL_PTR(rows[i].method, laconic_method_by_name(rows[i].name));
    }
}

static void a_row_has_the_name_and_the_order_of_its_source(void) {
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_STRING(rows[i].name, rows[i].method->name);
        TEST_ASSERT_EQUAL_INT32(rows[i].order, rows[i].method->order);
    }
}

static void a_name_is_the_identifier_with_hyphens(void) {
    for (int32_t i = 0; i < ROWS; i++) {
        TEST_ASSERT_EQUAL_size_t(strlen(rows[i].identifier), strlen(rows[i].name));
        for (size_t k = 0; k < strlen(rows[i].name); k++)
            TEST_ASSERT_EQUAL_CHAR(rows[i].identifier[k] == '_' ? '-' : rows[i].identifier[k], rows[i].name[k]);
    }
}

static void no_two_methods_have_one_name(void) {
    for (int32_t i = 0; i < ROWS; i++)
        for (int32_t k = 0; k < i; k++) TEST_ASSERT_TRUE(strcmp(rows[i].name, rows[k].name) != 0);
}

/* Names in the order of the numbers, with "or" before the last. */
static void the_message_for_an_unknown_method_names_all(void) {
    const laconic_refusal why = {LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, 0, 0};
    char text[400], expected[400] = "run.method: there is no such method; use ";
    for (int32_t i = 0; i < ROWS; i++) {
        if (i > 0) strcat(expected, i < ROWS - 1 ? ", " : " or ");
        strcat(expected, rows[i].name);
    }
    TEST_ASSERT_EQUAL_size_t(strlen(expected), laconic_message(&why, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void what_is_no_method_is_null(void) {
    TEST_ASSERT_NULL(laconic_method_by_number(-1));
    TEST_ASSERT_NULL(laconic_method_by_number(INT32_MIN));
    TEST_ASSERT_NULL(laconic_method_by_number(LACONIC_METHOD_COUNT));
    TEST_ASSERT_NULL(laconic_method_by_number(INT32_MAX));
    TEST_ASSERT_NULL(laconic_method_by_name(""));
    TEST_ASSERT_NULL(laconic_method_by_name("rk"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk45"));
    TEST_ASSERT_NULL(laconic_method_by_name("RK4"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk3"));
    TEST_ASSERT_NULL(laconic_method_by_name("rk5"));
}

/* Tests of eighth_order.h: the directions at the nodes. */

/* Their sum is just what the polynomials go to. As a share of a turn, which larger angles become, the small one would
 * lose its digits. */
static void at_the_border_a_small_angle_keeps_its_digits(void) {
    const real small = REAL(EITHER(1e-18, 1e-9));
    real cosine[NODES], sine[NODES], angle[NODES] = {REAL(0.78), 0, 0, small};
    TEST_ASSERT_TRUE(angle[0] + small == REAL(0.78));
    directions_at_nodes(cosine, sine, angle);
    TEST_ASSERT_TRUE(sine[3] == small && cosine[3] == 1);
    ASSERT_NEAR(2 * LACONIC_EPSILON, sin(0.78), sine[0]);
    ASSERT_NEAR(2 * LACONIC_EPSILON, cos(0.78), cosine[0]);
}

/* Tests of auto.c: which method takes usual steps, and what happens to those that it refuses. */

static double fastest_decay(const laconic_model *m) {
    return larger((double)m->decay_per_s[0], larger((double)m->decay_per_s[1], (double)m->decay_per_s[2]));
}

/* ------------------------------------------------------------------------------- usual steps -- */

static void assert_same_steps(const laconic_method *method, const laconic_model *m, laconic_state start,
                              const laconic_input *input, double step_s, int steps) {
    laconic_state a = start, b = start;
    take_steps(&laconic_auto, m, &a, input, step_s, steps);
    take_steps(method, m, &b, input, step_s, steps);
    TEST_ASSERT_EQUAL_MEMORY(&b, &a, sizeof a);
}

static void takes_the_very_steps_of_the_eighth_order_whatever_the_damping(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    const double step_s[3] = {0.0001, 0.01, 0.4};
    for (int k = 0; k < 3; k++) {
        const laconic_integrator in = integrator_of(&laconic_auto, &m, step_s[k]);
        TEST_ASSERT_EQUAL_PTR(&laconic_auto, in.method);
        TEST_ASSERT_EQUAL_STRING(laconic_exponential_gauss_8.name, in.chosen->name);
        assert_same_steps(&laconic_exponential_gauss_8, &m, moving(&m, 1, 2, 3), &input, step_s[k], 5);
    }
}

/* Both of the methods that it chooses among tell what they take usual steps by. */
static void either_choice_tells_its_name_and_order(void) {
    const laconic_method *either[] = {&laconic_auto_slow, &laconic_auto_fast};
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL_STRING(laconic_exponential_gauss_8.name, either[k]->name);
        TEST_ASSERT_EQUAL_INT32(laconic_exponential_gauss_8.order, either[k]->order);
    }
}

static void free_motion_keeps_its_energy_to_rounding(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_model m = model_of(v);
    const laconic_input none_acts = no_input();
    const double gyro = sqrt((double)(m.gyro[0] * m.gyro[0] + m.gyro[1] * m.gyro[1] + m.gyro[2] * m.gyro[2]));
    for (int k = 0; k < 3; k++) {
        const double yaw_rate = 30, angle[3] = {0.05, 0.5, 1.4}; /* h·|w||g·ζ| */
        laconic_state state = moving(&m, 20, 10, yaw_rate);
        const double energy_J = (double)laconic_energy_J(&m, &state);
        take_steps(&laconic_auto, &m, &state, &none_acts, angle[k] / (gyro * yaw_rate), 1000);
        TEST_ASSERT_TRUE(fabs((double)laconic_energy_J(&m, &state) / energy_J - 1) < EITHER(1e-13, 2e-5));
    }
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_auto, EITHER(1e-13, 1e-5));
}

static void is_of_eighth_order_under_everything_that_can_act(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    if (EITHER(true, false)) {
        assert_order(&laconic_auto, &v, start_with(2, 1, 4), &input, 2.0, 16, 8);
    } else { /* 8 steps already err by little more than rounding */
        const errors e = errors_of(&laconic_auto, &v, start_with(2, 1, 4), &input, 2.0, 8);
        TEST_ASSERT_TRUE(e.nu < 1e-4 && e.pose < 1e-5 && e.wheels < 1e-5);
    }
}

/* -------------------------------------------------------------------- steps that it refuses -- */

/* Those of a vehicle that yaws by far more than the method of eighth order takes. */
static void a_step_beyond_the_gyroscopic_limit_is_taken_by_exact_flow_4_or_kahan(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = every_input();
    const double border = 0.3 / fastest_decay(&m);
    const laconic_start start = start_with(1, 2, 50 / border);
    assert_step_refused(&laconic_exponential_gauss_8, with_motors(three_wheels()), start, input, border,
                        LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT);
    assert_same_steps(&laconic_exact_flow_4, &m, state_of(&m, start), &input, border * 0.999, 1);
    assert_same_steps(&laconic_exponential_kahan_4, &m, state_of(&m, start), &input, border * 1.001, 1);
}

/* What both refuse, since the step would gain energy: exact-flow takes it, to the bit. */
static void a_step_that_cannot_be_taken_is_taken_by_exact_flow(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_input input = every_input();
    const laconic_start start = start_that_gains_energy(&laconic_exact_flow_4, bare_body(), input, 1.0, 1e3);
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_slow, integrator_of(&laconic_auto, &m, 1.0).chosen);
    assert_same_steps(&laconic_exact_flow, &m, state_of(&m, start), &input, 1.0, 1);
}

static void a_step_that_cannot_be_taken_is_taken_by_exact_flow_while_damping_is_fast(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    const laconic_input input = no_input();
    const laconic_start start =
        start_that_gains_energy(&laconic_exponential_kahan_4, with_motors(three_wheels()), input, 1.0, 1e4);
    TEST_ASSERT_EQUAL_PTR(&laconic_auto_fast, integrator_of(&laconic_auto, &m, 1.0).chosen);
    assert_same_steps(&laconic_exact_flow, &m, state_of(&m, start), &input, 1.0, 1);
}

static void what_exact_flow_cannot_take_is_refused(void) {
    laconic_input input = no_input();
    laconic_vehicle v = bare_body();
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_auto, v, start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

static void what_exact_flow_cannot_take_is_refused_while_damping_is_fast(void) {
    laconic_input input = no_input();
    laconic_vehicle v = with_motors(three_wheels());
    input.body_force_N[0] = REAL(EITHER(1e100, 1e20));
    assert_step_refused(&laconic_auto, v, start_with(0, 0, 0), input, 1.0, LACONIC_OVERFLOW);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_number_has_its_method_and_every_name_leads_back);
    RUN_TEST(a_row_has_the_name_and_the_order_of_its_source);
    RUN_TEST(a_name_is_the_identifier_with_hyphens);
    RUN_TEST(no_two_methods_have_one_name);
    RUN_TEST(the_message_for_an_unknown_method_names_all);
    RUN_TEST(what_is_no_method_is_null);
    RUN_TEST(at_the_border_a_small_angle_keeps_its_digits);
    RUN_TEST(takes_the_very_steps_of_the_eighth_order_whatever_the_damping);
    RUN_TEST(either_choice_tells_its_name_and_order);
    RUN_TEST(free_motion_keeps_its_energy_to_rounding);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(is_of_eighth_order_under_everything_that_can_act);
    RUN_TEST(a_step_beyond_the_gyroscopic_limit_is_taken_by_exact_flow_4_or_kahan);
    RUN_TEST(a_step_that_cannot_be_taken_is_taken_by_exact_flow);
    RUN_TEST(a_step_that_cannot_be_taken_is_taken_by_exact_flow_while_damping_is_fast);
    RUN_TEST(what_exact_flow_cannot_take_is_refused);
    RUN_TEST(what_exact_flow_cannot_take_is_refused_while_damping_is_fast);
    return UNITY_END();
}
