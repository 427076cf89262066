/* Tests of linear_motion.c: an error is carried as the difference of two motions that are a little apart. */
#include "linear_motion.c" /* also for its equation, by which a window's error is found */
#include "methods.h"

static laconic_refusal why;

#define APART EITHER(1e-7, 1e-3)

typedef struct pair { /* two plants, the second a little off */
    laconic_plant plant, off;
} pair;

static pair apart(laconic_vehicle v) {
    const laconic_start start = start_with(2, 1, 4), other = start_with(2 + APART, 1 - APART, 4 + 2 * APART);
    pair both;
    memset(&both, 0, sizeof both);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&both.plant, &v, &laconic_auto, REAL(0.002), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&both.off, &v, &laconic_auto, REAL(0.002), &other, &why));
    return both;
}

static laconic_real between(laconic_sum a, laconic_sum b) { return (a.value - b.value) + (a.rest - b.rest); }

/* Each step makes no error of its own: what is left is how far two motions part. */
static void assert_carried(laconic_vehicle v, int32_t steps, const laconic_input *input) {
    pair both = apart(v);
    laconic_estimate estimate;
    state_error error;
    window_motion motion;
    memset(&error, 0, sizeof error);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &both.plant, 16, NULL, &why));
    laconic_forcing_of(&estimate.forcing, &both.plant.model, input);
    error.zeta = minus(zeta_of(&both.plant.state), zeta_of(&both.off.state));
    motion.steps = steps;
    motion.step_s = REAL(0.002);
    motion.zeta[0] = zeta_of(&both.plant.state);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&both.plant, input, (uint64_t)steps, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&both.off, input, (uint64_t)steps, &why));
    const laconic_state *s = &both.plant.state, *t = &both.off.state;
    motion.zeta[1] = zeta_of(s);
    motion.way = vector_of(s->travel[0].value, s->travel[1].value, s->travel[2].value);
    motion.path_m[0] = s->x_m.value;
    motion.path_m[1] = s->y_m.value;
    motion.heading = laconic_direction_of_angle(REAL(0.5) * dot(vec(both.plant.model.yaw_rate_of_zeta), motion.way));
    laconic_carry_error(&error, &estimate, &both.plant.model, &motion);
    const vector expected = minus(zeta_of(s), zeta_of(t));
    ASSERT_NEAR(0.03 * APART, expected.x, error.zeta.x);
    ASSERT_NEAR(0.03 * APART, expected.y, error.zeta.y);
    ASSERT_NEAR(0.03 * APART, expected.z, error.zeta.z);
    ASSERT_NEAR(0.03 * APART * 0.1, between(s->travel[0], t->travel[0]), error.travel.x);
    ASSERT_NEAR(0.03 * APART * 0.1, between(s->travel[2], t->travel[2]), error.travel.z);
    ASSERT_NEAR(0.01 * APART * 0.1, between(s->x_m, t->x_m), error.place_m[0]);
    ASSERT_NEAR(0.01 * APART * 0.1, between(s->y_m, t->y_m), error.place_m[1]);
}

static void free_motion_turns_the_error(void) {
    const laconic_input input = no_input();
    assert_carried(three_wheels(), 50, &input);
    assert_carried(mecanum(), 50, &input);
}

static void damping_lets_it_die(void) {
    const laconic_input input = no_input();
    laconic_vehicle v = with_motors(three_wheels());
    assert_carried(v, 50, &input);
    v.motor_damping_Nms = REAL(100 * DAMPING);
    assert_carried(v, 50, &input);
}

static void a_force_in_the_world_follows_the_heading(void) {
    laconic_input input = every_input();
    input.world_force_N[0] = REAL(40);
    assert_carried(with_motors(three_wheels()), 50, &input);
}

/* The source that makes the error of one step makes that of n steps: e+ of n windows of one step is e+ of one of n. */
static void windows_of_one_step_and_one_of_many_agree(void) {
    pair both = apart(with_motors(three_wheels()));
    laconic_estimate estimate;
    state_error stepwise, at_once;
    window_motion motion;
    memset(&stepwise, 0, sizeof stepwise);
    memset(&motion, 0, sizeof motion);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &both.plant, 16, NULL, &why));
    estimate.local[0] = estimate.local[4] = REAL(1e-6);
    estimate.local[2] = estimate.local[6] = REAL(-2e-6);
    motion.step_s = REAL(0.002);
    motion.heading.cosine = 1;
    motion.zeta[0] = motion.zeta[1] = zeta_of(&both.plant.state);
    at_once = stepwise;
    motion.steps = 1;
    for (int k = 0; k < 13; k++) laconic_carry_error(&stepwise, &estimate, &both.plant.model, &motion);
    motion.steps = 13;
    laconic_carry_error(&at_once, &estimate, &both.plant.model, &motion);
    ASSERT_NEAR(3e-8, stepwise.zeta.x, at_once.zeta.x);
    ASSERT_NEAR(3e-8, stepwise.zeta.z, at_once.zeta.z);
    ASSERT_NEAR(3e-8, stepwise.travel.y, at_once.travel.y);
    ASSERT_NEAR(3e-8, stepwise.place_m[0], at_once.place_m[0]);
}

/* What becomes of an error of ζ along z in a window of 16 steps of 2 ms: g along z, w along x, both 1, and ζ along −y
 * such that the determinant of the linear system is the one given. */
static vector z_carried(laconic_real z, double determinant) {
    pair both = apart(three_wheels());
    laconic_model *m = &both.plant.model;
    laconic_estimate estimate;
    state_error error;
    window_motion motion;
    memset(&error, 0, sizeof error);
    memset(&motion, 0, sizeof motion);
    store(m->nu_of_zeta[2], vector_of(0, 0, 1));
    store(m->gyro, vector_of(1, 0, 0));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &both.plant, 16, NULL, &why));
    error.zeta.z = z;
    motion.steps = 16;
    motion.step_s = REAL(0.002);
    motion.heading.cosine = 1;
    motion.zeta[0] = motion.zeta[1] = vector_of(0, REAL(-62.5 * (1 - determinant)), 0);
    laconic_carry_error(&error, &estimate, m, &motion);
    return error.zeta;
}

/* Where the linear system has no usable solution, what is known of the window's start counts alone. */
static void a_window_without_a_solution_stays_finite(void) {
    TEST_ASSERT_TRUE(size(z_carried(REAL(1e-6), 0)) < REAL(1e-5));
}

/* Solved it is a Cayley rotation by 2/det − 1, else its first term. */
static double z_where_the_determinant_is(double determinant) { return (double)z_carried(1, determinant).z; }

static void a_solution_is_usable_from_a_twentieth_on(void) {
    for (int sign = -1; sign <= 1; sign += 2) {
        const double usable = sign * 0.0502, not_usable = sign * 0.0498;
        ASSERT_NEAR(EITHER(1e-9, 1e-2), 2 / usable - 1, z_where_the_determinant_is(usable));
        ASSERT_NEAR(EITHER(1e-9, 1e-4), 3 - 2 * not_usable, z_where_the_determinant_is(not_usable));
    }
}

/* What a force in the world was, before there was none, is not looked at. */
static void a_force_that_has_ended_turns_nothing(void) {
    pair both = apart(with_motors(three_wheels()));
    laconic_estimate estimate;
    state_error error[2];
    window_motion motion;
    memset(error, 0, sizeof error);
    memset(&motion, 0, sizeof motion);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &both.plant, 16, NULL, &why));
    motion.steps = 16;
    motion.step_s = REAL(0.002);
    motion.heading = laconic_direction_of_angle(1);
    motion.zeta[0] = motion.zeta[1] = zeta_of(&both.plant.state);
    for (int k = 0; k < 2; k++) {
        estimate.forcing.rotates = false;
        for (int i = 0; i < 3; i++) estimate.forcing.cosine[i] = estimate.forcing.sine[i] = REAL(30 * k);
        error[k].zeta = vector_of(REAL(0.1), REAL(0.2), REAL(0.3));
        laconic_carry_error(&error[k], &estimate, &both.plant.model, &motion);
    }
    TEST_ASSERT_EQUAL_MEMORY(&error[0], &error[1], sizeof error[0]);
}

/* What is left after as many steps as the last window had is the border: that much does not count as fading. */
static void errors_fade_below_their_border_alone(void) {
    const laconic_real fading[3] = {REAL(1), REAL(0.7), REAL(0.69)};
    pair both = apart(with_motors(three_wheels()));
    laconic_estimate estimate;
    state_error error[3];
    window_motion motion;
    memset(error, 0, sizeof error);
    memset(&motion, 0, sizeof motion);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &both.plant, 16, NULL, &why));
    estimate.local[0] = REAL(1e-6);
    estimate.last_length = 2;
    motion.step_s = REAL(0.002);
    motion.heading.cosine = 1;
    motion.steps = 4;
    for (int k = 0; k < 3; k++) {
        estimate.fading = fading[k];
        laconic_carry_error(&error[k], &estimate, &both.plant.model, &motion);
    }
    TEST_ASSERT_EQUAL_MEMORY(&error[0], &error[1], sizeof error[0]);
    TEST_ASSERT_TRUE(error[2].zeta.x < REAL(0.8) * error[1].zeta.x);
}

/* A determinant of just 0.05 is not usable: what is on the right then stands for the solution. */
static void a_determinant_of_just_the_least_gives_the_right_hand_side(void) {
    const vector zeta = {REAL(-0.25), REAL(0.5), 0}, right = {1, 2, 3};
    const vector edge = {REAL(EITHER(0x1.e1f00783fe1fp+0, 0x1.e2767p+0)), REAL(EITHER(0x1.3p-1, 0x1.11p-1)), 0};
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.nu_of_zeta[2][0] = m.nu_of_zeta[2][1] = m.gyro[2] = 1;
    const vector at_edge = solve(&m, zeta, edge, right);
    TEST_ASSERT_TRUE(at_edge.x == 1 && at_edge.y == 2 && at_edge.z == 3);
    const vector within = {edge.x * (1 - 64 * LACONIC_EPSILON), edge.y, 0}, found = solve(&m, zeta, within, right);
    TEST_ASSERT_TRUE(magnitude(found.x) > 10);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_determinant_of_just_the_least_gives_the_right_hand_side);
    RUN_TEST(free_motion_turns_the_error);
    RUN_TEST(damping_lets_it_die);
    RUN_TEST(a_force_in_the_world_follows_the_heading);
    RUN_TEST(windows_of_one_step_and_one_of_many_agree);
    RUN_TEST(errors_fade_below_their_border_alone);
    RUN_TEST(a_window_without_a_solution_stays_finite);
    RUN_TEST(a_solution_is_usable_from_a_twentieth_on);
    RUN_TEST(a_force_that_has_ended_turns_nothing);
    return UNITY_END();
}
