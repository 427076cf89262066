/* What is logged once in a run: what the ground cannot provide, by its reactions, and voltages without a motor. */
#include "parts.h"

static void warn_of_lift(const fmu_instance *instance) {
    const laconic_grip_event *event = &instance->model.pending_lift;
    const int wheels = (int)instance->model.plant.model.wheel_count, point = (int)event->point;
    fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
            "at %.9g s %s %d lifts: its normal load would be %.4g N; %s (logged once)", instance->model.lift_s,
            point <= wheels ? "wheel" : "support", point <= wheels ? point : point - wheels, event->normal_N,
            fmu_wheels_slip(&instance->model)
                ? "it carries nothing, the others share its load, and the model knows no tilt"
                : "the model keeps all wheels on the ground, so its motion no longer holds");
}

static void warn_of_slip(const fmu_instance *instance) {
    const laconic_grip_event *event = &instance->model.pending_slip;
    const double friction = instance->model.contact.friction_coefficient;
    const double has_N = event->normal_N > 0.0 ? friction * event->normal_N : 0.0;
    fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
            "at %.9g s wheel %d needs %.4g N of grip and has %.4g N (friction_coefficient = %.4g): %.4g N are missing; "
            "the model has no slip, so its motion no longer holds (logged once)",
            instance->model.slip_s, (int)event->point, event->needed_N, has_N, friction, event->needed_N - has_N);
}

static void warn_of_overflow(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    fmu_log(instance, FMU_WARNING, FMU_LOG_WARNING,
            "at %.9g s the forces on the ground leave the range of double precision; check the inputs (logged once)",
            instance->warnings_pending & FMU_SLIP_WARNING ? self->slip_s : self->lift_s);
}

static bool is_finite(const laconic_grip_event *event) {
    return fmu_is_finite(event->needed_N + event->normal_N + event->margin_N);
}

static void warn(const fmu_instance *instance, bool of_slip, bool of_lift) {
    const fmu_model *self = &instance->model;
    if ((of_slip && !is_finite(&self->pending_slip)) || (of_lift && !is_finite(&self->pending_lift))) {
        warn_of_overflow(instance);
        return;
    }
    if (of_slip) warn_of_slip(instance);
    if (of_lift) warn_of_lift(instance);
}

void fmu_model_settle_warnings(fmu_instance *instance, bool accepted) {
    const uint32_t pending = instance->warnings_pending;
    if (accepted) {
        warn(instance, (pending & FMU_SLIP_WARNING) != 0, (pending & FMU_LIFT_WARNING) != 0);
        instance->warnings_given |= pending;
    }
    instance->warnings_pending = 0;
}

void fmu_grip_check(fmu_instance *instance, const laconic_reactions *ground, double time_s) {
    fmu_model *self = &instance->model;
    const uint32_t known = fmu_warnings_done(instance);
    laconic_grip now = {0};
    laconic_grip_watch(&now, &self->contact, &self->plant.model, ground, self->plant.steps);
    if (now.slipping && !(known & FMU_SLIP_WARNING)) {
        self->pending_slip = now.first_slip;
        self->slip_s = time_s;
        instance->warnings_pending |= FMU_SLIP_WARNING;
    }
    if (now.lifting && !(known & FMU_LIFT_WARNING)) {
        self->pending_lift = now.first_lift;
        self->lift_s = time_s;
        instance->warnings_pending |= FMU_LIFT_WARNING;
    }
}

void fmu_model_completed_step(fmu_instance *instance) {
    if (!fmu_grip_is_watched(instance)) return;
    fmu_model_refresh(instance, FMU_GROUP_GROUND);
    fmu_grip_check(instance, &instance->model.ground, instance->model.time_s);
    fmu_model_settle_warnings(instance, true);
}

/* ------------------------------------------------------------- voltages of wheels without a motor -- */

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
