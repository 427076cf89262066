/* Tests of step_internals: forces in body axes, and the energy that a step may gain. */
#include "step_internals.h"

#include "vehicles.h"

/* --------------------------------------------------------------------------------- forcing -- */

/* b = Gᵀ(Ξᵀ(c1 U + T) + w)/(M R²), computed with the matrices of laconic_matrices_of(). */
static void expected_forcing(double b[3], const laconic_vehicle *v, const laconic_input *in, double heading) {
    const laconic_model m = model_of(*v);
    laconic_matrices x;
    double right[3];
    const double along = cos(heading) * (double)in->world_force_N[0] + sin(heading) * (double)in->world_force_N[1];
    const double across = cos(heading) * (double)in->world_force_N[1] - sin(heading) * (double)in->world_force_N[0];
    ASSERT_STATUS(LACONIC_OK, laconic_matrices_of(&x, v, NULL));
    right[0] = RADIUS * ((double)in->body_force_N[0] + along);
    right[1] = RADIUS * ((double)in->body_force_N[1] + across);
    right[2] = ((double)in->body_moment_Nm + (double)in->world_force_point_m[0] * across -
                (double)in->world_force_point_m[1] * along) /
               BIG_LAMBDA;
    for (int i = 0; i < v->wheel_count; i++)
        for (int k = 0; k < 3; k++)
            right[k] += (double)x.wheel_rows[i][k] * (GAIN * (double)in->voltage_V[i] + (double)in->axle_torque_Nm[i]);
    for (int k = 0; k < 3; k++) {
        b[k] = 0;
        for (int i = 0; i < 3; i++) b[k] += (double)m.nu_of_zeta[i][k] * right[i] / UNIT_INERTIA;
    }
}

static void everything_that_acts_is_in_the_forcing(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_model m = model_of(v);
    const laconic_input input = every_input();
    laconic_forcing forcing;
    laconic_forcing_of(&forcing, &m, &input);
    TEST_ASSERT_TRUE(forcing.rotates);
    for (double heading = -3; heading < 3; heading += 0.8) {
        double expected[3];
        expected_forcing(expected, &v, &input, heading);
        for (int k = 0; k < 3; k++)
            ASSERT_NEAR(EITHER(1e-13, 5e-5), expected[k],
                        (double)forcing.constant[k] + cos(heading) * (double)forcing.cosine[k] +
                            sin(heading) * (double)forcing.sine[k]);
    }
}

static void without_a_world_force_the_forcing_does_not_rotate(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_model m = model_of(v);
    laconic_input input = every_input();
    laconic_forcing forcing;
    double expected[3];
    input.world_force_N[0] = input.world_force_N[1] = 0;
    laconic_forcing_of(&forcing, &m, &input);
    TEST_ASSERT_FALSE(forcing.rotates);
    expected_forcing(expected, &v, &input, 0);
    ASSERT_NEAR_ALL(EITHER(1e-13, 5e-5), expected, forcing.constant, 3);
}

static void every_part_of_a_wrench_counts_alone(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    const laconic_model m = model_of(v);
    for (int part = 0; part < 3; part++) {
        laconic_input input = no_input();
        laconic_forcing forcing;
        double expected[3];
        if (part < 2)
            input.body_force_N[part] = REAL(2);
        else
            input.body_moment_Nm = REAL(0.3);
        laconic_forcing_of(&forcing, &m, &input);
        expected_forcing(expected, &v, &input, 0);
        ASSERT_NEAR_ALL(EITHER(1e-13, 5e-5), expected, forcing.constant, 3);
    }
}

static void either_component_of_a_world_force_rotates_the_forcing_and_so_does_nan(void) {
    const laconic_model m = model_of(three_wheels());
    laconic_input input = no_input();
    laconic_forcing forcing;
    input.world_force_N[1] = REAL(1);
    laconic_forcing_of(&forcing, &m, &input);
    TEST_ASSERT_TRUE(forcing.rotates);
    input = no_input();
    input.world_force_N[0] = NOT_A_NUMBER;
    laconic_forcing_of(&forcing, &m, &input);
    TEST_ASSERT_TRUE(forcing.rotates);
}

/* -------------------------------------------------- a force fixed in the world, at a heading -- */

/* b = constant + cos θ · cosine + sin θ · sine, at the heading of a state and after a further yaw. */
static void a_force_fixed_in_the_world_rotates_against_the_body(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_input input = every_input();
    const double headings[] = {-2.5, -0.3, 0.0, 0.9, 3.0}, offsets[] = {-0.7, 0.0, 1.3};
    laconic_forcing forcing;
    laconic_forcing_of(&forcing, &m, &input);
    for (size_t i = 0; i < 5; i++)
        for (size_t j = 0; j < 3; j++) {
            laconic_start start = start_with(0, 0, 0);
            const double angle = headings[i] + offsets[j];
            laconic_state state;
            start.heading_rad = REAL(headings[i]);
            state = state_of(&m, start);
            vector b = laconic_forcing_after_yaw(&forcing, &state.heading, REAL(offsets[j]));
            ASSERT_NEAR(EITHER(1e-13, 5e-5),
                        (double)forcing.constant[0] + cos(angle) * (double)forcing.cosine[0] +
                            sin(angle) * (double)forcing.sine[0],
                        b.x);
            ASSERT_NEAR(EITHER(1e-13, 5e-5),
                        (double)forcing.constant[2] + cos(angle) * (double)forcing.cosine[2] +
                            sin(angle) * (double)forcing.sine[2],
                        b.z);
        }
}

/* ------------------------------------------------------------------------------------ energy -- */

/* ζ goes from 1 to 1.2 along the first axis in 0.1 s: |ζ|² grows by 0.44, which takes a mean b of 2. */
static bool growth_is_supplied_by(real start, real middle, real end, real grown) {
    const laconic_model m = model_of(bare_body());
    const increment by = {{grown, 0, 0}, {REAL(1) + grown / 2, 0, 0}, {grown, 0, 0}};
    laconic_forcing forcing[3];
    const laconic_forcing_samples samples = {&forcing[0], &forcing[1], &forcing[2], false};
    laconic_state state;
    memset(forcing, 0, sizeof forcing);
    memset(&state, 0, sizeof state);
    state.zeta[0].value = REAL(1);
    forcing[0].constant[0] = start;
    forcing[1].constant[0] = middle;
    forcing[2].constant[0] = end;
    return passive(&m, &state, REAL(0.1), &samples, (vector){REAL(1), 0, 0}, by);
}

static void growth_that_the_forcing_supplies_is_allowed(void) {
    TEST_ASSERT_TRUE(growth_is_supplied_by(REAL(2), REAL(2), REAL(2), REAL(0.2)));
    TEST_ASSERT_TRUE(growth_is_supplied_by(REAL(0), REAL(2), REAL(4), REAL(0.2)));
    TEST_ASSERT_TRUE(growth_is_supplied_by(REAL(1.9), REAL(2.02), REAL(2.02), REAL(0.2)));
    TEST_ASSERT_TRUE(growth_is_supplied_by(REAL(5), REAL(5), REAL(5), REAL(0.2)));
}

static void growth_beyond_the_forcing_is_not(void) {
    TEST_ASSERT_FALSE(growth_is_supplied_by(REAL(0), REAL(0), REAL(0), REAL(0.2)));
    TEST_ASSERT_FALSE(growth_is_supplied_by(REAL(-2), REAL(-2), REAL(-2), REAL(0.2)));
    TEST_ASSERT_FALSE(growth_is_supplied_by(REAL(1), REAL(1), REAL(1), REAL(0.2)));
}

static void a_loss_is_always_allowed(void) {
    TEST_ASSERT_TRUE(growth_is_supplied_by(REAL(0), REAL(0), REAL(0), REAL(-0.2)));
}

static void nan_is_not_passive(void) {
    TEST_ASSERT_FALSE(growth_is_supplied_by(REAL(2), REAL(2), REAL(2), NOT_A_NUMBER));
    TEST_ASSERT_FALSE(growth_is_supplied_by(NOT_A_NUMBER, REAL(2), REAL(2), REAL(0.2)));
}

/* Under a constant b. */
static bool step_is_passive(vector zeta, vector end, real step_s, vector b, vector mean) {
    const laconic_model m = model_of(bare_body());
    const increment by = {minus(end, zeta), mean, none};
    laconic_forcing forcing;
    const laconic_forcing_samples samples = {&forcing, &forcing, &forcing, true};
    laconic_state state;
    memset(&forcing, 0, sizeof forcing);
    memset(&state, 0, sizeof state);
    set_zeta(&state, zeta);
    store(forcing.constant, b);
    return passive(&m, &state, step_s, &samples, zeta, by);
}

/* |ζ|² grows from 2046 to 2050, as 1023 : 1025, while the forcing brakes; then by a little more. */
static void growth_by_just_the_tolerance_is_rounding(void) {
    const vector zeta = {43, 14, 1}, brakes = {-1, 0, 0}, mean = {44, 10, 1};
    TEST_ASSERT_TRUE(step_is_passive(zeta, (vector){45, 5, 0}, 1, brakes, mean));
    TEST_ASSERT_FALSE(step_is_passive(zeta, (vector){45, 5, REAL(0.125)}, 1, brakes, mean));
}

/* From rest to |ζ|² = 1024, of which the tolerance leaves 1023. */
static void growth_of_just_what_the_forcing_supplies_is_allowed(void) {
    const vector end = {32, 0, 0}, mean = {1, 0, 0};
    TEST_ASSERT_TRUE(step_is_passive(none, end, REAL(0.5), (vector){1023, 0, 0}, mean));
    TEST_ASSERT_FALSE(step_is_passive(none, end, REAL(0.5), (vector){REAL(1022.9375), 0, 0}, mean));
}

/* The power is near the end of the range of numbers, the energy of a short step is not. */
static void the_power_is_taken_over_the_step_before_it_is_doubled(void) {
    const real speed = REAL(EITHER(1e153, 1e18)), mean = REAL(EITHER(1e154, 1e19));
    TEST_ASSERT_FALSE(step_is_passive(none, (vector){speed, 0, 0}, REAL(1e-10), (vector){REAL(1.75) * mean, 0, 0},
                                      (vector){mean, 0, 0}));
}

/* ------------------------------------------------------------------------------------ rest -- */

/* Half of the last place of AT_REST, which is 1e-150 or 1e-18. */
static void what_is_left_of_a_motion_ends_where_its_square_is_still_a_normal_number(void) {
    laconic_sum sums[3];
    memset(sums, 0, sizeof sums);
    sums[0].value = REAL(EITHER(4e-166, 2e-25));
    sums[1].value = REAL(EITHER(4e-167, 2e-26));
    sums[2].value = -sums[1].value;
    flush_decayed(sums);
    TEST_ASSERT_TRUE(sums[0].value > 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)sums[1].value);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)sums[2].value);
}

/* ------------------------------------------------------------------------------------- chord -- */

/* α² is just what the polynomials go to; the quotient that larger angles take has lost digits here. */
static void at_the_border_the_chord_has_the_digits_of_the_polynomials(void) {
    for (int sign = -1; sign <= 1; sign += 2) {
        real sinc, half_j1;
        chord_factors(&sinc, &half_j1, REAL(0.125) * REAL(sign));
        ASSERT_NEAR(2 * LACONIC_EPSILON, 8 * sin(0.125), sinc);
        TEST_ASSERT_TRUE(half_j1 == REAL(sign) * REAL(EITHER(0x1.54cce04c9ea0cp-6, 0x1.54ccdcp-6)));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(everything_that_acts_is_in_the_forcing);
    RUN_TEST(without_a_world_force_the_forcing_does_not_rotate);
    RUN_TEST(every_part_of_a_wrench_counts_alone);
    RUN_TEST(either_component_of_a_world_force_rotates_the_forcing_and_so_does_nan);
    RUN_TEST(a_force_fixed_in_the_world_rotates_against_the_body);
    RUN_TEST(growth_that_the_forcing_supplies_is_allowed);
    RUN_TEST(growth_beyond_the_forcing_is_not);
    RUN_TEST(a_loss_is_always_allowed);
    RUN_TEST(nan_is_not_passive);
    RUN_TEST(what_is_left_of_a_motion_ends_where_its_square_is_still_a_normal_number);
    RUN_TEST(growth_by_just_the_tolerance_is_rounding);
    RUN_TEST(growth_of_just_what_the_forcing_supplies_is_allowed);
    RUN_TEST(the_power_is_taken_over_the_step_before_it_is_doubled);
    RUN_TEST(at_the_border_the_chord_has_the_digits_of_the_polynomials);
    return UNITY_END();
}
