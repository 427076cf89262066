/* The controller behind the glue: a limited PI controller for the speed of each wheel. */
#include "plant_api.h"

/* The voltage before it is limited. */
static double wanted_V(const fmu_plant *p, uint32_t i) {
    return p->proportional_Vs_per_rad * (p->setpoint_rad_per_s[i] - p->speed_rad_per_s[i]) +
           p->integral_V_per_rad * p->error_rad[i];
}

static bool is_limited(const fmu_plant *p, uint32_t i) {
    const double wanted = wanted_V(p, i);
    return wanted > p->limit_V || wanted < -p->limit_V;
}

/* While the voltage is limited the integral must not run further into the limit. */
static bool is_held(const fmu_plant *p, uint32_t i) {
    const double error = p->setpoint_rad_per_s[i] - p->speed_rad_per_s[i], wanted = wanted_V(p, i);
    return (wanted > p->limit_V && error > 0.0) || (wanted < -p->limit_V && error < 0.0);
}

static double limited_V(const fmu_plant *p, uint32_t i) {
    const double wanted = wanted_V(p, i);
    return wanted > p->limit_V ? p->limit_V : wanted < -p->limit_V ? -p->limit_V : wanted;
}

static fmu_status check(const fmu_instance *instance) {
    const fmu_plant *p = &instance->plant;
    if (!(p->limit_V > 0.0)) return fmu_refuse(instance, "voltage_limit_V: %g must be above 0", p->limit_V);
    if (!(p->proportional_Vs_per_rad >= 0.0))
        return fmu_refuse(instance, "proportional_gain_Vs_per_rad: %g must not be negative",
                          p->proportional_Vs_per_rad);
    if (!(p->integral_V_per_rad >= 0.0))
        return fmu_refuse(instance, "integral_gain_V_per_rad: %g must not be negative", p->integral_V_per_rad);
    return FMU_OK;
}

fmu_status fmu_plant_start(fmu_instance *instance) {
    fmu_plant *p = &instance->plant;
    const fmu_status status = check(instance);
    if (status != FMU_OK) return status;
    for (uint32_t i = 0; i < FMU_PLANT_LARGEST_ARRAY; i++) p->error_rad[i] = 0.0;
    p->start_needed = p->change_needed = false;
    p->stale = FMU_GROUPS_ALL;
    return FMU_OK;
}

fmu_status fmu_plant_change(fmu_instance *instance) {
    const fmu_status status = check(instance);
    if (status != FMU_OK) return status;
    instance->plant.change_needed = false;
    instance->plant.stale = FMU_GROUPS_ALL;
    return FMU_OK;
}

void fmu_plant_input_changed(fmu_plant *plant) { plant->stale = FMU_GROUPS_ALL; }

void fmu_plant_refresh(fmu_instance *instance, uint32_t groups) {
    fmu_plant *p = &instance->plant;
    groups &= p->stale;
    p->stale &= ~groups;
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(p); i++) {
        if (groups & FMU_GROUP_VOLTAGE) p->voltage_V[i] = limited_V(p, i);
        if (groups & FMU_GROUP_RATES)
            p->error_rate_rad_per_s[i] = is_held(p, i) ? 0.0 : p->setpoint_rad_per_s[i] - p->speed_rad_per_s[i];
    }
}

double fmu_plant_own_step(const fmu_plant *plant) {
    (void)plant;
    return 0.0;
}

fmu_status fmu_plant_set_step(fmu_instance *instance, double step_s) {
    instance->plant.step_s = step_s;
    return FMU_OK;
}

fmu_status fmu_plant_count_steps(fmu_instance *instance, double step_s, double own_s, uint64_t *steps) {
    (void)instance;
    (void)step_s;
    (void)own_s;
    *steps = 1;
    return FMU_OK;
}

/* The inputs are held over the step, so the integral grows evenly. */
fmu_status fmu_plant_run(fmu_instance *instance, uint64_t steps, uint64_t *taken) {
    fmu_plant *p = &instance->plant;
    fmu_plant_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(p); i++)
        p->error_rad[i] += (double)steps * p->step_s * p->error_rate_rad_per_s[i];
    p->stale = FMU_GROUPS_ALL;
    *taken = steps;
    return FMU_OK;
}

void fmu_plant_conclude(fmu_instance *instance, bool accepted) {
    (void)instance; /* nothing is ever noted */
    (void)accepted;
}

void fmu_plant_watch(fmu_instance *instance) { (void)instance; /* a controller needs no ground */ }

void fmu_plant_mark(const fmu_plant *plant, fmu_plant_motion *motion) {
    for (uint32_t i = 0; i < FMU_PLANT_LARGEST_ARRAY; i++) motion->error_rad[i] = plant->error_rad[i];
}

void fmu_plant_return(fmu_plant *plant, const fmu_plant_motion *motion) {
    for (uint32_t i = 0; i < FMU_PLANT_LARGEST_ARRAY; i++) plant->error_rad[i] = motion->error_rad[i];
    plant->stale = FMU_GROUPS_ALL;
}

uint32_t fmu_plant_state_count(const fmu_plant *plant) { return FMU_PLANT_ARRAY_SIZE(plant); }

void fmu_plant_get_states(fmu_instance *instance, double *values) {
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(&instance->plant); i++) values[i] = instance->plant.error_rad[i];
}

void fmu_plant_set_states(fmu_instance *instance, const double *values) {
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(&instance->plant); i++) instance->plant.error_rad[i] = values[i];
    instance->plant.stale = FMU_GROUPS_ALL;
}

void fmu_plant_states_lead(fmu_instance *instance) { instance->plant.stale = FMU_GROUPS_ALL; }

void fmu_plant_get_rates(fmu_instance *instance, double *values) {
    fmu_plant_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(&instance->plant); i++)
        values[i] = instance->plant.error_rate_rad_per_s[i];
}

void fmu_plant_get_nominals(const fmu_plant *plant, double *values) {
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(plant); i++) values[i] = 1.0;
}

/* Linear but for the limit, where the derivative is that of the side it is on. */
void fmu_plant_tangent(fmu_instance *instance, fmu_tangent *t) {
    const fmu_plant *p = &instance->plant;
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(p); i++) {
        const double error = t->setpoint_rad_per_s[i] - t->speed_rad_per_s[i];
        t->voltage_V[i] =
            is_limited(p, i) ? 0.0 : p->proportional_Vs_per_rad * error + p->integral_V_per_rad * t->error_rad[i];
        t->error_rate_rad_per_s[i] = is_held(p, i) ? 0.0 : error;
    }
}

void fmu_plant_motion_seed(fmu_instance *instance, fmu_tangent *tangent) {
    fmu_plant_refresh(instance, FMU_GROUP_RATES);
    for (uint32_t i = 0; i < FMU_PLANT_ARRAY_SIZE(&instance->plant); i++)
        tangent->error_rad[i] = instance->plant.error_rate_rad_per_s[i];
}

/* Inputs are held: the description says that they are not interpolated. */
void fmu_plant_set_slope(fmu_plant *plant, uint32_t tangent_offset, double slope) {
    (void)plant;
    (void)tangent_offset;
    (void)slope;
}

bool fmu_plant_transfer(fmu_stream *stream, fmu_plant *plant) {
    fmu_stream_bool(stream, &plant->start_needed);
    fmu_stream_bool(stream, &plant->change_needed);
    fmu_stream_bool(stream, &plant->states_changed);
    fmu_stream_reals(stream, &plant->time_s, 1);
    fmu_stream_i32(stream, &plant->wheel_count, 0, FMU_PLANT_LARGEST_ARRAY);
    fmu_stream_reals(stream, &plant->proportional_Vs_per_rad, 1);
    fmu_stream_reals(stream, &plant->integral_V_per_rad, 1);
    fmu_stream_reals(stream, &plant->limit_V, 1);
    fmu_stream_reals(stream, plant->setpoint_rad_per_s, FMU_PLANT_LARGEST_ARRAY);
    fmu_stream_reals(stream, plant->speed_rad_per_s, FMU_PLANT_LARGEST_ARRAY);
    fmu_stream_reals(stream, plant->error_rad, FMU_PLANT_LARGEST_ARRAY);
    fmu_stream_reals(stream, &plant->step_s, 1);
    if (stream->from != NULL) plant->stale = FMU_GROUPS_ALL;
    return !stream->failed;
}
