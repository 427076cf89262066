/* Logs, once a run for each kind, an input that this vehicle does not read. */
#include "core_words.h"
#include "parts.h"

static const fmu_idle_input idle_inputs[] = {
    {"voltage_V", "V", "this wheel has no motor (wheel_undriven, or a motor gain of 0)"},
    {"hinge_voltage_V", "V", "this hinge has no motor (body_hinge, hinge_gain_Nm_per_V)"},
    {"hinge_torque_Nm", "N m", "this hinge is commanded (body_hinge), whatever torque that takes"},
    {"steering_rate_rad_per_s", "rad/s", "this hinge is not prescribed (body_hinge)"},
    {"steering_acceleration_rad_per_s2", "rad/s2", "this hinge is not prescribed (body_hinge)"},
    {"steering_twist", "", "no hinge is coordinated (body_hinge)"},
    {"steering_twist_rate", "", "no hinge is coordinated (body_hinge)"},
};

static void warn(fmu_instance *instance, unsigned kind, int32_t element, double value) {
    fmu_warn_idle(instance, &idle_inputs[kind], kind, element, value);
}

static void check_hinge(fmu_instance *instance, int32_t b) {
    const laconic_articulated_input *u = &instance->model.input;
    const laconic_link *link = &instance->model.prepared.link[b];
    const bool commanded = link->motion == LACONIC_MOTION_PRESCRIBED || link->motion == LACONIC_MOTION_COORDINATED;
    if (commanded || link->gain_Nm_per_V == 0.0) warn(instance, 1, b, u->hinge_voltage_V[b]);
    if (commanded) warn(instance, 2, b, u->hinge_torque_Nm[b]);
    if (link->motion == LACONIC_MOTION_PRESCRIBED) return;
    warn(instance, 3, b, u->hinge_rate_rad_per_s[b]);
    warn(instance, 4, b, u->hinge_acceleration_rad_per_s2[b]);
}

void fmu_articulated_check_idle(fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    const laconic_articulated_model *m = &self->prepared;
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->wheel[i].gain_Nm_per_V == 0.0) warn(instance, 0, i, self->input.base.voltage_V[i]);
    for (int32_t b = 0; b < m->body_count; b++) check_hinge(instance, b);
    for (int32_t k = 0; !m->coordinated && k < 3; k++) {
        warn(instance, 5, k, k == 0 ? 0.0 : self->input.twist[k]); /* the start value points straight ahead */
        warn(instance, 6, k, self->input.twist_rate[k]);
    }
}
