/* What only vehicles with ground friction or limits of their drive have: states and outputs of wheels that slip. */
#ifndef LACONIC_FMU_VEHICLE_FRICTION_PART_H
#define LACONIC_FMU_VEHICLE_FRICTION_PART_H

#include "model_interface.h"

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

#endif
