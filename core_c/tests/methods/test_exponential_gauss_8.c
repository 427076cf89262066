/* Tests of exponential_gauss_8.c: order, steady motions, stiff vehicles, panels, drift, refusals. */
#include "exponential_gauss_8.h"
#include "methods.h"
#include "stiff.h"

/* In single precision 8 steps already err by little more than rounding, and half as many are beyond the gyroscopic
 * limit. */
static void assert_eighth_order_under(laconic_input input) {
    const laconic_vehicle v = with_motors(three_wheels());
    if (EITHER(true, false)) {
        assert_order(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 2.0, 16, 8);
    } else {
        const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 2.0, 8);
        TEST_ASSERT_TRUE(e.nu < 1e-4 && e.pose < 1e-5 && e.wheels < 1e-5);
    }
}

static void is_of_eighth_order_under_everything_that_can_act(void) { assert_eighth_order_under(every_input()); }

static void is_of_eighth_order_without_a_world_force(void) {
    laconic_input input = every_input();
    input.world_force_N[0] = input.world_force_N[1] = 0;
    assert_eighth_order_under(input);
}

static void large_steps_meet_the_reference(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_input input = every_input();
    const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, 1, 4), &input, 1.0, 25);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-11, 1e-5));
}

/* h·r of 0.3 is one panel, of 30 many of them and the rest. */
static void damping_and_forcing_alone_are_exact_in_one_panel_and_in_many(void) {
    laconic_vehicle v = with_motors(three_wheels());
    laconic_input input = no_input();
    input.voltage_V[0] = REAL(1);
    input.voltage_V[1] = REAL(-1); /* straight along η, without yaw */
    for (int k = 0; k < 3; k++) {
        const errors e = errors_of(&laconic_exponential_gauss_8, &v, start_with(0, 1, 0), &input, 1.0, 1);
        TEST_ASSERT_TRUE(e.nu < EITHER(1e-13, 4e-6));
        TEST_ASSERT_TRUE(e.wheels < EITHER(1e-13, 4e-6));
        v.motor_damping_Nms *= REAL(10);
    }
}

static void a_steady_motion_stays_at_any_step(void) {
    assert_steady_motion_stays(&laconic_exponential_gauss_8, 0.1);
    assert_steady_motion_stays(&laconic_exponential_gauss_8, 0.4);
}

static void a_stiff_vehicle_reaches_its_steady_motion(void) {
    assert_stiff_vehicle_reaches_its_steady_motion(&laconic_exponential_gauss_8, EITHER(1e-13, 1e-5));
}

/* On the way to its steady motion such a vehicle yaws and slides at once; against 1,000 small steps. */
static void what_dies_out_within_a_step_is_integrated(void) {
    laconic_vehicle v = stiff();
    laconic_input input = no_input();
    errors e;
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(i - 1);
    e = errors_of(&laconic_exponential_gauss_8, &v, start_with(2, -3, 4), &input, 0.02, 1);
    TEST_ASSERT_TRUE(e.nu < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.pose < EITHER(1e-11, 1e-5));
    TEST_ASSERT_TRUE(e.wheels < EITHER(1e-11, 1e-5));
}

static void damping_beyond_the_panels_is_taken(void) {
    const laconic_model m = model_of(stiff());
    laconic_state state = moving(&m, 1, 1, 0);
    const laconic_input input = no_input();
    take_steps(&laconic_exponential_gauss_8, &m, &state, &input, 1e5, 3);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0, laconic_energy_J(&m, &state));
}

static void energy_and_k_drift_only_by_the_truncation_error(void) {
    const laconic_vehicle v = three_wheels();
    const drift d = free_drift(&laconic_exponential_gauss_8, &v, 0.05, 2000);
    TEST_ASSERT_TRUE(d.energy < EITHER(1e-12, 1e-5));
    TEST_ASSERT_TRUE(d.yaw_integral < EITHER(1e-12, 1e-5));
}

/* From rest, by a b that grows from 0 along one of ζ's axes alone: what else moves, the gyroscopic term has made. */
static void end_of_one_axis(double zeta[3], const laconic_model *m, const laconic_method *method, int axis, int steps) {
    const laconic_integrator in = integrator_of(method, m, 0.25 / steps);
    laconic_state state = moving(m, 0, 0, 0);
    for (int i = 0; i < steps; i++) {
        laconic_forcing at[3];
        memset(at, 0, sizeof at);
        for (int k = 0; k < 3; k++) at[k].constant[axis] = REAL(6 * (i + 0.5 * k) / steps);
        const laconic_forcing_samples samples = {&at[0], &at[1], &at[2], false};
        ASSERT_STATUS(LACONIC_OK, method->step(m, &in, &state, &samples));
    }
    for (int k = 0; k < 3; k++) zeta[k] = (double)state.zeta[k].value;
}

static void a_forcing_along_one_axis_turns_the_motion(void) {
    laconic_vehicle v = with_own_wheels(with_motors(three_wheels()));
    v.com_x_m = REAL(0.03);
    const laconic_model m = model_of(v);
    for (int axis = 0; axis < 3; axis++) {
        double whole[3], fine[3];
        end_of_one_axis(whole, &m, &laconic_exponential_gauss_8, axis, 1);
        end_of_one_axis(fine, &m, &laconic_taylor_8, axis, 32);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(fabs(fine[k]) > 1e-4);
            ASSERT_NEAR(EITHER(1e-8, 1e-5), fine[k], whole[k]);
        }
    }
}

static void a_yaw_too_fast_for_the_step_is_refused(void) { assert_too_fast_yaw_refused(&laconic_exponential_gauss_8); }

static void a_step_that_gains_energy_is_refused(void) {
    start_that_gains_energy(&laconic_exponential_gauss_8, three_wheels(), every_input(), 1.0, 500);
}

/* Near the end of the method the rounds converge late; ROUNDS alone would gain 1e-5 of ζ in such a step. */
static void free_motion_keeps_its_energy_where_the_rounds_converge_late(void) {
    const laconic_model m = model_of(three_wheels());
    const double gyro = sqrt((double)m.gyro_square), yaw_rate = 30;
    const laconic_input none_acts = no_input();
    laconic_state state = moving(&m, 20, 10, yaw_rate);
    const double energy_J = (double)laconic_energy_J(&m, &state);
    take_steps(&laconic_exponential_gauss_8, &m, &state, &none_acts, 1.85 / (gyro * yaw_rate), 1000);
    TEST_ASSERT_TRUE(fabs((double)laconic_energy_J(&m, &state) / energy_J - 1) < EITHER(1e-12, 1e-6));
}

/* A moment that turns the vehicle by several radians within the step. */
static void a_step_whose_rounds_do_not_converge_is_refused(void) {
    laconic_input input = every_input();
    input.world_force_N[0] = REAL(5);
    input.world_force_point_m[0] = REAL(0.5);
    input.body_moment_Nm = REAL(EITHER(-8, 8));
    assert_step_refused(&laconic_exponential_gauss_8, three_wheels(), start_with(0.8, -0.5, 2.4), input, 0.8,
                        LACONIC_STEP_SINGULAR);
}

static void numbers_beyond_the_range_are_refused(void) { assert_too_large_force_refused(&laconic_exponential_gauss_8); }

/* Tests of the panels of a step with fast damping: how many, how long, and those of an integrator of half steps. */

/* One stretch of the first kind in decay times. */
#define FIRST (REAL(PARTS) * PANEL_DECAY)

static laconic_model damped(laconic_real x, laconic_real y, laconic_real z) {
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.decay_per_s[0] = x;
    m.decay_per_s[1] = y;
    m.decay_per_s[2] = z;
    return m;
}

static laconic_integrator with_panels(laconic_real x, laconic_real y, laconic_real z) {
    const laconic_model m = damped(x, y, z);
    return integrator_of(&laconic_exponential_gauss_8, &m, 1);
}

static laconic_integrator halved(laconic_real x, laconic_real y, laconic_real z) {
    const laconic_model m = damped(x, y, z);
    laconic_integrator in = integrator_of(&laconic_exponential_gauss_8, &m, 1);
    laconic_halve_panels(&in, &m);
    TEST_ASSERT_TRUE(in.halved);
    return in;
}

/* 1, 1, 2, 4 …: the time that has passed after the stretches, in units of the first. */
static laconic_real end_of(int32_t stretches) { return (laconic_real)((uint64_t)1 << (stretches - 1)); }

static void the_longest_step_of_one_panel_is_one(void) {
    const laconic_real above = WHOLE_DECAY * (1 + LACONIC_EPSILON);
    TEST_ASSERT_EQUAL_INT(0, with_panels(WHOLE_DECAY, 0, 0).stretches);
    TEST_ASSERT_TRUE(with_panels(above, 0, 0).stretches > 0);
    TEST_ASSERT_EQUAL_INT(0, halved(0, WHOLE_DECAY / 2, 0).stretches);
    TEST_ASSERT_TRUE(halved(0, above / 2, 0).stretches > 0);
}

static void stretches_end_when_they_cover_the_step(void) {
    laconic_integrator in = with_panels(0, 0, 2 * FIRST);
    TEST_ASSERT_EQUAL_INT(2, in.stretches);
    TEST_ASSERT_FALSE(in.has_rest);
    ASSERT_NEAR(ROUNDING, 1.0 / (2 * PARTS), in.first_share);
    in = with_panels(0, 0, 2 * FIRST * (1 + LACONIC_EPSILON));
    TEST_ASSERT_EQUAL_INT(3, in.stretches);
    ASSERT_NEAR(ROUNDING, 1.0 / (4 * PARTS), in.first_share);
}

/* Not before it is dead, and not a stretch later; `scale`: 2 where panels are halved. */
static void assert_rest_once_dead(const laconic_integrator *in, int scale) {
    const laconic_real end = end_of(in->stretches);
    TEST_ASSERT_TRUE(in->has_rest);
    TEST_ASSERT_TRUE(end * FIRST >= (laconic_real)scale * DEAD_AFTER);
    TEST_ASSERT_TRUE(end / 2 * FIRST < (laconic_real)scale * DEAD_AFTER);
    ASSERT_NEAR(ROUNDING, 1, in->rest_share + end * REAL(scale * PARTS) * in->first_share);
}

static void when_all_has_died_out_the_rest_of_the_step_is_one_panel(void) {
    const laconic_integrator whole = with_panels(0, 0, REAL(1e4)), half = halved(0, 0, REAL(1e4));
    assert_rest_once_dead(&whole, 1);
    assert_rest_once_dead(&half, 2);
    ASSERT_NEAR(ROUNDING * 1e-4, PANEL_DECAY * REAL(1e-4), whole.first_share);
    ASSERT_NEAR(ROUNDING * 1e-4, PANEL_DECAY * REAL(0.5e-4), half.first_share);
}

/* After 18 decay times, in single 12, of the slower axis: of 32 first stretches, or of 64 where 32 end just before. */
static void an_axis_has_died_out_after_so_many_decay_times(void) {
    const double fast = 1000, reached = 32 * EITHER(3 * 0.375, 0.5) / fast; /* of the slow axis, by its decay */
    const laconic_integrator dead = with_panels(REAL(EITHER(18.01, 12.01) / reached), 0, REAL(fast));
    const laconic_integrator alive = with_panels(REAL(EITHER(17.99, 11.99) / reached), 0, REAL(fast));
    TEST_ASSERT_TRUE(dead.has_rest && alive.has_rest);
    ASSERT_NEAR(ROUNDING, 32, end_of(dead.stretches));
    ASSERT_NEAR(ROUNDING, 64, end_of(alive.stretches));
}

/* An axis on which the whole step is no longer than a panel may be has nothing that must die out before the rest. */
static void an_axis_that_fits_one_panel_does_not_put_off_the_rest(void) {
    const laconic_integrator in = with_panels(PANEL_DECAY, 0, REAL(1000));
    assert_rest_once_dead(&in, 1);
    TEST_ASSERT_FALSE(with_panels(PANEL_DECAY * (1 + LACONIC_EPSILON), 0, REAL(1000)).has_rest);
}

static void there_are_no_more_stretches_than_the_most(void) {
    const laconic_integrator in = with_panels(REAL(1), 0, REAL(1e9));
    TEST_ASSERT_EQUAL_INT(MOST_STRETCHES, in.stretches);
    TEST_ASSERT_FALSE(in.has_rest);
    ASSERT_NEAR(ROUNDING, 1, end_of(MOST_STRETCHES) * REAL(PARTS) * in.first_share);
}

/* Nothing changes in an integrator of a method without panels. */
static void panels_of_other_methods_are_not_halved(void) {
    const laconic_model m = damped(REAL(1), REAL(2), REAL(0.5));
    for (int32_t i = 0; i < LACONIC_METHOD_COUNT; i++) {
        const laconic_method *method = laconic_method_by_number(i);
        if (method == &laconic_auto || method == &laconic_exponential_gauss_8) continue;
        const laconic_integrator before = integrator_of(method, &m, 1);
        laconic_integrator in = before;
        laconic_halve_panels(&in, &m);
        TEST_ASSERT_EQUAL_MEMORY(&before, &in, sizeof in);
    }
}

static void an_axis_without_damping_does_not_keep_panels_from_being_halved(void) {
    TEST_ASSERT_TRUE(halved(0, 0, REAL(9)).stretches > 0);
    TEST_ASSERT_TRUE(halved(REAL(9), 0, 0).stretches > 0);
    TEST_ASSERT_TRUE(halved(0, REAL(9), 0).stretches > 0);
}

/* Their first panel is so long that what there is at its nodes has underflowed. */
static void the_longest_panels_are_halved_too(void) {
    const laconic_integrator in = with_panels(REAL(1e15), 0, REAL(1));
    TEST_ASSERT_TRUE(in.collocation[0][0] == 0);
    TEST_ASSERT_TRUE(halved(REAL(1e15), 0, REAL(1)).first_share == in.first_share / 2);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(is_of_eighth_order_under_everything_that_can_act);
    RUN_TEST(is_of_eighth_order_without_a_world_force);
    RUN_TEST(large_steps_meet_the_reference);
    RUN_TEST(damping_and_forcing_alone_are_exact_in_one_panel_and_in_many);
    RUN_TEST(a_steady_motion_stays_at_any_step);
    RUN_TEST(a_stiff_vehicle_reaches_its_steady_motion);
    RUN_TEST(what_dies_out_within_a_step_is_integrated);
    RUN_TEST(damping_beyond_the_panels_is_taken);
    RUN_TEST(energy_and_k_drift_only_by_the_truncation_error);
    RUN_TEST(a_forcing_along_one_axis_turns_the_motion);
    RUN_TEST(a_yaw_too_fast_for_the_step_is_refused);
    RUN_TEST(a_step_that_gains_energy_is_refused);
    RUN_TEST(free_motion_keeps_its_energy_where_the_rounds_converge_late);
    RUN_TEST(a_step_whose_rounds_do_not_converge_is_refused);
    RUN_TEST(numbers_beyond_the_range_are_refused);
    RUN_TEST(the_longest_step_of_one_panel_is_one);
    RUN_TEST(stretches_end_when_they_cover_the_step);
    RUN_TEST(when_all_has_died_out_the_rest_of_the_step_is_one_panel);
    RUN_TEST(an_axis_has_died_out_after_so_many_decay_times);
    RUN_TEST(an_axis_that_fits_one_panel_does_not_put_off_the_rest);
    RUN_TEST(there_are_no_more_stretches_than_the_most);
    RUN_TEST(panels_of_other_methods_are_not_halved);
    RUN_TEST(an_axis_without_damping_does_not_keep_panels_from_being_halved);
    RUN_TEST(the_longest_panels_are_halved_too);
    return UNITY_END();
}
