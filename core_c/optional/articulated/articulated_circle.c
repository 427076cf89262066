/* The rarer parts of the maps of the circle: large arguments, points where the flow leaves in all directions, and the
 * angle of a direction. */
#include "articulated_circle.h"

#if LACONIC_MAX_BODIES > 0

/* cosh and sinh leave the range where their ratio does not: for x² > 0 (1, tanh x/x), with the same map. */
direction laconic_articulated_circle_factors(real x_square) {
    const real x = laconic_root(magnitude(x_square));
    if (x_square > R(0)) {
        const real e = laconic_decaying_exponential(R(2) * x);
        return direction_with(R(1), (R(1) - e) / ((R(1) + e) * x));
    }
    const direction d = laconic_direction_of_angle(x);
    return direction_with(d.cosine, d.sine / x);
}

direction laconic_articulated_unit(direction z, direction instead) {
    const real size_of = laconic_root(z.cosine * z.cosine + z.sine * z.sine);
    if (!(size_of > R(0)) || !is_finite(size_of)) return instead;
    return direction_with(z.cosine / size_of, z.sine / size_of);
}

/* The angle of a direction: of short turns by their sine; else a rough one, then what is left of it by the sine of the
 * difference.
 *
 * With t = smaller/larger component the rough angle t(π/4 + 0.273(1 − t)) is off by at most 4e-3 rad. Of the rest e,
 * the sine of the difference, arcsin e = e + e³/6 + 3e⁵/40 + …: the next term is below 1e-18. */
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
