/* Arrays instead of single vehicles: kinds, starts and outputs of a population. */
#include "batch_block.h"

/* A copy of a vehicle with its motor. */
static laconic_status fitted(laconic_vehicle *vehicle, const laconic_vehicle *vehicles, const laconic_motor *motors,
                             int32_t i) {
    *vehicle = vehicles[i];
    return motors != NULL ? laconic_motor_fit(vehicle, &motors[i], NULL) : LACONIC_OK;
}

int32_t laconic_batch_kinds_of(laconic_batch_kind *kinds, int32_t *status, const laconic_vehicle *vehicles,
                               const laconic_motor *motors, int32_t count, const laconic_method *method,
                               laconic_real step_s) {
    int32_t refused = 0;
    for (int32_t i = 0; i < count; i++) {
        laconic_vehicle vehicle;
        laconic_status result = fitted(&vehicle, vehicles, motors, i);
        if (result == LACONIC_OK) result = laconic_batch_kind_of(&kinds[i], &vehicle, method, step_s, NULL);
        status[i] = (int32_t)result;
        refused += result != LACONIC_OK;
    }
    return refused;
}

int32_t laconic_batch_start(laconic_batch *batch, int32_t first_lane, int32_t lanes, const laconic_start *starts) {
    int32_t refused = 0;
    for (int32_t i = 0; i < lanes; i++) {
        const int32_t lane = first_lane + i;
        laconic_state state;
        const laconic_status result =
            laconic_state_set(&state, &batch->kinds[batch->kind_of[lane]].model, &starts[i], NULL);
        if (result == LACONIC_OK) laconic_batch_load(batch, lane, &state);
        batch->status[lane] = (int32_t)result;
        refused += result != LACONIC_OK;
    }
    return refused;
}

int32_t laconic_batch_contacts_of(laconic_contact *contacts, int32_t *status, const laconic_vehicle *vehicles,
                                  const laconic_motor *motors, int32_t count) {
    int32_t refused = 0;
    for (int32_t i = 0; i < count; i++) {
        laconic_vehicle vehicle;
        laconic_status result = fitted(&vehicle, vehicles, motors, i);
        if (result == LACONIC_OK) result = laconic_contact_prepare(&contacts[i], &vehicle, NULL);
        status[i] = (int32_t)result;
        refused += result != LACONIC_OK;
    }
    return refused;
}

void laconic_batch_outputs(const laconic_batch *batch, int32_t first_lane, int32_t lanes,
                           const laconic_contact *contacts, laconic_outputs *outputs) {
    for (int32_t i = 0; i < lanes; i++) {
        const int32_t lane = first_lane + i;
        laconic_plant plant = ALL_ZERO;
        laconic_input input = ALL_ZERO;
        plant.model = batch->kinds[batch->kind_of[lane]].model;
        laconic_batch_store(batch, lane, &plant.state);
        laconic_batch_input(batch, lane, &input);
        laconic_outputs_of(&outputs[i], &plant, &input);
        if (contacts != NULL)
            laconic_reactions_of(&outputs[i].reactions, &contacts[i], &plant.model, &plant.state, &input);
    }
}
