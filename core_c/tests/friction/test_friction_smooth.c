/* Tests of friction_smooth.c: problems in which the exact passes go in circles, and the smoothed passes alone. */
#include "friction.h"
#include "friction_internals.h"

#define ACCEPTED EITHER(1e-9, 1e-4)
#define NEAR EITHER(1e-7, 3e-3) /* of the free motion */
#define MOST_BY_EXACT_PASSES 7  /* six and the look at what they found */
#define WHOLE_PATH EITHER(40, 25)

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

/* So many passes along the path alone, from no impulses. */
static void follow_path(problem *p, int passes) {
    friction_search at = {p->wheel, p->load, p->count, vec(p->free), vec(p->free), p->speed, p->impulse, 0};
    friction_path path;
    at.scale = square(at.free);
    for (int i = 0; i < p->count; i++) {
        const laconic_real start = free_speed_of(p, i);
        at.scale += p->wheel[i].inertia * start * start;
    }
    laconic_friction_start_path(&at, &path);
    for (int pass = 0; pass < passes; pass++) laconic_friction_follow_path(&at, &path);
    store(p->nu, at.nu);
}

static problem random_problem(int n) {
    problem p;
    random_vehicle(&p, 1 + n % 4);
    random_loads(&p);
    random_motion(&p);
    return p;
}

static void the_path_alone_leads_to_what_exact_passes_find(void) {
    int compared = 0, far = 0;
    for (int n = 0; n < 1000; n++) {
        problem exact = random_problem(n), p = exact;
        laconic_real nu[3], speed[MOST_WHEELS], free_speed[MOST_WHEELS];
        const int passes = solve(&exact);
        if (passes == 0 || passes > MOST_BY_EXACT_PASSES) continue;
        follow_path(&p, WHOLE_PATH);
        for (int m = 0; m < 3; m++) nu[m] = p.nu[m] - exact.nu[m];
        for (int i = 0; i < p.count; i++) {
            speed[i] = p.speed[i] - exact.speed[i];
            free_speed[i] = free_speed_of(&p, i);
        }
        compared++;
        far += energy_of(&p, nu, speed) > NEAR * NEAR * energy_of(&p, p.free, free_speed);
    }
    TEST_ASSERT_GREATER_THAN(500, compared);
    TEST_ASSERT_TRUE(far <= EITHER(0, 0.01) * compared);
}

static void the_path_keeps_impulses_within_the_grip_and_speeds_finite(void) {
    for (int n = 0; n < 1000; n++) {
        problem p = random_problem(n);
        follow_path(&p, n % WHOLE_PATH);
        TEST_ASSERT_TRUE(isfinite((double)energy_of(&p, p.nu, p.speed)));
        for (int i = 0; i < p.count; i++) {
            const double size = hypot((double)p.impulse[i][0], (double)p.impulse[i][1]);
            TEST_ASSERT_TRUE(size <= (double)p.load[i].grip * (1 + ROUNDING));
        }
    }
}

static void a_vehicle_that_coasts_has_lost_energy_at_the_end_of_the_path(void) {
    int gains = 0;
    for (int n = 0; n < 1000; n++) {
        problem p = random_problem(n);
        double before, after;
        for (int i = 0; i < p.count; i++) p.load[i].drive = REAL(0);
        before = energy_of(&p, p.free, p.speed);
        follow_path(&p, WHOLE_PATH);
        after = energy_of(&p, p.nu, p.speed);
        gains += after > before * EITHER(1 + 1e-9, 1 + 1e-3);
    }
    TEST_ASSERT_EQUAL_INT(0, gains);
}

/* Exact passes jump from one end of the motor's limits to the other, as they lie close together. */
static void a_motor_between_near_limits_is_solved(void) {
    for (double speed = -0.2; speed < 0.2; speed += 1e-3) {
        problem p;
        memset(&p, 0, sizeof p);
        put_wheel(&p, 1, 0, 0, PI / 2, 0, 0.18);
        p.load[0].grip = REAL(0.7);
        p.load[0].drive_slope = REAL(4.3);
        p.load[0].drive_limit = REAL(0.037);
        p.load[0].viscous = REAL(0.48);
        p.free[0] = REAL(0.1);
        p.free[1] = REAL(speed);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
    }
}

/* Four wheels that neither roll nor slide hold each other with any stress: their impulses are not unique, the speeds
 * are. The guess has stress of many times the motion. */
static void redundant_contacts_are_solved_from_any_stress(void) {
    for (int n = 0; n < 500; n++) {
        problem p;
        const double grip = decades(1e-3, 1), stress = decades(1e-6, 1e6);
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 4; i++) {
            put_wheel(&p, i & 1 ? 1 : -1, i & 2 ? 0.7 : -0.7, i & 2 ? PI / 2 : -PI / 2, PI / 2, 1, 0.05);
            p.load[i].grip = REAL(grip);
            p.load[i].axle = REAL(n % 2 ? 0.1 * grip : 0);
            p.load[i].drive_limit = LACONIC_REAL_MAX;
            for (int m = 0; m < 2; m++) p.impulse[i][m] = REAL(either_sign(stress));
        }
        for (int m = 0; m < 3; m++) p.free[m] = REAL(either_sign(4 * grip));
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
    }
}

/* The same with little drag across rollers and grips far above what the motion asks for, from speeds of any size. */
static void stiff_vehicles_at_any_scale_are_solved(void) {
    int refused = 0;
    for (int n = 0; n < 2000; n++) {
        problem p;
        const double scale = decades(EITHER(1e-100, 1e-10), EITHER(1e100, 1e10)), drag = decades(1e-6, 1);
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 3; i++) {
            put_wheel(&p, cos(2.1 * i), sin(2.1 * i), 2.1 * i, PI / 2, drag, decades(1e-3, 10));
            p.load[i].grip = REAL(scale * decades(1e-2, 1e2));
            p.load[i].axle = REAL(scale * decades(1e-4, 1));
            p.load[i].drive = REAL(scale * either_sign(1));
            p.load[i].drive_slope = REAL(decades(1e-3, 1e2));
            p.load[i].drive_limit = REAL(scale * decades(1e-3, 1));
            p.load[i].free_speed = REAL(scale * either_sign(1));
        }
        for (int m = 0; m < 3; m++) p.free[m] = REAL(scale * either_sign(1));
        if (solve(&p) == 0)
            refused++;
        else
            TEST_ASSERT_TRUE(residual_of(&p) < EITHER(1e-9, 1e-3));
    }
    TEST_ASSERT_LESS_OR_EQUAL(EITHER(0, 20), refused); /* 1 % */
}

/* Over the whole range of normal numbers some units in the last place; of 0 next to nothing. */
static void quick_roots_are_roots(void) {
    for (double x = (double)LACONIC_REAL_MIN; x < 0.9 * (double)LACONIC_REAL_MAX; x *= 1.37) {
        const double root = sqrt((double)REAL(x));
        ASSERT_NEAR(4 * (double)LACONIC_EPSILON * root, root, quick_root(REAL(x)));
    }
    TEST_ASSERT_TRUE(quick_root(0) >= 0 && quick_root(0) < EITHER(REAL(1e-150), REAL(1e-18)));
}

/* Of contacts that hold along one line, far stiffer than numbers tell, rounding takes the body's own mass from later
 * pivots: a solution is found all the same, and moves nothing along the line. */
static void what_rounding_takes_of_a_pivot_the_body_gives_back(void) {
    const laconic_real stiffness = EITHER(REAL(1e20), REAL(1e12));
    const vector lines[3] = {{1, 1, 0}, {0, 1, 1}, {1, 1, 1}};
    for (int n = 0; n < 3; n++) {
        equations k = {vector_of(1, 2, 4), 1, 0, 0, 1, 0, 1};
        add_product(&k, scaled(stiffness, lines[n]), lines[n]);
        const vector by = solved(&k);
        TEST_ASSERT_TRUE(fabs((double)by.x) < 10 && fabs((double)by.y) < 10 && fabs((double)by.z) < 10);
        ASSERT_NEAR(EITHER(1e-15, 1e-6), 0, dot(by, lines[n]));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(problems_in_which_exact_passes_go_in_circles_are_solved);
    RUN_TEST(the_path_alone_leads_to_what_exact_passes_find);
    RUN_TEST(the_path_keeps_impulses_within_the_grip_and_speeds_finite);
    RUN_TEST(a_vehicle_that_coasts_has_lost_energy_at_the_end_of_the_path);
    RUN_TEST(a_motor_between_near_limits_is_solved);
    RUN_TEST(redundant_contacts_are_solved_from_any_stress);
    RUN_TEST(stiff_vehicles_at_any_scale_are_solved);
    RUN_TEST(quick_roots_are_roots);
    RUN_TEST(what_rounding_takes_of_a_pivot_the_body_gives_back);
    return UNITY_END();
}
