/* The plant: vehicle, model, integrator and state together, with an integer count of steps. */
#include "common.h"

laconic_status laconic_plant_start(laconic_plant *plant, const laconic_vehicle *vehicle, const laconic_method *method,
                                   laconic_real step_s, const laconic_start *start, laconic_refusal *why) {
    laconic_model model;
    laconic_integrator integrator;
    laconic_status status = laconic_prepare(&model, vehicle, why);
    if (status == LACONIC_OK) status = laconic_integrator_prepare(&integrator, method, &model, step_s, why);
    if (status == LACONIC_OK) status = laconic_state_set(&plant->state, &model, start, why);
    if (status != LACONIC_OK) return status;
    plant->vehicle = *vehicle;
    plant->model = model;
    plant->integrator = integrator;
    plant->steps = 0;
    return LACONIC_OK;
}

laconic_status laconic_plant_run(laconic_plant *plant, const laconic_input *held, uint64_t steps,
                                 laconic_refusal *why) {
    laconic_status status;
    laconic_refusal found;
    plant->steps += laconic_run(&plant->model, &plant->integrator, &plant->state, held, steps, &status);
    if (status == LACONIC_OK) return status;
    laconic_step_refusal(&found, status, &plant->model, &plant->integrator, &plant->state, held, 1);
    return refuse(why, found.status, found.field, found.item, found.value, found.limit);
}

laconic_status laconic_plant_set_step(laconic_plant *plant, laconic_real step_s, laconic_refusal *why) {
    return laconic_integrator_prepare(&plant->integrator, plant->integrator.method, &plant->model, step_s, why);
}

laconic_status laconic_plant_change(laconic_plant *plant, const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_model model;
    laconic_integrator integrator;
    laconic_status status = laconic_prepare(&model, vehicle, why);
    if (status == LACONIC_OK)
        status =
            laconic_integrator_prepare(&integrator, plant->integrator.method, &model, plant->integrator.step_s, why);
    if (status != LACONIC_OK) return status;
    status = laconic_state_carry(&plant->state, &plant->model, &model);
    if (status != LACONIC_OK) return refuse(why, status, LACONIC_FIELD_NONE, 0, R(0), R(0));
    plant->vehicle = *vehicle;
    plant->model = model;
    plant->integrator = integrator;
    return LACONIC_OK;
}
