/* Tests of friction_solver.c: cases with known results, and random ones judged by a second routine. */
#include "friction.h"

#define ACCEPTED EITHER(1e-9, 1e-4)
#define NO_MOTION EITHER(1e-285, 1e-26) /* energies that count as rest */

/* One fixed wheel at the body's centre that rolls along x. */
static problem one_wheel(double grip) {
    problem p;
    memset(&p, 0, sizeof p);
    put_wheel(&p, 0, 0, PI / 2, PI / 2, 1, 0.5);
    p.load[0].grip = REAL(grip);
    p.load[0].drive_limit = LACONIC_REAL_MAX;
    return p;
}

static void a_sliding_wheel_loses_the_grip_against_its_slip(void) {
    problem p = one_wheel(0.5);
    p.free[1] = REAL(2); /* sideways: rolling does not help */
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-6, 1.5, p.nu[1]);
    ASSERT_NEAR(1e-6, 0.5, hypot((double)p.impulse[0][0], (double)p.impulse[0][1]));
}

static void rolling_shares_the_motion_by_inertia(void) {
    problem p = one_wheel(10);
    p.free[0] = REAL(3);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-5, 2.0, p.nu[0]); /* (1 + ½) v = 3 */
    ASSERT_NEAR(1e-5, 2.0, fabs((double)p.speed[0]));
}

static void what_the_grip_can_hold_stops_to_the_last_bit(void) {
    problem p = one_wheel(1);
    p.free[1] = REAL(0.9);
    p.speed[1] = REAL(7); /* there is no second wheel */
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.nu[0] == 0 && p.nu[1] == 0 && p.nu[2] == 0 && p.speed[0] == 0 && p.speed[1] == 7);
}

/* A wheel off the ground turns by its motor and axle alone. */
static problem one_lifted_wheel(double drive) {
    problem p = one_wheel(0);
    p.load[0].drive = REAL(drive);
    p.load[0].drive_slope = REAL(0.25);
    p.load[0].drive_limit = REAL(0.5);
    p.load[0].viscous = REAL(0.25);
    p.load[0].axle = REAL(0.125);
    return p;
}

static void a_lifted_wheel_turns_by_its_motor_within_the_limit(void) {
    problem p = one_lifted_wheel(0.125);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.speed[0] == 0); /* the axle's friction holds what is not above it */
    p = one_lifted_wheel(0.375);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-6, 0.25, p.speed[0]); /* (0.375 − 0.125) / (½ + ¼ + ¼) */
    p = one_lifted_wheel(-2);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(1e-6, -0.5, p.speed[0]); /* (½ − 0.125) / (½ + ¼) */
}

static void constants_that_are_no_numbers_have_no_solution(void) {
    problem p = one_wheel(1);
    p.free[0] = p.free[1] = REAL(3);
    p.wheel[0].row[0].x = NOT_A_NUMBER;
    TEST_ASSERT_EQUAL_INT(0, solve(&p));
}

static void rigid_contacts_with_free_rollers_give_the_model_without_slip(void) {
    for (int n = 0; n < 200; n++) {
        problem p;
        double left[3], largest = 0;
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 4; i++) {
            const double gamma = uniform(0.3, 2.8);
            put_wheel(&p, i & 1 ? 1 : -1, i & 2 ? 0.7 : -0.7, i & 2 ? PI / 2 : -PI / 2, gamma, 0, decades(1e-2, 1));
            p.load[i].grip = p.load[i].drive_limit = LACONIC_REAL_MAX;
        }
        random_motion(&p);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        for (int m = 0; m < 3; m++) left[m] = (double)p.free[m] - (double)p.nu[m];
        for (int i = 0; i < p.count; i++) { /* Σ j Ξᵀ (s* − Ξ ν), Ξ = along / rim */
            const laconic_real *u = p.wheel[i].along;
            const double rim = (double)p.wheel[i].rim_along;
            const double rolling = (double)(u[0] * p.nu[0] + u[1] * p.nu[1] + u[2] * p.nu[2]) / rim;
            ASSERT_NEAR(EITHER(1e-12, 1e-4) * (1 + fabs(rolling)), rolling, p.speed[i]);
            for (int m = 0; m < 3; m++)
                left[m] += (double)p.wheel[i].inertia * ((double)p.load[i].free_speed - rolling) * (double)u[m] / rim;
            largest = fmax(largest, fabs((double)p.load[i].free_speed));
        }
        for (int m = 0; m < 3; m++) ASSERT_NEAR(EITHER(1e-8, 1e-3) * (1 + largest), 0, left[m]);
    }
}

static void a_roller_that_does_not_turn_is_a_fixed_wheel_whatever_its_angle(void) {
    for (double gamma = 0.1; gamma < 3.1; gamma += 0.25) {
        problem fixed = one_wheel(0.3), p = one_wheel(0.3);
        p.count = 0;
        put_wheel(&p, 0, 0, PI / 2, gamma, 1, 0.5);
        p.free[0] = fixed.free[0] = REAL(1);
        p.free[1] = fixed.free[1] = REAL(-0.7);
        p.load[0].free_speed = fixed.load[0].free_speed = REAL(4);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_GREATER_THAN(0, solve(&fixed));
        ASSERT_NEAR_ALL(EITHER(1e-8, 1e-4), fixed.nu, p.nu, 3);
        ASSERT_NEAR(EITHER(1e-8, 1e-4), fixed.speed[0], p.speed[0]);
    }
}

/* Across free rollers nothing slips: an impulse just at the border, along them, has nothing to turn with. */
static void a_wheel_with_free_rollers_at_the_border_of_its_grip_is_solved(void) {
    for (double speed = 2.9; speed < 3.1; speed += 1e-3) {
        problem p;
        memset(&p, 0, sizeof p);
        put_wheel(&p, 0, 0, -2.1, 0.3, 0, 0.02);
        p.load[0].grip = REAL(0.6);
        p.load[0].drive_limit = LACONIC_REAL_MAX;
        p.free[1] = REAL(-speed);
        p.load[0].free_speed = REAL(-1);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
    }
}

static void little_drag_tends_to_none(void) {
    for (int n = 0; n < 100; n++) {
        problem with, without;
        memset(&with, 0, sizeof with);
        for (int i = 0; i < 3; i++) put_wheel(&with, cos(2.1 * i), sin(2.1 * i), 2.1 * i, PI / 2, 0, 0.01);
        random_loads(&with);
        random_motion(&with);
        for (int i = 0; i < 3; i++) with.load[i].grip = REAL(decades(1e-4, 1));
        without = with;
        with.count = 0;
        for (int i = 0; i < 3; i++) put_wheel(&with, cos(2.1 * i), sin(2.1 * i), 2.1 * i, PI / 2, 1e-6, 0.01);
        if (solve(&with) == 0 || solve(&without) == 0) continue; /* counted elsewhere */
        ASSERT_NEAR_ALL(1e-3, without.nu, with.nu, 3);
    }
}

/* Of 1 in 40 rounding leaves more than the solver asks for elsewhere: what it finds then is all that numbers tell. */
static void light_wheels_whose_rollers_hardly_drag_are_solved_as_far_as_numbers_tell(void) {
    for (int n = 0; n < 1000; n++) {
        problem p;
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 3; i++) put_wheel(&p, cos(2.1 * i), sin(2.1 * i), 2.1 * i, PI / 2, 1e-4, 1e-4);
        random_loads(&p);
        random_motion(&p);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
    }
}

static void random_vehicles_at_random_speeds_are_solved(void) {
    int refused = 0;
    double worst = 0;
    for (int n = 0; n < 5000; n++) {
        problem p;
        random_vehicle(&p, 1 + n % 4);
        random_loads(&p);
        random_motion(&p);
        if (solve(&p) == 0)
            refused++;
        else
            worst = fmax(worst, residual_of(&p));
    }
    TEST_ASSERT_LESS_OR_EQUAL(EITHER(0, 5), refused); /* in single 0.1 % */
    TEST_ASSERT_TRUE(worst < ACCEPTED);
}

/* The next step goes on from the last one's speeds and impulses. */
static void go_on(problem *p) {
    memcpy(p->free, p->nu, sizeof p->free);
    for (int i = 0; i < p->count; i++) p->load[i].free_speed = p->speed[i];
}

static double energy_of(const problem *p) {
    double energy = 0;
    for (int m = 0; m < 3; m++) energy += (double)p->nu[m] * (double)p->nu[m];
    for (int i = 0; i < p->count; i++)
        energy += (double)p->wheel[i].inertia * (double)p->speed[i] * (double)p->speed[i];
    return energy;
}

static void coasting_vehicles_lose_energy_in_every_step_and_are_seldom_refused(void) {
    int refused = 0, steps = 0;
    for (int n = 0; n < 300; n++) {
        problem p;
        double before;
        random_vehicle(&p, 1 + n % 4);
        random_loads(&p);
        random_motion(&p);
        for (int i = 0; i < p.count; i++) p.load[i].drive = REAL(0);
        before = energy_of(&p);
        for (int step = 0; step < 100 && before > NO_MOTION; step++, steps++) {
            if (solve(&p) == 0) {
                refused++;
                break;
            }
            TEST_ASSERT_TRUE(residual_of(&p) < ACCEPTED);
            TEST_ASSERT_TRUE(energy_of(&p) <= before * (1 + ACCEPTED));
            before = energy_of(&p);
            go_on(&p);
        }
    }
    TEST_ASSERT_GREATER_THAN(10000, steps);
    TEST_ASSERT_LESS_OR_EQUAL(EITHER(0, 3), refused); /* of some 20,000 */
}

static problem four_mecanum_wheels(double drag) {
    problem p;
    memset(&p, 0, sizeof p);
    for (int i = 0; i < 4; i++) {
        put_wheel(&p, i & 1 ? 1 : -1, i & 2 ? 0.7 : -0.7, i & 2 ? PI / 2 : -PI / 2, i % 3 == 0 ? PI / 4 : -PI / 4, drag,
                  0.05);
        p.load[i].grip = REAL(0.02);
        p.load[i].axle = REAL(1e-4);
        p.load[i].drive_limit = LACONIC_REAL_MAX;
    }
    return p;
}

/* Of the mirror image x is the same; y, angles, yaw and the wheels' speeds are negative. */
static void a_vehicle_and_its_mirror_image_are_solved_in_as_many_passes(void) {
    for (int n = 0; n < 20; n++) {
        int passes[2];
        problem p[2];
        const double angle = 0.3 + 0.1 * n, drag = 0.05 * (n + 1);
        for (int image = 0; image < 2; image++) {
            const double side = image ? -1 : 1;
            memset(&p[image], 0, sizeof p[image]);
            for (int i = 0; i < 3; i++) {
                put_wheel(&p[image], cos(2.1 * i), side * sin(2.1 * i), side * (angle + i), side * (0.5 + 0.4 * i),
                          drag, 0.05);
                p[image].load[i].grip = REAL(1);
                p[image].load[i].drive_limit = LACONIC_REAL_MAX;
                p[image].load[i].free_speed = REAL(side * (0.3 - 0.2 * i));
            }
            p[image].free[0] = REAL(0.7);
            p[image].free[1] = REAL(side * 0.4);
            p[image].free[2] = REAL(side * -0.2);
            passes[image] = solve(&p[image]);
        }
        TEST_ASSERT_EQUAL_INT(passes[0], passes[1]);
        for (int m = 0; m < 3; m++) ASSERT_NEAR(EITHER(1e-9, 1e-3), (m ? -1 : 1) * p[0].nu[m], p[1].nu[m]);
    }
}

static void coasting_ends_in_exact_rest(void) {
    problem p = four_mecanum_wheels(0.5);
    for (int m = 0; m < 3; m++) p.free[m] = REAL(0.4 - 0.3 * m);
    for (int i = 0; i < 4; i++) p.load[i].free_speed = REAL(1 - 0.6 * i);
    for (int step = 0; step < 5000; step++) {
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        go_on(&p);
    }
    TEST_ASSERT_TRUE(energy_of(&p) <= 0);
}

static void what_pulls_less_than_the_grip_moves_nothing_to_the_last_bit(void) {
    problem p = four_mecanum_wheels(0.7);
    for (int i = 0; i < 4; i++) p.load[i].axle = REAL(1); /* brakes */
    for (int step = 0; step < 100000; step++) {
        p.free[0] = REAL(0.03); /* of 4 · 0.02, on rollers that turn at 0.7 of it */
        p.free[1] = REAL(step % 7 * 1e-3);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(energy_of(&p) <= 0);
    }
}

static void what_is_not_finite_is_refused(void) {
    static const laconic_real bad[2] = {NOT_A_NUMBER, INFINITE};
    const size_t fields = sizeof(friction_load) / sizeof(laconic_real);
    for (int kind = 0; kind < 2; kind++) {
        problem p = one_wheel(1);
        p.free[0] = bad[kind];
        TEST_ASSERT_EQUAL_INT(0, solve(&p));
        for (size_t field = 0; field < fields; field++) {
            p = one_wheel(1);
            p.load[0].free_speed = REAL(1);
            memcpy((char *)&p.load[0] + field * sizeof(laconic_real), &bad[kind], sizeof(laconic_real));
            TEST_ASSERT_EQUAL_INT(0, solve(&p));
        }
    }
}

static void nothing_that_moves_is_no_motion(void) {
    problem p = one_wheel(1);
    p.impulse[0][0] = REAL(1);
    p.nu[0] = p.nu[2] = p.speed[0] = p.speed[1] = REAL(7); /* there is no second wheel */
    TEST_ASSERT_EQUAL_INT(1, solve(&p));
    TEST_ASSERT_TRUE(p.nu[0] == 0 && p.nu[1] == 0 && p.nu[2] == 0 && p.impulse[0][0] == 0);
    TEST_ASSERT_TRUE(p.speed[0] == 0 && p.speed[1] == 7);
    laconic_real speed[3] = {7, 7, 7};
    TEST_ASSERT_EQUAL_INT(1, laconic_friction_solve(p.wheel, p.load, 1, p.free, p.nu, &speed[1], p.impulse));
    TEST_ASSERT_TRUE(speed[0] == 7 && speed[1] == 0 && speed[2] == 7);
}

/* Contacts beyond those that are counted are neither read nor written. */
static void what_lies_beyond_the_last_wheel_stays(void) {
    problem p = one_wheel(1), alone;
    p.free[0] = REAL(3);
    p.free[1] = REAL(0.5);
    p.wheel[1] = p.wheel[0];
    p.load[1] = p.load[0];
    alone = p;
    p.load[1].free_speed = p.load[1].drive = p.speed[1] = REAL(7);
    p.impulse[1][0] = p.impulse[1][1] = EITHER(REAL(1e30), REAL(1e15)); /* a stress that would be forgotten */
    TEST_ASSERT_EQUAL_INT(solve(&alone), solve(&p));
    TEST_ASSERT_EQUAL_MEMORY(alone.nu, p.nu, sizeof p.nu);
    TEST_ASSERT_TRUE(p.speed[0] == alone.speed[0] && p.speed[1] == 7);
    for (int m = 0; m < 2; m++) {
        TEST_ASSERT_TRUE(p.impulse[0][m] == alone.impulse[0][m]);
        TEST_ASSERT_TRUE(p.impulse[1][m] == EITHER(REAL(1e30), REAL(1e15)));
    }
}

/* A wheel that slides sideways keeps what the grip leaves: below 1e-10 of the free motion (1e-4) nothing. */
static void speeds_of_hardly_any_share_of_the_free_motion_are_none(void) {
    const double share[2] = {EITHER(0.5e-10, 0.5e-4), EITHER(2e-10, 2e-4)};
    for (int moves = 0; moves < 2; moves++) {
        problem p = one_wheel(1 - share[moves]);
        laconic_real speed[3] = {7, 7, 7};
        p.free[1] = REAL(1);
        TEST_ASSERT_GREATER_THAN(0,
                                 laconic_friction_solve(p.wheel, p.load, p.count, p.free, p.nu, &speed[1], p.impulse));
        TEST_ASSERT_TRUE(speed[0] == 7 && speed[2] == 7); /* none of its wheels' */
        if (moves)
            ASSERT_NEAR(0.1 * share[1], share[1], p.nu[1]);
        else
            TEST_ASSERT_TRUE(p.nu[1] == 0);
    }
}

/* Squares of residuals of a smaller motion would underflow. */
static void a_motion_next_to_the_least_number_s_root_is_none(void) {
    const double speed = EITHER(1e-142, 1e-14);
    for (int moves = 0; moves < 2; moves++) {
        problem p = one_wheel(0);
        p.free[1] = REAL(moves ? 2 * speed : speed);
        TEST_ASSERT_GREATER_THAN(0, solve(&p));
        TEST_ASSERT_TRUE(p.nu[1] == (moves ? p.free[1] : 0));
    }
}

/* Beside a body that a brake stops, a wheel in the air of 100 times the other's inertia has energy worth keeping. */
static void a_heavy_wheel_that_turns_slowly_is_not_at_rest(void) {
    const double speed = EITHER(3e-11, 3e-5);
    problem p = one_wheel((double)LACONIC_REAL_MAX);
    put_wheel(&p, 0, 0, PI / 2, PI / 2, 1, 100);
    p.wheel[0].inertia = 1;
    laconic_friction_prepare(&p.wheel[0]);
    p.load[0].axle = p.load[1].drive_limit = LACONIC_REAL_MAX;
    p.free[0] = 1;
    p.load[1].free_speed = REAL(speed);
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    ASSERT_NEAR(EITHER(1e-6, 1e-5) * speed, speed, p.speed[1]);
}

/* Of each wheel, also where nothing moves. */
static void wheels_stand_where_nothing_moves(void) {
    problem p = one_wheel(1);
    put_wheel(&p, 0, 1, PI / 2, PI / 2, 1, 0.5);
    p.load[1] = p.load[0];
    p.speed[0] = p.speed[1] = 7;
    TEST_ASSERT_GREATER_THAN(0, solve(&p));
    TEST_ASSERT_TRUE(p.speed[0] == 0 && p.speed[1] == 0);
}

/* Impulses and speeds times a power of two: dampings and inertias stay. */
static void scale(problem *p, laconic_real by) {
    for (int m = 0; m < 3; m++) p->free[m] *= by;
    for (int i = 0; i < p->count; i++) {
        friction_load *l = &p->load[i];
        laconic_real *const numbers[5] = {&l->grip, &l->axle, &l->drive, &l->drive_limit, &l->free_speed};
        for (int k = 0; k < 5; k++)
            if (*numbers[k] < LACONIC_REAL_MAX) *numbers[k] *= by;
    }
}

/* No bound hangs on the unit of speed. */
static void the_solution_of_a_slower_motion_is_as_much_slower_to_the_last_bit(void) {
    const laconic_real by = REAL(EITHER(0x1p-60, 0x1p-6)); /* squares of residuals stay normal numbers */
    for (int n = 0; n < 600; n++) {
        problem p;
        if (n % 2 == 0) {
            random_vehicle(&p, 1 + n % 4);
        } else { /* of which some are solved only as far as numbers tell */
            memset(&p, 0, sizeof p);
            for (int i = 0; i < 3; i++) put_wheel(&p, cos(2.1 * i), sin(2.1 * i), 2.1 * i, PI / 2, 1e-4, 1e-4);
        }
        random_loads(&p);
        random_motion(&p);
        problem slower = p;
        scale(&slower, by);
        TEST_ASSERT_EQUAL_INT(solve(&p), solve(&slower));
        for (int m = 0; m < 3; m++) TEST_ASSERT_TRUE(slower.nu[m] == p.nu[m] * by);
        for (int i = 0; i < p.count; i++) TEST_ASSERT_TRUE(slower.speed[i] == p.speed[i] * by);
    }
}

static void what_is_prepared_again_stays_and_free_rollers_have_no_mass_across(void) {
    problem p = one_wheel(1);
    put_wheel(&p, 0.3, -0.7, 0.4, PI / 2, 0, 0.5);
    TEST_ASSERT_TRUE(p.wheel[1].row_mass[1] == 0 && p.wheel[1].lateral_mass == 0 && p.wheel[1].row_mass[0] > 0);
    for (int i = 0; i < 2; i++) {
        const friction_wheel before = p.wheel[i];
        laconic_friction_prepare(&p.wheel[i]);
        TEST_ASSERT_EQUAL_MEMORY(&before, &p.wheel[i], sizeof before);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_sliding_wheel_loses_the_grip_against_its_slip);
    RUN_TEST(rolling_shares_the_motion_by_inertia);
    RUN_TEST(what_the_grip_can_hold_stops_to_the_last_bit);
    RUN_TEST(a_lifted_wheel_turns_by_its_motor_within_the_limit);
    RUN_TEST(constants_that_are_no_numbers_have_no_solution);
    RUN_TEST(rigid_contacts_with_free_rollers_give_the_model_without_slip);
    RUN_TEST(a_roller_that_does_not_turn_is_a_fixed_wheel_whatever_its_angle);
    RUN_TEST(a_wheel_with_free_rollers_at_the_border_of_its_grip_is_solved);
    RUN_TEST(little_drag_tends_to_none);
    RUN_TEST(light_wheels_whose_rollers_hardly_drag_are_solved_as_far_as_numbers_tell);
    RUN_TEST(random_vehicles_at_random_speeds_are_solved);
    RUN_TEST(coasting_vehicles_lose_energy_in_every_step_and_are_seldom_refused);
    RUN_TEST(a_vehicle_and_its_mirror_image_are_solved_in_as_many_passes);
    RUN_TEST(coasting_ends_in_exact_rest);
    RUN_TEST(what_pulls_less_than_the_grip_moves_nothing_to_the_last_bit);
    RUN_TEST(what_is_not_finite_is_refused);
    RUN_TEST(nothing_that_moves_is_no_motion);
    RUN_TEST(what_lies_beyond_the_last_wheel_stays);
    RUN_TEST(speeds_of_hardly_any_share_of_the_free_motion_are_none);
    RUN_TEST(a_motion_next_to_the_least_number_s_root_is_none);
    RUN_TEST(a_heavy_wheel_that_turns_slowly_is_not_at_rest);
    RUN_TEST(wheels_stand_where_nothing_moves);
    RUN_TEST(the_solution_of_a_slower_motion_is_as_much_slower_to_the_last_bit);
    RUN_TEST(what_is_prepared_again_stays_and_free_rollers_have_no_mass_across);
    return UNITY_END();
}
