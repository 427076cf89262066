/* Vehicles with ground friction or limits of their drive: in Co-Simulation the plant has what the last step found; in
 * Model Exchange the smooth law gives it for this instant, or on ideal ground the model of the wheels that roll. */
#include "parts.h"

bool fmu_vehicle_slips(const laconic_vehicle *vehicle) {
    return vehicle->ground.friction_coefficient > 0.0 && vehicle->wheel_count > 0;
}

bool fmu_friction_refuses(const fmu_instance *instance, const laconic_vehicle *vehicle) {
    const bool slips = fmu_vehicle_slips(vehicle), has_states = instance->model.wheels_have_states;
    if (slips && !has_states)
        fmu_refuse(instance,
                   "ground_friction_coefficient: Model Exchange of this FMU has no states for wheels that slip; "
                   "use Co-Simulation, or make the FMU from a scene with [ground]");
    else if (has_states && !slips)
        fmu_refuse(instance,
                   "ground_friction_coefficient: Model Exchange of this FMU has states for wheels that slip; give "
                   "a value above 0, or make the FMU from a scene without it");
    else
        return false;
    return true;
}

/* ----------------------------------------------------------------------------- wheels that roll -- */

static laconic_vehicle without_motors(const laconic_vehicle *vehicle) {
    const laconic_drive none = {0.0, 0.0, 0.0, 0.0, 0.0};
    laconic_vehicle bare = *vehicle;
    bare.drive = none;
    for (int32_t i = 0; i < bare.wheel_count; i++) {
        laconic_wheel *wheel = &bare.wheel[i];
        wheel->motor_circuit = LACONIC_MOTOR_DRIVEN;
        wheel->own_motor_gain_Nm_per_V = wheel->own_motor_damping_Nms = 0.0;
        wheel->undriven = true;
    }
    return bare;
}

laconic_status fmu_friction_prepare(const laconic_vehicle *vehicle, laconic_contact *contact, laconic_model *rolling,
                                    laconic_refusal *why) {
    laconic_vehicle bare;
    if (fmu_vehicle_slips(vehicle) || !laconic_vehicle_has_friction(vehicle))
        return laconic_contact_prepare(contact, vehicle, why);
    bare = without_motors(vehicle);
    const laconic_status status = laconic_prepare(rolling, &bare, why);
    /* no refusal is expected: the vehicle with its motors was prepared before */
    return status == LACONIC_OK ? laconic_contact_prepare(contact, &bare, why) : status;
}

static laconic_state rolling_state(const fmu_model *self, const double nu_rad_per_s[3]) {
    const laconic_start motion = {
        {nu_rad_per_s[0], nu_rad_per_s[1], nu_rad_per_s[2]}, self->x_m, self->y_m, self->heading_rad, {0.0}};
    laconic_state state;
    (void)laconic_state_project(&state, &self->rolling, &motion, NULL); /* as in model.c: cannot be refused */
    return state;
}

void fmu_friction_project(fmu_model *model, double nu_rad_per_s[3]) {
    const laconic_state state = rolling_state(model, nu_rad_per_s);
    laconic_nu(&model->rolling, &state, nu_rad_per_s);
    laconic_wheel_speeds(&model->rolling, &state, model->wheel_speed_rad_per_s);
}

/* The motors' torques as torques on axles; the rest of the input as it is. */
static laconic_input torques_on_axles(const fmu_model *self) {
    laconic_input input = self->input;
    for (int32_t i = 0; i < self->plant.friction.wheel_count; i++) {
        input.voltage_V[i] = 0.0;
        input.axle_torque_Nm[i] = self->wheel_torque_Nm[i];
    }
    return input;
}

static void rolling_reactions(fmu_model *self) {
    const laconic_input input = torques_on_axles(self);
    const laconic_state state = rolling_state(self, self->nu);
    laconic_reactions_of(&self->ground, &self->contact, &self->rolling, &state, &input);
}

/* ---------------------------------------------------------------------------- states and rates -- */

void fmu_friction_set_wheels(fmu_model *model) {
    laconic_slip *slip = &model->plant.slip;
    for (int32_t i = 0; i < model->plant.friction.wheel_count; i++) {
        slip->wheel_speed_rad_per_s[i] = model->plant.friction.axle[i].locked ? 0.0 : model->wheel_speed_rad_per_s[i];
        slip->wheel_angle_rad[i].value = model->wheel_angle_rad[i];
        slip->wheel_angle_rad[i].rest = 0.0;
    }
}

/* A brake holds its wheel, whatever its state says. */
static void smooth_rates(fmu_model *self) {
    const laconic_friction *friction = &self->plant.friction;
    double speed[LACONIC_MAX_WHEELS];
    for (int32_t i = 0; i < friction->wheel_count; i++)
        speed[i] = friction->axle[i].locked ? 0.0 : self->wheel_speed_rad_per_s[i];
    laconic_friction_derivative(&self->rates, self->wheel_rate_rad_per_s2, friction, &self->plant.model, self->nu,
                                self->heading_rad, speed, &self->input);
}

void fmu_friction_rates(fmu_model *model) {
    const laconic_input input = torques_on_axles(model);
    if (fmu_friction_rolls(model))
        laconic_derivative(&model->rates, &model->rolling, model->nu, model->heading_rad, &input);
    else
        smooth_rates(model);
}

/* ----------------------------------------------------------------------------------- outputs -- */

#define PER_WHEEL(to, from, count) \
    for (int32_t i = 0; i < (count); i++) (to)[i] = (from)[i]

/* The smooth law has no sticking; a contact slips where friction has most of its size. */
static double smooth_contact_state(const fmu_model *self, const laconic_friction_outputs *now, int32_t i) {
    const double along = now->slip_along_m_per_s[i];
    const double across = self->plant.friction.wheel[i].drag * now->slip_across_m_per_s[i];
    if (self->ground.normal_N[i] < 0.0) return 2.0;
    return along * along + across * across > LACONIC_SMOOTH_SLIP_M_PER_S * LACONIC_SMOOTH_SLIP_M_PER_S ? 1.0 : 0.0;
}

static void show(fmu_model *self, const laconic_friction_outputs *now) {
    fmu_friction_outputs *out = &self->friction;
    const int32_t wheels = self->plant.friction.wheel_count;
    PER_WHEEL(out->slip_along_m_per_s, now->slip_along_m_per_s, wheels);
    PER_WHEEL(out->slip_across_m_per_s, now->slip_across_m_per_s, wheels);
    PER_WHEEL(out->contact_state, now->contact_state, wheels);
    PER_WHEEL(out->drive_limit, now->drive_limit, wheels);
    PER_WHEEL(out->motor_current_A, now->motor_current_A, wheels);
    for (int32_t i = 0; i < wheels && self->continuous; i++) out->contact_state[i] = smooth_contact_state(self, now, i);
    out->supply_current_A = now->supply_current_A;
    out->supply_voltage_V = now->supply_voltage_V;
    out->supply_energy_J = now->supply_energy_J;
    out->outer_work_J = now->outer_work_J;
    out->slip_loss_J = now->slip_loss_J;
    out->axle_loss_J = now->axle_loss_J;
    out->motor_loss_J = now->motor_loss_J;
    out->supply_loss_J = now->supply_loss_J;
    out->numerical_loss_J = now->numerical_loss_J;
}

/* What these groups read: of rolling wheels the reactions follow from the torques, and whether one lifts from those. */
static uint32_t with_needed(const fmu_model *self, uint32_t groups) {
    if (self->continuous && groups & FMU_GROUP_FRICTION) groups |= FMU_GROUP_GROUND;
    if (self->continuous && fmu_friction_rolls(self) && groups & FMU_GROUP_GROUND) groups |= FMU_GROUP_TORQUES;
    return groups;
}

static void refresh_wheels(fmu_model *self, uint32_t groups, const laconic_outputs *now) {
    const int32_t wheels = self->plant.friction.wheel_count;
    if (groups & FMU_GROUP_ANGLES) PER_WHEEL(self->wheel_angle_rad, now->wheel_angle_rad, wheels);
    if (groups & FMU_GROUP_SPEEDS) PER_WHEEL(self->wheel_speed_rad_per_s, now->wheel_speed_rad_per_s, wheels);
    if (groups & FMU_GROUP_TORQUES) PER_WHEEL(self->wheel_torque_Nm, now->wheel_torque_Nm, wheels);
    if (groups & FMU_GROUP_ENERGY) self->energy_J = now->energy_J;
}

void fmu_friction_refresh(fmu_model *model, uint32_t groups) {
    const laconic_plant *plant = &model->plant;
    laconic_outputs now;
    groups = with_needed(model, groups);
    if (model->continuous && groups & (FMU_GROUP_TORQUES | FMU_GROUP_GROUND | FMU_GROUP_FRICTION))
        laconic_slip_smooth(&model->plant.slip, &plant->friction, &plant->state, &model->input);
    laconic_outputs_of(&now, plant, &model->input);
    refresh_wheels(model, groups, &now);
    if (groups & FMU_GROUP_GROUND && model->continuous && fmu_friction_rolls(model))
        rolling_reactions(model);
    else if (groups & FMU_GROUP_GROUND)
        laconic_plant_reactions(&model->ground, plant, &model->contact, &model->input);
    if (groups & FMU_GROUP_FRICTION) show(model, &now.friction);
}
