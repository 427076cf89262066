/* States of articulated vehicles: start values, what a step adds, and motions that are kept when commands jump.
 *
 * A change of commands is an impulse: with X⁻ the twists before and X⁺ those at the same η after it, the change of η
 * obeys mass · x = Σ B_bᵀ I_b (X⁻ − X⁺) + Cᵀκ with C(η + x) = 0. The momenta along all motions that are allowed
 * afterwards stay, and of all allowed motions this one is nearest to X⁻ in kinetic energy. A start is the same from η =
 * 0, with the given twists as X⁻. */
#include "articulated_step.h"
#include "articulated_vehicle.h"
#include "step_internals.h"

#if LACONIC_MAX_BODIES > 0

/* ------------------------------------------------------------------------------- impulses -- */

/* x for the twists `before`; s is swept outward at the new commands. */
static laconic_status impulse(real *x, articulated_sweep *s, const laconic_articulated_model *m, const vector before[],
                              laconic_refusal *why) {
    const real at_rest[LACONIC_MAX_VELOCITIES] = {R(0)};
    real target[LACONIC_MAX_LEFT_ROWS];
    s->force[0] = form_times(&m->inertia, minus(before[0], s->twist[0]));
    for (int32_t b = 1; b <= m->body_count; b++)
        s->force[b] = form_times(&m->link[b - 1].inertia, minus(before[b], s->twist[b]));
    sweep_inward(s, m);
    project_root(s, m, at_rest, false);
    for (int32_t r = 0; r < m->row_count; r++) target[r] = -s->row_value[r];
    return laconic_articulated_solve(x, NULL, s, m, target, why);
}

static laconic_status sweep_or_refuse(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                                      const articulated_drive *drive, laconic_refusal *why) {
    const int32_t unknown = sweep_outward(s, m, eta, drive);
    return unknown == 0 ? LACONIC_OK : laconic_articulated_refuse_twist(unknown, m, drive, why);
}

/* Adds x to η with the commands of `drive`; false where it leaves the range. */
static bool add_to_eta(laconic_articulated_state *state, const laconic_articulated_model *m, const real *x) {
    real square_size = R(0);
    for (int32_t i = 0; i < m->dof; i++) {
        const real eta = state->eta[i].value + x[i];
        square_size += eta * eta;
    }
    if (!(square_size <= LARGEST_ETA * LARGEST_ETA)) return false;
    for (int32_t i = 0; i < m->dof; i++) sum_add(&state->eta[i], x[i]);
    return true;
}

static laconic_status out_of_range(laconic_refusal *why) {
    return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
}

laconic_status laconic_articulated_project(laconic_articulated_state *state, const laconic_articulated_model *m,
                                           const articulated_drive *drive, laconic_refusal *why) {
    articulated_sweep s;
    real eta[LACONIC_MAX_VELOCITIES], x[LACONIC_MAX_VELOCITIES];
    if (m->row_count == 0) return LACONIC_OK;
    take_posture_of(&s, m, state);
    take_eta(eta, m, state);
    laconic_status status = sweep_or_refuse(&s, m, eta, drive, why);
    if (status == LACONIC_OK) status = impulse(x, &s, m, s.twist, why);
    if (status == LACONIC_OK && !add_to_eta(state, m, x)) status = out_of_range(why);
    return status;
}

laconic_status laconic_articulated_take_drive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                              const articulated_drive *drive, laconic_refusal *why) {
    articulated_sweep s;
    articulated_drive old;
    vector before[BODIES];
    real eta[LACONIC_MAX_VELOCITIES], x[LACONIC_MAX_VELOCITIES];
    laconic_articulated_drive_kept(&old, m, state);
    take_posture_of(&s, m, state);
    take_eta(eta, m, state);
    laconic_status status = sweep_or_refuse(&s, m, eta, &old, why);
    for (int32_t b = 0; status == LACONIC_OK && b <= m->body_count; b++) before[b] = s.twist[b];
    if (status == LACONIC_OK) status = sweep_or_refuse(&s, m, eta, drive, why);
    if (status == LACONIC_OK) status = impulse(x, &s, m, before, why);
    if (status == LACONIC_OK && !add_to_eta(state, m, x)) status = out_of_range(why);
    if (status == LACONIC_OK) laconic_articulated_keep_drive(state, m, drive);
    return status;
}

void laconic_articulated_keep_drive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                    const articulated_drive *drive) {
    for (int32_t b = 0; b < m->body_count; b++) state->hinge_rate_rad_per_s[b] = drive->rate[b];
    state->twist = drive->twist[0];
    state->twist_rate = drive->twist[1];
}

/* ----------------------------------------------------------------------------------- starts -- */

laconic_status laconic_articulated_check_start_number(real value, laconic_field field, int32_t item, real largest,
                                                      laconic_refusal *why) {
    if (!is_finite(value)) return refuse(why, LACONIC_NOT_FINITE, field, item, value, R(0));
    if (!(magnitude(value) < LARGEST_YAW_CHANGE_RAD) || magnitude(value) > largest)
        return refuse(why, LACONIC_OVERFLOW, field, item, value, R(0));
    return LACONIC_OK;
}

laconic_status laconic_articulated_check_start(const laconic_articulated_start *start, real largest,
                                               laconic_refusal *why) {
    const real numbers[] = {
        start->velocity_m_per_s[0], start->velocity_m_per_s[1], start->yaw_rate_rad_per_s, start->x_m, start->y_m,
        start->heading_rad};
    const laconic_field fields[] = {OF(START_VELOCITY),    OF(START_VELOCITY),    OF(START_YAW_RATE),
                                    LACONIC_FIELD_START_X, LACONIC_FIELD_START_Y, LACONIC_FIELD_START_HEADING};
    laconic_status status = LACONIC_OK;
    for (int32_t k = 0; status == LACONIC_OK && k < 6; k++)
        status = laconic_articulated_check_start_number(numbers[k], fields[k], k < 2 ? k + 1 : 0, largest, why);
    return status;
}

laconic_status laconic_articulated_check_hinge_start(const laconic_articulated_start *start, int32_t b, real largest,
                                                     laconic_refusal *why) {
    const laconic_status status =
        laconic_articulated_check_start_number(start->hinge_angle_rad[b - 1], OF(START_HINGE_ANGLE), b, largest, why);
    if (status != LACONIC_OK) return status;
    return laconic_articulated_check_start_number(start->hinge_rate_rad_per_s[b - 1], OF(START_HINGE_RATE), b, largest,
                                                  why);
}

/* What a heading can count is the least bound. */
static laconic_status check_articulated_start(const laconic_articulated_model *m,
                                              const laconic_articulated_start *start, laconic_refusal *why) {
    laconic_status status = laconic_articulated_check_start(start, LACONIC_REAL_MAX, why);
    for (int32_t b = 1; status == LACONIC_OK && b <= m->body_count; b++)
        status = laconic_articulated_check_hinge_start(start, b, LACONIC_REAL_MAX, why);
    return status;
}

/* Twists of all bodies at the given rates. */
static void given_twists(vector twist[], const articulated_sweep *s, const laconic_articulated_model *m,
                         const laconic_articulated_start *start) {
    twist[0] = vector_of(start->velocity_m_per_s[0], start->velocity_m_per_s[1], start->yaw_rate_rad_per_s);
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        twist[b] = carried(link, s->toward[b - 1], twist[link->parent]);
        twist[b].z += link->motion <= LACONIC_MOTION_OWN ? start->hinge_rate_rad_per_s[b - 1] : s->rate[b - 1];
    }
}

/* Coordinated hinges: the angle next to the given one that the twist asks for. */
static void set_hinges(laconic_articulated_state *state, const laconic_articulated_model *m,
                       const laconic_articulated_start *start, const articulated_drive *drive) {
    articulated_increment by;
    for (int32_t b = 0; b < m->body_count; b++) heading_advance(&state->hinge[b], start->hinge_angle_rad[b]);
    laconic_articulated_turn_coordinated(&by, m, state, drive);
    for (int32_t b = 0; b < m->body_count; b++)
        if (m->link[b].motion == LACONIC_MOTION_COORDINATED) heading_advance(&state->hinge[b], by.turn_rad[b]);
}

/* √(2 · energy of the difference / mass of all bodies) */
static real size_of_change(const laconic_articulated_model *m, const vector a[], const vector b[]) {
    real mass = m->mass_kg, twice_energy = R(0);
    for (int32_t k = 0; k <= m->body_count; k++) {
        const vector change = minus(a[k], b[k]);
        twice_energy += dot(change, form_times(k == 0 ? &m->inertia : &m->link[k - 1].inertia, change));
        if (k > 0) mass += m->link[k - 1].first_moment.z;
    }
    return laconic_root(twice_energy / mass);
}

static laconic_status find_motion(laconic_articulated_state *state, real *change, const laconic_articulated_model *m,
                                  const laconic_articulated_start *start, const articulated_drive *drive,
                                  laconic_refusal *why) {
    const real at_rest[LACONIC_MAX_VELOCITIES] = {R(0)};
    articulated_sweep s;
    vector given[BODIES];
    real x[LACONIC_MAX_VELOCITIES];
    take_posture_of(&s, m, state);
    laconic_status status = sweep_or_refuse(&s, m, at_rest, drive, why);
    if (status != LACONIC_OK) return status;
    given_twists(given, &s, m, start);
    status = impulse(x, &s, m, given, why);
    if (status != LACONIC_OK) return status;
    if (!add_to_eta(state, m, x)) return out_of_range(why);
    (void)sweep_outward(&s, m, x, drive);
    *change = size_of_change(m, given, s.twist);
    return LACONIC_OK;
}

laconic_status laconic_articulated_state_set(laconic_articulated_state *state, laconic_real *change_m_per_s,
                                             const laconic_articulated_model *model,
                                             const laconic_articulated_start *start,
                                             const laconic_articulated_input *input, laconic_refusal *why) {
    laconic_articulated_state fresh = ALL_ZERO;
    articulated_drive drive;
    real change;
    laconic_status status = check_articulated_start(model, start, why);
    if (status == LACONIC_OK) status = laconic_articulated_input_check(model, input, why);
    if (status != LACONIC_OK) return status;
    laconic_articulated_drive_of(&drive, model, input);
    if (model->coordinated) status = laconic_articulated_check_twist(model, &drive, &drive, R(1), why);
    if (status != LACONIC_OK) return status;
    set_hinges(&fresh, model, start, &drive);
    fresh.x_m = sum_of(start->x_m);
    fresh.y_m = sum_of(start->y_m);
    heading_advance(&fresh.heading, start->heading_rad);
    laconic_articulated_keep_drive(&fresh, model, &drive);
    status = find_motion(&fresh, &change, model, start, &drive, why);
    if (status != LACONIC_OK) return status;
    if (change_m_per_s != NULL) *change_m_per_s = change;
    *state = fresh;
    return LACONIC_OK;
}

/* ----------------------------------------------------------------------------- what a step adds -- */

void laconic_articulated_turn_coordinated(articulated_increment *by, const laconic_articulated_model *m,
                                          const laconic_articulated_state *state, const articulated_drive *end) {
    for (int32_t b = 1; m->coordinated && b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const direction before = direction_of_heading(&state->hinge[b - 1]);
        if (link->motion == LACONIC_MOTION_COORDINATED)
            by->turn_rad[b - 1] = laconic_articulated_angle_of(from_to(before, twist_at_hinge(link, end->twist[0])));
    }
}

/* The displacement of S_0 in axes of the heading at mid-step, from mean and bend of X_0: as for every vehicle. */
static pose_change displacement_of(const articulated_increment *by, real h) {
    const vector path = scaled(h, by->mean[0]), bend = scaled(h, by->bend);
    real sinc, half_j1;
    chord_factors(&sinc, &half_j1, R(0.5) * path.z);
    const real yaw_bend = bend.z * (R(1) / R(12));
    const real aside_forth = half_j1 * bend.x - yaw_bend * path.x, aside_left = half_j1 * bend.y - yaw_bend * path.y;
    const pose_change moved = {sinc * path.x - aside_left, sinc * path.y + aside_forth, path.z};
    return moved;
}

/* Every angle and path of the step is finite and below what a heading can count. */
static bool in_step_range(const laconic_articulated_state *state, const laconic_articulated_model *m,
                          const articulated_increment *by, const pose_change *moved, real h) {
    real square_size = R(0),
         paths = magnitude(moved->along_m) + magnitude(moved->across_m) + magnitude(moved->yaw_change_rad);
    for (int32_t i = 0; i < m->dof; i++) {
        const real eta = state->eta[i].value + by->eta[i];
        square_size += eta * eta;
    }
    for (int32_t b = 0; b < m->body_count; b++) paths += magnitude(by->turn_rad[b]) + h * size(by->mean[b + 1]);
    return square_size <= LARGEST_ETA * LARGEST_ETA && paths < LARGEST_YAW_CHANGE_RAD;
}

static bool headings_have_room(const laconic_articulated_state *state, const laconic_articulated_model *m) {
    bool have = heading_has_room(&state->heading);
    for (int32_t b = 0; b < m->body_count; b++) have = have && heading_has_room(&state->hinge[b]);
    return have;
}

laconic_status laconic_articulated_accept(laconic_articulated_state *state, const laconic_articulated_model *m,
                                          const articulated_increment *by, real h) {
    const pose_change moved = displacement_of(by, h);
    if (!in_step_range(state, m, by, &moved, h) || !headings_have_room(state, m)) return LACONIC_OVERFLOW;
    for (int32_t i = 0; i < m->dof; i++) {
        sum_add(&state->eta[i], by->eta[i]);
        state->eta[i].value = (state->eta[i].value + AT_REST) - AT_REST;
    }
    for (int32_t b = 0; b < m->body_count; b++) heading_advance(&state->hinge[b], by->turn_rad[b]);
    for (int32_t b = 0; LACONIC_WITH_WHEEL_ANGLES && b <= m->body_count; b++)
        add_to_sums(state->travel[b], scaled(h, by->mean[b]));
    const direction middle = direction_of_binary_angle(heading_advance(&state->heading, moved.yaw_change_rad));
    sum_add(&state->x_m, middle.cosine * moved.along_m - middle.sine * moved.across_m);
    sum_add(&state->y_m, middle.sine * moved.along_m + middle.cosine * moved.across_m);
    return LACONIC_OK;
}

#endif
