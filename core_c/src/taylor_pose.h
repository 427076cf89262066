/* The pose along a series: a quadrature of the same order. */
#ifndef LACONIC_TAYLOR_POSE_H
#define LACONIC_TAYLOR_POSE_H

#include "advance.h"
#include "taylor.h"

#define NODES 4 /* of Gauss, exact to degree 7 */

static const real node[NODES] = {R(0.069431844202973712388), R(0.33000947820757186760), R(0.66999052179242813240),
                                 R(0.93056815579702628761)};
static const real weight[NODES] = {R(0.17392742256872692869), R(0.32607257743127307131), R(0.32607257743127307131),
                                   R(0.17392742256872692869)};

/* The polynomials: the components of ζ, and ∫ g·ζ ds, divided by s. */
typedef real (*polynomial)(const course *c, int n);

static inline real zeta_x(const course *c, int n) { return c->zeta[n].x; }

static inline real zeta_y(const course *c, int n) { return c->zeta[n].y; }

static inline real zeta_z(const course *c, int n) { return c->zeta[n].z; }

static inline real mean_yaw(const course *c, int n) { return inverse[n] * c->yaw[n]; }

/* A polynomial at all nodes at once: compilers take them two or four at a time. */
INLINE void at_nodes(real value[NODES], const course *c, polynomial coefficient) {
    int n, k;
    for (k = 0; k < NODES; k++) value[k] = coefficient(c, ORDER);
    for (n = ORDER - 1; n >= 0; n--)
        for (k = 0; k < NODES; k++) value[k] = node[k] * value[k] + coefficient(c, n);
}

/* All at once, too, where they are small. */
static inline void directions_at_nodes(real cosine[NODES], real sine[NODES], const real angle[NODES]) {
    real sum = R(0);
    int k;
    for (k = 0; k < NODES; k++) sum += magnitude(angle[k]);
    if (sum <= R(0.78)) {
        for (k = 0; k < NODES; k++) cosine[k] = poly_cos(angle[k] * angle[k]);
        for (k = 0; k < NODES; k++) sine[k] = poly_sin(angle[k], angle[k] * angle[k]);
    } else {
        for (k = 0; k < NODES; k++) {
            const direction d = laconic_direction_of_turn(laconic_turn_of_angle(angle[k]));
            cosine[k] = d.cosine;
            sine[k] = d.sine;
        }
    }
}

/* In axes at the mid-step heading: ∫ e^{i(θ − θ_mid)} v dt. */
static inline motion quadrature(const course *c, const laconic_model *m, real h, real turn) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    motion moved = {R(0), R(0), turn};
    const real per_yaw = turn_of_yaw(m, h);
    real x[NODES], y[NODES], z[NODES], angle[NODES], cosine[NODES], sine[NODES], along[NODES], across[NODES];
    int k;
    at_nodes(x, c, zeta_x);
    at_nodes(y, c, zeta_y);
    at_nodes(z, c, zeta_z);
    at_nodes(angle, c, mean_yaw);
    for (k = 0; k < NODES; k++) angle[k] = per_yaw * node[k] * angle[k] - R(0.5) * turn;
    directions_at_nodes(cosine, sine, angle);
    for (k = 0; k < NODES; k++) along[k] = h * weight[k] * (forth.x * x[k] + forth.y * y[k] + forth.z * z[k]);
    for (k = 0; k < NODES; k++) across[k] = h * weight[k] * (left.x * x[k] + left.y * y[k] + left.z * z[k]);
    for (k = 0; k < NODES; k++) moved.along_m += cosine[k] * along[k] - sine[k] * across[k];
    for (k = 0; k < NODES; k++) moved.across_m += sine[k] * along[k] + cosine[k] * across[k];
    return moved;
}

#endif
