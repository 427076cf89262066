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

/* b at three instants of a step. */
typedef struct forcing_over_step {
    vector start, middle, end;
} forcing_over_step;

static forcing_over_step forcing_along(const laconic_model *model, const laconic_state *state, real step_s,
                                       const laconic_forcing_samples *samples, const increment *by) {
    const real yaw_change = step_s * dot(vec(model->yaw_rate_of_zeta), by->mean);
    const forcing_over_step b = {forcing_after_yaw(samples->start, &state->heading, R(0)),
                                 forcing_after_yaw(samples->middle, &state->heading, R(0.5) * yaw_change),
                                 forcing_after_yaw(samples->end, &state->heading, yaw_change)};
    return b;
}

/* (1/h)∫b·ζ dt over the step, with b the parabola through its three values and ζ given by its mean and slope. */
static real work(const forcing_over_step *b, const increment *by) {
    const vector change = minus(b->end, b->start);
    const vector mean = scaled(R(1) / R(6), plus(plus(b->start, b->end), scaled(R(4), b->middle)));
    return dot(mean, by->mean) + (R(1) / R(12)) * dot(change, by->slope);
}

verdict laconic_growth_is_forced(const laconic_model *model, const laconic_state *state, real step_s,
                                 const laconic_forcing_samples *samples, const increment *by) {
    const vector zeta = zeta_of(state);
    const forcing_over_step b = forcing_along(model, state, step_s, samples, by);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    return gain - R(2) * step_s * work(&b, by) <= ENERGY_TOLERANCE * (R(2) * before + gain);
}

#ifndef LACONIC_LANES
/* ζ but for its part along w, which free motion keeps. */
static vector across_gyro(const laconic_model *model, vector zeta) {
    const vector w = vec(model->gyro);
    return model->gyro_square > R(0) ? minus(zeta, scaled(dot(w, zeta) / model->gyro_square, w)) : zeta;
}

/* Shortens ζ⁺ across w until |ζ⁺|² is `surplus` less: the gyroscopic term turns that part alone. */
static bool cut_back(const laconic_model *model, vector zeta, real surplus, increment *by) {
    const vector across = across_gyro(model, plus(zeta, by->delta));
    const real share = surplus / square(across);
    if (!(share <= R(0.25))) return false;
    if (share > R(0)) by->delta = minus(by->delta, scaled(share / (R(1) + laconic_root(R(1) - share)), across));
    return true;
}

/* Where the forcing can hardly supply what the step gains, the forcing at the start is near enough. */
bool laconic_energy_kept(const laconic_model *model, const laconic_state *state, real step_s,
                         const laconic_forcing_samples *samples, increment *by) {
    const vector zeta = zeta_of(state);
    const forcing_over_step b = forcing_along(model, state, step_s, samples, by);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    const real excess = gain - R(2) * step_s * work(&b, by);
    const real reach = step_s * size(by->mean) * (size(b.start) + size(b.middle) + size(b.end));
    if (!(excess <= ENERGY_TOLERANCE * (R(2) * before + gain))) return false;
    if (excess <= ENERGY_ROUNDING * before + R(0.0625) * reach) return true;
    return cut_back(model, zeta, gain - R(2) * step_s * dot(b.start, by->mean), by);
}
#endif
