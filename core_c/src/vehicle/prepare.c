/* vehicle → model: an orthonormal basis of the motions that the constraints leave, rotated so that Σ J_i Ξ_iᵀΞ_i, and
 * with it the inertia A = E + Σ J_i/(M R²) Ξ_iᵀΞ_i, is diagonal in it. Where c2_i : J_i is the same for all wheels, the
 * damping Σ c2_i/(M R²) Ξ_iᵀΞ_i then is diagonal, too; else the axes, scaled so that A is 1, are rotated once more. */
#include "geometry.h"
#include "step_internals.h"

typedef struct basis {
    int32_t count;
    real axis[3][3]; /* orthonormal, one to a row */
} basis;

static bool normalise(real v[3]) {
    const real scale = size(vec(v));
    if (!(scale > R(0))) return false;
    for (int k = 0; k < 3; k++) v[k] /= scale; /* first, so that squares neither overflow nor vanish */
    const real length = laconic_root(dot(vec(v), vec(v)));
    for (int k = 0; k < 3; k++) v[k] /= length;
    return true;
}

static void remove_component(real v[3], const real unit[3]) {
    const real along = dot(vec(v), vec(unit));
    for (int k = 0; k < 3; k++) v[k] -= along * unit[k];
}

/* Makes of a row its direction beyond the known constraints; false where it depends on them but for rounding. */
static bool new_direction(real v[3], const basis *known) {
    if (!normalise(v)) return false;
    for (int32_t k = 0; k < known->count; k++) remove_component(v, known->axis[k]);
    if (!(dot(vec(v), vec(v)) > LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE)) return false;
    for (int32_t k = 0; k < known->count; k++) remove_component(v, known->axis[k]); /* again, for rounding */
    return normalise(v);
}

static void add_constraint(basis *known, const real row[3]) {
    real v[3];
    for (int k = 0; k < 3; k++) v[k] = row[k];
    if (known->count < 3 && new_direction(v, known)) {
        for (int k = 0; k < 3; k++) known->axis[known->count][k] = v[k];
        known->count++;
    }
}

/* What part of its way a wheel would slide along a constraint row in the one motion that two known constraints leave:
 * the sine of the angle by which the wheel misses that motion. */
static real slide_of(const basis *known, const body *b, const laconic_wheel *wheel, const real row[3]) {
    const vector motion = cross(vec(known->axis[0]), vec(known->axis[1]));
    const real per_yaw = R(1) / (b->radius_m * b->yaw_scale);
    const real vx = motion.x - (wheel->y_m - b->com_y_m) * per_yaw * motion.z;
    const real vy = motion.y + (wheel->x_m - b->com_x_m) * per_yaw * motion.z;
    const real way = laconic_root((vx * vx + vy * vy) * (row[0] * row[0] + row[1] * row[1]));
    const real part = magnitude(dot(vec(row), motion)) / way;
    return is_finite(part) ? part : R(0); /* a way beyond all numbers, or none */
}

/* Refuses the wheel that takes the last motion; `why` may be NULL. */
static laconic_status collect_constraints(basis *known, const body *b, const laconic_vehicle *vehicle,
                                          laconic_refusal *why) {
    known->count = 0;
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        real rows[2][3];
        const int32_t count = laconic_constraint_rows(rows, b, &vehicle->wheel[i]);
        for (int32_t k = 0; k < count; k++) {
            const basis before = *known;
            add_constraint(known, rows[k]);
            if (known->count == 3)
                return refuse(why, LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, i + 1,
                              slide_of(&before, b, &vehicle->wheel[i], rows[k]), R(0));
        }
    }
    return LACONIC_OK;
}

/* Completes the constraints to a basis of all motions; the axes that are added span the allowed motions. */
static void allowed_motions(basis *allowed, const basis *constraints) {
    basis all = *constraints;
    for (int32_t axis = 0; axis < 3; axis++) {
        real unit[3] = {R(0), R(0), R(0)};
        unit[axis] = R(1);
        add_constraint(&all, unit);
    }
    allowed->count = all.count - constraints->count;
    for (int32_t k = 0; k < allowed->count; k++) {
        for (int c = 0; c < 3; c++) allowed->axis[k][c] = all.axis[constraints->count + k][c];
    }
}

/* Whether fixed wheels on parallel axle lines hold the heading. Lines that meet leave a rotation about their point. */
static bool goes_straight_only(const basis *allowed, const laconic_vehicle *vehicle) {
    for (int32_t i = 0; i < vehicle->wheel_count; i++)
        if (vehicle->wheel[i].locked) return false;
    return allowed->count == 1 && magnitude(allowed->axis[0][2]) < LACONIC_RANK_TOLERANCE;
}

/* Names the fixed wheel whose axle line lies farthest off that of the first one, and how far. */
static laconic_status refuse_straight(const laconic_vehicle *vehicle, laconic_refusal *why) {
    int32_t first = -1, farthest = -1;
    real most_m = R(0);
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        if (vehicle->wheel[i].kind != LACONIC_WHEEL_FIXED) continue;
        if (first < 0) first = farthest = i;
        const laconic_wheel *a = &vehicle->wheel[first], *w = &vehicle->wheel[i];
        const direction axle = laconic_direction_of_angle(a->axle_rad);
        const real off_m = magnitude((w->y_m - a->y_m) * axle.cosine - (w->x_m - a->x_m) * axle.sine);
        if (off_m > most_m) {
            most_m = off_m;
            farthest = i;
        }
    }
    return refuse(why, LACONIC_STRAIGHT_ONLY, LACONIC_FIELD_WHEEL_KIND, farthest + 1, most_m, R(0));
}

/* What the wheels contribute to a form: value_i = largest · share_i. */
typedef struct contributions {
    real largest;
    real share[LACONIC_OWN_WHEELS]; /* exactly 1 for wheels that are alike, also where all values are 0; builds for such
                                       wheels alone do not read it */
} contributions;

static contributions of_damping(const laconic_model *m) {
    contributions c = {R(0), {R(0)}};
    if (!LACONIC_WITH_OWN_WHEELS) {
        /* cannot be reached: of a core without own wheels */
        c.largest = m->wheel_count > 0 ? m->motor_damping_Nms[0] : R(0);
        return c;
    }
    for (int32_t i = 0; i < m->wheel_count; i++)
        if (m->motor_damping_Nms[own(i)] > c.largest) c.largest = m->motor_damping_Nms[own(i)];
    for (int32_t i = 0; i < m->wheel_count; i++)
        c.share[i] = c.largest > R(0) ? m->motor_damping_Nms[own(i)] / c.largest : R(1);
    return c;
}

/* One-sided Jacobi: rotates pairs of axes until the columns of Ξ V, weighted by the wheels' shares, are orthogonal. It
 * never forms the 3×3 matrix, so small rates keep their digits beside large ones. */
typedef struct pair {
    real aa, bb, ab;
} pair;

static pair column_products(const laconic_model *m, const real share[], int32_t a, int32_t b) {
    pair p = {R(0), R(0), R(0)};
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const real *row = m->wheel_of_zeta[i], weight = LACONIC_WITH_OWN_WHEELS ? share[i] : R(1);
        p.aa += weight * row[a] * row[a];
        p.bb += weight * row[b] * row[b];
        p.ab += weight * row[a] * row[b];
    }
    return p;
}

static void rotate_pair(real *a, real *b, direction d) {
    const real old = *a;
    *a = d.cosine * old - d.sine * *b;
    *b = d.sine * old + d.cosine * *b;
}

/* The columns of G, and the rows of G⁺, which turn with them. */
typedef struct axes {
    basis scaled;
    real inverse[3][3];
} axes;

static bool make_orthogonal(laconic_model *m, axes *v, const real share[], int32_t a, int32_t b) {
    const pair p = column_products(m, share, a, b);
    direction d;
    if (!(magnitude(p.ab) > R(0.25) * LACONIC_EPSILON * laconic_root(p.aa) * laconic_root(p.bb))) return false;
    const real cotangent = (p.bb - p.aa) / (R(2) * p.ab);
    real tangent = R(1) / (magnitude(cotangent) + laconic_root(R(1) + cotangent * cotangent));
    if (!is_finite(cotangent * cotangent)) tangent = R(0.5) / magnitude(cotangent);
    if (cotangent < R(0)) tangent = -tangent;
    const real q = laconic_root(R(1) + tangent * tangent);
    d.cosine = R(1) - tangent * tangent / (q * (q + R(1))); /* 1/q, but rounded once */
    d.sine = tangent / q;
    for (int32_t i = 0; i < m->wheel_count; i++) rotate_pair(&m->wheel_of_zeta[i][a], &m->wheel_of_zeta[i][b], d);
    for (int32_t i = 0; i < 3; i++) rotate_pair(&v->scaled.axis[a][i], &v->scaled.axis[b][i], d);
    for (int32_t i = 0; LACONIC_WITH_OWN_WHEELS && i < 3; i++) rotate_pair(&v->inverse[a][i], &v->inverse[b][i], d);
    return true;
}

static void find_principal_axes(laconic_model *m, axes *v, const real share[]) {
    bool rotated = true;
    /* Two to seven sweeps reach the precision of the scalar type. The threshold of make_orthogonal is below the
     * rounding of column_products, so for about one robot in ten rotations by such small angles would go on for ever:
     * 30 ends them. */
    for (int sweep = 0; sweep < 30 && rotated; sweep++) {
        rotated = false;
        for (int32_t a = 0; a < m->dof; a++)
            for (int32_t b = a + 1; b < m->dof; b++) rotated = make_orthogonal(m, v, share, a, b) || rotated;
    }
}

static void project_wheels(laconic_model *m, const basis *v, const body *b, const laconic_vehicle *vehicle) {
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        real row[3];
        laconic_wheel_row(row, b, &vehicle->wheel[i]);
        for (int32_t k = 0; k < 3; k++)
            m->wheel_of_zeta[i][k] = k < v->count && !vehicle->wheel[i].locked ? dot(vec(row), vec(v->axis[k])) : R(0);
    }
}

/* Scales axis k so that its kinetic energy is ζ²/2 (in units of M R²). The rate holds where damping has the shares. */
static void scale_axis(laconic_model *m, axes *v, const body *b, const real share[], real largest_damping, int32_t k) {
    const real x = column_products(m, share, k, k).aa;
    const real inertia = R(1) + b->wheel_scale_square * x;
    const real root = laconic_root(inertia);
    m->inertia[k] = inertia;
    m->decay_per_s[k] = largest_damping * m->torque_scale * x / inertia;
    for (int32_t i = 0; LACONIC_WITH_OWN_WHEELS && i < 3; i++) v->inverse[k][i] = v->scaled.axis[k][i] * root;
    for (int32_t i = 0; i < 3; i++) v->scaled.axis[k][i] /= root;
    for (int32_t i = 0; i < m->wheel_count; i++) m->wheel_of_zeta[i][k] /= root;
}

static bool same_shares(const real a[], const real b[], int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (a[i] < b[i] || a[i] > b[i]) return false;
    return true;
}

/* The second rotation, among axes for which A is 1: damping becomes diagonal, and A stays 1. */
static void rotate_to_damping(laconic_model *m, axes *v, const contributions *damping) {
    find_principal_axes(m, v, damping->share);
    for (int32_t k = 0; k < m->dof; k++)
        m->decay_per_s[k] = damping->largest * m->torque_scale * column_products(m, damping->share, k, k).aa;
#if LACONIC_WITH_OWN_WHEELS
    m->rotated_twice = true;
    for (int32_t k = 0; k < m->dof; k++)
        for (int32_t i = 0; i < 3; i++) m->zeta_of_nu[k][i] = v->inverse[k][i];
#endif
}

/* Both rotations. Where no wheel has inertia, A is 1 from the start: the first rotation makes the damping diagonal. */
static void diagonalise(laconic_model *m, axes *v, const body *b, const laconic_vehicle *vehicle) {
    const contributions damping = of_damping(m);
    real share[LACONIC_OWN_WHEELS] = {R(0)};
    const bool inert = b->wheel_scale_square > R(0);
    if (LACONIC_WITH_OWN_WHEELS) laconic_inertia_shares(share, vehicle);
    const real *first = inert ? share : damping.share;
    find_principal_axes(m, v, first);
    for (int32_t k = 0; k < m->dof; k++) scale_axis(m, v, b, first, damping.largest, k);
    if (LACONIC_WITH_OWN_WHEELS && damping.largest > R(0) && !same_shares(first, damping.share, m->wheel_count))
        rotate_to_damping(m, v, &damping);
    for (int32_t k = 0; k < 3; k++) {
        if (k >= m->dof) m->inertia[k] = R(1);
        for (int32_t i = 0; i < 3; i++) m->nu_of_zeta[i][k] = k < m->dof ? v->scaled.axis[k][i] : R(0);
    }
}

/* w, and the constants that the closed form of the free motion (exact_flow.c) computes from w. */
static void derive_gyro(laconic_model *m) {
    const vector g = vec(m->nu_of_zeta[2]);
    const vector w = scaled(R(1) / m->yaw_scale, cross(vec(m->nu_of_zeta[0]), vec(m->nu_of_zeta[1])));
    store(m->gyro, w);
    m->gyro_square = square(w);
    store(m->spin_gain, cross(w, g));
    store(m->spin_curve, minus(scaled(R(2) * dot(g, w), w), scaled(m->gyro_square, g)));
}

static void derive_rows(laconic_model *m) {
    for (int k = 0; k < 3; k++) {
        m->yaw_rate_of_zeta[k] = m->nu_of_zeta[2][k] / m->yaw_scale;
        m->velocity_of_zeta[0][k] = m->wheel_radius_m * m->nu_of_zeta[0][k];
        m->velocity_of_zeta[1][k] = m->wheel_radius_m * m->nu_of_zeta[1][k];
    }
}

static void fill_wheel(laconic_model *m, wheel_values values, int32_t i) {
    m->voltage_scale[i] = values.motor_gain_Nm_per_V * m->torque_scale;
    m->motor_gain_Nm_per_V[i] = values.motor_gain_Nm_per_V;
    m->motor_damping_Nms[i] = values.motor_damping_Nms;
    m->wheel_inertia_kgm2[i] = values.inertia_kgm2;
}

static void fill_constants(laconic_model *m, const laconic_vehicle *vehicle, const body *b) {
    m->wheel_count = vehicle->wheel_count;
    m->torque_scale = R(1) / (b->mass_kg * b->radius_m * b->radius_m);
    for (int32_t i = 0; i < LACONIC_OWN_WHEELS && i < m->wheel_count; i++)
        fill_wheel(m, laconic_wheel_values(vehicle, i), i);
    m->mass_kg = b->mass_kg;
    m->wheel_radius_m = b->radius_m;
    m->yaw_scale = b->yaw_scale;
    m->com_x_m = b->com_x_m;
    m->com_y_m = b->com_y_m;
}

laconic_real laconic_condition_number(const laconic_model *model) {
    real least = model->inertia[0], most = least;
    for (int32_t k = 1; k < model->dof; k++) {
        if (model->inertia[k] < least) least = model->inertia[k];
        if (model->inertia[k] > most) most = model->inertia[k];
    }
    return most / least;
}

/* The size of a scale and of its inverse: some formulas multiply by a scale, others divide by it. */
static real scale_size(real scale) { return magnitude(scale) + R(1) / magnitude(scale); }

/* No constant, and no product of two, is beyond the range: else steps or outputs would become NaN. The check covers
 * every constant, also those that only outputs or a change of the vehicle use. */
static bool usable(const laconic_model *m) {
    const real vectors = size(vec(m->inertia)) + size(vec(m->decay_per_s)) + size(vec(m->gyro)) +
                         size(vec(m->spin_gain)) + size(vec(m->spin_curve)) + size(vec(m->yaw_rate_of_zeta));
    const real rows =
        rows_size(m->nu_of_zeta, 3) + rows_size(m->velocity_of_zeta, 2) + rows_size(m->wheel_of_zeta, m->wheel_count);
    const real scales =
        scale_size(m->mass_kg) + scale_size(m->wheel_radius_m) + scale_size(m->yaw_scale) + scale_size(m->torque_scale);
    real others = m->gyro_square + magnitude(m->com_x_m) + magnitude(m->com_y_m);
    for (int32_t i = 0; i < LACONIC_OWN_WHEELS; i++)
        others += magnitude(m->voltage_scale[i]) + magnitude(m->motor_gain_Nm_per_V[i]) + m->motor_damping_Nms[i] +
                  m->wheel_inertia_kgm2[i];
    for (int k = 0; k < 3 && rotated_twice(m); k++) others += size(vec(inverse_row(m, k)));
    return fits_squared(vectors + rows + scales + others);
}

/* Names the wheel's own number that leaves the range by itself, if there is one. */
static laconic_status refuse_range(const laconic_model *m, const laconic_vehicle *vehicle, laconic_refusal *why) {
#if LACONIC_WITH_OWN_WHEELS
    const real scale = fits_squared(m->torque_scale) ? R(1) + m->torque_scale : R(1);
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        const laconic_wheel *w = &vehicle->wheel[i];
        const real value[4] = {w->own_radius_m, w->own_inertia_kgm2, w->own_motor_gain_Nm_per_V,
                               w->own_motor_damping_Nms};
        for (int k = 0; k < 4; k++) {
            const real size = magnitude(value[k]);
            if (size > R(0) && !fits_squared(k == 0 ? m->wheel_radius_m / size : scale * size))
                return refuse(why, LACONIC_OVERFLOW, (laconic_field)(LACONIC_FIELD_OWN_RADIUS + k), i + 1, value[k],
                              R(0));
        }
    }
#else
    (void)m;
    (void)vehicle;
#endif
    return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
}

/* Downhill: what pulls at the centre of mass, in world axes. */
static void fill_slope(laconic_model *m, const laconic_vehicle *vehicle) {
#if LACONIC_WITH_SLOPE
    const laconic_ground *ground = &vehicle->ground;
    const direction incline = laconic_direction_of_angle(ground->slope_rad);
    const direction uphill = laconic_direction_of_angle(ground->slope_heading_rad);
    const real pull = m->mass_kg * R(LACONIC_GRAVITY_M_PER_S2) * incline.sine;
    m->sloped = ground->slope_rad > R(0);
    m->slope_force_N[0] = m->sloped ? -pull * uphill.cosine : R(0);
    m->slope_force_N[1] = m->sloped ? -pull * uphill.sine : R(0);
#else
    (void)m;
    (void)vehicle;
#endif
}

/* `on_wheels`: without them the model is that of the body alone. */
static laconic_status prepare(laconic_model *model, const laconic_vehicle *vehicle, bool on_wheels,
                              laconic_refusal *why) {
    laconic_status status = laconic_vehicle_check(vehicle, why);
    laconic_model m = ALL_ZERO;
    basis constraints = ALL_ZERO;
    axes motions = ALL_ZERO;
    body b;
    if (status != LACONIC_OK) return status;
    laconic_body_of(&b, vehicle);
    fill_constants(&m, vehicle, &b);
    fill_slope(&m, vehicle);
    if (on_wheels) status = collect_constraints(&constraints, &b, vehicle, why);
    if (status != LACONIC_OK) return status;
    allowed_motions(&motions.scaled, &constraints);
    if (goes_straight_only(&motions.scaled, vehicle)) return refuse_straight(vehicle, why);
    m.dof = motions.scaled.count;
    if (on_wheels) project_wheels(&m, &motions.scaled, &b, vehicle);
    diagonalise(&m, &motions, &b, vehicle);
    derive_gyro(&m);
    derive_rows(&m);
    if (!usable(&m)) return refuse_range(&m, vehicle, why);
    if (!(LACONIC_EPSILON * laconic_root(laconic_condition_number(&m)) < R(0.01)))
        return refuse(why, LACONIC_ILL_CONDITIONED, LACONIC_FIELD_NONE, 0, laconic_condition_number(&m), R(0));
    *model = m;
    return LACONIC_OK;
}

laconic_status laconic_prepare(laconic_model *model, const laconic_vehicle *vehicle, laconic_refusal *why) {
    return prepare(model, vehicle, !laconic_vehicle_has_friction(vehicle), why);
}

laconic_status laconic_prepare_ideal(laconic_model *model, const laconic_vehicle *vehicle, laconic_refusal *why) {
    return prepare(model, vehicle, true, why);
}
