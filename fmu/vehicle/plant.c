/* The vehicle behind the glue: parameters → core, steps, and outputs when they are asked for. */
#include <stdio.h>

#include "grip_warning.h"
#include "plant_api.h"

/* A quotient beyond it is no count of steps: laconic_steps_in refuses it. */
#define MOST_STEPS 9e15

/* Does not compile unless the core is the double-precision one and wheel_kind can be read as an int32_t. */
typedef char fmu_core_is_double[sizeof(laconic_real) == sizeof(double) ? 1 : -1];
typedef char fmu_kind_is_int32[sizeof(laconic_wheel_kind) == sizeof(int32_t) ? 1 : -1];

/* laconic_message names a field as scenes do; here it has the name of the variable. */
static void tell(char *text, size_t size, const laconic_refusal *why) {
    char reason[256];
    const char *name = laconic_field_name(why->field);
    laconic_explanation(why, reason, sizeof reason);
    if (why->item > 0)
        snprintf(text, size, "%s[%d]: %s", name, (int)why->item, reason);
    else
        snprintf(text, size, "%s%s%s", name, *name != '\0' ? ": " : "", reason);
}

static fmu_status refuse_with(const fmu_instance *instance, const laconic_refusal *why, const char *when) {
    char text[320];
    tell(text, sizeof text, why);
    return fmu_refuse(instance, "%s: %s", when, text);
}

static fmu_status discard_with(const fmu_instance *instance, const laconic_refusal *why) {
    char text[320];
    tell(text, sizeof text, why);
    return fmu_report(instance, FMU_DISCARD, FMU_LOG_DISCARD, "the step at %.15g s is refused: %s",
                      fmu_clock_now(&instance->clock), text);
}

/* The step of a co-simulation is known at its first step only when step_s says so; until then a method that takes
 * any step stands in. */
static laconic_status start_core(fmu_plant *p, laconic_refusal *why) {
    const laconic_method *method = laconic_method_by_number(p->method);
    const bool known = p->step_s > 0.0 && !p->continuous;
    if (method == NULL || p->step_s < 0.0) /* the core says what is wrong with either */
        return laconic_plant_start(&p->core, &p->vehicle, method, p->step_s, &p->start, why);
    const laconic_status status = laconic_plant_start(&p->core, &p->vehicle, known ? method : &laconic_exact_flow,
                                                      known ? p->step_s : 1.0, &p->start, why);
    p->stand_in = !known;
    if (status == LACONIC_OK && !known) p->core.integrator.method = method;
    return status;
}

fmu_status fmu_plant_start(fmu_instance *instance) {
    fmu_plant *p = &instance->plant;
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    p->continuous = instance->kind == FMU_MODEL_EXCHANGE;
    laconic_status status = start_core(p, &why);
    if (status == LACONIC_OK) status = laconic_contact_prepare(&p->contact, &p->vehicle, &why);
    if (status != LACONIC_OK) return refuse_with(instance, &why, "this vehicle cannot start");
    p->start_needed = p->change_needed = false;
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (p->continuous) fmu_plant_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES);
    return FMU_OK;
}

fmu_status fmu_plant_change(fmu_instance *instance) {
    fmu_plant *p = &instance->plant;
    laconic_plant core;
    laconic_contact contact;
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    fmu_plant_refresh(instance, FMU_GROUP_STATE);
    core = p->core;
    if (p->stand_in) core.integrator.method = &laconic_exact_flow;
    laconic_status status = laconic_plant_change(&core, &p->vehicle, &why);
    if (status == LACONIC_OK) status = laconic_contact_prepare(&contact, &p->vehicle, &why);
    if (status != LACONIC_OK) return refuse_with(instance, &why, "the changed vehicle is refused");
    core.integrator.method = p->core.integrator.method;
    p->core = core;
    p->contact = contact;
    p->change_needed = false;
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    if (p->continuous) fmu_plant_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES);
    return fmu_report(instance, FMU_OK, FMU_LOG_EVENTS,
                      "the vehicle changed: mass %g kg, velocity and place of its body carried over",
                      core.model.mass_kg);
}

void fmu_plant_input_changed(fmu_plant *plant) { plant->stale |= FMU_GROUPS_OF_INPUT; }

/* ---------------------------------------------------------------------------------- outputs -- */

static void refresh_state(fmu_plant *p) {
    laconic_start motion = {{p->nu[0], p->nu[1], p->nu[2]}, p->x_m, p->y_m, p->heading_rad};
    /* not refused: fmu_set_states takes no number that it would refuse */
    (void)laconic_state_place(&p->core.state, &p->core.model, &motion, NULL);
    laconic_wheel_angles_set(&p->core.model, &p->core.state, p->wheel_angle_rad);
}

static void refresh_angles(fmu_plant *p) { laconic_wheel_angles(&p->core.model, &p->core.state, p->wheel_angle_rad); }

void fmu_plant_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_plant *p = &instance->plant;
    const laconic_model *m = &p->core.model;
    const laconic_state *s = &p->core.state;
    groups &= p->stale;
    if (groups == 0) return;
    if (p->stale & FMU_GROUP_STATE && groups != FMU_GROUP_RATES) {
        refresh_state(p);
        groups |= FMU_GROUP_STATE;
    }
    if (groups & FMU_GROUP_MOTION) {
        laconic_nu(m, s, p->nu);
        laconic_position(s, &p->x_m, &p->y_m, &p->heading_rad);
        if (groups == FMU_GROUP_MOTION) { /* what is asked for at every step */
            p->stale &= ~FMU_GROUP_MOTION;
            return;
        }
    }
    if (groups & FMU_GROUP_POSE) laconic_pose_of(&p->pose, m, s);
    if (groups & FMU_GROUP_ANGLES) refresh_angles(p);
    if (groups & FMU_GROUP_VELOCITY) p->yaw_rate_rad_per_s = laconic_body_velocity(m, s, p->velocity_m_per_s);
    if (groups & FMU_GROUP_SPEEDS) laconic_wheel_speeds(m, s, p->wheel_speed_rad_per_s);
    if (groups & FMU_GROUP_TORQUES) laconic_wheel_torques(m, s, &p->input, p->wheel_torque_Nm);
    if (groups & FMU_GROUP_GROUND) laconic_reactions_of(&p->ground, &p->contact, m, s, &p->input);
    if (groups & FMU_GROUP_ENERGY) p->energy_J = laconic_energy_J(m, s);
    p->stale &= ~groups;
    if (groups & FMU_GROUP_RATES) {
        fmu_plant_refresh(instance, FMU_GROUP_MOTION);
        laconic_derivative(&p->rates, m, p->nu, p->heading_rad, &p->input);
    }
}

/* ------------------------------------------------------------------------------------ steps -- */

double fmu_plant_own_step(const fmu_plant *plant) { return plant->step_s; }

fmu_status fmu_plant_set_step(fmu_instance *instance, double step_s) {
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    if (laconic_plant_set_step(&instance->plant.core, step_s, &why) != LACONIC_OK) return discard_with(instance, &why);
    instance->plant.stand_in = false;
    return FMU_OK;
}

/* The communication step nearest to the one asked for that this instance takes, now; 0: there is none. */
static double nearest_step(const fmu_instance *instance, double step_s, double own_s) {
    const double ratio = step_s / own_s;
    if (!(ratio < MOST_STEPS)) return 0.0;
    const uint64_t rounded = ratio < 1.0 ? 1 : (uint64_t)(ratio + 0.5);
    for (uint64_t count = rounded; count > 0 && count + 1 >= rounded; count--)
        if (!fmu_clock_passes_stop(&instance->clock, instance->plant.time_s + own_s * (double)count, own_s))
            return own_s * (double)count;
    return 0.0;
}

fmu_status fmu_plant_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps) {
    laconic_refusal why = {LACONIC_OK, LACONIC_FIELD_NONE, 0, 0.0, 0.0};
    if (laconic_steps_in(step_s, own_s, steps, &why) == LACONIC_OK) return FMU_OK;
    const double nearest = nearest_step(instance, step_s, own_s);
    if (nearest > 0.0)
        return fmu_refuse(instance,
                          "the communication step of %.15g s is no whole number of internal steps of %.15g s "
                          "(step_s); nearest that is: %.15g s",
                          step_s, own_s, nearest);
    return fmu_refuse(instance,
                      "the communication step of %.15g s cannot be taken in internal steps of %.15g s (step_s): "
                      "set another step_s before the run",
                      step_s, own_s);
}

static void shift_input(laconic_input *out, const fmu_plant *p, double by_s) {
    const laconic_input *u = &p->input, *du = &p->slope;
    for (int32_t i = 0; i < p->core.model.wheel_count; i++) {
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

/* Inputs that change evenly over the communication step, sampled three times an internal step. */
static laconic_status run_sloped(fmu_instance *instance, uint64_t steps, laconic_refusal *why) {
    fmu_plant *p = &instance->plant;
    const double h = p->core.integrator.step_s, start_s = fmu_clock_now(&instance->clock);
    laconic_input at[3];
    for (uint64_t n = 0; n < steps; n++) {
        for (int k = 0; k < 3; k++) shift_input(&at[k], p, ((double)n + 0.5 * k) * h);
        if (fmu_grip_is_watched(instance)) {
            laconic_reactions_of(&p->ground, &p->contact, &p->core.model, &p->core.state, &at[0]);
            fmu_grip_judge(instance, &p->ground, start_s + (double)n * h);
        }
        const laconic_status status =
            laconic_step_sampled(&p->core.model, &p->core.integrator, &p->core.state, &at[0], &at[1], &at[2]);
        if (status != LACONIC_OK) {
            laconic_step_refusal(why, status, &p->core.model, &p->core.integrator, &p->core.state, at, 3);
            return status;
        }
        p->core.steps++;
    }
    shift_input(&p->input, p, (double)steps * h);
    p->sloped = false; /* slopes hold for one communication step */
    return LACONIC_OK;
}

/* Inputs that are held, judged where each step begins: that is where a new input asks for the most. */
static laconic_status run_held(fmu_instance *instance, uint64_t steps, laconic_refusal *why) {
    fmu_plant *p = &instance->plant;
    const double h = p->core.integrator.step_s, start_s = fmu_clock_now(&instance->clock);
    uint64_t n;
    for (n = 0; n < steps && fmu_grip_is_watched(instance); n++) {
        fmu_plant_refresh(instance, FMU_GROUP_GROUND);
        fmu_grip_judge(instance, &p->ground, start_s + (double)n * h);
        const laconic_status status = laconic_plant_run(&p->core, &p->input, 1, why);
        if (status != LACONIC_OK) return status;
        p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    }
    return laconic_plant_run(&p->core, &p->input, steps - n, why);
}

static fmu_status run_several_steps(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_plant *p = &instance->plant;
    laconic_refusal why;
    const uint64_t before = p->core.steps;
    const laconic_status status = p->sloped ? run_sloped(instance, steps, &why) : run_held(instance, steps, &why);
    *taken = p->core.steps - before;
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    return status == LACONIC_OK ? FMU_OK : discard_with(instance, &why);
}

/* One step with held inputs is what most importers ask for, again and again. */
static bool run_one(fmu_plant *p) {
    if (laconic_step(&p->core.model, &p->core.integrator, &p->core.state, &p->input) != LACONIC_OK) return false;
    p->core.steps++;
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
    return true;
}

fmu_status fmu_plant_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_plant *p = &instance->plant;
    *taken = 1;
    if (steps == 1 && !p->sloped && !fmu_grip_is_watched(instance) && run_one(p)) return FMU_OK;
    return run_several_steps(instance, steps, taken); /* says what is wrong where a single step was refused */
}

void fmu_plant_mark(const fmu_plant *plant, fmu_plant_motion *motion) {
    motion->state = plant->core.state;
    motion->steps = plant->core.steps;
    motion->input = plant->input;
}

void fmu_plant_return(fmu_plant *plant, const fmu_plant_motion *motion) {
    plant->core.state = motion->state;
    plant->core.steps = motion->steps;
    plant->input = motion->input;
    plant->stale = FMU_GROUPS_ALL & ~FMU_GROUP_STATE;
}

/* ------------------------------------------------------------------------ continuous states -- */

uint32_t fmu_plant_state_count(const fmu_plant *plant) { return 6U + FMU_PLANT_ARRAY_SIZE(plant); }

void fmu_plant_get_states(fmu_instance *instance, double *values) {
    const fmu_plant *p = &instance->plant;
    fmu_plant_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES);
    for (uint32_t i = 0; i < 3; i++) values[i] = p->nu[i];
    values[3] = p->x_m;
    values[4] = p->y_m;
    values[5] = p->heading_rad;
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(p); i++) values[6 + i] = p->wheel_angle_rad[i];
}

void fmu_plant_states_lead(fmu_instance *instance) {
    fmu_plant_refresh(instance, FMU_GROUPS_OF_CONTINUOUS_STATES);
    instance->plant.stale = FMU_GROUPS_ALL & ~FMU_GROUPS_OF_CONTINUOUS_STATES;
}

void fmu_plant_set_states(fmu_instance *instance, const double *values) {
    fmu_plant *p = &instance->plant;
    for (uint32_t i = 0; i < 3; i++) p->nu[i] = values[i];
    p->x_m = values[3];
    p->y_m = values[4];
    p->heading_rad = values[5];
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(p); i++) p->wheel_angle_rad[i] = values[6 + i];
    p->stale = FMU_GROUPS_ALL & ~FMU_GROUPS_OF_CONTINUOUS_STATES;
}

void fmu_plant_get_rates(fmu_instance *instance, double *values) {
    const laconic_rates *rates = &instance->plant.rates;
    fmu_plant_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < 3; i++) values[i] = rates->nu_rad_per_s2[i];
    values[3] = rates->x_m_per_s;
    values[4] = rates->y_m_per_s;
    values[5] = rates->yaw_rate_rad_per_s;
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(&instance->plant); i++)
        values[6 + i] = rates->wheel_speed_rad_per_s[i];
}

void fmu_plant_get_nominals(const fmu_plant *plant, double *values) {
    for (uint32_t i = 0; i < fmu_plant_state_count(plant); i++) values[i] = i < 3 || i > 5 ? 10.0 : 1.0;
}
