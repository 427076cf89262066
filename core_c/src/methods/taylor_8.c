/* Taylor series of order 8. (4.7) is quadratic, so each coefficient of ζ follows from the earlier ones by one product
 * of series: with ζ = Σ ζn sⁿ over the step (s from 0 to 1),
 *     (n + 1) ζn+1 = h [ Σj (g·ζj)(ζn−j × w) − diag(r) ζn + bn ].
 * θ follows term by term, and the pose by a quadrature of the same order. Explicit: for large steps of vehicles
 * whose damping is slow beside the step, where its error is far below that of any other method of its cost. */
#include "taylor_8.h"
#include "eighth_order.h"

#define LARGEST_DAMPING R(4.313)  /* h·r: |Σ (−a)ⁿ/n!| to n = 8 exceeds 1 from a = 4.3136 on   */
#define LARGEST_ROTATION R(3.395) /* h·|w||g·ζ|: |Σ (ia)ⁿ/n!|, the rotation of free motion, from 3.3951 on */

/* -------------------------------------------------------- the motion over one step as a series -- */

/* Coefficients of sⁿ. */
typedef struct motion_series {
    vector zeta[ORDER + 1];
    real yaw[ORDER + 1]; /* g·ζ */
} motion_series;

/* h/Λ: the yaw of a step is h/Λ times the mean of ν3 = g·ζ. */
static inline real yaw_per_nu3(const laconic_model *m, real h) { return h / m->yaw_scale; }

/* ------- b as a series: its parabolas, and the heading for a force fixed in the world -- */

typedef struct forcing_series {
    forcing_terms at;
    real heading_cosine[ORDER], heading_sine[ORDER];
} forcing_series;

static forcing_series forcing_series_of(const laconic_forcing_samples *samples, const laconic_heading *heading) {
    forcing_series f;
    forcing_terms_of(&f.at, samples);
    if (!f.at.rotates) return f; /* the rest is not used */
    direction now = laconic_direction_of_binary_angle(heading->fraction);
    f.heading_cosine[0] = now.cosine;
    f.heading_sine[0] = now.sine;
    return f;
}

/* (cos θ)' = −θ' sin θ, (sin θ)' = θ' cos θ, coefficient by coefficient. */
static void add_heading_term(forcing_series *f, const motion_series *c, real per_nu3, int n) {
    real cosine = R(0), sine = R(0);
    for (int j = 0; j < n; j++) {
        cosine -= c->yaw[j] * f->heading_sine[n - 1 - j];
        sine += c->yaw[j] * f->heading_cosine[n - 1 - j];
    }
    f->heading_cosine[n] = per_nu3 * R(inverse[n - 1]) * cosine;
    f->heading_sine[n] = per_nu3 * R(inverse[n - 1]) * sine;
}

/* b0: b at the step's start. */
static vector first_forcing(const forcing_series *f) {
    const vector b = f->at.constant[0];
    if (!f->at.rotates) return b;
    return plus(b, plus(scaled(f->heading_cosine[0], f->at.cosine[0]), scaled(f->heading_sine[0], f->at.sine[0])));
}

/* bn for n >= 1, from the coefficients of the motion below n. */
static vector forcing_term(forcing_series *f, const motion_series *c, real per_nu3, int n) {
    vector b = n < 3 ? f->at.constant[n] : none;
    if (!f->at.rotates) return b;
    add_heading_term(f, c, per_nu3, n);
    for (int k = 0; k < 3 && k <= n; k++)
        b = plus(
            b, plus(scaled(f->heading_cosine[n - k], f->at.cosine[k]), scaled(f->heading_sine[n - k], f->at.sine[k])));
    return b;
}

/* --------------------------------------------------------------------------- the terms of ζ -- */

/* Rows of the Jacobian of the rate at the step's start. In the recursion it multiplies the newest coefficient ζn: the
 * terms j = 0 and j = n of the product, and the damping. */
typedef struct jacobian {
    vector x, y, z;
} jacobian;

static inline jacobian jacobian_at(const laconic_model *m, real yaw, vector zeta_cross_w) {
    const vector g = vec(m->nu_of_zeta[2]), s = scaled(yaw, vec(m->gyro)), r = vec(m->decay_per_s);
    const jacobian at = {{zeta_cross_w.x * g.x - r.x, zeta_cross_w.x * g.y + s.z, zeta_cross_w.x * g.z - s.y},
                         {zeta_cross_w.y * g.x - s.z, zeta_cross_w.y * g.y - r.y, zeta_cross_w.y * g.z + s.x},
                         {zeta_cross_w.z * g.x + s.y, zeta_cross_w.z * g.y - s.x, zeta_cross_w.z * g.z - r.z}};
    return at;
}

static inline vector applied(const jacobian *a, vector v) {
    const vector out = {dot(a->x, v), dot(a->y, v), dot(a->z, v)};
    return out;
}

static inline void keep_term(motion_series *c, vector zeta_cross_w[ORDER + 1], const laconic_model *m, int n,
                             vector zeta) {
    c->zeta[n] = zeta;
    c->yaw[n] = dot(vec(m->nu_of_zeta[2]), zeta);
    zeta_cross_w[n] = cross(zeta, vec(m->gyro));
}

/* ζ0 and ζ1. */
INLINE vector first_term(motion_series *c, vector zeta_cross_w[ORDER + 1], const laconic_model *m, real h, vector zeta,
                         vector b) {
    keep_term(c, zeta_cross_w, m, 0, zeta);
    return scaled(h, plus(minus(scaled(c->yaw[0], zeta_cross_w[0]), damping(m, zeta)), b));
}

/* Stores ζn, returns ζn+1. Only the last two operations depend on ζn, so that processors can overlap the others. */
INLINE vector next_term(motion_series *c, vector zeta_cross_w[ORDER + 1], const laconic_model *m, const jacobian *at,
                        real h, int n, vector zeta, vector b) {
    vector older = b;
    for (int j = 1; j < n; j++) older = plus(older, scaled(c->yaw[j], zeta_cross_w[n - j]));
    keep_term(c, zeta_cross_w, m, n, zeta);
    return scaled(h * R(inverse[n]), plus(older, applied(at, zeta)));
}

INLINE void steady_series(motion_series *c, const laconic_model *m, real h, vector start, vector b) {
    vector zeta_cross_w[ORDER + 1], zeta = first_term(c, zeta_cross_w, m, h, start, b);
    const jacobian at = jacobian_at(m, c->yaw[0], zeta_cross_w[0]);
    for (int n = 1; n < ORDER; n++) zeta = next_term(c, zeta_cross_w, m, &at, h, n, zeta, none);
    keep_term(c, zeta_cross_w, m, ORDER, zeta);
}

RARE void varying_series(motion_series *c, const laconic_model *m, real h, vector start,
                         const laconic_forcing_samples *samples, const laconic_heading *heading) {
    const real per_nu3 = yaw_per_nu3(m, h);
    forcing_series f = forcing_series_of(samples, heading);
    vector zeta_cross_w[ORDER + 1], zeta = first_term(c, zeta_cross_w, m, h, start, first_forcing(&f));
    const jacobian at = jacobian_at(m, c->yaw[0], zeta_cross_w[0]);
    for (int n = 1; n < ORDER; n++)
        zeta = next_term(c, zeta_cross_w, m, &at, h, n, zeta, forcing_term(&f, c, per_nu3, n));
    keep_term(c, zeta_cross_w, m, ORDER, zeta);
}

/* ------------------------------------------------ the pose: a quadrature of the same order -- */

/* The polynomials: the components of ζ, and ∫ g·ζ ds, divided by s. */
typedef real (*polynomial)(const motion_series *c, int n);

static inline real zeta_x(const motion_series *c, int n) { return c->zeta[n].x; }

static inline real zeta_y(const motion_series *c, int n) { return c->zeta[n].y; }

static inline real zeta_z(const motion_series *c, int n) { return c->zeta[n].z; }

static inline real mean_yaw(const motion_series *c, int n) { return R(inverse[n]) * c->yaw[n]; }

/* A polynomial at all nodes in one loop, which compilers vectorise. */
INLINE void at_nodes(real value[NODES], const motion_series *c, polynomial coefficient) {
    for (int k = 0; k < NODES; k++) value[k] = coefficient(c, ORDER);
    for (int n = ORDER - 1; n >= 0; n--)
        for (int k = 0; k < NODES; k++) value[k] = R(gauss_node[k]) * value[k] + coefficient(c, n);
}

/* In axes at the mid-step heading: ∫ e^{i(θ − θ_mid)} v dt. */
static inline pose_change quadrature(const motion_series *c, const laconic_model *m, real h, real yaw_change) {
    const real per_nu3 = yaw_per_nu3(m, h);
    real x[NODES], y[NODES], z[NODES], angle[NODES];
    at_nodes(x, c, zeta_x);
    at_nodes(y, c, zeta_y);
    at_nodes(z, c, zeta_z);
    at_nodes(angle, c, mean_yaw);
    for (int k = 0; k < NODES; k++) angle[k] = per_nu3 * R(gauss_node[k]) * angle[k] - R(0.5) * yaw_change;
    return displacement_at_nodes(m, h, yaw_change, x, y, z, angle);
}

/* -------------------------------------------------------------------------------- the step -- */

/* Smallest terms first. */
static inline increment sum_of_terms(const motion_series *c) {
    increment by = {none, none, none};
    for (int n = ORDER; n > 0; n--) {
        by.delta = plus(by.delta, c->zeta[n]);
        by.mean = plus(by.mean, scaled(R(inverse[n]), c->zeta[n]));
    }
    by.mean = plus(by.mean, c->zeta[0]);
    by.slope = by.delta;
    return by;
}

static laconic_status taylor_8_step(const laconic_model *model, const laconic_integrator *integrator,
                                    laconic_state *state, const laconic_forcing_samples *samples) {
    const real h = integrator->step_s;
    vector zeta = zeta_of(state);
    pose_change moved = {R(0), R(0), R(0)};
    increment by;
    motion_series c;
    if (UNLIKELY(beyond_rotation(model, integrator, zeta), &zeta.x)) return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    if (constant_over(samples))
        steady_series(&c, model, h, zeta, vec(samples->start->constant));
    else
        varying_series(&c, model, h, zeta, samples, &state->heading);
    by = sum_of_terms(&c);
    if (!LIKELY(passive(model, state, h, samples, zeta, by), &by.mean.x)) return not_passive(by);
    if (!LIKELY(in_range(zeta, by.delta), &by.mean.x)) return LACONIC_OVERFLOW;
    const vector path = scaled(h, by.mean);
    if (LACONIC_WITH_POSE) moved = quadrature(&c, model, h, dot(vec(model->yaw_rate_of_zeta), path));
    return END_STEP(state, by.delta, path, moved);
}

static laconic_status taylor_8_prepare(laconic_integrator *integrator, const laconic_model *model,
                                       laconic_refusal *why) {
    return laconic_explicit_limits(integrator, model, LARGEST_DAMPING, LARGEST_ROTATION, why);
}

const laconic_method laconic_taylor_8 = {"taylor-8", 8, PREPARE(taylor_8_prepare), taylor_8_step};
