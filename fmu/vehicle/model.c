/* The vehicle as an FMU model: starts and steps the core's plant, and computes outputs when they are read. The
 * project's modelDescription.xml declares its variables; variable_locations.h says where each stands. */
#include "core_words.h"
#include "model_interface.h"
#include "parts.h"

/* Internal steps between two looks at whether the importer cancels them: well below a second. */
#define SLICE_STEPS 1024U

/* These do not compile unless the core computes in double and a wheel_kind can be read as an int32_t. */
typedef char fmu_core_is_double[sizeof(laconic_real) == sizeof(double) ? 1 : -1];
typedef char fmu_kind_is_int32[sizeof(laconic_wheel_kind) == sizeof(int32_t) ? 1 : -1];

void fmu_model_made(fmu_model *model) { model->wheels_have_states = fmu_vehicle_slips(&model->vehicle); }

/* Without step_s, Co-Simulation knows its internal step only at its first communication step, and Model Exchange never.
 * Until then the integrator is prepared for a method that accepts every step; a vehicle with friction has one
 * method only, which does. */
static laconic_status start_plant(fmu_model *self, laconic_refusal *why) {
    const laconic_method *method = laconic_method_by_number(self->method);
    const bool known = self->step_s > 0.0 && !self->continuous;
    const bool any_step = known || laconic_vehicle_has_friction(&self->vehicle);
    if (method == NULL || self->step_s < 0.0) /* the core refuses both and gives the reason */
        return laconic_plant_start(&self->plant, &self->vehicle, method, self->step_s, &self->start, why);
    const laconic_status status =
        laconic_plant_start(&self->plant, &self->vehicle, any_step ? method : &laconic_exact_flow,
                            known ? self->step_s : 1.0, &self->start, why);
    self->stand_in = !known;
    if (status == LACONIC_OK && !known) self->plant.integrator.method = method;
    return status;
}

fmu_status fmu_model_start(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    self->continuous = instance->kind == FMU_MODEL_EXCHANGE;
    laconic_status status = start_plant(self, &why);
    if (status == LACONIC_OK) status = fmu_friction_prepare(&self->vehicle, &self->contact, &self->rolling, &why);
    if (status == LACONIC_OK) fmu_sensors_find(self);
    if (status == LACONIC_OK) status = fmu_sensors_start(self, &why);
    if (FMU_MODEL_ESTIMATES && status == LACONIC_OK) status = fmu_estimate_start(self, &why);
    if (status != LACONIC_OK) return fmu_refuse_with(instance, &why, "this vehicle cannot start");
    if ((self->continuous && fmu_friction_refuses(instance, &self->vehicle)) || fmu_sensors_refuse(instance))
        return FMU_ERROR;
    if (FMU_MODEL_ESTIMATES && fmu_estimate_refuses(instance)) return FMU_ERROR;
    self->start_needed = self->change_needed = false;
    fmu_idle_motors_find(self);
    fmu_model_input_changed(instance);
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (self->continuous) fmu_model_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES(self));
    return FMU_OK;
}

/* Ground that gets friction during the run is watched from now on; sensors that have watched go on. */
static void watch_change(fmu_model *self) {
    const bool before = self->watched;
    laconic_refusal why;
    fmu_sensors_find(self);
    if (!before) (void)fmu_sensors_start(self, &why); /* cannot be refused: without sensors all settings are 0 */
}

fmu_status fmu_model_change(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    laconic_plant plant;
    laconic_contact contact;
    laconic_model rolling = self->rolling;
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    if (self->continuous && fmu_friction_refuses(instance, &self->vehicle)) return FMU_ERROR;
    fmu_model_refresh(instance, FMU_GROUP_STATE);
    plant = self->plant;
    if (self->stand_in && !laconic_vehicle_has_friction(&self->vehicle)) plant.integrator.method = &laconic_exact_flow;
    laconic_status status = laconic_plant_change(&plant, &self->vehicle, &why);
    if (status == LACONIC_OK) status = fmu_friction_prepare(&self->vehicle, &contact, &rolling, &why);
    if (FMU_MODEL_ESTIMATES && status == LACONIC_OK) status = fmu_estimate_change(self, &plant, &why);
    if (status != LACONIC_OK) return fmu_refuse_with(instance, &why, "the changed vehicle is refused");
    plant.integrator.method = self->plant.integrator.method;
    self->plant = plant;
    self->contact = contact;
    self->rolling = rolling;
    self->change_needed = false;
    if (FMU_MODEL_KEEPS_STEPS) fmu_model_spoil_step(self, FMU_STEP_CHANGED);
    watch_change(self);
    fmu_idle_motors_find(self);
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (self->continuous) fmu_model_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES(self));
    return fmu_log(instance, FMU_OK, FMU_LOG_EVENTS,
                   "the vehicle changed: mass %g kg, its body keeps velocity and position", plant.model.mass_kg);
}

void fmu_model_input_changed(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    self->stale |= FMU_GROUPS_OF_INPUT;
    if (FMU_MODEL_KEEPS_STEPS && instance->mode == FMU_INTERMEDIATE) fmu_model_spoil_step(self, FMU_STEP_TOUCHED);
    if (self->idle_wheels && !self->start_needed) fmu_idle_motors_check(instance);
}

/* ---------------------------------------------------------------------------------- outputs -- */

static void refresh_state(fmu_model *self) {
    laconic_start motion = {{self->nu[0], self->nu[1], self->nu[2]}, self->x_m, self->y_m, self->heading_rad, {0.0}};
    if (fmu_friction_rolls(self)) fmu_friction_project(self, motion.nu_rad_per_s);
    /* cannot be refused: fmu_set_states has already refused every number that would be */
    (void)laconic_state_project(&self->plant.state, &self->plant.model, &motion, NULL);
    if (self->plant.friction.acts)
        fmu_friction_set_wheels(self);
    else
        laconic_wheel_angles_set(&self->plant.model, &self->plant.state, self->wheel_angle_rad);
}

/* The groups about wheels, ground and energy where the wheels follow from ν. */
static void refresh_ideal(fmu_model *self, uint32_t groups) {
    const laconic_model *m = &self->plant.model;
    const laconic_state *s = &self->plant.state;
    if (groups & FMU_GROUP_ANGLES) laconic_wheel_angles(m, s, self->wheel_angle_rad);
    if (groups & FMU_GROUP_SPEEDS) laconic_wheel_speeds(m, s, self->wheel_speed_rad_per_s);
    if (groups & FMU_GROUP_TORQUES) laconic_wheel_torques(m, s, &self->input, self->wheel_torque_Nm);
    if (groups & FMU_GROUP_GROUND) laconic_reactions_of(&self->ground, &self->contact, m, s, &self->input);
    if (groups & FMU_GROUP_ENERGY) self->energy_J = laconic_energy_J(m, s);
}

void fmu_model_part_loads(double support_load_N[LACONIC_MAX_SUPPORTS], const laconic_reactions *ground,
                          const laconic_vehicle *vehicle) {
    for (int32_t i = 0; i < LACONIC_MAX_SUPPORTS; i++)
        support_load_N[i] = i < vehicle->support_count ? ground->normal_N[vehicle->wheel_count + i] : 0.0;
}

static void refresh_rates(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    const bool friction = self->plant.friction.acts;
    const uint32_t of_wheels = fmu_friction_rolls(self) ? FMU_GROUP_TORQUES : FMU_GROUP_SPEEDS;
    fmu_model_refresh(instance, FMU_GROUP_MOTION | (friction ? of_wheels : 0U));
    if (friction)
        fmu_friction_rates(self);
    else
        laconic_derivative(&self->rates, &self->plant.model, self->nu, self->heading_rad, &self->input);
}

static void refresh_acceleration(fmu_instance *instance) {
    fmu_model *self = &instance->model;
    if (self->continuous && self->plant.friction.acts) fmu_model_refresh(instance, FMU_GROUP_RATES);
    fmu_sensors_accelerate(self);
}

void fmu_model_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_model *self = &instance->model;
    const laconic_model *m = &self->plant.model;
    const laconic_state *s = &self->plant.state;
    groups &= self->stale;
    if (groups == 0) return;
    if (self->stale & FMU_GROUP_STATE && groups != FMU_GROUP_RATES) {
        refresh_state(self);
        groups |= FMU_GROUP_STATE;
    }
    if (groups & FMU_GROUP_MOTION) {
        laconic_nu(m, s, self->nu);
        laconic_position(s, &self->x_m, &self->y_m, &self->heading_rad);
        if (groups == FMU_GROUP_MOTION) { /* importers read it at every step */
            self->stale &= ~FMU_GROUP_MOTION;
            return;
        }
    }
    if (groups & FMU_GROUP_POSE) laconic_pose_of(&self->pose, m, s);
    if (groups & FMU_GROUP_VELOCITY) self->yaw_rate_rad_per_s = laconic_body_velocity(m, s, self->velocity_m_per_s);
    if (self->plant.friction.acts)
        fmu_friction_refresh(self, groups);
    else
        refresh_ideal(self, groups);
    if (groups & FMU_GROUP_GROUND) fmu_model_part_loads(self->support_load_N, &self->ground, &self->plant.vehicle);
    if (groups & FMU_GROUP_SENSORS) fmu_sensors_refresh(self);
    if (FMU_MODEL_ESTIMATES && groups & FMU_GROUP_ESTIMATE) fmu_estimate_refresh(self);
    self->stale &= ~groups;
    if (groups & FMU_GROUP_RATES) refresh_rates(instance);
    if (groups & FMU_GROUP_ACCELERATION) refresh_acceleration(instance);
}

/* ------------------------------------------------------------------------------------ steps -- */

double fmu_model_own_step(const fmu_model *model) { return model->step_s; }

static laconic_status set_step(fmu_model *self, double step_s, laconic_refusal *why) {
    if (FMU_MODEL_ESTIMATES && fmu_estimate_is_on(self)) return fmu_estimate_set_step(self, step_s, why);
    return laconic_plant_set_step(&self->plant, step_s, why);
}

fmu_status fmu_model_set_step(fmu_instance *instance, double step_s) {
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    if (set_step(&instance->model, step_s, &why) != LACONIC_OK) return fmu_discard_with(instance, &why);
    instance->model.stand_in = false;
    return FMU_OK;
}

static void shift_input(laconic_input *out, const fmu_model *self, double by_s) {
    const laconic_input *u = &self->input, *du = &self->slope;
    for (int32_t i = 0; i < self->plant.model.wheel_count; i++) {
        out->voltage_V[i] = u->voltage_V[i] + by_s * du->voltage_V[i];
        out->axle_torque_Nm[i] = u->axle_torque_Nm[i] + by_s * du->axle_torque_Nm[i];
    }
    for (int32_t i = 0; i < 2; i++) {
        out->body_force_N[i] = u->body_force_N[i] + by_s * du->body_force_N[i];
        out->world_force_N[i] = u->world_force_N[i] + by_s * du->world_force_N[i];
        out->world_force_point_m[i] = u->world_force_point_m[i] + by_s * du->world_force_point_m[i];
    }
    out->body_moment_Nm = u->body_moment_Nm + by_s * du->body_moment_Nm;
}

static laconic_status step_sampled(fmu_model *self, const laconic_input samples[3], laconic_refusal *why) {
    if (FMU_MODEL_ESTIMATES && fmu_estimate_is_on(self)) return fmu_estimate_run_sampled(self, samples, why);
    if (self->watched) return laconic_sensors_run_sampled(&self->sensors, &self->plant, samples, why);
    return laconic_plant_run_sampled(&self->plant, samples, why);
}

/* Inputs change linearly over the communication step and are sampled three times in each internal step. */
static laconic_status run_sloped(fmu_instance *instance, uint64_t steps, laconic_refusal *why) {
    fmu_model *self = &instance->model;
    const double h = self->plant.integrator.step_s, start_s = fmu_clock_now(&instance->clock);
    laconic_input at[3];
    for (uint64_t n = 0; n < steps && !instance->cancelled; n++) {
        for (int k = 0; k < 3; k++) shift_input(&at[k], self, ((double)n + 0.5 * k) * h);
        if (fmu_grip_is_watched(instance)) {
            laconic_plant_reactions(&self->ground, &self->plant, &self->contact, &at[0]);
            fmu_grip_check(instance, &self->ground, start_s + (double)n * h);
        }
        const laconic_status status = step_sampled(self, at, why);
        if (status != LACONIC_OK) return status;
    }
    shift_input(&self->input, self, (double)steps * h);
    self->sloped = false; /* slopes hold for one communication step */
    return LACONIC_OK;
}

static laconic_status step_held(fmu_model *self, uint64_t steps, laconic_refusal *why) {
    if (FMU_MODEL_ESTIMATES && fmu_estimate_is_on(self)) return fmu_estimate_run(self, steps, why);
    if (self->watched) return laconic_sensors_run(&self->sensors, &self->plant, &self->input, steps, why);
    return laconic_plant_run(&self->plant, &self->input, steps, why);
}

/* Inputs are held. Grip is checked at the start of each step, where the reactions to a new input are largest. */
static laconic_status run_held(fmu_instance *instance, uint64_t steps, laconic_refusal *why) {
    fmu_model *self = &instance->model;
    const double h = self->plant.integrator.step_s, start_s = fmu_clock_now(&instance->clock);
    uint64_t n;
    for (n = 0; n < steps && fmu_grip_is_watched(instance) && !instance->cancelled; n++) {
        fmu_model_refresh(instance, FMU_GROUP_GROUND);
        fmu_grip_check(instance, &self->ground, start_s + (double)n * h);
        const laconic_status status = step_held(self, 1, why);
        if (status != LACONIC_OK) return status;
        self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    }
    while (n < steps && !instance->cancelled) {
        const uint64_t slice = steps - n < SLICE_STEPS ? steps - n : SLICE_STEPS;
        const laconic_status status = step_held(self, slice, why);
        if (status != LACONIC_OK) return status;
        n += slice;
    }
    return LACONIC_OK;
}

/* Where a sensor leaves its range, its step has been taken; it is taken back. So is what an estimate has begun. */
static fmu_status run_several_steps(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_model *self = &instance->model;
    laconic_refusal why;
    const uint64_t before = self->plant.steps;
    fmu_model_motion motion;
    const bool is_kept = self->watched || (FMU_MODEL_ESTIMATES && fmu_estimate_is_on(self));
    if (is_kept) fmu_model_save_motion(self, &motion);
    const laconic_status status = self->sloped ? run_sloped(instance, steps, &why) : run_held(instance, steps, &why);
    if (is_kept && status != LACONIC_OK) fmu_model_restore_motion(self, &motion);
    *taken = self->plant.steps - before;
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    return status == LACONIC_OK ? FMU_OK : fmu_discard_with(instance, &why);
}

/* One step with held inputs: what most importers need at every communication step. */
static bool run_one(fmu_model *self) {
    if (self->watched || (FMU_MODEL_ESTIMATES && fmu_estimate_is_on(self))) return false;
    if (laconic_step(&self->plant.model, &self->plant.integrator, &self->plant.state, &self->input) != LACONIC_OK)
        return false;
    self->plant.steps++;
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    return true;
}

fmu_status fmu_model_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_model *self = &instance->model;
    *taken = 1;
    if (steps == 1 && !self->sloped && !fmu_grip_is_watched(instance) && run_one(self)) return FMU_OK;
    return run_several_steps(instance, steps, taken); /* tries a refused single step again, to log the reason */
}

void fmu_model_save_motion(const fmu_model *model, fmu_model_motion *motion) {
    motion->state = model->plant.state;
    if (model->plant.friction.acts) motion->slip = model->plant.slip;
    if (model->watched) motion->sensors = model->sensors;
    motion->steps = model->plant.steps;
    motion->input = model->input;
    if (FMU_MODEL_ESTIMATES) fmu_estimate_save(model, motion);
}

void fmu_model_restore_motion(fmu_model *model, const fmu_model_motion *motion) {
    model->plant.state = motion->state;
    if (model->plant.friction.acts) model->plant.slip = motion->slip;
    if (model->watched) model->sensors = motion->sensors;
    model->plant.steps = motion->steps;
    model->input = motion->input;
    if (FMU_MODEL_ESTIMATES) fmu_estimate_restore(model, motion);
    model->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
}

/* ------------------------------------------------------------------------ continuous states -- */

/* ν, x, y, heading, wheel angles; and where wheels slip their speeds. */
uint32_t fmu_model_state_count(const fmu_model *model) {
    return 6U + (model->wheels_have_states ? 2U : 1U) * FMU_MODEL_ARRAY_SIZE(model);
}

void fmu_model_get_states(fmu_instance *instance, double *values) {
    const fmu_model *self = &instance->model;
    const uint32_t wheels = FMU_MODEL_ARRAY_SIZE(self);
    fmu_model_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES(self));
    for (uint32_t i = 0; i < 3; i++) values[i] = self->nu[i];
    values[3] = self->x_m;
    values[4] = self->y_m;
    values[5] = self->heading_rad;
    for (uint32_t i = 0; i < wheels; i++) values[6 + i] = self->wheel_angle_rad[i];
    for (uint32_t i = 0; i < wheels && self->wheels_have_states; i++)
        values[6 + wheels + i] = self->wheel_speed_rad_per_s[i];
}

void fmu_model_before_set_state(fmu_instance *instance) {
    const uint32_t states = FMU_GROUPS_OF_CONTINUOUS_STATES(&instance->model);
    fmu_model_refresh(instance, states);
    instance->model.stale = FMU_GROUPS_ALL & ~states;
}

void fmu_model_set_states(fmu_instance *instance, const double *values) {
    fmu_model *self = &instance->model;
    const uint32_t wheels = FMU_MODEL_ARRAY_SIZE(self);
    for (uint32_t i = 0; i < 3; i++) self->nu[i] = values[i];
    self->x_m = values[3];
    self->y_m = values[4];
    self->heading_rad = values[5];
    for (uint32_t i = 0; i < wheels; i++) self->wheel_angle_rad[i] = values[6 + i];
    for (uint32_t i = 0; i < wheels && self->wheels_have_states; i++)
        self->wheel_speed_rad_per_s[i] = values[6 + wheels + i];
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUPS_OF_CONTINUOUS_STATES(self);
}

void fmu_model_get_rates(fmu_instance *instance, double *values) {
    const fmu_model *self = &instance->model;
    const laconic_rates *rates = &self->rates;
    const uint32_t wheels = FMU_MODEL_ARRAY_SIZE(self);
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < 3; i++) values[i] = rates->nu_rad_per_s2[i];
    values[3] = rates->x_m_per_s;
    values[4] = rates->y_m_per_s;
    values[5] = rates->yaw_rate_rad_per_s;
    for (uint32_t i = 0; i < wheels; i++) values[6 + i] = rates->wheel_speed_rad_per_s[i];
    for (uint32_t i = 0; i < wheels && self->wheels_have_states; i++)
        values[6 + wheels + i] = self->wheel_rate_rad_per_s2[i];
}

void fmu_model_get_nominals(const fmu_model *model, double *values) {
    for (uint32_t i = 0; i < fmu_model_state_count(model); i++) values[i] = i < 3 || i > 5 ? 10.0 : 1.0;
}
