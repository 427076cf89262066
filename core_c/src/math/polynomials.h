/* Minimax polynomials (Remez, computed in 50 digits) of functions that a step needs for small arguments. In single
 * precision they have fewer terms. */
#ifndef LACONIC_POLYNOMIALS_H
#define LACONIC_POLYNOMIALS_H

#include "common.h"

/* Bounds up to which the polynomials hold: steps with a yaw below a quarter of a radian, as most have. */
#define CHORD_SMALL R(0.015625)   /* z = α² of poly_sinc and poly_j1, α half the yaw */
#define TANGENT_SMALL R(0.015625) /* |z| of poly_tangent, exact_flow.c defines its z */

#ifdef LACONIC_SINGLE

/* sin x on |x| <= π/4, z = x²: error 4e-9 */
static inline real poly_sin(real x, real z) {
    return x +
           x * z * (R(-0.16666654940256574587) + z * (R(0.0083321779190321380808) + z * R(-0.00019517267132177431398)));
}

/* cos x on |x| <= π/4, z = x²: error 1e-10 */
static inline real poly_cos(real z) {
    return R(1) - z * R(0.5) +
           z * z *
               (R(0.041666646860773310301) + z * (R(-0.0013887367223119975287) + z * R(0.000024438416549882651326)));
}

/* sin α/α on z = α² <= 1/64: error 3e-11 */
static inline real poly_sinc(real z) {
    return R(1) + z * (R(-0.16666664580678050564) + z * R(0.0083290180090501000745));
}

/* (sin α − α cos α)/α³ on z = α² <= 1/64: error 4e-8 */
static inline real poly_j1(real z) { return R(0.33333329701864815124) + z * R(-0.033314737524190506486); }

/* tan √z/√z, either sign of z: error 2e-10 */
INLINE real poly_tangent(real z) {
    return R(1) + z * (R(0.3333333331151476837) + z * (R(0.13333775436886876984) + z * R(0.053971311619314569029)));
}

#else

/* sin x on |x| <= π/4, z = x²: error 3e-18 */
static inline real poly_sin(real x, real z) {
    return x + x * z *
                   (R(-0.16666666666666632048) +
                    z * (R(0.0083333333333224192248) +
                         z * (R(-0.00019841269829812470697) +
                              z * (R(2.7557313693599078936e-6) +
                                   z * (R(-2.5050758387924907033e-8) + z * R(1.5896811979428936059e-10))))));
}

/* cos x on |x| <= π/4, z = x²: error 8e-17, below the rounding of the sum */
static inline real poly_cos(real z) {
    return R(1) - z * R(0.5) +
           z * z *
               (R(0.041666666666602229484) +
                z * (R(-0.0013888888878270576647) +
                     z * (R(0.000024801580969956457619) +
                          z * (R(-2.7555566810097892732e-7) + z * R(2.064771670736716179e-9)))));
}

/* sin α/α on z = α² <= 1/64: error 5e-20 */
static inline real poly_sinc(real z) {
    return R(1) +
           z * (R(-0.16666666666666656249) + z * (R(0.0083333333332685511471) + z * (R(-0.00019841268589095877322) +
                                                                                     z * R(2.7547780343214621122e-6))));
}

/* (sin α − α cos α)/α³ on z = α² <= 1/64: error 3e-12; its factors are themselves of second order in h */
static inline real poly_j1(real z) {
    return R(0.33333333333070619568) + z * (R(-0.033333330306691614816) + z * R(0.0011899596015826127739));
}

/* tan √z/√z, either sign of z: error 5e-18 */
INLINE real poly_tangent(real z) {
    const real z2 = z * z; /* in pairs: half the latency of Horner's rule */
    return (R(1) + z * R(0.33333333333333561896)) +
           z2 * ((R(0.13333333333333602852) + z * R(0.053968253892745705214)) +
                 z2 * ((R(0.021869488482977291104) + z * R(0.0088638563034496220872)) +
                       z2 * R(0.0035924446910769512314)));
}

#endif
#endif
