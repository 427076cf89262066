/* From a motor's data sheet to c1, c2 and J: c1 = G k_t/R_a, c2 = G² (k_t k_e/R_a + b). */
#include "internal.h"

static laconic_status check_motor(const laconic_motor *m, laconic_refusal *why) {
    const real numbers[] = {m->resistance_ohm, m->torque_constant_Nm_per_A, m->back_emf_Vs_per_rad,
                            m->gear_ratio,     m->viscous_friction_Nms,     m->rotor_inertia_kgm2};
    int32_t i;
    for (i = 0; i < 6; i++)
        if (!is_finite(numbers[i]))
            return refuse(why, LACONIC_NOT_FINITE, (laconic_field)(LACONIC_FIELD_RESISTANCE + i), 0, numbers[i], R(0));
    if (!(m->resistance_ohm > R(0)))
        return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_RESISTANCE, 0, m->resistance_ohm, R(0));
    if (magnitude(m->gear_ratio) < LACONIC_REAL_MIN)
        return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_GEAR_RATIO, 0, m->gear_ratio, R(1));
    if (m->viscous_friction_Nms < R(0))
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_VISCOUS_FRICTION, 0, m->viscous_friction_Nms, R(0));
    if (m->rotor_inertia_kgm2 < R(0))
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_ROTOR_INERTIA, 0, m->rotor_inertia_kgm2, R(0));
    return LACONIC_OK;
}

laconic_status laconic_motor_fit(laconic_vehicle *vehicle, const laconic_motor *motor, laconic_refusal *why) {
    const laconic_status status = check_motor(motor, why);
    const real ratio = motor->gear_ratio;
    real per_volt, gain, damping, inertia;
    if (status != LACONIC_OK) return status;
    if (vehicle->wheel_inertia_kgm2 < R(0)) /* before the rotor's inertia hides the sign */
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, vehicle->wheel_inertia_kgm2, R(0));
    per_volt = motor->torque_constant_Nm_per_A / motor->resistance_ohm;
    gain = ratio * per_volt;
    damping = ratio * ratio * (per_volt * motor->back_emf_Vs_per_rad + motor->viscous_friction_Nms);
    inertia = ratio * ratio * motor->rotor_inertia_kgm2;
    if (zero_if_finite(gain) + zero_if_finite(damping) + zero_if_finite(inertia) != R(0))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_GEAR_RATIO, 0, ratio, R(0));
    if (per_volt * motor->back_emf_Vs_per_rad < R(0)) /* a motor that drives itself */
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_BACK_EMF, 0, motor->back_emf_Vs_per_rad, R(0));
    vehicle->motor_gain_Nm_per_V = gain;
    vehicle->motor_damping_Nms = damping;
    vehicle->wheel_inertia_kgm2 += inertia;
    return LACONIC_OK;
}
