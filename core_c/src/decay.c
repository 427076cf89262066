/* Factors of exponential steps (PHYSICS §10): increments, not exponentials, so that single precision loses
 * nothing; mean and first moment of ζ' = −rζ + b with b linear over the step. */
#include "integrator.h"

/* With ζ(t) = ζ + Δ(1 − e^{−rt})/(1 − e^{−a}) for constant b, and the response to a ramp of b:
 * mean = ζ + κΔ + …, slope = 12/h² ∫(t − h/2)ζ dt. All exact for the linear equation. */
static void axis_factors(laconic_decay *d, int k, real h, real rate) {
    real phi[4];
    laconic_phi(phi, h * rate);
    d->gain[k] = h * phi[0];
    d->ramp[k] = h * phi[1];
    d->mean[k] = phi[1] / phi[0];
    d->mean_ramp[k] = h * (phi[2] - d->mean[k] * phi[1]);
    d->slope[k] = (R(6) * phi[1] - R(12) * phi[2]) / phi[0];
    d->slope_ramp[k] = h * (R(6) * phi[2] - R(12) * phi[3] - d->slope[k] * phi[1]);
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
