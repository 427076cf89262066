/* Partial derivatives of the vehicle, by the core's analytic linearisation. */
#include "model_interface.h"

static void take_variation(laconic_variation *by, const fmu_tangent *t) {
    for (int32_t k = 0; k < 3; k++) by->nu_rad_per_s[k] = t->nu[k];
    by->x_m = t->x_m;
    by->y_m = t->y_m;
    by->heading_rad = t->heading_rad;
    by->input = t->input;
}

static void take_motion(laconic_motion *at, fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    fmu_model_refresh(instance, FMU_GROUP_MOTION);
    for (int32_t k = 0; k < 3; k++) at->nu_rad_per_s[k] = self->nu[k];
    at->heading_rad = self->heading_rad;
}

static void put_motion(fmu_tangent *t, const laconic_motion_change *change, int32_t wheels) {
    t->pose.origin_x_m = change->origin_x_m;
    t->pose.origin_y_m = change->origin_y_m;
    t->pose.heading_wrapped_rad = t->heading_rad;
    t->velocity_m_per_s[0] = change->velocity_m_per_s[0];
    t->velocity_m_per_s[1] = change->velocity_m_per_s[1];
    t->yaw_rate_rad_per_s = change->yaw_rate_rad_per_s;
    t->energy_J = change->energy_J;
    for (int32_t i = 0; i < wheels; i++) {
        t->wheel_speed_rad_per_s[i] = change->wheel_speed_rad_per_s[i];
        t->wheel_torque_Nm[i] = change->wheel_torque_Nm[i];
    }
}

fmu_status fmu_model_check_tangent(const fmu_instance *instance) {
    if (!instance->model.plant.friction.acts) return FMU_OK;
    return fmu_refuse(instance,
                      "a vehicle with ground friction or limits of its drive has no partial derivatives, since "
                      "its forces have kinks; the description does not offer them");
}

void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    const fmu_model *self = &instance->model;
    const laconic_model *m = &self->plant.model;
    laconic_motion_change change;
    laconic_variation by;
    laconic_motion at;
    take_motion(&at, instance);
    take_variation(&by, tangent);
    fmu_model_refresh(instance, FMU_GROUP_GROUND);
    laconic_derivative_tangent(&tangent->rates, m, &at, &self->input, &by);
    laconic_motion_tangent(&change, m, &at, &by);
    laconic_reactions_tangent(&tangent->ground, &self->contact, m, &at, &self->input, &self->ground, &by);
    fmu_model_part_loads(tangent->support_load_N, &tangent->ground, &self->plant.vehicle);
    laconic_acceleration_tangent(tangent->sensed.acceleration_body_m_per_s2, m, at.nu_rad_per_s, by.nu_rad_per_s,
                                 tangent->rates.nu_rad_per_s2);
    put_motion(tangent, &change, m->wheel_count);
}

void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent) {
    const fmu_model *self = &instance->model;
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    for (int32_t i = 0; i < 3; i++) tangent->nu[i] = self->rates.nu_rad_per_s2[i];
    tangent->x_m = self->rates.x_m_per_s;
    tangent->y_m = self->rates.y_m_per_s;
    tangent->heading_rad = self->rates.yaw_rate_rad_per_s;
    for (int32_t i = 0; i < self->plant.model.wheel_count; i++)
        tangent->wheel_angle_rad[i] = self->rates.wheel_speed_rad_per_s[i];
    if (self->sloped) tangent->input = self->slope;
}

void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope) {
    const size_t offset = tangent_offset - offsetof(fmu_tangent, input);
    const laconic_input none = {{0.0}, {0.0}, {0.0}, 0.0, {0.0}, {0.0}};
    if (!model->sloped) model->slope = none;
    *(double *)(void *)((char *)&model->slope + offset) = slope;
    model->sloped = true;
}
