/* Motors with limits: what each does at a speed of its wheel, and how the supply sags under all of them. */
#include "friction_vehicle.h"

#if LACONIC_WITH_FRICTION
/* Torque c1 U − c2ₑ s within the current limit; c2ₑ/c1 is the back-EMF per speed, so U − that is R_a times the
 * current. A limited motor has the voltage at its terminals that its controller sets for the limit. */
motor_state laconic_motor_at(const laconic_friction *friction, int32_t wheel, real command_V, real speed,
                             real terminal_V) {
    const laconic_friction_axle *a = &friction->axle[wheel];
    motor_state m = {R(0), R(0), R(0), LACONIC_LIMIT_NONE};
    if (a->circuit == LACONIC_MOTOR_OPEN) return m;
    if (a->circuit == LACONIC_MOTOR_DRIVEN) {
        m.voltage_V = terminal_V >= R(0) ? cut(command_V, terminal_V) : command_V;
        if (m.voltage_V < command_V || m.voltage_V > command_V) m.limit = LACONIC_LIMIT_VOLTAGE;
    }
    const real free = a->gain * m.voltage_V - a->back_emf * speed;
    m.torque = a->circuit == LACONIC_MOTOR_DRIVEN ? cut(free, a->torque_limit) : free;
    m.current_A = m.torque * a->ampere;
    if (m.torque < free || m.torque > free) {
        m.limit = LACONIC_LIMIT_CURRENT;
        m.voltage_V = (m.torque + a->back_emf * speed) / a->gain;
    }
    return m;
}

/* V = V₀ − R_s Σ I_i U_i/V: each motor takes the share of the supply's voltage that its controller gives it. Newton's
 * method: a motor that gets the whole voltage takes more with it, any other one less, as its power stays. From the step
 * before it takes two rounds, the second to see that the first sufficed. */
#define SAG_ROUNDS 6
#define LEAST_SLOPE R(0.5) /* nearer to the most that the supply can give, Newton's steps would leave the range */

#ifdef LACONIC_SINGLE
#define FOUND R(3e-7)
#else
#define FOUND R(1e-15)
#endif

static real drawn_A(const laconic_friction *f, const laconic_input *input, const real speed[], real terminal_V,
                    real *per_volt) {
    real sum = R(0);
    for (int32_t i = 0; i < f->wheel_count; i++) {
        if (f->axle[i].circuit != LACONIC_MOTOR_DRIVEN) continue;
        const motor_state m = laconic_motor_at(f, i, input->voltage_V[i], speed[i], terminal_V);
        const bool whole = m.limit == LACONIC_LIMIT_VOLTAGE;
        const real duty = whole ? (input->voltage_V[i] > R(0) ? R(1) : R(-1)) : m.voltage_V / terminal_V;
        const real current = m.current_A * duty;
        sum += current;
        if (!whole)
            *per_volt -= current / terminal_V;
        else if (f->axle[i].gain != R(0))
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
        const real off = f->supply_V - f->supply_resistance_ohm * current - volts;
        const real slope = R(1) + f->supply_resistance_ohm * per_volt;
        const real next = volts + off / (slope > LEAST_SLOPE ? slope : LEAST_SLOPE);
        volts = next > R(0.5) * volts ? next : R(0.5) * volts; /* stays above 0 */
        if (magnitude(off) <= FOUND * volts) break;
    }
    return volts;
}

#endif
