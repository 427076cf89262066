#include "integrator.h"

#include "methods.h"

/* One axis alone, ζ' = −rζ + b + change·s + curve·s(s − 1), s = t/h: increment, mean and first moment by the exact
 * solution (variation of constants, Simpson's rule twice). */
typedef struct axis {
    double rate, step, zeta, start, change, curve;
} axis;

static double driven(const axis *a, double t) {
    const double s = t / a->step;
    return a->start + a->change * s + a->curve * s * (s - 1);
}

/* ζ at the next node from the one before: within a node's width b is a parabola and Simpson's rule exact enough. */
static double next(const axis *a, double zeta, double t, double dt) {
    const double decay = exp(-a->rate * dt), half = exp(-a->rate * dt / 2);
    return decay * zeta + dt / 6 * (decay * driven(a, t) + 4 * half * driven(a, t + dt / 2) + driven(a, t + dt));
}

static void factors_are_those_of_the_damped_axis(void) {
    const double rates[3] = {0.0, 0.7, 40.0};
    const int n = 20000;
    laconic_model m;
    laconic_decay d;
    int k, i;
    memset(&m, 0, sizeof m);
    for (k = 0; k < 3; k++) m.decay_per_s[k] = REAL(rates[k]);
    laconic_decay_of(&d, &m, REAL(0.8));
    for (k = 0; k < 3; k++) {
        const axis a = {rates[k], 0.8, 1.3, -0.4, 2.1, -1.7};
        double zeta = a.zeta, mean = 0, moment = 0, delta;
        for (i = 0; i <= n; i++) {
            const double weight = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * n);
            mean += weight * zeta;
            moment += weight * ((double)i / n - 0.5) * zeta;
            if (i < n) zeta = next(&a, zeta, a.step * i / n, a.step / n);
        }
        delta = (double)d.gain[k] *
                (a.start - a.rate * a.zeta + (double)d.mean[k] * a.change + (double)d.bend[k] * a.curve);
        ASSERT_NEAR(EITHER(1e-11, 1e-5), zeta - a.zeta, delta);
        ASSERT_NEAR(EITHER(1e-11, 1e-5), mean,
                    a.zeta + (double)d.mean[k] * delta + (double)d.mean_ramp[k] * a.change +
                        (double)d.mean_bend[k] * a.curve);
        ASSERT_NEAR(EITHER(1e-10, 1e-4), 12 * moment,
                    (double)d.slope[k] * delta + (double)d.slope_ramp[k] * a.change +
                        (double)d.slope_bend[k] * a.curve);
        ASSERT_NEAR(4 * ROUNDING, 1, (double)d.gain[k] * (double)d.inverse_gain[k]);
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
