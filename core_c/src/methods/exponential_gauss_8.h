/* What the collocation at Gauss' points and its derivative share: the weights, and the panels of a step. */
#ifndef LACONIC_EXPONENTIAL_GAUSS_8_H
#define LACONIC_EXPONENTIAL_GAUSS_8_H

#include "gauss_points.h"
#include "step_internals.h"

#define MOST_STRETCHES 20 /* for h·r up to 262,144, in double 589,824; beyond, the first stretch is longer */

#if LACONIC_WITH_EXPONENTIAL_GAUSS

/* The rounds end when one changes nothing, after 4 to 9 in usual steps, and from ROUNDS on when one moves ζ at the
 * nodes by rounding alone. 8 have the order; ROUNDS find the solution of the collocation up to h·|w||g·ζ| = 1.5. A step
 * for which MOST_ROUNDS do not find it is refused: free motion would not keep its energy. Rounds that hardly converge
 * end in moves that are larger than a rounding. */
#define ROUNDS 32
#define MOST_ROUNDS 128
#define SETTLED (R(8) * LACONIC_EPSILON)           /* move of a round over Σ|ζ| */
#define SETTLED_AT_LAST (R(256) * LACONIC_EPSILON) /* after MOST_ROUNDS */

/* ------------------------------------------------------------------ weights of a panel -- */

/* Of one axis, times h: the row of numbers that the integrator keeps, where the step is one panel. */
#define AT_POINT(w, i, j) (w)[NODES * (i) + (j)] /* A_ij */
#define AT_END (NODES * NODES)                   /* B_0 … B_3 */
#define OF_MEAN (NODES * (NODES + 1))            /* C_0 … C_3 */
#define WEIGHTS (NODES * (NODES + 2))

/* And of a panel among others: D_ij, with h Σi D_ij F_i the mean of η from its start to node j, times node j. */
#define MEAN_TO_POINT(w, i, j) (w)[WEIGHTS + NODES * (i) + (j)]
#define PANEL_WEIGHTS (WEIGHTS + NODES * NODES)

/* Where there are more, it keeps φ0 … φ5 at −h·r times each node and 1, for the first panel and for the rest. */
#define PHIS 6
#define PHI(phi, j, n) (phi)[(NODES + 1) * (n) + (j)]

/* Lagrange's polynomials through the nodes: coefficients of 1, s, s², s³. */
static const laconic_number lagrange[NODES][NODES] = {
    {N(1.526788125457266786984), N(-8.546023607872198765973), N(14.32585835417188815297), N(-7.420540068038946105201)},
    {N(-0.8136324494869272605619), N(13.80716692568957706616), N(-31.38822236344606021206), N(18.79544940755506081126)},
    {N(0.4007615203116504048003), N(-7.417070421462639075827), N(24.99812585921912222173), N(-18.79544940755506081126)},
    {N(-0.1139171962819899312227), N(2.155927103645260775642), N(-7.935761849944950162635),
     N(7.420540068038946105201)}};

/* Their integrals from 0 to each node: A_ij for r = 0. */
static const laconic_number undamped[NODES][NODES] = {
    {N(0.0869637112843634643433), N(0.188118117499868071651), N(0.167191921974188773171), N(0.177482572254522611843)},
    {N(-0.0266041800849987933134), N(0.163036288715636535657), N(0.353953006033743966538), N(0.313445114741868346798)},
    {N(0.0126274626894047245151), N(-0.0278804286024708952242), N(0.163036288715636535657), N(0.352676757516271864627)},
    {N(-0.00355514968579568315691), N(0.0067355005945381555154), N(-0.0141906949311411429642),
     N(0.0869637112843634643433)}};

/* ∫ of polynomial i from 0 to `to`, which is node j, under the decay, once or twice:
 * Σn coefficient n! φn+times toⁿ⁺ᵗⁱᵐᵉˢ. */
INLINE real integrated(int i, const real *phi, int j, int times, real to) {
    real sum = R(6) * R(lagrange[i][3]) * PHI(phi, j, times + 3);
    sum = sum * to + R(2) * R(lagrange[i][2]) * PHI(phi, j, times + 2);
    sum = sum * to + R(lagrange[i][1]) * PHI(phi, j, times + 1);
    sum = sum * to + R(lagrange[i][0]) * PHI(phi, j, times);
    return times == 1 ? sum * to : sum * to * to;
}

INLINE void integrals(real to_nodes[NODES + 1], int i, const real *phi, int times) {
    for (int j = 0; j < NODES; j++) to_nodes[j] = integrated(i, phi, j, times, R(gauss_node[j]));
    to_nodes[NODES] = integrated(i, phi, NODES, times, R(1));
}

/* Either follows from the other: without decay the integral is once + a·twice, with a = h·r. Where damping is slow the
 * second is summed, so that it costs no digits, where it is fast the first. */
static inline void weights_of(real w[PANEL_WEIGHTS], const real *phi, real h, real a) {
    const mask fast = a > R(1);
    const real inverse = R(1) / SELECT(fast, a, R(1));
    for (int i = 0; i < NODES; i++) {
        real once[NODES + 1], twice[NODES + 1], summed[NODES + 1], without[NODES + 1];
        for (int j = 0; j < NODES; j++) without[j] = R(undamped[i][j]);
        without[NODES] = R(gauss_weight[i]);
        if (!ALL(fast)) {
            integrals(twice, i, phi, 2);
            for (int j = 0; j <= NODES; j++) once[j] = without[j] - a * twice[j];
        }
        if (ANY(fast)) {
            integrals(summed, i, phi, 1);
            for (int j = 0; j <= NODES; j++) {
                once[j] = ALL(fast) ? summed[j] : SELECT(fast, summed[j], once[j]);
                twice[j] = ALL(fast) ? inverse * (without[j] - summed[j])
                                     : SELECT(fast, inverse * (without[j] - summed[j]), twice[j]);
            }
        }
        for (int j = 0; j < NODES; j++) AT_POINT(w, i, j) = h * once[j];
        for (int j = 0; j < NODES; j++) MEAN_TO_POINT(w, i, j) = h * twice[j];
        w[AT_END + i] = h * once[NODES];
        w[OF_MEAN + i] = h * twice[NODES];
    }
}

/* φ0 … φ5 at twice the argument: sums of positive numbers. */
static inline void double_phis(real phi[PHIS * (NODES + 1)]) {
    for (int j = 0; j <= NODES; j++) {
        const real decay = PHI(phi, j, 0), p1 = PHI(phi, j, 1), p2 = PHI(phi, j, 2), p3 = PHI(phi, j, 3),
                   p4 = PHI(phi, j, 4), more = R(1) + decay;
        PHI(phi, j, 5) = R(1.0 / 32) * (more * PHI(phi, j, 5) + p4 + R(0.5) * p3 + R(1.0 / 6) * p2 + R(1.0 / 24) * p1);
        PHI(phi, j, 4) = R(1.0 / 16) * (more * p4 + p3 + R(0.5) * p2 + R(1.0 / 6) * p1);
        PHI(phi, j, 3) = R(1.0 / 8) * (more * p3 + p2 + R(0.5) * p1);
        PHI(phi, j, 2) = R(0.25) * (more * p2 + p1);
        PHI(phi, j, 1) = R(0.5) * more * p1;
        PHI(phi, j, 0) = decay * decay;
    }
}

/* -------------------------------------------------------------------- a round at the nodes -- */

/* A vector at each node, axis by axis, so that compilers vectorise. */
typedef struct node_vectors {
    real x[NODES], y[NODES], z[NODES];
} node_vectors;

/* Σ|ζ − other| at the nodes. */
INLINE real distance_of_nodes(const node_vectors *zeta, const node_vectors *other) {
    real sum = R(0);
    for (int j = 0; j < NODES; j++)
        sum += magnitude(zeta->x[j] - other->x[j]) + magnitude(zeta->y[j] - other->y[j]) +
               magnitude(zeta->z[j] - other->z[j]);
    return sum;
}

/* Whether a round that moved ζ at the nodes so far ended at the solution. False for NaN. */
static inline mask nodes_settled(const node_vectors *zeta, real move, real tolerance) {
    static const node_vectors zero = ALL_ZERO;
    return move <= tolerance * distance_of_nodes(zeta, &zero);
}

/* F at each node, b where it is constant being part of `still`. */
INLINE void rates_at(node_vectors *rate, const laconic_model *m, const node_vectors *zeta, vector still) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro);
    for (int j = 0; j < NODES; j++) {
        const real yaw = g.x * zeta->x[j] + g.y * zeta->y[j] + g.z * zeta->z[j];
        rate->x[j] = yaw * (zeta->y[j] * w.z - zeta->z[j] * w.y) + still.x;
        rate->y[j] = yaw * (zeta->z[j] * w.x - zeta->x[j] * w.z) + still.y;
        rate->z[j] = yaw * (zeta->x[j] * w.y - zeta->y[j] * w.x) + still.z;
    }
}

/* ζ at each node from F there. */
INLINE void answer_axis(real zeta[NODES], real start, const real *row, const real rate[NODES]) {
    for (int j = 0; j < NODES; j++)
        zeta[j] = start + (AT_POINT(row, 0, j) * rate[0] + AT_POINT(row, 1, j) * rate[1] +
                           (AT_POINT(row, 2, j) * rate[2] + AT_POINT(row, 3, j) * rate[3]));
}

INLINE void answer(node_vectors *zeta, vector start, const real *const row[3], const node_vectors *rate) {
    answer_axis(zeta->x, start.x, row[0], rate->x);
    answer_axis(zeta->y, start.y, row[1], rate->y);
    answer_axis(zeta->z, start.z, row[2], rate->z);
}

/* The same from an F that is alike at all nodes. */
INLINE void first_answer_axis(real zeta[NODES], real start, const real *row, real rate) {
    for (int j = 0; j < NODES; j++)
        zeta[j] =
            start + rate * ((AT_POINT(row, 0, j) + AT_POINT(row, 1, j)) + (AT_POINT(row, 2, j) + AT_POINT(row, 3, j)));
}

/* F at the panel's start, where b is constant: `still` as for rates_at. */
INLINE vector first_rate(const laconic_model *m, vector zeta, vector still) {
    return plus(scaled(dot(vec(m->nu_of_zeta[2]), zeta), cross(zeta, vec(m->gyro))), still);
}

INLINE void first_answer(node_vectors *zeta, vector start, const real *const row[3], vector rate) {
    first_answer_axis(zeta->x, start.x, row[0], rate.x);
    first_answer_axis(zeta->y, start.y, row[1], rate.y);
    first_answer_axis(zeta->z, start.z, row[2], rate.z);
}

/* The yaw since the panel's start at each node. */
INLINE void yaw_at_nodes(real yaw[NODES], const laconic_model *m, real h, const node_vectors *zeta) {
    const vector yaw_rate = vec(m->yaw_rate_of_zeta);
    for (int j = 0; j < NODES; j++) yaw[j] = R(0);
    for (int i = 0; i < NODES; i++) {
        const real rate = h * (yaw_rate.x * zeta->x[i] + yaw_rate.y * zeta->y[i] + yaw_rate.z * zeta->z[i]);
        for (int j = 0; j < NODES; j++) yaw[j] += R(undamped[i][j]) * rate;
    }
}

/* ---------------------------------------------------------------------------- the panels -- */

/* One of the panels of a step, with the φ of its length. */
typedef struct panel_among {
    real h, first, share; /* its length; where it starts, of the step's s from 0 to 1; its length of that */
    real phi[3][PHIS * (NODES + 1)], row[3][PANEL_WEIGHTS];
} panel_among;

/* Stretches grow as the time that has passed, 1, 1, 2, 4 … of the first, each taken in PARTS equal panels. PANEL_DECAY
 * is h·r of the first panel at most; after DEAD_AFTER decay times something has died out, and the rest of the step is
 * one panel. Chosen on 500 random vehicles: fewer or longer panels err by more than 1e-12 at 1 ms in double, by more
 * than rounding in single precision. WHOLE_DECAY is h·r of the longest step that is one panel: one that is halved below
 * it loses its panels, which is seen as a loss of order unless rounding is all that is left of the error there. */
#ifdef LACONIC_SINGLE
#define PARTS 1
#define WHOLE_DECAY R(0.5)
#define PANEL_DECAY R(0.5)
#define DEAD_AFTER R(12)
#else
#define PARTS 3
#define WHOLE_DECAY R(0.125)
#define PANEL_DECAY R(0.375)
#define DEAD_AFTER R(18)
#endif

/* Panels half as long, and twice as many decay times until something counts as died out, for an integrator that steps
 * in panels, as auto does; others stay as they are. Two half steps have otherwise the same panels as the
 * whole step, or, where that has panels and they have none, longer ones, and do not show its error. */
#if LACONIC_WITH_PREPARE
void laconic_halve_panels(laconic_integrator *integrator, const laconic_model *model);
#endif

static inline int32_t parts_of(const laconic_integrator *integrator) { return integrator->halved ? 2 * PARTS : PARTS; }

static inline int32_t panels_of(const laconic_integrator *integrator) {
    return integrator->stretches == 0 ? 1 : parts_of(integrator) * integrator->stretches + integrator->has_rest;
}

static inline void set_rows(panel_among *p, const laconic_model *m) {
    for (int axis = 0; axis < 3; axis++) weights_of(p->row[axis], p->phi[axis], p->h, p->h * m->decay_per_s[axis]);
}

static inline void start_panel(panel_among *p, const laconic_model *m, const laconic_integrator *integrator, real share,
                               const laconic_real phi[3][PHIS * (NODES + 1)]) {
    p->share = share;
    p->h = share * integrator->step_s;
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < PHIS * (NODES + 1); n++) p->phi[axis][n] = phi[axis][n];
    set_rows(p, m);
}

static inline void first_panel(panel_among *p, const laconic_model *m, const laconic_integrator *integrator) {
    p->first = R(0);
    start_panel(p, m, integrator, integrator->first_share, integrator->collocation);
}

/* `k` counts from 0. The last one takes the rest of the step. */
static inline void next_panel(panel_among *p, const laconic_model *m, const laconic_integrator *integrator, int32_t k) {
    const int32_t parts = parts_of(integrator);
    p->first += p->share;
    if (k == parts * integrator->stretches) {
        start_panel(p, m, integrator, integrator->rest_share, integrator->collocation_of_rest);
    } else if (k >= 2 * parts && k % parts == 0) {
        p->share *= R(2);
        p->h *= R(2);
        for (int axis = 0; axis < 3; axis++) double_phis(p->phi[axis]);
        set_rows(p, m);
    }
}

#endif
#endif
