/* The core's own square root, exponential, sine and cosine, and the φ functions of exponential steps. */
#include "elementary.h"

#include "heading.h"

#ifdef LACONIC_SINGLE
#define REDUCE_1 R(1.5703125) /* π/2 in three parts; the first two times k are exact for small k */
#define REDUCE_2 R(4.8351287841796875e-4)
#define REDUCE_3 R(3.139164786504813e-7)
#define EXPONENT_SPAN R(103)
#define LN2_HIGH R(0.693145751953125)
#define LN2_LOW R(1.428606820309417232e-6)
#else
#define REDUCE_1 R(1.570796310901641845703125)
#define REDUCE_2 R(1.589325471229585673427209e-8)
#define REDUCE_3 R(6.12323399573676588613e-17)
#define EXPONENT_SPAN R(745)
#define LN2_HIGH R(0.6931471804855391383171082)
#define LN2_LOW R(7.440617110012396716130157e-11)
#endif

real laconic_root(real x) {
    real scale = R(1), guess;
    if (!(x > R(0))) return R(0);
    if (!is_finite(x)) return x;
    while (x > R(4)) { /* powers of two: exact */
        x *= R(0.0625);
        scale *= R(4);
    }
    while (x < R(0.25)) {
        x *= R(16);
        scale *= R(0.25);
    }
    guess = R(0.5) + R(0.5) * x;
    /* The guess is at most 25 % off, and each round squares that: 2.5e-2, 3e-4, 5e-8, 1.2e-15, then rounding. In a
     * million samples the sixth round changes no bit; the seventh is a reserve. */
    for (int k = 0; k < 7; k++) guess = R(0.5) * (guess + x / guess);
    return scale * guess;
}

real laconic_decaying_exponential(real a) {
    real halvings, x, term = R(1), sum = R(1);
    if (!(a < EXPONENT_SPAN)) return R(0);
    int n = (int)(a * R(1.4426950408889634) + R(0.5));
    halvings = (real)n;
    x = -((a - halvings * LN2_HIGH) - halvings * LN2_LOW); /* |x| <= ln 2 / 2 */
    /* sum lies in 0.7 … 1.42, and the term after the 13th is below 4.2e-18: less than half its last place. */
    for (int k = 1; k <= 13; k++) {
        term *= x / (real)k;
        sum += term;
    }
    for (; n > 0; n--) sum *= R(0.5);
    return sum;
}

direction laconic_direction_of_angle(real angle_rad) {
    const real quarters = angle_rad * R(0.6366197723675813431);
    if (magnitude(quarters) < R(1e6)) {
        const int32_t k = (int32_t)(quarters + (quarters < R(0) ? R(-0.5) : R(0.5)));
        const real n = (real)k;
        return direction_near(((angle_rad - n * REDUCE_1) - n * REDUCE_2) - n * REDUCE_3, (unsigned)k);
    }
    return laconic_direction_of_binary_angle(laconic_binary_angle_of(angle_rad));
}

direction laconic_direction_of_binary_angle(laconic_binary_angle angle) { return direction_of_binary_angle(angle); }

laconic_binary_angle laconic_binary_angle_of(real angle_rad) {
    const real turns = angle_rad * R(0.1591549430918953358);
    if (magnitude(turns) < HALF_TURN) {
        const real part = turns - (real)(signed_binary_angle)turns; /* in (−1, 1) */
        return (laconic_binary_angle)((laconic_binary_angle)(signed_binary_angle)(part * HALF_TURN) * 2U);
    }
    return 0; /* NaN, or an angle so large that its direction is not known */
}

/* φk = 1/k! − a φk+1. Below a = 4 from the series of φ5 downwards, above upwards from φ0. Downwards each step
 * multiplies the error by a: φ1 is off by 17 units in the last place at a = 4, by 54 at 5. Upwards each step
 * divides it by a: φ5 is off by 1.3 units at 4, by 7 at 2 and by 1,300 at ½. Of the series at a = 4, the 31st term is
 * the last that changes the sum. */
void laconic_phi(real phi[6], real a) {
    static const real inverse_factorial[5] = {R(1), R(1), R(0.5), R(1) / R(6), R(1) / R(24)};
    if (a < R(4)) {
        real term = R(1) / R(120), sum = term;
        for (int k = 6; k < 40; k++) {
            term *= -a / (real)k;
            sum += term;
        }
        phi[5] = sum;
        for (int k = 4; k >= 0; k--) phi[k] = inverse_factorial[k] - a * phi[k + 1];
    } else {
        phi[0] = laconic_decaying_exponential(a);
        for (int k = 0; k < 5; k++) phi[k + 1] = (inverse_factorial[k] - phi[k]) / a;
    }
}
