/* The outputs by name: where JavaScript finds each in a laconic_outputs, and how many numbers it has. */
#include "web.h"

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
