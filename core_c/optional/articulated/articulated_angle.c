/* The angle of a direction: of short turns by their sine; else a rough one, then what is left of it by the sine of the
 * difference.
 *
 * With t = smaller/larger component the rough angle t(π/4 + 0.273(1 − t)) is off by at most 4e-3 rad. Of the rest e,
 * the sine of the difference, arcsin e = e + e³/6 + 3e⁵/40 + …: the next term is below 1e-18. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

static real small_arcsine(real e) {
    const real z = e * e;
    return e + e * z * (R(1) / R(6) + z * R(0.075));
}

real laconic_articulated_angle_of(direction d) {
    const real x = magnitude(d.cosine), y = magnitude(d.sine), larger = x > y ? x : y, smaller = x > y ? y : x;
    if (!(larger > R(0)) || !is_finite(larger)) return R(0);
    const real t = smaller / larger, inverse = R(1) / laconic_root(R(1) + t * t);
    const real steep = t * (R(0.78539816339744830962) + R(0.273) * (R(1) - t));
    const direction rough = direction_near(steep < R(0.78) ? steep : R(0.78), 0);
    real angle = (steep < R(0.78) ? steep : R(0.78)) + small_arcsine((t * rough.cosine - rough.sine) * inverse);
    if (y > x) angle = R(1.57079632679489661923) - angle;
    if (d.cosine < R(0)) angle = R(3.14159265358979323846) - angle;
    return d.sine < R(0) ? -angle : angle;
}

real laconic_articulated_turn_from_to(direction from, direction to) {
    const direction d = from_to(from, to);
    const real z = d.sine * d.sine;
    if (!(z < R(4e-4)) || d.cosine < R(0)) return laconic_articulated_angle_of(d);
    return d.sine + d.sine * z * (R(1) / R(6) + z * (R(0.075) + z * (R(15) / R(336) + z * (R(35) / R(1152)))));
}

#endif
