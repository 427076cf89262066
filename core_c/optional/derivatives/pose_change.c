/* The displacement of a step, linearised: step_internals.h has the formula. */
#include "step_change.h"

/* j₁(α)/α = 1/3 − z/30 + …, z = α², to rounding: poly_j1 has fewer digits, since a step needs no more, and the
 * difference that j₁ is cancels below α = 1. (½ j₁)' = ½ (sinc α − 2 j₁(α)/α), and sinc' = −j₁. */
static real j1_over_alpha(real z, real half_j1, real alpha) {
    const real few = R(1) / R(840) + z * (R(-1) / R(45360) + z * (R(1) / R(3991680)));
    if (z <= CHORD_SMALL) return R(1) / R(3) + z * (R(-1) / R(30) + z * few);
    if (z > R(1)) return R(2) * half_j1 / alpha;
    const real more = R(1) / R(93405312000) + z * (R(-1) / R(22230464256000) + z * (R(1) / R(6758061133824000)));
    const real rest = few + z * z * z * (R(-1) / R(518918400) + z * more);
    return R(1) / R(3) + z * (R(-1) / R(30) + z * rest);
}

void laconic_pose_trace(pose_trace *t, const laconic_model *m, vector path, vector bend) {
    const vector along = vec(m->velocity_of_zeta[0]), across = vec(m->velocity_of_zeta[1]);
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const real yaw_change = dot(yaw, path), alpha = R(0.5) * yaw_change, twelfth = R(1) / R(12);
    const real bent_forth = dot(along, bend), bent_left = dot(across, bend);
    chord_factors(&t->sinc, &t->half_j1, alpha);
    const real j1 = j1_over_alpha(alpha * alpha, t->half_j1, alpha), quarter = R(0.25) * (t->sinc - R(2) * j1);
    t->half_j1 = R(0.5) * alpha * j1;
    t->path = path;
    t->bend = bend;
    t->forth = dot(along, path);
    t->left = dot(across, path);
    t->yaw_bend = twelfth * dot(yaw, bend);
    t->along_yaw = -t->half_j1 * t->forth - quarter * bent_left;
    t->across_yaw = -t->half_j1 * t->left + quarter * bent_forth;
    t->moved.along_m = t->sinc * t->forth - (t->half_j1 * bent_left - t->yaw_bend * t->left);
    t->moved.across_m = t->sinc * t->left + (t->half_j1 * bent_forth - t->yaw_bend * t->forth);
    t->moved.yaw_change_rad = yaw_change;
    t->along_path = plus(scaled(t->sinc, along), plus(scaled(t->yaw_bend, across), scaled(t->along_yaw, yaw)));
    t->across_path = plus(scaled(t->sinc, across), minus(scaled(t->across_yaw, yaw), scaled(t->yaw_bend, along)));
    t->along_bend = minus(scaled(twelfth * t->left, yaw), scaled(t->half_j1, across));
    t->across_bend = minus(scaled(t->half_j1, along), scaled(twelfth * t->forth, yaw));
}

pose_change laconic_pose_by_model(const pose_trace *t, const dynamics_change *by) {
    const real forth = dot(by->along, t->path), left = dot(by->across, t->path);
    const real bent_forth = dot(by->along, t->bend), bent_left = dot(by->across, t->bend);
    const real yaw = dot(by->yaw_rate, t->path), yaw_bend = (R(1) / R(12)) * dot(by->yaw_rate, t->bend);
    const pose_change out = {
        t->sinc * forth + t->yaw_bend * left + t->along_yaw * yaw - t->half_j1 * bent_left + yaw_bend * t->left,
        t->sinc * left - t->yaw_bend * forth + t->across_yaw * yaw + t->half_j1 * bent_forth - yaw_bend * t->forth,
        yaw};
    return out;
}
