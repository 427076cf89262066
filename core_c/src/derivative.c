/* Equation (4.7) and the kinematics (4.1)–(4.4) as a right-hand side in ν. */
#include "load.h"
#include "zeta.h"

void laconic_derivative(laconic_rates *rates, const laconic_model *model, const laconic_real nu_rad_per_s[3],
                        laconic_real heading_rad, const laconic_input *input) {
    const direction heading = laconic_direction_of_angle(heading_rad);
    const vector zeta = zeta_of_nu(model, nu_rad_per_s);
    const real along = dot(vec(model->velocity_of_zeta[0]), zeta), across = dot(vec(model->velocity_of_zeta[1]), zeta);
    laconic_load load;
    vector rate;
    int32_t i;
    laconic_load_of(&load, model, input);
    rate = zeta_rate(model, zeta, load.turns ? load_at(&load, heading) : vec(load.constant));
    for (i = 0; i < 3; i++) rates->nu_rad_per_s2[i] = dot(vec(model->nu_of_zeta[i]), rate);
    for (i = 0; i < LACONIC_WHEELS(model); i++)
        rates->wheel_speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), zeta);
    rates->x_m_per_s = along * heading.cosine - across * heading.sine;
    rates->y_m_per_s = along * heading.sine + across * heading.cosine;
    rates->yaw_rate_rad_per_s = dot(vec(model->yaw_rate_of_zeta), zeta);
}
