#include "vehicles.h"

static void velocity_is_r_nu_and_yaw_rate_nu3_over_lambda(void) {
    const laconic_model m = model_of(mecanum());
    const laconic_state state = moving(&m, 0.7, -0.4, 1.9);
    laconic_real nu[3], velocity[2];
    const laconic_real yaw_rate = laconic_body_velocity(&m, &state, velocity);
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR(4 * ROUNDING, 0.7, nu[0]);
    ASSERT_NEAR(4 * ROUNDING, -0.4, nu[1]);
    ASSERT_NEAR(4 * ROUNDING, 1.9, nu[2]);
    ASSERT_NEAR(ROUNDING, RADIUS * 0.7, velocity[0]);
    ASSERT_NEAR(ROUNDING, RADIUS * -0.4, velocity[1]);
    ASSERT_NEAR(ROUNDING, 1.9 / BIG_LAMBDA, yaw_rate);
}

static void a_constrained_vehicle_shows_its_dependent_component(void) {
    const laconic_model m = model_of(differential_drive());
    const laconic_state state = moving(&m, -DELTA / BIG_LAMBDA * 2.0, 1.0, 2.0);
    laconic_real nu[3];
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR(2 * ROUNDING, -DELTA / BIG_LAMBDA * 2.0, nu[0]);
    ASSERT_NEAR(2 * ROUNDING, 1.0, nu[1]);
    ASSERT_NEAR(2 * ROUNDING, 2.0, nu[2]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(velocity_is_r_nu_and_yaw_rate_nu3_over_lambda);
    RUN_TEST(a_constrained_vehicle_shows_its_dependent_component);
    return UNITY_END();
}
