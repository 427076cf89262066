/* What the methods of eighth order share: the quadrature of the pose, and the forcing along the step. */
#ifndef LACONIC_EIGHTH_ORDER_H
#define LACONIC_EIGHTH_ORDER_H

#include "gauss_points.h"
#include "step_internals.h"

/* In one loop, which compilers vectorise, where the angles are small. */
static inline void directions_at_nodes(real cosine[NODES], real sine[NODES], real angle[NODES]) {
    real sum = R(0);
    for (int k = 0; k < NODES; k++) sum += magnitude(angle[k]);
    if (LIKELY(sum <= R(0.78), &angle[0])) { /* then each is below π/4 = 0.785, up to where the polynomials hold */
        for (int k = 0; k < NODES; k++) cosine[k] = poly_cos(angle[k] * angle[k]);
        for (int k = 0; k < NODES; k++) sine[k] = poly_sin(angle[k], angle[k] * angle[k]);
    } else {
        for (int k = 0; k < NODES; k++) {
            const direction d = laconic_direction_of_binary_angle(laconic_binary_angle_of(angle[k]));
            cosine[k] = d.cosine;
            sine[k] = d.sine;
        }
    }
}

/* ∫ e^{i(θ − θ_mid)} v dt by the velocities at the nodes, times h: in axes at the heading θ_mid half-way between start
 * and end. `angle`: θ − θ_mid. */
INLINE pose_change displacement_at_nodes(const laconic_model *m, real h, real yaw_change, const real x[NODES],
                                         const real y[NODES], const real z[NODES], real angle[NODES]) {
    const vector forth = vec(m->velocity_of_zeta[0]), left = vec(m->velocity_of_zeta[1]);
    pose_change moved = {R(0), R(0), yaw_change};
    real cosine[NODES], sine[NODES], along[NODES], across[NODES];
    directions_at_nodes(cosine, sine, angle);
    for (int k = 0; k < NODES; k++)
        along[k] = h * R(gauss_weight[k]) * (forth.x * x[k] + forth.y * y[k] + forth.z * z[k]);
    for (int k = 0; k < NODES; k++)
        across[k] = h * R(gauss_weight[k]) * (left.x * x[k] + left.y * y[k] + left.z * z[k]);
    for (int k = 0; k < NODES; k++) moved.along_m += cosine[k] * along[k] - sine[k] * across[k];
    for (int k = 0; k < NODES; k++) moved.across_m += sine[k] * along[k] + cosine[k] * across[k];
    return moved;
}

/* ---- b along the step: parabolas through the samples, of what stays and of what rotates with the heading -- */

typedef struct forcing_terms {
    vector constant[3], cosine[3], sine[3]; /* of 1, s, s² with s from 0 to 1 */
    bool rotates;                           /* else cosine and sine are not set */
} forcing_terms;

static void parabola_terms(vector term[3], const real start[3], const real middle[3], const real end[3]) {
    const vector half = minus(vec(middle), vec(start)), whole = minus(vec(end), vec(start));
    term[0] = vec(start);
    term[1] = minus(scaled(R(4), half), whole);
    term[2] = scaled(R(2), minus(whole, scaled(R(2), half)));
}

static inline void forcing_terms_of(forcing_terms *f, const laconic_forcing_samples *samples) {
    static const laconic_forcing still = ALL_ZERO;
    const laconic_forcing *at[3] = {samples->start, samples->middle, samples->end};
    parabola_terms(f->constant, at[0]->constant, at[1]->constant, at[2]->constant);
    f->rotates = LACONIC_WITH_WORLD_FORCE && (at[0]->rotates || at[1]->rotates || at[2]->rotates);
    if (!f->rotates) return;
    for (int k = 0; k < 3; k++)
        if (!at[k]->rotates) at[k] = &still;
    parabola_terms(f->cosine, at[0]->cosine, at[1]->cosine, at[2]->cosine);
    parabola_terms(f->sine, at[0]->sine, at[1]->sine, at[2]->sine);
}

#endif
