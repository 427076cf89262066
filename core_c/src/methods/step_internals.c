/* The parts of a step that are not inlined into the methods. */
#include "step_internals.h"

void laconic_forcing_of(laconic_forcing *forcing, const laconic_model *model, const laconic_input *input) {
    forcing_of(forcing, model, input);
}

vector laconic_forcing_after_yaw(const laconic_forcing *forcing, const laconic_heading *heading, real yaw_change_rad) {
    const laconic_binary_angle angle =
        (laconic_binary_angle)(heading->fraction + laconic_binary_angle_of(yaw_change_rad));
    vector b = forcing_at(forcing, laconic_direction_of_binary_angle(angle));
    KEEP_NAN(&b.x, yaw_change_rad); /* which as an angle is 0 where it is NaN */
    return b;
}

/* b at the start, in the middle and at the end of a step. */
INLINE void forcing_along(vector b[3], const laconic_model *model, const laconic_state *state, real step_s,
                          const laconic_forcing_samples *samples, const increment *by) {
    const real yaw_change = step_s * dot(vec(model->yaw_rate_of_zeta), by->mean);
    const laconic_forcing *const forcing[3] = {samples->start, samples->middle, samples->end};
    for (int i = 0; i < 3; i++) b[i] = forcing_after_yaw(forcing[i], &state->heading, R(0.5) * R(i) * yaw_change);
}

/* (1/h)∫b·ζ dt over the step, with b the parabola through its three values and ζ given by its mean and slope. */
static real work(vector start, vector middle, vector end, const increment *by) {
    const vector change = minus(end, start);
    const vector mean = scaled(R(1) / R(6), plus(plus(start, end), scaled(R(4), middle)));
    return dot(mean, by->mean) + (R(1) / R(12)) * dot(change, by->slope);
}

mask laconic_growth_is_forced(const laconic_model *model, const laconic_state *state, real step_s,
                              const laconic_forcing_samples *samples, const increment *by) {
    const vector zeta = zeta_of(state);
    vector b[3];
    forcing_along(b, model, state, step_s, samples, by);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    return gain - R(2) * step_s * work(b[0], b[1], b[2], by) <= ENERGY_TOLERANCE * (R(2) * before + gain);
}

#ifndef LACONIC_LANES
#ifdef LACONIC_SINGLE
#define HALF_OF_DIGITS R(4096)
#else
#define HALF_OF_DIGITS R(134217728)
#endif

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
    vector b[3];
    forcing_along(b, model, state, step_s, samples, by);
    const real before = square(zeta), gain = R(2) * dot(zeta, by->delta) + square(by->delta);
    const real excess = gain - R(2) * step_s * work(b[0], b[1], b[2], by);
    const real reach = step_s * size(by->mean) * (size(b[0]) + size(b[1]) + size(b[2]));
    if (!(excess <= ENERGY_TOLERANCE * (R(2) * before + gain))) return false;
    if (excess <= ENERGY_ROUNDING * before + R(0.0625) * reach) return true;
    return cut_back(model, zeta, gain - R(2) * step_s * dot(b[0], by->mean), by);
}

/* Adds to a sum what the addition loses, too, whatever the sizes: value + rest stays exact but for the rest's own
 * rounding (Knuth's two-sum). */
static void add_exactly(laconic_sum *sum, real addend) {
    const real value = sum->value + addend, added = value - sum->value;
    sum->rest += (sum->value - (value - added)) + (addend - added);
    sum->value = value;
}

/* Adds sign · x², all digits of it: x is split into halves whose products are exact (Veltkamp, Dekker). */
static void add_square(laconic_sum *sum, real sign, real x) {
    const real wide = (R(1) + HALF_OF_DIGITS) * x, high = wide - (wide - x), low = x - high, product = x * x;
    add_exactly(sum, sign * product);
    sum->rest += sign * (((high * high - product) + R(2) * (high * low)) + low * low);
}

/* |ζ|² now less |ζ|² before, of sums with what they carry, to far less than a rounding of |ζ|². */
static real square_gained(const laconic_sum now[3], const laconic_sum before[3]) {
    laconic_sum gained = {R(0), R(0)};
    for (int k = 0; k < 3; k++) {
        add_square(&gained, R(1), now[k].value);
        add_square(&gained, R(-1), before[k].value);
        gained.rest += R(2) * (now[k].value * now[k].rest - before[k].value * before[k].rest);
    }
    return gained.value + gained.rest;
}

/* What damping takes at least: the mean of a square is no less than the square of the mean. */
static real square_lost(const laconic_model *model, real step_s, vector mean) {
    return R(2) * step_s * dot(mean, damping(model, mean));
}

/* The sums carry what is less than a rounding of them. What is beyond roundings is not of the roundings: then a gain
 * alone is taken back. */
static void level(laconic_sum zeta[3], const laconic_model *model, real gained, real lost) {
    const vector now = {zeta[0].value, zeta[1].value, zeta[2].value}, across = across_gyro(model, now);
    const real rounding = ENERGY_ROUNDING * square(now);
    real surplus = gained + lost;
    if (surplus > rounding) surplus = gained > R(0) ? gained : R(0);
    if (surplus < -rounding || !(magnitude(surplus) < R(0.25) * square(across))) return;
    add_to_sums(zeta, scaled(R(-0.5) * surplus / square(across), across));
}

laconic_status laconic_accept_levelled(laconic_state *state, const laconic_model *model, real step_s,
                                       const laconic_forcing_samples *samples, const increment *by,
                                       const pose_change *moved) {
    const laconic_sum before[3] = {state->zeta[0], state->zeta[1], state->zeta[2]};
    const laconic_status status = accept_step(state, by->delta, scaled(step_s, by->mean), *moved);
    if (status == LACONIC_OK && unforced(samples))
        level(state->zeta, model, square_gained(state->zeta, before), square_lost(model, step_s, by->mean));
    return status;
}
#endif
