/* How the factors of an exponential step change with the damping, as functions of a symmetric matrix: along dR entry jk
 * of the change of f(R) is dR_jk times the divided difference of f between the rates j and k (Daletskii and Krein).
 * With it the change of a step does not depend on the choice of axes, and rates may coincide. */
#include "step_change.h"

/* The factors of laconic_decay that a step with held input uses. */
typedef struct factors {
    real gain, inverse_gain, mean, mean_ramp, slope, slope_ramp;
} factors;

static factors factors_at(real h, real rate) {
    real phi[6];
    laconic_phi(phi, h * rate);
    const real mean = phi[2] / phi[1], slope = (R(6) * phi[2] - R(12) * phi[3]) / phi[1];
    const factors f = {h * phi[1], R(1) / (h * phi[1]),
                       mean,       h * (phi[3] - mean * phi[2]),
                       slope,      h * (R(6) * phi[3] - R(12) * phi[4] - slope * phi[2])};
    return f;
}

/* By the rate: φk(−a)' = k φk+1 − φk. */
static factors factor_slopes(real h, real rate) {
    real phi[6], d[5];
    laconic_phi(phi, h * rate);
    for (int k = 1; k < 5; k++) d[k] = h * (R(k) * phi[k + 1] - phi[k]);
    const real mean = phi[2] / phi[1], slope = (R(6) * phi[2] - R(12) * phi[3]) / phi[1];
    const real d_mean = (d[2] - mean * d[1]) / phi[1];
    const real d_slope = (R(6) * d[2] - R(12) * d[3] - slope * d[1]) / phi[1];
    const factors f = {h * d[1], -d[1] / (h * phi[1] * phi[1]),
                       d_mean,   h * (d[3] - d_mean * phi[2] - mean * d[2]),
                       d_slope,  h * (R(6) * d[3] - R(12) * d[4] - d_slope * phi[2] - slope * d[2])};
    return f;
}

static factors weighed_factors(factors sum, real weight, factors f) {
    sum.gain += weight * f.gain;
    sum.inverse_gain += weight * f.inverse_gain;
    sum.mean += weight * f.mean;
    sum.mean_ramp += weight * f.mean_ramp;
    sum.slope += weight * f.slope;
    sum.slope_ramp += weight * f.slope_ramp;
    return sum;
}

/* Gauss' quadrature of five points on −1 … 1: where h·r of two rates are at most 1 apart, the mean of the slope
 * between them to 1e-15, without the cancellation of a difference. */
#define POINTS 5
static const real point[POINTS] = {R(0), R(0.53846931010568309104), R(-0.53846931010568309104),
                                   R(0.90617984593866399280), R(-0.90617984593866399280)};
static const real point_share[POINTS] = {R(0.28444444444444444444), R(0.23931433524968323402),
                                         R(0.23931433524968323402), R(0.11846344252809454376),
                                         R(0.11846344252809454376)};

static factors divided_difference(real h, real a, real b) {
    const factors zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    factors sum = zero;
    if (magnitude(h * (a - b)) > R(1)) {
        sum = weighed_factors(zero, R(1) / (a - b), factors_at(h, a));
        return weighed_factors(sum, R(-1) / (a - b), factors_at(h, b));
    }
    for (int i = 0; i < POINTS; i++)
        sum = weighed_factors(sum, point_share[i], factor_slopes(h, R(0.5) * (a + b) + R(0.5) * (b - a) * point[i]));
    return sum;
}

/* Element jk, and kj, of all factors' changes. */
static void set_element(decay_change *c, int j, int k, real damping, factors f) {
    linear_map *const map[6] = {&c->gain, &c->inverse_gain, &c->mean, &c->mean_ramp, &c->slope, &c->slope_ramp};
    const real value[6] = {f.gain, f.inverse_gain, f.mean, f.mean_ramp, f.slope, f.slope_ramp};
    for (int i = 0; i < 6; i++) {
        vector *const row[3] = {&map[i]->x, &map[i]->y, &map[i]->z};
        real *const element[3] = {&row[j]->x, &row[j]->y, &row[j]->z};
        *element[k] = damping * value[i];
    }
}

void laconic_decay_change_of(decay_change *change, const laconic_model *m, real h, const linear_map *damping) {
    const vector row[3] = {damping->x, damping->y, damping->z};
    const factors zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    for (int j = 0; j < 3; j++) {
        const real by[3] = {row[j].x, row[j].y, row[j].z};
        for (int k = 0; k < 3; k++) {
            const factors f = by[k] == R(0) ? zero
                              : j == k      ? factor_slopes(h, m->decay_per_s[j])
                                            : divided_difference(h, m->decay_per_s[j], m->decay_per_s[k]);
            set_element(change, j, k, by[k], f);
        }
    }
}
