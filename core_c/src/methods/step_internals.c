/* The parts of a step that are not inlined into the methods. */
#include "step_internals.h"

void laconic_forcing_of(laconic_forcing *forcing, const laconic_model *model, const laconic_input *input) {
    forcing_of(forcing, model, input);
}

vector laconic_forcing_after_yaw(const laconic_forcing *forcing, const laconic_heading *heading, real yaw_change_rad) {
    const laconic_binary_angle angle =
        (laconic_binary_angle)(heading->fraction + laconic_binary_angle_of(yaw_change_rad));
    vector b = forcing_at(forcing, laconic_direction_of_binary_angle(angle));
    KEEP_LEFT(&b.x, yaw_change_rad); /* which as an angle is 0 where it is NaN */
    return b;
}

/* (1/h)∫b·ζ dt over the step, with b the parabola through its three values and ζ given by its mean and slope. */
static real work(vector start, vector middle, vector end, const increment *by) {
    const vector change = minus(end, start);
    const vector mean = scaled(R(1) / R(6), plus(plus(start, end), scaled(R(4), middle)));
    return dot(mean, by->mean) + (R(1) / R(12)) * dot(change, by->slope);
}

verdict laconic_growth_is_forced(const laconic_model *model, const laconic_state *state, real step_s,
                                 const laconic_forcing_samples *samples, const increment *by) {
    const vector zeta = zeta_of(state);
    const laconic_heading *heading = &state->heading;
    const real yaw_change = step_s * dot(vec(model->yaw_rate_of_zeta), by->mean);
    const laconic_forcing *const forcing[3] = {samples->start, samples->middle, samples->end};
    vector b[3];
    for (int i = 0; i < 3; i++) b[i] = forcing_after_yaw(forcing[i], heading, R(0.5) * R(i) * yaw_change);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    return gain - R(2) * step_s * work(b[0], b[1], b[2], by) <= ENERGY_TOLERANCE * (R(2) * before + gain);
}
