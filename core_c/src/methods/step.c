/* Steps: input → b, then the method; and why a step was refused. */
#include "step_internals.h"

/* The forcing of a held input; false where the point of its world force is not finite, which steps would not notice. */
static inline bool hold(laconic_forcing *forcing, laconic_forcing_samples *samples, const laconic_model *model,
                        const laconic_input *held) {
    if (zero_if_finite(world_force_point(held)) != R(0)) return false;
    forcing_of(forcing, model, held);
    samples->start = samples->middle = samples->end = forcing;
    samples->is_constant = !forcing->rotates;
    return true;
}

INLINE laconic_status take_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                                const laconic_forcing_samples *samples) {
    if (!heading_has_room(&state->heading)) return LACONIC_OVERFLOW;
    return integrator->chosen->step(model, integrator, state, samples);
}

laconic_status laconic_step(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                            const laconic_input *held) {
    laconic_forcing forcing;
    laconic_forcing_samples samples;
    if (!hold(&forcing, &samples, model, held)) return LACONIC_OVERFLOW;
    return take_step(model, integrator, state, &samples);
}

uint64_t laconic_run(const laconic_model *model, const laconic_integrator *integrator, laconic_state *state,
                     const laconic_input *held, uint64_t steps, laconic_status *status) {
    laconic_forcing forcing;
    laconic_forcing_samples samples;
    laconic_status last = hold(&forcing, &samples, model, held) ? LACONIC_OK : LACONIC_OVERFLOW;
    uint64_t left = steps;
    while (left > 0 && last == LACONIC_OK) {
        last = take_step(model, integrator, state, &samples);
        if (last == LACONIC_OK) left--;
    }
    *status = last;
    return steps - left;
}

/* Some methods do not use the world force in the middle (those of second order) or the point of a force of 0; without
 * this check they would accept an input that is not finite. */
static inline bool world_forces_are_finite(const laconic_input *start, const laconic_input *middle,
                                           const laconic_input *end) {
    const real force = LACONIC_WITH_WORLD_FORCE ? middle->world_force_N[0] + middle->world_force_N[1] : R(0);
    const real points = world_force_point(start) + world_force_point(middle) + world_force_point(end);
    return zero_if_finite(force + points) == R(0);
}

laconic_status laconic_step_sampled(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_input *start, const laconic_input *middle,
                                    const laconic_input *end) {
    laconic_forcing forcing[3];
    const laconic_forcing_samples samples = {&forcing[0], &forcing[1], &forcing[2], false};
    if (!world_forces_are_finite(start, middle, end)) return LACONIC_OVERFLOW;
    laconic_forcing_of(&forcing[0], model, start);
    laconic_forcing_of(&forcing[1], model, middle);
    laconic_forcing_of(&forcing[2], model, end);
    return take_step(model, integrator, state, &samples);
}

static laconic_status check_many(const real *numbers, int32_t count, laconic_field field, laconic_refusal *why) {
    for (int32_t i = 0; i < count; i++)
        if (!is_finite(numbers[i])) return refuse(why, LACONIC_NOT_FINITE, field, i + 1, numbers[i], R(0));
    return LACONIC_OK;
}

laconic_status laconic_input_check(const laconic_model *model, const laconic_input *input, laconic_refusal *why) {
    const int32_t n = model->wheel_count;
    laconic_status status = check_many(input->voltage_V, n, LACONIC_FIELD_VOLTAGE, why);
    if (status == LACONIC_OK) status = check_many(input->axle_torque_Nm, n, LACONIC_FIELD_AXLE_TORQUE, why);
    if (status == LACONIC_OK) status = check_many(input->body_force_N, 2, LACONIC_FIELD_BODY_FORCE, why);
    if (status == LACONIC_OK && !is_finite(input->body_moment_Nm))
        status = refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0, input->body_moment_Nm, R(0));
    if (status == LACONIC_OK) status = check_many(input->world_force_N, 2, LACONIC_FIELD_WORLD_FORCE, why);
    if (status == LACONIC_OK) status = check_many(input->world_force_point_m, 2, LACONIC_FIELD_WORLD_FORCE_POINT, why);
    return status;
}

void laconic_step_refusal(laconic_refusal *why, laconic_status status, const laconic_model *model,
                          const laconic_integrator *integrator, const laconic_state *state, const laconic_input *inputs,
                          int32_t input_count) {
    real limit = R(0);
    if (why == NULL) return;
    for (int32_t i = 0; i < input_count; i++)
        if (laconic_input_check(model, &inputs[i], why) != LACONIC_OK) return;
    if (status == LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT)
        limit = laconic_largest_stable_step_s(integrator->method, model, state);
    if (status == LACONIC_STEP_GAINS_ENERGY || status == LACONIC_STEP_SINGULAR ||
        (LACONIC_WITH_FRICTION && status == LACONIC_STEP_UNSOLVED))
        limit = R(0.5) * integrator->step_s;
    refuse(why, status, LACONIC_FIELD_STEP, 0, integrator->step_s, limit);
}
