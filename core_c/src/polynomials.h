/* Minimax polynomials (Remez, computed in 50 digits) of the functions that a step needs close to 0.
 * The only place where the two scalar types differ in more than their name: single needs fewer terms. */
#ifndef LACONIC_POLYNOMIALS_H
#define LACONIC_POLYNOMIALS_H

#include "internal.h"

#define CHORD_SMALL R(0.25)          /* z = α² up to which poly_sinc and poly_j1 hold */
#define TANGENT_SMALL R(0.015625)    /* |z| up to which poly_tangent holds            */

#ifdef LACONIC_SINGLE

/* sin x on |x| <= π/4, z = x²: error 4e-9 */
static inline real poly_sin(real x, real z) {
    return x + x * z * (R(-0.16666654940256574587) + z * (R(0.0083321779190321380808) + z * R(-0.00019517267132177431398)));
}

/* cos x on |x| <= π/4, z = x²: error 1e-10 */
static inline real poly_cos(real z) {
    return R(1) - z * R(0.5) +
           z * z * (R(0.041666646860773310301) + z * (R(-0.0013887367223119975287) + z * R(0.000024438416549882651326)));
}

/* sin α/α, z = α²: error 1e-10 */
static inline real poly_sinc(real z) {
    return R(1) + z * (R(-0.16666665880551673974) + z * (R(0.0083331423829819347446) + z * R(-0.00019709355699143168117)));
}

/* (sin α − α cos α)/α³, z = α²: error 1e-8 */
static inline real poly_j1(real z) {
    return R(0.33333332262974735309) + z * (R(-0.033332561944357907755) + z * R(0.001182237312979869037));
}

/* tan √z/√z, either sign of z: error 2e-10 */
static inline real poly_tangent(real z) {
    return R(1) + z * (R(0.3333333331151476837) + z * (R(0.13333775436886876984) + z * R(0.053971311619314569029)));
}

#else

/* sin x on |x| <= π/4, z = x²: error 3e-18 */
static inline real poly_sin(real x, real z) {
    return x + x * z * (R(-0.16666666666666632048) +
           z * (R(0.0083333333333224192248) + z * (R(-0.00019841269829812470697) +
           z * (R(2.7557313693599078936e-6) + z * (R(-2.5050758387924907033e-8) + z * R(1.5896811979428936059e-10))))));
}

/* cos x on |x| <= π/4, z = x²: error 5e-20 */
static inline real poly_cos(real z) {
    return R(1) - z * R(0.5) + z * z * (R(0.041666666666666599524) +
           z * (R(-0.0013888888888874132458) + z * (R(0.000024801587289487641776) +
           z * (R(-2.7557314353950177896e-7) + z * (R(2.0875723498811682614e-9) + z * R(-1.1359659781881176891e-11))))));
}

/* sin α/α, z = α²: error 2e-17 */
static inline real poly_sinc(real z) {
    return R(1) + z * (R(-0.16666666666666281302) + z * (R(0.0083333333331147989683) +
           z * (R(-0.00019841269438804871329) + z * (R(2.7556995710930070915e-6) + z * R(-2.4934019677787338054e-8)))));
}

/* (sin α − α cos α)/α³, z = α²: error 4e-15 */
static inline real poly_j1(real z) {
    return R(0.33333333333332967299) + z * (R(-0.033333333332601061983) + z * (R(0.0011904761670361789656) +
           z * (R(-0.000022045592735066974568) + z * R(2.4931945338832865323e-7))));
}

/* tan √z/√z, either sign of z: error 5e-18 */
static inline real poly_tangent(real z) {
    return R(1) + z * (R(0.33333333333333561896) + z * (R(0.13333333333333602852) +
           z * (R(0.053968253892745705214) + z * (R(0.021869488482977291104) +
           z * (R(0.0088638563034496220872) + z * R(0.0035924446910769512314))))));
}

#endif
#endif
