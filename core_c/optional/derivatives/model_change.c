/* How a model changes with its vehicle. The axes ζ stay normalised, GᵀAG = E, but do not turn: the change of G is
 *     dG = dGp + G S,      dGp = −C⁺ dC G,      S = −½ (GᵀAG)',
 * the first keeps the constraints C ν = 0, the second the energy. S is symmetric, so no rates are compared and none may
 * not coincide; the damping's change is then a full matrix. */
#include "geometry.h"
#include "step_change.h"

typedef struct body_change {
    body now;
    real mass_kg, com_x_m, com_y_m, radius_m;
    real yaw_scale_share; /* dΛ/Λ                */
    real torque_scale;    /* d(1/(M R²))         */
} body_change;

static body_change body_change_of(const laconic_vehicle *vehicle, const laconic_vehicle *by) {
    const laconic_payload *load = &vehicle->payload, *more = &by->payload;
    body_change c;
    laconic_body_of(&c.now, vehicle);
    const real mass = c.now.mass_kg, share = load->mass_kg / mass, m = vehicle->mass_kg;
    const real dx = load->x_m - vehicle->com_x_m, dy = load->y_m - vehicle->com_y_m, apart = dx * dx + dy * dy;
    const real ddx = more->x_m - by->com_x_m, ddy = more->y_m - by->com_y_m;
    const real inertia = vehicle->yaw_inertia_kgm2 + load->yaw_inertia_kgm2 + share * m * apart;
    c.mass_kg = by->mass_kg + more->mass_kg;
    const real d_share = (more->mass_kg - share * c.mass_kg) / mass;
    const real d_inertia = by->yaw_inertia_kgm2 + more->yaw_inertia_kgm2 + (d_share * m + share * by->mass_kg) * apart +
                           R(2) * share * m * (dx * ddx + dy * ddy);
    c.com_x_m = by->com_x_m + d_share * dx + share * ddx;
    c.com_y_m = by->com_y_m + d_share * dy + share * ddy;
    c.radius_m = by->wheel_radius_m;
    c.yaw_scale_share = R(0.5) * (d_inertia / inertia - c.mass_kg / mass) - c.radius_m / c.now.radius_m;
    c.torque_scale =
        -(c.mass_kg / mass + R(2) * c.radius_m / c.now.radius_m) / (mass * c.now.radius_m * c.now.radius_m);
    return c;
}

/* The change of a line's row (d_ξ, d_η, lever/(R Λ)), d turning by `turn`; without a factor. */
static vector line_change(const body_change *c, const laconic_wheel *wheel, const laconic_wheel *by, direction d,
                          real turn, vector *row) {
    const real x = wheel->x_m - c->now.com_x_m, y = wheel->y_m - c->now.com_y_m;
    const real scale = c->now.radius_m * c->now.yaw_scale, lever = x * d.sine - y * d.cosine;
    const real d_lever =
        (by->x_m - c->com_x_m) * d.sine - (by->y_m - c->com_y_m) * d.cosine + turn * (x * d.cosine + y * d.sine);
    const real share = c->radius_m / c->now.radius_m + c->yaw_scale_share;
    *row = vector_of(d.cosine, d.sine, lever / scale);
    return vector_of(-turn * d.sine, turn * d.cosine, (d_lever - share * lever) / scale);
}

/* The change of a wheel's values: its own where it has own ones. */
static wheel_values values_change(const laconic_vehicle *vehicle, const laconic_vehicle *by, int32_t i) {
    wheel_values d = {by->wheel_radius_m, by->wheel_inertia_kgm2, by->motor_gain_Nm_per_V, by->motor_damping_Nms};
#if LACONIC_WITH_OWN_WHEELS
    const laconic_wheel *w = &vehicle->wheel[i], *dw = &by->wheel[i];
    if (magnitude(w->own_radius_m) > R(0)) d.radius_m = dw->own_radius_m;
    if (magnitude(w->own_inertia_kgm2) > R(0)) d.inertia_kgm2 = dw->own_inertia_kgm2;
    if (magnitude(w->own_motor_gain_Nm_per_V) > R(0)) d.motor_gain_Nm_per_V = dw->own_motor_gain_Nm_per_V;
    if (magnitude(w->own_motor_damping_Nms) > R(0)) d.motor_damping_Nms = dw->own_motor_damping_Nms;
    if (w->undriven) d.motor_gain_Nm_per_V = d.motor_damping_Nms = R(0);
#else
    (void)vehicle, (void)i;
#endif
    return d;
}

/* The row of Ξ and its change. */
static vector wheel_row_change(const body_change *c, const laconic_vehicle *vehicle, const laconic_vehicle *by,
                               int32_t i, vector *row) {
    const laconic_wheel *w = &vehicle->wheel[i], *dw = &by->wheel[i];
    const bool rolls = w->kind != LACONIC_WHEEL_FIXED;
    const real radius = laconic_wheel_values(vehicle, i).radius_m;
    direction pull, roller = {R(0), R(1)};
    const real sine = laconic_pull_direction(&pull, w);
    if (rolls) roller = laconic_direction_of_angle(w->roller_rad);
    const real d_roller = rolls ? dw->roller_rad : R(0), factor = c->now.radius_m / (radius * sine);
    const real share = c->radius_m / c->now.radius_m - values_change(vehicle, by, i).radius_m / radius -
                       roller.cosine / sine * d_roller;
    vector line;
    const vector change = line_change(c, w, dw, pull, dw->axle_rad + d_roller, &line);
    *row = scaled(factor, line);
    return scaled(factor, added(change, share, line));
}

/* ------------------------------------------------------------------------------ constraints -- */

/* Symmetric 3×3: a += factor (u vᵀ + v uᵀ). */
static void add_products(real a[3][3], real factor, vector u, vector v) {
    const real x[3] = {u.x, u.y, u.z}, y[3] = {v.x, v.y, v.z};
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) a[j][k] += factor * (x[j] * y[k] + y[j] * x[k]);
}

/* Rows of A⁻¹ of a symmetric matrix. */
static void invert_symmetric(real out[3][3], const real a[3][3]) {
    const vector c0 = cross(vec(a[1]), vec(a[2])), c1 = cross(vec(a[2]), vec(a[0])), c2 = cross(vec(a[0]), vec(a[1]));
    const real scale = R(1) / dot(vec(a[0]), c0);
    store(out[0], scaled(scale, c0));
    store(out[1], scaled(scale, c1));
    store(out[2], scaled(scale, c2));
}

/* Column k of G. */
static inline vector axis_of(const laconic_model *m, int k) {
    return vector_of(m->nu_of_zeta[0][k], m->nu_of_zeta[1][k], m->nu_of_zeta[2][k]);
}

/* Row k of G⁺, and the projector G G⁺ onto the allowed motions. */
static void inverse_rows_of(real inverse[3][3], const laconic_model *m) {
    for (int i = 0; i < 3; i++) {
        const real nu[3] = {R(i == 0), R(i == 1), R(i == 2)};
        const vector zeta = zeta_of_nu(m, nu);
        inverse[0][i] = zeta.x;
        inverse[1][i] = zeta.y;
        inverse[2][i] = zeta.z;
    }
}

static void projector_of(real allowed[3][3], const laconic_model *m, const real inverse[3][3]) {
    for (int i = 0; i < 3; i++) store(allowed[i], transposed_rows(inverse, vec(m->nu_of_zeta[i])));
}

/* Rows c with cᵀν = 0 of all fixed and locked wheels: Σ c cᵀ, and for each axis Σ c (dc · axis). */
typedef struct constraint_sums {
    real products[3][3];
    vector pushed[3];
} constraint_sums;

/* A constraint is the same whatever its row's length. That of a locked wheel may be long, as R/R_i and 1/sin γ are, and
 * so may a lever: beside the fourth power of their length the projector's own 1 would have no digits. */
static void add_constraint_row(constraint_sums *sums, const laconic_model *m, vector row, vector change) {
    const real share = R(1) / size(row);
    const vector short_row = scaled(share, row);
    add_products(sums->products, R(0.5), short_row, short_row);
    for (int k = 0; k < 3; k++) sums->pushed[k] = added(sums->pushed[k], share * dot(change, axis_of(m, k)), short_row);
}

static void sum_constraints(constraint_sums *sums, const laconic_model *m, const body_change *c,
                            const laconic_vehicle *vehicle, const laconic_vehicle *by) {
    vector row;
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        const laconic_wheel *w = &vehicle->wheel[i];
        if (w->kind == LACONIC_WHEEL_FIXED) {
            const direction axle = laconic_direction_of_angle(w->axle_rad);
            const vector change = line_change(c, w, &by->wheel[i], axle, by->wheel[i].axle_rad, &row);
            add_constraint_row(sums, m, row, change);
        }
        if (w->locked) {
            const vector change = wheel_row_change(c, vehicle, by, i, &row);
            add_constraint_row(sums, m, row, change);
        }
    }
}

/* −C⁺ dC G by its columns, C⁺ = (CᵀC)⁺Cᵀ, (CᵀC)⁺ = (CᵀC + P)⁻¹ − P with the projector P. */
static void keep_constraints(vector axis_change[3], const laconic_model *m, const body_change *c,
                             const laconic_vehicle *vehicle, const laconic_vehicle *by, const real allowed[3][3]) {
    constraint_sums sums = {{{R(0)}}, {none, none, none}};
    real inverse[3][3];
    for (int k = 0; k < 3; k++) axis_change[k] = none;
    if (m->dof == 3) return;
    sum_constraints(&sums, m, c, vehicle, by);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) sums.products[i][k] += allowed[i][k];
    invert_symmetric(inverse, (const real(*)[3])sums.products);
    for (int k = 0; k < m->dof; k++)
        axis_change[k] =
            minus(mapped_rows(allowed, sums.pushed[k]), mapped_rows((const real(*)[3])inverse, sums.pushed[k]));
}

/* ---------------------------------------------------------------------------- energy and damping -- */

/* Changes of the forms GᵀAG and GᵀDG with the vehicle and dGp, and of the wheels' rows of ΞG. */
typedef struct form_changes {
    real energy[3][3], damping[3][3];
} form_changes;

static void add_wheel(form_changes *f, laconic_model_change *out, const laconic_model *m, const body_change *c,
                      const laconic_vehicle *vehicle, const laconic_vehicle *by, const vector axis_change[3],
                      int32_t i) {
    const wheel_values now = laconic_wheel_values(vehicle, i), d = values_change(vehicle, by, i);
    const real t = m->torque_scale, dt = c->torque_scale;
    vector row;
    const vector change = wheel_row_change(c, vehicle, by, i, &row), speed = vec(m->wheel_of_zeta[i]);
    vector d_speed = vector_of(dot(change, axis_of(m, 0)), dot(change, axis_of(m, 1)), dot(change, axis_of(m, 2)));
    d_speed = plus(d_speed, vector_of(dot(row, axis_change[0]), dot(row, axis_change[1]), dot(row, axis_change[2])));
    out->voltage_scale[i] = d.motor_gain_Nm_per_V * t + now.motor_gain_Nm_per_V * dt;
    if (vehicle->wheel[i].locked) return;
    store(out->wheel_of_zeta[i], d_speed);
    add_products(f->energy, R(0.5) * (d.inertia_kgm2 * t + now.inertia_kgm2 * dt), speed, speed);
    add_products(f->energy, now.inertia_kgm2 * t, d_speed, speed);
    add_products(f->damping, R(0.5) * (d.motor_damping_Nms * t + now.motor_damping_Nms * dt), speed, speed);
    add_products(f->damping, now.motor_damping_Nms * t, d_speed, speed);
}

/* S = −½ (GᵀAG)' in the form's place; then what it adds to the damping. */
static void renormalise(form_changes *f, const laconic_model *m, const vector axis_change[3]) {
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            const real moved = dot(axis_of(m, j), axis_change[k]) + dot(axis_change[j], axis_of(m, k));
            f->energy[j][k] = R(-0.5) * (f->energy[j][k] + moved);
        }
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) f->damping[j][k] += f->energy[j][k] * (m->decay_per_s[j] + m->decay_per_s[k]);
}

/* ------------------------------------------------------------------------------- the model -- */

/* dG = dGp + G S, and the rows that follow from it. S is symmetric, so row · S = S row. */
static void change_rows(laconic_model_change *out, const laconic_model *m, const body_change *c, const form_changes *f,
                        const vector axis_change[3]) {
    const vector dx = vector_of(axis_change[0].x, axis_change[1].x, axis_change[2].x);
    const vector dy = vector_of(axis_change[0].y, axis_change[1].y, axis_change[2].y);
    const vector dz = vector_of(axis_change[0].z, axis_change[1].z, axis_change[2].z), moved[3] = {dx, dy, dz};
    for (int i = 0; i < 3; i++)
        store(out->nu_of_zeta[i], plus(moved[i], mapped_rows(f->energy, vec(m->nu_of_zeta[i]))));
    for (int32_t i = 0; i < m->wheel_count; i++)
        store(out->wheel_of_zeta[i],
              plus(vec(out->wheel_of_zeta[i]), mapped_rows(f->energy, vec(m->wheel_of_zeta[i]))));
    for (int i = 0; i < 2; i++)
        store(out->velocity_of_zeta[i],
              plus(scaled(c->radius_m, vec(m->nu_of_zeta[i])), scaled(c->now.radius_m, vec(out->nu_of_zeta[i]))));
    store(out->yaw_rate_of_zeta,
          added(scaled(R(1) / m->yaw_scale, vec(out->nu_of_zeta[2])), -c->yaw_scale_share, vec(m->yaw_rate_of_zeta)));
    const vector w = plus(cross(vec(out->nu_of_zeta[0]), vec(m->nu_of_zeta[1])),
                          cross(vec(m->nu_of_zeta[0]), vec(out->nu_of_zeta[1])));
    store(out->gyro, added(scaled(R(1) / m->yaw_scale, w), -c->yaw_scale_share, vec(m->gyro)));
}

/* d(G⁺) = −G⁺ dG G⁺ + (GᵀG)⁻¹ dGᵀ (1 − P), (GᵀG)⁻¹ = G⁺G⁺ᵀ. */
static void change_inverse(laconic_model_change *out, const real inverse[3][3], const real allowed[3][3]) {
    const real(*change)[3] = (const real(*)[3])out->nu_of_zeta;
    for (int i = 0; i < 3; i++) {
        const vector unit = vector_of(R(i == 0), R(i == 1), R(i == 2)), in = mapped_rows(allowed, unit);
        const vector straight = mapped_rows(inverse, mapped_rows(change, mapped_rows(inverse, unit)));
        const vector across = mapped_rows(inverse, transposed_rows(inverse, transposed_rows(change, minus(unit, in))));
        const vector column = minus(across, straight);
        out->zeta_of_nu[0][i] = column.x;
        out->zeta_of_nu[1][i] = column.y;
        out->zeta_of_nu[2][i] = column.z;
    }
}

static void change_slope(laconic_model_change *out, const laconic_vehicle *vehicle, const laconic_vehicle *by,
                         const body_change *c) {
#if LACONIC_WITH_SLOPE
    const direction incline = laconic_direction_of_angle(vehicle->ground.slope_rad);
    const direction uphill = laconic_direction_of_angle(vehicle->ground.slope_heading_rad);
    const real g = R(LACONIC_GRAVITY_M_PER_S2), pull = c->now.mass_kg * g * incline.sine;
    const real d_pull = g * (c->mass_kg * incline.sine + c->now.mass_kg * incline.cosine * by->ground.slope_rad);
    const real turned = pull * by->ground.slope_heading_rad;
    out->slope_force_N[0] = turned * uphill.sine - d_pull * uphill.cosine;
    out->slope_force_N[1] = -turned * uphill.cosine - d_pull * uphill.sine;
#else
    (void)out, (void)vehicle, (void)by, (void)c;
#endif
}

laconic_status laconic_model_tangent(laconic_model_change *change, const laconic_model *model,
                                     const laconic_vehicle *vehicle, const laconic_vehicle *by) {
    laconic_model_change out = ALL_ZERO;
    form_changes forms = {{{R(0)}}, {{R(0)}}};
    vector axis_change[3];
    real inverse[3][3], allowed[3][3];
    if (laconic_vehicle_has_friction(vehicle)) return LACONIC_METHOD_WITHOUT_FRICTION;
    const body_change c = body_change_of(vehicle, by);
    inverse_rows_of(inverse, model);
    projector_of(allowed, model, (const real(*)[3])inverse);
    keep_constraints(axis_change, model, &c, vehicle, by, (const real(*)[3])allowed);
    out.torque_scale = c.torque_scale;
    for (int32_t i = 0; i < vehicle->wheel_count; i++) add_wheel(&forms, &out, model, &c, vehicle, by, axis_change, i);
    renormalise(&forms, model, axis_change);
    for (int j = 0; j < 3; j++) store(out.damping_per_s[j], vec(forms.damping[j]));
    change_rows(&out, model, &c, &forms, axis_change);
    change_inverse(&out, (const real(*)[3])inverse, (const real(*)[3])allowed);
    change_slope(&out, vehicle, by, &c);
    *change = out;
    return LACONIC_OK;
}
