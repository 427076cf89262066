/* Coordinated steering.
 *
 * One twist T(t) = (T_ξ, T_η, T_θ) commands every steered wheel, so that the carriage has one degree of freedom, X_0 =
 * σ U with U = T/|T|, |T|² = T·I₀T, and the rank of the wheels' rows is exact: no angle is given twice. A hinge at h
 * points along w = T_v + i T_θ h:
 *
 *     e^{iψ} = w/|w|,     ψ' = Im(w'/w),     ψ'' = Im(w''/w) − 2 ψ' Re(w'/w),     U' = T'/|T| − U (T·I₀T')/|T|² */
#ifndef LACONIC_ARTICULATED_COORDINATED_H
#define LACONIC_ARTICULATED_COORDINATED_H

#include "articulated_sweep.h"

#if LACONIC_MAX_BODIES > 0

/* 1/√x, from a number that is near it, or by a root. 0 where x is not positive or not finite. */
real laconic_articulated_inverse_root(real x);

/* Two rounds of Halley's kind, each of which takes e to about e³. */
INLINE real inverse_root_near(real x, real guess) {
    real e = R(1) - x * guess * guess;
    if (!(magnitude(e) < R(0.02))) return laconic_articulated_inverse_root(x);
    guess += guess * e * (R(0.5) + R(0.375) * e);
    e = R(1) - x * guess * guess;
    return guess + guess * e * (R(0.5) + R(0.375) * e);
}

/* |w|² up to which w is too short beside T_v, of which it is the rest near a turning centre. */
static inline real least_square_of(vector twist) {
    return LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE * (twist.x * twist.x + twist.y * twist.y);
}

/* U and U'. False where T is 0. */
INLINE bool take_unit_twist(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive) {
    const vector t = drive->twist[0], momentum = form_times(&m->inertia, t);
    const real inverse = inverse_root_near(dot(momentum, t), s->inverse_size[0]);
    s->inverse_size[0] = inverse;
    s->least_square = least_square_of(t);
    s->along[0] = scaled(inverse, t);
    s->along_rate = none;
    s->along_share = R(0);
    if (drive->turns) {
        s->along_share = inverse * inverse * dot(momentum, drive->twist[1]);
        s->along_rate = minus(scaled(inverse, drive->twist[1]), scaled(s->along_share, s->along[0]));
    }
    return inverse > R(0);
}

static inline direction twist_at_hinge(const laconic_link *link, vector twist) {
    return direction_with(twist.x - twist.z * link->hinge.y, twist.y + twist.z * link->hinge.x);
}

typedef struct coordinated_motion {
    direction w;                     /* not of length 1 */
    real square_size, size;          /* |w|², |w|       */
    real rate, acceleration, growth; /* ψ', ψ'', |w|'/|w| */
} coordinated_motion;

/* Coordinated hinge b; sets its direction. A hinge without one has the size 0. */
INLINE coordinated_motion coordinate(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive,
                                     int32_t b) {
    const direction w = twist_at_hinge(link, drive->twist[0]);
    coordinated_motion c = {w, w.cosine * w.cosine + w.sine * w.sine, R(0), R(0), R(0), R(0)};
    real guess = s->inverse_size[b];
    if (guess == R(0)) guess = R(1) / (s->toward[b - 1].cosine * w.cosine + s->toward[b - 1].sine * w.sine);
    const real inverse = inverse_root_near(c.square_size, guess);
    s->inverse_size[b] = inverse;
    s->toward[b - 1] = direction_with(w.cosine * inverse, w.sine * inverse);
    if (c.square_size > s->least_square) c.size = c.square_size * inverse;
    if (drive->turns) {
        const direction w1 = twist_at_hinge(link, drive->twist[1]), w2 = twist_at_hinge(link, drive->twist[2]);
        const real per_square = inverse * inverse;
        c.rate = (w.cosine * w1.sine - w.sine * w1.cosine) * per_square;
        c.growth = (w.cosine * w1.cosine + w.sine * w1.sine) * per_square;
        c.acceleration = (w.cosine * w2.sine - w.sine * w2.cosine) * per_square - R(2) * c.rate * c.growth;
    }
    return c;
}

/* Forgets sizes of another posture. */
static inline void forget_sizes(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t b = 0; m->coordinated && b <= m->body_count; b++) s->inverse_size[b] = R(0);
}

#endif
#endif
