/* How far a method may step, and how many steps an interval holds. */
#include "integrator.h"
#include "zeta.h"

/* Tries the method's own limits rather than knowing them: prepare and the gyroscopic limit say it. */
laconic_real laconic_largest_stable_step_s(const laconic_method *method, const laconic_model *model,
                                           const laconic_state *state) {
    laconic_integrator trial = {0};
    laconic_refusal why;
    real step = LARGEST_STEP_S, yaw;
    if (laconic_integrator_prepare(&trial, method, model, step, &why) != LACONIC_OK) {
        step = why.limit;
        (void)laconic_integrator_prepare(&trial, method, model, step * R(0.999), &why); /* safe from rounding */
        trial.gyro_limit *= R(0.999);
    }
    if (trial.chosen != method) return R(0); /* auto: goes on with another method */
    yaw = magnitude(dot(vec(model->nu_of_zeta[2]), zeta_of(state)));
    if (trial.gyro_limit > R(0) && yaw > trial.gyro_limit) step *= trial.gyro_limit / yaw;
    return step < LARGEST_STEP_S ? step : R(0);
}

/* Compared in units of the step, never of the time: so the tolerance does not widen as time goes on. */
laconic_status laconic_steps_in(double interval_s, double step_s, uint64_t *steps, laconic_refusal *why) {
    const double ratio = interval_s / step_s;
    double count, off;
    uint64_t nearest;
    if (!(interval_s <= DBL_MAX) || !(interval_s > 0.0))
        return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, (real)interval_s);
    if (!(step_s <= DBL_MAX)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    if (!(step_s > 0.0)) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    if (!(ratio < 9e15)) return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, R(0));
    nearest = (uint64_t)(ratio + 0.5);
    if (nearest == 0) nearest = 1;
    count = (double)nearest;
    off = ratio - count;
    if (off > 1e-6 || off < -1e-6)
        return refuse(why, LACONIC_STEP_DOES_NOT_FIT, LACONIC_FIELD_STEP, 0, (real)step_s, (real)(interval_s / count));
    *steps = nearest;
    return LACONIC_OK;
}
