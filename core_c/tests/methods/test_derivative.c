/* Tests of derivative.c against the paper's formulas. */
#include "reference.h"
#include "stack.h"

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
    RUN_TEST(rates_of_wheels_that_a_vehicle_has_not_stay_as_they_were);
    RUN_TEST(carriages_follow_equation_4_7);
    RUN_TEST(the_differential_drive_follows_section_6);
    RUN_TEST(what_stood_in_memory_before_does_not_matter);
    RUN_TEST(the_caster_follows_section_3);
    RUN_TEST(what_the_constraints_forbid_is_projected_away_first);
    return UNITY_END();
}
