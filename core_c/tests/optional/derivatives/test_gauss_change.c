/* Tests of derivatives of collocation at Gauss' points where an input turns the vehicle by radians within a step, so that the
 * rounds end before they have settled: they are of the step as it is; and of the room that its weights take.
 * test_step_derivatives.c has the usual steps. */
#include "gauss_weight_change.h"
#include "laconic/derivatives.h"
#include "stiff.h"

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

static void rounds_that_do_not_settle_are_linearised_one_by_one(void) {
    static const pull pulls[] = {{true, 105, 8, 0.8},
                                 {true, 105, -8, 0.4},
                                 {true, EITHER(168, 105), 0, 0.8},
                                 {false, 10, -8, 0.8},
                                 {false, 16, -8, 0.8}};
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

/* Of rounds that have just not settled, to the digits that are promised: as if they had, these are 1e-10, 3e-12 and
 * 3e-13 of the number off. */
static void rounds_that_have_hardly_not_settled_are_linearised_as_they_are(void) {
    static const struct {
        double force_N, nu_3;
    } pulls[] = {{19.5, -8.3136394542199366}, {22, -2.2992802101312182}, {21, -4.7155290458750514}};
    for (int n = 0; n < 3; n++) {
        const pull by = {false, pulls[n].force_N, -8, 0.8};
        const long_step s = step_under(&by);
        laconic_state_change before, after;
        memset(&before, 0, sizeof before);
        before.nu_rad_per_s[0] = 1;
        before.nu_rad_per_s[1] = REAL(0.5);
        before.nu_rad_per_s[2] = REAL(-0.25);
        before.heading_rad = REAL(0.125);
        ASSERT_STATUS(LACONIC_OK,
                      laconic_step_tangent(&after, &s.model, &s.integrator, &s.state, &s.held, &before, NULL, NULL));
        ASSERT_NEAR(EITHER(2e-13, 0.1), pulls[n].nu_3, after.nu_rad_per_s[2]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(no_number_behind_the_weights_is_written);
    RUN_TEST(rounds_that_do_not_settle_are_linearised_one_by_one);
    RUN_TEST(weights_at_the_end_of_the_series_have_the_digits_of_the_difference);
    RUN_TEST(rounds_that_have_hardly_not_settled_are_linearised_as_they_are);
    return UNITY_END();
}
