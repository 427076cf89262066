/* Classical Runge-Kutta for ζ. Its mean, which θ, the pose and the wheel angles follow, comes from the same stages:
 * h(ζ1 + 2ζ2 + 2ζ3 + ζ4)/6 = h(ζ + h(k1 + k2 + k3)/6). */
#include "advance.h"
#include "integrator.h"
#include "load.h"
#include "zeta.h"

#define LARGEST_DAMPING R(2.785)  /* h·r: end of the stability interval on the real axis          */
#define LARGEST_ROTATION R(2.828) /* h·|w||g·ζ|: on the imaginary axis, where free motion turns    */

/* The angle that a stage has turned on, for forces fixed in the world. */
static inline real turned_rad(const laconic_model *m, real h, vector zeta) {
    return LACONIC_WITH_WORLD_FORCE ? h * dot(vec(m->yaw_rate_of_zeta), zeta) : R(0);
}

static inline vector along(vector zeta, real h, vector rate) {
    return plus(zeta, scaled(h, rate));
}

/* Loads at the stages; where nothing varies, the one of the start. */
INLINE vector stage_load(const laconic_model *m, const laconic_load *load, const laconic_heading *heading, real h,
                         vector zeta, vector start, bool steady) {
    return steady ? start : load_now(load, heading, turned_rad(m, h, zeta));
}

INLINE increment stages(const laconic_model *m, real h, vector z1, const laconic_heading *heading,
                        const laconic_loads *loads, bool steady) {
    const real half = R(0.5) * h, sixth = h * (R(1) / R(6));
    const vector b = load_now(loads->start, heading, R(0));
    vector outer = zeta_rate(m, z1, b), z2, z3, z4, inner, rate;
    increment by;
    z2 = along(z1, half, outer);
    inner = zeta_rate(m, z2, stage_load(m, loads->middle, heading, half, z1, b, steady));
    z3 = along(z1, half, inner);
    rate = zeta_rate(m, z3, stage_load(m, loads->middle, heading, half, z2, b, steady));
    z4 = along(z1, h, rate);
    inner = plus(inner, rate);
    outer = scaled(sixth, plus(outer, inner));
    by.mean = plus(z1, outer);
    inner = plus(inner, zeta_rate(m, z4, stage_load(m, loads->end, heading, h, z3, b, steady)));
    by.delta = along(outer, sixth, inner);
    by.slope = by.delta;
    return by;
}

static laconic_status rk4_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                               const laconic_loads *loads) {
    const real h = integrator->step_s;
    const vector zeta = zeta_of(state);
    increment by;
    if (magnitude(dot(vec(model->nu_of_zeta[2]), zeta)) > integrator->gyro_limit)
        return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    by = steady_over(loads) ? stages(model, h, zeta, &state->heading, loads, true)
                            : stages(model, h, zeta, &state->heading, loads, false);
    return advance_if_passive(state, model, h, loads, zeta, by);
}

static laconic_status rk4_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    const real fastest = laconic_fastest_decay(model);
    const real turning = laconic_root(square(vec(model->gyro)));
    if (!(integrator->step_s * fastest <= LARGEST_DAMPING))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, integrator->step_s,
                      LARGEST_DAMPING / fastest);
    integrator->gyro_limit = LACONIC_REAL_MAX;
    if (integrator->step_s * turning > LARGEST_ROTATION / LACONIC_REAL_MAX)
        integrator->gyro_limit = LARGEST_ROTATION / (integrator->step_s * turning);
    return LACONIC_OK;
}

const laconic_method laconic_rk4 = {"rk4", 4, PREPARE(rk4_prepare), rk4_step};
