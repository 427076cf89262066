/* What the files about vehicles with friction share: loads, motors, contacts. The solver knows nothing of it. */
#ifndef LACONIC_FRICTION_VEHICLE_H
#define LACONIC_FRICTION_VEHICLE_H

#include "friction_solver.h"
#include "step_internals.h"

#if LACONIC_WITH_FRICTION

/* Normal loads of wheels and supports, and whether each has lifted. */
typedef struct normal_loads {
    real carried_N[LACONIC_SLIP_POINTS]; /* 0 where lifted                            */
    real statics_N[LACONIC_SLIP_POINTS]; /* below 0 where lifted, else what is carried */
} normal_loads;

/* Statics with the ground's horizontal force (body axes), which acts com_z below S: a point that would pull lifts, and
 * the others share its load. */
void laconic_normal_loads(normal_loads *loads, const laconic_friction *friction, const real ground_N[2]);

/* What a motor does at one speed of its wheel, torques over M R², or in Nm where its constants are. */
typedef struct motor_state {
    real torque;    /* clamped; without viscous friction */
    real current_A; /* 0 where R_a is not known          */
    real voltage_V; /* at its terminals                  */
    laconic_drive_limit limit;
} motor_state;

/* What the supply has left of a command. `terminal_V`: of the supply; below 0: voltages are not cut. */
static inline real within_supply(real command_V, real terminal_V) {
    return terminal_V >= R(0) ? cut(command_V, terminal_V) : command_V;
}

/* A motor of torque gain U − back_emf s within the current limit; back_emf/gain is the back-EMF per speed, so U − that
 * is R_a times the current. A limited motor has the voltage at its terminals that its controller sets for the limit. */
static inline motor_state motor_state_of(int32_t circuit, real gain, real back_emf, real torque_limit, real ampere,
                                         real command_V, real speed, real terminal_V) {
    motor_state m = {R(0), R(0), R(0), LACONIC_LIMIT_NONE};
    if (circuit == LACONIC_MOTOR_OPEN) return m;
    if (circuit == LACONIC_MOTOR_DRIVEN) {
        m.voltage_V = within_supply(command_V, terminal_V);
        if (m.voltage_V < command_V || m.voltage_V > command_V) m.limit = LACONIC_LIMIT_VOLTAGE;
    }
    const real free = gain * m.voltage_V - back_emf * speed;
    m.torque = circuit == LACONIC_MOTOR_DRIVEN ? cut(free, torque_limit) : free;
    m.current_A = m.torque * ampere;
    if (m.torque < free || m.torque > free) {
        m.limit = LACONIC_LIMIT_CURRENT;
        m.voltage_V = (m.torque + back_emf * speed) / gain;
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

/* One round; true where the voltage was right before it. `per_volt`: of the current. */
static inline bool sag_round(real *volts, real supply_V, real resistance_ohm, real current_A, real per_volt) {
    const real off = supply_V - resistance_ohm * current_A - *volts;
    const real slope = R(1) + resistance_ohm * per_volt;
    const real next = *volts + off / (slope > LEAST_SLOPE ? slope : LEAST_SLOPE);
    *volts = next > R(0.5) * *volts ? next : R(0.5) * *volts; /* stays above 0 */
    return magnitude(off) <= FOUND * *volts;
}

/* `terminal_V` as for within_supply(). */
motor_state laconic_motor_at(const laconic_friction *friction, int32_t wheel, real command_V, real speed,
                             real terminal_V);

/* The voltage that the supply has under the motors' currents at these speeds; −1 without a supply. `guess`: where the
 * search begins, the voltage of the step before. */
real laconic_supply_voltage(const laconic_friction *friction, const laconic_input *input, const real speed[],
                            real guess);

/* Slip of a contact's point over R, along u and across it (not yet times k). */
static inline void slip_of(real slip[2], const laconic_friction_wheel *w, vector nu, real speed) {
    slip[0] = dot(vec(w->along), nu) - w->rim_along * speed;
    slip[1] = dot(vec(w->across), nu) - w->rim_across * speed;
}

/* Force of the ground on the body at a contact, body axes. */
static inline void force_in_body(real force_N[2], const laconic_friction_axle *a, const real along_across_N[2]) {
    force_N[0] = along_across_N[0] * a->pull[0] - along_across_N[1] * a->pull[1];
    force_N[1] = along_across_N[0] * a->pull[1] + along_across_N[1] * a->pull[0];
}

#endif
#endif
