#include "grip.h"

#include <float.h>

/* A point that carries nothing has a load of 0 but for rounding. */
static double rounding_N(const laconic_model *model) {
    return 1e-9 * LACONIC_GRAVITY_M_PER_S2 * model->mass_kg;
}

static int32_t least_loaded(const laconic_reactions *ground, int32_t points) {
    int32_t i, least = 0;
    for (i = 1; i < points; i++)
        if (ground->normal_N[i] < ground->normal_N[least]) least = i;
    return least;
}

/* The wheel of the least margin: |reaction| = μ N − margin holds for it, and for the others less, so that no root is
 * needed. */
static int32_t worst_wheel(const laconic_reactions *ground, const laconic_contact *contact, int32_t wheels) {
    double least = DBL_MAX;
    int32_t i, worst = 0;
    for (i = 0; i < wheels; i++) {
        const double most_N = contact->friction_coefficient * ground->normal_N[i] - ground->no_slip_margin_N;
        const double spare_N2 =
            most_N * most_N - ground->along_N[i] * ground->along_N[i] - ground->lateral_N[i] * ground->lateral_N[i];
        if (!(spare_N2 < least)) continue;
        least = spare_N2;
        worst = i;
    }
    return worst;
}

static void tell_lift(const fmu_instance *instance, const laconic_reactions *ground, int32_t point, double time_s) {
    const int32_t wheels = instance->plant.core.model.wheel_count;
    fmu_report(
        instance, FMU_WARNING, FMU_LOG_WARNING,
        "at %.9g s %s %d lifts: the ground would have to pull it down with %.4g N; the model keeps all wheels on the "
        "ground, so its motion no longer holds (said once)",
        time_s, point < wheels ? "wheel" : "ball caster", (int)(point < wheels ? point : point - wheels) + 1,
        -ground->normal_N[point]);
}

static void tell_slip(const fmu_instance *instance, const laconic_reactions *ground, int32_t wheel, double time_s) {
    fmu_report(instance, FMU_WARNING, FMU_LOG_WARNING,
               "at %.9g s wheel %d needs %.4g N more grip than friction_coefficient = %.4g gives it (no_slip_margin_N "
               "is below "
               "0); the model knows no slip, so its motion no longer holds (said once)",
               time_s, (int)wheel + 1, -ground->no_slip_margin_N, instance->plant.contact.friction_coefficient);
}

void fmu_grip_judge(fmu_instance *instance, const laconic_reactions *ground, double time_s) {
    const fmu_plant *p = &instance->plant;
    const double rounding = rounding_N(&p->core.model);
    const int32_t light = least_loaded(ground, p->contact.point_count);
    const bool lifts = p->contact.point_count > 0 && ground->normal_N[light] < -rounding;
    if (lifts && !(instance->told & FMU_TOLD_LIFT)) {
        instance->told |= FMU_TOLD_LIFT;
        tell_lift(instance, ground, light, time_s);
    }
    if (!lifts && ground->no_slip_margin_N < -rounding && !(instance->told & FMU_TOLD_SLIP)) {
        instance->told |= FMU_TOLD_SLIP;
        tell_slip(instance, ground, worst_wheel(ground, &p->contact, p->core.model.wheel_count), time_s);
    }
}

void fmu_plant_watch(fmu_instance *instance) {
    if (!fmu_grip_is_watched(instance)) return;
    fmu_plant_refresh(instance, FMU_GROUP_GROUND);
    fmu_grip_judge(instance, &instance->plant.ground, instance->plant.time_s);
}

laconic_status fmu_grip_run(fmu_instance *instance, uint64_t steps, laconic_refusal *why) {
    fmu_plant *p = &instance->plant;
    const double start_s = fmu_clock_now(&instance->clock), step_s = p->core.integrator.step_s;
    uint64_t n;
    for (n = 0; n < steps && fmu_grip_is_watched(instance); n++) {
        laconic_status status;
        fmu_plant_refresh(instance, FMU_GROUP_GROUND);
        fmu_grip_judge(instance, &p->ground, start_s + (double)n * step_s);
        status = laconic_plant_run(&p->core, &p->input, 1, why);
        if (status != LACONIC_OK) return status;
        p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    }
    return laconic_plant_run(&p->core, &p->input, steps - n, why);
}
