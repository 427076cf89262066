/* What exponential-gauss-8 and its derivative share: the weights, and the panels of a step. */
#ifndef LACONIC_EXPONENTIAL_GAUSS_8_H
#define LACONIC_EXPONENTIAL_GAUSS_8_H

#include "gauss_points.h"
#include "step_internals.h"

#define MOST_HALVINGS 12 /* for h·r up to 2048; beyond, the first panel is longer */

#if LACONIC_WITH_EXPONENTIAL_GAUSS

#define ROUNDS 9 /* one beyond those that the order needs: the error is then that of collocation */

/* ------------------------------------------------------------------ weights of a panel -- */

/* Of one axis, times h: the row of numbers that the integrator keeps, where the step is one panel. */
#define AT_POINT(w, i, j) (w)[NODES * (i) + (j)] /* A_ij */
#define AT_END (NODES * NODES)                   /* B_0 … B_3 */
#define OF_MEAN (NODES * (NODES + 1))            /* C_0 … C_3 */
#define WEIGHTS (NODES * (NODES + 2))

/* And of a panel among others: D_ij, with h Σi D_ij F_i the mean of η from its start to node j, times node j. */
#define MEAN_TO_POINT(w, i, j) (w)[WEIGHTS + NODES * (i) + (j)]
#define PANEL_WEIGHTS (WEIGHTS + NODES * NODES)

/* Where there are more, it keeps φ0 … φ5 at −h·r times each node and 1, for the first panel. */
#define PHIS 6
#define PHI(phi, j, n) (phi)[PHIS * (j) + (n)]

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

/* ∫ of polynomial i from 0 to `to` under the decay, once or twice: Σn coefficient n! φn+times toⁿ⁺ᵗⁱᵐᵉˢ. */
static inline real integrated(int i, const real phi[PHIS], int times, real to) {
    real sum = R(6) * R(lagrange[i][3]) * phi[times + 3];
    sum = sum * to + R(2) * R(lagrange[i][2]) * phi[times + 2];
    sum = sum * to + R(lagrange[i][1]) * phi[times + 1];
    sum = sum * to + R(lagrange[i][0]) * phi[times];
    return times == 1 ? sum * to : sum * to * to;
}

/* The integral under the decay is that without it less a = h·r times the second one, so that slow damping costs no
 * digits. */
static inline real weight_to(real without, int i, const real phi[PHIS], real a, real to) {
    const verdict fast = a > R(1);
    real value = without - a * integrated(i, phi, 2, to);
    if (ANY(fast)) value = WHERE(fast, integrated(i, phi, 1, to), value);
    return value;
}

static inline void set_means_to_points(real w[PANEL_WEIGHTS], const real *phi, real h) {
    for (int i = 0; i < NODES; i++)
        for (int j = 0; j < NODES; j++)
            MEAN_TO_POINT(w, i, j) = h * integrated(i, &PHI(phi, j, 0), 2, R(gauss_node[j]));
}

static inline void weights_of(real w[WEIGHTS], const real *phi, real h, real a) {
    for (int i = 0; i < NODES; i++) {
        for (int j = 0; j < NODES; j++)
            AT_POINT(w, i, j) = h * weight_to(R(undamped[i][j]), i, &PHI(phi, j, 0), a, R(gauss_node[j]));
        w[AT_END + i] = h * weight_to(R(gauss_weight[i]), i, &PHI(phi, NODES, 0), a, R(1));
        w[OF_MEAN + i] = h * integrated(i, &PHI(phi, NODES, 0), 2, R(1));
    }
}

/* φ0 … φ5 at twice the argument: sums of positive numbers. */
static inline void double_phis(real phi[PHIS]) {
    const real decay = phi[0];
    phi[5] =
        R(1.0 / 32) * ((R(1) + decay) * phi[5] + phi[4] + R(0.5) * phi[3] + R(1.0 / 6) * phi[2] + R(1.0 / 24) * phi[1]);
    phi[4] = R(1.0 / 16) * ((R(1) + decay) * phi[4] + phi[3] + R(0.5) * phi[2] + R(1.0 / 6) * phi[1]);
    phi[3] = R(1.0 / 8) * ((R(1) + decay) * phi[3] + phi[2] + R(0.5) * phi[1]);
    phi[2] = R(0.25) * ((R(1) + decay) * phi[2] + phi[1]);
    phi[1] = R(0.5) * (R(1) + decay) * phi[1];
    phi[0] = decay * decay;
}

/* -------------------------------------------------------------------- a round at the nodes -- */

/* A vector at each node, axis by axis, so that compilers vectorise. */
typedef struct node_vectors {
    real x[NODES], y[NODES], z[NODES];
} node_vectors;

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

/* One of the panels that double, with the φ of its length. */
typedef struct doubling_panel {
    real h, first, share; /* its length; where it starts, of the step's s from 0 to 1; its length of that */
    real phi[3][PHIS * (NODES + 1)], row[3][PANEL_WEIGHTS];
} doubling_panel;

static inline void set_rows(doubling_panel *p, const laconic_model *m) {
    for (int axis = 0; axis < 3; axis++) {
        weights_of(p->row[axis], p->phi[axis], p->h, p->h * m->decay_per_s[axis]);
        set_means_to_points(p->row[axis], p->phi[axis], p->h);
    }
}

static inline void first_panel(doubling_panel *p, const laconic_model *m, const laconic_integrator *integrator) {
    p->first = R(0);
    p->share = R(1);
    for (int k = 0; k < integrator->halvings; k++) p->share *= R(0.5);
    p->h = p->share * integrator->step_s;
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < PHIS * (NODES + 1); n++) p->phi[axis][n] = integrator->collocation[axis][n];
    set_rows(p, m);
}

/* The second panel is as long as the first, each further one twice as long as the one before; `k` counts from 0. */
static inline void next_panel(doubling_panel *p, const laconic_model *m, int k) {
    p->first += p->share;
    if (k == 1) return;
    p->share *= R(2);
    p->h *= R(2);
    for (int axis = 0; axis < 3; axis++)
        for (int j = 0; j <= NODES; j++) double_phis(&PHI(p->phi[axis], j, 0));
    set_rows(p, m);
}

#endif
#endif
