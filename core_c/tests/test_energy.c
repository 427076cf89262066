#include "vehicles.h"

/* ½ M v² + ½ I_S θ'² + Σ ½ J χ'², from physical velocities alone. */
static void energy_is_that_of_the_moving_masses(laconic_vehicle v, double nu1, double nu2, double nu3) {
    const laconic_model m = model_of(v);
    const laconic_state state = moving(&m, nu1, nu2, nu3);
    const double speed_square = RADIUS * RADIUS * (nu1 * nu1 + nu2 * nu2), yaw = nu3 / BIG_LAMBDA;
    double energy = 0.5 * MASS * speed_square + 0.5 * 0.225 * yaw * yaw;
    laconic_real wheel[LACONIC_MAX_WHEELS];
    int i;
    laconic_wheel_speeds(&m, &state, wheel);
    for (i = 0; i < v.wheel_count; i++) energy += 0.5 * 0.009 * (double)wheel[i] * (double)wheel[i];
    ASSERT_NEAR(8 * ROUNDING, energy, laconic_energy_J(&m, &state));
}

static void energy_counts_body_and_wheels(void) {
    energy_is_that_of_the_moving_masses(three_wheels(), 0.7, -0.4, 1.9);
    energy_is_that_of_the_moving_masses(mecanum(), -0.2, 1.1, 0.3);
    energy_is_that_of_the_moving_masses(bare_body(), 1, 2, 3);
    energy_is_that_of_the_moving_masses(caster(), 1, 0, 3);
    energy_is_that_of_the_moving_masses(differential_drive(), -DELTA / BIG_LAMBDA * 2, 1, 2);
}

static void the_second_integral_is_the_third_component_of_a_nu(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    const double square = SMALL_LAMBDA * SMALL_LAMBDA;
    const double expected = -RHO * square * 0.7 + (1 + (2 * SIGMA * SIGMA + RHO * RHO) * square) * 1.9;
    ASSERT_NEAR(4 * ROUNDING, expected, laconic_yaw_integral(&m, &state));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(energy_counts_body_and_wheels);
    RUN_TEST(the_second_integral_is_the_third_component_of_a_nu);
    return UNITY_END();
}
