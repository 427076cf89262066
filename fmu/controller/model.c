/* The controller as an FMU model: a limited PI controller for the speed of each wheel. */
#include "model_interface.h"

/* The voltage before it is limited. */
static double wanted_V(const fmu_model *self, uint32_t i) {
    return self->proportional_Vs_per_rad * (self->setpoint_rad_per_s[i] - self->speed_rad_per_s[i]) +
           self->integral_V_per_rad * self->error_rad[i];
}

static bool is_limited(const fmu_model *self, uint32_t i) {
    const double wanted = wanted_V(self, i);
    return wanted > self->limit_V || wanted < -self->limit_V;
}

/* The integral stops while the voltage is limited and the error would drive it further beyond the limit. */
static bool is_held(const fmu_model *self, uint32_t i) {
    const double error = self->setpoint_rad_per_s[i] - self->speed_rad_per_s[i], wanted = wanted_V(self, i);
    return (wanted > self->limit_V && error > 0.0) || (wanted < -self->limit_V && error < 0.0);
}

static double limited_V(const fmu_model *self, uint32_t i) {
    const double wanted = wanted_V(self, i);
    return wanted > self->limit_V ? self->limit_V : wanted < -self->limit_V ? -self->limit_V : wanted;
}

static fmu_status check_values(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    if (!(self->limit_V > 0.0)) return fmu_refuse(instance, "voltage_limit_V: %g must be above 0", self->limit_V);
    if (!(self->proportional_Vs_per_rad >= 0.0))
        return fmu_refuse(instance, "proportional_gain_Vs_per_rad: %g must not be negative",
                          self->proportional_Vs_per_rad);
    if (!(self->integral_V_per_rad >= 0.0))
        return fmu_refuse(instance, "integral_gain_V_per_rad: %g must not be negative", self->integral_V_per_rad);
    return FMU_OK;
}

void fmu_model_made(fmu_model *model) { (void)model; /* all controllers have the same states */ }

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    const fmu_status status = check_values(instance);
    if (status != FMU_OK) return status;
    for (uint32_t i = 0; i < FMU_MODEL_LARGEST_ARRAY; i++) self->error_rad[i] = 0.0;
    self->start_needed = self->change_needed = false;
    self->stale = FMU_GROUPS_ALL;
    return FMU_OK;
}

fmu_status fmu_model_change(fmu_instance *instance) {
    const fmu_status status = check_values(instance);
    if (status != FMU_OK) return status;
    instance->model.change_needed = false;
    instance->model.stale = FMU_GROUPS_ALL;
    return FMU_OK;
}

void fmu_model_input_changed(fmu_instance *instance) { instance->model.stale = FMU_GROUPS_ALL; }

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    groups &= self->stale;
    self->stale &= ~groups;
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(self); i++) {
        if (groups & FMU_GROUP_VOLTAGE) self->voltage_V[i] = limited_V(self, i);
        if (groups & FMU_GROUP_RATES)
            self->error_rate_rad_per_s[i] =
                is_held(self, i) ? 0.0 : self->setpoint_rad_per_s[i] - self->speed_rad_per_s[i];
    }
}

double fmu_model_own_step(const fmu_model *model) {
    (void)model;
    return 0.0;
}

fmu_status fmu_model_set_step(fmu_instance *instance, double step_s) {
    instance->model.step_s = step_s;
    return FMU_OK;
}

/* A controller has no internal step of its own. */
fmu_status fmu_model_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps) {
    (void)instance;
    (void)step_s;
    (void)own_s;
    *steps = 1;
    return FMU_OK;
}

/* The inputs are held over the step, so the integral changes linearly. */
fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_model *self = &instance->model;
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(self); i++)
        self->error_rad[i] += (double)steps * self->step_s * self->error_rate_rad_per_s[i];
    self->stale = FMU_GROUPS_ALL;
    *taken = steps;
    return FMU_OK;
}

/* cannot be reached: a controller has no warnings */
void fmu_model_settle_warnings(fmu_instance *instance, bool accepted) {
    (void)instance;
    (void)accepted;
}

void fmu_model_completed_step(fmu_instance *instance) { (void)instance; /* a controller has no warnings */ }

void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion) {
    (void)model; /* a controller refuses no step, so that nothing is restored */
    (void)motion;
}

/* cannot be reached: a controller refuses no step */
void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion) {
    (void)model;
    (void)motion;
}

uint32_t fmu_model_state_count(const fmu_model *model) { return FMU_MODEL_ARRAY_SIZE(model); }

void fmu_model_get_states(fmu_instance *instance, double *values) {
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(&instance->model); i++) values[i] = instance->model.error_rad[i];
}

void fmu_model_set_states(fmu_instance *instance, const double *values) {
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(&instance->model); i++) instance->model.error_rad[i] = values[i];
    instance->model.stale = FMU_GROUPS_ALL;
}

void fmu_model_before_set_state(fmu_instance *instance) { instance->model.stale = FMU_GROUPS_ALL; }

void fmu_model_get_rates(fmu_instance *instance, double *values) {
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(&instance->model); i++)
        values[i] = instance->model.error_rate_rad_per_s[i];
}

void fmu_model_get_nominals(const fmu_model *model, double *values) {
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(model); i++) values[i] = 1.0;
}

/* The controller is linear; a limited voltage and a stopped integral are constant, so their derivatives are 0. */
fmu_status fmu_model_check_tangent(const fmu_instance *instance) {
    (void)instance;
    return FMU_OK;
}

void fmu_model_tangent(fmu_instance *instance, fmu_tangent *t) {
    const fmu_model *self = &instance->model;
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(self); i++) {
        const double error = t->setpoint_rad_per_s[i] - t->speed_rad_per_s[i];
        t->voltage_V[i] = is_limited(self, i)
                              ? 0.0
                              : self->proportional_Vs_per_rad * error + self->integral_V_per_rad * t->error_rad[i];
        t->error_rate_rad_per_s[i] = is_held(self, i) ? 0.0 : error;
    }
}

void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent) {
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(&instance->model); i++)
        tangent->error_rad[i] = instance->model.error_rate_rad_per_s[i];
}

/* cannot be reached: FMU_MODEL_TAKES_SLOPES is false, inputs are held */
void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope) {
    (void)model;
    (void)tangent_offset;
    (void)slope;
}

bool fmu_model_serialize(fmu_stream *stream, fmu_model *model) {
    fmu_stream_bool(stream, &model->start_needed);
    fmu_stream_bool(stream, &model->change_needed);
    fmu_stream_bool(stream, &model->states_changed);
    fmu_stream_reals(stream, &model->time_s, 1);
    fmu_stream_i32(stream, &model->wheel_count, 0, FMU_MODEL_LARGEST_ARRAY);
    fmu_stream_reals(stream, &model->proportional_Vs_per_rad, 1);
    fmu_stream_reals(stream, &model->integral_V_per_rad, 1);
    fmu_stream_reals(stream, &model->limit_V, 1);
    fmu_stream_reals(stream, model->setpoint_rad_per_s, FMU_MODEL_LARGEST_ARRAY);
    fmu_stream_reals(stream, model->speed_rad_per_s, FMU_MODEL_LARGEST_ARRAY);
    fmu_stream_reals(stream, model->error_rad, FMU_MODEL_LARGEST_ARRAY);
    fmu_stream_reals(stream, &model->step_s, 1);
    if (stream->from != NULL) model->stale = FMU_GROUPS_ALL;
    return !stream->failed;
}
