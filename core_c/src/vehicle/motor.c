/* From a motor's data sheet to c1, c2 and J: c1 = n k_t/R_a, c2 = n² (k_t k_e/R_a + d); R_a and n² d for the drive. */
#include "common.h"

#define RULE_OF(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) {number, LACONIC_RULE_##RULE},
#define VALUE_OF(motor, number, IDENTIFIER, member, name, KIND, RULE, NEED) motor->member,

static laconic_status check_rule(real value, uint8_t rule, laconic_field field, laconic_refusal *why) {
    if (rule == LACONIC_RULE_NOT_NEGATIVE && value < R(0)) return refuse(why, LACONIC_NEGATIVE, field, 0, value, R(0));
    if (rule == LACONIC_RULE_POSITIVE && value <= R(0)) return refuse(why, LACONIC_NOT_POSITIVE, field, 0, value, R(0));
    if (rule == LACONIC_RULE_NOT_ZERO && magnitude(value) < LACONIC_REAL_MIN)
        return refuse(why, LACONIC_ZERO, field, 0, value, R(0));
    return LACONIC_OK;
}

static laconic_status check_motor(const laconic_motor *m, laconic_refusal *why) {
    static const struct {
        uint8_t field, rule;
    } numbers[] = {LACONIC_MOTOR_FIELDS(RULE_OF, )};
    const real values[] = {LACONIC_MOTOR_FIELDS(VALUE_OF, m)};
    const size_t count = sizeof numbers / sizeof numbers[0];
    laconic_status status = LACONIC_OK;
    for (size_t k = 0; k < count; k++)
        if (!is_finite(values[k]))
            return refuse(why, LACONIC_NOT_FINITE, (laconic_field)numbers[k].field, 0, values[k], R(0));
    for (size_t k = 0; k < count && status == LACONIC_OK; k++)
        status = check_rule(values[k], numbers[k].rule, (laconic_field)numbers[k].field, why);
    return status;
}

#if LACONIC_WITH_OWN_WHEELS
/* How many wheels there are to look at; the count is checked later. */
static int32_t wheels_of(const laconic_vehicle *vehicle) {
    return vehicle->wheel_count < LACONIC_MAX_WHEELS ? vehicle->wheel_count : LACONIC_MAX_WHEELS;
}
#endif

/* Before the rotor's inertia hides the sign. */
static laconic_status check_bare_inertias(const laconic_vehicle *vehicle, laconic_refusal *why) {
    if (vehicle->wheel_inertia_kgm2 < R(0))
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, vehicle->wheel_inertia_kgm2, R(0));
#if LACONIC_WITH_OWN_WHEELS
    for (int32_t i = 0; i < wheels_of(vehicle); i++) {
        const real own_inertia = vehicle->wheel[i].own_inertia_kgm2;
        if (own_inertia < R(0))
            return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_OWN_INERTIA, i + 1, own_inertia, R(0));
    }
#endif
    return LACONIC_OK;
}

/* The driven wheels get the rotor. Beside a wheel without a motor the vehicle's J stays that of a wheel alone, and each
 * driven wheel gets its own. */
static void add_rotors(laconic_vehicle *vehicle, real rotor_inertia) {
    bool all_driven = true;
#if LACONIC_WITH_OWN_WHEELS
    for (int32_t i = 0; i < wheels_of(vehicle); i++) all_driven = all_driven && !vehicle->wheel[i].undriven;
    for (int32_t i = 0; i < wheels_of(vehicle); i++) {
        laconic_wheel *wheel = &vehicle->wheel[i];
        if (wheel->undriven || (all_driven && wheel->own_inertia_kgm2 == R(0))) continue;
        if (wheel->own_inertia_kgm2 == R(0)) wheel->own_inertia_kgm2 = vehicle->wheel_inertia_kgm2;
        wheel->own_inertia_kgm2 += rotor_inertia;
    }
#endif
    if (all_driven) vehicle->wheel_inertia_kgm2 += rotor_inertia;
}

laconic_status laconic_motor_fit(laconic_vehicle *vehicle, const laconic_motor *motor, laconic_refusal *why) {
    const laconic_status status = check_motor(motor, why);
    const real ratio = motor->gear_ratio;
    if (status != LACONIC_OK) return status;
    const laconic_status inertias = check_bare_inertias(vehicle, why);
    if (inertias != LACONIC_OK) return inertias;
    const real per_volt = motor->torque_constant_Nm_per_A / motor->resistance_ohm;
    const real gain = ratio * per_volt;
    const real damping = ratio * ratio * (per_volt * motor->back_emf_Vs_per_rad + motor->viscous_friction_Nms);
    const real inertia = ratio * ratio * motor->rotor_inertia_kgm2;
    if (zero_if_finite(gain) + zero_if_finite(damping) + zero_if_finite(inertia) != R(0))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_GEAR_RATIO, 0, ratio, R(0));
    if (per_volt * motor->back_emf_Vs_per_rad < R(0)) /* its damping would add energy */
        return refuse(why, LACONIC_NEGATIVE, LACONIC_FIELD_BACK_EMF, 0, motor->back_emf_Vs_per_rad, R(0));
    vehicle->motor_gain_Nm_per_V = gain;
    vehicle->motor_damping_Nms = damping;
    add_rotors(vehicle, inertia);
#if LACONIC_WITH_FRICTION
    vehicle->drive.winding_resistance_ohm = motor->resistance_ohm;
    vehicle->drive.viscous_friction_Nms = ratio * ratio * motor->viscous_friction_Nms;
#endif
    return LACONIC_OK;
}
