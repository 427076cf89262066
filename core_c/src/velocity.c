/* Velocities of a state, in the paper's and in physical terms. */
#include "zeta.h"

void laconic_nu(const laconic_model *model, const laconic_state *state, laconic_real nu_rad_per_s[3]) {
    real zeta[3];
    int k;
    take_zeta(zeta, state);
    for (k = 0; k < 3; k++) nu_rad_per_s[k] = dot(model->nu_of_zeta[k], zeta);
}

laconic_real laconic_body_velocity(const laconic_model *model, const laconic_state *state,
                                   laconic_real velocity_m_per_s[2]) {
    real zeta[3];
    take_zeta(zeta, state);
    velocity_m_per_s[0] = dot(model->velocity_of_zeta[0], zeta);
    velocity_m_per_s[1] = dot(model->velocity_of_zeta[1], zeta);
    return dot(model->yaw_rate_of_zeta, zeta);
}
