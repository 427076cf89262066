/* Coordinated steering: one twist T(t) = (T_ξ, T_η, T_θ) commands every steered wheel, so that the carriage has one
 * degree of freedom, X_0 = σ U with U = T/|T|, and the rank of the wheels' rows is exact: no angle is given twice.
 *
 * A module at h points along w = T_v + i T_θ h:  e^{iψ} = w/|w|,  ψ' = Im(w'/w),  ψ'' = Im(w''/w) − 2 ψ' Re(w'/w). */
#include "articulated_tree.h"

#if LACONIC_MAX_BODIES > 0

/* Not positive where T is 0 or its square leaves the range. */
static real inverse_size(real square_size) {
    const real root = laconic_root(square_size);
    return root > R(0) && is_finite(root) ? R(1) / root : R(0);
}

/* |T|² = T·I₀T keeps ½σ² the energy of body 0: U' = T'/|T| − U (T·I₀T')/|T|². */
bool laconic_articulated_unit_twist(vector *unit, vector *unit_rate, const laconic_articulated_model *m,
                                    const articulated_drive *drive) {
    const vector t = drive->twist[0], momentum = form_times(&m->inertia, t);
    const real inverse = inverse_size(dot(momentum, t));
    *unit = scaled(inverse, t);
    *unit_rate = minus(scaled(inverse, drive->twist[1]),
                       scaled(inverse * inverse * dot(momentum, drive->twist[1]), *unit));
    return inverse > R(0);
}

static direction at_hinge(const laconic_link *link, vector twist) {
    return direction_with(twist.x - twist.z * link->hinge.y, twist.y + twist.z * link->hinge.x);
}

bool laconic_articulated_coordinate(direction *d, real *rate, real *acceleration, const laconic_link *link,
                                    const vector twist[3]) {
    const direction w = at_hinge(link, twist[0]), w1 = at_hinge(link, twist[1]), w2 = at_hinge(link, twist[2]);
    const real size = magnitude(twist[0].x) + magnitude(twist[0].y) + magnitude(link->hinge.x * twist[0].z) +
                      magnitude(link->hinge.y * twist[0].z);
    const real square_size = w.cosine * w.cosine + w.sine * w.sine, inverse = inverse_size(square_size);
    const real per_square = inverse * inverse;
    const real turn = (w.cosine * w1.sine - w.sine * w1.cosine) * per_square;
    *d = direction_with(w.cosine * inverse, w.sine * inverse);
    *rate = turn;
    *acceleration = (w.cosine * w2.sine - w.sine * w2.cosine) * per_square -
                    R(2) * turn * (w.cosine * w1.cosine + w.sine * w1.sine) * per_square;
    return square_size > LACONIC_RANK_TOLERANCE * LACONIC_RANK_TOLERANCE * size * size && inverse > R(0);
}

laconic_status laconic_articulated_refuse_twist(int32_t hinge, const laconic_articulated_model *m,
                                                const articulated_drive *drive, laconic_refusal *why) {
    if (hinge < 0) return refuse(why, LACONIC_TWIST_ZERO, (laconic_field)LACONIC_FIELD_OF_TWIST, 0, R(0), R(0));
    const direction w = at_hinge(&m->link[hinge - 1], drive->twist[0]);
    return refuse(why, LACONIC_TWIST_ZERO, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE, hinge,
                  laconic_root(w.cosine * w.cosine + w.sine * w.sine), R(0));
}

#endif
