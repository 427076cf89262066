#include "heading.h"

/* The body's origin is at (x, y) − Rot(θ) s, s = QS. */
void laconic_pose_of(laconic_pose *pose, const laconic_model *model, const laconic_state *state) {
    const direction heading = laconic_direction_of_turn(state->heading.fraction);
    const real sx = model->com_x_m, sy = model->com_y_m;
    pose->x_m = state->x_m.value;
    pose->y_m = state->y_m.value;
    pose->origin_x_m = pose->x_m - (heading.cosine * sx - heading.sine * sy);
    pose->origin_y_m = pose->y_m - (heading.sine * sx + heading.cosine * sy);
    pose->heading_rad = heading_unwrapped(&state->heading);
    pose->heading_wrapped_rad = heading_wrapped(&state->heading);
}
