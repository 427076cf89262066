/* The plant: vehicle, model, integrator and state together, with an integer count of steps. A vehicle with friction is
 * stepped by the friction step, any other by its integrator's method. The equations of motion
 * stand in derivative.c, those on friction in the folder friction. */
#include "common.h"

/* Builds without friction have no room for it, and never come to where these are used. */
#if LACONIC_WITH_FRICTION
#define FRICTION_OF(it) (&(it)->friction)
#define SLIP_OF(plant) (&(plant)->slip)
#else
#define FRICTION_OF(it) ((void)(it), (laconic_friction *)NULL)
#define SLIP_OF(plant) ((void)(plant), (laconic_slip *)NULL)
#endif

static bool friction_acts(const laconic_friction *friction) { return LACONIC_WITH_FRICTION && friction->acts; }

static bool has_slip(const laconic_plant *plant) { return friction_acts(FRICTION_OF(plant)); }

/* ----------------------------------------------------------------------------- preparation -- */

/* What an integrator of a plant with friction chooses; adapters that step it without the wheels are refused. */
static laconic_status refuse_step(const laconic_model *model, const laconic_integrator *integrator,
                                  laconic_state *state, const laconic_forcing_samples *samples) {
    (void)model;
    (void)integrator;
    (void)state;
    (void)samples;
    return LACONIC_METHOD_WITHOUT_FRICTION;
}

static const laconic_method friction_method = {"friction", 1, NULL, refuse_step};

/* All of a plant that follows from its vehicle, method and step. */
typedef struct constants {
    laconic_model model;
    laconic_integrator integrator;
#if LACONIC_WITH_FRICTION
    laconic_friction friction;
#endif
} constants;

/* By its name: its address would link every method that auto chooses from. */
static bool is_auto(const laconic_method *method) {
    static const char name[] = "auto";
    for (size_t k = 0; k < sizeof name; k++)
        if (method->name[k] != name[k]) return false;
    return true;
}

static laconic_status prepare_friction(constants *c, const laconic_vehicle *vehicle, const laconic_method *method,
                                       laconic_refusal *why) {
    if (method != NULL && !is_auto(method))
        return refuse(why, LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD, 0, R(0), R(0));
    return laconic_friction_of(FRICTION_OF(c), &c->model, vehicle, why);
}

static laconic_status prepare_constants(constants *c, const laconic_vehicle *vehicle, const laconic_method *method,
                                        real step_s, laconic_refusal *why) {
    const bool has_friction = LACONIC_WITH_FRICTION && laconic_vehicle_has_friction(vehicle);
    laconic_status status = laconic_prepare(&c->model, vehicle, why);
    if (LACONIC_WITH_FRICTION) FRICTION_OF(c)->acts = false;
    if (status == LACONIC_OK && has_friction) status = prepare_friction(c, vehicle, method, why);
    if (status == LACONIC_OK) status = laconic_integrator_prepare(&c->integrator, method, &c->model, step_s, why);
    if (status == LACONIC_OK && has_friction) c->integrator.chosen = &friction_method;
    return status;
}

static void adopt(laconic_plant *plant, const laconic_vehicle *vehicle, const constants *c) {
    plant->vehicle = *vehicle;
    plant->model = c->model;
    plant->integrator = c->integrator;
    if (LACONIC_WITH_FRICTION) *FRICTION_OF(plant) = *FRICTION_OF(c);
}

laconic_status laconic_plant_start(laconic_plant *plant, const laconic_vehicle *vehicle, const laconic_method *method,
                                   laconic_real step_s, const laconic_start *start, laconic_refusal *why) {
    constants c;
    laconic_state state;
    laconic_status status = prepare_constants(&c, vehicle, method, step_s, why);
    if (status == LACONIC_OK) status = laconic_state_set(&state, &c.model, start, why);
    if (status == LACONIC_OK && friction_acts(FRICTION_OF(&c)))
        status = laconic_slip_set(SLIP_OF(plant), FRICTION_OF(&c), vehicle, start, why);
    if (status != LACONIC_OK) return status;
    adopt(plant, vehicle, &c);
    plant->state = state;
    plant->steps = 0;
    return LACONIC_OK;
}

laconic_status laconic_plant_restart(laconic_plant *plant, const laconic_start *start, laconic_refusal *why) {
    laconic_slip slip;
    laconic_status status = LACONIC_OK;
    if (has_slip(plant)) status = laconic_slip_set(&slip, FRICTION_OF(plant), &plant->vehicle, start, why);
    if (status == LACONIC_OK) status = laconic_state_set(&plant->state, &plant->model, start, why);
    if (status != LACONIC_OK) return status;
    if (has_slip(plant)) *SLIP_OF(plant) = slip;
    plant->steps = 0;
    return LACONIC_OK;
}

laconic_status laconic_plant_set_step(laconic_plant *plant, laconic_real step_s, laconic_refusal *why) {
    const laconic_status status =
        laconic_integrator_prepare(&plant->integrator, plant->integrator.method, &plant->model, step_s, why);
    if (status == LACONIC_OK && has_slip(plant)) plant->integrator.chosen = &friction_method;
    return status;
}

/* ------------------------------------------------------------------------------------ steps -- */

static uint64_t run(laconic_plant *plant, const laconic_input *held, uint64_t steps, laconic_status *status) {
    uint64_t taken;
    if (!has_slip(plant)) return laconic_run(&plant->model, &plant->integrator, &plant->state, held, steps, status);
    *status = LACONIC_OK;
    for (taken = 0; taken < steps; taken++) {
        *status = laconic_friction_step(FRICTION_OF(plant), &plant->model, plant->integrator.step_s, &plant->state,
                                        SLIP_OF(plant), held);
        if (*status != LACONIC_OK) break;
    }
    return taken;
}

/* The refusal that belongs to the status of a refused step. */
static laconic_status refused(const laconic_plant *plant, laconic_status status, const laconic_input *inputs,
                              int32_t count, laconic_refusal *why) {
    laconic_refusal refusal;
    laconic_step_refusal(&refusal, status, &plant->model, &plant->integrator, &plant->state, inputs, count);
    if (why != NULL) *why = refusal;
    return refusal.status;
}

laconic_status laconic_plant_run(laconic_plant *plant, const laconic_input *held, uint64_t steps,
                                 laconic_refusal *why) {
    laconic_status status;
    plant->steps += run(plant, held, steps, &status);
    return status == LACONIC_OK ? LACONIC_OK : refused(plant, status, held, 1, why);
}

laconic_status laconic_plant_run_sampled(laconic_plant *plant, const laconic_input samples[3], laconic_refusal *why) {
    laconic_status status;
    if (has_slip(plant))
        run(plant, &samples[1], 1, &status);
    else
        status = laconic_step_sampled(&plant->model, &plant->integrator, &plant->state, &samples[0], &samples[1],
                                      &samples[2]);
    if (status != LACONIC_OK) return refused(plant, status, samples, 3, why);
    plant->steps++;
    return LACONIC_OK;
}

/* --------------------------------------------------------------- the wheels, wherever they are -- */

void laconic_plant_wheel_speeds(const laconic_plant *plant, laconic_real *speed_rad_per_s) {
    if (!has_slip(plant)) laconic_wheel_speeds(&plant->model, &plant->state, speed_rad_per_s);
    for (int32_t i = 0; has_slip(plant) && i < FRICTION_OF(plant)->wheel_count; i++)
        speed_rad_per_s[i] = SLIP_OF(plant)->wheel_speed_rad_per_s[i];
}

void laconic_plant_wheel_angles(const laconic_plant *plant, laconic_real *angle_rad) {
    if (!has_slip(plant)) laconic_wheel_angles(&plant->model, &plant->state, angle_rad);
    for (int32_t i = 0; has_slip(plant) && i < FRICTION_OF(plant)->wheel_count; i++)
        angle_rad[i] = SLIP_OF(plant)->wheel_angle_rad[i].value;
}

laconic_real laconic_plant_energy_J(const laconic_plant *plant) {
    return has_slip(plant) ? laconic_friction_energy_J(FRICTION_OF(plant), &plant->state, SLIP_OF(plant))
                           : laconic_energy_J(&plant->model, &plant->state);
}

/* ----------------------------------------------------------------------------------- change -- */

laconic_status laconic_plant_change(laconic_plant *plant, const laconic_vehicle *vehicle, laconic_refusal *why) {
    constants c;
    real speed[LACONIC_MAX_WHEELS], angle_rad[LACONIC_MAX_WHEELS];
    const int32_t wheels = LACONIC_WHEELS(&plant->model);
    laconic_status status = prepare_constants(&c, vehicle, plant->integrator.method, plant->integrator.step_s, why);
    if (status != LACONIC_OK) return status;
    if (vehicle->wheel_count > wheels) /* how far they have turned nobody knows */
        return refuse(why, LACONIC_ABOVE_LIMIT, LACONIC_FIELD_WHEEL_COUNT, 0, (real)vehicle->wheel_count, (real)wheels);
    laconic_plant_wheel_speeds(plant, speed);
    laconic_plant_wheel_angles(plant, angle_rad);
    status = laconic_state_carry(&plant->state, &plant->model, &c.model);
    if (status != LACONIC_OK) return refuse(why, status, LACONIC_FIELD_NONE, 0, R(0), R(0));
    if (has_slip(plant) && !friction_acts(FRICTION_OF(&c)))
        laconic_wheel_angles_set(&c.model, &plant->state, angle_rad);
    if (!has_slip(plant) && friction_acts(FRICTION_OF(&c)))
        laconic_slip_take_over(SLIP_OF(plant), FRICTION_OF(&c), speed, angle_rad);
    adopt(plant, vehicle, &c);
    return LACONIC_OK;
}
