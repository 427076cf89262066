/* A vehicle with hinges from its numbers to its outputs. JavaScript makes the commands of hinges, step by step where a
 * limit acts (hinge_commands.js); here a run takes them as they are. */
#include "web.h"

/* Prepares the vehicle, with a method by its number and a step; returns a status. */
WEB_EXPORT(laconic_web_prepare) int32_t laconic_web_prepare(laconic_web_robot *robot, int32_t method, double step_s) {
    laconic_status status = laconic_web_vehicle(&robot->hinged.base, robot, &robot->why);
    if (status == LACONIC_OK) status = laconic_articulated_prepare(&robot->model, &robot->hinged, &robot->why);
    if (status == LACONIC_OK)
        status = laconic_articulated_integrator_prepare(&robot->integrator, method, &robot->model, step_s, &robot->why);
    return (int32_t)(status == LACONIC_OK ? status : laconic_web_refuse(robot));
}

static laconic_articulated_input commanded(const laconic_web_robot *robot) {
    laconic_articulated_input input = robot->hinged_input;
    input.base = robot->input;
    return input;
}

static void copy_twist(laconic_real to[3], const laconic_real from[3]) {
    for (int k = 0; k < 3; k++) to[k] = from[k];
}

/* Puts the vehicle at its start, where the inputs already act; returns a status. */
WEB_EXPORT(laconic_web_place) int32_t laconic_web_place(laconic_web_robot *robot) {
    robot->hinged_start.x_m = robot->start.x_m;
    robot->hinged_start.y_m = robot->start.y_m;
    robot->hinged_start.heading_rad = robot->start.heading_rad;
    const laconic_articulated_input input = commanded(robot);
    copy_twist(robot->twist, input.twist);
    const laconic_status status = laconic_articulated_state_set(&robot->state, &robot->changed_m_per_s, &robot->model,
                                                                &robot->hinged_start, &input, &robot->why);
    return (int32_t)(status == LACONIC_OK ? status : laconic_web_refuse(robot));
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

/* Takes steps; returns a status. The twist goes linearly from that which acts to the commanded one within the first
 * step; all other inputs are held. */
WEB_EXPORT(laconic_web_run) int32_t laconic_web_run(laconic_web_robot *robot, uint32_t steps) {
    const laconic_articulated_input held = commanded(robot);
    laconic_articulated_input from = held, to = held;
    laconic_status status = LACONIC_OK;
    robot->before = robot->state;
    robot->steps_before = robot->steps;
    copy_twist(robot->twist_before, robot->twist);
    copy_twist(from.twist, robot->twist);
    laconic_articulated_ramp(&from, &to, robot->integrator.step_s);
    for (uint32_t k = 0; k < steps && status == LACONIC_OK; k++)
        status = k == 0 ? step(robot, &from, &to) : step(robot, &held, &held);
    return (int32_t)status;
}

/* Takes the last run back. */
WEB_EXPORT(laconic_web_back) void laconic_web_back(laconic_web_robot *robot) {
    robot->state = robot->before;
    robot->steps = robot->steps_before;
    copy_twist(robot->twist, robot->twist_before);
}

WEB_EXPORT(laconic_web_clear_input) void laconic_web_clear_input(laconic_web_robot *robot) {
    __builtin_memset(&robot->input, 0, sizeof robot->input);
    __builtin_memset(&robot->hinged_input, 0, sizeof robot->hinged_input);
}

WEB_EXPORT(laconic_web_steps) double laconic_web_steps(const laconic_web_robot *robot) { return robot->steps; }

/* What follows from the state, and where it lies. */
WEB_EXPORT(laconic_web_outputs) const laconic_web_hinged_outputs *laconic_web_outputs(laconic_web_robot *robot) {
    laconic_articulated_motion_of(&robot->outputs.motion, &robot->model, &robot->state);
    return &robot->outputs;
}

/* Fills the reactions, under the inputs that are set and the twist that acts; returns a status. */
WEB_EXPORT(laconic_web_reactions) int32_t laconic_web_reactions(laconic_web_robot *robot) {
    laconic_articulated_input input = commanded(robot);
    copy_twist(input.twist, robot->twist);
    const laconic_status status = laconic_articulated_reactions_of(&robot->outputs.reactions, &robot->model,
                                                                   &robot->state, &input, NULL, &robot->why);
    return (int32_t)(status == LACONIC_OK ? status : laconic_web_refuse(robot));
}

#define MOTION(name) \
    {#name, offsetof(laconic_web_hinged_outputs, motion.name), \
     sizeof(((laconic_web_hinged_outputs *)NULL)->motion.name) / sizeof(laconic_real)}
#define REACTION(name) \
    {#name, offsetof(laconic_web_hinged_outputs, reactions.name), \
     sizeof(((laconic_web_hinged_outputs *)NULL)->reactions.name) / sizeof(laconic_real)}

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
