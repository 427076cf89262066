/* All members of the fmu_model of a vehicle with hinges to and from bytes. Prepared constants are not stored but
 * prepared again, which gives the same bits. */
#include "parts.h"
#include "serialize_core.h"

static void serialize_state(fmu_stream *s, laconic_articulated_state *state) {
    serialize_sums(s, state->eta, LACONIC_MAX_VELOCITIES);
    serialize_sums(s, &state->x_m, 1);
    serialize_sums(s, &state->y_m, 1);
    serialize_heading(s, &state->heading);
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) serialize_heading(s, &state->hinge[b]);
    serialize_sums(s, &state->travel[0][0], 3 * (LACONIC_MAX_BODIES + 1));
    fmu_stream_reals(s, state->wheel_angle_set_rad, LACONIC_MAX_WHEELS);
    fmu_stream_reals(s, state->hinge_rate_rad_per_s, LACONIC_MAX_BODIES);
    fmu_stream_reals(s, &state->twist.x, sizeof state->twist / sizeof(double));
    fmu_stream_reals(s, &state->twist_rate.x, sizeof state->twist_rate / sizeof(double));
}

/* After reading, outputs are stale. In Model Exchange the continuous states are not: they are stored, and `follows`
 * states whether the core's state must still be computed from them. */
static void serialize_stale(fmu_stream *s, fmu_model *self) {
    bool follows = (self->stale & FMU_GROUP_STATE) != 0;
    fmu_stream_bool(s, &follows);
    if (s->from == NULL) return;
    if (follows && !self->continuous) s->failed = true;
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (self->continuous) self->stale &= ~FMU_GROUP_PLACE;
    if (follows) self->stale |= FMU_GROUP_STATE;
}

/* Prepares model and integrator from the vehicle and the step that were in use. */
static void prepare_again(fmu_stream *s, fmu_model *self, double step_s) {
    if (s->from == NULL || s->failed || self->start_needed) return;
    if (self->in_use.base.wheel_count != self->vehicle.base.wheel_count ||
        self->in_use.body_count != self->vehicle.body_count ||
        laconic_articulated_prepare(&self->prepared, &self->in_use, NULL) != LACONIC_OK)
        s->failed = true;
    if (s->failed || step_s == 0.0) return;
    if (laconic_articulated_integrator_prepare(&self->integrator, self->method, &self->prepared, step_s, NULL) !=
        LACONIC_OK)
        s->failed = true;
}

bool fmu_model_serialize(fmu_stream *stream, fmu_model *model) {
    double step_s = model->integrator.step_s;
    fmu_stream_bool(stream, &model->start_needed);
    fmu_stream_bool(stream, &model->change_needed);
    fmu_stream_bool(stream, &model->states_changed);
    fmu_stream_bool(stream, &model->continuous);
    fmu_stream_bool(stream, &model->jump_needed);
    fmu_stream_reals(stream, &model->time_s, 1);
    serialize_hinged_vehicle(stream, &model->vehicle);
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) fmu_stream_bool(stream, &model->hinge_is_ball[b]);
    serialize_hinged_start(stream, &model->start);
    serialize_integer(stream, &model->method);
    fmu_stream_reals(stream, &model->step_s, 1);
    serialize_hinged_input(stream, &model->input);
    serialize_hinged_input(stream, &model->slope);
    serialize_stale(stream, model);
    fmu_stream_reals(stream, &model->at.x_m, sizeof model->at / sizeof(double));
    serialize_hinged_vehicle(stream, &model->in_use);
    serialize_state(stream, &model->state);
    serialize_hinged_input(stream, &model->commanded);
    fmu_stream_reals(stream, &step_s, 1);
    prepare_again(stream, model, step_s);
    return !stream->failed;
}
