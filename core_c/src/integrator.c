/* Prepares a method for one step size. */
#include "integrator.h"
#include "vector.h"

#define FAST_DAMPING R(0.3) /* h·r_max: below, splitting off the damping costs less than following it */

laconic_status laconic_integrator_prepare(laconic_integrator *integrator, const laconic_method *method,
                                          const laconic_model *model, laconic_real step_s, laconic_refusal *why) {
    laconic_integrator prepared = {0};
    laconic_status status;
    if (method == NULL || method->prepare == NULL) /* none, or one that only auto chooses */
        return refuse(why, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, R(0), R(0));
    if (!is_finite(step_s)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!(step_s > R(0))) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (step_s < SMALLEST_STEP_S) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, step_s, SMALLEST_STEP_S);
    if (step_s > LARGEST_STEP_S) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, step_s, LARGEST_STEP_S);
    prepared.method = prepared.chosen = method;
    prepared.step_s = step_s;
    prepared.stiff = step_s * laconic_fastest_decay(model) >= FAST_DAMPING;
    status = method->prepare(&prepared, model, why);
    if (status == LACONIC_OK) *integrator = prepared;
    return status;
}

laconic_status laconic_explicit_limits(laconic_integrator *integrator, const laconic_model *model, real largest_damping,
                                       real largest_rotation, laconic_refusal *why) {
    const real fastest = laconic_fastest_decay(model), turning = laconic_root(square(vec(model->gyro)));
    if (!(integrator->step_s * fastest <= largest_damping))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, integrator->step_s,
                      largest_damping / fastest);
    integrator->gyro_limit = LACONIC_REAL_MAX;
    if (integrator->step_s * turning > largest_rotation / LACONIC_REAL_MAX)
        integrator->gyro_limit = largest_rotation / (integrator->step_s * turning);
    return LACONIC_OK;
}

real laconic_fastest_decay(const laconic_model *model) {
    real fastest = model->decay_per_s[0];
    int k;
    for (k = 1; k < 3; k++)
        if (model->decay_per_s[k] > fastest) fastest = model->decay_per_s[k];
    return fastest;
}
