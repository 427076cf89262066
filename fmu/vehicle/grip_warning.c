/* Judges the reactions of the ground during a run, and says once what they cannot be. */
#include "grip_warning.h"

static void tell_lift(const fmu_instance *instance) {
    const laconic_grip_event *event = &instance->plant.noted_lift;
    const int wheels = (int)instance->plant.core.model.wheel_count, point = (int)event->point;
    fmu_report(
        instance, FMU_WARNING, FMU_LOG_WARNING,
        "at %.9g s %s %d lifts: its normal load would be %.4g N; the model keeps all wheels on the ground, so its "
        "motion no longer holds (said once)",
        instance->plant.lift_s, point <= wheels ? "wheel" : "support", point <= wheels ? point : point - wheels,
        event->normal_N);
}

static void tell_slip(const fmu_instance *instance) {
    const laconic_grip_event *event = &instance->plant.noted_slip;
    const double friction = instance->plant.contact.friction_coefficient;
    const double has_N = event->normal_N > 0.0 ? friction * event->normal_N : 0.0;
    fmu_report(
        instance, FMU_WARNING, FMU_LOG_WARNING,
        "at %.9g s wheel %d needs %.4g N of grip and has %.4g N (friction_coefficient = %.4g): %.4g N are missing; "
        "the model knows no slip, so its motion no longer holds (said once)",
        instance->plant.slip_s, (int)event->point, event->needed_N, has_N, friction, event->needed_N - has_N);
}

static void tell_overflow(const fmu_instance *instance) {
    const fmu_plant *p = &instance->plant;
    fmu_report(instance, FMU_WARNING, FMU_LOG_WARNING,
               "at %.9g s the forces on the ground leave the range of double precision; check the inputs (said once)",
               instance->noted & FMU_TOLD_SLIP ? p->slip_s : p->lift_s);
}

static bool is_told_in_numbers(const laconic_grip_event *event) {
    return fmu_is_finite(event->needed_N + event->normal_N + event->margin_N);
}

void fmu_plant_conclude(fmu_instance *instance, bool accepted) {
    const uint32_t noted = instance->noted;
    const fmu_plant *p = &instance->plant;
    if (accepted && ((noted & FMU_TOLD_SLIP && !is_told_in_numbers(&p->noted_slip)) ||
                     (noted & FMU_TOLD_LIFT && !is_told_in_numbers(&p->noted_lift))))
        tell_overflow(instance);
    else if (accepted) {
        if (noted & FMU_TOLD_SLIP) tell_slip(instance);
        if (noted & FMU_TOLD_LIFT) tell_lift(instance);
    }
    if (accepted) instance->told |= noted;
    instance->noted = 0;
}

void fmu_grip_judge(fmu_instance *instance, const laconic_reactions *ground, double time_s) {
    fmu_plant *p = &instance->plant;
    const uint32_t known = instance->told | instance->noted;
    laconic_grip now = {0};
    laconic_grip_watch(&now, &p->contact, &p->core.model, ground, p->core.steps);
    if (now.slipping && !(known & FMU_TOLD_SLIP)) {
        p->noted_slip = now.first_slip;
        p->slip_s = time_s;
        instance->noted |= FMU_TOLD_SLIP;
    }
    if (now.lifting && !(known & FMU_TOLD_LIFT)) {
        p->noted_lift = now.first_lift;
        p->lift_s = time_s;
        instance->noted |= FMU_TOLD_LIFT;
    }
}

void fmu_plant_watch(fmu_instance *instance) {
    if (!fmu_grip_is_watched(instance)) return;
    fmu_plant_refresh(instance, FMU_GROUP_GROUND);
    fmu_grip_judge(instance, &instance->plant.ground, instance->plant.time_s);
    fmu_plant_conclude(instance, true);
}
