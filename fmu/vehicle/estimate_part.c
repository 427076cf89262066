/* The core's error estimate beside the plant: it watches internal steps, and shows how far they are from the truth. */
#include "parts.h"

bool fmu_estimate_is_on(const fmu_model *model) { return model->estimate_error; }

bool fmu_estimate_refuses(const fmu_instance *instance) {
    if (!instance->model.continuous || !instance->model.estimate_error) return false;
    fmu_refuse(instance, "estimate_error: an estimate follows internal steps, which Model Exchange does not have; use "
                         "Co-Simulation, or set it to false");
    return true;
}

static laconic_status begin(fmu_model *model, laconic_refusal *why) {
    const laconic_status status = laconic_estimate_start(&model->estimate, &model->plant, model->estimate_window_steps,
                                                         laconic_finer_method(&model->plant), why);
    model->estimate_begun = status == LACONIC_OK;
    return status;
}

laconic_status fmu_estimate_start(fmu_model *model, laconic_refusal *why) {
    model->estimate_begun = false;
    return model->estimate_error && !model->stand_in ? begin(model, why) : LACONIC_OK;
}

laconic_status fmu_estimate_set_step(fmu_model *model, double step_s, laconic_refusal *why) {
    const laconic_plant before = model->plant;
    laconic_plant *plant = &model->plant;
    laconic_status status = laconic_plant_set_step(plant, step_s, why);
    if (status != LACONIC_OK) return status;
    status = model->estimate_begun
                 ? laconic_estimate_carry(&model->estimate, &before, plant, laconic_finer_method(plant), why)
                 : begin(model, why);
    if (status != LACONIC_OK) *plant = before;
    return status;
}

laconic_status fmu_estimate_change(fmu_model *model, const laconic_plant *changed, laconic_refusal *why) {
    if (!model->estimate_begun) return LACONIC_OK;
    return laconic_estimate_carry(&model->estimate, &model->plant, changed, laconic_finer_method(changed), why);
}

laconic_status fmu_estimate_run(fmu_model *model, uint64_t steps, laconic_refusal *why) {
    laconic_plant *plant = &model->plant;
    laconic_status status = LACONIC_OK;
    while (steps > 0 && status == LACONIC_OK) {
        const uint64_t now = laconic_estimate_before(&model->estimate, plant, &model->input, 1, steps);
        const uint64_t before = plant->steps;
        status = model->watched ? laconic_sensors_run(&model->sensors, plant, &model->input, now, why)
                                : laconic_plant_run(plant, &model->input, now, why);
        if (plant->steps > before) laconic_estimate_after(&model->estimate, plant, plant->steps - before);
        steps -= now;
    }
    return status;
}

/* Samples of slopes have no numbers for wheels that are not there; the estimate compares all of an input. */
static void watch_samples(fmu_model *model, const laconic_input samples[3]) {
    laconic_input whole[3] = {samples[0], samples[1], samples[2]};
    for (int k = 0; k < 3; k++)
        for (int32_t i = model->plant.model.wheel_count; i < LACONIC_MAX_WHEELS; i++)
            whole[k].voltage_V[i] = whole[k].axle_torque_Nm[i] = 0.0;
    laconic_estimate_before(&model->estimate, &model->plant, whole, 3, 1);
}

laconic_status fmu_estimate_run_sampled(fmu_model *model, const laconic_input samples[3], laconic_refusal *why) {
    laconic_plant *plant = &model->plant;
    watch_samples(model, samples);
    const laconic_status status = model->watched ? laconic_sensors_run_sampled(&model->sensors, plant, samples, why)
                                                 : laconic_plant_run_sampled(plant, samples, why);
    if (status == LACONIC_OK) laconic_estimate_after(&model->estimate, plant, 1);
    return status;
}

void fmu_estimate_refresh(fmu_model *model) {
    const laconic_error none = {0.0, 0.0, 0.0, 0.0};
    laconic_errors *found = &model->estimated;
    found->now = found->largest = found->rounding = none;
    found->unknown = 0;
    if (model->estimate_error && model->estimate_begun) laconic_estimate_read(found, &model->estimate, &model->plant);
    model->estimated_unknown = (double)found->unknown;
}

void fmu_estimate_save(const fmu_model *model, fmu_model_motion *motion) {
    if (model->estimate_error) motion->estimate = model->estimate;
}

void fmu_estimate_restore(fmu_model *model, const fmu_model_motion *motion) {
    if (model->estimate_error) model->estimate = motion->estimate;
}
