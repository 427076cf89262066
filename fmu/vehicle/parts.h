/* Parts of the vehicle as an FMU model: what model.c asks of the files that have them. */
#ifndef LACONIC_FMU_VEHICLE_PARTS_H
#define LACONIC_FMU_VEHICLE_PARTS_H

#include "model_interface.h"

/* ---- friction_part.c: what only vehicles with ground friction or limits of their drive have: states and outputs
 * of wheels that slip. */

/* Whether the ground, or one wheel's contact with it, has friction. */
bool fmu_vehicle_slips(const laconic_vehicle *vehicle);

/* Whether Model Exchange cannot have this vehicle, since its states would be others; the log then says so. */
bool fmu_friction_refuses(const fmu_instance *instance, const laconic_vehicle *vehicle);

/* A drive with limits on ideal ground. For derivatives the motors' torques, which have kinks, act on the model of the
 * vehicle without motors, whose wheels roll. */
static inline bool fmu_friction_rolls(const fmu_model *model) {
    return model->plant.friction.acts && !model->plant.friction.slips;
}

/* Prepares the contact of the vehicle, and where it will roll with limits the model without motors. */
laconic_status fmu_friction_prepare(const laconic_vehicle *vehicle, laconic_contact *contact, laconic_model *rolling,
                                    laconic_refusal *why);

/* Where the wheels roll: projects ν onto what they allow, and gives them their speeds. */
void fmu_friction_project(fmu_model *model, double nu_rad_per_s[3]);

/* Model Exchange: speeds and angles of the wheels, from the continuous states to the plant. */
void fmu_friction_set_wheels(fmu_model *model);

/* Writes the derivatives of ν, pose and wheels: by the smooth law, or those of the wheels that roll. */
void fmu_friction_rates(fmu_model *model);

/* Computes those of the groups that are about wheels, ground and energy. */
void fmu_friction_refresh(fmu_model *model, uint32_t groups);

/* ---- sensors_part.c: IMU and encoders, which sample at internal steps; and the acceleration of the body, which
 * every vehicle has. */

/* Whether the vehicle has an IMU or an encoder. */
bool fmu_sensors_are_there(const fmu_model *model);

/* Whether there is a counter of one value, or Model Exchange cannot have this vehicle, since it has no internal steps
 * to sample at; the log says so. */
bool fmu_sensors_refuse(const fmu_instance *instance);

/* To be called when the plant was prepared: finds out who must watch its steps (fmu_model.watched). Ground with
 * friction is watched, too, as its acceleration is known of a whole step alone. */
void fmu_sensors_find(fmu_model *model);

/* Sensors as after power-up, if any watch. */
laconic_status fmu_sensors_start(fmu_model *model, laconic_refusal *why);

/* What the sensors show. */
void fmu_sensors_refresh(fmu_model *model);

/* The acceleration of the body's origin; in Model Exchange with friction the rates must be computed before. */
void fmu_sensors_accelerate(fmu_model *model);

/* ---- warnings.c: a wheel would slip or lift, so that the model no longer holds. Each is logged once in a run. */

#define FMU_SLIP_WARNING 1U
#define FMU_LIFT_WARNING 2U
#define FMU_ALL_WARNINGS 3U /* of the ground */
#define FMU_IDLE_WARNING 4U /* of a voltage without effect */

static inline bool fmu_wheels_slip(const fmu_model *model) {
    return model->plant.friction.acts && model->plant.friction.slips;
}

/* Warnings that this vehicle will not give any more. Slip is no news on ground with friction. */
static inline uint32_t fmu_warnings_done(const fmu_instance *instance) {
    return instance->warnings_given | instance->warnings_pending |
           (fmu_wheels_slip(&instance->model) ? FMU_SLIP_WARNING : 0U);
}

/* False, and nothing is computed, where no friction coefficient is given, all warnings are given, or none is logged. */
static inline bool fmu_grip_is_watched(const fmu_instance *instance) {
    const fmu_model *model = &instance->model;
    return (model->contact.friction_coefficient > 0.0 || fmu_wheels_slip(model)) &&
           (fmu_warnings_done(instance) & FMU_ALL_WARNINGS) != FMU_ALL_WARNINGS && instance->deliver != NULL &&
           (instance->log_categories & FMU_LOG_WARNING) != 0;
}

/* Makes slip and lift at that time pending warnings, which fmu_model_settle_warnings logs. */
void fmu_grip_check(fmu_instance *instance, const laconic_reactions *ground, double time_s);

/* ---- warnings.c: voltages of wheels that have no motor. They have no effect, which is logged once in a run. */

/* To be called when the plant was prepared: sets idle_wheels, so that vehicles without such wheels check nothing. */
void fmu_idle_motors_find(fmu_model *model);

/* Logs the first voltage without effect, once in a run. */
void fmu_idle_motors_check(fmu_instance *instance);

/* ---- estimate_part.c: the core's error estimate beside the plant, of an FMU with FMU_MODEL_ESTIMATES 1. Elsewhere
 * nothing calls these. */

/* Whether this instance estimates its error. */
bool fmu_estimate_is_on(const fmu_model *model);

/* Whether it is to be estimated in Model Exchange, which has no internal steps; the log says so. */
bool fmu_estimate_refuses(const fmu_instance *instance);

/* No error yet. Where the internal step is not known yet the estimate begins with it. */
laconic_status fmu_estimate_start(fmu_model *model, laconic_refusal *why);

/* laconic_plant_set_step(), and the estimate goes on, or begins. */
laconic_status fmu_estimate_set_step(fmu_model *model, double step_s, laconic_refusal *why);

/* The estimate goes on with a plant whose vehicle has changed; model->plant is still as before. */
laconic_status fmu_estimate_change(fmu_model *model, const laconic_plant *changed, laconic_refusal *why);

/* Steps of the plant, watched by sensors where there are any, with the input held, or one step with three samples. */
laconic_status fmu_estimate_run(fmu_model *model, uint64_t steps, laconic_refusal *why);
laconic_status fmu_estimate_run_sampled(fmu_model *model, const laconic_input samples[3], laconic_refusal *why);

/* What is known of the error now; all 0 where it is not estimated. */
void fmu_estimate_refresh(fmu_model *model);

/* The estimate's part of what steps change. */
void fmu_estimate_save(const fmu_model *model, fmu_model_motion *motion);
void fmu_estimate_restore(fmu_model *model, const fmu_model_motion *motion);

#endif
