/* What follows from the state alone: velocities, poses, hinges, wheels, energy. */
#include "articulated_step.h"
#include "step_internals.h"

#if LACONIC_MAX_BODIES > 0

/* Sweeps the state's twists outward. Its commands were checked when they were taken, which compilers do not know: the
 * carriage's twist is 0 where they could give it none. */
static void sweep_state(articulated_sweep *s, const laconic_articulated_model *m,
                        const laconic_articulated_state *state) {
    articulated_drive kept;
    real eta[LACONIC_MAX_VELOCITIES];
    laconic_articulated_drive_kept(&kept, m, state);
    take_posture_of(s, m, state);
    take_eta(eta, m, state);
    s->twist[0] = none;
    (void)sweep_outward(s, m, eta, &kept);
}

static void body_poses(laconic_articulated_motion *motion, const laconic_articulated_model *m,
                       const laconic_articulated_state *state) {
    laconic_heading facing[BODIES];
    real x[BODIES], y[BODIES];
    facing[0] = state->heading;
    x[0] = state->x_m.value;
    y[0] = state->y_m.value;
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const direction d = direction_of_heading(&facing[link->parent]);
        x[b] = motion->body_x_m[b - 1] = x[link->parent] + d.cosine * link->hinge.x - d.sine * link->hinge.y;
        y[b] = motion->body_y_m[b - 1] = y[link->parent] + d.sine * link->hinge.x + d.cosine * link->hinge.y;
        facing[b].fraction = (laconic_binary_angle)(facing[link->parent].fraction + state->hinge[b - 1].fraction);
        motion->body_heading_rad[b - 1] = heading_wrapped(&facing[b]);
    }
}

static vector travel_of(const laconic_articulated_state *state, int32_t number) {
    const laconic_sum *t = state->travel[number];
    return vector_of(t[0].value + t[0].rest, t[1].value + t[1].rest, t[2].value + t[2].rest);
}

void laconic_articulated_motion_of(laconic_articulated_motion *motion, const laconic_articulated_model *model,
                                   const laconic_articulated_state *state) {
    articulated_sweep s;
    sweep_state(&s, model, state);
    motion->velocity_m_per_s[0] = s.twist[0].x;
    motion->velocity_m_per_s[1] = s.twist[0].y;
    motion->yaw_rate_rad_per_s = s.twist[0].z;
    motion->x_m = state->x_m.value;
    motion->y_m = state->y_m.value;
    motion->heading_rad = heading_unwrapped(&state->heading);
    for (int32_t b = 0; b < model->body_count; b++) {
        motion->hinge_angle_rad[b] = heading_unwrapped(&state->hinge[b]);
        motion->hinge_rate_rad_per_s[b] = s.rate[b];
    }
    body_poses(motion, model, state);
    for (int32_t i = 0; i < model->wheel_count; i++) {
        const laconic_articulated_wheel *w = &model->wheel[i];
        motion->wheel_speed_rad_per_s[i] = w->locked ? R(0) : dot(w->roll, s.twist[w->body]);
        motion->wheel_angle_rad[i] = state->wheel_angle_set_rad[i];
        if (!w->locked) motion->wheel_angle_rad[i] += dot(w->roll, travel_of(state, w->body));
    }
    motion->energy_J = energy_of_twists(model, s.twist);
}

void laconic_articulated_wheel_angles_set(const laconic_articulated_model *model, laconic_articulated_state *state,
                                          const laconic_real *angle_rad) {
    for (int32_t i = 0; i < model->wheel_count; i++) state->wheel_angle_set_rad[i] = angle_rad[i];
    for (int32_t b = 0; b <= model->body_count; b++)
        for (int k = 0; k < 3; k++) state->travel[b][k] = sum_of(R(0));
}

#endif
