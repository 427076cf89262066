#include "internal.h"

/* M_i = c1 U_i − c2 χ_i' + T_i */
void laconic_wheel_torques(const laconic_model *model, const laconic_state *state, const laconic_input *input,
                           laconic_real *torque_Nm) {
    int32_t i;
    laconic_wheel_speeds(model, state, torque_Nm);
    for (i = 0; i < LACONIC_WHEELS(model); i++)
        torque_Nm[i] = model->motor_gain_Nm_per_V * input->voltage_V[i] - model->motor_damping_Nms * torque_Nm[i] +
                       input->axle_torque_Nm[i];
}
