/* How the factors of an exponential step change with the damping, as functions of a symmetric matrix: along dR entry jk
 * of the change of f(R) is dR_jk times the divided difference of f between the rates j and k (Daletskii and Krein).
 * With it the change of a step does not depend on the choice of axes, and rates may coincide. */
#include "divided_difference.h"
#include "step_change.h"

/* The factors of laconic_decay that a step with held input uses. */
typedef struct factors {
    real gain, inverse_gain, mean, mean_ramp, slope, slope_ramp;
} factors;

/* Mean and slope at −a, of φ1 … φ4 there; and how all of these change with a. From a = 1 on by 1/(1 − e⁻ᵃ): the
 * differences of φ cancel more and more there, and a stiff vehicle multiplies what is left by its large damping. */
typedef struct phi_part {
    real mean, slope;
} phi_part;

typedef struct phi_slopes {
    real phi[5], mean, slope;
} phi_slopes;

#define FAST R(1)

static phi_part part_at(real a, const real phi[6]) {
    phi_part p;
    if (a > FAST) {
        p.mean = R(1) / (R(1) - phi[0]) - R(1) / a;
        p.slope = (R(12) * p.mean - R(6)) / a;
    } else {
        p.mean = phi[2] / phi[1];
        p.slope = (R(6) * phi[2] - R(12) * phi[3]) / phi[1];
    }
    return p;
}

/* By a: φk(−a)' = k φk+1 − φk, and also −(φk−1' + φk)/a. */
static phi_slopes slope_at(real a, const real phi[6], const phi_part *at) {
    phi_slopes d;
    d.phi[0] = -phi[0];
    if (a > FAST) {
        const real whole = R(1) / (R(1) - phi[0]);
        for (int k = 1; k < 5; k++) d.phi[k] = -(d.phi[k - 1] + phi[k]) / a;
        d.mean = R(1) / (a * a) - phi[0] * whole * whole;
        d.slope = (R(12) * d.mean - at->slope) / a;
    } else {
        for (int k = 1; k < 5; k++) d.phi[k] = R(k) * phi[k + 1] - phi[k];
        d.mean = (d.phi[2] - at->mean * d.phi[1]) / phi[1];
        d.slope = (R(6) * d.phi[2] - R(12) * d.phi[3] - at->slope * d.phi[1]) / phi[1];
    }
    return d;
}

static factors factors_at(real h, real rate) {
    real phi[6];
    laconic_phi(phi, h * rate);
    const phi_part p = part_at(h * rate, phi);
    const factors f = {h * phi[1], R(1) / (h * phi[1]),
                       p.mean,     h * (phi[3] - p.mean * phi[2]),
                       p.slope,    h * (R(6) * phi[3] - R(12) * phi[4] - p.slope * phi[2])};
    return f;
}

/* By the rate. */
static factors factor_slopes(real h, real rate) {
    real phi[6];
    laconic_phi(phi, h * rate);
    const phi_part p = part_at(h * rate, phi);
    const phi_slopes d = slope_at(h * rate, phi, &p);
    const real mean_ramp = d.phi[3] - d.mean * phi[2] - p.mean * d.phi[2];
    const real slope_ramp = R(6) * d.phi[3] - R(12) * d.phi[4] - d.slope * phi[2] - p.slope * d.phi[2];
    const factors f = {h * h * d.phi[1],  -d.phi[1] / (phi[1] * phi[1]), h * d.mean, h * h * mean_ramp, h * d.slope,
                       h * h * slope_ramp};
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

/* As divided_difference_of(), of all factors at once. */
static factors divided_difference(real h, real a, real b) {
    const factors zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    factors sum = zero;
    if (magnitude(h * (a - b)) > R(1)) {
        sum = weighed_factors(zero, R(1) / (a - b), factors_at(h, a));
        return weighed_factors(sum, R(-1) / (a - b), factors_at(h, b));
    }
    for (int i = 0; i < SLOPE_POINTS; i++)
        sum = weighed_factors(sum, slope_share[i],
                              factor_slopes(h, R(0.5) * (a + b) + R(0.5) * (b - a) * slope_point[i]));
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
