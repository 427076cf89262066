/* Tests of friction_smooth.c: problems in which the exact passes go in circles, and the smoothed passes alone. */
#include "friction.h"
#include "friction_internals.h"

#define ACCEPTED EITHER(1e-9, 4e-5)
#define NEAR 1e-2              /* of the free motion */
#define MOST_BY_EXACT_PASSES 4 /* three and the look at what they found */

/* A wheel's place, angles, drag, inertia, grip and free speed. */
typedef struct wheel_numbers {
    double x, y, beta, gamma, drag, inertia, grip, free_speed;
} wheel_numbers;

typedef struct problem_numbers {
    int count;
    double free[3];
    wheel_numbers wheel[3];
} problem_numbers;

/* Without smoothed passes the exact ones have not converged after 2000, in double and in single. */
static const problem_numbers in_circles[] = {
    {2, {0, 1, 0}, {{0.2, -0.4, -0.7, 0.4, 0.3, 0.06, 0.2, 1}, {1, -0.8, 2.5, 2.1, 0.9, 0.02, 1.1, 0}}},
    {3,
     {2, -1, -3},
     {{-0.3, -0.4, -0.1, 1.6, 0.8, 0.01, 0.9, 0},
      {-0.2, -0.6, 2.8, 0.3, 1, 0.06, 0.8, 5},
      {-0.8, -0.3, 2.2, 1.2, 0.5, 0.06, 0.4, 1}}},
};

static problem problem_of(const problem_numbers *numbers) {
    problem p;
    memset(&p, 0, sizeof p);
    for (int i = 0; i < numbers->count; i++) {
        const wheel_numbers *w = &numbers->wheel[i];
        put_wheel(&p, w->x, w->y, w->beta, w->gamma, w->drag, w->inertia);
        p.load[i].grip = REAL(w->grip);
        p.load[i].drive_limit = LACONIC_REAL_MAX;
        p.load[i].free_speed = REAL(w->free_speed);
    }
    for (int m = 0; m < 3; m++) p.free[m] = REAL(numbers->free[m]);
    return p;
}

static void problems_in_which_exact_passes_go_in_circles_are_solved(void) {
    for (size_t n = 0; n < sizeof in_circles / sizeof in_circles[0]; n++) {
        problem p = problem_of(&in_circles[n]);
        TEST_ASSERT_GREATER_THAN(MOST_BY_EXACT_PASSES, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
    }
}

/* Twice the energy. */
static double energy_of(const problem *p, const laconic_real nu[3], const laconic_real speed[]) {
    double energy = 0;
    for (int m = 0; m < 3; m++) energy += (double)nu[m] * (double)nu[m];
    for (int i = 0; i < p->count; i++) energy += (double)p->wheel[i].inertia * (double)speed[i] * (double)speed[i];
    return energy;
}

static laconic_real free_speed_of(const problem *p, int i) {
    return p->load[i].free_speed + drive_at(&p->load[i], 0) / p->wheel[i].inertia;
}

/* The smoothed passes alone, from no impulses. */
static void smooth(problem *p) {
    friction_search at = {p->wheel, p->load, p->count, vec(p->free), vec(p->free), p->speed, p->impulse, 0};
    at.scale = square(at.free);
    for (int i = 0; i < p->count; i++) {
        const laconic_real start = free_speed_of(p, i);
        at.scale += p->wheel[i].inertia * start * start;
    }
    TEST_ASSERT_GREATER_THAN(0, laconic_friction_smooth(&at));
    store(p->nu, at.nu);
}

static problem random_problem(int n) {
    problem p;
    random_vehicle(&p, 1 + n % 4);
    random_loads(&p);
    random_motion(&p);
    return p;
}

static void smoothed_passes_alone_lead_near_to_what_exact_passes_find(void) {
    int compared = 0, far = 0;
    for (int n = 0; n < 2000; n++) {
        problem exact = random_problem(n), p = exact;
        laconic_real nu[3], speed[MOST_WHEELS], free_speed[MOST_WHEELS];
        const int passes = solve(&exact);
        if (passes == 0 || passes > MOST_BY_EXACT_PASSES) continue;
        smooth(&p);
        for (int m = 0; m < 3; m++) nu[m] = p.nu[m] - exact.nu[m];
        for (int i = 0; i < p.count; i++) {
            speed[i] = p.speed[i] - exact.speed[i];
            free_speed[i] = free_speed_of(&p, i);
        }
        compared++;
        far += energy_of(&p, nu, speed) > NEAR * NEAR * energy_of(&p, p.free, free_speed);
    }
    TEST_ASSERT_GREATER_THAN(1000, compared);
    TEST_ASSERT_TRUE(far < EITHER(0.01, 0.15) * compared);
}

static void smoothed_passes_keep_impulses_within_the_grip_and_speeds_finite(void) {
    for (int n = 0; n < 2000; n++) {
        problem p = random_problem(n);
        smooth(&p);
        TEST_ASSERT_TRUE(isfinite((double)energy_of(&p, p.nu, p.speed)));
        for (int i = 0; i < p.count; i++) {
            const double size = hypot((double)p.impulse[i][0], (double)p.impulse[i][1]);
            TEST_ASSERT_TRUE(size <= (double)p.load[i].grip * (1 + ROUNDING));
        }
    }
}

static void smoothed_passes_seldom_bring_energy_to_a_vehicle_that_coasts(void) {
    int gains = 0;
    for (int n = 0; n < 2000; n++) {
        problem p = random_problem(n);
        double before, after;
        for (int i = 0; i < p.count; i++) p.load[i].drive = REAL(0);
        before = energy_of(&p, p.free, p.speed);
        smooth(&p);
        after = energy_of(&p, p.nu, p.speed);
        gains += after > before * EITHER(1 + 1e-6, 1 + 1e-2);
    }
    TEST_ASSERT_LESS_THAN(20, gains); /* of 2000 */
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(problems_in_which_exact_passes_go_in_circles_are_solved);
    RUN_TEST(smoothed_passes_alone_lead_near_to_what_exact_passes_find);
    RUN_TEST(smoothed_passes_keep_impulses_within_the_grip_and_speeds_finite);
    RUN_TEST(smoothed_passes_seldom_bring_energy_to_a_vehicle_that_coasts);
    return UNITY_END();
}
