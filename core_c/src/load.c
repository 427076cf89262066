/* input → load: everything that acts, as b of ζ' = … + b (the bracket of (4.7) times Gᵀ). */
#include "load.h"

static void add_scaled(real out[3], real factor, const real row[3]) {
    out[0] += factor * row[0];
    out[1] += factor * row[1];
    out[2] += factor * row[2];
}

/* Ξᵀ(c1 U + T)/(M R²): power of a wheel's torque is torque · χ'. */
static void add_wheels(real b[3], const laconic_model *m, const laconic_input *in) {
    int32_t i;
    for (i = 0; i < LACONIC_WHEELS(m); i++) {
        real torque = R(0);
        if (LACONIC_WITH_VOLTAGE) torque += m->voltage_scale * in->voltage_V[i];
        if (LACONIC_WITH_AXLE_TORQUE) torque += m->torque_scale * in->axle_torque_Nm[i];
        add_scaled(b, torque, m->wheel_of_zeta[i]);
    }
}

/* Power of an outer wrench: F·v_S + τ θ'. */
static void add_body_wrench(real b[3], const laconic_model *m, const laconic_input *in) {
    add_scaled(b, m->torque_scale * in->body_force_N[0], m->velocity_of_zeta[0]);
    add_scaled(b, m->torque_scale * in->body_force_N[1], m->velocity_of_zeta[1]);
    add_scaled(b, m->torque_scale * in->body_moment_Nm, m->yaw_rate_of_zeta);
}

/* A world force F at the body point r: F_ξ = c F_X + s F_Y, F_η = −s F_X + c F_Y, τ = r_ξ F_η − r_η F_ξ. */
static void add_world_force(laconic_load *load, const laconic_model *m, const laconic_input *in) {
    const real fx = m->torque_scale * in->world_force_N[0], fy = m->torque_scale * in->world_force_N[1];
    const real *r = in->world_force_point_m;
    int k;
    for (k = 0; k < 3; k++) {
        const real along = m->velocity_of_zeta[0][k] - r[1] * m->yaw_rate_of_zeta[k];
        const real across = m->velocity_of_zeta[1][k] + r[0] * m->yaw_rate_of_zeta[k];
        load->cosine[k] = along * fx + across * fy;
        load->sine[k] = along * fy - across * fx;
    }
}

void laconic_load_of(laconic_load *load, const laconic_model *model, const laconic_input *input) {
    load->constant[0] = load->constant[1] = load->constant[2] = R(0);
    load->turns = false;
    if (LACONIC_WITH_VOLTAGE || LACONIC_WITH_AXLE_TORQUE) add_wheels(load->constant, model, input);
    if (LACONIC_WITH_BODY_WRENCH) add_body_wrench(load->constant, model, input);
    if (LACONIC_WITH_WORLD_FORCE) {
        /* written so that NaN counts as a force and is noticed in the step */
        load->turns = !(input->world_force_N[0] == R(0) && input->world_force_N[1] == R(0));
        if (load->turns) add_world_force(load, model, input);
    }
}

void laconic_load_at(real b[3], const laconic_load *load, direction heading) {
    int k;
    for (k = 0; k < 3; k++)
        b[k] = load->constant[k] + heading.cosine * load->cosine[k] + heading.sine * load->sine[k];
}
