#include "integrator.h"

#include "methods.h"

/* One axis alone, ζ' = −rζ + b + s t: increment, mean and first moment by fine quadrature of the exact solution. */
static void factors_are_those_of_the_damped_axis(void) {
    const double rates[3] = {0.0, 0.7, 40.0}, h = 0.8, zeta = 1.3, b = -0.4, slope = 2.1;
    const int n = 20000;
    laconic_model m;
    laconic_decay d;
    int k, i;
    memset(&m, 0, sizeof m);
    for (k = 0; k < 3; k++) m.decay_per_s[k] = REAL(rates[k]);
    laconic_decay_of(&d, &m, REAL(h));
    for (k = 0; k < 3; k++) {
        const double r = rates[k], change = slope * h;
        double end = 0, mean = 0, moment = 0, delta;
        for (i = 0; i <= n; i++) {
            const double t = h * i / n, weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * n);
            const double p1 = r > 0 ? (1 - exp(-r * t)) / r : t, p2 = r > 0 ? (t - p1) / r : t * t / 2;
            end = exp(-r * t) * zeta + p1 * b + p2 * slope;
            mean += weight * end;
            moment += weight * (t / h - 0.5) * end;
        }
        delta = (double)d.gain[k] * (b - r * zeta) + (double)d.ramp[k] * change;
        ASSERT_NEAR(EITHER(1e-11, 1e-5), end - zeta, delta);
        ASSERT_NEAR(EITHER(1e-11, 1e-5), mean,
                    zeta + (double)d.mean[k] * delta + (double)d.mean_ramp[k] * change);
        ASSERT_NEAR(EITHER(1e-10, 1e-4), 12 * moment, (double)d.slope[k] * delta + (double)d.slope_ramp[k] * change);
    }
}

static void levels_are_halved_steps(void) {
    const laconic_model m = model_of(with_motors(three_wheels()));
    laconic_integrator in;
    laconic_decay half;
    memset(&in, 0, sizeof in);
    in.step_s = REAL(0.5);
    laconic_decay_levels(&in, &m, 3);
    laconic_decay_of(&half, &m, REAL(0.125));
    TEST_ASSERT_EQUAL_MEMORY(&half, &in.decay[2], sizeof half);
}

static void the_limits_are_even_changes_and_jumps(void) {
    laconic_model m;
    laconic_decay d;
    memset(&m, 0, sizeof m);
    m.decay_per_s[1] = REAL(1e12);
    laconic_decay_of(&d, &m, REAL(1));
    ASSERT_NEAR(ROUNDING, 0.5, d.mean[0]);
    ASSERT_NEAR(EITHER(1e-14, 4e-6), 1, d.slope[0]);
    ASSERT_NEAR(1e-6, 1, d.mean[1]);
    ASSERT_NEAR(1e-6, 0, d.slope[1]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(factors_are_those_of_the_damped_axis);
    RUN_TEST(levels_are_halved_steps);
    RUN_TEST(the_limits_are_even_changes_and_jumps);
    return UNITY_END();
}
