/* Prepares a method for one step size; how far a method may step, and how many steps an interval holds. */
#include "step_internals.h"

/* h·r_max. On the way to a steady state exact-flow-4 errs 0.6 times as much as exponential-kahan-4 (median of 100
 * random robots), but the steady state of a yawing robot is inexact: at h·r = 0.1, 0.3, 1 and 3 by 4e-9, 3e-7, 3e-5 and
 * 2e-3 of the speed (median of 60; the worst ten times that), where exponential-kahan-4 is exact. */
#define FAST_DAMPING R(0.3)

laconic_status laconic_integrator_prepare(laconic_integrator *integrator, const laconic_method *method,
                                          const laconic_model *model, laconic_real step_s, laconic_refusal *why) {
    laconic_integrator prepared = ALL_ZERO;
    if (method == NULL || method->prepare == NULL) /* no method, or one that only auto chooses */
        return refuse(why, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, R(0), R(0));
    if (!is_finite(step_s)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!(step_s > R(0))) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (step_s < SMALLEST_STEP_S) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, step_s, SMALLEST_STEP_S);
    if (step_s > LARGEST_STEP_S) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, step_s, LARGEST_STEP_S);
    prepared.method = prepared.chosen = method;
    prepared.step_s = step_s;
    prepared.stiff = step_s * laconic_fastest_decay(model) >= FAST_DAMPING;
    const laconic_status status = method->prepare(&prepared, model, why);
    if (status == LACONIC_OK) *integrator = prepared;
    return status;
}

laconic_status laconic_explicit_limits(laconic_integrator *integrator, const laconic_model *model, real largest_damping,
                                       real largest_rotation, laconic_refusal *why) {
    const real fastest = laconic_fastest_decay(model), gyro_size = laconic_root(square(vec(model->gyro)));
    if (!(integrator->step_s * fastest <= largest_damping))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, integrator->step_s,
                      largest_damping / fastest);
    integrator->gyro_limit = LACONIC_REAL_MAX;
    if (integrator->step_s * gyro_size > largest_rotation / LACONIC_REAL_MAX)
        integrator->gyro_limit = largest_rotation / (integrator->step_s * gyro_size);
    return LACONIC_OK;
}

real laconic_fastest_decay(const laconic_model *model) {
    real fastest = model->decay_per_s[0];
    for (int k = 1; k < 3; k++)
        if (model->decay_per_s[k] > fastest) fastest = model->decay_per_s[k];
    return fastest;
}

/* Factors of exponential steps: increment, mean and first moment of ζ' = −rζ + b with b quadratic over the step. They
 * give the increment, not ζ⁺ = e^−a ζ + …, whose rounding would be relative to ζ. */

/* Response of ζ to b = s^k/k!: the increment is h φk+1, the mean h φk+2, 12 times the first moment about the
 * middle 12 h (φk+2/2 − φk+3); s(s − 1) = 2·s²/2! − s. Mean and slope are the increment times their
 * factor for a constant b, plus a term for change and curve of b. All are exact for the linear equation. */
static void axis_factors(laconic_decay *d, int k, real h, real rate) {
    real phi[6], ramp, bend, mean, slope;
    laconic_phi(phi, h * rate);
    ramp = phi[2];
    bend = R(2) * phi[3] - phi[2];
    mean = phi[2] / phi[1];
    slope = (R(6) * phi[2] - R(12) * phi[3]) / phi[1];
    d->gain[k] = h * phi[1];
    d->inverse_gain[k] = R(1) / d->gain[k];
    d->mean[k] = mean;
    d->bend[k] = bend / phi[1];
    d->mean_ramp[k] = h * (phi[3] - mean * ramp);
    d->mean_bend[k] = h * (R(2) * phi[4] - phi[3] - mean * bend);
    d->slope[k] = slope;
    d->slope_ramp[k] = h * (R(6) * phi[3] - R(12) * phi[4] - slope * ramp);
    d->slope_bend[k] = h * (R(24) * phi[4] - R(24) * phi[5] - R(6) * phi[3] - slope * bend);
}

void laconic_decay_of(laconic_decay *decay, const laconic_model *model, real h) {
    for (int k = 0; k < 3; k++) axis_factors(decay, k, h, model->decay_per_s[k]);
}

void laconic_decay_levels(laconic_integrator *integrator, const laconic_model *model, int levels) {
    real h = integrator->step_s;
    for (int level = 0; level < levels; level++) {
        laconic_decay_of(&integrator->decay[level], model, h);
        h *= R(0.5);
    }
}

/* Finds the limits by a trial: laconic_integrator_prepare() refuses with the damping limit and sets the gyroscopic
 * limit. */
laconic_real laconic_largest_stable_step_s(const laconic_method *method, const laconic_model *model,
                                           const laconic_state *state) {
    laconic_integrator trial = ALL_ZERO;
    laconic_refusal why;
    real step = LARGEST_STEP_S;
    if (laconic_integrator_prepare(&trial, method, model, step, &why) != LACONIC_OK) {
        step = why.limit;
        (void)laconic_integrator_prepare(&trial, method, model, step * R(0.999),
                                         &why); /* far beyond rounding in single, too */
        trial.gyro_limit *= R(0.999);
    }
    if (trial.chosen != method) return R(0); /* auto: goes on with another method */
    const real yaw = magnitude(dot(vec(model->nu_of_zeta[2]), zeta_of(state)));
    if (trial.gyro_limit > R(0) && yaw > trial.gyro_limit) step *= trial.gyro_limit / yaw;
    return step < LARGEST_STEP_S ? step : R(0);
}

/* The comparison is in units of the step, not of the interval, so that long intervals are held to the same
 * tolerance. */
laconic_status laconic_steps_in(double interval_s, double step_s, uint64_t *steps, laconic_refusal *why) {
    const double ratio = interval_s / step_s;
    if (!(interval_s <= DBL_MAX) || !(interval_s > 0.0))
        return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, (real)interval_s);
    if (!(step_s <= DBL_MAX)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    if (!(step_s > 0.0)) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    if (!(ratio < 9e15)) return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    uint64_t nearest = (uint64_t)ratio;
    if (ratio - (double)nearest >= 0.5) nearest++; /* ratio + 0.5 would round above 2^52 */
    if (nearest == 0) nearest = 1;
    const double count = (double)nearest;
    const double off = ratio - count;
    if (off > 1e-6 || off < -1e-6)
        return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, (real)(interval_s / count));
    *steps = nearest;
    return LACONIC_OK;
}
