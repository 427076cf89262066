/* Methods prepared for a step. */
#include "articulated_step.h"
#include "step_internals.h"

#if LACONIC_MAX_BODIES > 0

/* a/(1 − e^−a) − 1 − a/2 = (1/φ1 − 1) − a/2; small a by its series a²/12 − a⁴/720, as the difference loses digits. */
static real exponential_correction(real a, real phi1) {
    const real z = a * a;
    if (a < R(0.1)) return z * (R(1) / R(12) - z * (R(1) / R(720) - z * (R(1) / R(30240))));
    return R(1) / phi1 - R(1) - R(0.5) * a;
}

static void velocity_factors(laconic_articulated_factors *f, int32_t i, real a) {
    real phi[6];
    laconic_phi(phi, a);
    f->correction[i] = exponential_correction(a, phi[1]);
    f->mean[i] = phi[2] / phi[1];
    f->slope[i] = (R(6) * phi[2] - R(12) * phi[3]) / phi[1];
}

/* Damping of an own hinge over its body's inertia; the carriage's own rates. */
static real rate_of_velocity(const laconic_articulated_model *m, int32_t i) {
    if (i < m->carriage_dof) return m->coordinated ? R(0) : m->decay_per_s[i];
    for (int32_t b = 0; b < m->body_count; b++) {
        const laconic_link *link = &m->link[b];
        if (link->motion == LACONIC_MOTION_OWN && link->column == i - m->carriage_dof && link->inertia.ww > R(0))
            return (link->damping_Nms + link->drag.ww) / link->inertia.ww;
    }
    return R(0);
}

void laconic_articulated_factors_of(laconic_articulated_factors factors[2], const laconic_articulated_model *m,
                                    real h) {
    for (int32_t i = 0; i < m->dof; i++) {
        velocity_factors(&factors[0], i, h * rate_of_velocity(m, i));
        velocity_factors(&factors[1], i, R(0.5) * h * rate_of_velocity(m, i));
    }
}

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
        return refuse(why, LACONIC_METHOD_UNKNOWN, LACONIC_FIELD_METHOD, 0, (real)method,
                      (real)LACONIC_ARTICULATED_METHOD_COUNT);
    const laconic_status status = check_step(step_s, why);
    if (status != LACONIC_OK) return status;
    const bool is_explicit = method == LACONIC_ARTICULATED_RK4 || method == LACONIC_ARTICULATED_CIRCLE;
    const real rate = model->fastest_decay_per_s + model->fastest_swing_per_s;
    if (is_explicit && !(step_s * rate <= LARGEST_EXPLICIT_RATE))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, step_s,
                      LARGEST_EXPLICIT_RATE / rate);
    fresh.method = (laconic_articulated_method)method;
    fresh.step_s = step_s;
    fresh.rate_per_step = R(1) / step_s;
    fresh.parts = laconic_articulated_parts_for(step_s * rate);
    laconic_articulated_factors_of(fresh.factors, model, step_s);
    *integrator = fresh;
    return LACONIC_OK;
}

#endif
