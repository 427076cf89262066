/* Tests of step_internals: forces in body axes, and the energy that a step may gain. */
#include "step_internals.h"

#include "reference.h"
#include "stack.h"
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

/* -------------------------------------------------------------------- energy that is kept -- */

/* With w along the third axis. */
static laconic_model turning(void) {
    laconic_model m;
    memset(&m, 0, sizeof m);
    m.gyro[2] = REAL(0.5);
    m.gyro_square = REAL(0.25);
    return m;
}

/* Under a constant b; the increment after it. */
static bool step_keeps_energy(vector zeta, vector end, vector b, increment *by) {
    const laconic_model m = turning();
    laconic_forcing forcing;
    const laconic_forcing_samples samples = {&forcing, &forcing, &forcing, true};
    laconic_state state;
    memset(&forcing, 0, sizeof forcing);
    memset(&state, 0, sizeof state);
    set_zeta(&state, zeta);
    store(forcing.constant, b);
    by->delta = minus(end, zeta);
    by->mean = scaled(REAL(0.5), plus(zeta, end));
    by->slope = by->delta;
    return keeps_energy(&m, &state, REAL(0.125), &samples, zeta, by);
}

static void assert_uncut(vector zeta, vector end, vector b) {
    increment by;
    TEST_ASSERT_TRUE(step_keeps_energy(zeta, end, b, &by));
    const vector as_given = minus(end, zeta);
    TEST_ASSERT_EQUAL_MEMORY(&as_given, &by.delta, sizeof as_given);
}

static void what_a_step_gains_beyond_rounding_is_cut_across_w(void) {
    const vector zeta = {3, 4, 12}, end = {0, REAL(5.001), 12}; /* |ζ|² of 169 would be 0.010001 more */
    increment by;
    TEST_ASSERT_TRUE(step_keeps_energy(zeta, end, none, &by));
    ASSERT_NEAR(EITHER(1e-13, 5e-5), 169, square(plus(zeta, by.delta)));
    ASSERT_NEAR(EITHER(1e-15, 1e-6), 0, by.delta.z);
    ASSERT_NEAR(EITHER(1e-15, 1e-6), -3, by.delta.x);
}

static void what_rounding_gains_stays(void) {
    const vector zeta = {3, 4, 12};
    assert_uncut(zeta, (vector){0, 5 + 16 * LACONIC_EPSILON, 12}, none);
    assert_uncut(zeta, (vector){0, REAL(4.9), 12}, none);
}

/* b·(mean of ζ) of 1.5 gives 0.375 in 1/8 s. */
static void what_the_forcing_supplies_stays(void) {
    const vector zeta = {3, 4, 12}, end = {3, REAL(4.04654), 12};
    assert_uncut(zeta, end, (vector){REAL(0.5), 0, 0});
}

/* Of forces that could do the work along another motion, 1/16 may come from rounding and truncation. */
static void what_the_forcing_can_nearly_supply_stays(void) {
    const vector zeta = {3, 4, 12}, end = {3, REAL(4.01), 12};
    increment by;
    assert_uncut(zeta, end, (vector){4, -3, 0});
    TEST_ASSERT_TRUE(step_keeps_energy(zeta, end, (vector){REAL(0.04), REAL(-0.03), 0}, &by));
    ASSERT_NEAR(1e-4, 169, square(plus(zeta, by.delta)));
}

/* Beyond the tolerance, along w alone, not a number: none of these is cut. */
static void other_gains_are_not_kept(void) {
    const vector zeta = {3, 4, 12};
    increment by;
    TEST_ASSERT_FALSE(step_keeps_energy(zeta, (vector){3, REAL(4.1), 12}, none, &by));
    TEST_ASSERT_FALSE(step_keeps_energy((vector){0, 0, 12}, (vector){0, 0, REAL(12.001)}, none, &by));
    TEST_ASSERT_FALSE(step_keeps_energy(zeta, (vector){3, NOT_A_NUMBER, 12}, none, &by));
    TEST_ASSERT_FALSE(step_keeps_energy(zeta, (vector){3, INFINITE, 12}, none, &by));
}

/* Where nothing turns ζ, all of it is shortened. */
static void without_w_all_of_the_motion_is_cut(void) {
    const vector zeta = {3, 4, 12}, end = {3, 4, REAL(12.001)};
    laconic_model m = turning();
    laconic_forcing forcing;
    laconic_state state;
    const laconic_forcing_samples samples = {&forcing, &forcing, &forcing, true};
    increment by = {minus(end, zeta), zeta, none};
    memset(&forcing, 0, sizeof forcing);
    memset(&state, 0, sizeof state);
    set_zeta(&state, zeta);
    m.gyro[2] = m.gyro_square = 0;
    TEST_ASSERT_TRUE(keeps_energy(&m, &state, REAL(0.125), &samples, zeta, &by));
    ASSERT_NEAR(EITHER(1e-13, 5e-5), 169, square(plus(zeta, by.delta)));
    TEST_ASSERT_TRUE(by.delta.x < 0 && by.delta.y < 0);
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

/* Tests of derivative.c against the paper's formulas. */

static void is_the_papers_right_hand_side(laconic_vehicle v) {
    const laconic_model model = model_of(v);
    const reference p = reference_of(&v);
    const laconic_input input = every_input();
    const laconic_real nu[3] = {REAL(0.8), REAL(-1.3), REAL(2.1)};
    for (double heading = -7; heading < 7; heading += 0.9) {
        double y[6 + LACONIC_MAX_WHEELS] = {0}, rate[6 + LACONIC_MAX_WHEELS];
        laconic_rates rates;
        for (int i = 0; i < 3; i++) y[i] = (double)nu[i];
        y[5] = (double)REAL(heading);
        reference_rate(&p, y, &input, rate);
        laconic_derivative(&rates, &model, nu, REAL(heading), &input);
        ASSERT_NEAR_ALL(EITHER(2e-13, 1e-4), rate, rates.nu_rad_per_s2, 3);
        ASSERT_NEAR(ROUNDING, rate[3], rates.x_m_per_s);
        ASSERT_NEAR(ROUNDING, rate[4], rates.y_m_per_s);
        ASSERT_NEAR(ROUNDING, rate[5], rates.yaw_rate_rad_per_s);
        ASSERT_NEAR_ALL(10 * ROUNDING, &rate[6], rates.wheel_speed_rad_per_s, v.wheel_count);
    }
}

static void rates_of_wheels_that_a_vehicle_has_not_stay_as_they_were(void) {
    const laconic_model model = model_of(three_wheels());
    const laconic_real nu[3] = {REAL(0.8), REAL(-1.3), REAL(2.1)};
    const laconic_input input = no_input();
    laconic_rates rates;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) rates.wheel_speed_rad_per_s[i] = 7;
    laconic_derivative(&rates, &model, nu, 0, &input);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) TEST_ASSERT_TRUE((rates.wheel_speed_rad_per_s[i] == 7) == (i >= 3));
}

static void carriages_follow_equation_4_7(void) {
    is_the_papers_right_hand_side(with_motors(three_wheels()));
    is_the_papers_right_hand_side(with_motors(mecanum()));
    is_the_papers_right_hand_side(bare_body());
}

static void the_differential_drive_follows_section_6(void) {
    const laconic_model model = model_of(with_motors(differential_drive()));
    const double nu2 = 1.7, nu3 = -0.9, u[2] = {2.0, 0.5}, unit = UNIT_INERTIA;
    const double square = SMALL_LAMBDA * SMALL_LAMBDA, s = DRIVE_SIGMA, big = BIG_LAMBDA * BIG_LAMBDA;
    const double m1 = GAIN * u[0] - DAMPING * (nu2 + s * nu3), m2 = GAIN * u[1] - DAMPING * (-nu2 + s * nu3);
    const double a2 = 1 + 2 * square, a3 = 1 + 2 * s * s * square;
    const double rate2 = (DELTA / big * nu3 * nu3 + (m1 - m2) / unit) / a2;
    const double rate3 = (-DELTA / big * nu2 * nu3 + s * (m1 + m2) / unit) / (DELTA * DELTA / big + a3);
    const laconic_real nu[3] = {REAL(-DELTA * nu3 / BIG_LAMBDA), REAL(nu2), REAL(nu3)};
    laconic_input input = no_input();
    laconic_rates rates;
    input.voltage_V[0] = REAL(u[0]);
    input.voltage_V[1] = REAL(u[1]);
    laconic_derivative(&rates, &model, nu, 0, &input);
    ASSERT_NEAR(EITHER(1e-13, 5e-5), -DELTA / BIG_LAMBDA * rate3, rates.nu_rad_per_s2[0]);
    ASSERT_NEAR(EITHER(1e-13, 5e-5), rate2, rates.nu_rad_per_s2[1]);
    ASSERT_NEAR(EITHER(1e-13, 5e-5), rate3, rates.nu_rad_per_s2[2]);
}

/* Where no force is fixed in the world, the core leaves what would turn with the heading unset. */
static void what_stood_in_memory_before_does_not_matter(void) {
    const laconic_model model = model_of(with_motors(three_wheels()));
    const laconic_real nu[3] = {REAL(0.8), REAL(-1.3), REAL(2.1)};
    laconic_input input = no_input();
    laconic_rates rates, again;
    input.voltage_V[1] = 4;
    memset(&rates, 0, sizeof rates);
    memset(&again, 0, sizeof again);
    fill_stack(0);
    laconic_derivative(&rates, &model, nu, 1, &input);
    fill_stack(ALL_NAN);
    laconic_derivative(&again, &model, nu, 1, &input);
    TEST_ASSERT_EQUAL_MEMORY(&rates, &again, sizeof rates);
}

/* J1 θ'' = D F sin θ, (J3 + m R²) χ'' = R F cos θ for a force F along OX at C − D e_ξ. */
static void the_caster_follows_section_3(void) {
    const laconic_model model = model_of(caster());
    const double force = 3.0, arm = 0.12;
    const laconic_real nu[3] = {REAL(0.5), 0, REAL(-0.8)};
    laconic_input input = no_input();
    input.world_force_N[0] = REAL(force);
    input.world_force_point_m[0] = REAL(-arm);
    for (double heading = -3; heading < 3; heading += 0.7) {
        laconic_rates rates;
        laconic_derivative(&rates, &model, nu, REAL(heading), &input);
        ASSERT_NEAR(EITHER(1e-13, 2e-5), RADIUS * force * cos(heading) / (0.009 + UNIT_INERTIA),
                    rates.nu_rad_per_s2[0]);
        ASSERT_NEAR(EITHER(1e-13, 2e-5), 0, rates.nu_rad_per_s2[1]);
        ASSERT_NEAR(EITHER(1e-13, 2e-5), BIG_LAMBDA * arm * force * sin(heading) / 0.225, rates.nu_rad_per_s2[2]);
        ASSERT_NEAR(ROUNDING, 0.5, rates.wheel_speed_rad_per_s[0]);
    }
}

static void what_the_constraints_forbid_is_projected_away_first(void) {
    const laconic_model model = model_of(caster());
    const laconic_real nu[3] = {REAL(0.5), REAL(9), REAL(-0.8)};
    const laconic_input input = no_input();
    laconic_rates rates;
    laconic_derivative(&rates, &model, nu, 0, &input);
    ASSERT_NEAR(ROUNDING, RADIUS * 0.5, rates.x_m_per_s);
    ASSERT_NEAR(ROUNDING, 0, rates.y_m_per_s);
    ASSERT_NEAR(ROUNDING, -0.8 / BIG_LAMBDA, rates.yaw_rate_rad_per_s);
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
    RUN_TEST(what_a_step_gains_beyond_rounding_is_cut_across_w);
    RUN_TEST(what_rounding_gains_stays);
    RUN_TEST(what_the_forcing_supplies_stays);
    RUN_TEST(what_the_forcing_can_nearly_supply_stays);
    RUN_TEST(other_gains_are_not_kept);
    RUN_TEST(without_w_all_of_the_motion_is_cut);
    RUN_TEST(at_the_border_the_chord_has_the_digits_of_the_polynomials);
    RUN_TEST(rates_of_wheels_that_a_vehicle_has_not_stay_as_they_were);
    RUN_TEST(carriages_follow_equation_4_7);
    RUN_TEST(the_differential_drive_follows_section_6);
    RUN_TEST(what_stood_in_memory_before_does_not_matter);
    RUN_TEST(the_caster_follows_section_3);
    RUN_TEST(what_the_constraints_forbid_is_projected_away_first);
    return UNITY_END();
}
