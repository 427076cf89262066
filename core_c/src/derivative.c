/* Equation (4.7) and the kinematics (4.1)–(4.4) as a right-hand side in ν. */
#include "load.h"
#include "zeta.h"

static void project(real zeta[3], const laconic_model *m, const real nu[3]) {
    int k;
    for (k = 0; k < 3; k++)
        zeta[k] = m->inertia[k] *
                  (m->nu_of_zeta[0][k] * nu[0] + m->nu_of_zeta[1][k] * nu[1] + m->nu_of_zeta[2][k] * nu[2]);
}

void laconic_derivative(laconic_rates *rates, const laconic_model *model, const laconic_real nu_rad_per_s[3],
                        laconic_real heading_rad, const laconic_input *input) {
    const direction heading = laconic_direction_of_angle(heading_rad);
    laconic_load load;
    real zeta[3], b[3], rate[3], along, across;
    int32_t i;
    project(zeta, model, nu_rad_per_s);
    laconic_load_of(&load, model, input);
    for (i = 0; i < 3; i++) b[i] = load.constant[i];
    if (load.turns) laconic_load_at(b, &load, heading);
    zeta_rate(rate, model, zeta, b);
    for (i = 0; i < 3; i++) rates->nu_rad_per_s2[i] = dot(model->nu_of_zeta[i], rate);
    for (i = 0; i < model->wheel_count; i++) rates->wheel_speed_rad_per_s[i] = dot(model->wheel_of_zeta[i], zeta);
    along = dot(model->velocity_of_zeta[0], zeta);
    across = dot(model->velocity_of_zeta[1], zeta);
    rates->x_m_per_s = along * heading.cosine - across * heading.sine;
    rates->y_m_per_s = along * heading.sine + across * heading.cosine;
    rates->yaw_rate_rad_per_s = dot(model->yaw_rate_of_zeta, zeta);
}
