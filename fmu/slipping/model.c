/* The vehicle with hinges on ground with friction as an FMU model: starts, changes, steps and stores the core's. */
#include <string.h>

#include "core_words.h"
#include "serialize_core.h"

/* Internal steps between two looks at whether the importer cancels them: well below a second. */
#define SLICE_STEPS 64U

/* These do not compile unless the core computes in double, kinds can be read as an int32_t and inputs are numbers. */
typedef char fmu_core_is_double[sizeof(laconic_real) == sizeof(double) ? 1 : -1];
typedef char fmu_kinds_are_int32
    [sizeof(laconic_hinge_kind) == sizeof(int32_t) && sizeof(laconic_wheel_kind) == sizeof(int32_t) ? 1 : -1];
typedef char fmu_input_is_all_doubles[sizeof(laconic_tree_input) % sizeof(double) == 0 ? 1 : -1];

static laconic_refusal no_refusal(void) {
    const laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    return why;
}

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

static void show_origin(fmu_model *self) {
    const laconic_articulated_motion *motion = &self->out.motion;
    double from_origin[2];
    fmu_turn(from_origin, &self->state.heading, self->prepared.com_x_m, self->prepared.com_y_m);
    self->origin_m[0] = motion->x_m - from_origin[0];
    self->origin_m[1] = motion->y_m - from_origin[1];
    self->heading_wrapped_rad = laconic_angle_wrapped(motion->heading_rad);
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    const laconic_tree_model *m = &self->prepared;
    if ((groups & self->stale) == 0) return;
    laconic_tree_outputs_of(&self->out, m, &self->state);
    show_origin(self);
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

/* The input `by_s` later, by the slopes of FMI 2. */
static void shift_input(laconic_tree_input *out, const fmu_model *self, double by_s) {
    const double *u = (const double *)&self->input, *du = (const double *)&self->slope;
    double *shifted = (double *)out;
    for (size_t k = 0; k < sizeof *out / sizeof(double); k++) shifted[k] = u[k] + by_s * du[k];
}

static bool input_moves(const fmu_model *self) {
    const double *du = (const double *)&self->slope;
    bool moves = false;
    for (size_t k = 0; k < sizeof self->slope / sizeof(double); k++) moves = moves || du[k] != 0.0;
    return moves;
}

static laconic_status step(fmu_model *self, const laconic_tree_input *held, laconic_refusal *why) {
    return laconic_tree_step(&self->prepared, self->internal_step_s, &self->state, held, why);
}

/* Each step has the input of its middle. Slopes hold for one communication step. */
static laconic_status run_moving(fmu_instance *instance, uint64_t steps, uint64_t *taken, laconic_refusal *why) {
    fmu_model *self = &instance->model;
    const double h = self->internal_step_s;
    const laconic_tree_input none = {0};
    laconic_tree_input held;
    for (*taken = 0; *taken < steps && !instance->cancelled; ++*taken) {
        shift_input(&held, self, ((double)*taken + 0.5) * h);
        const laconic_status status = step(self, &held, why);
        if (status != LACONIC_OK) return status;
    }
    shift_input(&held, self, (double)steps * h);
    self->input = held;
    self->slope = none;
    return LACONIC_OK;
}

static laconic_status run_held(fmu_instance *instance, uint64_t steps, uint64_t *taken, laconic_refusal *why) {
    fmu_model *self = &instance->model;
    for (*taken = 0; *taken < steps && (*taken % SLICE_STEPS != 0 || !instance->cancelled); ++*taken) {
        const laconic_status status = step(self, &self->input, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_model *self = &instance->model;
    laconic_refusal why = no_refusal();
    const laconic_status status =
        input_moves(self) ? run_moving(instance, steps, taken, &why) : run_held(instance, steps, taken, &why);
    self->stale = FMU_GROUPS_ALL;
    return status == LACONIC_OK ? FMU_OK : fmu_discard_with(instance, &why);
}

void fmu_model_settle_warnings(fmu_instance *instance, bool accepted) {
    (void)instance;
    (void)accepted; /* steps of such a vehicle have no warnings */
}

void fmu_model_completed_step(fmu_instance *instance) { (void)instance; }

void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion) {
    motion->state = model->state;
    motion->input = model->input;
    motion->slope = model->slope;
}

void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion) {
    model->state = motion->state;
    model->input = motion->input;
    model->slope = motion->slope;
    model->stale = FMU_GROUPS_ALL;
}

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
