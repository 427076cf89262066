/* χ' = wheel_of_zeta · ζ, so χ is the same row of ∫ζ dt: no work per wheel in a step. */
#include "vector.h"

void laconic_wheel_angles(const laconic_model *model, const laconic_state *state, laconic_real *angle_rad) {
    const vector travel = {state->travel[0].value, state->travel[1].value, state->travel[2].value};
    const vector rest = {state->travel[0].rest, state->travel[1].rest, state->travel[2].rest};
    int32_t i;
    for (i = 0; i < LACONIC_WHEELS(model); i++) {
        const vector row = vec(model->wheel_of_zeta[i]);
        angle_rad[i] = state->wheel_angle_set_rad[i] + (dot(row, travel) + dot(row, rest));
    }
}

void laconic_wheel_angles_set(const laconic_model *model, laconic_state *state, const laconic_real *angle_rad) {
    int32_t i;
    for (i = 0; i < LACONIC_WHEELS(model); i++) state->wheel_angle_set_rad[i] = angle_rad[i];
    for (i = 0; i < 3; i++) state->travel[i] = sum_of(R(0));
}
