/* Motors with limits: what each does at a speed of its wheel, and how the supply sags under all of them. */
#include "friction_vehicle.h"

#if LACONIC_WITH_FRICTION
INLINE motor_state motor_of(const laconic_friction_axle *a, real command_V, real speed, real terminal_V) {
    return motor_state_of(a->circuit, a->gain, a->back_emf, a->torque_limit, a->ampere, command_V, speed, terminal_V);
}

motor_state laconic_motor_at(const laconic_friction *friction, int32_t wheel, real command_V, real speed,
                             real terminal_V) {
    return motor_of(&friction->axle[wheel], command_V, speed, terminal_V);
}

static real drawn_A(const laconic_friction *f, const laconic_input *input, const real speed[], real terminal_V,
                    real *per_volt) {
    real sum = R(0);
    for (int32_t i = 0; i < f->wheel_count; i++) {
        const laconic_friction_axle *a = &f->axle[i];
        if (a->circuit != LACONIC_MOTOR_DRIVEN) continue;
        const motor_state m = motor_of(a, input->voltage_V[i], speed[i], terminal_V);
        const bool whole = m.limit == LACONIC_LIMIT_VOLTAGE;
        const real duty = whole ? (input->voltage_V[i] > R(0) ? R(1) : R(-1)) : m.voltage_V / terminal_V;
        const real current = m.current_A * duty;
        sum += current;
        if (!whole)
            *per_volt -= current / terminal_V;
        else if (a->gain != R(0))
            *per_volt += R(1) / f->winding_resistance_ohm;
    }
    return sum;
}

real laconic_supply_voltage(const laconic_friction *friction, const laconic_input *input, const real speed[],
                            real guess) {
    const laconic_friction *f = friction;
    real volts = guess > R(0) ? guess : f->supply_V;
    if (!(f->supply_V > R(0))) return R(-1);
    if (!(f->supply_resistance_ohm > R(0))) return f->supply_V;
    for (int k = 0; k < SAG_ROUNDS; k++) {
        real per_volt = R(0);
        const real current = drawn_A(f, input, speed, volts, &per_volt);
        if (sag_round(&volts, f->supply_V, f->supply_resistance_ohm, current, per_volt)) break;
    }
    return volts;
}

#endif
