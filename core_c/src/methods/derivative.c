/* Equation (4.7) and the kinematics (4.1)–(4.4) as a right-hand side in ν, and its analytic linearisation along a
 * direction of states and inputs. */
#include "step_internals.h"
#include "wrench.h"

/* Rates or their changes, all linear: of ν from ζ', of the position from the velocity in body axes, of angles from
 * ζ. */
static void fill_rates(laconic_rates *rates, const laconic_model *model, vector zeta, vector zeta_rate, real along,
                       real across, direction heading) {
    for (int32_t i = 0; i < 3; i++) rates->nu_rad_per_s2[i] = dot(vec(model->nu_of_zeta[i]), zeta_rate);
    for (int32_t i = 0; i < LACONIC_WHEELS(model); i++)
        rates->wheel_speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), zeta);
    rates->x_m_per_s = along * heading.cosine - across * heading.sine;
    rates->y_m_per_s = along * heading.sine + across * heading.cosine;
    rates->yaw_rate_rad_per_s = dot(vec(model->yaw_rate_of_zeta), zeta);
}

void laconic_derivative(laconic_rates *rates, const laconic_model *model, const laconic_real nu_rad_per_s[3],
                        laconic_real heading_rad, const laconic_input *input) {
    const direction heading = laconic_direction_of_angle(heading_rad);
    const vector zeta = zeta_of_nu(model, nu_rad_per_s);
    const real along = dot(vec(model->velocity_of_zeta[0]), zeta), across = dot(vec(model->velocity_of_zeta[1]), zeta);
    laconic_forcing forcing;
    laconic_forcing_of(&forcing, model, input);
    fill_rates(rates, model, zeta,
               zeta_rate(model, zeta, forcing.rotates ? forcing_at(&forcing, heading) : vec(forcing.constant)), along,
               across, heading);
}

/* d[(g·ζ)(ζ×w) − diag(r)ζ + b] */
static vector rate_change(const laconic_model *m, vector zeta, vector d_zeta, vector d_b) {
    const vector gyro = vec(m->gyro), yaw = vec(m->nu_of_zeta[2]);
    const vector gyroscopic =
        plus(scaled(dot(yaw, d_zeta), cross(zeta, gyro)), scaled(dot(yaw, zeta), cross(d_zeta, gyro)));
    return plus(gyroscopic, minus(d_b, times(vec(m->decay_per_s), d_zeta)));
}

void laconic_derivative_tangent(laconic_rates *change, const laconic_model *model, const laconic_motion *at,
                                const laconic_input *input, const laconic_variation *by) {
    const direction heading = laconic_direction_of_angle(at->heading_rad);
    const vector zeta = zeta_of_nu(model, at->nu_rad_per_s), d_zeta = zeta_of_nu(model, by->nu_rad_per_s);
    const vector d_b =
        plus(b_of_torques(model, &by->input), b_of_wrench(model, wrench_change(model, input, heading, by)));
    const real along = dot(vec(model->velocity_of_zeta[0]), zeta), across = dot(vec(model->velocity_of_zeta[1]), zeta);
    const real d_along = dot(vec(model->velocity_of_zeta[0]), d_zeta) - by->heading_rad * across;
    const real d_across = dot(vec(model->velocity_of_zeta[1]), d_zeta) + by->heading_rad * along;
    fill_rates(change, model, d_zeta, rate_change(model, zeta, d_zeta, d_b), d_along, d_across, heading);
}
