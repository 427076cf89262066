/* Taylor series of order 8. (4.7) is quadratic, so each coefficient of ζ follows from the earlier ones by one product
 * of series: with ζ = Σ ζn sⁿ over the step (s from 0 to 1),
 *     (n + 1) ζn+1 = h [ Σj (g·ζj)(ζn−j × w) − diag(r) ζn + bn ].
 * θ follows term by term, and the pose by a quadrature of the same order. Explicit: for large steps of vehicles whose
 * damping is slow beside them, where it is far more exact than anything else of its cost. */
#include "integrator.h"
#include "taylor_forcing.h"
#include "taylor_pose.h"

#define LARGEST_DAMPING R(4.313)  /* h·r: end of the stability interval on the real axis        */
#define LARGEST_ROTATION R(3.395) /* h·|w||g·ζ|: on the imaginary axis, where free motion turns */

/* The Jacobian of the rate at the step's start, by rows: of the product of series, and of the damping, it is the part
 * that the newest coefficient takes. */
typedef struct jacobian {
    vector x, y, z;
} jacobian;

static inline jacobian jacobian_at(const laconic_model *m, real yaw, vector turned) {
    const vector g = vec(m->nu_of_zeta[2]), s = scaled(yaw, vec(m->gyro)), r = vec(m->decay_per_s);
    const jacobian at = {{turned.x * g.x - r.x, turned.x * g.y + s.z, turned.x * g.z - s.y},
                         {turned.y * g.x - s.z, turned.y * g.y - r.y, turned.y * g.z + s.x},
                         {turned.z * g.x + s.y, turned.z * g.y - s.x, turned.z * g.z - r.z}};
    return at;
}

static inline vector applied(const jacobian *a, vector v) {
    const vector out = {dot(a->x, v), dot(a->y, v), dot(a->z, v)};
    return out;
}

static inline void keep(course *c, vector turned[ORDER + 1], const laconic_model *m, int n, vector zeta) {
    c->zeta[n] = zeta;
    c->yaw[n] = dot(vec(m->nu_of_zeta[2]), zeta);
    turned[n] = cross(zeta, vec(m->gyro));
}

/* ζ0 and ζ1. */
INLINE vector first_term(course *c, vector turned[ORDER + 1], const laconic_model *m, real h, vector zeta, vector b) {
    keep(c, turned, m, 0, zeta);
    return scaled(h, plus(minus(scaled(c->yaw[0], turned[0]), damping(m, zeta)), b));
}

/* Keeps ζn, returns ζn+1. Only the last two operations wait for ζn. */
INLINE vector next_term(course *c, vector turned[ORDER + 1], const laconic_model *m, const jacobian *at, real h, int n,
                        vector zeta, vector b) {
    vector older = b;
    int j;
    for (j = 1; j < n; j++) older = plus(older, scaled(c->yaw[j], turned[n - j]));
    keep(c, turned, m, n, zeta);
    return scaled(h * inverse[n], plus(older, applied(at, zeta)));
}

INLINE void steady_course(course *c, const laconic_model *m, real h, vector start, vector b) {
    vector turned[ORDER + 1], zeta = first_term(c, turned, m, h, start, b);
    const jacobian at = jacobian_at(m, c->yaw[0], turned[0]);
    int n;
    for (n = 1; n < ORDER; n++) zeta = next_term(c, turned, m, &at, h, n, zeta, none);
    keep(c, turned, m, ORDER, zeta);
}

RARE void varying_course(course *c, const laconic_model *m, real h, vector start, const laconic_loads *loads,
                         const laconic_heading *heading) {
    const real turn = turn_of_yaw(m, h);
    forcing f = forcing_of(loads, heading);
    vector turned[ORDER + 1], zeta = first_term(c, turned, m, h, start, first_forcing(&f));
    const jacobian at = jacobian_at(m, c->yaw[0], turned[0]);
    int n;
    for (n = 1; n < ORDER; n++) zeta = next_term(c, turned, m, &at, h, n, zeta, forcing_term(&f, c, turn, n));
    keep(c, turned, m, ORDER, zeta);
}

/* Smallest terms first. */
static inline increment sum_of_terms(const course *c) {
    increment by = {none, none, none};
    int n;
    for (n = ORDER; n > 0; n--) {
        by.delta = plus(by.delta, c->zeta[n]);
        by.mean = plus(by.mean, scaled(inverse[n], c->zeta[n]));
    }
    by.mean = plus(by.mean, c->zeta[0]);
    by.slope = by.delta;
    return by;
}

static laconic_status taylor_step(const laconic_model *model, const laconic_integrator *integrator,
                                  laconic_state *state, const laconic_loads *loads) {
    const real h = integrator->step_s;
    const vector zeta = zeta_of(state);
    motion moved = {R(0), R(0), R(0)};
    vector path;
    increment by;
    course c;
    if (beyond_rotation(model, integrator, zeta)) return LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
    if (steady_over(loads))
        steady_course(&c, model, h, zeta, vec(loads->start->constant));
    else
        varying_course(&c, model, h, zeta, loads, &state->heading);
    by = sum_of_terms(&c);
    if (!passive(model, state, h, loads, zeta, by)) return not_passive(by);
    if (!in_range(zeta, by.delta)) return LACONIC_OVERFLOW;
    path = scaled(h, by.mean);
    if (LACONIC_WITH_POSE) moved = quadrature(&c, model, h, dot(vec(model->yaw_rate_of_zeta), path));
    return take(state, by.delta, path, moved);
}

static laconic_status taylor_prepare(laconic_integrator *integrator, const laconic_model *model, laconic_refusal *why) {
    return laconic_explicit_limits(integrator, model, LARGEST_DAMPING, LARGEST_ROTATION, why);
}

const laconic_method laconic_taylor_8 = {"taylor-8", 8, PREPARE(taylor_prepare), taylor_step};
