/* input → load: everything that acts, as b of ζ' = … + b (the bracket of (4.7) times Gᵀ); b at a heading. */
#ifndef LACONIC_LOAD_H
#define LACONIC_LOAD_H

#include "elementary.h"
#include "vector.h"

/* Anything that acts at all. */
#define LACONIC_WITH_LOAD \
    (LACONIC_WITH_VOLTAGE || LACONIC_WITH_AXLE_TORQUE || LACONIC_WITH_BODY_WRENCH || LACONIC_WITH_WORLD_FORCE)

/* Ξᵀ(c1 U + T)/(M R²): power of a wheel's torque is torque · χ'. */
static inline vector wheel_torques(const laconic_model *m, const laconic_input *in) {
    vector b = none;
    int32_t i;
    for (i = 0; i < LACONIC_WHEELS(m); i++) {
        const real motor = LACONIC_WITH_VOLTAGE ? m->voltage_scale * in->voltage_V[i] : R(0);
        const real torque = LACONIC_WITH_AXLE_TORQUE ? motor + m->torque_scale * in->axle_torque_Nm[i] : motor;
        b = plus(b, scaled(torque, vec(m->wheel_of_zeta[i])));
    }
    return b;
}

/* Power of an outer wrench: F·v_S + τ θ'. */
static inline vector body_wrench(const laconic_model *m, const laconic_input *in) {
    const vector along = scaled(in->body_force_N[0], vec(m->velocity_of_zeta[0]));
    const vector across = scaled(in->body_force_N[1], vec(m->velocity_of_zeta[1]));
    const vector moment = scaled(in->body_moment_Nm, vec(m->yaw_rate_of_zeta));
    return scaled(m->torque_scale, plus(along, plus(across, moment)));
}

/* A world force F at the body point r: F_ξ = c F_X + s F_Y, F_η = −s F_X + c F_Y, τ = r_ξ F_η − r_η F_ξ. */
static inline void add_world_force(laconic_load *load, const laconic_model *m, const laconic_input *in) {
    const real fx = m->torque_scale * in->world_force_N[0], fy = m->torque_scale * in->world_force_N[1];
    const real *r = in->world_force_point_m;
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const vector along = minus(vec(m->velocity_of_zeta[0]), scaled(r[1], yaw));
    const vector across = plus(vec(m->velocity_of_zeta[1]), scaled(r[0], yaw));
    put(load->cosine, plus(scaled(fx, along), scaled(fy, across)));
    put(load->sine, minus(scaled(fy, along), scaled(fx, across)));
}

/* What does not act costs nothing. Written so that NaN counts as acting and is noticed in the step. */
static inline bool acts(real a, real b, real c) { return !(a == R(0) && b == R(0) && c == R(0)); }

/* A force of 0 is not looked at, but where it acts must be a place all the same. NaN or infinity where it is none. */
static inline real world_force_place(const laconic_input *input) {
    return LACONIC_WITH_WORLD_FORCE ? input->world_force_point_m[0] + input->world_force_point_m[1] : R(0);
}

static inline void load_of(laconic_load *load, const laconic_model *model, const laconic_input *input) {
    vector b = none;
    if (LACONIC_WITH_VOLTAGE || LACONIC_WITH_AXLE_TORQUE) b = wheel_torques(model, input);
    if (LACONIC_WITH_BODY_WRENCH && acts(input->body_force_N[0], input->body_force_N[1], input->body_moment_Nm))
        b = plus(b, body_wrench(model, input));
    put(load->constant, b);
    load->turns = LACONIC_WITH_WORLD_FORCE && acts(input->world_force_N[0], input->world_force_N[1], R(0));
    if (LACONIC_WITH_WORLD_FORCE && load->turns) add_world_force(load, model, input);
}

/* b of a load that turns. */
static inline vector load_at(const laconic_load *load, direction heading) {
    return plus(vec(load->constant),
                plus(scaled(heading.cosine, vec(load->cosine)), scaled(heading.sine, vec(load->sine))));
}

/* The same at the heading of a state, turned on by an angle. */
vector laconic_turned_load(const laconic_load *load, const laconic_heading *heading, real offset_rad);

/* b of any load; the heading is looked at only where a force turns with it. */
static inline vector load_now(const laconic_load *load, const laconic_heading *heading, real offset_rad) {
    if (LACONIC_WITH_WORLD_FORCE && load->turns) return laconic_turned_load(load, heading, offset_rad);
    return vec(load->constant);
}

/* Known beforehand, it leaves of the code below a base step and nothing else. */
static inline bool steady_over(const laconic_loads *loads) {
    return (!LACONIC_WITH_WORLD_FORCE && !LACONIC_WITH_SAMPLED_INPUT) || loads->steady;
}

#endif
