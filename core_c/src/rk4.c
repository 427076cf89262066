/* Classical Runge-Kutta on the full state. θ and the wheel angles follow from the same stages:
 * h(ζ1 + 2ζ2 + 2ζ3 + ζ4)/6 = h(ζ + h(k1 + k2 + k3)/6). */
#include "integrator.h"
#include "load.h"
#include "passivity.h"
#include "zeta.h"

#define LARGEST_DAMPING R(2.785)   /* h·r: end of the stability interval on the real axis          */
#define LARGEST_ROTATION R(2.828)  /* h·|w||g·ζ|: on the imaginary axis, where free motion turns    */

static void stage(real out[3], const real zeta[3], real h, const real k[3]) {
    out[0] = zeta[0] + h * k[0];
    out[1] = zeta[1] + h * k[1];
    out[2] = zeta[2] + h * k[2];
}

static real yaw_angle(const laconic_model *m, real h, const real zeta[3]) {
    return LACONIC_WITH_WORLD_FORCE ? h * dot(m->yaw_rate_of_zeta, zeta) : R(0);
}

static laconic_status rk4_increment(const laconic_model *model, const laconic_integrator *integrator,
                                    const laconic_state *state, laconic_loads loads, laconic_increment *out) {
    const real h = integrator->step_s, half = R(0.5) * h, sixth = h * (R(1) / R(6));
    const laconic_heading *heading = &state->heading;
    real z1[3], z2[3], z3[3], z4[3], k1[3], k2[3], k3[3], k4[3], b1[3], b[3], change[3];
    int k;
    take_zeta(z1, state);
    if (magnitude(dot(model->nu_of_zeta[2], z1)) > integrator->gyro_limit)
        return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    load_now(b1, loads.start, heading, R(0));
    zeta_rate(k1, model, z1, b1);
    stage(z2, z1, half, k1);
    load_now(b, loads.middle, heading, yaw_angle(model, half, z1));
    zeta_rate(k2, model, z2, b);
    stage(z3, z1, half, k2);
    load_now(b, loads.middle, heading, yaw_angle(model, half, z2));
    zeta_rate(k3, model, z3, b);
    stage(z4, z1, h, k3);
    load_now(b, loads.end, heading, yaw_angle(model, h, z3));
    zeta_rate(k4, model, z4, b);
    for (k = 0; k < 3; k++) {
        const real middle = k2[k] + k3[k];
        out->mean[k] = z1[k] + sixth * (k1[k] + middle);
        out->delta[k] = sixth * ((k1[k] + k4[k]) + R(2) * middle);
        out->slope[k] = out->delta[k];
        change[k] = b[k] - b1[k];
    }
    return passive(z1, h, b1, change, out) ? LACONIC_OK : LACONIC_STEP_GAINS_ENERGY;
}

static laconic_status rk4_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    const real fastest = laconic_fastest_decay(model);
    const real turning = laconic_root(dot(model->gyro, model->gyro));
    if (!(integrator->step_s * fastest <= LARGEST_DAMPING))
        return refuse(why, LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, integrator->step_s,
                      LARGEST_DAMPING / fastest);
    integrator->gyro_limit = LACONIC_REAL_MAX;
    if (integrator->step_s * turning > LARGEST_ROTATION / LACONIC_REAL_MAX)
        integrator->gyro_limit = LARGEST_ROTATION / (integrator->step_s * turning);
    return LACONIC_OK;
}

const laconic_method laconic_rk4 = {"rk4", 4, rk4_prepare, rk4_increment};
