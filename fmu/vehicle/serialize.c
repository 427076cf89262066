/* All members of the vehicle's fmu_model to and from bytes. Prepared constants are not stored but prepared again, which
 * gives the same bits. */
#include "parts.h"
#include "serialize_core.h"

static void serialize_vehicle(fmu_stream *s, laconic_vehicle *v) {
    LACONIC_VEHICLE_FIELDS(SERIALIZE, *v)
    LACONIC_PAYLOAD_FIELDS(SERIALIZE, v->payload)
    LACONIC_GROUND_FIELDS(SERIALIZE, v->ground)
    LACONIC_DRIVE_FIELDS(SERIALIZE, v->drive)
    fmu_stream_i32(s, &v->wheel_count, 0, LACONIC_MAX_WHEELS);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_FIELDS(SERIALIZE, v->wheel[i])
        LACONIC_OWN_WHEEL_FIELDS(SERIALIZE_OWN, v->wheel[i])
    }
    fmu_stream_i32(s, &v->support_count, INT32_MIN, INT32_MAX);
    for (int32_t i = 0; i < LACONIC_MAX_SUPPORTS; i++) {
        LACONIC_SUPPORT_FIELDS(SERIALIZE, v->support[i])
    }
}

static void serialize_start(fmu_stream *s, laconic_start *start) {
    LACONIC_START_ARRAY_FIELDS(SERIALIZE_ARRAY, *start)
    LACONIC_START_FIELDS(SERIALIZE, *start)
}

static void serialize_sensor_settings(fmu_stream *s, laconic_sensor_settings *settings) {
    LACONIC_IMU_FIELDS(SERIALIZE, settings->imu)
    LACONIC_IMU_ARRAY_FIELDS(SERIALIZE_ARRAY, settings->imu)
    fmu_stream_i32(s, &settings->encoder_wrap, INT32_MIN, INT32_MAX);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_WHEEL_ENCODER_FIELDS(SERIALIZE, settings->encoder[i])
    }
}

static void serialize_input(fmu_stream *s, laconic_input *u) {
    LACONIC_INPUT_ARRAY_FIELDS(SERIALIZE_ARRAY, *u)
    LACONIC_INPUT_FIELDS(SERIALIZE, *u)
}

static void serialize_state(fmu_stream *s, laconic_state *state) {
    serialize_sums(s, state->zeta, 3);
    serialize_sums(s, &state->x_m, 1);
    serialize_sums(s, &state->y_m, 1);
    serialize_heading(s, &state->heading);
    serialize_sums(s, state->travel, 3);
    fmu_stream_reals(s, state->wheel_angle_set_rad, LACONIC_MAX_WHEELS);
}

static void serialize_continuous(fmu_stream *s, fmu_model *self) {
    fmu_stream_reals(s, self->nu, 3);
    fmu_stream_reals(s, &self->x_m, 1);
    fmu_stream_reals(s, &self->y_m, 1);
    fmu_stream_reals(s, &self->heading_rad, 1);
    fmu_stream_reals(s, self->wheel_angle_rad, LACONIC_MAX_WHEELS);
    if (self->wheels_have_states) fmu_stream_reals(s, self->wheel_speed_rad_per_s, LACONIC_MAX_WHEELS);
}

/* After reading, outputs are stale. In Model Exchange the continuous states are not: they are stored, and `follows`
 * states whether the plant's state must still be computed from them. */
static void serialize_stale(fmu_stream *s, fmu_model *self) {
    bool follows = (self->stale & FMU_GROUP_STATE) != 0;
    fmu_stream_bool(s, &follows);
    if (s->from == NULL) return;
    if (follows && !self->continuous) s->failed = true;
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (self->continuous) self->stale &= ~FMU_GROUPS_OF_CONTINUOUS_STATES(self);
    if (follows) self->stale |= FMU_GROUP_STATE;
}

static int32_t method_number(const laconic_method *method) {
    for (int32_t number = 0; number < LACONIC_METHOD_COUNT; number++)
        if (laconic_method_by_number(number) == method) return number;
    return 0;
}

static void serialize_slip(fmu_stream *s, laconic_slip *slip) {
    const size_t wheels = LACONIC_SLIP_WHEELS;
    fmu_stream_reals(s, slip->wheel_speed_rad_per_s, wheels);
    serialize_sums(s, slip->wheel_angle_rad, wheels);
    fmu_stream_reals(s, &slip->grip_N[0][0], 2 * wheels);
    fmu_stream_reals(s, slip->normal_N, LACONIC_SLIP_POINTS);
    fmu_stream_reals(s, slip->current_A, wheels);
    for (size_t i = 0; i < wheels; i++) fmu_stream_i32(s, &slip->limit[i], LACONIC_LIMIT_NONE, LACONIC_LIMIT_CURRENT);
    fmu_stream_reals(s, &slip->supply_current_A, 1);
    fmu_stream_reals(s, &slip->supply_voltage_V, 1);
    serialize_sums(s, &slip->supply_energy_J, 1);
    serialize_sums(s, &slip->outer_work_J, 1);
    serialize_sums(s, &slip->slip_loss_J, 1);
    serialize_sums(s, &slip->axle_loss_J, 1);
    serialize_sums(s, &slip->motor_loss_J, 1);
    serialize_sums(s, &slip->supply_loss_J, 1);
    serialize_sums(s, &slip->numerical_loss_J, 1);
}

/* Its settings are those that it started with. */
static void serialize_sensors(fmu_stream *s, laconic_sensors *sensors, int32_t wheel_count) {
    serialize_sensor_settings(s, &sensors->settings);
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        fmu_stream_i64(s, &sensors->encoder[i].count);
        fmu_stream_reals(s, &sensors->encoder[i].rest, 1);
    }
    fmu_stream_reals(s, sensors->acceleration_m_per_s2, 2);
    fmu_stream_u64(s, &sensors->newest);
    for (size_t n = 0; n < sizeof sensors->sample / sizeof sensors->sample[0]; n++) {
        fmu_stream_reals(s, sensors->sample[n].specific_force_m_per_s2, 2);
        fmu_stream_reals(s, &sensors->sample[n].yaw_rate_rad_per_s, 1);
    }
    if (s->from != NULL && laconic_sensor_settings_check(&sensors->settings, wheel_count, NULL) != LACONIC_OK)
        s->failed = true;
}

/* Prepares model, integrator and contact from the vehicle, the method and the step that were in use. */
static bool prepare_again(fmu_model *self, int32_t number, double step_s) {
    laconic_plant *plant = &self->plant;
    const laconic_method *method = laconic_method_by_number(number);
    if (laconic_prepare(&plant->model, &plant->vehicle, NULL) != LACONIC_OK) return false;
    if (fmu_friction_prepare(&plant->vehicle, &self->contact, &self->rolling, NULL) != LACONIC_OK) return false;
    if (plant->vehicle.wheel_count != self->vehicle.wheel_count) return false;
    plant->friction.acts = false;
    if (laconic_vehicle_has_friction(&plant->vehicle) &&
        laconic_friction_of(&plant->friction, &plant->model, &plant->vehicle, NULL) != LACONIC_OK)
        return false;
    plant->integrator.method = self->stand_in && !plant->friction.acts ? &laconic_exact_flow : method;
    if (laconic_plant_set_step(plant, step_s, NULL) != LACONIC_OK) return false;
    plant->integrator.method = method;
    fmu_idle_motors_find(self);
    return true;
}

static void serialize_plant(fmu_stream *s, fmu_model *self) {
    int32_t method = method_number(self->plant.integrator.method);
    double step_s = self->plant.integrator.step_s;
    serialize_vehicle(s, &self->plant.vehicle);
    serialize_state(s, &self->plant.state);
    if (laconic_vehicle_has_friction(&self->plant.vehicle)) serialize_slip(s, &self->plant.slip);
    fmu_stream_u64(s, &self->plant.steps);
    fmu_stream_i32(s, &method, 0, LACONIC_METHOD_COUNT - 1);
    fmu_stream_reals(s, &step_s, 1);
    if (s->from == NULL || s->failed) return;
    self->plant.integrator.method = laconic_method_by_number(method);
    self->plant.integrator.step_s = step_s;
    if (!self->start_needed && !prepare_again(self, method, step_s)) s->failed = true;
}

#if FMU_MODEL_ESTIMATES

static void serialize_forcing(fmu_stream *s, laconic_forcing *forcing) {
    fmu_stream_reals(s, forcing->constant, 3);
    fmu_stream_reals(s, forcing->cosine, 3);
    fmu_stream_reals(s, forcing->sine, 3);
    fmu_stream_bool(s, &forcing->rotates);
}

/* Its error at the start of the window, and the window so far. */
static void serialize_window(fmu_stream *s, laconic_estimate *e) {
    const int32_t most = LACONIC_ESTIMATE_MOST;
    fmu_stream_reals(s, e->zeta, 3);
    fmu_stream_reals(s, e->travel, 3);
    fmu_stream_reals(s, e->place_m, 2);
    fmu_stream_reals(s, &e->floor_zeta, 1);
    fmu_stream_reals(s, &e->floor_travel, 1);
    fmu_stream_reals(s, &e->floor_path_m, 1);
    fmu_stream_reals(s, e->doubt_zeta, 3);
    fmu_stream_reals(s, e->doubt_travel, 3);
    fmu_stream_reals(s, &e->doubt_place_m, 1);
    fmu_stream_i32(s, &e->length, 0, most);
    fmu_stream_i32(s, &e->taken, 0, most);
    fmu_stream_i32(s, &e->last_length, 0, most);
    fmu_stream_bool(s, &e->begun);
    serialize_input(s, &e->input);
    serialize_state(s, &e->start);
    serialize_state(s, &e->twin);
    fmu_stream_reals(s, e->local, 8);
    fmu_stream_reals(s, &e->fading, 1);
    fmu_stream_reals(s, e->first_path_m, 2);
    serialize_forcing(s, &e->forcing);
    serialize_slip(s, &e->twin_slip);
}

/* What follows from the plant is prepared again. */
static void serialize_estimate(fmu_stream *s, fmu_model *self) {
    laconic_estimate *e = &self->estimate;
    fmu_stream_bool(s, &self->estimate_error);
    fmu_stream_i32(s, &self->estimate_window_steps, INT32_MIN, INT32_MAX);
    fmu_stream_bool(s, &self->estimate_begun);
    if (!self->estimate_begun || s->failed) return;
    if (s->from != NULL && !self->start_needed &&
        laconic_estimate_start(e, &self->plant, self->estimate_window_steps, laconic_finer_method(&self->plant),
                               NULL) != LACONIC_OK)
        s->failed = true;
    serialize_window(s, e);
    fmu_stream_reals(s, &e->largest.nu_rad_per_s, 4);
    fmu_stream_reals(s, e->origin_m, 2);
    fmu_stream_reals(s, &e->extent_m, 1);
    fmu_stream_u64(s, &e->unknown);
}

#endif

bool fmu_model_serialize(fmu_stream *stream, fmu_model *model) {
    fmu_stream_bool(stream, &model->start_needed);
    fmu_stream_bool(stream, &model->change_needed);
    fmu_stream_bool(stream, &model->states_changed);
    fmu_stream_bool(stream, &model->continuous);
    fmu_stream_bool(stream, &model->stand_in);
    fmu_stream_bool(stream, &model->wheels_have_states);
    fmu_stream_bool(stream, &model->watched);
    fmu_stream_reals(stream, &model->time_s, 1);
    serialize_vehicle(stream, &model->vehicle);
    serialize_start(stream, &model->start);
    fmu_stream_bool(stream, &model->has_imu);
    serialize_sensor_settings(stream, &model->sensor_settings);
    fmu_stream_i32(stream, &model->method, INT32_MIN, INT32_MAX);
    fmu_stream_reals(stream, &model->step_s, 1);
    serialize_input(stream, &model->input);
    fmu_stream_bool(stream, &model->sloped);
    serialize_input(stream, &model->slope);
    serialize_stale(stream, model);
    serialize_continuous(stream, model);
    serialize_plant(stream, model);
    if (model->watched) serialize_sensors(stream, &model->sensors, model->vehicle.wheel_count);
#if FMU_MODEL_KEEPS_STEPS
    fmu_stream_i32(stream, &model->last.kept, FMU_STEP_NONE, FMU_STEP_KINDS - 1);
    serialize_state(stream, &model->last.state);
    serialize_input(stream, &model->last.input);
    fmu_stream_reals(stream, &model->last.step_s, 1);
    fmu_stream_u64(stream, &model->last.steps);
#endif
#if FMU_MODEL_ESTIMATES
    serialize_estimate(stream, model);
#endif
    return !stream->failed;
}
