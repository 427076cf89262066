/* The core's sensors beside the plant: they watch its internal steps, and show what they have seen. */
#include "parts.h"

bool fmu_sensors_are_there(const fmu_model *model) {
    bool there = model->has_imu;
    for (int32_t i = 0; i < model->vehicle.wheel_count; i++)
        there = there || model->sensor_settings.encoder[i].counts_per_turn > 0;
    return there;
}

bool fmu_sensors_refuse(const fmu_instance *instance) {
    const fmu_model *model = &instance->model;
    if (model->sensor_settings.encoder_wrap == 1) {
        fmu_refuse(instance, "encoder_wrap: a counter of 1 value shows nothing; give 2 or more, or 0");
        return true;
    }
    if (!model->continuous || !fmu_sensors_are_there(model)) return false;
    fmu_refuse(instance,
               "has_imu, encoder_counts_per_turn: sensors sample at internal steps, which Model Exchange does "
               "not have; use Co-Simulation, or make the FMU from a scene without [sensors]");
    return true;
}

void fmu_sensors_find(fmu_model *model) {
    model->watched = !model->continuous && (fmu_sensors_are_there(model) || model->plant.friction.acts);
}

laconic_status fmu_sensors_start(fmu_model *model, laconic_refusal *why) {
    const laconic_encoder_settings none = {0, 0.0};
    laconic_sensor_settings settings = model->sensor_settings;
    if (!model->watched) return LACONIC_OK;
    for (int32_t i = model->vehicle.wheel_count; i < LACONIC_MAX_WHEELS; i++) settings.encoder[i] = none; /* unset */
    return laconic_sensors_start(&model->sensors, &settings, &model->plant, why);
}

/* Where no sensors watch, and without an IMU, these outputs are 0. */
void fmu_sensors_refresh(fmu_model *model) {
    laconic_sensor_outputs *out = &model->sensed;
    const laconic_sensors *sensors = &model->sensors;
    out->imu_acceleration_m_per_s2[0] = out->imu_acceleration_m_per_s2[1] = out->imu_yaw_rate_rad_per_s = 0.0;
    if (!model->watched) return;
    if (model->has_imu)
        laconic_imu_read(sensors, model->plant.integrator.step_s, out->imu_acceleration_m_per_s2,
                         &out->imu_yaw_rate_rad_per_s);
    for (int32_t i = 0; i < model->vehicle.wheel_count; i++)
        out->encoder_count[i] = laconic_encoder_shown(&sensors->encoder[i], sensors->settings.encoder_wrap);
}

void fmu_sensors_accelerate(fmu_model *model) {
    const laconic_plant *plant = &model->plant;
    double *acceleration = model->sensed.acceleration_body_m_per_s2, nu[3];
    if (!model->continuous || !plant->friction.acts) {
        laconic_acceleration_body(acceleration, &model->sensors, plant, &model->input);
        return;
    }
    laconic_nu(&plant->model, &plant->state, nu); /* as the constraints allow it, unlike the continuous states */
    laconic_acceleration_of_rates(acceleration, &plant->model, nu, model->rates.nu_rad_per_s2);
}
