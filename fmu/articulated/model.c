/* The vehicle with hinges as an FMU model: starts, changes and steps the core's articulated vehicle. */
#include <string.h>

#include "hinged_run.h"
#include "parts.h"

void fmu_model_made(fmu_model *model) { (void)model; /* all vehicles have the same states */ }

/* ------------------------------------------------------------------------- inputs without effect -- */

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

static void check_idle(fmu_instance *instance) {
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

/* ------------------------------------------------------------------------------------- start -- */

/* Without step_s, Co-Simulation knows its internal step only at its first communication step, Model Exchange never. */
static laconic_status prepare(fmu_model *self, laconic_refusal *why) {
    const bool knows_step = self->step_s != 0.0 && !self->continuous;
    const laconic_status status = laconic_articulated_prepare(&self->prepared, &self->vehicle, why);
    if (status != LACONIC_OK || !knows_step) return status;
    return laconic_articulated_integrator_prepare(&self->integrator, self->method, &self->prepared, self->step_s, why);
}

static void mark_as_started(fmu_model *self) {
    self->in_use = self->vehicle;
    self->commanded = self->input;
    self->start_needed = self->change_needed = self->jump_needed = false;
    self->stale = FMU_GROUPS_OF_STATE;
}

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_refusal why = no_refusal();
    bool allowed;
    self->continuous = instance->kind == FMU_MODEL_EXCHANGE;
    laconic_status status = prepare(self, &why);
    if (status == LACONIC_OK) status = fmu_articulated_start(self, &allowed, &why);
    if (status != LACONIC_OK) return fmu_refuse_with(instance, &why, "this vehicle cannot start");
    if (!allowed) return fmu_articulated_refuse_start(instance);
    mark_as_started(self);
    check_idle(instance);
    if (self->continuous) fmu_model_refresh(instance, FMU_GROUP_PLACE);
    return FMU_OK;
}

/* ------------------------------------------------------------------------------------ changes -- */

/* Where the body frame's origin is, and how fast: both stay when a payload moves the centre of mass. */
static void carry_over(laconic_articulated_start *start, fmu_model *self, const laconic_articulated_model *fresh) {
    const laconic_articulated_motion *m = &self->motion;
    const double dx = fresh->com_x_m - self->prepared.com_x_m, dy = fresh->com_y_m - self->prepared.com_y_m;
    double moved[2];
    fmu_turn(moved, &self->state.heading, dx, dy);
    start->velocity_m_per_s[0] = m->velocity_m_per_s[0] - m->yaw_rate_rad_per_s * dy;
    start->velocity_m_per_s[1] = m->velocity_m_per_s[1] + m->yaw_rate_rad_per_s * dx;
    start->yaw_rate_rad_per_s = m->yaw_rate_rad_per_s;
    start->x_m = m->x_m + moved[0];
    start->y_m = m->y_m + moved[1];
    start->heading_rad = m->heading_rad;
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) {
        start->hinge_angle_rad[b] = b < fresh->body_count ? m->hinge_angle_rad[b] : 0.0;
        start->hinge_rate_rad_per_s[b] = b < fresh->body_count ? m->hinge_rate_rad_per_s[b] : 0.0;
    }
}

static laconic_status change_vehicle(fmu_model *self, laconic_refusal *why) {
    laconic_articulated_model fresh;
    laconic_articulated_integrator integrator = self->integrator;
    laconic_articulated_state state;
    laconic_articulated_start start;
    laconic_status status = laconic_articulated_prepare(&fresh, &self->vehicle, why);
    if (status == LACONIC_OK && integrator.step_s > 0.0)
        status = laconic_articulated_integrator_prepare(&integrator, self->method, &fresh, integrator.step_s, why);
    if (status != LACONIC_OK) return status;
    laconic_articulated_motion_of(&self->motion, &self->prepared, &self->state);
    carry_over(&start, self, &fresh);
    status = laconic_articulated_state_set(&state, NULL, &fresh, &start, &self->commanded, why);
    if (status != LACONIC_OK) return status;
    laconic_articulated_wheel_angles_set(&fresh, &state, self->motion.wheel_angle_rad);
    self->state = state;
    self->prepared = fresh;
    self->integrator = integrator;
    self->in_use = self->vehicle;
    return LACONIC_OK;
}

/* In Model Exchange commands that were set in event mode jump; the momenta along the allowed motions are kept. */
static laconic_status jump(fmu_model *self, laconic_refusal *why) {
    const laconic_status status = laconic_articulated_jump(&self->prepared, &self->state, &self->input, why);
    if (status == LACONIC_OK) self->commanded = self->input;
    return status;
}

fmu_status fmu_model_change(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_refusal why = no_refusal();
    laconic_status status = LACONIC_OK;
    const bool changes = memcmp(&self->vehicle, &self->in_use, sizeof self->vehicle) != 0;
    if (self->stale & FMU_GROUP_STATE) status = fmu_articulated_take_state(self, &self->commanded, &why);
    if (status == LACONIC_OK && changes) status = change_vehicle(self, &why);
    if (status == LACONIC_OK && self->jump_needed) status = jump(self, &why);
    if (status != LACONIC_OK) return fmu_refuse_with(instance, &why, "the change is refused");
    self->change_needed = self->jump_needed = false;
    self->stale = FMU_GROUPS_OF_STATE;
    if (self->continuous) fmu_model_refresh(instance, FMU_GROUP_PLACE);
    if (!changes) return FMU_OK;
    return fmu_log(instance, FMU_OK, FMU_LOG_EVENTS,
                   "the vehicle changed: mass of the carriage %g kg, its body keeps velocity and position",
                   self->prepared.mass_kg);
}

static bool commands_differ(const laconic_articulated_input *a, const laconic_articulated_input *b) {
    bool differ = false;
    for (int k = 0; k < LACONIC_MAX_BODIES; k++)
        differ = differ || a->hinge_rate_rad_per_s[k] != b->hinge_rate_rad_per_s[k];
    for (int k = 0; k < 3; k++) differ = differ || a->twist[k] != b->twist[k] || a->twist_rate[k] != b->twist_rate[k];
    return differ;
}

/* Commands of the initialization are those of the start. In Co-Simulation a step sees by itself that they jump. */
void fmu_model_input_changed(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    if (instance->mode <= FMU_INITIALIZATION) {
        self->start_needed = true;
        return;
    }
    self->stale |= FMU_GROUPS_OF_INPUT;
    check_idle(instance);
    if (!self->continuous || !commands_differ(&self->input, &self->commanded)) return;
    if (instance->mode == FMU_EVENT)
        self->change_needed = self->jump_needed = true;
    else
        self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_PLACE; /* the same continuous states are another motion */
}

/* ------------------------------------------------------------------------------------ outputs -- */

static void fill(void *numbers, size_t size, double value) {
    for (size_t k = 0; k < size / sizeof value; k++) ((double *)numbers)[k] = value;
}

/* Where a posture has no motion, outputs are no numbers, and reading them is refused. */
static void show_nothing(fmu_instance *instance, const laconic_refusal *why, uint32_t groups) {
    fmu_model *self = &instance->model;
    const double zero = 0.0, nan = zero / zero;
    (void)fmu_refuse_with(instance, why, "this posture has no motion");
    if (groups & FMU_GROUP_RATES) fill(&self->rate, sizeof self->rate, nan);
    if (groups & FMU_GROUP_GROUND) fill(&self->ground, sizeof self->ground, nan);
    if (groups & FMU_GROUP_STATE) fill(&self->motion, sizeof self->motion, nan);
}

/* An acceleration a shifts the weight of a carriage of height z by −a z/g. */
static laconic_status find_shift(double shift_m[2], const fmu_model *self, laconic_refusal *why) {
    const double height_m = self->in_use.base.com_z_m, per_m = -height_m / LACONIC_GRAVITY_M_PER_S2;
    laconic_articulated_rates rates;
    shift_m[0] = shift_m[1] = 0.0;
    if (!(height_m > 0.0)) return LACONIC_OK;
    const laconic_status status =
        laconic_articulated_rates_of(&rates, &self->prepared, &self->state, &self->input, why);
    if (status != LACONIC_OK) return status;
    const laconic_vector *speed = &rates.twist[0], *rate = &rates.twist_rate[0];
    const double ahead = rate->x - speed->z * speed->y, aside = rate->y + speed->z * speed->x;
    fmu_turn(shift_m, &self->state.heading, per_m * ahead, per_m * aside);
    return LACONIC_OK;
}

static laconic_status refresh_ground(fmu_model *self, laconic_refusal *why) {
    laconic_articulated_reactions *r = &self->ground;
    double shift_m[2];
    laconic_status status = find_shift(shift_m, self, why);
    if (status != LACONIC_OK) return status;
    fmu_articulated_loads(self, shift_m);
    status = laconic_articulated_reactions_of(r, &self->prepared, &self->state, &self->input, self->wheel_load_N, why);
    for (int32_t b = 0; status == LACONIC_OK && b < self->prepared.body_count; b++) {
        self->hinge_force_along_N[b] = r->hinge_force_N[b][0];
        self->hinge_force_across_N[b] = r->hinge_force_N[b][1];
    }
    return status;
}

/* Needs `motion`. */
static laconic_status refresh_rates(fmu_model *self, laconic_refusal *why) {
    const laconic_articulated_model *m = &self->prepared;
    const laconic_articulated_motion *motion = &self->motion;
    laconic_articulated_rates rates;
    double velocity[2];
    const laconic_status status = laconic_articulated_rates_of(&rates, m, &self->state, &self->input, why);
    if (status != LACONIC_OK) return status;
    fmu_turn(velocity, &self->state.heading, motion->velocity_m_per_s[0], motion->velocity_m_per_s[1]);
    self->rate.x_m = velocity[0];
    self->rate.y_m = velocity[1];
    self->rate.heading_rad = motion->yaw_rate_rad_per_s;
    for (int32_t k = 0; k < 3; k++) self->rate.zeta[k] = k < m->carriage_dof ? rates.eta_rate[k] : 0.0;
    for (int32_t b = 0; b < m->body_count; b++) {
        const bool is_own = m->link[b].motion == LACONIC_MOTION_OWN;
        self->rate.hinge_rad[b] = motion->hinge_rate_rad_per_s[b];
        self->rate.own[b] = is_own ? rates.eta_rate[m->carriage_dof + m->link[b].column] : 0.0;
    }
    for (int32_t i = 0; i < m->wheel_count; i++) self->rate.wheel_angle_rad[i] = motion->wheel_speed_rad_per_s[i];
    return LACONIC_OK;
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    laconic_refusal why = no_refusal();
    laconic_status status = LACONIC_OK;
    groups &= self->stale;
    if (groups == 0) return;
    if (self->stale & FMU_GROUP_STATE) {
        status = fmu_articulated_take_state(self, &self->input, &why);
        self->commanded = self->input;
        groups |= FMU_GROUP_STATE;
    }
    if (groups & (FMU_GROUP_PLACE | FMU_GROUP_MOTION | FMU_GROUP_RATES))
        laconic_articulated_motion_of(&self->motion, &self->prepared, &self->state);
    if (groups & FMU_GROUP_PLACE) fmu_articulated_show_state(self);
    if (groups & FMU_GROUP_MOTION) show_origin(self, &self->motion);
    if (status == LACONIC_OK && groups & FMU_GROUP_GROUND) status = refresh_ground(self, &why);
    if (status == LACONIC_OK && groups & FMU_GROUP_RATES) status = refresh_rates(self, &why);
    if (status != LACONIC_OK) show_nothing(instance, &why, groups);
    self->stale &= ~groups;
}

/* -------------------------------------------------------------------------------------- steps -- */

double fmu_model_own_step(const fmu_model *model) { return model->step_s; }

fmu_status fmu_model_set_step(fmu_instance *instance, double step_s) {
    fmu_model *self = &instance->model;
    laconic_articulated_integrator integrator;
    laconic_refusal why = no_refusal();
    if (laconic_articulated_integrator_prepare(&integrator, self->method, &self->prepared, step_s, &why) != LACONIC_OK)
        return fmu_discard_with(instance, &why);
    self->integrator = integrator;
    return FMU_OK;
}

static bool input_has_rates(const fmu_model *self) {
    const laconic_articulated_input *u = &self->input;
    return any_is_not_0(u->hinge_acceleration_rad_per_s2, LACONIC_MAX_BODIES) || any_is_not_0(u->twist_rate, 3);
}

/* The input `by_s` later: by its slopes, and the derivatives of rates and twist. */
static void shift_input(laconic_articulated_input *out, const fmu_model *self, double by_s) {
    shift_by_slope(out, self, by_s);
    for (int b = 0; b < LACONIC_MAX_BODIES; b++) {
        out->hinge_rate_rad_per_s[b] += by_s * self->input.hinge_acceleration_rad_per_s2[b];
        out->hinge_acceleration_rad_per_s2[b] += self->slope.hinge_rate_rad_per_s[b];
    }
    for (int k = 0; k < 3; k++) {
        out->twist[k] += by_s * self->input.twist_rate[k];
        out->twist_rate[k] += self->slope.twist[k];
    }
}

static laconic_status step(fmu_model *self, const laconic_articulated_input *from, const laconic_articulated_input *to,
                           laconic_refusal *why) {
    return laconic_articulated_step(&self->prepared, &self->integrator, &self->state, from, to, why);
}

static laconic_status step_held(fmu_model *self, laconic_refusal *why) {
    return step(self, &self->input, &self->input, why);
}

static laconic_status step_moving(fmu_model *self, uint64_t before, laconic_refusal *why) {
    const double h = self->integrator.step_s;
    laconic_articulated_input from, to;
    shift_input(&from, self, (double)before * h);
    shift_input(&to, self, (double)(before + 1) * h);
    return step(self, &from, &to, why);
}

/* The derivatives of rates and twist stay as they were set. */
static void end_after(fmu_model *self, uint64_t steps) {
    const laconic_articulated_input none = {0}, before = self->input;
    laconic_articulated_input reached;
    shift_input(&reached, self, (double)steps * self->integrator.step_s);
    self->input = reached;
    for (int b = 0; b < LACONIC_MAX_BODIES; b++)
        self->input.hinge_acceleration_rad_per_s2[b] = before.hinge_acceleration_rad_per_s2[b];
    for (int k = 0; k < 3; k++) self->input.twist_rate[k] = before.twist_rate[k];
    self->slope = none;
}

static void mark_as_run(fmu_model *self) {
    self->commanded = self->input;
    self->stale = FMU_GROUPS_OF_STATE;
}
