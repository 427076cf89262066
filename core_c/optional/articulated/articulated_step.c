/* One step: checks of the input, a jump of what is commanded, and the method; methods by name and number. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

#define SAME_DIRECTION (R(100) * LACONIC_RANK_TOLERANCE) /* sine: of a twist that goes on as it was */

static const char *const method_names[LACONIC_ARTICULATED_METHOD_COUNT] = {LACONIC_ARTICULATED_METHOD_NAMES};

const char *laconic_articulated_method_name(int32_t method) {
    return method >= 0 && method < LACONIC_ARTICULATED_METHOD_COUNT ? method_names[method] : "";
}

static bool same_name(const char *a, const char *b) {
    for (; *a != '\0' && *a == *b; a++) b++;
    return *a == *b;
}

int32_t laconic_articulated_method_by_name(const char *name) {
    for (int32_t i = 0; i < LACONIC_ARTICULATED_METHOD_COUNT; i++)
        if (same_name(method_names[i], name)) return i;
    return -1;
}

/* ------------------------------------------------------------------------------------ inputs -- */

void laconic_articulated_ramp(laconic_articulated_input *start, laconic_articulated_input *end, laconic_real step_s) {
    for (int k = 0; k < LACONIC_MAX_BODIES; k++)
        start->hinge_acceleration_rad_per_s2[k] = end->hinge_acceleration_rad_per_s2[k] =
            (end->hinge_rate_rad_per_s[k] - start->hinge_rate_rad_per_s[k]) / step_s;
    for (int k = 0; k < 3; k++) start->twist_rate[k] = end->twist_rate[k] = (end->twist[k] - start->twist[k]) / step_s;
}

static laconic_status check_hinge_numbers(const real *numbers, int32_t count, laconic_articulated_field field,
                                          laconic_refusal *why) {
    for (int32_t i = 0; i < count; i++)
        if (!is_finite(numbers[i]))
            return refuse(why, LACONIC_NOT_FINITE, (laconic_field)field, i + 1, numbers[i], R(0));
    return LACONIC_OK;
}

static laconic_status check_base_input(const laconic_articulated_model *m, const laconic_input *input,
                                       laconic_refusal *why) {
    laconic_model wheels = ALL_ZERO;
    wheels.wheel_count = m->wheel_count;
    return laconic_input_check(&wheels, input, why);
}

laconic_status laconic_articulated_input_check(const laconic_articulated_model *model,
                                               const laconic_articulated_input *input, laconic_refusal *why) {
    const int32_t n = model->body_count;
    laconic_status status = check_base_input(model, &input->base, why);
    if (status == LACONIC_OK)
        status = check_hinge_numbers(input->hinge_voltage_V, n, LACONIC_FIELD_OF_HINGE_VOLTAGE, why);
    if (status == LACONIC_OK)
        status = check_hinge_numbers(input->hinge_torque_Nm, n, LACONIC_FIELD_OF_HINGE_TORQUE, why);
    if (status == LACONIC_OK)
        status = check_hinge_numbers(input->hinge_rate_rad_per_s, n, LACONIC_FIELD_OF_HINGE_RATE, why);
    if (status == LACONIC_OK)
        status = check_hinge_numbers(input->hinge_acceleration_rad_per_s2, n, LACONIC_FIELD_OF_HINGE_ACCELERATION, why);
    if (status == LACONIC_OK) status = check_hinge_numbers(input->twist, 3, LACONIC_FIELD_OF_TWIST, why);
    if (status == LACONIC_OK) status = check_hinge_numbers(input->twist_rate, 3, LACONIC_FIELD_OF_TWIST_RATE, why);
    return status;
}

/* Finite, or names the number. */
static laconic_status check_drive_numbers(const articulated_drive *drive, const laconic_articulated_model *m,
                                          const laconic_articulated_input *input, laconic_refusal *why) {
    if (laconic_articulated_drive_is_finite(drive, m)) return LACONIC_OK;
    const laconic_status status = laconic_articulated_input_check(m, input, why);
    return status != LACONIC_OK ? status : refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
}

/* ------------------------------------------------------------------------------------- jumps -- */

static bool differs(real a, real b) { return !(a == b); }

static bool vectors_differ(vector a, vector b) { return differs(a.x, b.x) || differs(a.y, b.y) || differs(a.z, b.z); }

static bool commands_jump(const laconic_articulated_state *state, const laconic_articulated_model *m,
                          const articulated_drive *drive) {
    bool jump = m->coordinated &&
                (vectors_differ(state->twist, drive->twist[0]) || vectors_differ(state->twist_rate, drive->twist[1]));
    for (int32_t b = 0; b < m->body_count; b++) jump = jump || differs(state->hinge_rate_rad_per_s[b], drive->rate[b]);
    return jump;
}

static laconic_status follow_jump(laconic_articulated_state *state, const laconic_articulated_model *m,
                                  const articulated_drive *drive, laconic_refusal *why) {
    articulated_drive kept;
    if (!commands_jump(state, m, drive)) return LACONIC_OK;
    laconic_articulated_drive_kept(&kept, m, state);
    if (m->coordinated) {
        const laconic_status status = laconic_articulated_check_twist(m, &kept, drive, SAME_DIRECTION, why);
        if (status != LACONIC_OK) return status;
    }
    return laconic_articulated_take_drive(state, m, drive, why);
}

laconic_status laconic_articulated_jump(const laconic_articulated_model *model, laconic_articulated_state *state,
                                        const laconic_articulated_input *input, laconic_refusal *why) {
    laconic_articulated_state after = *state;
    articulated_drive drive;
    laconic_articulated_drive_of(&drive, model, input);
    laconic_status status = check_drive_numbers(&drive, model, input, why);
    if (status == LACONIC_OK) status = follow_jump(&after, model, &drive, why);
    if (status == LACONIC_OK) *state = after;
    return status;
}

/* ------------------------------------------------------------------------------------- steps -- */

/* Drives at both ends; the course is constant where nothing changes and nothing is commanded that has a derivative. */
static laconic_status take_course(articulated_course *course, const laconic_articulated_model *m,
                                  const laconic_articulated_integrator *integrator,
                                  const laconic_articulated_input *start, const laconic_articulated_input *end,
                                  laconic_refusal *why) {
    course->step_s = integrator->step_s;
    course->rate_per_step = integrator->rate_per_step;
    laconic_articulated_drive_of(&course->start, m, start);
    laconic_status status = check_drive_numbers(&course->start, m, start, why);
    if (status != LACONIC_OK) return status;
    course->constant = start == end;
    for (int32_t b = 0; b < m->body_count; b++)
        if (course->start.acceleration[b] != R(0)) course->constant = false;
    if (course->start.turns) course->constant = false;
    if (course->constant) return LACONIC_OK;
    laconic_articulated_drive_of(&course->end, m, end);
    status = check_drive_numbers(&course->end, m, end, why);
    if (status != LACONIC_OK) return status;
    laconic_articulated_course_of(course, m);
    if (!m->coordinated) return LACONIC_OK;
    return laconic_articulated_check_twist(m, &course->start, &course->end, R(1), why);
}

static laconic_status by_method(laconic_articulated_state *state, const laconic_articulated_model *m,
                                const laconic_articulated_integrator *integrator, const articulated_course *course,
                                laconic_refusal *why) {
    switch (integrator->method) {
    case LACONIC_ARTICULATED_RK4:
        return laconic_articulated_rk4(state, m, course, R(0), R(1), false, LARGEST_EXPLICIT_RATE, why);
    case LACONIC_ARTICULATED_CIRCLE:
        return laconic_articulated_rk4(state, m, course, R(0), R(1), true, LARGEST_EXPLICIT_RATE, why);
    case LACONIC_ARTICULATED_MOEBIUS_4:
        return laconic_articulated_moebius_4(state, m, integrator->factors, course, R(0), R(1), why);
    default: return laconic_articulated_auto(state, m, integrator, course, why);
    }
}

/* Methods that may refuse after they changed the state, and jumps before a step, work on a copy. */
RARE laconic_status step_on_copy(laconic_articulated_state *state, const laconic_articulated_model *m,
                                 const laconic_articulated_integrator *integrator, const articulated_course *course,
                                 laconic_refusal *why) {
    laconic_articulated_state after = *state;
    laconic_status status = follow_jump(&after, m, &course->start, why);
    if (status == LACONIC_OK) status = by_method(&after, m, integrator, course, why);
    if (status == LACONIC_OK) *state = after;
    return status;
}

laconic_status laconic_articulated_step(const laconic_articulated_model *model,
                                        const laconic_articulated_integrator *integrator,
                                        laconic_articulated_state *state, const laconic_articulated_input *start,
                                        const laconic_articulated_input *end, laconic_refusal *why) {
    articulated_course course;
    laconic_status status = take_course(&course, model, integrator, start, end, why);
    if (status != LACONIC_OK) return status;
    const bool projects = integrator->method == LACONIC_ARTICULATED_MOEBIUS_4 && model->row_count > 0;
    if (projects || commands_jump(state, model, &course.start))
        status = step_on_copy(state, model, integrator, &course, why);
    else
        status = by_method(state, model, integrator, &course, why);
    if (status == LACONIC_OK && !course.constant) laconic_articulated_keep_drive(state, model, &course.end);
    return status;
}

#endif
