/* Tests of what answers directions through a step of each method: it reads no number that it has not set. What the
 * answers are, test_step_derivatives.c compares with differences. */
#include "derived.h"
#include "stack.h"
#include "step_chain.h"

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
    RUN_TEST(what_lay_on_the_stack_changes_no_answer);
    RUN_TEST(columns_are_found_in_a_room_of_their_own);
    RUN_TEST(a_direction_beside_another_is_answered_as_alone);
    return UNITY_END();
}
