/* The rarer parts of the maps of the circle: large arguments, and points where the flow leaves in all directions. */
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

#endif
