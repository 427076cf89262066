/* All outputs of a plant at one moment, for those who choose among them by number. */
#include "internal.h"

void laconic_outputs_of(laconic_outputs *outputs, const laconic_plant *plant, const laconic_input *input) {
    const laconic_model *model = &plant->model;
    const laconic_state *state = &plant->state;
    laconic_nu(model, state, outputs->nu_rad_per_s);
    outputs->yaw_rate_rad_per_s = laconic_body_velocity(model, state, outputs->velocity_body_m_per_s);
    outputs->energy_J = laconic_energy_J(model, state);
    laconic_pose_of(&outputs->pose, model, state);
    laconic_wheel_speeds(model, state, outputs->wheel_speed_rad_per_s);
    laconic_wheel_angles(model, state, outputs->wheel_angle_rad);
    laconic_wheel_torques(model, state, input, outputs->wheel_torque_Nm);
    outputs->input = *input;
}
