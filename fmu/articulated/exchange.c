/* The continuous states of a vehicle with hinges, slopes of its inputs, and what it lacks: partial derivatives. */
#include "parts.h"

/* Calls `visit` for each list of states in the order of the description. */
#define EACH_LIST(visit, moving, bodies, wheels) \
    visit(&(moving)->x_m, 1); \
    visit(&(moving)->y_m, 1); \
    visit(&(moving)->heading_rad, 1); \
    visit((moving)->hinge_rad, bodies); \
    visit((moving)->wheel_angle_rad, wheels); \
    visit((moving)->zeta, 3); \
    visit((moving)->own, bodies)

#define COPY_OUT(list, count) \
    for (uint32_t k = 0; k < (count); k++) *values++ = (list)[k]
#define COPY_IN(list, count) \
    for (uint32_t k = 0; k < (count); k++) (list)[k] = *values++

uint32_t fmu_model_state_count(const fmu_model *model) {
    return 6U + 2U * FMU_MODEL_OTHER_ARRAY_SIZE(model) + FMU_MODEL_ARRAY_SIZE(model);
}

static void copy_out(const fmu_moving *moving, const fmu_model *self, double *values) {
    EACH_LIST(COPY_OUT, moving, FMU_MODEL_OTHER_ARRAY_SIZE(self), FMU_MODEL_ARRAY_SIZE(self));
}

void fmu_model_get_states(fmu_instance *instance, double *values) {
    fmu_model_refresh(instance, FMU_GROUP_PLACE);
    copy_out(&instance->model.at, &instance->model, values);
}

void fmu_model_before_set_state(fmu_instance *instance) {
    fmu_model_refresh(instance, FMU_GROUP_PLACE);
    instance->model.stale = FMU_GROUPS_ALL & ~FMU_GROUP_PLACE;
}

void fmu_model_set_states(fmu_instance *instance, const double *values) {
    fmu_model *self = &instance->model;
    fmu_moving *moving = &self->at;
    EACH_LIST(COPY_IN, moving, FMU_MODEL_OTHER_ARRAY_SIZE(self), FMU_MODEL_ARRAY_SIZE(self));
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_PLACE;
}

void fmu_model_get_rates(fmu_instance *instance, double *values) {
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    copy_out(&instance->model.rate, &instance->model, values);
}

void fmu_model_get_nominals(const fmu_model *model, double *values) {
    for (uint32_t i = 0; i < fmu_model_state_count(model); i++) values[i] = 1.0;
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(model); i++) values[3 + FMU_MODEL_OTHER_ARRAY_SIZE(model) + i] = 10.0;
}

/* ------------------------------------------------------------------------ partial derivatives -- */

fmu_status fmu_model_check_tangent(const fmu_instance *instance) {
    return fmu_refuse(instance, "a vehicle with hinges has no derivatives of outputs yet; take differences of runs");
}

void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance;
    (void)tangent;
}

void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance;
    (void)tangent;
}

void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope) {
    *(double *)(void *)((char *)&model->slope + tangent_offset) = slope;
}
