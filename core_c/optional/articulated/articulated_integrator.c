/* Methods prepared for a step. */
#include "articulated_step.h"
#include "step_internals.h"

#if LACONIC_MAX_BODIES > 0

#define LARGEST_EXPLICIT_RATE R(2.785) /* h·r of rk4 and circle */

static laconic_status check_step(real step_s, laconic_refusal *why) {
    if (!is_finite(step_s)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!(step_s > R(0))) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!(step_s <= LARGEST_STEP_S) || !(step_s * step_s > R(64) * LACONIC_REAL_MIN))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_STEP, 0, step_s, R(0));
    return LACONIC_OK;
}

laconic_status laconic_articulated_integrator_prepare(laconic_articulated_integrator *integrator, int32_t method,
                                                      const laconic_articulated_model *model, laconic_real step_s,
                                                      laconic_refusal *why) {
    laconic_articulated_integrator fresh = ALL_ZERO;
    if (method < 0 || method >= LACONIC_ARTICULATED_METHOD_COUNT)
        return refuse(why, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, R(0), R(0));
    const laconic_status status = check_step(step_s, why);
    if (status != LACONIC_OK) return status;
    const bool is_explicit = method == LACONIC_ARTICULATED_RK4 || method == LACONIC_ARTICULATED_CIRCLE;
    if (is_explicit && !(step_s * model->fastest_decay_per_s <= LARGEST_EXPLICIT_RATE))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, step_s,
                      LARGEST_EXPLICIT_RATE / model->fastest_decay_per_s);
    fresh.method = (laconic_articulated_method)method;
    fresh.step_s = step_s;
    fresh.rate_per_step = R(1) / step_s;
    *integrator = fresh;
    return LACONIC_OK;
}

#endif
