/* A robot from its numbers to its outputs. */
#include "web.h"

/* The same robot on ideal ground; rolls is false where it cannot be prepared, as with skid steering. */
static void prepare_rolling(laconic_web_robot *robot) {
    static laconic_vehicle ideal;
    ideal = robot->plant.vehicle;
    ideal.ground.friction_coefficient = ideal.ground.roller_drag = ideal.ground.axle_friction_Nm = 0;
    __builtin_memset(&ideal.drive, 0, sizeof ideal.drive);
    for (int32_t i = 0; i < ideal.wheel_count; i++) {
        laconic_wheel *wheel = &ideal.wheel[i];
        wheel->own_friction_coefficient = wheel->own_roller_drag = wheel->own_axle_friction_Nm = 0;
        wheel->motor_circuit = LACONIC_MOTOR_DRIVEN;
    }
    robot->rolls = laconic_prepare(&robot->rolling, &ideal, NULL) == LACONIC_OK;
}

/* Makes the plant at its start, with a method by its number and a step; returns a status. A refused robot keeps the
 * plant that it had. */
WEB_EXPORT(laconic_web_start) int32_t laconic_web_start(laconic_web_robot *robot, int32_t method, double step_s) {
    static laconic_vehicle vehicle;
    static laconic_contact contact;
    laconic_status status = laconic_web_vehicle(&vehicle, robot, &robot->why);
    if (status == LACONIC_OK) status = laconic_contact_prepare(&contact, &vehicle, &robot->why);
    if (status == LACONIC_OK)
        status = laconic_plant_start(&robot->plant, &vehicle, laconic_method_by_number(method), step_s, &robot->start,
                                     &robot->why);
    if (status != LACONIC_OK) return (int32_t)laconic_web_refuse(robot);
    robot->contact = contact;
    prepare_rolling(robot);
    return LACONIC_OK;
}

/* Sets ν of the start from a velocity of the centre of mass in body axes and a yaw rate; returns a status. */
WEB_EXPORT(laconic_web_start_velocity)
int32_t laconic_web_start_velocity(laconic_web_robot *robot, double forward, double left, double turn) {
    static laconic_vehicle vehicle;
    static laconic_model model;
    laconic_status status = laconic_web_vehicle(&vehicle, robot, &robot->why);
    if (status == LACONIC_OK) status = laconic_prepare(&model, &vehicle, &robot->why);
    if (status != LACONIC_OK) return (int32_t)laconic_web_refuse(robot);
    robot->start.nu_rad_per_s[0] = forward / model.wheel_radius_m;
    robot->start.nu_rad_per_s[1] = left / model.wheel_radius_m;
    robot->start.nu_rad_per_s[2] = model.yaw_scale * turn;
    return LACONIC_OK;
}

/* Takes steps with the input held; returns a status. */
WEB_EXPORT(laconic_web_run) int32_t laconic_web_run(laconic_web_robot *robot, uint32_t steps) {
    const laconic_status status = laconic_plant_run(&robot->plant, &robot->input, steps, &robot->why);
    return (int32_t)(status == LACONIC_OK ? status : laconic_web_refuse(robot));
}

WEB_EXPORT(laconic_web_clear_input) void laconic_web_clear_input(laconic_web_robot *robot) {
    __builtin_memset(&robot->input, 0, sizeof robot->input);
}

/* Steps taken since the start, as a double: whole up to 2⁵³. */
WEB_EXPORT(laconic_web_steps) double laconic_web_steps(const laconic_web_robot *robot) {
    return (double)robot->plant.steps;
}

/* Fills the outputs, reactions with them, and returns where they lie. */
WEB_EXPORT(laconic_web_outputs) const laconic_outputs *laconic_web_outputs(laconic_web_robot *robot) {
    laconic_outputs_of(&robot->outputs, &robot->plant, &robot->input);
    laconic_plant_reactions(&robot->outputs.reactions, &robot->plant, &robot->contact, &robot->input);
    return &robot->outputs;
}

WEB_EXPORT(laconic_web_has_friction) bool laconic_web_has_friction(const laconic_web_robot *robot) {
    return robot->plant.friction.acts;
}

/* Motor gain c1 of a wheel, from 0, as the core uses it; 0: no motor. */
WEB_EXPORT(laconic_web_motor_gain) double laconic_web_motor_gain(const laconic_web_robot *robot, int32_t wheel) {
    if (wheel < 0 || wheel >= robot->plant.vehicle.wheel_count) return 0;
    const laconic_wheel *w = &robot->plant.vehicle.wheel[wheel];
    if (w->undriven) return 0;
    return w->own_motor_gain_Nm_per_V != 0 ? w->own_motor_gain_Nm_per_V : robot->plant.vehicle.motor_gain_Nm_per_V;
}

/* The outputs by name: where JavaScript finds each in a laconic_outputs, and how many numbers it has. */
#define OUTPUT(name, member) \
    {#name, offsetof(laconic_outputs, member), sizeof(((laconic_outputs *)NULL)->member) / sizeof(laconic_real)}
#define POSE(name) OUTPUT(name, pose.name)
#define REACTION(name) OUTPUT(name, reactions.name)
#define FRICTION(name) OUTPUT(name, friction.name)

static const laconic_web_output outputs[] = {
    OUTPUT(nu_rad_per_s, nu_rad_per_s),
    OUTPUT(velocity_body_m_per_s, velocity_body_m_per_s),
    OUTPUT(yaw_rate_rad_per_s, yaw_rate_rad_per_s),
    OUTPUT(energy_J, energy_J),
    POSE(x_m),
    POSE(y_m),
    POSE(origin_x_m),
    POSE(origin_y_m),
    POSE(heading_rad),
    POSE(heading_wrapped_rad),
    OUTPUT(wheel_speed_rad_per_s, wheel_speed_rad_per_s),
    OUTPUT(wheel_angle_rad, wheel_angle_rad),
    OUTPUT(wheel_torque_Nm, wheel_torque_Nm),
    REACTION(along_N),
    REACTION(lateral_N),
    REACTION(brake_Nm),
    REACTION(normal_N),
    REACTION(no_slip_margin_N),
    FRICTION(slip_along_m_per_s),
    FRICTION(slip_across_m_per_s),
    FRICTION(contact_state),
    FRICTION(drive_limit),
    FRICTION(motor_current_A),
    FRICTION(supply_current_A),
    FRICTION(supply_voltage_V),
    FRICTION(supply_energy_J),
    FRICTION(slip_loss_J),
};

/* NULL beyond the last. */
WEB_EXPORT(laconic_web_output) const laconic_web_output *laconic_web_output_at(uint32_t number) {
    return number < sizeof outputs / sizeof outputs[0] ? &outputs[number] : NULL;
}
