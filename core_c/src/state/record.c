/* Steps along a schedule of inputs; records rows of chosen outputs and watches the grip. */
#include "common.h"

static void set_signals(laconic_input *input, const laconic_schedule *schedule, const real *value) {
    for (int32_t k = 0; k < schedule->signal_count; k++)
        *(real *)(void *)((unsigned char *)input + schedule->signal[k]) = value[k];
}

static void copy_columns(laconic_recorder *recorder, const laconic_outputs *now) {
    real *row = recorder->row + recorder->row_count * (uint64_t)recorder->column_count;
    for (int32_t k = 0; k < recorder->column_count; k++) row[k] = *number_at(now, recorder->column[k]);
    recorder->row_count++;
}

static void observe(laconic_recorder *recorder, const laconic_plant *plant, const laconic_input *input, bool row_due) {
    laconic_outputs now;
    if (recorder->contact != NULL && (row_due || recorder->grip != NULL)) {
        laconic_plant_reactions(&now.reactions, plant, recorder->contact, input);
        if (recorder->grip != NULL)
            laconic_grip_watch(recorder->grip, recorder->contact, &plant->model, &now.reactions, plant->steps);
#if LACONIC_WITH_FRICTION
        if (recorder->grip != NULL && plant->friction.acts && plant->friction.slips)
            laconic_friction_watch(recorder->grip, plant);
#endif
    }
    if (!row_due) return;
    laconic_outputs_of(&now, plant, input);
    if (recorder->sensors != NULL) laconic_sensors_read(&now.sensors, recorder->sensors, plant, input);
    copy_columns(recorder, &now);
}

void laconic_record_row(laconic_recorder *recorder, const laconic_plant *plant, const laconic_input *input) {
    observe(recorder, plant, input, true);
}

/* Observes where a row or the watch is due; returns how many of `left` steps may pass before the next observation, 0
 * where a row has no room. */
static uint64_t steps_until_observation(laconic_recorder *recorder, const laconic_plant *plant,
                                        const laconic_input *input, uint64_t left) {
    if (recorder == NULL) return left;
    const uint64_t since_row = recorder->every != 0 ? plant->steps % recorder->every : 1;
    const bool row_due = since_row == 0;
    if (row_due && recorder->row_count >= recorder->row_room) return 0;
    observe(recorder, plant, input, row_due);
    if (recorder->contact != NULL && recorder->grip != NULL) return 1;
    if (recorder->every == 0 || left < recorder->every - since_row) return left;
    return recorder->every - since_row;
}

static laconic_sensors *sensors_of(const laconic_recorder *recorder) {
    return recorder != NULL ? recorder->sensors : NULL;
}

static laconic_status step(const laconic_recorder *recorder, laconic_plant *plant, const laconic_input *input,
                           uint64_t steps, laconic_refusal *why) {
    laconic_sensors *sensors = sensors_of(recorder);
    return sensors != NULL ? laconic_sensors_run(sensors, plant, input, steps, why)
                           : laconic_plant_run(plant, input, steps, why);
}

static laconic_status step_sampled(const laconic_recorder *recorder, laconic_plant *plant,
                                   const laconic_input samples[3], laconic_refusal *why) {
    laconic_sensors *sensors = sensors_of(recorder);
    return sensors != NULL ? laconic_sensors_run_sampled(sensors, plant, samples, why)
                           : laconic_plant_run_sampled(plant, samples, why);
}

/* One stretch, up to `until_step`; *full: a row had no room. */
static laconic_status run_held(laconic_plant *plant, const laconic_input *input, uint64_t until_step,
                               laconic_recorder *recorder, bool *full, laconic_refusal *why) {
    while (plant->steps < until_step) {
        const uint64_t steps = steps_until_observation(recorder, plant, input, until_step - plant->steps);
        *full = steps == 0;
        if (*full) return LACONIC_OK;
        const laconic_status status = step(recorder, plant, input, steps, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

/* The stretch that a step of the schedule lies in: the first that ends after it. */
static uint64_t stretch_at(const laconic_schedule *schedule, uint64_t step) {
    uint64_t low = 0, high = schedule->count;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (schedule->until_step[middle] <= step)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Inputs are 0 but for the signals, which `value` has. */
static void inputs_of(laconic_input *input, const laconic_schedule *schedule, const real *value, int32_t count) {
    const laconic_input nothing = ALL_ZERO;
    for (int32_t k = 0; k < count; k++) {
        input[k] = nothing;
        set_signals(&input[k], schedule, value + k * schedule->signal_count);
    }
}

int32_t laconic_schedule_at(laconic_input inputs[3], uint64_t *until_step, const laconic_schedule *schedule,
                            uint64_t step) {
    const uint64_t since = step - schedule->first_step, width = (uint64_t)schedule->signal_count;
    const bool is_held = schedule->until_step != NULL;
    const uint64_t at = is_held ? stretch_at(schedule, since) : since;
    if (at >= schedule->count) return 0;
    const uint64_t end = schedule->first_step + (is_held ? schedule->until_step[at] : since + 1);
    *until_step = end < schedule->first_step ? UINT64_MAX : end; /* a stretch that lasts for ever */
    inputs_of(inputs, schedule, schedule->value + at * width * (is_held ? 1U : 3U), is_held ? 1 : 3);
    return is_held ? 1 : 3;
}

static laconic_status follow_held(laconic_plant *plant, const laconic_schedule *schedule, uint64_t until_step,
                                  laconic_recorder *recorder, laconic_refusal *why) {
    laconic_input input = ALL_ZERO;
    laconic_status status = LACONIC_OK;
    bool full = false;
    uint64_t k = stretch_at(schedule, plant->steps - schedule->first_step);
    for (; k < schedule->count && plant->steps < until_step && !full && status == LACONIC_OK; k++) {
        const uint64_t left = schedule->until_step[k] - (plant->steps - schedule->first_step);
        const uint64_t end = left < until_step - plant->steps ? plant->steps + left : until_step;
        set_signals(&input, schedule, schedule->value + k * (uint64_t)schedule->signal_count);
        status = run_held(plant, &input, end, recorder, &full, why);
    }
    return status;
}

static laconic_status follow_sampled(laconic_plant *plant, const laconic_schedule *schedule, uint64_t until_step,
                                     laconic_recorder *recorder, laconic_refusal *why) {
    const uint64_t numbers = (uint64_t)schedule->signal_count;
    const laconic_input nothing = ALL_ZERO;
    laconic_input input[3] = {nothing, nothing, nothing};
    while (plant->steps < until_step && plant->steps - schedule->first_step < schedule->count) {
        const real *value = schedule->value + 3 * numbers * (plant->steps - schedule->first_step);
        for (uint64_t k = 0; k < 3; k++) set_signals(&input[k], schedule, value + k * numbers);
        if (steps_until_observation(recorder, plant, input, 1) == 0) break;
        const laconic_status status = step_sampled(recorder, plant, input, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

laconic_status laconic_plant_follow(laconic_plant *plant, const laconic_schedule *schedule, uint64_t until_step,
                                    laconic_recorder *recorder, laconic_refusal *why) {
    return schedule->until_step != NULL ? follow_held(plant, schedule, until_step, recorder, why)
                                        : follow_sampled(plant, schedule, until_step, recorder, why);
}
