/* A vehicle with hinges from its numbers to its outputs. JavaScript makes the commands of hinges, step by step where a
 * limit acts (hinge_commands.js); here a run takes them as they are. */
#include "web.h"

static int32_t kept(laconic_web_robot *robot, laconic_status status) {
    return (int32_t)(status == LACONIC_OK ? status : laconic_web_refuse(robot));
}

static laconic_status prepare_rolling(laconic_web_robot *robot, int32_t method, double step_s) {
    const laconic_status status = laconic_articulated_prepare(&robot->model, &robot->tree.hinged, &robot->why);
    if (status != LACONIC_OK) return status;
    return laconic_articulated_integrator_prepare(&robot->integrator, method, &robot->model, step_s, &robot->why);
}

/* Prepares the vehicle, with a method by its number and a step; where wheels may slip there is one method. Returns a
 * status. */
WEB_EXPORT(laconic_web_prepare)
int32_t laconic_web_prepare(laconic_web_robot *robot, int32_t method, double step_s, bool slips) {
    laconic_status status = laconic_web_vehicle(&robot->tree.hinged.base, robot, &robot->why);
    robot->slips = slips;
    robot->step_s = step_s;
    if (status == LACONIC_OK)
        status = slips ? laconic_tree_prepare(&robot->tree_model, &robot->tree, &robot->why)
                       : prepare_rolling(robot, method, step_s);
    return kept(robot, status);
}

static laconic_tree_input commanded(const laconic_web_robot *robot) {
    laconic_tree_input input = robot->tree_input;
    input.hinged.base = robot->input;
    return input;
}

static void copy_twist(laconic_real to[3], const laconic_real from[3]) {
    for (int k = 0; k < 3; k++) to[k] = from[k];
}

/* Puts the vehicle at its start, where the inputs act; returns a status. wheels_stand: their speeds are given. */
WEB_EXPORT(laconic_web_place) int32_t laconic_web_place(laconic_web_robot *robot, bool wheels_stand) {
    laconic_articulated_start *start = &robot->tree_start.hinged;
    start->x_m = robot->start.x_m;
    start->y_m = robot->start.y_m;
    start->heading_rad = robot->start.heading_rad;
    const laconic_tree_input input = commanded(robot);
    copy_twist(robot->twist, input.hinged.twist);
    if (!robot->slips)
        return kept(robot, laconic_articulated_state_set(&robot->state, &robot->changed_m_per_s, &robot->model, start,
                                                         &input.hinged, &robot->why));
    robot->tree_start.wheels_stand = wheels_stand;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++)
        robot->tree_start.wheel_speed_rad_per_s[i] = robot->start.wheel_speed_rad_per_s[i];
    return kept(robot, laconic_tree_state_set(&robot->tree_state, &robot->tree_model, &robot->tree_start, &robot->why));
}

/* By how much the start was changed to a motion that the wheels allow [m/s]. */
WEB_EXPORT(laconic_web_changed) double laconic_web_changed(const laconic_web_robot *robot) {
    return robot->changed_m_per_s;
}

static laconic_status step(laconic_web_robot *robot, const laconic_articulated_input *from,
                           const laconic_articulated_input *to) {
    const laconic_status status =
        laconic_articulated_step(&robot->model, &robot->integrator, &robot->state, from, to, &robot->why);
    if (status != LACONIC_OK) return laconic_web_refuse(robot);
    copy_twist(robot->twist, to->twist);
    robot->steps++;
    return status;
}

static laconic_status roll(laconic_web_robot *robot, const laconic_articulated_input *held, uint32_t steps) {
    laconic_articulated_input from = *held, to = *held;
    laconic_status status = LACONIC_OK;
    robot->before = robot->state;
    robot->steps_before = robot->steps;
    copy_twist(robot->twist_before, robot->twist);
    copy_twist(from.twist, robot->twist);
    laconic_articulated_ramp(&from, &to, robot->integrator.step_s);
    for (uint32_t k = 0; k < steps && status == LACONIC_OK; k++)
        status = k == 0 ? step(robot, &from, &to) : step(robot, held, held);
    return status;
}

static laconic_status slide(laconic_web_robot *robot, const laconic_tree_input *held, uint32_t steps) {
    for (uint32_t k = 0; k < steps; k++) {
        const laconic_status status =
            laconic_tree_step(&robot->tree_model, robot->step_s, &robot->tree_state, held, &robot->why);
        if (status != LACONIC_OK) return laconic_web_refuse(robot);
        robot->steps++;
    }
    return LACONIC_OK;
}

/* Takes steps; returns a status. All inputs are held, but without slip the twist goes linearly from that which acts to
 * the commanded one within the first step. */
WEB_EXPORT(laconic_web_run) int32_t laconic_web_run(laconic_web_robot *robot, uint32_t steps) {
    const laconic_tree_input held = commanded(robot);
    return (int32_t)(robot->slips ? slide(robot, &held, steps) : roll(robot, &held.hinged, steps));
}

/* Takes the last run without slip back. */
WEB_EXPORT(laconic_web_back) void laconic_web_back(laconic_web_robot *robot) {
    robot->state = robot->before;
    robot->steps = robot->steps_before;
    copy_twist(robot->twist, robot->twist_before);
}

WEB_EXPORT(laconic_web_clear_input) void laconic_web_clear_input(laconic_web_robot *robot) {
    __builtin_memset(&robot->input, 0, sizeof robot->input);
    __builtin_memset(&robot->tree_input, 0, sizeof robot->tree_input);
}

WEB_EXPORT(laconic_web_steps) double laconic_web_steps(const laconic_web_robot *robot) { return robot->steps; }

static void slipping_outputs(laconic_web_hinged_outputs *outputs) {
    outputs->motion = outputs->tree.motion;
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) outputs->contact_state[i] = outputs->tree.contact_state[i];
    for (int32_t i = 0; i < LACONIC_TREE_AXES; i++) outputs->drive_limit[i] = outputs->tree.drive_limit[i];
}

/* What follows from the state, and where it lies. */
WEB_EXPORT(laconic_web_outputs) const laconic_web_hinged_outputs *laconic_web_outputs(laconic_web_robot *robot) {
    if (!robot->slips) {
        laconic_articulated_motion_of(&robot->outputs.motion, &robot->model, &robot->state);
        return &robot->outputs;
    }
    laconic_tree_outputs_of(&robot->outputs.tree, &robot->tree_model, &robot->tree_state);
    slipping_outputs(&robot->outputs);
    return &robot->outputs;
}

/* Fills the reactions without slip, under the inputs that are set and the twist that acts; returns a status. */
WEB_EXPORT(laconic_web_reactions) int32_t laconic_web_reactions(laconic_web_robot *robot) {
    laconic_tree_input input = commanded(robot);
    copy_twist(input.hinged.twist, robot->twist);
    return kept(robot, laconic_articulated_reactions_of(&robot->outputs.reactions, &robot->model, &robot->state,
                                                        &input.hinged, NULL, &robot->why));
}

#define OUTPUT(name, member) \
    {#name, offsetof(laconic_web_hinged_outputs, member), \
     sizeof(((laconic_web_hinged_outputs *)NULL)->member) / sizeof(laconic_real)}
#define MOTION(name) OUTPUT(name, motion.name)
#define REACTION(name) OUTPUT(name, reactions.name)
#define SLIPPING(name) OUTPUT(name, tree.name)

/* Those of slipping vehicles alone begin with the slips; along_N and others are there twice, once for each kind. */
static const laconic_web_output outputs[] = {
    MOTION(velocity_m_per_s),
    MOTION(yaw_rate_rad_per_s),
    MOTION(x_m),
    MOTION(y_m),
    MOTION(heading_rad),
    MOTION(hinge_angle_rad),
    MOTION(hinge_rate_rad_per_s),
    MOTION(body_x_m),
    MOTION(body_y_m),
    MOTION(body_heading_rad),
    MOTION(wheel_speed_rad_per_s),
    MOTION(wheel_angle_rad),
    MOTION(energy_J),
    REACTION(wheel_torque_Nm),
    REACTION(along_N),
    REACTION(lateral_N),
    REACTION(brake_Nm),
    REACTION(hinge_torque_Nm),
    REACTION(hinge_force_N),
    SLIPPING(slip_along_m_per_s),
    SLIPPING(slip_across_m_per_s),
    OUTPUT(contact_state, contact_state),
    SLIPPING(along_N),
    SLIPPING(lateral_N),
    SLIPPING(scrub_Nm),
    SLIPPING(normal_N),
    SLIPPING(wheel_torque_Nm),
    SLIPPING(hinge_torque_Nm),
    SLIPPING(friction_torque_Nm),
    SLIPPING(stop_torque_Nm),
    SLIPPING(motor_current_A),
    OUTPUT(drive_limit, drive_limit),
    SLIPPING(supply_current_A),
    SLIPPING(supply_voltage_V),
    SLIPPING(spring_energy_J),
    SLIPPING(supply_energy_J),
    SLIPPING(outer_work_J),
    SLIPPING(servo_work_J),
    SLIPPING(slip_loss_J),
    SLIPPING(scrub_loss_J),
    SLIPPING(axle_loss_J),
    SLIPPING(hinge_loss_J),
    SLIPPING(stop_loss_J),
    SLIPPING(motor_loss_J),
    SLIPPING(supply_loss_J),
    SLIPPING(numerical_loss_J),
};

/* NULL beyond the last. */
WEB_EXPORT(laconic_web_output) const laconic_web_output *laconic_web_output_at(uint32_t number) {
    return number < sizeof outputs / sizeof outputs[0] ? &outputs[number] : NULL;
}

/* Whether a body's wheels make its hinge follow, body from 1: its rate at a start is then that of rolling. */
WEB_EXPORT(laconic_web_follows) bool laconic_web_follows(const laconic_web_robot *robot, int32_t body) {
    return robot->model.link[body - 1].motion == LACONIC_MOTION_FOLLOWING;
}

/* Of a body, from 1: 0, 1 its hinge from the origin of its parent, which of the carriage is its centre of mass; 2, 3
 * the axle of its wheels over their lever. */
WEB_EXPORT(laconic_web_link) double laconic_web_link(const laconic_web_robot *robot, int32_t body, int32_t number) {
    const laconic_link *link = &robot->model.link[body - 1];
    const double numbers[4] = {link->hinge.x, link->hinge.y, link->axle_per_lever.x, link->axle_per_lever.y};
    return numbers[number & 3];
}
