/* Finds wheels without a motor and logs once a voltage that such a wheel gets. */
#include "idle_motors.h"

#include "grip_warning.h"

void fmu_idle_motors_find(fmu_model *model) {
    model->idle_wheels = false;
    for (int32_t i = 0; i < model->plant.model.wheel_count; i++)
        if (model->plant.model.voltage_scale[i] == 0.0) model->idle_wheels = true;
}

void fmu_idle_motors_check(fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    if (instance->warnings_given & FMU_IDLE_WARNING) return;
    for (int32_t i = 0; i < self->plant.model.wheel_count; i++) {
        const double voltage_V = self->input.voltage_V[i];
        if (voltage_V == 0.0 || self->plant.model.voltage_scale[i] != 0.0) continue;
        instance->warnings_given |= FMU_IDLE_WARNING;
        fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
                "voltage_V[%d]: %.9g V has no effect: wheel %d has no motor (wheel_undriven, or a motor gain of 0); "
                "give 0, or drive the wheel by axle_torque_Nm (logged once)",
                (int)(i + 1), voltage_V, (int)(i + 1));
        return;
    }
}
