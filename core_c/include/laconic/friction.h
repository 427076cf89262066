/* Ground with friction, on which wheels slip and rollers drag, and drives whose voltage and current have limits. Part
 * of laconic.h; docs/friction.md has the model and its limits.
 *
 * A vehicle has friction where its ground (or a wheel) has a friction coefficient above 0, or where its motors have
 * limits or another circuit. Wheel speeds are then states of their own: laconic_plant steps body and wheels by the
 * friction step (first order, one convex problem a step), whose energy never grows by itself. Its model is that of the
 * body alone, without wheels: G = E and ζ = ν. A drive on ideal ground is stepped in the same way; its contacts hold
 * whatever the force. */
#ifndef LACONIC_FRICTION_H
#define LACONIC_FRICTION_H

#include "laconic/internals.h"
#include "laconic/real.h"
#include "laconic/status.h"
#include "laconic/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Array lengths: 1 in a build without friction. */
#if LACONIC_WITH_FRICTION
#define LACONIC_SLIP_WHEELS LACONIC_MAX_WHEELS
#define LACONIC_SLIP_POINTS (LACONIC_MAX_WHEELS + LACONIC_MAX_SUPPORTS)
#else
#define LACONIC_SLIP_WHEELS 1
#define LACONIC_SLIP_POINTS 1
#endif

/* Whether a vehicle is stepped by the friction step. */
bool laconic_vehicle_has_friction(const laconic_vehicle *vehicle);

/* Contact of one wheel, without units: speeds over R, energies over M R². Body axes. */
typedef struct laconic_friction_wheel {
    laconic_real along[3], across[3]; /* ν → contact point's velocity of the body, along the roller's axis u and across
                                           it, w = e_z × u                                      */
    laconic_real rim_along, rim_across; /* R_i sin γ/R, R_i cos γ/R: the rim's part of the slip, per wheel speed */
    laconic_real inertia;               /* J_i, over M R²                                        */
    laconic_real drag;                  /* k, 0 … 1; 1 for a fixed wheel                         */

    laconic_vector row[2];             /* along, k across                                 */
    laconic_real rim[2];               /* rim_along, k rim_across                         */
    laconic_real rolling[2], rim_size; /* rim[] as direction and length                   */
    laconic_real mobility;             /* the most slip that a unit impulse at the contact causes */
    laconic_real lateral_mass;         /* 1/(what an impulse square to `rolling` causes); 0: no such row */
    laconic_real row_mass[2];          /* the same for each row, with the wheel held      */
} laconic_friction_wheel;

/* Motor and axle of one wheel; torques over M R². */
typedef struct laconic_friction_axle {
    int32_t circuit;                   /* laconic_motor_circuit                                  */
    bool locked;                       /* the wheel's speed is held at 0                         */
    laconic_real gain;                 /* c1                                                     */
    laconic_real back_emf;             /* c2 without its viscous part                            */
    laconic_real viscous;              /* n² d                                                   */
    laconic_real torque_limit;         /* of the current limit; LACONIC_REAL_MAX: none           */
    laconic_real ampere;               /* current per torque, 1/(c1 R_a); 0 where R_a is not known */
    laconic_real dry;                  /* T                                                      */
    laconic_real friction_coefficient; /* μ_i; on ideal ground the vehicle's, for the margin     */
    laconic_real pull[2];              /* u, body axes                                           */
    laconic_real arm_m[2];             /* R_i sin γ, R_i cos γ                                   */
} laconic_friction_axle;

/* Prepared constants of a vehicle with friction; read them, do not write them. */
typedef struct laconic_friction {
    bool acts;  /* false: the vehicle has no friction, and the rest is 0 */
    bool slips; /* false: a drive on ideal ground, whose contacts hold */
    int32_t wheel_count, point_count;
    laconic_friction_wheel wheel[LACONIC_SLIP_WHEELS];
    laconic_friction_axle axle[LACONIC_SLIP_WHEELS];
    laconic_real energy_J;  /* M R²: its energy at 1 rad/s, twice  */
    laconic_real impulse_N; /* M R: force at the acceleration 1 rad/s² */
    laconic_real weight_N, com_z_m, radius_m;
    laconic_real supply_V, supply_resistance_ohm, winding_resistance_ohm;
    laconic_real point_row[LACONIC_SLIP_POINTS][3];             /* (R, ξ, η) of each wheel and support, from S  */
    laconic_real normal_load_of_wrench[LACONIC_SLIP_POINTS][3]; /* least-norm statics, while no point lifts    */
} laconic_friction;

/* The limit that a drive has reached. */
typedef enum laconic_drive_limit {
    LACONIC_LIMIT_NONE = 0,
    LACONIC_LIMIT_VOLTAGE = 1,
    LACONIC_LIMIT_CURRENT = 2
} laconic_drive_limit;

/* The wheels' part of the motion, and what the last step found out. To save a motion copy it with the
 * laconic_state. */
typedef struct laconic_slip {
    laconic_real wheel_speed_rad_per_s[LACONIC_SLIP_WHEELS];
    laconic_sum wheel_angle_rad[LACONIC_SLIP_WHEELS];
    laconic_real grip_N[LACONIC_SLIP_WHEELS]
                       [2]; /* forces of the last step by their law: of the robot on the ground, along
                                                     u, and along w over k; the next step's first guess */
    laconic_real normal_N[LACONIC_SLIP_POINTS];      /* below 0: the point has lifted and carried nothing */
    laconic_real current_A[LACONIC_SLIP_WHEELS];     /* of each motor                               */
    int32_t limit[LACONIC_SLIP_WHEELS];              /* laconic_drive_limit                         */
    laconic_real supply_current_A, supply_voltage_V; /* at the supply's terminals               */
    laconic_sum supply_energy_J;                     /* drawn from the supply, since the start      */
    laconic_sum outer_work_J;                        /* of outer forces, axle torques and the slope */
    laconic_sum slip_loss_J, axle_loss_J, motor_loss_J, supply_loss_J;
    laconic_sum numerical_loss_J; /* dissipation of the first-order step            */
} laconic_slip;

/* Outputs of a vehicle with friction in addition to the usual ones; every member is a number of the scalar type. */
typedef struct laconic_friction_outputs {
    laconic_real slip_along_m_per_s[LACONIC_SLIP_WHEELS];  /* of the contact point, along the roller's axis u  */
    laconic_real slip_across_m_per_s[LACONIC_SLIP_WHEELS]; /* along w = e_z × u; of free rollers their rolling */
    laconic_real contact_state[LACONIC_SLIP_WHEELS];       /* 0 sticks or rolls, 1 slips, 2 has lifted          */
    laconic_real drive_limit[LACONIC_SLIP_WHEELS];         /* laconic_drive_limit                               */
    laconic_real motor_current_A[LACONIC_SLIP_WHEELS];
    laconic_real supply_current_A, supply_voltage_V;
    laconic_real supply_energy_J, outer_work_J; /* since the start: what came in …                             */
    laconic_real slip_loss_J, axle_loss_J, motor_loss_J, supply_loss_J, numerical_loss_J; /* … and what was lost */
} laconic_friction_outputs;

#ifdef __cplusplus
}
#endif
#endif
