/* Velocities of a state, in the paper's and in physical terms. */
#include "zeta.h"

void laconic_nu(const laconic_model *model, const laconic_state *state, laconic_real nu_rad_per_s[3]) {
    const vector zeta = zeta_of(state);
    int k;
    for (k = 0; k < 3; k++) nu_rad_per_s[k] = dot(vec(model->nu_of_zeta[k]), zeta);
}

laconic_real laconic_body_velocity(const laconic_model *model, const laconic_state *state,
                                   laconic_real velocity_m_per_s[2]) {
    const vector zeta = zeta_of(state);
    velocity_m_per_s[0] = dot(vec(model->velocity_of_zeta[0]), zeta);
    velocity_m_per_s[1] = dot(vec(model->velocity_of_zeta[1]), zeta);
    return dot(vec(model->yaw_rate_of_zeta), zeta);
}
