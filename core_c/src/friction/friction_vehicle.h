/* What the files about vehicles with friction share: loads, motors, contacts. The solver knows nothing of it. */
#ifndef LACONIC_FRICTION_VEHICLE_H
#define LACONIC_FRICTION_VEHICLE_H

#include "friction_solver.h"
#include "step_internals.h"

/* Normal loads of wheels and supports, and whether each has lifted. */
typedef struct normal_loads {
    real carried_N[LACONIC_SLIP_POINTS]; /* 0 where lifted                            */
    real statics_N[LACONIC_SLIP_POINTS]; /* below 0 where lifted, else what is carried */
} normal_loads;

/* Statics with the ground's horizontal force (body axes), which acts com_z below S: a point that would pull lifts, and
 * the others share its load. */
void laconic_normal_loads(normal_loads *loads, const laconic_friction *friction, const real ground_N[2]);

/* What a motor does at one speed of its wheel, torques over M R². */
typedef struct motor_state {
    real torque;    /* clamped; without viscous friction */
    real current_A; /* 0 where R_a is not known          */
    real voltage_V; /* at its terminals                  */
    laconic_drive_limit limit;
} motor_state;

/* `terminal_V`: of the supply; below 0: voltages are not cut. */
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
