/* How far a wheel has turned, and the incremental encoder: whole counts of a shaft that turns with it. */
#include "common.h"

#define TURN_RAD R(6.28318530717958647693)
#define MOST_COUNTS R(2147483520.0) /* of one step; the largest number below 2^31 of single precision */

bool laconic_encoder_turn(laconic_encoder *encoder, const laconic_encoder_settings *settings,
                          laconic_real wheel_turned_rad) {
    const real gear = settings->gear_ratio == R(0) ? R(1) : settings->gear_ratio;
    const real counts = wheel_turned_rad * (gear * (real)settings->counts_per_turn / TURN_RAD);
    if (!(counts >= -MOST_COUNTS && counts <= MOST_COUNTS)) return false;
    const int32_t whole = (int32_t)counts;
    real rest = encoder->rest + (counts - (real)whole); /* above −1, below 2 */
    const int32_t carry = rest >= R(1) ? 1 : rest < R(0) ? -1 : 0;
    rest -= (real)carry;
    const bool rounded_up = rest >= R(1); /* a tiny negative part, taken from 1 */
    encoder->rest = rounded_up ? R(0) : rest;
    encoder->count += (int64_t)whole + carry + (rounded_up ? 1 : 0);
    return true;
}

int32_t laconic_encoder_place(const laconic_encoder *encoder, int32_t counts_per_turn) {
    const int32_t within = (int32_t)(encoder->count % counts_per_turn); /* the sign of the count */
    return within < 0 ? within + counts_per_turn : within;
}

int64_t laconic_encoder_turns(const laconic_encoder *encoder, int32_t counts_per_turn) {
    return (encoder->count - laconic_encoder_place(encoder, counts_per_turn)) / counts_per_turn;
}

/* Of the lower 32 bits, those from 2^31 on stand for numbers below 0: written out, as C leaves the conversion of such a
 * number to the compiler. */
int32_t laconic_encoder_shown(const laconic_encoder *encoder, int32_t wrap) {
    const uint32_t bits = (uint32_t)encoder->count;
    if (wrap > 0) return laconic_encoder_place(encoder, wrap);
    return bits <= (uint32_t)INT32_MAX ? (int32_t)bits : -(int32_t)(UINT32_MAX - bits) - 1;
}

/* ------------------------------------------------------------------------------------ odometer -- */

static const laconic_sum *sums_of(const laconic_plant *plant) {
#if LACONIC_WITH_FRICTION
    if (has_friction(plant)) return plant->slip.wheel_angle_rad;
#endif
    return plant->state.travel;
}

void laconic_odometer_of(laconic_odometer *now, const laconic_plant *plant) {
    const laconic_sum *sums = sums_of(plant);
    const int32_t count = has_friction(plant) ? plant->model.wheel_count : 3;
    for (int32_t k = 0; k < count; k++) now->sum[k] = sums[k];
}

static real difference(const laconic_sum *now, const laconic_sum *before) {
    return (now->value - before->value) + (now->rest - before->rest);
}

laconic_real laconic_wheel_turned_rad(const laconic_plant *plant, const laconic_odometer *before, int32_t wheel) {
    const laconic_sum *now = sums_of(plant);
    real turned = R(0);
    if (has_friction(plant)) return difference(&now[wheel], &before->sum[wheel]);
    for (int32_t k = 0; k < 3; k++)
        turned += plant->model.wheel_of_zeta[wheel][k] * difference(&now[k], &before->sum[k]);
    return turned;
}
