/* Following angles as points z = e^{iψ} of the circle. With q = V_p + iω_p h, the parent's velocity at the hinge,
 *
 *     z' = i z (Re(z̄ p) − ω_p),     p = −n̄ q/ℓ,     a Riccati equation: z' = (i/2)(p + p̄ z² − 2ω_p z).
 *
 * For constant p and ω its flow is a Möbius map. With x² = h²(|p|² − ω²)/4, C = cosh x, S = sinh x/x (cos and sin/x for
 * x² < 0) and t = hS/2:
 *
 *     z⁺ = ((C − iωt) z + ipt) / ((C + iωt) − ip̄t z)
 *
 * Numerator and denominator have the same size on the circle, so z⁺ needs no root. */
#ifndef LACONIC_ARTICULATED_CIRCLE_H
#define LACONIC_ARTICULATED_CIRCLE_H

#include "articulated_step.h"
#include "polynomials.h"

#if LACONIC_MAX_BODIES > 0

/* p and ω of one hinge. */
typedef struct circle_flow {
    real px, py, turn;
} circle_flow;

INLINE circle_flow circle_flow_of(const laconic_link *link, vector parent) {
    const real x = parent.x - parent.z * link->hinge.y, y = parent.y + parent.z * link->hinge.x;
    const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
    const circle_flow f = {-(mx * x + my * y), my * x - mx * y, parent.z};
    return f;
}

static inline circle_flow flows_added(circle_flow a, real share, circle_flow b) {
    const circle_flow f = {a.px + share * b.px, a.py + share * b.py, a.turn + share * b.turn};
    return f;
}

/* C and S beyond the polynomial's bound. */
direction laconic_articulated_circle_factors(real x_square);

/* z for a map that had to divide by next to nothing: z is where the flow leaves in all directions. */
direction laconic_articulated_unit(direction z, direction instead);

/* The flow for a time h. */
INLINE direction circle_map(direction z, circle_flow f, real h) {
    const real y = R(0.25) * h * h * (f.px * f.px + f.py * f.py - f.turn * f.turn);
    direction factors = direction_with(R(1), R(0));
    if (magnitude(y) <= TANGENT_SMALL)
        factors.sine = poly_tangent(-y);
    else
        factors = laconic_articulated_circle_factors(y);
    const real t = R(0.5) * h * factors.sine, c = factors.cosine, wt = f.turn * t;
    const real ux = c * z.cosine + wt * z.sine - f.py * t, uy = c * z.sine - wt * z.cosine + f.px * t;
    const real qx = f.px * z.cosine + f.py * z.sine, qy = f.px * z.sine - f.py * z.cosine;
    const real vx = c + t * qy, vy = wt - t * qx;
    const real inverse = R(1) / (vx * vx + vy * vy);
    const direction to = direction_with((ux * vx + uy * vy) * inverse, (uy * vx - ux * vy) * inverse);
    const real off = to.cosine * to.cosine + to.sine * to.sine - R(1);
    if (!(magnitude(off) < R(1e-4))) return laconic_articulated_unit(to, z);
    return direction_with(to.cosine - R(0.5) * off * to.cosine, to.sine - R(0.5) * off * to.sine);
}

#endif
#endif
