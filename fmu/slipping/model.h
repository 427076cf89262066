/* A vehicle with hinges on ground with friction as an FMU model for Co-Simulation: parameters and inputs as the
 * importer set them, the core's vehicle, and outputs that are computed when they are read. Plain data. */
#ifndef LACONIC_FMU_SLIPPING_MODEL_H
#define LACONIC_FMU_SLIPPING_MODEL_H

#include "laconic/articulated_friction.h"

#if LACONIC_MAX_BODIES < 1 || !LACONIC_WITH_FRICTION
#error "this FMU needs the core with bodies on hinges (LACONIC_MAX_BODIES) and with friction"
#endif

#define FMU_MODEL_SLIPS 1
#define FMU_MODEL_OFFERS_EXCHANGE 0
#define FMU_MODEL_LARGEST_ARRAY LACONIC_MAX_WHEELS
#define FMU_MODEL_OTHER_LARGEST_ARRAY LACONIC_MAX_BODIES
#define FMU_MODEL_MOST_STATES 1
#define FMU_MODEL_PORTS 0 /* bus terminals */
#define FMU_MODEL_TAKES_SLOPES true
#define FMU_MODEL_SLICE_STEPS 64U /* between two looks at whether the importer cancels: well below a second */
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)

/* Arrays have one element for each wheel, or one for each body on a hinge. */
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.hinged.base.wheel_count)
#define FMU_MODEL_OTHER_ARRAY_SIZE(model) ((uint32_t)(model)->vehicle.hinged.body_count)

/* All outputs are computed together: they follow from the state alone, which has what its last step found. */
#define FMU_GROUP_OUTPUTS 1U
#define FMU_GROUPS_ALL 1U
#define FMU_GROUPS_OF_STATE FMU_GROUPS_ALL /* stale when the core's state changed */

typedef laconic_tree_input fmu_hinged_input;

typedef struct fmu_model {
    bool start_needed;   /* parameters were set since the last start                     */
    bool change_needed;  /* tunable parameters were set since                            */
    bool states_changed; /* by an event that no event iteration has reported yet         */
    double time_s;
    uint32_t stale;

    laconic_tree_vehicle vehicle;
    laconic_tree_start start;
    double step_s;
    laconic_tree_input input;
    laconic_tree_input slope; /* du/dt during the next step; FMI 2 */

    laconic_tree_vehicle in_use; /* what `prepared` was prepared from */
    laconic_tree_model prepared;
    double internal_step_s;
    laconic_tree_state state;

    laconic_tree_outputs out;
    double heading_wrapped_rad, origin_m[2], solver_passes;
    double contact_state[LACONIC_MAX_WHEELS], drive_limit[LACONIC_MAX_WHEELS];
    double hinge_current_A[LACONIC_MAX_BODIES], hinge_drive_limit[LACONIC_MAX_BODIES];
    double support_load_N[LACONIC_MAX_SUPPORTS];
} fmu_model;

/* What steps change. */
typedef struct fmu_model_motion {
    laconic_tree_state state;
    laconic_tree_input input, slope;
} fmu_model_motion;

/* Such a vehicle has no partial derivatives; the offsets of its inputs name them for slopes. */
typedef struct fmu_tangent {
    laconic_tree_input input;
} fmu_tangent;

/* Locations of the variables that vehicles with hinges do not all have (articulated/variable_locations.h). */
#define IN_DRIVE(member) FMU_PLAIN(vehicle.hinged.base.drive.member)
#define IN_TREE_HINGE(member) FMU_AT(vehicle.hinge[0].member), sizeof(laconic_tree_hinge), 0, FMU_NO_TANGENT
#define IN_TREE_WHEEL(member) FMU_AT(vehicle.wheel[0].member), sizeof(laconic_tree_wheel), 0, FMU_NO_TANGENT
#define IN_TREE_INPUT(member) FMU_MOVING(input.member, 0)
#define SHOWN(name, member) OUTPUT(name, member, FMU_GROUP_OUTPUTS)
#define SAME(name) SHOWN(name, out.name)
#define MOVES(name) SHOWN(name, out.motion.name)
/* clang-format off */
#define SLIPPING_LOCATIONS \
    LACONIC_DRIVE_FIELDS(FIELD, DRIVE) LACONIC_TREE_FIELDS(FIELD) \
    FMU_LOCATION(start_wheel_speed_rad_per_s, FMU_AT(start.wheel_speed_rad_per_s), sizeof(double), 0, FMU_NO_TANGENT) \
    FMU_LOCATION(start_wheels_stand, FMU_PLAIN(start.wheels_stand)) FMU_LOCATION(step_s, FMU_PLAIN(step_s)) \
    MOVES(x_m) MOVES(y_m) MOVES(heading_rad) SHOWN(hinge_rad, out.motion.hinge_angle_rad) \
    MOVES(wheel_angle_rad) SHOWN(heading_wrapped_rad, heading_wrapped_rad) \
    SHOWN(origin_x_m, origin_m[0]) SHOWN(origin_y_m, origin_m[1]) \
    SHOWN(velocity_body_m_per_s, out.motion.velocity_m_per_s) MOVES(yaw_rate_rad_per_s) MOVES(hinge_rate_rad_per_s) \
    MOVES(body_x_m) MOVES(body_y_m) MOVES(body_heading_rad) MOVES(wheel_speed_rad_per_s) MOVES(energy_J) \
    SAME(wheel_torque_Nm) SHOWN(wheel_reaction_N, out.along_N) SHOWN(wheel_lateral_N, out.lateral_N) \
    SHOWN(hinge_reaction_Nm, out.hinge_torque_Nm) SHOWN(wheel_load_N, out.normal_N) \
    SHOWN(support_load_N, support_load_N) \
    SAME(slip_along_m_per_s) SAME(slip_across_m_per_s) SHOWN(contact_state, contact_state) \
    SHOWN(scrub_torque_Nm, out.scrub_Nm) SHOWN(drive_limit, drive_limit) SAME(motor_current_A) \
    SHOWN(hinge_friction_Nm, out.friction_torque_Nm) SHOWN(hinge_stop_Nm, out.stop_torque_Nm) \
    SHOWN(hinge_current_A, hinge_current_A) SHOWN(hinge_drive_limit, hinge_drive_limit) \
    SAME(supply_current_A) SAME(supply_voltage_V) SAME(supply_energy_J) SAME(outer_work_J) SAME(servo_work_J) \
    SAME(slip_loss_J) SAME(scrub_loss_J) SAME(axle_loss_J) SAME(hinge_loss_J) SAME(stop_loss_J) SAME(motor_loss_J) \
    SAME(supply_loss_J) SAME(numerical_loss_J) SAME(spring_energy_J) SHOWN(solver_passes, solver_passes)
/* clang-format on */

#endif
