/* Undriven, undamped trees with short trails: auto never adds energy, or refuses in one line that names the body. */
#include <stdlib.h>

#include "hinged_vehicles.h"

static uint64_t seed = 7;
static int wanted_trees = 100;
static double shortest; /* trail of the tree, m */

static double uniform(double low, double high) {
    seed = seed * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

static int choice(int count) { return (int)uniform(0, count) % count; }

/* A body with one wheel behind its hinge, or two. */
static void hang_follower(laconic_articulated_vehicle *v, double trail) {
    const int b = v->body_count + 1, parent = choice(3) == 0 ? choice(b) : 0;
    const double kg = choice(3) == 0 ? 0 : pow(10, uniform(-1, 1.5));
    const double off = choice(2) == 0 ? trail : uniform(0, 0.3);
    const double x = uniform(-0.5, 0.5), y = uniform(-0.3, 0.3), inertia = kg * uniform(0, 0.02);
    hang_body(v, parent, LACONIC_HINGE_FREE, x, y, kg, inertia, -off, choice(2) == 0 ? 0 : uniform(-0.02, 0.02));
    const double half = choice(2) == 0 ? 0 : 0.2;
    for (int k = 0; k < (half > 0 ? 2 : 1); k++)
        hang_wheel(v, b, -trail, k == 0 ? half : -half, choice(2) == 0 ? 0 : 1e-3);
}

static laconic_articulated_vehicle short_tree(void) {
    const double mass = uniform(5, 30), inertia = uniform(0.1, 1), ahead = uniform(-0.2, 0.2);
    laconic_articulated_vehicle v = carriage(mass, inertia, ahead, uniform(-0.05, 0.05));
    const int bodies = 1 + choice(3);
    if (choice(4) != 0)
        for (int k = 0; k < 2; k++) hang_wheel(&v, 0, 0, k == 0 ? 0.2 : -0.2, 0.01);
    shortest = 1;
    for (int b = 0; b < bodies; b++) {
        const double trail = pow(10, uniform(EITHER(-6, -3), -2));
        shortest = fmin(shortest, trail);
        hang_follower(&v, trail);
    }
    return v;
}

static double energy_of(const laconic_articulated_model *m, const laconic_articulated_state *s) {
    return (double)motion_of(m, s).energy_J;
}

/* What rounding may add in so many steps: speeds of the wheels' bodies are differences of lengths over the trail, which
 * are rounded some times in the parts of a step. */
static double by_rounding(int steps) { return EITHER(2e-15, 2e-6) * (steps + 3) * 0.5 / shortest; }

/* Takes steps of one size, each of which keeps the energy or is refused by the name of a body. Returns how many. */
static int steps_that_keep(const laconic_articulated_model *m, const laconic_articulated_start *start, double step_s) {
    const laconic_articulated_input in = nothing();
    laconic_articulated_state s = hinged_state(m, start, &in);
    const laconic_articulated_integrator i = hinged_integrator(m, LACONIC_ARTICULATED_AUTO, step_s);
    const double before = energy_of(m, &s);
    for (int taken = 0; taken < 10; taken++) {
        const laconic_articulated_state last = s;
        if (laconic_articulated_step(m, &i, &s, &in, &in, &refusal) != LACONIC_OK) {
            TEST_ASSERT_EQUAL_MEMORY(&last, &s, sizeof s);
            TEST_ASSERT_EQUAL(LACONIC_STEP_BEYOND_TRAIL_LIMIT, refusal.status);
            TEST_ASSERT_TRUE(refusal.item >= 1 && refusal.item <= m->body_count);
            TEST_ASSERT_TRUE(refusal.limit > 0 && (double)refusal.limit < step_s);
            return taken;
        }
        TEST_ASSERT_TRUE_MESSAGE(energy_of(m, &s) <= before * (1 + by_rounding(taken + 1)), "auto adds energy");
        TEST_ASSERT_TRUE_MESSAGE(energy_of(m, &s) >= before * (1 - EITHER(1e-4, 1e-2)), "auto loses energy");
    }
    return 10;
}

static void undriven_trees_with_short_trails_keep_their_energy_or_name_the_body(void) {
    static const double sizes[] = {1e-4, 1e-3, 1e-2, 1e-1};
    long taken = 0, runs = 0;
    for (int n = 0; n < (int)LONG_RUN(wanted_trees); n++) {
        const laconic_articulated_vehicle v = short_tree();
        laconic_articulated_model m;
        const double velocity = uniform(-2, 2);
        laconic_articulated_start start = start_at(velocity, 0, uniform(-1, 1));
        for (int b = 0; b < LACONIC_MAX_BODIES; b++) start.hinge_angle_rad[b] = REAL(uniform(-3, 3));
        memset(&m, 0, sizeof m);
        if (laconic_articulated_prepare(&m, &v, &refusal) != LACONIC_OK) continue;
        for (int k = 0; k < 4; k++, runs++) taken += steps_that_keep(&m, &start, sizes[k]);
    }
    TEST_ASSERT_TRUE_MESSAGE(taken >= EITHER(8, 4) * runs, "too many steps are refused");
}

/* A caster with inertia on a trail of 0.1 mm: its wheel hardly turns it, however fast it would follow without. */
static void a_heavy_caster_on_a_short_trail_moves_alike_by_all_steps(void) {
    if (!IN_DOUBLE) return;
    laconic_articulated_vehicle v = carriage(20, 0.8, 0, 0);
    hang_wheel(&v, 0, 0, 0.2, 0);
    hang_wheel(&v, 0, 0, -0.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_FREE, 0.3, 0, 1, 0.01, 0, 0);
    hang_wheel(&v, 1, -1e-4, 0, 0);
    const laconic_articulated_model m = hinged_model(v);
    const laconic_articulated_start start = start_at(0.8, 0, 0);
    laconic_articulated_input in = nothing();
    in.base.body_moment_Nm = REAL(0.3); /* so that its energy is no judge */
    laconic_articulated_motion end[2];
    for (int k = 0; k < 2; k++) {
        laconic_articulated_state s = hinged_state(&m, &start, &in);
        run_held(&m, &s, LACONIC_ARTICULATED_AUTO, k == 0 ? 0.01 : 1e-4, k == 0 ? 20 : 2000, &in);
        end[k] = motion_of(&m, &s);
    }
    TEST_ASSERT_TRUE(difference(&m, &end[0], &end[1]) < 1e-3);
}

int main(int count, char **words) {
    if (count > 1) wanted_trees = atoi(words[1]);
    UNITY_BEGIN();
    RUN_TEST(undriven_trees_with_short_trails_keep_their_energy_or_name_the_body);
    RUN_TEST(a_heavy_caster_on_a_short_trail_moves_alike_by_all_steps);
    return UNITY_END();
}
