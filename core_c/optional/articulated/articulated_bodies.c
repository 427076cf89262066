/* Bodies on hinges: their wheels, their inertia and drag, and what their fixed and locked wheels ask for. A body with
 * wheels is one carriage of equation (4.7) in its own frame:
 *
 *     I = [[m, 0, −m s_η], [0, m, m s_ξ], [·, ·, I_s + m s²]] + Σ J ρᵀρ,     D = Σ c2 ρᵀρ,     χ' = ρ·X
 *
 * A fixed wheel asks for n·V + ℓω = 0, a locked one for ρ·X = 0. Rows of one body that depend on each other count once.
 * Of a free or motor hinge the row with the largest lever gives ω = −n·V/ℓ, and what is left of the others are rows on
 * V alone; all rows of other hinges are left over. */
#include "articulated_vehicle.h"

#if LACONIC_MAX_BODIES > 0

/* ---------------------------------------------------------------------------------- wheels -- */

static vector line_through(direction d, real x, real y) {
    return vector_of(d.cosine, d.sine, x * d.sine - y * d.cosine);
}

static laconic_articulated_wheel wheel_on_body(const laconic_articulated_vehicle *vehicle, int32_t i, real x, real y) {
    const laconic_wheel *w = &vehicle->base.wheel[i];
    const wheel_values values = laconic_wheel_values(&vehicle->base, i);
    laconic_articulated_wheel out = ALL_ZERO;
    direction pull;
    const real sine = laconic_pull_direction(&pull, w);
    out.body = vehicle->wheel_body[i];
    out.inverse_arm_per_m = R(1) / (values.radius_m * sine);
    out.pull = line_through(pull, x, y);
    out.roll = scaled(out.inverse_arm_per_m, out.pull);
    if (w->kind == LACONIC_WHEEL_FIXED) out.axle = line_through(laconic_direction_of_angle(w->axle_rad), x, y);
    out.inertia_kgm2 = values.inertia_kgm2;
    out.gain_Nm_per_V = values.motor_gain_Nm_per_V;
    out.damping_Nms = values.motor_damping_Nms;
    out.locked = w->locked;
    return out;
}

void laconic_articulated_wheels(laconic_articulated_model *m, const laconic_articulated_vehicle *vehicle) {
    m->wheel_count = vehicle->base.wheel_count;
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_wheel *w = &vehicle->base.wheel[i];
        const bool on_carriage = vehicle->wheel_body[i] == 0;
        m->wheel[i] = wheel_on_body(vehicle, i, on_carriage ? w->x_m - m->com_x_m : w->x_m,
                                    on_carriage ? w->y_m - m->com_y_m : w->y_m);
    }
}

static void add_outer_square(laconic_form *f, real factor, vector v) {
    f->xx += factor * v.x * v.x;
    f->xy += factor * v.x * v.y;
    f->yy += factor * v.y * v.y;
    f->xw += factor * v.x * v.z;
    f->yw += factor * v.y * v.z;
    f->ww += factor * v.z * v.z;
}

void laconic_articulated_add_wheel(laconic_form *inertia, laconic_form *drag, const laconic_articulated_wheel *wheel) {
    add_outer_square(inertia, wheel->inertia_kgm2, wheel->roll);
    add_outer_square(drag, wheel->damping_Nms, wheel->roll);
}

/* ---------------------------------------------------------------------------- rows of one body -- */

typedef struct body_rows {
    int32_t count;
    vector row[3]; /* orthonormal, with levers over the vehicle's length */
    int32_t wheel[3];
} body_rows;

static void add_row(body_rows *known, vector row, int32_t wheel) {
    const real length = laconic_root(square(row));
    if (known->count == 3 || !(length > R(0))) return;
    row = scaled(R(1) / length, row);
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t k = 0; k < known->count; k++) row = minus(row, scaled(dot(row, known->row[k]), known->row[k]));
        if (!(square(row) > LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE)) return;
    }
    known->row[known->count] = scaled(R(1) / laconic_root(square(row)), row);
    known->wheel[known->count++] = wheel;
}

static vector in_lengths(vector row, real length) { return vector_of(row.x, row.y, row.z / length); }

static body_rows rows_of_body(const laconic_articulated_model *m, int32_t b) {
    body_rows known = ALL_ZERO;
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_articulated_wheel *w = &m->wheel[i];
        if (w->body != b) continue;
        if (square(w->axle) > R(0)) add_row(&known, in_lengths(w->axle, m->length_m), i);
        if (w->locked) add_row(&known, in_lengths(w->pull, m->length_m), i);
    }
    return known;
}

static void leave_row(laconic_articulated_model *m, int32_t b, vector row, int32_t wheel) {
    laconic_left_row *left = &m->row[m->row_count++];
    left->body = b;
    left->wheel = wheel;
    left->axle = vector_of(row.x, row.y, magnitude(row.z) > R(8) * LACONIC_EPSILON ? row.z * m->length_m : R(0));
}

/* The row whose lever is largest; −1: none has one beside the vehicle's size. */
static int32_t row_with_lever(const body_rows *rows) {
    int32_t best = -1;
    real lever = LACONIC_RANK_TOLERANCE;
    for (int32_t k = 0; k < rows->count; k++)
        if (magnitude(rows->row[k].z) > lever) {
            lever = magnitude(rows->row[k].z);
            best = k;
        }
    return best;
}

/* The row gives ω; it is taken out of the others, so that they are rows on V. */
static void follow_row(laconic_link *link, body_rows *rows, int32_t k, real length) {
    const vector row = rows->row[k];
    const real inverse = R(1) / (row.z * length);
    link->motion = LACONIC_MOTION_FOLLOWING;
    link->axle_per_lever = vector_of(row.x * inverse, row.y * inverse, R(0));
    for (int32_t j = 0; j < rows->count; j++) {
        if (j == k) continue;
        vector rest = minus(rows->row[j], scaled(rows->row[j].z / row.z, row));
        rest.z = R(0);
        rows->row[j] = scaled(R(1) / laconic_root(square(rest)), rest);
    }
}

static laconic_status refuse_coordinated(const body_rows *rows, laconic_refusal *why) {
    for (int32_t k = 0; k < rows->count; k++) {
        const vector row = rows->row[k];
        if (magnitude(row.x) > LACONIC_RANK_TOLERANCE || magnitude(row.z) > LACONIC_RANK_TOLERANCE)
            return refuse(why, LACONIC_COORDINATED_WHEEL, LACONIC_FIELD_AXLE, rows->wheel[k] + 1, R(0), R(0));
    }
    return LACONIC_OK;
}

static laconic_status classify(laconic_articulated_model *m, laconic_hinge_kind kind, int32_t b, laconic_refusal *why) {
    laconic_link *link = &m->link[b - 1];
    body_rows rows = rows_of_body(m, b);
    int32_t followed = -1;
    link->column = -1;
    if (kind == LACONIC_HINGE_COORDINATED) {
        link->motion = LACONIC_MOTION_COORDINATED;
        m->coordinated = true;
        return refuse_coordinated(&rows, why);
    }
    link->motion = kind == LACONIC_HINGE_PRESCRIBED ? LACONIC_MOTION_PRESCRIBED : LACONIC_MOTION_OWN;
    if (kind != LACONIC_HINGE_PRESCRIBED) followed = row_with_lever(&rows);
    if (followed >= 0) follow_row(link, &rows, followed, m->length_m);
    if (link->motion == LACONIC_MOTION_OWN) link->column = m->own_count++;
    link->first_row = m->row_count;
    for (int32_t k = 0; k < rows.count; k++)
        if (k != followed) leave_row(m, b, rows.row[k], rows.wheel[k]);
    link->row_end = m->row_count;
    return LACONIC_OK;
}

/* ---------------------------------------------------------------------------------- links -- */

static void fill_link(laconic_link *link, const laconic_articulated_model *m, const laconic_body *hung) {
    const real sx = hung->com_x_m, sy = hung->com_y_m, mass = hung->mass_kg;
    const laconic_form inertia = {mass,       R(0),      mass,
                                  -mass * sy, mass * sx, hung->yaw_inertia_kgm2 + mass * (sx * sx + sy * sy)};
    const bool on_carriage = hung->parent == 0, acts = hung->hinge <= LACONIC_HINGE_MOTOR;
    link->parent = hung->parent;
    link->hinge = vector_of(on_carriage ? hung->hinge_x_m - m->com_x_m : hung->hinge_x_m,
                            on_carriage ? hung->hinge_y_m - m->com_y_m : hung->hinge_y_m, R(0));
    link->first_moment = vector_of(mass * sx, mass * sy, mass);
    link->inertia = inertia;
    link->damping_Nms = acts ? hung->damping_Nms : R(0);
    link->stiffness_Nm = acts ? hung->stiffness_Nm : R(0);
    link->rest_rad = hung->rest_rad;
    link->gain_Nm_per_V = hung->hinge == LACONIC_HINGE_MOTOR ? hung->gain_Nm_per_V : R(0);
}

static void add_wheels_of(laconic_articulated_model *m, int32_t b) {
    laconic_link *link = &m->link[b - 1];
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->wheel[i].body == b) laconic_articulated_add_wheel(&link->inertia, &link->drag, &m->wheel[i]);
    link->drags = link->drag.xx + link->drag.yy + link->drag.ww > R(0);
}

/* Marks which own hinges and rows belong to a body or hang on it. */
static void mark_below(laconic_articulated_model *m) {
    for (int32_t r = 0; r < m->row_count; r++) m->link[m->row[r].body - 1].rows_below |= (uint32_t)1 << r;
    for (int32_t b = m->body_count; b >= 1; b--) {
        laconic_link *link = &m->link[b - 1];
        if (link->column >= 0) link->own_below |= (uint32_t)1 << link->column;
        if (link->parent == 0) continue;
        m->link[link->parent - 1].own_below |= link->own_below;
        m->link[link->parent - 1].rows_below |= link->rows_below;
    }
}

/* I and D on V alone, with ω = −n·V/ℓ. */
static laconic_form followed(const laconic_link *link, const laconic_form *f) {
    const plane_form plane = plane_part(link, f);
    const laconic_form on_velocity = {plane.xx, plane.xy, plane.yy, R(0), R(0), R(0)};
    return on_velocity;
}

static void mark_leaves(laconic_articulated_model *m) {
    for (int32_t b = 0; b < m->body_count; b++) m->link[b].is_leaf = true;
    for (int32_t b = 0; b < m->body_count; b++) {
        laconic_link *link = &m->link[b];
        link->followed_inertia = followed(link, &link->inertia);
        link->followed_drag = followed(link, &link->drag);
        if (link->parent == 0) continue;
        m->link[link->parent - 1].is_leaf = false;
        if (link->parent > m->last_inner) m->last_inner = link->parent;
    }
    for (int32_t b = 0; b < m->body_count; b++)
        m->link[b].is_plain_follower =
            m->link[b].is_leaf && m->link[b].motion == LACONIC_MOTION_FOLLOWING && m->link[b].rows_below == 0U;
}

laconic_status laconic_articulated_links(laconic_articulated_model *m, const laconic_articulated_vehicle *vehicle,
                                         laconic_refusal *why) {
    m->body_count = vehicle->body_count;
    for (int32_t b = 1; b <= m->body_count; b++) {
        fill_link(&m->link[b - 1], m, &vehicle->body[b - 1]);
        add_wheels_of(m, b);
        const laconic_status status = classify(m, vehicle->body[b - 1].hinge, b, why);
        if (status != LACONIC_OK) return status;
    }
    mark_below(m);
    mark_leaves(m);
    return LACONIC_OK;
}

#endif
