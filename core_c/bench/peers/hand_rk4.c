/* What a step of laconic_rk4 costs at least: written by hand for one vehicle, whose numbers the compiler knows, with
 * voltages held on ideal ground and a yaw below a quarter of a radian in each step. Its bits are those of the core. It
 * stands in for bench.c. HAND_REFUSES: 1 refuses what the core refuses, 0 nothing. */
#include "bench.h"
#include "laconic_scene_model.c"
#include "step_internals.h"

#define MODEL laconic_scene_model
#define STEP_S laconic_scene_integrator.step_s

static laconic_state state;
static uint32_t segment, taken; /* steps of this segment */

void bench_reset(void) {
    state = laconic_scene_start;
    segment = taken = 0;
}

const laconic_state *bench_state(void) { return &state; }

static vector forcing_of_voltages(const laconic_real voltage_V[]) {
    vector b = none;
    for (int i = 0; i < MODEL.wheel_count; i++)
        b = plus(b, scaled(MODEL.voltage_scale[0] * voltage_V[i], vec(MODEL.wheel_of_zeta[i])));
    return b;
}

INLINE vector rate(vector zeta, vector b) {
    const vector gyroscopic = scaled(dot(vec(MODEL.nu_of_zeta[2]), zeta), cross(zeta, vec(MODEL.gyro)));
    return plus(minus(gyroscopic, times(vec(MODEL.decay_per_s), zeta)), b);
}

/* After these no number of the step is beyond its range. */
INLINE bool can_be_taken(vector zeta, vector b, vector change, vector mean) {
    const real before = square(zeta), after = square(plus(zeta, change));
    const real excess = (R(1) - ENERGY_TOLERANCE) * after - (R(1) + ENERGY_TOLERANCE) * before;
    if (magnitude(dot(vec(MODEL.nu_of_zeta[2]), zeta)) > laconic_scene_integrator.gyro_limit) return false;
    if (!(excess <= R(0)) && !(excess <= R(2) * STEP_S * dot(b, mean))) return false;
    return before + after <= LARGEST_SPEED * LARGEST_SPEED;
}

/* The displacement by the mean of ζ and its change, each times h. */
INLINE pose_change moved_by(vector path, vector bend) {
    const vector along = vec(MODEL.velocity_of_zeta[0]), across = vec(MODEL.velocity_of_zeta[1]);
    const vector yaw = vec(MODEL.yaw_rate_of_zeta);
    const real yaw_change = dot(yaw, path), yaw_bend = dot(yaw, bend) * (R(1) / R(12)), alpha = R(0.5) * yaw_change;
    const real sinc = poly_sinc(alpha * alpha), half_j1 = R(0.5) * alpha * poly_j1(alpha * alpha);
    const real forth = dot(along, path), left = dot(across, path);
    const pose_change moved = {sinc * forth - (half_j1 * dot(across, bend) - yaw_bend * left),
                               sinc * left + (half_j1 * dot(along, bend) - yaw_bend * forth), yaw_change};
    return moved;
}

INLINE bool can_be_made(pose_change moved) {
    return magnitude(moved.yaw_change_rad) + magnitude(moved.along_m) + magnitude(moved.across_m) <
           LARGEST_YAW_CHANGE_RAD;
}

INLINE void add(vector change, vector path) {
    add_to_sums(state.zeta, change);
    flush_decayed(state.zeta);
    add_to_sums(state.travel, path);
}

static bool step(vector b) {
    const real sixth = STEP_S * (R(1) / R(6));
    const vector zeta = zeta_of(&state);
    const vector k1 = rate(zeta, b), k2 = rate(plus(zeta, scaled(R(0.5) * STEP_S, k1)), b);
    const vector k3 = rate(plus(zeta, scaled(R(0.5) * STEP_S, k2)), b), inner = plus(k2, k3);
    const vector forth = scaled(sixth, plus(k1, inner)), k4 = rate(plus(zeta, scaled(STEP_S, k3)), b);
    const vector change = plus(forth, scaled(sixth, plus(inner, k4))), mean = plus(zeta, forth);
    const vector path = scaled(STEP_S, mean);
    if (HAND_REFUSES && !can_be_taken(zeta, b, change, mean)) return false;
    if (!HAND_REFUSES) add(change, path); /* before the displacement, which then has more registers */
    const pose_change moved = moved_by(path, scaled(STEP_S, change));
    if (HAND_REFUSES && !can_be_made(moved)) return false;
    if (HAND_REFUSES) add(change, path);
    advance_pose(&state, moved);
    return true;
}

laconic_status bench_run(uint32_t steps) {
    for (; steps > 0; segment = (segment + (taken == 0)) % bench_segment_count) {
        const bench_segment *now = &bench_segments[segment];
        const uint32_t left = now->steps - taken, count = steps < left ? steps : left;
        const vector b = forcing_of_voltages(now->start.voltage_V);
        for (uint32_t i = 0; i < count; i++)
            if (!step(b)) return LACONIC_OVERFLOW;
        taken = (taken + count) % now->steps;
        steps -= count;
    }
    return LACONIC_OK;
}
