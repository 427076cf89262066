/* The state of a vehicle with hinges: from start values, from the continuous states of Model Exchange, and back; and
 * what Model Exchange asks of them. */
#include "core_words.h"
#include "parts.h"

/* Of the size of a start, what rounding may change of it. */
#define ALLOWED_CHANGE 1e-9

/* ------------------------------------------------------------------------------------ starts -- */

/* Twist of a body's origin, seen by the body, at the angle of its hinge. */
static laconic_vector carried_to(const laconic_link *link, const laconic_heading *hinge, laconic_vector parent) {
    laconic_heading back = *hinge;
    laconic_vector at = {0.0, 0.0, parent.z};
    double turned[2];
    back.fraction = (laconic_binary_angle)(0U - hinge->fraction);
    fmu_turn(turned, &back, parent.x - parent.z * link->hinge.y, parent.y + parent.z * link->hinge.x);
    at.x = turned[0];
    at.y = turned[1];
    return at;
}

/* Rates of hinges behind which wheels roll, as these wheels ask for them; the others as they are given. */
static void find_rolling_rates(laconic_articulated_start *start, const laconic_articulated_model *m,
                               const laconic_articulated_state *posture) {
    laconic_vector twist[LACONIC_MAX_BODIES + 1] = {
        {start->velocity_m_per_s[0], start->velocity_m_per_s[1], start->yaw_rate_rad_per_s}};
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const laconic_vector parent = twist[link->parent];
        laconic_vector *own = &twist[b];
        *own = carried_to(link, &posture->hinge[b - 1], parent);
        if (link->motion == LACONIC_MOTION_FOLLOWING)
            own->z = -(link->axle_per_lever.x * own->x + link->axle_per_lever.y * own->y);
        else
            own->z += link->motion == LACONIC_MOTION_OWN ? start->hinge_rate_rad_per_s[b - 1]
                                                         : posture->hinge_rate_rad_per_s[b - 1];
        start->hinge_rate_rad_per_s[b - 1] = own->z - parent.z;
    }
}

static laconic_articulated_start standing(const laconic_articulated_start *start) {
    laconic_articulated_start still = *start;
    still.velocity_m_per_s[0] = still.velocity_m_per_s[1] = still.yaw_rate_rad_per_s = 0.0;
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) still.hinge_rate_rad_per_s[b] = 0.0;
    return still;
}

/* The nearest motion to the start values that wheels and commands allow; writes by how much it differs. */
static laconic_status set_start(fmu_model *self, double *change_m_per_s, const laconic_articulated_input *commands,
                                laconic_refusal *why) {
    laconic_articulated_start start = standing(&self->start);
    laconic_status status =
        laconic_articulated_state_set(&self->state, change_m_per_s, &self->prepared, &start, commands, why);
    if (status != LACONIC_OK) return status;
    start = self->start;
    find_rolling_rates(&start, &self->prepared, &self->state);
    return laconic_articulated_state_set(&self->state, change_m_per_s, &self->prepared, &start, commands, why);
}

static bool is_allowed(const fmu_model *self, double change_m_per_s) {
    const double *v = self->start.velocity_m_per_s, yaw = self->start.yaw_rate_rad_per_s;
    const double square_size = 1.0 + v[0] * v[0] + v[1] * v[1] + yaw * yaw;
    return change_m_per_s * change_m_per_s <= ALLOWED_CHANGE * ALLOWED_CHANGE * square_size;
}

static laconic_articulated_input without_rates(const laconic_articulated_input *input) {
    laconic_articulated_input still = *input;
    for (int b = 0; b < LACONIC_MAX_BODIES; b++)
        still.hinge_rate_rad_per_s[b] = still.hinge_acceleration_rad_per_s2[b] = 0.0;
    for (int k = 0; k < 3; k++) still.twist_rate[k] = 0.0;
    return still;
}

/* The start is a motion with the rates that are commanded, or one before that: then they jump at its beginning. */
laconic_status fmu_articulated_start(fmu_model *self, bool *allowed, laconic_refusal *why) {
    const laconic_articulated_input still = without_rates(&self->input);
    double change_m_per_s;
    laconic_status status = set_start(self, &change_m_per_s, &self->input, why);
    *allowed = status == LACONIC_OK && is_allowed(self, change_m_per_s);
    if (status != LACONIC_OK || *allowed) return status;
    const laconic_articulated_state nearest = self->state;
    status = set_start(self, &change_m_per_s, &still, why);
    *allowed = status == LACONIC_OK && is_allowed(self, change_m_per_s);
    if (*allowed) return laconic_articulated_jump(&self->prepared, &self->state, &self->input, why);
    self->state = nearest;
    return status;
}

fmu_status fmu_articulated_refuse_start(const fmu_instance *instance) {
    const fmu_model *self = &instance->model;
    laconic_articulated_motion nearest;
    laconic_articulated_motion_of(&nearest, &self->prepared, &self->state);
    return fmu_refuse(
        instance,
        "start_velocity_m_per_s: this start makes a fixed wheel slide; the nearest motion that all wheels "
        "allow is %.6g, %.6g m/s with start_yaw_rate_rad_per_s %.6g",
        nearest.velocity_m_per_s[0], nearest.velocity_m_per_s[1], nearest.yaw_rate_rad_per_s);
}

/* ------------------------------------------------------------------------- continuous states -- */

static bool is_own(const fmu_model *self, int32_t b) { return self->prepared.link[b].motion == LACONIC_MOTION_OWN; }

static laconic_sum *own_velocity(fmu_model *self, int32_t b) {
    return &self->state.eta[self->prepared.carriage_dof + self->prepared.link[b].column];
}

void fmu_articulated_show_state(fmu_model *self) {
    const laconic_articulated_motion *m = &self->motion;
    fmu_moving *at = &self->at;
    at->x_m = m->x_m;
    at->y_m = m->y_m;
    at->heading_rad = m->heading_rad;
    for (int32_t k = 0; k < 3; k++) at->zeta[k] = k < self->prepared.carriage_dof ? self->state.eta[k].value : 0.0;
    for (int32_t b = 0; b < LACONIC_MAX_BODIES; b++) {
        const bool there = b < self->prepared.body_count;
        at->hinge_rad[b] = there ? m->hinge_angle_rad[b] : 0.0;
        at->own[b] = there && is_own(self, b) ? own_velocity(self, b)->value : 0.0;
    }
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++)
        at->wheel_angle_rad[i] = i < self->prepared.wheel_count ? m->wheel_angle_rad[i] : 0.0;
}

laconic_status fmu_articulated_take_state(fmu_model *self, const laconic_articulated_input *input,
                                          laconic_refusal *why) {
    const fmu_moving *at = &self->at;
    laconic_articulated_start start = standing(&self->start);
    start.x_m = at->x_m;
    start.y_m = at->y_m;
    start.heading_rad = at->heading_rad;
    for (int32_t b = 0; b < self->prepared.body_count; b++) start.hinge_angle_rad[b] = at->hinge_rad[b];
    const laconic_status status =
        laconic_articulated_state_set(&self->state, NULL, &self->prepared, &start, input, why);
    if (status != LACONIC_OK) return status;
    for (int32_t k = 0; k < self->prepared.carriage_dof; k++) {
        self->state.eta[k].value = at->zeta[k];
        self->state.eta[k].rest = 0.0;
    }
    for (int32_t b = 0; b < self->prepared.body_count; b++) {
        if (!is_own(self, b)) continue;
        own_velocity(self, b)->value = at->own[b];
        own_velocity(self, b)->rest = 0.0;
    }
    laconic_articulated_wheel_angles_set(&self->prepared, &self->state, at->wheel_angle_rad);
    return LACONIC_OK;
}

/* --------------------------------------------- continuous states, slopes, and no partial derivatives -- */

/* Calls `visit` for each list of states in the order of the description. */
#define EACH_LIST(visit, moving, bodies, wheels) \
    visit(&(moving)->x_m, 1); \
    visit(&(moving)->y_m, 1); \
    visit(&(moving)->heading_rad, 1); \
    visit((moving)->hinge_rad, bodies); \
    visit((moving)->wheel_angle_rad, wheels); \
    visit((moving)->zeta, 3); \
    visit((moving)->own, bodies)

#define COPY_OUT(list, count) \
    for (uint32_t k = 0; k < (count); k++) *values++ = (list)[k]
#define COPY_IN(list, count) \
    for (uint32_t k = 0; k < (count); k++) (list)[k] = *values++

uint32_t fmu_model_state_count(const fmu_model *model) {
    return 6U + 2U * FMU_MODEL_OTHER_ARRAY_SIZE(model) + FMU_MODEL_ARRAY_SIZE(model);
}

static void copy_out(const fmu_moving *moving, const fmu_model *self, double *values) {
    EACH_LIST(COPY_OUT, moving, FMU_MODEL_OTHER_ARRAY_SIZE(self), FMU_MODEL_ARRAY_SIZE(self));
}

void fmu_model_get_states(fmu_instance *instance, double *values) {
    fmu_model_refresh(instance, FMU_GROUP_PLACE);
    copy_out(&instance->model.at, &instance->model, values);
}

void fmu_model_before_set_state(fmu_instance *instance) {
    fmu_model_refresh(instance, FMU_GROUP_PLACE);
    instance->model.stale = FMU_GROUPS_ALL & ~FMU_GROUP_PLACE;
}

void fmu_model_set_states(fmu_instance *instance, const double *values) {
    fmu_model *self = &instance->model;
    fmu_moving *moving = &self->at;
    EACH_LIST(COPY_IN, moving, FMU_MODEL_OTHER_ARRAY_SIZE(self), FMU_MODEL_ARRAY_SIZE(self));
    self->stale = FMU_GROUPS_ALL & ~FMU_GROUP_PLACE;
}

void fmu_model_get_rates(fmu_instance *instance, double *values) {
    fmu_model_refresh(instance, FMU_GROUP_RATES);
    copy_out(&instance->model.rate, &instance->model, values);
}

void fmu_model_get_nominals(const fmu_model *model, double *values) {
    for (uint32_t i = 0; i < fmu_model_state_count(model); i++) values[i] = 1.0;
    for (uint32_t i = 0; i < FMU_MODEL_ARRAY_SIZE(model); i++) values[3 + FMU_MODEL_OTHER_ARRAY_SIZE(model) + i] = 10.0;
}

/* ------------------------------------------------------------------------ partial derivatives -- */

fmu_status fmu_model_check_tangent(const fmu_instance *instance) {
    return fmu_refuse(instance, "a vehicle with hinges has no derivatives of outputs yet; take differences of runs");
}

void fmu_model_tangent(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance;
    (void)tangent;
}

void fmu_model_motion_seed(fmu_instance *instance, fmu_tangent *tangent) {
    (void)instance;
    (void)tangent;
}

void fmu_model_set_slope(fmu_model *model, uint32_t tangent_offset, double slope) {
    *(double *)(void *)((char *)&model->slope + tangent_offset) = slope;
}
