/* Along a change dR of the damping, entry jk of the change of a weight f(R) is dR_jk times the divided difference of f
 * between the rates j and k, as in decay_change.c. */
#include "gauss_weight_change.h"

#include "divided_difference.h"

#if LACONIC_WITH_EXPONENTIAL_GAUSS

static void phis_at(real phi[PHIS * (NODES + 1)], real a) {
    for (int j = 0; j <= NODES; j++) {
        real of_node[PHIS];
        laconic_phi(of_node, j < NODES ? a * gauss_node[j] : a);
        for (int n = 0; n < PHIS; n++) PHI(phi, j, n) = of_node[n];
    }
}

static void weights_at(real w[], real h, real rate) {
    real phi[PHIS * (NODES + 1)];
    phis_at(phi, h * rate);
    weights_of(w, phi, h, h * rate);
}

/* φ6 at −a. */
static real phi_6(real a, real phi_5) {
    real term = R(1) / R(720), sum = term;
    if (a >= R(4)) return (R(1) / R(120) - phi_5) / a;
    for (int k = 7; k < 40; k++) {
        term *= -a / (real)k;
        sum += term;
    }
    return sum;
}

/* integrated() by a = h·r: φk(−a)' = k φk+1 − φk. */
static real integrated_slope(int i, const real *phi, int node, real a, int times, real to) {
    real sum = R(0), factorial = R(1), power = times == 1 ? to : to * to;
    for (int n = 0; n < NODES; n++) {
        const int k = n + times;
        const real higher = k + 1 < PHIS ? PHI(phi, node, k + 1) : phi_6(a * to, PHI(phi, node, PHIS - 1));
        if (n > 0) factorial *= (real)n;
        power *= to;
        sum += lagrange[i][n] * factorial * power * ((real)k * higher - PHI(phi, node, k));
    }
    return sum;
}

static void weight_slopes_at(real w[], real h, real rate) {
    real phi[PHIS * (NODES + 1)];
    const real a = h * rate, scale = h * h;
    phis_at(phi, a);
    for (int i = 0; i < NODES; i++) {
        for (int j = 0; j < NODES; j++) {
            AT_POINT(w, i, j) = scale * integrated_slope(i, phi, j, a, 1, gauss_node[j]);
            MEAN_TO_POINT(w, i, j) = scale * integrated_slope(i, phi, j, a, 2, gauss_node[j]);
        }
        w[AT_END + i] = scale * integrated_slope(i, phi, NODES, a, 1, R(1));
        w[OF_MEAN + i] = scale * integrated_slope(i, phi, NODES, a, 2, R(1));
    }
}

void laconic_gauss_weight_change_of(gauss_weight_change *change, const laconic_model *m, real h,
                                    const linear_map *damping) {
    static const int first[6] = {0, 1, 2, 0, 0, 1}, second[6] = {0, 1, 2, 1, 2, 2};
    const real by[6] = {damping->x.x, damping->y.y, damping->z.z, damping->x.y, damping->x.z, damping->y.z};
    for (int n = 0; n < 6; n++) {
        real *entry = change->entry[n];
        for (int k = 0; k < PANEL_WEIGHTS; k++) entry[k] = R(0);
        if (by[n] == R(0)) continue;
        divided_difference_of(entry, PANEL_WEIGHTS, weights_at, weight_slopes_at, h, m->decay_per_s[first[n]],
                              m->decay_per_s[second[n]]);
        for (int k = 0; k < PANEL_WEIGHTS; k++) entry[k] *= by[n];
    }
}

#endif
