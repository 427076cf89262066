/* Classical Runge-Kutta for ζ. The mean of ζ, of which pose and wheel angles are computed, comes from the same stages:
 * h(ζ1 + 2ζ2 + 2ζ3 + ζ4)/6 = h(ζ + h(k1 + k2 + k3)/6). */
#include "step_internals.h"

#define LARGEST_DAMPING R(2.785)  /* h·r: |Σ (−a)ⁿ/n!| to n = 4 exceeds 1 from a = 2.7853 on */
#define LARGEST_ROTATION R(2.828) /* h·|w||g·ζ|: |Σ (ia)ⁿ/n!|, the rotation of free motion, from 2√2 on */

/* Yaw from the step's start to a stage, for forces fixed in the world. */
static inline real yaw_change_rad(const laconic_model *m, real h, vector zeta) {
    return LACONIC_WITH_WORLD_FORCE ? h * dot(vec(m->yaw_rate_of_zeta), zeta) : R(0);
}

static inline vector along(vector zeta, real h, vector rate) { return plus(zeta, scaled(h, rate)); }

/* Increment by Simpson's weights, and the mean by the same stages. */
INLINE increment simpson(real h, vector z1, vector k1, vector k2, vector k3, vector k4) {
    const real sixth = h * (R(1) / R(6));
    const vector inner = plus(k2, k3), forth = scaled(sixth, plus(k1, inner));
    increment by;
    by.mean = plus(z1, forth);
    by.delta = along(forth, sixth, plus(inner, k4));
    by.slope = by.delta;
    return by;
}

/* b held. */
INLINE increment held_stages(const laconic_model *m, real h, vector z1, vector b) {
    const real half = R(0.5) * h;
    const vector k1 = zeta_rate(m, z1, b);
    const vector k2 = zeta_rate(m, along(z1, half, k1), b);
    const vector k3 = zeta_rate(m, along(z1, half, k2), b);
    const vector k4 = zeta_rate(m, along(z1, h, k3), b);
    return simpson(h, z1, k1, k2, k3, k4);
}

/* The same, each stage under its own b: for samples, and for forces fixed in the world. */
RARE increment varying_stages(const laconic_model *m, real h, vector z1, const laconic_heading *heading,
                              const laconic_forcing_samples *samples) {
    const laconic_forcing *const forcing[4] = {samples->start, samples->middle, samples->middle, samples->end};
    const real ahead[4] = {R(0), R(0.5) * h, R(0.5) * h, h};
    vector rate[4], z = z1;
    for (int i = 0; i < 4; i++) {
        const vector b = forcing_after_yaw(forcing[i], heading, yaw_change_rad(m, ahead[i], z));
        if (i > 0) z = along(z1, ahead[i], rate[i - 1]);
        rate[i] = zeta_rate(m, z, b);
    }
    return simpson(h, z1, rate[0], rate[1], rate[2], rate[3]);
}

static laconic_status rk4_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                               const laconic_forcing_samples *samples) {
    const real h = integrator->step_s;
    vector zeta = zeta_of(state);
    increment by;
    if (UNLIKELY(beyond_rotation(model, integrator, zeta), &zeta.x)) return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    by = constant_over(samples) ? held_stages(model, h, zeta, vec(samples->start->constant))
                                : varying_stages(model, h, zeta, &state->heading, samples);
    return advance_if_passive(state, model, h, samples, zeta, by);
}

static laconic_status rk4_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    return laconic_explicit_limits(integrator, model, LARGEST_DAMPING, LARGEST_ROTATION, why);
}

const laconic_method laconic_rk4 = {"rk4", 4, PREPARE(rk4_prepare), rk4_step};
