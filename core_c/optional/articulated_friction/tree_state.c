/* The state in which a tree starts, and what it shows. */
#include "articulated_vehicle.h"
#include "tree_step.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

static laconic_status tree_check_stops(const tree_body *link, real angle, int32_t b, laconic_refusal *why) {
    const laconic_field field = (laconic_field)LACONIC_FIELD_OF_START_HINGE_ANGLE;
    if (link->stops && angle > link->stop_high_rad)
        return refuse(why, LACONIC_ABOVE_LIMIT, field, b, angle, link->stop_high_rad);
    if (link->stops && angle < link->stop_low_rad)
        return refuse(why, LACONIC_BELOW_LIMIT, field, b, angle, link->stop_low_rad);
    return LACONIC_OK;
}

static laconic_status tree_check_start(const tree_model *m, const laconic_tree_start *start, laconic_refusal *why) {
    const laconic_articulated_start *h = &start->hinged;
    laconic_status status = laconic_articulated_check_start(h, TREE_LARGEST, why);
    for (int32_t b = 1; status == LACONIC_OK && b <= m->body_count; b++) {
        status = laconic_articulated_check_hinge_start(h, b, TREE_LARGEST, why);
        if (status == LACONIC_OK) status = tree_check_stops(&m->body[b], h->hinge_angle_rad[b - 1], b, why);
    }
    for (int32_t i = 0; status == LACONIC_OK && i < m->wheel_count; i++)
        status = laconic_articulated_check_start_number(start->wheel_speed_rad_per_s[i],
                                                        LACONIC_FIELD_START_WHEEL_SPEED, i + 1, TREE_LARGEST, why);
    return status;
}

static void tree_posture_of(tree_posture *at, const tree_model *m, const tree_state *s) {
    for (int32_t b = 0; b < m->body_count; b++) at->axes[b + 1] = direction_of_binary_angle(s->hinge[b].fraction);
    tree_place(at, m);
}

/* Velocity of a wheel's contact point along u and across it at z. */
static void tree_contact_velocity(real out[2], const tree_model *m, const tree_posture *at,
                                  const tree_place_of_wheel *w, int32_t on, const real z[]) {
    const tree_body *link = &m->body[on];
    real x = z[0] - z[2] * w->y, y = z[1] + z[2] * w->x;
    for (int32_t k = 0; k < link->depth; k++) {
        const int32_t b = link->path[k] + 1;
        x -= z[2 + b] * (w->y - at->hinge_y[b]);
        y += z[2 + b] * (w->x - at->hinge_x[b]);
    }
    out[0] = w->pull.cosine * x + w->pull.sine * y;
    out[1] = w->pull.cosine * y - w->pull.sine * x;
}

static void tree_start_wheels(tree_state *s, const tree_model *m, const tree_posture *at,
                              const tree_place_of_wheel place[], const laconic_tree_start *start) {
    bool given = start->wheels_stand;
    for (int32_t i = 0; i < m->wheel_count; i++) given = given || start->wheel_speed_rad_per_s[i] != R(0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        real velocity[2];
        tree_contact_velocity(velocity, m, at, &place[i], m->wheel[i].body, s->z);
        s->wheel_speed_rad_per_s[i] = given ? start->wheel_speed_rad_per_s[i] : velocity[0] / m->wheel[i].rim[0];
        if (m->wheel[i].locked) s->wheel_speed_rad_per_s[i] = R(0);
    }
}

static void tree_start_springs(tree_state *s, const tree_model *m) {
    for (int32_t b = 1; b <= m->body_count; b++) {
        const real off = heading_unwrapped(&s->hinge[b - 1]) - m->body[b].rest_rad;
        s->spring_energy_J += R(0.5) * m->body[b].stiffness_Nm * off * off;
    }
}

laconic_status laconic_tree_state_set(laconic_tree_state *state, const laconic_tree_model *model,
                                      const laconic_tree_start *start, laconic_refusal *why) {
    const laconic_articulated_start *h = &start->hinged;
    const laconic_status status = tree_check_start(model, start, why);
    laconic_tree_state s = ALL_ZERO;
    tree_place_of_wheel place[TREE_WHEELS];
    tree_posture at;
    tree_loads loads;
    if (status != LACONIC_OK) return status;
    s.x_m = sum_of(h->x_m);
    s.y_m = sum_of(h->y_m);
    (void)heading_advance(&s.heading, h->heading_rad);
    s.z[0] = h->velocity_m_per_s[0];
    s.z[1] = h->velocity_m_per_s[1];
    s.z[2] = h->yaw_rate_rad_per_s;
    for (int32_t b = 0; b < model->body_count; b++) {
        (void)heading_advance(&s.hinge[b], h->hinge_angle_rad[b]);
        s.z[3 + b] = h->hinge_rate_rad_per_s[b];
    }
    tree_posture_of(&at, model, &s);
    for (int32_t i = 0; i < model->wheel_count; i++) tree_place_wheel(&place[i], &at, &model->wheel[i]);
    tree_velocities(s.body, &at, model, s.z);
    tree_start_wheels(&s, model, &at, place, start);
    tree_start_springs(&s, model);
    laconic_tree_loads(&loads, model, &at, place, &s);
    for (int32_t i = 0; i < model->point_count; i++) s.normal_N[i] = loads.statics_N[i];
    s.supply_voltage_V = model->supply_V;
    if (!is_finite(tree_energy_twice(model, &s)))
        return refuse(why, LACONIC_OVERFLOW, (laconic_field)LACONIC_FIELD_OF_START_VELOCITY, 0, h->velocity_m_per_s[0],
                      R(0));
    *state = s;
    return LACONIC_OK;
}

/* ----------------------------------------------------------------------------------------- outputs -- */

static void tree_fill_motion(laconic_articulated_motion *out, const tree_model *m, const tree_state *s,
                             const tree_posture *at) {
    const direction heading = direction_of_binary_angle(s->heading.fraction);
    laconic_binary_angle facing[TREE_BODIES];
    out->velocity_m_per_s[0] = s->z[0];
    out->velocity_m_per_s[1] = s->z[1];
    out->yaw_rate_rad_per_s = s->z[2];
    out->x_m = s->x_m.value;
    out->y_m = s->y_m.value;
    out->heading_rad = heading_unwrapped(&s->heading);
    facing[0] = s->heading.fraction;
    for (int32_t b = 1; b <= m->body_count; b++) {
        laconic_heading now = ALL_ZERO;
        now.fraction = facing[b] = (laconic_binary_angle)(facing[m->body[b].parent] + s->hinge[b - 1].fraction);
        out->hinge_angle_rad[b - 1] = heading_unwrapped(&s->hinge[b - 1]);
        out->hinge_rate_rad_per_s[b - 1] = s->z[2 + b];
        out->body_heading_rad[b - 1] = heading_wrapped(&now);
        out->body_x_m[b - 1] = s->x_m.value + (heading.cosine * at->hinge_x[b] - heading.sine * at->hinge_y[b]);
        out->body_y_m[b - 1] = s->y_m.value + (heading.sine * at->hinge_x[b] + heading.cosine * at->hinge_y[b]);
    }
    for (int32_t i = 0; i < m->wheel_count; i++) {
        out->wheel_speed_rad_per_s[i] = s->wheel_speed_rad_per_s[i];
        out->wheel_angle_rad[i] = s->wheel_angle_rad[i].value;
    }
    out->energy_J = R(0.5) * tree_energy_twice(m, s);
}

static int32_t tree_contact_state(const laconic_tree_rim *w, const tree_state *s, int32_t i, const real slip[2]) {
    const real *p = s->grip_N[i], limit = w->friction_coefficient * s->normal_N[i];
    if (s->normal_N[i] < R(0)) return 2;
    if (!(magnitude(slip[0]) + magnitude(w->drag * slip[1]) > R(0))) return 0;
    return p[0] * p[0] + p[1] * p[1] >= limit * limit * (R(1) - R(8) * LACONIC_RANK_TOLERANCE) ? 1 : 0;
}

static void tree_fill_wheels(laconic_tree_outputs *out, const tree_model *m, const tree_state *s,
                             const tree_posture *at) {
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_tree_rim *w = &m->wheel[i];
        tree_place_of_wheel place;
        real slip[2];
        tree_place_wheel(&place, at, w);
        tree_contact_velocity(slip, m, at, &place, w->body, s->z);
        slip[0] -= w->rim[0] * s->wheel_speed_rad_per_s[i];
        slip[1] -= w->arm_across_m * s->wheel_speed_rad_per_s[i];
        out->slip_along_m_per_s[i] = slip[0];
        out->slip_across_m_per_s[i] = slip[1];
        out->contact_state[i] = tree_contact_state(w, s, i, slip);
        out->along_N[i] = -s->grip_N[i][0];
        out->lateral_N[i] = w->drag * s->grip_N[i][1]; /* to the right; the slip counts to the left */
        out->scrub_Nm[i] = -s->scrub_Nm[i];
        out->wheel_torque_Nm[i] = s->motor_torque_Nm[i];
    }
}

static void tree_fill_books(laconic_tree_outputs *out, const tree_state *s) {
    out->supply_current_A = s->supply_current_A;
    out->supply_voltage_V = s->supply_voltage_V;
    out->spring_energy_J = s->spring_energy_J;
    out->supply_energy_J = s->supply_energy_J.value;
    out->outer_work_J = s->outer_work_J.value;
    out->servo_work_J = s->servo_work_J.value;
    out->slip_loss_J = s->slip_loss_J.value;
    out->scrub_loss_J = s->scrub_loss_J.value;
    out->axle_loss_J = s->axle_loss_J.value;
    out->hinge_loss_J = s->hinge_loss_J.value;
    out->stop_loss_J = s->stop_loss_J.value;
    out->motor_loss_J = s->motor_loss_J.value;
    out->supply_loss_J = s->supply_loss_J.value;
    out->numerical_loss_J = s->numerical_loss_J.value;
}

void laconic_tree_motion_of(laconic_articulated_motion *motion, const laconic_tree_model *model,
                            const laconic_tree_state *state) {
    tree_posture at;
    tree_posture_of(&at, model, state);
    tree_fill_motion(motion, model, state, &at);
}

void laconic_tree_outputs_of(laconic_tree_outputs *outputs, const laconic_tree_model *model,
                             const laconic_tree_state *state) {
    tree_posture at;
    tree_posture_of(&at, model, state);
    tree_fill_motion(&outputs->motion, model, state, &at);
    tree_fill_wheels(outputs, model, state, &at);
    for (int32_t i = 0; i < model->point_count; i++) outputs->normal_N[i] = state->normal_N[i];
    for (int32_t b = 0; b < model->body_count; b++) {
        outputs->hinge_torque_Nm[b] = state->motor_torque_Nm[model->wheel_count + b];
        outputs->friction_torque_Nm[b] = -state->dry_Nm[b];
        outputs->stop_torque_Nm[b] = -(state->stop_Nm[b][0] + state->stop_Nm[b][1]);
    }
    for (int32_t i = 0; i < model->wheel_count + model->body_count; i++) {
        outputs->motor_current_A[i] = state->current_A[i];
        outputs->drive_limit[i] = state->limit[i];
    }
    tree_fill_books(outputs, state);
}

#endif
