/* Factors of exponential steps: increments, not exponentials, so that single precision loses
 * nothing; mean and first moment of ζ' = −rζ + b with b quadratic over the step. */
#include "integrator.h"

/* Response of ζ to b = s^k/k!: the increment is h φk+1, the mean h φk+2, 12 times the first moment about the
 * middle 12 h (φk+2/2 − φk+3); s(s − 1) = 2·s²/2! − s. What the increment explains of mean and moment of a
 * constant b it explains of any b; the rest goes beside it. All exact for the linear equation. */
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
    int k;
    for (k = 0; k < 3; k++) axis_factors(decay, k, h, model->decay_per_s[k]);
}

void laconic_decay_levels(laconic_integrator *integrator, const laconic_model *model, int levels) {
    real h = integrator->step_s;
    int level;
    for (level = 0; level < levels; level++) {
        laconic_decay_of(&integrator->decay[level], model, h);
        h *= R(0.5);
    }
}
