/* The parts of a step that are not inlined into the methods. */
#include "step_internals.h"

void laconic_load_of(laconic_load *load, const laconic_model *model, const laconic_input *input) {
    load_of(load, model, input);
}

vector laconic_turned_load(const laconic_load *load, const laconic_heading *heading, real offset_rad) {
    const laconic_turn turn = (laconic_turn)(heading->fraction + laconic_turn_of_angle(offset_rad));
    return load_at(load, laconic_direction_of_turn(turn));
}

/* ∫b·ζ over the step, divided by h: b through its values at start, middle and end, ζ by mean and slope. */
static real work(vector start, vector middle, vector end, const increment *by) {
    const vector change = minus(end, start);
    const vector mean = scaled(R(1) / R(6), plus(plus(start, end), scaled(R(4), middle)));
    return dot(mean, by->mean) + (R(1) / R(12)) * dot(change, by->slope);
}

bool laconic_growth_is_driven(const laconic_model *model, const laconic_state *state, real step_s,
                              const laconic_loads *loads, const increment *by) {
    const vector zeta = zeta_of(state);
    const laconic_heading *heading = &state->heading;
    const real turn = step_s * dot(vec(model->yaw_rate_of_zeta), by->mean);
    const vector start = load_now(loads->start, heading, R(0));
    const vector middle = load_now(loads->middle, heading, R(0.5) * turn);
    const vector end = load_now(loads->end, heading, turn);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    return gain - R(2) * step_s * work(start, middle, end, by) <= ENERGY_TOLERANCE * (R(2) * before + gain);
}
