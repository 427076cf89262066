/* The vehicle with hinges on ground with friction as an FMU model: starts, changes, steps and stores the core's. */
#include "hinged_run.h"
#include "serialize_core.h"

void fmu_model_made(fmu_model *model) { (void)model; }

/* ------------------------------------------------------------------------- inputs without effect -- */

static const fmu_idle_input idle_inputs[] = {
    {"voltage_V", "V", "this wheel has no motor (wheel_undriven, or a motor gain of 0)"},
    {"hinge_voltage_V", "V", "this hinge has no motor (body_hinge, hinge_gain_Nm_per_V)"},
    {"hinge_torque_Nm", "N m", "this hinge is prescribed (body_hinge), whatever torque that takes"},
    {"steering_rate_rad_per_s", "rad/s", "this hinge is not prescribed, and no servo or loop takes a rate"},
    {"steering_angle_rad", "rad", "no servo or loop takes an angle (servo_gain_Nm_per_rad, loop_V_per_rad)"},
};

static void warn(fmu_instance *instance, unsigned kind, int32_t element, double value) {
    fmu_warn_idle(instance, &idle_inputs[kind], kind, element, value);
}

static void check_hinge(fmu_instance *instance, int32_t b) {
    const laconic_tree_model *m = &instance->model.prepared;
    const laconic_tree_input *u = &instance->model.input;
    const laconic_tree_body *link = &m->body[b + 1];
    const bool prescribed = link->hinge == LACONIC_HINGE_PRESCRIBED;
    const bool takes_angle = link->servo_gain_Nm_per_rad != 0.0 || link->loop_V_per_rad != 0.0;
    const bool takes_rate = prescribed || link->servo_damping_Nms != 0.0 || link->loop_Vs_per_rad != 0.0;
    if (m->motor[m->wheel_count + b].gain_Nm_per_V == 0.0) warn(instance, 1, b, u->hinged.hinge_voltage_V[b]);
    if (prescribed) warn(instance, 2, b, u->hinged.hinge_torque_Nm[b]);
    if (!takes_rate) warn(instance, 3, b, u->hinged.hinge_rate_rad_per_s[b]);
    if (!takes_angle) warn(instance, 4, b, u->hinge_angle_rad[b]);
}

static void check_idle(fmu_instance *instance) {
    const laconic_tree_model *m = &instance->model.prepared;
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->motor[i].gain_Nm_per_V == 0.0) warn(instance, 0, i, instance->model.input.hinged.base.voltage_V[i]);
    for (int32_t b = 0; b < m->body_count; b++) check_hinge(instance, b);
}

void fmu_model_input_changed(fmu_instance *instance) {
    if (instance->mode > FMU_INITIALIZATION) check_idle(instance);
}

/* --------------------------------------------------------------------------- start and changes -- */

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_refusal why = no_refusal();
    laconic_status status = laconic_tree_prepare(&self->prepared, &self->vehicle, &why);
    if (status == LACONIC_OK) status = laconic_tree_state_set(&self->state, &self->prepared, &self->start, &why);
    if (status != LACONIC_OK) return fmu_refuse_with(instance, &why, "this vehicle cannot start");
    self->in_use = self->vehicle;
    self->internal_step_s = self->step_s;
    self->start_needed = self->change_needed = false;
    self->stale = FMU_GROUPS_ALL;
    check_idle(instance);
    return FMU_OK;
}

/* The body keeps its motion where a payload moves the centre of mass to which position and velocity belong. */
static void carry_over(fmu_model *self, const laconic_tree_model *fresh) {
    laconic_tree_state *s = &self->state;
    const double dx = fresh->com_x_m - self->prepared.com_x_m, dy = fresh->com_y_m - self->prepared.com_y_m;
    double moved[2];
    if (dx == 0.0 && dy == 0.0) return;
    fmu_turn(moved, &s->heading, dx, dy);
    s->x_m.value += moved[0];
    s->y_m.value += moved[1];
    s->z[0] -= s->z[2] * dy;
    s->z[1] += s->z[2] * dx;
    s->body[0].x -= s->body[0].z * dy;
    s->body[0].y += s->body[0].z * dx;
}

fmu_status fmu_model_change(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_tree_model fresh;
    laconic_refusal why = no_refusal();
    if (laconic_tree_prepare(&fresh, &self->vehicle, &why) != LACONIC_OK)
        return fmu_refuse_with(instance, &why, "the change is refused");
    carry_over(self, &fresh);
    self->prepared = fresh;
    self->in_use = self->vehicle;
    self->change_needed = false;
    self->stale = FMU_GROUPS_ALL;
    return fmu_log(instance, FMU_OK, FMU_LOG_EVENTS,
                   "the vehicle changed: mass of all bodies %g kg, they keep velocity and position", fresh.mass_kg);
}

/* ------------------------------------------------------------------------------------- outputs -- */

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    const laconic_tree_model *m = &self->prepared;
    if ((groups & self->stale) == 0) return;
    laconic_tree_outputs_of(&self->out, m, &self->state);
    show_origin(self, &self->out.motion);
    self->solver_passes = self->state.passes;
    for (int32_t i = 0; i < m->wheel_count; i++) {
        self->contact_state[i] = self->out.contact_state[i];
        self->drive_limit[i] = self->out.drive_limit[i];
    }
    for (int32_t b = 0; b < m->body_count; b++) {
        self->hinge_current_A[b] = self->out.motor_current_A[m->wheel_count + b];
        self->hinge_drive_limit[b] = self->out.drive_limit[m->wheel_count + b];
    }
    for (int32_t k = m->wheel_count; k < m->point_count; k++)
        self->support_load_N[k - m->wheel_count] = self->out.normal_N[k];
    self->stale = 0;
}

/* --------------------------------------------------------------------------------------- steps -- */

double fmu_model_own_step(const fmu_model *model) { return model->step_s; }

fmu_status fmu_model_set_step(fmu_instance *instance, double step_s) {
    instance->model.internal_step_s = step_s;
    return FMU_OK;
}

static bool input_has_rates(const fmu_model *self) {
    (void)self;
    return false;
}

static laconic_status step(fmu_model *self, const laconic_tree_input *held, laconic_refusal *why) {
    return laconic_tree_step(&self->prepared, self->internal_step_s, &self->state, held, why);
}

static laconic_status step_held(fmu_model *self, laconic_refusal *why) { return step(self, &self->input, why); }

/* Each step has the input of its middle. */
static laconic_status step_moving(fmu_model *self, uint64_t before, laconic_refusal *why) {
    laconic_tree_input held;
    shift_by_slope(&held, self, ((double)before + 0.5) * self->internal_step_s);
    return step(self, &held, why);
}

static void end_after(fmu_model *self, uint64_t steps) {
    const laconic_tree_input none = {0};
    laconic_tree_input reached;
    shift_by_slope(&reached, self, (double)steps * self->internal_step_s);
    self->input = reached;
    self->slope = none;
}

static void mark_as_run(fmu_model *self) { self->stale = FMU_GROUPS_OF_STATE; }

/* ------------------------------------------------------------- no Model Exchange, no derivatives -- */

uint32_t fmu_model_state_count(const fmu_model *model) {
    (void)model;
    return 0;
}

void fmu_model_get_states(fmu_instance *instance, double *values) {
    (void)instance;
    (void)values;
}

void fmu_model_before_set_state(fmu_instance *instance) { (void)instance; }

void fmu_model_set_states(fmu_instance *instance, const double *values) {
    (void)instance;
    (void)values;
}

void fmu_model_get_rates(fmu_instance *instance, double *values) { fmu_model_get_states(instance, values); }

void fmu_model_get_nominals(const fmu_model *model, double *values) {
    (void)model;
    (void)values;
}

fmu_status fmu_model_check_tangent(const fmu_instance *instance) {
    return fmu_refuse(instance, "a vehicle with hinges has no derivatives of outputs yet; take differences of runs");
}

void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance;
    (void)tangent;
}

void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent) { fmu_model_tangent(instance, tangent); }

void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope) {
    *(double *)(void *)((char *)&model->slope + tangent_offset) = slope;
}

/* -------------------------------------------------------------------------------- saved states -- */

static void serialize_vehicle(fmu_stream *s, laconic_tree_vehicle *v) {
    serialize_hinged_vehicle(s, &v->hinged);
    LACONIC_DRIVE_FIELDS(SERIALIZE, v->hinged.base.drive)
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) {
        LACONIC_TREE_HINGE_FIELDS(SERIALIZE, v->hinge[b])
    }
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) {
        LACONIC_TREE_WHEEL_FIELDS(SERIALIZE, v->wheel[i])
    }
}

static void serialize_input(fmu_stream *s, laconic_tree_input *u) {
    serialize_hinged_input(s, &u->hinged);
    LACONIC_TREE_INPUT_FIELDS(SERIALIZE_ARRAY, *u)
}

static void serialize_motion(fmu_stream *s, laconic_tree_state *state) {
    serialize_sums(s, &state->x_m, 1);
    serialize_sums(s, &state->y_m, 1);
    serialize_heading(s, &state->heading);
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) serialize_heading(s, &state->hinge[b]);
    fmu_stream_reals(s, state->z, LACONIC_TREE_SPEEDS);
    fmu_stream_reals(s, &state->body[0].x, 3 * (LACONIC_MAX_BODIES + 1));
    fmu_stream_reals(s, state->wheel_speed_rad_per_s, LACONIC_MAX_WHEELS);
    serialize_sums(s, state->wheel_angle_rad, LACONIC_MAX_WHEELS);
}

static void serialize_forces(fmu_stream *s, laconic_tree_state *state) {
    fmu_stream_reals(s, &state->grip_N[0][0], 2 * LACONIC_MAX_WHEELS);
    fmu_stream_reals(s, state->scrub_Nm, LACONIC_MAX_WHEELS);
    fmu_stream_reals(s, state->dry_Nm, LACONIC_MAX_BODIES);
    fmu_stream_reals(s, &state->stop_Nm[0][0], 2 * LACONIC_MAX_BODIES);
    fmu_stream_reals(s, state->drive_Nm, LACONIC_MAX_BODIES);
    fmu_stream_reals(s, state->normal_N, LACONIC_TREE_POINTS);
    fmu_stream_reals(s, state->control_command, LACONIC_MAX_BODIES);
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) serialize_integer(s, &state->control_wait[b]);
    fmu_stream_reals(s, state->motor_torque_Nm, LACONIC_TREE_AXES);
    fmu_stream_reals(s, state->current_A, LACONIC_TREE_AXES);
    for (int32_t k = 0; k < LACONIC_TREE_AXES; k++) fmu_stream_i32(s, &state->limit[k], 0, 2);
    serialize_integer(s, &state->passes);
}

static void serialize_books(fmu_stream *s, laconic_tree_state *state) {
    fmu_stream_reals(s, &state->supply_current_A, 1);
    fmu_stream_reals(s, &state->supply_voltage_V, 1);
    fmu_stream_reals(s, &state->spring_energy_J, 1);
    serialize_sums(s, &state->supply_energy_J, 1);
    serialize_sums(s, &state->outer_work_J, 1);
    serialize_sums(s, &state->servo_work_J, 1);
    serialize_sums(s, &state->slip_loss_J, 1);
    serialize_sums(s, &state->scrub_loss_J, 1);
    serialize_sums(s, &state->axle_loss_J, 1);
    serialize_sums(s, &state->hinge_loss_J, 1);
    serialize_sums(s, &state->stop_loss_J, 1);
    serialize_sums(s, &state->motor_loss_J, 1);
    serialize_sums(s, &state->supply_loss_J, 1);
    serialize_sums(s, &state->numerical_loss_J, 1);
}

/* Prepares the model from the vehicle that was in use, which gives the same bits. After reading, outputs are stale. */
static void prepare_again(fmu_stream *s, fmu_model *self) {
    const laconic_articulated_vehicle *used = &self->in_use.hinged, *now = &self->vehicle.hinged;
    if (s->from == NULL) return;
    self->stale = FMU_GROUPS_ALL;
    if (s->failed || self->start_needed) return;
    s->failed = used->base.wheel_count != now->base.wheel_count || used->body_count != now->body_count ||
                laconic_tree_prepare(&self->prepared, &self->in_use, NULL) != LACONIC_OK;
}

bool fmu_model_serialize(fmu_stream *stream, fmu_model *model) {
    fmu_stream_bool(stream, &model->start_needed);
    fmu_stream_bool(stream, &model->change_needed);
    fmu_stream_bool(stream, &model->states_changed);
    fmu_stream_reals(stream, &model->time_s, 1);
    serialize_vehicle(stream, &model->vehicle);
    serialize_hinged_start(stream, &model->start.hinged);
    fmu_stream_reals(stream, model->start.wheel_speed_rad_per_s, LACONIC_MAX_WHEELS);
    fmu_stream_bool(stream, &model->start.wheels_stand);
    fmu_stream_reals(stream, &model->step_s, 1);
    serialize_input(stream, &model->input);
    serialize_input(stream, &model->slope);
    serialize_vehicle(stream, &model->in_use);
    fmu_stream_reals(stream, &model->internal_step_s, 1);
    serialize_motion(stream, &model->state);
    serialize_forces(stream, &model->state);
    serialize_books(stream, &model->state);
    prepare_again(stream, model);
    return !stream->failed;
}
