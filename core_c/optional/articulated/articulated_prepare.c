/* Articulated vehicle → model. The carriage alone is prepared as a vehicle of laconic.h: its ζ carry the constraints of
 * its own wheels exactly. Each body on a hinge is a carriage in its own frame (articulated_bodies.c). */
#include "articulated_vehicle.h"

#if LACONIC_MAX_BODIES > 0

/* The carriage with its own wheels alone; number[i] is the wheel's number in the whole vehicle. */
static void carriage_alone(laconic_vehicle *alone, int32_t number[], const laconic_articulated_vehicle *vehicle) {
    *alone = vehicle->base;
    alone->wheel_count = 0;
    alone->support_count = 0;
    for (int32_t i = 0; i < vehicle->base.wheel_count; i++)
        if (vehicle->wheel_body[i] == 0) {
            number[alone->wheel_count] = i + 1;
            alone->wheel[alone->wheel_count++] = vehicle->base.wheel[i];
        }
}

static laconic_status prepare_carriage(laconic_model *model, const laconic_articulated_vehicle *vehicle,
                                       laconic_refusal *why) {
    laconic_vehicle alone;
    int32_t number[LACONIC_MAX_WHEELS];
    laconic_refusal found = ALL_ZERO;
    carriage_alone(&alone, number, vehicle);
    const laconic_status status = laconic_prepare_ideal(model, &alone, &found);
    if (status == LACONIC_OK) return status;
    const bool names_wheel = found.item > 0 && found.item <= alone.wheel_count;
    return refuse(why, status, found.field, names_wheel ? number[found.item - 1] : found.item, found.value,
                  found.limit);
}

/* Columns of unit energy: the carriage's ζ has the energy ½ M R² |ζ|². */
static void take_columns(laconic_articulated_model *m, const laconic_model *carriage) {
    const real scale = laconic_root(carriage->torque_scale);
    m->carriage_dof = m->column_count = carriage->dof;
    for (int32_t k = 0; k < carriage->dof; k++) {
        m->column[k] = scaled(scale, vector_of(carriage->velocity_of_zeta[0][k], carriage->velocity_of_zeta[1][k],
                                               carriage->yaw_rate_of_zeta[k]));
        m->decay_per_s[k] = carriage->decay_per_s[k];
    }
}

/* Coefficients of aᵀ A b in the six entries of A. */
static laconic_form pair_of(vector a, vector b) {
    const laconic_form pair = {
        a.x * b.x, a.x * b.y + a.y * b.x, a.y * b.y, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y, a.z * b.z};
    return pair;
}

static void take_pairs(laconic_articulated_model *m) {
    for (int32_t i = 0, k = 0; i < 3; i++)
        for (int32_t j = 0; j <= i; j++) m->pair[k++] = pair_of(m->column[i], m->column[j]);
}

/* Rows with row·X_0 = 0 for every motion that the carriage's own wheels allow. */
static void take_held(laconic_articulated_model *m) {
    const vector a = m->column[0];
    m->held_count = 3 - m->column_count;
    if (m->column_count == 2) m->held[0] = cross(a, m->column[1]);
    if (m->column_count != 1) return;
    const bool along_x = magnitude(a.x) > magnitude(a.y) && magnitude(a.x) > magnitude(a.z);
    m->held[0] = cross(a, along_x ? vector_of(R(0), R(1), R(0)) : vector_of(R(1), R(0), R(0)));
    m->held[1] = cross(a, m->held[0]);
}

static void take_carriage(laconic_articulated_model *m, const laconic_model *carriage) {
    const real spread = carriage->yaw_scale * carriage->wheel_radius_m;
    const laconic_form inertia = {
        carriage->mass_kg, R(0), carriage->mass_kg, R(0), R(0), carriage->mass_kg * spread * spread};
    m->mass_kg = carriage->mass_kg;
    m->com_x_m = carriage->com_x_m;
    m->com_y_m = carriage->com_y_m;
    m->inertia = inertia;
    m->length_m = spread;
    take_columns(m, carriage);
    take_pairs(m);
    take_held(m);
#if LACONIC_WITH_SLOPE
    if (carriage->sloped)
        m->slope_acceleration = vector_of(carriage->slope_force_N[0] / carriage->mass_kg,
                                          carriage->slope_force_N[1] / carriage->mass_kg, R(0));
#endif
}

static void widen(real *length, real x, real y) {
    if (magnitude(x) > *length) *length = magnitude(x);
    if (magnitude(y) > *length) *length = magnitude(y);
}

static real length_of(const laconic_articulated_model *m, const laconic_articulated_vehicle *vehicle) {
    real length = m->length_m;
    for (int32_t i = 0; i < vehicle->base.wheel_count; i++)
        widen(&length, vehicle->base.wheel[i].x_m, vehicle->base.wheel[i].y_m);
    for (int32_t b = 0; b < vehicle->body_count; b++) {
        widen(&length, vehicle->body[b].hinge_x_m, vehicle->body[b].hinge_y_m);
        widen(&length, vehicle->body[b].com_x_m, vehicle->body[b].com_y_m);
    }
    return length;
}

static void add_carriage_wheels(laconic_articulated_model *m) {
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->wheel[i].body == 0) laconic_articulated_add_wheel(&m->inertia, &m->drag, &m->wheel[i]);
}

static real form_size(const laconic_form *f) {
    return magnitude(f->xx) + magnitude(f->xy) + magnitude(f->yy) + magnitude(f->xw) + magnitude(f->yw) +
           magnitude(f->ww);
}

/* No constant, and no product of two, is beyond the range. */
static bool all_usable(const laconic_articulated_model *m) {
    real sum =
        form_size(&m->inertia) + form_size(&m->drag) + m->length_m + m->fastest_decay_per_s + m->fastest_swing_per_s;
    for (int k = 0; k < 3; k++) sum += size(m->column[k]) + m->decay_per_s[k];
    for (int32_t b = 0; b < m->body_count; b++) {
        const laconic_link *link = &m->link[b];
        sum += size(link->hinge) + size(link->first_moment) + size(link->axle_per_lever) + form_size(&link->inertia) +
               form_size(&link->drag) + link->damping_Nms + link->stiffness_Nm + magnitude(link->gain_Nm_per_V);
    }
    for (int32_t i = 0; i < m->wheel_count; i++)
        sum += size(m->wheel[i].roll) + magnitude(m->wheel[i].inverse_arm_per_m) + magnitude(m->wheel[i].gain_Nm_per_V);
    return fits_squared(sum);
}

/* A twist commands one motion: wheels must hold the carriage to it. Axle lines that a posture happens to join count. */
static laconic_status check_held(const laconic_articulated_model *m, laconic_refusal *why) {
    int32_t lines = 3 - m->column_count;
    for (int32_t b = 1; b <= m->body_count; b++) {
        bool fixed = false;
        for (int32_t i = 0; i < m->wheel_count; i++)
            fixed = fixed || (m->wheel[i].body == b && square(m->wheel[i].axle) > R(0));
        if (fixed && m->link[b - 1].motion == LACONIC_MOTION_COORDINATED) lines++;
    }
    if (!m->coordinated || lines >= 2) return LACONIC_OK;
    return refuse(why, LACONIC_COORDINATED_TOO_FEW, (laconic_field)LACONIC_FIELD_OF_BODY_COUNT, 0, (real)lines, R(2));
}

static void count_velocities(laconic_articulated_model *m) {
    if (m->coordinated) m->carriage_dof = 1;
    m->dof = m->carriage_dof + m->own_count;
}

void LACONIC_BUILT_BODIES(void) {}

laconic_status laconic_articulated_prepare(laconic_articulated_model *model, const laconic_articulated_vehicle *vehicle,
                                           laconic_refusal *why) {
    laconic_articulated_model m = ALL_ZERO;
    laconic_model carriage;
    laconic_status status = laconic_articulated_check(vehicle, why);
    if (status == LACONIC_OK) status = prepare_carriage(&carriage, vehicle, why);
    if (status != LACONIC_OK) return status;
    take_carriage(&m, &carriage);
    m.length_m = length_of(&m, vehicle);
    m.friction_coefficient = vehicle->base.friction_coefficient;
    laconic_articulated_wheels(&m, vehicle);
    add_carriage_wheels(&m);
    status = laconic_articulated_links(&m, vehicle, why);
    if (status == LACONIC_OK) status = check_held(&m, why);
    if (status != LACONIC_OK) return status;
    count_velocities(&m);
    if (!all_usable(&m)) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    status = laconic_articulated_examine(&m, why);
    if (status != LACONIC_OK) return status;
    if (!all_usable(&m)) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *model = m;
    return LACONIC_OK;
}

#endif
